"""What moves above the legs, by rule, for a walk that brings no whole-body Cycle.

The papers leave it open: the arm swing is "a kinematic function that depends on the leg
movement" ([KB92b] section 6). The rules and their sizes here are from published measurements
of walking; sources stand at the constants. Everything is a function of the step's phase, its
amplitude follows the step lengths, so starts and stops ease by themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import number
from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import about, exp, inverse, log, multiply
from gaitsmith.synthesis.overlay import Overlay, Samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.model import SagittalStep, StepRequest


#: No angle (radians) or share of the rules may be larger.
LARGEST_SIZE = 2.0


@dataclass(frozen=True)
class Manner:
    """Sizes of the rules. Angles in radians at a step of :attr:`usual` leg lengths.

    Attributes
    ----------
    usual
        Step length over leg length at which the sizes hold; they grow in proportion.
    pelvis_rotation
        Half of the range: 8.9 deg at free speed (Schwartz 2008), own side forward at heel strike.
    pelvis_list
        Half of the range: 8.2 deg (Schwartz 2008), swing side lowest at 15-18 % of the stride.
    pelvis_tilt, lean
        Forward tilt of the pelvis and lean of the trunk while walking (1-5 deg, 1.2-1.6 m/s).
    thorax_rotation
        Half of the range against the pelvis: 9-14 deg at natural cadence (CMU 07, computed).
    thorax_list
        Lean of the thorax over the stance leg, half of the range.
    sway
        Half of the lateral path of the pelvis over the hip width: 4-6 cm in all at 1.2-1.7 m/s.
    arm_swing
        Swing of the upper arm over the mean swing of both legs, opposite to its own leg.
    arm_middle, arm_apart
        Mean flexion and abduction of the upper arms.
    elbow, elbow_swing
        Flexion with the arm at its middle; more of it per radian of forward swing (24-35 deg
        in the mean, 20-39 deg range at 0.9-1.9 m/s).
    head_pitch
        Nose down, radians per meter the hips rise: the gaze stays on a point ahead.
    pelvis, arms
        Switch the pelvis and trunk layer, and the arm swing, off.
    """

    usual: float = 0.85
    pelvis_rotation: float = float(np.radians(4.5))
    pelvis_list: float = float(np.radians(4.0))
    pelvis_tilt: float = float(np.radians(1.5))
    lean: float = float(np.radians(2.5))
    thorax_rotation: float = float(np.radians(4.5))
    thorax_list: float = float(np.radians(1.0))
    sway: float = 0.13
    arm_swing: float = 0.62
    arm_middle: float = float(np.radians(-3.0))
    arm_apart: float = float(np.radians(9.0))
    elbow: float = float(np.radians(20.0))
    elbow_swing: float = 0.55
    head_pitch: float = 0.8
    pelvis: bool = True
    arms: bool = True

    def __post_init__(self) -> None:
        """Check that every size is a number that a body can show."""
        for field in fields(self):
            if field.name not in ("pelvis", "arms"):
                value = number(f"manner.{field.name}", getattr(self, field.name), "radians or 1")
                if abs(value) > LARGEST_SIZE or (field.name == "usual" and value <= 0.0):
                    raise InvalidInputError(
                        f"manner.{field.name} must be within +-{LARGEST_SIZE:g} (usual: above 0), "
                        f"got {value!r}"
                    )


class RuleOverlay:
    """The rules as an :class:`~gaitsmith.synthesis.overlay.Overlayer`."""

    strides = 1

    def __init__(self, manner: Manner | None = None) -> None:
        self._manner = manner or Manner()

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """See :func:`rule_overlays`; every stride is the same."""
        return self.many(body, [request], [step])[0]

    def many(
        self, body: Body, requests: Sequence[StepRequest], steps: Sequence[SagittalStep]
    ) -> list[Overlay]:
        """See :class:`gaitsmith.synthesis.overlay.BatchOverlayer`."""
        return rule_overlays(body, requests, steps, self._manner)

    def arms_middle(self, body: Body) -> Float[np.ndarray, "U 3"]:
        """See :class:`gaitsmith.synthesis.overlay.ArmedOverlayer`."""
        arms = [joint for side in (0, 1) for joint in _arm(side, np.zeros(1), self._manner)]
        out = np.zeros((body.spine_segments + 2 + len(arms), 3))
        out[-len(arms) :] = np.concatenate(arms)
        return out


def rule_overlays(
    body: Body, requests: Sequence[StepRequest], steps: Sequence[SagittalStep], manner: Manner
) -> list[Overlay]:
    """Pelvis, trunk, head and arms of steps, by rule.

    Amplitudes run from the previous step's to this step's, so that steps of any length join;
    all is zero in standing.
    """
    samples = Samples.of(requests, steps)
    p, s = samples.phase, SIDE_SIGN[samples.side]
    e0, e1 = (e / body.leg_length / manner.usual for e in samples.lengths(requests))
    on = 1.0 if manner.pelvis else 0.0
    ease = smoothstep(p)
    envelope = e0 + (e1 - e0) * ease

    # antiperiodic in the step: what one side does now the other does in the next
    turn = -s * (e0 - (e0 + e1) * 0.5 * (1.0 - np.cos(np.pi * p)))
    tip = s * envelope * np.sin(np.pi * p) * (1.0 + 0.5 * np.sin(2.0 * np.pi * p))
    reach = s * manner.sway * body.hip_width
    sway = shifted_sway(samples, reach * np.sin(np.pi * (p - 0.06)), e0, e1, np.abs(reach))
    pelvis = on * np.stack(
        [manner.pelvis_tilt * envelope, manner.pelvis_rotation * turn, manner.pelvis_list * tip],
        axis=-1,
    )
    thorax = on * np.stack(
        [
            manner.lean * envelope,
            -manner.thorax_rotation * turn,
            -manner.thorax_list * tip,
        ],
        axis=-1,
    )
    first, last = (samples.spread([q.center[end, 1] for q in steps]) for end in (0, -1))
    nod = np.zeros_like(pelvis)
    nod[:, 0] = on * manner.head_pitch * (samples.center[:, 1] - (first + (last - first) * p))

    pelvis_q, thorax_q, head_q = exp(pelvis), exp(thorax), exp(nod)
    n = body.spine_segments
    spine = log(multiply(inverse(pelvis_q), thorax_q)) / n
    neck = 0.5 * log(multiply(inverse(thorax_q), head_q))
    swing = _arm_swing(samples, manner)
    arms = [_arm(side, swing[:, side], manner) for side in (0, 1)]
    upper = np.stack([*[spine] * n, neck, neck, *arms[0], *arms[1]], axis=1)
    return samples.split(on * sway, pelvis, upper)


def shifted_sway(
    samples: Samples,
    steady: Float[np.ndarray, "M"],
    e0: Float[np.ndarray, "M"],
    e1: Float[np.ndarray, "M"],
    reach: Float[np.ndarray, "M"] | float,
) -> Float[np.ndarray, "M"]:
    """Lateral path of the hips, meters to the left, from that of a steady walk.

    Nearly the same at all step lengths ``e0`` (before) and ``e1`` (this), over the usual one.
    Before the first foot can leave the ground the weight must be over the other one, so a
    start shifts early and far, ``reach`` meters (Yiou et al. 2016, 2017).
    """
    p, first, last = samples.phase, np.tanh(3.0 * e0), np.tanh(3.0 * e1)
    out = (first + (last - first) * smoothstep(p)) * steady
    if samples.starts.any():
        shift = SIDE_SIGN[samples.side] * 1.1 * reach * last * smoothstep(p / 0.30)
        later = smoothstep((p - 0.30) / 0.60)
        out = np.where(samples.starts, (1.0 - later) * shift + later * last * steady, out)
    return out


def _arm_swing(samples: Samples, manner: Manner) -> Float[np.ndarray, "M 2"]:
    """Forward swing of the [left, right] upper arm about its middle, radians."""
    ahead_of_hips = samples.ankle[..., 0] - samples.center[:, None, 0]
    below = np.maximum(samples.center[:, None, 1] - samples.ankle[..., 1], 1e-6)
    leg = np.arctan2(ahead_of_hips, below)  # (M, 2) stance, swing
    mean = 0.5 * (leg[:, 0] - leg[:, 1]) * (manner.arm_swing if manner.arms else 0.0)
    left = np.where(samples.side == 0, -mean, mean)
    return np.stack([left, -left], axis=-1)


def _arm(
    side: int, swing: Float[np.ndarray, "T"], manner: Manner
) -> list[Float[np.ndarray, "T 3"]]:
    """Rotation vectors of shoulder, upper arm, forearm and hand of one side."""
    s = float(SIDE_SIGN[side])
    hang = about("z", -s * (0.5 * np.pi - manner.arm_apart))
    forward = about("x", -(manner.arm_middle + swing))
    upper = log(multiply(forward, hang))
    still = np.zeros((len(swing), 3))
    # the elbow follows the forward swing; the soft maximum keeps it smooth at the middle
    soft = 0.5 * (swing + np.sqrt(swing**2 + 0.15**2))
    forearm = np.zeros((len(swing), 3))
    forearm[:, 1] = -s * (manner.elbow + manner.elbow_swing * soft)
    return [still, upper, forearm, still]
