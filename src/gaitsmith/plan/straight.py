"""Footsteps along a straight line: from standing or walking, over a distance, to a stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.conventions import SIDE_SIGN, ahead, leftward
from gaitsmith.plan.follow import follow
from gaitsmith.plan.lengths import (
    EASED_DURATION,
    FIRST_STEP,
    LEAST_DEFICIT,
    MOST_STEPS,
    PATH_SPACING,
    SHARES,
    Stance,
    stride_lengths,
)
from gaitsmith.plan.paths import Path

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import StepPlan
    from gaitsmith.plan.pace import Pace

__all__ = [
    "EASED_DURATION",
    "FIRST_STEP",
    "LEAST_DEFICIT",
    "MOST_STEPS",
    "PATH_SPACING",
    "SHARES",
    "Stance",
    "footstep_positions",
    "plan_straight",
    "stride_lengths",
]


def plan_straight(
    *,
    distance: float,
    pace: Pace,
    stance: Stance,
    ground: Ground,
    start: str = "stand",
    stop: str = "stand",
    origin: tuple[float, float] = (0.0, 0.0),
    heading: float = 0.0,
) -> StepPlan:
    """Footsteps from ``origin`` straight ahead over ``distance`` meters.

    Parameters
    ----------
    distance
        Meters from the first to the last point of the path.
    pace
        Steady step length and cadence.
    stance
        Step width and toe-out.
    ground
        Gives the height of every footstep.
    start, stop
        ``"stand"``: feet side by side, the middle of both N on the end point. ``"walk"``: frame
        0 is a heel strike at the first point; the end is the last heel strike on the path.
    origin, heading
        Where the path begins, x,z, and which way it goes.
    """
    distance = positive("distance", distance, "meters")
    path = Path.line(distance, origin=origin, heading=heading)
    return follow(path, pace=pace, stance=stance, ground=ground, start=start, stop=stop)


def footstep_positions(
    along: Float[np.ndarray, "N"],
    side: np.ndarray,
    stance: Stance,
    origin: tuple[float, float],
    heading: float,
    ground: Ground,
) -> Float[np.ndarray, "N 3"]:
    """N of footsteps ``along`` a line, half a step width to their side, on the ground."""
    out = np.array([origin[0], 0.0, origin[1]]) + along[:, None] * ahead(heading)
    out = out + (0.5 * stance.width * SIDE_SIGN[side])[:, None] * leftward(heading)
    out[:, 1] = ground.height(out[:, 0], out[:, 2])
    return out
