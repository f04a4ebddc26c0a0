"""How slopes change steps: shorter, downhill most, and slower, [SM01] Eqs. 11-12."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import smoothstep
from gaitsmith.plan.slope_steps import BLEND, DOWNHILL, UPHILL

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground import Ground
    from gaitsmith.plan.paths import Path

#: The lines are of streets; beyond so many degrees they are not trusted.
STEEPEST = 20.0
#: Loss of preferred speed per degree: uphill up to 5 deg and beyond, downhill.
SLOWER_UP, SLOWER_STEEP, SLOWER_DOWN = 0.01, 0.02, 0.007


def step_length_share(slope: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """Preferred step length on a slope (rise per meter along the walk) over that on the level.

    [SM01] Eqs. 11-12 over what they say of level ground, so that who walks with longer steps
    keeps them longer.
    """
    degrees = np.clip(np.degrees(np.arctan(slope)), -STEEPEST, STEEPEST)
    down = DOWNHILL[0] + DOWNHILL[1] * degrees
    up = UPHILL[0] + UPHILL[1] * degrees
    share = smoothstep(0.5 + 0.5 * degrees / BLEND)
    return (down + share * (up - down)) / (0.5 * (DOWNHILL[0] + UPHILL[0]))


def speed_share(slope: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """Preferred speed on a slope over that on the level."""
    degrees = np.clip(np.degrees(np.arctan(slope)), -STEEPEST, STEEPEST)
    up = np.maximum(degrees, 0.0)
    loss = SLOWER_UP * np.minimum(up, 5.0) + SLOWER_STEEP * np.maximum(up - 5.0, 0.0)
    return 1.0 - loss - SLOWER_DOWN * np.maximum(-degrees, 0.0)


def slope_along(
    path: Path, ground: Ground, s: Float[np.ndarray, "n"], reach: float
) -> Float[np.ndarray, "n"]:
    """Rise per meter of ``ground`` along ``path``, over ``reach`` meters around ``s``."""
    before, after = (path.at(s + d) for d in (-0.5 * reach, 0.5 * reach))
    rise = ground.height(after[:, 0], after[:, 1]) - ground.height(before[:, 0], before[:, 1])
    way = np.sqrt(((after - before) ** 2).sum(-1))
    return rise / np.maximum(way, 1e-6)
