"""Edges of a ground near places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground.edges import Edges
    from gaitsmith.ground.model import Ground


def edges_near(ground: Ground, x: float, z: float, reach: float) -> Edges:
    """Edges of ``ground`` in the square of ``reach`` meters around ``(x, z)``."""
    return ground.edges((x - reach, z - reach), (x + reach, z + reach))


def edge_distance(
    ground: Ground, places: Float[np.ndarray, "*n 2"], reach: float
) -> Float[np.ndarray, "*n"]:
    """Meters, seen from above, from x,z ``places`` to the nearest edge; inf beyond ``reach``."""
    places = np.asarray(places, dtype=np.float64)
    if not ground.stepped or places.size == 0:
        return np.full(places.shape[:-1], np.inf)
    flat = places.reshape(-1, 2)
    (x0, z0), (x1, z1) = flat.min(axis=0).tolist(), flat.max(axis=0).tolist()
    near = ground.edges((x0 - reach, z0 - reach), (x1 + reach, z1 + reach))
    found = near.distance(places)
    return np.where(found <= reach, found, np.inf)
