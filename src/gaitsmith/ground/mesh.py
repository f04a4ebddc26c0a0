"""A triangle mesh looked at from above, as a height field."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground.heightfield import MOST_SAMPLES, HeightField

if TYPE_CHECKING:
    from collections.abc import Generator

    from jaxtyping import Float, Int

#: Meters between samples at most; so far below its lowest point a mesh is open where no triangle
#: lies, so that nobody is led over a hole.
CELL, PIT = 0.02, 1.0
#: Samples of a triangle at once; places this near its border (in cells) belong to it.
_AT_ONCE, _BORDER = 1_000_000, 1e-6
#: Digits of heights: a hundredth of a millimeter.
_DIGITS = 5


def field_from_mesh(
    corners: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"], *, cell: float = CELL
) -> HeightField:
    """Height field of the highest triangle above each sample.

    Parameters
    ----------
    corners
        ``(V, 3)`` world x, y, z, meters.
    triangles
        ``(T, 3)`` indices of corners; upright ones are not seen from above.
    cell
        Most meters between samples; it is made to fit the width along X.

    Raises
    ------
    InvalidInputError
        If nothing is seen from above, or the mesh has too many samples.
    """
    used = corners[np.unique(triangles)]
    low, high = used.min(axis=0), used.max(axis=0)
    width, length = float(high[0] - low[0]), float(high[2] - low[2])
    if min(width, length) < 2.0 * cell:
        raise InvalidInputError(
            f"seen from above the mesh is {width:g} m x {length:g} m, too small to stand on: "
            "lengths are meters and +Y is up"
        )
    columns = math.ceil(width / cell - 1e-9) + 1
    fitted = width / (columns - 1)
    rows = math.floor(length / fitted + 1e-9) + 1
    if rows * columns > MOST_SAMPLES:
        raise InvalidInputError(
            f"the mesh is {width:.1f} m x {length:.1f} m, in cells of {cell:g} m that is more "
            f"than {MOST_SAMPLES:.0e} samples; cut out the part that is walked on"
        )
    heights = np.full(rows * columns, -np.inf)
    at = (corners[triangles] - [low[0], 0.0, low[2]]) / [fitted, 1.0, fitted]
    for index, height in _samples(at, rows, columns):
        np.maximum.at(heights, index, height)
    open_ = np.isneginf(heights)
    if open_.all():
        raise InvalidInputError("all triangles of the mesh are upright: no ground from above")
    heights[open_] = heights[~open_].min() - PIT
    return HeightField(
        np.round(heights.reshape(rows, columns), _DIGITS),
        fitted,
        (float(low[0]), float(low[2])),
    )


def _samples(
    triangles: Float[np.ndarray, "T 3 3"], rows: int, columns: int
) -> Generator[tuple[Int[np.ndarray, "k"], Float[np.ndarray, "k"]]]:
    """Flat index and height of all samples over each triangle, in parts.

    Corners are (column, height, row) in cells. First the rows that each triangle meets, then
    the columns between its two borders in each.
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 2] - a[:, 2]) - (c[:, 0] - a[:, 0]) * (b[:, 2] - a[:, 2])
    triangles = triangles[np.abs(area) > 1e-9]
    first = np.ceil(triangles[..., 2].min(axis=1) - _BORDER).astype(np.int64).clip(0, rows)
    last = np.floor(triangles[..., 2].max(axis=1) + _BORDER).astype(np.int64).clip(-1, rows - 1)
    for which, row in _spread(first, last):
        own = triangles[which]
        begin, end = _borders(own, row)
        left = np.ceil(begin - _BORDER).astype(np.int64).clip(0, columns)
        right = np.floor(end + _BORDER).astype(np.int64).clip(-1, columns - 1)
        for strip, column in _spread(left, right):
            height = _plane_height(own[strip], column, row[strip])
            yield row[strip] * columns + column, height


def _spread(
    first: Int[np.ndarray, "n"], last: Int[np.ndarray, "n"]
) -> Generator[tuple[Int[np.ndarray, "k"], Int[np.ndarray, "k"]]]:
    """All (which, value) with ``first <= value <= last``, a bounded number at once."""
    count = np.maximum(last - first + 1, 0)
    total = np.cumsum(count)
    done, begin = 0, 0
    while begin < len(count):
        end = max(int(np.searchsorted(total, done + _AT_ONCE, side="right")), begin + 1)
        part = count[begin:end]
        which = np.repeat(np.arange(begin, end), part)
        value = np.arange(len(which)) - np.repeat(np.cumsum(part) - part, part) + first[which]
        yield which, value
        done, begin = int(total[end - 1]), end


def _borders(
    triangles: Float[np.ndarray, "k 3 3"], row: Int[np.ndarray, "k"]
) -> tuple[Float[np.ndarray, "k"], Float[np.ndarray, "k"]]:
    """Least and largest column of each triangle in its row."""
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = triangles[:, i], triangles[:, j]
        span = b[:, 2] - a[:, 2]
        met = (np.minimum(a[:, 2], b[:, 2]) - _BORDER <= row) & (
            row <= np.maximum(a[:, 2], b[:, 2]) + _BORDER
        )
        level = np.abs(span) < 1e-12
        share = np.clip((row - a[:, 2]) / np.where(level, 1.0, span), 0.0, 1.0)
        column = a[:, 0] + share * (b[:, 0] - a[:, 0])
        least = np.where(level, np.minimum(a[:, 0], b[:, 0]), column)
        most = np.where(level, np.maximum(a[:, 0], b[:, 0]), column)
        low = np.where(met, np.minimum(low, least), low)
        high = np.where(met, np.maximum(high, most), high)
    return low, high


def _plane_height(
    triangles: Float[np.ndarray, "k 3 3"], column: Int[np.ndarray, "k"], row: Int[np.ndarray, "k"]
) -> Float[np.ndarray, "k"]:
    """Height of each triangle's plane there, never beyond its corners."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    ux, uy, uz = (b - a).T
    vx, vy, vz = (c - a).T
    area = ux * vz - vx * uz
    px, pz = column - a[:, 0], row - a[:, 2]
    height = a[:, 1] + ((px * vz - vx * pz) * uy + (ux * pz - px * uz) * vy) / area
    y = triangles[..., 1]
    return np.clip(height, y.min(axis=1), y.max(axis=1))
