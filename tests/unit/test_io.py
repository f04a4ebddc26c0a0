"""save, load, the npz of a motion and the CSV table."""

from __future__ import annotations

import csv
import json
import zipfile
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitsmith import io
from gaitsmith.errors import FileFormatError, InvalidInputError, UnknownFormatError
from gaitsmith.geometry.rotations import exp
from gaitsmith.io.npz import read_npz, write_npz
from gaitsmith.io.table import write_csv
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.motion.skeleton import HUMANOID, Skeleton

if TYPE_CHECKING:
    from pathlib import Path

SEEDS = st.integers(0, 2**32 - 1)
FIELDS = ("root_position", "rotations", "contacts", "translations")
LABELS = ("phase", "step", "footstep_side", "footstep_position", "footstep_heading")
MUST = (
    *("format", "fps", "joint_names", "parents", "offsets", "root_position", "rotations"),
    *("positions", "soles", "contacts", "phase", "step", "footstep_side", "footstep_position"),
    *("footstep_heading", "footstep_time", "ground", "recipe", "sole_offsets"),
)


def labels(frames: int, rng: np.random.Generator, *, path: bool = True) -> Labels:
    return Labels(
        phase=rng.random(frames),
        step=np.minimum(np.arange(frames) // 5 + 2, 6),
        footstep_side=np.arange(7) % 2,
        footstep_position=rng.normal(size=(7, 3)),
        footstep_heading=rng.normal(size=7),
        footstep_time=np.maximum(np.arange(7) - 1, 0) * 0.5,
        ground=json.dumps({"kind": "stairs", "rise": 0.17, "tread": 0.29, "count": 3}),
        recipe=json.dumps({"body": "Zoë", "distance": 5}, ensure_ascii=False),
        path=rng.normal(size=(4, 2)) if path else None,
    )


def walking(seed: int = 0, frames: int = 20, **fields: object) -> Motion:
    """Humanoid with everything that a generator knows."""
    rng = np.random.default_rng(seed)
    names = [name for name, _ in HUMANOID]
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent in HUMANOID)
    skeleton = Skeleton(
        tuple(names), parents, rng.normal(0, 0.1, (len(names), 3)), rng.normal(0, 0.1, (2, 3, 3))
    )
    values = {
        "skeleton": skeleton,
        "root_position": rng.normal(size=(frames, 3)),
        "rotations": exp(rng.normal(size=(frames, len(names), 3))),
        "fps": 60.0,
        "contacts": rng.random((frames, 2, 3)) < 0.5,
        "labels": labels(frames, rng),
    }
    return Motion(**(values | fields))


def assert_same(a: Motion, b: Motion) -> None:
    """Equal to the last bit."""
    assert (a.fps, a.skeleton.names, a.skeleton.parents) == (
        *(b.fps, b.skeleton.names, b.skeleton.parents),
    )
    pairs = [(getattr(a, name), getattr(b, name)) for name in FIELDS]
    pairs += [(a.skeleton.offsets, b.skeleton.offsets), (a.skeleton.soles, b.skeleton.soles)]
    pairs += [(getattr(a.labels, n), getattr(b.labels, n)) for n in (*LABELS, "path")]
    for x, y in pairs:
        assert (x is None) == (y is None)
        if x is not None:
            assert x.dtype == y.dtype
            np.testing.assert_array_equal(x, y)
    assert (a.labels.ground, a.labels.recipe) == (b.labels.ground, b.labels.recipe)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("io")


def rewritten(path: Path, **changes: object) -> Path:
    """The npz at ``path`` with other arrays (None: without)."""
    with np.load(path) as data:
        arrays = {key: data[key] for key in data.files} | changes
    np.savez(path, **{key: value for key, value in arrays.items() if value is not None})
    return path


# ----------------------------------------------------------------------------------------- npz
@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, frames=st.integers(0, 30), stretch=st.booleans(), path=st.booleans())
def test_npz_comes_back_bit_by_bit(folder, seed, frames, stretch, path):
    rng = np.random.default_rng(seed)
    motion = walking(seed, frames, fps=1.0 / (0.001 + rng.random()))
    motion = motion.with_(
        translations=rng.normal(size=(frames, 22, 3)) if stretch else None,
        labels=labels(frames, rng, path=path),
    )
    write_npz(motion, folder / "a.npz")
    assert_same(read_npz(folder / "a.npz"), motion)


