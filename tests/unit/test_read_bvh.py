"""BVH of every dialect: what is read, what is warned of, what is refused and where."""

from __future__ import annotations

import time
import warnings

import numpy as np
import pytest

from gaitsmith.errors import FileFormatError, GaitsmithWarning, InvalidInputError
from gaitsmith.io.bvh_file import BvhFile, EndSite
from gaitsmith.io.bvh_motion import read_bvh
from gaitsmith.io.bvh_parse import MAX_JOINTS, parse_bvh, read_bvh_file
from gaitsmith.io.bvh_print import digits, write_bvh_file
from gaitsmith.motion.roles import humanoid_roles

HEADER = """HIERARCHY
ROOT Hips
{
  OFFSET 0.0 0.0 0.0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0.0 10.5 0.25
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0.0 20.0 0.0
    }
  }
  JOINT LeftLeg
  {
    OFFSET 9.0 -3.0 0.0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0.0 -40.0 1.0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.0333333
"""
VALUES = np.round(np.random.default_rng(0).uniform(-180.0, 180.0, (3, 12)), 4)
ROWS = [" ".join(f"{v:.4f}" for v in row) for row in VALUES]
BASE = HEADER + "\n".join(ROWS) + "\n"


def swap(*pairs: tuple[str, str]) -> str:
    text = BASE
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


def wrapped(*cuts: int) -> str:
    words = [row.split() for row in ROWS]
    return HEADER + "\n".join(
        " ".join(row[a:b]) for row in words for a, b in zip((0, *cuts), (*cuts, 12), strict=True)
    )


