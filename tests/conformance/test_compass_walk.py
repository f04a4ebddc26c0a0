"""The smallest walk keeps the contract of seam 1, and nothing but the seam is needed to walk it.

[KB92a]: any straight-line walking system can be driven.
"""

from __future__ import annotations

import pytest
from compass_walk import CompassWalk
from judge import broken
from people import ENDS, GROUND, person, prepared, straight_plan
from straight_walk import StraightWalkContract

from gaitsmith.synthesis.sample import sample_walk


class TestCompassWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self):
        return CompassWalk()


def walked(who, ratio, start, stop, **samples):
    body = person(who)
    plan = straight_plan(body, ratio=ratio, cadence=100.0, start=start, stop=stop)
    walk = prepared(body, plan, CompassWalk(**samples))
    return sample_walk(walk, body, GROUND, fps=120.0, recipe={})


@pytest.mark.parametrize("who", [1.2, 1.75, 2.1, "kb92b-figure"])
@pytest.mark.parametrize("ratio", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
def test_a_compass_walks_and_keeps_every_promise(who, ratio, start, stop):
    assert broken(walked(who, ratio, start, stop)) == {}


@pytest.mark.parametrize("samples", [9, 17, 129, 1025])
def test_the_promises_do_not_hang_on_how_finely_a_walk_is_sampled(samples):
    assert broken(walked(1.75, 0.9, "walk", "walk", samples=samples)) == {}
