"""How the person of a script walks, and in which gait."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.errors import UnknownNameError
from gaitsmith.plan.pace import choose_pace

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.lengths import Stance
    from gaitsmith.plan.pace import Pace
    from gaitsmith.plan.rhythm import Rhythm
    from gaitsmith.plan.routes import Routes
    from gaitsmith.plan.script import Tempo


#: Leg (m) of the adult whose durations of local steps are given; others keep the Froude number.
LEG = 0.834


@dataclass(frozen=True)
class Manners:
    """How the director's person walks: as :func:`~gaitsmith.plan.follow.follow` is told."""

    body: Body
    pace: Pace
    stance: Stance
    ground: Ground
    rhythm: Rhythm | None = None
    outside: bool = True
    keep_cadence: bool = False
    keep_length: bool = False
    paced: Callable[[Tempo], Pace] | None = None
    gaits: Mapping[str, Manners] | None = None
    routes: Routes | None = None

    @property
    def tempo(self) -> float:
        """Durations of this body over those of an adult."""
        return float(np.sqrt(self.body.leg_length / LEG))

    def in_gait(self, gait: str | None) -> Manners:
        """How the person walks in a gait of that name; None: as usual."""
        if gait is None:
            return self
        if self.gaits is None or gait not in self.gaits:
            raise UnknownNameError("gait", gait, self.gaits or ())
        return replace(self.gaits[gait], gaits=self.gaits)

    def pace_at(self, tempo: Tempo | None) -> Pace:
        """The pace of an action."""
        said: dict[str, Any] = {} if tempo is None else dict(tempo.said)
        if tempo is None or not said:
            return self.pace
        return self.paced(tempo) if self.paced else choose_pace(self.body, **said)

    def keeps(self, tempo: Tempo | None) -> bool:
        """Whether an action slows down in curves by shorter steps alone."""
        if tempo is None or not tempo.said:
            return self.keep_cadence
        return tempo.cadence is not None

    def keeps_length(self, tempo: Tempo | None) -> bool:
        """Whether the steps of an action do not get shorter on slopes."""
        if tempo is None or not tempo.said:
            return self.keep_length
        return tempo.step_length is not None


def gait_of(tempo: Tempo | None) -> str | None:
    """The gait that an action names."""
    return None if tempo is None else tempo.gait
