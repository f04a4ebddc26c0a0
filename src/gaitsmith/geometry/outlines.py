"""Outlines on the floor: simple polygons, checked."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.solids import segments_apart

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jaxtyping import Float

#: Outlines smaller than this (square meters) and things thinner (meters) are none.
SMALLEST, THINNEST = 1e-6, 1e-4


def simple_outline(
    what: str, points: Iterable[Iterable[float]], *, most: int, farthest: float
) -> tuple[tuple[float, float], ...]:
    """Corners of ``what``, in order, without the first one again at the end.

    Raises
    ------
    InvalidInputError
        If they are no points, farther than ``farthest`` meters, fewer than 3 or more than
        ``most``, or their polygon crosses itself or encloses nothing.
    """
    try:
        corners = tuple((float(x), float(z)) for x, z in points)
    except (TypeError, ValueError):
        raise InvalidInputError(
            f"the corners of {what} must be points x,z, got {points!r}"
        ) from None
    for i, (x, z) in enumerate(corners, start=1):
        within(f"corner {i} of {what}", x, z, farthest)
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners = corners[:-1]
    if not 3 <= len(corners) <= most:
        raise InvalidInputError(
            f"the outline of {what} needs 3 to {most} corners, got {len(corners)}"
        )
    ring = np.array(corners)
    following = np.roll(ring, -1, axis=0)
    area = 0.5 * float((ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum())
    same = np.flatnonzero(np.abs(ring - following).max(axis=1) < THINNEST)
    if same.size:
        x, z = corners[int(same[0])]
        raise InvalidInputError(
            f"the outline of {what} has the corner ({x:g}, {z:g}) twice; remove one"
        )
    crossing = _crossing(ring)
    if crossing is not None:
        raise InvalidInputError(
            f"the outline of {what} crosses itself: its sides after corners {crossing[0]} "
            f"and {crossing[1]} meet; give the corners in order around it"
        )
    if abs(area) < SMALLEST:
        raise InvalidInputError(f"the outline of {what} encloses nothing; it is a line")
    return corners


def within(what: str, x: float, z: float, farthest: float) -> None:
    """Raise InvalidInputError where x,z is farther than ``farthest`` meters from 0,0."""
    if not (math.isfinite(x) and math.isfinite(z) and max(abs(x), abs(z)) <= farthest):
        raise InvalidInputError(f"{what} must be within {farthest:g} m of 0,0, got {x:g},{z:g}")


def _crossing(corners: Float[np.ndarray, "n 2"]) -> tuple[int, int] | None:
    """Two sides of a polygon that meet without being neighbors, counted from 1."""
    begin, end = corners, np.roll(corners, -1, axis=0)
    count = len(corners)
    for i in range(count - 1):
        others = np.arange(i + 1, count)
        others = others[(others > i + 1) & ~((i == 0) & (others == count - 1))]
        if others.size:
            near = segments_apart(begin[i], end[i], begin[others], end[others])
            if near.min() < 1e-9:
                return i + 1, int(others[near.argmin()]) + 1
    return None
