"""Local steps and turns, [KB93]: NRS- (forward, backward, lateral) and turnaround.

What the paper calls INITIALIZE_NRS is ``prepare``, ADVANCE_NRS is ``poses``. The paper says
nothing about balance; here the hips go over the foot that stays before the other one leaves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.contact import ReferenceStep, StepCurves
from gaitsmith.conventions import LOCAL_KINDS, SIDE_SIGN, UP, ahead, leftward
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import end_slope_correction, parabola_slopes, smoothstep
from gaitsmith.plan.footsteps import LocalStep
from gaitsmith.synthesis.local_curves import (
    FootAngles,
    backward_height,
    eased,
    forward_height,
    lateral_height,
    over_stance,
    swing_lift,
)
from gaitsmith.synthesis.local_swing import kept_apart, swing_way
from gaitsmith.synthesis.local_upper import glanced, local_upper
from gaitsmith.synthesis.rest import Rest
from gaitsmith.synthesis.step import LocalState, PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.swing_path import push_shape
from gaitsmith.synthesis.upper_body import RuleOverlay
from gaitsmith.walks.model import SagittalStep, StepRequest, StraightWalk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.synthesis.overlay import Overlayer

#: Samples of a step before and after toe-off.
SAMPLES = 40
#: Samples of standing this near to its ends.
NEAR = 1e-3
#: Shortest step that the underlying walk is asked for, meters, and longest, over the leg.
SHORTEST, LONGEST = 0.05, 1.0
#: How far the hips go over the stance foot before the other leaves, of the way from where they
#: would be: 4-6 of 7-14 cm as people start (one person), less aside, where the push is from the
#: leg that stays.
OVER = {"forward": 0.66, "backward": 0.66, "lateral": 0.50, "turn": 0.66}
CLOSING_OVER = {"forward": 0.50, "backward": 0.45, "lateral": 0.15, "turn": 0.66}
#: Phase at which the swing foot leaves: first steps from standing shift the weight for longer.
TOE_OFF = {"forward": 0.42, "backward": 0.42, "lateral": 0.34, "turn": 0.40}
CLOSING_TOE_OFF = {"forward": 0.34, "backward": 0.36, "lateral": 0.20, "turn": 0.34}
#: Farthest that the pelvis turns beyond the middle of the feet, radians ([KB93] has 0.5 alpha,
#: 27 deg for a step of 0.3 m), and share of alpha.
PELVIS_TURN, ALPHA_SHARE = float(np.radians(10.0)), 0.5
#: Speed of the hips where the second step of a pair takes over, over the mean of both.
THROUGH = {"forward": 1.5, "backward": 1.4, "lateral": 1.6, "turn": 0.8}
#: Reach of straight legs, over their length; less of it at the widest straddle: people drop by
#: 10-13 cm at 0.6 m.
STANDING_REACH, STRADDLE = 0.998, 0.055
#: Drop of the pelvis on the swing side, lean of the trunk over the stance foot, radians.
LIST, OVER_LEAN = float(np.radians(2.5)), float(np.radians(2.0))
#: Arms: swing at a step of half a leg, held apart in a lateral step, radians.
ARM_SWING, ARM_APART = float(np.radians(9.0)), float(np.radians(6.0))


@dataclass(frozen=True, eq=False)
class _Step:
    """A local step with what it begins with, in the plane: x, z."""

    step: PlannedStep
    how: LocalStep
    body: Body
    rest: Rest
    toe_off: float
    t: Float[np.ndarray, "T"]
    begin: LocalState
    height: float
    walked: SagittalStep

    @property
    def stance(self) -> Footstep:
        return self.step.stance

    @property
    def sign(self) -> float:
        """+1 where the swing foot is the left one."""
        return float(SIDE_SIGN[self.step.target.side])

    @property
    def share(self) -> Float[np.ndarray, "T"]:
        """0 at toe-off, 1 at landing, eased."""
        return smoothstep((self.t - self.toe_off) / (1.0 - self.toe_off))


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
        self._rest = lru_cache(maxsize=16)(lambda body: Rest.of(body, walk, over))

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        if step.kind not in LOCAL_KINDS:
            raise InvalidInputError(f"step {step.index} is of kind {step.kind!r}, no local step")
        rest, how = self._rest(body), step.local or LocalStep()
        begin, height = _beginning(state, step, rest)
        if step.kind == "stand":
            return self._stand(body, step, how, rest, begin, height)
        usual = CLOSING_TOE_OFF if how.closes else TOE_OFF
        toe_off = how.toe_off or usual[step.kind]
        t = np.concatenate(
            [np.linspace(0.0, toe_off, SAMPLES)[:-1], np.linspace(toe_off, 1.0, SAMPLES)]
        )
        walked = self._walk.step(body, _underlying(body, step))
        return self._drawn(_Step(step, how, body, rest, toe_off, t, begin, height, walked))

    def _drawn(self, s: _Step) -> PreparedStep:
        step, body, begin, t = s.step, s.body, s.begin, s.t
        st, sw = s.stance.side, 1 - s.stance.side
        angles = s.how.angles or _usual_angles(s)
        pitches = FootAngles.of(t, s.walked, (begin.pitch[st], begin.pitch[sw]), angles, s.toe_off)
        heading = begin.heading + smoothstep(t) * (_facing(s, self._limit) - begin.heading)
        base, speed = _way_of_hips(s)
        height, ends_at = _height(s, base, heading, angles)
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
        over = (CLOSING_OVER if s.how.closes else OVER)[step.kind]
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
            _reference(step, curves, origin, s.toe_off),
            body,
            self._ground,
        )

    def _stand(
        self, body: Body, step: PlannedStep, how: LocalStep, rest: Rest, begin: LocalState, height: float
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
        ankle = np.stack(
            [f.position + stand[0] * ahead(f.heading) + stand[1] * UP for f in feet]
        )
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


def _reference(
    step: PlannedStep, curves: StepCurves, origin: Float[np.ndarray, "3"], toe_off: float
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


def _underlying(body: Body, step: PlannedStep) -> StepRequest:
    """The walking step that foot angles and heights are of: as long as the feet are apart along
    the stance foot. Of a backward step the one that it reverses.
    """
    way = ahead(step.stance.direction)
    before, after = (
        float(np.clip(abs((f.position - step.stance.position) @ way), SHORTEST, LONGEST * body.leg_length))
        for f in (step.origin, step.target)
    )
    if step.kind == "backward":
        before, after = after, before
    return StepRequest(
        side=step.stance.side,
        previous_length=before,
        length=after,
        next_length=after,
        duration=step.duration,
        kind="walk",
    )


def _usual_angles(s: _Step) -> tuple[float, float, float]:
    """Foot angles that suit the step: stance and swing at HSM+, swing at TOM.

    A step that closes ends on flat feet; a foot that comes from far leaves on its toes.
    """
    kind, leg = s.step.kind, s.body.leg_length
    way = ahead(s.stance.direction)
    there = float((s.step.target.position - s.stance.position) @ way)
    travel = float(np.linalg.norm(s.step.target.position - s.step.origin.position))
    mu2 = max(float(s.walked.pitch[-1, 1]), 0.0)
    off = int(s.walked.phase.searchsorted(s.walked.toe_off))
    mu3 = max(-float(s.walked.pitch[off, 1]), 0.0)
    if kind == "turn":
        return (0.0, 0.0, 0.0)
    far = float(smoothstep(np.array(min(max(abs(there), 0.6 * travel) / (0.5 * leg), 1.0))))
    if kind == "lateral":
        push = 0.3 * min(travel / (0.7 * leg), 1.0) ** 2 if s.how.closes else 0.0
        return (0.0, 0.0, -0.15 - push)
    if kind == "backward":
        # as a forward step reversed: toes land first, the heel leaves last
        return (0.0, 0.0, 0.2 * far) if s.how.closes else (0.0, -0.2 * far, -0.25 * max(far, 0.3))
    if s.how.closes:
        return (0.0, 0.0, -0.6 * mu3 * max(far, 0.25))
    return (-0.25 * far, mu2 * far, -0.6 * mu3 * max(0.6 * far, 0.25))


def _facing(s: _Step, limit: float) -> float:
    """Heading of the pelvis at the end: half of alpha, [KB93] Figure 7, within ``limit`` of the
    middle of the feet; in a turn the middle.
    """
    middle = 0.5 * (s.stance.direction + s.step.target.direction)
    if s.how.closes or s.step.kind in ("turn", "stand"):
        return middle
    way = s.step.target.position - s.stance.position
    along = float(way @ ahead(s.stance.direction))
    aside = s.sign * float(way @ leftward(s.stance.direction))
    alpha = float(np.arctan2(along, max(aside, 1e-9)))
    printed = s.stance.direction - s.sign * ALPHA_SHARE * alpha
    return middle + float(np.clip(printed - middle, -limit, limit))


def _way_of_hips(s: _Step) -> tuple[Float[np.ndarray, "T 2"], Float[np.ndarray, "2"]]:
    """Hips seen from above, weight shift left out, and their speed at the end (m/s)."""
    step = s.step
    here = np.array(s.begin.center)
    stance, target = (f.position[[0, 2]] for f in (step.stance, step.target))
    there = 0.5 * (stance + target)
    seconds = step.duration
    speed = np.zeros(2)
    if not s.how.closes and step.following is not None:
        last = 0.5 * (target + step.following.position[[0, 2]])
        speed = THROUGH[step.kind] * (last - here) / (2.0 * seconds)
        most = 2.2 * min(np.linalg.norm(there - here), np.linalg.norm(last - there)) / seconds
        size = float(np.linalg.norm(speed))
        if size > most:
            speed *= most / size
    ends = (np.array(s.begin.speed) * seconds, speed * seconds)
    return eased(s.t, here, there, ends), speed


def _height(
    s: _Step,
    base: Float[np.ndarray, "T 2"],
    heading: Float[np.ndarray, "T"],
    angles: tuple[float, float, float],
) -> tuple[Float[np.ndarray, "T"], float]:
    """Height of the hips over the stance foot's floor, and where it ends."""
    body, step, t = s.body, s.step, s.t
    end = _end_height(s, base[-1], heading[-1], angles)
    walked = np.interp(t, s.walked.phase, s.walked.center[:, 1])
    if step.kind == "forward":
        height = forward_height(t, walked, s.height, end)
    elif step.kind == "backward":
        height = backward_height(t, walked, s.height, end)
    elif step.kind == "lateral":
        hip = s.sign * 0.5 * body.hip_width * leftward(heading)[:, [0, 2]]
        way = base[0] + smoothstep(t)[:, None] * (base[-1] - base[0])
        distance = np.linalg.norm(way - hip - s.stance.position[[0, 2]], axis=-1)
        height = lateral_height(t, distance, s.height, end, body.foot.ankle_height)
    else:
        height = s.height + (end - s.height) * smoothstep(t)
    # steps meet, and end in standing, with hips that neither rise nor fall
    slopes = parabola_slopes(t, height[:, None])
    return height + end_slope_correction(t, -slopes[:1], -slopes[-1:])[:, 0], end


