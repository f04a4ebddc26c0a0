"""What a walker proposes for one step, and the proposals of a whole walk side by side."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import (
    end_slope_correction,
    hermite,
    pchip_slopes,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

#: Fields of StepCurves that are sampled on its phases, with their shape after (T,).
CURVES: dict[str, tuple[int | None, ...]] = {
    "center": (3,),
    "heading": (),
    "pelvis": (3,),
    "ankle": (2, 3),
    "foot_heading": (2,),
    "pitch": (2,),
    "meta": (2,),
    "bend": (2,),
    "upper": (None, 3),
}
#: Farthest that two samples may be apart for the contact stage.
FINEST = 1.0 / 36.0
#: Those that are positions, and so move with the step.
PLACES = ("center", "ankle")


@dataclass(frozen=True, eq=False)
class StepCurves:
    """Curves of one step as a walker proposes them, before the feet meet the ground.

    World axes, meters and radians; positions are relative to a point that
    :class:`ReferenceStep` names, so that equal steps share their curves. Side axes are
    [left, right].

    Attributes
    ----------
    phase
        ``(T,)`` from 0 to 1; holds the toe-off.
    center, heading, pelvis
        ``(T, 3)`` mid-point of the hips; ``(T,)`` heading of the walk, unwrapped; ``(T, 3)``
        rotation vector of the pelvis in the heading's frame.
    ankle
        ``(T, 2, 3)``; where a foot bears, the contact stage replaces it.
    foot_heading
        ``(T, 2)``, unwrapped.
    pitch, meta, bend
        ``(T, 2)`` sole pitch, toes against the floor, toes against the sole, as in
        :class:`gaitsmith.walks.model.SagittalStep`, against the foothold's plane.
    upper
        ``(T, U, 3)`` local rotation vectors of the upper body's joints.
    """

    phase: Float[np.ndarray, "T"]
    center: Float[np.ndarray, "T 3"]
    heading: Float[np.ndarray, "T"]
    pelvis: Float[np.ndarray, "T 3"]
    ankle: Float[np.ndarray, "T 2 3"]
    foot_heading: Float[np.ndarray, "T 2"]
    pitch: Float[np.ndarray, "T 2"]
    meta: Float[np.ndarray, "T 2"]
    bend: Float[np.ndarray, "T 2"]
    upper: Float[np.ndarray, "T U 3"]

    def __post_init__(self) -> None:
        """Copy, check and freeze the arrays."""
        n = len(self.phase)
        object.__setattr__(self, "phase", frozen_array("phase", self.phase, (n,)))
        for name, shape in CURVES.items():
            array = frozen_array(name, getattr(self, name), (n, *shape))
            object.__setattr__(self, name, array)
        if self.phase[0] != 0.0 or self.phase[-1] != 1.0 or (np.diff(self.phase) <= 0.0).any():
            raise InvalidInputError("phase must rise from 0 to 1 without repeating")

    @staticmethod
    def trusted(**curves: Float[np.ndarray, "T ..."]) -> StepCurves:
        """Curves that are known to be right, taken as they are: for batches checked as a whole."""
        out = object.__new__(StepCurves)
        out.__dict__.update(curves)
        return out

    def with_(self, **changes: object) -> StepCurves:
        """Copy with some fields replaced; the copy is checked again."""
        return replace(self, **changes)  # type: ignore[arg-type]

    def refined(self, *events: float) -> StepCurves:
        """The same curves on samples well closer than :data:`FINEST`; itself if they are closer.

        The contact stage corrects on samples: a coarse walk would escape it between them.
        ``events`` are phases at which a curve may have a corner; none is read across them.
        """
        if np.diff(self.phase).max() <= FINEST * (1.0 + 1e-9):
            return self
        marks = np.array(sorted({0.0, *(e for e in events if 0.0 < e < 1.0), 1.0}))
        pieces = []
        for first, last in pairwise(marks):
            own = self.phase[(self.phase >= first) & (self.phase <= last)]
            more = [
                np.linspace(a, b, int(np.ceil(2.0 * (b - a) / FINEST)) + 1)[:-1]
                for a, b in pairwise(own)
            ]
            pieces.append((own, np.concatenate([*more, [last]])))
        phase = np.concatenate(
            [p[: None if i == len(pieces) - 1 else -1] for i, (_, p) in enumerate(pieces)]
        )
        curves = {}
        for name in CURVES:
            values = getattr(self, name)
            flat = values.reshape(len(values), -1)
            read = []
            for i, (own, fine) in enumerate(pieces):
                rows = flat[(self.phase >= own[0]) & (self.phase <= own[-1])]
                fine = fine if i == len(pieces) - 1 else fine[:-1]
                read.append(hermite(own, rows, pchip_slopes(own, rows), fine))
            curves[name] = np.concatenate(read).reshape(len(phase), *values.shape[1:])
        return StepCurves(phase=phase, **curves)

    @property
    def end_speeds(self) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
        """Speed of the center at phase 0 and at phase 1, meters per step."""
        first, last = end_speeds([self])
        return first[0], last[0]


def end_speeds(
    curves: Sequence[StepCurves],
) -> tuple[Float[np.ndarray, "S 3"], Float[np.ndarray, "S 3"]]:
    """Speeds of the centers at phase 0 and at phase 1, meters per step."""
    own = list({id(c): c for c in curves}.values())
    index = {id(c): i for i, c in enumerate(own)}
    each = np.array([index[id(c)] for c in curves])
    out = []
    for samples in ([0, 1, 2], [-1, -2, -3]):
        x = np.array([_three(c.phase, samples) for c in own])
        y = np.array([_three(c.center, samples) for c in own])
        h0, h1 = (x[:, 1] - x[:, 0])[:, None], (x[:, 2] - x[:, 1])[:, None]
        d0, d1 = (y[:, 1] - y[:, 0]) / h0, (y[:, 2] - y[:, 1]) / h1
        out.append(((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1))
    return out[0][each], out[1][each]


def _three(values: Float[np.ndarray, "T *c"], samples: list[int]) -> Float[np.ndarray, "3 *c"]:
    """Three samples at an end; of two, a third on their line."""
    if len(values) > 2:
        return values[samples]
    first, second = values[samples[0]], values[samples[1]]
    return np.array([first, second, 2.0 * second - first])


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
    speed_change
        What is added to the speed of the center at phase 0 and at phase 1, meters per step, so
        that it joins its neighbors; the way there is a cubic that moves neither end.
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
        places: dict[tuple[int, float], int] = {}
        for s in steps:
            key = (id(s.curves.phase), s.toe_off)
            if not at_end and key not in places:
                places[key] = int(s.curves.phase.searchsorted(min(s.toe_off, 1.0)))
        picks = [
            (s.curves, -1 if at_end else places[id(s.curves.phase), s.toe_off], 1 - s.stance)
            for s in steps
        ]
        origin = np.array([s.origin for s in steps])
        return SwingEnd(
            ankle=origin + np.array([c.ankle[i, side] for c, i, side in picks]),
            heading=np.array([c.foot_heading[i, side] for c, i, side in picks]),
            pitch=np.array([c.pitch[i, side] for c, i, side in picks]),
        )


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
    curves
        The fields of :data:`CURVES`, ``(M, ...)``, writable.
    stance, toe_off, foothold, foothold_heading, target, target_heading
        ``(S, ...)`` of each step.
    leaving, landing
        The swing foot as each step proposes it at its own toe-off and end.
    """

    at: Float[np.ndarray, "M"]
    phase: Float[np.ndarray, "M"]
    step: Int[np.ndarray, "M"]
    curves: dict[str, Float[np.ndarray, "M ..."]]
    stance: Int[np.ndarray, "S"]
    toe_off: Float[np.ndarray, "S"]
    foothold: Float[np.ndarray, "S 2 3"]
    foothold_heading: Float[np.ndarray, "S 2"]
    target: Float[np.ndarray, "S 3"]
    target_heading: Float[np.ndarray, "S"]
    leaving: SwingEnd
    landing: SwingEnd

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
    down = np.ones((len(step), 2), dtype=np.bool_)
    swing = 1 - stance[step]
    down[np.arange(len(step)), swing] = phase <= toe_off[step]
    return down


