"""What a local step decides once: its angles, where the hips go and how high, [KB93] section 5."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.conventions import SIDE_SIGN, ahead, leftward
from gaitsmith.geometry.curves import end_slope_correction, parabola_slopes, smoothstep
from gaitsmith.synthesis.local_curves import (
    backward_height,
    eased,
    forward_height,
    lateral_height,
)
from gaitsmith.walks.model import StepRequest

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import Footstep, LocalStep, PlannedStep
    from gaitsmith.synthesis.rest import Rest
    from gaitsmith.synthesis.step import LocalState
    from gaitsmith.walks.model import SagittalStep

#: Shortest step that the underlying walk is asked for, meters, and longest, over the leg.
SHORTEST, LONGEST = 0.05, 1.0
#: Farthest that the pelvis turns beyond the middle of the feet, radians ([KB93] has 0.5 alpha,
#: 27 deg for a step of 0.3 m), and share of alpha.
PELVIS_TURN, ALPHA_SHARE = float(np.radians(10.0)), 0.5
#: Speed of the hips where the second step of a pair takes over, over the mean of both.
THROUGH = {"forward": 1.5, "backward": 1.4, "lateral": 1.6, "turn": 0.8}
#: A foot that would tip by less lands and leaves flat, radians.
LEAST_TIP = 0.05
#: Feet nearer than this along or across are side by side, meters.
APART = 0.05
#: Reach of straight legs, over their length; less of it at the widest straddle: people drop by
#: 10-13 cm at 0.6 m.
STANDING_REACH, STRADDLE = 0.998, 0.055


@dataclass(frozen=True, eq=False)
class LocalDraft:
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
        """The foot that stays."""
        return self.step.stance

    @property
    def sign(self) -> float:
        """+1 where the swing foot is the left one."""
        return float(SIDE_SIGN[self.step.target.side])

    @property
    def share(self) -> Float[np.ndarray, "T"]:
        """0 at toe-off, 1 at landing, eased."""
        return smoothstep((self.t - self.toe_off) / (1.0 - self.toe_off))


def underlying_step(body: Body, step: PlannedStep) -> StepRequest:
    """The walking step that foot angles and heights are of.

    As long as the feet are apart along the stance foot; of a backward step the one it reverses.
    """
    way = ahead(step.stance.direction)
    before, after = (
        float(
            np.clip(
                abs((f.position - step.stance.position) @ way), SHORTEST, LONGEST * body.leg_length
            )
        )
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


def usual_angles(s: LocalDraft) -> tuple[float, float, float]:
    """Foot angles that suit the step: stance and swing at HSM+, swing at TOM.

    A step that closes ends on flat feet; a foot that comes from far leaves on its toes, one that
    is left in front on its heel.
    """
    kind, leg = s.step.kind, s.body.leg_length
    way = ahead(s.stance.direction)
    there = float((s.step.target.position - s.stance.position) @ way)
    travel = float(np.linalg.norm(s.step.target.position - s.step.origin.position))
    mu2 = max(float(s.walked.pitch[-1, 1]), 0.0)
    off = int(s.walked.phase.searchsorted(s.walked.toe_off))
    mu3 = max(-float(s.walked.pitch[off, 1]), 0.0)
    left = _leaving(s, mu3)
    if kind == "turn":
        return (0.0, 0.0, left)
    far = _eased(max(abs(there), 0.6 * travel) / (0.5 * leg))
    if kind == "lateral":
        push = 0.3 * min(travel / (0.7 * leg), 1.0) ** 2 if s.how.closes else 0.0
        return (0.0, 0.0, left if left > 0.0 else min(-0.15 - push, left))
    if kind == "backward":
        # as a forward step reversed: toes land first, the heel leaves last
        tipped = 0.2 * far if 0.2 * far > LEAST_TIP else 0.0
        if s.how.closes:
            return (0.0, 0.0, left if left < 0.0 else tipped)
        return (0.0, -tipped, left or -0.25 * max(far, 0.3))
    if s.how.closes:
        return (0.0, 0.0, min(-0.6 * mu3 * max(far, 0.25), left))
    return (-0.25 * far, mu2 * far, min(-0.6 * mu3 * max(0.6 * far, 0.25), left))


def _leaving(s: LocalDraft, mu3: float) -> float:
    """Pitch at TOM of a foot that stands apart from the other: behind or aside of it, or ahead."""
    way, leg = s.step.origin.position - s.stance.position, s.body.leg_length
    along = float(way @ ahead(s.stance.direction))
    aside = abs(float(way @ leftward(s.stance.direction)))
    behind = -0.6 * mu3 * _eased(max(-along - APART, 0.0) / (0.5 * leg))
    wide = max(aside - s.body.hip_width - APART, 0.0) / (0.7 * leg)
    aside = -0.45 * min(wide, 1.0) ** 2
    if min(behind, aside) < -0.05:
        return min(behind, aside)
    ahead_of_it = 0.2 * _eased(max(along - APART, 0.0) / (0.5 * leg))
    return ahead_of_it if ahead_of_it > LEAST_TIP else 0.0


def _eased(share: float) -> float:
    return float(smoothstep(np.array(min(share, 1.0))))


def pelvis_heading(s: LocalDraft, limit: float) -> float:
    """Heading of the pelvis at the end: half of alpha, [KB93] Figure 7, in a turn the middle.

    Within ``limit`` of the middle of the feet.
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


def way_of_hips(s: LocalDraft) -> tuple[Float[np.ndarray, "T 2"], Float[np.ndarray, "2"]]:
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


def height_of_hips(
    s: LocalDraft,
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
    s: LocalDraft,
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
