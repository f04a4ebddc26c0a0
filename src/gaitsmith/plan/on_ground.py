"""Plans put on the ground: how high every footstep is, and whether a foot can stand there."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES, ahead
from gaitsmith.errors import GaitsmithWarning, InfeasibleError
from gaitsmith.ground import Flat, Slope
from gaitsmith.plan.footholds import HIGHEST, MOST_HANGING, MOST_SUNK, SHORT_TREADS, STEEPEST
from gaitsmith.plan.footing import footing, never_sinks
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.nearest import nearest_stand, said

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.plan.timeline import Timeline

#: Soles that sink in deeper than this between their bearing points are spoken of, meters.
SINKS = 0.0005
#: Steps (m) and their largest number by which feet that stand side by side on a ridge are set
#: apart, and rises (m) that are not climbed for it.
APART, MOST_APART, HARDLY = 0.02, 5, 0.03


def on_ground(plan: StepPlan | Timeline, body: Body, ground: Ground) -> StepPlan | Timeline:
    """``plan`` with the heights that ``ground`` gives its footsteps; itself on level ground.

    N is where a foot whose heel and ball touch has it.

    Raises
    ------
    InfeasibleError
        Naming the footstep, the place, what it needs and the limit, where no foot can stand, or
        a step is too high.

    Warns
    -----
    GaitsmithWarning
        Where the ground is curved under a sole, which is stiff.
    """
    if isinstance(ground, Flat):
        return plan
    if isinstance(plan, StepPlan):
        plan = _off_ridges(plan, body, ground)
        height = _heights(plan.position, plan.heading, plan.side, body, ground)
        position = np.array(plan.position)
        position[:, 1] = height
        rises = np.abs(np.diff(height))
        rises[0] = 0.0
        if ground.stepped:
            _check_rises(rises, position[1:], body)
        return replace(plan, position=position)
    return _timeline(plan, body, ground)


def _off_ridges(plan: StepPlan, body: Body, ground: Ground) -> StepPlan:
    """``plan`` whose feet do not stand on a ridge where a path begins and ends.

    Feet that stand side by side there are set apart fore and aft, as little as does and rather one
    ahead and one back, so that their middle stays. Given footsteps are where they are said to be.
    """
    if plan.path is None or isinstance(ground, Slope) or never_sinks(ground, body.foot, MOST_SUNK):
        return plan
    swings = int(plan.side[0] != plan.side[2])  # which of the first two: it stands behind
    ends = [[swings, 1 - swings]] * (plan.kinds[0] == "start")
    ends += [[-2, -1]] * (plan.kinds[-1] == "stop")
    position = np.array(plan.position)
    ways = np.concatenate([[0.0], *([d, -d] for d in np.arange(1, MOST_APART + 1) * APART)])
    rear, front = (w.ravel() for w in np.meshgrid(ways, ways, indexing="ij"))
    cost = np.abs(rear) + np.abs(front) + 0.5 * np.abs(rear + front)
    order = np.arange(len(position))
    for pair in ends:
        fits = []
        for i in pair:
            way = ahead(np.array(plan.direction[i]))[[0, 2]]
            place = position[i, [0, 2]] + ways[:, None] * way
            heading = np.full(len(ways), plan.heading[i])
            found = footing(ground, place, heading, body.foot)
            good = found.stands & (found.hangs <= MOST_HANGING) & (found.sinks <= MOST_SUNK)
            good &= found.slope <= np.tan(STEEPEST)
            fits.append(good & (np.abs(found.height - found.height[0]) <= HARDLY))
        both = (fits[0][:, None] & fits[1][None, :]).ravel() & (rear <= front)
        if both[0] or not both.any():
            continue
        best = int(np.where(both, cost, np.inf).argmin())
        for i, by in zip(pair, (rear[best], front[best]), strict=True):
            position[i] += by * ahead(np.array(plan.direction[i]))
        if pair[0] == swings:
            order[:2] = pair  # of those that stand the rear one comes first
    return replace(
        plan, side=plan.side[order], heading=plan.heading[order], position=position[order]
    )


def _timeline(plan: Timeline, body: Body, ground: Ground) -> Timeline:
    named = ("stance", "origin", "target", "before", "following")
    feet = {id(f): f for s in plan.planned for n in named if (f := getattr(s, n)) is not None}
    each = list(feet.values())
    place = np.array([f.position for f in each])
    heading, side = np.array([f.heading for f in each]), np.array([f.side for f in each])
    place[:, 1] = _heights(place, heading, side, body, ground, led=True)
    new = {id(f): replace(f, position=p) for f, p in zip(each, place, strict=True)}

    def moved(foot: Footstep | None) -> Footstep | None:
        return None if foot is None else new[id(foot)]

    def lifted(step: PlannedStep) -> PlannedStep:
        return replace(step, **{n: moved(getattr(step, n)) for n in named})

    planned = tuple(lifted(s) for s in plan.planned)
    rises = np.array([abs(float(s.target.position[1] - s.stance.position[1])) for s in planned])
    if ground.stepped:
        _check_rises(rises, np.array([s.target.position for s in planned]), body)
    return replace(plan, planned=planned)


def _heights(
    position: Float[np.ndarray, "N 3"],
    heading: Float[np.ndarray, "N"],
    side: np.ndarray,
    body: Body,
    ground: Ground,
    *,
    led: bool = False,
) -> Float[np.ndarray, "N"]:
    """Heights of N; refuses places where no foot stands. ``led``: by a script."""
    found = footing(ground, position[:, [0, 2]], heading, body.foot)
    steep = found.slope > np.tan(STEEPEST) + 1e-9
    bad = steep | ~found.stands | (found.hangs > SHORT_TREADS)
    if bad.any():
        # what can be changed of a script is where it leads to
        last = len(bad) - 2
        i = last + int(bad[last:].argmax()) if led and bad[last:].any() else int(bad.argmax())
        what = (
            f"footstep {i + 1} ({SIDES[side[i]]}) at ({position[i, 0]:.2f}, {position[i, 2]:.2f})"
        )
        # feet that stand where the way ends are moved together
        feet = [i] if i < last else [last, last + 1]
        near = None
        if not isinstance(ground, Slope):
            near = nearest_stand(ground, body, position[feet][:, [0, 2]], heading[feet])
        elsewhere = said(near, "it" if len(feet) == 1 else "the middle of both feet")
        if steep[i]:
            raise InfeasibleError(
                f"{what}: the ground slopes by {np.degrees(np.arctan(found.slope[i])):.3g} deg, "
                f"more than the {np.degrees(STEEPEST):.0f} deg that can be walked on"
                + ("; make it less steep, or stairs" if isinstance(ground, Slope) else elsewhere)
            )
        if found.stands[i]:
            raise InfeasibleError(
                f"{what}: {100 * found.hangs[i]:.0f} % of the sole would hang over an edge, more "
                f"than {100 * SHORT_TREADS:.0f} %{elsewhere}"
            )
        raise InfeasibleError(
            f"{what}: a foot of {body.foot.length:.2f} m cannot stand there: an edge or a bump is "
            f"under its ball or in its way{elsewhere}"
        )
    if (deepest := float(found.sinks.max())) > SINKS:
        warnings.warn(
            f"the ground is curved: soles, which are stiff, sink in by up to {1e3 * deepest:.1f} "
            "mm between heel and ball",
            GaitsmithWarning,
            stacklevel=4,
        )
    return found.height


def _check_rises(
    rises: Float[np.ndarray, "n"], targets: Float[np.ndarray, "n 3"], body: Body
) -> None:
    limit = HIGHEST * body.leg_length
    if (rises > limit + 1e-9).any():
        i = int(rises.argmax())
        raise InfeasibleError(
            f"the step to ({targets[i, 0]:.2f}, {targets[i, 2]:.2f}) rises or drops by "
            f"{rises[i]:.2f} m, more than the {limit:.2f} m that this body steps at once; lead "
            "the way round, or make it lower"
        )