SPINE = "JOINT Spine\n  {\n    OFFSET 0.0 10.5 0.25\n    CHANNELS 3 Zrotation Xrotation Yrotation"
#: The dialects of files in the wild: text, names of the joints, words of the warnings.
QUIRKS: dict[str, tuple[str | bytes, tuple[str, ...]]] = {
    "base": (BASE, ()),
    "CRLF": (BASE.replace("\n", "\r\n"), ()),
    "CR alone": (BASE.replace("\n", "\r"), ()),
    "tabs": (BASE.replace("  ", "\t").replace(" ", "\t").replace("End\tSite", "End Site"), ()),
    "no frame time": (swap(("Frame Time: 0.0333333\n", "")), ("no 'Frame Time:'",)),
    "frame time of zero": (swap(("0.0333333", "0")), ("of zero",)),
    "brace on the same line": (BASE.replace("\n  {", " {").replace("\n{", "{"), ()),
    "all on one line": (
        BASE.split("MOTION")[0].replace("\n", " ") + "MOTION " + BASE.split("MOTION\n")[1], ()),
    "names with blanks": (swap(("JOINT Spine", "JOINT Lower  Spine 1")), ()),
    "names with a colon": (swap(("ROOT Hips", "ROOT mixamorig:Hips")), ()),
    "names not in ASCII": (swap(("ROOT Hips", "ROOT 腰")), ()),
    "names in Latin-1": (swap(("ROOT Hips", "ROOT Hüfte")).encode("latin-1"), ()),
    "names with braces": (swap(("JOINT Spine", "JOINT a{b}c")), ()),
    "positions elsewhere": (
        swap((SPINE, SPINE.replace("3 Z", "6 Xposition Yposition Zposition Z")),
             ("0.0\n    CHANNELS 3 Zrotation Xrotation Yrotation", "0.0\n    CHANNELS 0")), ()),
    "rotation before position": (
        swap(("Xposition Yposition Zposition Zrotation Xrotation Yrotation",
              "Zrotation Xrotation Yrotation Xposition Yposition Zposition")), ()),
    "wrapped frames": (wrapped(5), ()),
    "wrapped in three": (wrapped(1, 11), ()),
    "one number a line": (HEADER + "\n".join(" ".join(ROWS).split()), ()),
    "frames flow on": (HEADER + "\n".join(
        " ".join(" ".join(ROWS).split()[i : i + 9]) for i in range(0, 36, 9)), ()),
    "more frames than declared": (swap(("Frames: 3", "Frames: 2")), ("declares 2 frames, has 3",)),
    "1e3 notation": (HEADER + "\n".join(
        " ".join(f"{v:.8e}" for v in row) for row in VALUES), ()),
    "BOM": (b"\xef\xbb\xbf" + BASE.encode(), ()),
    "UTF-16": (BASE.encode("utf-16"), ()),
    "no End Site": (swap(("    End Site\n    {\n      OFFSET 0.0 20.0 0.0\n    }\n", "")), ()),
    "trailing blanks": (BASE.replace("\n", "  \t\n") + "\n \n\t\n", ()),
    "no newline at the end": (BASE.rstrip("\n"), ()),
    "frames and a tab": (swap(("Frames: 3", "Frames:\t3")), ()),
    "no blank behind the colon": (swap(("Frames: 3", "Frames:3")), ()),
    "joint of no channel": (
        (BASE.split("MOTION")[0].replace(SPINE, SPINE[: SPINE.rindex("3")] + "0")
         + "MOTION\nFrames: 3\nFrame Time: 0.0333333\n"
         + "\n".join(" ".join(row.split()[:9]) for row in ROWS)), ()),
    "joint without CHANNELS": (
        (BASE.split("MOTION")[0].replace(SPINE, SPINE[: SPINE.rindex("\n")])
         + "MOTION\nFrames: 3\nFrame Time: 0.0333333\n"
         + "\n".join(" ".join(row.split()[:9]) for row in ROWS)), ()),
    "joint of one channel": (
        (BASE.split("MOTION")[0].replace(SPINE, SPINE[: SPINE.rindex("3")] + "1 Xrotation")
         + "MOTION\nFrames: 3\nFrame Time: 0.0333333\n"
         + "\n".join(" ".join(row.split()[:10]) for row in ROWS)), ()),
    "lower-case keywords": (HEADER.lower() + "\n".join(ROWS), ()),
    "upper-case keywords": (HEADER.upper() + "\n".join(ROWS), ()),
    "no frame": (HEADER.replace("Frames: 3", "Frames: 0"), ()),
    "duplicate names": (swap(("JOINT LeftLeg", "JOINT Spine")), ("more than one joint is called",)),
    "named End Site": (swap(("End Site", "End Site Tip of it")), ()),
    "blank line between frames": (HEADER + ROWS[0] + "\n\n" + "\n".join(ROWS[1:]), (":29: blank",)),
    "blank lines in the hierarchy": (BASE.split("MOTION")[0].replace("\n", "\n\n")
                                     + "MOTION\n" + BASE.split("MOTION\n")[1], ()),
    "end of file of DOS": (BASE + "\x1a", ()),
}  # fmt: skip


def read(text: str | bytes, tmp_path, name="a.bvh") -> tuple[BvhFile, list[str]]:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        file = read_bvh_file(path)
    assert all(issubclass(w.category, GaitsmithWarning) for w in caught)
    return file, [str(w.message) for w in caught]


def values_of(text: str | bytes) -> np.ndarray:
    """What a plain reader of numbers finds behind the header."""
    if isinstance(text, bytes):
        return VALUES
    words = text.split("\x1a")[0].lower().split("motion")[1].split()
    start = words.index("time:") + 2 if "time:" in words else 2
    return np.array(words[start:], dtype=float)


@pytest.mark.parametrize("quirk", QUIRKS)
def test_every_dialect_is_read_to_the_last_bit(quirk, tmp_path):
    text, said = QUIRKS[quirk]
    file, messages = read(text, tmp_path)
    np.testing.assert_array_equal(file.values.ravel(), values_of(text).ravel())
    assert file.parents == (-1, 0, 0)
    assert file.frame_time == pytest.approx(1 / 30, rel=2e-6)
    assert len(messages) == len(said)
    assert all(str(tmp_path) in m and word in m for m, word in zip(messages, said, strict=True))
    assert file.warnings == tuple(messages)
    np.testing.assert_array_equal(file.offsets, [[0, 0, 0], [0, 10.5, 0.25], [9, -3, 0]])


