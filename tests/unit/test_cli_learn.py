"""``gaitsmith learn``, and gaits and bodies of clips on the command line."""

from __future__ import annotations

import json

import pytest
from puppet import Puppet
from rigs import bare, cut

from gaitsmith.pipeline import save

KEYS = {
    *("name", "source", "license", "stride_length_m", "duration_s", "speed_mps", "cadence_spm"),
    *("step_lengths_m", "step_width_m", "toe_out_deg", "events", "upper_body", "clip", "notes"),
    *("strides", "files", "warnings"),
}


@pytest.fixture
def run(run, tmp_path):
    """Run the command line in a folder with a clip."""
    save(bare(Puppet().clip(4.0)), tmp_path / "clip.bvh")
    return run


def test_learn_and_walk(run, tmp_path):
    code, out, err = run("learn", "clip.bvh", "-o", "me.gait.json")
    assert (code, err) == (0, "")
    assert out.startswith("clip: stride 1.300 m in 1.10")
    assert out.splitlines()[-1] == "wrote me.gait.json"
    for source, file in (("me.gait.json", "a.npz"), ("clip.bvh", "b.npz")):
        assert run("walk", "--distance", 2, "--gait", source, "--fps", 30, "-o", file)[0] == 0
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def test_json_is_one_object(run):
    code, out, err = run("learn", "clip.bvh", "-o", "me.gait.json", "--json", "--name", "Kim")
    assert (code, err) == (0, "")
    facts = json.loads(out)
    assert facts.keys() == KEYS
    assert facts["name"] == "Kim"
    assert facts["files"] == ["me.gait.json"]


def test_options_are_kept(run, tmp_path):
    options = ("--license", "CC0", "--source", "here", "--symmetric")
    assert run("learn", "clip.bvh", "-o", "me.gait.json", *options)[0] == 0
    data = json.loads((tmp_path / "me.gait.json").read_text())
    assert (data["license"], data["source"]) == ("CC0", "here")
    assert data["step_lengths_m"]["left"] == pytest.approx(
        data["step_lengths_m"]["right"], abs=1e-3
    )


def test_events_by_hand(run, tmp_path):
    rows = [
        f"{side},{t:.3f},{t + 0.08:.3f},{t + 0.4:.3f},{t + 0.68:.3f}"
        for side, t in [("left", 1.1), ("right", 1.65), ("left", 2.2), ("right", 2.75)]
    ]
    head = "side,heel_strike,foot_flat,heel_off,toe_off"
    (tmp_path / "e.csv").write_text("\n".join([head, *rows]))
    assert run("learn", "clip.bvh", "-o", "me.gait.json", "--events", "e.csv")[0] == 0
    data = json.loads((tmp_path / "me.gait.json").read_text())
    assert data["duration_s"] == pytest.approx(1.1)


def test_a_body_of_a_clip(run):
    code, out, _ = run("walk", "--distance", 2, "--body", "clip.bvh", "-o", "a.npz", "--json")
    assert code == 0
    assert json.loads(out)["slip_mm_max"] < 0.5


FAILURES = {
    "too short": ("learn", "short.bvh", "-o", "x.gait.json"),
    "backward": ("learn", "back.bvh", "-o", "x.gait.json"),
    "running": ("learn", "run.bvh", "-o", "x.gait.json"),
    "not there": ("learn", "no.bvh", "-o", "x.gait.json"),
    "no BVH": ("learn", "text.bvh", "-o", "x.gait.json"),
    "no gait": ("walk", "--distance", "2", "--gait", "bad.gait.json", "-o", "x.npz"),
    "gait of a file of markers": ("walk", "--distance", "2", "--gait", "short.bvh", "-o", "x.npz"),
    "events of nothing": ("learn", "clip.bvh", "-o", "x.gait.json", "--events", "bad.csv"),
}


@pytest.mark.parametrize("name", FAILURES)
def test_what_cannot_be_done(run, tmp_path, name):
    """Exit 1, one line that says why, no file."""
    save(cut(bare(Puppet().clip(4.0)), 1.0, 2.4), tmp_path / "short.bvh")
    save(bare(Puppet(way=180.0).clip(4.0)), tmp_path / "back.bvh")
    fast = Puppet(duty=(0.4, 0.4), stride=2.0, period=0.75)
    save(bare(fast.clip(4.0)), tmp_path / "run.bvh")
    (tmp_path / "text.bvh").write_text("hello")
    (tmp_path / "bad.gait.json").write_text('{"format": "other"}')
    (tmp_path / "bad.csv").write_text("a,b\n1,2\n")
    code, out, err = run(*FAILURES[name])
    assert (code, out) == (1, "")
    assert err.startswith("gaitsmith: ")
    assert err.count("\n") == 1
    assert not list(tmp_path.glob("x.*"))


@pytest.mark.parametrize(
    "args",
    [
        ("learn", "clip.bvh", "-o", "x.bvh"),
        ("learn", "clip.fbx", "-o", "x.gait.json"),
        ("learn", "clip.bvh"),
        ("walk", "--distance", "2", "--gait", "nobody", "-o", "x.npz"),
    ],
)
def test_wrong_usage(run, tmp_path, args):
    code, out, _ = run(*args)
    assert (code, out) == (2, "")
    assert not list(tmp_path.glob("x.*"))
