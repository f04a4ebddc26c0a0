"""Key times by event and the maps between them: which instants of two walks belong together.

[KN12] sections 3.1-3.2. The paper names its eight key frames by their place in time. Walks
differ in that order, so here a key frame is what happens in it: the same foot does the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.curves import pchip

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.gait.cycle import Cycle

#: Key frames of a stride in the order of their slots: foot and event.
KEYS = (
    *("left heel strike", "left foot flat", "right toe-off", "left heel off"),
    *("right heel strike", "right foot flat", "left toe-off", "right heel off"),
)
#: Samples of one stride, the same for all walks that are mixed.
SAMPLES = 128
#: Where slots may lie: toe-off of the other foot after a heel strike (stride), foot flat within
#: that, heel off within the single support that follows (shares).
_TOE_OFF, _FLAT, _HEEL_OFF = (0.05, 0.15), (0.3, 0.8), (0.4, 0.75)


@dataclass(frozen=True, eq=False)
class Timing:
    """When things happen in a stride.

    Attributes
    ----------
    contacts
        ``(2, 4)`` stride phases of [left, right] x heel strike, foot flat, heel off, toe-off,
        rising: what happens after the end of the stride is above 1. They may be averaged.
    slots
        ``(8,)`` rising stride phases in [0, 1) of :data:`KEYS`. Heel strikes are where they are;
        the others are kept within bounds, so that a map from one walk's slots to another's
        neither rushes nor turns back.
    """

    contacts: Float[np.ndarray, "2 4"]
    slots: Float[np.ndarray, "8"]

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        object.__setattr__(self, "contacts", frozen_array("contacts", self.contacts, (2, 4)))
        object.__setattr__(self, "slots", frozen_array("slots", self.slots, (8,)))

    @property
    def events(self) -> Float[np.ndarray, "2 4"]:
        """Of a :class:`~gaitsmith.gait.cycle.Cycle`: stride phases in [0, 1)."""
        return self.contacts % 1.0

    @property
    def ordered(self) -> bool:
        """Whether both feet do everything in order, and one bears until the other has landed."""
        left, right = self.contacts
        return bool(
            (np.diff(self.contacts, axis=1) > 0.0).all()
            and 0.0 < right[0] < left[3] < 1.0 < right[3] < right[0] + 1.0
            and (np.diff(self.slots) > 0.0).all()
            and self.slots[-1] < 1.0
        )


def timing_of(cycle: Cycle) -> Timing:
    """The timing of ``cycle``.

    Raises
    ------
    InfeasibleError
        If both feet are off the ground at once: running does not mix with walking.
    """
    since = (cycle.events - cycle.events[:, :1]) % 1.0
    contacts = cycle.events[:, :1] + since
    right = contacts[1, 0]
    if not (right < contacts[0, 3] and contacts[1, 3] > 1.0):
        raise InfeasibleError(
            "this stride has a flight phase (a foot leaves before the other lands): running is "
            "not mixed with walking"
        )
    slots = np.empty(8)
    for side, (strike, other) in enumerate(((0.0, right), (right, 1.0))):
        off = contacts[1 - side, 3] - (1.0 - side)  # the other foot leaves during this stance
        flat, heel_off = contacts[side, 1] - strike, contacts[side, 2] - strike
        off = _within(off - strike, *_TOE_OFF)
        single = (other - strike) - off
        slots[4 * side : 4 * side + 4] = strike + np.array(
            [
                0.0,
                _within(flat, *(share * off for share in _FLAT)),
                off,
                off + _within(heel_off - off, *(share * single for share in _HEEL_OFF)),
            ]
        )
    return Timing(contacts, slots)


def _within(value: float, least: float, most: float) -> float:
    return min(max(value, least), most)


def mapped(
    slots: Float[np.ndarray, "8"],
    onto: Float[np.ndarray, "8"],
    phase: Float[np.ndarray, "n"],
) -> Float[np.ndarray, "n"]:
    """Stride phases of a walk with slots ``onto`` that belong to ``phase`` of one with ``slots``.

    A monotone cubic through the slots, periodic by strides. It is what [KN12] calls a dynamic
    time-warp: with key frames known nothing is left to search.
    """
    if np.array_equal(slots, onto):
        return np.asarray(phase, dtype=np.float64)
    grid = np.concatenate([slots[-3:] - 1.0, slots, slots[:3] + 1.0])
    values = np.concatenate([onto[-3:] - 1.0, onto, onto[:3] + 1.0])
    whole = np.floor(phase)
    return whole + pchip(grid, values[:, None], phase - whole)[:, 0]


def phases(strides: int) -> Float[np.ndarray, "K"]:
    """Stride phases of the samples of a loop of ``strides``."""
    return np.arange(SAMPLES * strides) / SAMPLES


def slots_over(slots: Float[np.ndarray, "8"], strides: int) -> Float[np.ndarray, "8S"]:
    """Slots of every stride of a loop."""
    return np.concatenate([slots + stride for stride in range(strides)])
