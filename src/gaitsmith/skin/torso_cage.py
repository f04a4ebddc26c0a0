"""Cage of trunk, neck and head: rings of sixteen points, with holes for the arms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.skin.fit import HALF_HIPS, Fit

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.cage import Cage

#: Points of a ring: column 0 is in front, 4 on the left, 8 behind, 12 on the right.
AROUND = 16

# Rings of the standard figure from the crotch up, meters: height in front, at the side and
# behind; half the width, how far forward the front and (negative) the back is; exponent of
# the outline, 1 for an ellipse and less for a box; height in front and behind that weights go by.
_RINGS = np.array(
    [
        [0.872, 0.925, 0.850, 0.170, 0.090, -0.112, 0.88],  # groin
        [0.925, 0.955, 0.925, 0.170, 0.103, -0.128, 0.88],
        [0.990, 1.000, 0.995, 0.163, 0.106, -0.116, 0.88],
        [1.055, 1.055, 1.055, 0.147, 0.103, -0.092, 0.86],
        [1.115, 1.115, 1.115, 0.138, 0.102, -0.083, 0.86],
        [1.180, 1.180, 1.180, 0.143, 0.107, -0.090, 0.86],
        [1.250, 1.250, 1.250, 0.157, 0.117, -0.103, 0.85],
        [1.315, 1.325, 1.315, 0.166, 0.123, -0.113, 0.84],  # armpit
        [1.385, 1.405, 1.390, 0.170, 0.113, -0.115, 0.84],
        [1.440, 1.474, 1.455, 0.166, 0.078, -0.098, 0.86],  # top of the shoulder
        [1.468, 1.502, 1.495, 0.104, 0.056, -0.080, 0.94],
        [1.486, 1.524, 1.526, 0.063, 0.047, -0.064, 1.00],  # base of the neck
        [1.512, 1.553, 1.562, 0.055, 0.047, -0.058, 1.00],
        [1.522, 1.570, 1.596, 0.055, 0.064, -0.062, 1.00],
        [1.514, 1.577, 1.622, 0.058, 0.090, -0.084, 0.94],  # chin
        [1.553, 1.600, 1.645, 0.066, 0.096, -0.098, 0.96],
        [1.592, 1.626, 1.664, 0.071, 0.099, -0.102, 1.00],  # nose
        [1.634, 1.653, 1.682, 0.075, 0.097, -0.106, 1.00],  # eyes
        [1.663, 1.680, 1.700, 0.077, 0.103, -0.104, 1.00],
        [1.702, 1.710, 1.718, 0.073, 0.093, -0.095, 1.00],
        [1.738, 1.740, 1.740, 0.054, 0.066, -0.073, 1.00],
        [1.7545, 1.7545, 1.7545, 0.028, 0.034, -0.040, 1.00],
    ]
)
_GROIN, _ARMPIT, _SHOULDER, _NECK, _CHIN, _NOSE, _EYES = 0, 7, 9, 11, 14, 16, 17
_TOP = np.array([0.0, 1.756, -0.003])
# What no ellipse has: ring, columns, and how far they move to front, meters.
_DENTS: tuple[tuple[int, tuple[int, ...], float], ...] = (
    (_GROIN, (8,), 0.022),
    (_GROIN, (6, 10), -0.012),
    (1, (8,), 0.014),
    (1, (6, 10), -0.010),
    (3, (8,), 0.006),
    (4, (8,), 0.007),
    (5, (8,), 0.008),
    (6, (8,), 0.008),
    (7, (8,), 0.008),
    (8, (8,), 0.008),
    (7, (0,), -0.008),
    (7, (2, 14), 0.010),
    (8, (0,), -0.006),
    (8, (2, 14), 0.004),
    (_CHIN, (0,), 0.006),
    (_NOSE, (0,), 0.026),
    (_EYES, (0,), 0.010),
    (_EYES, (1, 15), -0.008),
    (_EYES, (2, 14), -0.004),
    (_EYES + 1, (1, 15), 0.002),
)
#: Corner of a sixteen-sided ring over the radius of the smooth one.
_INFLATE = 1.02


@dataclass(frozen=True)
class Openings:
    """Rings that limbs grow from, [left, right]; orientation as :class:`Cage` wants it.

    ``arms``: from the top toward the front (left) or the back (right). ``legs``: seen from
    above counter-clockwise, from the front (left) or the back (right) of the mid-line; the
    last point is the crotch.
    """

    arms: tuple[list[int], list[int]]
    legs: tuple[list[int], list[int]]


def add_torso(cage: Cage, fit: Fit, paints: tuple[int, int]) -> Openings:
    """Trunk, neck and head in the colours (upper, pelvis); what it leaves open for limbs."""
    rings: list[list[int]] = []
    for row, table in enumerate(_RINGS):
        points = fit.trunk(_outline(row, table))
        rings.append(cage.ring(points, _weights(fit, row, points)))
    for row in range(len(rings) - 1):
        is_arm = _ARMPIT <= row < _SHOULDER
        skip = (3, 4, 11, 12) if is_arm else ()
        cage.loft(rings[row], rings[row + 1], paints[1] if row < 2 else paints[0], skip=skip)
    tip = cage.point(fit.trunk(_TOP[None])[0], fit.one("head"))
    cage.fan(rings[-1], tip, paints[0])
    crotch = fit.trunk(np.array([[0.0, 0.838, -0.012]]))
    half = 0.5 * fit.one("hips")
    thighs = 0.25 * (fit.one("leftUpperLeg") + fit.one("rightUpperLeg"))
    between = cage.point(crotch[0], half + thighs)
    groin = rings[_GROIN]
    low, mid, top = rings[_ARMPIT : _SHOULDER + 1]
    left = [top[4], top[3], mid[3], low[3], low[4], low[5], mid[5], top[5]]
    right = [top[12], top[11], mid[11], low[11], low[12], low[13], mid[13], top[13]]
    return Openings((left, right), ([*groin[:9], between], [*groin[8:], groin[0], between]))


def _outline(row: int, table: Float[np.ndarray, "7"]) -> Float[np.ndarray, "around 3"]:
    """One ring of the standard figure."""
    front_y, side_y, back_y, wide, front, back, power = table
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    cosine, sine = np.cos(turn), np.sin(turn)
    ahead = cosine > 0.0
    level = np.where(ahead, front_y, back_y) - side_y
    reach = np.where(ahead, front, -back) * _INFLATE
    out = np.stack(
        [
            _INFLATE * wide * np.sign(sine) * np.abs(sine) ** power,
            side_y + level * cosine**2,
            reach * np.sign(cosine) * np.abs(cosine) ** power,
        ],
        axis=1,
    )
    for at, columns, depth in _DENTS:
        if at == row:
            out[list(columns), 2] += depth
    return out


def _weights(
    fit: Fit, row: int, points: Float[np.ndarray, "around 3"]
) -> Float[np.ndarray, "around joints"]:
    """Spine by height, and the shares of thighs, shoulders and upper arms."""
    if row >= _CHIN:
        return np.tile(fit.one("head"), (AROUND, 1))
    level = points[:, 1] if row < _SHOULDER else np.full(AROUND, points[:, 1].mean())
    if row == _CHIN - 1:
        return 0.4 * fit.spine(level) + 0.6 * fit.one("head")
    out = fit.spine(level)
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    for k, word in enumerate(("left", "right")):
        side = np.clip(np.sin(turn) * (1.0, -1.0)[k], 0.0, None)
        share = np.zeros(AROUND)
        if row <= 2:
            at = (0.42, 0.16, 0.03)[row]
            share = at * side**0.5
            if row == _GROIN:
                share[[0, 8]] = 0.2
            out = out * (1.0 - share[:, None]) + share[:, None] * fit.one(f"{word}UpperLeg")
        if _ARMPIT - 1 <= row <= _NECK:
            out = _arm_share(fit, row, side, word, out)
    return out


def _arm_share(
    fit: Fit,
    row: int,
    side: Float[np.ndarray, "around"],
    word: str,
    out: Float[np.ndarray, "around joints"],
) -> Float[np.ndarray, "around joints"]:
    """Weights with those of one shoulder and upper arm mixed in."""
    k = row - _ARMPIT + 1
    clavicle = (0.0, 0.15, 0.40, 0.60, 0.45, 0.10)[k] if k < 6 else 0.0
    arm = (0.03, 0.30, 0.40, 0.34, 0.04, 0.0)[k] if k < 6 else 0.0
    near = np.clip((side - 0.35) / 0.65, 0.0, 1.0)
    if f"{word}Shoulder" in fit.measures.skeleton.names:
        share = (clavicle * side)[:, None]
        out = out * (1.0 - share) + share * fit.one(f"{word}Shoulder")
    share = (arm * near)[:, None]
    return out * (1.0 - share) + share * fit.one(f"{word}UpperArm")


def hip_room(fit: Fit) -> float:
    """How wide a thigh may be toward the mid-line over the standard one."""
    return min(fit.half_hips / HALF_HIPS, 1.0)
