"""The person in a clip: lengths of the rig, soles on the floor, or a clear refusal."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from puppet import BODY, Puppet
from rigs import bare, cut, with_offsets

from gaitsmith.conventions import SIDES
from gaitsmith.errors import GaitsmithError, InfeasibleError
from gaitsmith.gait.learn import body_in
from gaitsmith.gait.person import person_of
from gaitsmith.motion.kinematics import joint_positions, motion_kinematics, sole_positions
from gaitsmith.pipeline import walk


@pytest.fixture(scope="module")
def clip():
    return bare(Puppet().clip(4.0))


def test_the_body_is_the_puppets(clip):
    body = person_of(clip, name="somebody").body
    assert body.name == "somebody"
    for name in ("thigh", "shin", "hip_width", "trunk", "neck", "upper_arm", "forearm"):
        assert getattr(body, name) == pytest.approx(getattr(BODY, name), abs=1e-6), name
    for name in ("ankle_height", "ball", "toes"):
        assert getattr(body.foot, name) == pytest.approx(getattr(BODY.foot, name), abs=1e-3), name
    assert body.height == pytest.approx(BODY.height, abs=0.01)
    assert body_in(person_of(clip)).foot.heel == pytest.approx(BODY.foot.heel, abs=4e-3)


def test_the_joints_stay_where_they_are(clip):
    person = person_of(clip)
    ours, theirs = joint_positions(person.motion), joint_positions(clip)
    for name in ("LowerLeg", "Foot", "LowerArm", "Hand"):
        for side in SIDES:
            i, j = (m.skeleton.index(side + name) for m in (person.motion, clip))
            assert np.abs(ours[:, i] - theirs[:, j]).max() < 2e-3, side + name


@pytest.mark.parametrize("lift", [-1.0, -0.05, 1.0])
def test_the_floor_is_where_the_feet_stand(clip, lift):
    person = person_of(clip.with_(root_position=clip.root_position + [0.0, lift, 0.0]))
    positions, world = motion_kinematics(person.motion)
    soles = sole_positions(person.motion.skeleton, positions, world)
    assert abs(soles[..., :2, 1].min()) < 0.012
    assert person.body.foot.ankle_height == pytest.approx(BODY.foot.ankle_height, abs=2e-3)


def test_a_floor_that_rises_two_centimeters(clip):
    rising = np.linspace(0.0, 0.02, len(clip))[:, None] * [0.0, 1.0, 0.0]
    body = person_of(clip.with_(root_position=clip.root_position + rising)).body
    assert body.foot.ankle_height == pytest.approx(BODY.foot.ankle_height, abs=0.015)


def test_a_generated_walk_has_the_body_that_was_asked_for():
    for who in (1.3, "child", 2.0):
        motion = walk(distance=3.0, body=who, fps=60)
        offsets = motion.skeleton.offsets
        body = person_of(bare(motion)).body
        assert body.thigh == pytest.approx(
            -offsets[motion.skeleton.index("leftLowerLeg"), 1], abs=1e-6
        )


@pytest.mark.parametrize("scale", [0.3, 4.0, 100.0])
def test_nobody_is_that_size(clip, scale):
    giant = clip.with_(
        skeleton=replace(clip.skeleton, offsets=scale * clip.skeleton.offsets),
        root_position=scale * clip.root_position,
    )
    with pytest.raises(InfeasibleError, match=r"legs of .* m .* no person's; give the file's unit"):
        person_of(giant)


def test_one_frame_is_no_motion(clip):
    with pytest.raises(InfeasibleError, match="1 frames"):
        person_of(cut(clip, 0.0, 0.0))


@pytest.mark.parametrize(
    "bones",
    [
        {"leftLowerLeg": [0.0, 0.0, 0.0]},
        {"leftUpperLeg": [0.0, 0.0, 0.0], "rightUpperLeg": [0.0, 0.0, 0.0]},
        {"leftFoot": [0.0, 0.0, 0.0], "rightFoot": [0.0, 0.0, 0.0]},
    ],
)
def test_bones_of_no_length_are_refused(clip, bones):
    with pytest.raises(GaitsmithError, match=r"no person's"):
        person_of(with_offsets(clip, **bones))


def test_a_head_or_forearm_of_no_length_is_taken_from_tables(clip):
    zero = [0.0, 0.0, 0.0]
    person = person_of(with_offsets(clip, leftLowerArm=zero, head=zero, chest=zero))
    assert np.isfinite(person.motion.rotations).all()
    assert person.body.neck > 0.03


@pytest.mark.parametrize("first", [0, 100])
def test_a_t_pose_in_the_first_frame(clip, first):
    """Many files begin with one; it must not spoil what the walk tells."""
    q, root = np.array(clip.rotations[first:]), np.array(clip.root_position[first:])
    posed = np.tile([0.0, 0.0, 0.0, 1.0], (1, q.shape[1], 1))
    start = clip.with_(
        rotations=np.concatenate([posed, q]),
        root_position=np.concatenate([[[0.0, BODY.hip_height, 0.0]], root]),
    )
    body = person_of(start).body
    assert body.foot.ankle_height == pytest.approx(BODY.foot.ankle_height, abs=2e-3)
