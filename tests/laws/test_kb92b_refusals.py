"""What cannot be walked is refused with its numbers, and no NaN leaves."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from walkers import BODIES, PROTOTYPE, bodies, plan_of

import gaitsmith
from gaitsmith.errors import GaitsmithError, InfeasibleStepError, InvalidInputError, LegReachError
from gaitsmith.ground import GROUNDS
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks import KinematicWalk, StepRequest
from gaitsmith.walks.data import Character, TimedSequence
from gaitsmith.walks.generalize import LONGEST_STEP, generalize, hip_height

WALK = KinematicWalk([PROTOTYPE])
NUMBER = r"[-+]?\d+\.\d+"


def request(before: float, now: float, kind="walk", height=None) -> StepRequest:
    return StepRequest(0, before, now, now, 0.5, 0.0, height, kind)


def numbers(error: Exception) -> list[float]:
    return [float(n) for n in re.findall(NUMBER, str(error))]


@given(
    body=bodies(),
    over=st.floats(1e-6, 5.0),
    where=st.sampled_from(["length", "previous_length"]),
    kind=st.sampled_from(["walk", "start", "stop"]),
)
def test_a_step_too_long_is_refused_with_the_longest_that_works(body, over, where, kind):
    long, good = (LONGEST_STEP + over) * body.leg_length, 0.8 * body.leg_length
    lengths = (good, long) if where == "length" else (long, good)
    with pytest.raises(InfeasibleStepError, match="too long") as caught:
        WALK.step(body, request(*lengths, kind))
    error = caught.value
    assert error.needed == long
    assert error.available == pytest.approx(LONGEST_STEP * body.leg_length, abs=1e-12)
    for value in (error.needed, error.available, body.leg_length):
        assert any(abs(n - value) < 5.1e-4 for n in numbers(error)), (value, str(error))
    # and it does work
    WALK.step(body, request(*(min(v, error.available) for v in lengths), kind))


@pytest.mark.parametrize("kind", ["walk", "start", "stop"])
@pytest.mark.parametrize("bad", [-0.1, float("nan"), float("inf"), -float("inf")])
def test_a_length_that_is_none_is_refused_and_named(bad, kind):
    body = BODIES["adult"]
    for lengths in ((0.7, bad), (bad, 0.7)):
        with pytest.raises(GaitsmithError, match=r"step length") as caught:
            WALK.step(body, request(*lengths, kind))
        assert str(bad).removeprefix("-") in str(caught.value)


@pytest.mark.parametrize("lengths", [(0.0, 0.7), (0.7, 0.0), (-0.2, 0.7), (0.7, float("nan"))])
def test_walk_data_need_steps_of_some_length(lengths):
    name = "previous_length" if lengths[0] <= 0.0 else "length"
    with pytest.raises(InvalidInputError, match=rf"{name} must be a positive number of meters"):
        generalize(PROTOTYPE, BODIES["adult"], *lengths)


@pytest.mark.parametrize("name", BODIES)
def test_the_guard_of_the_paper_fires_only_beyond_two_leg_lengths(name):
    """Why ``LONGEST_STEP`` is there: Eq. 10's radicand says no far too late."""
    body = BODIES[name]
    works = [r for r in np.arange(1.0, 3.0, 0.01) if _has_hip_height(body, r)]
    assert 2.2 < max(works) < 2.7
    with pytest.raises(InfeasibleStepError) as caught:
        hip_height(PROTOTYPE.character, body, 2.9 * body.leg_length)
    assert caught.value.needed == pytest.approx(2.9 * body.leg_length)


def _has_hip_height(body, ratio: float) -> bool:
    try:
        return np.isfinite(hip_height(PROTOTYPE.character, body, ratio * body.leg_length))
    except InfeasibleStepError:
        return False


