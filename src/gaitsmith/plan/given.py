"""Footsteps that somebody gives: exactly these, from standing to standing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.conventions import GRAVITY, SIDE_SIGN, SIDES, ahead, leftward
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.ground import foot_plane
from gaitsmith.plan.course import course_curvature, course_pieces
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.lengths import EASED_DURATION, MOST_STEPS
from gaitsmith.plan.pace import LARGEST_FROUDE

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground
    from gaitsmith.plan.pace import Pace

#: How far a given height may be off the ground, meters.
ON_GROUND = 1e-3
#: Turn of the walk in one step, radians; a step must lead at least so far ahead, over the leg.
LARGEST_TURN, LEAST_AHEAD = float(np.radians(65.0)), 0.1
#: Farthest that the walk may lead aside of where the feet point.
LARGEST_ASIDE = float(np.radians(60.0))
#: Axes of two feet that stand nearer than this touch; a foot set farther across the other one
#: than this crosses the legs (m); wider apart than this part of the leg is a straddle.
TOUCHING, CROSSED, WIDEST = 0.045, 0.03, 0.6
#: A step takes its usual time times the square root of usual over own length, within these.
QUICKEST, SLOWEST = 0.75, 1.6
#: Seconds of the quickest step, of a body whose leg is LEG meters.
SHORTEST_TIME, LEG = 0.2, 0.834
#: Time that a turning step takes longer, per radian.
TURN_TIME = 0.35


@dataclass(frozen=True, eq=False)
class GivenSteps:
    """Footsteps as given, in order of landing; the first two, in any order, stand at the start.

    Attributes
    ----------
    side, place, heading
        ``(N,)`` 0 left 1 right; ``(N, 2)`` x,z of N; ``(N,)`` of the foot, radians.
    height, time
        ``(N,)`` y of N and seconds of landing, or None.
    """

    side: Int[np.ndarray, "N"]
    place: Float[np.ndarray, "N 2"]
    heading: Float[np.ndarray, "N"]
    height: Float[np.ndarray, "N"] | None = None
    time: Float[np.ndarray, "N"] | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.side)
        for name, shape, dtype in (
            ("side", (count,), np.int64),
            ("place", (count, 2), np.float64),
            ("heading", (count,), np.float64),
            ("height", (count,), np.float64),
            ("time", (count,), np.float64),
        ):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, frozen_array(name, value, shape, dtype))
        if count < 4:
            raise InvalidInputError(
                "given footsteps need at least 4 rows: two for the feet that stand, one for a step "
                f"and one that closes; got {count}"
                + (", a single step from standing to standing: no walk" if count == 3 else "")
            )
        if count > MOST_STEPS:
            raise InvalidInputError(f"more than {MOST_STEPS} footsteps; walk them in parts")


def plan_given(given: GivenSteps, *, body: Body, pace: Pace, ground: Ground) -> StepPlan:
    """The plan that lands on exactly the ``given`` footsteps.

    The walk's direction at each is the mean of its own foot's heading and of its neighbors',
    so that toes turned out alike cancel. Without times, short and turning steps take longer.

    Raises
    ------
    InfeasibleError
        Naming the step, what it needs and the limit, if it leads back, turns too far, or would
        set one foot on or across the other.
    InvalidInputError
        If sides do not alternate, times do not rise, or a height is not on the ground.
    """
    _check_sides(given.side)
    given = _standing_first(given)
    heading = np.unwrap(given.heading)
    direction = 0.5 * heading
    direction[1:-1] += 0.25 * (heading[2:] + heading[:-2])
    direction[0] += 0.5 * heading[1]
    direction[-1] += 0.5 * heading[-2]
    x, z = given.place[:, 0], given.place[:, 1]
    foot = body.foot
    stands = foot_plane(ground, given.place, heading, heel=foot.heel, ball=foot.ball)
    level = stands.position[:, 1]
    if given.height is not None:
        off = np.abs(given.height - level)
        if (off > ON_GROUND).any():
            i = int(off.argmax())
            raise InvalidInputError(
                f"footstep {i + 1}: y is {given.height[i]:g} m, a foot that stands there has it at "
                f"{level[i]:g} m; leave the column out to stand on the ground"
            )
    position = np.stack([x, level, z], axis=-1)
    _check_steps(given.side, position, heading, direction, body)
    kinds: list[StepKind] = ["walk"] * (len(x) - 2)
    kinds[0], kinds[-1] = "start", "stop"
    time = given.time
    if time is None:
        time = _times(position, direction, pace, kinds)
    plan = StepPlan(
        side=given.side,
        position=position,
        heading=heading,
        direction=direction,
        time=time,
        kinds=tuple(kinds),
    )
    _check_course(plan)
    if given.time is not None:
        _check_times(plan, body)
    return plan


def _check_times(plan: StepPlan, body: Body) -> None:
    """Refuse steps that nobody walks in the time they are given."""
    shortest = SHORTEST_TIME * np.sqrt(body.leg_length / LEG)
    fastest = np.sqrt(LARGEST_FROUDE * GRAVITY * body.hip_height)
    least = np.maximum(shortest, np.abs(plan.step_lengths[1:]) / fastest)
    quick = np.flatnonzero(plan.durations < least * (1.0 - 1e-9))
    if quick.size:
        i = int(quick[0])
        raise InfeasibleError(
            f"footstep {i + 3} ({SIDES[plan.side[i + 2]]}): its step of "
            f"{plan.step_lengths[i + 1]:.2f} m has {plan.durations[i]:.2f} s, this body needs at "
            f"least {least[i]:.2f} s; let it land later"
        )


def _check_course(plan: StepPlan) -> None:
    """Refuse steps whose feet point elsewhere than they go: the hips would have to whirl."""
    assert plan.middle is not None
    curvature = course_curvature(plan.middle, plan.direction)
    first, last = slice(1, -2), slice(2, -1)
    curves = course_pieces(
        plan.middle[first],
        plan.middle[last],
        (plan.direction[first], plan.direction[last]),
        (curvature[first], curvature[last]),
    )
    mean = 0.5 * (plan.direction[first] + plan.direction[last])
    for u in np.linspace(0.0, 1.0, 17):
        way = curves.derivative(np.full(len(curves), u))
        aside = np.arctan2(way[:, 0], way[:, 1]) - mean
        aside = np.abs(np.arctan2(np.sin(aside), np.cos(aside)))
        if (aside > LARGEST_ASIDE).any():
            i = int(aside.argmax())
            raise InfeasibleError(
                f"footstep {i + 3} ({SIDES[plan.side[i + 2]]}): the way to it leads "
                f"{np.degrees(aside[i]):.0f} deg aside of where the feet point, a walk may lead "
                f"{np.degrees(LARGEST_ASIDE):.0f} deg; turn the feet along the way"
            )


def _standing_first(given: GivenSteps) -> GivenSteps:
    """The same; of the feet that stand, the one that steps first comes first."""
    if given.side[2] != given.side[1]:
        return given
    order = np.array([1, 0, *range(2, len(given.side))])
    columns = (given.side, given.place, given.heading, given.height, given.time)
    return GivenSteps(*(None if c is None else c[order] for c in columns))  # type: ignore[arg-type]


def _check_sides(side: Int[np.ndarray, "N"]) -> None:
    if side[0] == side[1]:
        raise InvalidInputError(
            f"the first two footsteps must be a left and a right one, both are {SIDES[side[0]]}"
        )
    same = np.flatnonzero(side[3:] == side[2:-1]) + 2
    if same.size:
        i = int(same[0])
        raise InvalidInputError(
            f"sides must alternate: footsteps {i + 1} and {i + 2} are both {SIDES[side[i]]}"
        )


def _check_steps(
    side: Int[np.ndarray, "N"],
    position: Float[np.ndarray, "N 3"],
    heading: Float[np.ndarray, "N"],
    direction: Float[np.ndarray, "N"],
    body: Body,
) -> None:
    """Refuse what a person who walks ahead cannot do."""
    turn = np.diff(direction)
    mean = 0.5 * (direction[1:] + direction[:-1])
    gap = position[1:] - position[:-1]
    length = (gap * ahead(mean)).sum(-1)
    width = (gap * leftward(mean)).sum(-1) * SIDE_SIGN[side[1:]]
    least = LEAST_AHEAD * body.leg_length
    wide = WIDEST * body.leg_length
    foot, spot = body.foot, position[:, [0, 2]]
    apart = feet_apart(
        spot[1:], heading[1:], spot[:-1], heading[:-1], back=foot.heel, front=foot.ball + foot.toes
    )
    walks = np.zeros(len(gap), dtype=np.bool_)
    walks[1:-1] = True
    for i in range(len(gap)):
        name = f"footstep {i + 2} ({SIDES[side[i + 1]]})"
        if abs(turn[i]) > LARGEST_TURN:
            raise InfeasibleError(
                f"{name}: the walk would turn by {np.degrees(abs(turn[i])):.0f} deg in one step, "
                f"more than {np.degrees(LARGEST_TURN):.0f} deg; add a footstep between"
            )
        if walks[i] and length[i] < least:
            raise InfeasibleError(
                f"{name}: leads {length[i]:.3f} m ahead, a walk needs at least {least:.3f} m; "
                "steps back, aside or on the spot are not built yet"
            )
        if apart[i] < TOUCHING or width[i] < -CROSSED:
            raise InfeasibleError(
                f"{name}: its axis is {apart[i]:.3f} m from that of the foot before and it lies "
                f"{width[i]:.3f} m to its own side of it; feet need {TOUCHING:.3f} m and may not "
                f"cross by more than {CROSSED:.3f} m: set it farther out"
            )
        if width[i] > wide:
            raise InfeasibleError(
                f"{name}: is {width[i]:.3f} m to its side of the foot before, more than the "
                f"{wide:.3f} m that this body can straddle"
            )


def _times(
    position: Float[np.ndarray, "N 3"],
    direction: Float[np.ndarray, "N"],
    pace: Pace,
    kinds: list[StepKind],
) -> Float[np.ndarray, "N"]:
    """Seconds of landing at the pace's own rhythm."""
    gap = np.sqrt(((position[2:] - position[1:-1]) ** 2).sum(-1))
    ratio = np.sqrt(pace.step_length / np.maximum(gap, 1e-3))
    share = np.clip(ratio, QUICKEST, SLOWEST) + TURN_TIME * np.abs(np.diff(direction)[1:])
    share[-1] = min(share[-1], 1.2)
    eased = np.array([EASED_DURATION if kind != "walk" else 1.0 for kind in kinds])
    return np.concatenate([[0.0, 0.0], np.cumsum(eased * share * pace.step_duration)])
