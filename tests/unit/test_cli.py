"""The command line: exit codes, one line of error, files or none, JSON."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest

from gaitsmith import pipeline
from gaitsmith._version import __version__
from gaitsmith.body.presets import BODIES
from gaitsmith.ground import GROUNDS
from gaitsmith.walks import WALKS


def walk(*args):
    return ("walk", "--distance", "1.5", "--fps", "30", *args)


def made(tmp_path):
    return sorted(p.name for p in tmp_path.iterdir())


# done: 0 ---------------------------------------------------------------------------------


def test_a_walk(run, tmp_path):
    code, out, err = run(*walk("-o", "a.npz", "-o", "a.bvh", "--output", "a.csv"))
    assert (code, err) == (0, "")
    assert made(tmp_path) == ["a.bvh", "a.csv", "a.npz"]
    assert re.match(r"\d+ steps over 1\.50 m in ", out)
    assert out.splitlines()[1:] == ["wrote a.npz", "wrote a.bvh", "wrote a.csv"]


def test_the_command_line_is_the_library(run, tmp_path):
    options = "--body 1.6 --step-length 0.6 --cadence 100 --start walk --stop stand --seed 3"
    code, _, _ = run(*walk(*options.split(), "--toe-out", 8, "--step-width", 0.12, "-o", "a.npz"))
    assert code == 0
    motion = pipeline.walk(
        distance=1.5,
        body="1.6",
        step_length=0.6,
        cadence=100.0,
        start="walk",
        stop="stand",
        toe_out=math.radians(8.0),
        step_width=0.12,
        fps=30.0,
        seed=3,
    )
    pipeline.save(motion, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


KEYS = """frames fps duration_s steps distance_m speed_mps cadence_spm step_length_m files
slip_mm_max penetration_mm_max float_mm_max path_error_p95_m goal_error_m knee_min_deg warnings"""


def finite(thing):
    if isinstance(thing, dict):
        return all(map(finite, thing.values()))
    if isinstance(thing, list):
        return all(map(finite, thing))
    return not isinstance(thing, float) or math.isfinite(thing)


@pytest.mark.parametrize("distance", [0.05, 0.4, 1.5, 6.0])
@pytest.mark.parametrize("ends", ["stand stand", "stand walk", "walk stand", "walk walk"])
def test_json_is_one_object_with_its_keys_and_finite_numbers(run, distance, ends):
    start, stop = ends.split()
    arguments = ["walk", "--distance", distance, "--start", start, "--stop", stop]
    if ends == "walk walk" and distance < 1.0:
        return
    code, out, err = run(*arguments, "-o", "a.npz", "--json")
    assert (code, err, out.count("\n")) == (0, "", 1)
    facts = json.loads(out, parse_constant=lambda name: pytest.fail(f"{name} in JSON"))
    assert set(KEYS.split()) <= facts.keys()
    assert finite(facts)
    assert facts["files"] == ["a.npz"]
    assert facts["warnings"] == []
    assert facts["fps"] == 60.0
    assert facts["duration_s"] == pytest.approx((facts["frames"] - 1) / 60.0)
    if stop == "stand":
        assert facts["goal_error_m"] < 1e-6
    assert max(facts[k] for k in ("slip_mm_max", "penetration_mm_max", "float_mm_max")) < 1e-3


def test_json_says_what_was_asked_for(run):
    _, out, _ = run(
        "walk", "--distance", 9, "--step-length", 0.65, "--cadence", 105, "-o", "a.bvh", "--json"
    )
    facts = json.loads(out)
    assert facts["step_length_m"] == pytest.approx(0.65, abs=1e-6)
    assert facts["cadence_spm"] == pytest.approx(105.0)
    assert facts["speed_mps"] == pytest.approx(0.65 * 105 / 60)
    assert facts["distance_m"] == pytest.approx(9.0, abs=0.01)
    assert facts["steps"] >= 14


def test_warnings_go_where_they_belong(run):
    fast = ["--speed", 1.95, "--step-length", 0.85]
    code, out, err = run(*walk(*fast, "-o", "a.npz", "--json"))
    said = json.loads(out)["warnings"]
    assert (code, err) == (0, "")
    assert "Froude number" in said[0]
    code, out, err = run(*walk(*fast, "-o", "a.npz"))
    assert err.splitlines() == [f"gaitsmith: warning: {line}" for line in said]


@pytest.mark.parametrize("value", ["-4", "-0.5", "+3"])
def test_values_may_start_with_a_sign(run, value):
    assert run(*walk("--toe-out", value, "-o", "a.npz"))[0] == 0
    assert run(*walk(f"--toe-out={value}", "-o", "a.npz"))[0] == 0


def test_files_that_are_there_are_replaced(run, tmp_path):
    (tmp_path / "a.bvh").write_text("old")
    assert run(*walk("-o", "a.bvh"))[0] == 0
    assert (tmp_path / "a.bvh").read_text().startswith("HIERARCHY")


FAMILIES = {
    "gaits": WALKS,
    "bodies": BODIES,
    "grounds": GROUNDS,
    "formats": pipeline.WRITERS,
}


@pytest.mark.parametrize("kind", FAMILIES)
def test_list_shows_the_whole_family_with_a_word_on_each(run, kind):
    code, out, err = run("list", kind)
    assert (code, err) == (0, "")
    lines = [line.split(maxsplit=1) for line in out.splitlines()]
    assert {line[0] for line in lines} >= set(FAMILIES[kind])
    assert len({line[0] for line in lines}) == len(lines)
    assert all(len(line) == 2 for line in lines)


@pytest.mark.parametrize("name", BODIES)
def test_every_listed_body_walks(run, name):
    assert run(*walk("--body", name, "-o", "a.npz"))[0] == 0


def test_a_body_from_a_file(run, tmp_path):
    (tmp_path / "me.toml").write_text("height = 1.68\n")
    assert run(*walk("--body", "me.toml", "-o", "a.npz"))[0] == 0


def test_version(run):
    assert run("--version") == (0, f"gaitsmith {__version__}\n", "")


# help ------------------------------------------------------------------------------------

#: Commands of the plan; those that are not built yet must not show.
DESIGNED = {"demo", "walk", "learn", "compose", "certify", "measure", "convert", "list"}
OPTIONS = {
    "walk": "output distance path steps do scene ground body gait step-length speed cadence start "
    "stop step-width toe-out walker vary fps seed json help",
    "demo": "output help",
    "list": "help",
}


def listed_commands(run):
    code, out, err = run("--help")
    assert (code, err) == (0, "")
    return set(re.findall(r"^  ([a-z]+)  ", out.split("Commands:")[1], re.MULTILINE))


def test_help_shows_what_exists(run):
    commands = listed_commands(run)
    assert set(OPTIONS) <= commands <= DESIGNED
    for command in commands:
        code, out, err = run(command, "--help")
        assert (code, err) == (0, "")
        assert out.startswith("Usage: ")


def test_what_is_not_built_is_no_command(run):
    for planned in DESIGNED - listed_commands(run):
        code, out, err = run(planned)
        assert (code, out) == (2, "")
        assert f"No such command '{planned}'" in err


@pytest.mark.parametrize("command", OPTIONS)
def test_help_of_a_command(run, command):
    code, out, _ = run(command, "--help")
    assert code == 0
    assert set(re.findall(r"--([a-z-]+)", out)) == set(OPTIONS[command].split())


# wrong usage: 2 --------------------------------------------------------------------------

WRONG = {
    "nothing": [],
    "unknown command": ["wlak", "--distance", 3],
    "unknown option": walk("-o", "a.npz", "--bogus", 1),
    "no output": ["walk", "--distance", 3],
    "no distance": ["walk", "-o", "a.npz"],
    "stray argument": walk("a.npz"),
    "distance nan": ["walk", "--distance", "nan", "-o", "a.npz"],
    "distance inf": ["walk", "--distance", "inf", "-o", "a.npz"],
    "distance 0": ["walk", "--distance", 0, "-o", "a.npz"],
    "distance negative": ["walk", "--distance", -3, "-o", "a.npz"],
    "distance no number": ["walk", "--distance", "far", "-o", "a.npz"],
    "step length 0": walk("--step-length", 0, "-o", "a.npz"),
    "step length nan": walk("--step-length", "nan", "-o", "a.npz"),
    "speed negative": walk("--speed", -1, "-o", "a.npz"),
    "cadence 0": walk("--cadence", 0, "-o", "a.npz"),
    "fps 0": ["walk", "--distance", 3, "--fps", 0, "-o", "a.npz"],
    "fps nan": ["walk", "--distance", 3, "--fps", "nan", "-o", "a.npz"],
    "seed no whole number": walk("--seed", 1.5, "-o", "a.npz"),
    "seed negative": walk("--seed", -1, "-o", "a.npz"),
    "step width 0": walk("--step-width", 0, "-o", "a.npz"),
    "toe out nan": walk("--toe-out", "nan", "-o", "a.npz"),
    "toe out too far": walk("--toe-out", 90, "-o", "a.npz"),
    "start": walk("--start", "run", "-o", "a.npz"),
    "stop": walk("--stop", "", "-o", "a.npz"),
    "gait": walk("--gait", "hop", "-o", "a.npz"),
    "body name": walk("--body", "nobody", "-o", "a.npz"),
    "body height": walk("--body", 17, "-o", "a.npz"),
    "body nan": walk("--body", "nan", "-o", "a.npz"),
    "contradiction": walk("--step-length", 0.7, "--cadence", 100, "--speed", 1.5, "-o", "a.npz"),
    "format": walk("-o", "a.xyz"),
    "no format": walk("-o", "walk"),
    "list nothing": ["list"],
    "list unknown": ["list", "cars"],
}


@pytest.mark.parametrize("arguments", WRONG.values(), ids=WRONG.keys())
@pytest.mark.parametrize("as_json", [False, True])
def test_wrong_usage_is_2_and_leaves_nothing(run, tmp_path, arguments, as_json):
    if as_json and arguments and arguments[0] == "walk":
        arguments = [*arguments, "--json"]
    code, out, err = run(*arguments)
    assert code == 2
    assert made(tmp_path) == []
    assert out == "" or not arguments, "help of the bare command may go to stdout"
    if err.startswith("gaitsmith: "):
        assert err.count("\n") == 1
        assert err.endswith("\n")
    else:
        assert "Usage: " in out + err
    assert "Traceback" not in err


def test_what_is_wrong_is_named_with_what_is_right(run):
    for arguments, named in (
        (walk("--gait", "wintr", "-o", "a.npz"), ("'wintr'", "Did you mean 'winter'")),
        (walk("--start", "run", "-o", "a.npz"), ("start", "stand, walk", "'run'")),
        (walk("-o", "a.bvb"), ("'.bvb'", "Did you mean '.bvh'")),
        (["walk", "--distance", "nan", "-o", "a.npz"], ("distance", "meters", "nan")),
        (["list", "cars"], ("gaits, bodies, grounds, formats", "'cars'")),
        (["wlak"], ("wlak",)),
    ):
        _, _, err = run(*arguments)
        assert all(word in err for word in named), err


# the task cannot be done: 1 --------------------------------------------------------------

FAILING = {
    "step too long": (
        walk("--step-length", 1.2, "--cadence", 60, "-o", "a.npz"),
        ("step length of 1.200 m", "too long", "longest that works is 0.9"),
    ),
    "speed": (walk("--speed", 3, "-o", "a.npz"), ("3.000 m/s", "Froude", "fastest walk is 2.1")),
    "cadence": (walk("--cadence", 190, "-o", "a.npz"), ("Froude", "fastest")),
    "no folder": (walk("-o", "gone/a.npz"), ("gone/a.npz", "no folder gone")),
    "second has no folder": (walk("-o", "a.npz", "-o", "gone/b.bvh"), ("gone/b.bvh", "no folder")),
    "a folder": (walk("-o", "a.npz", "-o", "sub.bvh"), ("sub.bvh", "folder")),
    "body file missing": (walk("--body", "me.toml", "-o", "a.npz"), ("me.toml", "cannot be read")),
    "body file broken": (walk("--body", "broken.toml", "-o", "a.npz"), ("broken.toml", "TOML")),
    "body file wrong": (walk("--body", "wrong.toml", "-o", "a.npz"), ("wrong.toml", "height")),
}


@pytest.mark.parametrize(("arguments", "words"), FAILING.values(), ids=FAILING.keys())
@pytest.mark.parametrize("as_json", [False, True])
def test_a_task_that_cannot_be_done_is_1_and_one_line(run, tmp_path, arguments, words, as_json):
    (tmp_path / "broken.toml").write_text("height = [")
    (tmp_path / "wrong.toml").write_text('height = "tall"\n')
    (tmp_path / "sub.bvh").mkdir()
    before = made(tmp_path)
    code, out, err = run(*arguments, *(["--json"] if as_json else []))
    assert (code, out) == (1, "")
    assert re.fullmatch(r"gaitsmith: [^\n]+\n", err)
    assert all(word in err for word in words), err
    assert made(tmp_path) == before


def test_a_disk_that_fails_leaves_no_file(run, tmp_path, monkeypatch):
    def full(motion, path):
        path.write_text("half")
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setitem(pipeline.WRITERS, ".bvh", full)
    code, out, err = run(*walk("-o", "a.npz", "-o", "b.bvh", "--json"))
    assert (code, out) == (1, "")
    assert "no space left on device; choose another" in err
    assert "b.bvh" in err
    assert made(tmp_path) == []


def test_a_path_too_short_for_a_step_is_refused(run, tmp_path):
    arguments = ["walk", "--distance", 0.2, "--start", "walk", "--stop", "walk", "-o", "a.npz"]
    code, out, err = run(*arguments)
    assert code in (1, 2)
    assert (out, made(tmp_path)) == ("", [])
    assert re.fullmatch(r"gaitsmith: [^\n]+holds no step of [^\n]+\n", err)


# demo ------------------------------------------------------------------------------------

DEMO = ["walk.bvh", "walk.gif", "walk.glb", "walk.npz", "walk.png"]


def test_demo_writes_its_files(run, tmp_path, monkeypatch):
    """With a picture writer that costs nothing; the slow test writes the real ones."""

    def dot(motion, path):
        path.write_bytes(b".")

    for suffix in (".png", ".gif"):
        monkeypatch.setitem(pipeline.WRITERS, suffix, dot)
    assert run("demo", "-o", "some/where")[0] == 0
    assert made(tmp_path / "some" / "where") == DEMO
    assert run("demo")[0] == 0
    assert made(tmp_path / "demo") == DEMO
    with np.load(tmp_path / "demo" / "walk.npz") as data:
        assert data["path"][-1].tolist() == [0.0, 5.0]


def test_demo_into_a_file_is_refused(run, tmp_path):
    (tmp_path / "taken").write_text("mine")
    code, out, err = run("demo", "-o", "taken")
    assert (code, out) == (1, "")
    assert err == "gaitsmith: cannot write into taken: it is a file; -o takes a folder\n"
    assert (tmp_path / "taken").read_text() == "mine"


@pytest.mark.slow
def test_demo_for_real(tmp_path):
    command = [sys.executable, "-m", "gaitsmith", "demo", "-o", str(tmp_path / "d")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert made(tmp_path / "d") == DEMO
    assert (tmp_path / "d" / "walk.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "d" / "walk.gif").read_bytes().startswith(b"GIF8")


# as a program ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["walk", "--distance", "1", "-o", "a.npz", "--json"], 0),
        (["walk", "--distance", "1", "-o", "gone/a.npz", "--json"], 1),
        (["walk", "--distance", "nan", "-o", "a.npz", "--json"], 2),
        (["walk", "--nonsense"], 2),
    ],
)
def test_python_m_gaitsmith(arguments, code, tmp_path):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "gaitsmith", *arguments],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code
    assert "Traceback" not in done.stderr
    if code:
        assert done.stdout == ""
        assert made(tmp_path) == []
    else:
        assert done.stderr == ""
        assert json.loads(done.stdout)["files"] == ["a.npz"]


def test_help_and_walk_load_nothing_heavy():
    code = """
