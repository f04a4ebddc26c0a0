"""Unequal steps: a person's left and right, and natural variation, along the same way."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground import GROUNDS
from gaitsmith.plan.follow import follow
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.paths import Path
from gaitsmith.plan.rhythm import DRIFT, LENGTH_POWER, RESIDUAL, WIDTH, Rhythm

PACE, STANCE, GROUND = Pace(0.7, 110.0), Stance(0.1, 0.1), GROUNDS["flat"]()


def plan(distance=12.0, rhythm=None, **more):
    return follow(
        Path.line(distance), pace=PACE, stance=STANCE, ground=GROUND, rhythm=rhythm, **more
    )


def steps_of(made):
    """Length, duration and landing side of every step along +Z."""
    length = made.position[2:, 2] - made.position[1:-1, 2]
    return length, made.durations, made.side[2:]


@settings(max_examples=30, deadline=None)
@given(
    left=st.floats(0.7, 1.3),
    variation=st.floats(0.0, 2.0),
    seed=st.integers(0, 1000),
    distance=st.floats(5.0, 40.0),
)
def test_the_way_is_kept_whatever_the_steps(left, variation, seed, distance):
    rhythm = Rhythm((left, 2.0 - left), (1.0, 1.0), variation, seed)
    made, even = plan(distance, rhythm), plan(distance)
    np.testing.assert_allclose(made.position[-2:], even.position[-2:], atol=1e-9)
    assert len(made.side) == len(even.side)
    assert (made.side == even.side).all()
    assert (np.diff(made.time[1:]) > 0.0).all()


def test_no_rhythm_changes_nothing():
    for name in ("position", "heading", "time"):
        np.testing.assert_array_equal(getattr(plan(rhythm=Rhythm()), name), getattr(plan(), name))


def test_left_and_right_steps_are_as_uneven_as_asked():
    made = plan(30.0, Rhythm((1.1, 0.9), (0.95, 1.05)))
    length, duration, side = steps_of(made)
    full = slice(1, -5)
    left, right = (length[full][side[full] == s] for s in (0, 1))
    assert np.ptp(left) < 1e-9
    assert left[0] / right[0] == pytest.approx(1.1 / 0.9, abs=1e-9)
    left, right = (duration[full][side[full] == s] for s in (0, 1))
    assert left[0] / right[0] == pytest.approx(0.95 / 1.05, abs=1e-9)
    assert left[0] + right[0] == pytest.approx(2.0 * PACE.step_duration)


def test_variation_is_of_the_size_that_people_have():
    """Collins & Kuo 2013; Almarwani 2016."""
    made = plan(1500.0, Rhythm(variation=1.0, seed=7))
    length, duration, _ = steps_of(made)
    length, duration = length[1:-5], duration[1:-5]
    asked = float(np.hypot(LENGTH_POWER * DRIFT, RESIDUAL))
    assert length.std() / length.mean() == pytest.approx(asked, rel=0.1)
    width = np.abs(np.diff(made.position[3:-3, 0]))
    assert width.std() == pytest.approx(WIDTH * 1.75, rel=0.15)

    def memory(values):
        v = values - values.mean()
        return float((v[1:] * v[:-1]).mean() / (v * v).mean())

    assert memory(duration) > 0.8  # a slow drift
    assert abs(memory(made.position[3:-3, 0] * (1 - 2 * made.side[3:-3]))) < 0.1  # white


def test_a_seed_gives_the_same_steps_and_another_gives_others():
    one, again, other = (plan(rhythm=Rhythm(variation=1.0, seed=s)) for s in (1, 1, 2))
    np.testing.assert_array_equal(one.position, again.position)
    assert np.abs(one.position - other.position).max() > 1e-3


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        ({"lengths": (1.2, 1.0)}, "must add up to 2"),
        ({"lengths": (1.6, 0.4)}, "within 0.45 of 1"),
        ({"durations": (-1.0, 3.0)}, "positive"),
        ({"variation": -0.1}, "from 0"),
        ({"variation": 2.5}, "to 2"),
        ({"variation": float("nan")}, "finite"),
    ],
)
def test_what_is_no_rhythm_is_refused(wrong, match):
    with pytest.raises(InvalidInputError, match=match):
        Rhythm(**wrong)
