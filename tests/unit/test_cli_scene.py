"""``gaitsmith walk --scene``."""

from __future__ import annotations

import json

import numpy as np
import pytest

THREE = """
[[walker]]
name = "ann"
body = 1.2
do = "walk to 0,1.2"
[[walker]]
name = "ben"
start = {at = [1.5, 0]}
distance = 1
begin = 0.5
"""
BAD = """ground = "slop"
[[walker]]
name = "ann"
bdy = 1.2
speed = -1
do = "wlak to 0,1"
[[walker]]
name = "ann"
distance = 1
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(THREE)
    return path


def test_one_file_of_all_and_one_each(run, scene, tmp_path):
    files = ("all.npz", "all.glb", "{walker}.bvh")
    outputs = [word for file in files for word in ("-o", file)]
    code, out, err = run("walk", "--scene", scene, "--fps", 20, *outputs)
    assert (code, err) == (0, "")
    assert "2 walkers" in out
    assert all(f"wrote {name}" in out for name in ("all.npz", "all.glb", "ann.bvh", "ben.bvh"))
    with np.load(tmp_path / "all.npz") as data:
        assert data["walkers"].tolist() == ["ann", "ben"]
        assert data["fps"] == 20.0


def test_measure_takes_everybody_in_a_file(run, scene):
    run("walk", "--scene", scene, "-o", "all.npz", "-o", "{walker}.npz")
    code, out, err = run("measure", "all.npz", "--json")
    assert (code, err) == (0, "")
    files = json.loads(out)["files"]
    assert [f["file"] for f in files] == ["all.npz:ann", "all.npz:ben"]
    for figures in files:
        name = figures["file"].partition(":")[2]
        alone = json.loads(run("measure", f"{name}.npz", "--json")[1])
        assert {**figures, "file": ""} == {**alone, "file": ""}
    assert "all.npz:ben" in run("measure", "all.npz")[1]


def test_json_has_the_keys_of_a_walk_for_each(run, scene):
    code, out, _ = run("walk", "--scene", scene, "-o", "{walker}.npz", "--json")
    assert code == 0
    facts = json.loads(out)
    assert set(facts) == {"frames", "fps", "duration_s", "walkers", "files", "warnings"}
    assert [w["name"] for w in facts["walkers"]] == ["ann", "ben"]
    assert facts["files"] == ["ann.npz", "ben.npz"]
    alone = json.loads(run("walk", "--distance", 1, "-o", "x.npz", "--json")[1])
    for walker in facts["walkers"]:
        assert set(walker) - {"name"} <= set(alone)
        assert walker["frames"] == facts["frames"]
        assert walker["slip_mm_max"] < 0.5


def test_a_scene_of_one_has_the_keys_of_a_walk(run, tmp_path):
    (tmp_path / "one.toml").write_text("distance = 1\nbody = 1.4\n")
    code, out, _ = run("walk", "--scene", "one.toml", "-o", "x.npz", "--json")
    assert code == 0
    facts = json.loads(out)
    alone = json.loads(run("walk", "--distance", 1, "--body", 1.4, "-o", "y.npz", "--json")[1])
    assert set(facts) == {*alone, "walkers"}
    assert {k: facts[k] for k in alone if k != "files"} == {
        k: alone[k] for k in alone if k != "files"
    }
    assert (tmp_path / "x.npz").read_bytes() == (tmp_path / "y.npz").read_bytes()


def test_a_bad_file_is_refused_with_all_that_is_wrong(run, tmp_path):
    (tmp_path / "bad.toml").write_text(BAD)
    code, out, err = run("walk", "--scene", "bad.toml", "-o", "x.npz", "--json")
    assert (code, out) == (1, "")
    assert err.startswith("gaitsmith: bad.toml: line 1: ground:")
    assert err.count("\n") == 1
    for said in ("did you mean 'body'?", "speed: must be above 0", "did you mean 'walk'?"):
        assert said in err
    assert "walker 1 has the same name 'ann'" in err
    assert not (tmp_path / "x.npz").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--do", "stand 1"], "--do cannot go with --scene"),
        (["--distance", "3"], "--distance cannot go with --scene"),
        (["--body", "1.7", "--speed", "1"], "--body and --speed cannot go with --scene"),
        (["--vary", "1"], "write it there (variation)"),
    ],
)
def test_what_a_scene_says_itself_is_no_option(run, scene, words, says):
    code, _, err = run("walk", "--scene", scene, *words, "-o", "x.npz")
    assert code == 2
    assert says in err


def test_what_cannot_be_done_is_refused(run, scene, tmp_path):
    code, _, err = run("walk", "--scene", scene, "-o", "x.bvh")
    assert code == 2
    assert "x-{walker}.bvh" in err
    code, _, err = run("walk", "--scene", "gone.toml", "-o", "x.npz")
    assert code == 1
    assert "gone.toml: no such file" in err
    (tmp_path / "fast.toml").write_text(THREE + "speed = 5\n[[walker]]\ndistance = 1\nspeed = 9\n")
    code, _, err = run("walk", "--scene", "fast.toml", "-o", "x.npz")
    assert code == 1
    assert "ben: speed 5.000" in err
    assert "walker3: speed 9.000" in err
    assert not list(tmp_path.glob("*x.*"))
