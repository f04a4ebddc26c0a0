"""Any rig in the T-pose: the same motion of a skeleton that a skin can be fitted to.

What pose a rig rests in is its maker's business: all bones along one axis, legs astride, a
scan of the actor. A skin wants arms out, legs down and unturned joints. So the rig is posed
like that - turned to face +Z from the frame in which it stands straightest, then every bone
by the least rotation that brings it where it belongs, which keeps its natural twist - and
what each joint was turned by is taken out of the motion. No joint moves by it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.rotations import about, between, inverse, multiply, rotate
from gaitsmith.motion.kinematics import motion_kinematics
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.motion.skeleton import Skeleton
from gaitsmith.skin.measures import Measures

if TYPE_CHECKING:
    from jaxtyping import Float

#: Bones of a person without which there is no T-pose.
NEEDED = ("hips", "neck", "head") + tuple(
    side + joint
    for side in SIDES
    for joint in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")
)
# A rest pose whose bones lean no more than this from the T-pose is left alone, radians.
_NEAR = 0.26


def renamed(skeleton: Skeleton) -> Skeleton:
    """The skeleton with VRM's names for the bones of a human, which joints then have alone."""
    found = humanoid_roles(skeleton.names, skeleton.parents, need=()).joints
    names = [f"{name} " if name in found else name for name in skeleton.names]
    for role, joint in found.items():
        names[joint] = role
    return replace(skeleton, names=tuple(names))


def in_t_pose(motion: Motion) -> Motion:
    """``motion`` of a skeleton with VRM names that rests in the T-pose, joints where they were.

    If the skeleton is a person's. One that rests in the T-pose already only gets the names;
    of any other, joints above the hips are dropped. What is no person comes back renamed
    where a name was known.
    """
    skeleton = renamed(motion.skeleton)
    motion = motion.with_(skeleton=skeleton)
    if len(motion) == 0 or any(name not in skeleton.names for name in NEEDED):
        return motion
    wanted = _directions(skeleton)
    if skeleton.soles is not None and _lean(skeleton, wanted) < _NEAR:
        return motion
    hips = skeleton.index("hips")
    keep = [hips]
    for joint in range(hips + 1, len(skeleton)):
        if skeleton.parents[joint] in keep:
            keep.append(joint)
    if any(skeleton.index(name) not in keep for name in NEEDED):
        return motion
    positions, world = motion_kinematics(motion)
    parents = tuple(-1 if j == hips else keep.index(skeleton.parents[j]) for j in keep)
    names = tuple(skeleton.names[j] for j in keep)
    rig = Skeleton(names, parents, skeleton.offsets[keep])
    ends = None if skeleton.ends is None else skeleton.ends[keep]
    return _turned(motion, rig, ends, positions[:, keep], world[:, keep])


def _directions(skeleton: Skeleton) -> dict[int, tuple[int, Float[np.ndarray, "3"]]]:
    """For every bone that has a place in the T-pose: its end and where it points there."""
    up = np.array([0.0, 1.0, 0.0])
    bones = [("neck", "head", up)]
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        out = np.array([sign, 0.0, 0.0])
        bones += [
            (f"{side}UpperArm", f"{side}LowerArm", out),
            (f"{side}LowerArm", f"{side}Hand", out),
        ]
        bones += [
            (f"{side}UpperLeg", f"{side}LowerLeg", -up),
            (f"{side}LowerLeg", f"{side}Foot", -up),
        ]
    return {
        skeleton.index(name): (skeleton.index(end), way)
        for name, end, way in bones
        if end in skeleton.names
    }


