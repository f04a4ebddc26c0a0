"""Forward kinematics against a slow loop of 4 x 4 matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitsmith.errors import InvalidInputError
from gaitsmith.motion.kinematics import (
    forward_kinematics,
    joint_positions,
    motion_kinematics,
    sole_positions,
)
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import HUMANOID, Skeleton

SEEDS = st.integers(0, 2**32 - 1)
fast = settings(max_examples=30, deadline=None)


def random_tree(seed: int, joints: int) -> Skeleton:
    rng = np.random.default_rng(seed)
    parents = [-1, *(int(rng.integers(0, joint)) for joint in range(1, joints))]
    names = [f"joint{i}" for i in range(joints)]
    return Skeleton(tuple(names), tuple(parents), rng.normal(size=(joints, 3)))


def humanoid(seed: int, *, toes: bool = True) -> Skeleton:
    rng = np.random.default_rng(seed)
    pairs = [(n, p) for n, p in HUMANOID if toes or not n.endswith("Toes")]
    names = [name for name, _ in pairs]
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent in pairs)
    soles = rng.normal(size=(2, 3, 3))
    return Skeleton(tuple(names), parents, rng.normal(size=(len(names), 3)), soles)


def random_motion(skeleton: Skeleton, seed: int, *, translations: bool, frames: int = 4) -> Motion:
    rng = np.random.default_rng(seed)
    shape = (frames, len(skeleton))
    return Motion(
        skeleton=skeleton,
        root_position=rng.normal(size=(frames, 3)),
        rotations=Rotation.random(frames * shape[1], rng=seed).as_quat().reshape(*shape, 4),
        fps=60.0,
        translations=rng.normal(size=(*shape, 3)) if translations else None,
    )


def slow_frames(motion: Motion) -> np.ndarray:
    """World matrices (F, J, 4, 4), one joint of one frame at a time."""
    skeleton = motion.skeleton
    world = np.zeros((len(motion), len(skeleton), 4, 4))
    for frame in range(len(motion)):
        for joint, parent in enumerate(skeleton.parents):
            local = np.eye(4)
            local[:3, :3] = Rotation.from_quat(motion.rotations[frame, joint]).as_matrix()
            if parent < 0:
                local[:3, 3] = motion.root_position[frame]
                world[frame, joint] = local
                continue
            moved = motion.translations
            local[:3, 3] = skeleton.offsets[joint] if moved is None else moved[frame, joint]
            world[frame, joint] = world[frame, parent] @ local
    return world


@fast
@given(SEEDS, st.integers(1, 12), st.booleans())
def test_forward_kinematics_is_the_product_of_matrices(seed, joints, translations):
    motion = random_motion(random_tree(seed, joints), seed, translations=translations)
    want = slow_frames(motion)
    positions, world = motion_kinematics(motion)

    np.testing.assert_allclose(positions, want[..., :3, 3], atol=1e-12)
    turned = Rotation.from_quat(world.reshape(-1, 4)).as_matrix().reshape(want[..., :3, :3].shape)
    np.testing.assert_allclose(turned, want[..., :3, :3], atol=1e-12)
    np.testing.assert_array_equal(joint_positions(motion), positions)


def test_translations_equal_to_the_offsets_change_nothing():
    skeleton = random_tree(3, 8)
    motion = random_motion(skeleton, 3, translations=False)
    same = np.broadcast_to(skeleton.offsets, (len(motion), 8, 3))
    want = forward_kinematics(skeleton, motion.root_position, motion.rotations)
    got = forward_kinematics(skeleton, motion.root_position, motion.rotations, same)
    np.testing.assert_allclose(got[0], want[0], atol=1e-12)
    np.testing.assert_array_equal(got[1], want[1])


def test_identity_rotations_show_the_rest_pose():
    skeleton = humanoid(0)
    rest = np.zeros((2, len(skeleton), 4)) + [0.0, 0.0, 0.0, 1.0]
    root = np.broadcast_to(skeleton.offsets[0], (2, 3))
    positions, world = forward_kinematics(skeleton, root, rest)
    np.testing.assert_allclose(positions[1], skeleton.rest_positions(), atol=1e-12)
    np.testing.assert_array_equal(world, rest)


@fast
@given(SEEDS, st.booleans(), st.booleans())
def test_soles_hang_on_foot_and_toes(seed, toes, translations):
    skeleton = humanoid(seed, toes=toes)
    motion = random_motion(skeleton, seed, translations=translations)
    world = slow_frames(motion)
    soles = sole_positions(skeleton, *motion_kinematics(motion))

    for side, name in enumerate(("left", "right")):
        for point, part in enumerate(("Foot", "Foot", "Toes" if toes else "Foot")):
            frame = world[:, skeleton.index(name + part)]
            want = frame @ np.append(skeleton.soles[side, point], 1.0)
            np.testing.assert_allclose(soles[:, side, point], want[:, :3], atol=1e-12)


def test_a_skeleton_without_soles_says_so():
    skeleton = random_tree(0, 3)
    motion = random_motion(skeleton, 0, translations=False)
    with pytest.raises(InvalidInputError, match="no sole points"):
        sole_positions(skeleton, *motion_kinematics(motion))


def test_no_frames_are_no_positions():
    skeleton = random_tree(0, 3)
    positions, world = forward_kinematics(skeleton, np.zeros((0, 3)), np.zeros((0, 3, 4)))
    assert positions.shape == (0, 3, 3)
    assert world.shape == (0, 3, 4)
