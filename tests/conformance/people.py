"""Who walks and how in the tests: bodies, paces, and walks prepared without the pipeline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from hypothesis import strategies as st

from gaitsmith.body.presets import BODIES, body_from
from gaitsmith.conventions import GRAVITY
from gaitsmith.ground import Flat
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.straight import Stance, plan_straight
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks import winter

ENDS = ("stand", "walk")
GROUND = Flat()


@cache
def person(spec):
    return body_from(spec)


@cache
def the_walk():
    return winter()


def heights():
    return st.floats(1.2, 2.1).map(lambda h: round(h, 3))


def people():
    """Anybody from 1.2 to 2.1 m, and everybody who has a name."""
    return st.one_of(heights(), st.sampled_from(sorted(BODIES))).map(person)


def fastest_cadence(body, step_length, froude=0.4):
    """Steps per minute at which steps of this length reach the Froude number."""
    leg = body.thigh + body.shin + body.foot.ankle_height
    return 60.0 * np.sqrt(froude * GRAVITY * leg) / step_length


@dataclass(frozen=True)
class Errand:
    """What is asked of a person: arguments of ``gaitsmith.walk``."""

    body: object
    step_length: float
    cadence: float
    distance: float
    start: str
    stop: str
    fps: float

    @property
    def arguments(self):
        return dict(vars(self))

    def __repr__(self):
        rest = {k: v for k, v in vars(self).items() if k != "body"}
        return f"Errand({self.body.name}, {self.body.height:.3f} m, {rest})"


@st.composite
def errands(draw, frame_rates=(24.0, 30.0, 59.94, 60.0, 120.0), shortest=0.1, longest=12.0):
    """All that is promised to walk, on level ground."""
    body = draw(people())
    length = draw(st.floats(0.3, 1.0)) * body.leg_length
    cadence = draw(st.floats(70.0, min(140.0, fastest_cadence(body, length))))
    start, stop = draw(st.sampled_from(ENDS)), draw(st.sampled_from(ENDS))
    least = shortest if stop == "stand" or start == "stand" else max(shortest, 1.001 * length)
    distance = draw(st.one_of(st.floats(least, 3.0), st.floats(3.0, longest)))
    return Errand(body, length, cadence, distance, start, stop, draw(st.sampled_from(frame_rates)))


def straight_plan(
    body,
    *,
    ratio=0.8,
    cadence=105.0,
    distance=4.0,
    start="stand",
    stop="stand",
    width=0.1,
    toe_out=0.1,
    heading=0.0,
    origin=(0.0, 0.0),
):
    return plan_straight(
        distance=distance,
        pace=Pace(ratio * body.leg_length, cadence),
        stance=Stance(width, toe_out),
        ground=GROUND,
        start=start,
        stop=stop,
        origin=origin,
        heading=heading,
    )


def prepared(body, plan, walk=None, rest=0.2):
    """The plan with its feet on the ground."""
    generator = StraightGenerator(walk or the_walk(), GROUND)
    return prepare_walk(plan, generator, body, GROUND, rest=rest)
