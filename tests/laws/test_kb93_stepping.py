"""[KB93]: regions, foot angles, swings, heights and turnarounds; acceptance 12 to 15."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from people import GROUND, person, the_walk
from step_generator import legs

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.plan.footsteps import Footstep, LocalStep
from gaitsmith.plan.stepping import classify, local_step, step_region, turnaround, turning_side
from gaitsmith.plan.timeline import Timeline
from gaitsmith.synthesis.local_curves import (
    FootAngles,
    backward_height,
    eased,
    forward_height,
    lateral_height,
    swing_lift,
)
from gaitsmith.synthesis.local_upper import NECK, SPINE, glanced
from gaitsmith.synthesis.step import WalkerState, prepare_walk
from gaitsmith.synthesis.stepping import LocalGenerator
from gaitsmith.walks.model import StepRequest

ADULT = person(1.75)
T = np.linspace(0.0, 1.0, 41)
ANGLES = st.floats(-3.1, 3.1)


def foot(side, x, z, direction=0.0, toe_out=0.1):
    heading = direction + SIDE_SIGN[side] * toe_out
    return Footstep(side, np.array([x, 0.0, z]), heading, direction, 0.0, np.array([x, z]))


def feet(width=0.1):
    return foot(LEFT, 0.5 * width, 0.0), foot(RIGHT, -0.5 * width, 0.0)


def stepped(target, *, body=ADULT, how=None, duration=0.9, following=None, width=0.1):
    """One step of ``target``'s foot, and how it is prepared."""
    left, right = feet(width)
    stance, origin = (left, right) if target.side == RIGHT else (right, left)
    step = local_step(stance, origin, target, duration, how, foot=body.foot, following=following)
    return step, LocalGenerator(the_walk(), GROUND).prepare(body, WalkerState(), step)


# 14: regions -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("degrees", "region"),
    [
        (-170, "backward"),
        (-151, "backward"),
        (-149, None),
        (-90, None),
        (-31, None),
        (-29, "forward"),
        (0, "forward"),
        (55, "forward"),
        (65, "lateral"),
        (90, "lateral"),
        (115, "lateral"),
        (125, "backward"),
        (180, "backward"),
    ],
)
def test_where_a_step_leads_says_its_kind(degrees, region):
    assert step_region(np.radians(degrees)) == region
    assert step_region(np.radians(degrees + 360.0)) == region


@pytest.mark.parametrize(("line", "beyond"), [(60.0, "forward"), (120.0, "backward")])
@pytest.mark.parametrize("off", [-2.9, 0.0, 2.9])
def test_at_a_boundary_a_foot_that_stays_parallel_steps_aside(line, beyond, off):
    assert step_region(np.radians(line + off), np.radians(19.0)) == "lateral"
    assert step_region(np.radians(line + off), np.radians(-21.0)) == beyond


def test_a_step_that_would_cross_the_legs_is_refused_with_the_reason():
    with pytest.raises(InfeasibleError, match=r"left foot would land -90 deg .* legs would cross"):
        classify(np.zeros(3), 0.0, np.array([-0.3, 0.0, 0.0]), 0.0, LEFT)
    with pytest.raises(InfeasibleError, match="set on the right one"):
        stepped(foot(LEFT, -0.03, 0.2))


def test_legs_that_would_stay_crossed_too_near_are_refused():
    left, right = feet()
    far, near = foot(LEFT, -0.12, 0.5), foot(LEFT, -0.13, -0.25, -0.5)
    kept = local_step(right, left, far, 0.9, foot=ADULT.foot, hip_width=ADULT.hip_width)
    assert kept.kind == "forward"
    with pytest.raises(InfeasibleError, match=r"stay crossed, 0\.\d+ m one behind the other"):
        local_step(right, left, near, 0.9, foot=ADULT.foot, hip_width=ADULT.hip_width)


@given(ANGLES, ANGLES, st.floats(0.05, 1.0))
@settings(max_examples=60)
def test_left_and_right_are_mirror_images(angle, direction, way):
    """And the region does not depend on where the person faces."""

    def kind(side):
        target = way * (
            np.cos(angle) * ahead(direction) + SIDE_SIGN[side] * np.sin(angle) * leftward(direction)
        )
        try:
            return classify(np.zeros(3), direction, target, 0.5, side)
        except InfeasibleError:
            return None

    assert kind(LEFT) == kind(RIGHT) == step_region(angle, 0.5)


# 12: the swing -----------------------------------------------------------------------------------


