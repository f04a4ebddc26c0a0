from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.files import body_from_dict, body_from_toml, body_to_dict
from gaitsmith.body.presets import BODIES, KB92B_SUBJECT, body_from
from gaitsmith.body.proportions import SHORTEST, TALLEST, body_from_height
from gaitsmith.errors import (
    FileFormatError,
    InvalidInputError,
    UnknownFormatError,
    UnknownNameError,
)


@pytest.fixture
def write(tmp_path):
    def to_file(text: str, name: str = "me.toml") -> Path:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return to_file


def complaint(path: Path) -> str:
    with pytest.raises(FileFormatError) as caught:
        body_from_toml(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@given(st.floats(SHORTEST, TALLEST), st.integers(1, 40))
def test_json_round_trip_is_exact(height, segments):
    body = body_from_height(height, spine_segments=segments)
    assert body_from_dict(json.loads(json.dumps(body_to_dict(body)))) == body


def test_dictionaries_must_be_bodies():
    data = body_to_dict(KB92B_SUBJECT)
    assert body_from_dict({k: v for k, v in data.items() if k != "spine_segments"}) == KB92B_SUBJECT
    for bad in (None, [], {}, {"foot": 3}):
        with pytest.raises(InvalidInputError, match="'foot' object"):
            body_from_dict(bad)
    data["tigh"] = data.pop("thigh")
    del data["foot"]["ball"]
    words = "thigh: missing; tigh: unknown key, did you mean 'thigh'.; foot.ball: missing"
    with pytest.raises(InvalidInputError, match=words):
        body_from_dict(data)


def test_a_height_is_enough(write):
    assert body_from_toml(write("height = 1.68")) == body_from_height(1.68, name="me")


def test_every_measure_overrides(write):
    body = body_from_height(1.62, name="Ada", spine_segments=5).scaled(1.01)
    body = replace(body, foot=replace(body.foot, toe_joint_height=0.01), mass=61.0)
    lines = [f"{k} = {v!r}" for k, v in body_to_dict(body).items() if isinstance(v, float | int)]
    feet = [f"{f.name} = {getattr(body.foot, f.name)!r}" for f in fields(Foot)]
    text = "\n".join(['name = "Ada"', *lines, "[foot]", *feet])
    assert body_from_toml(write(text)) == body


def test_whole_numbers_are_numbers(write):
    body = body_from_toml(write("height = 2\nmass = 90"))
    assert (body.height, body.mass) == (2.0, 90.0)
    assert isinstance(body.mass, float)


def test_legs_tell_the_height(write):
    body = body_from_toml(write("thigh = 0.40\nshin = 0.41\n[foot]\nankle_height = 0.08"))
    like = body_from_height(0.81 / 0.491)
    assert (body.thigh, body.shin, body.foot.ankle_height) == (0.40, 0.41, 0.08)
    assert body.trunk == pytest.approx(like.trunk, rel=1e-12)
    assert body.height == pytest.approx(like.height - like.foot.ankle_height + 0.08, abs=1e-12)


def test_all_that_is_wrong_is_said_at_once(write):
    text = complaint(
        write(
            "hieght = 1.7\nthigh = -0.4\nmass = nan\nneck = inf\nspine_segments = 3.5\nname = 3\n"
            'hand = 0\n[foot]\nankel_height = 0.07\nheel = "a"\nball = true\ntoe_joint_height = -1'
        )
    )
    for part in (
        "hieght: unknown key, did you mean 'height'?",
        "height: missing",
        "thigh: must be a positive number of meters, got -0.4",
        "hand: must be a positive number of meters, got 0",
        "mass: must be a finite number of kilograms, got nan",
        "neck: must be a finite number of meters, got inf",
        "spine_segments: must be a whole number of joints, got 3.5",
        "name: must be a string, got 3",
        "foot.ankel_height: unknown key, did you mean 'foot.ankle_height'?",
        "foot.heel: must be a number of meters, got 'a'",
        "foot.ball: must be a number of meters, got True",
        "foot.toe_joint_height: must be at least 0.0 meters, got -1",
    ):
        assert part in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("height = 17", "height: must be at most 2.3 meters, got 17"),
        ("height = 0.3", "height: must be at least 0.8 meters, got 0.3"),
        ("height = 1.7\nspine_segments = 99", "spine_segments: must be at most 40 joints"),
        ("height = 1.7\nfoot = 3", "foot: must be a table, [foot], got 3"),
        ("height = 1.7\n[wings]\nspan = 3", "wings: unknown key"),
        ("height = 1.7\nthigh = 0.9\nhip_width = 2", "twice body.shin"),
        ("height = 1.7\nneck = 1.5", "body.height (1.700 m) must be within 25%"),
        ("height = 1.7\n[foot]\ntoe_joint_height = 0.5", "below the ankle"),
        ("thigh = 0.1\nshin = 0.1", "give the height as well"),
        ("thigh = 0.4", "height: missing (needed unless thigh and shin are both given)"),
        ("height == 1.7", "not a TOML file"),
        ("", "height: missing"),
    ],
)
def test_bad_files(write, text, words):
    assert words in complaint(write(text))


def test_files_that_cannot_be_read(tmp_path):
    assert "cannot be read" in complaint(tmp_path / "none.toml")
    assert "cannot be read" in complaint(tmp_path)
    (tmp_path / "x.toml").write_bytes(b"height = 1.7 # \xff")
    assert "not a TOML file" in complaint(tmp_path / "x.toml")


def test_what_body_takes(write):
    path = write("height = 1.68")
    assert body_from("1.75") == body_from(1.75) == body_from(" 1.75 ") == body_from_height(1.75)
    assert body_from(2) == body_from_height(2.0)
    assert body_from(str(path)) == body_from(path) == body_from_toml(path)
    assert body_from(KB92B_SUBJECT) is KB92B_SUBJECT
    for name in BODIES:
        assert isinstance(body_from(name), Body)


@pytest.mark.parametrize("bad", ["nan", "-1", "inf", "0", "175", float("nan"), -1.75, 0])
def test_heights_that_are_none(bad):
    with pytest.raises(InvalidInputError, match="height must be"):
        body_from(bad)


@pytest.mark.parametrize("bad", [None, True, [1.75], np.ones(3)])
def test_things_that_are_no_body(bad):
    with pytest.raises(InvalidInputError, match="a body must be"):
        body_from(bad)


def test_unknown_names_and_formats():
    with pytest.raises(UnknownNameError, match=r"'adlt'; known: adult, .* Did you mean 'adult'\?"):
        body_from("adlt")
    for bad in ("", "1.75m", "1,75"):
        with pytest.raises(UnknownNameError, match="height in meters"):
            body_from(bad)
    for bad in ("rig.bvh", Path("rig.bvh"), Path("rig")):
        with pytest.raises(UnknownFormatError, match=r"known suffixes: \.toml"):
            body_from(bad)


def test_importing_presets_is_light():
    code = (
        "import sys, gaitsmith.body.presets as p; p.body_from('1.75');"
        "print(*{'pydantic', 'tomllib', 'scipy'} & set(sys.modules))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.split() == []
