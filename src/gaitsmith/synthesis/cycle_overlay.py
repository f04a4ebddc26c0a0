"""The upper body of a measured Cycle, read by phase and side and laid over any walk."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.synthesis.overlay import Overlay, upper_joints
from gaitsmith.synthesis.upper_body import shifted_sway

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.walks.model import SagittalStep, StepRequest

#: How far the measured excursions may be scaled with the step length.
MOST = 1.5
#: Arms swing with a higher power of the step length: 94 deg per meter of step where the
#: whole swing at 0.7 m is 25-30 deg (one person, 1.1-2.25 m/s), so they fade faster.
ARM_POWER = 1.5
_ARMS = ("Shoulder", "UpperArm", "LowerArm", "Hand")


class CycleOverlay:
    """Lays the pelvis, trunk, head and arms of ``cycle`` over the steps of any walk.

    Every joint keeps its mean posture; its excursion about it, a rotation vector, is scaled by
    the step length over the cycle's own, both in leg lengths, so that starts and stops grow
    and fade. Sway scales with the hip width and hardly with the step length.
    """

    def __init__(self, cycle: Cycle, leg_length: float) -> None:
        self._cycle = cycle
        self._usual = 0.5 * cycle.stride_length / leg_length
        index = cycle.skeleton.index
        left, right = (cycle.skeleton.offsets[index(f"{s}UpperLeg"), 0] for s in ("left", "right"))
        self._hip_width = float(left - right)
        self._mean = np.stack([_mean(q) for q in cycle.rotations.swapaxes(0, 1)])

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """See :class:`gaitsmith.synthesis.overlay.Overlayer`."""
        p = step.phase
        e0 = 0.0 if request.kind == "start" else request.previous_length / body.leg_length
        e1 = 0.0 if request.kind == "stop" else request.length / body.leg_length
        e0, e1 = (min(e / self._usual, MOST) for e in (e0, e1))
        size = e0 + (e1 - e0) * smoothstep(p)
        center, rotations = self._cycle.at(self._stride_phase(request.side, p))
        steady = center[:, 0] - self._cycle.center[:, 0].mean()
        steady = steady * (body.hip_width / self._hip_width)
        sway = shifted_sway(p, request, steady, e0, e1, 0.12 * body.hip_width)

        joint = self._cycle.skeleton.index
        pelvis = log(self._scaled(joint("hips"), rotations, size))
        upper = self._upper(body, rotations, size)
        return Overlay(sway=sway, pelvis=pelvis, upper=upper)

    def _stride_phase(self, side: int, phase: Float[np.ndarray, "T"]) -> Float[np.ndarray, "T"]:
        """A step from its left (right) heel strike to the other's, in the cycle's phase."""
        right = float(self._cycle.events[1, 0])
        return phase * right if side == 0 else right + phase * (1.0 - right)

    def _scaled(
        self, joint: int, rotations: Float[np.ndarray, "T J 4"], size: Float[np.ndarray, "T"]
    ) -> Float[np.ndarray, "T 4"]:
        """The joint's rotation with its excursion about the mean times ``size``."""
        mean = self._mean[joint]
        away = log(multiply(inverse(mean), rotations[:, joint]))
        return multiply(mean, exp(size[:, None] * away))

    def _upper(
        self, body: Body, rotations: Float[np.ndarray, "T J 4"], size: Float[np.ndarray, "T"]
    ) -> Float[np.ndarray, "T U 3"]:
        names, skeleton = spine_names(body.spine_segments), self._cycle.skeleton
        own = [n for n in ("spine", "chest", "upperChest") if n in skeleton.names]
        trunk = np.zeros((len(size), 3))
        total = exp(trunk)
        for name in own:
            total = multiply(total, self._scaled(skeleton.index(name), rotations, size))
        share = log(total) / len(names)  # the trunk's turn is shared by as many joints as there are
        swing = size**ARM_POWER
        out = []
        for name in upper_joints(body):
            if name in names:
                out.append(share)
            elif name in skeleton.names:
                arm = name.endswith(_ARMS)
                joint = skeleton.index(name)
                out.append(log(self._scaled(joint, rotations, swing if arm else size)))
            else:
                out.append(np.zeros((len(size), 3)))
        return np.stack(out, axis=1)


def _mean(q: Float[np.ndarray, "K 4"]) -> Float[np.ndarray, "4"]:
    """Rotation about which the excursions of ``q`` average to nothing."""
    mean = q.sum(0) / np.linalg.norm(q.sum(0))
    for _ in range(10):
        mean = multiply(mean, exp(log(multiply(inverse(mean), q)).mean(0)))
    return mean / np.linalg.norm(mean)
