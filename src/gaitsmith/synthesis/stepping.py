"""Local steps and turns, [KB93]: NRS- (forward, backward, lateral) and turnaround.

What the paper calls INITIALIZE_NRS is ``prepare``, ADVANCE_NRS is ``poses``. The paper says
nothing about balance; here the hips go over the foot that stays before the other one leaves.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.contact import ReferenceStep, StepCurves
from gaitsmith.conventions import LOCAL_KINDS, UP, ahead, leftward
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.plan.footsteps import LocalStep
from gaitsmith.synthesis.local_curves import (
    FootAngles,
    over_stance,
    swing_lift,
)
from gaitsmith.synthesis.local_plan import (
    PELVIS_TURN,
    LocalDraft,
    height_of_hips,
    pelvis_heading,
    underlying_step,
    usual_angles,
    way_of_hips,
)
from gaitsmith.synthesis.local_swing import kept_apart, swing_way
from gaitsmith.synthesis.local_upper import glanced, local_upper
from gaitsmith.synthesis.rest import Rest
from gaitsmith.synthesis.step import LocalState, PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.swing_path import push_shape
from gaitsmith.synthesis.upper_body import RuleOverlay

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.model import StraightWalk

#: Samples of a step before and after toe-off.
SAMPLES = 40
#: How far the height of the swing is eased at its ends: a foot is set down, not lowered.
LIFT_EASE = 0.7
#: Samples of standing this near to its ends.
NEAR = 1e-3
#: How far the hips go over the stance foot before the other leaves, of the way from where they
#: would be: 4-6 of 7-14 cm as people start (one person), less aside, where the push is from the
#: leg that stays.
OVER = {"forward": 0.66, "backward": 0.66, "lateral": 0.50, "turn": 0.66}
CLOSING_OVER = {"forward": 0.50, "backward": 0.45, "lateral": 0.15, "turn": 0.66}
#: Phase at which the swing foot leaves: first steps from standing shift the weight for longer.
TOE_OFF = {"forward": 0.42, "backward": 0.42, "lateral": 0.34, "turn": 0.40}
CLOSING_TOE_OFF = {"forward": 0.34, "backward": 0.36, "lateral": 0.20, "turn": 0.34}
#: Feet so far apart, over the leg, are as far as feet are when one closes.
APART_WHOLE = 0.4
#: Drop of the pelvis on the swing side, lean of the trunk over the stance foot, radians.
LIST, OVER_LEAN = float(np.radians(2.5)), float(np.radians(2.0))
#: Arms: swing at a step of half a leg, held apart in a lateral step, radians.
ARM_SWING, ARM_APART = float(np.radians(9.0)), float(np.radians(6.0))


class LocalGenerator:
    """Steps of [KB93] with the foot angles and hip heights of any straight walk.

    Parameters
    ----------
    walk, ground, overlay
        As of :class:`~gaitsmith.synthesis.straight.StraightGenerator`.
    pelvis_limit
        Radians that the pelvis may turn beyond the middle of the feet; inf: as printed.
    """

    def __init__(
        self,
        walk: StraightWalk,
        ground: Ground,
        overlay: Overlayer | None = None,
        *,
        pelvis_limit: float = PELVIS_TURN,
    ) -> None:
        self._walk, self._ground = walk, ground
        self._limit = pelvis_limit
        over = overlay or RuleOverlay()

        def rest(body: Body) -> Rest:
            return Rest.of(body, walk, over)

        self._rest = lru_cache(maxsize=16)(rest)

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        if step.kind not in LOCAL_KINDS:
            raise InvalidInputError(f"step {step.index} is of kind {step.kind!r}, no local step")
        rest, how = self._rest(body), step.local or LocalStep()
        begin, height = _beginning(state, step, rest)
        if step.kind == "stand":
            return self._stand(body, step, how, rest, begin, height)
        toe_off = how.toe_off or _usual(step, how, body, TOE_OFF, CLOSING_TOE_OFF)
        t = np.concatenate(
            [np.linspace(0.0, toe_off, SAMPLES)[:-1], np.linspace(toe_off, 1.0, SAMPLES)]
        )
        walked = self._walk.step(body, underlying_step(body, step))
        return self._drawn(LocalDraft(step, how, body, rest, toe_off, t, begin, height, walked))

    def _drawn(self, s: LocalDraft) -> PreparedStep:
        step, body, begin, t = s.step, s.body, s.begin, s.t
        st, sw = s.stance.side, 1 - s.stance.side
        angles = s.how.angles or usual_angles(s)
        pitches = FootAngles.of(t, s.walked, (begin.pitch[st], begin.pitch[sw]), angles, s.toe_off)
        heading = begin.heading + smoothstep(t) * (pelvis_heading(s, self._limit) - begin.heading)
        base, speed = way_of_hips(s)
        height, ends_at = height_of_hips(s, base, heading, angles)
        ankle, foot_heading = _swing(s, angles)
        pitch, bend = np.empty((len(t), 2)), np.zeros((len(t), 2))
        pitch[:, st], pitch[:, sw] = pitches.stance, pitches.swing
        # toes lie flat while the foot bears on them, and again where it lands on them
        bears = t <= s.toe_off
        landing = max(0.0, -angles[1])
        air = max(0.0, -angles[2]) * (1.0 - s.share) + landing * s.share
        bend[:, sw] = np.where(bears, np.maximum(-pitch[:, sw], 0.0), air)
        bend[:, st] = np.maximum(-pitch[:, st], 0.0)

        shift = over_stance(t, s.toe_off)
        stands = s.stance.position[[0, 2]]
        over = _usual(step, s.how, body, OVER, CLOSING_OVER)
        place = base + (over * shift)[:, None] * (stands - base)
        center = np.stack([place[:, 0], s.stance.position[1] + height, place[:, 1]], axis=-1)
        pelvis = np.tile(s.rest.pelvis, (len(t), 1))
        # positive about z: the left side up, so the swing side comes down
        pelvis[:, 2] += LIST * -s.sign * np.sin(np.pi * s.share) ** 2
        gaze = begin.gaze if s.how.gaze is None else s.how.gaze
        looks = glanced(t, gaze, s.how.glances)
        arms_end = _arms(s)
        arms = np.array(begin.arms) + smoothstep(t)[:, None] * (arms_end - np.array(begin.arms))
        roll = -s.sign * OVER_LEAN * shift
        upper = local_upper(body, s.rest.upper, looks - heading, roll, arms)
        origin = np.array([s.stance.position[0], 0.0, s.stance.position[2]])
        curves = StepCurves(
            phase=t,
            center=center - origin,
            heading=heading,
            pelvis=pelvis,
            ankle=ankle - origin,
            foot_heading=foot_heading,
            pitch=pitch,
            meta=np.zeros((len(t), 2)),
            bend=bend,
            upper=upper,
        )
        after = LocalState(
            center=(float(base[-1, 0]), float(base[-1, 1])),
            speed=(float(speed[0]), float(speed[1])),
            heading=float(heading[-1]),
            gaze=float(looks[-1]),
            pitch=(float(pitch[-1, 0]), float(pitch[-1, 1])),
            arms=tuple(float(a) for a in arms_end),  # type: ignore[arg-type]
        )
        rise = float(step.target.position[1] - s.stance.position[1])
        return TabledStep(
            step.duration,
            WalkerState(hip_height=ends_at - rise, local=after),
            _reference(step, curves, origin, s.toe_off, raising=0.0),
            body,
            self._ground,
        )

    def _stand(
        self,
        body: Body,
        step: PlannedStep,
        how: LocalStep,
        rest: Rest,
        begin: LocalState,
        height: float,
    ) -> PreparedStep:
        """Nothing moves but the gaze."""
        t = np.linspace(0.0, 1.0, SAMPLES)
        # close to its ends, so that no speed of a walk beside it leaks in
        t = np.sort(np.append(t, [NEAR, 1.0 - NEAR]))
        gaze = begin.gaze if how.gaze is None else how.gaze
        looks = glanced(t, gaze, how.glances)
        heading = np.full(len(t), begin.heading)
        arms = np.tile(begin.arms, (len(t), 1))
        level = step.stance.position[1]
        feet = sorted((step.stance, step.origin), key=lambda f: f.side)
        stand = rolled_ankle(body.foot, np.zeros(1), np.zeros(1))[0]
        ankle = np.stack([f.position + stand[0] * ahead(f.heading) + stand[1] * UP for f in feet])
        curves = StepCurves(
            phase=t,
            center=np.tile([begin.center[0], level + height, begin.center[1]], (len(t), 1)),
            heading=heading,
            pelvis=np.tile(rest.pelvis, (len(t), 1)),
            ankle=np.tile(ankle, (len(t), 1, 1)),
            foot_heading=np.tile([f.heading for f in feet], (len(t), 1)),
            pitch=np.zeros((len(t), 2)),
            meta=np.zeros((len(t), 2)),
            bend=np.zeros((len(t), 2)),
            upper=local_upper(body, rest.upper, looks - heading, np.zeros(len(t)), arms),
        )
        after = LocalState(
            begin.center, (0.0, 0.0), begin.heading, float(looks[-1]), (0.0, 0.0), begin.arms
        )
        reference = _reference(step, curves, np.zeros(3), 1.0)
        end = WalkerState(hip_height=height, local=after)
        return TabledStep(step.duration, end, reference, body, self._ground)


def _usual(
    step: PlannedStep,
    how: LocalStep,
    body: Body,
    first: dict[str, float],
    closing: dict[str, float],
) -> float:
    """``first`` of feet side by side; the farther they are apart the more as if it closed.

    A foot that was left behind, ahead or aside is no foot that bears half of the weight.
    """
    base = (closing if how.closes else first)[step.kind]
    way = step.origin.position - step.stance.position
    along = float(way @ ahead(step.stance.direction))
    wide = max(abs(float(way @ leftward(step.stance.direction))) - body.hip_width, 0.0)
    apart = abs(along) + wide
    if apart < 1e-6:
        return base
    left = closing["forward" if along < 0.0 else "backward"]
    mixed = (abs(along) * left + wide * closing["lateral"]) / apart
    share = smoothstep(np.array(min(apart / (APART_WHOLE * body.leg_length), 1.0)))
    return float(base + share * (mixed - base))


def _reference(
    step: PlannedStep,
    curves: StepCurves,
    origin: Float[np.ndarray, "3"],
    toe_off: float,
    raising: float = 1.0,
) -> ReferenceStep:
    foothold, heading = np.empty((2, 3)), np.empty(2)
    for foot in (step.stance, step.origin):
        foothold[foot.side], heading[foot.side] = foot.position, foot.heading
    return ReferenceStep(
        curves=curves,
        origin=origin,
        stance=step.stance.side,
        toe_off=toe_off,
        foothold=foothold,
        foothold_heading=heading,
        target=step.target.position,
        target_heading=step.target.heading,
        raising=raising,
    )


def _beginning(state: WalkerState, step: PlannedStep, rest: Rest) -> tuple[LocalState, float]:
    """What the step begins with: what the last one left, or standing between the feet."""
    height = rest.height if state.hip_height is None else state.hip_height
    if state.local is not None:
        return state.local, height
    x, _, z = 0.5 * (step.stance.position + step.origin.position)
    facing = 0.5 * (step.stance.direction + step.origin.direction)
    standing = LocalState((float(x), float(z)), (0.0, 0.0), facing, facing, (0.0, 0.0))
    return standing, rest.height


def _swing(
    s: LocalDraft, angles: tuple[float, float, float]
) -> tuple[Float[np.ndarray, "T 2 3"], Float[np.ndarray, "T 2"]]:
    """Ankles and headings of [left, right]; where a foot bears the contact stage replaces them."""
    step, body, t = s.step, s.body, s.t
    st, sw = step.stance.side, step.target.side

    def ankle_of(foot: Footstep, pitch: float) -> Float[np.ndarray, "3"]:
        rolled = rolled_ankle(body.foot, np.array([pitch]), np.zeros(1))[0]
        return foot.position + rolled[0] * ahead(foot.heading) + rolled[1] * UP

    start, end = ankle_of(step.origin, angles[2]), ankle_of(step.target, angles[1])
    stance = ankle_of(step.stance, 0.0)
    outward = s.sign * leftward(step.stance.direction)[[0, 2]]
    way = swing_way(start[[0, 2]], end[[0, 2]], stance[[0, 2]], outward, body.hip_width, s.share)
    heading = step.origin.heading + s.share * (step.target.heading - step.origin.heading)
    u = np.clip((t - s.toe_off) / (1.0 - s.toe_off), 0.0, 1.0)
    way = kept_apart(
        way,
        heading,
        stance[[0, 2]],
        step.stance.heading,
        outward,
        push_shape(u),
        body.foot,
        body.height,
    )
    lift = swing_lift(u + LIFT_EASE * (s.share - u), s.how.swing_height)
    ankle, headings = np.empty((len(t), 2, 3)), np.empty((len(t), 2))
    ankle[:, st], headings[:, st] = stance, step.stance.heading
    ankle[:, sw, 0], ankle[:, sw, 2] = way[:, 0], way[:, 1]
    ankle[:, sw, 1] = start[1] + s.share * (end[1] - start[1]) + lift
    headings[:, sw] = heading
    return ankle, headings


def _arms(s: LocalDraft) -> Float[np.ndarray, "3"]:
    """Swing of [left, right] arm and their distance from the body at the end of the step."""
    if s.how.closes or s.step.kind == "turn":
        return np.zeros(3)
    if s.step.kind == "lateral":
        return np.array([0.0, 0.0, ARM_APART])
    along = float((s.step.target.position - s.stance.position) @ ahead(s.stance.direction))
    swing = ARM_SWING * float(np.clip(2.0 * along / s.body.leg_length, -1.0, 1.0))
    out = np.zeros(3)
    out[s.stance.side], out[s.step.target.side] = swing, -swing
    return out
