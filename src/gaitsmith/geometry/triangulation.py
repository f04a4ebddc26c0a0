"""Delaunay triangulations of few points in the plane, that grow point by point."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: A triangle whose height is less, over its longest side, is none.
_THIN = 1e-9


class Triangulation:
    """Delaunay triangulation: no point lies inside the circle through a triangle's corners.

    Attributes
    ----------
    points
        ``(P, 2)``; those added later come last.
    """

    def __init__(self, points: Float[np.ndarray, "P 2"]) -> None:
        """Triangulate; InvalidInputError unless three of the points span a triangle.

        For a handful of points: all triangles are tried.
        """
        self.points = np.array(points, dtype=np.float64)
        self._edges: dict[tuple[int, int], tuple[int, int, int]] = {}
        self._first(len(self.points))
        if not self._edges:
            raise InvalidInputError(
                f"a triangulation needs three points that are not in line, got {len(self.points)}"
            )
        self._last = next(iter(self._edges.values()))

    def _first(self, count: int) -> None:
        hull = set[tuple[int, int]]()
        for corners in self._empty(count):
            sides = _sides(corners)
            if not any(side in hull for side in sides) and not self._overlaps(corners):
                hull.update(sides)
                self._add(corners)

    def _empty(self, count: int) -> list[tuple[int, int, int]]:
        """Triangles, counter-clockwise, in whose circles no point lies; some share their circle."""
        triples = np.array(list(combinations(range(count), 3)), dtype=np.int64).reshape(-1, 3)
        turns = np.array([self._turn(a, b, c) for a, b, c in triples.tolist()])
        triples, turns = triples[turns != 0.0], turns[turns != 0.0]
        triples = np.where(turns[:, None] > 0.0, triples, triples[:, [0, 2, 1]])
        arms = self.points[triples][:, None] - self.points[:, None]
        square = (arms * arms).sum(-1)
        crossed = arms[..., [1, 2, 0], 0] * arms[..., [2, 0, 1], 1]
        crossed = crossed - arms[..., [1, 2, 0], 1] * arms[..., [2, 0, 1], 0]
        inside = (square * crossed).sum(-1) > 1e-12 * square.max(-1) ** 2
        every = np.arange(len(triples))
        inside[every[:, None], triples] = False  # its own corners
        # of points on one circle the first triangulation found is kept
        return [(a, b, c) for a, b, c in triples[~inside.any(axis=1)].tolist()]

    def _overlaps(self, corners: tuple[int, int, int]) -> bool:
        """Whether the middle of a new triangle lies in one that is there, or the reverse."""
        middle = self.points[list(corners)].sum(axis=0) / 3.0
        for other in self.triangles.tolist():
            there = self.points[other].sum(axis=0) / 3.0
            own = self._barycentric(corners, there).min()
            theirs = self._barycentric((other[0], other[1], other[2]), middle).min()
            if own > 1e-12 or theirs > 1e-12:
                return True
        return False

    @property
    def triangles(self) -> Int[np.ndarray, "T 3"]:
        """Corners of each triangle, counter-clockwise, in order."""
        return np.array(sorted(set(self._edges.values())), dtype=np.int64).reshape(-1, 3)

    def locate(self, point: Float[np.ndarray, "2"]) -> tuple[tuple[int, int, int], int]:
        """The triangle that holds ``point``, and how many were left on the way to it.

        The way begins at the triangle found last; beyond the hull it ends at the hull.
        """
        here, walked = self._last, 0
        for _ in range(4 * len(self._edges)):
            share = self._barycentric(here, point)
            worst = int(share.argmin())
            if share[worst] >= -1e-12:
                break
            a, b = here[(worst + 1) % 3], here[(worst + 2) % 3]
            beyond = self._edges.get((b, a))
            if beyond is None:
                break
            here, walked = beyond, walked + 1
        self._last = here
        return here, walked

    def shares(
        self, triangle: tuple[int, int, int], point: Float[np.ndarray, "2"]
    ) -> Float[np.ndarray, "3"]:
        """Barycentric coordinates of ``point``; negative outside."""
        return self._barycentric(triangle, point)

    def insert(self, point: Float[np.ndarray, "2"]) -> int:
        """Add a point inside the hull; its index."""
        start, _ = self.locate(point)
        index = len(self.points)
        self.points = np.concatenate([self.points, [point]])
        bad, front = {start}, [start]
        while front:
            for a, b in _sides(front.pop()):
                beyond = self._edges.get((b, a))
                if beyond is not None and beyond not in bad and self._in_circle(beyond, point):
                    bad.add(beyond)
                    front.append(beyond)
        sides = [side for triangle in sorted(bad) for side in _sides(triangle)]
        rim = [side for side in sides if (side[1], side[0]) not in sides]
        for side in sides:
            self._edges.pop(side)
        for a, b in rim:
            if self._turn(a, b, index) > 0.0:  # else the point lies on the hull's own edge
                self._add((a, b, index))
        self._last = next(t for t in self._edges.values() if index in t)
        return index

    def _add(self, corners: tuple[int, int, int]) -> None:
        low = corners.index(min(corners))
        corners = (corners[low], corners[(low + 1) % 3], corners[(low + 2) % 3])
        for side in _sides(corners):
            self._edges[side] = corners

    def _turn(self, a: int, b: int, c: int) -> float:
        """Twice the area, counter-clockwise positive; 0 if it is as good as none."""
        u, v = self.points[b] - self.points[a], self.points[c] - self.points[a]
        area = float(u[0] * v[1] - u[1] * v[0])
        size = float(max(u @ u, v @ v, (u - v) @ (u - v)))
        return area if abs(area) > _THIN * size else 0.0

    def _in_circle(self, triangle: tuple[int, int, int], point: Float[np.ndarray, "2"]) -> bool:
        """Whether ``point`` is inside the circle through the corners."""
        arms = self.points[list(triangle)] - point
        table = np.concatenate([arms, (arms * arms).sum(-1, keepdims=True)], axis=1)
        return float(np.linalg.det(table)) > 0.0

    def _barycentric(
        self, triangle: tuple[int, int, int], point: Float[np.ndarray, "2"]
    ) -> Float[np.ndarray, "3"]:
        (ax, ay), (bx, by), (cx, cy) = self.points[list(triangle)].tolist()
        x, y = float(point[0]) - cx, float(point[1]) - cy
        ax, ay, bx, by = ax - cx, ay - cy, bx - cx, by - cy
        area = ax * by - ay * bx  # plain numbers: a solver takes ten times as long for two
        first, second = (x * by - y * bx) / area, (ax * y - ay * x) / area
        return np.array([first, second, 1.0 - first - second])


def _sides(triangle: tuple[int, int, int]) -> tuple[tuple[int, int], ...]:
    a, b, c = triangle
    return (a, b), (b, c), (c, a)
