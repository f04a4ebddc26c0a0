"""Swings over edges, how well a foot stands, and what slopes do to steps."""

from __future__ import annotations

import numpy as np
import pytest
from people import person

from gaitsmith.body.sole import hanging_toes, roll, rolled_ankle
from gaitsmith.contact.over_edges import SAMPLES, beam, bending, warped
from gaitsmith.contact.standing import standing
from gaitsmith.ground import HeightField, Slope, Stairs
from gaitsmith.plan.footing import footing
from gaitsmith.plan.slopes import speed_share, step_length_share

FOOT = person(1.75).foot


def test_a_beam_stays_above_and_is_straight_where_nothing_is_needed():
    u = np.linspace(0.0, 1.0, SAMPLES)
    need = np.full((3, SAMPLES), -1.0)
    need[1, 20:28] = 0.1
    need[2, 10:15], need[2, 30:40] = 0.08, 0.03
    lift = beam(need)
    assert not lift[0].any()
    assert (need - lift).max() < 0.001
    assert np.abs(lift[:, [0, -1]]).max() == 0.0
    # the least bent curve over a plateau is no higher than it must be
    assert lift[1].max() < 0.108
    assert bending(lift)[1] < bending(0.1 * np.sin(np.pi * u)[None] ** 8)[0]


@pytest.mark.parametrize("by", [-0.4, -0.1, 0.0, 0.3])
def test_a_warped_swing_leaves_and_arrives_as_ever(by):
    u = np.linspace(0.0, 1.0, 2001)
    shown = warped(u, by)
    assert shown[[0, -1]].tolist() == [0.0, 1.0]
    assert (np.diff(shown) >= 0.0).all()
    assert (shown[1] - shown[0]) / u[1] == pytest.approx(1.0, abs=5e-3)


def test_a_foot_whose_toes_hang_rolls_on_its_ball():
    pitch = np.linspace(-1.0, 0.0, 5)
    ankle = rolled_ankle(FOOT, pitch, 0.0 * pitch, None, np.ones(5, dtype=bool))
    to_ball = ankle - [FOOT.ball, 0.0]
    np.testing.assert_allclose(np.linalg.norm(to_ball, axis=-1), FOOT.ankle_ball, atol=1e-15)
    flat = rolled_ankle(FOOT, np.zeros(1), np.zeros(1))[0]
    np.testing.assert_allclose(ankle[-1], flat, atol=1e-15)
    # toes beside a joint at the sole keep level
    if FOOT.toe_joint_height == 0.0:
        np.testing.assert_allclose(hanging_toes(FOOT, pitch), -pitch, atol=1e-15)


def test_raised_toes_carry_the_foot_as_flat_ones_do_where_they_are_not_raised():
    pitch, meta = np.linspace(-1.2, 0.3, 7), np.linspace(0.4, 0.0, 7)
    plain = roll(FOOT, pitch, meta).ankle
    np.testing.assert_allclose(rolled_ankle(FOOT, pitch, meta, np.zeros(7)), plain, atol=1e-15)


def test_toes_bend_until_their_tip_touches():
    z = np.arange(-1.0, 2.0, 0.02)
    field = HeightField(np.tile(0.3 * z[:, None] ** 2, (1, 11)), 0.02, (-0.1, -1.0))
    stand = standing(np.array([[0.0, 0.0, 0.4]]), np.zeros(1), field, FOOT)
    raised = stand.toes[0]
    assert raised > 0.02
    joint = stand.place(np.array([FOOT.ball, FOOT.toe_joint_height]))[0]
    forward, up = FOOT.toes * np.cos(raised), FOOT.toes * np.sin(raised)
    tip = joint + forward * stand.forward[0] + up * stand.normal[0]
    assert tip[1] == pytest.approx(float(field.height(tip[0], tip[2])), abs=1e-9)


def test_toes_just_over_an_edge_reach_over_it_and_do_not_bend_round():
    """The edge of a field is a ramp of one cell: the tip is over its upper part."""
    height = np.zeros((201, 11))
    height[:100] = 0.05
    field = HeightField(height, 0.02, (-0.1, -1.0))
    edge = -1.0 + 99 * 0.02
    n = np.array([[0.0, 0.0, edge + 0.006 - FOOT.ball - FOOT.toes]])
    stand = standing(n, np.zeros(1), field, FOOT)
    assert stand.bears.tolist() == [[True, True, False]]
    assert stand.toes.tolist() == [0.0]


def test_on_a_tread_the_foot_stands_and_at_its_edges_it_hangs():
    stairs = Stairs(0.17, 0.30, 5)
    z = 1.0 + np.array([0.08, 0.03, -0.04, 0.16])
    found = footing(stairs, np.stack([0.0 * z, z], axis=-1), 0.0 * z, FOOT)
    # well on it; heel over the edge, a little and too much; toes in the next riser
    assert found.stands.tolist() == [True, True, True, False]
    assert found.hangs[0] == 0.0
    assert 0.1 < found.hangs[1] < 0.3
    assert found.hangs[2] > 0.35
    assert found.crowded[0] < 1.0


def test_standing_on_a_slope_bears_whole():
    slope = Slope(12.0)
    found = footing(slope, np.array([[0.3, 1.0]]), np.array([0.7]), FOOT)
    assert found.stands.all()
    assert found.hangs[0] == 0.0
    assert found.slope[0] == pytest.approx(np.tan(np.radians(12.0)), abs=1e-12)
    assert found.rough[0] < 1e-12


def test_slopes_shorten_and_slow():
    rho = np.tan(np.radians([-10.0, 0.0, 10.0]))
    np.testing.assert_allclose(step_length_share(rho), [0.552 / 0.625, 1.0, 0.604 / 0.625])
    assert speed_share(rho) == pytest.approx([0.93, 1.0, 0.85])
