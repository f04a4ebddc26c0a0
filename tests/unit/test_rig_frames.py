"""A person is the same on any rig: lengths, pose and walk do not depend on a joint's axes."""

from __future__ import annotations

import numpy as np
import pytest
from puppet import Puppet
from rigs import (
    a_pose,
    apart,
    bare,
    cycle_angles,
    events_apart,
    in_a_mirror,
    moved,
    nonsense_axes,
    rest_turned,
    rms,
    with_offsets,
    without,
)
from scipy.spatial.transform import Rotation

from gaitsmith.conventions import SIDES, UP
from gaitsmith.gait.learn import learn_cycle
from gaitsmith.gait.person import person_of
from gaitsmith.gait.rig_frames import Rig, bone_frames, frame, still_frames
from gaitsmith.geometry.rotations import multiply, rotate
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.pipeline import walk

LENGTHS = ("thigh", "shin", "hip_width", "trunk", "neck", "shoulder_width", "upper_arm", "forearm")
RIGS = {
    "nonsense axes": nonsense_axes,
    "other nonsense axes": lambda m: nonsense_axes(m, 2),
    "A-pose": a_pose,
    "arms down": lambda m: a_pose(m, 85.0),
    "rest faces back": lambda m: rest_turned(m, "y", 180.0),
    "rest faces aside": lambda m: rest_turned(m, "y", 90.0),
    "rest lies down": lambda m: rest_turned(m, "x", -90.0),
    "far away, another way": lambda m: moved(m, 137.0, [40.0, 0.0, -300.0]),
}


@pytest.fixture(scope="module")
def clip():
    return bare(walk(distance=6.0, fps=60, toe_out=(0.02, 0.2), step_width=0.14))


@pytest.fixture(scope="module")
def found(clip):
    return learn_cycle(person_of(clip))


@pytest.mark.parametrize("name", RIGS)
def test_the_rig_does_not_matter(name, clip, found):
    """THE law of learning: what is learned is the person's, not the rig's."""
    other = learn_cycle(person_of(RIGS[name](clip)))
    for length in LENGTHS:
        assert getattr(other.body, length) == pytest.approx(
            getattr(found.body, length), abs=1e-6
        ), length
    for part in ("ankle_height", "heel", "ball", "toes"):
        assert getattr(other.body.foot, part) == pytest.approx(
            getattr(found.body.foot, part), abs=1e-4
        ), part
    one, two = found.cycle, other.cycle
    assert np.abs(events_apart(one, two)).max() < 1e-3
    assert two.duration == pytest.approx(one.duration, abs=1e-6)
    assert two.stride_length == pytest.approx(one.stride_length, abs=1e-4)
    np.testing.assert_allclose(other.step_lengths, found.step_lengths, atol=1e-4)
    assert other.step_width == pytest.approx(found.step_width, abs=1e-4)
    np.testing.assert_allclose(other.toe_out, found.toe_out, atol=1e-3)
    error = apart(cycle_angles(one), cycle_angles(two))
    if "nonsense" in name:  # such a rest pose does not tell how the pelvis is tipped
        tilt = error[..., 0].mean()
        assert abs(tilt) < 8.0
        error[..., 0] -= tilt
    assert np.abs(error).max() < 0.1


def test_a_rig_seen_in_a_mirror(clip, found):
    other = learn_cycle(person_of(in_a_mirror(clip)))
    assert other.step_width == pytest.approx(found.step_width, abs=2e-3)
    np.testing.assert_allclose(other.toe_out, found.toe_out[::-1], atol=2e-3)
    np.testing.assert_allclose(other.step_lengths, found.step_lengths[::-1], atol=2e-3)


@pytest.mark.parametrize("fps", [24.0, 30.0, 50.0, 120.0])
def test_the_frame_rate_hardly_matters(fps, found):
    other = learn_cycle(
        person_of(bare(walk(distance=6.0, fps=fps, toe_out=(0.02, 0.2), step_width=0.14)))
    )
    assert np.abs(events_apart(found.cycle, other.cycle)).max() < 2.0 / 60.0
    assert other.cycle.stride_length == pytest.approx(found.cycle.stride_length, abs=2e-3)
    assert rms(apart(cycle_angles(found.cycle), cycle_angles(other.cycle))) < 1.0