@pytest.mark.parametrize("swhf", [0.0, 1.0, 2.5])
def test_equation_3_counts_centimeters_and_peaks_in_the_middle_of_the_swing(swhf):
    lift = swing_lift(np.array([0.0, 0.5, 1.0]), swhf)
    np.testing.assert_allclose(lift, [0.0, 0.05 * swhf, 0.0], atol=1e-14)
    u = np.linspace(0.0, 1.0, 101)
    np.testing.assert_allclose(
        swing_lift(u), 0.2 * u * (1.0 - u), atol=0.27e-3, err_msg="nearly a parabola"
    )
    printed = 5.0 * (np.e**0.5 + np.e**-0.5 - np.exp(u - 0.5) - np.exp(0.5 - u))
    np.testing.assert_allclose(
        swing_lift(u), 0.01 * printed / (np.e**0.5 + np.e**-0.5 - 2.0), atol=1e-15
    )


KINDS = {
    "forward": foot(RIGHT, -0.05, 0.5),
    "backward": foot(RIGHT, -0.06, -0.35),
    "lateral": foot(RIGHT, -0.5, 0.05),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("body", [1.25, 1.75, "child"], ids=str)
def test_footpos_is_reached_and_the_other_foot_does_not_move(kind, body):
    body = person(body)
    target = replace(KINDS[kind], position=KINDS[kind].position * body.height / 1.75)
    flat = LocalStep(angles=(0.0, 0.0, -0.2))
    step, prepared = stepped(target, body=body, how=flat)
    assert step.kind == kind
    poses = prepared.poses(np.array([0.0, 0.3, 0.5, 0.8, 1.0]))
    ankles, soles = legs(poses, body)
    heel = target.position - body.foot.heel * ahead(target.heading)
    np.testing.assert_allclose(soles[-1, RIGHT, 0], heel, atol=1e-9)
    np.testing.assert_allclose(soles[:, LEFT] - soles[0, LEFT], 0.0, atol=1e-12)
    np.testing.assert_allclose(ankles[:, LEFT] - ankles[0, LEFT], 0.0, atol=1e-12)


def test_the_height_of_the_swing_is_above_the_line_between_its_ends():
    """Erratum D16: 5 cm is not counted from the floor, so toes up and down matter."""
    heights = []
    for angles in ((0.0, 0.0, 0.0), (0.0, 0.0, -0.5)):
        _, prepared = stepped(KINDS["forward"], how=LocalStep(swing_height=1.0, angles=angles))
        curves = prepared.reference.curves
        free = curves.phase >= prepared.reference.toe_off
        up = curves.ankle[free, RIGHT, 1]
        share = smoothstep(np.linspace(0.0, 1.0, int(free.sum())))
        line = up[0] + share * (up[-1] - up[0])
        assert (up - line).max() == pytest.approx(0.05, abs=1e-3)
        heights.append(up.max())
    assert heights[1] > heights[0] + 0.01


# 13, 14: heights ---------------------------------------------------------------------------------


@given(st.floats(0.7, 1.0), st.floats(0.7, 1.0), st.integers(0, 1000))
@settings(max_examples=40)
def test_equations_4_and_5_meet_both_ends(begin, end, seed):
    walked = 0.9 + 0.02 * np.cumsum(np.random.default_rng(seed).normal(size=len(T))) / 5.0
    for law in (forward_height, backward_height):
        height = law(T, walked, begin, end)
        assert height[0] == pytest.approx(begin, abs=1e-12)
        assert height[-1] == pytest.approx(end, abs=1e-12)
    # both ends corrected alike: the backward step is the forward one reversed, in time
    forward = forward_height(T, walked, walked[0] + 0.01, walked[-1] + 0.01)
    backward = backward_height(T, walked, walked[-1] + 0.01, walked[0] + 0.01)
    np.testing.assert_allclose(backward, forward[::-1], atol=1e-12)


def test_equation_5_is_read_in_time_not_by_index():
    """``h_(n-i+1)`` is the reversed step only for samples symmetric in time."""
    t = T**1.7
    walked = 0.9 + 0.03 * np.sin(np.pi * t) * t
    height = backward_height(t, walked, walked[-1], walked[0])
    np.testing.assert_allclose(height, 0.9 + 0.03 * np.sin(np.pi * t) * (1.0 - t), atol=2e-4)
    assert np.abs(height - walked[::-1]).max() > 0.002


@given(st.floats(0.1, 0.4), st.floats(0.0, 0.1))
@settings(max_examples=40)
def test_a_lateral_step_lowers_the_hips_when_the_feet_part_and_raises_them_when_they_meet(
    far, near
):
    leg, ankle = 0.834, 0.08
    top, low = (ankle + np.sqrt((0.998 * leg) ** 2 - d**2) for d in (near, far))
    apart = lateral_height(T, near + (far - near) * smoothstep(T), top, low, ankle)
    meet = lateral_height(T, far + (near - far) * smoothstep(T), low, top, ankle)
    assert (np.diff(apart) < 1e-12).all()
    assert (np.diff(meet) > -1e-12).all()
    for height, ends in ((apart, (top, low)), (meet, (low, top))):
        np.testing.assert_allclose(height[[0, -1]], ends, atol=1e-12)
    whole = leg * 0.998
    np.testing.assert_allclose(np.hypot(apart - ankle, near + (far - near) * smoothstep(T)), whole)


def test_hips_drop_in_a_side_step_as_people_do():
    """10-13 cm at the widest straddle of 0.6 m (four clips); here a straddle of 0.7 m."""
    side = foot(LEFT, 0.65, 0.0)
    closing = foot(RIGHT, 0.55, 0.0)
    _, prepared = stepped(side, following=closing)
    height = prepared.reference.curves.center[:, 1]
    assert 0.06 < height[0] - height.min() < 0.13
    assert (np.diff(height) < 1e-6).all(), "monotone"


# foot angles -------------------------------------------------------------------------------------


@given(
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.3),
    st.tuples(st.floats(-0.4, 0.0), st.floats(-0.2, 0.3), st.floats(-0.8, 0.2)),
)
@settings(max_examples=40)
def test_foot_angles_pass_through_what_is_asked(stance, swing, angles):
    request = StepRequest(0, 0.4, 0.5, 0.5, 0.6)
    walked = the_walk().step(ADULT, request)
    t = np.array([0.0, 0.4, 1.0])
    pitch = FootAngles.of(t, walked, (stance, swing), angles, 0.4)
    np.testing.assert_allclose(pitch.stance[[0, 2]], [stance, angles[0]], atol=1e-9)
    np.testing.assert_allclose(pitch.swing, [swing, angles[2], angles[1]], atol=1e-9)


