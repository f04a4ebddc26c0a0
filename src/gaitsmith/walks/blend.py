"""Between two measured steps of one person."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.walks.data import TimedSequence, WalkData
from gaitsmith.walks.generalize import generalize, mu

if TYPE_CHECKING:
    from jaxtyping import Float

#: Samples per interval between events on which two sequences meet.
SAMPLES = 40


def blend(
    first: WalkData, second: WalkData, share: float, *, start_height: float | None = None
) -> WalkData:
    """Walk data ``share`` of the way from ``first`` to ``second``, events and all.

    Both must be of the same body and step lengths (generalize them first). Curves meet at
    equal shares of the interval between their events, so that a heel strike is never mixed
    with a swing; the ends are then made to agree with the blended angles.
    """
    a, b = 1.0 - share, share
    events = {
        name: a * getattr(first, name) + b * getattr(second, name)
        for name in ("flat", "heel_off", "meta_off", "toe_off")
    }

    def marks(walk: WalkData, name: str) -> Float[np.ndarray, "k"]:
        times = getattr(walk, name).times
        inside = [walk.heel_off] if name == "foot2" else []
        return np.array([times[0], *inside, times[-1]])

    def mixed(name: str) -> TimedSequence:
        grids = [_spread(marks(walk, name)) for walk in (first, second)]
        values = [getattr(w, name).at(g) for w, g in zip((first, second), grids, strict=True)]
        return TimedSequence(a * grids[0] + b * grids[1], a * values[0] + b * values[1])

    body, length = first.body, first.length
    angles = [
        a * x + b * y
        for x, y in zip(
            mu(first.character, body, length), mu(second.character, body, length), strict=True
        )
    ]
    character = replace(
        first.character,
        ratio=length / body.leg_length,
        knee=angles[0],
        strike_pitch=angles[1],
        off_pitch=angles[2],
        off_meta=angles[3],
        kappa=a * first.character.kappa + b * second.character.kappa,
        gains=tuple(
            a * x + b * y
            for x, y in zip(first.character.gains, second.character.gains, strict=True)
        ),
    )
    mix = replace(
        first,
        character=character,
        **events,
        **{name: mixed(name) for name in first.sequences},
    )
    return generalize(mix, body, first.previous_length, length, start_height=start_height)


def _spread(marks: Float[np.ndarray, "k"]) -> Float[np.ndarray, "n"]:
    pieces = [np.linspace(x, y, SAMPLES, endpoint=False) for x, y in pairwise(marks)]
    return np.concatenate([*pieces, marks[-1:]])
