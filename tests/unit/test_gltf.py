"""GLB files, read back by a parser of the tests' own: structure, kinematics, skin, extras."""

from __future__ import annotations

import json

import numpy as np
import pytest
from glb import Glb

import gaitsmith
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import about, exp
from gaitsmith.io.gltf import write_glb
from gaitsmith.motion.kinematics import joint_positions, motion_kinematics, sole_positions
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import Skeleton

BODIES = {"child": 1.2, "adult": 1.75, "tall": 2.05}


def written(motion, folder, **options):
    path = folder / "motion.glb"
    write_glb(motion, path, **options)
    return Glb(path.read_bytes())


@pytest.fixture(scope="module", params=BODIES)
def walked(request, tmp_path_factory):
    motion = gaitsmith.walk(distance=3.0, body=BODIES[request.param], fps=30.0)
    return motion, written(motion, tmp_path_factory.mktemp("glb"))


def robot(frames=4, **changes):
    """Three joints that are no person: one turns, one stands, one is turned for good."""
    skeleton = Skeleton(("base", "arm", "tip"), (-1, 0, 1), [[0, 0, 0], [0, 1, 0], [0.5, 0, 0]])
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 3, 1))
    rotations[:, 0] = about("y", 2.0 * np.arange(frames))
    rotations[:, 2] = about("x", np.full(frames, 0.3))
    facts = {"skeleton": skeleton, "root_position": np.zeros((frames, 3)), "fps": 10.0}
    return Motion(**{**facts, "rotations": rotations, **changes})


def test_joints_are_where_forward_kinematics_puts_them(walked):
    motion, glb = walked
    expected, names = joint_positions(motion), [node["name"] for node in glb.nodes]
    for frame in range(0, len(motion), 7):
        world = glb.world(frame)
        for joint, name in enumerate(motion.skeleton.names):
            at = world[names.index(name), :3, 3]
            np.testing.assert_allclose(at, expected[frame, joint], atol=1e-5, err_msg=name)


def test_nodes_stand_in_the_rest_pose_bound_where_they_stand(walked):
    motion, glb = walked
    skin, rest = glb.document["skins"][0], motion.skeleton.rest_positions()
    bind = glb.numbers(skin["inverseBindMatrices"]).reshape(-1, 4, 4)
    for joint, node in enumerate(skin["joints"]):
        assert glb.nodes[node]["name"] == motion.skeleton.names[joint]
        assert "rotation" not in glb.nodes[node]
        np.testing.assert_allclose(bind[joint, 3, :3], -rest[joint], atol=1e-6)
        np.testing.assert_array_equal(bind[joint, :3, :3], np.eye(3))


def test_mesh_and_armature_are_roots_and_mesh_is_skinned(walked):
    _, glb = walked
    roots = [glb.nodes[k] for k in glb.document["scenes"][0]["nodes"]]
    assert [node["name"] for node in roots] == ["Armature", "mannequin"]
    assert roots[1]["skin"] == roots[1]["mesh"] == 0
    assert [glb.nodes[k]["name"] for k in roots[0]["children"]] == ["hips"]


def test_soles_of_the_mesh_stand_on_the_ground_where_contacts_say(walked):
    """A point in contact is on the sole of the mesh, which is on the floor and not below."""
    motion, glb = walked
    soles = sole_positions(motion.skeleton, *motion_kinematics(motion))
    for frame in range(0, len(motion), 5):
        mesh = glb.skinned(frame)["outsole"]
        assert mesh[:, 1].min() > -2e-3
        for side, point in np.argwhere(motion.contacts[frame]):
            near = np.linalg.norm(mesh - soles[frame, side, point], axis=1).min()
            assert near < 2e-3, (frame, side, point)


