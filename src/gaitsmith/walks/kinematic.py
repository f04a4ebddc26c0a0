"""The measured walk as a :class:`~gaitsmith.walks.model.StraightWalk`, [KB92b]."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import roll
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.walks.blend import blend
from gaitsmith.walks.data import TimedSequence, WalkData
from gaitsmith.walks.generalize import (
    affine,
    ankle_at_heel_strike,
    ankle_at_toe_off,
    arc,
    check_step_length,
    generalize,
    mu,
)
from gaitsmith.walks.model import SagittalStep, StepRequest

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Straightness of the legs in standing: hip to ankle over leg length (7 degrees of flexion).
STANDING_REACH = 0.9982
#: Samples a step is cut into, at least; the events are added to them.
SAMPLES = 36
#: The pose at the first toe-off is that of a walk with steps this part as long.
START_SHARE = 0.6
#: Shares of the swing after which the toes are straight again.
TOES_STRAIGHT = 0.35


class KinematicWalk:
    """Walks of any body and step length from one or more measured steps of one person.

    Parameters
    ----------
    prototypes
        Walk data of one person at different step lengths, in any order. The two nearest in
        step length over leg length are generalized and blended ([KB92b] section 6 asks for
        a nearer measurement where the step is far from the measured one).

    Notes
    -----
    [KB92b]. Starting and stopping are beyond the paper: they are the same sequences with one
    step length 0 and standing as the other end.
    """

    def __init__(self, prototypes: Sequence[WalkData]) -> None:
        if not prototypes:
            raise InvalidInputError("a kinematic walk needs at least one measured step")
        self._prototypes = tuple(sorted(prototypes, key=lambda w: w.character.ratio))
        self._cached = lru_cache(maxsize=512)(self._step)

    @property
    def prototypes(self) -> tuple[WalkData, ...]:
        """The measured steps, shortest first."""
        return self._prototypes

    def step(self, body: Body, request: StepRequest) -> SagittalStep:
        """See :meth:`gaitsmith.walks.model.StraightWalk.step`."""
        return self._cached(body, request)

    def walk_data(
        self, body: Body, previous_length: float, length: float, start_height: float | None = None
    ) -> WalkData:
        """Generalized walk data for one step of ``body``; lengths in meters, above zero."""
        ratio = length / body.leg_length
        ratios = [w.character.ratio for w in self._prototypes]
        right = int(np.searchsorted(ratios, ratio))
        around = self._prototypes[max(right - 1, 0) : right + 1]
        walks = [
            generalize(w, body, previous_length, length, start_height=start_height) for w in around
        ]
        if len(walks) == 1:
            return walks[0]
        share = (ratio - ratios[right - 1]) / (ratios[right] - ratios[right - 1])
        return blend(walks[0], walks[1], share, start_height=start_height)

    def _step(self, body: Body, request: StepRequest) -> SagittalStep:
        for length in (request.previous_length, request.length):
            check_step_length(body, length)
        if request.kind == "start":
            return _sample(*self._start(body, request), "start")
        if request.kind == "stop":
            return _sample(*self._stop(body, request), "stop")
        previous, length = request.previous_length, request.length
        walk = self.walk_data(body, previous, length, request.hip_height)
        return _sample(walk, *_rear(walk, previous), "walk")

    def _start(
        self, body: Body, request: StepRequest
    ) -> tuple[WalkData, TimedSequence, TimedSequence]:
        """Data of a step from standing, and pitch and meta of the foot that starts."""
        length = request.length
        before = START_SHARE * length
        stand = standing_height(body) if request.hip_height is None else request.hip_height
        walk = self.walk_data(body, before, length, stand)
        kappa = walk.character.kappa
        _, _, off, meta = mu(walk.character, body, before)
        hip = np.array(walk.hip.values)
        hip[:, 0] = affine(hip[:, 0], 0.0, (1.0 - kappa) * length)
        ankle = np.array(walk.ankle.values)
        ankle[:, 0] = affine(
            ankle[:, 0], ankle_at_toe_off(body.foot, 0.0, off, meta)[0], ankle[-1, 0]
        )
        pitch, toes = _rear(walk, before)
        # the foot stands flat at first: take the part it would already have turned away
        fade = 1.0 - smoothstep(pitch.times / walk.toe_off)[:, None]
        pitch = pitch.with_values(np.minimum(pitch.values - pitch.values[0] * fade, 0.0))
        toes = toes.with_values(np.maximum(toes.values - toes.values[0] * fade, 0.0))
        walk = walk.with_(
            hip=walk.hip.with_values(hip),
            ankle=walk.ankle.with_values(ankle),
            foot1=walk.foot1.with_values(np.zeros_like(walk.foot1.values)),
        )
        return walk, pitch, toes

    def _stop(
        self, body: Body, request: StepRequest
    ) -> tuple[WalkData, TimedSequence, TimedSequence]:
        """Data of the step that closes to standing, and pitch and meta of the rear foot."""
        previous = request.previous_length
        walk = self.walk_data(body, previous, START_SHARE * previous, request.hip_height)
        _, _, off, meta = mu(walk.character, body, previous)
        kappa = walk.character.kappa
        hip, ankle = np.array(walk.hip.values), np.array(walk.ankle.values)
        hip[:, 0] = affine(hip[:, 0], -kappa * previous, 0.0)
        hip[:, 1] = arc(walk.hip.unit, hip[:, 1], hip[0, 1], standing_height(body))
        start = ankle_at_toe_off(body.foot, previous, off, meta)
        end = ankle_at_heel_strike(body.foot, 0.0, 0.0)
        ankle[:, 0] = affine(ankle[:, 0], start[0], end[0])
        ankle[:, 1] = arc(walk.ankle.unit, ankle[:, 1], start[1], end[1])
        swing = arc(walk.foot3.unit, walk.foot3.values[:, 0], -off, 0.0)
        rear = _rear(walk, previous)
        walk = walk.with_(
            hip=walk.hip.with_values(hip),
            ankle=walk.ankle.with_values(ankle),
            foot2=walk.foot2.with_values(np.zeros_like(walk.foot2.values)),
            foot3=walk.foot3.with_values(swing),
            meta=walk.meta.with_values(np.zeros_like(walk.meta.values)),
        )
        return walk, *rear


def standing_height(body: Body) -> float:
    """Height of the hips in standing, feet together, meters."""
    return body.foot.ankle_height + STANDING_REACH * body.leg_length


def _rear(walk: WalkData, previous_length: float) -> tuple[TimedSequence, TimedSequence]:
    """Pitch and meta of the rear foot on [0, TOM]: F2 and M of the step before.

    That step had length ``previous_length``, so its sequences end at mu3 and mu4 of it
    ([KB92b] uses the current length: erratum D6).
    """
    _, _, off, meta = mu(walk.character, walk.body, previous_length)
    out = []
    for sequence, end in ((walk.foot2, -off), (walk.meta, meta)):
        last = sequence.values[-1, 0]
        scaled = sequence.with_values(sequence.values * (end / last))
        times = sequence.times[sequence.times > 1.0 + 1e-9]
        times = np.concatenate([[1.0], times]) if sequence.times[0] <= 1.0 else times
        late = scaled.at(times)
        times = times - 1.0
        if times[0] > 0.0:  # the toes begin to turn only now
            times, late = np.concatenate([[0.0], times]), np.concatenate([[[0.0]], late])
        out.append(TimedSequence(times, late))
    return out[0], out[1]


def phase_grid(*events: float) -> Float[np.ndarray, "T"]:
    """Phases from 0 to 1 that hold every event inside, nowhere coarser than 1/SAMPLES."""
    marks = np.array(sorted({0.0, 1.0, *(e for e in events if 0.0 < e < 1.0)}))
    pieces = [
        np.linspace(a, b, max(2, int(np.ceil((b - a) * SAMPLES)) + 1))[:-1]
        for a, b in pairwise(marks)
    ]
    return np.concatenate([*pieces, [1.0]])


def _sample(
    walk: WalkData, rear_pitch: TimedSequence, rear_meta: TimedSequence, kind: str
) -> SagittalStep:
    """Both feet and the hips on one phase grid."""
    foot, start, stop = walk.body.foot, kind == "start", kind == "stop"
    flat = 0.0 if start else walk.flat
    heel_off, meta_off = (1.0, 1.0) if stop else (walk.heel_off, walk.meta_off)
    phase = phase_grid(flat, heel_off, meta_off, walk.toe_off, max(rear_meta.times[0], 0.0))
    rear, landing = phase <= walk.toe_off, phase <= walk.flat
    raising, turning = phase >= walk.flat, phase >= meta_off

    pitch, meta = np.zeros((2, len(phase), 2))
    pitch[landing, 0] = walk.foot1.at(phase[landing])[:, 0]
    pitch[raising, 0] = walk.foot2.at(phase[raising])[:, 0]
    meta[turning, 0] = walk.meta.at(phase[turning])[:, 0]
    pitch[rear, 1] = rear_pitch.at(phase[rear])[:, 0]
    pitch[~rear, 1] = walk.foot3.at(phase[~rear])[:, 0]
    meta[rear, 1] = rear_meta.at(phase[rear])[:, 0]
    previous = 0.0 if start else walk.previous_length
    bend = np.where(pitch < 0.0, -pitch - meta, 0.0)
    at_off = int(np.flatnonzero(rear)[-1])
    swing = (phase - walk.toe_off) / (1.0 - walk.toe_off)
    relaxing = bend[at_off, 1] * (1.0 - smoothstep(swing / TOES_STRAIGHT))
    bend[~rear, 1] = relaxing[~rear]

    ankle = roll(foot, pitch, meta).ankle
    ankle[:, 1, 0] -= previous
    ankle[~rear, 1] = walk.ankle.at(phase[~rear])
    return SagittalStep(
        phase=phase,
        flat=flat,
        heel_off=heel_off,
        meta_off=meta_off,
        toe_off=walk.toe_off,
        center=walk.hip.at(phase),
        ankle=ankle,
        pitch=pitch,
        meta=meta,
        bend=bend,
    )
