"""Gait files: to the byte there and back, walked alike, and refused where they are none."""

from __future__ import annotations

import json

import numpy as np
import pytest
from puppet import Puppet
from rigs import bare

from gaitsmith.errors import FileFormatError, GaitsmithError, InvalidInputError
from gaitsmith.learning import gait_from, learn, read_events
from gaitsmith.pipeline import regenerate, save, walk
from gaitsmith.walks.learned import FORMAT, gait_to_dict, read_gait, write_gait


@pytest.fixture(scope="module")
def clip(tmp_path_factory):
    path = tmp_path_factory.mktemp("clip") / "somebody.bvh"
    save(bare(Puppet(right=0.47, width=0.13).clip(4.0)), path)
    return path


@pytest.fixture(scope="module")
def gait(clip):
    return learn(clip, license="CC0", source="a puppet")


@pytest.fixture
def file(gait, tmp_path):
    path = tmp_path / "somebody.gait.json"
    write_gait(gait, path)
    return path


def test_there_and_back_to_the_byte(gait, file, tmp_path):
    again = tmp_path / "again.gait.json"
    write_gait(read_gait(file), again)
    assert again.read_bytes() == file.read_bytes()


def test_provenance_is_kept(file):
    data = json.loads(file.read_text())
    assert data["format"] == FORMAT
    assert (data["name"], data["source"], data["license"]) == ("somebody", "a puppet", "CC0")
    assert data["clip"]["file"] == "somebody.bvh"
    assert len(data["clip"]["stances"]) >= 5
    assert data["made_with"].startswith("gaitsmith ")


def test_numbers_of_the_file_agree(file):
    data = json.loads(file.read_text())
    assert data["speed_mps"] == pytest.approx(
        data["stride_length_m"] / data["duration_s"], abs=1e-5
    )
    assert data["cadence_spm"] == pytest.approx(120.0 / data["duration_s"], abs=1e-4)
    assert sum(data["step_lengths_m"].values()) == pytest.approx(data["stride_length_m"], abs=1e-5)
    assert data["step_width_m"] == pytest.approx(0.13, abs=2e-3)


def test_from_the_file_as_from_the_clip(clip, file, tmp_path):
    """To the byte of the motion, recipe and all; the source's name is the only difference."""
    options = {"distance": 3.0, "fps": 30}
    one = walk(gait=learn(clip, license="CC0", source="a puppet"), **options)
    two = walk(gait=file, **options)
    paths = [save(m, tmp_path / f"{i}.npz") for i, m in enumerate((one, two))]
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_a_recipe_holds_the_gait(file, tmp_path):
    """The motion alone, without file or clip, is enough to make it again."""
    motion = walk(gait=file, distance=3.0, body=1.5, fps=30)
    recipe = motion.labels.recipe
    one = save(motion, tmp_path / "one.npz")
    file.unlink()
    two = save(regenerate(recipe), tmp_path / "two.npz")
    assert one.read_bytes() == two.read_bytes()


def test_habits_are_walked(gait):
    """Pace, width and toe-out of the clip, on its own body."""
    motion = walk(gait=gait, body=gait.body, distance=0.65 * 8, fps=60)
    labels = motion.labels
    times = np.diff(labels.footstep_time[2:])
    assert times[2:-2].mean() == pytest.approx(0.55, abs=0.01)
    side = np.abs(labels.footstep_position[2:, 0])
    np.testing.assert_allclose(side, 0.065, atol=2e-3)


def test_a_clip_may_be_the_body(clip):
    motion = walk(body=clip, distance=2.0, fps=30)
    assert motion.skeleton.offsets[motion.skeleton.index("leftLowerLeg"), 1] == pytest.approx(
        -0.42875, abs=1e-5
    )


