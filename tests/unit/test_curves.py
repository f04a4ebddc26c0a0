"""Piecewise cubics against SciPy's, and the small curves by their definitions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from gaitsmith.geometry import curves as C

SEEDS = st.integers(0, 2**32 - 1)
fast = settings(max_examples=60, deadline=None)


def samples(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Uneven nodes, values with plateaus and turns, and points to read between the nodes."""
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.uniform(0.01, 1.0, count))
    y = rng.normal(size=(count, 3)) * (rng.random((count, 3)) < 0.7)  # zeros side by side
    return x, y, rng.uniform(x[0], x[-1], 200)


@fast
@given(SEEDS, st.integers(2, 12))
def test_pchip_is_scipys(seed, count):
    x, y, at = samples(seed, count)
    oracle = PchipInterpolator(x, y)

    np.testing.assert_allclose(C.pchip_slopes(x, y), oracle.derivative()(x), atol=1e-9)
    np.testing.assert_allclose(C.pchip(x, y, at), oracle(at), atol=1e-12)
    np.testing.assert_array_equal(C.pchip(x, y[:, 0], at), C.pchip(x, y, at)[:, 0])


@fast
@given(SEEDS, st.integers(2, 12))
def test_pchip_never_leaves_the_range_of_its_neighbors(seed, count):
    x, y, at = samples(seed, count)
    left = np.searchsorted(x, at, side="right") - 1
    low, high = np.minimum(y[left], y[left + 1]), np.maximum(y[left], y[left + 1])
    values = C.pchip(x, y, at)

    assert (values >= low - 1e-12).all()
    assert (values <= high + 1e-12).all()


@fast
@given(SEEDS, st.integers(2, 12))
def test_hermite_is_scipys_inside_and_clamped_outside(seed, count):
    x, y, at = samples(seed, count)
    slopes = np.random.default_rng(seed + 1).normal(size=y.shape)
    oracle = CubicHermiteSpline(x, y, slopes)

    np.testing.assert_allclose(C.hermite(x, y, slopes, at), oracle(at), atol=1e-12)
    np.testing.assert_allclose(C.hermite(x, y, slopes, x), y, atol=1e-12)
    beyond = C.hermite(x, y, slopes, np.array([x[0] - 1.0, x[-1] + 1.0]))
    np.testing.assert_allclose(beyond, y[[0, -1]], atol=1e-12)


def test_hermite_takes_the_interval_that_the_caller_knows():
    x, y, at = samples(1, 9)
    slopes = C.parabola_slopes(x, y)
    known = np.searchsorted(x, at, side="right") - 1
    np.testing.assert_array_equal(C.hermite(x, y, slopes, at, known), C.hermite(x, y, slopes, at))


def test_hermite_is_exactly_constant_between_equal_values():
    """A foot that stands does not move by a rounding error."""
    x, y = np.array([0.0, 0.3, 0.7]), np.full((3, 1), 0.1)
    out = C.hermite(x, y, np.zeros((3, 1)), np.linspace(0.0, 0.7, 101))
    assert (out == 0.1).all()


@fast
@given(SEEDS, st.integers(3, 12))
def test_parabola_slopes_are_exact_for_parabolas(seed, count):
    x, _, _ = samples(seed, count)
    a, b, c = np.random.default_rng(seed + 1).normal(size=(3, 2))
    y = a + b * x[:, None] + c * x[:, None] ** 2
    np.testing.assert_allclose(C.parabola_slopes(x, y), b + 2.0 * c * x[:, None], atol=1e-9)


def test_slopes_of_two_samples_are_their_line():
    x, y = np.array([1.0, 3.0]), np.array([[1.0], [2.0]])
    for slopes in (C.parabola_slopes, C.pchip_slopes):
        np.testing.assert_allclose(slopes(x, y), [[0.5], [0.5]])


def test_smoothstep_is_flat_at_both_ends_and_stays_there():
    u = np.array([-1.0, 0.0, 0.25, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(C.smoothstep(u), [0.0, 0.0, 0.15625, 0.5, 1.0, 1.0])
    near = C.smoothstep(np.array([1e-6, 1.0 - 1e-6]))
    np.testing.assert_allclose(near, [0.0, 1.0], atol=1e-11)


def test_end_slope_correction_moves_no_end_and_has_the_slopes():
    start, end, h = np.array([0.7, -1.0]), np.array([-0.3, 2.0]), 1e-6
    u = np.array([0.0, h, 1.0 - h, 1.0])
    out = C.end_slope_correction(u, start, end)

    np.testing.assert_array_equal(out[[0, 3]], 0.0)
    np.testing.assert_allclose((out[1] - out[0]) / h, start, atol=1e-5)
    np.testing.assert_allclose((out[3] - out[2]) / h, end, atol=1e-5)


@pytest.mark.parametrize("half", [0, 1, 4])
def test_running_maximum_is_the_slow_one(half):
    values = np.random.default_rng(0).normal(size=30)
    slow = [values[max(0, i - half) : i + half + 1].max() for i in range(30)]
    np.testing.assert_array_equal(C.running_maximum(values, half), slow)


@pytest.mark.parametrize("half", [0, 1, 4])
def test_hann_average_keeps_lines_inside_and_never_overshoots(half):
    line = np.linspace(-1.0, 2.0, 30)
    inside = slice(half, 30 - half)
    np.testing.assert_allclose(C.hann_average(line, half)[inside], line[inside], atol=1e-12)

    values = np.random.default_rng(0).normal(size=30)
    out = C.hann_average(values, half)
    assert out.shape == values.shape
    assert values.min() - 1e-12 <= out.min()
    assert out.max() <= values.max() + 1e-12