def test_npz_is_the_file_of_the_design(folder):
    motion = walking(frames=11)
    write_npz(motion, folder / "a.npz")
    with np.load(folder / "a.npz", allow_pickle=False) as data:
        arrays = {key: data[key] for key in data.files}

    assert tuple(k for k in arrays if k != "joint_ends") == (*MUST[:-1], "path", "sole_offsets")
    assert arrays["format"] == "gaitsmith-motion-1"
    for key, array in arrays.items():
        kind = {"contacts": "b", "parents": "i", "step": "i", "footstep_side": "i"}.get(key)
        kind = kind or ("U" if key in ("format", "joint_names", "ground", "recipe") else "f")
        assert array.dtype.kind == kind, key
        assert array.dtype.itemsize == 8 or kind in "bU", key
    positions, world = motion_kinematics(motion)
    np.testing.assert_array_equal(arrays["positions"], positions)
    np.testing.assert_array_equal(
        arrays["soles"], sole_positions(motion.skeleton, positions, world)
    )
    assert json.loads(str(arrays["recipe"]))["body"] == "Zoë"


def test_npz_has_the_same_bytes_each_time_and_no_compression(folder, monkeypatch):
    write_npz(walking(), folder / "a.npz")
    monkeypatch.setattr("time.time", lambda: 2e9)
    write_npz(walking(), folder / "b.npz")
    assert (folder / "a.npz").read_bytes() == (folder / "b.npz").read_bytes()
    with zipfile.ZipFile(folder / "a.npz") as archive:
        assert {entry.compress_type for entry in archive.infolist()} == {zipfile.ZIP_STORED}
        assert {entry.date_time[0] for entry in archive.infolist()} == {1980}


@pytest.mark.parametrize(
    ("without", "named"),
    [
        ({"contacts": None}, "no contacts, which"),
        ({"labels": None}, "no labels, which"),
        ({"contacts": None, "labels": None}, "no contacts and no labels, which"),
    ],
)
def test_npz_of_a_motion_that_lacks_what_it_promises_is_refused(folder, without, named):
    with pytest.raises(InvalidInputError, match=named + r".*\.bvh or \.csv"):
        write_npz(walking(**without), folder / "no.npz")
    assert not (folder / "no.npz").exists()


def test_npz_needs_soles(folder):
    motion = walking()
    bare = Skeleton(motion.skeleton.names, motion.skeleton.parents, motion.skeleton.offsets)
    with pytest.raises(InvalidInputError, match="no sole points"):
        write_npz(motion.with_(skeleton=bare), folder / "no.npz")


@pytest.mark.parametrize("key", MUST)
def test_npz_without_a_key_is_refused_by_name(folder, key):
    write_npz(walking(), folder / "a.npz")
    with pytest.raises(FileFormatError, match=key) as error:
        read_npz(rewritten(folder / "a.npz", **{key: None}))
    assert error.value.path.endswith("a.npz")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"format": "gaitsmith-motion-2"}, "wanted 'gaitsmith-motion-1'"),
        ({"rotations": np.zeros((20, 22, 4))}, "unit quaternions"),
        ({"rotations": np.zeros((20, 21, 4))}, "'rotations' has shape .* with .*J = 22"),
        ({"root_position": np.full((20, 3), np.nan)}, "root_position must be finite"),
        ({"positions": np.zeros((19, 22, 3))}, "'positions' has shape"),
        ({"positions": np.zeros((20, 22, 3), np.float32)}, "float32, wanted float64"),
        ({"contacts": np.zeros((20, 2, 3))}, "'contacts' holds float64, wanted flags"),
        ({"parents": np.arange(22)}, "parents must come before children"),
        ({"phase": np.full(20, 1.5)}, "phase must lie in"),
        ({"step": np.full(20, 7)}, "step must be the index"),
        ({"step": -np.arange(20) + 6}, "step must be the index"),
        ({"footstep_side": np.full(7, 2)}, "footstep_side must be 0"),
        ({"fps": np.float64(0.0)}, "fps must be a positive"),
        ({"fps": np.array([60.0])}, "'fps' has shape"),
        ({"ground": np.array("{")}, "ground is not JSON"),
        ({"recipe": np.array(3.0)}, "'recipe' holds float64, wanted text"),
        ({"joint_names": np.full(22, "hips")}, "joint names must be different"),
        ({"ground": np.array({"a": 1}, dtype=object)}, "(?i)object arrays cannot be loaded"),
    ],
)
def test_npz_with_a_wrong_value_is_refused_with_the_reason(folder, change, why):
    write_npz(walking(), folder / "a.npz")
    with pytest.raises(FileFormatError, match=why):
        read_npz(rewritten(folder / "a.npz", **change))


