"""The documents: tutorials run as printed, the index is fresh, the site needs no network."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
#: Pages whose examples are run; a tutorial must have some, the others may.
PAGES = [*sorted(DOCS.rglob("*.md")), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
#: Those whose examples take long.
#: Pages whose examples take a second and more; of the commands only the README's run every time.
SLOW = {
    *("docs/obstacles.md", "docs/reference/cli.md", "docs/reference/grounds.md", "docs/styles.md"),
    *("docs/index.md", "docs/papers/sm01.md", "docs/tutorials/learn-a-gait.md"),
    *("docs/tutorials/scenes.md", "docs/tutorials/steering.md", "docs/tutorials/first-walk.md"),
    "docs/tutorials/measure-a-clip.md",
}
SHELL = {"bash", "console", "sh", "shell"}
#: Commands that a tutorial may show and that a test does not run.
SET_UP = {"git", "make", "pip", "python3", "source"}
#: Languages of blocks that show what is read or printed.
SHOWN = {"csv", "ini", "json", "text", "toml"}
FENCE = re.compile(
    r"^(?P<indent>[ \t]*)(?P<fence>```+|~~~+)(?P<info>[^\n]*)\n"
    r"(?P<body>.*?)^[ \t]*(?P=fence)[ \t]*$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page: its language, its first line's number, its text.

    ``title`` is the file that a reader saves it as.
    """

    language: str
    line: int
    text: str
    title: str | None = None


def blocks(page: Path) -> list[Block]:
    """All fenced blocks of ``page``, whatever their language."""
    found, text = [], page.read_text(encoding="utf-8")
    for match in FENCE.finditer(text):
        language = re.match(r"\s*\{?\s*\.?([\w+-]*)", match["info"])[1]
        line = text.count("\n", 0, match.start("body")) + 1
        body = re.sub(rf"^{match['indent']}", "", match["body"], flags=re.MULTILINE)
        title = re.search(r'title="([^"]+)"', match["info"])
        found.append(Block(language, line, body, title[1] if title else None))
    return found


def save_files(page: Path, folder: Path) -> None:
    """What a reader of ``page`` saves."""
    for block in blocks(page):
        if block.title is not None:
            (folder / block.title).write_text(block.text, encoding="utf-8")


