"""Walk data of a stride: both sides, consistent ends, nothing that divides by zero."""

from __future__ import annotations

from dataclasses import fields
from functools import cache

import numpy as np
import pytest
from judge import broken, runs
from people import person
from puppet import Puppet
from rigs import apart, bare, cycle_angles, rms
from straight_walk import StraightWalkContract

from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.learn import learn_cycle
from gaitsmith.gait.person import person_of
from gaitsmith.learning import learn
from gaitsmith.pipeline import walk
from gaitsmith.walks import KinematicWalk
from gaitsmith.walks.from_cycle import for_good, walk_data_of
from gaitsmith.walks.generalize import ankle_at_heel_strike, ankle_at_toe_off, hip_height, mu
from gaitsmith.walks.learned import learned_gait

WAYS = {
    "walk": Puppet(),
    "limp": Puppet(right=0.44, duty=(0.68, 0.58)),
    "flat": Puppet(strike=0.0),
    "always flat": Puppet(strike=0.0, push=1.0),
    "toes first": Puppet(strike=-10.0),
    "on the toes": Puppet(strike=-15.0, level=-25.0, push=60.0),
    "high on the toes": Puppet(strike=-30.0, level=-35.0, push=60.0),
    "on the heels": Puppet(level=12.0, push=0.0),
    "hardly overlaps": Puppet(duty=(0.5, 0.5), fly=0.0),
    "wide": Puppet(width=0.35),
    "crossing": Puppet(width=-0.08),
    "short": Puppet(stride=0.3),
    "long": Puppet(stride=1.7, period=1.0),
    "crouched": Puppet(crouch=0.2),
}


@cache
def pair_of(puppet):
    found = learn_cycle(person_of(bare(puppet.clip(5.0))))
    return found, walk_data_of(found.cycle, found.body)


@cache
def learned_walk(name):
    return KinematicWalk([pair_of(WAYS[name])[1]])


@pytest.fixture(params=WAYS)
def case(request):
    return pair_of(WAYS[request.param])


def test_nothing_is_nan(case):
    _, pair = case
    for data in pair:
        for field in fields(data):
            value = getattr(data, field.name)
            if hasattr(value, "values"):
                assert np.isfinite(value.values).all(), field.name


def test_steps_are_those_of_the_stride(case):
    found, (left, right) = case
    assert left.length + right.length == pytest.approx(found.cycle.stride_length, abs=1e-9)
    assert (left.previous_length, right.previous_length) == (right.length, left.length)
    assert right.length == pytest.approx(found.step_lengths[0], abs=2e-3)


def test_ends_meet(case):
    """What one side's step ends with, the other one begins with."""
    found, pair = case
    for data, before in zip(pair, pair[::-1], strict=True):
        body = found.body
        _, strike, _, _ = mu(data.character, body, data.length)
        _, landed, off, meta = mu(before.character, body, data.previous_length)
        np.testing.assert_allclose(
            data.ankle.values[-1], ankle_at_heel_strike(body.foot, data.length, strike), atol=1e-9
        )
        np.testing.assert_allclose(
            data.ankle.values[0],
            ankle_at_toe_off(body.foot, data.previous_length, off, meta),
            atol=1e-9,
        )
        assert data.foot1.values[0, 0] == pytest.approx(landed, abs=1e-9)
        assert data.foot3.values[-1, 0] == pytest.approx(strike, abs=1e-9)
        assert data.hip.values[-1, 1] == pytest.approx(
            hip_height(data.character, body, data.length), abs=1e-9
        )


def learn_from(found):
    return learned_gait(found, name="x", upper_body="measured")


# steps as narrow or wide as a clip's are not always walked; that is said
@pytest.mark.filterwarnings("ignore:the gait's own step width")
def test_it_walks_and_keeps_its_promises(case):
    found, _ = case
    gait = learn_from(found)
    on_toes = max(w.character.strike_pitch for w in gait.walk_data) < 0.0
    asked = ("footsteps_unseen",) if on_toes else ()  # no foot is ever flat
    # steps three times as long as measured swing too fast
    most = found.cycle.stride_length / found.body.leg_length
    for body, length in ((found.body, None), (person(1.2), 0.35), (person(2.0), 0.8)):
        if length is not None:
            length = min(length, most * body.leg_length)
        motion = walk(distance=3.0, gait=gait, body=body, step_length=length, fps=120)
        assert broken(motion, but=(*asked, "unflagged_bearing")) == {}


@pytest.mark.parametrize("name", ["limp", "flat"])
class TestEveryLearnedWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self, name):
        return learned_walk(name)

    def test_both_sides_walk_alike(self, walk, body, name):
        if name == "limp":
            pytest.skip("a limp does not")
        left, right = (walk.step(body, self.steady(body, side=side)) for side in (0, 1))
        np.testing.assert_allclose(left.center, right.center, atol=6e-3)


def test_toes_first_stay_toes_first():
    _, pair = pair_of(WAYS["toes first"])
    for data in pair:
        assert np.degrees(data.character.strike_pitch) == pytest.approx(-10.0, abs=2.0)
        assert data.foot1.values[:, 0].max() <= 1e-9


def test_a_limp_is_walked_as_a_limp():
    """Equal steps are asked for, the difference between the legs stays."""
    gait = learn(bare(Puppet(right=0.5, duty=(0.70, 0.58), strike=20.0).clip(5.0)))
    motion = walk(distance=6.0, gait=gait, body=gait.body, fps=120)
    stands = [
        np.median([b - a for a, b in runs(motion.contacts[:, side].any(-1))[1:-1]])
        for side in (0, 1)
    ]
    stride = 2.0 * np.median(np.diff(motion.labels.footstep_time[3:-2])) * motion.fps
    assert (stands[0] - stands[1]) / stride == pytest.approx(0.12, abs=0.03)


def test_a_stride_that_stands_still_is_refused():
    found, _ = pair_of(Puppet())
    with pytest.raises(InfeasibleError, match="short to be generalized"):
        walk_data_of(found.cycle.with_(stride_length=0.02), found.body)


def test_learned_again_it_is_the_same():
    """A generated walk learned and walked again keeps its joint angles."""
    first = learn(bare(Puppet().clip(5.0)))
    motion = walk(distance=8.0, gait=first, body=first.body, fps=60)
    again = learn(bare(motion))
    error = apart(cycle_angles(again.cycle), cycle_angles(first.cycle))
    assert rms(error) < 2.5


def test_a_ball_does_not_leave_the_ground_by_a_hair_and_come_back():
    rises = np.radians([0.0, 0.1, 0.2, 0.5, 2.0, 9.0])[:, None]
    np.testing.assert_array_equal(for_good(rises), rises)
    wobbles = np.radians([0.0, 0.5, 1.2, 0.4, 0.1, 0.5, 2.0, 9.0])[:, None]
    np.testing.assert_array_equal(for_good(wobbles)[:5], 0.0)
    np.testing.assert_array_equal(for_good(wobbles)[5:], wobbles[5:])
