"""Between two measured steps of one person."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.walks.data import TimedSequence, WalkData
from gaitsmith.walks.generalize import generalize, mu

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.data import Character

#: Samples of the two that are nearer than this, as a share of an interval, are one.
SAME = 1e-9


def blend(
    first: WalkData,
    second: WalkData,
    share: float,
    *,
    start_height: float | None = None,
    before: Character | None = None,
) -> WalkData:
    """Walk data ``share`` of the way from ``first`` to ``second``, events and all.

    Both must be of the same body and step lengths (generalize them first). Curves meet at
    equal shares of the interval between their events, so that a heel strike is never mixed
    with a swing; the ends are then made to agree with the blended angles, those that the step
    begins with by the character ``before`` (see :func:`generalize`).
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
        grids = _common(*((getattr(w, name).times, marks(w, name)) for w in (first, second)))
        values = [getattr(w, name).at(g) for w, g in zip((first, second), grids, strict=True)]
        return TimedSequence(a * grids[0] + b * grids[1], a * values[0] + b * values[1])

    character = blended_character(
        first.character, second.character, share, first.body, first.length
    )
    mix = replace(
        first,
        character=character,
        **events,
        **{name: mixed(name) for name in first.sequences},
    )
    return generalize(
        mix,
        first.body,
        first.previous_length,
        first.length,
        start_height=start_height,
        before=before,
    )


def blended_character(
    first: Character, second: Character, share: float, body: Body, length: float
) -> Character:
    """Character ``share`` of the way, whose measured step is ``body``'s of ``length`` meters."""
    a, b = 1.0 - share, share
    knee, strike, off, meta = (
        a * x + b * y
        for x, y in zip(mu(first, body, length), mu(second, body, length), strict=True)
    )
    return replace(
        first,
        ratio=length / body.leg_length,
        knee=knee,
        strike_pitch=strike,
        off_pitch=off,
        off_meta=meta,
        kappa=a * first.kappa + b * second.kappa,
        gains=tuple(a * x + b * y for x, y in zip(first.gains, second.gains, strict=True)),
        bounce_power=a * first.bounce_power + b * second.bounce_power,
        swing_power=a * first.swing_power + b * second.swing_power,
        hip=(a * first.hip[0] + b * second.hip[0], a * first.hip[1] + b * second.hip[1]),
    )


def _common(
    *sampled: tuple[Float[np.ndarray, "n"], Float[np.ndarray, "k"]],
) -> list[Float[np.ndarray, "m"]]:
    """Times in either sequence that lie at equal shares of the intervals between its marks.

    They hold every sample of both, so that all of one and none of the other is that one.
    """
    shares = np.sort(
        np.concatenate([np.interp(t, marks, np.arange(len(marks))) for t, marks in sampled])
    )
    shares = shares[np.concatenate([[True], np.diff(shares) > SAME])]
    return [np.interp(shares, np.arange(len(marks)), marks) for _, marks in sampled]
