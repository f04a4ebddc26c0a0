"""Step length, cadence and speed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from people import people, person

from gaitsmith.conventions import GRAVITY
from gaitsmith.errors import InfeasibleSpeedError, InvalidInputError
from gaitsmith.plan.pace import Pace, choose_pace, froude, preferred_pace

ADULT = person(1.75)
step_lengths = st.floats(0.3, 0.8)
cadences = st.floats(70.0, 130.0)


@given(length=step_lengths, cadence=cadences)
def test_any_two_give_the_third(length, cadence):
    speed = length * cadence / 60.0
    for asked in (
        {"step_length": length, "cadence": cadence},
        {"step_length": length, "speed": speed},
        {"cadence": cadence, "speed": speed},
        {"step_length": length, "cadence": cadence, "speed": speed},
    ):
        pace = choose_pace(ADULT, **asked)
        assert pace.step_length == pytest.approx(length, rel=1e-12)
        assert pace.cadence == pytest.approx(cadence, rel=1e-12)
        assert pace.speed == pytest.approx(speed, rel=1e-12)
        assert pace.step_duration == pytest.approx(60.0 / cadence, rel=1e-12)


@pytest.mark.parametrize("off", [-0.0099, 0.0, 0.0099])
def test_three_may_disagree_by_a_percent(off):
    pace = choose_pace(ADULT, step_length=0.7, cadence=100.0, speed=0.7 * 100.0 / 60.0 / (1 + off))
    assert (pace.step_length, pace.cadence) == (0.7, 100.0)


@pytest.mark.parametrize("off", [-0.0101, 0.0101, 0.5])
def test_three_that_contradict_are_refused_with_their_numbers(off):
    speed = 0.7 * 100.0 / 60.0 / (1 + off)
    with pytest.raises(
        InvalidInputError, match=r"0\.7 m at cadence 100/min is 1\.167 m/s.*any two"
    ):
        choose_pace(ADULT, step_length=0.7, cadence=100.0, speed=speed)


@pytest.mark.parametrize("name", ["step_length", "cadence", "speed"])
@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf, "fast", None])
def test_a_bad_value_is_named(name, bad):
    if bad is None:
        assert choose_pace(ADULT, **{name: None}) == preferred_pace(ADULT)
        return
    with pytest.raises(InvalidInputError, match=f"{name} must be a positive number"):
        choose_pace(ADULT, **{name: bad})


def test_speed_alone_by_the_walk_ratio():
    """An adult of 1.75 m at 1.35 m/s: .73 m at 110 steps/min, as people do."""
    pace = choose_pace(ADULT, speed=1.35)
    assert pace.speed == pytest.approx(1.35)
    assert pace.step_length == pytest.approx(0.73, abs=0.01)
    assert pace.cadence == pytest.approx(110.7, abs=1.5)
    assert 0.0060 < pace.step_length / pace.cadence < 0.0072  # the published range


@given(who=people(), first=st.floats(0.5, 1.3), second=st.floats(0.5, 1.3))
def test_the_walk_ratio_is_kept_at_any_speed(who, first, second):
    a, b = choose_pace(who, speed=first), choose_pace(who, speed=second)
    assert a.step_length / a.cadence == pytest.approx(b.step_length / b.cadence)
    assert a.step_length / b.step_length == pytest.approx(np.sqrt(first / second))


@given(factor=st.floats(0.6, 1.3), speed=st.floats(0.3, 1.7))
def test_scaled_bodies_at_equal_froude_number_walk_alike(factor, speed):
    """Lengths in proportion to the leg, times to its square root."""
    big = ADULT.scaled(factor)
    scaled = speed * np.sqrt(factor)
    assert froude(big, scaled) == pytest.approx(froude(ADULT, speed))
    one, other = choose_pace(ADULT, speed=speed), choose_pace(big, speed=scaled)
    assert other.step_length / big.leg_length == pytest.approx(one.step_length / ADULT.leg_length)
    assert other.cadence == pytest.approx(one.cadence / np.sqrt(factor))


@given(who=people())
def test_the_preferred_pace(who):
    """What nobody asked for: a fifth of g leg, which an adult walks at 1.35 m/s."""
    pace = preferred_pace(who)
    assert froude(who, pace.speed) == pytest.approx(0.20)
    assert choose_pace(who) == pace
    assert 0.7 < pace.step_length / who.leg_length < 1.0


def test_preferred_numbers_of_an_adult():
    assert preferred_pace(ADULT).speed == pytest.approx(1.35, abs=0.02)
    leg = ADULT.thigh + ADULT.shin + ADULT.foot.ankle_height
    assert froude(ADULT, 1.35) == pytest.approx(1.35**2 / (GRAVITY * leg))


@given(length=st.floats(0.3, 0.8))
def test_step_length_alone_is_kept(length):
    """Shorter steps are quicker ones, but less than in proportion."""
    pace, usual = choose_pace(ADULT, step_length=length), preferred_pace(ADULT)
    assert pace.step_length == length
    share = length / usual.step_length
    assert min(1.0, share) <= pace.cadence / usual.cadence <= max(1.0, share)


def test_cadence_alone_is_kept():
    pace = choose_pace(ADULT, cadence=90.0)
    assert pace == Pace(preferred_pace(ADULT).step_length, 90.0)


@pytest.mark.parametrize("who", [1.2, 1.75, "kb92b-figure"])
def test_above_froude_one_half_nobody_walks(who):
    body = person(who)
    leg = body.thigh + body.shin + body.foot.ankle_height
    limit = np.sqrt(0.5 * GRAVITY * leg)
    choose_pace(body, speed=0.999 * limit)
    with pytest.raises(InfeasibleSpeedError) as caught:
        choose_pace(body, speed=1.2 * limit)
    error = caught.value
    assert error.speed == pytest.approx(1.2 * limit)
    assert error.available == pytest.approx(limit)
    assert f"Froude number {0.5 * 1.2**2:.2f}" in str(error)
    assert f"{limit:.3f} m/s" in str(error)
    choose_pace(body, speed=0.9999 * error.available)


def test_the_limit_holds_however_the_speed_is_asked_for():
    for asked in ({"step_length": 0.9, "cadence": 150.0}, {"cadence": 200.0}):
        with pytest.raises(InfeasibleSpeedError):
            choose_pace(ADULT, **asked)
