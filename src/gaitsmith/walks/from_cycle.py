"""The legs of a whole-body Cycle as walk data, one set for each side's stance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.learn import standing_feet
from gaitsmith.geometry.curves import hermite, parabola_slopes, pchip
from gaitsmith.walks.data import Character, TimedSequence, WalkData
from gaitsmith.walks.generalize import SMALLEST_ANGLE, generalize
from gaitsmith.walks.planting import Planted, plant

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle

#: Samples of a sequence over a whole step.
SAMPLES = 120
#: Toes that rise less than this against the ground lie on it, radians.
LEAST_RISE = float(np.radians(0.3))
#: alpha1..alpha3, see :class:`~gaitsmith.walks.data.Character`; alpha4 follows.
_GAINS = (0.15, 0.35, 0.75)
#: Straightest interior knee angle that walk data hold, radians.
_STRAIGHTEST = float(np.radians(179.0))


def walk_data_of(
    cycle: Cycle, body: Body, *, width: float | None = None
) -> tuple[WalkData, WalkData]:
    """Six timed sequences of the steps on the left and on the right foot of ``cycle``.

    Parameters
    ----------
    cycle
        A stride of ``body``; left and right may differ.
    body
        Whose legs and feet.
    width
        Meters between the lines of left and right feet; None: as in the cycle.

    Raises
    ------
    InfeasibleError
        If a step of the cycle does not get ahead.

    Notes
    -----
    Feet are planted first, see :mod:`gaitsmith.walks.planting`. [KB92b] has one set of walk
    data; a set for each side keeps a limp a limp. What one step leaves to the next (heel rise
    and toes of the rear foot) is timed by the step that it belongs to.
    """
    feet = standing_feet(cycle)
    width = float(feet.place[0, 0] - feet.place[1, 0]) if width is None else width
    planted = plant(cycle, body, place=feet.place[:, 1], width=width)
    lengths = (planted.place[1], cycle.stride_length - planted.place[1])
    if min(lengths) <= 0.02 * body.leg_length:
        raise InfeasibleError(
            f"the steps of this stride get {lengths[0]:.3f} and {lengths[1]:.3f} m ahead: too "
            "short to be generalized"
        )
    sides = [_Side(planted, body, side) for side in (0, 1)]
    raw = [side.walk_data() for side in sides]
    left, right = (
        generalize(w, body, w.previous_length, w.length, before=other.character)
        for w, other in zip(raw, raw[::-1], strict=True)
    )
    return left, right


@dataclass(eq=False)
class _Side:
    """The step on one foot, read from a planted stride."""

    planted: Planted
    body: Body
    side: int

    def __post_init__(self) -> None:
        marks, other = self.planted.marks[self.side], self.planted.marks[1 - self.side]
        self.start = float(marks[4])
        # shares of the stride that this step and the other one take
        self.span = float((other[4] - marks[4]) % 1.0)
        rest = 1.0 - self.span
        self.toe_off = float((other[3] - rest) / self.span)
        self.own_toe_off = float((marks[3] - self.span) / rest)
        if not (0.0 < self.toe_off < 1.0 and 0.0 < self.own_toe_off < 1.0):
            raise InvalidInputError("toe-off must come between the other foot's heel strikes")
        stride = self.planted.stride_length
        ahead = self.planted.place[1] - self.planted.place[0]
        self.length = float(ahead if self.side == 0 else stride - ahead)
        self.previous = stride - self.length
        self.zero = float(self.planted.place[self.side])

    def step_phase(self, own: float) -> float:
        """Own phase of the stance foot to the phase of this step, running on into the next."""
        if own <= self.span:
            return own / self.span
        late = (own - self.span) / (1.0 - self.span)
        return 1.0 + late * self.toe_off / self.own_toe_off

    def own_phase(self, t: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """The inverse."""
        late = (t - 1.0) * self.own_toe_off / self.toe_off
        return np.where(t <= 1.0, t * self.span, self.span + late * (1.0 - self.span))

    def read(
        self, values: Float[np.ndarray, "N *c"], own: Float[np.ndarray, "n"], *, travels: bool
    ) -> Float[np.ndarray, "n *c"]:
        """A planted curve at own phases, forward from N of the stance foot where it travels."""
        count = len(values)
        flat = values.reshape(count, -1)
        far = np.zeros(flat.shape[1])
        if travels:
            far[0] = self.planted.stride_length
        table = np.concatenate([flat - far, flat, flat + far, flat + 2.0 * far])
        grid = np.arange(-count, 3 * count) / count
        at = self.start + own
        if travels:
            out = hermite(grid, table, parabola_slopes(grid, table), at)
            out[:, 0] -= self.zero
        else:
            out = pchip(grid, table, at)
        return out.reshape(len(own), *values.shape[1:])

    def sequence(
        self, values: Float[np.ndarray, "N *c"], first: float, last: float, *, travels: bool = False
    ) -> TimedSequence:
        count = max(4, int(np.ceil((last - first) * SAMPLES)) + 1)
        times = np.linspace(first, last, count)
        return TimedSequence(times, self.read(values, self.own_phase(times), travels=travels))

    def walk_data(self) -> WalkData:
        """The six sequences; their ends are made consistent afterwards."""
        s, o, p = self.side, 1 - self.side, self.planted
        flat, heel_off, meta_off = (self.step_phase(float(m)) for m in p.marks[s][:3])
        flat = min(flat, 0.95)
        end = 1.0 + self.toe_off
        hip = self.sequence(p.center, 0.0, 1.0, travels=True)
        ankle = self.sequence(p.ankle[:, o], self.toe_off, 1.0, travels=True)
        foot1 = self.sequence(p.pitch[:, s], 0.0, flat)
        foot2 = self.sequence(p.pitch[:, s], flat, end)
        meta = self.sequence(p.meta[:, s], meta_off, end)
        landed, off_pitch = float(foot1.values[0, 0]), -float(foot2.values[-1, 0])
        level = abs(float(foot2.values[0, 0])) < 2.0 * SMALLEST_ANGLE
        if level:
            falling = np.minimum(foot2.values, 0.0)
            foot2 = foot2.with_values(np.where(foot2.times[:, None] <= heel_off, 0.0, falling))
            landing = foot1.values - foot1.values[-1] * foot1.unit[:, None]
            onto = np.maximum if _apart_from_0(landed) > 0.0 else np.minimum
            foot1 = foot1.with_values(onto(landing, 0.0))
        # generalization divides by the ends
        off_pitch = max(off_pitch, 2.0 * SMALLEST_ANGLE)
        rising = np.clip((foot2.times - heel_off) / (end - heel_off), 0.0, 1.0)
        foot1 = _ending(foot1, _apart_from_0(landed), 1.0 - foot1.unit)
        foot2 = _ending(foot2, -off_pitch, rising)
        meta = meta.with_values(for_good(np.maximum(meta.values - meta.values[0], 0.0)))
        off_meta = max(float(meta.values[-1, 0]), 2.0 * SMALLEST_ANGLE)
        meta = _ending(meta, off_meta, meta.unit)
        strike = self.read(p.ankle[:, o], np.array([self.span]), travels=True)[0]
        joint = np.array([self._at_strike(p.hip[:, o, i]) for i in (0, 1)])
        reach = float(np.hypot(*(strike - hip.values[-1] - joint)))
        lead, lift = joint / self.body.leg_length
        return WalkData(
            body=self.body,
            previous_length=self.previous,
            length=self.length,
            character=Character(
                ratio=self.length / self.body.leg_length,
                knee=self._interior_knee(reach),
                strike_pitch=_apart_from_0(self._at_strike(p.pitch[:, o])),
                off_pitch=off_pitch,
                off_meta=off_meta,
                # sole and toes keep step with each other at every step length
                gains=(*_GAINS, _GAINS[2] * min(off_meta / off_pitch, 1.0)),
                kappa=float(1.0 - hip.values[-1, 0] / self.length),
                hip=(float(lead), float(lift)),
            ),
            flat=flat,
            heel_off=max(heel_off, flat),
            meta_off=meta_off,
            toe_off=self.toe_off,
            hip=hip,
            foot1=foot1,
            foot2=foot2,
            foot3=self.sequence(p.pitch[:, o], self.toe_off, 1.0),
            meta=meta,
            ankle=ankle,
        )

    def _at_strike(self, values: Float[np.ndarray, "N"]) -> float:
        """A curve that does not travel, where the step ends."""
        return float(self.read(values, np.array([self.span]), travels=False)[0])

    def _interior_knee(self, reach: float) -> float:
        thigh, shin = self.body.thigh, self.body.shin
        cosine = (thigh**2 + shin**2 - reach**2) / (2.0 * thigh * shin)
        return min(float(np.arccos(np.clip(cosine, -1.0, 1.0))), _STRAIGHTEST)


def _ending(sequence: TimedSequence, end: float, u: Float[np.ndarray, "T"]) -> TimedSequence:
    """``sequence`` raised along ``u`` so that it is ``end`` where ``u`` is 1."""
    now = float(sequence.values[int(u.argmax()), 0])
    return sequence.with_values(sequence.values + (end - now) * u[:, None])


def for_good(values: Float[np.ndarray, "T 1"]) -> Float[np.ndarray, "T 1"]:
    """Nothing where it rises and comes back: a ball does not leave the ground by a hair."""
    down = np.flatnonzero(values[:, 0] < LEAST_RISE)
    out = np.array(values)
    if len(down) and values[: down[-1]].max(initial=0.0) >= LEAST_RISE:
        out[: down[-1] + 1] = 0.0
    return out


def _apart_from_0(angle: float) -> float:
    """An angle that generalization may divide by."""
    if abs(angle) >= 2.0 * SMALLEST_ANGLE:
        return angle
    return 2.0 * SMALLEST_ANGLE
