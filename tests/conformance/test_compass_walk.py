"""The smallest walk keeps the contract of seam 1, and nothing but the seam is needed to walk it.

[KB92a]: any straight-line walking system can be driven.
"""

from __future__ import annotations

import pytest
from compass_walk import CompassWalk
from judge import broken, judge
from people import ENDS, GROUND, person, prepared, straight_plan
from straight_walk import StraightWalkContract

from gaitsmith.synthesis.sample import sample_walk

#: The compass proposes feet that never roll, so its rear heel is raised by the contact stage
#: alone, on the compass' own coarse grid: between two samples the knee gets a little
#: straighter than the 3 degrees that hold for the measured walk.
COMPASS_KNEE_DEG = 2.0


class TestCompassWalk(StraightWalkContract):
    @pytest.fixture
    def walk(self):
        return CompassWalk()


@pytest.mark.parametrize("who", [1.2, 1.75, 2.1, "kb92b-figure"])
@pytest.mark.parametrize("ratio", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
def test_a_compass_walks(who, ratio, start, stop):
    body = person(who)
    plan = straight_plan(body, ratio=ratio, cadence=100.0, start=start, stop=stop)
    walk = prepared(body, plan, CompassWalk())
    motion = sample_walk(walk, body, GROUND, fps=120.0, recipe={})
    assert broken(motion, but=["stance_knee_deg"]) == {}
    assert judge(motion)["stance_knee_deg"] > COMPASS_KNEE_DEG