def ids(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def named(kind: set[str]) -> list[Path]:
    """Pages that have a block in one of the languages ``kind``."""
    return [page for page in PAGES if any(block.language in kind for block in blocks(page))]


def marked(pages: list[Path]) -> list[object]:
    """The same as parameters, those that take long marked so."""
    slow = [pytest.mark.slow]
    return [pytest.param(page, marks=slow if ids(page) in SLOW else []) for page in pages]


def test_there_are_tutorials_and_each_shows_python():
    assert TUTORIALS
    assert set(TUTORIALS) <= set(named({"python"}))


@pytest.mark.parametrize("page", PAGES, ids=ids)
def test_every_block_says_what_it_is(page):
    """So that none is left out by a misspelling: ``py`` and ``pycon`` are refused."""
    known = {"python"} | SHELL | SHOWN
    odd = [f"line {b.line}: {b.language!r}" for b in blocks(page) if b.language not in known]
    assert not odd, f"{page.name}: unknown language of a block: {odd}; known: {sorted(known)}"


@pytest.mark.parametrize("page", marked(named({"python"})), ids=ids)
def test_the_python_of_a_page_runs_as_printed(page, tmp_path, monkeypatch, capsys):
    """One namespace a page, from the top, as a reader would type it.

    A block of text that follows at once is what it prints.
    """
    monkeypatch.chdir(tmp_path)
    save_files(page, tmp_path)
    namespace: dict[str, object] = {"__name__": "__tutorial__"}
    every = blocks(page)
    for block, after in zip(every, [*every[1:], None], strict=True):
        if block.language == "python":
            # blank lines put the traceback on the page's own lines
            code = compile("\n" * (block.line - 1) + block.text, str(page), "exec")
            exec(code, namespace)
            said = capsys.readouterr().out
            behind = block.line + block.text.count("\n") + 3  # fence, empty line, fence
            if after is not None and (after.language, after.line) == ("text", behind):
                assert said == after.text


@pytest.mark.parametrize("page", marked(named(SHELL)), ids=ids)
def test_the_commands_of_a_page_run_as_printed(page, tmp_path):
    save_files(page, tmp_path)
    lines = [
        line
        for block in blocks(page)
        if block.language in SHELL
        for line in block.text.replace("\\\n", " ").splitlines()
    ]
    for line in lines:
        words = shlex.split(line.removeprefix("$ "), comments=True)
        if not words or words[0] in SET_UP:
            continue
        assert words[0] == "gaitsmith", f"{page.name}: nobody runs {line!r}"
        command = [sys.executable, "-m", *words]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert run.returncode == 0, f"{page.name}: {line}\n{run.stderr}"


#: Commands within a line of text.
INLINE = re.compile(r"`((?:python -m )?gaitsmith [a-z][^`]*)`")


def test_commands_within_the_text_are_known():
    """Their words and options; what they are given is often a placeholder there."""
    known = {name: help_of(name) for name in COMMANDS}
    odd = []
    for page in PAGES:
        for command in INLINE.findall(page.read_text(encoding="utf-8")):
            name = command.removeprefix("python -m ").split()[1]
            options = re.findall(r"(?<![\w-])--[a-z][\w-]*", command)
            if name not in known:
                odd.append(f"{ids(page)}: {command}")
            else:
                odd += [f"{ids(page)}: {name} {o}" for o in options if o not in known[name]]
    assert not odd


def test_every_tutorial_and_page_is_in_the_navigation():
    """A page that nobody can reach is a page that nobody reads."""
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")}
    assert not sorted(page for page in pages if page not in nav)


def help_of(*words: str) -> str:
    command = [sys.executable, "-m", "gaitsmith", *words, "--help"]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return run.stdout


#: What ``gaitsmith --help`` names.
COMMANDS = ("demo", "walk", "learn", "compose", "convert", "measure", "list")


def suffixes() -> list[str]:
    """What ``gaitsmith list formats`` prints, less any words beside the suffixes."""
    command = [sys.executable, "-m", "gaitsmith", "list", "formats"]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return re.findall(r"(?<![\w.])\.[a-z][a-z0-9]+\b", run.stdout)


def test_the_reference_names_every_command_and_option():
    page = (DOCS / "reference" / "cli.md").read_text(encoding="utf-8")
    commands = re.findall(r"^ {2}(\w[\w-]*) ", help_of().split("Commands:")[1], re.MULTILINE)
    assert commands
    missing = [name for name in commands if f"## `gaitsmith {name}" not in page]
    for name in commands:
        options = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", help_of(name))) - {"--help"}
        missing += [f"{name} {option}" for option in sorted(options) if f"`{option}" not in page]
    assert not missing


def first_column(page: str, heading: str) -> set[str]:
    """Code words that start the rows of the tables under ``heading``."""
    text = (DOCS / "reference" / page).read_text(encoding="utf-8")
    section = text.split(f"\n## {heading}")[1].split("\n## ")[0]
    return set(re.findall(r"^\| `(\w+)`", section, re.MULTILINE))


def test_the_reference_has_the_keys_of_walk_json_and_of_its_npz(tmp_path):
    """Exactly the keys of the object; every key of the file (some files have fewer)."""
    command = [sys.executable, "-m", "gaitsmith", "walk", "--distance", "2", "--json"]
    target = tmp_path / "walk.npz"
    run = subprocess.run([*command, "-o", target], capture_output=True, text=True, check=True)
    assert set(json.loads(run.stdout)) == first_column("json.md", "`walk`")
    with np.load(target) as arrays:
        assert not set(arrays.files) - first_column("files.md", "`.npz`")


def test_the_reference_names_every_suffix():
    page = (DOCS / "reference" / "files.md").read_text(encoding="utf-8")
    known = suffixes()
    assert known
    assert not [suffix for suffix in known if f"| `{suffix}` |" not in page]


def test_the_reference_has_every_key_of_a_scene():
    from gaitsmith.scene import schema

    page = (DOCS / "reference" / "scenes.md").read_text(encoding="utf-8")
    tables = [getattr(schema, name) for name in vars(schema) if name.endswith("Table")]
    keys = {key for table in tables for key in table.model_fields}
    assert len(keys) > 30
    assert not sorted(k for k in keys if f"`{k}" not in page and f"`[[{k}]]`" not in page)


@pytest.mark.slow
def test_the_site_builds_and_asks_nobody_for_anything(tmp_path):
    """Strict, and without a script, style, font or picture from elsewhere."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", str(tmp_path)]
    subprocess.run(command, cwd=ROOT, check=True)
    pages = sorted(tmp_path.rglob("*.html"))
    assert pages
    fetched = re.compile(r'<(?:script|img|iframe|link)\b[^>]*\b(?:src|href)="?(?:https?:)?//[^>]*>')
    outside = {hit for page in pages for hit in fetched.findall(page.read_text("utf-8"))}
    styles = {s.name for s in tmp_path.rglob("*.css") if "url(http" in s.read_text("utf-8")}
    assert not outside
    assert not styles
