"""Ways of walking: legs, what is above them, and the pace and stance that belong to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.gait.posture import with_easy_shoulders_and_hands, with_pelvis_tilt
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.upper_body import Manner, RuleOverlay
from gaitsmith.walks import KinematicWalk, winter
from gaitsmith.walks.from_cycle import walk_data_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.learned import LearnedGait
    from gaitsmith.walks.model import StraightWalk


#: Forward tilt given to the pelvis of ``neutral``, radians: the line of its spines is level in the
#: measured man (-3 to 2 deg, markers), 11.6 +- 5 deg forward in people (Schwartz 2008). Half of it.
PELVIS_TILT = float(np.radians(5.0))


@dataclass(frozen=True)
class Habits:
    """Pace and stance of a measured person, for a body of any size.

    Attributes
    ----------
    step_length
        Over leg length (hip to ankle).
    cadence
        Steps per minute of who was measured, whose leg is ``leg_length`` meters: others keep
        the Froude number.
    step_width
        Over leg length, between the lines of left and right feet.
    toe_out
        Radians of [left, right].
    """

    step_length: float
    cadence: float
    leg_length: float
    step_width: float
    toe_out: tuple[float, float]


@dataclass(frozen=True)
class Gait:
    """A straight walk, the overlay that rides on it, and the habits that go with it if any."""

    walk: StraightWalk
    overlay: Overlayer
    habits: Habits | None = None


def neutral(_: Manner | None = None) -> Gait:
    """A measured man's whole body, made symmetric, his arms relaxed [Rajagopal 2016]."""
    cycle, body = neutral_cycle(), subject()
    cycle = with_easy_shoulders_and_hands(with_pelvis_tilt(cycle, PELVIS_TILT))
    return Gait(KinematicWalk([walk_data_of(cycle, body)]), CycleOverlay(cycle, body.leg_length))


def winter_rules(manner: Manner | None = None) -> Gait:
    """The measured legs of [KB92b]'s subject, everything above by published rules."""
    return Gait(winter(), RuleOverlay(manner))


def learned(gait: LearnedGait, manner: Manner | None = None) -> Gait:
    """The way of walking that was learned from a clip."""
    leg = gait.body.leg_length
    measured = gait.upper_body == "measured"
    return Gait(
        walk=KinematicWalk([gait.walk_data]),
        overlay=CycleOverlay(gait.cycle, leg) if measured else RuleOverlay(manner),
        habits=Habits(
            step_length=0.5 * sum(gait.step_lengths) / leg,
            cadence=gait.cadence,
            leg_length=leg,
            step_width=gait.step_width / leg,
            toe_out=gait.toe_out,
        ),
    )


#: Built-in gaits by the name the command line uses.
GAITS: dict[str, Callable[[Manner | None], Gait]] = {"neutral": neutral, "winter": winter_rules}
