"""Distances between segments in space, and from segments to polygons seen from above."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

#: Squared lengths below this are those of points.
NOTHING = 1e-18


def segments_apart(
    a: Float[np.ndarray, "*n d"],
    b: Float[np.ndarray, "*n d"],
    c: Float[np.ndarray, "*n d"],
    d: Float[np.ndarray, "*n d"],
) -> Float[np.ndarray, "*n"]:
    """Distance of the segments a-b and c-d, in the plane or in space; either may be a point.

    The arrays are broadcast against each other. Closest points as in C. Ericson, *Real-Time
    Collision Detection*, 2005, section 5.1.9.
    """
    one, other, gap = b - a, d - c, a - c
    size, other_size = _dot(one, one), _dot(other, other)
    along, along_other, both = _dot(one, gap), _dot(other, gap), _dot(one, other)
    point, other_point = size < NOTHING, other_size < NOTHING
    size, other_size = np.maximum(size, NOTHING), np.maximum(other_size, NOTHING)
    free = size * other_size - both * both
    crossed = free > 1e-12 * size * other_size
    s = np.where(crossed, both * along_other - along * other_size, 0.0)
    s = np.clip(s / np.where(crossed, free, 1.0), 0.0, 1.0)
    t = np.where(other_point, 0.0, (both * s + along_other) / other_size)
    kept = np.clip(t, 0.0, 1.0)
    back = np.clip((both * kept - along) / size, 0.0, 1.0)
    s = np.where(point, 0.0, np.where((t != kept) | other_point, back, s))
    between = gap + s[..., None] * one - kept[..., None] * other
    return np.sqrt(_dot(between, between))


def inside_polygon(
    points: Float[np.ndarray, "*n 2"], corners: Float[np.ndarray, "m 2"]
) -> Bool[np.ndarray, "*n"]:
    """Whether points lie inside a simple polygon: an odd number of its edges is to one side."""
    begin, end = corners, np.roll(corners, -1, axis=0)
    x, y = points[..., None, 0], points[..., None, 1]
    across = (begin[:, 1] > y) != (end[:, 1] > y)
    rise = np.where(across, end[:, 1] - begin[:, 1], 1.0)
    at = begin[:, 0] + (y - begin[:, 1]) * (end[:, 0] - begin[:, 0]) / rise
    return (across & (x < at)).sum(axis=-1) % 2 == 1


def polygon_apart(
    a: Float[np.ndarray, "*n 2"], b: Float[np.ndarray, "*n 2"], corners: Float[np.ndarray, "m 2"]
) -> Float[np.ndarray, "*n"]:
    """Distance of segments from a simple polygon; below 0, how deep the deeper end is inside."""
    begin, end = corners, np.roll(corners, -1, axis=0)
    near = segments_apart(a[..., None, :], b[..., None, :], begin, end).min(axis=-1)
    deep = np.zeros(near.shape)
    for point in (a, b):
        depth = segments_apart(point[..., None, :], point[..., None, :], begin, end).min(axis=-1)
        deep = np.maximum(deep, np.where(inside_polygon(point, corners), depth, 0.0))
    return np.where(deep > 0.0, -deep, near)


def _dot(
    one: Float[np.ndarray, "*n d"], other: Float[np.ndarray, "*n d"]
) -> Float[np.ndarray, "*n"]:
    return (one * other).sum(axis=-1)
