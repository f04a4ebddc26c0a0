"""Paths: smooth plane curves that know their points, headings and curvatures by arc length.

``Path.through`` (C2 spline), ``Path.rounded`` (polyline with round corners), ``Path.arc``,
``Path.figure_eight`` and ``Path.line``; :mod:`gaitsmith.plan.where` reads points from files.
Points are ``(x, z)``, headings as everywhere: 0 faces +Z, positive turns left, to +X.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, number, positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.curves import hermite
from gaitsmith.geometry.splines import Spline, natural_spline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

#: Points of a path nearer than this are the same point, meters.
SAME = 1e-6
#: Points off one line by less than this make a straight path, meters.
COLLINEAR = 1e-9
#: Nodes lie this part of the radius apart, and at most so far (m): headings to 1e-7 rad.
NODE_ANGLE, NODE_SPACING = 0.02, 0.05
#: Longest path, meters, and most points.
LONGEST, MOST_POINTS = 1e5, 100_000


@dataclass(frozen=True, eq=False)
class Path:
    """A plane curve by arc length: nodes that are read by cubics between.

    Before its beginning and after its end a path goes straight on.

    Attributes
    ----------
    along
        ``(K,)`` arc length of the nodes, from 0, meters.
    points
        ``(K, 2)`` x,z, meters.
    heading
        ``(K,)`` of the tangent, unwrapped, radians.
    curvature
        ``(K,)`` change of heading per meter, left positive.
    """

    along: Float[np.ndarray, "K"]
    points: Float[np.ndarray, "K 2"]
    heading: Float[np.ndarray, "K"]
    curvature: Float[np.ndarray, "K"]

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.along)
        for name, shape in (
            ("along", (count,)),
            ("points", (count, 2)),
            ("heading", (count,)),
            ("curvature", (count,)),
        ):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape))
        if count < 2 or self.along[0] != 0.0 or (np.diff(self.along) < 0.0).any():
            raise InvalidInputError("along must rise from 0 over at least two nodes")

    # ------------------------------------------------------------------------ shapes

    @staticmethod
    def line(
        length: float, *, origin: tuple[float, float] = (0.0, 0.0), heading: float = 0.0
    ) -> Path:
        """Straight ahead over ``length`` meters."""
        length = _checked_length(positive("length", length, "meters"))
        heading = number("heading", heading, "radians")
        first = np.array([number("origin", v, "meters") for v in origin])
        way = np.array([np.sin(heading), np.cos(heading)])
        return Path(
            along=np.array([0.0, length]),
            points=np.stack([first, first + length * way]),
            heading=np.full(2, heading),
            curvature=np.zeros(2),
        )

    @staticmethod
    def through(points: Sequence[Sequence[float]] | Float[np.ndarray, "n 2"]) -> Path:
        """The C2 curve through ``points`` in their order: a natural cubic spline.

        Its parameter is the length of the chords. Points on one line, each ahead of the last,
        make the straight line from the first to the last.
        """
        given = checked_points(points)
        straight = _straight(given)
        return straight if straight is not None else _spline_path(natural_spline(given))

    @staticmethod
    def rounded(
        points: Sequence[Sequence[float]] | Float[np.ndarray, "n 2"], *, radius: float = 0.6
    ) -> Path:
        """Straight from point to point, each corner cut by an arc of ``radius`` meters.

        A corner between short legs gets the largest radius that fits.
        """
        given = checked_points(points)
        radius = positive("radius", radius, "meters")
        straight = _straight(given)
        if straight is not None:
            return straight
        legs = np.diff(given, axis=0)
        lengths = np.linalg.norm(legs, axis=1)
        headings = np.arctan2(legs[:, 0], legs[:, 1])
        pieces: list[tuple[float, float]] = []  # (length, turn)
        cut = 0.0
        for i, (a, b) in enumerate(pairwise(headings)):
            turn = float(np.arctan2(np.sin(b - a), np.cos(b - a)))
            if abs(turn) > np.pi - 1e-6:
                raise InvalidInputError(
                    f"point {i + 2} of the path turns back on itself; no arc rounds that: set "
                    "two points where the turn should be"
                )
            room = 0.5 * min(lengths[i], lengths[i + 1])
            if i == 0:
                room = min(lengths[i], 0.5 * lengths[i + 1])
            if i + 2 == len(lengths):
                room = min(0.5 * lengths[i] if i else lengths[i], lengths[i + 1])
            tangent = min(radius * np.tan(0.5 * abs(turn)), float(room))
            pieces.append((float(lengths[i] - cut - tangent), 0.0))
            if abs(turn) > 1e-12:
                pieces.append((tangent / np.tan(0.5 * abs(turn)) * abs(turn), turn))
            cut = tangent
        pieces.append((float(lengths[-1] - cut), 0.0))
        return Path.of_turns(pieces, origin=tuple(given[0]), heading=float(headings[0]))

    @staticmethod
    def arc(
        radius: float,
        turn: float,
        *,
        origin: tuple[float, float] = (0.0, 0.0),
        heading: float = 0.0,
    ) -> Path:
        """Part of a circle: ``turn`` radians of it (may exceed a full circle), left positive."""
        radius, turn = positive("radius", radius, "meters"), number("turn", turn, "radians")
        if turn == 0.0:
            raise InvalidInputError("turn must not be 0 radians; a straight path is Path.line")
        return Path.of_turns([(radius * abs(turn), turn)], origin=origin, heading=heading)

    @staticmethod
    def of_turns(
        pieces: Sequence[tuple[float, float]],
        *,
        origin: Sequence[float] = (0.0, 0.0),
        heading: float = 0.0,
    ) -> Path:
        """Lines and arcs one after the other: pairs of length (m) and turn (rad, left positive)."""
        here = np.array([number("origin", v, "meters") for v in origin])
        facing, done = number("heading", heading, "radians"), 0.0
        along, points, headings, curvature = [], [], [], []
        for i, (length, turn) in enumerate(pieces):
            length, turn = number(f"piece {i}", length, "meters"), float(turn)
            if length <= SAME:
                continue
            bend = turn / length
            count = max(1, int(np.ceil(abs(turn) / NODE_ANGLE)))
            s = np.linspace(0.0, length, count + 1)
            turned = facing + bend * s
            if turn:
                x = (np.cos(facing) - np.cos(turned)) / bend
                z = (np.sin(turned) - np.sin(facing)) / bend
            else:
                x, z = s * np.sin(facing), s * np.cos(facing)
            along.append(done + s)
            points.append(here + np.stack([x, z], axis=-1))
            headings.append(turned)
            curvature.append(np.full(count + 1, bend))
            here, facing, done = points[-1][-1], float(turned[-1]), done + length
        if not along:
            raise InvalidInputError("the path has no length")
        _checked_length(done)
        return Path(*(np.concatenate(part) for part in (along, points, headings, curvature)))

    @staticmethod
    def figure_eight(
        size: float, *, origin: tuple[float, float] = (0.0, 0.0), heading: float = 0.0
    ) -> Path:
        """A closed eight, ``size`` meters long and half as wide, crossed in its middle.

        It begins and ends in the crossing (Gerono's lemniscate, turned so that it leaves at
        ``heading``).
        """
        size, heading = positive("size", size, "meters"), number("heading", heading, "radians")
        t = np.linspace(0.0, 2.0 * np.pi, 97)
        x, z = 0.25 * size * np.sin(2.0 * t), 0.5 * size * np.sin(t)
        turn = heading - np.pi / 4.0
        c, s = np.cos(turn), np.sin(turn)
        eight = np.stack([c * x + s * z, c * z - s * x], axis=-1) + np.asarray(origin)
        return _spline_path(natural_spline(eight))

    # ----------------------------------------------------------------------- reading

    @property
    def length(self) -> float:
        """Meters."""
        return float(self.along[-1])

    @property
    def straight(self) -> bool:
        """Whether it is one straight line."""
        return not self.curvature.any() and not np.ptp(self.heading)

    def at(self, along: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 2"]:
        """Points at arc lengths, straight on before and after the path."""
        along = np.asarray(along, dtype=np.float64)
        first, last = self._ends()
        if self.straight:
            return self.points[0] + along[:, None] * first
        out = hermite(self.along, self.points, self._tangent, along)
        before, after = np.minimum(along, 0.0), np.maximum(along - self.length, 0.0)
        return out + before[:, None] * first + after[:, None] * last

    @cached_property
    def _tangent(self) -> Float[np.ndarray, "K 2"]:
        return np.stack(sine_cosine(self.heading), axis=-1)

    def heading_at(self, along: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Headings at arc lengths, unwrapped."""
        along = np.asarray(along, dtype=np.float64)
        if self.straight:
            return np.full(len(along), self.heading[0])
        # between nodes the curvature is as good as constant: no overshoot where it jumps
        return np.interp(along, self.along, self.heading)

    def _ends(self) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        first, last = (np.array([np.sin(h), np.cos(h)]) for h in self.heading[[0, -1]])
        return first, last

    def turned(self, start: Float[np.ndarray, "n"], end: Float[np.ndarray, "n"]) -> np.ndarray:
        """Mean curvature between arc lengths, per meter."""
        return (self.heading_at(end) - self.heading_at(start)) / (end - start)


