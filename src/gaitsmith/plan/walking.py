"""Walks that a script asks for: from point to point without a stop, along smooth curves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.along import walk_path
from gaitsmith.plan.among import walk_among
from gaitsmith.plan.arrive import BEND, TURN_FIRST, step_to
from gaitsmith.plan.bends import bends_between
from gaitsmith.plan.local import turn
from gaitsmith.plan.manners import gait_of
from gaitsmith.plan.script import Follow
from gaitsmith.plan.ways import NO_WAY, Route, wrapped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.plan.among import Run
    from gaitsmith.plan.draft import Draft
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.script import WalkTo

#: A walk from point to point is stopped where it would turn farther than this.
LARGEST_CORNER = float(np.radians(100.0))
#: A way shorter than this (m) that begins with a turn is taken in steps that turn.
SHORT = 0.8
#: What is left to turn after a turn towards a walk, radians.
NEARLY = float(np.radians(6.0))
#: A way that turns by so much over so many leg lengths is not walked but turned on the spot.
TIGHT = (float(np.radians(60.0)), 0.36)
#: How near to a point the turn of the path counts as that of the point, meters.
NEAR_POINT = 0.3


def walk_on(draft: Draft, group: Sequence[WalkTo | Follow]) -> None:
    """Walk on from point to point without a stop, but where it turns too far."""
    run: Run = []
    here = draft.middle
    heading: float | None = None
    for action in group:
        soft = isinstance(action, Follow)
        points = action.points if isinstance(action, Follow) else (action.point,)
        way = [np.array(p) for p in points]
        gap = way[0] - here
        if np.linalg.norm(gap) < NO_WAY and len(way) == 1:
            continue
        towards = float(np.arctan2(*gap))
        turns = heading is not None and abs(wrapped(towards - heading)) > LARGEST_CORNER
        if run and (turns or gait_of(action.tempo) != gait_of(run[-1][2])):
            _walk(draft, run)
            run = []
        run.append((way, soft, action.tempo))
        heading = float(np.arctan2(*(way[-1] - (way[-2] if len(way) > 1 else here))))
        here = way[-1]
    if run:
        _walk(draft, run)


def _walk(draft: Draft, run: Run) -> None:
    """Walk ``run`` on free ground, or round what stands there."""
    routes = draft.manners.routes
    if routes is None or routes.free:
        walk_through(draft, Route.of(draft.middle, run))
    else:
        walk_among(draft, run)


def walk_through(draft: Draft, route: Route) -> None:
    """Walk the smooth curve through the points of ``route``, from where the person stands.

    Where it turns too sharply to be walked, the walk stops at the point there, turns on the spot
    and goes on.
    """
    before = draft.mark()
    route = route.starting(draft.middle)
    path, points = route.path(), route.points
    aside = wrapped(float(path.heading[0]) - draft.facing)
    if len(points) == 2 and abs(aside) > TURN_FIRST and path.length < SHORT:
        return step_to(draft, points[1], draft.facing + aside)
    if len(points) == 2 and NEARLY < abs(aside) <= TURN_FIRST:
        radius = BEND * draft.manners.body.leg_length
        bent = bends_between(points[0], draft.facing, points[1], None, radius)
        path = min(bent, key=lambda p: p.length, default=path)
    if len(points) > 2 and _tightest(path) > TIGHT[0] / (TIGHT[1] * draft.manners.body.leg_length):
        return _walk_in_parts(draft, path, route)
    try:
        path = _turned_towards(draft, path, route)
        walk_path(draft, path, *route.legs())
    except InfeasibleError:
        if len(points) < 3:
            raise
        draft.back_to(before)
        _walk_in_parts(draft, path, route)
    return None


def _walk_in_parts(draft: Draft, path: Path, route: Route) -> None:
    """Stop at the point where the way turns most."""
    for part in route.cut(_sharpest(path, route.points)):
        walk_through(draft, part)


def _turned_towards(draft: Draft, path: Path, route: Route) -> Path:
    """The path from where the person stands after a turn to where it leads, if that is needed.

    A turn moves the body, so the way after it leads elsewhere: three times is near enough.
    """
    before, aside = draft.mark(), wrapped(float(path.heading[0]) - draft.facing)
    if abs(aside) <= TURN_FIRST:
        return path
    for _ in range(3):
        draft.back_to(before)
        turn(draft, aside, walks_on=True)
        path = route.starting(draft.middle).path()
        missed = wrapped(float(path.heading[0]) - draft.facing)
        if abs(missed) < NEARLY:
            return path
        aside += missed
    # the way is short: turn about the middle of the feet, which stays
    draft.back_to(before)
    path = route.path()
    step_to(draft, draft.middle, draft.facing + wrapped(float(path.heading[0]) - draft.facing))
    return path


def _tightest(path: Path) -> float:
    """Largest turn over a way of :data:`NEAR_POINT`, radians per meter."""
    if path.straight:
        return 0.0
    bends = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.heading)))])
    turned = np.interp(path.along + NEAR_POINT, path.along, bends) - bends
    return float(turned.max()) / NEAR_POINT


def _sharpest(path: Path, points: Float[np.ndarray, "n 2"]) -> int:
    """Index of the inner point of a path near which it turns most."""
    gaps = np.linalg.norm(path.points[:, None] - points[None, 1:-1], axis=-1)
    bends = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path.heading)))])
    there = path.along[gaps.argmin(axis=0)]
    turned = [np.interp(there + d, path.along, bends) for d in (NEAR_POINT, -NEAR_POINT)]
    return 1 + int((turned[0] - turned[1]).argmax())
