"""How a way of walking stands: what local steps begin and end in."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith.walks.model import StepRequest, StraightWalk

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.synthesis.overlay import Overlayer


@dataclass(frozen=True, eq=False)
class Rest:
    """Height of the hips over the floor, pelvis and upper body in standing."""

    height: float
    pelvis: Float[np.ndarray, "3"]
    upper: Float[np.ndarray, "U 3"]

    @staticmethod
    def of(body: Body, walk: StraightWalk, overlay: Overlayer) -> Rest:
        """What a step that starts from standing begins with."""
        length = 0.5 * body.leg_length
        request = StepRequest(
            side=0,
            previous_length=0.0,
            length=length,
            next_length=length,
            duration=0.6,
            kind="start",
        )
        step = walk.step(body, request)
        over = overlay(body, request, step)
        return Rest(float(step.center[0, 1]), over.pelvis[0], over.upper[0])
