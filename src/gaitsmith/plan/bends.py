"""Curves of arcs and straight lines from one place and heading to another: Dubins' ways."""

from __future__ import annotations

import numpy as np

from gaitsmith.plan.paths import Path

#: A piece of a curve: length (m) and turn (rad, left positive), as of ``Path.of_turns``.
Pieces = list[tuple[float, float]]


def bends_between(
    begin: np.ndarray, heading: float | None, end: np.ndarray, arrival: float | None, radius: float
) -> list[Path]:
    """Arc, line, arc from ``begin`` to ``end``; a heading that is None is the line's own.

    The four ways that turn left or right at each end with a radius of ``radius`` meters; those
    that turn by more than 200 deg at one end are left out.
    """
    out = []
    for first in (0.0,) if heading is None else (1.0, -1.0):
        for last in (0.0,) if arrival is None else (1.0, -1.0):
            found = _tangent(begin, heading, end, arrival, radius, first, last)
            if found is not None:
                out.append(found)
    return out


def _left(heading: float) -> np.ndarray:
    return np.array([np.cos(heading), -np.sin(heading)])


def _tangent(
    begin: np.ndarray,
    heading: float | None,
    end: np.ndarray,
    arrival: float | None,
    radius: float,
    first: float,
    last: float,
) -> Path | None:
    """The curve whose arcs turn to the sides ``first`` and ``last`` (+1 left); 0: no arc."""
    one = begin if heading is None else begin + first * radius * _left(heading)
    two = end if arrival is None else end + last * radius * _left(arrival)
    gap = two - one
    size = float(np.hypot(*gap))
    # the line keeps the centers at their distance on its left: first * radius, last * radius
    apart = (last if arrival is not None else 0.0) - (first if heading is not None else 0.0)
    apart *= radius
    if size <= abs(apart) or size < 1e-9:
        return None
    line = float(np.arctan2(*gap)) - float(np.arcsin(apart / size))
    straight = float(np.sqrt(size**2 - apart**2))
    pieces: Pieces = []
    facing = line if heading is None else heading
    for side, turn in ((first, line - facing), (last, (arrival or 0.0) - line)):
        if side == 0.0:
            part = (0.0, 0.0)
        else:
            angle = float(np.mod(side * turn, 2.0 * np.pi))
            if angle > 2.0 * np.pi - 1e-9:
                angle = 0.0
            if angle > np.radians(200.0):
                return None
            part = (radius * angle, side * angle)
        pieces.append(part)
    kept = [p for p in (pieces[0], (straight, 0.0), pieces[1]) if p[0] > 1e-6]
    if not kept:
        return None
    return Path.of_turns(kept, origin=(float(begin[0]), float(begin[1])), heading=facing)
