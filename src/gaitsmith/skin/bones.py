"""A slim solid along every bone: what a skeleton that is no person is shown as."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.skin.palette import WOOD, WOOD_DARK
from gaitsmith.skin.shapes import ball, frame_along

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.skin.palette import Color
    from gaitsmith.skin.shapes import Mesh


class Solid(NamedTuple):
    """A closed piece in the frame of the joint that carries it, meters."""

    joint: int
    mesh: Mesh
    color: Color


def bone_solids(
    skeleton: Skeleton, rest: Float[np.ndarray, "joints 3"], size: float
) -> list[Solid]:
    """A ball at every joint and a spindle to each of its children, for a figure ``size`` m big."""
    knob = ball(np.zeros(3), np.full(3, 0.012 * size), around=8, rings=5)
    solids = [Solid(joint, knob, WOOD_DARK) for joint in range(len(skeleton))]
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            bone = rest[joint] - rest[parent]
            if float(np.linalg.norm(bone)) > 0.004 * size:
                solids.append(Solid(parent, _spindle(bone, 0.016 * size), WOOD))
    return solids


def _spindle(bone: Float[np.ndarray, "3"], wide: float) -> Mesh:
    """Eight-sided solid from the joint to the end of ``bone``, thickest near the joint."""
    length = float(np.linalg.norm(bone))
    wide = min(wide, 0.2 * length)
    turn = 2.0 * np.pi * np.arange(8) / 8
    frame = frame_along(bone)
    circle = np.cos(turn)[:, None] * frame[0] + np.sin(turn)[:, None] * frame[1]
    rings = [share * bone + reach * wide * circle for share, reach in ((0.16, 1.0), (0.9, 0.35))]
    vertices = np.concatenate([*rings, np.zeros((1, 3)), bone[None]])
    here, after = np.arange(8), (np.arange(8) + 1) % 8
    faces = np.concatenate(
        [
            np.stack([here, after, after + 8], axis=1),
            np.stack([here, after + 8, here + 8], axis=1),
            np.stack([np.full(8, 16), after, here], axis=1),
            np.stack([np.full(8, 17), here + 8, after + 8], axis=1),
        ]
    )
    return vertices, faces
