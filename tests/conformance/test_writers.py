"""What every writer and every reader of the tables must do. A new format is picked up here."""

from __future__ import annotations

import json

import numpy as np
import pytest

from gaitsmith.errors import FileFormatError
from gaitsmith.geometry.rotations import exp
from gaitsmith.io import READERS, WRITERS, load, save
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.motion.skeleton import HUMANOID, Skeleton


@pytest.fixture(scope="module")
def motion():
    """Two seconds of something with every label; no walk, but writers cannot tell."""
    rng, frames = np.random.default_rng(0), 121
    names = [name for name, _ in HUMANOID]
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent in HUMANOID)
    offsets, soles = rng.normal(0, 0.1, (len(names), 3)), rng.normal(0, 0.05, (2, 3, 3))
    phase = 2.0 * np.arange(frames) / 60.0
    swing = rng.normal(0, 0.4, (len(names), 3)) * np.sin(np.pi * phase)[:, None, None]
    labels = Labels(
        phase=phase % 1.0,
        step=np.minimum(2 + phase.astype(int), 5),
        footstep_side=np.arange(6) % 2,
        footstep_position=np.stack([np.zeros(6), np.zeros(6), 0.6 * np.arange(6)], axis=-1),
        footstep_heading=np.zeros(6),
        footstep_time=[0.0, 0.0, 0.5, 1.0, 1.5, 2.0],
        ground=json.dumps({"kind": "flat", "height": 0}),
        recipe=json.dumps({"made": "by hand"}),
    )
    return Motion(
        skeleton=Skeleton(tuple(names), parents, offsets, soles),
        root_position=np.stack([0 * phase, 0.9 + 0 * phase, 0.6 * phase], axis=-1),
        rotations=exp(swing),
        fps=60.0,
        contacts=rng.random((frames, 2, 3)) < 0.5,
        labels=labels,
    )


@pytest.mark.parametrize("suffix", WRITERS)
def test_the_same_motion_gives_the_same_bytes(suffix, motion, tmp_path):
    first = save(motion, tmp_path / f"a{suffix}").read_bytes()
    assert first
    assert save(motion, tmp_path / f"b{suffix}").read_bytes() == first
    assert sorted(p.name for p in tmp_path.iterdir()) == [f"a{suffix}", f"b{suffix}"]


@pytest.mark.parametrize("suffix", WRITERS)
def test_files_name_no_place_of_the_machine(suffix, motion, tmp_path):
    content = save(motion, tmp_path / f"a{suffix}").read_bytes()
    assert str(tmp_path).encode() not in content


@pytest.mark.parametrize("suffix", WRITERS)
def test_writing_replaces_what_was_there(suffix, motion, tmp_path):
    target = tmp_path / f"a{suffix}"
    target.write_bytes(b"x" * 10_000_000)
    assert save(motion, target).stat().st_size < 10_000_000


@pytest.mark.parametrize("suffix", [s for s in WRITERS if s in READERS])
def test_what_is_written_is_read_again(suffix, motion, tmp_path):
    back = load(save(motion, tmp_path / f"a{suffix}"))
    assert len(back) == len(motion)
    assert back.fps == pytest.approx(motion.fps, rel=1e-6)
    np.testing.assert_allclose(joint_positions(back), joint_positions(motion), atol=5e-5)


@pytest.mark.parametrize("suffix", READERS)
@pytest.mark.parametrize("content", [b"", b"hello\n", b"\x00" * 100, b"PK\x03\x04", b"\xff\xfe{"])
def test_nonsense_is_refused_with_the_file_s_name(suffix, content, tmp_path):
    path = tmp_path / f"nonsense{suffix}"
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="nonsense"):
        load(path)


@pytest.mark.parametrize("suffix", READERS)
def test_a_missing_file_is_an_error_of_the_disk(suffix, tmp_path):
    with pytest.raises(FileNotFoundError, match="missing"):
        load(tmp_path / f"missing{suffix}")