def broken_files(data):
    """What is wrong, and how the message names it."""

    def without(*keys):
        out = json.loads(json.dumps(data))
        at = out
        for key in keys[:-1]:
            at = at[key]
        del at[keys[-1]]
        return out

    def changed(value, *keys):
        out = json.loads(json.dumps(data))
        at = out
        for key in keys[:-1]:
            at = at[key]
        at[keys[-1]] = value
        return out

    for key in data:
        if key not in ("made_with", "speed_mps", "cadence_spm"):
            yield f"no {key}", without(key), key
    yield "no center", without("cycle", "center"), "center"
    yield "no hips", without("cycle", "rotations", "hips"), "hips"
    yield "no left walk", without("walk_data", "left"), "left"
    yield "other format", changed("gaitsmith-gait-9", "format"), "gaitsmith-gait-9"
    yield "a word for a length", changed("long", "stride_length_m"), "stride_length"
    yield "negative duration", changed(-1.0, "duration_s"), "duration"
    yield "null events", changed(None, "events"), ""
    yield "null clip", changed(None, "clip"), ""
    yield "a list for a name", changed([1], "step_lengths_m"), ""
    yield "short rotations", changed([[0, 0, 0, 1]], "cycle", "rotations", "hips"), ""
    yield (
        "no unit quaternions",
        changed([[0, 0, 0, 3]] * len(data["cycle"]["center"]), "cycle", "rotations", "hips"),
        "unit quaternions",
    )
    yield "three strides", changed(3, "cycle", "strides"), "strides"
    yield "upper body by magic", changed("magic", "upper_body"), "upper_body"
    yield "no angles", changed({"left": [], "right": []}, "elevation", "angles"), ""
    yield "a side of its own", changed("middle", "clip", "stances", 0, "side"), ""
    yield "infinite", changed(float("inf"), "step_width_m"), ""
    yield "notes in numbers", changed(3, "notes"), ""
    yield "no body", changed({}, "body"), ""


def test_what_is_no_gait_file_is_refused(gait, tmp_path):
    for name, data, word in broken_files(gait_to_dict(gait)):
        path = tmp_path / "broken.gait.json"
        path.write_text(json.dumps(data))
        try:
            read_gait(path)
        except FileFormatError as error:
            said = str(error)
        else:
            pytest.fail(f"taken for a gait: {name}")
        assert word in said, name
        assert "\n" not in said, name


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "3", "null", "{}", '{"format": 3}', '{"format": [1]}', "\ufeff{}"]
)
def test_other_text_is_refused(text, tmp_path):
    path = tmp_path / "broken.gait.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError):
        read_gait(path)


def test_bytes_are_refused(tmp_path):
    path = tmp_path / "broken.gait.json"
    path.write_bytes(b"\xff\xfe\x00{")
    with pytest.raises(FileFormatError, match="not JSON"):
        read_gait(path)


@pytest.mark.parametrize("spec", ["nobody", "walk.fbx", {"format": 1}, {}, {"format": FORMAT}])
def test_what_is_no_gait_at_all(spec):
    with pytest.raises(InvalidInputError):
        gait_from(spec)


def test_a_file_that_is_not_there():
    with pytest.raises((OSError, GaitsmithError)):
        gait_from("nowhere.gait.json")


HEAD = "side,heel_strike,foot_flat,heel_off,toe_off\n"


def test_events_of_a_file(tmp_path):
    path = tmp_path / "events.csv"
    path.write_text(HEAD + "left,0,0.1,0.4,0.7\nR,0.55,0.6,0.9,1.2\n\n")
    left, right = read_events(path)
    assert (left.side, left.times) == (0, (0.0, 0.1, 0.4, 0.7))
    assert (right.side, right.times) == (1, (0.55, 0.6, 0.9, 1.2))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "first line"),
        ("side,heel_strike\nleft,0\n", "first line"),
        (HEAD, "no stances"),
        (HEAD + "left,0,0.1,0.4\n", "four times"),
        (HEAD + "left,0,0.5,0.4,0.7\n", "in order"),
        (HEAD + "middle,0,0.1,0.4,0.7\n", "left, right"),
        (HEAD + "left,0,x,0.4,0.7\n", "x"),
        (HEAD + "left,0,nan,0.4,0.7\n", "nan"),
        (HEAD + "left,0,0.1,0.4,inf\n", "inf"),
    ],
)
def test_events_with_errors(text, why, tmp_path):
    path = tmp_path / "events.csv"
    path.write_text(text)
    with pytest.raises(FileFormatError, match=why):
        read_events(path)


@pytest.mark.parametrize(
    "rows",
    [
        "left,100,100.1,100.4,100.7\n",
        "left,0.5,0.6,0.9,1.2\nright,1.0,1.1,1.4,1.7\nleft,99,99.1,99.4,99.7\n",
        "left,-5,-4.9,-4.6,-4.3\nright,-4.5,-4.4,-4.1,-3.8\nleft,-4,-3.9,-3.6,-3.3\n",
        "left,0.5,0.5,0.5,0.5\nright,0.5,0.5,0.5,0.5\nleft,0.5,0.5,0.5,0.5\n",
        "left,0.5,0.6,0.9,1.2\nleft,1.6,1.7,2.0,2.3\nleft,2.7,2.8,3.1,3.4\n",
    ],
)
def test_events_that_the_clip_does_not_hold(rows, clip, tmp_path):
    """An error that says so; nothing else."""
    path = tmp_path / "events.csv"
    path.write_text(HEAD + rows)
    with pytest.raises(GaitsmithError) as caught:
        learn(clip, events=read_events(path))
    assert "nan" not in str(caught.value)
