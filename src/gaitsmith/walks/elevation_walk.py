"""Elevation data as a :class:`~gaitsmith.walks.model.StraightWalk`: the product's [SM01] walker.

Pelvis-led: the data say where the hips are over the feet, how the foot rolls and how the other
one swings; legs follow by the shared contact stage. So feet and floor are exact, and thigh and
shank come as near to the data as the feet allow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import minimum_jerk, smoothstep
from gaitsmith.walks.elevation import FOOT, PELVIS, SHANK, THIGH
from gaitsmith.walks.generalize import affine, check_step_length
from gaitsmith.walks.interpolate import ElevInterp
from gaitsmith.walks.kinematic import (
    START_SHARE,
    STOP_SHARE,
    bent_toes,
    phase_grid,
    standing_height,
)
from gaitsmith.walks.model import SagittalStep
from gaitsmith.walks.round_heel import turned
from gaitsmith.walks.step_of import down

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.elevation import ElevationSet
    from gaitsmith.walks.model import StepRequest

#: Phase of the step at which the weights of the step asked for are reached ([SM01]: 0.46 strides).
SETTLED = 0.92
#: Phase of the step by which the front leg alone leads the hips; later if toes leave later.
HANDED = 0.42
#: A sole that is turned by less lies flat, radians: no heel leaves and comes back by a hair.
FLAT = 1e-4
#: Phases of the swing until which the foot leaves where it bore, and from which it goes to land.
LEFT_BEHIND, LANDS = 0.3, 0.6
_LEVEL = 0.5 * np.pi


class Taken(NamedTuple):
    """How the data take steps: weights of the sets, and by how much they miss what is asked.

    Attributes
    ----------
    weights
        ``(n, S)``.
    missed
        ``(n, 2)`` step (length, height) asked for beyond the one taken, meters.
    outside
        ``(n,)`` whether the step is outside of what the sets span.
    """

    weights: Float[np.ndarray, "n S"]
    missed: Float[np.ndarray, "n 2"]
    outside: Bool[np.ndarray, "n"]


class ElevationWalk:
    """Walks elevation sets: level, up and down hill, of any body.

    Parameters
    ----------
    sets
        Three or more of the left leg, whose steps are not all in line.
    others
        As many of the right leg; None: both legs walk alike.

    Notes
    -----
    [SM01] sections 4 and 5 with the resolutions of ``docs/papers/sm01.md``. A step outside of what
    the sets span is that of the nearest mix, carried over to where it must end: the
    contact stage keeps its feet, and :meth:`taken` says so.
    """

    climbs = True

    def __init__(
        self, sets: Sequence[ElevationSet], others: Sequence[ElevationSet] | None = None
    ) -> None:
        both = (tuple(sets), tuple(sets if others is None else others))
        if len(both[LEFT]) != len(both[RIGHT]):
            raise InvalidInputError("both legs need equally many sets")
        self._sets = both
        self._alike = others is None
        self._of: Callable[[Body], tuple[_Figure, _Figure]] = lru_cache(16)(self._figures)
        self._cached: Callable[[Body, StepRequest], SagittalStep] = lru_cache(1024)(self._step)

    def step(self, body: Body, request: StepRequest) -> SagittalStep:
        """See :meth:`gaitsmith.walks.model.StraightWalk.step`."""
        return self._cached(body, request)

    def foresee(self, body: Body, requests: Sequence[StepRequest]) -> None:
        """See :meth:`gaitsmith.walks.model.ClimbingWalk.foresee`."""
        for side, figure in enumerate(self._of(body)):
            steps = [_ends(r)[r.side != side] for r in requests]
            if steps:
                figure.taken(np.array(steps))

    def taken(self, body: Body, steps: Float[np.ndarray, "n 2"], side: int = LEFT) -> Taken:
        """How steps (length, height) in meters on the stance foot ``side`` are taken."""
        return self._of(body)[side].taken(np.asarray(steps, dtype=np.float64))

    def _figures(self, body: Body) -> tuple[_Figure, _Figure]:
        own, other = self._sets
        left = _Figure(own, own if self._alike else other, body)
        return left, left if self._alike else _Figure(other, own, body)

    def _step(self, body: Body, request: StepRequest) -> SagittalStep:
        for length in (request.previous_length, request.length):
            check_step_length(body, length)
        figure, asked = self._of(body)[request.side], _ends(request)
        drawn = _Drawn.of(figure, self._of(body)[1 - request.side], asked)
        if request.kind == "start":
            drawn.from_standing(body)
        if request.kind == "stop":
            drawn.to_standing(body)
        if request.hip_height is not None:
            miss = request.hip_height - drawn.center[0, 1]
            drawn.center[:, 1] += miss * (1.0 - smoothstep(drawn.phase / drawn.toe_off))
        return drawn.step(body)


def _ends(request: StepRequest) -> tuple[tuple[float, float], tuple[float, float]]:
    """Steps (length, rise) in meters that the data take: the one before this one, and this one.

    A start leaves as after a short step, a stop lands as after one.
    """
    length, climb = request.length, request.climbs[1]
    before, fell = request.previous_length, request.climbs[0]
    if request.kind == "start":
        before, fell = START_SHARE * length, START_SHARE * climb
    if request.kind == "stop":
        length, climb = STOP_SHARE * before, STOP_SHARE * fell
    return (before, fell), (length, climb)


class _Figure:
    """One body's sets on the phases of a step: stance leg of one side, swing leg of the other."""

    def __init__(
        self,
        stance: Sequence[ElevationSet],
        swing: Sequence[ElevationSet],
        body: Body,
    ) -> None:
        alike = stance is swing
        self.interp = ElevInterp(stance, body, None if alike else swing)
        self.planar, self.foot = self.interp.figure, body.foot
        own = self.interp.sets
        other = own if alike else tuple(s.for_body(body) for s in swing)
        #: The swing foot leaves at one phase whatever the mix: sets are warped to that.
        leaves = np.array([2.0 * s.toe_off - 1.0 for s in other])
        self.toe_off = round(float(leaves.mean()), 12)
        self.phase = phase = phase_grid(self.toe_off)
        late = [
            0.5 + 0.5 * np.interp(phase, [0.0, self.toe_off, 1.0], [0.0, a, 1.0]) for a in leaves
        ]
        #: ``(T, S, 4)`` elevations of stance and swing leg; ``(T, S)`` meta of both.
        self.stance = np.stack([s.at(0.5 * phase) for s in own], axis=1)
        self.swing = np.stack([s.at(t) for s, t in zip(other, late, strict=True)], axis=1)
        early = 0.5 * phase
        standing = np.stack([s.beside_at(early) for s in own], axis=1)
        flying = np.stack([s.beside_at(t) for s, t in zip(other, late, strict=True)], axis=1)
        self.meta = (standing[..., 0], flying[..., 0])
        #: ``(T, S)`` meters that the hips run above what the angles say.
        self.above = body.leg_length * standing[..., 1]
        self.slope = np.array([s.slope for s in own])
        self._known: dict[tuple[float, float], tuple[np.ndarray, np.ndarray, bool]] = {}

    def taken(self, steps: Float[np.ndarray, "n 2"]) -> Taken:
        """See :meth:`ElevationWalk.taken`; answers are remembered, not used for others."""
        keys = [(float(a), float(b)) for a, b in steps]
        new = [k for k in dict.fromkeys(keys) if k not in self._known]
        if new:
            if len(self._known) > 4096:
                self._known.clear()
                new = list(dict.fromkeys(keys))
            wanted = np.array(new)
            found = self.interp.find(wanted)
            # rounded: in other company sums end otherwise in their last bits
            weights, missed = np.round(found.weights, 11), np.round(wanted - found.achieved, 11)
            rows = zip(weights, missed, found.outside.tolist(), strict=True)
            self._known |= dict(zip(new, rows, strict=True))
        rows = [self._known[k] for k in keys]
        weights, missed, outside = zip(*rows, strict=True)
        return Taken(np.array(weights), np.array(missed), np.array(outside))