@pytest.mark.parametrize("name", RIGS)
def test_legs_turn_as_the_puppets_do(name):
    """Not only the joints are where they were: thigh, shin and foot face as they did."""
    clip = bare(Puppet().clip(3.0))
    motion = person_of(RIGS[name](clip)).motion
    for side in SIDES:
        for part in ("LowerLeg", "Foot"):
            own, true = (m.rotations[:, m.skeleton.index(side + part)] for m in (motion, clip))
            apart_by = 2.0 * np.arccos(np.clip(np.abs((own * true).sum(-1)), 0.0, 1.0))
            assert np.degrees(apart_by).max() < 3.0, side + part


def test_who_leans_leans_on_every_rig():
    """The trunk follows the line of its joints, where the rest pose tells nothing."""
    clip = Puppet().clip(3.0)
    q = np.array(clip.rotations)
    lean = np.radians(15.0)
    spine = clip.skeleton.index("spine")
    q[:, spine] = multiply(q[:, spine], Rotation.from_euler("x", lean).as_quat())
    clip = bare(clip.with_(rotations=q))
    for rig in (clip, nonsense_axes(clip)):
        person = person_of(rig)
        places = joint_positions(person.motion)
        index = person.motion.skeleton.index
        line = (places[:, index("neck")] - places[:, 0]).mean(0)
        shown = np.arctan2(line[2], line[1])
        seen = joint_positions(clip)
        wanted = (seen[:, clip.skeleton.index("neck")] - seen[:, 0]).mean(0)
        assert np.degrees(shown) == pytest.approx(np.degrees(np.arctan2(*wanted[2:0:-1])), abs=4.0)


def test_who_walks_on_the_toes_shows_the_sole_at_rest():
    clip = bare(Puppet(strike=-15.0, level=-25.0, push=60.0).clip(3.0))
    body = person_of(clip).body
    assert body.foot.ankle_height == pytest.approx(0.06825, abs=2e-3)
    found = learn_cycle(person_of(clip))
    assert found.body.foot.heel == pytest.approx(person_of(clip).body.foot.heel)


def test_a_still_foot_is_low_and_slow():
    clip = Puppet().clip(4.0)
    roles = humanoid_roles(clip.skeleton.names, clip.skeleton.parents).joints
    rig = Rig(clip, roles)
    for side, name in enumerate(SIDES):
        own = Puppet().own(clip.times, side)[1]
        still = still_frames(rig, name)
        assert still.sum() >= 3
        assert (own[still] < 0.62).all()
    frames = bone_frames(rig)
    for name in SIDES:
        up = rotate(multiply(rig.turn(f"{name}Foot"), frames[f"{name}Foot"]), UP)
        assert up[still_frames(rig, name), 1].min() > 0.99


def test_toes_that_lie_on_the_foot_are_none():
    clip = bare(Puppet().clip(3.0))
    zero = dict.fromkeys(("leftToes", "rightToes"), np.zeros(3))
    person = person_of(with_offsets(clip, **zero))
    assert not {"leftToes", "rightToes"} & set(person.roles)
    found = learn_cycle(person)
    assert found.cycle.stride_length == pytest.approx(1.3, abs=2e-3)


@pytest.mark.parametrize(
    "parts", [("Toes",), ("Arm", "Hand"), ("head", "neck"), ("Hand",), ("Toes", "Shoulder", "Arm")]
)
def test_what_a_rig_lacks_is_filled_in(parts):
    parts = (*parts, "Hand", "Shoulder") if "Arm" in parts else parts
    found = learn_cycle(person_of(without(bare(Puppet().clip(4.0)), *parts)))
    assert found.cycle.stride_length == pytest.approx(1.3, abs=5e-3)
    np.testing.assert_allclose(found.step_lengths, [0.65, 0.65], atol=5e-3)


def test_legs_alone_are_enough():
    above = ("spine", "chest", "Chest", "neck", "head", "Shoulder", "Arm", "Hand")
    found = learn_cycle(person_of(without(bare(Puppet().clip(4.0)), *above)))
    assert found.cycle.stride_length == pytest.approx(1.3, abs=5e-3)


def test_frame_is_a_rotation_with_the_axes_asked_for():
    q = frame((1, np.array([0.0, 2.0, 0.0])), (2, np.array([0.3, 0.5, 0.4])))
    np.testing.assert_allclose(rotate(q, UP), UP, atol=1e-12)
    np.testing.assert_allclose(rotate(q, np.array([0.0, 0.0, 1.0])), [0.6, 0.0, 0.8], atol=1e-12)
