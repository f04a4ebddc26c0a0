"""What can be walked but is not usual: said as warnings."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from gaitsmith.errors import GaitsmithWarning
from gaitsmith.plan.pace import UNUSUAL_FROUDE, froude
from gaitsmith.walks.generalize import LONG_STEP

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import StepPlan


def warn_of_unusual(body: Body, step_length: float, speed: float) -> None:
    """Say that steps (m) are longer, or a speed (m/s) higher, than people usually walk with."""
    ratio, number_ = step_length / body.leg_length, froude(body, speed)
    if ratio > LONG_STEP:
        warnings.warn(
            f"steps of {step_length:.3f} m are {ratio:.2f} leg lengths: longer than people take",
            GaitsmithWarning,
            stacklevel=3,
        )
    if number_ > UNUSUAL_FROUDE:
        warnings.warn(
            f"{speed:.2f} m/s is Froude number {number_:.2f} for this body: nearly a run",
            GaitsmithWarning,
            stacklevel=3,
        )


def warn_of_treads(plan: StepPlan, step_length: float) -> None:
    """Warn that footholds on ground with steps set how long steps are."""
    taken = plan.step_lengths[1:-1]
    warnings.warn(
        f"footholds set the steps: they are {taken.min():.3f} to {taken.max():.3f} m long, "
        f"{step_length:.3f} m is only a wish where the ground has steps",
        GaitsmithWarning,
        stacklevel=3,
    )


def warn_of_short_steps(plan: StepPlan, step_length: float, share: float) -> None:
    """Say that no step has the length asked for, or that curves leave only a share of it."""
    longest = float(plan.step_lengths[1:].max())
    if longest < step_length - 1e-6:
        warnings.warn(
            f"the way is too short for a full step of {step_length:.3f} m; the longest is "
            f"{longest:.3f} m",
            GaitsmithWarning,
            stacklevel=3,
        )
    if share < 1.0 - 1e-6:
        warnings.warn(
            f"curves shorten steps of {step_length:.3f} m to as little as "
            f"{share * step_length:.3f} m",
            GaitsmithWarning,
            stacklevel=3,
        )
