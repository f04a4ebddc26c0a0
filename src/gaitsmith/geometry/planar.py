"""Distances in the plane of the ground, x,z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.angles import sine_cosine

if TYPE_CHECKING:
    from jaxtyping import Float

    _Point = tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]


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
    # x and z apart: rows of two are slow to work on
    sin, cos = sine_cosine(heading)
    stand_sin, stand_cos = sine_cosine(stand_heading)
    a = (ankle[:, 0] - back * sin, ankle[:, 1] - back * cos)
    b = (ankle[:, 0] + front * sin, ankle[:, 1] + front * cos)
    c = (stand[:, 0] - back * stand_sin, stand[:, 1] - back * stand_cos)
    d = (stand[:, 0] + front * stand_sin, stand[:, 1] + front * stand_cos)
    nearest = np.minimum(
        np.minimum(_to_segment(a, c, d), _to_segment(b, c, d)),
        np.minimum(_to_segment(c, a, b), _to_segment(d, a, b)),
    )

    def side(p: _Point, q: _Point, r: _Point) -> Float[np.ndarray, "n"]:
        return np.sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    cross = (side(a, b, c) != side(a, b, d)) & (side(c, d, a) != side(c, d, b))
    return np.where(cross, 0.0, nearest)


def _to_segment(p: _Point, a: _Point, b: _Point) -> Float[np.ndarray, "n"]:
    x, z = b[0] - a[0], b[1] - a[1]
    px, pz = p[0] - a[0], p[1] - a[1]
    t = np.clip((px * x + pz * z) / (x * x + z * z), 0.0, 1.0)
    return np.sqrt((px - t * x) ** 2 + (pz - t * z) ** 2)
