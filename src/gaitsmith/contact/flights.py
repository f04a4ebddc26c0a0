"""Swings of one foot side by side, and where its sole is in the air."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import about, exp, multiply, rotate

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Foot
    from gaitsmith.contact.foothold import Footholds


@dataclass(frozen=True, eq=False)
class Flights:
    """k swings of one foot, their n samples one after the other.

    Attributes
    ----------
    first
        ``(k,)`` index of each swing's first sample.
    u
        ``(n,)`` 0 at toe-off, 1 at heel strike.
    at
        ``(n,)`` walk phase.
    ankle, heading, pitch, bend
        ``(n, 3)``, ``(n,)`` each, as proposed; both ends are where the footholds have them.
    hip
        ``(n, 3)`` of the same leg.
    start, end
        k footholds that it leaves and lands on.
    own
        ``(n,)`` False where the sample, a landing, is of the step that follows.
    """

    first: Int[np.ndarray, "k"]
    u: Float[np.ndarray, "n"]
    at: Float[np.ndarray, "n"]
    ankle: Float[np.ndarray, "n 3"]
    heading: Float[np.ndarray, "n"]
    pitch: Float[np.ndarray, "n"]
    bend: Float[np.ndarray, "n"]
    hip: Float[np.ndarray, "n 3"]
    start: Footholds
    end: Footholds
    own: Bool[np.ndarray, "n"]

    @staticmethod
    def of(
        when: tuple[Int[np.ndarray, "k"], Float[np.ndarray, "m"], Float[np.ndarray, "m"]],
        columns: Float[np.ndarray, "m 9"],
        landing: tuple[Float[np.ndarray, "k"], Float[np.ndarray, "k 9"]],
        footholds: tuple[Footholds, Footholds],
    ) -> Flights:
        """Swings up to and with their landings.

        ``when``: first sample of each swing, ``u`` and ``at``; ``columns``: ankle, heading, pitch,
        bend and hip; ``landing``: when each swing lands, and its columns then.
        """
        (first, u, at), (strike, landed) = when, landing
        last = np.append(first[1:], len(at))
        lands = at[last - 1] < strike - 1e-9  # the end of the walk is a sample already
        where, more = last[lands], np.append(0, np.cumsum(lands)[:-1])
        rows = np.insert(columns, where, landed[lands], axis=0)
        return Flights(
            first=first + more,
            u=np.insert(u, where, 1.0),
            at=np.insert(at, where, strike[lands]),
            ankle=rows[:, :3],
            heading=rows[:, 3],
            pitch=rows[:, 4],
            bend=rows[:, 5],
            hip=rows[:, 6:],
            start=footholds[0],
            end=footholds[1],
            own=np.insert(np.ones(len(u), dtype=np.bool_), where, values=False),
        )

    @property
    def swing(self) -> Int[np.ndarray, "n"]:
        """``(n,)`` index of the swing of each sample."""
        counts = np.diff(np.append(self.first, len(self.u)))
        return np.repeat(np.arange(len(self.first)), counts)

    def soles(self) -> tuple[Float[np.ndarray, "n 4"], Float[np.ndarray, "n"]]:
        """World rotation of the foot and bend of the toes, with the lie of the footholds."""
        i, share = self.swing, smoothstep(self.u)
        tilt = (1.0 - share)[:, None] * self.start.tilt[i] + share[:, None] * self.end.tilt[i]
        toes = np.zeros(len(self.u))
        if self.start.toes is not None and self.end.toes is not None:
            toes = (1.0 - share) * self.start.toes[i] + share * self.end.toes[i]
        level = multiply(about("y", self.heading), about("x", -self.pitch))
        return multiply(exp(tilt), level), self.bend + toes


def sole_points(
    foot: Foot, turned: Float[np.ndarray, "*n 4"], bend: Float[np.ndarray, "*n"]
) -> Float[np.ndarray, "*n 3 3"]:
    """Heel, ball and toe tip from the ankle, of a foot with world rotation ``turned``."""
    high = foot.toe_joint_height
    c, s = np.cos(bend), np.sin(bend)
    local = np.zeros((*bend.shape, 3, 3))
    local[..., :, 1] = -foot.ankle_height
    local[..., 0, 2], local[..., 1, 2] = -foot.heel, foot.ball
    local[..., 2, 1] += high + foot.toes * s - high * c
    local[..., 2, 2] = foot.ball + foot.toes * c + high * s
    return rotate(turned[..., None, :], local)


def along_sole(points: Float[np.ndarray, "*n 3 3"]) -> Float[np.ndarray, "*n 12 3"]:
    """Points along the sole's line through heel, ball and toe tip, these among them."""
    heel, ball, tip = (points[..., i : i + 1, :] for i in range(3))
    back, front = (np.linspace(0.0, 1.0, n)[:, None] for n in (8, 5))
    return np.concatenate([heel + back * (ball - heel), ball + front[1:] * (tip - ball)], axis=-2)
