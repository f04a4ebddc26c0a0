"""A walk elsewhere, another way round, or in the mirror is the same walk."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import SIDES, posed
from people import ENDS, GROUND, people, person, prepared, straight_plan
from scipy.spatial.transform import Rotation

from gaitsmith.synthesis.sample import sample_walk

FPS = 30.0


def walked(body, plan):
    return sample_walk(prepared(body, plan), body, GROUND, fps=FPS, recipe={})


@settings(max_examples=30)
@given(
    who=people(),
    heading=st.floats(-10.0, 10.0),
    x=st.floats(-50.0, 50.0),
    z=st.floats(-50.0, 50.0),
    start=st.sampled_from(ENDS),
    stop=st.sampled_from(ENDS),
)
def test_a_walk_elsewhere_is_the_same_walk_moved(who, heading, x, z, start, stop):
    """To 1e-9, joints, soles and flags."""
    asked = {"ratio": 0.7, "distance": 3.0, "start": start, "stop": stop}
    here = walked(who, straight_plan(who, **asked))
    there = walked(who, straight_plan(who, **asked, heading=heading, origin=(x, z)))
    turn, shift = Rotation.from_euler("y", heading), np.array([x, 0.0, z])

    def moved(points):
        return turn.apply(np.reshape(points, (-1, 3))).reshape(np.shape(points)) + shift

    positions, _, soles = posed(here)
    positions_there, _, soles_there = posed(there)
    np.testing.assert_allclose(positions_there, moved(positions), atol=1e-9)
    np.testing.assert_allclose(soles_there, moved(soles), atol=1e-9)
    np.testing.assert_array_equal(there.contacts, here.contacts)
    same = np.abs((there.rotations[:, 1:] * here.rotations[:, 1:]).sum(-1))
    np.testing.assert_allclose(same, 1.0, atol=1e-12)
    np.testing.assert_allclose(
        there.labels.footstep_position, moved(np.array(here.labels.footstep_position)), atol=1e-9
    )
    facing = there.labels.footstep_heading - here.labels.footstep_heading - heading
    assert facing == pytest.approx(0.0, abs=1e-9)


def mirrored_plan(plan):
    """The same plan with left for right: the left foot lands first."""
    across = np.array([-1.0, 1.0, 1.0])
    return replace(
        plan,
        side=1 - plan.side,
        position=plan.position * across,
        heading=-plan.heading,
        direction=-plan.direction,
    )


@settings(max_examples=30)
@given(
    who=people(),
    ratio=st.floats(0.3, 1.0),
    toe_out=st.floats(-0.3, 0.4),
    start=st.sampled_from(ENDS),
    stop=st.sampled_from(ENDS),
)
def test_with_the_left_foot_first_the_walk_is_mirrored(who, ratio, toe_out, start, stop):
    """To 1e-9: there is no left-handedness in a straight walk."""
    plan = straight_plan(
        who, ratio=ratio, cadence=80.0, distance=3.0, toe_out=toe_out, start=start, stop=stop
    )
    right, left = walked(who, plan), walked(who, mirrored_plan(plan))
    names = right.skeleton.names
    other = [
        names.index(name.replace(*(SIDES if name.startswith(SIDES[0]) else SIDES[::-1])))
        for name in names
    ]
    positions, _, soles = posed(right)
    positions_left, _, soles_left = posed(left)
    across = np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(positions_left, positions[:, other] * across, atol=1e-9)
    np.testing.assert_allclose(soles_left, soles[:, ::-1] * across, atol=1e-9)
    np.testing.assert_array_equal(left.contacts, right.contacts[:, ::-1])
    turned = right.rotations[:, other] * np.array([1.0, -1.0, -1.0, 1.0])
    same = np.abs((left.rotations * turned).sum(-1))
    np.testing.assert_allclose(same, 1.0, atol=1e-12)


def test_left_and_right_steps_mirror_each_other_in_one_walk():
    """A steady step is the one before it, mirrored and one step ahead."""
    body = person(1.75)
    plan = straight_plan(body, cadence=60.0, distance=8.0, start="walk", stop="walk")
    motion = walked(body, plan)
    frames, length = round(FPS), 0.8 * body.leg_length  # one step a second
    hips = motion.root_position[2 * frames : 7 * frames]
    ahead = hips[frames:] - hips[:-frames]
    np.testing.assert_allclose(ahead[:, 1:], [[0.0, length]] * len(ahead), atol=1e-6)
    np.testing.assert_allclose(hips[frames:, 0], -hips[:-frames, 0], atol=1e-6)
