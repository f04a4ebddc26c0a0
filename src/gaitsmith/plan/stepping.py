"""Where feet go in local steps and turns, [KB93] sections 4 and 6."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.conventions import LEFT, SIDE_SIGN, SIDES, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.plan.footsteps import PlannedStep

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Foot
    from gaitsmith.plan.footsteps import Footstep, LocalStep

    Region = Literal["forward", "lateral", "backward"]

#: nu of [KB93] Figure 2; within TOLERANCE of its lines a step whose foot points within PARALLEL
#: of the stance foot is a lateral one, others are not.
NU, TOLERANCE, PARALLEL = (float(np.radians(a)) for a in (60.0, 3.0, 20.0))
#: Largest turn of one turnaround.
LARGEST_TURN = float(np.radians(100.0))
#: Farthest that one pair of steps moves the body, over the leg length (0.5-0.7 m forward,
#: 0.35-0.5 m back, 0.58-0.65 m aside from standing).
FARTHEST = {"forward": 0.75, "back": 0.50, "left": 0.72, "right": 0.72}
#: Axes of feet that stand nearer than this touch, meters; a foot that lands across the other one
#: must keep clear of its toes or heel by more, or it could not get there.
TOUCHING, TOUCHING_ACROSS = 0.045, 0.075
#: Crossed legs are one behind the other by so much of the sole from heel to ball: a bent knee.
CROSSED = 1.25
TURNAROUNDS = ("dynamic", "stationary")


def step_region(angle: float, turned: float = 0.0) -> Region | None:
    """Kind of a local step by where it leads, [KB93] Figure 2; None: the legs would cross.

    Parameters
    ----------
    angle
        Direction of the new heel from the stance heel against the stance foot's direction,
        radians, positive to the side of the stepping foot.
    turned
        Direction of the new foot against that of the stance foot.
    """
    angle = float(np.arctan2(np.sin(angle), np.cos(angle)))
    parallel = abs(np.arctan2(np.sin(turned), np.cos(turned))) < PARALLEL
    for line, beyond in ((NU, "forward"), (np.pi - NU, "backward")):
        if abs(angle - line) <= TOLERANCE:
            return "lateral" if parallel else beyond  # type: ignore[return-value]
    if -0.5 * NU <= angle < NU:
        return "forward"
    if NU <= angle <= np.pi - NU:
        return "lateral"
    if angle > np.pi - NU or angle < -(np.pi - 0.5 * NU):
        return "backward"
    return None


def classify(
    stance: Float[np.ndarray, "3"],
    direction: float,
    target: Float[np.ndarray, "3"],
    turned: float,
    side: int,
) -> Region:
    """Kind of the step of foot ``side`` whose heel goes to ``target``.

    ``stance`` is the heel that stays, ``direction`` where that foot points, ``turned`` how far
    the new foot points to the left of it.

    Raises
    ------
    InfeasibleError
        If the legs would cross.
    """
    way = np.asarray(target) - np.asarray(stance)
    sign = float(SIDE_SIGN[side])
    angle = float(np.arctan2(sign * (way @ leftward(direction)), way @ ahead(direction)))
    region = step_region(angle, turned)
    if region is None:
        raise InfeasibleError(
            f"the {SIDES[side]} foot would land {np.degrees(angle):.0f} deg to its own side of "
            f"where the {SIDES[1 - side]} foot points, across it: the legs would cross. "
            f"It may land from {np.degrees(-0.5 * NU):.0f} deg over its own side to "
            f"{np.degrees(-(np.pi - 0.5 * NU)):.0f} deg; step with the other foot first"
        )
    return region


def local_step(
    stance: Footstep,
    origin: Footstep,
    target: Footstep,
    duration: float,
    how: LocalStep | None = None,
    *,
    foot: Foot,
    hip_width: float | None = None,
    following: Footstep | None = None,
) -> PlannedStep:
    """One step of [KB93] on its own: ``specs`` of Eq. 1 as a planned step.

    ``footpos``, ``footdir`` and ``left_or_right`` are in ``target``, the rest in ``how``.
    ``direction`` of a footstep is where the foot points but for its toe-out; the kind is read
    from it. With ``hip_width`` a step that leaves the legs crossed is checked: the shins must
    clear each other.

    Raises
    ------
    InfeasibleError
        If the legs would cross, or the feet be set one on the other.
    """
    heels = [f.position - foot.heel * ahead(f.direction) for f in (stance, target)]
    turned = target.direction - stance.direction
    kind = classify(heels[0], stance.direction, heels[1], turned, target.side)
    apart = float(
        feet_apart(
            target.position[None, [0, 2]],
            np.array([target.heading]),
            stance.position[None, [0, 2]],
            np.array([stance.heading]),
            back=foot.heel,
            front=foot.ball + foot.toes,
        )[0]
    )
    way = target.position - stance.position
    across = float(way @ leftward(stance.direction)) * SIDE_SIGN[target.side] < 0.0
    least = TOUCHING_ACROSS if across else TOUCHING
    if apart < least:
        raise InfeasibleError(
            f"the {SIDES[target.side]} foot would be set on the {SIDES[stance.side]} one: their "
            f"axes would be {apart:.3f} m apart, feet need {least:.3f} m there"
        )
    if across and hip_width is not None:
        _check_crossed(stance, target, hip_width, foot)
    return PlannedStep(0, kind, stance, origin, target, None, following, duration, how)


def _check_crossed(stance: Footstep, target: Footstep, hip_width: float, foot: Foot) -> None:
    """Refuse legs that stay crossed so near that one knee is in the other leg.

    Legs from hips to crossed feet meet, seen from ahead, at the part hips / (hips + cross) of
    their height from the hips on; there one must be far enough in front of the other.
    """
    way, sign = target.position - stance.position, SIDE_SIGN[target.side]
    crossed = [-sign * float(way @ leftward(f.direction)) for f in (stance, target)]
    if min(crossed) <= 0.0:
        return
    middle = 0.5 * (stance.direction + target.direction)
    along = abs(float(way @ ahead(middle)))
    apart = along * hip_width / (hip_width + 0.5 * sum(crossed))
    least = CROSSED * (foot.heel + foot.ball)
    if apart < least:
        raise InfeasibleError(
            f"the legs would stay crossed, {apart:.2f} m one behind the other, which takes "
            f"{least:.2f} m; land less far across or farther on, or step with the other foot first"
        )


def turnaround(
    pivot: Float[np.ndarray, "3"],
    direction: float,
    angle: float,
    *,
    hip_width: float,
    kind: str = "stationary",
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Where the two feet of a turn land, [KB93] section 6: first the one on the turn's side.

    Parameters
    ----------
    pivot, direction
        N and direction of the foot that stays at first: the right one in a turn to the left.
    angle
        Radians, left positive, at most 100 deg: turn repeatedly for more.
    hip_width
        2 lambda.
    kind
        ``"dynamic"``: the second foot lands 2 lambda ahead, ready to walk. ``"stationary"``:
        side by side.

    Notes
    -----
    "2 lambda back and left of the right foot" is read in the frame of the foot that stays: in
    that of the goal the foot would cross behind it.
    """
    one_of("kind", kind, TURNAROUNDS)
    if not 0.0 < abs(angle) <= LARGEST_TURN + 1e-12:
        raise InfeasibleError(
            f"one turnaround turns by up to {np.degrees(LARGEST_TURN):.0f} deg, got "
            f"{np.degrees(angle):.1f} deg; turn repeatedly"
        )
    sign, goal = float(np.sign(angle)), direction + angle
    first = pivot + hip_width * (sign * leftward(direction) - ahead(direction))
    second = first - hip_width * sign * leftward(goal)
    if kind == "dynamic":
        second = second + hip_width * ahead(goal)
    return first, second


def turning_side(angle: float) -> int:
    """The foot that steps first: the one on the side turned to."""
    return LEFT if angle > 0.0 else 1 - LEFT
