"""Trunk, head and arms in a turn: the head looks into it first, the trunk leans where asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, log, multiply, turned_left
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Shares of the gaze's turn: neck, head, and the whole spine ([KB93] gives the neck 2/3).
NECK, HEAD, SPINE = 0.5, 0.4, 0.1
#: Farthest that the head turns against the pelvis, radians (17-61 deg measured in turns).
LARGEST_GAZE = float(np.radians(60.0))
#: Lean of the trunk over the lean that is asked for, by way of banking. "trunk": upper body and
#: head are 0.6 of the mass, a third of the height above the hips.
TRUNK_LEAN = {"trunk": 10.0}
#: Radius of the way, meters, from which on a walker is all in the turn.
TIGHT = 1.2
#: Parts of their own turning to and fro that pelvis and head leave out in a turn: both then follow
#: it, the head held on where it looks.
STEADY_PELVIS, STEADY_HEAD = 0.85, 1.0
#: Least and most that an arm swings in a turn, over its swing straight ahead.
ARM_SWING = (0.5, 1.5)


@dataclass(frozen=True, eq=False)
class Turning:
    """What a turn asks of the upper body at M instants; left positive.

    Attributes
    ----------
    gaze
        How far the head turns beyond the walk, radians.
    roll
        Lean of the trunk, radians.
    bend
        How much the way turns, per meter.
    """

    gaze: Float[np.ndarray, "M"]
    roll: Float[np.ndarray, "M"]
    bend: Float[np.ndarray, "M"]


def bend_upper(
    body: Body,
    upper: Float[np.ndarray, "M U 3"],
    pelvis: Float[np.ndarray, "M 3"],
    turn: Turning,
    arms_middle: Float[np.ndarray, "U 3"] | None,
) -> None:
    """Change ``upper`` and ``pelvis``, rotation vectors, to what the turn has them.

    The head turns to the gaze, the trunk leans; pelvis and head keep less of what they turn to and
    fro in every step; each arm swings about ``arms_middle`` as far as its side of the body
    gets ahead: the inner one less, the outer one more.
    """
    gaze, roll, bend = turn.gaze, turn.roll, turn.bend
    if not gaze.any() and not roll.any() and not bend.any():
        return
    count = len(spine_names(body.spine_segments))
    steady = smoothstep(TIGHT * np.abs(bend))
    less = STEADY_PELVIS * steady * pelvis[:, 1]  # the trunk above stays as it was
    head = pelvis[:, 1] + upper[:, : count + 2, 1].sum(-1)
    pelvis[:, 1] -= less
    yaw = LARGEST_GAZE * np.tanh(gaze / LARGEST_GAZE)
    turns = np.zeros((3, len(gaze))).T
    turns[:, 1] = (SPINE * yaw + less) / count
    turns[:, 2] = -roll / count
    first = exp(turns)
    before = None
    for i in range(count):
        here = upper[:, i]
        if before is not None and np.array_equal(here, before):
            here[:] = upper[:, i - 1]  # usual: a spine shares its turn evenly
        else:
            before = np.array(here)
            here[:] = log(multiply(first, exp(here)))
    yaw = (1.0 - SPINE) * yaw - STEADY_HEAD * steady * head
    for i, share in ((count, NECK), (count + 1, HEAD)):
        upper[:, i] = log(turned_left(share / (NECK + HEAD) * yaw, exp(upper[:, i])))
    if arms_middle is not None and bend.any():
        names = upper_joints(body)
        for side, sign in zip(SIDES, SIDE_SIGN, strict=True):
            size = np.clip(1.0 - 0.5 * sign * body.shoulder_width * bend, *ARM_SWING)[:, None]
            for i in (names.index(f"{side}{part}") for part in ("UpperArm", "LowerArm")):
                upper[:, i] = arms_middle[i] + size * (upper[:, i] - arms_middle[i])
