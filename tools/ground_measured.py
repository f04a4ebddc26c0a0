"""Compare a walk over blocks with the person who was measured on them (CMU 03_01).

Same ground, same footholds, same times of landing. Prints the table of docs/reference/grounds.md.

Needs the measured data (GAITSMITH_DATA). The blocks are found from the feet that lie flat on them.
"""

from __future__ import annotations

import os
import warnings
from itertools import pairwise
from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith import io
from gaitsmith.errors import GaitsmithWarning
from gaitsmith.gait.person import person_of
from gaitsmith.geometry.rotations import rotate
from gaitsmith.ground import HeightField
from gaitsmith.motion.kinematics import motion_kinematics

CLIP = Path(os.environ.get("GAITSMITH_DATA", "../shared/data")) / "permissive/cmu/03_01.amc"
SIDES = {"L": "left", "R": "right"}
#: Feet in order, the frames (120 a second) in which each lies flat, and when it landed.
FLAT = (
    ("L", 2, 15, 0),
    ("R", 95, 125, 84),
    ("L", 194, 205, 172),
    ("R", 280, 320, 246),
    ("L", 355, 385, 345),
)
#: Frames that are compared: from the second landing to the last.
COMPARED = slice(84, 345)
#: Length of the standing step before the first foot, and seconds of the step that closes.
BEHIND, CLOSING = 0.35, 0.9


def ahead(vectors: np.ndarray, heading: float) -> np.ndarray:
    """Turned so that the walk leads along +Z."""
    c, s = np.cos(heading), np.sin(heading)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([c * x - s * z, y, s * x + c * z], axis=-1)


def blocks_and_steps(positions, rotations, index):
    """The height field of the blocks, and rows of footsteps."""
    hips = positions[:, 0]
    way = hips[-1] - hips[0]
    heading = float(np.arctan2(way[0], way[2]))
    origin = ahead(hips[0], heading) * [1.0, 0.0, 1.0]
    rows, level = [], []
    for side, a, b, landed in FLAT:
        foot, toes = (
            (ahead(positions[a:b, index(SIDES[side] + part)], heading) - origin).mean(0)
            for part in ("Foot", "Toes")
        )
        faces = rotate(rotations[a:b, index(SIDES[side] + "Foot")], np.array([0.0, 0.0, 1.0]))
        x, _, z = ahead(faces, heading).mean(0)
        rows.append((side, foot[0], foot[2], np.degrees(np.arctan2(x, z)), landed / 120.0))
        level.append(toes[1])
    # a block ends half way between the toes of one foot and the heel of the next
    fore, back = 0.16, 0.02
    edges = [0.5 * (a[2] + fore + b[2] - back) for a, b in pairwise(rows)]
    z = np.arange(-2.0, 4.0, 0.01)
    height = (np.array(level) - level[0])[np.searchsorted(edges, z)]
    field = HeightField(np.tile(height[:, None], (1, 201)), 0.01, (-1.0, -2.0))
    first = ("R", rows[1][1], rows[0][2] - BEHIND, rows[1][3], 0.0)
    last = ("R", rows[3][1], rows[4][2], rows[3][3], rows[4][4] + CLOSING)
    names = ("side", "x", "z", "heading_deg", "time")
    return field, [dict(zip(names, row, strict=True)) for row in (first, *rows, last)]


def angles(positions, index, side):
    """Elevation of the thigh and flexion of the knee, degrees."""
    hip, knee, ankle = (positions[:, index(side + p)] for p in ("UpperLeg", "LowerLeg", "Foot"))
    left = positions[:, index("leftUpperLeg")] - positions[:, index("rightUpperLeg")]
    front = np.cross(left, [0.0, 1.0, 0.0])
    front /= np.linalg.norm(front, axis=-1, keepdims=True)
    thigh, shin = knee - hip, ankle - knee
    sine = np.linalg.norm(np.cross(thigh, shin), axis=-1)
    flexion = np.arctan2(sine, (thigh * shin).sum(-1))
    elevation = np.arctan2((thigh * front).sum(-1), -thigh[:, 1])
    return np.degrees(elevation[COMPARED]), np.degrees(flexion[COMPARED])


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore", GaitsmithWarning)
    person = person_of(io.load(CLIP))
    clip = person.motion
    positions, rotations = motion_kinematics(clip)
    field, steps = blocks_and_steps(positions, rotations, clip.skeleton.index)
    ours = gaitsmith.walk(steps=steps, ground=field, body=person.body, fps=120)
    walked = motion_kinematics(ours)[0]
    print("| | largest, measured | ours | RMS difference | correlation |\n|---|---|---|---|---|")
    for side in ("left", "right"):
        both = (
            angles(positions, clip.skeleton.index, side),
            angles(walked, ours.skeleton.index, side),
        )
        for name, a, b in zip(("thigh elevation", "knee flexion"), *both, strict=True):
            rms, like = np.sqrt(((a - b) ** 2).mean()), np.corrcoef(a, b)[0, 1]
            print(
                f"| {side} {name} | {a.max():.0f} deg | {b.max():.0f} deg | {rms:.1f} deg | "
                f"{like:.2f} |"
            )


if __name__ == "__main__":
    main()