def test_hips_go_straight_and_the_pelvis_is_half_of_alpha():
    way = eased(T, np.zeros(2), np.array([0.2, 0.5]), (np.zeros(2), np.zeros(2)))
    np.testing.assert_allclose(way[:, 0] * 0.5, way[:, 1] * 0.2, atol=1e-15)
    step, limited = stepped(KINDS["lateral"])
    printed = LocalGenerator(the_walk(), GROUND, pelvis_limit=np.inf).prepare(
        ADULT, WalkerState(), step
    )
    gap = step.target.position - step.stance.position
    alpha = np.arctan2(gap[2], -gap[0])
    # the right foot leads: its hip goes ahead, so the pelvis turns left
    assert printed.reference.curves.heading[-1] == pytest.approx(0.5 * alpha, abs=1e-12)
    assert abs(limited.reference.curves.heading[-1]) <= np.radians(10.0) + 1e-12


@pytest.mark.parametrize("kind", KINDS)
def test_the_weight_is_over_the_foot_that_stays_before_the_other_leaves(kind):
    """Hips are nearer to the stance foot by half of the way at least, as seen from above."""
    step, prepared = stepped(KINDS[kind])
    reference = prepared.reference
    off = int(np.searchsorted(reference.curves.phase, reference.toe_off))
    hips = (reference.curves.center + reference.origin)[[0, off]]
    across = step.origin.position - step.stance.position
    share = 1.0 - (hips - step.stance.position) @ across / (across @ across)
    assert share[0] == pytest.approx(0.5)
    # aside the push comes from the leg that stays, and the hips are on their way already
    assert share[1] > (0.75 if kind != "lateral" else 0.25)


# 15: turnarounds ---------------------------------------------------------------------------------


def test_a_turn_of_90_degrees_as_in_figure_8():
    """Feet at (0, +-.09) in the paper's frame, x ahead and y left: L (-.18, .09), R (0, .27)."""
    pivot = np.array([-0.09, 0.0, 0.0])
    left, right = turnaround(pivot, 0.0, np.pi / 2.0, hip_width=0.18, kind="dynamic")
    np.testing.assert_allclose(left, [0.09, 0.0, -0.18], atol=1e-15)
    np.testing.assert_allclose(right, [0.27, 0.0, 0.0], atol=1e-15)


