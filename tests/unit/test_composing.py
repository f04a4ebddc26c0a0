"""Recipes: what they may hold, what they make, and what a composed gait file remembers."""

from __future__ import annotations

import json
import warnings

import numpy as np
import pytest
from judge import broken

from gaitsmith.composing import compose, license_of
from gaitsmith.errors import FileFormatError, GaitsmithError, GaitsmithWarning, InvalidInputError
from gaitsmith.pipeline import walk
from gaitsmith.style.recipe import paper_recipes, recipe_from_dict
from gaitsmith.style.restyle import rule_gait
from gaitsmith.walks.learned import gait_to_dict, read_gait, write_gait

RECIPE = """
name = "wistful"
[styles]
sad = "sad"
proud = "proud"
[root]
weights = { sad = 0.6, proud = 0.4 }
[arms]
weights = { proud = 1.0 }
"""
#: The paper's examples as built-in styles.
PAPER = {
    "Basic": "neutral", "Energetic": "happy", "Gorilla": "swagger", "Tired": "tired",
    "Delightful": "childlike", "Side_Sway": "proud", "Confident": "angry", "Bouncy": "hurried",
    "Charlie_Chaplin": "careful", "Shoulder_Roll": "elderly",
}  # fmt: skip


@pytest.fixture
def recipe(tmp_path):
    path = tmp_path / "wistful.toml"
    path.write_text(RECIPE)
    return path


def test_a_composed_gait_walks_straight_and_round(recipe):
    gait = compose(recipe)
    assert gait.name == "wistful"
    for where in ({"distance": 3.0}, {"path": "0,0 0,2 1.5,3.5"}):
        assert broken(walk(gait=gait, fps=120, **where)) == {}


def test_the_file_remembers_and_gives_the_same_gait(recipe, tmp_path):
    gait, again = compose(recipe), compose(recipe)
    one, two = tmp_path / "one.gait.json", tmp_path / "two.gait.json"
    write_gait(gait, one)
    write_gait(again, two)
    assert one.read_bytes() == two.read_bytes()
    read = read_gait(one)
    assert gait_to_dict(read) == gait_to_dict(gait)
    made = json.loads(one.read_text())["recipe"]
    assert made["root"]["weights"] == {"sad": 0.6, "proud": 0.4}
    assert made["arms"] == {"weights": {"proud": 1.0}, "offset_scale": 1.0}
    assert [s["name"] for s in made["sources"]] == ["sad", "proud"]
    assert all("made by rule" in s["source"] for s in made["sources"])
    a, b = (walk(distance=2.0, gait=g, fps=30) for g in (gait, read))
    assert a.rotations.tobytes() == b.rotations.tobytes()


def test_a_gait_that_was_learned_has_no_recipe():
    data = gait_to_dict(rule_gait("sad"))
    assert "recipe" not in data


def test_one_walk_alone_comes_back(tmp_path):
    gait = compose({"styles": {"a": "elderly"}, "root": {"weights": {"a": 1.0}}})
    own = rule_gait("elderly").cycle
    np.testing.assert_allclose(gait.cycle.rotations, own.rotations, atol=1e-5)
    assert gait.cycle.stride_length == pytest.approx(own.stride_length, abs=1e-6)


@pytest.mark.parametrize(
    ("licenses", "expected"),
    [
        (["CC BY 4.0"], "CC BY 4.0"),
        (["CC BY 4.0", "CC BY 4.0"], "CC BY 4.0"),
        (["CC BY 4.0", "CC0"], "a mix of: CC BY 4.0 | CC0"),
        (["CC BY-NC 4.0"], "non-commercial; a mix of: CC BY-NC 4.0"),
        (["CC0", "Non-Commercial"], "non-commercial; a mix of: CC0 | Non-Commercial"),
        (["CC0", "noncommercial use"], "non-commercial; a mix of: CC0 | noncommercial use"),
    ],
)  # fmt: skip
def test_licenses_are_kept_and_the_strictest_is_said_first(licenses, expected):
    assert license_of(licenses) == expected


def test_license_and_source_of_a_style_replace_what_its_file_says(tmp_path):
    write_gait(rule_gait("sad"), tmp_path / "x.gait.json")
    path = tmp_path / "r.toml"
    path.write_text(
        'styles.a = { from = "x.gait.json", license = "CC BY-NC 4.0", source = "a friend" }\n'
        "root.weights.a = 1.0\n"
    )
    gait = compose(path)
    assert gait.cycle.license.startswith("non-commercial")
    assert gait.recipe["sources"][0]["source"] == "a friend"
    assert gait.recipe["sources"][0]["from"] == "x.gait.json"


