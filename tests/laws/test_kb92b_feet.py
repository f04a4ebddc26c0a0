"""[KB92b] lemma 2: stance feet roll over heel, ball and toe tip, and none of these slides.

Soles are placed from the ankle and the angles a step says, as a rigid foot would be; the
package's own ``roll`` is compared with that, not used for it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from walkers import BODIES, PROTOTYPE, RigidFoot, bodies, chain, ratios, walks

from gaitsmith.body.body import Foot
from gaitsmith.body.presets import KB92B_SUBJECT
from gaitsmith.body.sole import roll
from gaitsmith.walks import KinematicWalk
from gaitsmith.walks.generalize import generalize

EXACT = {"rtol": 0, "atol": 1e-12}
#: Lengths that a KinematicWalk takes, over the leg length.
lengths = st.lists(st.floats(0.5, 1.1), min_size=2, max_size=4)


def stance(foot, step):
    """Phases, sole points, pitch and meta of the stance foot of a step."""
    placed = RigidFoot.at(foot, step.ankle[:, 0], step.pitch[:, 0], step.bend[:, 0])
    return step.phase, placed, step.pitch[:, 0], step.meta[:, 0]


@given(walk=walks(), body=bodies(), before=ratios, now=ratios)
def test_lemma_2_the_foot_that_lands_comes_to_stand_one_step_ahead(walk, body, before, now):
    """Turned flat about its heel, its ankle is sl from the ankle it passed: Eqs. 36, 37."""
    data = generalize(walk, body, before * body.leg_length, now * body.leg_length)
    foot, at = body.foot, data.ankle.values[-1]
    heel = RigidFoot.at(foot, at, data.foot3.values[-1, 0], 0.0).heel
    flat = heel + [foot.heel, foot.ankle_height]
    np.testing.assert_allclose(flat - [0.0, foot.ankle_height], [data.length, 0.0], **EXACT)
    assert heel[1] == pytest.approx(0.0, abs=1e-12)


@given(body=bodies(), shares=lengths)
def test_stance_ankles_stand_a_step_length_apart(body, shares):
    """Flat at FGM, in every step of a walk of unequal steps."""
    asked = [r * body.leg_length for r in shares]
    here, flat = 0.0, []
    for request, step in chain(KinematicWalk([PROTOTYPE]), body, asked):
        at = int(np.flatnonzero(step.phase == step.flat)[0])
        assert step.pitch[at, 0] == 0.0
        flat.append(here + step.ankle[at, 0])
        # the same foot a step later, seen from the next one, and as it was seen on landing
        landed = RigidFoot.at(body.foot, step.ankle[-1, 1], step.pitch[-1, 1], 0.0).heel
        np.testing.assert_allclose(landed, [request.length - body.foot.heel, 0.0], **EXACT)
        here = here + np.array([request.length, 0.0])
    apart = np.diff(flat, axis=0, prepend=[[-asked[0], body.foot.ankle_height]])
    np.testing.assert_allclose(apart, [[sl, 0.0] for sl in asked[:-1]], **EXACT)


@given(body=bodies(), shares=lengths)
def test_heel_then_ball_then_toe_tip_stay_where_they_are(body, shares):
    foot = body.foot
    for request, step in chain(
        KinematicWalk([PROTOTYPE]), body, [r * body.leg_length for r in shares]
    ):
        phase, sole, _, _ = stance(foot, step)
        heel, ball = phase <= step.flat, (phase >= step.flat) & (phase <= step.meta_off)
        tip = phase >= step.flat
        np.testing.assert_allclose(sole.heel[heel] - [-foot.heel, 0.0], 0.0, **EXACT)
        np.testing.assert_allclose(sole.ball[ball] - [foot.ball, 0.0], 0.0, **EXACT)
        np.testing.assert_allclose(sole.toe[tip] - [foot.ball + foot.toes, 0.0], 0.0, **EXACT)
        assert heel.sum() > 3
        assert ball.sum() > 10
        # the rear foot goes on about the tip of its toes
        rear = phase <= step.toe_off
        placed = RigidFoot.at(foot, step.ankle[:, 1], step.pitch[:, 1], step.bend[:, 1])
        tip_at = [foot.ball + foot.toes - request.previous_length, 0.0]
        np.testing.assert_allclose(placed.toe[rear] - tip_at, 0.0, **EXACT)
        assert rear.sum() > 3


@given(body=bodies(), shares=lengths)
def test_no_part_of_a_bearing_sole_is_below_the_floor(body, shares):
    for _, step in chain(KinematicWalk([PROTOTYPE]), body, [r * body.leg_length for r in shares]):
        _, sole, _, _ = stance(body.foot, step)
        rear = step.phase <= step.toe_off
        behind = RigidFoot.at(
            body.foot, step.ankle[rear, 1], step.pitch[rear, 1], step.bend[rear, 1]
        )
        for placed in (sole, behind):
            for points in (placed.heel, placed.ball, placed.toe):
                assert points[..., 1].min() >= -1e-12


@given(body=bodies(), shares=lengths)
def test_the_ankles_of_bearing_feet_are_what_roll_gives(body, shares):
    for request, step in chain(
        KinematicWalk([PROTOTYPE]), body, [r * body.leg_length for r in shares]
    ):
        rolled = roll(body.foot, step.pitch, step.meta).ankle
        np.testing.assert_allclose(step.ankle[:, 0], rolled[:, 0], **EXACT)
        rear = step.phase <= step.toe_off
        behind = rolled[rear, 1] - [request.previous_length, 0.0]
        np.testing.assert_allclose(step.ankle[rear, 1], behind, **EXACT)


@given(
    body=bodies(),
    joint=st.floats(0.0, 0.5),
    pitch=st.floats(-1.3, 0.6),
    share=st.floats(0.0, 1.0),
)
def test_roll_is_a_rigid_foot_on_its_heel_or_on_its_toes(body, joint, pitch, share):
    """All five points, with the toes' axis anywhere between sole and half the ankle's height."""
    foot = replace(body.foot, toe_joint_height=joint * body.foot.ankle_height)
    meta = share * max(0.0, -pitch)
    pose = roll(foot, np.array(pitch), np.array(meta))
    bend = -pitch - meta if pitch < 0.0 else 0.0
    rigid = RigidFoot.at(foot, pose.ankle, pitch, bend)
    for name in ("heel", "ball", "toe_joint", "toe"):
        np.testing.assert_allclose(getattr(pose, name), getattr(rigid, name), **EXACT)
    if pitch >= 0.0:
        np.testing.assert_allclose(pose.heel, [-foot.heel, 0.0], **EXACT)
    else:
        np.testing.assert_allclose(pose.toe, [foot.ball + foot.toes, 0.0], **EXACT)
    for name in ("heel", "ball", "toe"):
        assert getattr(pose, name)[1] >= -1e-12


def test_roll_is_continuous_where_the_foot_is_flat_and_where_its_toes_begin_to_turn():
    foot = Foot(ankle_height=0.07, heel=0.06, ball=0.12, toes=0.07, toe_joint_height=0.015)
    tiny = 1e-13
    for one, other in (
        (roll(foot, tiny, 0.0), roll(foot, -tiny, 0.0)),
        (roll(foot, -0.4, 0.0), roll(foot, -0.4, tiny)),
    ):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_allclose(a, b, **EXACT)
    flat = roll(foot, 0.0, 0.0)
    expected = [[-0.06, 0.0], [0.12, 0.0], [0.19, 0.0], [0.0, 0.07], [0.12, 0.015]]
    np.testing.assert_allclose(np.stack(flat), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("name", BODIES)
def test_in_standing_both_feet_are_flat(name):
    body = BODIES[name]
    steps = chain(KinematicWalk([PROTOTYPE]), body, [0.6 * body.leg_length], stand=True)
    flat = [0.0, body.foot.ankle_height]
    (_, first), (_, last) = steps[0], steps[-1]
    for step, at in ((first, 0), (last, -1)):
        np.testing.assert_allclose(step.ankle[at], [flat, flat], **EXACT)
        np.testing.assert_allclose([step.pitch[at], step.meta[at], step.bend[at]], 0.0, **EXACT)
        assert step.center[at, 0] == pytest.approx(0.0, abs=1e-12)
        reach = (step.center[at, 1] - body.foot.ankle_height) / body.leg_length
        assert 0.99 < reach < 1.0, "standing legs are nearly straight"


def test_the_flat_distance_is_worked_by_hand_for_the_subject():
    """Half the measured stride in, and what the landing heel says out: .7069 m."""
    data = generalize(PROTOTYPE, KB92B_SUBJECT, 0.7069, 0.7069)
    foot, (x, y) = KB92B_SUBJECT.foot, data.ankle.values[-1]
    p = data.foot3.values[-1, 0]
    heel = x - foot.heel * np.cos(p) + foot.ankle_height * np.sin(p)
    assert heel + foot.heel == pytest.approx(0.7069, abs=1e-12)
    assert y == pytest.approx(foot.heel * np.sin(p) + foot.ankle_height * np.cos(p), abs=1e-12)