@given(
    st.floats(0.05, np.radians(100.0)),
    ANGLES,
    st.floats(0.1, 0.25),
    st.sampled_from(["dynamic", "stationary"]),
)
@settings(max_examples=60)
def test_footprints_of_a_turn_are_the_closed_form(angle, direction, width, kind):
    pivot = np.array([0.3, 0.0, -0.7])
    first, second = turnaround(pivot, direction, angle, hip_width=width, kind=kind)
    back = pivot - width * ahead(direction) + width * leftward(direction)
    np.testing.assert_allclose(first, back, atol=1e-12)
    goal = direction + angle
    beside = back - width * leftward(goal) + (width * ahead(goal) if kind == "dynamic" else 0.0)
    np.testing.assert_allclose(second, beside, atol=1e-12)
    # to the right: the mirror image in the line through the pivot foot
    flip = np.array([-1.0, 1.0, 1.0])
    mirrored = turnaround(flip * pivot, -direction, -angle, hip_width=width, kind=kind)
    np.testing.assert_allclose(mirrored, [flip * first, flip * second], atol=1e-12)
    assert turning_side(angle) == LEFT
    assert turning_side(-angle) == RIGHT


@pytest.mark.parametrize("degrees", [100.1, -180.0, 0.0])
def test_one_turnaround_turns_by_100_degrees_at_most(degrees):
    with pytest.raises(InfeasibleError, match=r"up to 100 deg, got .* turn repeatedly"):
        turnaround(np.zeros(3), 0.0, np.radians(degrees), hip_width=0.18)


def turned(kind, angle=np.pi / 2.0):
    """Hip height of the two steps of a turn to the left, where the feet stand 2 lambda apart."""
    width = ADULT.hip_width
    left, right = foot(LEFT, 0.5 * width, 0.0), foot(RIGHT, -0.5 * width, 0.0)
    places = turnaround(right.position, 0.0, angle, hip_width=width, kind=kind)
    one, two = (
        replace(foot(s, 0.0, 0.0, angle), position=p)
        for s, p in zip((LEFT, RIGHT), places, strict=True)
    )
    first = local_step(right, left, one, 0.7, LocalStep(), foot=ADULT.foot, following=two)
    second = local_step(one, right, two, 0.7, LocalStep(closes=True), foot=ADULT.foot)
    plan = Timeline((replace(first, kind="turn"), replace(second, kind="turn", index=1)))
    generator, state, heights = LocalGenerator(the_walk(), GROUND), WalkerState(), []
    for step in plan.planned:
        done = generator.prepare(ADULT, state, step)
        heights.append(done.reference.curves.center[:, 1])
        state = done.end
    return heights, prepare_walk(plan, generator, ADULT, GROUND)


def test_hips_come_down_in_a_turn_and_rise_only_if_the_feet_close():
    """Erratum D15: "elevated in the recovering step" holds for the stationary type alone."""
    for kind in ("stationary", "dynamic"):
        (first, second), walk = turned(kind)
        assert (np.diff(first) < 1e-9).all()
        assert first[-1] < first[0] - 5e-4
        rise = second[-1] - second[0]
        assert rise > 5e-4 if kind == "stationary" else rise < 0.0
        np.testing.assert_allclose(
            walk.poses(np.array([walk.duration])).heading, np.pi / 2.0, atol=1e-12
        )


# gaze --------------------------------------------------------------------------------------------


def test_two_thirds_of_the_twist_are_in_the_neck_and_the_rest_evenly_in_the_torso():
    for count in (3, 17):
        body = replace(ADULT, spine_segments=count)
        step, _ = stepped(KINDS["forward"])
        looks = LocalStep(glances=((0.6, 0.0, 1.0),))
        prepared = LocalGenerator(the_walk(), GROUND).prepare(
            body, WalkerState(), replace(step, local=looks)
        )
        upper = prepared.reference.curves.upper
        twist = 0.6 - prepared.reference.curves.heading[-1]
        turn = (upper[-1] - upper[0])[:, 1]
        np.testing.assert_allclose(turn[:count], SPINE * twist / count, atol=1e-3)
        np.testing.assert_allclose(turn[count : count + 2], NECK * twist, atol=2e-3)
    np.testing.assert_allclose((2.0 * NECK, SPINE), (2.0 / 3.0, 1.0 / 3.0))


def test_a_glance_eases_from_its_beginning_to_its_end():
    gaze = glanced(T, 0.2, ((1.0, -0.5, 0.5),))
    assert gaze[0] == pytest.approx(0.7), "half way as the step begins"
    assert gaze[-1] == pytest.approx(1.2)
    assert (np.diff(gaze) >= 0.0).all()
