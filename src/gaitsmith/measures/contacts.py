"""How soles keep to the ground while they bear: slip, penetration, height."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int


def runs(flags: Bool[np.ndarray, "F"]) -> Int[np.ndarray, "n 2"]:
    """``[first, last)`` of every unbroken run of True."""
    edges = np.diff(np.concatenate([[0], flags.astype(np.int8), [0]]))
    return np.flatnonzero(edges).reshape(-1, 2)


def gone(
    soles: Float[np.ndarray, "F 2 3 d"], down: Bool[np.ndarray, "F 2 3"]
) -> Float[np.ndarray, "F 2 3"]:
    """How far each sole point is from where its contact began, meters; 0 without contact."""
    starts = down.copy()
    starts[1:] &= ~down[:-1]
    frames = np.arange(len(down))[:, None, None]
    began = np.maximum.accumulate(np.where(starts, frames, 0), axis=0)
    out = np.linalg.norm(soles - np.take_along_axis(soles, began[..., None], axis=0), axis=-1)
    return np.where(down, out, 0.0)


def slips(
    soles: Float[np.ndarray, "F 2 3 d"],
    down: Bool[np.ndarray, "F 2 3"],
    bearing: Bool[np.ndarray, "F 2"],
) -> Float[np.ndarray, "n"]:
    """Largest slip of a sole point in each stance, a run of ``bearing``, of either foot, meters."""
    far = gone(soles, down).max(axis=-1)
    return np.array([far[a:b, side].max() for side in range(2) for a, b in runs(bearing[:, side])])


def heights(
    above: Float[np.ndarray, "F 2 3"], down: Bool[np.ndarray, "F 2 3"], *, exact: bool
) -> Float[np.ndarray, "n"]:
    """Height over the ground of each foot in each frame in which it bears, meters.

    With ``exact`` contacts that of the highest point that bears; with estimated ones that of
    the lowest, for one point on the ground is all that is known.
    """
    bears = down.any(-1)
    chosen = np.where(down, above, -np.inf if exact else np.inf)
    return (chosen.max(-1) if exact else chosen.min(-1))[bears]
