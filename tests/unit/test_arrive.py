"""``be at``: feet end where they were asked to, in few steps, and no step is beyond its limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import broken
from people import GROUND, person

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.pipeline import walk
from gaitsmith.plan.arrive import be_at
from gaitsmith.plan.bends import bends_between
from gaitsmith.plan.chains import Standing, chains_between
from gaitsmith.plan.draft import Draft
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.manners import Manners
from gaitsmith.plan.pace import preferred_pace
from gaitsmith.plan.placing import INWARD, OUTWARD, Feet, Limits, may_land
from gaitsmith.plan.script import BeAt
from gaitsmith.plan.start import Start
from gaitsmith.plan.stepping import step_region

ADULT = person(1.75)
STANCE = Stance(0.1, 0.1)
ANGLES, PLACES = st.floats(-3.1, 3.1), st.floats(-1.5, 1.5)


def manners(body=ADULT):
    return Manners(body, preferred_pace(body), STANCE, GROUND)


def beside(facing, middle=(0.0, 0.0), width=0.1, ahead_of=0.0, out=(0.1, 0.1)):
    """Feet of somebody who stands there, one ``ahead_of`` the other."""
    left, way = leftward(facing)[[0, 2]], np.array([np.sin(facing), np.cos(facing)])
    return tuple(
        (*(np.array(middle) + 0.5 * s * (width * left + ahead_of * way)), facing + s * out[i])
        for i, s in enumerate((1.0, -1.0))
    )


def arrived(draft):
    feet = [draft.feet[s] for s in (LEFT, RIGHT)]
    middle = 0.5 * (feet[0].position + feet[1].position)[[0, 2]]
    return middle, 0.5 * (feet[0].heading + feet[1].heading)


@st.composite
def stances(draw):
    return beside(
        draw(ANGLES),
        width=draw(st.floats(0.1, 0.3)),
        ahead_of=draw(st.floats(-0.25, 0.25)),
        out=(draw(st.floats(-0.1, 0.4)), draw(st.floats(-0.1, 0.4))),
    )


@given(stances(), st.tuples(PLACES, PLACES), ANGLES, st.sampled_from([1.25, 1.75, 2.05]))
@settings(max_examples=60)
def test_feet_end_where_they_were_asked_to(feet, place, facing, height):
    draft = Draft.standing(manners(person(height)), Start(feet=feet))
    be_at(draft, BeAt(place, facing))
    middle, heading = arrived(draft)
    np.testing.assert_allclose(middle, place, atol=1e-9)
    assert np.cos(heading - facing) == pytest.approx(1.0, abs=1e-12)
    draft.timeline()  # every step begins where the feet stand
    for step in draft.planned:
        assert abs(step.target.heading - step.origin.heading) < np.radians(110.0), "never round"


def test_given_feet_are_met_one_by_one():
    goal = beside(0.7, (0.4, 0.9), width=0.22, ahead_of=-0.2, out=(0.3, 0.0))
    draft = Draft.standing(manners(), Start())
    be_at(draft, BeAt((0.4, 0.9), None, goal))
    for side, (x, z, heading) in enumerate(goal):
        np.testing.assert_allclose(draft.feet[side].position[[0, 2]], [x, z], atol=1e-12)
        assert draft.feet[side].heading == pytest.approx(heading)


def footfalls(place, facing=None):
    draft = Draft.standing(manners(), Start())
    be_at(draft, BeAt(place, None if facing is None else np.radians(facing)))
    return [s.kind for s in draft.planned if s.kind != "stand"]


@pytest.mark.parametrize(
    ("place", "facing", "most"),
    [
        ((0.0, 0.1), 0.0, 2),
        ((0.0, 0.6), 0.0, 2),
        ((0.55, 0.0), 0.0, 2),
        ((0.0, -0.4), 0.0, 2),
        ((0.0, -0.8), 0.0, 3),
        ((0.3, 0.3), 45.0, 2),
        ((0.0, 0.0), 25.0, 2),
        ((0.0, 0.0), 90.0, 4),
        ((0.0, 0.0), 180.0, 6),
        ((0.0, 1.5), 0.0, 4),
    ],
)
def test_few_steps_are_enough(place, facing, most):
    assert len(footfalls(place, facing)) <= most


def test_people_back_up_a_little_and_turn_and_walk_when_it_is_far():
    assert set(footfalls((0.0, -0.8), 0.0)) == {"backward"}
    assert set(footfalls((0.9, 0.0), 0.0)) == {"lateral"}
    assert "start" in footfalls((0.0, -3.0), 0.0)
    assert "lateral" not in footfalls((2.4, 0.0), 90.0)
    assert "start" in footfalls((0.0, 2.4), 0.0)


def test_nobody_moves_who_is_there_already():
    draft = Draft.standing(manners(), Start())
    be_at(draft, BeAt((0.0, 0.0), 0.0))
    assert not draft.planned
    with pytest.raises(InfeasibleError, match="legs would cross"):
        be_at(draft, BeAt((0.0, 0.0), None, ((-0.1, 0.0, 0.0), (0.1, 0.0, 0.0))))


def test_who_stands_in_a_stride_does_not_walk_off_across_the_other_foot():
    """Along the way the feet would be in one line: the rear one would go through the other."""
    feet = ((-0.149, -0.053, -2.444), (0.149, 0.053, -2.407))
    draft = Draft.standing(manners(person(2.05)), Start(feet=feet))
    be_at(draft, BeAt((-0.52, -0.227), 0.22))
    for step in draft.planned:
        if step.kind == "start":
            stood = {foot.side: foot.position for foot in (step.stance, step.origin)}
            apart = (stood[LEFT] - stood[RIGHT]) @ leftward(step.stance.direction)
            assert apart > 0.05, "the feet are on their own sides of the way"


# limits -------------------------------------------------------------------------------------------


def landings(count=400, seed=0):
    """Random footsteps beside one at the origin, for both sides."""
    rng = np.random.default_rng(seed)
    side = rng.integers(0, 2, count)
    stands = Feet(np.zeros((count, 2)), np.zeros(count), -SIDE_SIGN[side] * 0.1)
    turned = rng.uniform(-1.6, 1.6, count)
    place = rng.uniform(-0.9, 0.9, (count, 2))
    return side, stands, Feet(place, turned, turned + SIDE_SIGN[side] * 0.1)


def test_the_limits_of_a_step_are_kept_for_many_at_once():
    side, stands, target = landings()
    limits = Limits.of(ADULT, 0.1)
    ok = may_land(stands, np.zeros(len(side)), target, side, limits, ADULT)
    assert 10 < ok.sum() < 200
    sign = SIDE_SIGN[side[ok]]
    out = sign * target.direction[ok]
    assert out.max() <= OUTWARD + 1e-9
    assert out.min() >= -INWARD - 1e-9
    x, z = target.place[ok].T
    assert z.max() <= limits.forward
    assert z.min() >= -limits.back
    assert (sign * x).min() >= 0.0, "each foot on its own side"
    for i in np.flatnonzero(ok):
        heel = ADULT.foot.heel
        direction = target.direction[i]
        hx = target.place[i, 0] - heel * np.sin(direction)
        hz = target.place[i, 1] - heel * (np.cos(direction) - 1.0)
        assert step_region(np.arctan2(SIDE_SIGN[side[i]] * hx, hz), direction) is not None


def test_left_and_right_limits_are_mirror_images():
    side, stands, target = landings(seed=3)
    flip = np.array([-1.0, 1.0])
    mirrored = Feet(flip * target.place, -target.direction, -target.heading)
    stood = Feet(stands.place, stands.direction, -stands.heading)
    limits, none = Limits.of(ADULT, 0.1), np.zeros(len(side))
    np.testing.assert_array_equal(
        may_land(stands, none, target, side, limits, ADULT),
        may_land(stood, none, mirrored, 1 - side, limits, ADULT),
    )


@given(stances(), st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8)), ANGLES)
@settings(max_examples=25)
def test_every_step_of_a_chain_is_within_the_limits(feet, place, facing):
    begin = Standing(
        np.array([f[:2] for f in feet]),
        np.array([f[2] for f in feet]),
        np.full(2, 0.5 * (feet[0][2] + feet[1][2])),
    )
    goal = beside(facing, place)
    end = Standing(
        np.array([f[:2] for f in goal]), np.array([f[2] for f in goal]), np.full(2, facing)
    )
    chains = chains_between(begin, end, ADULT, STANCE)
    assert chains
    limits = Limits.of(ADULT, STANCE.width)
    for chain in chains[:6]:
        stands = Feet(begin.place.copy(), begin.direction.copy(), begin.heading.copy())
        for i, side in enumerate(chain.side):
            target = chain.feet.rows(np.array([i]))
            assert may_land(
                stands.rows(np.array([1 - side])),
                stands.direction[[side]],
                target,
                np.array([side]),
                limits,
                ADULT,
            ).all()
            stands.place[side] = target.place[0]
            stands.direction[side], stands.heading[side] = target.direction[0], target.heading[0]
        np.testing.assert_allclose(stands.place, end.place, atol=1e-12)


# bends --------------------------------------------------------------------------------------------


@given(PLACES, PLACES, ANGLES | st.none(), ANGLES | st.none(), st.floats(0.3, 1.0))
@settings(max_examples=80)
def test_bends_begin_and_end_as_they_should(x, z, heading, arrival, radius):
    for path in bends_between(np.zeros(2), heading, np.array([x, z]), arrival, radius):
        np.testing.assert_allclose(path.points[-1], [x, z], atol=1e-9)
        for wanted, end in ((heading, 0), (arrival, -1)):
            if wanted is not None:
                assert np.cos(path.heading[end] - wanted) == pytest.approx(1.0, abs=1e-12)
        assert np.abs(path.curvature).max(initial=0.0) <= 1.0 / radius + 1e-9


# motions ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("script", "body"),
    [
        ("be at 0.5,-0.7 facing 40; be at 0.2,0.3 facing -150", 1.75),
        ("be at -0.8,0.1 feet L -0.6,0.1,20 R -0.8,-0.05,0; be at -0.4,0.9 facing 90", 1.25),
        ("be at 0,-1 facing 0; be at 0.4,-0.2 facing 70", 2.05),
    ],
)
def test_steps_that_turn_and_travel_keep_every_promise(script, body):
    assert not broken(walk(do=script, body=body, fps=60.0))