@pytest.mark.parametrize(("quirk", "names"), [
    ("names with blanks", ("Hips", "Lower  Spine 1", "LeftLeg")),
    ("names with a colon", ("mixamorig:Hips", "Spine", "LeftLeg")),
    ("names not in ASCII", ("腰", "Spine", "LeftLeg")),
    ("names in Latin-1", ("Hüfte", "Spine", "LeftLeg")),
    ("names with braces", ("Hips", "a{b}c", "LeftLeg")),
    ("brace on the same line", ("Hips", "Spine", "LeftLeg")),
    ("all on one line", ("Hips", "Spine", "LeftLeg")),
    ("duplicate names", ("Hips", "Spine", "Spine")),
])  # fmt: skip
def test_names_are_those_of_the_file(quirk, names, tmp_path):
    assert read(QUIRKS[quirk][0], tmp_path)[0].names == names


def test_channels_and_end_sites_are_those_of_the_file(tmp_path):
    rotation = ("Zrotation", "Xrotation", "Yrotation")
    position = ("Xposition", "Yposition", "Zposition")
    file, _ = read(BASE, tmp_path)
    assert file.channels == (position + rotation, rotation, rotation)
    assert file.ends == (EndSite(1, (0.0, 20.0, 0.0)), EndSite(2, (0.0, -40.0, 1.0)))
    assert read(QUIRKS["rotation before position"][0], tmp_path)[0].channels[0] == (
        rotation + position
    )
    assert read(QUIRKS["positions elsewhere"][0], tmp_path)[0].channels[1:] == (
        position + rotation,
        (),
    )
    assert read(QUIRKS["joint of one channel"][0], tmp_path)[0].channels[1] == ("Xrotation",)
    assert read(QUIRKS["lower-case keywords"][0], tmp_path)[0].channels == file.channels
    assert {e.name for e in read(QUIRKS["named End Site"][0], tmp_path)[0].ends} == {"Tip of it"}


@pytest.mark.parametrize("quirk", QUIRKS)
def test_what_is_written_is_strict_and_read_again_the_same(quirk, tmp_path):
    file, _ = read(QUIRKS[quirk][0], tmp_path)
    target = tmp_path / "out.bvh"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        write_bvh_file(file, target)
    text = target.read_text(encoding="utf-8")
    assert "\r" not in text
    assert "\ufeff" not in text
    lines = text.splitlines()
    start = lines.index("MOTION")
    assert lines[start + 1] == f"Frames: {len(file)}"
    assert lines[start + 2].split(".")[1].isdigit()
    assert len(lines[start + 2].split(".")[1]) >= 7
    assert len(lines) == start + 3 + len(file)
    for line in lines[:start]:
        assert line.strip() in "{}" or "{" not in line or "a{b}c" in line
        if "CHANNELS" in line:
            assert line.count("rotation") in (0, 3)
    back, _ = read(text, tmp_path, "again.bvh")
    assert (back.names, back.parents, back.frame_time) == (
        file.names,
        file.parents,
        file.frame_time,
    )
    np.testing.assert_array_equal(back.offsets, file.offsets)
    assert [(e.joint, e.offset) for e in back.ends] == [(e.joint, e.offset) for e in file.ends]
    for joint, names in enumerate(file.channels):
        assert back.channels[joint][: len(names)] == names
        columns = back.values[:, back.columns[joint]]
        np.testing.assert_array_equal(columns[:, : len(names)], file.values[:, file.columns[joint]])
        assert not columns[:, len(names) :].any()


def test_what_blender_refuses_is_said(tmp_path):
    with pytest.warns(GaitsmithWarning, match="'Spine' had less than three rotation"):
        write_bvh_file(read(QUIRKS["joint of one channel"][0], tmp_path)[0], tmp_path / "o.bvh")
    with pytest.warns(GaitsmithWarning, match="no frame"):
        write_bvh_file(read(QUIRKS["no frame"][0], tmp_path)[0], tmp_path / "o.bvh")


@pytest.mark.parametrize("value", [0.0, 1.0, -5.51764e-07, 0.1, 1e-12, 1e22, np.pi * 1e5, 5e-324])
def test_digits_read_back_and_have_no_exponent(value):
    assert float(digits(value)) == value
    assert "e" not in digits(value)
    assert "." in digits(value)


