"""Seconds to walk phase."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from people import ENDS, person, straight_plan

from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.synthesis.clock import Clock

BODY = person(1.75)


def plan_of(kinds, durations):
    count = len(kinds) + 2
    return StepPlan(
        side=np.arange(count) % 2,
        position=np.zeros((count, 3)),
        heading=np.zeros(count),
        direction=np.zeros(count),
        time=np.concatenate([[0.0, 0.0], np.cumsum(durations)]),
        kinds=tuple(kinds),
    )


@st.composite
def plans(draw):
    """Any kinds in a sensible order; steps up to three times as long as their neighbors."""
    kinds = ["walk"] * draw(st.integers(1, 6))
    if draw(st.booleans()):
        kinds[0] = "start"
    if draw(st.booleans()):
        kinds.append("stop")
    durations = [draw(st.floats(0.45, 1.3)) for _ in kinds]
    return plan_of(kinds, durations)


@given(plan=plans())
def test_phase_never_goes_back(plan):
    clock = Clock.of(plan, rest=0.5)
    phase = clock.walk_phase(np.linspace(0.0, clock.duration, 4001))
    assert np.diff(phase).min() > -1e-12
    assert (phase[0], phase[-1]) == (0.0, len(plan.kinds))


@given(plan=plans())
def test_steps_land_on_time(plan):
    clock = Clock.of(plan)
    np.testing.assert_allclose(
        clock.walk_phase(clock.starts), np.arange(len(plan.kinds) + 1.0), atol=1e-9
    )
    np.testing.assert_allclose(clock.starts[1:], plan.time[2:], rtol=1e-12)
    assert clock.duration == pytest.approx(plan.time[-1])


@given(plan=plans())
def test_the_rate_does_not_jump_where_steps_meet(plan):
    clock, h = Clock.of(plan), 1e-6
    meet = clock.starts[1:-1]

    def rate(shift):
        ends = clock.walk_phase(meet + shift + h), clock.walk_phase(meet + shift - h)
        return (ends[0] - ends[1]) / (2.0 * h)

    # 2 h apart from the joint and from its bookkeeping of a nanosecond
    np.testing.assert_allclose(rate(-3 * h), rate(3 * h), atol=2e-3)


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
def test_a_walk_starts_from_rest_and_comes_to_rest(start, stop):
    clock = Clock.of(straight_plan(BODY, cadence=100.0, start=start, stop=stop))
    end, h = clock.starts[-1], 1e-5
    first = clock.walk_phase(np.array([0.0, h]))
    last = clock.walk_phase(np.array([end - h, end]))
    even = 100.0 / 60.0
    assert np.diff(first)[0] / h == pytest.approx(0.0 if start == "stand" else even, abs=1e-3)
    assert np.diff(last)[0] / h == pytest.approx(0.0 if stop == "stand" else even, abs=1e-3)


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
def test_steps_between_pass_evenly_and_nobody_hurries(start, stop):
    """A start and a stop last longer, so that their easing is never faster than the walk."""
    plan = straight_plan(BODY, cadence=100.0, start=start, stop=stop)
    clock = Clock.of(plan)
    times = np.linspace(0.0, clock.starts[-1], 5001)
    rate = np.gradient(clock.walk_phase(times), times)
    assert rate.max() < 100.0 / 60.0 * (1.0 + 1e-3)
    for i, kind in enumerate(plan.kinds):
        if kind == "walk":
            inside = (times > clock.starts[i] + 0.01) & (times < clock.starts[i + 1] - 0.01)
            np.testing.assert_allclose(rate[inside], 100.0 / 60.0, rtol=1e-9)


def test_one_step_from_stand_to_stand():
    clock = Clock.of(plan_of(["start", "stop"], [0.8, 0.8]))
    phase = clock.walk_phase(np.linspace(0.0, 1.6, 1601))
    assert np.diff(phase).min() >= 0.0
    assert phase[800] == pytest.approx(1.0)


def test_rest_stands_at_the_very_end():
    clock = Clock.of(plan_of(["walk", "stop"], [0.5, 0.7]), rest=0.25)
    assert clock.duration == pytest.approx(1.45)
    times = np.array([1.2 - 1e-10, 1.2, 1.3, 1.45])
    assert clock.walk_phase(times).tolist() == [2.0] * 4
    step, share = clock.position(times)
    assert step.tolist() == [1] * 4
    np.testing.assert_allclose(share, 1.0)


def test_position_is_the_step_and_the_share_of_its_time():
    clock = Clock.of(plan_of(["start", "walk", "stop"], [1.0, 0.5, 0.75]))
    step, share = clock.position(np.array([0.0, 0.25, 1.0 - 1e-10, 1.0, 1.25, 2.25]))
    assert step.tolist() == [0, 0, 1, 1, 1, 2]
    np.testing.assert_allclose(share, [0.0, 0.25, 0.0, 0.0, 0.5, 1.0], atol=1e-9)