@dataclass(eq=False)
class _Drawn:
    """Curves of one step, about N of the stance foot, heights from the line of the footsteps.

    ``center`` (T, 2) of the hips, ``swing`` (T, 2) the swing ankle as the data have it; ``pitch``
    and ``meta`` (T, 2) of (stance, swing). ``previous`` and ``length`` are of the steps, meters.
    """

    phase: Float[np.ndarray, "T"]
    toe_off: float
    center: Float[np.ndarray, "T 2"]
    swing: Float[np.ndarray, "T 2"]
    pitch: Float[np.ndarray, "T 2"]
    meta: Float[np.ndarray, "T 2"]
    previous: float
    length: float

    @staticmethod
    def of(figure: _Figure, after: _Figure, asked: Sequence[tuple[float, float]]) -> _Drawn:
        """The step that follows one of ``asked[0]`` and takes ``asked[1]``, (length, rise).

        ``after`` has the other foot's stance: the step before was its.
        """
        phase, planar, foot, toe_off = figure.phase, figure.planar, figure.foot, figure.toe_off
        before, taken = after.taken(np.array(asked[:1])), figure.taken(np.array(asked[1:]))
        share = minimum_jerk(phase / SETTLED)
        # sets of the step before stand in the same order for both sides
        weights = before.weights + share[:, None] * (taken.weights - before.weights)
        own = np.einsum("ts,tsc->tc", weights, figure.stance)
        other = np.einsum("ts,tsc->tc", weights, figure.swing)
        data_slope = weights @ figure.slope
        metas = np.stack([(weights * m).sum(1) for m in figure.meta], axis=-1)
        pitch = np.stack([own[:, FOOT], other[:, FOOT]], axis=-1) - _LEVEL - data_slope[:, None]
        pitch[:, 0] = _rolled(pitch[:, 0])
        rear = phase <= toe_off
        pitch[rear, 1] = np.minimum(pitch[rear, 1], 0.0)
        meta = np.maximum(metas, 0.0)
        meta[:, 1] = np.where(rear, meta[:, 1], 0.0)
        meta = np.where(pitch < 0.0, np.minimum(meta, -pitch), 0.0)
        # up the leg that stands to the hips, down the other to its ankle
        ankle = turned(planar.sole.stand(pitch[:, 0]), data_slope)
        hip = ankle - planar.shin * down(own[:, SHANK]) - planar.thigh * down(own[:, THIGH])
        shift = planar.pelvis * (np.tan(other[:, PELVIS]) - np.tan(own[:, PELVIS]))
        half = 0.5 * np.stack([shift, np.zeros(len(phase))], axis=-1)
        (previous, fell), (length, rise) = asked
        # what the mixes miss is shared by the two legs that predict the hips at heel strike
        start, end = -0.5 * before.missed[0], 0.5 * taken.missed[0]
        soft = smoothstep(phase)
        center = hip + half + start + soft[:, None] * (end - start)
        leg = planar.shin * down(other[:, SHANK]) + planar.thigh * down(other[:, THIGH])
        swing = center + half + leg
        # the rear leg knows how the hips came here: it hands over while both legs bear
        ankle = rolled_ankle(foot, pitch[:, 1], meta[:, 1])
        # the data's toes lie until the other heel strikes, as the paper's
        lies = planar.sole.stand(pitch[:1, 1]) - ankle[:1]
        ankle += (1.0 - smoothstep(np.minimum(phase / LEFT_BEHIND, 1.0)))[:, None] * lies
        ankle = turned(ankle, data_slope) - [previous, fell]
        behind = ankle - leg - half - start
        off = behind - center
        last = int(rear.sum()) - 1
        slope = (off[last] - off[last - 1]) / (phase[last] - phase[last - 1])
        on = np.maximum(phase - toe_off, 0.0)[:, None]  # where it has left: as it was about to
        off = np.where(rear[:, None], off, off[last] + slope * on)
        hands = minimum_jerk(phase / max(toe_off, HANDED))[:, None]
        center = center + (1.0 - hands) * off
        center[:, 1] += (weights * figure.above).sum(axis=1)
        # heights from the line: of the step before at first, of this one at last
        grades = [rise / length if length > 0.0 else 0.0 for length, rise in asked]
        grade = grades[0] + soft * (grades[1] - grades[0])
        center[:, 1] -= grade * center[:, 0]
        over = (rise + fell) / (length + previous)
        swing[:, 1] -= over * (swing[:, 0] + previous) - fell
        return _Drawn(phase, toe_off, center, swing, pitch, meta, previous, length)

    @property
    def _rear(self) -> Bool[np.ndarray, "T"]:
        """While the rear foot bears."""
        return self.phase <= self.toe_off

    def from_standing(self, body: Body) -> None:
        """The first foot leaves as in the walk before, from where it stands."""
        fade = 1.0 - smoothstep(self.phase)
        self.center[:, 0] = affine(self.center[:, 0], 0.0, self.center[-1, 0])
        self.center[:, 1] += (standing_height(body) - self.center[0, 1]) * fade
        self.pitch[:, 0] = np.minimum(self.pitch[:, 0], 0.0)
        turned_away = np.where(self._rear, 1.0 - smoothstep(self.phase / self.toe_off), 0.0)
        self.pitch[:, 1] -= self.pitch[0, 1] * turned_away
        self.meta[:, 1] = np.maximum(self.meta[:, 1] - self.meta[0, 1] * turned_away, 0.0)
        self.swing[:, 0] += self.previous * fade
        self.previous = 0.0

    def to_standing(self, body: Body) -> None:
        """The rear foot closes beside the other, that stays flat."""
        rise = smoothstep(self.phase)
        self.center[:, 0] = affine(self.center[:, 0], self.center[0, 0], 0.0)
        self.center[:, 1] += (standing_height(body) - self.center[-1, 1]) * rise
        self.pitch[:, 0] = np.maximum(self.pitch[:, 0], 0.0)
        self.meta[:, 0] = 0.0
        late = smoothstep((self._swing - LEFT_BEHIND) / (1.0 - LEFT_BEHIND))
        self.pitch[:, 1] -= self.pitch[-1, 1] * late
        self.swing[:, 0] -= self.length * rise
        self.length = 0.0

    @property
    def _swing(self) -> Float[np.ndarray, "T"]:
        """0 at toe-off, 1 at landing."""
        return (self.phase - self.toe_off) / (1.0 - self.toe_off)

    def step(self, body: Body) -> SagittalStep:
        """Feet that bear where they stand, a swing between, and the events."""
        foot, phase, rear = body.foot, self.phase, self._rear
        ankle = rolled_ankle(foot, self.pitch, self.meta)
        ankle[:, 1, 0] -= self.previous
        last = int(rear.sum()) - 1
        leaves = ankle[last, 1] - self.swing[last]
        lands = rolled_ankle(foot, self.pitch[-1:, 1], np.zeros(1))[0] + [self.length, 0.0]
        fades = 1.0 - smoothstep(self._swing / LEFT_BEHIND)
        comes = smoothstep((self._swing - LANDS) / (1.0 - LANDS))
        flown = self.swing + fades[:, None] * leaves + comes[:, None] * (lands - self.swing[-1])
        ankle[:, 1] = np.where(rear[:, None], ankle[:, 1], flown)
        lies = self.pitch[:, 0] <= 0.0
        flat = float(phase[lies.argmax()]) if lies.any() else 1.0
        heel_off = max(_last_before(phase, self.pitch[:, 0] < 0.0), flat)
        return SagittalStep(
            phase=phase,
            flat=flat,
            heel_off=heel_off,
            meta_off=max(_last_before(phase, self.meta[:, 0] > 0.0), heel_off),
            toe_off=self.toe_off,
            center=self.center,
            ankle=ankle,
            pitch=self.pitch,
            meta=self.meta,
            bend=bent_toes(phase, self.toe_off, self.pitch, self.meta),
        )


def _last_before(phase: Float[np.ndarray, "T"], holds: Bool[np.ndarray, "T"]) -> float:
    """The last sample before ``holds`` begins; 1 if it never does."""
    if not holds.any():
        return 1.0
    return float(phase[max(int(holds.argmax()) - 1, 0)])


def _rolled(pitch: Float[np.ndarray, "T"]) -> Float[np.ndarray, "T"]:
    """Down until it lies, then flat or on the toes: mixes of sets that lie at other times."""
    pitch = np.where(np.abs(pitch) < FLAT, 0.0, pitch)
    lies = pitch <= 0.0
    if not lies.any():
        return pitch
    first = int(lies.argmax())
    out = pitch.copy()
    out[first:] = np.minimum(out[first:], 0.0)
    return out
