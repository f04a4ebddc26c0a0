"""A coarse cage of quads that subdivision turns into a smooth skin, weights and all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float, Int


class Cage:
    """Points, their joint weights and the faces between them, while they are being built.

    Rings are lists of indices. Seen from where a tube goes to, a ring runs counter-clockwise;
    then all faces look outward.
    """

    def __init__(self, joints: int) -> None:
        self.joints = joints
        self.points: list[Float[np.ndarray, "3"]] = []
        self.weights: list[Float[np.ndarray, "joints"]] = []
        self.faces: list[tuple[int, int, int, int]] = []
        self.paints: list[int] = []

    def point(self, at: Float[np.ndarray, "3"], weights: Float[np.ndarray, "joints"]) -> int:
        """Add one point; its index."""
        self.points.append(np.asarray(at, dtype=np.float64))
        self.weights.append(weights)
        return len(self.points) - 1

    def ring(
        self, at: Float[np.ndarray, "n 3"], weights: Float[np.ndarray, "*n joints"]
    ) -> list[int]:
        """Add a ring of points, with a row of weights each or one for all; their indices."""
        rows = np.broadcast_to(weights, (len(at), self.joints))
        return [self.point(p, w) for p, w in zip(at, rows, strict=True)]

    def quad(self, a: int, b: int, c: int, d: int, paint: int) -> None:
        """Add a face, counter-clockwise from outside."""
        self.faces.append((a, b, c, d))
        self.paints.append(paint)

    def loft(
        self,
        lower: Sequence[int],
        upper: Sequence[int],
        paint: int,
        *,
        skip: Sequence[int] = (),
    ) -> None:
        """Quads between two closed rings of equal size, but for the columns in ``skip``."""
        count = len(lower)
        for k in range(count):
            after = (k + 1) % count
            if k not in skip:
                self.quad(lower[k], lower[after], upper[after], upper[k], paint)

    def fan(self, ring: Sequence[int], tip: int, paint: int) -> None:
        """Triangles that close the end of a tube, from its last ``ring`` to the point ``tip``."""
        for k in range(len(ring)):
            self.quad(ring[k], ring[(k + 1) % len(ring)], tip, -1, paint)

    def smooth(
        self,
    ) -> tuple[
        Float[np.ndarray, "vertices 3"],
        Float[np.ndarray, "vertices joints"],
        Int[np.ndarray, "faces 4"],
        Int[np.ndarray, "faces"],
    ]:
        """Subdivided once: points, weights, quads and their paint."""
        table, faces = np.concatenate([self.points, self.weights], axis=1), np.array(self.faces)
        used = np.unique(faces[faces >= 0])  # all but what lies in the holes for the arms
        faces = np.where(faces < 0, -1, np.searchsorted(used, faces))
        table, quads, parent = subdivide(table[used], faces)
        return table[:, :3], table[:, 3:], quads, np.array(self.paints)[parent]


def subdivide(
    table: Float[np.ndarray, "vertices columns"], faces: Int[np.ndarray, "faces 4"]
) -> tuple[
    Float[np.ndarray, "finer columns"], Int[np.ndarray, "quads 4"], Int[np.ndarray, "quads"]
]:
    """One step of Catmull & Clark's subdivision of a closed mesh (1978).

    Parameters
    ----------
    table
        A row of anything for each vertex: places, weights; all are smoothed alike.
    faces
        Four corners each, or three and -1; every edge has two faces.

    Returns
    -------
    Rows of the finer vertices (vertices, then faces, then edges), its quads, and the face
    that each quad is a part of.
    """
    count, corners = len(table), np.where(faces[:, 3] < 0, 3, 4)
    face = np.repeat(np.arange(len(faces)), corners)
    first = np.repeat(np.cumsum(corners) - corners, corners)
    place = np.arange(len(face)) - first
    here = faces[face, place]
    ahead = faces[face, (place + 1) % corners[face]]
    pair = np.sort(np.stack([here, ahead], axis=1), axis=1)
    edges, edge = np.unique(pair, axis=0, return_inverse=True)
    edge = edge.reshape(-1)
    if not (np.bincount(edge) == 2).all():
        raise AssertionError("a cage must be closed: every edge between two faces")
    center = _sums(face, table[here], len(faces)) / corners[:, None]
    middle = table[edges].mean(axis=1)
    on_edge = 0.5 * (middle + 0.5 * _sums(edge, center[face], len(edges)))
    valence = np.bincount(here, minlength=count)[:, None]
    around = _sums(here, center[face], count) / valence
    ends = np.concatenate([edges[:, 0], edges[:, 1]])
    beside = _sums(ends, np.concatenate([middle, middle]), count) / valence
    moved = (around + 2.0 * beside + (valence - 3.0) * table) / valence
    before = first + (place - 1) % corners[face]
    quads = np.stack(
        [here, count + len(faces) + edge, count + face, count + len(faces) + edge[before]], axis=1
    )
    return np.concatenate([moved, center, on_edge]), quads, face


def _sums(
    index: Int[np.ndarray, "n"], rows: Float[np.ndarray, "n columns"], count: int
) -> Float[np.ndarray, "count columns"]:
    """Sum of the ``rows`` that have the same ``index``."""
    order = np.argsort(index, kind="stable")
    start = np.searchsorted(index[order], np.arange(count))
    return np.add.reduceat(rows[order], start, axis=0)
