"""Mixed gaits walk everywhere: the paper's recipes and pairs of styles, curves, slopes, stairs."""

from __future__ import annotations

import warnings
from functools import cache

import pytest
from judge import broken
from people import person

from gaitsmith.composing import compose
from gaitsmith.errors import GaitsmithWarning
from gaitsmith.ground import Slope, Stairs
from gaitsmith.pipeline import walk
from gaitsmith.plan.paths import Path

#: The paper's examples as built-in styles.
STYLES = {
    "Basic": "neutral", "Energetic": "happy", "Gorilla": "swagger", "Tired": "tired",
    "Delightful": "childlike", "Side_Sway": "proud", "Confident": "angry", "Bouncy": "hurried",
    "Charlie_Chaplin": "careful", "Shoulder_Roll": "elderly",
}  # fmt: skip
PAIRS = ("sad+proud", "sneaky+happy", "elderly+hurried", "careful+swagger", "tired+angry")
GAITS = ("relaxed", "tired", "rigid", *PAIRS)
S_CURVE = [(1.5, 0.0), (1.57, 0.7), (2.0, 0.0), (1.57, -0.7), (1.0, 0.0)]
WAYS = {
    "circle": {"path": Path.arc(1.2, 6.0)},
    "s-curve": {"path": Path.of_turns(S_CURVE)},
    "upstairs": {"distance": 4.0, "ground": Stairs(0.17, 0.29, 8, 1.0)},
    "downstairs": {"distance": 4.0, "ground": Stairs(-0.17, 0.29, 8, 1.0)},
    "uphill": {"distance": 4.0, "ground": Slope(10.0)},
    "downhill": {"distance": 4.0, "ground": Slope(-10.0)},
}  # fmt: skip
BODIES = (1.45, 1.75, 2.0)


@cache
def mixed(name):
    if "+" not in name:
        return compose({"paper": name, "styles": STYLES})
    one, two = name.split("+")
    return compose({
        "styles": {"a": one, "b": two},
        "root": {"weights": {"a": 0.5, "b": 0.5}},
        "arms": {"weights": {"b": 1.0}},
    })  # fmt: skip


def test_arms_of_another_go_upstairs():
    holds("sneaky+happy", 1.75, "upstairs")


@pytest.mark.slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("height", BODIES)
@pytest.mark.parametrize("name", GAITS)
def test_every_promise_is_kept(name, height, way):
    holds(name, height, way)


def holds(name, height, way):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # of unusual weights and short steps
        motion = walk(gait=mixed(name), body=person(height), fps=120, **WAYS[way])
    # a heel over an edge bears nothing: its footstep cannot be told from heel and ball
    assert broken(motion, but=("unflagged_bearing", "footsteps_unseen")) == {}
