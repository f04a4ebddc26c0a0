"""Where joints and soles are: forward kinematics over all frames at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.motion.skeleton import Skeleton


def forward_kinematics(
    skeleton: Skeleton,
    root_position: Float[np.ndarray, "frames 3"],
    rotations: Float[np.ndarray, "frames joints 4"],
    translations: Float[np.ndarray, "frames joints 3"] | None = None,
) -> tuple[Float[np.ndarray, "frames joints 3"], Float[np.ndarray, "frames joints 4"]]:
    """World positions (meters) and world rotations of every joint.

    The work runs on component-major arrays ``(joints, component, frames)``, which is several
    times faster than frame-major ones; what is returned are ``(frames, joints, component)``
    views of them.
    """
    frames, joints = rotations.shape[:2]
    local = np.ascontiguousarray(rotations.transpose(1, 2, 0))
    world = np.empty((joints, 4, frames))
    position = np.empty((joints, 3, frames))
    world[0], position[0] = local[0], root_position.T
    for joint in range(1, joints):
        parent = skeleton.parents[joint]
        ax, ay, az, aw = world[parent]
        bx, by, bz, bw = local[joint]
        out = world[joint]
        out[0] = aw * bx + ax * bw + ay * bz - az * by
        out[1] = aw * by - ax * bz + ay * bw + az * bx
        out[2] = aw * bz + ax * by - ay * bx + az * bw
        out[3] = aw * bw - ax * bx - ay * by - az * bz
        if translations is None:
            vx, vy, vz = skeleton.offsets[joint]
        else:
            vx, vy, vz = translations[:, joint].T
        tx, ty, tz = 2.0 * (ay * vz - az * vy), 2.0 * (az * vx - ax * vz), 2.0 * (ax * vy - ay * vx)
        base, here = position[parent], position[joint]
        here[0] = base[0] + vx + aw * tx + ay * tz - az * ty
        here[1] = base[1] + vy + aw * ty + az * tx - ax * tz
        here[2] = base[2] + vz + aw * tz + ax * ty - ay * tx
    return position.transpose(2, 0, 1), world.transpose(2, 0, 1)


def joint_positions(motion: Motion) -> Float[np.ndarray, "frames joints 3"]:
    """World positions of every joint of ``motion``, meters."""
    return motion_kinematics(motion)[0]


def motion_kinematics(
    motion: Motion,
) -> tuple[Float[np.ndarray, "frames joints 3"], Float[np.ndarray, "frames joints 4"]]:
    """World positions (meters) and world rotations of every joint of ``motion``."""
    return forward_kinematics(
        motion.skeleton, motion.root_position, motion.rotations, motion.translations
    )


def sole_positions(
    skeleton: Skeleton,
    positions: Float[np.ndarray, "frames joints 3"],
    world: Float[np.ndarray, "frames joints 4"],
) -> Float[np.ndarray, "frames 2 3 3"]:
    """World positions of [left, right] x [heel, ball, toe tip], meters.

    Raises InvalidInputError if the skeleton does not know its soles.
    """
    if skeleton.soles is None:
        raise InvalidInputError("this skeleton has no sole points; give Skeleton(soles=...)")
    from gaitsmith.geometry.rotations import rotate

    out = np.empty((len(positions), 2, 3, 3))
    for side, joints in enumerate(skeleton.sole_joints):
        for point, joint in enumerate(joints):
            out[:, side, point] = positions[:, joint] + rotate(
                world[:, joint], skeleton.soles[side, point]
            )
    return out
