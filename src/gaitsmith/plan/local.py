"""Local moves that a script asks for: turns on the spot, and pairs of steps, [KB93]."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, ahead, leftward
from gaitsmith.plan.draft import Footfall
from gaitsmith.plan.stepping import FARTHEST, turnaround, turning_side
from gaitsmith.plan.ways import NO_WAY

if TYPE_CHECKING:
    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.draft import Draft
    from gaitsmith.plan.footsteps import Footstep
    from gaitsmith.plan.manners import Manners
    from gaitsmith.plan.script import Step

#: Seconds of the first and of the closing step of a pair that moves the body by half a meter, of
#: an adult; and of one in between.
SECONDS = {
    "forward": (0.90, 0.72, 0.66),
    "backward": (0.95, 0.78, 0.70),
    "lateral": (0.82, 0.67, 0.70),
}
#: Part of that which a very small step takes, and the way (m) from which all of it is taken.
SMALL, WHOLE = 0.75, 0.5
#: Seconds of a step of a turn: of none, and more per radian.
TURN_SECONDS, PER_RADIAN = 0.52, 0.12
#: swhf of the foot that closes a lateral step, which heel and toes lift as well.
CLOSING_LIFT = 0.7
#: Lift of the foot in a turn (1-4 cm measured).
TURN_LIFT = 0.5
#: Largest turn of a pair of steps that is taken without haste, radians: a man turns by 44-48 deg
#: (28-81) at a time; [KB93] has up to 100 deg.
USUAL_TURN = float(np.radians(60.0))
KINDS: dict[str, StepKind] = {
    "forward": "forward",
    "back": "backward",
    "left": "lateral",
    "right": "lateral",
}


def turn_seconds(manners: Manners, angle: float) -> float:
    """Of each step of a pair that turns by ``angle``."""
    return manners.tempo * (TURN_SECONDS + PER_RADIAN * abs(angle))


def step_seconds(manners: Manners, kind: StepKind, way: float, place: int) -> float:
    """Of a step whose foot goes ``way`` meters: ``place`` 0 leads, 1 closes, 2 is in between."""
    size = SMALL + (1.0 - SMALL) * min(1.0, way / WHOLE)
    return manners.tempo * size * SECONDS[kind][place]


def turn(draft: Draft, angle: float, *, walks_on: bool) -> None:
    """Turn on the spot: turnarounds of equal parts; the last is the dynamic one before a walk."""
    if abs(angle) < 1e-9:
        return
    manners = draft.manners
    count = int(np.ceil(abs(angle) / USUAL_TURN - 1e-9))
    part = angle / count
    seconds = turn_seconds(manners, part)
    side, facing = turning_side(angle), draft.facing
    pivot, footfalls = draft.feet[1 - side], []
    for k in range(count):
        last = walks_on and k == count - 1
        places = turnaround(
            pivot.position,
            facing,
            part,
            hip_width=manners.body.hip_width,
            kind="dynamic" if last else "stationary",
        )
        facing += part
        first, pivot = (
            draft.foot(s, place[[0, 2]], facing)
            for s, place in zip((side, 1 - side), places, strict=True)
        )
        for foot, closes in ((first, False), (pivot, True)):
            footfalls.append(Footfall(foot, "turn", seconds, closes, TURN_LIFT))
    draft.take(footfalls)


def step(draft: Draft, action: Step) -> None:
    """Pairs of steps that move the body: one foot leads, the other closes."""
    if action.distance < NO_WAY:
        return
    most = FARTHEST[action.way] * draft.manners.body.leg_length
    count = int(np.ceil(action.distance / most - 1e-9))
    facing = draft.facing
    along = ahead(facing) if action.way in ("forward", "back") else leftward(facing)
    sign = 1.0 if action.way in ("forward", "left") else -1.0
    move = (sign * action.distance / count) * along[[0, 2]]
    lead = LEFT if action.way == "left" else RIGHT
    left = leftward(facing)
    width = float((draft.feet[LEFT].position - draft.feet[RIGHT].position) @ left)
    for _ in range(count):
        middle = draft.middle + move
        targets = {
            s: draft.foot(s, middle + 0.5 * width * SIDE_SIGN[s] * left[[0, 2]], facing)
            for s in (LEFT, RIGHT)
        }
        draft.take(pair(draft, KINDS[action.way], lead, targets))


def pair(draft: Draft, kind: StepKind, lead: int, targets: dict[int, Footstep]) -> list[Footfall]:
    """One foot leads, the other closes; a foot that closes keeps the kind of the first step."""
    ways = [
        float(np.linalg.norm(targets[s].position - draft.feet[s].position)) for s in (LEFT, RIGHT)
    ]
    return [
        Footfall(
            targets[side],
            kind,
            step_seconds(draft.manners, kind, max(ways), j),
            closes=j == 1,
            lift=CLOSING_LIFT if j and kind == "lateral" else 1.0,
        )
        for j, side in enumerate((lead, 1 - lead))
    ]