def _lean(skeleton: Skeleton, wanted: dict[int, tuple[int, Float[np.ndarray, "3"]]]) -> float:
    """Largest angle between a bone at rest and in the T-pose, radians."""
    at = skeleton.rest_positions()
    worst = 0.0
    for joint, (end, way) in wanted.items():
        bone = at[end] - at[joint]
        length = float(np.linalg.norm(bone))
        cosine = float(bone @ way) / length if length > 0.0 else 1.0
        worst = max(worst, float(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return worst


def _turned(
    motion: Motion,
    rig: Skeleton,
    ends: Float[np.ndarray, "joints 3"] | None,
    positions: Float[np.ndarray, "frames joints 3"],
    world: Float[np.ndarray, "frames joints 4"],
) -> Motion:
    """The motion of ``rig`` with these world positions and rotations, at rest in the T-pose."""
    frame = _straightest(rig, positions)
    turn = _turns(rig, positions, frame)
    bind = multiply(turn, world[frame])
    at = positions[frame]
    parents = np.array(rig.parents)
    bone = np.concatenate([np.zeros((1, 3)), at[1:] - at[parents[1:]]])
    offsets = np.concatenate([np.zeros((1, 3)), rotate(turn[parents[1:]], bone[1:])])
    now = multiply(world, inverse(bind))
    local = np.concatenate([now[:, :1], multiply(inverse(now[:, parents[1:]]), now[:, 1:])], axis=1)
    moved = positions[:, 1:] - positions[:, parents[1:]]
    moved = rotate(inverse(now[:, parents[1:]]), moved)
    translations = np.concatenate([np.zeros((len(now), 1, 3)), moved], axis=1)
    is_rigid = np.abs(translations - offsets).max() < 1e-6
    ends = None if ends is None else rotate(bind, ends)
    return Motion(
        _shod(Skeleton(rig.names, rig.parents, offsets, ends=ends)),
        positions[:, 0],
        local,
        motion.fps,
        contacts=motion.contacts,
        translations=None if is_rigid else translations,
        labels=motion.labels,
    )


def _shod(skeleton: Skeleton) -> Skeleton:
    """The skeleton with soles guessed from its shins and feet, standing on them."""
    measures = Measures(skeleton)
    soles = np.empty((2, 3, 3))
    for side, last in enumerate(measures.lasts):
        assert last is not None  # feet are needed
        along = np.array([0.0, last.ball, last.length])
        soles[side] = last.place(np.stack([along, 0.0 * along, 0.0 * along], axis=1))
        toes = measures.find(f"{SIDES[side]}Toes")
        if toes is not None:
            soles[side, 2] -= skeleton.offsets[toes]
    offsets = np.array(skeleton.offsets)
    offsets[0] = [0.0, -measures.floor, 0.0]
    return replace(skeleton, offsets=offsets, soles=soles)


def _straightest(rig: Skeleton, positions: Float[np.ndarray, "frames joints 3"]) -> int:
    """The frame with legs, trunk and neck nearest to upright."""
    bones = [("hips", "neck"), ("neck", "head")]
    for side in SIDES:
        bones += [(f"{side}LowerLeg", f"{side}UpperLeg"), (f"{side}Foot", f"{side}LowerLeg")]
    total = np.zeros(len(positions))
    for low, high in bones:
        bone = positions[:, rig.index(high)] - positions[:, rig.index(low)]
        total += bone[:, 1] / np.maximum(np.linalg.norm(bone, axis=1), 1e-9)
    return int(np.argmax(total))


def _turns(
    rig: Skeleton, positions: Float[np.ndarray, "frames joints 3"], frame: int
) -> Float[np.ndarray, "joints 4"]:
    """World rotation of each joint from ``frame`` to the T-pose."""
    at, wanted = positions[frame], _directions(rig)
    left = at[rig.index("leftUpperLeg")] - at[rig.index("rightUpperLeg")]
    # face +Z, hip joints level, trunk upright
    facing = about("y", np.arctan2(left[2], left[0]))
    level = between(rotate(facing, left), np.array([1.0, 0.0, 0.0]))
    turn = np.empty((len(rig), 4))
    turn[0] = multiply(level, facing)
    spine = rotate(turn[0], at[rig.index("neck")] - at[0]) * [0.0, 1.0, 1.0]
    turn[0] = multiply(between(spine, np.array([0.0, 1.0, 0.0])), turn[0])
    for joint in range(1, len(rig)):
        turn[joint] = turn[rig.parents[joint]]
        for side in SIDES:
            if rig.names[joint] == f"{side}Foot":
                turn[joint] = _foot_turn(rig, positions, frame, side, turn[joint])
        if joint in wanted:
            end, way = wanted[joint]
            bone = rotate(turn[joint], at[end] - at[joint])
            turn[joint] = multiply(between(bone, way), turn[joint])
    return turn


def _foot_turn(
    rig: Skeleton,
    positions: Float[np.ndarray, "frames joints 3"],
    frame: int,
    side: str,
    turn: Float[np.ndarray, "4"],
) -> Float[np.ndarray, "4"]:
    """Rotation that makes a foot look ahead, pitched as it is when it stands."""
    if f"{side}Toes" not in rig.names:
        return turn
    foot, toes = rig.index(f"{side}Foot"), rig.index(f"{side}Toes")
    low = int(np.argmin(positions[:, foot, 1] + positions[:, toes, 1]))
    standing = positions[low, toes] - positions[low, foot]
    reach = float(np.hypot(standing[0], standing[2]))
    if reach < 1e-6:
        return turn
    bone = rotate(turn, positions[frame, toes] - positions[frame, foot])
    ahead = np.array([0.0, min(float(standing[1]), 0.0), reach])
    return multiply(between(bone, ahead), turn)
