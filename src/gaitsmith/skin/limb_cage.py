"""Cages of arms and legs: rings along the bones of the modelling pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.skin.hand import add_hand
from gaitsmith.skin.rings import Bones, ring_around
from gaitsmith.skin.torso_cage import hip_room

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.cage import Cage
    from gaitsmith.skin.fit import Fit

# Rings of an arm, standard meters: bone (0 upper arm, 1 forearm), share of it, meters beyond;
# radii to the top (in the T-pose), bottom, front and back; weight of the joint below.
_ARM = np.array(
    [
        [0, 0.00, 0.030, 0.055, 0.046, 0.053, 0.054, -1.0],
        [0, 0.00, 0.085, 0.056, 0.044, 0.049, 0.051, -1.0],
        [0, 0.45, 0.000, 0.045, 0.042, 0.045, 0.043, 0.0],
        [0, 0.75, 0.000, 0.040, 0.038, 0.041, 0.040, 0.0],
        [0, 1.00, -0.034, 0.038, 0.036, 0.036, 0.039, 0.12],
        [1, 0.00, 0.000, 0.038, 0.036, 0.034, 0.041, 0.5],
        [1, 0.00, 0.034, 0.039, 0.037, 0.036, 0.038, 0.88],
        [1, 0.30, 0.000, 0.040, 0.036, 0.039, 0.036, 0.0],
        [1, 0.60, 0.000, 0.033, 0.030, 0.034, 0.030, 0.0],
        [1, 1.00, -0.030, 0.024, 0.023, 0.029, 0.027, 0.08],
    ]
)
# Rings of a leg: bone, share, meters beyond; radii to front, back, outside, inside; lift of
# the outer edge; weight of the joint below.
_LEG = np.array(
    [
        [0, 0.165, 0.0, 0.090, 0.108, 0.085, 0.079, 0.026, -1.0],
        [0, 0.29, 0.0, 0.088, 0.094, 0.082, 0.078, 0.010, -1.0],
        [0, 0.46, 0.0, 0.082, 0.080, 0.076, 0.071, 0.0, 0.0],
        [0, 0.66, 0.0, 0.072, 0.068, 0.066, 0.062, 0.0, 0.0],
        [0, 0.82, 0.0, 0.060, 0.059, 0.056, 0.056, 0.0, 0.0],
        [0, 1.00, -0.040, 0.054, 0.053, 0.051, 0.053, 0.0, 0.10],
        [1, 0.00, 0.000, 0.054, 0.049, 0.050, 0.052, 0.0, 0.5],
        [1, 0.00, 0.040, 0.048, 0.053, 0.049, 0.050, 0.0, 0.90],
        [1, 0.23, 0.0, 0.041, 0.066, 0.053, 0.052, 0.0, 0.0],
        [1, 0.37, 0.0, 0.038, 0.067, 0.051, 0.050, 0.0, 0.0],
        [1, 0.56, 0.0, 0.036, 0.051, 0.042, 0.041, 0.0, 0.0],
        [1, 0.75, 0.0, 0.033, 0.036, 0.032, 0.032, 0.0, 0.0],
        [1, 0.90, 0.0, 0.032, 0.033, 0.030, 0.031, 0.0, 0.08],
        [1, 1.02, 0.0, 0.033, 0.034, 0.031, 0.033, 0.0, 0.55],
    ]
)


def add_arm(
    cage: Cage, fit: Fit, side: int, opening: list[int], paints: tuple[int, int, int]
) -> None:
    """Arm and hand of one side in the colours (limb, joint, skin), from the ``opening``."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    joints = [f"{word}{name}" for name in ("UpperArm", "LowerArm", "Hand")]
    # right-handed (top, front, along) on the left; on the right, front is behind
    bones = Bones(fit, joints, np.array([0.0, 0.0, sign]))
    above = opening
    for k, row in enumerate(_ARM):
        point, frame = bones.place(row)
        radii = fit.girth * row[3:7]
        if sign < 0.0:
            radii = radii[[0, 1, 3, 2]]
        bone, below = int(row[0]), float(row[7])
        if below < 0.0:
            share = (0.90, 1.0)[k]
            parent = f"{word}Shoulder" if f"{word}Shoulder" in fit.measures.skeleton.names else None
            rest = fit.one(parent) if parent else fit.spine(point[1:2])[0]
            weights = share * fit.one(joints[0]) + (1.0 - share) * rest
        elif k < 7:
            weights = (1.0 - below) * fit.one(joints[0]) + below * fit.one(joints[1])
            weights = fit.one(joints[bone]) if below == 0.0 else weights
        else:
            weights = (1.0 - below) * fit.one(joints[1]) + below * fit.one(joints[2])
        ring = cage.ring(ring_around(point, frame, radii, 8, 0.96), weights)
        # the shoulder's cap is of the trunk: sleeves in another colour would show its corners
        cage.loft(above, ring, paints[2] if k == 0 else paints[1] if k in (5, 6) else paints[0])
        above = ring
    add_hand(cage, fit, side, bones, above, paints[2])


def add_leg(cage: Cage, fit: Fit, side: int, opening: list[int], paints: tuple[int, int]) -> None:
    """Leg of one side in the colours (limb, joint), from the ``opening`` into the shoe."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    joints = [f"{word}{name}" for name in ("UpperLeg", "LowerLeg", "Foot")]
    bones = Bones(fit, joints, np.array([0.0, 0.0, 1.0]))
    above, room = opening, hip_room(fit)
    for k, row in enumerate(_LEG):
        point, frame = bones.place(row)
        points = _leg_ring(fit, sign, point, frame, row, room if k < 3 else 1.0)
        bone, below = int(row[0]), float(row[8])
        if below < 0.0:
            share = (0.86, 0.99)[k]
            weights = share * fit.one(joints[0]) + (1.0 - share) * fit.one("hips")
        elif below == 0.0:
            weights = fit.one(joints[bone])
        else:
            upper, lower = (0, 1) if k < 9 else (1, 2)
            weights = (1.0 - below) * fit.one(joints[upper]) + below * fit.one(joints[lower])
        ring = cage.ring(points, weights)
        cage.loft(ring, above, paints[1] if k in (6, 7) else paints[0])
        above = ring
    tip = bones.at[2] + 0.03 * fit.girth * bones.way[1]
    cage.fan(above[::-1], cage.point(tip, fit.one(joints[2])), paints[0])


def _leg_ring(
    fit: Fit,
    sign: float,
    point: Float[np.ndarray, "3"],
    frame: Float[np.ndarray, "3 3"],
    row: Float[np.ndarray, "9"],
    room: float,
) -> Float[np.ndarray, "10 3"]:
    """Ten points from the front around the outside; the last one looks to the other leg."""
    front, back, out, inside = fit.girth * row[3:7] / np.cos(np.pi / 10)
    turn = np.deg2rad(36.0 * np.arange(10) - 54.0)  # of a left leg: 0 front, 90 outside
    if sign < 0.0:
        turn = np.pi - turn  # counter-clockwise from above all the same
    across, forward = np.sin(turn), np.cos(turn)
    inside *= room
    beside = np.where(across > 0.0, out, inside) * across
    ahead = np.where(forward > 0.0, front, back) * forward
    left = frame[0] if frame[0][0] > 0.0 else -frame[0]
    lift = fit.girth * row[7] * across
    points = point + (sign * beside)[:, None] * left + ahead[:, None] * frame[1]
    return points - lift[:, None] * frame[2]
