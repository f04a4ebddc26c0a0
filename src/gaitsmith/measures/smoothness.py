"""Jerk, and what should not jump from frame to frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.measures.notes import Figures, explained
from gaitsmith.measures.skating import resampled

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion

#: Frames per second at which derivatives are taken, so that clips of all rates compare.
RATE = 30.0
#: m/s^2: second differences below are no jump of the root.
_CALM = 3.0


def jerk_rms(path: Float[np.ndarray, "F 3"], fps: float) -> float | None:
    """Root mean square jerk of a point, m/s^3, by third differences over 1/30 s."""
    path = resampled(path, fps, RATE)
    if len(path) < 4:
        return None
    jerk = np.diff(path, 3, axis=0) * RATE**3
    return float(np.sqrt((jerk**2).sum(-1).mean()))


def log_dimensionless_jerk(path: Float[np.ndarray, "F 3"], fps: float) -> float | None:
    """Log dimensionless jerk of a movement; nearer to 0 is smoother.

    ``-ln(T^3 / v_max^2 * integral of jerk^2)``, jerk by third differences over 1/30 s
    (Balasubramanian, Melendez-Calderon & Burdet 2012). None of a point that does not move.
    """
    path = resampled(path, fps, RATE)
    if len(path) < 8:
        return None
    speed = np.linalg.norm(np.diff(path, axis=0), axis=-1) * RATE
    jerk = np.diff(path, 3, axis=0) * RATE**3
    duration = (len(path) - 1) / RATE
    size = float((jerk**2).sum(-1).mean()) * duration**4  # the mean: three ends have no jerk
    if speed.max() < 1e-3 or size <= 0.0:
        return None
    return -float(np.log(size / float(speed.max()) ** 2))


def joint_turn(rotations: Float[np.ndarray, "F J 4"], fps: float) -> tuple[float, int, int]:
    """Largest turn of a joint against its parent, radians per 1/60 s; its joint and frame.

    Taken over the whole number of frames nearest to 1/60 s, at least one, and scaled to it.
    """
    width = max(1, round(fps / 60.0))
    if len(rotations) <= width:
        return 0.0, 0, 0
    one, two = rotations[:-width], rotations[width:]
    # 2 atan2 of the parts keeps digits near zero, where arccos has none
    same = np.abs((one * two).sum(-1))
    apart = np.minimum(np.linalg.norm(two - one, axis=-1), np.linalg.norm(two + one, axis=-1))
    turn = 4.0 * np.arctan2(apart, np.sqrt(2.0 * (1.0 + same)))
    frame, joint = np.unravel_index(int(turn.argmax()), turn.shape)
    return float(turn.max()) * fps / (60.0 * width), int(joint), int(frame)


def root_jump(root: Float[np.ndarray, "F 3"], fps: float) -> tuple[float, int] | None:
    """Largest second difference of the root over its neighborhood's; its frame.

    The neighborhood's is the 75th percentile within 1/8 s (at least 5 frames) on both sides, at
    least 3 m/s^2. Above 4 a jump shows. None of fewer than 23 frames.
    """
    size = np.linalg.norm(np.diff(root, 2, axis=0), axis=-1)
    half = max(5, round(fps / 8.0))
    if len(size) <= max(20, 2 * half):
        return None
    windows = np.lib.stride_tricks.sliding_window_view(size, 2 * half + 1)
    typical = np.empty(len(size))
    typical[half:-half] = np.percentile(windows, 75.0, axis=-1)
    for i in range(half):  # the two ends, where the neighborhood is cut
        typical[i] = np.percentile(size[: i + half + 1], 75.0)
        typical[-1 - i] = np.percentile(size[-1 - i - half :], 75.0)
    ratio = size / np.maximum(typical, _CALM / fps**2)
    return float(ratio.max()), int(ratio.argmax()) + 1


def quaternion_flips(rotations: Float[np.ndarray, "F J 4"]) -> int:
    """Joints times frames at which a quaternion changes to the other half-sphere."""
    return int(((rotations[1:] * rotations[:-1]).sum(-1) < 0.0).sum())


def continuity_figures(motion: Motion, notes: list[str]) -> Figures:
    """What should not jump, of the motion's own joints."""
    turn, joint, frame = joint_turn(motion.rotations, motion.fps)
    jump = root_jump(motion.root_position, motion.fps)
    return {
        "joint_deg_per_60th_max": float(np.degrees(turn)),
        "joint_deg_per_60th_joint": motion.skeleton.names[joint],
        "joint_deg_per_60th_frame": frame,
        **explained(
            {
                "root_jump_max": None if jump is None else jump[0],
                "root_jump_frame": None if jump is None else jump[1],
            },
            "too short a clip to tell jumps from motion",
            notes,
        ),
        "quaternion_flips": quaternion_flips(motion.rotations),
    }