def test_styles_may_be_given_as_gaits(recipe):
    gait = compose(recipe, styles={"sad": rule_gait("tired"), "proud": "happy"}, name="other")
    assert gait.name == "other"
    assert gait.recipe["sources"][0]["from"] == "tired"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "relaxed",
        *(pytest.param(n, marks=pytest.mark.slow) for n in paper_recipes() if n != "relaxed"),
    ],
)
def test_the_papers_recipes_walk_with_styles_of_ones_own(name):
    """[KN12] Table 3 and Figure 5."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # sums of 0.4 to 2.2 are unusual
        gait = compose({"paper": name, "styles": PAPER})
        motion = walk(distance=3.0, gait=gait, fps=120)
    assert broken(motion) == {}
    assert gait.recipe["paper"] == name
    cadence = 60.0 * 2.0 / gait.cycle.duration
    assert 0.8 * 60.0 <= cadence <= 2.6 * 60.0


def test_unusual_weights_are_warned_of():
    with pytest.warns(GaitsmithWarning, match=r"weights of arms sum to 2\.00"):
        compose({
            "styles": {"a": "sad"},
            "root": {"weights": {"a": 1.0}},
            "arms": {"weights": {"a": 2.0}},
        })  # fmt: skip


def test_all_that_is_wrong_in_a_recipe_is_said_at_once(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(
        """
engine = "sparse"
speeed = 1.0
[styles]
sad = 3
[root]
weights = { sad = "much", glad = 1.0 }
[legs]
find = "magic"
[arms]
offset_scale = 1.0
"""
    )
    with pytest.raises(FileFormatError) as error:
        compose(path)
    for part in (
        "engine must be one of dense, keys", "speeed: unknown key, did you mean 'speed'?",
        "styles.sad must be", "'sad' in root must be a finite number", "legs.find",
        "arms.weights: missing",
    ):  # fmt: skip
        assert part in str(error.value)


def test_styles_that_are_used_must_be_mapped():
    with pytest.raises(InvalidInputError, match=r"'Energetic' is used but not in \[styles\]"):
        recipe_from_dict({"paper": "relaxed", "styles": {"Basic": "neutral"}})
    with pytest.raises(InvalidInputError, match=r"unknown recipe of the paper 'relxed'"):
        recipe_from_dict({"paper": "relxed"})


def test_walks_that_cannot_be_had_are_named_all(tmp_path):
    path = tmp_path / "r.toml"
    path.write_text(
        '[styles]\na = "no.bvh"\nb = "nowhere.gait.json"\n[root]\nweights = { a = 1.0, b = 1.0 }\n'
    )
    with pytest.raises(GaitsmithError) as error:
        compose(path)
    assert "no.bvh" in str(error.value)
    assert "nowhere.gait.json" in str(error.value)
    with pytest.raises(InvalidInputError, match="'saad' is neither a built-in style"):
        compose({"styles": {"a": "saad"}, "root": {"weights": {"a": 1.0}}})


def test_weights_that_do_not_fit_the_components_are_the_files_fault(run, tmp_path):
    path = tmp_path / "r.toml"
    path.write_text(
        'styles = { a = "sad", b = "happy" }\nroot.weights.a = 1.0\narms.weights.a = [1, 2]\n'
    )
    code, _, err = run("compose", path, "-o", "x.gait.json")
    assert code == 1
    assert "r.toml" in err
    assert "but 'a' has 2 weights there" in err


def test_not_toml_is_said(tmp_path):
    path = tmp_path / "r.toml"
    path.write_text("this is not TOML")
    with pytest.raises(FileFormatError, match="not a TOML file"):
        compose(path)


def test_the_body_may_be_another():
    gait = compose({"styles": {"a": "sad"}, "root": {"weights": {"a": 1.0}}, "body": 1.4})
    assert gait.body.height == pytest.approx(1.4)
    own = rule_gait("sad")
    froude = own.cycle.speed**2 / own.body.leg_length
    assert gait.cycle.speed**2 / gait.body.leg_length == pytest.approx(froude, rel=0.1)


def test_command_line(run, tmp_path):
    path = tmp_path / "wistful.toml"
    path.write_text(RECIPE)
    code, out, err = run("compose", path, "-o", "w.gait.json", "--json")
    assert (code, err) == (0, "")
    facts = json.loads(out)
    assert facts["name"] == "wistful"
    assert facts["files"] == ["w.gait.json"]
    assert facts["recipe"]["sources"][1]["name"] == "proud"
    code, out, err = run("compose", path, "-o", "w.gait.json")
    assert code == 0
    assert "wistful: stride" in out
    code, out, _ = run("walk", "--distance", 2, "--gait", "w.gait.json", "-o", "w.npz")
    assert code == 0
    code, _, err = run("compose", path, "-o", "w.bvh")
    assert code == 2
    assert "cannot write '.bvh'" in err
    path.write_text("root = 3")
    code, out, err = run("compose", path, "-o", "new.gait.json", "--json")
    assert (code, out) == (1, "")
    assert "root must be a table" in err
    assert not (tmp_path / "new.gait.json").exists()


def test_built_in_styles_are_listed_and_walk_by_name(run):
    code, out, _ = run("list", "gaits")
    assert code == 0
    assert "sneaky" in out
    assert "(made by rule)" in out
    code, _, err = run("walk", "--distance", 2, "--gait", "sneaky", "-o", "s.npz")
    assert (code, err) == (0, "")
