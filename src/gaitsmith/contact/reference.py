"""What a walker proposes for one step, and the proposals of a whole walk side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.step_curves import CURVES, FINEST, StepCurves, curve_of
from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import end_slope_correction

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

#: Curves that are positions, and so move with the step.
PLACES = ("center", "ankle")


@dataclass(frozen=True, eq=False)
class ReferenceStep:
    """One step as a walker proposes it: its curves and where they belong.

    Attributes
    ----------
    curves
        Relative to ``origin``.
    origin
        ``(3,)`` world, meters.
    stance
        Side that bears through the whole step.
    toe_off
        Phase at which the swing foot leaves its foothold, one of ``curves.phase``; 1 or more:
        it stays (standing).
    foothold, foothold_heading
        ``(2, 3)``, ``(2,)`` world: N and heading where [left, right] stand as the step begins.
    target, target_heading
        ``(3,)``, radians: where the swing foot lands at phase 1.
    share
        Seconds that it takes over those of a usual step, at most 1: what is smooth over a part of
        a step is so over as much of its time.
    speed_change
        What is added to the speed of the center at phase 0 and at phase 1, meters per step, so
        that it joins its neighbors; the way there is a cubic that moves neither end.
    raising
        Share of the usual rise of the rear heel that may bring its leg in reach before it
        leaves; what is missing lowers the hips.
    """

    curves: StepCurves
    origin: Float[np.ndarray, "3"]
    stance: int
    toe_off: float
    foothold: Float[np.ndarray, "2 3"]
    foothold_heading: Float[np.ndarray, "2"]
    target: Float[np.ndarray, "3"]
    target_heading: float
    speed_change: tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]] | None = None
    raising: float = 1.0
    share: float = 1.0

    def __post_init__(self) -> None:
        """Check the places, and that the foot leaves on a sample."""
        places = np.concatenate([self.origin, np.ravel(self.foothold), self.target])
        if places.shape != (12,) or not np.isfinite(places).all():
            raise InvalidInputError("origin, foothold and target must be 1, 2 and 1 finite points")
        if self.toe_off < 1.0 and self.toe_off not in self.curves.phase:
            raise InvalidInputError("phase must hold toe_off, so that the foot leaves on a sample")

    @staticmethod
    def trusted(
        curves: StepCurves,
        origin: Float[np.ndarray, "3"],
        stance: int,
        toe_off: float,
        foothold: Float[np.ndarray, "2 3"],
        foothold_heading: Float[np.ndarray, "2"],
        target: Float[np.ndarray, "3"],
        target_heading: float,
        speed_change: tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]] | None = None,
    ) -> ReferenceStep:
        """A step that is known to be right: for batches checked as a whole."""
        out = object.__new__(ReferenceStep)
        out.__dict__.update(
            curves=curves,
            origin=origin,
            stance=stance,
            toe_off=toe_off,
            foothold=foothold,
            foothold_heading=foothold_heading,
            target=target,
            target_heading=target_heading,
            speed_change=speed_change,
        )
        return out

    def with_(self, **changes: object) -> ReferenceStep:
        """Copy with some fields replaced."""
        return replace(self, **changes)  # type: ignore[arg-type]

    def joined(self, start: Float[np.ndarray, "3"], end: Float[np.ndarray, "3"]) -> ReferenceStep:
        """Copy with the speed of the center changed by ``start`` and ``end``."""
        out = object.__new__(ReferenceStep)
        out.__dict__.update(self.__dict__, speed_change=(start, end))
        return out

    def refined(self) -> ReferenceStep:
        """Itself, with curves fine enough for the contact stage."""
        fine = self.curves.refined(self.toe_off)
        return self if fine is self.curves else self.with_(curves=fine)


def _fine(steps: Sequence[ReferenceStep]) -> list[ReferenceStep]:
    """All steps refined; those that share their phases are looked at once."""
    phases = {id(s.curves.phase): s.curves.phase for s in steps}
    coarse = {k for k, p in phases.items() if np.diff(p).max() > FINEST * (1.0 + 1e-9)}
    return [s.refined() if id(s.curves.phase) in coarse else s for s in steps]


@dataclass(frozen=True, eq=False)
class SwingEnd:
    """The swing foot of each of S steps at one instant, as proposed."""

    ankle: Float[np.ndarray, "S 3"]
    heading: Float[np.ndarray, "S"]
    pitch: Float[np.ndarray, "S"]

    @staticmethod
    def of(steps: Sequence[ReferenceStep], *, at_end: bool) -> SwingEnd:
        """Read it off the steps' own samples."""
        if at_end:
            place = [-1] * len(steps)
        else:
            place = [int(s.curves.phase.searchsorted(min(s.toe_off, 1.0))) for s in steps]
        samples = [s.curves.table[:, i] for s, i in zip(steps, place, strict=True)]
        table = np.array(samples).T
        every, swing = np.arange(len(steps)), np.array([1 - s.stance for s in steps])
        ankle, heading, pitch = (
            curve_of(table, name)[every, swing] for name in ("ankle", "foot_heading", "pitch")
        )
        return SwingEnd(np.array([s.origin for s in steps]) + ankle, heading, pitch)


