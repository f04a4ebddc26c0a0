"""[KB92b] written out slowly, sample by sample, from the page: the oracle of ``generalize``.

Points are complex numbers, ``x + 1j * y`` with x forward and y up; a rotation is a product
with ``exp(1j * angle)``, counter-clockwise. Misprints are mended as docs/papers/errata.md says.
Nothing is shared with the code under test but the data.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.walks.data import Character, WalkData

    Sequences = dict[str, list[list[float]]]


def mu1(c: Character, body: Body, sl: float) -> float:
    """Eq. 5: the knee at heel strike, straight at most."""
    return min(-c.gains[0] * (sl / (body.thigh + body.shin) - c.ratio) + c.knee, math.pi)


def mu2(c: Character, body: Body, sl: float) -> float:
    """Eq. 6: the foot at heel strike."""
    return c.gains[1] * (sl / (body.thigh + body.shin) - c.ratio) + c.strike_pitch


def mu3(c: Character, body: Body, sl: float) -> float:
    """Eq. 21: the foot at toe-off."""
    return c.gains[2] * (sl / (body.thigh + body.shin) - c.ratio) + c.off_pitch


def mu4(c: Character, body: Body, sl: float) -> float:
    """Eq. 24: the toes at toe-off."""
    return c.gains[3] * (sl / (body.thigh + body.shin) - c.ratio) + c.off_meta


def heel_strike_ankle(body: Body, sl: float, pitch: float) -> complex:
    """Eqs. 8, 9: the flat ankle a step ahead, turned about the heel."""
    heel = sl - body.foot.heel
    ankle = sl + 1j * body.foot.ankle_height
    return heel + (ankle - heel) * cmath.exp(1j * pitch)


def toe_off_ankle(body: Body, sb: float, pitch: float, meta: float) -> complex:
    """Figures 6, 7: toes turned about their tip by meta, the rest about the ball by pitch."""
    foot = body.foot
    tip = -sb + foot.ball + foot.toes
    ball = tip + (-foot.toes) * cmath.exp(-1j * meta)
    return ball + (-foot.ball + 1j * foot.ankle_height) * cmath.exp(-1j * pitch)


def hip_at_heel_strike(c: Character, body: Body, sl: float) -> complex:
    """Eqs. 7, 10, 11 with the measured kappa, from N of the stance foot."""
    a1_squared = (
        body.thigh**2 + body.shin**2 - 2.0 * body.thigh * body.shin * math.cos(mu1(c, body, sl))
    )
    ankle = heel_strike_ankle(body, sl, mu2(c, body, sl))
    x = (1.0 - c.kappa) * sl
    return x + 1j * (ankle.imag + math.sqrt(a1_squared - (ankle.real - x) ** 2))


def tau(walk: WalkData, body: Body, sb: float, sl: float, y1: float | None = None) -> Sequences:
    """Every sample of the six sequences of ``body`` stepping ``sl`` after ``sb``."""
    c = walk.character
    alpha = (body.thigh + body.shin) / (walk.body.thigh + walk.body.shin)
    rho = (sb + sl) / (alpha * (walk.previous_length + walk.length))
    bounce, swing = rho**c.bounce_power, rho**c.swing_power
    if y1 is None:
        y1 = hip_at_heel_strike(c, body, sb).imag
    yn = hip_at_heel_strike(c, body, sl).imag
    b1 = toe_off_ankle(body, sb, mu3(c, body, sb), mu4(c, body, sb))
    b2 = heel_strike_ankle(body, sl, mu2(c, body, sl))

    hip, ankle, foot3 = [], [], []
    first, last = walk.hip.values[0], walk.hip.values[-1]
    for t, (x, y) in zip(walk.hip.times, walk.hip.values, strict=True):
        along = (x - first[0]) / (last[0] - first[0])
        off_chord = y - (first[1] * (1.0 - t) + last[1] * t)
        hip.append(
            [
                -c.kappa * sb * (1.0 - along) + (1.0 - c.kappa) * sl * along,
                y1 * (1.0 - t) + yn * t + bounce * alpha * off_chord,
            ]
        )
    first, last = walk.ankle.values[0], walk.ankle.values[-1]
    for t, (x, y) in zip(walk.ankle.times, walk.ankle.values, strict=True):
        u = (t - walk.toe_off) / (1.0 - walk.toe_off)
        along = (x - first[0]) / (last[0] - first[0])
        off_chord = y - (first[1] * (1.0 - u) + last[1] * u)
        ankle.append(
            [
                b1.real * (1.0 - along) + b2.real * along,
                b1.imag * (1.0 - u) + b2.imag * u + swing * alpha * off_chord,
            ]
        )
    start, end = walk.foot3.values[0, 0], walk.foot3.values[-1, 0]
    for t, f in zip(walk.foot3.times, walk.foot3.values[:, 0], strict=True):
        u = (t - walk.toe_off) / (1.0 - walk.toe_off)
        off_chord = f - (start * (1.0 - u) + end * u)
        foot3.append([-mu3(c, body, sb) * (1.0 - u) + mu2(c, body, sl) * u + swing * off_chord])
    return {
        "hip": hip,
        "foot1": [
            [f * mu2(c, body, sb) / walk.foot1.values[0, 0]] for f in walk.foot1.values[:, 0]
        ],
        "foot2": [
            [-f * mu3(c, body, sl) / walk.foot2.values[-1, 0]] for f in walk.foot2.values[:, 0]
        ],
        "foot3": foot3,
        "meta": [[m * mu4(c, body, sl) / walk.meta.values[-1, 0]] for m in walk.meta.values[:, 0]],
        "ankle": ankle,
    }
