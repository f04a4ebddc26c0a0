"""One measured step to any body and any step length, [KB92b] sections 2 to 5.

The paper's three operators - step length (phi), body (psi), both (tau) - are one map here:
every sequence keeps its shape and is carried to new END values, and the ends follow from the
target alone. That is why composition in any order and any number of steps gives the same
walk: the person's character survives, [KB92b] definition 4.

Frames: sagittal ``(forward, up)`` meters from N of the stance foot; the paper's x is forward
and its y up. Printed errors that are mended here are listed in ``docs/papers/errata.md``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import rolled_ankle
from gaitsmith.errors import InfeasibleStepError, InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body, Foot
    from gaitsmith.walks.data import Character, WalkData

#: Longest step over leg length; above it the rear leg cannot reach (measured on five bodies).
LONGEST_STEP = 1.15
#: Longest that people take.
LONG_STEP = 1.05
#: Smallest angle a mu function returns, radians: generalization divides by them.
SMALLEST_ANGLE = 0.01


def mu(character: Character, body: Body, length: float) -> tuple[float, float, float, float]:
    """Angles at heel strike and toe-off for a step of ``length`` meters, radians.

    Returns mu1 (interior knee angle at heel strike), mu2 (foot pitch at heel strike), mu3
    (magnitude of the foot pitch at toe-off), mu4 (meta angle at toe-off).

    Notes
    -----
    [KB92b] Eqs. 5, 6, 21, 24, except that what is subtracted is ``r* = sl*/ll(S*)``: as
    printed, with ``sl*``, the functions miss the measured angles (erratum D1).
    """
    more = length / body.leg_length - character.ratio
    a1, a2, a3, a4 = character.gains
    strike = character.strike_pitch + a2 * more
    # whoever lands on the heel never lands on the toes, and the other way round
    heel = character.strike_pitch > 0.0
    return (
        min(character.knee - a1 * more, float(np.pi)),
        max(strike, SMALLEST_ANGLE) if heel else min(strike, -SMALLEST_ANGLE),
        max(character.off_pitch + a3 * more, SMALLEST_ANGLE),
        max(character.off_meta + a4 * more, SMALLEST_ANGLE),
    )


def ankle_at_toe_off(
    foot: Foot, previous_length: float, pitch: float, meta: float
) -> Float[np.ndarray, "2"]:
    """Ankle of the rear foot at toe-off, from N of the current stance foot, meters.

    [KB92b] lemma 1, Eqs. 32-33, with theta_b and the previous step length, which the print
    leaves out (erratum D5). ``pitch`` is the magnitude mu3, ``meta`` is mu4.
    """
    ankle = rolled_ankle(foot, -pitch, meta)
    return ankle - np.array([previous_length, 0.0])


def ankle_at_heel_strike(foot: Foot, length: float, pitch: float) -> Float[np.ndarray, "2"]:
    """Ankle of the landing foot at heel strike, from N of the stance foot, meters.

    [KB92b] lemma 1, Eqs. 34-35. ``pitch`` is mu2.
    """
    return rolled_ankle(foot, pitch, 0.0) + np.array([length, 0.0])


def hip_height(character: Character, body: Body, length: float) -> float:
    """Height of the hips at the heel strike that ends a step of ``length``, meters.

    [KB92b] Eqs. 7-11 with the measured ``kappa`` in place of 1/2 (erratum D3), and the hip joint
    where the turned pelvis has it, if the character says so.

    Raises
    ------
    InfeasibleStepError
        If no hip can be that far from the ankle. This guard of the paper fires only beyond
        two leg lengths; :func:`check_step_length` is the one that protects walks.
    """
    mu1, mu2, _, _ = mu(character, body, length)
    leg = body.thigh**2 + body.shin**2 - 2.0 * body.thigh * body.shin * np.cos(mu1)
    x, y = ankle_at_heel_strike(body.foot, length, mu2)
    lead, lift = (body.leg_length * share for share in character.hip)
    square = leg - (x - (1.0 - character.kappa) * length - lead) ** 2
    if square <= 0.0:
        raise InfeasibleStepError(
            step=None,
            side="",
            needed=length,
            available=LONGEST_STEP * body.leg_length,
            why=f"the leg of {body.leg_length:.3f} m does not span it",
        )
    return float(y + np.sqrt(square) - lift)


def check_step_length(
    body: Body, length: float, *, step: int | None = None, side: str = ""
) -> None:
    """Refuse a step longer than this body's rear leg can follow, or shorter than none."""
    if not (np.isfinite(length) and length >= 0.0):
        raise InvalidInputError(f"step length must be 0 m or more, got {length!r}")
    longest = LONGEST_STEP * body.leg_length
    if length > longest * (1.0 + 1e-12):
        raise InfeasibleStepError(
            step=step,
            side=side,
            needed=length,
            available=longest,
            why=f"{LONGEST_STEP:g} times its leg length of {body.leg_length:.3f} m is the limit",
        )


