"""Where the points of a foot are when it rolls over heel, ball and toe tip."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Foot


class SolePose(NamedTuple):
    """Points of a supported foot, ``(*n, 2)`` (forward, up) from N of its flat pose, meters.

    ``toe_joint`` is the axis the toes bend about (the ball itself in the papers).
    """

    heel: Float[np.ndarray, "*n 2"]
    ball: Float[np.ndarray, "*n 2"]
    toe: Float[np.ndarray, "*n 2"]
    ankle: Float[np.ndarray, "*n 2"]
    toe_joint: Float[np.ndarray, "*n 2"]


def turned(
    forward: Float[np.ndarray, "*n"] | float,
    up: Float[np.ndarray, "*n"] | float,
    pitch: Float[np.ndarray, "*n"],
) -> Float[np.ndarray, "*n 2"]:
    """Sagittal vector ``(forward, up)`` of the level foot after it pitches, toes up positive."""
    c, s = np.cos(pitch), np.sin(pitch)
    return np.stack([forward * c - up * s, forward * s + up * c], axis=-1)


def roll(foot: Foot, pitch: Float[np.ndarray, "*n"], meta: Float[np.ndarray, "*n"]) -> SolePose:
    """Pose of a foot that stands at N with sole pitch and meta angle (radians).

    ``pitch >= 0`` turns the whole foot about the heel; ``pitch < 0`` raises the heel while
    the toes stay (``meta = 0``) or stand on their tip, raised by ``meta`` against the floor.
    Continuous at both zeros. [KB92b] Figure 7 and section 2.3; lemma 1 is the special case of
    the ankle at toe-off.
    """
    pitch, meta = np.broadcast_arrays(
        np.asarray(pitch, dtype=np.float64), np.asarray(meta, dtype=np.float64)
    )
    rocker = pitch >= 0.0
    # heel rocker: everything turns about the heel
    at_heel = np.stack([np.full(pitch.shape, -foot.heel), np.zeros(pitch.shape)], axis=-1)
    # forefoot: the toes turn by meta about their tip, the rest by pitch about the toe joint
    tip = np.array([foot.ball + foot.toes, 0.0])
    joint = tip + turned(-foot.toes, foot.toe_joint_height, -meta)

    def point(forward: float, up: float) -> Float[np.ndarray, "*n 2"]:
        by_heel = at_heel + turned(forward + foot.heel, up, pitch)
        by_joint = joint + turned(forward - foot.ball, up - foot.toe_joint_height, pitch)
        return np.where(rocker[..., None], by_heel, by_joint)

    toe = np.where(rocker[..., None], at_heel + turned(foot.heel_ball + foot.toes, 0.0, pitch), tip)
    return SolePose(
        heel=point(-foot.heel, 0.0),
        ball=point(foot.ball, 0.0),
        toe=toe,
        ankle=point(0.0, foot.ankle_height),
        toe_joint=point(foot.ball, foot.toe_joint_height),
    )
