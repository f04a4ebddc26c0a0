"""A stretch of motion closed into a Cycle: the later stride blended in, mirrored on request."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.geometry.curves import hermite, parabola_slopes, smoothstep
from gaitsmith.geometry.rotations import sign_continuous, slerp

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.motion.skeleton import Skeleton

Pose = "tuple[Float[np.ndarray, 'n 3'], Float[np.ndarray, 'n J 4']]"


def read_pose(
    motion: Motion, times: Float[np.ndarray, "n"]
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n J 4"]]:
    """Root position and local rotations of ``motion`` at ``times`` (seconds), by the cubic."""
    frames = np.arange(len(motion), dtype=np.float64)
    joints = len(motion.skeleton)
    table = np.concatenate([motion.root_position, motion.rotations.reshape(len(motion), -1)], 1)
    values = hermite(frames, table, parabola_slopes(frames, table), times * motion.fps)
    turned = values[:, 3:].reshape(-1, joints, 4)
    return values[:, :3], turned / np.linalg.norm(turned, axis=-1, keepdims=True)


def closed(
    motion: Motion,
    first: float,
    last: float,
    blend: float,
    shift: Float[np.ndarray, "3"],
    samples: int,
) -> tuple[Float[np.ndarray, "K 3"], Float[np.ndarray, "K J 4"]]:
    """``samples`` poses from ``first`` to ``last`` (seconds) that close on themselves.

    Parameters
    ----------
    motion
        Covers ``first`` to ``last + blend``.
    first, last
        Times of the same event, one loop apart.
    blend
        Seconds over which the beginning is led over from what follows ``last``.
    shift
        How far the loop gets, meters: what follows ``last`` is moved back by it.

    Notes
    -----
    [KN12] section 3.2. At the start the pose is that of the later stance, at the end of the
    blend that of the earlier one; so the end of the loop runs on into its start. The weight is
    ``3u^2 - 2u^3``: with the paper's linear one the speed jumps at both ends. Events
    are not warped onto each other, which makes the seam worse (measured; see the errata).
    """
    share = np.arange(samples) / samples
    times = first + share * (last - first)
    position, turned = read_pose(motion, times)
    u = (times - first) / blend
    early = u < 1.0
    weight = smoothstep(u[early])  # of the earlier stance
    later_position, later = read_pose(motion, times[early] + (last - first))
    position[early] = weight[:, None] * position[early] + (1.0 - weight)[:, None] * (
        later_position - shift
    )
    turned[early] = slerp(later, turned[early], weight[:, None])
    return position - share[:, None] * shift, sign_continuous(turned)


def mirrored(skeleton: Skeleton, q: Float[np.ndarray, "K J 4"]) -> Float[np.ndarray, "K J 4"]:
    """Local rotations seen in a mirror: left and right swapped, turns about Y and Z reversed."""
    other = list(range(len(skeleton)))
    for joint, name in enumerate(skeleton.names):
        for side, opposite in (SIDES, SIDES[::-1]):
            if name.startswith(side):
                other[joint] = skeleton.index(opposite + name.removeprefix(side))
    return q[:, other] * np.array([1.0, -1.0, -1.0, 1.0])


def average(
    one: Float[np.ndarray, "*n 4"], two: Float[np.ndarray, "*n 4"]
) -> Float[np.ndarray, "*n 4"]:
    """Half way between rotations."""
    return slerp(one, two, 0.5)