@dataclass(eq=False)
class Proposal:
    """The proposals of S steps on one axis of M nodes; the contact stage works on this.

    The end of a step and the start of the next are one node, taken from the next.

    Attributes
    ----------
    at
        ``(M,)`` walk phase: index of the step plus its phase.
    phase
        ``(M,)`` phase within the step, as proposed (``at - step`` would round it over the
        events); 1 at the very last node.
    step
        ``(M,)`` index of the step.
    table
        ``(C, M)`` all curves, writable; rows as in :class:`StepCurves`.
    stance, toe_off, foothold, foothold_heading, target, target_heading, raising
        ``(S, ...)`` of each step.
    leaving, landing
        The swing foot as each step proposes it at its own toe-off and end.
    """

    at: Float[np.ndarray, "M"]
    phase: Float[np.ndarray, "M"]
    step: Int[np.ndarray, "M"]
    table: Float[np.ndarray, "C M"]
    stance: Int[np.ndarray, "S"]
    toe_off: Float[np.ndarray, "S"]
    foothold: Float[np.ndarray, "S 2 3"]
    foothold_heading: Float[np.ndarray, "S 2"]
    target: Float[np.ndarray, "S 3"]
    target_heading: Float[np.ndarray, "S"]
    raising: Float[np.ndarray, "S"]
    leaving: SwingEnd
    landing: SwingEnd

    @cached_property
    def curves(self) -> dict[str, Float[np.ndarray, "M ..."]]:
        """The curves by name: views of the table, each component contiguous."""
        return {name: curve_of(self.table, name) for name in CURVES}

    def bearing(self) -> Bool[np.ndarray, "M 2"]:
        """Whether each foot stands on its foothold."""
        return bearing(self.stance, self.toe_off, self.step, self.phase)


def bearing(
    stance: Int[np.ndarray, "S"],
    toe_off: Float[np.ndarray, "S"],
    step: Int[np.ndarray, "n"],
    phase: Float[np.ndarray, "n"],
) -> Bool[np.ndarray, "n 2"]:
    """Whether [left, right] stand on their footholds at ``phase`` of ``step``."""
    lifted, stands = phase > toe_off[step], stance[step]
    return ~np.array([lifted & (stands != side) for side in (LEFT, RIGHT)]).T


def stack(steps: Sequence[ReferenceStep]) -> Proposal:
    """Put the proposals of consecutive steps on one axis."""
    if not steps:
        raise InvalidInputError("a walk needs at least one step")
    steps = _fine(steps)
    own = [slice(None, -1)] * (len(steps) - 1) + [slice(None)]
    counts = [len(s.curves.phase) - 1 for s in steps]
    counts[-1] += 1
    index = np.repeat(np.arange(len(steps)), counts)
    phase = np.concatenate([s.curves.phase[i] for s, i in zip(steps, own, strict=True)])
    table = np.concatenate([s.curves.table[:, i] for s, i in zip(steps, own, strict=True)], axis=1)
    origin = np.repeat(np.array([s.origin for s in steps]).T, counts, axis=1).T
    center, ankle = (curve_of(table, name) for name in PLACES)
    center += origin
    ankle += origin[:, None]
    none = (np.zeros(3), np.zeros(3))
    change = np.array([s.speed_change or none for s in steps])
    begin, end = (np.repeat(change[:, i].T, counts, axis=1).T for i in (0, 1))
    center += end_slope_correction(phase, begin, end)
    return Proposal(
        at=phase + index,
        phase=phase,
        step=index,
        table=table,
        stance=np.array([s.stance for s in steps]),
        toe_off=np.array([s.toe_off for s in steps]),
        foothold=np.array([s.foothold for s in steps]),
        foothold_heading=np.array([s.foothold_heading for s in steps]),
        target=np.array([s.target for s in steps]),
        target_heading=np.array([s.target_heading for s in steps]),
        raising=np.array([s.raising for s in steps]),
        leaving=SwingEnd.of(steps, at_end=False),
        landing=SwingEnd.of(steps, at_end=True),
    )
