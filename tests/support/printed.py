"""[KB92b] to the letter, misprints and all: what the errata tests show to fail.

Each function is one printed formula; the names of the errata are those of
docs/papers/errata.md. Frames as in the package: (forward, up) from N of the stance foot.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.walks.generalize import (
    ankle_at_heel_strike,
    ankle_at_toe_off,
    arc,
    change_body,
    generalize,
    hip_height,
    mu,
)

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body, Foot
    from gaitsmith.walks.data import Character, WalkData


def mu_with_step_length(
    c: Character, body: Body, length: float, measured_length: float
) -> tuple[float, float, float, float]:
    """D1, Eqs. 5, 6, 21, 24: ``sl / ll(S) - sl*``, a ratio minus meters."""
    more = length / body.leg_length - measured_length
    a1, a2, a3, a4 = c.gains
    return (
        c.knee - a1 * more,
        c.strike_pitch + a2 * more,
        c.off_pitch + a3 * more,
        c.off_meta + a4 * more,
    )


def hip_forward(walk: WalkData, length: float) -> Float[np.ndarray, "n"]:
    """D2, Eqs. 13, 15: x scaled about the stance ankle, the previous step as it was."""
    slope = (walk.previous_length + length) / (walk.previous_length + walk.length)
    return slope * walk.hip.values[:, 0]


def half_way(c: Character) -> Character:
    """D3, Eq. 10: at heel strike the hips are half way between the feet."""
    return replace(c, kappa=0.5)


def bounce_kept(walk: WalkData) -> WalkData:
    """D4, Eq. 14: whatever the step length, the whole bounce."""
    return walk.with_(character=replace(walk.character, bounce_power=0.0))


def paper_powers(walk: WalkData) -> WalkData:
    """Eqs. 14, 23, 30: neither bounce nor swing is scaled."""
    return walk.with_(character=replace(walk.character, bounce_power=0.0, swing_power=0.0))


def toe_off_ankle(foot: Foot, pitch: float, meta: float) -> Float[np.ndarray, "2"]:
    """D5, lemma 1, Eqs. 32, 33: without theta_b and without the previous step."""
    return np.array(
        [
            foot.ball + foot.toes - foot.toes * np.cos(meta) - foot.ankle_ball * np.cos(pitch),
            foot.toes * np.sin(meta) + foot.ankle_ball * np.sin(pitch),
        ]
    )


def toe_off_of_this_step(walk: WalkData) -> tuple[Float[np.ndarray, "2"], float]:
    """D6, Eqs. 23, 32: ankle and pitch of the swing foot at toe-off, from the CURRENT length."""
    _, _, off, meta = mu(walk.character, walk.body, walk.length)
    return ankle_at_toe_off(walk.body.foot, walk.previous_length, off, meta), -off


def swing_pitch(walk: WalkData, start: float, end: float) -> Float[np.ndarray, "n"]:
    """D7, Eq. 23: ``t' = t / (HSM+ - TOM)``, which does not run from 0 to 1."""
    late = walk.foot3.times / (1.0 - walk.toe_off)
    f = walk.foot3.values[:, 0]
    return f + (1.0 - late) * (start - f[0]) + late * (end - f[-1])


def change_body_by_ankle(walk: WalkData, body: Body) -> WalkData:
    """D8, Eq. 123: the hip curve scaled and lifted by the difference of ankle heights.

    All else as psi should be: lengths scale with the legs, angles stay, the swing ankle goes
    between the new ends (Eqs. 127, 128; powers 0).
    """
    alpha = body.leg_length / walk.body.leg_length
    up = body.foot.ankle_height - alpha * walk.body.foot.ankle_height
    new = change_body(paper_powers(walk), body)
    hip = alpha * walk.hip.values + [0.0, up]
    return new.with_(hip=walk.hip.with_values(hip))


def scale_step(walk: WalkData, ratio: float) -> WalkData:
    """phi of the proofs: the step ``ratio`` times as long, the one before as it was.

    The step begins at the height at which this body, by Eqs. 7-11, ends the step before.
    """
    walk = paper_powers(walk)
    return generalize(walk, walk.body, walk.previous_length, ratio * walk.length)


def hip_scaled_in_proof(walk: WalkData, body: Body, length: float) -> Float[np.ndarray, "n"]:
    """D8, Eq. 157: hip x after psi and phi, with a factor sl_1 too many."""
    alpha = body.leg_length / walk.body.leg_length
    before = alpha * walk.previous_length
    return (
        (before + length)
        / (before + alpha * walk.length)
        * (alpha * walk.length)
        * walk.hip.values[:, 0]
    )


__all__ = [
    "ankle_at_heel_strike",
    "arc",
    "bounce_kept",
    "change_body_by_ankle",
    "half_way",
    "hip_forward",
    "hip_height",
    "hip_scaled_in_proof",
    "mu_with_step_length",
    "paper_powers",
    "scale_step",
    "swing_pitch",
    "toe_off_ankle",
    "toe_off_of_this_step",
]
