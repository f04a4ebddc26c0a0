"""Ways round obstacles: the shortest that keeps the body's width clear of all of them."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.body.bulk import half_width
from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.low import FEET, cost_over
from gaitsmith.plan.paths import Path
from gaitsmith.plan.ways import NO_WAY, path_through

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float
    from shapely import Polygon
    from shapely.geometry.base import BaseGeometry

    from gaitsmith.body.body import Body
    from gaitsmith.plan.surroundings import Post, Surroundings

    Run = Sequence[tuple[list[Float[np.ndarray, "2"]], bool]]

#: Room beyond the elbows that a way leaves at least, for the sway of the walk, meters.
MARGIN = 0.04
#: From the middle of the way to an obstacle that people like to keep, of an adult, meters: they
#: pass 0.30 m beside it (Hackney & Cinelli 2013). It is also the radius that is walked well.
COMFORT = 0.60
#: Ways nearer to obstacles than that are taken where they save this many meters a meter.
WORTH = 3.0
#: A hand's breadth over the stature.
HAND = 0.06
#: Sides of a quarter of a round corner.
QUARTER = 8
#: Posts that begin lower than this share of the stature stand in the way of the feet.
LOW = 0.35
#: Two distances nearer than this are one, meters.
SLACK = 2e-3
#: How far beyond everything people may go round, meters.
AROUND = 3.0


@dataclass(frozen=True, eq=False)
class Routes:
    """Ways of ``body`` between ``surroundings``.

    Attributes
    ----------
    body, surroundings
        Who walks among what.
    wider
        Meters that are kept from the thing of this name beyond what its body needs at least.
    walked_round
        Names of posts that hang so high that feet pass below, but are to be walked round.
    low
        Names of obstacles that are part of the ground: stepped over or on where that is cheaper
        than walking round.
    strict
        Refuse goals that leave the walking body less than its room.
    """

    body: Body
    surroundings: Surroundings
    wider: dict[str, float] = field(default_factory=dict)
    walked_round: frozenset[str] = frozenset()
    low: frozenset[str] = frozenset()
    strict: bool = False

    @property
    def least(self) -> float:
        """Meters from the middle of the way that the walking body takes on each side."""
        return half_width(self.body) + MARGIN

    @cached_property
    def _solids(self) -> list[tuple[str, Polygon]]:
        """Outlines of all that is walked round, by name."""
        from shapely import Polygon  # late: most walks have nothing around

        solids = [
            (o.name, Polygon(o.points))
            for o in self.surroundings.obstacles
            if o.name not in self.low
        ]
        low = LOW * self.body.height
        for post in self.surroundings.posts:
            if post.bottom < low or post.name in self.walked_round:
                solids.append((post.name, Polygon(_round(post))))
        return solids

    @property
    def free(self) -> bool:
        """Whether there is nothing to walk round."""
        return not (self._solids or self.low)

    # ------------------------------------------------------------------------ asking

    def is_clear(self, points: Float[np.ndarray, "n 2"]) -> bool:
        """Whether a way through ``points`` leaves the body its width, but for its own ends."""
        from shapely import LineString

        line = LineString(points)
        ends = points[[0, -1]]
        return all(
            line.distance(solid) >= max(reach, SLACK) - SLACK and not line.crosses(solid)
            for (_, solid), reach in zip(self._solids, self._reaches(*ends), strict=True)
        )

    def path(self, here: Float[np.ndarray, "2"], run: Run) -> Path | None:
        """A path from ``here`` through the points of all ways of ``run``.

        As on free ground where that is clear of everything. Else round what stands in the way,
        or None where one path cannot do that: it goes through more than one point. A curve
        through given points stays what it is. What is low is gone over, or on the way to one
        point walked round where that is cheaper.

        Raises
        ------
        InfeasibleError
            If there is no way; the message says why, and which point can be reached.
        """
        best, routes = self._path(here, run), self
        if best is None or len(run) > 1 or len(run[-1][0]) > 1 or run[-1][1]:
            return best
        while crossed := routes.crossed(_dense(best)):
            options = [(best, routes)]
            for names in {frozenset({name}) for name in crossed} | {crossed}:
                rounder = replace(routes, low=routes.low - names)
                try:
                    other = rounder._path(here, run)
                except InfeasibleError:
                    continue
                if other is not None:
                    options.append((other, rounder))
            cheapest = min(options, key=lambda option: option[1]._cost(option[0]))
            if cheapest[1] is routes:
                break
            best, routes = cheapest
        return best

    def crossed(self, points: Float[np.ndarray, "n 2"]) -> frozenset[str]:
        """Names of low things that feet come upon on a way through ``points``."""
        from shapely import LineString, Polygon

        line, feet = LineString(points), FEET * self.body.height
        return frozenset(
            one.name
            for one in self.surroundings.obstacles
            if one.name in self.low and line.distance(Polygon(one.points)) < feet
        )

    def _cost(self, path: Path) -> float:
        """Length of a way, meters, with what its steps over low things are worth."""
        crossed = self.crossed(_dense(path))
        over = (cost_over(o) for o in self.surroundings.obstacles if o.name in crossed)
        return path.length + sum(over)

    def _path(self, here: Float[np.ndarray, "2"], run: Run) -> Path | None:
        """:meth:`path` over everything low."""
        way = run[-1][0]
        goal = way[-1]
        given = any(soft for _, soft in run)
        self._check_start(here)
        if not given:
            for points, _ in run:
                self.check_goal(here, points[-1])
        there = path_through(here, run)
        if given or self.is_clear(_dense(there)):
            return there
        if len(run) > 1 or len(way) > 1:
            return None
        return self._round_path(here, goal)

    def _reaches(
        self, start: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"], wanted: float = 0.0
    ) -> list[float]:
        """What to keep from each solid; who stands or arrives nearer to it keeps that."""
        from shapely import Point

        ends = [Point(start), Point(goal)]
        out = []
        for name, solid in self._solids:
            reach = max(wanted, self.least + self.wider.get(name, 0.0))
            out.append(min(reach, *(end.distance(solid) - SLACK for end in ends)))
        return out

    def _check_start(self, here: Float[np.ndarray, "2"]) -> None:
        from shapely import Point

        for name, solid in self._solids:
            if solid.distance(Point(here)) <= 0.0:
                raise InfeasibleError(
                    f"the person stands inside {name!r} at ({here[0]:.2f}, {here[1]:.2f}); begin "
                    "outside of it"
                )

    def check_goal(self, here: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]) -> None:
        """Raise InfeasibleError if nobody can be at ``goal``; the message names the nearest."""
        from shapely import Point

        for name, solid in self._solids:
            room, away = self.least + self.wider.get(name, 0.0), solid.distance(Point(goal))
            if away < SLACK:
                why = f"lies inside {name!r}"
            elif self.strict and away < room:
                why = f"is {away:.2f} m from {name!r}, too near for this body as it would be there"
            else:
                continue
            raise InfeasibleError(
                f"({goal[0]:.2f}, {goal[1]:.2f}) {why}{self._instead(here, goal)}"
            )

    # ----------------------------------------------------------------------- finding

    def _round_path(self, start: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]) -> Path:
        """The best of the ways that keep more or less room."""
        size = self.body.height / 1.75
        best: tuple[float, Path] | None = None
        for wanted in (COMFORT * size, 0.5 * size, 0.42 * size, 0.0):
            reaches = self._reaches(start, goal, wanted)
            free = self._free(reaches, start, goal)
            if free is None:
                continue
            corners = shortest(free, start, goal)
            path = Path.rounded(corners, radius=COMFORT) if len(corners) > 2 else None
            path = path or path_through(start, [([goal], False)])
            cost = path.length + WORTH * max(0.0, COMFORT * size - max(wanted, self.least))
            if self._keeps(path, reaches) and (best is None or cost < best[0]):
                best = cost, path
        if best is None:
            raise InfeasibleError(self._why_not(start, goal))
        return best[1]

    def _keeps(self, path: Path, reaches: Sequence[float]) -> bool:
        """Whether the smooth path keeps what the straight lines did."""
        from shapely import LineString

        line = LineString(_dense(path))
        return all(
            line.distance(solid) >= reach - 5.0 * SLACK
            for (_, solid), reach in zip(self._solids, reaches, strict=True)
        )

    def _free(
        self,
        reaches: Sequence[float],
        start: Float[np.ndarray, "2"],
        goal: Float[np.ndarray, "2"] | None,
    ) -> Polygon | None:
        """The piece of free floor that holds both points; None: there is none."""
        from shapely import Point, box, unary_union

        corner = 1.0 / np.cos(np.pi / (4 * QUARTER))  # round corners are cut outside the circle
        grown = [
            solid.buffer(max(reach, 0.0) * corner, quad_segs=QUARTER)
            for (_, solid), reach in zip(self._solids, reaches, strict=True)
        ]
        points = [start] if goal is None else [start, goal]
        bounds = np.array([g.bounds for g in grown] + [(*p, *p) for p in points])
        low, high = bounds[:, :2].min(axis=0) - AROUND, bounds[:, 2:].max(axis=0) + AROUND
        free = box(*low, *high).difference(unary_union(grown))
        for piece in _polygons(free):
            if all(piece.distance(Point(p)) <= SLACK for p in points):
                return piece
        return None

    # ---------------------------------------------------------------------- refusing

    def _why_not(self, start: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]) -> str:
        """Whether a gap is too narrow or there is none, and how near one can get."""
        narrow, wide = 0.0, self.least + max(self.wider.values(), default=0.0)
        for _ in range(12):
            middle = 0.5 * (narrow + wide)
            tried = [min(r, middle) for r in self._reaches(start, goal)]
            if self._free(tried, start, goal) is None:
                wide = middle
            else:
                narrow = middle
        to = f"({goal[0]:.2f}, {goal[1]:.2f})"
        if narrow < 0.01:
            why = f"there is no way to {to}: what stands around closes it"
        else:
            need = 2.0 * (self.least + max(self.wider.values(), default=0.0) + SLACK)
            why = (
                f"the way to {to} leads through a gap of {2.0 * narrow:.2f} m; this body needs "
                f"{np.ceil(100.0 * need) / 100.0:.2f} m"
            )
        return why + self._instead(start, goal)

    def _instead(self, start: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]) -> str:
        """The nearest point that can be reached, as the end of a sentence."""
        from shapely import Point
        from shapely.ops import nearest_points

        # a hand's breadth more than the least: who turns or stops takes more room than who walks
        more = SLACK + HAND * self.body.height
        room = [
            min(self.least + self.wider.get(name, 0.0) + more, solid.distance(Point(start)) - SLACK)
            for name, solid in self._solids
        ]
        free = self._free(room, start, None)
        if free is None:
            return ""
        nearly = goal + 1e-3 * (start - goal)  # of two equally near, the one on this side
        near = nearest_points(free.buffer(-SLACK), Point(nearly))[0]
        return f"; the nearest point that can be reached is {near.x:.2f},{near.y:.2f}"


def path_among(routes: Routes | None, here: Float[np.ndarray, "2"], run: Run) -> Path | None:
    """:meth:`Routes.path`; None for ``routes``: on free ground."""
    return path_through(here, run) if routes is None else routes.path(here, run)


def is_blocked(
    routes: Routes | None, here: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]
) -> bool:
    """Whether something stands in the straight way from ``here`` to ``goal``.

    Raises InfeasibleError where ``goal`` is known to be too near to something.
    """
    if routes is None:
        return False
    if routes.strict:
        routes.check_goal(here, goal)
    straight = np.stack([here, goal])
    return not routes.is_clear(straight) or bool(routes.crossed(straight))


def shortest(
    free: Polygon, start: Float[np.ndarray, "2"], goal: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "n 2"]:
    """Corners of the shortest way from ``start`` to ``goal`` within ``free``.

    A* over the points that see each other: the ends and the corners that a taut string may
    touch.
    """
    import shapely

    nodes = np.concatenate([[start, goal], _touched(free)])
    within = free.buffer(0.5 * SLACK)
    shapely.prepare(within)
    left = np.linalg.norm(nodes - goal, axis=1)
    known = np.full(len(nodes), np.inf)
    known[0], before, done = 0.0, np.full(len(nodes), -1), np.zeros(len(nodes), dtype=np.bool_)
    queue = [(float(left[0]), 0)]
    while queue:
        _, at = heapq.heappop(queue)
        if at == 1:
            break
        if done[at]:
            continue
        done[at] = True
        way = known[at] + np.linalg.norm(nodes - nodes[at], axis=1)
        better = np.flatnonzero(~done & (way < known - 1e-12))
        lines = np.stack([np.broadcast_to(nodes[at], (len(better), 2)), nodes[better]], axis=1)
        seen = better[shapely.covers(within, shapely.linestrings(lines))]
        known[seen], before[seen] = way[seen], at
        for k in seen.tolist():
            heapq.heappush(queue, (float(known[k] + left[k]), k))
    chain, at = [1], int(before[1])
    while at >= 0:
        chain.append(at)
        at = int(before[at])
    return _thinned(nodes[chain[::-1]])


def _touched(free: Polygon) -> Float[np.ndarray, "n 2"]:
    """Corners of the free floor that point into it."""
    from shapely.geometry.polygon import orient

    found = [np.empty((0, 2))]
    polygon = orient(free)  # the floor lies left of every ring
    for ring in (polygon.exterior, *polygon.interiors):
        points = np.asarray(ring.coords)[:-1]
        before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        found.append(points[turn < 0.0])
    return np.concatenate(found)


def _thinned(points: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "m 2"]:
    """Without points that repeat the one before."""
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > max(NO_WAY, 1e-4):
            kept.append(point)
    if len(kept) > 1:
        kept[-1] = points[-1]
    return np.array(kept)


def _dense(path: Path) -> Float[np.ndarray, "n 2"]:
    count = int(np.ceil(path.length / 0.02)) + 1
    return path.at(np.linspace(0.0, path.length, max(count, 2)))


def _round(post: Post) -> Float[np.ndarray, "n 2"]:
    angle = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    reach = post.radius / np.cos(np.pi / 16)
    return np.array(post.at) + reach * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _polygons(shape: BaseGeometry) -> list[Any]:
    return [g for g in getattr(shape, "geoms", [shape]) if g.geom_type == "Polygon"]


__all__ = ["Routes", "is_blocked", "path_among", "shortest"]
