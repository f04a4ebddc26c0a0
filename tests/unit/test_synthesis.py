"""The straight generator's refusals and reuse, the rules above the legs, sampling."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from compass_walk import CompassWalk
from judge import posed
from people import GROUND, person, prepared, straight_plan, the_walk

from gaitsmith.errors import InfeasibleStepError, InvalidInputError
from gaitsmith.pipeline import walk
from gaitsmith.synthesis.sample import sample_walk
from gaitsmith.synthesis.step import WalkerState, prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.synthesis.upper_body import Manner

BODY = person(1.75)


def bent(plan, **changes):
    fields = {name: np.array(getattr(plan, name)) for name in ("position", "heading", "direction")}
    for name, (index, value) in changes.items():
        fields[name][index] = value
    return replace(plan, **fields)


@pytest.mark.parametrize(
    "changes",
    [
        {"direction": (4, 0.1)},
        {"position": (4, [0.2, 0.0, 2.0])},
        {"position": (slice(4, None), 0.5)},
    ],
)
def test_a_plan_that_is_not_straight_is_refused(changes):
    plan = bent(straight_plan(BODY), **changes)
    with pytest.raises(InvalidInputError, match=r"step \d is not straight"):
        prepare_walk(plan, StraightGenerator(the_walk(), GROUND), BODY, GROUND)


def test_a_step_too_long_is_refused_before_anything_is_made():
    plan = straight_plan(BODY, ratio=1.4)
    with pytest.raises(InfeasibleStepError, match="too long for this body"):
        prepare_walk(plan, StraightGenerator(the_walk(), GROUND), BODY, GROUND)


def test_each_step_is_asked_of_the_walk_as_planned():
    """Seam 1: lengths along the walk, duration, kind, side, the height that was reached."""

    class Listening(CompassWalk):
        def __init__(self):
            super().__init__()
            self.asked = []

        def step(self, body, request):
            self.asked.append(request)
            return super().step(body, request)

    listening = Listening()
    plan = straight_plan(BODY, ratio=0.7, distance=3.0, heading=1.0, origin=(3.0, -2.0))
    generator, state, ends = StraightGenerator(listening, GROUND), WalkerState(), []
    for step in plan.steps():
        state = generator.prepare(BODY, state, step).end
        ends.append(state.hip_height)
    way = np.array([np.sin(1.0), 0.0, np.cos(1.0)])
    along = (plan.position - [3.0, 0.0, -2.0]) @ way
    asked = listening.asked
    assert [r.kind for r in asked] == list(plan.kinds)
    assert [r.side for r in asked] == (1 - plan.side[2:]).tolist()
    np.testing.assert_allclose([r.length for r in asked], np.diff(along)[1:], atol=1e-9)
    np.testing.assert_allclose([r.previous_length for r in asked], np.diff(along)[:-1], atol=1e-9)
    np.testing.assert_allclose(
        [r.next_length for r in asked], np.append(np.diff(along)[2:], 0.0), atol=1e-9
    )
    np.testing.assert_allclose([r.duration for r in asked], plan.durations)
    assert asked[0].hip_height is None
    np.testing.assert_allclose([r.hip_height for r in asked[1:]], ends[:-1], atol=1e-9)


def test_a_short_rest_follows_a_stop_only():
    stopped = prepared(BODY, straight_plan(BODY), rest=0.3)
    walking = prepared(BODY, straight_plan(BODY, stop="walk"), rest=0.3)
    assert stopped.duration - stopped.plan.time[-1] == pytest.approx(0.3)
    assert walking.duration == pytest.approx(walking.plan.time[-1])


# above the legs --------------------------------------------------------------------------


def angle_of(motion, upper, lower):
    """Swing of a limb forward of straight down, in the walk's plane, radians."""
    positions = posed(motion)[0]
    index = motion.skeleton.index
    limb = positions[:, index(lower)] - positions[:, index(upper)]
    return np.arctan2(limb[:, 2], -limb[:, 1])


@pytest.fixture(scope="module")
def striding():
    return walk(distance=6.0, gait="winter", body=1.75, start="walk", stop="walk", fps=60)


@pytest.mark.parametrize("side", ["left", "right"])
def test_arms_swing_against_the_leg_of_their_side(striding, side):
    arm = angle_of(striding, f"{side}UpperArm", f"{side}LowerArm")
    leg = angle_of(striding, f"{side}UpperLeg", f"{side}Foot")
    assert np.corrcoef(arm, leg)[0, 1] < -0.9
    assert 15.0 < np.degrees(np.ptp(arm)) < 50.0


