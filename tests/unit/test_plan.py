"""Where the feet go: stride lengths, straight plans, and what a plan must be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from people import GROUND, straight_plan

from gaitsmith.body.presets import body_from
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.ground import Flat
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.straight import (
    EASED_DURATION,
    FIRST_STEP,
    Stance,
    footstep_positions,
    plan_straight,
    stride_lengths,
)

lengths = st.floats(0.2, 1.1)
distances = st.one_of(st.floats(1e-3, 5.0), st.floats(5.0, 500.0))
starts = st.sampled_from(["stand", "walk"])

# stride lengths --------------------------------------------------------------------------


@settings(max_examples=300)
@given(distance=distances, length=lengths, start=starts)
def test_strides_to_a_stop_sum_to_the_distance(distance, length, start):
    strides = stride_lengths(distance, length, start, "stand")
    assert sum(strides) == pytest.approx(distance, abs=1e-9)
    assert min(strides) > 0.0
    assert max(strides) <= length + 1e-9, "no step is longer than asked"


@settings(max_examples=300)
@given(distance=distances, length=lengths, start=starts)
def test_only_the_first_and_the_last_three_are_shorter(distance, length, start):
    strides = stride_lengths(distance, length, start, "stand")
    begin = 1 if start == "stand" else 0
    assert strides[begin:-3] == [length] * len(strides[begin:-3])
    if start == "stand":
        assert strides[0] == pytest.approx(min(FIRST_STEP * length, distance))


@settings(max_examples=300)
@given(distance=st.floats(5.0, 500.0), length=lengths, start=starts)
def test_the_last_three_shorten_one_after_the_other(distance, length, start):
    """Nobody stops from a full step: measured before a stop are -5 and -15 %."""
    before, *last = stride_lengths(distance, length, start, "stand")[-4:]
    assert before == length
    assert length > last[0] > last[1] > last[2] > 0.1 * length
    assert sum(last) <= 3 * length - 0.2 * length + 1e-9


@settings(max_examples=200)
@given(distance=distances, length=lengths, start=starts)
def test_strides_without_a_stop_are_whole(distance, length, start):
    begin = FIRST_STEP * length if start == "stand" else 0.0
    if start == "walk" and distance < length:
        with pytest.raises(InfeasibleError, match="holds no step"):
            stride_lengths(distance, length, start, "walk")
        return
    strides = stride_lengths(distance, length, start, "walk")
    first = 1 if start == "stand" else 0
    assert strides[first:] == [length] * len(strides[first:])
    assert sum(strides) <= distance * (1.0 + 1e-9) + 1e-9
    if distance >= begin:
        assert distance - sum(strides) < length * (1.0 + 1e-9)


def test_strides_by_hand():
    """5 m by 0.7 m: 0.56, then 4.44 m in 7 steps that give up 0.46 m in sixths."""
    strides = stride_lengths(5.0, 0.7, "stand", "stand")
    cut = 7 * 0.7 - 4.44
    tail = [0.7 - cut / 6, 0.7 - cut / 3, 0.7 - cut / 2]
    assert strides == pytest.approx([0.56, 0.7, 0.7, 0.7, 0.7, *tail])


@pytest.mark.parametrize("distance", [1e-6, 1e-3, 0.1, 0.56, 0.57, 0.7])
def test_tiny_distances(distance):
    assert sum(stride_lengths(distance, 0.7, "stand", "stand")) == pytest.approx(distance)
    assert sum(stride_lengths(distance, 0.7, "walk", "stand")) == pytest.approx(distance)


def test_huge_distances():
    strides = stride_lengths(42_195.0, 0.7, "stand", "stand")
    assert sum(strides) == pytest.approx(42_195.0, abs=1e-6)
    assert set(strides[1:-3]) == {0.7}


@given(count=st.integers(1, 200))
def test_a_whole_number_of_steps_is_not_one_too_few(count):
    """0.1 + 0.2 > 0.3 must not lose a step."""
    assert len(stride_lengths(count * 0.7, 0.7, "walk", "walk")) == count


# straight plans --------------------------------------------------------------------------


@pytest.fixture
def body():
    return body_from(1.75)


def test_a_plan_from_stand_to_stand(body):
    plan = straight_plan(body, distance=4.0, width=0.12, toe_out=0.1)
    assert plan.kinds[0] == "start"
    assert plan.kinds[-1] == "stop"
    assert set(plan.kinds[1:-1]) == {"walk"}
    assert plan.side[:4].tolist() == [0, 1, 1, 0], "the left one is listed first, the right lands"
    np.testing.assert_allclose(plan.position[:2], [[0.06, 0, 0], [-0.06, 0, 0]], atol=1e-12)
    np.testing.assert_allclose(plan.position[-2:, 2], 4.0, atol=1e-12)
    np.testing.assert_allclose(plan.heading, np.where(plan.side == 0, 0.1, -0.1))
    assert (plan.direction == 0.0).all()


def test_time_of_landing(body):
    plan = straight_plan(body, cadence=100.0)
    assert plan.time[:2].tolist() == [0.0, 0.0]
    steady = 0.6
    want = [EASED_DURATION * steady, *[steady] * (len(plan.kinds) - 2), EASED_DURATION * steady]
    np.testing.assert_allclose(plan.durations, want)
    np.testing.assert_allclose(np.cumsum(want), plan.time[2:])


def test_a_walk_in_the_middle_of_walking(body):
    plan = straight_plan(body, ratio=0.7, distance=3.0, start="walk", stop="walk")
    length = 0.7 * body.leg_length
    assert set(plan.kinds) == {"walk"}
    np.testing.assert_allclose(np.diff(plan.position[:, 2]), length)
    assert plan.position[1, 2] == pytest.approx(0.0)
    assert 3.0 - length < plan.position[-1, 2] <= 3.0


def test_steps_of_a_plan_are_chained(body):
    plan = straight_plan(body)
    steps = plan.steps()
    assert [s.index for s in steps] == list(range(len(plan.kinds)))
    for i, step in enumerate(steps):
        assert step.duration == pytest.approx(plan.durations[i])
        assert step.stance.side != step.target.side == step.origin.side
        # standing, the left foot is listed first and the right one leaves first
        origin, stance = ((1, 0), (0, 2))[i] if i < 2 else (i, i + 1)
        for foot, index in ((step.origin, origin), (step.stance, stance), (step.target, i + 2)):
            np.testing.assert_array_equal(foot.position, plan.position[index])
            assert (foot.heading, foot.time) == (plan.heading[index], plan.time[index])
    assert steps[0].before is None
    assert steps[-1].following is None
    np.testing.assert_array_equal(steps[0].following.position, plan.position[3])
    np.testing.assert_array_equal(steps[1].before.position, plan.position[1])


def test_footsteps_lie_on_the_ground():
    class Hill(Flat):
        def height(self, x, z):
            return 0.1 * np.asarray(z) + 0.05 * np.asarray(x)

    along, side = np.array([0.0, 0.0, 0.7]), np.array([1, 0, 1])
    found = footstep_positions(along, side, Stance(0.2, 0.0), (1.0, 2.0), 0.5 * np.pi, Hill())
    # heading 90 degrees: ahead is +X, left is -Z
    np.testing.assert_allclose(found[:, 0], [1.0, 1.0, 1.7])
    np.testing.assert_allclose(found[:, 2], [2.1, 1.9, 2.1])
    np.testing.assert_allclose(found[:, 1], 0.1 * found[:, 2] + 0.05 * found[:, 0])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"distance": 0.0}, "distance must be a positive number of meters"),
        ({"distance": np.nan}, "distance must be a positive number of meters"),
        ({"distance": np.inf}, "distance must be a positive number of meters"),
        ({"start": "run"}, "start must be one of stand, walk, got 'run'"),
        ({"stop": ""}, "stop must be one of stand, walk"),
        ({"heading": np.nan}, "heading must be a finite number of radians"),
        ({"heading": None}, "heading must be a finite number of radians"),
    ],
)
def test_bad_requests(wrong, message):
    asked = {"distance": 3.0, "pace": Pace(0.7, 100.0), "stance": Stance(0.1, 0.1), **wrong}
    with pytest.raises(InvalidInputError, match=message):
        plan_straight(ground=GROUND, **asked)


# what a plan must be ---------------------------------------------------------------------


def fields(**changes):
    good = {
        "side": [1, 0, 1, 0],
        "position": np.zeros((4, 3)),
        "heading": np.zeros(4),
        "direction": np.zeros(4),
        "time": [0.0, 0.0, 0.5, 1.0],
        "kinds": ("start", "stop"),
    }
    return good | changes


def test_a_good_plan_is_one_and_cannot_be_changed():
    plan = StepPlan(**fields())
    np.testing.assert_allclose(plan.durations, [0.5, 0.5])
    for name in ("side", "position", "heading", "direction", "time"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(plan, name)[0] = 1


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            {
                "side": [1, 0],
                "position": np.zeros((2, 3)),
                "heading": np.zeros(2),
                "direction": np.zeros(2),
                "time": [0.0, 0.0],
                "kinds": (),
            },
            r"at least one step \(3 footsteps\), got 2",
        ),
        ({"kinds": ("start",)}, "4 footsteps make 2 steps, got 1 kinds"),
        ({"side": [2, 0, 1, 0]}, r"side must be 0 \(left\) or 1 \(right\)"),
        ({"side": [1, 0, 1, 1]}, "sides must alternate: footsteps 2 and 3 are both right"),
        ({"side": [1, 1, 0, 1]}, "must be a left and a right one, both are right"),
        ({"time": [0.0, 0.1, 0.5, 1.0]}, "time must be 0 for both initial feet and then rise"),
        ({"time": [0.0, 0.0, 0.5, 0.5]}, "then rise"),
        ({"time": [0.0, 0.0, 0.0, 0.5]}, "then rise"),
        ({"position": np.zeros((4, 2))}, r"position must have shape \(4, 3\), got \(4, 2\)"),
        ({"heading": np.zeros(3)}, r"heading must have shape \(4,\), got \(3,\)"),
        ({"direction": [0.0, 0.0, np.nan, 0.0]}, r"direction must be finite, but direction\[2\]"),
        ({"position": np.full((4, 3), np.inf)}, "position must be finite"),
        ({"path": np.zeros((5, 3))}, r"path must have shape \('any', 2\), got \(5, 3\)"),
        ({"side": "LRLR"}, "side must be an array of numbers"),
    ],
)
def test_a_wrong_plan_cannot_exist(wrong, message):
    with pytest.raises(InvalidInputError, match=message):
        StepPlan(**fields(**wrong))
