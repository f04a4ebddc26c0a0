"""Ways of walking by name: legs and what is above them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.synthesis.cycle_overlay import CycleOverlay
from gaitsmith.synthesis.upper_body import Manner, RuleOverlay
from gaitsmith.walks import KinematicWalk, winter
from gaitsmith.walks.from_cycle import walk_data_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.model import StraightWalk


@dataclass(frozen=True)
class Gait:
    """A straight walk and the overlay that rides on it."""

    walk: StraightWalk
    overlay: Overlayer


def neutral(_: Manner | None = None) -> Gait:
    """A measured man's whole body, made symmetric, his arms relaxed [Rajagopal 2016]."""
    cycle = neutral_cycle()
    body = subject()
    pair = walk_data_of(cycle, body)
    return Gait(KinematicWalk([pair]), CycleOverlay(cycle, body.leg_length))


def winter_rules(manner: Manner | None = None) -> Gait:
    """The measured legs of [KB92b]'s subject, everything above by published rules."""
    return Gait(winter(), RuleOverlay(manner))


#: Built-in gaits by the name the command line uses.
GAITS: dict[str, Callable[[Manner | None], Gait]] = {"neutral": neutral, "winter": winter_rules}
