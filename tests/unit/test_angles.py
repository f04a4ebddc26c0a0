"""Sines and cosines from the tangent of the half angle, against the C library's."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.geometry.angles import sine_cosine

ULP = float(np.finfo(float).eps)


@pytest.mark.parametrize("size", [1e-300, 1e-8, 1e-3, 0.5, 1.6, 3.2, 50.0, 1e6])
def test_right_to_the_last_place(size):
    angle = np.random.default_rng(7).uniform(-size, size, 20_000)
    sine, cosine = sine_cosine(angle)
    assert np.abs(sine - np.sin(angle)).max() <= 1.01 * ULP * min(1.0, size)
    assert np.abs(cosine - np.cos(angle)).max() <= 1.01 * ULP


def test_exact_where_it_matters():
    sine, cosine = sine_cosine(np.array([0.0, -0.0, np.pi, -np.pi, 0.5 * np.pi]))
    np.testing.assert_array_equal(sine[[0, 1, 4]], [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(cosine[:4], [1.0, 1.0, -1.0, -1.0])
    assert np.abs(sine[2:4]).max() < ULP
    assert abs(cosine[4]) < ULP


def test_turning_the_other_way_mirrors_to_the_bit():
    angle = np.linspace(0.0, 7.0, 1001)
    (sine, cosine), (back, same) = sine_cosine(angle), sine_cosine(-angle)
    np.testing.assert_array_equal(back, -sine)
    np.testing.assert_array_equal(same, cosine)


def test_shapes_are_kept():
    for shape in [(), (3,), (2, 5)]:
        sine, cosine = sine_cosine(np.full(shape, 0.3))
        assert sine.shape == cosine.shape == shape
