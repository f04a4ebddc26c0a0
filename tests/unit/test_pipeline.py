"""The one-call API: what it refuses, warns of, records and writes."""

from __future__ import annotations

import json

import numpy as np
import pytest

import gaitsmith
from gaitsmith.body.presets import body_from
from gaitsmith.errors import (
    FileFormatError,
    GaitsmithWarning,
    InfeasibleSpeedError,
    InfeasibleStepError,
    InvalidInputError,
    UnknownNameError,
)
from gaitsmith.pipeline import WRITERS, regenerate, save, save_all, walk


@pytest.fixture(scope="module")
def motion():
    return walk(distance=1.5, fps=30)


NUMBERS = ["distance", "fps", "step_length", "cadence", "speed", "step_width"]


@pytest.mark.parametrize("name", NUMBERS)
@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf, -np.inf, "far"])
def test_a_bad_number_is_named(name, bad):
    with pytest.raises(InvalidInputError, match=f"{name} must be a positive number"):
        walk(**{"distance": 2.0, name: bad})


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ({"start": "run"}, InvalidInputError, "start must be one of stand, walk, got 'run'"),
        ({"stop": None}, InvalidInputError, "stop must be one of stand, walk, got None"),
        ({"gait": "wintr"}, UnknownNameError, "unknown gait 'wintr'.*Did you mean 'winter'"),
        ({"body": "adlut"}, UnknownNameError, "Did you mean 'adult'"),
        ({"body": 17}, InvalidInputError, "height must be from"),
        ({"body": np.nan}, InvalidInputError, "height must be"),
        ({"body": "missing.toml"}, FileFormatError, "missing.toml: cannot be read"),
        ({"toe_out": np.nan}, InvalidInputError, "toe_out must be a finite number of radians"),
        ({"toe_out": 1.0}, InvalidInputError, r"toe_out must be from -5 to 30 deg, got 57.3 deg"),
        ({"toe_out": -1.0}, InvalidInputError, r"got -57.3 deg"),
        ({"step_width": 0.6}, InvalidInputError, "step_width must be from 0.088 to 0.430 m"),
        (
            {"fps": 20_000},
            InvalidInputError,
            "fps must be from 5 to 10000 frames per second, got 20000",
        ),
        ({"seed": -1}, InvalidInputError, "seed must be a whole number, 0 or more, got -1"),
        ({"seed": 1.5}, InvalidInputError, "seed must be a whole number"),
        ({"seed": True}, InvalidInputError, "seed must be a whole number"),
        (
            {"step_length": 0.7, "cadence": 100, "speed": 1.3},
            InvalidInputError,
            "give any two of the three",
        ),
        ({"step_length": 1.2, "cadence": 60}, InfeasibleStepError, "The longest that works is"),
        ({"speed": 2.5}, InfeasibleSpeedError, "The fastest walk is"),
    ],
)
def test_what_cannot_be_done_says_why(wrong, error, message):
    with pytest.raises(error, match=message):
        walk(**{"distance": 2.0, **wrong})


def test_the_longest_step_and_the_fastest_walk_offered_do_work():
    with pytest.raises(InfeasibleStepError) as long:
        walk(distance=3.0, step_length=2.0, cadence=30)
    with pytest.warns(GaitsmithWarning, match="longer than people take"):
        walk(distance=3.0, step_length=long.value.available, cadence=60)
    with pytest.raises(InfeasibleSpeedError) as fast:
        walk(distance=3.0, speed=9.0)
    with pytest.warns(GaitsmithWarning, match="nearly a run"):
        walk(distance=3.0, speed=0.999 * fast.value.available, step_length=0.8)


@pytest.mark.parametrize("froude", [0.39, 0.41])
def test_a_warning_above_froude_two_fifths(froude, recwarn):
    body = body_from(1.75)
    speed = np.sqrt(froude * 9.80665 * body.hip_height)
    if froude < 0.4:
        walk(distance=3.0, speed=speed, step_length=0.8)
        assert not recwarn.list
        return
    with pytest.warns(GaitsmithWarning, match=r"Froude number 0\.41 for this body"):
        walk(distance=3.0, speed=speed, step_length=0.8)


def test_a_warning_above_one_point_nought_five_legs():
    body = body_from(1.75)
    walk(distance=3.0, step_length=1.04 * body.leg_length, cadence=70)
    with pytest.warns(GaitsmithWarning, match=r"1\.07 leg lengths"):
        walk(distance=3.0, step_length=1.07 * body.leg_length, cadence=70)


def test_the_recipe_holds_every_argument():
    recipe = json.loads(walk(distance=1.0, cadence=100).labels.recipe)
    asked = {"distance", "body", "gait", "step_length", "cadence", "speed", "start", "stop"}
    asked |= {"step_width", "toe_out", "manner", "fps", "seed"}
    assert recipe["walk"].keys() == asked
    assert recipe["walk"]["step_length"] is None
    assert recipe["walk"]["cadence"] == 100


@pytest.mark.parametrize("recipe", ["{}", {"walk": 3}, '{"walk": null}'])
def test_what_is_no_recipe(recipe):
    with pytest.raises(InvalidInputError, match="must be an object with a 'walk' object"):
        regenerate(recipe)


def test_a_motion_without_labels_has_no_recipe(motion):
    with pytest.raises(InvalidInputError, match="has no recipe"):
        regenerate(motion.with_(labels=None))


def test_a_recipe_of_another_version_warns(motion):
    recipe = json.loads(motion.labels.recipe) | {"gaitsmith": "0.0.1"}
    with pytest.warns(GaitsmithWarning, match=r"of gaitsmith 0\.0\.1.*may differ"):
        again = regenerate(recipe)
    np.testing.assert_array_equal(again.rotations, motion.rotations)


SLOW = {".gif"}


@pytest.mark.parametrize(
    "suffix", [pytest.param(s, marks=[pytest.mark.slow] if s in SLOW else []) for s in WRITERS]
)
def test_every_format_is_written(suffix, motion, tmp_path):
    path = save(motion, tmp_path / f"a{suffix}")
    assert path.stat().st_size > 1000
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_all_files_or_none(motion, tmp_path, monkeypatch):
    def broken(motion, path):
        path.write_text("half")
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setitem(WRITERS, ".png", broken)
    with pytest.raises(OSError, match=r"No space left on device: .*b\.png"):
        save_all(motion, [tmp_path / "a.npz", tmp_path / "b.png", tmp_path / "c.bvh"])
    assert list(tmp_path.iterdir()) == []


def test_a_walk_in_three_lines(tmp_path):
    motion = gaitsmith.walk(distance=1.0)
    gaitsmith.save(motion, tmp_path / "walk.npz")
    assert len(gaitsmith.load(tmp_path / "walk.npz")) == len(motion)


def test_a_way_too_short_for_the_step_asked_for_is_said():
    with pytest.warns(GaitsmithWarning, match=r"full step of 0.800 m; the longest is 0.640 m"):
        walk(distance=1.0, step_length=0.8)
