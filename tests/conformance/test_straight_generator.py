"""The straight generator keeps the contract of seam 2, whatever walk drives it."""

from __future__ import annotations

import pytest
from compass_walk import CompassWalk
from people import GROUND, person, straight_plan, the_walk
from step_generator import StepGeneratorContract

from gaitsmith.synthesis.straight import StraightGenerator


class OfAnyBody(StepGeneratorContract):
    @pytest.fixture(params=[1.75, "child", "kb92b-figure"], ids=str)
    def body(self, request):
        return person(request.param)

    @pytest.fixture(params=[("stand", "stand"), ("walk", "walk")], ids="-".join)
    def plan(self, request, body):
        start, stop = request.param
        return straight_plan(body, ratio=0.75, distance=3.0, start=start, stop=stop)


class TestStraightGeneratorOfTheMeasuredWalk(OfAnyBody):
    @pytest.fixture
    def generator(self):
        return StraightGenerator(the_walk(), GROUND)


class TestStraightGeneratorOfTheCompass(OfAnyBody):
    @pytest.fixture
    def generator(self):
        return StraightGenerator(CompassWalk(), GROUND)
