"""The kinds of ground, each with numbers worked by hand; tests/conformance has what all share."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground import (
    Edges,
    Flat,
    HeightField,
    Slope,
    Stairs,
    edges_near,
    ground_from_json,
)

NO_X = np.zeros(1)


def at(ground, *z):
    """Heights along x = 0."""
    return ground.height(np.zeros(len(z)), np.array(z))


def test_flat():
    ground = Flat(0.25)
    assert ground.height(np.array([1.0, 2.0]), np.array([0.0, 9.0])).tolist() == [0.25, 0.25]
    assert ground.normal(np.array(1.0), np.array(2.0)).tolist() == [0.0, 1.0, 0.0]
    assert ground.as_json() == {"kind": "flat", "height": 0.25}
    assert Flat(1).as_json() == {"kind": "flat", "height": 1.0}


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), None, "low"])
def test_flat_level_must_be_a_number(bad):
    with pytest.raises(InvalidInputError, match="ground level must be a finite number of meters"):
        Flat(bad)


def test_a_slope_rises_ahead_and_falls_behind():
    np.testing.assert_allclose(at(Slope(45.0), -2.0, 0.0, 3.0), [-2.0, 0.0, 3.0], atol=1e-15)
    np.testing.assert_allclose(at(Slope(-30.0), 3.0), [-np.sqrt(3.0)], atol=1e-15)
    np.testing.assert_allclose(Slope(30.0).normal(0.0, 0.0), [0.0, np.sqrt(0.75), -0.5], atol=1e-15)
    assert Slope(10).as_json() == {"kind": "slope", "deg": 10.0}


@pytest.mark.parametrize("bad", [60.5, -90.0, float("nan"), "steep"])
def test_slopes_that_are_none(bad):
    with pytest.raises(InvalidInputError, match=r"ground slope must be .* degrees, got"):
        Slope(bad)


def test_stairs_are_the_contract_of_the_command_line():
    """Flat to z = 1, COUNT risers, level after the last; the edge belongs to the upper tread."""
    ground = Stairs(0.17, 0.29, 3)
    edge = [1.0, 1.29, 1.58]
    heights = at(ground, -5.0, 0.999, *edge, 1.289, 1.5799, 99.0)
    np.testing.assert_allclose(heights, [0, 0, 0.17, 0.34, 0.51, 0.17, 0.34, 0.51], atol=1e-15)
    np.testing.assert_allclose(at(Stairs(-0.2, 0.3, 2), 0.9, 1.1, 1.4, 50.0), [0, -0.2, -0.4, -0.4])
    z = np.linspace(-1.0, 6.0, 20011)
    formula = 0.17 * np.clip(np.floor((z - 1.0) / 0.29) + 1.0, 0, 10)
    assert np.array_equal(at(Stairs(0.17, 0.29, 10), *z), formula)


def test_stairs_jump_exactly_at_their_risers():
    """Whatever the quotient rounds to: 0.1, 0.3 and 0.7 have no exact doubles."""
    for tread, start in ((0.1, 0.3), (0.3, 1.0), (0.29, 0.7), (1e-3, -7.1)):
        ground = Stairs(0.15, tread, 1000, start)
        z = ground.risers
        np.testing.assert_allclose(at(ground, *z), 0.15 * np.arange(1, 1001), rtol=1e-14)
        below = np.nextafter(z, -np.inf)
        np.testing.assert_allclose(at(ground, *below), 0.15 * np.arange(1000), rtol=1e-14)


def test_stairs_edges_are_their_risers():
    edges = edges_near(Stairs(-0.2, 0.3, 4), 0.0, 1.3, 0.31)
    assert edges.begin.tolist() == [[-0.31, 1.0], [-0.31, 1.3], [-0.31, 1.6]]
    assert edges.end[:, 0].tolist() == [0.31] * 3
    np.testing.assert_allclose(edges.low, [-0.2, -0.4, -0.6])
    np.testing.assert_allclose(edges.high, [0.0, -0.2, -0.4])


@pytest.mark.parametrize(
    ("numbers", "says"),
    [
        ((0.0, 0.3, 5), "stairs rise must not be 0: level ground is 'flat'"),
        ((9.0, 0.3, 5), "stairs rise must be from -2 to 2 meters, got 9"),
        ((0.2, -0.3, 5), "stairs tread must be a positive number of meters"),
        ((0.2, 500.0, 5), "stairs tread must be at most 100 meters"),
        ((0.2, 0.3, 2.5), "stairs count must be a whole number of risers from 1 to 10000, got 2.5"),
        ((0.2, 0.3, 0), "stairs count must be a whole number"),
        ((float("nan"), 0.3, 5), "stairs rise must be a finite number of meters"),
        ((0.2, 0.3, 5, float("inf")), "stairs start must be a finite number"),
    ],
)
def test_stairs_that_are_none(numbers, says):
    with pytest.raises(InvalidInputError, match=says):
        Stairs(*numbers)


def test_a_height_field_is_bilinear_between_and_clamped_outside():
    ground = HeightField(np.array([[0.0, 1.0], [2.0, 5.0]]), 0.5, (1.0, 3.0))
    x = np.array([1.0, 1.5, 1.0, 1.5, 1.25, 1.25, 0.0, 9.0, 9.0])
    z = np.array([3.0, 3.0, 3.5, 3.5, 3.25, 3.0, 3.25, 3.25, 99.0])
    np.testing.assert_allclose(ground.height(x, z), [0, 1, 2, 5, 2.0, 0.5, 1.0, 3.0, 5.0])
    assert ground.normal(9.0, 99.0).tolist() == [0.0, 1.0, 0.0]
    slopes = ground.normal(np.array([1.25]), np.array([3.25]))[0]
    np.testing.assert_allclose(-slopes[[0, 2]] / slopes[1], [4.0, 6.0])
    # beside the field the height changes along its border only
    np.testing.assert_allclose(ground.normal(0.5, 3.25)[0], 0.0)
    assert ground.normal(0.5, 3.25)[2] < -0.9


def test_a_height_field_of_a_plane_is_the_plane():
    x, z = np.arange(7) * 0.3 - 1.0, np.arange(9) * 0.3 + 2.0
    ground = HeightField(0.2 * x + 0.1 * z[:, None] + 0.5, 0.3, (-1.0, 2.0))
    rng = np.random.default_rng(0)
    px, pz = rng.uniform(-1.0, 0.8, 300), rng.uniform(2.0, 4.4, 300)
    np.testing.assert_allclose(ground.height(px, pz), 0.2 * px + 0.1 * pz + 0.5, atol=1e-12)
    wanted = np.array([-0.2, 1.0, -0.1]) / np.sqrt(1.05)
    np.testing.assert_allclose(ground.normal(px, pz), np.tile(wanted, (300, 1)), atol=1e-12)
    assert not ground.stepped


def test_a_wall_in_a_height_field_is_an_edge():
    """A kerb of 12 cm across x, between rows 2 and 3, and a lone post."""
    heights = np.zeros((6, 5))
    heights[3:] = 0.12
    ground = HeightField(heights, 0.02, (0.0, 0.0))
    edges = ground.edges((-1.0, -1.0), (1.0, 1.0))
    assert len(edges) == 5
    np.testing.assert_allclose(edges.begin[:, 1], 0.05)
    np.testing.assert_allclose(edges.end[:, 1], 0.05)
    np.testing.assert_allclose([edges.low[0], edges.high[0]], [0.0, 0.12])
    assert len(ground.edges((0.03, -1.0), (0.045, 1.0))) == 2
    post = np.zeros((5, 5))
    post[2, 2] = 0.3
    edges = HeightField(post, 0.02, (0.0, 0.0)).edges((-1.0, -1.0), (1.0, 1.0))
    assert len(edges) == 4
    np.testing.assert_allclose(edges.distance(np.array([0.04, 0.04])), 0.01, atol=1e-12)


@pytest.mark.parametrize(("height", "jumps"), [(0.019, False), (0.021, True)])
def test_what_jumps_is_higher_than_2_cm_and_steeper_than_45_degrees(height, jumps):
    heights = np.zeros((4, 4))
    heights[2:] = height
    assert HeightField(heights, 0.02, (0.0, 0.0)).stepped is jumps
    assert not HeightField(heights, 0.05, (0.0, 0.0)).stepped


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((np.zeros((1, 5)),), "2 or more rows and columns .* got 1 x 5"),
        ((np.zeros(5),), "height must have shape"),
        ((np.array([[0.0, 1.0], [np.nan, 0.0]]),), r"height\[1, 0\] is nan"),
        ((np.zeros((3, 3)), 0.0), "cell must be a positive number of meters"),
        ((np.zeros((3, 3)), 0.1, (0.0, np.inf)), "origin must be a finite number"),
        ((np.zeros((3, 3)), 0.1, (0.0,)), "origin must be x,z"),
        ((np.full((3, 3), 1e6),), "height must be within"),
    ],
)
def test_height_fields_that_are_none(arguments, says):
    with pytest.raises(InvalidInputError, match=says):
        HeightField(*arguments)


def test_distance_to_edges():
    edges = Edges([[0.0, 0.0], [5.0, 0.0]], [[2.0, 0.0], [5.0, 3.0]], [0.0, 0.0], [1.0, 1.0])
    places = np.array([[[1.0, 0.5], [-3.0, 4.0]], [[4.0, 2.0], [2.0, 0.0]]])
    np.testing.assert_allclose(edges.distance(places), [[0.5, 5.0], [1.0, 0.0]])


def test_crossings_tell_which_where_and_how_high():
    stairs = Stairs(0.2, 0.3, 5)
    edges = stairs.edges((-1.0, 0.0), (1.0, 3.0))
    feet = np.array([[0.0, 0.9], [0.0, 1.05], [0.0, 1.2], [0.5, 1.3]])
    toes = np.array([[0.0, 1.1], [0.0, 1.25], [0.0, 1.7], [-0.5, 1.3]])
    found = edges.crossings(feet, toes)
    assert found.way.tolist() == [0, 2, 2]
    assert found.edge.tolist() == [0, 1, 2]
    np.testing.assert_allclose(found.at, [0.5, 0.2, 0.8])
    np.testing.assert_allclose(found.high, [0.2, 0.4, 0.6])
    assert len(edges.crossings(np.empty((0, 2)), np.empty((0, 2)))) == 0


def test_many_places_against_many_edges():
    """In parts, to the same result."""
    rng = np.random.default_rng(0)
    heights = np.round(rng.uniform(0.0, 0.4, (60, 60)), 1)
    edges = HeightField(heights, 0.1, (0.0, 0.0)).edges((0.0, 0.0), (6.0, 6.0))
    assert len(edges) > 3000
    places = rng.uniform(0.0, 6.0, (700, 2))
    every = edges.distance(places)
    assert [edges.distance(place) for place in places[::97]] == every[::97].tolist()
    ways = edges.crossings(places, places[::-1])
    one = edges.crossings(places[600:601], places[99:100])
    assert ways.edge[ways.way == 600].tolist() == one.edge.tolist()


@pytest.mark.parametrize(
    ("data", "says"),
    [
        ("{", "object with its kind"),
        ("[1]", "object with its kind"),
        ('{"kind": "stair"}', "unknown ground 'stair'.*Did you mean 'stairs'"),
        ('{"kind": "stairs", "rise": 0.2}', "of a ground 'stairs' has no 'tread'"),
        ('{"kind": "slope", "deg": null}', "ground slope must be a finite number"),
        (
            '{"kind": "heightfield", "height": [1, 2], "shape": [2, 2], "cell":1, "origin":[0,0]}',
            "shape must be rows, columns of the 2 heights",
        ),
        (
            '{"kind": "heightfield", "height": [1, 2], "shape": 2, "cell": 1, "origin": [0, 0]}',
            "not the JSON of a ground 'heightfield'",
        ),
    ],
)
def test_json_that_is_no_ground(data, says):
    with pytest.raises(InvalidInputError, match=says):
        ground_from_json(data)


def test_no_line_on_a_field_bends_more_than_it_says():
    rng = np.random.default_rng(5)
    field = HeightField(np.cumsum(np.cumsum(rng.normal(0, 1e-3, (30, 30)), 0), 1) * 0.1, 0.1)
    start, way = rng.uniform(-6.0, -4.0, (400, 2)) + [0.0, 6.0], rng.normal(size=(400, 2))
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    for span in (0.1, 0.2, 0.3):
        ends = [field.height(*(start + k * span * way).T) for k in (-1.0, 0.0, 1.0)]
        bent = np.abs(ends[0] - 2.0 * ends[1] + ends[2]) / span**2
        assert bent.max() <= field.most_bent * (1.0 + field.cell / span)
    flat = HeightField(np.add.outer(0.1 * np.arange(9.0), 0.2 * np.arange(9.0)), 0.1)
    assert flat.most_bent < 1e-9
