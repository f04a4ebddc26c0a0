"""A motion that stands on after its end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.motion.motion import Motion

#: Frames that one motion may have: about 2 GB.
MOST_FRAMES = 1_000_000


def frames_until(seconds: float, fps: float) -> int:
    """How many frames a motion of ``seconds`` has: the last is not after its end."""
    count = int(np.floor(seconds * fps + 1e-6)) + 1
    if count > MOST_FRAMES:
        raise InvalidInputError(
            f"{seconds:.0f} s at {fps:g} frames per second are more than {MOST_FRAMES} "
            "frames; walk it in parts or lower fps"
        )
    return count


def held(motion: Motion, until: float) -> Motion:
    """``motion`` with its last frame repeated until the second ``until``; as it is if longer."""
    more = frames_until(until, motion.fps) - len(motion)
    if more <= 0:
        return motion

    def longer(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values, np.repeat(values[-1:], more, axis=0)])

    labels = motion.labels
    if labels is not None:
        labels = replace(labels, phase=longer(labels.phase), step=longer(labels.step))
    return Motion(
        skeleton=motion.skeleton,
        root_position=longer(motion.root_position),
        rotations=longer(motion.rotations),
        fps=motion.fps,
        contacts=None if motion.contacts is None else longer(motion.contacts),
        translations=None if motion.translations is None else longer(motion.translations),
        labels=labels,
    )
