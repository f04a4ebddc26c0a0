"""The measured walk as a :class:`~gaitsmith.walks.model.StraightWalk`, [KB92b]."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.walks.blend import blend, blended_character
from gaitsmith.walks.data import TimedSequence, WalkData
from gaitsmith.walks.generalize import (
    affine,
    ankle_at_heel_strike,
    arc,
    check_step_length,
    generalize,
    mu,
)
from gaitsmith.walks.model import SagittalStep, StepRequest

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.data import Character

#: Straightness of the legs in standing: hip to ankle over leg length (7 degrees of flexion).
STANDING_REACH = 0.9982
#: Samples a step is cut into, at least; the events are added to them.
SAMPLES = 36
#: The pose at the first toe-off, and at that of the closing step, is that of a walk with steps this
#: part as long: a foot that stood beside the other one rises less.
START_SHARE, STOP_SHARE = 0.4, 0.6
#: Part of a step in which who walks on the toes sets the heel down to stand, and raises it.
SET_DOWN = 0.5
#: Shares of the swing after which the toes are straight again.
TOES_STRAIGHT = 0.35


class KinematicWalk:
    """Walks of any body and step length from one or more measured steps of one person.

    Parameters
    ----------
    prototypes
        Walk data of one person at different step lengths, in any order; a pair where the steps
        on the left and on the right foot differ. The two nearest in step length over leg length
        are generalized and blended ([KB92b] section 6 asks for a nearer measurement where the
        step is far from the measured one).

    Notes
    -----
    [KB92b]. Starting and stopping are beyond the paper: they are the same sequences with one
    step length 0 and standing as the other end. So is the pair: the paper's walker is
    symmetric.
    """

    def __init__(self, prototypes: Sequence[WalkData | tuple[WalkData, WalkData]]) -> None:
        if not prototypes:
            raise InvalidInputError("a kinematic walk needs at least one measured step")
        pairs = [(p, p) if isinstance(p, WalkData) else p for p in prototypes]
        pairs.sort(key=lambda pair: sum(w.character.ratio for w in pair))
        self._prototypes = tuple(pairs)
        self._dense = tuple(
            (densified(left), densified(right) if right is not left else densified(left))
            for left, right in pairs
        )
        self._alike = len(pairs) == 1 and pairs[0][0] is pairs[0][1]
        self._cached: Callable[[Body, StepRequest], SagittalStep] = lru_cache(512)(self._step)

    @property
    def prototypes(self) -> tuple[tuple[WalkData, WalkData], ...]:
        """The measured steps on the left and on the right foot, shortest first."""
        return self._prototypes

    def step(self, body: Body, request: StepRequest) -> SagittalStep:
        """See :meth:`gaitsmith.walks.model.StraightWalk.step`."""
        return self._cached(body, request)

    def walk_data(
        self,
        body: Body,
        previous_length: float,
        length: float,
        start_height: float | None = None,
        side: int = 0,
    ) -> WalkData:
        """Generalized walk data for one step of ``body``; lengths in meters, above zero.

        ``side`` is that of the stance foot. Sampled on :func:`phase_grid` of its events.
        """
        around, share = self._around(body, length, side)
        before = self._character(body, previous_length, 1 - side)
        walks = [
            generalize(w, body, previous_length, length, start_height=start_height, before=before)
            for w in around
        ]
        if len(walks) == 1:
            return walks[0]
        return densified(blend(walks[0], walks[1], share, start_height=start_height, before=before))

    def _around(self, body: Body, length: float, side: int) -> tuple[tuple[WalkData, ...], float]:
        """The one or two measured steps nearest to ``length``, and the share of the second."""
        ratio = length / body.leg_length
        ratios = [pair[side].character.ratio for pair in self._prototypes]
        right = int(np.searchsorted(ratios, ratio))
        around = tuple(pair[side] for pair in self._dense[max(right - 1, 0) : right + 1])
        if len(around) == 1:
            return around, 0.0
        return around, (ratio - ratios[right - 1]) / (ratios[right] - ratios[right - 1])

    def _character(self, body: Body, length: float, side: int) -> Character:
        """Of a step of ``length``: it must not depend on the steps beside it."""
        around, share = self._around(body, length, side)
        if len(around) == 1:
            return around[0].character
        one, two = (w.character for w in around)
        return blended_character(one, two, share, body, length)

    def _rear(
        self, walk: WalkData, side: int
    ) -> tuple[Float[np.ndarray, "R"], Float[np.ndarray, "R"]]:
        """Pitch and meta of the rear foot on the grid of [0, TOM]: F2 and M of the step before.

        That step had its own length, so its sequences end at mu3 and mu4 of it ([KB92b] uses
        the current length: erratum D6), and, between measured steps or where the sides
        differ, its own curves. Its toe-off is moved to that of ``walk``.
        """
        phase = walk.hip.times[walk.hip.times <= walk.toe_off]
        length = walk.previous_length
        if self._alike:
            return _late(walk, len(phase), mu(walk.character, walk.body, length))
        before = self.walk_data(walk.body, length, length, side=1 - side)
        at = 1.0 + phase * (before.toe_off / walk.toe_off)
        return before.foot2.at(at)[:, 0], before.meta.at(at)[:, 0]

    def _step(self, body: Body, request: StepRequest) -> SagittalStep:
        for length in (request.previous_length, request.length):
            check_step_length(body, length)
        if request.kind == "start":
            return self._start(body, request)
        if request.kind == "stop":
            return self._stop(body, request)
        previous = request.previous_length
        walk = self.walk_data(body, previous, request.length, request.hip_height, request.side)
        return _sagittal(walk, *self._rear(walk, request.side), previous=previous)

    def _start(self, body: Body, request: StepRequest) -> SagittalStep:
        """From standing: the first foot leaves as in a walk with somewhat shorter steps."""
        length = request.length
        before = START_SHARE * length
        stand = standing_height(body) if request.hip_height is None else request.hip_height
        walk = self.walk_data(body, before, length, stand, request.side)
        hip, ankle = np.array(walk.hip.values), np.array(walk.ankle.values)
        bounce, swing = _of_half_a_stride(walk)
        hip[:, 0] = affine(hip[:, 0], 0.0, hip[-1, 0])
        hip[:, 1] = arc(walk.hip.unit, hip[:, 1], hip[0, 1], hip[-1, 1], bounce)
        ankle[:, 0] = affine(ankle[:, 0], ankle[0, 0] + before, ankle[-1, 0])
        ankle[:, 1] = arc(walk.ankle.unit, ankle[:, 1], ankle[0, 1], ankle[-1, 1], swing)
        turn = walk.foot3.values[:, 0]
        turn = arc(walk.foot3.unit, turn, turn[0], turn[-1], swing)
        # the foot stands flat at first: take the part it would already have turned away
        pitch, toes = self._rear(walk, request.side)
        fade = 1.0 - smoothstep(np.linspace(0.0, 1.0, len(pitch)))
        walk = walk.with_(
            hip=walk.hip.with_values(hip),
            ankle=walk.ankle.with_values(ankle),
            foot1=walk.foot1.with_values(np.zeros_like(walk.foot1.values)),
            foot2=walk.foot2.with_values(walk.foot2.values - _held(walk)),
            foot3=walk.foot3.with_values(turn),
        )
        return _sagittal(
            walk,
            np.minimum(pitch - pitch[0] * fade, 0.0),
            np.maximum(toes - toes[0] * fade, 0.0),
            previous=0.0,
            flat=0.0,
        )

    def _stop(self, body: Body, request: StepRequest) -> SagittalStep:
        """To standing: the rear foot closes beside the other, which stays flat."""
        previous = request.previous_length
        walk = self.walk_data(
            body, previous, STOP_SHARE * previous, request.hip_height, request.side
        )
        hip, ankle = np.array(walk.hip.values), np.array(walk.ankle.values)
        hip[:, 0] = affine(hip[:, 0], hip[0, 0], 0.0)
        bounce, swing = _of_half_a_stride(walk)
        hip[:, 1] = arc(walk.hip.unit, hip[:, 1], hip[0, 1], standing_height(body), bounce)
        end = ankle_at_heel_strike(body.foot, 0.0, 0.0)
        ankle[:, 0] = affine(ankle[:, 0], ankle[0, 0], end[0])
        ankle[:, 1] = arc(walk.ankle.unit, ankle[:, 1], ankle[0, 1], end[1], swing)
        turn = walk.foot3.values[:, 0]
        turn = arc(walk.foot3.unit, turn, turn[0], 0.0, swing)
        rear = self._rear(walk, request.side)
        walk = walk.with_(
            hip=walk.hip.with_values(hip),
            ankle=walk.ankle.with_values(ankle),
            foot2=walk.foot2.with_values(_held(walk)),
            foot3=walk.foot3.with_values(turn),
            meta=walk.meta.with_values(np.zeros_like(walk.meta.values)),
        )
        return _sagittal(walk, *rear, previous=previous, heel_off=1.0, meta_off=1.0)


def _held(walk: WalkData) -> Float[np.ndarray, "T 1"]:
    """The pitch at which a foot that is never level stands, let down over half a step."""
    u = (walk.foot2.times - walk.flat) / SET_DOWN
    return walk.foot2.values[0, 0] * (1.0 - smoothstep(np.minimum(u, 1.0)))[:, None]


def _of_half_a_stride(walk: WalkData) -> tuple[float, float]:
    """What is left of bounce and swing where one of the stride's two steps has no length."""
    share = max(walk.previous_length, walk.length) / (walk.previous_length + walk.length)
    return share**walk.character.bounce_power, share**walk.character.swing_power


