"""The parts of the contact stage, each by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from people import GROUND, people, person
from step_generator import turn

from gaitsmith.body.sole import roll
from gaitsmith.contact.foothold import footholds, sole_in_air
from gaitsmith.contact.plan import plan_contact
from gaitsmith.contact.reach import (
    REACH,
    REAR_REACH,
    SWING_REACH,
    drawn_near,
    lowering,
    raised_heel,
)
from gaitsmith.errors import InvalidInputError, LegReachError
from gaitsmith.geometry.rotations import about, multiply
from gaitsmith.ground import Flat

BODY = person(1.75)
LEG = BODY.leg_length
angles = st.floats(-0.8, 0.5)
headings = st.floats(-7.0, 7.0)


class Slope(Flat):
    """y = 0.2 z, as a ground of the tests."""

    def height(self, x, z):
        return 0.2 * np.asarray(z) + 0.0 * np.asarray(x)

    def normal(self, x, z):
        out = np.zeros((*np.broadcast_shapes(np.shape(x), np.shape(z)), 3))
        out[...] = np.array([0.0, 1.0, -0.2]) / np.hypot(1.0, 0.2)
        return out


# footholds -------------------------------------------------------------------------------


@given(who=people(), heading=headings, x=st.floats(-9, 9), z=st.floats(-9, 9))
def test_a_flat_foot_stands_over_its_n(who, heading, x, z):
    n = np.array([[x, 0.0, z]])
    stand = footholds(n, np.array([heading]), GROUND)
    ankle = stand.ankle(who.foot, np.zeros(1), np.zeros(1))
    np.testing.assert_allclose(ankle, n + [0.0, who.foot.ankle_height, 0.0], atol=1e-12)
    assert not stand.tilt.any()


@given(heading=headings)
def test_a_foothold_on_a_slope_lies_in_its_plane(heading):
    n = np.array([[1.0, 0.4, 2.0]])
    stand = footholds(n, np.array([heading]), Slope())
    forward, normal = stand.forward[0], stand.normal[0]
    assert forward @ normal == pytest.approx(0.0, abs=1e-12)
    assert forward[1] == pytest.approx(0.2 * forward[2], abs=1e-12)
    assert np.arctan2(forward[0], forward[2]) == pytest.approx(
        np.angle(np.exp(1j * heading)), abs=1e-9
    ), "its heading seen from above"
    ankle = stand.ankle(BODY.foot, np.zeros(1), np.zeros(1))[0]
    np.testing.assert_allclose(ankle, n[0] + BODY.foot.ankle_height * normal, atol=1e-12)


# the foot in the air ---------------------------------------------------------------------


@given(who=people(), pitch=st.floats(-0.9, 0.0), meta=st.floats(0.0, 0.9))
def test_a_foot_leaves_the_ground_as_it_stood_on_it(who, pitch, meta):
    """The free foot of the same pitch and bend is the supported foot."""
    if pitch == 0.0:
        meta = 0.0
    stood = roll(who.foot, np.array(pitch), np.array(meta))
    bend = np.array(-pitch - meta)
    free = sole_in_air(who.foot, stood.ankle[1], np.array(pitch), bend)
    for name in ("heel", "ball", "toe"):
        there = getattr(free, name) + [stood.ankle[0], 0.0]
        np.testing.assert_allclose(there, getattr(stood, name), atol=1e-12, err_msg=name)


@given(who=people(), height=st.floats(0.0, 0.5), pitch=angles, bend=st.floats(0.0, 1.0))
def test_a_free_foot_keeps_its_shape(who, height, pitch, bend):
    foot = who.foot
    sole = sole_in_air(foot, np.array(height), np.array(pitch), np.array(bend))
    assert np.linalg.norm(sole.ball - sole.heel) == pytest.approx(foot.heel_ball)
    assert np.linalg.norm(sole.ankle - sole.heel) == pytest.approx(foot.ankle_heel)
    assert np.linalg.norm(sole.ankle - sole.ball) == pytest.approx(foot.ankle_ball)
    tip = np.hypot(foot.toes, foot.toe_joint_height)
    assert np.linalg.norm(sole.toe - sole.toe_joint) == pytest.approx(tip)
    assert sole.ankle[1] == pytest.approx(height)


# reach -----------------------------------------------------------------------------------


def straight_line(count=121, steps=2.0):
    """Hips over a standing left ankle; the right one does not bear."""
    at = np.linspace(0.0, steps, count)
    hip = np.zeros((count, 2, 3))
    hip[..., 1] = 0.09 + 0.95 * LEG
    ankle = np.zeros((count, 2, 3))
    ankle[..., 1] = 0.09
    slack = np.zeros((count, 2))
    slack[:, 1] = np.inf
    return at, hip, ankle, slack


def test_hips_within_reach_stay_where_they_are():
    at, hip, ankle, slack = straight_line()
    assert not lowering(at, hip, ankle, slack, leg_length=LEG).any()


def test_hips_come_down_enough_and_smoothly():
    at, hip, ankle, slack = straight_line()
    hip[40:61, :, 1] += 0.08 * LEG
    down = lowering(at, hip, ankle, slack, leg_length=LEG)
    left = np.linalg.norm(hip[:, 0] - ankle[:, 0], axis=-1) - down
    assert left.max() <= REACH * LEG + 1e-9
    assert down.min() > -1e-12
    assert down.max() < 0.08 * LEG
    assert not down[:20].any(), "only around the need"
    assert np.abs(np.diff(down, 2)).max() < 1e-3, "no corner"


def test_a_foot_that_does_not_bear_pulls_nobody_down():
    at, hip, ankle, slack = straight_line()
    ankle[:, 1, 1] -= 0.5
    assert not lowering(at, hip, ankle, slack, leg_length=LEG).any()


def test_a_foot_that_may_follow_pulls_less():
    at, hip, ankle, slack = straight_line()
    hip[..., 1] += 0.08 * LEG
    stiff = lowering(at, hip, ankle, slack, leg_length=LEG)
    slack[:, 0] = 0.01
    np.testing.assert_allclose(lowering(at, hip, ankle, slack, leg_length=LEG), stiff - 0.01)


def test_a_foot_out_of_any_reach_is_refused():
    at, hip, ankle, slack = straight_line()
    ankle[70:, 0, 2] += 1.2 * LEG
    with pytest.raises(LegReachError, match=r"step 1 \(left\)") as caught:
        lowering(at, hip, ankle, slack, leg_length=LEG)
    assert caught.value.needed > caught.value.available


@given(who=people(), back=st.floats(0.2, 0.75), up=st.floats(0.9, 1.0))
def test_a_raised_heel_reaches(who, back, up):
    """The first angle that fits, none where the leg reaches, the largest where none fits."""
    foot, leg = who.foot, who.leg_length
    stand = footholds(np.zeros((1, 3)), np.zeros(1), GROUND)
    hip = np.array([[0.0, foot.ankle_height + up * leg, back * leg]])
    pitch, meta = np.array([-0.1]), np.array([0.0])

    def far(more):
        ankle = stand.ankle(foot, pitch - more, meta)
        return np.linalg.norm(ankle - hip) / leg - REAR_REACH

    extra = raised_heel(foot, stand, hip, pitch, meta, leg_length=leg)
    if far(0.0) <= 0.0:
        assert extra[0] == 0.0
    elif extra[0] < 0.8:
        assert far(extra[0]) == pytest.approx(0.0, abs=1e-6)
    else:
        assert min(far(more) for more in np.linspace(0.0, 0.8, 30)) > -1e-6


def test_an_ankle_is_drawn_near_along_the_leg():
    hip = np.zeros((2, 3))
    ankle = np.array([[0.0, -0.9 * LEG, 0.0], [0.0, -1.2 * LEG, 0.0]])
    near = drawn_near(hip, ankle, np.full(2, 0.5), np.full((2, 2), 0.9 * LEG), BODY)
    np.testing.assert_allclose(near[0], ankle[0], atol=1e-6)  # out of the soft limit's way
    assert np.linalg.norm(near[1]) == pytest.approx(SWING_REACH * LEG, abs=1e-9)
    assert np.abs(near[:, [0, 2]]).max() == 0.0


@given(off=st.floats(0.9, REAR_REACH), strike=st.floats(0.9, REACH), far=st.floats(0.98, 1.05))
def test_a_swinging_leg_is_in_reach_from_toe_off_to_heel_strike(off, strike, far):
    """Ends are kept; between them no leg is straight, however far its foot is proposed."""
    u = np.linspace(0.0, 1.0, 401)
    away = LEG * (off + (strike - off) * u + (far - off) * np.clip(40.0 * u * (1.0 - u), 0.0, 1.0))
    ankle = np.stack([np.zeros_like(u), -away, np.zeros_like(u)], axis=-1)
    ends = np.repeat([[off * LEG], [strike * LEG]], len(u), axis=1)
    near = np.linalg.norm(drawn_near(np.zeros_like(ankle), ankle, u, ends, BODY), axis=-1) / LEG
    assert near[[0, -1]] == pytest.approx(away[[0, -1]] / LEG, abs=1e-12)
    assert near.max() < 0.99965


# the whole -------------------------------------------------------------------------------


def test_a_walk_without_steps_is_none():
    with pytest.raises(InvalidInputError, match="at least one step"):
        plan_contact([], BODY, GROUND)


def one_step():
    from people import straight_plan, the_walk

    from gaitsmith.synthesis.step import WalkerState
    from gaitsmith.synthesis.straight import StraightGenerator

    plan = straight_plan(BODY, start="walk", stop="walk")
    generator = StraightGenerator(the_walk(), GROUND)
    return generator.prepare(BODY, WalkerState(), plan.steps()[0]).reference


def test_a_step_whose_foot_leaves_between_samples_is_refused():
    with pytest.raises(InvalidInputError, match="phase must hold toe_off"):
        replace(one_step(), toe_off=0.123456)


def test_a_landing_foot_is_put_where_the_ground_is():
    """The proposal is for one foothold; another near it is met exactly all the same."""
    step = one_step()
    heading = step.target_heading + 0.1
    moved = replace(step, target=step.target + [0.01, 0.0, -0.02], target_heading=heading)
    poses = plan_contact([moved], BODY, GROUND).poses(np.array([1.0]))
    swing, foot = 1 - step.stance, BODY.foot
    hip = poses.center + turn(
        poses.pelvis, [(0.5 if swing == 0 else -0.5) * BODY.hip_width, 0.0, 0.0]
    )
    knee = hip + turn(poses.thigh[:, swing], [0.0, -BODY.thigh, 0.0])
    ankle = knee + turn(poses.shin[:, swing], [0.0, -BODY.shin, 0.0])
    heel = ankle + turn(poses.foot[:, swing], [0.0, -foot.ankle_height, -foot.heel])
    ahead = np.array([np.sin(heading), 0.0, np.cos(heading)])
    np.testing.assert_allclose(heel[0], moved.target - foot.heel * ahead, atol=1e-9)


def sole_at(step, phases):
    """World positions of heel, ball and toe tip of the swinging foot."""
    poses = plan_contact([step], BODY, GROUND).poses(np.asarray(phases))
    swing, foot = 1 - step.stance, BODY.foot
    side = 0.5 if swing == 0 else -0.5
    hip = poses.center + turn(poses.pelvis, [side * BODY.hip_width, 0.0, 0.0])
    knee = hip + turn(poses.thigh[:, swing], [0.0, -BODY.thigh, 0.0])
    ankle = knee + turn(poses.shin[:, swing], [0.0, -BODY.shin, 0.0])
    world = poses.foot[:, swing]
    ball = ankle + turn(world, [0.0, -foot.ankle_height, foot.ball])
    toes = multiply(world, about("x", -poses.bend[:, swing]))
    return (
        ankle + turn(world, [0.0, -foot.ankle_height, -foot.heel]),
        ball,
        ball + turn(toes, [0.0, 0.0, foot.toes]),
    )


def swung(step):
    """0 up to toe-off, 1 at heel strike."""
    return np.clip((step.curves.phase - step.toe_off) / (1.0 - step.toe_off), 0.0, 1.0)


@pytest.mark.parametrize("curl", [0.0, 0.5])
def test_the_toe_tip_leaves_the_ground_without_dipping_into_it(curl):
    """Toes that begin to straighten at once, too: at toe-off they turn on as they rolled."""
    step = one_step()
    swing, off = 1 - step.stance, step.toe_off
    bend = np.array(step.curves.bend)
    bend[:, swing] *= 1.0 - curl * np.clip(20.0 * swung(step), 0.0, 1.0)
    step = replace(step, curves=step.curves.with_(bend=bend))
    tip = sole_at(step, off + np.array([0.0, 1e-6, *np.linspace(0.0, 0.2, 400)]))[2]
    assert abs(tip[1, 2] - tip[0, 2]) < 2e-11  # ahead, meters in a millionth of a step
    assert tip[2:, 1].min() > -1e-9


def test_a_foot_that_comes_down_fast_does_not_dip_before_it_lands():
    step = one_step()
    swing, u = 1 - step.stance, swung(step)
    pitch, ankle = np.array(step.curves.pitch), np.array(step.curves.ankle)
    late = np.clip((0.98 - u) / 0.05, 0.0, 1.0) * np.clip((u - 0.4) / 0.2, 0.0, 1.0)
    pitch[:, swing] -= 0.5 * late
    ankle[:, swing, 1] += 0.06 * late
    step = replace(step, curves=step.curves.with_(pitch=pitch, ankle=ankle))
    points = sole_at(step, np.linspace(step.toe_off + 0.1, 1.0, 2000))
    assert min(p[:, 1].min() for p in points) > -2e-4


def test_a_flat_foot_whose_toes_would_hang_is_raised_as_well():
    """A sole that is level lies flat, whatever its toes are to do next."""
    stand = footholds(np.zeros((1, 3)), np.zeros(1), GROUND)
    hip = np.array([[0.0, BODY.foot.ankle_height + 0.89 * LEG, 0.455 * LEG]])
    pitch, meta = np.zeros(1), np.full(1, 0.13)
    flat = np.linalg.norm(stand.ankle(BODY.foot, pitch, meta) - hip)
    assert flat > (REAR_REACH + 1e-4) * LEG
    extra = raised_heel(BODY.foot, stand, hip, pitch, meta, leg_length=LEG)
    assert extra[0] > 0.0
    raised = np.linalg.norm(stand.ankle(BODY.foot, pitch - extra, meta) - hip)
    assert raised < (REAR_REACH + 1e-6) * LEG
