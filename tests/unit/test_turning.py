"""What a turn does to pelvis, trunk, head and arms."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from people import person

from gaitsmith.body.rig import spine_names
from gaitsmith.geometry.rotations import exp, multiply, rotate
from gaitsmith.motion.kinematics import motion_kinematics
from gaitsmith.pipeline import walk
from gaitsmith.plan.paths import Path
from gaitsmith.synthesis.overlay import upper_joints
from gaitsmith.synthesis.turning import Turning, bend_upper

BODY = person(1.75)
NAMES = upper_joints(BODY)
COUNT = len(spine_names(BODY.spine_segments))
NEUTRAL, WINTER = "neutral", "winter"


def poses(count=50, seed=3):
    rng = np.random.default_rng(seed)
    return rng.normal(0.0, 0.05, (count, len(NAMES), 3)), rng.normal(0.0, 0.05, (count, 3))


def yaw(pelvis, upper, joints):
    q = exp(pelvis)
    for i in range(joints):
        q = multiply(q, exp(upper[:, i]))
    ahead = rotate(q, np.array([0.0, 0.0, 1.0]))
    return np.arctan2(ahead[:, 0], ahead[:, 2])


def turning(count=50, gaze=0.0, roll=0.0, bend=0.0):
    return Turning(*(np.full(count, v) for v in (gaze, roll, bend)))


def bent(upper, pelvis, turn, middle):
    out, turned = np.array(upper), np.array(pelvis)
    bend_upper(BODY, out, turned, turn, middle)
    return out, turned


def test_without_a_turn_nothing_changes():
    upper, pelvis = poses()
    same = bent(upper, pelvis, turning(), upper[0])
    np.testing.assert_array_equal(same[0], upper)
    np.testing.assert_array_equal(same[1], pelvis)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_in_a_tight_turn_the_face_keeps_to_where_it_looks(side):
    upper, pelvis = poses()
    out, turned = bent(upper, pelvis, turning(gaze=side * 0.2, bend=side), None)
    swung, held = (yaw(*p, COUNT + 2) for p in ((pelvis, upper), (turned, out)))
    assert np.abs(held - side * 0.2).max() < 0.25 * np.abs(swung).max()
    # the trunk goes on as it did, but for the share of the gaze
    chest, now = (yaw(*p, COUNT) for p in ((pelvis, upper), (turned, out)))
    assert np.abs(now - chest - side * 0.02).max() < 0.01


def test_the_arm_outside_swings_more_and_the_one_inside_less():
    upper, pelvis = poses()
    middle = np.full(upper.shape[1:], 0.1)
    out, _ = bent(upper, pelvis, turning(bend=1.0), middle)
    half = 0.5 * BODY.shoulder_width
    for name, share in (("left", 1.0 - half), ("right", 1.0 + half)):
        i = NAMES.index(f"{name}UpperArm")
        swing = upper[:, i] - middle[i]
        np.testing.assert_allclose(out[:, i] - middle[i], share * swing, atol=1e-12)


@cache
def circled(gait):
    return walk(path=Path.arc(1.0, 2.0 * np.pi), gait=gait, start="walk", stop="walk")


@pytest.mark.parametrize("gait", [NEUTRAL, WINTER])
def test_on_a_circle_arms_swing_as_far_as_their_side_gets(gait):
    motion = circled(gait)
    positions, _ = motion_kinematics(motion)
    index = motion.skeleton.index
    swing = []
    for side in ("left", "right"):
        arm = positions[:, index(f"{side}LowerArm")] - positions[:, index(f"{side}UpperArm")]
        across = positions[:, index("leftUpperArm")] - positions[:, index("rightUpperArm")]
        ahead = np.cross(across, [0.0, 1.0, 0.0])
        ahead /= np.linalg.norm(ahead, axis=1)[:, None]
        angle = np.arctan2((arm * ahead).sum(1), -arm[:, 1])[60:-60]
        swing.append(np.ptp(angle))
    assert 0.55 < swing[0] / swing[1] < 0.85


@pytest.mark.parametrize("first", [0.0, 0.2, 0.4, 0.6])
def test_the_head_comes_out_of_a_corner_without_overshoot(first):
    """Wherever the corner falls among the steps; 90 deg to the left."""
    path = Path.of_turns([(2.0 + first, 0.0), (0.6 * np.pi / 2.0, np.pi / 2.0), (2.5, 0.0)])
    motion = walk(path=path, start="walk", stop="walk", fps=60.0)
    _, world = motion_kinematics(motion)
    face = rotate(world[:, motion.skeleton.index("head")], np.array([0.0, 0.0, 1.0]))
    heading = np.degrees(np.unwrap(np.arctan2(face[:, 0], face[:, 2])))
    straight = np.abs(heading[:60]).max()
    assert heading.max() < 90.0 + straight + 1.5
