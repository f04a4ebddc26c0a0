from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.body.leg import knee_position, two_bone_ik
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import about, multiply, rotate

DOWN, UP, FORWARD = np.array([0.0, -1, 0]), np.array([0.0, 1, 0]), np.array([0.0, 0, 1])
bones = st.floats(0.1, 1.0)
seeds = st.integers(0, 2**32 - 1)


def posed(hip, ankle, forward, thigh, shin):
    """Pose, knee and ankle by forward kinematics."""
    pose = two_bone_ik(hip, ankle, forward, thigh=thigh, shin=shin)
    knee = hip + rotate(pose.thigh, thigh * DOWN)
    assert np.array_equal(knee, knee_position(hip, pose.thigh, thigh=thigh))
    return pose, knee, knee + rotate(pose.shin, shin * DOWN)


def cases(seed: int, thigh: float, shin: float, count: int = 200):
    rng = np.random.default_rng(seed)
    hip, forward = rng.normal(size=(2, count, 3))
    line = rng.normal(size=(count, 3))
    line /= np.linalg.norm(line, axis=-1, keepdims=True)
    low, high = abs(thigh - shin), thigh + shin
    distance = low + (high - low) * rng.uniform(0.001, 0.999, count)
    forward *= 10.0 ** rng.uniform(-6, 6, (count, 1))
    return hip, hip + distance[:, None] * line, forward, line


@given(seeds, bones, bones)
def test_forward_kinematics_hits_the_ankle(seed, thigh, shin):
    hip, ankle, forward, line = cases(seed, thigh, shin)
    pose, knee, reached = posed(hip, ankle, forward, thigh, shin)
    assert np.abs(reached - ankle).max() < 1e-12
    # unit quaternions; the knee is a hinge about +X and bends towards the buttock only
    assert np.abs(np.linalg.norm(pose.thigh, axis=-1) - 1.0).max() < 1e-12
    hinge = multiply(pose.thigh, about("x", pose.flexion))
    assert np.abs(hinge - pose.shin).max() < 1e-12
    assert (pose.flexion > 0.0).all()
    assert (pose.flexion < np.pi).all()
    # the knee is on the side of the hint, in the plane of hip, ankle and hint
    across = forward - (forward * line).sum(-1, keepdims=True) * line
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    assert (((knee - hip) * across).sum(-1) > 0.0).all()
    axis = rotate(pose.thigh, np.array([1.0, 0, 0]))
    assert np.abs((axis * line).sum(-1)).max() < 1e-9
    assert np.abs((axis * across).sum(-1)).max() < 1e-9


@given(seeds, bones, bones)
def test_flexion_is_the_law_of_cosines(seed, thigh, shin):
    hip, ankle, forward, _ = cases(seed, thigh, shin)
    pose = two_bone_ik(hip, ankle, forward, thigh=thigh, shin=shin)
    square = ((ankle - hip) ** 2).sum(-1)
    cosine = (square - thigh**2 - shin**2) / (2 * thigh * shin)
    assert np.cos(pose.flexion) == pytest.approx(cosine, abs=1e-9)


@given(seeds, bones, bones, st.floats(1.0, 10.0))
def test_beyond_reach_the_leg_is_exactly_straight(seed, thigh, shin, excess):
    hip, _, forward, line = cases(seed, thigh, shin)
    ankle = hip + excess * (1.0 + 1e-12) * (thigh + shin) * line
    pose, _, reached = posed(hip, ankle, forward, thigh, shin)
    assert np.isfinite(pose.thigh).all()
    assert pose.flexion.max() < 1e-6  # full reach itself: within the rounding of the distance
    assert np.abs(reached - (hip + (thigh + shin) * line)).max() < 1e-11
    if excess > 1.001:
        assert (pose.flexion == 0.0).all()
        assert np.array_equal(pose.thigh, pose.shin)


@given(seeds, bones, bones, st.floats(0.0, 1.0))
def test_too_near_the_leg_is_folded(seed, thigh, shin, share):
    hip, _, forward, line = cases(seed, thigh, shin)
    fold = abs(thigh - shin)
    ankle = hip + share * fold * line
    pose, _, reached = posed(hip, ankle, forward, thigh, shin)
    assert np.isfinite(pose.thigh).all()
    assert np.isfinite(pose.shin).all()
    assert np.linalg.norm(reached - hip, axis=-1) == pytest.approx(fold, abs=1e-6)
    if share < 0.99 and fold > 1e-3:
        assert (pose.flexion == np.pi).all()


