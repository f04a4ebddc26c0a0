"""Parts of the body by role, and walks of different people brought to one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from people import person
from styles import apart, slide, synthetic

from gaitsmith.body.rig import skeleton_of
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.learn import standing_feet
from gaitsmith.gait.neutral import subject
from gaitsmith.motion.skeleton import Skeleton
from gaitsmith.style.examples import examples_of, karcher_mean
from gaitsmith.style.parts import PARTS, parts_of
from gaitsmith.style.retarget import on_body


def test_every_joint_but_the_root_is_of_one_part():
    skeleton = skeleton_of(person(1.75))
    parts = parts_of(skeleton)
    assert tuple(parts) == PARTS
    assert sorted(j for joints in parts.values() for j in joints) == list(range(1, len(skeleton)))
    assert [skeleton.names[j] for j in parts["left_arm"]] == [
        "leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand",
    ]  # fmt: skip


def test_parts_are_found_by_role_whatever_the_names():
    ours = skeleton_of(person(1.75))
    mixamo = {
        "hips": "Hips", "spine": "Spine", "chest": "Spine1", "upperChest": "Spine2",
        "neck": "Neck", "head": "Head",
    }  # fmt: skip
    bones = {
        "Shoulder": "Shoulder", "UpperArm": "Arm", "LowerArm": "ForeArm", "Hand": "Hand",
        "UpperLeg": "UpLeg", "LowerLeg": "Leg", "Foot": "Foot", "Toes": "ToeBase",
    }  # fmt: skip
    names = [
        mixamo.get(n)
        or f"{n[: 4 if n.startswith('left') else 5].capitalize()}"
        f"{bones[n.removeprefix('left').removeprefix('right')]}"
        for n in ours.names
    ]
    other = Skeleton(
        (*names, "LeftHandThumb1"), (*ours.parents, ours.index("leftHand")),
        np.concatenate([ours.offsets, [[0.02, 0.0, 0.03]]]),
    )  # fmt: skip
    found = parts_of(other)
    assert found["left_leg"] == parts_of(ours)["left_leg"]
    assert found["left_arm"] == (*parts_of(ours)["left_arm"], len(ours))  # the thumb goes along


def test_roles_that_are_missing_are_named():
    skeleton = skeleton_of(person(1.75))
    arms = ("Shoulder", "UpperArm", "LowerArm", "Hand")
    keep = [j for j, n in enumerate(skeleton.names) if not n.endswith(arms)]
    legs_only = Skeleton(
        tuple(skeleton.names[j] for j in keep),
        tuple(-1 if j == 0 else keep.index(skeleton.parents[j]) for j in keep),
        skeleton.offsets[keep],
        soles=skeleton.soles,
    )
    cycle = synthetic(0)
    index = [cycle.skeleton.index(n) for n in legs_only.names]
    bare = cycle.with_(skeleton=legs_only, rotations=cycle.rotations[:, index])
    with pytest.raises(InfeasibleError, match=r"'bare'.*lacks.*leftUpperArm.*rightHand"):
        examples_of({"whole": cycle, "bare": bare}, subject())


def test_a_walk_of_the_same_body_is_left_alone():
    cycle = synthetic(2)
    assert on_body(cycle, subject()) is cycle


@pytest.mark.parametrize("height", [1.2, 1.6, 2.1])
@pytest.mark.parametrize("seed", [0, 4])
def test_a_walk_of_another_body_keeps_its_angles_and_its_feet(height, seed):
    cycle, body = synthetic(seed), person(height)
    moved = on_body(cycle, body)
    assert apart(moved.rotations, cycle.rotations).max() < 1e-12
    assert standing_feet(moved).height == pytest.approx(0.0, abs=1e-9)
    froude = moved.speed**2 / body.leg_length
    assert froude == pytest.approx(cycle.speed**2 / subject().leg_length, rel=0.1)
    # feet that stand still to the proportions of both
    assert slide(moved, until="heel_off") < 0.04 * body.leg_length


def test_another_number_of_spine_joints_shares_the_turn():
    cycle = synthetic(5)
    body = replace(subject(), spine_segments=1)
    moved = on_body(cycle, body)
    chest = cycle.at(np.array([0.3]))[1]
    from gaitsmith.motion.kinematics import forward_kinematics

    _, world = forward_kinematics(cycle.skeleton, np.zeros((1, 3)), chest)
    _, other = forward_kinematics(moved.skeleton, np.zeros((1, 3)), moved.at(np.array([0.3]))[1])
    a, b = cycle.skeleton.index("head"), moved.skeleton.index("head")
    assert apart(world[0, a], other[0, b]) < 1e-3


def test_the_mean_rotation_is_karchers():
    keys = synthetic(1).rotations
    mean = karcher_mean(keys)
    from gaitsmith.geometry.rotations import inverse, log, multiply

    assert np.abs(log(multiply(inverse(mean), keys)).mean(0)).max() < 1e-14
    # signs of quaternions do not matter
    signs = np.where(np.random.default_rng(0).random(keys.shape[:2]) < 0.5, -1.0, 1.0)
    assert apart(karcher_mean(keys * signs[..., None]), mean).max() < 1e-12


def test_nothing_to_mix_is_refused():
    with pytest.raises(InvalidInputError, match="at least one"):
        examples_of({}, subject())
