"""Motions put on other rigs, in other places, cut and spoiled; and how learned gaits differ."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from gaitsmith.conventions import SIDES
from gaitsmith.geometry.rotations import about, inverse, multiply, rotate
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import Skeleton

ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")


def other_side(name):
    for side, opposite in (SIDES, SIDES[::-1]):
        if name.startswith(side):
            return opposite + name.removeprefix(side)
    return name


def bare(motion):
    """Only what a file of somebody else's would have."""
    skeleton = replace(motion.skeleton, soles=None)
    return Motion(skeleton, motion.root_position, motion.rotations, motion.fps)


def rerigged(motion, change):
    """The same joints in the same places, but the axes of joint j turned by ``change[j]``."""
    skeleton = motion.skeleton
    offsets, q = np.array(skeleton.offsets), np.array(motion.rotations)
    for joint, parent in enumerate(skeleton.parents):
        q[:, joint] = multiply(q[:, joint], change[joint])
        if parent >= 0:
            back = inverse(change[parent])
            offsets[joint] = rotate(back, offsets[joint])
            q[:, joint] = multiply(back, q[:, joint])
    ends = None
    if skeleton.ends is not None:
        ends = rotate(inverse(change), skeleton.ends)
    rig = Skeleton(skeleton.names, skeleton.parents, offsets, ends=ends)
    return Motion(rig, motion.root_position, q, motion.fps)


def nonsense_axes(motion, seed=1):
    """A rig whose rest pose nobody can take."""
    count = len(motion.skeleton)
    return rerigged(motion, Rotation.random(count, random_state=seed).as_quat())


def a_pose(motion, degrees=45.0):
    """Arms down at rest."""
    change = np.tile([0.0, 0.0, 0.0, 1.0], (len(motion.skeleton), 1))
    for joint, name in enumerate(motion.skeleton.names):
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
            if name.startswith(side) and name.removeprefix(side) in ARM[1:]:
                change[joint] = about("z", sign * np.radians(degrees))
    return rerigged(motion, change)


def rest_turned(motion, axis, degrees):
    """A rig whose rest pose is turned: it faces elsewhere or lies on its back."""
    turn = about(axis, np.radians(degrees))
    return rerigged(motion, np.tile(turn, (len(motion.skeleton), 1)))


def moved(motion, degrees, place):
    """The same walk, elsewhere and another way."""
    turn = about("y", np.radians(degrees))
    q = np.array(motion.rotations)
    q[:, 0] = multiply(turn, q[:, 0])
    root = rotate(turn, motion.root_position) + place
    return motion.with_(root_position=root, rotations=q)


def in_a_mirror(motion):
    other = [motion.skeleton.index(other_side(n)) for n in motion.skeleton.names]
    return motion.with_(
        root_position=motion.root_position * [-1.0, 1.0, 1.0],
        rotations=motion.rotations[:, other] * [1.0, -1.0, -1.0, 1.0],
    )


def without(motion, *parts):
    """The rig without the joints whose names hold one of ``parts``; children must go too."""
    old = motion.skeleton
    keep = [j for j, n in enumerate(old.names) if not any(part in n for part in parts)]
    rig = Skeleton(
        tuple(old.names[j] for j in keep),
        tuple(-1 if old.parents[j] < 0 else keep.index(old.parents[j]) for j in keep),
        old.offsets[keep],
    )
    return Motion(rig, motion.root_position, motion.rotations[:, keep], motion.fps)


def with_offsets(motion, **offsets):
    """The rig with other bones."""
    table = np.array(motion.skeleton.offsets)
    for name, offset in offsets.items():
        table[motion.skeleton.index(name)] = offset
    return motion.with_(skeleton=replace(motion.skeleton, offsets=table))


def cut(motion, first, last):
    """Frames from ``first`` to ``last`` seconds."""
    a, b = round(first * motion.fps), round(last * motion.fps) + 1
    return motion.with_(
        root_position=motion.root_position[a:b],
        rotations=motion.rotations[a:b],
        translations=None if motion.translations is None else motion.translations[a:b],
        contacts=None,
        labels=None,
    )


def every(motion, nth):
    return motion.with_(
        root_position=motion.root_position[::nth],
        rotations=motion.rotations[::nth],
        fps=motion.fps / nth,
    )


def leg_angles(skeleton, positions, world, soles):
    """Hip against the pelvis, knee and ankle: ``(F, 2, 3)`` degrees, sagittal."""
    up = rotate(world[:, 0], np.array([0.0, 1.0, 0.0]))
    tilt = np.arctan2(up[:, 2], up[:, 1])
    out = []
    for side, name in enumerate(SIDES):
        hip, knee, ankle = (
            positions[:, skeleton.index(name + part)] for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        thigh, shin = knee - hip, ankle - knee
        swing = np.arctan2(thigh[:, 2], -thigh[:, 1])
        flexion = np.arctan2(np.linalg.norm(np.cross(thigh, shin), axis=-1), (thigh * shin).sum(-1))
        sole = soles[:, side, 1] - soles[:, side, 0]
        ahead = np.hypot(sole[:, 0], sole[:, 2]) * np.sign(sole[:, 2])
        pitch = np.arctan2(sole[:, 1], ahead)
        out.append(np.stack([swing + tilt, flexion, pitch - (swing - flexion)], axis=-1))
    return np.degrees(np.stack(out, axis=1))


def cycle_angles(cycle, count=100):
    """Leg angles over a stride."""
    phase = np.arange(count) / count
    center, q = cycle.at(phase)
    center = center + phase[:, None] * [0.0, 0.0, cycle.stride_length]
    positions, world = forward_kinematics(cycle.skeleton, center, q)
    soles = sole_positions(cycle.skeleton, positions, world)
    return leg_angles(cycle.skeleton, positions, world, soles)


def apart(one, two):
    """Angles between angles, degrees."""
    return (one - two + 180.0) % 360.0 - 180.0


def rms(values):
    return float(np.sqrt((np.asarray(values) ** 2).mean()))


def events_apart(one, two):
    """Seconds between the events of two cycles, ``(2, 4)``."""
    return (((one.events - two.events) + 0.5) % 1.0 - 0.5) * one.duration