def standing_height(body: Body) -> float:
    """Height of the hips in standing, feet together, meters."""
    return body.foot.ankle_height + STANDING_REACH * body.leg_length


def phase_grid(*events: float) -> Float[np.ndarray, "T"]:
    """Phases from 0 to 1 that hold every event inside, nowhere coarser than 1/SAMPLES.

    One more beside each end: the hips' speed changes fast about a heel strike, and steps are
    joined by the speeds read there.
    """
    near = 0.4 / SAMPLES
    marks = np.array(sorted({0.0, near, 1.0 - near, 1.0, *(e for e in events if 0.0 < e < 1.0)}))
    pieces = [
        np.linspace(a, b, max(2, int(np.ceil((b - a) * SAMPLES)) + 1))[:-1]
        for a, b in pairwise(marks)
    ]
    return np.concatenate([*pieces, [1.0]])


def densified(walk: WalkData) -> WalkData:
    """The same walk data read on the phase grid of its events, so that steps share samples.

    Generalization carries samples over one by one, so it is done after this: a step costs no
    interpolation.
    """
    off, meta = walk.toe_off, walk.meta_off
    # just after toe-off the foot turns from rolling to swinging: one more sample there
    phase = phase_grid(walk.flat, walk.heel_off, meta, meta - 1.0, off, off + 0.4 / SAMPLES)
    later = 1.0 + phase[(phase > 0.0) & (phase <= off)]
    times = {
        "hip": phase,
        "foot1": phase[phase <= walk.flat],
        "foot2": np.concatenate([phase[phase >= walk.flat], later]),
        "foot3": phase[phase >= off],
        "meta": np.concatenate([phase[phase >= meta], later[later >= meta]]),
        "ankle": phase[phase >= off],
    }
    return walk.with_(
        **{name: TimedSequence(t, getattr(walk, name).at(t)) for name, t in times.items()}
    )


