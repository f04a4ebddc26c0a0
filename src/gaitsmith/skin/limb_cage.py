"""Cages of arms, hands and legs: rings along the bones of the modelling pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.skin.fit import HAND
from gaitsmith.skin.torso_cage import hip_room

if TYPE_CHECKING:
    from collections.abc import Sequence

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
# Rings of a hand: meters from the wrist; radii to the back of the hand, the palm, the thumb
# and the little finger; how far it has curled toward the palm.
_HAND = np.array(
    [
        [0.005, 0.022, 0.021, 0.028, 0.026, 0.000],
        [0.034, 0.021, 0.020, 0.037, 0.033, 0.002],
        [0.070, 0.018, 0.018, 0.044, 0.042, 0.005],
        [0.100, 0.016, 0.014, 0.045, 0.044, 0.010],
        [0.134, 0.014, 0.011, 0.039, 0.039, 0.018],
        [0.164, 0.011, 0.009, 0.031, 0.033, 0.029],
        [0.182, 0.007, 0.006, 0.018, 0.021, 0.037],
    ]
)
_HAND_WEIGHTS = (0.55, 0.95)
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


class _Bones:
    """A chain of bones in the modelling pose, with a frame at every place of it."""

    def __init__(self, fit: Fit, names: Sequence[str], front: Float[np.ndarray, "3"]) -> None:
        at = fit.sculpt.posed[[fit.index(name) for name in names]]
        self.at, self.step = at, np.diff(at, axis=0)
        self.length = np.linalg.norm(self.step, axis=1)
        self.way, self.hint, self.girth = self.step / self.length[:, None], front, fit.girth

    def place(
        self, row: Float[np.ndarray, "columns"]
    ) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
        """Point of a row ``(bone, share, meters beyond)``; rows (first, front, along) there."""
        bone = int(row[0])
        along = row[1] * self.length[bone] + row[2] * self.girth
        point = self.at[bone] + along * self.way[bone]
        way = self.way[bone]
        # near the joint between two bones the rings stand halfway between both
        start, end = along < 0.15 * self.length[bone], along > 0.85 * self.length[bone]
        near = bone - 1 if start else bone + 1 if end else bone
        if 0 <= near < len(self.way) and near != bone:
            apart = abs(along if start else self.length[bone] - along) / self.girth
            way = way + np.clip(1.0 - apart / 0.08, 0.0, 1.0) * self.way[near]
            way = way / np.linalg.norm(way)
        front = self.hint - (self.hint @ way) * way
        front /= np.linalg.norm(front)
        return point, np.stack([np.cross(front, way), front, way])


def _ring(
    point: Float[np.ndarray, "3"],
    frame: Float[np.ndarray, "3 3"],
    radii: Float[np.ndarray, "4"],
    count: int,
    power: float = 1.0,
) -> Float[np.ndarray, "count 3"]:
    """Ring around ``point``; radii to +first, -first, +front, -front of its frame."""
    turn = 2.0 * np.pi * np.arange(count) / count
    first, front = np.cos(turn), np.sin(turn)
    first = np.sign(first) * np.abs(first) ** power
    front = np.sign(front) * np.abs(front) ** power
    reach = np.array(radii) / np.cos(np.pi / count) * (1.0 if count > 8 else 0.98)
    a = np.where(first > 0.0, reach[0], reach[1]) * first
    b = np.where(front > 0.0, reach[2], reach[3]) * front
    return point + a[:, None] * frame[0] + b[:, None] * frame[1]


def add_arm(
    cage: Cage, fit: Fit, side: int, opening: list[int], paints: tuple[int, int, int]
) -> None:
    """Arm and hand of one side in the colours (limb, joint, hand), from the ``opening``."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    joints = [f"{word}{name}" for name in ("UpperArm", "LowerArm", "Hand")]
    # right-handed (top, front, along) on the left; on the right, front is behind
    bones = _Bones(fit, joints, np.array([0.0, 0.0, sign]))
    above = opening
    for k, row in enumerate(_ARM):
        point, frame = bones.place(row)
        radii = fit.girth * row[3:7]
        if sign < 0.0:
            radii = radii[[0, 1, 3, 2]]
        bone, below = int(row[0]), float(row[7])
        if below < 0.0:
            share = (0.90, 1.0)[k]
            parent = f"{word}Shoulder" if f"{word}Shoulder" in fit.maker.skeleton.names else None
            rest = fit.one(parent) if parent else fit.spine(point[1:2])[0]
            weights = share * fit.one(joints[0]) + (1.0 - share) * rest
        elif k < 7:
            weights = (1.0 - below) * fit.one(joints[0]) + below * fit.one(joints[1])
            weights = fit.one(joints[bone]) if below == 0.0 else weights
        else:
            weights = (1.0 - below) * fit.one(joints[1]) + below * fit.one(joints[2])
        ring = cage.ring(_ring(point, frame, radii, 8, 0.96), weights)
        cage.loft(above, ring, paints[1] if k in (5, 6) else paints[0])
        above = ring
    _add_hand(cage, fit, side, bones, above, paints[2])


