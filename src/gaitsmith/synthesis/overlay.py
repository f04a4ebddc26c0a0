"""What is laid over a sagittal step: pelvis, trunk, head and arms, relative to the heading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import SIDES

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.walks.model import SagittalStep, StepRequest


@dataclass(frozen=True, eq=False)
class Overlay:
    """One step's worth.

    Attributes
    ----------
    sway
        ``(T,)`` the hips to the left, meters.
    pelvis
        ``(T, 3)`` rotation vector of the pelvis in the heading's frame.
    upper
        ``(T, U, 3)`` local rotation vectors, in the order of :func:`upper_joints`.
    """

    sway: Float[np.ndarray, "T"]
    pelvis: Float[np.ndarray, "T 3"]
    upper: Float[np.ndarray, "T U 3"]


class Overlayer(Protocol):
    """A way of carrying what is above the legs: by rule, or as a measured Cycle.

    Attributes
    ----------
    strides
        Strides after which it repeats, 1 or 2.
    """

    strides: int

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """The overlay of one step; joins that of the steps before and after."""
        ...


def stride_of(step: PlannedStep) -> int:
    """Number of the stride that ``step`` belongs to; one begins with each left heel strike."""
    first = (step.index + step.stance.side) % 2  # side of the foot that the first step stands on
    return (step.index + first) // 2


def upper_joints(body: Body) -> tuple[str, ...]:
    """Names of the joints above the pelvis, in the order of ``Overlay.upper``."""
    arms = ("Shoulder", "UpperArm", "LowerArm", "Hand")
    return (
        *spine_names(body.spine_segments),
        "neck",
        "head",
        *(f"{side}{part}" for side in SIDES for part in arms),
    )
