"""Ducking under bars and leaning past posts, [KB92a] section 6: as much as needed, in time.

Every frame near a thing is asked how deep it must bend; that is held for a while before and
after, eased, and put on: hips and pelvis before the feet are planned, trunk, head and arms after.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact import plan_contact
from gaitsmith.conventions import LEFT, RIGHT, UP, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.curves import hann_average, hermite, parabola_slopes, running_maximum
from gaitsmith.geometry.rotations import about, exp, multiply
from gaitsmith.plan.surroundings import Bar, Obstacle, Post
from gaitsmith.synthesis.clearance import LOOKS, REACH, Watch, near, toward
from gaitsmith.synthesis.postures import Amounts, Postures
from gaitsmith.synthesis.shifting import shifted

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.contact import Poses
    from gaitsmith.ground import Ground
    from gaitsmith.plan.surroundings import Surroundings
    from gaitsmith.synthesis.clearance import Thing
    from gaitsmith.synthesis.step import PreparedWalk

#: Meters that stay between a body and a bar or a post; what is aimed at beyond.
CLEAR, AIM = 0.020, 0.002
#: The same between an arm that is held in and an obstacle.
NEARLY = 0.005
#: Seconds that a posture is held before and after it is needed, and over which it is eased in
#: and out on both sides of that, of an adult: one to two steps in all.
EASE = 0.42
#: Amounts of a posture that are tried, and halvings between two of them.
GRID, HALVINGS = 20, 7
#: Times that what is still missing is added.
TRIES = 5
#: Who turns farther than this beside a thing has it on one side and on the other, radians.
TURNS = 1.0
#: Parts that a posture does not carry out of the way.
LEGS = ("thigh", "shin", "foot", "toes")
#: Columns of amounts: duck, aside of what is left, aside of what is right.
DUCK, ASIDE = 0, (1, 2)


class TooTight(InfeasibleError):
    """No posture gets past ``thing``."""

    def __init__(self, thing: Thing, message: str) -> None:
        self.thing = thing
        super().__init__(message)


@dataclass(frozen=True, eq=False)
class Dodge:
    """Amounts of the postures over the time of a walk."""

    postures: Postures
    times: Float[np.ndarray, "n"]
    table: Float[np.ndarray, "n 3"]
    slopes: Float[np.ndarray, "n 3"]

    def amounts(self, times: Float[np.ndarray, "F"]) -> Amounts:
        """How much at ``times``, seconds; as at the end after it."""
        at = hermite(self.times, self.table, self.slopes, np.minimum(times, self.times[-1]))
        at = np.clip(at, 0.0, 1.0)
        return Amounts(at[:, DUCK], at[:, list(ASIDE)])

    def shift(
        self, times: Float[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n"]]:
        """What is done to hips and pelvis, for :func:`~gaitsmith.synthesis.shifting.shifted`."""
        amounts = self.amounts(times)
        return self.postures.hips(amounts), self.postures.tilt(amounts.duck)

    def applied(self, times: Float[np.ndarray, "F"], poses: Poses) -> Poses:
        """The same poses with trunk, head and arms bent."""
        amounts = self.amounts(times)
        if not (amounts.duck.any() or amounts.aside.any()):
            return poses
        return replace(poses, upper=self.postures.upper(poses.upper, amounts))


def dodged(
    walk: PreparedWalk,
    body: Body,
    ground: Ground,
    surroundings: Surroundings,
    *,
    obstacles: bool = False,
) -> PreparedWalk:
    """The same walk, bent where it would come nearer than 2 cm to a bar or a post.

    ``obstacles``: an arm is held in where it would touch an obstacle, too, if that is enough.

    Raises
    ------
    TooTight
        Naming the thing, the place and what would do.
    """
    things: tuple[Thing, ...] = (*surroundings.bars, *surroundings.posts)
    clear = [CLEAR] * len(things)
    if obstacles:
        things = (*things, *surroundings.obstacles)
        clear += [NEARLY] * len(surroundings.obstacles)
    if not things:
        return walk
    dodger, least = _Dodger(walk, body, ground), np.array(clear)
    aims = least + AIM
    worst, gaps = 0, np.zeros(len(things))
    for _ in range(TRIES):
        dodge = dodger.dodge(list(zip(things, aims.tolist(), strict=True)))
        if dodge is None:
            return walk
        steps = shifted(walk.references, walk.clock, dodge.shift)
        out = replace(walk, contact=plan_contact(steps, body, ground), dodge=dodge)
        gaps = np.array(dodger.gaps(out, things))
        short = least - gaps
        if short.max() <= 0.0 or isinstance(things[int(short.argmax())], Obstacle):
            return out
        worst = int(short.argmax())
        aims += np.where(short > 0.0, short + 0.001, 0.0)
    raise TooTight(
        things[worst],
        f"{_where(things[worst])} leaves {100.0 * gaps[worst]:.1f} cm where {100.0 * CLEAR:.0f} cm "
        "are needed, however the body bends; lead the way farther from it",
    )


class _Dodger:
    """What a walk needs to get past things."""

    def __init__(self, walk: PreparedWalk, body: Body, ground: Ground) -> None:
        self._walk, self._body, self._watch = walk, body, Watch(body, ground)
        end = float(walk.clock.starts[-1])
        self._times = np.linspace(0.0, end, max(int(np.ceil(end * LOOKS)) + 1, 3))
        self._poses = walk.poses(self._times)
        first = walk.references[0].curves
        self._postures = Postures(body, (exp(first.pelvis[0]), first.upper[0]))
        self._bends = np.array([not p.endswith(LEGS) for p in self._watch.bulk.parts])
        self._reach = REACH * body.height

    def gaps(self, walk: PreparedWalk, things: tuple[Thing, ...]) -> list[float]:
        """Smallest distance of the whole body from each thing over the walk."""
        poses = walk.poses(self._times)
        axes = self._watch.axes(poses)
        out = []
        for thing in things:
            frames = near(poses.center, thing, self._reach)
            gaps = self._watch.gaps(axes[frames], thing) if frames.size else np.array([np.inf])
            out.append(float(gaps.min()))
        return out

    def dodge(self, things: list[tuple[Thing, float]]) -> Dodge | None:
        """The postures that keep each thing at its distance; None: none are needed."""
        need = np.zeros((len(self._times), 3))
        for thing, aim in things:
            for frames in self._passes(thing, aim):
                column, amount = self._needed(thing, frames, aim)
                if column is None:
                    continue
                need[frames, column] = np.maximum(need[frames, column], amount)
        if not need.any():
            return None
        rate = (len(self._times) - 1) / self._times[-1]
        half = max(2, round(EASE * rate * np.sqrt(self._body.leg_length / 0.86)))
        table = np.stack(
            [hann_average(running_maximum(column, half), half) for column in need.T], axis=-1
        )
        return Dodge(self._postures, self._times, table, parabola_slopes(self._times, table))

    def _passes(self, thing: Thing, aim: float) -> list[Int[np.ndarray, "n"]]:
        """Runs of frames near ``thing`` in which the walk comes too near as it is."""
        frames = near(self._poses.center, thing, self._reach)
        if not frames.size:
            return []
        found = []
        for run in np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1):
            # who turns on the spot has the same thing on the left and on the right in turn
            sides = self._sides(thing, run)
            found += np.split(run, np.flatnonzero(np.diff(sides)) + 1)
        return [run for run in found if self._gap(thing, run, None).min() < aim]

    def _gap(
        self,
        thing: Thing,
        frames: Int[np.ndarray, "n"],
        amounts: Amounts | None,
    ) -> Float[np.ndarray, "n"]:
        """Distance of trunk, head and arms from ``thing`` in ``frames``, bent by ``amounts``."""
        poses = _some(self._poses, frames)
        if amounts is not None:
            moved, forms = self._postures.hips(amounts), self._postures
            way = (leftward(poses.heading), np.tile(UP, (len(frames), 1)), ahead(poses.heading))
            poses = replace(
                poses,
                center=poses.center + sum(moved[:, k : k + 1] * way[k] for k in range(3)),
                pelvis=multiply(poses.pelvis, about("x", forms.tilt(amounts.duck))),
                upper=forms.upper(poses.upper, amounts),
            )
        gaps = self._watch.gaps(self._watch.axes(poses), thing)
        return np.where(self._bends, gaps, np.inf).min(axis=-1)

    def _needed(
        self, thing: Thing, frames: Int[np.ndarray, "n"], aim: float
    ) -> tuple[int | None, Float[np.ndarray, "n"]]:
        """Which posture gets past, and how much of it each frame needs.

        None where nothing gets past an obstacle: that is somebody else's business.
        """
        side = int(self._sides(thing, frames)[0])
        columns = (DUCK, side) if isinstance(thing, Bar) else (side, DUCK)
        if isinstance(thing, Obstacle):
            amount, fits = self._amount(thing, frames, side, aim)
            return (side if fits else None), amount
        missing: list[float] = []
        for column in columns:
            amount, fits = self._amount(thing, frames, column, aim)
            if fits:
                return column, amount
            missing.append(aim + 0.005 - self._tightest(thing, frames, column))
        raise TooTight(thing, self._refusal(thing, frames, missing[0]))

    def _sides(self, thing: Thing, frames: Int[np.ndarray, "n"]) -> Int[np.ndarray, "n"]:
        """Columns of the lean past what is on the left or on the right.

        A thing that is passed has the side on which it is when it is nearest.
        """
        to = toward(self._poses.center[frames], thing)
        left = leftward(self._poses.heading[frames])[:, [0, 2]]
        aside = (to * left).sum(axis=1)
        at = int((to**2).sum(axis=1).argmin())
        turned = self._poses.heading[frames] - self._poses.heading[frames[at]]
        if np.abs(turned).max() < TURNS:
            aside = np.full(len(frames), aside[at])
        return np.where(aside >= 0.0, ASIDE[LEFT], ASIDE[RIGHT])

    def _amounts(self, column: int, amount: Float[np.ndarray, "n"]) -> Amounts:
        table = np.zeros((len(amount), 3))
        table[:, column] = amount
        return Amounts(table[:, DUCK], table[:, list(ASIDE)])

    def _amount(
        self, thing: Thing, frames: Int[np.ndarray, "n"], column: int, aim: float
    ) -> tuple[Float[np.ndarray, "n"], Bool[np.ndarray, ""] | bool]:
        """The least amount from which on no more of it touches ``thing``, frame by frame.

        More would not touch either: so it may come early and be held for long.
        """

        def clear(amount: Float[np.ndarray, "n"]) -> Bool[np.ndarray, "n"]:
            return self._gap(thing, frames, self._amounts(column, amount)) >= aim

        grid = np.linspace(0.0, 1.0, GRID + 1)
        free = np.stack([clear(np.full(len(frames), a)) for a in grid])
        if not free[-1].all():
            return np.ones(len(frames)), False
        last = GRID - np.argmin(free[::-1], axis=0)  # the deepest that still touches
        touched = ~free.all(axis=0)
        low = np.where(touched, grid[last], 0.0)
        high = np.where(touched, grid[np.minimum(last + 1, GRID)], 0.0)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            fits = clear(middle)
            low, high = np.where(fits, low, middle), np.where(fits, middle, high)
        return np.where(touched, high, 0.0), True

    def _tightest(self, thing: Thing, frames: Int[np.ndarray, "n"], column: int) -> float:
        """The smallest distance at the most of a posture, meters."""
        return float(self._gap(thing, frames, self._amounts(column, np.ones(len(frames)))).min())

    def _refusal(self, thing: Thing, frames: Int[np.ndarray, "n"], missing: float) -> str:
        if isinstance(thing, Bar):
            most = self._amounts(DUCK, np.ones(len(frames)))
            least = float(np.ceil(100.0 * self._lowest(most, frames))) / 100.0
            return (
                f"{_where(thing)} is too low: this body ducks under bars from {least:.2f} m on; "
                "raise it or walk beside it"
            )
        more = float(np.ceil(100.0 * missing)) / 100.0
        return (
            f"{_where(thing)} stands in the way: leaning aside gets past it if it is {more:.2f} m "
            "farther from the middle of the way; move it or lead the way round it"
        )

    def _lowest(self, most: Amounts, frames: Int[np.ndarray, "n"]) -> float:
        """The lowest underside that the deepest duck clears, meters."""
        poses = _some(self._poses, frames)
        forms = self._postures
        poses = replace(
            poses,
            center=poses.center + forms.hips(most)[:, 1:2] * UP,
            pelvis=multiply(poses.pelvis, about("x", forms.tilt(most.duck))),
            upper=forms.upper(poses.upper, most),
        )
        top = self._watch.axes(poses)[..., 1].max(axis=-1) + self._watch.bulk.radius
        return float(top[:, self._bends].max()) + CLEAR


def _some(poses: Poses, frames: Int[np.ndarray, "n"]) -> Poses:
    return replace(poses, **{name: getattr(poses, name)[frames] for name in vars(poses)})


def _where(thing: Thing) -> str:
    if isinstance(thing, Bar):
        x, z = 0.5 * (np.array(thing.begin) + np.array(thing.end))
        return f"{thing.name!r} at ({x:.2f}, {z:.2f}), {thing.height:.2f} m high,"
    x, z = thing.at if isinstance(thing, Post) else thing.points[0]
    return f"{thing.name!r} at ({x:.2f}, {z:.2f})"
