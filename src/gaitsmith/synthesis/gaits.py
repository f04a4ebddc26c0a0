"""Ways of walking: legs, what is above them, and the pace and stance that belong to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.gait.posture import (
    with_easy_shoulders_and_hands,
    with_head_that_follows,
    with_pelvis_tilt,
)
from gaitsmith.plan.rhythm import UNEVEN
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.cycles_overlay import CyclesOverlay
from gaitsmith.synthesis.upper_body import Manner, RuleOverlay
from gaitsmith.walks import KinematicWalk, winter
from gaitsmith.walks.files import built_in

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jaxtyping import Float

    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.data import WalkData
    from gaitsmith.walks.learned import LearnedGait
    from gaitsmith.walks.model import StraightWalk


#: Forward tilt given to the pelvis of ``neutral``, radians: the line of its spines is level in the
#: measured man (-3 to 2 deg, markers), 11.6 +- 5 deg forward in people (Schwartz 2008). Half of it.
PELVIS_TILT = float(np.radians(5.0))

#: How the legs of ``neutral`` change with the step length. Bounce: 15.7 cm per meter of step where
#: the whole is 3.7 cm at 0.71 m; 27 % of the compass arc at 0.9 m/s, 58-70 % above 1.1. Swing and
#: toe-off pitch (radians per leg length): the swing knee flexes 45, 55, 59, 61 deg at very slow to
#: fast (Schwartz 2008), toe-off pitch is -38 - 17.5 v deg (CMU 07).
BOUNCE_POWER, SWING_POWER, OFF_GAIN = 3.0, 1.6, 1.0

#: What ``--walker`` names: [KB92b]'s generalized measured step, or elevation angles [SM01].
WALKERS = ("kinematic", "elevation")

#: Smaller turns of a sole or of toes about their edge are none, radians.
ONSET = 1e-4


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
    return _neutral()


@cache
def _neutral() -> Gait:
    cycle = with_head_that_follows(with_pelvis_tilt(neutral_cycle(), PELVIS_TILT))
    cycle = with_easy_shoulders_and_hands(cycle)
    walk = KinematicWalk([built_in("neutral_step")])
    return Gait(walk, CycleOverlay(cycle, subject().leg_length))


def neutral_step() -> WalkData:
    """The legs of ``neutral``, that change with the step length as people's; see the data file."""
    from gaitsmith.walks.from_cycle import walk_data_of  # late: it ships, nobody fits it again

    walk, _ = walk_data_of(neutral_cycle(), subject())
    old = walk.character
    knee, strike, off, meta = old.gains
    # sole and toes keep step with each other
    gains = (knee, strike, OFF_GAIN, meta * OFF_GAIN / off)
    new = replace(old, gains=gains, bounce_power=BOUNCE_POWER, swing_power=SWING_POWER)
    return walk.with_(
        character=new,
        meta=walk.meta.with_values(_rising(walk.meta.values)),
        foot2=walk.foot2.with_values(-_rising(-walk.foot2.values)),
    )


def _rising(values: Float[np.ndarray, "n c"]) -> Float[np.ndarray, "n c"]:
    """Nothing until they rise for good: a heel or a ball does not leave and come back by a hair."""
    never_less = np.maximum.accumulate(values, axis=0)
    return np.where(never_less < ONSET, 0.0, never_less)


def winter_rules(manner: Manner | None = None) -> Gait:
    """The measured legs of [KB92b]'s subject, everything above by published rules."""
    return Gait(winter(), RuleOverlay(manner))


def learned(gait: LearnedGait, manner: Manner | None = None) -> Gait:
    """The way of walking that was learned from a clip."""
    leg = gait.body.leg_length
    overlay: Overlayer
    if gait.upper_body != "measured":
        overlay = RuleOverlay(manner)
    elif gait.others:
        overlay = CyclesOverlay([stride.cycle for stride in gait.strides], leg)
    else:
        overlay = CycleOverlay(gait.cycle, leg)
    return Gait(
        walk=KinematicWalk([stride.walk_data for stride in gait.strides]),
        overlay=overlay,
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


def with_walker(gait: Gait, walker: str) -> Gait:
    """The same way of walking by one of :data:`WALKERS`."""
    return gait if one_of("walker", walker, WALKERS) == "kinematic" else by_elevation(gait)


@lru_cache(maxsize=16)
def by_elevation(gait: Gait) -> Gait:
    """The same way of walking by its elevation angles, [SM01]; remembered."""
    from gaitsmith.walks.elevation_sets import Legs, spanning_sets  # late: few walks are so led
    from gaitsmith.walks.elevation_walk import ElevationWalk

    if not isinstance(gait.walk, KinematicWalk):
        raise InvalidInputError("only a measured or learned walk has elevation data")
    pairs = gait.walk.prototypes
    left, right = pairs[len(pairs) // 2]
    length = 0.5 * (left.length + right.length)
    overlay, cycle = gait.overlay, neutral_cycle()
    if isinstance(overlay, CycleOverlay | CyclesOverlay):
        cycle = overlay.cycle
    legs = Legs(
        walk=gait.walk,
        body=left.body,
        cycle=cycle,
        length=length,
        step_time=0.5 * cycle.duration,
        source="legs of the gait",
    )
    even = left is right
    sets = [spanning_sets(legs, side) for side in ((LEFT,) if even else (LEFT, RIGHT))]
    return replace(gait, walk=ElevationWalk(*sets))


def _over_mean(left: float, right: float) -> tuple[float, float]:
    """Both over their mean, as far as steps may be uneven."""
    share = 2.0 * float(left) / float(left + right)
    share = min(max(share, 1.0 - UNEVEN), 1.0 + UNEVEN)
    return share, 2.0 - share


class _Gaits(Mapping[str, "Callable[[Manner | None], Gait]"]):
    """Built-in gaits; the styles by rule are looked up only when another gait is asked for."""

    def __init__(self, own: dict[str, Callable[[Manner | None], Gait]]) -> None:
        self._own = own

    def __getitem__(self, name: str) -> Callable[[Manner | None], Gait]:
        if name in self._own:
            return self._own[name]
        from gaitsmith.style.rules import RULES  # late: other gaits need none

        return _by_rule(name, RULES[name].about)

    def __iter__(self) -> Iterator[str]:
        from gaitsmith.style.rules import RULES

        return iter((*self._own, *RULES))

    def __len__(self) -> int:
        return sum(1 for _ in self)  # tuple(self) would ask for its length


def _by_rule(name: str, about: str) -> Callable[[Manner | None], Gait]:
    """The built-in style ``name``."""

    def make(_: Manner | None = None) -> Gait:
        from gaitsmith.style.restyle import rule_gait

        return learned(rule_gait(name))

    make.__doc__ = f"{about} (made by rule)"
    return make


#: Built-in gaits by the name the command line uses.
GAITS: Mapping[str, Callable[[Manner | None], Gait]] = _Gaits(
    {"neutral": neutral, "winter": winter_rules}
)
