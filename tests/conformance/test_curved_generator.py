"""The curved generator keeps the contract of seam 2, whatever walk drives it."""

from __future__ import annotations

import pytest
from compass_walk import CompassWalk
from people import GROUND, person, the_walk
from step_generator import StepGeneratorContract

from gaitsmith.plan.follow import follow
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.paths import Path
from gaitsmith.synthesis.curved import CurvedGenerator


class OnAnyPath(StepGeneratorContract):
    @pytest.fixture(params=[1.75, "child"], ids=str)
    def body(self, request):
        return person(request.param)

    @pytest.fixture(params=[2.0, -0.8], ids=str)
    def plan(self, request, body):
        return follow(
            Path.arc(abs(request.param), 3.0 / request.param),
            pace=Pace(0.75 * body.leg_length, 105.0),
            stance=Stance(0.1, 0.1),
            ground=GROUND,
            body=body,
        )


class TestCurvedGeneratorOfTheMeasuredWalk(OnAnyPath):
    @pytest.fixture
    def generator(self):
        return CurvedGenerator(the_walk(), GROUND, exact=True)


class TestCurvedGeneratorOfTheCompass(OnAnyPath):
    @pytest.fixture
    def generator(self):
        return CurvedGenerator(CompassWalk(), GROUND, exact=True)


class TestAnchoredGenerator(OnAnyPath):
    @pytest.fixture
    def generator(self):
        return CurvedGenerator(the_walk(), GROUND, mode="anchored", exact=True)