@settings(max_examples=150, deadline=None)
@given(data=st.data())
def test_a_damaged_npz_is_refused_and_never_crashes(folder, data):
    path = folder / "damaged.npz"
    write_npz(walking(frames=2), path)
    content = bytearray(path.read_bytes())
    if data.draw(st.booleans(), label="cut"):
        del content[data.draw(st.integers(0, len(content) - 1)) :]
    for _ in range(data.draw(st.integers(1, 4))):
        if content:
            where = data.draw(st.integers(0, len(content) - 1))
            content[where] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        read_npz(path)
    except FileFormatError as error:
        said = str(error)
    else:
        said = "damaged.npz"  # in a byte that nobody reads, or one that makes another good file
    assert "damaged.npz" in said
    assert "\n" not in said


def test_a_file_that_is_no_zip_is_refused(folder):
    (folder / "text.npz").write_text("hello")
    with pytest.raises(FileFormatError, match=r"text\.npz: not a readable npz archive"):
        read_npz(folder / "text.npz")
    with pytest.raises(FileNotFoundError):
        read_npz(folder / "missing.npz")


def test_a_seek_to_nowhere_is_the_file_s_fault_not_the_disk_s(folder, monkeypatch):
    """Offsets in a damaged zip end in an OSError that names no file."""

    def seek(*_):
        raise OSError(22, "Invalid argument")

    write_npz(walking(), folder / "a.npz")
    monkeypatch.setattr(zipfile.ZipFile, "open", seek)
    with pytest.raises(FileFormatError, match=r"a\.npz: not a readable npz archive.*Invalid"):
        read_npz(folder / "a.npz")


@pytest.mark.parametrize("field", ["ground", "recipe"])
def test_labels_that_could_not_be_read_back_are_not_written(folder, field):
    from dataclasses import replace

    motion = walking()
    for text, why in (("{", "is not JSON"), ("1\0", "is not JSON|NUL")):
        broken = motion.with_(labels=replace(motion.labels, **{field: text}))
        with pytest.raises(InvalidInputError, match=f"{field}.*({why})"):
            write_npz(broken, folder / "no.npz")


# ----------------------------------------------------------------------------------------- csv
def table(motion: Motion, folder: Path) -> dict[str, list[str]]:
    write_csv(motion, folder / "a.csv")
    with (folder / "a.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    assert len({len(row) for row in rows}) == 1
    return dict(zip(rows[0], zip(*rows[1:], strict=True), strict=True))


def test_csv_has_every_column_and_the_right_numbers(folder):
    motion = walking(frames=7)
    columns = table(motion, folder)
    positions, world = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, positions, world)

    assert list(columns)[:5] == ["time_s", "frame", "hips_x", "hips_y", "hips_z"]
    assert list(columns)[-2:] == ["phase", "step"]
    assert len(columns) == 2 + 22 * 3 + 18 + 6 + 2
    assert columns["frame"] == tuple("0123456")
    assert columns["step"] == tuple(str(step) for step in motion.labels.step)
    assert columns["contact_right_ball"] == tuple(
        "1" if flag else "0" for flag in motion.contacts[:, 1, 1]
    )
    for name, want in (
        ("time_s", motion.times),
        ("leftHand_y", positions[:, motion.skeleton.index("leftHand"), 1]),
        ("sole_left_heel_x", soles[:, 0, 0, 0]),
        ("sole_right_toe_z", soles[:, 1, 2, 2]),
        ("phase", motion.labels.phase),
    ):
        np.testing.assert_allclose(np.array(columns[name], float), want, atol=5.1e-7)
        assert all(len(word.split(".")[1]) == 6 for word in columns[name])


