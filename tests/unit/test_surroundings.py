"""What stands around: read, checked, named."""

from __future__ import annotations

import json

import pytest

from gaitsmith.errors import InvalidInputError
from gaitsmith.plan.surroundings import Bar, Obstacle, Post, Surroundings, read_surroundings

SQUARE = ((0.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))


def test_a_recipe_holds_them_exactly():
    given = Surroundings(
        (Obstacle(SQUARE, "table"), Obstacle(SQUARE, "step", 0.2)),
        (Bar((0, 3), (1, 3), 1.4),),
        (Post((0.3, 4)),),
    )
    again = read_surroundings(json.loads(json.dumps(given.as_dict())))
    assert again == read_surroundings(given) == read_surroundings(again)
    assert "height" not in given.as_dict()["obstacles"][0]
    assert read_surroundings(None).empty
    assert not given.empty


def test_the_same_name_twice_gets_a_number():
    read = read_surroundings(Surroundings(posts=(Post((0, 1)), Post((0, 2)))))
    assert [p.name for p in read.posts] == ["post", "post 2"]


def test_an_outline_may_be_closed_by_its_first_corner():
    read = read_surroundings(Surroundings((Obstacle((*SQUARE, SQUARE[0])),)))
    assert read.obstacles[0].points == SQUARE


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"obstacles": [{"points": SQUARE[:2]}]}, "needs 3 to 1000 corners, got 2"),
        ({"obstacles": [{"points": [(0, 0), (1, 1), (1, 0), (0, 1)]}]}, "crosses itself"),
        ({"obstacles": [{"points": [(0, 0), (0, 0), (1, 0), (0, 1)]}]}, "twice"),
        ({"obstacles": [{"points": [(0, 0), (1, 0), (2, 0)]}]}, "encloses nothing"),
        ({"obstacles": [{"points": [(0, 0), (1, 0), (float("nan"), 1)]}]}, "corner 3 of 'obst"),
        ({"obstacles": [{"points": [(0, 0), (1, 0), 3]}]}, "must be points x,z"),
        ({"obstacles": [{"points": SQUARE, "name": ""}]}, "must be text"),
        (
            {"obstacles": [{"points": SQUARE, "height": 0.01}]},
            "height of 'obstacle' must be from 0",
        ),
        (
            {"obstacles": [{"points": SQUARE, "height": "low"}]},
            "finite number of meters, got 'low'",
        ),
        ({"bars": [{"begin": (0, 1), "end": (1, 1), "height": -1}]}, "height of 'bar'"),
        ({"bars": [{"begin": (0, 1), "end": 1, "height": 1}]}, "the end of 'bar'"),
        ({"bars": [{"begin": (0, 1), "end": (0, 2), "height": 1, "radius": 0}]}, "radius of 'bar'"),
        ({"posts": [{"at": (0, 1), "bottom": 2.0, "top": 1.0}]}, "from a bottom of 0 m"),
        ({"posts": [{"at": (0, float("inf"))}]}, "within 2000 m"),
        ({"posts": [{"where": (0, 1)}]}, "not the surroundings of a walk"),
        ({"trees": []}, "not 'trees'"),
    ],
)
def test_what_is_wrong_is_named(given, says):
    with pytest.raises(InvalidInputError, match=says):
        read_surroundings(given)
