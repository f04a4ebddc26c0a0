"""``gaitsmith measure``: table, JSON, exit codes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import gaitsmith
from gaitsmith.cli.measure import HEADINGS

STICK = """HIERARCHY
ROOT Box
{
 OFFSET 0 0 0
 CHANNELS 3 Xposition Yposition Zposition
 JOINT Lid
 {
  OFFSET 0 90 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  End Site
  {
   OFFSET 0 10 0
  }
 }
}
MOTION
Frames: 2
Frame Time: 0.033333
0 0 0 0 0 0
0 0 0 0 0 0
"""


@pytest.fixture(scope="module")
def walked():
    return gaitsmith.walk(distance=4.0, step_length=0.6, cadence=100.0, fps=30, gait="winter")


@pytest.fixture
def walk(walked, tmp_path):
    """The files ``walk.npz`` and ``walk.bvh`` of one walk."""
    for suffix in ("npz", "bvh"):
        gaitsmith.save(walked, tmp_path / f"walk.{suffix}")
    return walked


def test_one_file_is_one_object(run, walk):
    code, out, err = run("measure", "walk.npz", "--json")
    assert (code, err) == (0, "")
    figures = json.loads(out)
    assert figures["file"] == "walk.npz"
    assert figures["step_length_m"] == pytest.approx(0.6)
    assert figures["warnings"] == []
    asked = gaitsmith.measure("walk.npz")
    assert {k: v for k, v in figures.items() if k not in ("file", "warnings")} == asked


def test_several_files_are_a_list_in_their_order(run, walk):
    code, out, _ = run("measure", "walk.npz", "walk.bvh", "--json")
    assert code == 0
    files = json.loads(out)["files"]
    assert [f["file"] for f in files] == ["walk.npz", "walk.bvh"]
    assert files[0].keys() == files[1].keys()
    assert files[1]["cadence_spm"] == pytest.approx(100.0, rel=0.01)


def test_the_table_has_a_row_a_figure_and_a_column_a_file(run, walk):
    code, out, err = run("measure", "walk.npz", "walk.bvh")
    assert code == 0
    rows = {line.split()[0]: line.split()[1:] for line in out.splitlines() if line}
    assert rows["walk.npz"] == ["walk.bvh"]
    assert rows["step_length_m"] == ["0.6", "0.6"]
    assert rows["contacts"] == ["file", "estimated"]
    assert rows["path_error_p95_m"][1] == "-"
    assert "path_error_p95_m" in err  # why it is not there
    assert err.startswith("gaitsmith: note: walk.bvh: ")


def test_every_heading_stands_before_a_figure(run, walk):
    figures = gaitsmith.measure(walk)
    assert set(HEADINGS) <= set(figures)
    _, out, _ = run("measure", "walk.npz")
    assert [h for h in HEADINGS.values() if f"\n{h}\n" not in out] == []


def test_a_unit_that_was_guessed_is_a_warning(run, walk, tmp_path):
    text = (tmp_path / "walk.bvh").read_text()
    head, frames = text.split("MOTION\n")
    # the same walk in meters
    head = scaled(head, "OFFSET")
    lines = frames.splitlines()
    rows = [line.split() for line in lines[2:]]
    moved = [" ".join([*(str(0.01 * float(v)) for v in r[:3]), *r[3:]]) for r in rows]
    (tmp_path / "meters.bvh").write_text(head + "MOTION\n" + "\n".join(lines[:2] + moved) + "\n")
    code, out, err = run("measure", "meters.bvh", "--json")
    assert (code, err) == (0, "")
    figures = json.loads(out)
    assert any("unit" in line for line in figures["warnings"])
    assert figures["step_length_m"] == pytest.approx(0.6, rel=0.02)
    assert json.loads(run("measure", "meters.bvh", "--unit", "m", "--json")[1])["warnings"] == []


def scaled(text, word):
    out = []
    for line in text.splitlines(keepends=True):
        before, found, after = line.partition(word)
        if found:
            values = [f"{0.01 * float(v):.8f}" for v in after.split()]
            line = f"{before}{found} {' '.join(values)}\n"
        out.append(line)
    return "".join(out)


def test_what_is_no_person_is_one_clear_line(run, tmp_path):
    (tmp_path / "box.bvh").write_text(STICK)
    code, out, err = run("measure", "box.bvh", "--json", "--unit", "cm")
    assert (code, out) == (1, "")
    assert err.count("\n") == 1
    assert "box.bvh" in err
    assert "hips" in err


@pytest.mark.parametrize(
    ("name", "code", "word"),
    [("none.bvh", 1, "no such file"), ("bad.npz", 1, "bad.npz"), ("clip.fbx", 2, ".fbx")],
)
def test_a_file_that_cannot_be_read(run, tmp_path, name, code, word):
    (tmp_path / "bad.npz").write_bytes(b"no archive")
    got, out, err = run("measure", name)
    assert (got, out) == (code, "")
    assert word in err.lower()
    assert err.count("\n") == 1


def test_one_bad_file_of_several_fails_them_all(run, walk, tmp_path):
    (tmp_path / "box.bvh").write_text(STICK)
    code, out, err = run("measure", "walk.npz", "box.bvh", "--json")
    assert (code, out) == (1, "")
    assert "box.bvh" in err


def test_without_a_file_it_is_wrong_usage(run):
    assert run("measure")[0] == 2


def test_the_reference_has_every_key(run, walk):
    page = Path(__file__).resolve().parents[2] / "docs" / "reference" / "json.md"
    section = page.read_text("utf-8").split("\n## `measure`")[1].split("\n## ")[0]
    cells = re.findall(r"^\| (`[^|]*`) \|", section, re.MULTILINE)
    documented = re.findall(r"`(\w+)`", " ".join(cells))
    assert sorted(documented) == sorted(json.loads(run("measure", "walk.npz", "--json")[1]))
