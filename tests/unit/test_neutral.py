"""The built-in stride against the check values of its recipe."""

from __future__ import annotations

import json
from importlib.resources import files

import numpy as np
import pytest

import gaitsmith
from gaitsmith.gait.neutral import neutral_cycle
from gaitsmith.geometry.rotations import inverse, multiply
from gaitsmith.motion.kinematics import motion_kinematics
from gaitsmith.synthesis.gaits import neutral_step
from gaitsmith.walks.files import built_in

#: Degrees (mm for tx, ty, tz) at phases 0, .25, .5, .75 of the symmetric stride.
CHECKS = {
    "pelvis_tilt": (-1.16, 1.80, -1.16, 1.80),
    "pelvis_list": (-0.31, 2.71, 0.31, -2.71),
    "pelvis_rotation": (-1.51, -3.97, 1.51, 3.97),
    "pelvis_ty": (956.5, 983.1, 956.5, 983.1),
    "pelvis_tz": (15.5, -21.0, -15.5, 21.0),
    "pelvis_tx": (-14.7, 9.7, -14.7, 9.7),
    "lumbar_extension": (-6.36, -7.62, -6.36, -7.62),
    "lumbar_bending": (0.78, -3.01, -0.78, 3.01),
    "lumbar_rotation": (7.38, 2.30, -7.38, -2.30),
    "hip_flexion_l": (27.41, 10.71, -12.78, 18.82),
    "hip_adduction_l": (-0.38, 5.71, 3.23, -8.44),
    "knee_angle_l": (2.69, 19.05, 11.25, 72.16),
    "ankle_angle_l": (4.49, 8.91, 16.96, -4.05),
    "arm_flex_l": (-6.57, 1.25, 9.52, 2.72),
    "arm_add_l": (-4.59, -5.47, -9.51, -6.39),
    "arm_rot_l": (-24.37, -20.81, -7.56, -12.25),
    "elbow_flex_l": (33.77, 35.21, 54.15, 39.40),
}
#: Local quaternions at phase 0, arms relaxed.
ROTATIONS = {
    "hips": (0.0101, -0.0132, -0.0028, 0.9999),
    "spine": (0.0024, 0.0211, 0.0045, 0.9998),
    "leftUpperArm": (0.0807, 0.1566, -0.6599, 0.7304),
    "leftLowerArm": (0.0, -0.1630, 0.0, 0.9866),
    "rightUpperArm": (-0.0085, 0.0253, 0.6456, 0.7632),
    "rightLowerArm": (0.0, 0.3349, 0.0, 0.9422),
    "leftUpperLeg": (-0.2369, 0.0304, -0.0040, 0.9710),
    "leftFoot": (-0.0384, 0.0068, 0.0041, 0.9992),
}
MIRROR = np.array([1.0, -1.0, -1.0, 1.0])  # x -> -x


@pytest.fixture(scope="module")
def data():
    return json.loads(files("gaitsmith.data").joinpath("neutral.json").read_text("utf-8"))


def test_the_shipped_legs_are_those_that_the_fit_makes():
    """Else run tools/build_neutral_step.py."""
    made, shipped = neutral_step(), built_in("neutral_step")
    assert made.character.gains == pytest.approx(shipped.character.gains, abs=1e-4)
    for name, sequence in made.sequences.items():
        np.testing.assert_allclose(sequence.times, getattr(shipped, name).times, atol=1e-5)
        np.testing.assert_allclose(sequence.values, getattr(shipped, name).values, atol=1e-4)


@pytest.fixture(scope="module")
def motion():
    return gaitsmith.walk(distance=9.0, gait="neutral", speed=1.25, fps=100)


@pytest.mark.parametrize("column", CHECKS)
def test_columns_are_those_of_the_recipe(data, column):
    cosine, sine = map(np.array, data["symmetric"][column])
    turns = 2.0 * np.pi * np.arange(9) * np.array([0.0, 0.25, 0.5, 0.75])[:, None]
    values = np.cos(turns) @ cosine + np.sin(turns) @ sine
    place = column.startswith("pelvis_t") and column != "pelvis_tilt"
    values, within = (1e3 * values, 0.5) if place else (np.degrees(values), 0.2)
    np.testing.assert_allclose(values, CHECKS[column], atol=within)


@pytest.mark.parametrize("joint", ROTATIONS)
def test_rotations_are_those_of_the_recipe(joint):
    cycle = neutral_cycle()
    q = cycle.rotations[0, cycle.skeleton.index(joint)]
    np.testing.assert_allclose(q * np.sign(q[3]), ROTATIONS[joint], atol=0.003)


def test_the_symmetric_stride_is_its_own_mirror_image_half_a_stride_later():
    cycle = neutral_cycle()
    half = len(cycle.center) // 2
    index = cycle.skeleton.index
    for name in cycle.skeleton.names:
        other = name.replace("left", "#").replace("right", "left").replace("#", "right")
        here = cycle.rotations[:, index(name)]
        there = np.roll(cycle.rotations[:, index(other)], -half, axis=0) * MIRROR
        apart = multiply(inverse(here), there)[:, :3]
        assert np.abs(apart).max() < 1e-6, name


def test_the_raw_stride_keeps_the_mans_own_asymmetry():
    raw, even = neutral_cycle(symmetric=False), neutral_cycle()
    assert np.abs(np.abs((raw.rotations * even.rotations).sum(-1)) - 1.0).max() > 1e-3


def test_neutral_arms_swing_against_the_legs(motion):
    """24.6 +- 2.4 deg of upper arm swing in healthy men (docs/gaits/neutral.md)."""
    positions, _ = motion_kinematics(motion)
    index = motion.skeleton.index

    def pitch(top, bottom):
        bone = positions[150:-150, index(bottom)] - positions[150:-150, index(top)]
        return np.degrees(np.arctan2(bone[:, 2], -bone[:, 1]))

    for side in ("left", "right"):
        arm = pitch(f"{side}UpperArm", f"{side}LowerArm")
        leg = pitch(f"{side}UpperLeg", f"{side}LowerLeg")
        assert 15.0 < np.ptp(arm) < 40.0
        assert np.corrcoef(arm, leg)[0, 1] < -0.7


def test_neutral_pelvis_head_and_path_stay_in_human_bounds(motion):
    """Pelvis rotation 4-14, list 4-12 deg; rises 2-6 cm, sways 2-6 cm; head within 5 deg."""
    positions, world = motion_kinematics(motion)
    steady = slice(250, -300)  # steps grow before and shorten after
    index = motion.skeleton.index
    across = positions[steady, index("leftUpperLeg")] - positions[steady, index("rightUpperLeg")]
    turn = np.degrees(np.arctan2(-across[:, 2], across[:, 0]))
    tip = np.degrees(np.arctan2(across[:, 1], np.hypot(across[:, 0], across[:, 2])))
    assert 4.0 < np.ptp(turn) < 14.0
    assert 4.0 < np.ptp(tip) < 12.0
    assert 0.02 < np.ptp(motion.root_position[steady, 1]) < 0.06
    assert 0.02 < np.ptp(motion.root_position[steady, 0]) < 0.06
    head = world[steady, index("head")]
    assert np.degrees(2.0 * np.abs(head[:, 0])).max() < 5.0