def _end_height(
    s: _Step,
    place: Float[np.ndarray, "2"],
    heading: float,
    angles: tuple[float, float, float],
) -> float:
    """Height at HSM+: the knee as bent as the walk's, within what both legs reach."""
    body, step = s.body, s.step
    level = step.stance.position[1]
    hips = {
        side: place + 0.5 * SIDE_SIGN[side] * body.hip_width * leftward(heading)[[0, 2]]
        for side in (0, 1)
    }

    def reached(foot: Footstep, pitch: float, length: float) -> float:
        rolled = rolled_ankle(body.foot, np.array([pitch]), np.zeros(1))[0]
        ankle = foot.position[[0, 2]] + rolled[0] * ahead(foot.heading)[[0, 2]]
        across = float(np.linalg.norm(hips[foot.side] - ankle))
        square = max(length**2 - across**2, (0.5 * length) ** 2)
        return float(foot.position[1] - level + rolled[1] + np.sqrt(square))

    straight = STANDING_REACH * body.leg_length
    stance = reached(step.stance, angles[0], straight)
    swing = straight
    if s.how.closes:
        pass
    elif step.kind in ("forward", "backward"):
        last = -1 if step.kind == "forward" else 0
        leg = 1 if step.kind == "forward" else 0
        gap = s.walked.center[last] - s.walked.ankle[last, leg]
        swing = min(float(np.hypot(*gap)), straight)
    elif step.kind == "lateral":
        wide = float(np.linalg.norm(step.target.position - step.stance.position)) / body.leg_length
        swing = straight - STRADDLE * body.leg_length * max(0.0, wide - 0.3) ** 2 * 2.5
    return min(stance, reached(step.target, angles[1], swing), s.rest.height)