def _late(
    walk: WalkData, count: int, angles: tuple[float, float, float, float]
) -> tuple[Float[np.ndarray, "R"], Float[np.ndarray, "R"]]:
    """F2 and M at the last ``count`` samples, carried to end at mu3 and mu4 of ``angles``."""
    _, _, off, meta = angles
    pitch = walk.foot2.values[-count:, 0] * (-off / walk.foot2.values[-1, 0])
    toes = np.zeros(count)
    late = walk.meta.values[-count:, 0]
    toes[count - len(late) :] = late * (meta / late[-1])
    return pitch, toes


def bent_toes(
    phase: Float[np.ndarray, "T"],
    toe_off: float,
    pitch: Float[np.ndarray, "T 2"],
    meta: Float[np.ndarray, "T 2"],
) -> Float[np.ndarray, "T 2"]:
    """Toes against the soles of (stance, swing): as they lie, and straight again in the swing."""
    bend = np.where(pitch < 0.0, -pitch - meta, 0.0)
    rear = int(np.searchsorted(phase, toe_off, side="right"))
    swing = (phase[rear:] - toe_off) / (1.0 - toe_off)
    bend[rear:, 1] = bend[rear - 1, 1] * (1.0 - smoothstep(swing / TOES_STRAIGHT))
    # toes that land first lie flat as they do
    bend[rear:, 1] += max(-float(pitch[-1, 1]), 0.0) * smoothstep((swing - 0.5) / 0.5)
    return bend


def _sagittal(
    walk: WalkData,
    rear_pitch: Float[np.ndarray, "R"],
    rear_meta: Float[np.ndarray, "R"],
    *,
    previous: float,
    flat: float | None = None,
    heel_off: float | None = None,
    meta_off: float | None = None,
) -> SagittalStep:
    """Both feet and the hips on the grid of ``walk``, which is densified."""
    foot, phase = walk.body.foot, walk.hip.times
    count, rear, landing = len(phase), len(rear_pitch), len(walk.foot1.values)
    pitch, meta = np.zeros((2, count, 2))
    pitch[:landing, 0] = walk.foot1.values[:, 0]
    pitch[landing - 1 :, 0] = walk.foot2.values[: count - landing + 1, 0]
    turning = int((walk.meta.times <= 1.0).sum())
    meta[count - turning :, 0] = walk.meta.values[:turning, 0]
    pitch[:rear, 1], meta[:rear, 1] = rear_pitch, rear_meta
    pitch[rear:, 1] = walk.foot3.values[1:, 0]
    bend = bent_toes(phase, walk.toe_off, pitch, meta)
    ankle = rolled_ankle(foot, pitch, meta)
    ankle[:, 1, 0] -= previous
    ankle[rear:, 1] = walk.ankle.values[1:]
    return SagittalStep(
        phase=phase,
        flat=walk.flat if flat is None else flat,
        heel_off=walk.heel_off if heel_off is None else heel_off,
        meta_off=walk.meta_off if meta_off is None else meta_off,
        toe_off=walk.toe_off,
        center=walk.hip.values,
        ankle=ankle,
        pitch=pitch,
        meta=meta,
        bend=bend,
    )
