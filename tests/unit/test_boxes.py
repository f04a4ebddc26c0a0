"""Boxes on a ground: heights, edges, files."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely

from gaitsmith.errors import FileFormatError, InvalidInputError
from gaitsmith.ground import (
    Box,
    Boxes,
    Flat,
    HeightField,
    Slope,
    Stairs,
    ground_from_json,
    read_ground,
)

STAR = ((0.0, 0.0), (2.0, 0.5), (0.8, 0.9), (1.0, 2.5), (0.3, 1.0), (-1.5, 1.2))
TERRACE = HeightField(
    np.repeat([0.0, 0.15, 0.3], 20)[:, None].repeat(90, axis=1), 0.05, (-2.0, -1.0)
)
BASES = [Flat(0.3), Slope(12.0), Stairs(0.17, 0.29, 5), HeightField(), TERRACE]
ids = ["flat", "slope", "stairs", "bumps", "terrace"]


def rectangle(x0, z0, x1, z1, height):
    return Box(((x0, z0), (x1, z0), (x1, z1), (x0, z1)), height)


SEVERAL = (
    Box(STAR, 0.2),
    rectangle(-1.0, 0.5, 1.0, 1.5, 0.1),
    rectangle(1.0, 0.5, 2.0, 1.5, 0.1),
    rectangle(-1.0, 1.5, 1.0, 3.0, 0.25),
)


@pytest.mark.parametrize("base", BASES, ids=ids)
def test_the_highest_box_over_a_point_lifts_the_ground(base):
    ground = Boxes(base, SEVERAL)
    x, z = np.random.default_rng(0).uniform(-2.0, 3.0, (2, 4000))
    lift = np.zeros(4000)
    for box in SEVERAL:
        inside = shapely.contains_xy(shapely.Polygon(box.points), x, z)
        lift = np.where(inside, np.maximum(lift, box.height), lift)
    np.testing.assert_allclose(ground.height(x, z), base.height(x, z) + lift, atol=1e-12)
    np.testing.assert_array_equal(ground.normal(x, z), base.normal(x, z))


def test_between_boxes_that_touch_there_is_no_gap():
    z = np.linspace(0.6, 1.4, 101)
    ground = Boxes(boxes=SEVERAL[1:3])
    assert (ground.height(np.full(101, 1.0), z) == 0.1).all()


@pytest.mark.parametrize("base", BASES[:-1], ids=ids[:-1])
def test_edges_are_all_the_places_where_the_height_jumps(base):
    """Every short way whose height jumps crosses one, which says how high both sides are."""
    ground = Boxes(base, SEVERAL)
    edges = ground.edges((-3.0, -3.0), (4.0, 4.0))
    rng = np.random.default_rng(1)
    begin = rng.uniform(-2.0, 3.0, (20_000, 2))
    end = begin + rng.normal(0.0, 0.01, begin.shape)
    change = np.abs(ground.height(*end.T) - ground.height(*begin.T))
    met = edges.crossings(begin, end)
    free = np.ones(len(begin), dtype=bool)
    free[met.way] = False
    assert (change[free] < 0.019).all()
    assert change[free].size > 15_000
    slack = 0.02 * np.tan(np.radians(12.0)) + 0.01
    once = np.flatnonzero(np.bincount(met.way, minlength=len(begin)) == 1)
    rise = dict(zip(met.way.tolist(), (met.high - met.low).tolist(), strict=True))
    np.testing.assert_allclose(change[once], [rise[k] for k in once.tolist()], atol=slack)


def test_edges_of_boxes_know_the_base_exactly():
    """On a slope the height of a side changes along it; on stairs a riser crosses the box."""
    box = rectangle(-1.0, 0.5, 1.0, 2.0, 0.2)
    sloping = Boxes(Slope(10.0), (box,)).edges((-3.0, 0.0), (3.0, 3.0))
    middle = 0.5 * (sloping.begin + sloping.end)
    level = Slope(10.0).height(*middle.T)
    np.testing.assert_allclose(sloping.low, level, atol=1e-6)
    np.testing.assert_allclose(sloping.high, level + 0.2, atol=1e-6)
    np.testing.assert_allclose(sloping.low, Slope(10.0).height(*sloping.begin.T), atol=0.005)
    stairs = Boxes(Stairs(0.15, 5.0, 1), (box,)).edges((-3.0, 0.0), (3.0, 3.0))
    riser = (stairs.begin[:, 1] == 1.0) & (stairs.end[:, 1] == 1.0)
    middle = 0.5 * (stairs.begin[riser, 0] + stairs.end[riser, 0])
    np.testing.assert_allclose(stairs.high[riser] - stairs.low[riser], 0.15, atol=1e-12)
    np.testing.assert_allclose(stairs.low[riser], np.where(np.abs(middle) < 1.0, 0.2, 0.0))


def test_jumps_of_a_field_are_lifted_by_the_box_over_them():
    box = rectangle(-0.5, -0.5, 0.5, 0.5, 0.2)
    edges = Boxes(TERRACE, (box,)).edges((-1.0, -0.2), (1.0, 0.3))
    middle = 0.5 * (edges.begin + edges.end)
    jumps = np.abs(middle[:, 1] + 0.025) < 1e-9
    lift = np.where(np.abs(middle[jumps, 0]) < 0.5, 0.2, 0.0)
    assert lift.any()
    np.testing.assert_allclose(edges.low[jumps], lift, atol=1e-12)
    np.testing.assert_allclose(edges.high[jumps], 0.15 + lift, atol=1e-12)


def test_a_side_under_a_higher_box_is_no_edge():
    low, high = rectangle(-1.0, 0.0, 1.0, 1.0, 0.1), rectangle(-2.0, -1.0, 2.0, 2.0, 0.3)
    edges = Boxes(boxes=(low, high)).edges((-3.0, -3.0), (3.0, 3.0))
    assert len(edges) == 4
    assert (edges.high == 0.3).all()


def test_boxes_on_boxes_are_one_ground():
    one = Boxes(Boxes(Slope(5.0), SEVERAL[:1]), SEVERAL[1:])
    assert one.as_json() == Boxes(Slope(5.0), SEVERAL).as_json()


@pytest.mark.parametrize(
    ("points", "height", "says"),
    [
        (STAR, 0.01, "from 0.02 to 3 m, got 0.01; what is lower is not felt underfoot"),
        (STAR, -0.1, "from 0.02 to 3 m, got -0.1"),
        (STAR, float("nan"), "finite number of meters, got nan"),
        (STAR[:2], 0.1, "the outline of a box needs 3 to 1000 corners, got 2"),
        (((0, 0), (1, 1), (1, 0), (0, 1)), 0.1, "crosses itself"),
        (((0, 0), (1, 1), (2, float("inf"))), 0.1, "corner 3 of a box must be within 2000 m"),
    ],
)
def test_a_box_that_is_none(points, height, says):
    with pytest.raises(InvalidInputError, match=says):
        Box(points, height)


@pytest.mark.parametrize(
    "change",
    [
        {"boxes": []},
        {"boxes": [{"points": [[0, 0], [1, 0]], "height": 0.1}]},
        {"boxes": [{"points": [[0, 0], [1, 0], [0, 1]]}]},
        {"boxes": [{"points": 3, "height": 0.1}]},
        {"boxes": 3},
        {"ground": "flat"},
        {"ground": {}},
        {"ground": {"kind": "boxes"}},
        {"ground": None},
    ],
)
def test_json_that_is_no_ground_of_boxes(change):
    with pytest.raises(InvalidInputError):
        ground_from_json({**Boxes().as_json(), **change})


# -------------------------------------------------------------------------------- files

KERB = """
ground = "slope:5"

