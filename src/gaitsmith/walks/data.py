"""The measured walk W(S, sl) = {H, F1, F2, F3, M, A} of [KB92b] Eq. 4."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, number, positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import pchip

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body


@dataclass(frozen=True, eq=False)
class TimedSequence:
    """Samples in step-normalised time, [KB92b] Eq. 1: ``(n,)`` times, ``(n, c)`` values."""

    times: Float[np.ndarray, "n"]
    values: Float[np.ndarray, "n c"]

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        values = np.asarray(self.values, dtype=np.float64)
        values = values[:, None] if values.ndim == 1 else values
        object.__setattr__(self, "times", frozen_array("times", self.times, (len(values),)))
        object.__setattr__(self, "values", frozen_array("values", values, (len(values), None)))
        if len(values) < 2 or (np.diff(self.times) <= 0).any():
            raise InvalidInputError("a timed sequence needs two or more samples, times rising")

    @property
    def unit(self) -> Float[np.ndarray, "n"]:
        """Times mapped so that the first is 0 and the last is 1."""
        return (self.times - self.times[0]) / (self.times[-1] - self.times[0])

    def at(self, times: Float[np.ndarray, "m"]) -> Float[np.ndarray, "m c"]:
        """Values at ``times``, by the monotone cubic; clamped outside.

        [KB92b] Eq. 2 interpolates linearly; the cubic passes the same samples and keeps
        velocities continuous. The algebra of generalization works on samples alone.
        """
        return pchip(self.times, self.values, times)

    def with_values(self, values: Float[np.ndarray, "n c"]) -> TimedSequence:
        """Same times, other values."""
        return replace(self, values=values)


@dataclass(frozen=True)
class Character:
    """What stays the same when a walk is generalized: the person's way of walking.

    Attributes
    ----------
    ratio
        ``r*``: step length over leg length of the measured step.
    knee, strike_pitch, off_pitch, off_meta
        mu1*..mu4*, radians: interior knee angle at heel strike (pi is straight), foot pitch at
        heel strike (negative: the toes land first), magnitude of the foot pitch at toe-off, meta
        angle at toe-off.
    kappa
        At heel strike the hips are ``kappa`` of a step length behind the new foot. The paper
        assumes 1/2; it belongs to the person.
    gains
        alpha1..alpha4 of Eqs. 5, 6, 21, 24, radians per unit of step length over leg length.
        The paper limits alpha1 to [0, 0.3].
    bounce_power, swing_power
        The bounce of the hips is scaled with the stride length to this power (0: the paper),
        and so is the swing's rise over the chord and the overshoot of its pitch.
    hip
        Hip joint of the landing leg forward of and above the hips' middle at heel strike, in
        leg lengths: the pelvis is turned and tipped then. The papers have it in the middle.
    """

    ratio: float
    knee: float
    strike_pitch: float
    off_pitch: float
    off_meta: float
    kappa: float
    gains: tuple[float, float, float, float] = (0.15, 0.35, 0.75, 0.55)
    bounce_power: float = 2.0
    swing_power: float = 1.0
    hip: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Check ranges."""
        for name in ("ratio", "knee", "off_pitch", "off_meta"):
            object.__setattr__(self, name, positive(name, getattr(self, name), "radians or 1"))
        if number("strike_pitch", self.strike_pitch, "radians") == 0.0:
            raise InvalidInputError("strike_pitch must not be 0: generalization divides by it")
        if not 0.0 < number("kappa", self.kappa, "1") < 1.0:
            raise InvalidInputError(f"kappa must be between 0 and 1, got {self.kappa!r}")
        if len(self.gains) != 4 or not 0.0 <= self.gains[0] <= 0.3:
            raise InvalidInputError(
                f"gains must be four numbers, the first in [0, 0.3], got {self.gains!r}"
            )
        if len(self.hip) != 2 or max(abs(number("hip", v, "1")) for v in self.hip) > 0.3:
            raise InvalidInputError(f"hip must be two shares of the leg, got {self.hip!r}")


@dataclass(frozen=True, eq=False)
class WalkData:
    """Six timed sequences of one step of one body, [KB92b] Eq. 4.

    Hip and ankle are ``(forward, up)`` meters, forward from N of the current stance foot, up
    from the floor; angles are radians. ``foot1``, ``foot2`` and ``meta`` belong to the current
    stance foot (the latter two run on into the next step, where that foot is the rear foot),
    ``foot3`` and ``ankle`` to the current swing foot.

    Attributes
    ----------
    body, previous_length, length
        S, ``sb`` and ``sl``.
    character
        The person's mu*, kappa and gains, carried along unchanged.
    flat, heel_off, meta_off, toe_off
        FGM, heel off, MOM, TOM in step-normalised time.
    hip
        H on [0, 1].
    foot1, foot2, foot3
        F1 on [0, FGM], F2 on [FGM, 1 + TOM], F3 on [TOM, 1]: sole pitch.
    meta
        M on [MOM, 1 + TOM].
    ankle
        A on [TOM, 1].
    """

    body: Body
    previous_length: float
    length: float
    character: Character
    flat: float
    heel_off: float
    meta_off: float
    toe_off: float
    hip: TimedSequence
    foot1: TimedSequence
    foot2: TimedSequence
    foot3: TimedSequence
    meta: TimedSequence
    ankle: TimedSequence

    def __post_init__(self) -> None:
        """Check that the sequences cover their intervals."""
        spans = {
            "hip": (0.0, 1.0),
            "foot1": (0.0, self.flat),
            "foot2": (self.flat, 1.0 + self.toe_off),
            "foot3": (self.toe_off, 1.0),
            "meta": (self.meta_off, 1.0 + self.toe_off),
            "ankle": (self.toe_off, 1.0),
        }
        for name, (first, last) in spans.items():
            times = getattr(self, name).times
            if abs(times[0] - first) > 1e-9 or abs(times[-1] - last) > 1e-9:
                raise InvalidInputError(
                    f"{name} must run from {first:.4f} to {last:.4f} of the step, got "
                    f"{times[0]:.4f} to {times[-1]:.4f}"
                )

    @property
    def sequences(self) -> dict[str, TimedSequence]:
        """The six sequences by name, in the paper's order H, F1, F2, F3, M, A."""
        names = ("hip", "foot1", "foot2", "foot3", "meta", "ankle")
        return {name: getattr(self, name) for name in names}

    def with_(self, **changes: object) -> WalkData:
        """Copy with some fields replaced; the copy is checked again."""
        return replace(self, **changes)  # type: ignore[arg-type]
