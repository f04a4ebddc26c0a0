"""Walks among things: planned round them, bent past them, and looked over before they are given."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.low import low_obstacles, standing
from gaitsmith.plan.routes import Routes
from gaitsmith.plan.surroundings import Obstacle, Post
from gaitsmith.synthesis.clearance import touches
from gaitsmith.synthesis.dodging import TooTight, dodged

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import StepPlan
    from gaitsmith.plan.surroundings import Surroundings
    from gaitsmith.plan.timeline import Timeline
    from gaitsmith.synthesis.clearance import Touch
    from gaitsmith.synthesis.step import PreparedWalk

    Planner = Callable[[Routes], StepPlan | Timeline]

#: Meters that stay between a body and anything.
APART = 0.004
#: Times that a way is planned anew with more room, and what is added to what was missing.
TRIES, MORE = 6, 0.02


def walk_among(
    planner: Planner,
    prepare: Callable[[StepPlan | Timeline], PreparedWalk],
    body: Body,
    ground: Ground,
    surroundings: Surroundings,
) -> PreparedWalk:
    """Plan and prepare a walk that touches nothing of ``surroundings``.

    What is low enough lies in ``ground``: it is stepped over or on, or walked round where that
    is cheaper or no foot finds a place. See :func:`_walk_past` for the arguments and the rest.
    """
    low = frozenset(one.name for one in low_obstacles(surroundings, body))
    routes = Routes(body, surroundings, low=low)
    past = standing(surroundings, low)
    try:
        return _walk_past(planner, prepare, body, ground, past, routes)
    except InfeasibleError as over:
        if not low:
            raise
        try:
            return _walk_past(
                planner, prepare, body, ground, past, replace(routes, low=frozenset())
            )
        except InfeasibleError:
            raise over from None


def _walk_past(
    planner: Planner,
    prepare: Callable[[StepPlan | Timeline], PreparedWalk],
    body: Body,
    ground: Ground,
    surroundings: Surroundings,
    routes: Routes,
) -> PreparedWalk:
    """Plan and prepare a walk that touches nothing of ``surroundings``.

    Parameters
    ----------
    planner
        Plans the way; asked again with more room where a limb would touch something. A plan that
        does not change then is one that was given, and is refused.
    prepare
        Makes a plan a walk.
    body, ground
        Who walks, on what.
    surroundings
        What may be touched.
    routes
        How to get round it.

    Raises
    ------
    InfeasibleError
        Naming what would be touched, by what and where.
    """
    worst = None
    for _ in range(TRIES):
        plan = planner(routes)
        walk = prepare(plan)
        free = walk
        try:
            walk = dodged(free, body, ground, surroundings)
        except TooTight as tight:
            name = tight.thing.name
            if not isinstance(tight.thing, Post) or name in routes.walked_round:
                raise
            routes = replace(routes, walked_round=routes.walked_round | {name})
            if _same(planner(routes), plan):
                raise
            continue
        found = [t for t in touches(walk, body, ground, surroundings) if t.gap < APART]
        if not found:
            return walk
        worst = min(found, key=lambda touch: touch.gap)
        wider = dict(routes.wider)
        for touch in found:
            if isinstance(touch.thing, Obstacle | Post):
                name = touch.thing.name
                wider[name] = wider.get(name, 0.0) + MORE - touch.gap
        routes, refused = replace(routes, wider=wider), None
        try:
            if not _same(planner(routes), plan):
                continue
        except InfeasibleError as error:
            refused = error
        # there is no more room: perhaps it is enough to hold an arm in
        held = dodged(free, body, ground, surroundings, obstacles=True)
        if all(t.gap >= APART for t in touches(held, body, ground, surroundings)):
            return held
        if refused is not None:
            raise refused
        planner(replace(routes, strict=True))  # perhaps it is a goal that is too near
        break
    raise InfeasibleError(_refusal(worst))


def _same(one: StepPlan | Timeline, other: StepPlan | Timeline) -> bool:
    """Whether both plans set the same footsteps."""
    return (
        one.position.shape == other.position.shape
        and bool((one.position == other.position).all())
        and bool((one.heading == other.heading).all())
    )


def _refusal(touch: Touch | None) -> str:
    if touch is None:
        return "no way was found past the posts; lead it farther from them"
    x, y, z = touch.at
    deep = max(-100.0 * touch.gap, 0.0)
    return (
        f"the {touch.part} would be {deep:.0f} cm inside {touch.thing.name!r} at x,y,z "
        f"{x:.2f},{y:.2f},{z:.2f} m after {touch.time:.1f} s; lead the way or set the feet "
        "farther from it"
    )
