"""Local steps from one stance to another: many ways at once, each with as few steps as it can.

A way says where the body is and faces on its way; its feet land beside that, one after the other,
each as far on as the standing foot lets it (:mod:`gaitsmith.plan.placing`). Steps that turn and
travel at once, backing up and side stepping are all of this kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN
from gaitsmith.plan.placing import Feet, Limits, may_land
from gaitsmith.plan.ways import wrapped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.plan.lengths import Stance

#: Places on a way at which a foot may land, most steps of a chain, and how many more than the
#: shortest are still of interest.
CELLS, MOST, MORE = 24, 16, 1
#: A way of so many meters counts as much as a turn of so many radians where cells are laid out.
PER_CELL = (0.6, float(np.radians(60.0)))
#: Turns larger than this may go either way round, radians; ways shorter than this are on the spot.
TWO_WAYS, ON_THE_SPOT = float(np.radians(150.0)), 0.05
#: A way that turns by more than this is walked with the feet wide apart, radians.
WIDE_TURN = float(np.radians(20.0))
#: Shares of what the body can: steps are even where the last of as many would be small.
SHARES = (0.8, 1.0)


@dataclass(frozen=True, eq=False)
class Standing:
    """Both feet [left, right], x,z of N, their headings, and where the body faces."""

    place: Float[np.ndarray, "2 2"]
    heading: Float[np.ndarray, "2"]
    direction: Float[np.ndarray, "2"]

    @property
    def middle(self) -> Float[np.ndarray, "2"]:
        """x, z half way between the feet."""
        return 0.5 * (self.place[0] + self.place[1])

    @property
    def facing(self) -> float:
        """Mean of the directions."""
        return 0.5 * float(self.direction[0] + self.direction[1])


@dataclass(frozen=True, eq=False)
class Chain:
    """Steps of one way: side, x,z, direction and heading of each; and how the body travels.

    ``closes`` says which steps end with the feet side by side; ``back`` and ``aside`` are the
    meters that the body goes so, ``way`` those it goes in all, ``turned`` the radians that it
    turns, to and fro; ``began`` is where it faced at first.
    """

    side: Int[np.ndarray, "n"]
    feet: Feet
    closes: tuple[bool, ...]
    back: float
    aside: float
    way: float
    turned: float
    began: float

    def __len__(self) -> int:
        """How many steps it takes."""
        return len(self.side)


def chains_between(
    begin: Standing, end: Standing, body: Body, stance: Stance, *, on_the_spot: bool = False
) -> list[Chain]:
    """A chain for every way that local steps can take, as few steps as each needs."""
    ways = _ways(begin, end, on_the_spot)
    place, facing = _laid_out(ways, begin.middle, end.middle)
    feet = _beside(place, facing, end, stance, body.hip_width)
    # every way: either foot leads, with all that the body can or with less of it
    way, lead, share = (
        a.ravel() for a in np.meshgrid(np.arange(len(ways)), (LEFT, RIGHT), np.arange(len(SHARES)))
    )
    taken = _taken(begin, feet, way, lead, np.array(SHARES)[share], body, stance.width)
    travel = _travelled(place, facing)
    out = []
    for row, steps in enumerate(taken):
        if steps is None:
            continue
        w = way[row]
        side, cells = np.array(steps).T
        at = (w, cells, side)
        closes = tuple(
            i == len(cells) - 1 or (i > 0 and cells[i] == cells[i - 1]) for i in range(len(cells))
        )
        landed = Feet(feet.place[at], facing[w, cells], feet.heading[at])
        out.append(Chain(side, landed, closes, *map(float, travel[w]), began=begin.facing))
    return out


def _ways(begin: Standing, end: Standing, on_the_spot: bool) -> list[list[tuple[float, float]]]:
    """Key places of each way: (share of the distance, facing)."""
    first, whole = begin.facing, 2.0 * np.pi
    turn = end.facing - first
    turns = [turn, turn - whole * float(np.sign(turn))] if abs(turn) > TWO_WAYS else [turn]
    ways = [[(0.0, first), (1.0, first + t)] for t in turns]
    gap = end.middle - begin.middle
    if on_the_spot or float(np.hypot(*gap)) < ON_THE_SPOT:
        return ways
    for t in turns:
        ways.append([(0.0, first), (0.6, first + t), (1.0, first + t)])
        ways.append([(0.0, first), (0.4, first), (1.0, first + t)])
    towards = float(np.arctan2(*gap))
    for between in towards + np.array([0.0, np.pi, 0.5 * np.pi, -0.5 * np.pi]):
        there = first + float(wrapped(between - first))
        last = there + float(wrapped(end.facing - there))
        ways.append([(0.0, first), (0.35, there), (0.65, there), (1.0, last)])
        ways.append([(0.0, first), (0.0, there), (1.0, there), (1.0, last)])
    return ways


def _laid_out(
    ways: Sequence[Sequence[tuple[float, float]]],
    begin: Float[np.ndarray, "2"],
    end: Float[np.ndarray, "2"],
) -> tuple[Float[np.ndarray, "W K 2"], Float[np.ndarray, "W K"]]:
    """Where the body is and faces at the cells of each way."""
    gap, cells = float(np.hypot(*(end - begin))), np.linspace(0.0, 1.0, CELLS + 1)
    share, facing = np.empty((2, len(ways), CELLS + 1))
    for i, way in enumerate(ways):
        keys = np.array(way)
        change = np.abs(np.diff(keys, axis=0)) @ np.array([gap / PER_CELL[0], 1.0 / PER_CELL[1]])
        along = np.concatenate([[0.0], np.cumsum(change)])
        along = along / along[-1] if along[-1] > 0.0 else np.linspace(0.0, 1.0, len(keys))
        share[i], facing[i] = (np.interp(cells, along, keys[:, k]) for k in (0, 1))
        facing[i, -1], share[i, -1] = keys[-1, 1], 1.0
    return begin + share[..., None] * (end - begin), facing


def _beside(
    place: Float[np.ndarray, "W K 2"],
    facing: Float[np.ndarray, "W K"],
    end: Standing,
    stance: Stance,
    wide: float,
) -> Feet:
    """Both feet at every cell, ``(W, K, 2)``; those of the goal at the last.

    On a way that turns they are ``wide`` apart ([KB93]: 2 lambda), or heels would touch.
    """
    left = np.stack([np.cos(facing), -np.sin(facing)], axis=-1)
    turns = np.ptp(facing, axis=1) > WIDE_TURN
    half = 0.5 * np.where(turns, max(wide, stance.width), stance.width)
    out = half[:, None, None, None] * SIDE_SIGN[:, None]
    feet = place[:, :, None] + out * left[:, :, None]
    heading = facing[..., None] + SIDE_SIGN * np.array(stance.toe_out)
    direction = np.repeat(facing[..., None], 2, axis=-1)
    feet[:, -1] = end.place
    heading[:, -1] = end.heading + (facing[:, -1] - end.facing)[:, None]
    return Feet(feet, direction, heading)


def _travelled(
    place: Float[np.ndarray, "W K 2"], facing: Float[np.ndarray, "W K"]
) -> Float[np.ndarray, "W 4"]:
    """Meters that the body goes backward, aside and in all on each way; radians that it turns."""
    move, face = np.diff(place, axis=1), 0.5 * (facing[:, 1:] + facing[:, :-1])
    sin, cos = np.sin(face), np.cos(face)
    along = move[..., 0] * sin + move[..., 1] * cos
    aside = move[..., 0] * cos - move[..., 1] * sin
    turned = np.abs(np.diff(facing, axis=1)).sum(1)
    back, way = np.maximum(-along, 0.0).sum(1), np.hypot(along, aside).sum(1)
    return np.stack([back, np.abs(aside).sum(1), way, turned], axis=-1)


def _taken(
    begin: Standing,
    feet: Feet,
    way: Int[np.ndarray, "R"],
    lead: Int[np.ndarray, "R"],
    share: Float[np.ndarray, "R"],
    body: Body,
    width: float,
) -> list[list[tuple[int, int]] | None]:
    """(side, cell) of the steps of each row, each as far on as it may land; None: no way."""
    count = len(way)
    place = np.tile(begin.place, (count, 1, 1))
    heading, direction = (np.tile(v, (count, 1)) for v in (begin.heading, begin.direction))
    cell = np.full((count, 2), -1)
    steps: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    alive, side, cells = np.arange(count), lead.copy(), np.arange(CELLS + 1)
    failed: set[int] = set()
    shortest = MOST
    for taken in range(MOST):
        if not len(alive) or taken > shortest + MORE:
            break
        # beside each other, either foot may go on: the one that comes farther
        level = (cell[alive, 0] == cell[alive, 1]) & (cell[alive, 0] >= 0)
        rows = np.concatenate([alive, alive[level]])
        swing = np.concatenate([side[alive], 1 - side[alive[level]]])
        stay = 1 - swing
        at = (way[rows], slice(None), swing)

        def spread(values: np.ndarray) -> np.ndarray:
            return np.repeat(values, CELLS + 1, axis=0)

        stands = Feet(*(spread(v[rows, stay]) for v in (place, direction, heading)))
        target = Feet(
            feet.place[at].reshape(-1, 2), feet.direction[at].ravel(), feet.heading[at].ravel()
        )
        origin, sides, shares = (spread(v) for v in (direction[rows, swing], swing, share[rows]))
        mine, other = cell[rows, swing], cell[rows, stay]
        ok = (cells >= np.maximum(mine, other)[:, None]) & ~(
            (cells == mine[:, None]) & (mine == other)[:, None]
        )
        asked = np.flatnonzero(ok)
        ok.ravel()[asked] = may_land(
            stands.rows(asked),
            origin[asked],
            target.rows(asked),
            sides[asked],
            Limits.of(body, width, shares[asked]),
            body,
        )
        best = np.where(ok, cells, -1).max(axis=1)
        first, second = best[: len(alive)], best[len(alive) :]
        swap = second > first[level]
        turned = np.flatnonzero(level)[swap]
        first[turned] = second[swap]
        side[alive[turned]] = 1 - side[alive[turned]]
        failed.update(alive[first < 0].tolist())
        alive, best = alive[first >= 0], first[first >= 0]
        swing = side[alive]
        there = (way[alive], best, swing)
        place[alive, swing] = feet.place[there]
        direction[alive, swing] = feet.direction[there]
        heading[alive, swing] = feet.heading[there]
        cell[alive, swing] = best
        for row, foot, at_cell in zip(alive.tolist(), swing.tolist(), best.tolist(), strict=True):
            steps[row].append((foot, at_cell))
        side[alive] = 1 - side[alive]
        going = (cell[alive] < CELLS).any(axis=1)
        if not going.all():
            shortest = min(shortest, taken)
        alive = alive[going]
    failed.update(alive.tolist())
    return [None if row in failed else taken for row, taken in enumerate(steps)]