@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e9])
def test_numbers_of_any_size_come_back(scale, tmp_path):
    values = scale * np.random.default_rng(0).normal(size=(5, 12))
    file = read(BASE, tmp_path)[0].with_(values=values)
    write_bvh_file(file, tmp_path / "o.bvh")
    np.testing.assert_array_equal(read_bvh_file(tmp_path / "o.bvh").values, values)


# --------------------------------------------------------------------------------------- errors
BROKEN = {
    "nothing": ("", 1, "HIERARCHY"),
    "no BVH": ("hello\n", 1, "no BVH"),
    "a picture": (b"\x89PNG\r\n\x1a\n" + b"\x00" * 100, 1, "no BVH"),
    "a long line": (b"x" * 200_000, 1, "a line of more than"),
    "cut in the hierarchy": (BASE.split("    CHANNELS 3")[0].rstrip(), 8, "ends before MOTION"),
    "not closed": (swap(("  }\n}\nMOTION", "  }\nMOTION")), 24, "'Hips' is not closed"),
    "closed twice": (swap(("}\nMOTION", "}\n}\nMOTION")), 25, "not open"),
    "no root": ("HIERARCHY\nMOTION\nFrames: 0\n", 2, "no ROOT"),
    "joint without root": ("HIERARCHY\nJOINT a\n{\n}\n", 2, "outside of the joints"),
    "root in a joint": (swap(("JOINT Spine", "ROOT Spine")), 6, "inside another joint"),
    "joint in an End Site": (swap(("OFFSET 0.0 20.0 0.0", "JOINT a")), 12, "in an End Site"),
    "no name": (swap(("JOINT Spine", "JOINT")), 6, "without a name"),
    "name of a brace": (swap(("JOINT Spine\n  {", "JOINT a{ {")), 6, "ends in a brace"),
    "no brace": (swap(("JOINT Spine\n  {", "JOINT Spine\n")), 8, "must open"),
    "unknown word": (swap(("    OFFSET 9.0", "    SCALE 9.0")), 17, "'SCALE' has no place"),
    "bad offset": (swap(("9.0 -3.0 0.0", "9.0 x 0.0")), 17, "got 'x'"),
    "offset of nan": (swap(("9.0 -3.0 0.0", "9.0 nan 0.0")), 17, "finite"),
    "unknown channel": (swap(("Zposition Z", "Wposition Z")), 5, "'Wposition' is none"),
    "too few channels": (swap(("CHANNELS 6", "CHANNELS 7")), 5, "0 to 6"),
    "billions of channels": (swap(("CHANNELS 6", "CHANNELS 6000000000")), 5, "0 to 6"),
    "no Frames": (swap(("Frames: 3\n", "")), 26, "'Frames:' expected"),
    "half a frame": (swap(("Frames: 3", "Frames: 3.5")), 26, "whole number"),
    "negative frames": (swap(("Frames: 3", "Frames: -1")), 26, "whole number"),
    "endless frames": (swap(("Frames: 3", "Frames: " + "9" * 5000)), 26, "whole number"),
    "backward time": (swap(("0.0333333", "-0.0333333")), 27, "0.000001 to 1000"),
    "time of nan": (swap(("0.0333333", "nan")), 27, "0.000001 to 1000"),
    "less frames than declared": (swap(("Frames: 3", "Frames: 4")), 30, "declares 4 frames"),
    "a billion frames": (swap(("Frames: 3", "Frames: 1000000000")), 30, "ends after 3"),
    "a short row": (BASE.replace(ROWS[1], ROWS[1].rsplit(" ", 1)[0]), 29, "11 values where 12"),
    "a long row": (BASE.replace(ROWS[1], ROWS[1] + " 1.0"), 29, "13 values where 12"),
    "a short last row": (BASE[:-10], 30, "11 of 12 values"),
    "a word": (BASE.replace(ROWS[1].split()[0], "oh"), 29, "'oh' is not a finite number"),
    "an underscore": (BASE.replace(ROWS[1].split()[0], "1_0"), 29, "'1_0' is not"),
    "nan": (BASE.replace(ROWS[2].split()[0], "nan"), 30, "'nan' is not"),
    "too large": (BASE.replace(ROWS[2].split()[0], "1e999"), 30, "'1e999' is not"),
    "frames without channels": (
        "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 1000000000\nFrame Time: 0.1\n",
        8,
        "no joint has a channel",
    ),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_a_broken_file_gives_one_line_with_file_line_and_cause(fault, tmp_path):
    text, line, cause = BROKEN[fault]
    path = tmp_path / "broken.bvh"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FileFormatError, match=r"broken\.bvh") as error:
        read_bvh_file(path)
    assert error.value.line == line
    assert cause in str(error.value)
    assert "\n" not in str(error.value)


