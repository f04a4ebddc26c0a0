"""Rotations against SciPy's, and by the laws they must obey."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry import rotations as R

TAIT_BRYAN = ("xyz", "xzy", "yxz", "yzx", "zxy", "zyx")
PROPER = ("xyx", "xzx", "yxy", "yzy", "zxz", "zyz")
ORDERS = (*TAIT_BRYAN, *PROPER)
SEEDS = st.integers(0, 2**32 - 1)
ANGLES = st.tuples(*[st.floats(-10.0, 10.0)] * 3)
fast = settings(max_examples=40, deadline=None)


def random_quaternions(seed: int, count: int = 50) -> np.ndarray:
    q = np.random.default_rng(seed).normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def assert_same_rotation(a: np.ndarray, b: np.ndarray, atol: float = 1e-12) -> None:
    np.testing.assert_allclose(R.to_matrix(a), R.to_matrix(b), rtol=0, atol=atol)


def quarter_turns(order: str) -> np.ndarray:
    """Every triple of multiples of 90 degrees: a third of them are gimbal locks."""
    quarter = 0.5 * np.pi * np.arange(-4, 5)
    return R.from_euler(order, np.stack(np.meshgrid(*[quarter] * 3), -1).reshape(-1, 3))


@fast
@given(SEEDS)
def test_product_inverse_and_turned_vectors_are_scipys(seed):
    a, b = random_quaternions(seed), random_quaternions(seed + 1)
    v = np.random.default_rng(seed + 2).normal(size=(50, 3))
    A, B = Rotation.from_quat(a), Rotation.from_quat(b)

    assert_same_rotation(R.multiply(a, b), (A * B).as_quat())
    assert_same_rotation(R.inverse(a), A.inv().as_quat())
    np.testing.assert_allclose(R.rotate(a, v), A.apply(v), atol=1e-12)


@fast
@given(SEEDS)
def test_matrices_are_scipys(seed):
    q = random_quaternions(seed)

    np.testing.assert_allclose(R.to_matrix(q), Rotation.from_quat(q).as_matrix(), atol=1e-12)
    assert_same_rotation(R.from_matrix(R.to_matrix(q)), q)
    columns = np.moveaxis(R.to_matrix(q), -1, 0)
    assert_same_rotation(R.from_basis(*columns), q)


@pytest.mark.parametrize("order", ORDERS)
def test_half_turns_survive_matrices(order):
    q = quarter_turns(order)
    assert_same_rotation(R.from_matrix(R.to_matrix(q)), q, atol=1e-14)


@fast
@given(SEEDS, st.sampled_from([0.0, 1e-12, 1e-7, 1e-6, 1e-3, 1.0, np.pi]))
def test_exp_and_log_are_scipys_at_every_size(seed, size):
    direction = random_quaternions(seed)[:, :3]
    vector = size * direction / np.linalg.norm(direction, axis=-1, keepdims=True)
    oracle = Rotation.from_rotvec(vector)

    assert_same_rotation(R.exp(vector), oracle.as_quat())
    assert_same_rotation(R.exp(R.log(R.exp(vector))), R.exp(vector))
    np.testing.assert_allclose(
        np.linalg.norm(R.log(-R.exp(vector)), axis=-1), oracle.magnitude(), atol=1e-12
    )
    if size < 3.0:  # at pi both signs of the axis are right
        np.testing.assert_allclose(R.log(R.exp(vector)), vector, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("order", ORDERS)
@fast
@given(angles=ANGLES)
def test_from_euler_is_scipys_intrinsic(order, angles):
    a = np.array([angles])
    oracle = Rotation.from_euler(order.upper(), a)
    assert_same_rotation(R.from_euler(order, a), oracle.as_quat())
    assert_same_rotation(R.from_euler(order.upper(), a), oracle.as_quat())


@pytest.mark.parametrize("order", ORDERS)
@fast
@given(seed=SEEDS)
def test_to_euler_is_scipys(order, seed):
    q = random_quaternions(seed)
    angles = R.to_euler(order, q)
    oracle = Rotation.from_quat(q).as_euler(order.upper())

    # the same triple, not merely the same rotation; loose, for the angles of a rotation
    # close to gimbal lock are not well determined
    turns = np.abs(angles - oracle) % (2.0 * np.pi)
    np.testing.assert_allclose(np.minimum(turns, 2.0 * np.pi - turns), 0.0, atol=1e-6)
    assert_same_rotation(R.from_euler(order, angles), q)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("off", [0.0, 1e-15, 1e-9, 0.9e-7, 1.1e-7, 1e-5])
def test_to_euler_at_and_near_gimbal_lock_is_the_same_rotation(order, off):
    q = quarter_turns(order)
    q = R.multiply(q, R.exp(np.broadcast_to(off * np.array([0.6, -0.48, 0.64]), (len(q), 3))))
    angles = R.to_euler(order, q)
    # within 1e-7 of the lock the triple of the lock itself is given
    assert_same_rotation(R.from_euler(order, angles), q, atol=2e-7 if 0 < off < 1e-6 else 1e-12)


@pytest.mark.parametrize("order", ORDERS)
def test_to_euler_keeps_its_ranges(order):
    q = np.concatenate([quarter_turns(order), random_quaternions(3, 2000)])
    angles = R.to_euler(order, q)
    low, high = (0.0, np.pi) if order in PROPER else (-0.5 * np.pi, 0.5 * np.pi)

    assert (angles[:, 1] >= low - 1e-12).all()
    assert (angles[:, 1] <= high + 1e-12).all()
    assert (np.abs(angles[:, [0, 2]]) <= np.pi).all()
    locked = np.minimum(angles[:, 1] - low, high - angles[:, 1]) < 1e-8
    assert locked.any()
    assert (angles[locked, 2] == 0.0).all()


@pytest.mark.parametrize("order", ORDERS)
@fast
@given(seed=SEEDS)
def test_continuous_euler_follows_a_smooth_turn_through_every_wrap(order, seed):
    """A smooth triple comes back with the same steps, though it passes +-180 and the lock."""
    steps = np.random.default_rng(seed).uniform(-0.2, 0.2, (300, 2, 3)) + [0.05, 0.03, -0.04]
    smooth = np.cumsum(steps, axis=0)
    q = R.from_euler(order, smooth)
    angles = R.continuous_euler(order, R.to_euler(order, q))

    assert_same_rotation(R.from_euler(order, angles), q, atol=3e-7)
    moved, want = np.diff(angles, axis=0), np.diff(smooth, axis=0)
    np.testing.assert_allclose(np.abs(moved), np.abs(want), atol=1e-5)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("frames", [0, 1, 2])
def test_continuous_euler_of_hardly_any_frames(order, frames):
    angles = R.to_euler(order, random_quaternions(5, frames))
    assert R.continuous_euler(order, angles).shape == (frames, 3)


@pytest.mark.parametrize("order", ["", "xy", "xxz", "xyy", "abc", "xyzx"])
def test_nonsense_orders_are_refused(order):
    for call in (R.to_euler, R.from_euler, R.continuous_euler):
        with pytest.raises(InvalidInputError, match="three axes"):
            call(order, np.zeros((1, 4)))


@fast
@given(SEEDS, st.floats(0.0, 1.0))
def test_slerp_is_scipys(seed, t):
    a, b = random_quaternions(seed, 2)
    oracle = Slerp([0.0, 1.0], Rotation.from_quat([a, b]))(t).as_quat()
    assert_same_rotation(R.slerp(a, b, t), oracle, atol=1e-9)
    assert_same_rotation(R.slerp(a, -b, t), oracle, atol=1e-9)


@fast
@given(SEEDS)
def test_swing_and_twist_make_the_rotation_and_share_no_axis(seed):
    q = random_quaternions(seed)
    axis = random_quaternions(seed + 1, 1)[0, :3]
    axis /= np.linalg.norm(axis)
    swing, angle = R.swing_twist(q, axis)

    assert_same_rotation(R.multiply(swing, R.exp(angle[:, None] * axis)), q)
    np.testing.assert_allclose(swing[:, :3] @ axis, 0.0, atol=1e-12)
    assert (np.abs(angle) <= np.pi).all()


@pytest.mark.parametrize("axis", "xyz")
def test_about_turns_about_its_axis(axis):
    angle = np.linspace(-7.0, 7.0, 41)
    oracle = Rotation.from_euler(axis, angle[:, None])
    assert_same_rotation(R.about(axis, angle), oracle.as_quat())


@fast
@given(SEEDS)
def test_sign_continuous_keeps_rotations_and_the_half_sphere(seed):
    rng = np.random.default_rng(seed)
    q = R.exp(np.cumsum(rng.uniform(-0.1, 0.1, (60, 3, 3)), axis=0))
    mixed = q * rng.choice([-1.0, 1.0], (60, 3, 1))
    out = R.sign_continuous(mixed)

    assert_same_rotation(out, q)
    assert ((out[1:] * out[:-1]).sum(-1) > 0.0).all()
    np.testing.assert_array_equal(out[0], mixed[0])
