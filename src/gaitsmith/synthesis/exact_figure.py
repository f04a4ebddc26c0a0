"""The legs of [SM01]: 14 joint angles with the anatomical axes of the ankle.

Vectors and matrices here are in the paper's frame, x forward at heading 0, y up, z to the right,
which turns with the heading as ours does; :func:`ours` leads back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.walks.elevation import pelvis_height
from gaitsmith.walks.round_heel import RoundHeel
from gaitsmith.walks.single_dof import solve_single_dof

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Degrees of the lower ankle's axis up and inward, and of the upper one's outer end down and
#: back: Isman & Inman 1969, Inman 1976, from memory of the literature.
SUBTALAR, TALOCRURAL = (42.0, 23.0), (8.0, 6.0)
#: Half widths of the sole at heel and ball over the length from heel to ball.
HEEL_WIDTH, BALL_WIDTH = 0.15, 0.21
X, Y, Z = np.eye(3)


@dataclass(frozen=True, eq=False)
class ExactFigure:
    """A body for the exact walker; lengths in meters.

    Attributes
    ----------
    thigh, shin, half_hips, pelvis
        Hip to knee, knee to ankle, half the distance of the hips, hips' middle to pelvis' top.
    sole
        ``(C, 3)`` corners of the sole from the ankle, of the flat foot: left and right of the
        profile of the round heel and the ball.
    joint
        ``(3,)`` joint of the toes, from the ankle.
    leg_length
        Thigh and shin.
    """

    thigh: float
    shin: float
    half_hips: float
    pelvis: float
    sole: Float[np.ndarray, "C 3"]
    joint: Float[np.ndarray, "3"]
    leg_length: float

    @classmethod
    def of(cls, body: Body) -> ExactFigure:
        """The figure of ``body``."""
        profile = RoundHeel.of(body.foot)
        flat = profile.corners - profile.ankle
        width = np.full(len(flat), HEEL_WIDTH * body.foot.heel_ball)
        width[-1] = BALL_WIDTH * body.foot.heel_ball
        sole = [np.insert(flat, 2, side * width, axis=1) for side in (-1.0, 1.0)]
        joint = profile.joint - profile.ankle
        return cls(
            body.thigh,
            body.shin,
            0.5 * body.hip_width,
            pelvis_height(body),
            np.concatenate(sole),
            np.append(joint, 0.0),
            body.leg_length,
        )


def ankle_axes(side: float) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Unit axes of the upper and the lower ankle; ``side`` is +1 right, -1 left.

    Positive about the upper one lifts the toes on both sides; about the lower one it is
    inversion on one side and eversion on the other.
    """
    up, inward = np.radians(SUBTALAR)
    lower = np.array([np.cos(up) * np.cos(inward), np.sin(up), -side * np.cos(up) * np.sin(inward)])
    down, back = np.radians(TALOCRURAL)
    upper = np.array([-side * np.sin(back), -side * np.sin(down), 1.0])
    return upper / np.linalg.norm(upper), lower


def about(axis: Float[np.ndarray, "*n 3"], angle: Float[np.ndarray, "*n"]) -> np.ndarray:
    """Rotation matrices ``(*n, 3, 3)`` about unit axes."""
    axis, angle = np.asarray(axis), np.asarray(angle)
    x, y, z = axis[..., 0], axis[..., 1], axis[..., 2]
    c, s = np.cos(angle), np.sin(angle)
    vx, vy, vz = (1.0 - c) * x, (1.0 - c) * y, (1.0 - c) * z
    out = np.empty((*np.broadcast_shapes(x.shape, c.shape), 3, 3))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = c + vx * x, vx * y - s * z, vx * z + s * y
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2] = vx * y + s * z, c + vy * y, vy * z - s * x
    out[..., 2, 0], out[..., 2, 1], out[..., 2, 2] = vx * z - s * y, vy * z + s * x, c + vz * z
    return out


def apply(matrix: Float[np.ndarray, "*n 3 3"], vector: Float[np.ndarray, "*n 3"]) -> np.ndarray:
    """Matrix times vector, each."""
    return (matrix @ np.asarray(vector)[..., None])[..., 0]


def sagittal(
    heading: Float[np.ndarray, "*n"],
) -> tuple[Float[np.ndarray, "*n 3"], Float[np.ndarray, "*n 3"]]:
    """Forward and normal (to the right) of the sagittal plane."""
    c, s, zero = np.cos(heading), np.sin(heading), np.zeros_like(heading)
    return np.stack([c, zero, -s], axis=-1), np.stack([s, zero, c], axis=-1)


def elevation(vector: Float[np.ndarray, "*n 3"], forward: Float[np.ndarray, "*n 3"]) -> np.ndarray:
    """[SM01] Eq. 1, with the quadrant."""
    return np.arctan2((vector * forward).sum(-1), -vector[..., 1])


def turn_to_elevation(
    vector: Float[np.ndarray, "*n 3"],
    axis: Float[np.ndarray, "*n 3"],
    wanted: Float[np.ndarray, "*n"],
    heading: Float[np.ndarray, "*n"],
    near: Float[np.ndarray, "*n"] | float,
) -> Float[np.ndarray, "*n"]:
    """Angle about ``axis`` that gives ``vector`` its elevation, [SM01] section 4.2."""
    return solve_single_dof(ours(vector), ours(axis), wanted, heading=heading, near=near).angle


def ours(vector: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Vectors of the paper's frame in the package's: +Z forward, +Y up, +X to the left."""
    vector = np.asarray(vector)
    return np.stack([-vector[..., 2], vector[..., 1], vector[..., 0]], axis=-1)
