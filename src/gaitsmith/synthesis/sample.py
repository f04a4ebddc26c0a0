"""A prepared walk at a frame rate: the Motion with all its labels."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.body.rig import skeleton_of
from gaitsmith.contact.apply import local_legs
from gaitsmith.conventions import SIDES
from gaitsmith.geometry.rotations import exp
from gaitsmith.ground import Ground
from gaitsmith.motion.holding import frames_until
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.plan.timeline import Timeline, landing_at
from gaitsmith.synthesis.overlay import upper_joints

if TYPE_CHECKING:
    from typing import Any

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact.apply import Poses
    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.synthesis.step import PreparedWalk


#: Frames that are posed together: their numbers stay in the processor's cache. No power of two,
#: whose rows would compete for the same places in it.
BLOCK = 2000
#: Where the real parts of two unit quaternions are above this, they are in one half-sphere.
NEAR = 0.7072
#: Stands in a recipe for the JSON of the ground until that is put there.
_HERE = "\0ground"


def sample_walk(
    walk: PreparedWalk,
    body: Body,
    ground: Ground,
    *,
    fps: float,
    recipe: dict[str, Any],
    begin: float = 0.0,
) -> Motion:
    """Sample ``walk`` at ``fps`` frames per second from its first instant.

    The last frame is the last one that is not after the end of the walk. Everything is
    evaluated for all frames at once. The walk begins at the second ``begin``; until then it
    stands as it does in its first instant.
    """
    fps = positive("fps", fps, "frames per second")
    frames = frames_until(begin + walk.duration, fps)
    times = np.arange(frames) / fps
    skeleton = skeleton_of(body)
    root = np.empty((frames, 3))
    rotations = np.empty((frames, len(skeleton), 4))
    contacts = np.empty((frames, 2, 3), dtype=np.bool_)
    before = None
    for start in range(0, frames, BLOCK):
        rows = slice(start, min(start + BLOCK, frames))
        poses = walk.poses(np.clip(times[rows] - begin, 0.0, walk.duration))
        root[rows], contacts[rows] = poses.center, poses.contacts
        local = local_rotations(poses, body, skeleton)
        before = _keep_signs(local, before)
        rotations[rows] = local.transpose(2, 0, 1)
    for array in (root, rotations, contacts):
        array.flags.writeable = False  # so that the motion need not copy it
    return Motion(
        skeleton=skeleton,
        root_position=root,
        rotations=rotations,
        fps=fps,
        contacts=contacts,
        labels=_labels(walk, ground, times, recipe, begin),
    )


def local_rotations(
    poses: Poses, body: Body, skeleton: Skeleton
) -> Float[np.ndarray, "joints 4 F"]:
    """Joint to parent, frames last: what is next to each other is worked on together."""
    out = np.empty((len(skeleton), 4, len(poses.center)))
    out[0] = poses.pelvis.T
    legs = local_legs(poses)
    for side, name in enumerate(SIDES):
        for part, turned in legs.items():
            out[skeleton.index(f"{name}{part}")] = turned[:, side].T
    last = None
    for i, name in enumerate(upper_joints(body)):
        here, vector = out[skeleton.index(name)], poses.upper[:, i]
        # one frame tells nearly always
        if last is not None and (vector[0] == last[0][0]).all() and np.array_equal(vector, last[0]):
            here[:] = last[1]  # the joints of a spine share its turn
        elif vector[0].any() or vector.any():
            here[:] = exp(vector).T
            last = vector, here
        else:
            here[:3], here[3] = 0.0, 1.0
    return out


def _keep_signs(
    local: Float[np.ndarray, "joints 4 F"], before: Float[np.ndarray, "joints 4"] | None
) -> Float[np.ndarray, "joints 4"]:
    """Of q and -q, which are one rotation, the one nearer to the frame before; the last frame."""
    far = local[:, 3].min(axis=1) < NEAR
    if before is not None:
        far |= before[:, 3] < NEAR
    for joint in np.flatnonzero(far):
        q = local[joint]
        flip = np.zeros(q.shape[1], dtype=np.bool_)
        products = q[:, 1:] * q[:, :-1]
        flip[1:] = products[0] + products[1] + products[2] + products[3] < 0.0
        if before is not None:
            flip[0] = float(q[:, 0] @ before[joint]) < 0.0
        if flip.any():
            np.negative(q, out=q, where=np.cumsum(flip) % 2 == 1)
    return np.array(local[..., -1])


@lru_cache(maxsize=4)
def _ground_text(ground: Ground) -> str:
    """JSON of a ground; writing half a million heights takes longer than the walk over them."""
    return json.dumps(ground.as_json(), sort_keys=True)


def _recipe_text(recipe: dict[str, Any]) -> str:
    """JSON of a recipe, in which the ground of a walk may be a Ground."""
    walk = recipe.get("walk", {})
    ground = walk.get("ground")
    if not isinstance(ground, Ground):
        return json.dumps(recipe, sort_keys=True)
    text = json.dumps({**recipe, "walk": {**walk, "ground": _HERE}}, sort_keys=True)
    return text.replace(json.dumps(_HERE), _ground_text(ground), 1)


def _labels(
    walk: PreparedWalk, ground: Ground, times: np.ndarray, recipe: dict[str, Any], begin: float
) -> Labels:
    plan, landing = walk.plan, walk.plan.time
    if begin > 0.0:  # both initial feet stand from the first frame on
        landing = np.concatenate([landing[:2], landing[2:] + begin])
    if isinstance(plan, Timeline) or begin > 0.0:
        step, phase = landing_at(landing, times)
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
        footstep_time=landing,
        ground=_ground_text(ground),
        recipe=_recipe_text(recipe),
        path=plan.path,
    )
