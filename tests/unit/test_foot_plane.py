"""How a foot stands: numbers worked by hand; tests/conformance asks it of every ground."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.conventions import ahead
from gaitsmith.ground import Flat, HeightField, Slope, Stairs, foot_plane

HEEL, BALL = 0.06, 0.14


def stand(ground, x, z, heading=0.0):
    return foot_plane(ground, np.array([x, z]), heading, heel=HEEL, ball=BALL)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
def test_on_level_ground_it_is_level_to_the_last_bit(heading):
    plane = stand(Flat(0.3), 1.0, 2.0, heading)
    assert plane.position.tolist() == [1.0, 0.3, 2.0]
    assert np.array_equal(plane.forward, ahead(heading))
    assert plane.normal.tolist() == [0.0, 1.0, 0.0]
    assert plane.bears.all()
    assert plane.pitch == plane.roll == 0.0


def test_up_a_slope_it_pitches_and_across_it_rolls():
    angle = np.radians(12.0)
    up = stand(Slope(12.0), 0.3, 2.0)
    assert up.pitch == pytest.approx(angle, abs=1e-14)
    assert up.roll == pytest.approx(0.0, abs=1e-14)
    assert up.position[1] == pytest.approx(2.0 * np.tan(angle), abs=1e-14)
    down = stand(Slope(12.0), 0.3, 2.0, np.pi)
    assert down.pitch == pytest.approx(-angle, abs=1e-14)
    # facing +X, the hill is to the right
    across = stand(Slope(12.0), 0.3, 2.0, 0.5 * np.pi)
    assert across.roll == pytest.approx(-angle, abs=1e-14)
    np.testing.assert_allclose(across.normal, Slope(12.0).normal(0.0, 0.0), atol=1e-14)


def test_the_whole_plane_is_that_of_the_slope_at_any_heading():
    heading = np.linspace(-3.0, 3.0, 13)
    place = np.stack([np.linspace(-1.0, 1.0, 13), np.linspace(0.0, 2.0, 13)], axis=-1)
    plane = foot_plane(Slope(-35.0), place, heading, heel=HEEL, ball=BALL)
    normal = np.tile(Slope(-35.0).normal(0.0, 0.0), (13, 1))
    np.testing.assert_allclose(plane.normal, normal, atol=1e-13)


def test_lengths_count_along_the_sole():
    """On 45 deg the heel is HEEL cos 45 behind N as seen from above, not HEEL."""
    plane = stand(Slope(45.0), 0.0, 1.0)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(plane.heel, [0.0, 1.0 - HEEL * half, 1.0 - HEEL * half], atol=1e-14)
    np.testing.assert_allclose(plane.ball, [0.0, 1.0 + BALL * half, 1.0 + BALL * half], atol=1e-14)


def test_on_a_crest_heel_and_ball_touch_and_n_is_in_the_air_or_the_ground():
    """Height z^2 in fine cells: the sole is a chord of the bowl, N where the chord puts it."""
    z = np.arange(-200, 201) * 0.005
    bowl = HeightField(np.tile((z * z)[:, None], (1, 401)), 0.005, (-1.0, -1.0))
    plane = stand(bowl, 0.0, 0.0)
    assert plane.bears.all()
    # chord from z1 to z2 has slope z1 + z2 and is z1 z2 below 0 at z = 0
    z1, z2 = plane.heel[2], plane.ball[2]
    assert np.tan(plane.pitch) == pytest.approx(z1 + z2, abs=1e-4)
    assert plane.position[1] == pytest.approx(-z1 * z2, abs=1e-5)
    assert plane.position[1] > 0.008


def test_a_pebble_beside_the_ball_does_not_tilt_the_foot():
    heights = np.zeros((40, 40))
    heights[20, 23] = 0.015
    ground = HeightField(heights, 0.01, (-0.2, -0.2))
    assert stand(ground, 0.0, -BALL).roll == 0.0


def test_heel_over_the_edge_of_stairs():
    """Up: the ball on the tread, the heel hangs 3 cm out: the foot is level, the heel bears not."""
    stairs = Stairs(0.17, 0.29, 5)
    plane = stand(stairs, 0.0, 1.29 + HEEL - 0.03)
    np.testing.assert_allclose(plane.position, [0.0, 0.34, 1.29 + HEEL - 0.03], atol=1e-14)
    assert plane.normal.tolist() == [0.0, 1.0, 0.0]
    assert plane.bears.tolist() == [False, True]
    assert plane.heel[1] == pytest.approx(0.34)


def test_ball_over_the_edge_of_stairs():
    """Down: the ball is beyond the nosing, the heel bears, level."""
    plane = stand(Stairs(-0.15, 0.3, 5), 0.0, 1.3 - BALL + 0.02)
    assert plane.position[1] == pytest.approx(-0.15)
    assert plane.pitch == 0.0
    assert plane.bears.tolist() == [True, False]


def test_treads_shorter_than_the_foot_carry_it_on_the_highest():
    plane = stand(Stairs(0.1, 0.09, 9), 0.0, 1.2)
    highest = float(Stairs(0.1, 0.09, 9).height(0.0, 1.2 + BALL))
    assert plane.position[1] == pytest.approx(highest)
    assert plane.bears.tolist() == [False, True]


def test_a_kerb_on_a_slope_keeps_the_slope():
    """Upper side of a kerb of 10 cm in a field that rises by 0.1."""
    z = np.arange(200) * 0.01
    heights = np.tile((0.1 * z + 0.1 * (z >= 1.0))[:, None], (1, 50))
    plane = stand(HeightField(heights, 0.01, (-0.25, 0.0)), 0.0, 0.97)
    assert np.tan(plane.pitch) == pytest.approx(0.1, abs=1e-9)
    assert plane.ball[1] == pytest.approx(0.1 * plane.ball[2] + 0.1, abs=1e-9)
    assert plane.bears.tolist() == [False, True]
