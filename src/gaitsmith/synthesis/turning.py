"""Trunk and head in a turn: the head looks into it first, the trunk leans where asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.geometry.rotations import about, exp, log, multiply

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Shares of the gaze's turn: neck, head, and the whole spine ([KB93] gives the neck 2/3).
NECK, HEAD, SPINE = 0.4, 0.35, 0.25
#: Farthest that the head turns against the pelvis, radians (17-61 deg measured in turns).
LARGEST_GAZE = float(np.radians(60.0))
#: Lean of the trunk over the lean that is asked for, by way of banking. "trunk": upper body and
#: head are 0.6 of the mass, a third of the height above the hips.
TRUNK_LEAN = {"trunk": 10.0}


def bent_upper(
    body: Body,
    upper: Float[np.ndarray, "M U 3"],
    gaze: Float[np.ndarray, "M"],
    roll: Float[np.ndarray, "M"],
) -> Float[np.ndarray, "M U 3"]:
    """``upper`` with the head turned by ``gaze``, the trunk leaning by ``roll``; left positive."""
    if not gaze.any() and not roll.any():
        return upper
    out = np.array(upper)
    yaw = LARGEST_GAZE * np.tanh(gaze / LARGEST_GAZE)
    spine = spine_names(body.spine_segments)
    count = len(spine)
    turns = np.zeros((len(gaze), 3))
    turns[:, 1] = SPINE * yaw / count
    turns[:, 2] = -roll / count
    first = exp(turns)
    same = count > 1 and bool((upper[:, 1:count] == upper[:, :1]).all())  # usual: shared evenly
    for i in range(1 if same else count):
        out[:, i] = log(multiply(first, exp(upper[:, i])))
    if same:
        out[:, 1:count] = out[:, :1]
    for i, share in ((count, NECK), (count + 1, HEAD)):
        out[:, i] = log(multiply(about("y", share * yaw), exp(upper[:, i])))
    return out