import sys
from gaitsmith.cli.main import app
heavy = {'numpy', 'scipy', 'rich', 'pydantic', 'PIL'} & set(sys.modules)
from gaitsmith import pipeline
pipeline.walk(distance=1)
late = {'scipy', 'sklearn', 'PIL', 'shapely', 'pydantic'} & set(sys.modules)
print(sorted(heavy), sorted(late))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] []"


def test_a_walk_straight_ahead_waits_for_nothing_that_it_does_not_need():
    """What bends, mixes and directs walks, and NumPy's slow corners, are imported when needed."""
    code = """
import sys
from gaitsmith.cli.walk import facts_of
from gaitsmith import pipeline
facts_of(pipeline.walk(distance=3), [], [])
ours = ('synthesis.curved', 'synthesis.mixed', 'synthesis.stepping', 'synthesis.attention',
        'plan.director', 'body.masses', 'walks.learned', 'gait.learn', 'viz', 'scene', 'style')
loaded = {f'gaitsmith.{name}' for name in ours} | {'numpy.ma', 'numpy.fft', 'numpy.polynomial'}
print(sorted(loaded & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_who_takes_no_step_stands(run, tmp_path):
    code, out, err = run("walk", "--do", "stand 1", "-o", tmp_path / "s.npz", "--json")
    assert (code, err) == (0, "")
    assert json.loads(out)["step_length_m"] is None
    assert run("walk", "--do", "look at 1,1,1", "-o", tmp_path / "s.npz")[0] == 0
    assert run("measure", tmp_path / "s.npz")[0] == 0


def test_footsteps_that_nobody_takes_in_time_are_refused(run, tmp_path):
    rows = ["side,x,z,heading_deg,time", "L,0.1,0,0,0", "R,-0.1,0,0,0"]
    rows += ["L,0.1,0.4,0,0.05", "R,-0.1,0.8,0,0.9", "L,0.1,0.8,0,1.5"]
    given = tmp_path / "steps.csv"
    given.write_text("\n".join(rows))
    code, _, err = run("walk", "--steps", given, "-o", tmp_path / "s.npz")
    assert code == 1
    assert "footstep 3 (left): its step of 0.40 m has 0.05 s" in err
