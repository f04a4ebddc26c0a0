"""A prepared walk at a frame rate: the Motion with all its labels."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.body.rig import skeleton_of
from gaitsmith.contact.apply import local_legs
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import exp, sign_continuous
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.plan.timeline import Timeline
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from typing import Any

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.synthesis.step import PreparedWalk


#: Frames that one motion may have: about 5 GB of work space.
MOST_FRAMES = 1_000_000


def sample_walk(
    walk: PreparedWalk, body: Body, ground: Ground, *, fps: float, recipe: dict[str, Any]
) -> Motion:
    """Sample ``walk`` at ``fps`` frames per second from its first instant.

    The last frame is the last one that is not after the end of the walk. Everything is
    evaluated for all frames at once.
    """
    fps = positive("fps", fps, "frames per second")
    if walk.duration * fps > MOST_FRAMES:
        raise InvalidInputError(
            f"{walk.duration:.0f} s at {fps:g} frames per second are more than {MOST_FRAMES} "
            "frames; walk it in parts or lower fps"
        )
    frames = int(np.floor(walk.duration * fps + 1e-6)) + 1
    times = np.arange(frames) / fps
    poses = walk.poses(np.minimum(times, walk.duration))
    skeleton = skeleton_of(body)
    rotations = np.zeros((frames, len(skeleton), 4))
    rotations[..., 3] = 1.0
    rotations[:, 0] = poses.pelvis
    legs = local_legs(poses)
    for side, name in enumerate(SIDES):
        for part, turned in legs.items():
            rotations[:, skeleton.index(f"{name}{part}")] = turned[:, side]
    for i, name in enumerate(upper_joints(body)):
        if poses.upper[:, i].any():
            rotations[:, skeleton.index(name)] = exp(poses.upper[:, i])
    rotations = sign_continuous(rotations)
    rotations.flags.writeable = False  # so that the motion need not copy it
    return Motion(
        skeleton=skeleton,
        root_position=poses.center,
        rotations=rotations,
        fps=fps,
        contacts=poses.contacts,
        labels=_labels(walk, ground, times, recipe),
    )


def _labels(
    walk: PreparedWalk, ground: Ground, times: np.ndarray, recipe: dict[str, Any]
) -> Labels:
    plan = walk.plan
    if isinstance(plan, Timeline):
        step, phase = plan.position_at(times)
    else:
        step, phase = walk.clock.position(times)
        landed = times >= walk.clock.starts[-1] - 1e-9
        step = np.minimum(step + 2, len(plan.side) - 1)
        phase = np.where(landed, 1.0, phase)
    return Labels(
        phase=phase,
        step=step,
        footstep_side=plan.side,
        footstep_position=plan.position,
        footstep_heading=plan.heading,
        footstep_time=plan.time,
        ground=json.dumps(ground.as_json(), sort_keys=True),
        recipe=json.dumps(recipe, sort_keys=True),
        path=plan.path,
    )
