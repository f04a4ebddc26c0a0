"""Ways of walking: legs, what is above them, and the pace and stance that belong to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.plan.rhythm import UNEVEN
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.upper_body import Manner, RuleOverlay
from gaitsmith.walks import KinematicWalk, winter
from gaitsmith.walks.from_cycle import walk_data_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.learned import LearnedGait
    from gaitsmith.walks.model import StraightWalk


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
    lengths, durations
        Of the steps that land the [left, right] foot, over the mean.
    """

    step_length: float
    cadence: float
    leg_length: float
    step_width: float
    toe_out: tuple[float, float]
    lengths: tuple[float, float] = (1.0, 1.0)
    durations: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True)
class Gait:
    """A straight walk, the overlay that rides on it, and the habits that go with it if any."""

    walk: StraightWalk
    overlay: Overlayer
    habits: Habits | None = None


def neutral(_: Manner | None = None) -> Gait:
    """A measured man's whole body, made symmetric, his arms relaxed [Rajagopal 2016]."""
    cycle, body = neutral_cycle(), subject()
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
            lengths=_over_mean(*gait.step_lengths),
            # the step on the left foot lands the right one
            durations=_over_mean(1.0 - gait.cycle.events[1, 0], gait.cycle.events[1, 0]),
        ),
    )


def _over_mean(left: float, right: float) -> tuple[float, float]:
    """Both over their mean, as far as steps may be uneven."""
    share = 2.0 * float(left) / float(left + right)
    share = min(max(share, 1.0 - UNEVEN), 1.0 + UNEVEN)
    return share, 2.0 - share


#: Built-in gaits by the name the command line uses.
GAITS: dict[str, Callable[[Manner | None], Gait]] = {"neutral": neutral, "winter": winter_rules}
