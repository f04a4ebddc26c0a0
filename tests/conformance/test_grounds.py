"""What every ground must do; each new one is picked up from its table."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.ground import GROUNDS, Ground, edge_distance, foot_plane, ground_from_json

EVERY = pytest.mark.parametrize("name", GROUNDS)
coordinates = st.floats(-1e3, 1e3)


@EVERY
def test_is_a_ground(name):
    assert isinstance(GROUNDS[name](), Ground)


@EVERY
@given(x=coordinates, z=coordinates)
def test_finite_with_unit_upward_normal_everywhere(name, x, z):
    ground = GROUNDS[name]()
    height = ground.height(np.array(x), np.array(z))
    normal = ground.normal(np.array(x), np.array(z))
    assert np.shape(height) == ()
    assert np.isfinite(height)
    assert np.shape(normal) == (3,)
    assert np.linalg.norm(normal) == pytest.approx(1.0, abs=1e-12)
    assert normal[1] > 0.0


@EVERY
@pytest.mark.parametrize("shape", [(), (1,), (0,), (7,), (5, 2, 3)])
def test_elementwise(name, shape):
    ground = GROUNDS[name]()
    x, z = np.random.default_rng(0).uniform(-5.0, 5.0, (2, *shape))
    height, normal = ground.height(x, z), ground.normal(x, z)
    assert height.shape == shape
    assert normal.shape == (*shape, 3)
    assert height.dtype == normal.dtype == np.float64
    for index in np.ndindex(shape):
        assert ground.height(x[index], z[index]) == height[index]
        assert np.array_equal(ground.normal(x[index], z[index]), normal[index])


@EVERY
def test_x_and_z_broadcast(name):
    ground = GROUNDS[name]()
    x, z = np.linspace(-3, 3, 5)[:, None], np.linspace(-1, 9, 7)
    wide = np.broadcast_arrays(x, z)
    assert np.array_equal(ground.height(x, z), ground.height(*wide))
    assert np.array_equal(ground.normal(x, z), ground.normal(*wide))


@EVERY
def test_normal_is_that_of_the_height(name):
    """Away from edges (none for smooth grounds) the slope of the height is the normal's."""
    ground = GROUNDS[name]()
    x, z = np.random.default_rng(1).uniform(-5.0, 5.0, (2, 200))
    step = 1e-5
    slope_x = (ground.height(x + step, z) - ground.height(x - step, z)) / (2 * step)
    slope_z = (ground.height(x, z + step) - ground.height(x, z - step)) / (2 * step)
    wanted = np.stack([-slope_x, np.ones_like(x), -slope_z], axis=-1)
    wanted /= np.linalg.norm(wanted, axis=-1, keepdims=True)
    off = np.abs(wanted - ground.normal(x, z)).max(axis=-1)
    assert np.mean(off < 1e-6) > 0.95


@EVERY
def test_is_not_changed_by_being_asked(name):
    ground = GROUNDS[name]()
    x = np.linspace(-1.0, 1.0, 5)
    first, normal = ground.height(x, x).copy(), ground.normal(x, x).copy()
    ground.height(x, x)[...] = 7.0
    ground.normal(x, x)[...] = 7.0
    assert np.array_equal(ground.height(x, x), first)
    assert np.array_equal(ground.normal(x, x), normal)
    assert np.array_equal(x, np.linspace(-1.0, 1.0, 5))


@EVERY
def test_as_json_is_json_with_its_kind(name):
    data = GROUNDS[name]().as_json()
    assert json.loads(json.dumps(data, allow_nan=False)) == data
    assert isinstance(data["kind"], str)


@EVERY
def test_json_rebuilds_it(name):
    ground = GROUNDS[name]()
    again = ground_from_json(json.dumps(ground.as_json()))
    assert type(again) is type(ground)
    assert again.as_json() == ground.as_json()
    x, z = np.random.default_rng(2).uniform(-8.0, 8.0, (2, 500))
    assert np.array_equal(again.height(x, z), ground.height(x, z))
    assert np.array_equal(again.normal(x, z), ground.normal(x, z))