def affine(v: Float[np.ndarray, "n"], low: float, high: float) -> Float[np.ndarray, "n"]:
    """``v`` stretched so that it runs from ``low`` to ``high``."""
    return low + (v - v[0]) * ((high - low) / (v[-1] - v[0]))


def arc(
    u: Float[np.ndarray, "n"], v: Float[np.ndarray, "n"], low: float, high: float, gain: float = 1.0
) -> Float[np.ndarray, "n"]:
    """``v`` carried to new ends; its deviation from the chord is scaled by ``gain``.

    With ``gain = 1`` this is the paper's ``v + (1-u) d1 + u d2`` (Eqs. 14, 23, 30).
    """
    return low + u * (high - low) + gain * (v - (v[0] + u * (v[-1] - v[0])))


def generalize(
    walk: WalkData,
    body: Body,
    previous_length: float,
    length: float,
    *,
    start_height: float | None = None,
    before: Character | None = None,
) -> WalkData:
    """Walk data of ``body`` stepping ``length`` after ``previous_length``: the paper's tau.

    Parameters
    ----------
    walk
        Walk data of any body and step length, measured or generalized.
    body
        Whose walk is wanted.
    previous_length, length
        Meters, both above zero.
    start_height
        Hip height at which the step begins, meters: "given by the current posture" (Eq. 14).
        None: what a step of ``previous_length`` ends with.
    before
        Character of the step before, which gives the ends that this step begins with. None:
        the same. It differs where walk data are blended from several measured steps.

    Notes
    -----
    [KB92b] Eqs. 13-15, 20, 22, 23, 26, 29, 30, 120-128, mended as the errata D2-D8 say. The
    bounce of the hips is scaled by the stride length to ``character.bounce_power`` and the
    swing's rise to ``character.swing_power``; both powers 0 give the paper's rule.
    """
    c, earlier = walk.character, before or walk.character
    for name, value in (("previous_length", previous_length), ("length", length)):
        if not (np.isfinite(value) and value > 0.0):
            raise InvalidInputError(f"{name} must be a positive number of meters, got {value!r}")
    alpha = body.leg_length / walk.body.leg_length
    stride = (previous_length + length) / (alpha * (walk.previous_length + walk.length))
    bounce, swing = stride**c.bounce_power, stride**c.swing_power
    _, strike_before, off_before, meta_before = mu(earlier, body, previous_length)
    _, strike, off, meta = mu(c, body, length)
    low = hip_height(earlier, body, previous_length) if start_height is None else start_height
    high = hip_height(c, body, length)

    hip, ankle = walk.hip.values, walk.ankle.values
    start = ankle_at_toe_off(body.foot, previous_length, off_before, meta_before)
    end = ankle_at_heel_strike(body.foot, length, strike)
    hip_forward = affine(hip[:, 0], -earlier.kappa * previous_length, (1.0 - c.kappa) * length)
    hip_up = arc(walk.hip.unit, alpha * hip[:, 1], low, high, bounce)
    ankle_forward = affine(ankle[:, 0], start[0], end[0])
    ankle_up = arc(walk.ankle.unit, alpha * ankle[:, 1], start[1], end[1], swing)
    f1, f2, f3, m = (s.values for s in (walk.foot1, walk.foot2, walk.foot3, walk.meta))
    f2 = f2 * (-off / f2[-1])
    if f2[0] == 0.0:
        f1 = f1 * (strike_before / f1[0])
    else:  # a foot that is never level: its landing ends where its rise begins
        f1 = arc(walk.foot1.unit, f1[:, 0], strike_before, float(f2[0, 0]))[:, None]
    return walk.with_(
        body=body,
        previous_length=float(previous_length),
        length=float(length),
        hip=walk.hip.with_values(np.stack([hip_forward, hip_up], axis=-1)),
        foot1=walk.foot1.with_values(f1),
        foot2=walk.foot2.with_values(f2),
        foot3=walk.foot3.with_values(arc(walk.foot3.unit, f3[:, 0], -off_before, strike, swing)),
        meta=walk.meta.with_values(m * (meta / m[-1])),
        ankle=walk.ankle.with_values(np.stack([ankle_forward, ankle_up], axis=-1)),
    )


def scale_step_length(walk: WalkData, ratio: float) -> WalkData:
    """phi: the same body, both step lengths ``ratio`` times as long ([KB92b] section 2)."""
    return generalize(walk, walk.body, ratio * walk.previous_length, ratio * walk.length)


def change_body(walk: WalkData, body: Body) -> WalkData:
    """psi: another body, step lengths in proportion to the leg lengths ([KB92b] section 4).

    The hips end at the heights that THIS body's legs give them. The paper adds the difference
    of ankle heights instead (Eq. 123), with which its theorems 4 and 5 fail for bodies of
    other proportions (erratum D8).
    """
    alpha = body.leg_length / walk.body.leg_length
    return generalize(walk, body, alpha * walk.previous_length, alpha * walk.length)