def test_a_million_nested_joints_fail_at_once(tmp_path):
    text = "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n" + "JOINT j\n{\nOFFSET 0 1 0\n" * 1_000_000
    start = time.perf_counter()
    with pytest.raises(FileFormatError, match=f"more than {MAX_JOINTS} joints"):
        parse_bvh(text.encode())
    assert time.perf_counter() - start < 5.0


def test_as_many_joints_as_are_allowed_one_in_the_other(tmp_path):
    count = MAX_JOINTS - 1
    text = (
        "HIERARCHY\nROOT r\n{\nCHANNELS 1 Yrotation\n"
        + "JOINT LeftLeg\n{\nOFFSET 0 1 0\n" * count
        + "}\n" * (count + 1)
        + "MOTION\nFrames: 1\nFrame Time: 0.1\n5\n"
    )
    start = time.perf_counter()
    file, _ = read(text, tmp_path)
    humanoid_roles(file.names, file.parents, need=())
    assert len(file.names) == MAX_JOINTS
    assert time.perf_counter() - start < 20.0


def test_joints_without_channels_do_not_fill_the_memory(tmp_path):
    """2 MB of file must not become 32 GB of quaternions."""
    text = (
        "HIERARCHY\nROOT r\n{\nCHANNELS 1 Yrotation\n"
        + "JOINT j\n{\n}\n" * 1000
        + "}\nMOTION\nFrames: 1000000\nFrame Time: 0.1\n"
        + "0\n" * 1_000_000
    )
    (tmp_path / "bomb.bvh").write_text(text)
    with (
        pytest.warns(GaitsmithWarning, match="more than one joint"),
        pytest.raises(FileFormatError, match="are no figure"),
    ):
        read_bvh(tmp_path / "bomb.bvh")


def test_twenty_thousand_frames_in_seconds(tmp_path):
    rng = np.random.default_rng(0)
    joints = 58
    rotation = ("Zrotation", "Xrotation", "Yrotation")
    file = BvhFile(
        names=tuple(f"j{i}" for i in range(joints)),
        parents=tuple(range(-1, joints - 1)),
        offsets=np.ones((joints, 3)),
        channels=(rotation,) * joints,
        ends=(),
        frame_time=1 / 30,
        values=np.round(rng.uniform(-180, 180, (4000, 3 * joints)), 6),
    )
    write_bvh_file(file, tmp_path / "big.bvh")
    start = time.perf_counter()
    back = read_bvh_file(tmp_path / "big.bvh")
    assert time.perf_counter() - start < 3.0  # a fifth of it; 0.2 s where nothing else runs
    np.testing.assert_array_equal(back.values, file.values)


def test_a_bvh_file_that_cannot_be_is_refused(tmp_path):
    file = read(BASE, tmp_path)[0]
    for changes, word in (
        ({"parents": (-1, 2, 0)}, "depth first"),
        ({"channels": (("Zrot",), (), ())}, "unknown channels"),
        ({"names": ("a",)}, "same joints"),
        ({"names": ("a", "b {c", "d")}, "cannot be called"),
        ({"names": ("a", "b\nc", "d")}, "cannot be called"),
        ({"values": np.zeros((3, 5))}, "values"),
        ({"frame_time": 0.0}, "frame_time"),
    ):
        with pytest.raises(InvalidInputError, match=word):
            file.with_(**changes)
