"""A relaxed hand: a palm and a thumb of the body's cage, fingers that curl a little."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.skin.fit import HAND
from gaitsmith.skin.rings import Bones, ring_around
from gaitsmith.skin.shapes import skin

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.cage import Cage
    from gaitsmith.skin.fit import Fit
    from gaitsmith.skin.shapes import Mesh

# Rings of the palm: meters from the wrist; radii to the back of the hand, the palm, the
# thumb and the little finger; how far it has curled toward the palm.
_PALM = np.array(
    [
        [0.005, 0.022, 0.021, 0.028, 0.026, 0.000],
        [0.034, 0.021, 0.020, 0.037, 0.033, 0.002],
        [0.068, 0.018, 0.020, 0.043, 0.042, 0.004],
        [0.092, 0.015, 0.016, 0.043, 0.042, 0.006],
        [0.104, 0.008, 0.009, 0.036, 0.035, 0.009],
    ]
)
_PALM_WEIGHTS = (0.55, 0.95)
# Rings of the thumb, from the wrist: meters toward the back of the hand, toward the thumb's
# side, along; radius; where it looks, in the same three directions. Then its tip.
_THUMB = np.array(
    [
        [-0.012, 0.047, 0.057, 0.0165, -0.30, 0.60, 0.74],
        [-0.023, 0.057, 0.080, 0.0138, -0.35, 0.36, 0.87],
        [-0.032, 0.061, 0.101, 0.0108, -0.37, 0.16, 0.92],
    ]
)
_THUMB_TIP = np.array([-0.037, 0.062, 0.114])
# Fingers from the index to the little one: knuckle along and toward the thumb's side, length,
# radius, all in meters; how far it spreads toward the thumb and how far it is curled, radians.
_FINGERS = np.array(
    [
        [0.094, 0.0310, 0.080, 0.0104, 0.06, 0.62],
        [0.098, 0.0105, 0.089, 0.0108, 0.01, 0.78],
        [0.095, -0.0105, 0.083, 0.0104, -0.04, 0.92],
        [0.087, -0.0305, 0.066, 0.0092, -0.10, 1.05],
    ]
)
# Rings of a finger: share of its length, radius and share of the curl.
_FINGER = np.array(
    [
        [-0.14, 0.92, 0.10],
        [0.08, 1.02, 0.30],
        [0.34, 0.94, 0.34],
        [0.52, 0.96, 0.72],
        [0.76, 0.86, 1.0],
        [0.93, 0.66, 1.08],
    ]
)
_SIDES_OF_FINGER = 6


def _unit(fit: Fit, side: int) -> float:
    """Size of the hand over the standard one."""
    ends = fit.measures.skeleton.ends
    length = 0.0 if ends is None else float(np.linalg.norm(ends[fit.index(f"{SIDES[side]}Hand")]))
    return length / HAND if 0.04 < length / fit.girth < 0.3 else fit.girth


def add_hand(cage: Cage, fit: Fit, side: int, bones: Bones, above: list[int], paint: int) -> None:
    """Palm and thumb, welded to the last ring ``above`` of the arm."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    unit = _unit(fit, side)
    wrist, frame = bones.place(np.array([1.0, 1.0, 0.0]))
    rigid, fore = fit.one(f"{word}Hand"), fit.one(f"{word}LowerArm")
    rings: list[list[int]] = []
    for k, row in enumerate(_PALM):
        point = wrist + unit * (row[0] * frame[2] - row[5] * frame[0])
        radii = unit * (row[[1, 2, 3, 4]] if sign > 0.0 else row[[1, 2, 4, 3]])
        share = _PALM_WEIGHTS[k] if k < 2 else 1.0
        ring = ring_around(point, frame, radii, 8, 0.80)
        rings.append(cage.ring(ring, share * rigid + (1.0 - share) * fore))
    # the thumb grows from the two columns that look forward, between two rings of the palm
    thumb = 2 if sign > 0.0 else 6
    cage.loft(above, rings[0], paint)
    for k in range(len(rings) - 1):
        skip = (thumb - 1, thumb) if k == 1 else ()
        cage.loft(rings[k], rings[k + 1], paint, skip=skip)
    tip = wrist + unit * (0.107 * frame[2] - 0.010 * frame[0])
    cage.fan(rings[-1], cage.point(tip, rigid), paint)
    low, high = rings[1], rings[2]
    columns = (thumb - 1, thumb, thumb + 1)
    base = [low[k] for k in columns] + [high[k] for k in columns[::-1]]
    frame = frame * [[1.0], [sign], [1.0]]
    _add_thumb(cage, wrist, unit, frame, base, rigid, paint)


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
    # as it bends forward, the opening's near edge becomes its outside, the far one its inside
    above = float((cage.points[base[0]] - cage.points[base[2]]) @ frame[0])
    turn = np.deg2rad(60.0 * np.arange(1, -5, -1)) * np.sign(above)
    for row in _THUMB:
        axis = row[4:] / np.linalg.norm(row[4:])
        out = np.array([0.0, 1.0, 0.0]) - axis[1] * axis
        out /= np.linalg.norm(out)
        up = np.cross(out, axis)
        flat = np.cos(turn)[:, None] * out + np.sin(turn)[:, None] * up
        ring = cage.ring(wrist + unit * ((row[:3] + row[3] * flat) @ frame), rigid)
        cage.loft(base, ring, paint)
        base = ring
    cage.fan(base, cage.point(wrist + unit * (_THUMB_TIP @ frame), rigid), paint)


def fingers(fit: Fit, side: int) -> list[Mesh]:
    """Four closed meshes in the modelling pose, rooted in the palm."""
    word, sign = SIDES[side], float(SIDE_SIGN[side])
    joints = [f"{word}{name}" for name in ("UpperArm", "LowerArm", "Hand")]
    bones = Bones(fit, joints, np.array([0.0, 0.0, sign]))
    wrist, frame = bones.place(np.array([1.0, 1.0, 0.0]))
    frame = frame * [[1.0], [sign], [1.0]]  # back of the hand, toward the thumb, along
    unit = _unit(fit, side)
    return [_finger(row, wrist, unit, frame, sign) for row in _FINGERS]


def _finger(
    row: Float[np.ndarray, "6"],
    wrist: Float[np.ndarray, "3"],
    unit: float,
    frame: Float[np.ndarray, "3 3"],
    sign: float,
) -> Mesh:
    along, beside, length, radius, spread, curl = row.tolist()
    share, thick, bend = _FINGER.T
    angle = curl * bend
    way = np.stack([-np.sin(angle), spread * np.cos(angle), np.cos(angle)], axis=1)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    step = np.diff(np.concatenate([share, [1.0]])) * length
    middle = 0.5 * (way + np.concatenate([way[1:], way[-1:]]))
    root = np.array([-0.007, beside, along]) + share[0] * length * way[0]
    centers = root + np.concatenate([np.zeros((1, 3)), np.cumsum(step[:, None] * middle, axis=0)])
    turn = sign * 2.0 * np.pi * (np.arange(_SIDES_OF_FINGER) + 0.5) / _SIDES_OF_FINGER
    across = np.array([0.0, 1.0, 0.0]) - way[:, 1:2] * way
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    up = np.cross(way, across)
    rings = centers[:-1, None] + radius * thick[:, None, None] * (
        np.cos(turn)[:, None] * across[:, None] + np.sin(turn)[:, None] * up[:, None]
    )
    vertices, faces = skin(rings, centers[0] - 0.2 * radius * way[0], centers[-1])
    return wrist + unit * (vertices @ frame), faces