@EVERY
def test_edges_are_where_the_height_jumps(name):
    """Across each edge it jumps from low to high; where none is near, it does not jump."""
    ground = GROUNDS[name]()
    edges = ground.edges((-8.0, -8.0), (8.0, 8.0))
    assert (len(edges) > 0) == ground.stepped
    assert (edges.high > edges.low).all()
    if len(edges):
        assert ((edges.begin >= -8.0) & (edges.end <= 8.0)).all()
        middle, along = 0.5 * (edges.begin + edges.end), edges.end - edges.begin
        across = 1e-6 * np.stack([-along[:, 1], along[:, 0]], axis=-1)
        across /= np.linalg.norm(along, axis=-1, keepdims=True)
        sides = np.stack(
            [ground.height(*(middle + sign * across).T) for sign in (-1.0, 1.0)], axis=-1
        )
        np.testing.assert_allclose(sides.min(axis=1), edges.low, atol=1e-9)
        np.testing.assert_allclose(sides.max(axis=1), edges.high, atol=1e-9)
    begin = np.random.default_rng(3).uniform(-7.0, 7.0, (400, 2))
    turn = np.random.default_rng(4).uniform(0.0, 2.0 * np.pi, 400)
    end = begin + 0.004 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    free = np.ones(400, dtype=bool)
    free[edges.crossings(begin, end).way] = False
    change = np.abs(ground.height(*end.T) - ground.height(*begin.T))
    assert (change[free] < 0.02).all()
    far = edge_distance(ground, begin, 0.5)
    assert (far[~free] <= 0.004).all()


@EVERY
def test_no_edges_in_an_empty_box(name):
    assert len(GROUNDS[name]().edges((0.0, 1.0), (0.0, 0.5))) == 0


@EVERY
@given(x=st.floats(-5.0, 5.0), z=st.floats(-3.0, 8.0), heading=st.floats(-4.0, 4.0))
def test_heel_and_ball_of_a_foot_stand_on_it(name, x, z, heading):
    """Away from edges; N is on their line, the heading stays."""
    ground = GROUNDS[name]()
    place = np.array([x, z])
    plane = foot_plane(ground, place, heading, heel=0.06, ball=0.13)
    lengths = [np.linalg.norm(v) for v in (plane.forward, plane.normal)]
    assert lengths == pytest.approx([1.0, 1.0], abs=1e-12)
    assert plane.forward @ plane.normal == pytest.approx(0.0, abs=1e-12)
    assert plane.normal[1] > 0.0
    assert plane.forward[[0, 2]] / np.hypot(plane.forward[0], plane.forward[2]) == pytest.approx(
        [np.sin(heading), np.cos(heading)], abs=1e-12
    )
    assert np.array_equal(plane.position[[0, 2]], place)
    np.testing.assert_allclose(plane.ball - plane.position, 0.13 * plane.forward, atol=1e-12)
    np.testing.assert_allclose(plane.position - plane.heel, 0.06 * plane.forward, atol=1e-12)
    if np.isfinite(edge_distance(ground, place, 0.25)):
        assert plane.bears.any()
        return
    assert plane.bears.all()
    for point in (plane.heel, plane.ball):
        assert point[1] == pytest.approx(float(ground.height(point[0], point[2])), abs=1e-9)


@EVERY
def test_many_feet_at_once_stand_as_each(name):
    ground = GROUNDS[name]()
    rng = np.random.default_rng(5)
    place, heading = rng.uniform(-4.0, 6.0, (3, 4, 2)), rng.uniform(-4.0, 4.0, (3, 4))
    every = foot_plane(ground, place, heading, heel=0.06, ball=0.13)
    for index in np.ndindex(3, 4):
        one = foot_plane(ground, place[index], float(heading[index]), heel=0.06, ball=0.13)
        np.testing.assert_allclose(one.position, every.position[index], atol=1e-12)
        np.testing.assert_allclose(one.normal, every.normal[index], atol=1e-12)
        assert np.array_equal(one.bears, every.bears[index])
    none = foot_plane(ground, np.empty((0, 2)), np.empty(0), heel=0.06, ball=0.13)
    assert none.position.shape == (0, 3)
