"""Where the points of a foot are when it rolls over heel, ball and toe tip."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.rotations import component_major

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Bool, Float

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
    s, c = sine_cosine(pitch)
    return np.stack([forward * c - up * s, forward * s + up * c], axis=-1)


def rolled_ankle(
    foot: Foot,
    pitch: Float[np.ndarray, "*n"] | float,
    meta: Float[np.ndarray, "*n"] | float,
    toes: Float[np.ndarray, "*n"] | None = None,
    on_ball: Bool[np.ndarray, "*n"] | None = None,
) -> Float[np.ndarray, "*n 2"]:
    """The ankle of :func:`roll` alone, for those who need it often.

    ``toes``: radians by which the toes of the flat foot are raised against its sole, where the
    ground bends under them. ``on_ball``: whose toes hang over an edge, so that the foot rolls
    on the ball's sole point and ``meta`` means nothing.
    """
    pitch, meta = np.asarray(pitch, dtype=np.float64), np.asarray(meta, dtype=np.float64)
    ankle = _rolled(foot, pitch, meta, toes)(0.0, foot.ankle_height)
    if on_ball is None:
        return ankle
    rolled = turned(-foot.ball, foot.ankle_height, pitch) + [foot.ball, 0.0]
    return np.where((on_ball & (pitch < 0.0))[..., None], rolled, ankle)


def hanging_toes(foot: Foot, pitch: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Bend of toes that keep level beside a ball on which the foot rolls to ``pitch`` <= 0."""
    joint = foot.toe_joint_height
    size, angle = np.hypot(foot.toes, joint), np.arctan2(joint, foot.toes)
    return angle - np.arcsin(joint * np.cos(pitch) / size) - pitch


def roll(
    foot: Foot, pitch: Float[np.ndarray, "*n"] | float, meta: Float[np.ndarray, "*n"] | float
) -> SolePose:
    """Pose of a foot that stands at N with sole pitch and meta angle (radians).

    ``pitch >= 0`` turns the whole foot about the heel; ``pitch < 0`` raises the heel while
    the toes stay (``meta = 0``) or stand on their tip, raised by ``meta`` against the floor.
    Continuous at both zeros. [KB92b] Figure 7 and section 2.3; lemma 1 is the special case of
    the ankle at toe-off.
    """
    pitch, meta = np.broadcast_arrays(
        np.asarray(pitch, dtype=np.float64), np.asarray(meta, dtype=np.float64)
    )
    point = _rolled(foot, pitch, meta)
    tip = np.array([foot.ball + foot.toes, 0.0])
    on_heel = turned(foot.heel_ball + foot.toes, 0.0, pitch) - [foot.heel, 0.0]
    return SolePose(
        heel=point(-foot.heel, 0.0),
        ball=point(foot.ball, 0.0),
        toe=np.where((pitch >= 0.0)[..., None], on_heel, tip),
        ankle=point(0.0, foot.ankle_height),
        toe_joint=point(foot.ball, foot.toe_joint_height),
    )


def _rolled(
    foot: Foot,
    pitch: Float[np.ndarray, "*n"],
    meta: Float[np.ndarray, "*n"],
    toes: Float[np.ndarray, "*n"] | None = None,
) -> Callable[[float, float], Float[np.ndarray, "*n 2"]]:
    """Where the rolling foot has a point that the flat foot has at (forward, up) from N."""
    s, c = sine_cosine(pitch)
    rocker = pitch >= 0.0
    # on its heel the foot turns about it; else about the toe joint, which the toes carry as
    # they turn by meta about their tip
    back, high = -foot.toes, foot.toe_joint_height
    sm, cm = sine_cosine(meta)
    tip = foot.ball + foot.toes
    if toes is None:
        toe_forward = tip + back * cm + high * sm
        toe_up = high * cm - back * sm
    else:  # tip and joint as the toes of the flat foot have them
        ct, st = np.cos(toes), np.sin(toes)
        x, y = back * ct - high * st, back * st + high * ct
        toe_forward = foot.ball - x + (x * cm + y * sm)
        toe_up = foot.toe_joint_height - y + (y * cm - x * sm)
    pivot_forward = np.where(rocker, -foot.heel, toe_forward)
    pivot_up = np.where(rocker, 0.0, toe_up)
    from_forward = np.where(rocker, -foot.heel, foot.ball)
    from_up = np.where(rocker, 0.0, high)

    def point(forward: float, up: float) -> Float[np.ndarray, "*n 2"]:
        x, y = forward - from_forward, up - from_up
        out = component_major(np.broadcast_shapes(c.shape, cm.shape), 2)
        out[..., 0] = pivot_forward + x * c - y * s
        out[..., 1] = pivot_up + x * s + y * c
        return out

    return point
