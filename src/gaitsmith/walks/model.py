"""Seam 1: what a straight-line walk must be, and what it is asked and answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.conventions import StepKind


@dataclass(frozen=True)
class StepRequest:
    """One step asked of a straight-line walk, from heel strike to heel strike.

    Attributes
    ----------
    side
        Side of the stance foot, 0 left, 1 right.
    previous_length, length, next_length
        Meters between the N of successive footsteps along the walk; 0 before a start and
        after a stop.
    duration
        Seconds of this step.
    rise
        Meters that the new footstep lies above the stance foot.
    hip_height
        Meters above the stance foot's floor at which the hips begin, as the previous step
        left them (its own, uncorrected height); None: what a steady walk would have reached.
    kind
        ``"start"`` from standing feet side by side, ``"walk"``, or ``"stop"``: the swing foot
        closes beside the stance foot.
    previous_duration
        Seconds of the step before; None: the same as this one. What goes with the speed of a walk
        joins from step to step by it.
    stride
        Number of the stride, from left heel strike to left heel strike, modulo the strides after
        which the gait repeats; 0 for nearly all.
    """

    side: int
    previous_length: float
    length: float
    next_length: float
    duration: float
    rise: float = 0.0
    hip_height: float | None = None
    kind: StepKind = "walk"
    previous_duration: float | None = None
    stride: int = 0
    climbs: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class SagittalStep:
    """One straight step, as curved walking needs it: the "2D step information" of [KB92a].

    Positions are ``(forward, up)`` meters from N, the floor point under the flat stance
    ankle. Angles are radians. The last axis of two counts (stance, swing). All T samples
    share ``phase``, which holds the four events, so that nothing is rounded over them.

    Attributes
    ----------
    phase
        ``(T,)`` rising from 0 (HSM-) to 1 (HSM+).
    flat
        FGM: phase at which the stance foot is flat; 0 if it starts so.
    heel_off, meta_off
        Phases at which the stance heel leaves the floor and its toes begin to turn about
        their tip (MOM); 1 or more where that does not happen in this step.
    toe_off
        TOM: phase at which the swing foot leaves the floor, in (0, 1).
    center
        ``(T, 2)`` mid-point of the hips.
    ankle
        ``(T, 2, 2)`` ankles of stance and swing foot over the whole step.
    pitch
        ``(T, 2)`` sole (heel to ball) against the floor, toes up positive.
    meta
        ``(T, 2)`` toes against the floor while the foot bears on their tip, else 0.
    bend
        ``(T, 2)`` toes against the sole, toes up positive.
    """

    phase: Float[np.ndarray, "T"]
    flat: float
    heel_off: float
    meta_off: float
    toe_off: float
    center: Float[np.ndarray, "T 2"]
    ankle: Float[np.ndarray, "T 2 2"]
    pitch: Float[np.ndarray, "T 2"]
    meta: Float[np.ndarray, "T 2"]
    bend: Float[np.ndarray, "T 2"]

    def __post_init__(self) -> None:
        """Copy, check and freeze the arrays."""
        n = len(self.phase)
        for name, shape in (
            ("phase", (n,)),
            ("center", (n, 2)),
            ("ankle", (n, 2, 2)),
            ("pitch", (n, 2)),
            ("meta", (n, 2)),
            ("bend", (n, 2)),
        ):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape))
        if (
            n < 2
            or self.phase[0] != 0.0
            or self.phase[-1] != 1.0
            or (np.diff(self.phase) <= 0).any()
        ):
            raise InvalidInputError("phase must rise from 0 to 1 without repeating")
        if not 0.0 < self.toe_off < 1.0:
            raise InvalidInputError(f"toe_off must be a phase in (0, 1), got {self.toe_off!r}")
        if not 0.0 <= self.flat <= self.heel_off <= self.meta_off:
            raise InvalidInputError(
                "events must come in order: 0 <= flat <= heel_off <= meta_off, got "
                f"{self.flat!r}, {self.heel_off!r}, {self.meta_off!r}"
            )


@runtime_checkable
class StraightWalk(Protocol):
    """A straight-line walking system. One method; nothing else is assumed.

    Whoever has this can drive curved walking, planning and the studio: they call ``step``
    once per step and bend the answer ([KB92a] section 3). An implementation needs no base
    class and must not know about paths.
    """

    def step(self, body: Body, request: StepRequest) -> SagittalStep:
        """Compute one step; raise InfeasibleStepError if ``body`` cannot take it."""
        ...


@runtime_checkable
class ClimbingWalk(StraightWalk, Protocol):
    """A straight walk that steps otherwise up and down hill.

    It still answers as on the level: heights count from the line through the footsteps, soles
    from the ground.
    """

    climbs: bool

    def foresee(self, body: Body, requests: Sequence[StepRequest]) -> None:
        """All ``requests`` are about to be asked: what they share may be found at once."""
        ...


def climbs(walk: StraightWalk) -> bool:
    """Whether ``walk`` steps otherwise up and down hill."""
    return isinstance(walk, ClimbingWalk) and walk.climbs
