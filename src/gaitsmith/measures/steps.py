"""Steps and strides between footsteps, and which of them are a steady walk's."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, ahead, leftward
from gaitsmith.measures.promises import steady_steps

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.measures.footsteps import Footsteps
    from gaitsmith.motion.motion import Labels

#: Share by which estimated steps may differ from the median and be steady still.
_USUAL = 0.15
#: Share of a long step that a step must have, and share of the steps that must be alike.
_LONG, _ALIKE = 0.5, 0.25


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps and strides of a walk, one row each.

    Attributes
    ----------
    index
        Footstep that ends each step; the one before it is the other foot's.
    length, width
        Meters along and across the direction of the walk; length below 0 is backward, width
        below 0 crosses over.
    time
        Seconds since the other foot landed; NaN where that is not known.
    steady
        Neither starting nor stopping nor odd.
    stride
        Footsteps from which a whole steady stride goes on: landing, the other foot's
        landing, landing of the same foot again.
    """

    index: Int[np.ndarray, "s"]
    length: Float[np.ndarray, "s"]
    width: Float[np.ndarray, "s"]
    time: Float[np.ndarray, "s"]
    steady: Bool[np.ndarray, "s"]
    stride: Int[np.ndarray, "k"]


def steps_of(feet: Footsteps, labels: Labels | None = None) -> Steps:
    """The steps between ``feet``; with ``labels`` the steady ones are those of the promises."""
    landed = np.isfinite(feet.time)
    if labels is not None:
        landed[:2], landed[2:] = False, True
    index = np.array(
        [i for i in range(1, len(feet)) if landed[i] and feet.side[i] != feet.side[i - 1]],
        dtype=np.int64,
    )
    direction = feet.direction()
    # the mean of two angles that may lie on both sides of the cut at 180 degrees
    turn = np.angle(np.exp(1j * (direction[index] - direction[index - 1])))
    middle = direction[index - 1] + 0.5 * turn
    gap = feet.position[index] - feet.position[index - 1]
    length = (gap * ahead(middle)).sum(-1)
    width = (gap * leftward(middle)).sum(-1) * SIDE_SIGN[feet.side[index]]
    time = feet.time[index] - feet.time[index - 1]
    own = None if labels is None else steady_steps(labels) + 2
    steady = _usual(length, time) if own is None else np.isin(index, own)
    good = set(index[steady].tolist())
    stride = [i for i in range(len(feet) - 2) if landed[i] and {i + 1, i + 2} <= good]
    return Steps(index, length, width, time, steady, np.array(stride, dtype=np.int64))


def _usual(length: Float[np.ndarray, "s"], time: Float[np.ndarray, "s"]) -> Bool[np.ndarray, "s"]:
    """Steps near the median of those that get ahead; none if too few are alike."""
    none = np.zeros(len(length), dtype=bool)
    if len(length) == 0:
        return none
    size = np.abs(length)
    ahead_ = size > _LONG * np.percentile(size, 90.0)
    good = ahead_ & _near(length, length[ahead_]) & _near(time, time[ahead_])
    return good if good.sum() >= max(2.0, _ALIKE * len(length)) else none


def _near(values: Float[np.ndarray, "s"], of: Float[np.ndarray, "k"]) -> Bool[np.ndarray, "s"]:
    """Near the median of ``of``; what is not known is not odd."""
    known = of[np.isfinite(of)]
    if len(known) == 0:
        return np.ones(len(values), dtype=bool)
    middle = float(np.median(known))
    return ~(np.abs(values - middle) > _USUAL * abs(middle))