def test_flat_foot_lies_flat(walked):
    motion, glb = walked
    flat = np.argwhere(motion.contacts.all(axis=2))
    frame, side = flat[len(flat) // 2]
    mesh = glb.skinned(frame)["outsole"]
    joint = joint_positions(motion)[frame, motion.skeleton.index(("left", "right")[side] + "Foot")]
    mine = mesh[np.abs(mesh[:, 0] - joint[0]) < 0.04 * motion.skeleton.offsets[0, 1] / 0.93]
    under = np.sort(mine[np.abs(mine[:, 2] - joint[2]) < 0.1, 1])
    assert (np.abs(under[: len(under) // 3]) < 2e-3).all()


def test_animation_is_ready_to_play(walked):
    motion, glb = walked
    for (name, what), (times, values) in glb.channels().items():
        assert times[0] == 0.0
        assert (np.diff(times) > 0.0).all()
        assert len(values) == len(times) in (1, len(motion))
        assert what == "rotation" or name == "hips"
        if what == "rotation":
            np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-6)
            assert values[0, 3] >= 0.0
            assert (np.einsum("ij,ij->i", values[1:], values[:-1]) > 0.0).all()
    moving = {name for name, _ in glb.channels()}
    assert {"hips", "leftLowerLeg", "rightUpperArm", "leftToes"} <= moving
    times = glb.channels()["hips", "translation"][0]
    assert times[-1] == pytest.approx(motion.duration, rel=1e-6)


def test_bounds_are_those_of_the_numbers(walked):
    _, glb = walked
    document = glb.document
    bounded = [p["attributes"]["POSITION"] for p in document["meshes"][0]["primitives"]]
    bounded += [s["input"] for s in document["animations"][0]["samplers"]]
    for accessor in bounded:
        numbers = glb.numbers(accessor).reshape(document["accessors"][accessor]["count"], -1)
        assert numbers.min(axis=0).tolist() == document["accessors"][accessor]["min"]
        assert numbers.max(axis=0).tolist() == document["accessors"][accessor]["max"]
    for view in document["bufferViews"]:
        assert view["byteOffset"] % 4 == 0


def test_extras_tell_contacts_footsteps_ground_and_recipe(walked):
    motion, glb = walked
    extras = glb.document["asset"]["extras"]["gaitsmith"]
    assert glb.document["asset"]["generator"] == f"gaitsmith {gaitsmith.__version__}"
    assert (extras["fps"], extras["frames"]) == (motion.fps, len(motion))
    back = np.zeros_like(motion.contacts)
    for k, word in enumerate(extras["contacts"]):
        for first, last in extras["contacts"][word]:
            back[first : last + 1, k // 3, k % 3] = True
    assert list(extras["contacts"])[:3] == ["leftHeel", "leftBall", "leftToe"]
    np.testing.assert_array_equal(back, motion.contacts)
    assert [s["side"] for s in extras["footsteps"]].count("left") == (
        motion.labels.footstep_side == 0
    ).sum()
    assert json.loads(extras["ground"])["kind"] == "flat"
    assert extras["recipe"] == motion.labels.recipe


def test_still_joints_have_no_channel_or_one_key(tmp_path):
    glb = written(robot(), tmp_path)
    channels = glb.channels()
    assert set(channels) == {("base", "rotation"), ("tip", "rotation")}
    assert len(channels["base", "rotation"][1]) == 4
    assert len(channels["tip", "rotation"][1]) == 1
    np.testing.assert_allclose(glb.world(2)[3, :3, 3], joint_positions(robot())[2, 2], atol=1e-6)


def test_quaternions_that_change_sign_are_made_continuous(tmp_path):
    motion = robot(40)
    flipped = motion.rotations * np.where(np.arange(40) % 3 == 1, -1.0, 1.0)[:, None, None]
    turns = written(robot(40, rotations=flipped), tmp_path).channels()["base", "rotation"][1]
    assert (np.einsum("ij,ij->i", turns[1:], turns[:-1]) > 0.0).all()


def test_translations_become_channels_where_they_move(tmp_path):
    translations = np.tile(robot().skeleton.offsets, (4, 1, 1))
    translations[:, 1, 1] += [0.0, 0.1, 0.2, 0.1]
    motion = robot(translations=translations)
    glb = written(motion, tmp_path)
    assert ("arm", "translation") in glb.channels()
    assert ("tip", "translation") not in glb.channels()
    for frame in range(4):
        np.testing.assert_allclose(
            glb.world(frame)[1:4, :3, 3], joint_positions(motion)[frame], atol=1e-6
        )


def test_a_motion_where_nothing_moves_has_no_animation(tmp_path):
    still = robot(3, rotations=np.tile([0.0, 0.0, 0.0, 1.0], (3, 3, 1)))
    assert "animations" not in written(still, tmp_path).document


def test_one_frame_is_one_key(tmp_path):
    glb = written(robot(1, root_position=[[1.0, 2.0, 3.0]]), tmp_path)
    np.testing.assert_allclose(glb.world(0)[1, :3, 3], [1.0, 2.0, 3.0])


@pytest.mark.parametrize("joints", [300, 256])
def test_many_joints(joints, tmp_path):
    names = tuple(f"j{k}" for k in range(joints))
    skeleton = Skeleton(names, tuple(range(-1, joints - 1)), np.tile([0, 0.01, 0], (joints, 1)))
    turns = exp(np.random.default_rng(0).normal(0.0, 0.01, (5, joints, 3)))
    motion = Motion(skeleton, np.zeros((5, 3)), turns, 30.0)
    glb = written(motion, tmp_path)
    world = glb.world(3)[1 : 1 + joints, :3, 3]
    np.testing.assert_allclose(world, joint_positions(motion)[3], atol=1e-5)
    kind = glb.document["accessors"][2]["componentType"]
    assert kind == (5121 if joints <= 256 else 5123)


def test_neutral_is_one_colour(tmp_path):
    glb = written(gaitsmith.walk(distance=2.0, fps=20.0), tmp_path, neutral=True)
    assert [m["name"] for m in glb.document["materials"]] == ["wood"]


def test_no_frames_are_refused(tmp_path):
    with pytest.raises(InvalidInputError, match="no frames"):
        write_glb(robot(0), tmp_path / "a.glb")