[[box]]
name = "kerb"
points = [[-2, 1.5], [2, 1.5], [2, 1.8], [-2, 1.8]]
height = 0.12
"""


def written(folder, text):
    path = folder / "yard.toml"
    path.write_text(text)
    return path


def test_a_file_of_boxes(tmp_path):
    path = written(tmp_path, KERB)
    ground = read_ground(str(path))
    assert ground.as_json() == Boxes(Slope(5.0), (rectangle(-2, 1.5, 2, 1.8, 0.12),)).as_json()
    assert read_ground(path).as_json() == ground.as_json()


def test_boxes_lie_on_a_field_beside_the_file(tmp_path):
    np.savez(tmp_path / "hill.npz", height=np.eye(4), cell=0.5, origin=np.zeros(2))
    ground = read_ground(written(tmp_path, KERB.replace("slope:5", "hill.npz")))
    assert json.loads(json.dumps(ground.as_json()))["ground"]["kind"] == "heightfield"


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("slope:5", "slop:5", "line 2: ground: unknown ground 'slop'"),
        ("slope:5", "none.npz", "line 2: ground: .*none.npz"),
        ("slope:5", "yard.toml", "line 2: ground: boxes lie on words or on a file of heights"),
        ('"slope:5"', "5", "line 2: ground: must be text"),
        ("name", "nam", "line 5: box 1, nam: unknown key, did you mean 'name'"),
        ('"kerb"', "7", "line 5: box 1, name: must be text, got 7"),
        ("height = 0.12", "", "line 4: box 1: height is missing"),
        ("0.12", "0.001", "line 7: box 1, height: .*from 0.02 to 3 m, got 0.001"),
        ("0.12", "true", "line 7: box 1, height: must be a number of meters, got True"),
        ("0.12", "nan", "line 7: box 1, height: .*finite"),
        ("[2, 1.8], [-2, 1.8]]", "[-2, 1.8], [2, 1.8]]", "line 6: box 1, points: .*crosses itself"),
        ("[-2, 1.5]", "[-2]", "line 6: box 1, points: must be corners"),
        ("[[box]]", "[[bx]]", "needs boxes: tables"),
        ("[[box]]", "[[box", "not a TOML file"),
        (KERB[1:], "", "needs boxes: tables"),
    ],
)
def test_what_is_wrong_in_a_file_is_said_with_its_line(tmp_path, old, new, says):
    path = written(tmp_path, KERB.replace(old, new))
    assert path.read_text() != KERB
    with pytest.raises(FileFormatError, match=says) as caught:
        read_ground(path)
    assert "yard.toml" in str(caught.value)
    assert "\n" not in str(caught.value)