def stack(steps: Sequence[ReferenceStep]) -> Proposal:
    """Put the proposals of consecutive steps on one axis."""
    if not steps:
        raise InvalidInputError("a walk needs at least one step")
    last = len(steps) - 1
    steps = _fine(steps)

    def joined(name: str) -> Float[np.ndarray, "M ..."]:
        parts = [getattr(s.curves, name)[: None if i == last else -1] for i, s in enumerate(steps)]
        return np.concatenate(parts)

    counts = [len(s.curves.phase) - (i != last) for i, s in enumerate(steps)]
    index = np.repeat(np.arange(len(steps)), counts)
    curves = {name: joined(name) for name in CURVES}
    origin = np.array([s.origin for s in steps])[index]
    for name in PLACES:
        curves[name] += origin if name == "center" else origin[:, None]
    phase = joined("phase")
    none = (np.zeros(3), np.zeros(3))
    change = np.array([s.speed_change or none for s in steps])[index]
    curves["center"] += end_slope_correction(phase, change[:, 0], change[:, 1])
    return Proposal(
        at=phase + index,
        phase=phase,
        step=index,
        curves=curves,
        stance=np.array([s.stance for s in steps]),
        toe_off=np.array([s.toe_off for s in steps]),
        foothold=np.array([s.foothold for s in steps]),
        foothold_heading=np.array([s.foothold_heading for s in steps]),
        target=np.array([s.target for s in steps]),
        target_heading=np.array([s.target_heading for s in steps]),
        leaving=SwingEnd.of(steps, at_end=False),
        landing=SwingEnd.of(steps, at_end=True),
    )
