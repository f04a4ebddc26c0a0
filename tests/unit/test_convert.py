"""``gaitsmith convert``: nothing is lost that the other format can hold."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from gaitsmith import io, pipeline
from gaitsmith.cli.main import main
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.geometry.rotations import from_euler, slerp
from gaitsmith.io.bvh_file import BvhFile
from gaitsmith.io.bvh_parse import read_bvh_file
from gaitsmith.io.bvh_print import write_bvh_file
from gaitsmith.io.convert import convert
from gaitsmith.io.resample import resampled, resampled_bvh
from gaitsmith.motion.kinematics import joint_positions

ORDERS = (("Zrotation", "Xrotation", "Yrotation"), ("Xrotation", "Yrotation", "Zrotation"))
POSITION = ("Xposition", "Yposition", "Zposition")


@pytest.fixture
def clip() -> BvhFile:
    """Odd on purpose: names, orders, six channels below the root, no channel, a moved root."""
    rng, frames = np.random.default_rng(1), 31
    t = np.linspace(0.0, 1.0, frames)[:, None]
    channels = (POSITION + ORDERS[0], ORDERS[1], ORDERS[0] + POSITION, (), ("Yposition",))
    width = sum(map(len, channels))
    values = rng.uniform(-60, 60, width) * np.sin(3 * t + rng.uniform(0, 6, width))
    values[:, 5] = 400.0 * t[:, 0]  # more than a turn
    return BvhFile(
        names=("my:Hips", "left leg", "Spine", "prop", "lift"),
        parents=(-1, 0, 0, 2, 0),
        offsets=np.round(rng.uniform(-50, 50, (5, 3)), 3),
        channels=channels,
        ends=(),
        frame_time=0.0333333,
        values=np.round(values, 5),
    )


@pytest.fixture(scope="module")
def walk():
    return pipeline.walk(distance=2.0, fps=60.0)


def test_a_bvh_into_a_bvh_keeps_everything(clip, tmp_path):
    write_bvh_file(clip, tmp_path / "a.bvh")
    text = (tmp_path / "a.bvh").read_text().replace("\n", "\r\n").replace("\t", "    ")
    (tmp_path / "a.bvh").write_text(text, newline="")
    convert(tmp_path / "a.bvh", tmp_path / "b.bvh")
    back = read_bvh_file(tmp_path / "b.bvh")
    for name in ("names", "parents", "channels", "ends", "frame_time"):
        assert getattr(back, name) == getattr(clip, name)
    np.testing.assert_array_equal(back.values, clip.values)
    np.testing.assert_array_equal(back.offsets, clip.offsets)
    once = (tmp_path / "b.bvh").read_bytes()
    convert(tmp_path / "b.bvh", tmp_path / "b.bvh")  # onto itself
    assert (tmp_path / "b.bvh").read_bytes() == once
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.bvh", "b.bvh"]


def test_measured_clips_are_kept(measured_data, tmp_path):
    for source in sorted(measured_data.rglob("*.bvh")):
        convert(source, tmp_path / "out.bvh")
        before, after = read_bvh_file(source), read_bvh_file(tmp_path / "out.bvh")
        np.testing.assert_array_equal(after.values, before.values, err_msg=source.name)
        assert (after.names, after.channels) == (before.names, before.channels)


def test_a_unit_makes_centimeters(clip, tmp_path):
    write_bvh_file(clip, tmp_path / "a.bvh")
    convert(tmp_path / "a.bvh", tmp_path / "b.bvh", unit="inch")
    back = read_bvh_file(tmp_path / "b.bvh")
    np.testing.assert_allclose(back.offsets, 2.54 * clip.offsets)
    np.testing.assert_allclose(back.values[:, :3], 2.54 * clip.values[:, :3])
    np.testing.assert_array_equal(back.values[:, 3:9], clip.values[:, 3:9])


def test_every_second_frame_is_that_frame(clip):
    half = resampled_bvh(clip, 15.0)
    np.testing.assert_array_equal(half.values, clip.values[::2])
    assert half.frame_time == pytest.approx(1 / 15, abs=1e-10)
    np.testing.assert_array_equal(resampled_bvh(clip, 30.0).values, clip.values)


def test_frames_between_are_slerps_on_the_same_turn(clip):
    got = resampled_bvh(clip, 120.0)
    assert len(got) == 121
    np.testing.assert_array_equal(got.values[::4], clip.values)
    np.testing.assert_allclose(
        got.values[1::4, :3], 0.75 * clip.values[:-1, :3] + 0.25 * clip.values[1:, :3]
    )
    for joint, order, columns in ((1, "xyz", slice(6, 9)), (2, "zxy", slice(9, 12))):
        old = from_euler(order, np.radians(clip.values[:, columns]))
        new = from_euler(order, np.radians(got.values[2::4, columns]))
        dots = np.abs(np.sum(new * slerp(old[:-1], old[1:], 0.5), axis=-1))
        np.testing.assert_allclose(dots, 1.0, atol=1e-12, err_msg=str(joint))
    assert np.abs(np.diff(got.values, axis=0)).max() < 30.0
    assert got.values[-1, 5] == clip.values[-1, 5]


def test_a_generated_walk_is_resampled_with_its_labels(walk, tmp_path):
    source = io.save(walk, tmp_path / "a.npz")
    convert(source, tmp_path / "b.npz", fps=30.0)
    half = io.load(tmp_path / "b.npz")
    np.testing.assert_array_equal(half.rotations, walk.rotations[::2])
    np.testing.assert_array_equal(half.labels.phase, walk.labels.phase[::2])
    np.testing.assert_array_equal(half.contacts, walk.contacts[::2])
    assert "resampled" in half.labels.recipe
    fine = resampled(walk, 240.0)
    want = pipeline.walk(distance=2.0, fps=240.0)
    frames = min(len(fine), len(want))
    np.testing.assert_allclose(
        joint_positions(fine)[:frames], joint_positions(want)[:frames], atol=4e-3
    )
    np.testing.assert_array_equal(fine.labels.step[:frames], want.labels.step[:frames])
    np.testing.assert_allclose(fine.labels.phase[:frames], want.labels.phase[:frames], atol=1e-9)


@pytest.mark.parametrize("fps", [0.0, -1.0, float("nan"), float("inf"), 1e9])
def test_a_rate_of_no_use_is_refused(clip, walk, fps):
    for call in (lambda: resampled(walk, fps), lambda: resampled_bvh(clip, fps)):
        with pytest.raises(InvalidInputError, match="fps"):
            call()


def test_no_frame_and_one_frame_are_resampled(clip):
    assert len(resampled_bvh(clip.with_(values=clip.values[:0]), 60.0)) == 0
    assert len(resampled_bvh(clip.with_(values=clip.values[:1]), 60.0)) == 1


def test_motions_change_format(walk, tmp_path):
    source = io.save(walk, tmp_path / "a.npz")
    convert(source, tmp_path / "b.bvh")
    convert(tmp_path / "b.bvh", tmp_path / "c.csv")
    assert io.load(tmp_path / "b.bvh").fps == 60.0
    assert (tmp_path / "c.csv").read_text().startswith("time_s,frame,Hips_x")
    with pytest.raises(InfeasibleError, match="no labels"):
        convert(tmp_path / "b.bvh", tmp_path / "d.npz")
    assert not (tmp_path / "d.npz").exists()
    with pytest.raises(InvalidInputError, match="unit is of BVH"):
        convert(source, tmp_path / "b.bvh", unit="cm")


@pytest.mark.parametrize("suffix", [".png", ".gif", ".glb"])
def test_what_was_read_becomes_a_picture(monkeypatch, capsys, walk, tmp_path, suffix):
    source = io.save(walk.with_(**thinned(walk)), tmp_path / "a.bvh")
    code, out, _ = run(monkeypatch, capsys, source, tmp_path / f"b{suffix}")
    assert code == 0, out
    assert (tmp_path / f"b{suffix}").stat().st_size > 10_000


def thinned(walk):
    """A few frames: pictures of them are made soon."""
    few = slice(0, 8)
    return {
        "root_position": walk.root_position[few],
        "rotations": walk.rotations[few],
        "contacts": None,
        "labels": None,
    }


# --------------------------------------------------------------------------------- command line
def run(monkeypatch, capsys, *words: object) -> tuple[int, str, str]:
    monkeypatch.setattr(sys, "argv", ["gaitsmith", "convert", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    out, err = capsys.readouterr()
    return int(stop.value.code or 0), out, err


def test_the_command_converts_and_says_so(clip, tmp_path, monkeypatch, capsys):
    write_bvh_file(clip, tmp_path / "a.bvh")
    target = tmp_path / "b.bvh"
    code, out, err = run(monkeypatch, capsys, tmp_path / "a.bvh", target, "--fps", 60)
    assert (code, out, err) == (0, f"wrote {target}\n", "")
    assert read_bvh_file(target).frame_time == pytest.approx(1 / 60)


def test_the_command_tells_what_is_odd(clip, tmp_path, monkeypatch, capsys):
    write_bvh_file(clip, tmp_path / "a.bvh")
    text = (tmp_path / "a.bvh").read_text()
    (tmp_path / "a.bvh").write_text(text.replace("Frames: 31", "Frames: 30"))
    code, _, err = run(monkeypatch, capsys, tmp_path / "a.bvh", tmp_path / "b.bvh")
    assert code == 0
    assert err.startswith("gaitsmith: warning: ")
    assert "declares 30 frames, has 31" in err


@pytest.mark.parametrize(("source", "target", "options", "code", "word"), [
    ("broken.bvh", "b.bvh", (), 1, "broken.bvh:1: this is no BVH"),
    ("missing.bvh", "b.bvh", (), 1, "missing.bvh"),
    ("a.bvh", "b.npz", (), 1, "no labels"),
    ("a.bvh", "nowhere/b.bvh", (), 1, "there is no folder"),
    ("a.bvh", "b.bvb", (), 2, "cannot write '.bvb'"),
    ("a.xyz", "b.bvh", (), 2, "cannot read '.xyz'"),
    ("a.bvh", "b.bvh", ("--fps", "nan"), 2, "fps"),
    ("a.bvh", "b.bvh", ("--unit", "furlong"), 2, "unit must be one of"),
])  # fmt: skip
def test_the_command_fails_in_one_line_and_leaves_no_file(
    source, target, options, code, word, clip, tmp_path, monkeypatch, capsys
):
    write_bvh_file(clip, tmp_path / "a.bvh")
    (tmp_path / "broken.bvh").write_text("hello\n")
    before = sorted(tmp_path.rglob("*"))
    got = run(monkeypatch, capsys, tmp_path / source, tmp_path / target, *options)
    assert got[0] == code
    assert got[1] == ""
    assert word in got[2]
    assert len(got[2].splitlines()) == 1
    assert sorted(tmp_path.rglob("*")) == before
