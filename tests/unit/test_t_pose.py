"""Rigs that rest in any pose, put into the T-pose: nothing moves, and a skin fits."""

from __future__ import annotations

import numpy as np
import pytest

import gaitsmith
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.rotations import about, exp, inverse, multiply, rotate
from gaitsmith.motion.kinematics import joint_positions, motion_kinematics
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import Skeleton
from gaitsmith.skin.t_pose import in_t_pose
from gaitsmith.viz.tracks import Tracks, tracks_of

UP = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def walk() -> Motion:
    return gaitsmith.walk(distance=3.0, gait="winter", fps=30.0)


def rebound(motion: Motion, seed: int, yaw: float = 0.0) -> Motion:
    """The same movement of a rig that rests anyhow, under a root on the floor, turned."""
    rng, old = np.random.default_rng(seed), motion.skeleton
    positions, world = motion_kinematics(motion)
    turn = about("y", yaw)
    positions, world = rotate(turn, positions), multiply(turn, world)
    bind = exp(rng.normal(0.0, 1.0, (len(old), 3)))
    world = multiply(world, inverse(bind))
    offsets = np.zeros((len(old) + 1, 3))
    offsets[1:] = rotate(bind[list(old.parents)], old.offsets)
    rotations = np.zeros((len(motion), len(old) + 1, 4))
    rotations[:, 0, 3] = 1.0
    rotations[:, 1] = world[:, 0]
    for joint in range(1, len(old)):
        rotations[:, joint + 1] = multiply(inverse(world[:, old.parents[joint]]), world[:, joint])
    translations = np.tile(offsets, (len(motion), 1, 1))
    translations[:, 1] = positions[:, 0]
    names = ("Reference", *old.names)
    rig = Skeleton(names, (-1, *(p + 1 for p in old.parents)), offsets)
    return Motion(rig, np.zeros((len(motion), 3)), rotations, motion.fps, translations=translations)


@pytest.mark.parametrize("seed", range(4))
def test_any_rest_pose_becomes_the_t_pose_and_no_joint_moves(walk, seed):
    yaw = 1.5 * seed
    rig = rebound(walk, seed, yaw)
    posed = in_t_pose(rig)
    skeleton = posed.skeleton
    assert skeleton.names[0] == "hips"
    assert len(skeleton) == len(walk.skeleton)
    expected = rotate(about("y", yaw), joint_positions(walk))
    np.testing.assert_allclose(joint_positions(rig)[:, 1:], expected, atol=1e-12)
    np.testing.assert_allclose(joint_positions(posed), expected, atol=1e-12)
    at = skeleton.rest_positions()
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        chains = {
            ("UpperArm", "LowerArm", "Hand"): [sign, 0.0, 0.0],
            ("UpperLeg", "LowerLeg", "Foot"): -UP,
        }
        for chain, way in chains.items():
            joints = at[[skeleton.index(side + name) for name in chain]]
            bones = np.diff(joints, axis=0)
            bones /= np.linalg.norm(bones, axis=1, keepdims=True)
            np.testing.assert_allclose(bones, [way, way], atol=1e-9)
        foot, toes = (at[skeleton.index(side + name)] for name in ("Foot", "Toes"))
        assert toes[2] - foot[2] > 0.05
        assert abs(toes[0] - foot[0]) < 1e-9
    assert sole_heights(posed).min() == pytest.approx(0.0, abs=1e-12)


def sole_heights(motion: Motion) -> np.ndarray:
    """Heights of heels and balls at rest."""
    at, soles = motion.skeleton.rest_positions(), motion.skeleton.soles
    feet = [motion.skeleton.index(f"{side}Foot") for side in SIDES]
    return at[feet, 1][:, None] + soles[:, :2, 1]


@pytest.mark.parametrize("seed", range(2))
def test_the_skin_of_any_rig_is_nearly_that_of_the_body(walk, seed):
    """Twists are guessed and girths go by another guess of the stature."""
    own, other = tracks_of(walk), tracks_of(rebound(walk, seed))
    assert other.figure.lasts != (None, None)
    assert other.stature == pytest.approx(own.stature, rel=0.03)
    for frame in (0, len(walk) // 2):
        a, b = (body(tracks, frame) for tracks in (own, other))
        away = np.linalg.norm(a - b, axis=1)
        assert away.mean() < 0.003
        assert away.max() < 0.01


def body(tracks: Tracks, frame: int) -> np.ndarray:
    """Vertices of all but the shoes, whose creases are where their sizes put them."""
    figure = tracks.figure
    shoes = [k for k, p in enumerate(figure.paints) if "hoe" in p.name or p.name == "outsole"]
    used = np.unique(figure.faces[~np.isin(figure.face_paints, shoes)])
    return figure.pose(tracks.positions[frame], tracks.world[frame])[0][used]


def test_facing_is_found_whatever_the_root_is(walk):
    turned = tracks_of(rebound(walk, 1, yaw=1.0))
    np.testing.assert_allclose(turned.heading, tracks_of(walk).heading + 1.0, atol=0.02)
    assert turned.distance == pytest.approx(tracks_of(walk).distance, rel=1e-6)


def test_what_rests_in_the_t_pose_or_is_no_person_is_left_alone(walk):
    same = in_t_pose(walk)
    assert same.skeleton.names == walk.skeleton.names
    np.testing.assert_array_equal(same.skeleton.offsets, walk.skeleton.offsets)
    np.testing.assert_array_equal(same.rotations, walk.rotations)
    assert same.labels is walk.labels
    chain = Skeleton(("a", "b"), (-1, 0), np.ones((2, 3)))
    thing = Motion(chain, np.zeros((3, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (3, 2, 1)), 30.0)
    assert in_t_pose(thing).skeleton.names == ("a", "b")
    assert in_t_pose(thing).rotations.shape == (3, 2, 4)


def test_a_moved_bone_stays_moved(walk):
    """Translations below the hips are carried over."""
    rig = rebound(walk, 5)
    moved = np.array(rig.translations)
    moved[:, -1] += np.linspace(0.0, 0.1, len(moved))[:, None]
    rig = rig.with_(translations=moved)
    np.testing.assert_allclose(
        joint_positions(in_t_pose(rig)), joint_positions(rig)[:, 1:], atol=1e-12
    )
    assert in_t_pose(rig).translations is not None
    assert in_t_pose(rebound(walk, 5)).translations is None
