"""The legs of a whole-body Cycle as walk data, one set for each side's stance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.learn import standing_feet
from gaitsmith.geometry.curves import hermite, parabola_slopes, pchip_slopes
from gaitsmith.walks.data import Character, TimedSequence, WalkData
from gaitsmith.walks.generalize import SMALLEST_ANGLE, generalize
from gaitsmith.walks.planting import Planted, plant

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.gait.learn import Standing

#: Curves of a planted stride that get ahead with the walk.
TRAVELS = ("center", *(f"{side} ankle" for side in SIDES))
#: Samples of a sequence over a whole step.
SAMPLES = 120
#: Toes that rise less than this against the ground lie on it, radians.
LEAST_RISE = float(np.radians(0.3))
#: alpha1..alpha3, see :class:`~gaitsmith.walks.data.Character`; alpha4 follows.
_GAINS = (0.15, 0.35, 0.75)
#: Straightest interior knee angle that walk data hold, radians.
_STRAIGHTEST = float(np.radians(179.0))


def walk_data_of(
    cycle: Cycle, body: Body, *, width: float | None = None, feet: Standing | None = None
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
    feet
        How they stand in the cycle, by who knows it.

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
    feet = standing_feet(cycle) if feet is None else feet
    width = float(feet.place[0, 0] - feet.place[1, 0]) if width is None else width
    planted = plant(cycle, body, place=feet.place[:, 1], width=width)
    lengths = (planted.place[1], cycle.stride_length - planted.place[1])
    if min(lengths) <= 0.02 * body.leg_length:
        raise InfeasibleError(
            f"the steps of this stride get {lengths[0]:.3f} and {lengths[1]:.3f} m ahead: too "
            "short to be generalized"
        )
    curves = _Curves(planted)
    sides = [_Side(curves, body, side) for side in (0, 1)]
    raw = [side.walk_data() for side in sides]
    left, right = (
        generalize(w, body, w.previous_length, w.length, before=other.character)
        for w, other in zip(raw, raw[::-1], strict=True)
    )
    return left, right


class _Curves:
    """The curves of a planted stride over several strides, to be read anywhere.

    Those that travel go through their samples on parabolas, the others monotonously.
    """

    def __init__(self, planted: Planted) -> None:
        self.planted = planted
        count = len(planted.center)
        self._grid = np.arange(-count, 3 * count) / count
        self._tables: dict[str, tuple[Float[np.ndarray, "n c"], Float[np.ndarray, "n c"]]] = {}
        feet = {
            f"{side} {name}": values[:, i].reshape(count, -1)
            for i, side in enumerate(SIDES)
            for name, values in (
                ("ankle", planted.ankle),
                ("pitch", planted.pitch),
                ("meta", planted.meta),
                ("hip", planted.hip),
            )
        }
        curves = {"center": planted.center, **feet}
        for slopes, names in (
            (parabola_slopes, [n for n in curves if n in TRAVELS]),
            (pchip_slopes, [n for n in curves if n not in TRAVELS]),
        ):
            flat = np.concatenate([curves[name] for name in names], axis=1)
            far = np.zeros(flat.shape[1])
            if names[0] in TRAVELS:
                far[::2] = planted.stride_length  # forward, up, forward, up
            table = np.concatenate([flat - far, flat, flat + far, flat + 2.0 * far])
            slope, first = slopes(self._grid, table), 0
            for name in names:
                own = slice(first, first := first + curves[name].shape[1])
                self._tables[name] = table[:, own], slope[:, own]

    def at(self, name: str, phase: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n c"]:
        """A curve at stride phases."""
        return hermite(self._grid, *self._tables[name], phase)


@dataclass(eq=False)
class _Side:
    """The step on one foot, read from a planted stride."""

    curves: _Curves
    body: Body
    side: int

    def __post_init__(self) -> None:
        planted = self.curves.planted
        marks, other = planted.marks[self.side], planted.marks[1 - self.side]
        self.start = float(marks[4])
        # shares of the stride that this step and the other one take
        self.span = float((other[4] - marks[4]) % 1.0)
        rest = 1.0 - self.span
        self.toe_off = float((other[3] - rest) / self.span)
        self.own_toe_off = float((marks[3] - self.span) / rest)
        if not (0.0 < self.toe_off < 1.0 and 0.0 < self.own_toe_off < 1.0):
            raise InvalidInputError("toe-off must come between the other foot's heel strikes")
        stride = planted.stride_length
        ahead = planted.place[1] - planted.place[0]
        self.length = float(ahead if self.side == 0 else stride - ahead)
        self.previous = stride - self.length
        self.zero = float(planted.place[self.side])

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

    def read(self, curve: str, own: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n c"]:
        """A planted curve at own phases, forward from N of the stance foot where it travels."""
        out = self.curves.at(curve, self.start + own)
        if curve in TRAVELS:
            out[:, 0] -= self.zero
        return out

    def sequence(self, curve: str, first: float, last: float) -> TimedSequence:
        count = max(4, int(np.ceil((last - first) * SAMPLES)) + 1)
        times = np.linspace(first, last, count)
        return TimedSequence(times, self.read(curve, self.own_phase(times)))

    def walk_data(self) -> WalkData:
        """The six sequences; their ends are made consistent afterwards."""
        this, other = SIDES[self.side], SIDES[1 - self.side]
        marks = self.curves.planted.marks[self.side]
        flat, heel_off, meta_off = (self.step_phase(float(m)) for m in marks[:3])
        flat = min(flat, 0.95)
        end = 1.0 + self.toe_off
        hip = self.sequence("center", 0.0, 1.0)
        ankle = self.sequence(f"{other} ankle", self.toe_off, 1.0)
        foot1 = self.sequence(f"{this} pitch", 0.0, flat)
        foot2 = self.sequence(f"{this} pitch", flat, end)
        meta = self.sequence(f"{this} meta", meta_off, end)
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
        at_strike = np.array([self.span])
        strike = self.read(f"{other} ankle", at_strike)[0]
        joint = self.read(f"{other} hip", at_strike)[0]
        reach = float(np.hypot(*(strike - hip.values[-1] - joint)))
        lead, lift = joint / self.body.leg_length
        return WalkData(
            body=self.body,
            previous_length=self.previous,
            length=self.length,
            character=Character(
                ratio=self.length / self.body.leg_length,
                knee=self._interior_knee(reach),
                strike_pitch=_apart_from_0(float(self.read(f"{other} pitch", at_strike)[0, 0])),
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
            foot3=self.sequence(f"{other} pitch", self.toe_off, 1.0),
            meta=meta,
            ankle=ankle,
        )

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
