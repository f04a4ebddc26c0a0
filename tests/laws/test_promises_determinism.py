"""The same question gives the same bytes: in one process, in two, and from the recipe."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from people import errands

from gaitsmith import io
from gaitsmith.body.presets import BODIES, body_from
from gaitsmith.pipeline import regenerate, save_all, walk
from gaitsmith.synthesis.upper_body import Manner

SUFFIXES = (".npz", ".bvh", ".csv")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("files")


def digests(motion, folder):
    files = save_all(motion, [folder / f"motion{suffix}" for suffix in SUFFIXES])
    return [hashlib.sha256(path.read_bytes()).hexdigest() for path in files]


def test_twice_the_same_bytes(folder):
    arguments = {"distance": 3.0, "body": 1.62, "speed": 1.1}
    assert digests(walk(**arguments), folder) == digests(walk(**arguments), folder)


def test_what_was_walked_before_does_not_matter(folder):
    """Caches remember, but nobody can tell."""
    arguments = {"distance": 3.0, "body": "child", "cadence": 120.0}
    first = digests(walk(**arguments), folder)
    for height in (1.3, 1.75, 2.0):
        walk(distance=2.0, body=height, cadence=120.0)
    assert digests(walk(**arguments), folder) == first


def test_two_processes_the_same_bytes(tmp_path):
    found = []
    for i, seed in enumerate(("1", "2")):
        place = tmp_path / str(i)
        place.mkdir()
        files = [str(place / f"w{suffix}") for suffix in SUFFIXES]
        outputs = [word for file in files for word in ("-o", file)]
        command = [sys.executable, "-m", "gaitsmith", "walk", "--distance", "3", *outputs]
        subprocess.run(
            command, check=True, env={**os.environ, "PYTHONHASHSEED": seed}, capture_output=True
        )
        found.append([(place / f"w{suffix}").read_bytes() for suffix in SUFFIXES])
    assert found[0] == found[1]


COMBINATIONS = [
    {},
    {"body": 1.2},
    {"body": "1.9"},
    {"body": BODIES["kb92b-figure"]()},
    {"gait": "winter"},
    {"step_length": 0.6},
    {"cadence": 95.0},
    {"speed": 1.0},
    {"step_length": 0.6, "cadence": 95.0},
    {"step_length": 0.6, "speed": 1.0},
    {"cadence": 95.0, "speed": 1.0},
    {"step_length": 0.6, "cadence": 100.0, "speed": 1.0},
    {"start": "walk"},
    {"stop": "walk"},
    {"start": "walk", "stop": "walk"},
    {"step_width": 0.15},
    {"toe_out": 0.0},
    {"manner": Manner(pelvis=False)},
    {"manner": Manner(arms=False, lean=0.1)},
    {"fps": 29.97},
    {"seed": 7},
]


@pytest.mark.parametrize("more", COMBINATIONS, ids=lambda more: "-".join(more) or "defaults")
def test_the_recipe_regenerates_the_bytes(more, folder):
    motion = walk(distance=2.2, **more)
    wanted = digests(motion, folder)
    assert digests(regenerate(motion), folder) == wanted
    assert digests(regenerate(motion.labels.recipe), folder) == wanted
    assert digests(regenerate(json.loads(motion.labels.recipe)), folder) == wanted


@settings(max_examples=15)
@given(errand=errands(), width=st.none() | st.floats(0.11, 0.2), toe_out=st.floats(-0.08, 0.5))
def test_any_recipe_survives_its_file(errand, width, toe_out, folder):
    """Written, read again and regenerated: the same bytes."""
    motion = walk(**errand.arguments, step_width=width, toe_out=toe_out)
    wanted = digests(motion, folder)
    back = io.load(folder / "motion.npz")
    assert digests(regenerate(back), folder) == wanted


def test_the_recipe_names_its_maker_and_no_place():
    recipe = json.loads(walk(distance=1.0).labels.recipe)
    assert recipe["gaitsmith"]
    assert recipe["walk"]["distance"] == 1.0
    text = json.dumps(recipe)
    assert "/" not in text


def test_the_body_of_a_recipe_needs_no_file(tmp_path, folder):
    path = tmp_path / "me.toml"
    path.write_text("height = 1.7\n")
    motion = walk(distance=1.0, body=path)
    wanted = digests(motion, folder)
    path.unlink()
    assert digests(regenerate(motion), folder) == wanted


def test_another_seed_is_recorded_and_changes_no_step():
    one, other = walk(distance=2.0, seed=0), walk(distance=2.0, seed=12345)
    np.testing.assert_array_equal(one.rotations, other.rotations)
    np.testing.assert_array_equal(one.root_position, other.root_position)
    assert json.loads(other.labels.recipe)["walk"]["seed"] == 12345
    assert one.labels.recipe != other.labels.recipe


def test_a_height_as_text_is_that_height():
    one, other = walk(distance=1.0, body="1.6"), walk(distance=1.0, body=body_from(1.6))
    np.testing.assert_array_equal(one.rotations, other.rotations)
    assert one.labels.recipe == other.labels.recipe
