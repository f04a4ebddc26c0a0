"""Distances in the plane of the ground, x,z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float


def feet_apart(
    ankle: Float[np.ndarray, "n 2"],
    heading: Float[np.ndarray, "n"],
    stand: Float[np.ndarray, "n 2"],
    stand_heading: Float[np.ndarray, "n"],
    *,
    back: float,
    front: float,
) -> Float[np.ndarray, "n"]:
    """Distance of two foot axes seen from above, heel to toe tip, meters; 0 where they cross."""
    one = np.stack([np.sin(heading), np.cos(heading)], axis=-1)
    two = np.stack([np.sin(stand_heading), np.cos(stand_heading)], axis=-1)
    a, b = ankle - back * one, ankle + front * one
    c, d = stand - back * two, stand + front * two
    nearest = np.minimum(
        np.minimum(_to_segment(a, c, d), _to_segment(b, c, d)),
        np.minimum(_to_segment(c, a, b), _to_segment(d, a, b)),
    )

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return np.sign((q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0])

    cross = (side(a, b, c) != side(a, b, d)) & (side(c, d, a) != side(c, d, b))
    return np.where(cross, 0.0, nearest)


def _to_segment(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> Float[np.ndarray, "n"]:
    line = b - a
    t = np.clip(((p - a) * line).sum(-1) / (line * line).sum(-1), 0.0, 1.0)
    return np.linalg.norm(p - a - t[:, None] * line, axis=-1)
