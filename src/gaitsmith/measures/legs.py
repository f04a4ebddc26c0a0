"""Knees and the room between the legs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float

#: Meters that a knee may lie behind the line from hip to ankle and still be called straight.
_STRAIGHT = 1e-3


def knee_flexion(
    hip: Float[np.ndarray, "F 3"], knee: Float[np.ndarray, "F 3"], ankle: Float[np.ndarray, "F 3"]
) -> Float[np.ndarray, "F"]:
    """Angle between thigh and shin, radians, 0 for a straight leg; without a sign."""
    thigh, shin = knee - hip, ankle - knee
    return np.arctan2(np.linalg.norm(np.cross(thigh, shin), axis=-1), (thigh * shin).sum(-1))


def backward(
    hip: Float[np.ndarray, "F 3"],
    knee: Float[np.ndarray, "F 3"],
    ankle: Float[np.ndarray, "F 3"],
    ahead: Float[np.ndarray, "F 3"],
) -> Float[np.ndarray, "F"]:
    """By how much a knee is bent the wrong way, radians, else 0.

    Wrong is a knee more than 1 mm behind the middle between hip and ankle, along ``ahead``.
    """
    bulge = ((knee - 0.5 * (hip + ankle)) * ahead).sum(-1)
    return np.where(bulge < -_STRAIGHT, knee_flexion(hip, knee, ankle), 0.0)


def segment_gap(
    a: Float[np.ndarray, "*n 3"],
    b: Float[np.ndarray, "*n 3"],
    c: Float[np.ndarray, "*n 3"],
    d: Float[np.ndarray, "*n 3"],
) -> Float[np.ndarray, "*n"]:
    """Shortest distance between the segments ``ab`` and ``cd``, meters.

    Ericson, *Real-Time Collision Detection*, section 5.1.9: the nearest points of the lines,
    brought back to the segments one after the other.
    """
    u, v, w = b - a, d - c, a - c
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    uu, vv = np.maximum(uu, 1e-12), np.maximum(vv, 1e-12)
    cross = uu * vv - uv * uv
    parallel = cross <= 1e-12 * uu * vv
    s = np.where(
        parallel, 0.0, np.clip((uv * vw - uw * vv) / np.where(parallel, 1.0, cross), 0.0, 1.0)
    )
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    return np.linalg.norm(w + s[..., None] * u - t[..., None] * v, axis=-1)
