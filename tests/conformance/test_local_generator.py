"""Local steps and turns keep the contract of seam 2, alone and between walks."""

from __future__ import annotations

import numpy as np
import pytest
from people import GROUND, person, the_walk
from step_generator import StepGeneratorContract

from gaitsmith.plan.director import Manners, direct
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import preferred_pace
from gaitsmith.plan.script import read_script
from gaitsmith.plan.timeline import Timeline
from gaitsmith.synthesis.stepping import LocalGenerator


def steps_of(script, body):
    """The steps of a script, its whiles of standing left out."""
    stance = Stance(max(0.057 * body.height, 0.066), 0.1)
    plan = direct(read_script(script), Manners(body, preferred_pace(body), stance, GROUND))
    return Timeline(tuple(s for s in plan.planned if s.kind != "stand"))


class OfScript(StepGeneratorContract):
    script = ""

    @pytest.fixture(params=[1.75, "child"], ids=str)
    def body(self, request):
        return person(request.param)

    @pytest.fixture
    def generator(self):
        return LocalGenerator(the_walk(), GROUND)

    @pytest.fixture
    def plan(self, body):
        return steps_of(self.script, body)


class TestForward(OfScript):
    script = "step forward 0.4; step forward 1.0"


class TestLateral(OfScript):
    script = "step left 0.4; step right 0.3"


class TestTurnaround(OfScript):
    """Three turnarounds in a row: between two turns there is the while of the gaze's lead."""

    script = "turn left 250"


class TestTurnaroundToTheRight(OfScript):
    script = "turn right 90"


class TestBackward(OfScript):
    script = "step back 0.3; step back 0.4"

    def test_footsteps_are_where_the_plan_has_them(self, steps, body):
        """Toes land first, so the heel is there when the foot has come down."""
        for planned, step in steps:
            pose = step.poses(np.array([1.0]))
            assert pose.contacts[0, planned.target.side, 2], "the toe tip bears"
