"""What every ground must do; each new one is picked up from its table."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground import GROUNDS, Flat, Ground

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