def checked_points(
    points: Sequence[Sequence[float]] | Float[np.ndarray, "n 2"],
) -> Float[np.ndarray, "n 2"]:
    """Points of a path: at least two, finite, no two in a row the same."""
    given = frozen_array("path", np.asarray(points, dtype=np.float64), (None, 2))
    if len(given) < 2:
        raise InvalidInputError(f"a path needs at least two points, got {len(given)}")
    if len(given) > MOST_POINTS:
        raise InvalidInputError(f"a path may have {MOST_POINTS} points, got {len(given)}")
    same = np.flatnonzero(np.linalg.norm(np.diff(given, axis=0), axis=1) < SAME)
    if same.size:
        i = int(same[0])
        raise InvalidInputError(
            f"points {i + 1} and {i + 2} of the path are the same, "
            f"({given[i, 0]:g}, {given[i, 1]:g}); remove one of them"
        )
    return given


def _checked_length(length: float) -> float:
    if length > LONGEST:
        raise InvalidInputError(f"a path of {length:g} m is longer than {LONGEST:g} m")
    return length


def _straight(points: Float[np.ndarray, "n 2"]) -> Path | None:
    """The line through ``points`` if each lies ahead of the last on one."""
    first, whole = points[0], points[-1] - points[0]
    length = float(np.hypot(*whole))
    if length <= SAME:
        return None
    way = whole / length
    rest = points - first
    ahead, aside = rest @ way, rest @ np.array([way[1], -way[0]])
    if np.abs(aside).max() > COLLINEAR or (np.diff(ahead) <= 0.0).any():
        return None
    return Path.line(
        length, origin=(float(first[0]), float(first[1])), heading=float(np.arctan2(*way))
    )


def _spline_path(spline: Spline) -> Path:
    """A spline on nodes close enough for its curvature."""
    knots = spline.knots
    gaps = np.diff(knots)
    inside = knots[:-1, None] + gaps[:, None] * (np.arange(17) / 16.0)
    bends = np.abs(spline.curvature(inside.ravel())).reshape(inside.shape).max(axis=1)
    spacing = np.minimum(NODE_SPACING, NODE_ANGLE / np.maximum(bends, 1e-9))
    counts = np.clip(np.ceil(gaps / spacing), 1, 2000).astype(np.int64)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(counts.sum()) - first) / np.repeat(counts, counts)
    u = np.append(np.repeat(knots[:-1], counts) + share * np.repeat(gaps, counts), knots[-1])
    along = spline.arc_length(u)
    _checked_length(float(along[-1]))
    tangent = spline.derivative(u)
    heading = np.unwrap(np.arctan2(tangent[:, 0], tangent[:, 1]))
    return Path(along=along, points=spline.at(u), heading=heading, curvature=spline.curvature(u))
