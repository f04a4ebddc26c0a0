"""What every generated motion promises, asked of anybody's walk."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from judge import broken
from people import ENDS, Errand, errands, person

from gaitsmith.body.presets import BODIES
from gaitsmith.errors import InvalidInputError
from gaitsmith.pipeline import walk


@settings(max_examples=100)
@given(errand=errands())
def test_every_walk_keeps_its_promises(errand):
    assert broken(walk(**errand.arguments)) == {}


@pytest.mark.slow
@settings(max_examples=1000)
@given(errand=errands(longest=60.0))
def test_very_many_walks_keep_their_promises(errand):
    assert broken(walk(**errand.arguments)) == {}


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("ratio", [0.3, 1.0])
def test_everybody_with_a_name_at_both_ends_of_the_range(name, ratio):
    body = person(name)
    errand = Errand(body, ratio * body.leg_length, 90.0, 5.0, "stand", "stand", 120.0)
    assert broken(walk(**errand.arguments)) == {}


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
@pytest.mark.parametrize("distance", [0.9, 1.3, 2.0, 2.7])
def test_short_errands(start, stop, distance):
    """So short that the start and the stop share their steps."""
    assert broken(walk(distance=distance, start=start, stop=stop, step_length=0.7)) == {}


@pytest.mark.parametrize("distance", [0.02, 0.1, 0.3])
def test_a_shuffle_is_a_walk_too(distance):
    assert broken(walk(distance=distance)) == {}


def test_a_heel_strike_in_the_last_frame_is_a_contact():
    """``stop="walk"`` ends with the heel on the ground."""
    motion = walk(distance=3.5, step_length=0.7, cadence=120, start="walk", stop="walk")
    landing = motion.labels.footstep_time[-1] * motion.fps
    assert landing == pytest.approx(len(motion) - 1)
    assert motion.contacts[-1, motion.labels.footstep_side[-1]].tolist() == [True, False, False]


@pytest.mark.parametrize("height", [0.002, 0.02, 0.05])
def test_feet_whose_toes_bend_above_the_sole_stand_as_still(height):
    """The ball's sole point bears only while the foot is flat: later it moves with the heel."""
    usual = person(1.75)
    body = replace(usual, foot=replace(usual.foot, toe_joint_height=height))
    assert broken(walk(distance=3.0, body=body, fps=120)) == {}


def test_wide_steps_with_feet_turned_out_stay_in_reach():
    """A rear foot too short or too far to the side to follow by its heel: the hips come down."""
    wide = {"step_width": 0.42, "toe_out": np.radians(30.0)}
    assert broken(walk(distance=5.0, step_length=0.86, cadence=70.0, **wide)) == {}


def test_a_foot_that_cannot_roll_is_no_foot():
    usual = person(1.75)
    with pytest.raises(InvalidInputError, match=r"foot.ball \(0.050 m\) must be at least 0.07"):
        replace(usual, foot=replace(usual.foot, ball=0.05))
