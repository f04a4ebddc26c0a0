"""The index of citations: what it reads, how it sorts, when it is stale."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOL = ROOT / "tools" / "paper_index.py"

spec = importlib.util.spec_from_file_location("paper_index", TOOL)
paper_index = importlib.util.module_from_spec(spec)
sys.modules["paper_index"] = paper_index  # dataclasses look their module up
spec.loader.exec_module(paper_index)

MODULE = '''"""A walk; see [KB92b]."""


def late():
    """Later. [KB92b] Eqs. 10-12."""


class Walk:
    """The walk of [KB92b]
    section 2.3 and Theorem 1.
    """

    def step(self):
        """One step, [KB92b] Eqs. (5), (6) and 21; [SM01] Fig. 13."""
'''


@pytest.fixture
def package(tmp_path):
    folder = tmp_path / "gaitsmith"
    (folder / "walk").mkdir(parents=True)
    (folder / "walk" / "__init__.py").write_text('"""Walks, [KN12]."""\n')
    (folder / "walk" / "model.py").write_text(MODULE)
    return folder


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (" Eq. 3", [("Eq.", "3")]),
        (" Eqs. 3 \u2013 5", [("Eq.", "3-5")]),
        (", Eqs. (5), (6), and 21.", [("Eq.", "5, 6, 21")]),
        (" section 4.2, Eqs. 4 to 7", [("Section", "4.2"), ("Eq.", "4-7")]),
        (" Figure 7; Table 2", [("Figure", "7"), ("Table", "2")]),
        (" Lemma 1 and Corollary 2", [("Lemma", "1"), ("Corollary", "2")]),
        ("\n    Theorem 1", [("Theorem", "1")]),
        (" says so in Eq. 3", []),
        ("", []),
    ],
)
def test_places_are_read_up_to_the_first_other_word(text, expected):
    found = [(paper_index.KINDS[kind][0], numbers) for kind, numbers in paper_index.places(text)]
    assert found == expected


def test_the_page_sorts_by_place_and_keeps_papers_apart(package):
    text = paper_index.page(paper_index.index(package))
    ours, rest = text.split("## KB92b")[1].split("## KB92a")
    rows = [line for line in ours.splitlines() if line.startswith("| ")][1:]
    assert rows == [
        "| Eq. 5, 6, 21 | `gaitsmith.walk.model.Walk.step` |",
        "| Eq. 10-12 | `gaitsmith.walk.model.late` |",
        "| Section 2.3 | `gaitsmith.walk.model.Walk` |",
        "| Theorem 1 | `gaitsmith.walk.model.Walk` |",
    ]
    assert "Also cited by `gaitsmith.walk.model`." in ours
    assert "| Figure 13 | `gaitsmith.walk.model.Walk.step` |" in rest
    assert "Also cited by `gaitsmith.walk`." in rest
    assert rest.count("No code cites it yet.") == 2


def test_check_fails_when_stale_and_passes_when_fresh(package, tmp_path, capsys):
    page = tmp_path / "index.md"
    options = ["--source", str(package), "--page", str(page)]

    assert paper_index.main([*options, "--check"]) == 1
    assert "stale" in capsys.readouterr().err
    assert not page.exists(), "--check writes nothing"

    assert paper_index.main(options) == 0
    assert paper_index.main([*options, "--check"]) == 0

    (package / "new.py").write_text('"""New, [SM01] Eq. 4."""\n')
    assert paper_index.main([*options, "--check"]) == 1


def test_an_unknown_key_is_named(package, tmp_path, capsys):
    (package / "typo.py").write_text('"""A slip of the pen: [KB92c] Eq. 1."""\n')
    assert paper_index.main(["--source", str(package), "--page", str(tmp_path / "x.md")]) == 1
    assert "gaitsmith.typo cites [KB92c]" in capsys.readouterr().err


def test_the_index_in_the_docs_is_fresh():
    run = subprocess.run([sys.executable, str(TOOL), "--check"], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