def test_csv_leaves_out_what_is_not_known(folder):
    motion = walking(contacts=None, labels=None)
    bare = Skeleton(("a,b", 'c"d'), (-1, 0), np.ones((2, 3)))
    motion = Motion(bare, np.zeros((3, 3)), np.tile([0.0, 0, 0, 1], (3, 2, 1)), 30.0)
    columns = table(motion, folder)
    assert list(columns) == [
        *("time_s", "frame", "a,b_x", "a,b_y", "a,b_z", 'c"d_x', 'c"d_y', 'c"d_z')
    ]
    assert columns["a,b_x"] == ("0.000000",) * 3
    assert columns['c"d_z'] == ("1.000000",) * 3


# ------------------------------------------------------------------------------- save and load
def test_save_chooses_by_suffix_in_any_case_and_returns_the_path(tmp_path):
    motion = walking()
    for name in ("a.bvh", "b.NPZ", "c.Csv"):
        assert io.save(motion, str(tmp_path / name)) == tmp_path / name
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.bvh", "b.NPZ", "c.Csv"]
    assert_same(io.load(str(tmp_path / "b.NPZ")), motion)


@pytest.mark.parametrize(("name", "hint"), [("a.bvb", "'.bvh'?"), ("a", ""), ("a.fbx", "")])
def test_unknown_suffixes_are_refused_before_anything_else(tmp_path, name, hint):
    with pytest.raises(UnknownFormatError, match=r"cannot write .*known suffixes: \.bvh, ") as e:
        io.save(walking(), tmp_path / "nowhere" / name)
    assert str(e.value).endswith(hint or "npz.")
    with pytest.raises(UnknownFormatError, match=r"cannot read .*known suffixes: .*\.npz"):
        io.load(tmp_path / name)


def test_a_missing_folder_is_said_in_one_line(tmp_path):
    with pytest.raises(FileNotFoundError) as error:
        io.save(walking(), tmp_path / "nowhere" / "a.bvh")
    folder = tmp_path / "nowhere"
    assert str(error.value) == f"cannot write {folder / 'a.bvh'}: there is no folder {folder}"
    (tmp_path / "d.bvh").mkdir()
    with pytest.raises(IsADirectoryError, match="it is a folder"):
        io.save(walking(), tmp_path / "d.bvh")


@pytest.mark.parametrize("error", [InvalidInputError("no"), KeyboardInterrupt(), OSError("full")])
def test_a_failed_save_leaves_the_old_file_and_nothing_else(tmp_path, error):
    def half(motion, path):
        path.write_text("half")
        raise error

    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(type(error)):
        io.save(walking(), tmp_path / "a.txt", {".txt": half})
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_a_refused_motion_leaves_nothing(tmp_path):
    with pytest.raises(InvalidInputError, match="no labels"):
        io.save(walking(labels=None), tmp_path / "a.npz")
    assert list(tmp_path.iterdir()) == []


def test_writers_get_a_path_of_their_suffix_and_may_be_added(tmp_path):
    seen = []

    def write(motion, path):
        seen.append(path)
        path.write_text(str(len(motion)))

    io.save(walking(), tmp_path / "a.png", {**io.WRITERS, ".png": write})
    assert (tmp_path / "a.png").read_text() == "20"
    assert seen[0].suffix == ".png"
    assert seen[0].parent == tmp_path


def test_save_all_writes_all_or_none(tmp_path):
    targets = [tmp_path / "a.bvh", tmp_path / "a.npz"]
    with pytest.raises(InvalidInputError, match="no labels"):
        io.save_all(walking(labels=None), targets)
    assert list(tmp_path.iterdir()) == []
    assert io.save_all(walking(), targets) == targets
    assert all(target.stat().st_size for target in targets)


def test_errors_of_the_disk_name_the_target(tmp_path):
    def refuse(motion, path):
        raise PermissionError(13, "Permission denied", str(path))

    with pytest.raises(PermissionError, match=r"Permission denied: '.*a\.txt'"):
        io.save(walking(), tmp_path / "a.txt", {".txt": refuse})


def test_saving_through_a_longest_possible_name(tmp_path):
    path = tmp_path / ("x" * 251 + ".csv")
    assert io.save(walking(), path).exists()
