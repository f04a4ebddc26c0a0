"""What every generated motion promises (design section 6), asked of anybody's walk."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from judge import broken
from people import ENDS, Errand, errands, person

from gaitsmith.body.presets import BODIES
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
