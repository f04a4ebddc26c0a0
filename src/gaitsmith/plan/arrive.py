"""``be at``: walking, local steps, backing up, side stepping and turning, whichever is shortest.

Ways are planned with what each can do, the dearest are left out, the cheapest is taken: a way
costs its footfalls, its time, and what people avoid (backing up far, side stepping far).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.plan.along import walk_path
from gaitsmith.plan.among import TURN_FIRST, walk_among
from gaitsmith.plan.bends import bends_between
from gaitsmith.plan.chains import Chain, Standing, chains_between
from gaitsmith.plan.draft import AFTER_WALK, BEFORE_WALK, Footfall
from gaitsmith.plan.follow import count_steps
from gaitsmith.plan.local import CLOSING_LIFT, TURN_LIFT, step_seconds, turn_seconds
from gaitsmith.plan.manners import gait_of
from gaitsmith.plan.placing import OUTWARD
from gaitsmith.plan.routes import is_blocked
from gaitsmith.plan.stepping import TOUCHING, step_region
from gaitsmith.plan.ways import goals_of, wrapped

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.draft import Draft
    from gaitsmith.plan.footsteps import Footstep
    from gaitsmith.plan.manners import Manners
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.script import BeAt, Tempo

#: What a second costs, over a footfall.
SECOND = 0.7
#: Meters that people back up, side-step and go in single steps without a thought, and what each
#: further one costs: where it is farther they turn and walk.
BACK, ASIDE, SINGLE = (1.0, 4.0), (0.9, 8.0), (1.0, 3.0)
#: What a radian of turning costs, to and fro.
TURNED = 0.3
#: Rough seconds of a local step and of a step of a walk, where ways are compared.
LOCAL_SECONDS, WALK_SECONDS = 0.75, 0.57
#: Ways shorter than this are not walked, longer than this are (m).
WALKED, STEPPED = 0.5, 2.6
#: Radius of the bends of a walk to a place nearby, over the leg.
BEND = 0.75
#: A foot that lands within this of side by side (m) and turns by more than this turns on the spot.
BESIDE, TURNS = 0.12, float(np.radians(12.0))
#: Least distance of the feet across a way that is walked at once, over the step width.
LEAST_APART = 0.6
#: Meters between the points of a way that are looked at for what stands there.
CLEAR_EVERY = 0.02
#: Widest stance that is a goal, over the leg.
WIDEST = 0.8


@dataclass(frozen=True, eq=False)
class _Way:
    """Local steps, a walk, local steps; any of them may be missing."""

    cost: float
    before: Chain | None
    path: Path | None = None
    after: Chain | None = None


def be_at(draft: Draft, action: BeAt) -> None:
    """Plan the way to where ``action`` wants the feet.

    Raises
    ------
    InfeasibleError
        If nobody can stand so, or there is no way; it names the nearest stance that works.
    """
    _reach(draft, _goal(draft, action), action.tempo)


def step_to(draft: Draft, place: Float[np.ndarray, "2"], facing: float) -> None:
    """To standing side by side at x, z, facing ``facing``."""
    _reach(draft, _side_by_side(draft.manners, place, facing))


def _reach(draft: Draft, goal: Standing, tempo: Tempo | None = None) -> None:
    routes = draft.manners.routes
    if routes is not None and not routes.free:
        routes.check_goal(draft.middle, goal.middle)
        if is_blocked(routes, draft.middle, goal.middle):
            walk_among(draft, [([goal.middle], False, tempo)])
            goal = _unwound(goal, draft.facing)
    begin = standing(draft.feet)
    moved = np.abs(goal.place - begin.place).max() + np.abs(goal.heading - begin.heading).max()
    if moved < 1e-9:
        return
    ways = _ways(draft, begin, goal, tempo)
    for way in sorted(ways, key=lambda w: w.cost):
        before = draft.mark()
        try:
            _take(draft, way, tempo)
        except InfeasibleError:
            draft.back_to(before)
            continue
        return
    raise InfeasibleError(_no_way(draft, begin, goal))


def standing(feet: dict[int, Footstep]) -> Standing:
    """Where both feet are."""
    both = [feet[s] for s in (LEFT, RIGHT)]
    return Standing(
        place=np.stack([f.position[[0, 2]] for f in both]),
        heading=np.array([f.heading for f in both]),
        direction=np.array([f.direction for f in both]),
    )


def _goal(draft: Draft, action: BeAt) -> Standing:
    """Feet and direction in the end, headings as many times round as the person is."""
    goals = goals_of(action, draft.facing, draft.manners.stance)
    place = np.stack([goals[s][0] for s in (LEFT, RIGHT)])
    heading = np.array([goals[s][1] for s in (LEFT, RIGHT)])
    heading[1] = heading[0] + wrapped(heading[1] - heading[0])
    facing = float(heading.mean())
    goal = _unwound(Standing(place, heading, np.full(2, facing)), draft.facing)
    _check(draft, goal)
    return goal


def _unwound(goal: Standing, facing: float) -> Standing:
    """``goal`` with headings as many times round as ``facing``."""
    whole = facing + wrapped(goal.facing - facing) - goal.facing
    return replace(goal, heading=goal.heading + whole, direction=goal.direction + whole)


def _check(draft: Draft, goal: Standing) -> None:
    """Refuse feet that nobody can stand on."""
    body, foot = draft.manners.body, draft.manners.body.foot
    gap = goal.place[0] - goal.place[1]
    left = np.array([np.cos(goal.facing), -np.sin(goal.facing)])
    apart = float(
        feet_apart(
            goal.place[:1],
            goal.heading[:1],
            goal.place[1:],
            goal.heading[1:],
            back=foot.heel,
            front=foot.ball + foot.toes,
        )[0]
    )
    why = None
    if apart < TOUCHING:
        why = f"the feet's axes would be {apart:.3f} m apart, they need {TOUCHING:g} m"
    elif float(gap @ left) < 0.0:
        why = "the legs would cross"
    elif float(np.hypot(*gap)) > WIDEST * body.leg_length:
        why = (
            f"the feet would be {np.hypot(*gap):.2f} m apart, legs reach "
            f"{WIDEST * body.leg_length:.2f} m"
        )
    elif abs(float(goal.heading[0] - goal.heading[1])) > np.radians(100.0):
        why = f"the feet would be turned {np.degrees(np.ptp(goal.heading)):.0f} deg apart"
    if why is not None:
        raise InfeasibleError(f"nobody stands so: {why}; {_nearest(draft, goal)}")


def _nearest(draft: Draft, goal: Standing) -> str:
    """The stance beside each other nearest to ``goal``, as it is written."""
    left = np.array([np.cos(goal.facing), -np.sin(goal.facing)])
    toe_out = np.array(draft.manners.stance.toe_out)
    feet = [
        goal.middle + 0.5 * draft.manners.stance.width * SIDE_SIGN[s] * left for s in (LEFT, RIGHT)
    ]
    heading = np.degrees(goal.facing + SIDE_SIGN * toe_out)
    written = " ".join(
        f"{SIDES[s][0].upper()} {feet[s][0]:.3f},{feet[s][1]:.3f},{heading[s]:.1f}"
        for s in (LEFT, RIGHT)
    )
    return f"the nearest that works is: feet {written}"


def _no_way(draft: Draft, begin: Standing, goal: Standing) -> str:
    far = float(np.hypot(*(goal.middle - begin.middle)))
    return (
        f"no way leads from the feet as they stand to that stance, {far:.2f} m away; "
        f"{_nearest(draft, goal)}"
    )


# ----------------------------------------------------------------------------------- ways


def _ways(draft: Draft, begin: Standing, goal: Standing, tempo: Tempo | None) -> list[_Way]:
    """Every way that is not plainly dearer than another."""
    manners = draft.manners
    body, stance = manners.body, manners.stance
    far = float(np.hypot(*(goal.middle - begin.middle)))
    out = []
    if far < STEPPED:
        out = [_Way(_cost(chain), chain) for chain in chains_between(begin, goal, body, stance)]
    if far > WALKED:
        out += _walks(draft, begin, goal, tempo, min((w.cost for w in out), default=np.inf))
    return out


def _cost(chain: Chain | None) -> float:
    if chain is None:
        return 0.0
    avoided = sum(
        each * max(0.0, size - free)
        for size, (free, each) in (
            (chain.back, BACK),
            (chain.aside, ASIDE),
            (chain.way, SINGLE),
        )
    )
    avoided += TURNED * chain.turned
    return len(chain) * (1.0 + SECOND * LOCAL_SECONDS) + avoided


def _walks(
    draft: Draft, begin: Standing, goal: Standing, tempo: Tempo | None, bar: float
) -> list[_Way]:
    """A walk, straight or with bends, with turns on the spot before and after where needed."""
    manners = draft.manners
    radius = BEND * manners.body.leg_length
    places = begin.middle, goal.middle
    out = []
    for heading in (begin.facing, None):
        for arrival in (goal.facing, None):
            for path in bends_between(places[0], heading, places[1], arrival, radius):
                out += _walk(draft, begin, goal, path, tempo, bar)
                bar = min([bar, *(w.cost for w in out)])
    return out


def _walk(
    draft: Draft, begin: Standing, goal: Standing, path: Path, tempo: Tempo | None, bar: float
) -> list[_Way]:
    """The walk along ``path`` with turns before and after, unless dearer than ``bar``."""
    routes = draft.manners.routes
    if routes is not None and not routes.free:
        count = int(np.ceil(path.length / CLEAR_EVERY)) + 1
        if not routes.is_clear(path.at(np.linspace(0.0, path.length, count))):
            return []
    manners = draft.manners.in_gait(gait_of(tempo))
    pace = manners.pace_at(tempo)
    walked = (path.length / pace.step_length + 1.0) * (1.0 + SECOND * WALK_SECONDS)
    aside = wrapped(float(path.heading[0]) - begin.facing)
    beyond = wrapped(goal.facing - float(path.heading[-1]))
    turns = sum(np.ceil(abs(a) / OUTWARD - 1e-9) for a in (aside, beyond) if abs(a) > 1e-9)
    if abs(aside) <= TURN_FIRST and aside != 0.0:
        turns -= 1
    if walked + 2.0 * turns * (1.0 + SECOND * LOCAL_SECONDS) > bar:
        return []
    # seen along the way the feet must be on their own sides, or one would walk through the other
    across = np.array([np.cos(path.heading[0]), -np.sin(path.heading[0])])
    apart = float((begin.place[0] - begin.place[1]) @ across)
    if abs(aside) <= TURN_FIRST and apart < LEAST_APART * manners.stance.width:
        return []
    steps = count_steps(path, pace, keep_cadence=manners.keeps(tempo))
    cost = steps * (1.0 + SECOND * WALK_SECONDS)
    before = after = None
    if abs(aside) > TURN_FIRST:
        there = _side_by_side(draft.manners, begin.middle, begin.facing + aside)
        before = _cheapest(draft, begin, there)
        if before is None:
            return []
        cost += SECOND * BEFORE_WALK
    arrived = _side_by_side(manners, goal.middle, float(path.heading[-1]))
    missing = np.abs(wrapped(goal.heading[0] - arrived.heading[0]))
    if missing > 1e-6 or np.abs(goal.place - arrived.place).max() > 1e-6:
        turned = replace(
            arrived,
            heading=arrived.heading + (goal.facing - beyond) - arrived.facing,
            direction=np.full(2, goal.facing - beyond),
        )
        after = _cheapest(draft, turned, goal)
        if after is None:
            return []
        cost += SECOND * AFTER_WALK
    return [_Way(cost + _cost(before) + _cost(after), before, path, after)]


def _side_by_side(manners: Manners, middle: Float[np.ndarray, "2"], facing: float) -> Standing:
    stance = manners.stance
    left = np.array([np.cos(facing), -np.sin(facing)])
    return Standing(
        place=middle + 0.5 * stance.width * SIDE_SIGN[:, None] * left,
        heading=facing + SIDE_SIGN * np.array(stance.toe_out),
        direction=np.full(2, facing),
    )


def _cheapest(draft: Draft, begin: Standing, end: Standing) -> Chain | None:
    manners = draft.manners
    found = chains_between(begin, end, manners.body, manners.stance, on_the_spot=True)
    return min(found, key=_cost, default=None)


# --------------------------------------------------------------------------------- taking


def _take(draft: Draft, way: _Way, tempo: Tempo | None) -> None:
    """Plan a way that was chosen."""
    if way.before is not None:
        draft.take(footfalls_of(draft, way.before))
    if way.path is not None:
        walk_path(draft, way.path, tempi=(tempo,))
    if way.after is not None:
        # as many times round as the walk has left the person
        whole = 2.0 * np.pi * np.round((draft.facing - way.after.began) / (2.0 * np.pi))
        draft.take(footfalls_of(draft, way.after, whole))


def footfalls_of(draft: Draft, chain: Chain, whole: float = 0.0) -> list[Footfall]:
    """Kinds and durations of the steps of a chain."""
    manners, feet = draft.manners, dict(draft.feet)
    foot = manners.body.foot
    out: list[Footfall] = []
    kind: StepKind = "turn"
    for i, closes in enumerate(chain.closes):
        side = int(chain.side[i])
        target = draft.foot(
            side,
            chain.feet.place[i],
            float(chain.feet.direction[i]) + whole,
            float(chain.feet.heading[i]) + whole,
        )
        stance = feet[1 - side]
        first = i == 0 or out[-1].closes
        if not closes or first:
            kind = _kind(stance, target, foot.heel, manners.stance.width)
        turned = abs(target.direction - feet[side].direction)
        way = float(np.linalg.norm(target.position - feet[side].position))
        seconds = (
            turn_seconds(manners, turned)
            if kind == "turn"
            else max(
                step_seconds(manners, kind, way, 1 if closes else 0 if first else 2),
                turn_seconds(manners, turned),
            )
        )
        lift = (
            TURN_LIFT if kind == "turn" else CLOSING_LIFT if closes and kind == "lateral" else 1.0
        )
        out.append(Footfall(target, kind, seconds, closes, TURN_LIFT if kind == "turn" else lift))
        feet[side] = target
    return out


def _kind(stance: Footstep, target: Footstep, heel: float, width: float) -> StepKind:
    """Turn on the spot, or the region of the step."""
    sign = float(SIDE_SIGN[target.side])
    sin, cos = np.sin(stance.direction), np.cos(stance.direction)
    x, _, z = target.position - stance.position
    along, aside = x * sin + z * cos, sign * (x * cos - z * sin)
    turned = target.direction - stance.direction
    if abs(turned) > TURNS and abs(along) < BESIDE and abs(aside - width) < BESIDE:
        return "turn"
    x -= heel * (np.sin(target.direction) - sin)
    z -= heel * (np.cos(target.direction) - cos)
    angle = float(np.arctan2(sign * (x * cos - z * sin), x * sin + z * cos))
    return step_region(angle, turned) or "lateral"
