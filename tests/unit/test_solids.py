"""Distances of segments and polygons, against sampling and Shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from gaitsmith.geometry.solids import inside_polygon, polygon_apart, segments_apart

RNG = np.random.default_rng(3)


@pytest.mark.parametrize("size", [2, 3])
def test_segments_are_as_far_apart_as_their_nearest_points(size):
    a, b, c, d = RNG.normal(size=(4, 60, size))
    a[0], c[1] = b[0], d[1]  # points
    c[2], d[2] = a[2] + 0.3, b[2] + 0.3  # parallel
    a[3] = b[3]
    c[3] = d[3]
    found = segments_apart(a, b, c, d)
    u = np.linspace(0.0, 1.0, 401)
    one = a[:, None] + u[:, None] * (b - a)[:, None]
    line = d - c
    length = np.maximum((line**2).sum(-1), 1e-18)
    t = np.clip(((one - c[:, None]) * line[:, None]).sum(-1) / length[:, None], 0.0, 1.0)
    near = np.linalg.norm(one - c[:, None] - t[..., None] * line[:, None], axis=-1).min(axis=1)
    assert (found <= near + 1e-12).all()
    np.testing.assert_allclose(found, near, atol=2e-2)
    np.testing.assert_allclose(found, segments_apart(c, d, a, b), atol=1e-12)
    np.testing.assert_allclose(found, segments_apart(b, a, c, d), atol=1e-12)


def test_a_polygon_is_as_far_as_shapely_says():
    corners = np.array([[0, 0], [2, 0], [2, 2], [1.2, 0.6], [0, 2]], dtype=float)
    a, b = RNG.uniform(-2, 4, size=(2, 300, 2))
    shape, lines = shapely.Polygon(corners), shapely.linestrings(np.stack([a, b], axis=1))
    found = polygon_apart(a, b, corners)
    np.testing.assert_allclose(np.maximum(found, 0.0), shapely.distance(lines, shape), atol=1e-9)
    within = shapely.contains_xy(shape, a[:, 0], a[:, 1])
    np.testing.assert_array_equal(inside_polygon(a, corners), within)
    assert (found[within] < 0.0).all()