def test_the_pelvis_turns_with_the_swinging_leg_and_the_trunk_against_it(striding):
    positions = posed(striding)[0]
    index = striding.skeleton.index

    def turned(left, right):
        line = positions[:, index(left)] - positions[:, index(right)]
        return np.arctan2(-line[:, 2], line[:, 0])

    pelvis, chest = turned("leftUpperLeg", "rightUpperLeg"), turned("leftUpperArm", "rightUpperArm")
    legs = angle_of(striding, "leftUpperLeg", "leftFoot") - angle_of(
        striding, "rightUpperLeg", "rightFoot"
    )
    assert np.corrcoef(-pelvis, legs)[0, 1] > 0.8, "left hip forward with the left leg"
    assert np.corrcoef(pelvis, chest)[0, 1] < -0.8
    assert 5.0 < np.degrees(np.ptp(pelvis)) < 15.0


def test_the_head_keeps_level(striding):
    positions, world, _ = posed(striding)
    up = world[striding.skeleton.index("head")].apply([0.0, 1.0, 0.0])
    assert np.degrees(np.arccos(up[:, 1])).max() < 6.0
    assert np.ptp(positions[:, striding.skeleton.index("head"), 0]) < 0.08


def test_the_hips_sway_towards_the_foot_that_bears(striding):
    labels = striding.labels
    stance = labels.footstep_side[labels.step - 1]
    middle = (labels.phase > 0.3) & (labels.phase < 0.7)
    aside = striding.root_position[:, 0]
    assert aside[middle & (stance == 0)].min() > 0.0
    assert aside[middle & (stance == 1)].max() < 0.0
    assert 0.02 < np.ptp(aside) < 0.08


def test_layers_switch_off():
    plain = walk(distance=3.0, gait="winter", manner=Manner(pelvis=False, arms=False))
    index = plain.skeleton.index
    np.testing.assert_allclose(plain.root_position[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(plain.rotations[:, 0, 3]), 1.0, atol=1e-12)
    for name in ("spine", "head", "leftUpperArm", "rightLowerArm"):
        joint = plain.rotations[:, index(name)]
        np.testing.assert_allclose(joint, joint[:1].repeat(len(joint), 0), atol=1e-9)


def test_standing_is_upright_and_still():
    motion = walk(distance=3.0, gait="winter", fps=60)
    for frame in (0, -1):
        np.testing.assert_allclose(np.abs(motion.rotations[frame, 0, 3]), 1.0, atol=1e-9)
        for name in ("spine", "neck", "head"):
            joint = motion.rotations[frame, motion.skeleton.index(name)]
            assert abs(joint[3]) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("segments", [1, 2, 3, 17])
def test_a_spine_of_any_number_of_joints(segments):
    """The head goes the same way, however finely the trunk is cut."""
    body = replace(BODY, spine_segments=segments)
    motion = sample_walk(prepared(body, straight_plan(body)), body, GROUND, fps=30.0, recipe={})
    whole = sample_walk(prepared(BODY, straight_plan(BODY)), BODY, GROUND, fps=30.0, recipe={})
    world = posed(motion)[1][motion.skeleton.index("head")]
    same = posed(whole)[1][whole.skeleton.index("head")]
    assert (world * same.inv()).magnitude().max() < 1e-9


# sampling --------------------------------------------------------------------------------


@pytest.mark.parametrize("fps", [7.0, 24.0, 30.0, 59.94])
def test_frames_are_those_within_the_walk(fps):
    walk_ = prepared(BODY, straight_plan(BODY))
    motion = sample_walk(walk_, BODY, GROUND, fps=fps, recipe={"made": "here"})
    assert (len(motion) - 1) / fps <= walk_.duration + 1e-6
    assert len(motion) / fps > walk_.duration
    assert motion.labels.recipe == '{"made": "here"}'
    assert motion.labels.step[0] == 2
    assert motion.labels.step[-1] == len(motion.labels.footstep_side) - 1
    assert motion.labels.phase[-1] == 1.0


def test_times_may_come_in_any_order():
    walk_ = prepared(BODY, straight_plan(BODY))
    times = np.linspace(0.0, walk_.duration, 50)
    film, back = walk_.poses(times), walk_.poses(times[::-1])
    np.testing.assert_allclose(back.center[::-1], film.center, atol=1e-12)
    np.testing.assert_array_equal(back.contacts[::-1], film.contacts)
    one = walk_.poses(times[17:18])
    np.testing.assert_allclose(one.thigh[0], film.thigh[17], atol=1e-12)


@pytest.mark.parametrize("fps", [0.0, -1.0, np.nan, None])
def test_a_bad_frame_rate(fps):
    walk_ = prepared(BODY, straight_plan(BODY))
    with pytest.raises(InvalidInputError, match="fps must be a positive number"):
        sample_walk(walk_, BODY, GROUND, fps=fps, recipe={})
