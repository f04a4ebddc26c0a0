"""Delaunay triangulations against SciPy's, and that they keep their promise as they grow."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import Delaunay

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.triangulation import Triangulation

CORNERS = np.array([[0.0, 0.0], [1.0, 0.1], [1.1, 1.0], [-0.1, 0.9]])


def as_set(triangles):
    return {frozenset(t) for t in np.asarray(triangles).tolist()}


@pytest.mark.parametrize("seed", range(5))
def test_as_scipys(seed):
    points = np.random.default_rng(seed).uniform(size=(8, 2))
    assert as_set(Triangulation(points).triangles) == as_set(Delaunay(points).simplices)


@pytest.mark.parametrize("seed", range(3))
def test_grown_point_by_point_it_is_scipys_of_all(seed):
    more = np.random.default_rng(seed).uniform(0.1, 0.85, size=(60, 2))
    grown = Triangulation(CORNERS)
    for k, point in enumerate(more):
        assert grown.insert(point) == 4 + k
    every = np.concatenate([CORNERS, more])
    assert np.array_equal(grown.points, every)
    assert as_set(grown.triangles) == as_set(Delaunay(every).simplices)


def test_every_place_inside_is_found_in_its_triangle():
    grown = Triangulation(CORNERS)
    rng = np.random.default_rng(0)
    for point in rng.uniform(0.1, 0.85, size=(40, 2)):
        grown.insert(point)
    for point in rng.uniform(0.1, 0.85, size=(200, 2)):
        triangle, _ = grown.locate(point)
        shares = grown.shares(triangle, point)
        assert shares.min() >= -1e-9
        np.testing.assert_allclose(shares @ grown.points[list(triangle)], point, atol=1e-12)
        assert grown.locate(point) == (triangle, 0)


def test_outside_it_ends_at_the_hull():
    plane = Triangulation(CORNERS)
    triangle, _ = plane.locate(np.array([9.0, 0.5]))
    assert plane.shares(triangle, np.array([9.0, 0.5])).min() < 0.0
    assert {1, 2} <= set(triangle)


def test_points_on_a_circle_and_on_an_edge():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    plane = Triangulation(square)
    assert len(plane.triangles) == 2
    plane.insert(np.array([0.5, 0.0]))
    plane.insert(np.array([0.5, 0.5]))
    area = 0.0
    for a, b, c in plane.points[plane.triangles]:
        area += 0.5 * np.linalg.det(np.stack([b - a, c - a]))
    assert area == pytest.approx(1.0)


def test_a_middle_on_the_line_between_two_others():
    """As the level sets are: short, normal and long take steps of no height."""
    points = np.array([[0.72, 0.0], [0.46, 0.0], [0.89, 0.0], [0.66, 0.13], [0.63, -0.12]])
    assert len(Triangulation(points).triangles) == 4


def test_too_few_points():
    with pytest.raises(InvalidInputError, match="three points that are not in line, got 2"):
        Triangulation(np.zeros((2, 2)))
    with pytest.raises(InvalidInputError, match="not in line"):
        Triangulation(np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]))