def _add_hand(cage: Cage, fit: Fit, side: int, bones: _Bones, above: list[int], paint: int) -> None:
    """A mitten with a thumb, curled a little toward the palm."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    hand, ends = fit.index(f"{word}Hand"), fit.maker.skeleton.ends
    length = 0.0 if ends is None else float(np.linalg.norm(ends[hand]))
    unit = length / HAND if length > 0.0 else fit.girth
    wrist, frame = bones.at[2], bones.place(np.array([1.0, 1.0, 0.0]))[1]
    rigid, fore = fit.one(f"{word}Hand"), fit.one(f"{word}LowerArm")
    rings: list[list[int]] = []
    for k, row in enumerate(_HAND):
        point = wrist + unit * (row[0] * frame[2] - row[5] * frame[0])
        radii = unit * (row[[1, 2, 3, 4]] if sign > 0.0 else row[[1, 2, 4, 3]])
        share = _HAND_WEIGHTS[k] if k < 2 else 1.0
        ring = _ring(point, frame, radii, 8, 0.80)
        rings.append(cage.ring(ring, share * rigid + (1.0 - share) * fore))
    # the thumb grows from the two columns that look forward, between two rings of the palm
    thumb = 2 if sign > 0.0 else 6
    cage.loft(above, rings[0], paint)
    for k in range(len(rings) - 1):
        skip = (thumb - 1, thumb) if k == 1 else ()
        cage.loft(rings[k], rings[k + 1], paint, skip=skip)
    tip = wrist + unit * (0.187 * frame[2] - 0.041 * frame[0])
    cage.fan(rings[-1], cage.point(tip, rigid), paint)
    low, high = rings[1], rings[2]
    columns = (thumb - 1, thumb, thumb + 1)
    base = [low[k] for k in columns] + [high[k] for k in columns[::-1]]
    front = sign * frame[1]
    _add_thumb(cage, wrist, unit, np.stack([frame[0], front, frame[2]]), base, rigid, paint)


def _add_thumb(
    cage: Cage,
    wrist: Float[np.ndarray, "3"],
    unit: float,
    frame: Float[np.ndarray, "3 3"],
    base: list[int],
    rigid: Float[np.ndarray, "joints"],
    paint: int,
) -> None:
    """Thumb from the opening ``base``; frame rows: back of the hand, toward the thumb, along."""
    middle = np.mean([cage.points[k] for k in base], axis=0)
    spread = np.array([cage.points[k] for k in base]) - middle
    # its rings keep the outline of the opening, turned to look along the thumb
    way = np.array([-0.34, 0.50, 0.80])
    way = way / np.linalg.norm(way)
    for depth, forward, down, size in (
        (0.066, 0.054, 0.014, 0.0150),
        (0.086, 0.064, 0.021, 0.0138),
        (0.104, 0.070, 0.027, 0.0105),
    ):
        center = wrist + unit * (depth * frame[2] + forward * frame[1] - down * frame[0])
        axis = way @ frame
        flat = spread - (spread @ axis)[:, None] * axis
        flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-9)
        ring = cage.ring(center + unit * size * flat, rigid)
        cage.loft(base, ring, paint)
        base = ring
    tip = wrist + unit * (0.113 * frame[2] + 0.073 * frame[1] - 0.030 * frame[0])
    cage.fan(base, cage.point(tip, rigid), paint)


def add_leg(cage: Cage, fit: Fit, side: int, opening: list[int], paints: tuple[int, int]) -> None:
    """Leg of one side in the colours (limb, joint), from the ``opening`` into the shoe."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    joints = [f"{word}{name}" for name in ("UpperLeg", "LowerLeg", "Foot")]
    bones = _Bones(fit, joints, np.array([0.0, 0.0, 1.0]))
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