def _swing(
    s: _Step, angles: tuple[float, float, float]
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
    way = swing_way(
        start[[0, 2]], end[[0, 2]], stance[[0, 2]], outward, body.hip_width, s.share
    )
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
    lift = swing_lift(s.share, s.how.swing_height)
    ankle, headings = np.empty((len(t), 2, 3)), np.empty((len(t), 2))
    ankle[:, st], headings[:, st] = stance, step.stance.heading
    ankle[:, sw, 0], ankle[:, sw, 2] = way[:, 0], way[:, 1]
    ankle[:, sw, 1] = start[1] + s.share * (end[1] - start[1]) + lift
    headings[:, sw] = heading
    return ankle, headings


def _arms(s: _Step) -> Float[np.ndarray, "3"]:
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


class MixedGenerator:
    """Walks by one generator, local steps by another, in any order."""

    def __init__(self, walking: object, local: LocalGenerator) -> None:
        self._walking, self._local = walking, local

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        if step.kind in LOCAL_KINDS:
            return self._local.prepare(body, state, step)
        return self._walking.prepare(body, state, step)  # type: ignore[attr-defined]

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """Each walk as a whole, from standing to standing; each local step from the last."""
        out: list[PreparedStep] = []
        i = 0
        while i < len(steps):
            if steps[i].kind in LOCAL_KINDS:
                done = [self._local.prepare(body, state, steps[i])]
            else:
                j = i + 1
                while j < len(steps) and steps[j].kind not in (*LOCAL_KINDS, "start"):
                    j += 1
                done = self._walking.prepare_all(  # type: ignore[attr-defined]
                    body, WalkerState(), steps[i:j]
                )
            out += done
            i += len(done)
            state = done[-1].end if steps[i - 1].kind in LOCAL_KINDS else WalkerState()
        return out