@pytest.mark.parametrize("thigh", [0.38, 0.40, 0.45])
@pytest.mark.parametrize(
    ("ankle", "forward", "knee_side"),
    [
        (0.7 * FORWARD, FORWARD, UP),  # a kick
        (-0.7 * FORWARD, FORWARD, DOWN),
        (0.7 * DOWN, UP, FORWARD),
        (0.7 * UP, UP, FORWARD),
        (0.7 * DOWN, 0.0 * UP, FORWARD),
        (0.7 * FORWARD, 0.0 * UP, UP),
        (0.7 * UP, FORWARD, FORWARD),
        (0.7 * np.array([1.0, 0, 0]), np.array([1.0, 0, 0]), UP),
    ],
)
def test_where_the_hint_says_nothing_the_documented_plane_is_used(thigh, ankle, forward, knee_side):
    pose, knee, reached = posed(np.zeros(3), ankle, forward, thigh, 0.40)
    assert reached == pytest.approx(ankle, abs=1e-12)
    assert knee @ knee_side > 0.1
    assert pose.thigh.shape == pose.shin.shape == (4,)


def test_hip_and_ankle_in_one_point():
    zero = np.zeros(3)
    pose, knee, reached = posed(zero, zero, FORWARD, 0.4, 0.4)
    assert knee == pytest.approx(0.4 * FORWARD, abs=1e-12)  # a squat
    assert reached == pytest.approx(zero, abs=1e-12)
    for thigh, shin in ((0.5, 0.4), (0.4, 0.5)):
        pose, _, reached = posed(zero, zero, FORWARD, thigh, shin)
        assert pose.flexion == np.pi
        assert reached == pytest.approx(0.1 * DOWN, abs=1e-12)


def test_a_standing_leg_is_the_rest_pose():
    pose = two_bone_ik(0.9 * UP, 0.05 * UP, FORWARD, thigh=0.43, shin=0.42)
    assert pose.thigh == pytest.approx([0, 0, 0, 1], abs=1e-7)
    assert pose.shin == pytest.approx([0, 0, 0, 1], abs=1e-7)


def test_mirror_image():
    """A leg and its image in the sagittal plane are images of each other."""
    hip, ankle, forward, _ = cases(1, 0.43, 0.41)
    pose = two_bone_ik(hip, ankle, forward, thigh=0.43, shin=0.41)
    m = np.array([-1.0, 1.0, 1.0])
    image = two_bone_ik(hip * m, ankle * m, forward * m, thigh=0.43, shin=0.41)
    # mirrored in x, a rotation keeps its x and w and turns y and z over
    for one, other in ((pose.thigh, image.thigh), (pose.shin, image.shin)):
        same = np.abs((one * [1, -1, -1, 1] * other).sum(-1))
        assert same == pytest.approx(1.0, abs=1e-9)


def test_axes_broadcast():
    hip = np.array([0.1, 0.9, 0.0])
    ankle = np.random.default_rng(2).normal(size=(5, 2, 3)) * 0.1
    pose = two_bone_ik(hip, ankle, FORWARD, thigh=0.43, shin=0.42)
    assert pose.thigh.shape == pose.shin.shape == (5, 2, 4)
    assert pose.flexion.shape == (5, 2)
    one = two_bone_ik(hip, ankle[3, 1], FORWARD, thigh=0.43, shin=0.42)
    assert np.array_equal(one.thigh, pose.thigh[3, 1])
    assert two_bone_ik(hip, np.empty((0, 3)), FORWARD, thigh=0.4, shin=0.4).thigh.shape == (0, 4)


@pytest.mark.parametrize("bad", [0.0, -0.4, float("nan")])
def test_bones_must_have_length(bad):
    with pytest.raises(InvalidInputError, match="thigh must be a positive number of meters"):
        two_bone_ik(np.zeros(3), DOWN, FORWARD, thigh=bad, shin=0.4)
    with pytest.raises(InvalidInputError, match="shin must be a positive number of meters"):
        two_bone_ik(np.zeros(3), DOWN, FORWARD, thigh=0.4, shin=bad)
