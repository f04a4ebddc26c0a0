"""Ways round obstacles: shortest, clear, refused with the reason."""

from __future__ import annotations

import re

import numpy as np
import pytest
import shapely

from gaitsmith.body.presets import body_from_height
from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.routes import COMFORT, Routes, is_blocked, shortest
from gaitsmith.plan.surroundings import Obstacle, Post, Surroundings, read_surroundings
from gaitsmith.plan.ways import path_through

BODY = body_from_height(1.75)
BOX = ((-0.5, 2.0), (0.5, 2.0), (0.5, 3.0), (-0.5, 3.0))
HERE = np.array([0.0, 0.0])


def routes(*outlines, posts=()):
    things = tuple(Obstacle(o, f"thing {i}") for i, o in enumerate(outlines, start=1))
    return Routes(BODY, read_surroundings(Surroundings(things, posts=posts)))


def to(x, z):
    return [([np.array([x, z])], False)]


def test_the_shortest_way_is_a_taut_string():
    free = shapely.box(-5, -5, 5, 5).difference(shapely.Polygon(BOX))
    way = shortest(free, HERE, np.array([0.0, 5.0]))
    length = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
    assert length == pytest.approx(2.0 * np.hypot(0.5, 2.0) + 1.0)
    way = shortest(free, HERE, np.array([0.8, 4.0]))
    assert len(way) == 3, "round one corner"


def test_free_ground_is_walked_as_without_obstacles():
    around = routes(BOX)
    path, free = around.path(HERE, to(3.0, 1.0)), path_through(HERE, to(3.0, 1.0))
    np.testing.assert_array_equal(path.points, free.points)


@pytest.mark.parametrize("goal", [(0.0, 5.0), (0.2, 3.8), (-1.2, 4.0), (0.45, 9.0)])
def test_a_way_keeps_the_distance_that_people_like(goal):
    path = routes(BOX).path(HERE, to(*goal))
    line = shapely.LineString(path.at(np.linspace(0.0, path.length, 500)))
    assert line.distance(shapely.Polygon(BOX)) > COMFORT - 0.011
    assert 1.0 / np.abs(path.curvature).max() > COMFORT - 0.02, "m of radius"
    np.testing.assert_allclose(path.points[[0, -1]], [HERE, goal], atol=1e-6)


def test_a_gap_is_walked_through_that_is_wide_enough():
    left = ((-9.0, 2.0), (-0.4, 2.0), (-0.4, 3.0), (-9.0, 3.0))
    right = tuple((-x, z) for x, z in reversed(left))
    path = routes(left, right).path(np.array([1.0, 0.0]), to(1.0, 5.0))
    line = shapely.LineString(path.at(np.linspace(0.0, path.length, 500)))
    assert path.length < 6.0
    for outline in (left, right):
        assert line.distance(shapely.Polygon(outline)) > routes().least - 0.011


def test_a_gap_that_is_too_narrow_is_refused_with_its_width():
    ring = ((-3, -3), (3, -3), (3, 3), (0.25, 3), (0.25, 2.8), (2.8, 2.8), (2.8, -2.8))
    ring += ((-2.8, -2.8), (-2.8, 2.8), (-0.25, 2.8), (-0.25, 3), (-3, 3))
    with pytest.raises(InfeasibleError, match=r"gap of 0\.50 m; .* needs 0\.69 m") as caught:
        routes(ring).path(HERE, to(0.0, 5.0))
    x, z = map(float, re.search(r"reached is (\S+),(\S+)", str(caught.value)).groups())
    assert abs(x) < 0.05
    assert 2.3 < z < 2.9
    path = routes(ring).path(HERE, to(x, z))
    np.testing.assert_allclose(path.points[-1], [x, z], atol=1e-6)


def test_a_goal_behind_walls_or_inside_is_refused_with_the_nearest():
    walls = [((-3, z), (3, z), (3, z + 0.1), (-3, z + 0.1)) for z in (-3, 3)]
    walls += [((x, -3), (x + 0.1, -3), (x + 0.1, 3.1), (x, 3.1)) for x in (-3, 2.9)]
    with pytest.raises(InfeasibleError, match="there is no way"):
        routes(*walls).path(HERE, to(0.0, 5.0))
    with pytest.raises(InfeasibleError, match=r"lies inside 'thing 1'; .* 0\.00,1\.55"):
        routes(BOX).path(HERE, to(0.0, 2.4))


def test_posts_that_stand_are_walked_round_those_that_hang_are_not():
    stands, hangs = (routes(posts=(Post((0.1, 2.0), bottom=b),)) for b in (0.0, 1.2))
    assert stands.path(HERE, to(0.0, 4.0)).length > 4.02
    assert hangs.path(HERE, to(0.0, 4.0)).length == pytest.approx(4.0)


def test_several_points_in_one_way_are_left_to_be_walked_one_by_one():
    run = [([np.array([0.0, 5.0])], False), ([np.array([4.0, 5.0])], False)]
    assert routes(BOX).path(HERE, run) is None
    assert routes().path(HERE, run) is not None


def test_who_stands_inside_or_steps_inside_is_told():
    around = routes(BOX)
    with pytest.raises(InfeasibleError, match=r"stands inside 'thing 1' at \(0\.00, 2\.20\)"):
        around.path(np.array([0.0, 2.2]), to(0.0, 5.0))
    assert is_blocked(around, np.array([0.0, 1.6]), np.array([0.0, 2.3]))
    assert not is_blocked(around, np.array([0.0, 1.6]), np.array([0.4, 1.6]))
    assert not is_blocked(None, HERE, HERE)
