"""What is above the legs in a local step: gaze, trunk and arms, [KB93] section 5.4."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import about, exp, log, multiply
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Shares of the twist between pelvis and gaze: two thirds by the neck, which is two joints here,
#: one third by the whole torso.
NECK, HEAD, SPINE = 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0


def glanced(
    t: Float[np.ndarray, "T"], gaze: float, glances: Sequence[tuple[float, float, float]]
) -> Float[np.ndarray, "T"]:
    """Heading of the gaze: ``gaze`` plus its turns (radians, begin, end)."""
    out = np.full(len(t), gaze)
    for turn, begin, end in glances:
        out = out + turn * smoothstep((t - begin) / (end - begin))
    return out


def local_upper(
    body: Body,
    rest: Float[np.ndarray, "U 3"],
    twist: Float[np.ndarray, "T"],
    roll: Float[np.ndarray, "T"],
    arms: Float[np.ndarray, "T 3"],
) -> Float[np.ndarray, "T U 3"]:
    """Rotation vectors of the upper body: ``rest``, twisted to the gaze, arms moved.

    ``twist`` is the gaze against the pelvis, ``roll`` the lean of the trunk against the pelvis,
    both left positive; ``arms`` are the forward swings of both and how far they are held apart.
    """
    names = upper_joints(body)
    out = np.tile(rest, (len(twist), 1, 1))
    count = len(spine_names(body.spine_segments))
    turns = np.zeros((len(twist), 3))
    turns[:, 1], turns[:, 2] = SPINE * twist / count, -roll / count
    first = exp(turns)
    for i in range(count):
        out[:, i] = log(multiply(first, exp(out[:, i])))
    back = np.zeros_like(turns)
    for i, share in ((count, NECK), (count + 1, HEAD)):
        back[:, 1], back[:, 2] = share * twist, 0.5 * roll
        out[:, i] = log(multiply(exp(back), exp(out[:, i])))
    for side, name in enumerate(SIDES):
        i = names.index(f"{name}UpperArm")
        apart = about("z", SIDE_SIGN[side] * arms[:, 2])
        moved = multiply(about("x", -arms[:, side]), apart)
        out[:, i] = log(multiply(moved, exp(out[:, i])))
    return out