def test_a_walk_refuses_a_step_too_long_and_the_limit_it_names_works():
    body = BODIES["adult"]
    with pytest.raises(InfeasibleStepError, match="too long") as caught:
        gaitsmith.walk(distance=4.0, body=body, step_length=1.3 * body.leg_length, cadence=70.0)
    limit = caught.value.available
    assert 0.9 * body.leg_length < limit < 1.2 * body.leg_length
    with pytest.warns(gaitsmith.GaitsmithWarning):
        gaitsmith.walk(distance=4.0, body=body, step_length=limit, cadence=70.0, fps=10)


def test_a_leg_too_short_for_where_the_feet_are_is_refused_with_its_reach():
    """Feet so wide apart that no hip height reaches: the contact stage says so."""
    body, ground = BODIES["child"], GROUNDS["flat"]()
    plan = plan_of(body, [0.4, 0.4, 0.4], stand=True, width=2.5 * body.leg_length)
    with pytest.raises(LegReachError, match="reaches") as caught:
        prepare_walk(plan, StraightGenerator(WALK, ground), body, ground)
    error = caught.value
    assert error.needed > error.available
    assert error.available == pytest.approx(body.leg_length, rel=0.01)
    for value in (error.needed, error.available):
        assert any(abs(n - value) < 5.1e-4 for n in numbers(error))


any_length = st.one_of(
    st.floats(0.0, 1.5), st.floats(), st.sampled_from([0.0, 5e-324, 1e-12, 1e308])
)


@given(
    body=bodies(),
    before=any_length,
    now=any_length,
    kind=st.sampled_from(["walk", "start", "stop"]),
    height=st.one_of(st.none(), st.floats(0.3, 1.3)),
)
@example(BODIES["adult"], 1e-12, 1e-12, "walk", None)
@example(BODIES["adult"], 0.0, 1e-9, "start", None)
@example(BODIES["adult"], 1e-9, 0.0, "stop", None)
def test_whatever_is_asked_the_answer_is_finite_or_an_error_of_ours(
    body, before, now, kind, height
):
    try:
        step = WALK.step(body, request(before, now, kind, height))
    except GaitsmithError:
        return
    for name in ("phase", "center", "ankle", "pitch", "meta", "bend"):
        assert np.isfinite(getattr(step, name)).all(), name


@given(value=st.sampled_from([float("nan"), float("inf"), -float("inf")]), at=st.integers(0, 5))
def test_no_walk_data_hold_what_is_not_a_number(value, at):
    samples = np.linspace(0.0, 1.0, 6)
    broken = samples.copy()
    broken[at] = value
    with pytest.raises(InvalidInputError, match="finite"):
        TimedSequence(samples, broken)
    with pytest.raises(InvalidInputError):
        TimedSequence(broken, samples)


def test_a_hip_height_that_is_none_does_not_get_through():
    with pytest.raises(InvalidInputError, match="finite"):
        WALK.step(BODIES["adult"], request(0.7, 0.7, "walk", float("nan")))


@pytest.mark.parametrize(
    ("name", "bad", "said"),
    [
        ("ratio", 0.0, "ratio must be a positive number"),
        ("knee", float("nan"), "knee must be a positive number"),
        ("strike_pitch", 0.0, "strike_pitch must not be 0"),
        ("kappa", 1.0, "kappa must be between 0 and 1, got 1.0"),
        ("gains", (0.4, 0.3, 0.3, 0.3), r"the first in \[0, 0.3\], got \(0.4"),
        ("gains", (0.1, 0.3, 0.3), "gains must be four numbers"),
    ],
)
def test_a_character_says_what_is_wrong_with_it(name, bad, said):
    assert isinstance(PROTOTYPE.character, Character)
    with pytest.raises(InvalidInputError, match=said):
        replace(PROTOTYPE.character, **{name: bad})


def test_walk_data_whose_sequences_do_not_cover_the_step_are_refused():
    with pytest.raises(InvalidInputError, match=r"foot2 must run from 0\.1778 to 1\.2000"):
        PROTOTYPE.with_(toe_off=0.2)
