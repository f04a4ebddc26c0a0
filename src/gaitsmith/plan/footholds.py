"""Footholds on stepped ground: where along the path each foot is set, and how long steps take.

Steps cannot all be equal where there are treads. The way is cut into a fine grid of places for
either foot; the cheapest walk over them is found by dynamic programming: steps near the usual
length, soles borne whole, no rise higher than it must be.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.ground import Flat, Slope
from gaitsmith.plan.footing import Footing, footing, never_sinks
from gaitsmith.plan.lengths import FIRST_STEP, Stance
from gaitsmith.plan.nearest import nearest_stand, said

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.paths import Path

#: Grid of places along the way, meters.
GRID = 0.01
#: Shortest and longest step, over the leg.
SHORTEST, LONGEST = 0.16, 1.0
#: Highest rise or drop of one step, over the leg.
HIGHEST = 0.27
#: Steepest ground to stand on, radians.
STEEPEST = float(np.radians(30.0))
#: Share of the sole that may hang over; where treads are shorter than the foot. Meters that its
#: line may sink in between heel and ball; where there is nothing better, as on a ridge.
MOST_HANGING, SHORT_TREADS = 0.25, 0.35
MOST_SUNK, ON_RIDGES = 0.008, 0.016
#: What footholds may have, in the order in which a way is sought.
ALLOWED = ((MOST_HANGING, MOST_SUNK), (SHORT_TREADS, MOST_SUNK), (SHORT_TREADS, ON_RIDGES))
#: Largest turn of the walk in one step, radians.
LARGEST_TURN = float(np.radians(60.0))
#: The last step is shorter by this.
LAST_STEP = 0.15
#: What a step costs beside the square of its length's relative error: rise over leg squared,
#: hanging share squared, crowding, roughness per centimeter squared.
RISE, HANGING, CROWDED, ROUGH = 60.0, 3.0, 0.25, 0.02
#: Steps longer than usual cost so many times more than shorter ones.
LONGER = 4.0
#: Usual step over a full rise is shorter by this. A foot pays so much for a riser close behind
#: its heel, which has to pass it as it comes down.
SHORTER, BEHIND = 0.35, 0.6
#: Samples, 5 mm apart, over which a jump of the ground is told from a slope.
WINDOW = 8
#: Time of a step up or down over one on the level, at a rise of a fifth of the leg.
SLOWER_UP, SLOWER_DOWN, FULL_RISE = 0.28, 0.14, 0.18
#: The same where a foot swings over something as high.
SLOWER_OVER = 0.28
#: A step on the level lasts as after this part of the rise before it.
LINGERS = 0.7


@dataclass(frozen=True, eq=False)
class Places:
    """Places for the left and the right foot along a way, ``(2, M)`` each but ``along``."""

    along: Float[np.ndarray, "M"]
    heading: Float[np.ndarray, "M"]
    footings: tuple[Footing, Footing]

    @staticmethod
    def of(path: Path, stance: Stance, ground: Ground, body: Body) -> Places:
        """The grid over ``path``, from its first to its last point."""
        along = np.linspace(0.0, path.length, max(2, round(path.length / GRID)) + 1)
        middle, heading = path.at(along), path.heading_at(along)
        left = leftward(heading)[:, [0, 2]]
        sides = []
        for side in (0, 1):
            place = middle + 0.5 * stance.width * SIDE_SIGN[side] * left
            facing = heading + SIDE_SIGN[side] * stance.toe_out[side]  # type: ignore[index]
            sides.append(footing(ground, place, facing, body.foot))
        return Places(along, heading, (sides[0], sides[1]))


def treads_near(path: Path, stance: Stance, ground: Ground, body: Body) -> bool:
    """Whether there are places along ``path`` where no foot stands: edges, or sharp ridges."""
    if isinstance(ground, Flat | Slope):
        return False
    if ground.stepped:
        middle = path.at(np.linspace(0.0, path.length, max(2, int(path.length / 0.1)) + 1))
        reach = 0.5 * body.leg_length
        (x0, z0), (x1, z1) = middle.min(0) - reach, middle.max(0) + reach
        return len(ground.edges((float(x0), float(z0)), (float(x1), float(z1)))) > 0
    if never_sinks(ground, body.foot, MOST_SUNK):
        return False
    places = Places.of(path, stance, ground, body)
    return not all((f.stands & (f.sinks <= MOST_SUNK)).all() for f in places.footings)


@dataclass(frozen=True, eq=False)
class Treading:
    """Landings along a way: arc lengths (the first where both feet stand), times over level."""

    along: Float[np.ndarray, "n"]
    lasting: Float[np.ndarray, "n-1"]


def tread(
    path: Path,
    *,
    length: float,
    stance: Stance,
    ground: Ground,
    body: Body,
    stop: str,
    first: int,
    share: Float[np.ndarray, "K"] | None = None,
) -> Treading:
    """Where steps land along ``path``, from its first point on.

    Parameters
    ----------
    path, length, stance, ground, body, stop, first
        As of :func:`gaitsmith.plan.follow.follow`; ``length`` is the usual step length.
    share
        Step length over the usual one that curves and slopes ask for, evenly along the path.

    Raises
    ------
    InfeasibleError
        Where there is no way on: a rise too high, ground too steep, or no place for a foot
        within a step.
    """
    places = Places.of(path, stance, ground, body)
    for allowed in ALLOWED:
        found = _cheapest(places, length, body, stop, first, share, allowed)
        if found is not None:
            break
    else:
        raise _no_way(path, places, length, body, ground, stop, first, stance)
    index, sides = found
    height = np.array([places.footings[s].height[j] for s, j in zip(sides, index, strict=True)])
    full = FULL_RISE * body.leg_length
    rise = np.diff(height) / full
    # the foot that swings rises with the step before too
    before = LINGERS * np.append(0.0, rise[:-1])
    rise = np.where(np.abs(before) > np.abs(rise), before, rise)
    up = SLOWER_UP * np.clip(rise, 0.0, 1.3)
    down = SLOWER_DOWN * np.clip(-rise, 0.0, 1.3)
    over = SLOWER_OVER * np.clip(_over(places, path, ground, index, height) / full, 0.0, 1.3)
    return Treading(places.along[index], 1.0 + np.maximum(up + down, over))


def _over(
    places: Places,
    path: Path,
    ground: Ground,
    index: list[int],
    height: Float[np.ndarray, "n"],
) -> Float[np.ndarray, "n-1"]:
    """Meters that each swing leads over ground higher than both its ends."""
    middle = path.at(places.along)
    level = ground.height(middle[:, 0], middle[:, 1])
    out = np.zeros(len(index) - 1)
    for k in range(1, len(index)):
        before = max(k - 2, 0)
        top = float(level[index[before] : index[k] + 1].max())
        out[k - 1] = max(top - max(float(height[before]), float(height[k])), 0.0)
    return out


def _cheapest(
    places: Places,
    length: float,
    body: Body,
    stop: str,
    first: int,
    share: Float[np.ndarray, "K"] | None,
    allowed: tuple[float, float],
    *,
    furthest: list[int] | None = None,
) -> tuple[list[int], list[int]] | None:
    """Indices and sides of the landings of the cheapest walk, None if there is none."""
    count, leg = len(places.along), body.leg_length
    cell = float(places.along[1] - places.along[0])
    least = max(1, int(np.ceil(SHORTEST * leg / cell)))
    far = min(count - 1, int(np.floor(LONGEST * leg / cell)))
    usual = np.full(count, length)
    if share is not None:
        usual = length * np.interp(
            np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, len(share)), share
        )
    if stop == "stand":
        usual[-max(1, int(0.5 * length / cell)) :] *= 1.0 - LAST_STEP
    height = np.stack([f.height for f in places.footings])
    hanging, sunk = allowed
    free = np.stack([f.stands & (f.hangs <= hanging) & (f.sinks <= sunk) for f in places.footings])
    for end in (0, -1):  # where the path begins and ends there is no choice
        free[:, end] = [
            f.stands[end] & (f.hangs[end] <= hanging) & (f.sinks[end] <= ON_RIDGES)
            for f in places.footings
        ]
    free &= np.stack([f.slope <= np.tan(STEEPEST) + 1e-9 for f in places.footings])
    own = np.stack(
        [
            HANGING * f.hangs**2 + CROWDED * f.crowded + ROUGH * (100.0 * f.rough) ** 2
            for f in places.footings
        ]
    )
    behind = np.stack([f.behind for f in places.footings])
    cost = np.full((2, count), np.inf)
    came = np.full((2, count), -1)
    back = np.arange(least, far + 1)
    other = 1 - first
    if not free[other, 0]:
        return None
    cost[other, 0] = 0.0
    for j in range(1, count):
        near = back[back <= j]
        if j == count - 1 and not len(near):
            near = np.array([j])
        if not len(near):
            continue
        i = j - near
        turn = np.abs(places.heading[j] - places.heading[i])
        stretch = near * cell / (0.5 * (usual[i] + usual[j]))
        stretch = np.where(i == 0, stretch / FIRST_STEP, stretch)
        for side in (0, 1):
            if not free[side, j]:
                continue
            rise = (height[side, j] - height[1 - side, i]) / leg
            shorter = 1.0 - SHORTER * np.minimum(np.abs(rise) / FULL_RISE, 1.0)
            off = stretch / shorter - 1.0
            off = np.where(off > 0.0, LONGER, 1.0) * off**2
            new = cost[1 - side, i] + off + RISE * rise**2
            new += own[side, j] + BEHIND * behind[side, j]
            new[(np.abs(rise) > HIGHEST + 1e-9) | (turn > LARGEST_TURN)] = np.inf
            k = int(new.argmin())
            if new[k] < cost[side, j]:
                cost[side, j], came[side, j] = new[k], i[k]
    if furthest is not None:
        furthest.append(int(np.flatnonzero(np.isfinite(cost).any(0)).max()))
    if stop == "stand":
        ends = [count - 1]
        ok = free[:, -1].all()
    else:
        ends = list(range(max(1, count - far), count))
        ok = True
    best, end = np.inf, None
    for j in ends if ok else []:
        left = (count - 1 - j) * cell / length  # a walk goes on to the last landing on the path
        for side in (0, 1):
            value = cost[side, j] + (left if stop != "stand" else 0.0)
            if value < best:
                best, end = value, (side, j)
    if end is None or not np.isfinite(best):
        return None
    side, j = end
    index, sides = [], []
    while j >= 0:
        index.append(j)
        sides.append(side)
        j, side = int(came[side, j]), 1 - side
    return index[::-1], sides[::-1]


def _no_way(
    path: Path,
    places: Places,
    length: float,
    body: Body,
    ground: Ground,
    stop: str,
    first: int,
    stance: Stance,
) -> InfeasibleError:
    """Why there is no way on, where, and what would do."""
    furthest: list[int] = []
    _cheapest(places, length, body, "walk", first, None, ALLOWED[-1], furthest=furthest)
    j = furthest[0] if furthest else 0
    last = len(places.along) - 1
    ends = [("begins", 0)] + ([("ends", last)] if stop == "stand" else [])
    for word, k in ends:
        if all(f.stands[k] and f.hangs[k] <= SHORT_TREADS for f in places.footings):
            continue
        middle, way = path.at(places.along[[k]])[0], float(places.heading[k])
        aside = 0.5 * stance.width * leftward(way)[[0, 2]]
        feet = middle + np.array(SIDE_SIGN)[:, None] * aside
        facing = way + np.array(SIDE_SIGN) * np.array(stance.toe_out)
        near = nearest_stand(ground, body, feet, facing, ahead(way)[[0, 2]])
        return InfeasibleError(
            f"the path {word} at ({middle[0]:.2f}, {middle[1]:.2f}), where feet cannot stand side "
            f"by side: an edge is under them or before them{said(near, 'it')}"
        )
    reach, limit = LONGEST * body.leg_length, HIGHEST * body.leg_length
    s = float(places.along[j]) + np.arange(0.0, reach, 0.005)
    at = path.at(s[s <= path.length])
    level = ground.height(at[:, 0], at[:, 1])
    jump = level[WINDOW:] - level[:-WINDOW]
    high = np.flatnonzero(np.abs(jump) > limit)
    if high.size:
        k = int(high[0])
        x, z = at[k + WINDOW]
        return InfeasibleError(
            f"the ground {'rises' if jump[k] > 0.0 else 'drops'} by {np.abs(jump).max():.2f} m at "
            f"({x:.2f}, {z:.2f}), more than the {limit:.2f} m that this body steps at once; lead "
            "the path round it, or make it lower"
        )
    slopes = np.array([f.slope for f in places.footings])[:, j : j + round(reach / GRID)].min(0)
    if np.median(slopes) > np.tan(STEEPEST):
        x, z = at[len(at) // 2]
        return InfeasibleError(
            f"the ground at ({x:.2f}, {z:.2f}) slopes by "
            f"{np.degrees(np.arctan(np.median(slopes))):.0f} deg, more than the "
            f"{np.degrees(STEEPEST):.0f} deg that can be walked on; lead the path round it"
        )
    x, z = at[0]
    return InfeasibleError(
        f"no place for a foot of {body.foot.length:.2f} m within a step of {reach:.2f} m beyond "
        f"({x:.2f}, {z:.2f}): treads too short, a gap, or steps of more than {limit:.2f} m; lead "
        "the path round it"
    )
