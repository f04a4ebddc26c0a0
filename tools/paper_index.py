"""Write ``docs/papers/index.md``: which code serves which equation, from the docstrings.

``python tools/paper_index.py`` writes the page, ``--check`` fails if it is stale. Only
citations with a place count, such as ``[KB92b] Eqs. 5-6`` or ``[KB93] section 2 and Fig. 3``;
code that cites a paper without a place is listed under it by name alone.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "gaitsmith"
PAGE = ROOT / "docs" / "papers" / "index.md"

PAPERS = {
    "KB92b": "Ko & Badler 1992, *Straight Line Walking Animation Based on Kinematic "
    "Generalization that Preserves the Original Characteristics*, MS-CIS-92-79",
    "KB92a": "Ko & Badler 1992, *Curved Path Walking*, MS-CIS-92-02",
    "KB93": "Ko & Badler 1993, *Intermittent Non-Rhythmic Human Stepping and Locomotion*, "
    "MS-CIS-93-55",
    "SM01": "Sun & Metaxas 2001, *Automating Gait Generation*, SIGGRAPH",
    "KN12": "Kim & Neff 2012, *Component-based Locomotion Composition*, SCA",
}
#: Modules that list the papers and serve none.
NOT_SERVING = frozenset({"gaitsmith.conventions"})
#: Places in a paper in the order of the page: how it is printed, how it is cited.
KINDS = (
    ("Eq.", r"Eqs?\.|[Ee]quations?"),
    ("Section", r"[Ss]ections?|[Ss]ecs?\.|§"),
    ("Theorem", r"[Tt]heorems?"),
    ("Lemma", r"[Ll]emmas?"),
    ("Corollary", r"[Cc]orollar(?:y|ies)"),
    ("Figure", r"[Ff]igures?|[Ff]igs?\."),
    ("Table", r"[Tt]ables?"),
    ("Appendix", r"[Aa]ppendix|[Aa]ppendices"),
)

CITATION = re.compile(r"\[([A-Z]{2}\d{2}[a-z]?)\]")
_NUMBER = r"\(?(?:[A-Z]\.)?\d+[a-z]?(?:\.\d+)*\)?"
_NUMBERS = rf"{_NUMBER}(?:(?:\s*[-\u2013]\s*|\s*,\s*(?:and\s+)?|\s+and\s+|\s+to\s+){_NUMBER})*"
_JOIN = r"(?:[\s,;:]+(?:and\s+)?|^)"
PLACES = tuple((name, re.compile(rf"{_JOIN}(?:{words})\s*({_NUMBERS})")) for name, words in KINDS)


class UnknownPaperError(Exception):
    """A docstring cites a key that is not one of :data:`PAPERS`."""


@dataclass(frozen=True, order=True)
class Citation:
    """One place in a paper and the code that serves it; sorts as the page does."""

    kind: int
    numbers: tuple[tuple[int, str], ...]
    place: str
    code: str


@dataclass
class Cited:
    """What the code says about one paper."""

    placed: set[Citation] = field(default_factory=set)
    bare: set[str] = field(default_factory=set)


def places(text: str) -> list[tuple[int, str]]:
    """Read the places at the start of ``text``, up to the first word that is none.

    >>> places(" Eqs. 5, 6 and section 2.3 say so")
    [(0, '5, 6'), (1, '2.3')]
    >>> places(", as everybody knows since Eq. 4")
    []
    """
    found: list[tuple[int, str]] = []
    while True:
        for kind, (_, pattern) in enumerate(PLACES):
            if match := pattern.match(text):
                numbers = re.sub(r"[()]", "", " ".join(match[1].split()))
                numbers = re.sub(r",? and | ?, ?", ", ", numbers)
                found.append((kind, re.sub(r" ?[-\u2013] ?| to ", "-", numbers)))
                text = text[match.end() :]
                break
        else:
            return found


def natural(numbers: str) -> tuple[tuple[int, str], ...]:
    """Sort key that puts 9 before 10 and 5a after 5."""
    return tuple((int(n), letter) for n, letter in re.findall(r"(\d+)([a-z]?)", numbers))


def documented(tree: ast.Module, module: str) -> list[tuple[str, str]]:
    """Pairs of qualified name and docstring: the module, its classes, functions and methods."""
    found = [(module, ast.get_docstring(tree) or "")]
    waiting: list[tuple[str, ast.AST]] = [(module, tree)]
    while waiting:
        name, node = waiting.pop()
        for child in ast.iter_child_nodes(node):
            inner = name
            if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                inner = f"{name}.{child.name}"
                found.append((inner, ast.get_docstring(child) or ""))
            waiting.append((inner, child))
    return found


def index(source: Path) -> dict[str, Cited]:
    """Read the citations of every docstring under ``source``, a package folder."""
    found: dict[str, Cited] = defaultdict(Cited)
    for path in sorted(source.rglob("*.py")):
        parts = path.relative_to(source.parent).with_suffix("").parts
        module = ".".join(part for part in parts if part != "__init__")
        if module in NOT_SERVING:
            continue
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for name, doc in documented(tree, module):
            for cite in CITATION.finditer(doc):
                if cite[1] not in PAPERS:
                    known = ", ".join(PAPERS)
                    raise UnknownPaperError(f"{name} cites [{cite[1]}]; the papers are {known}")
                where = places(doc[cite.end() :])
                for kind, numbers in where:
                    found[cite[1]].placed.add(Citation(kind, natural(numbers), numbers, name))
                if not where:
                    found[cite[1]].bare.add(name)
    return found


def page(found: dict[str, Cited]) -> str:
    """Return the page as Markdown."""
    lines = [
        "<!-- Written by tools/paper_index.py from the docstrings; `make docs` renews it. -->",
        "",
        "# Papers",
        "",
        "What each paper gave, and which code serves which of its equations and sections. Where",
        "the code leaves a paper, [the errata](errata.md) say why.",
        "",
    ]
    for key, title in PAPERS.items():
        cited = found.get(key, Cited())
        lines += [f"## {key}", "", f"{title}. [What is implemented]({key.lower()}.md).", ""]
        if cited.placed:
            lines += ["| place | code |", "|---|---|"]
            for cite in sorted(cited.placed):
                lines.append(f"| {KINDS[cite.kind][0]} {cite.place} | `{cite.code}` |")
            lines.append("")
        bare = sorted(cited.bare - {cite.code for cite in cited.placed})
        if bare:
            names = ", ".join(f"`{name}`" for name in bare)
            lines += [f"Also cited by {names}.", ""]
        if not cited.placed and not bare:
            lines += ["No code cites it yet.", ""]
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Write the page, or with ``--check`` only compare; exit 1 if it is stale."""
    parser = argparse.ArgumentParser(description="index of citations in docstrings")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if stale")
    parser.add_argument("--source", type=Path, default=SOURCE, help="the package's folder")
    parser.add_argument("--page", type=Path, default=PAGE, help="the page to write")
    options = parser.parse_args(arguments)
    try:
        text = page(index(options.source))
    except UnknownPaperError as error:
        print(f"paper_index: {error}", file=sys.stderr)
        return 1
    if not options.check:
        options.page.write_text(text, encoding="utf-8")
        return 0
    if not options.page.exists() or options.page.read_text(encoding="utf-8") != text:
        name = options.page.name
        print(f"paper_index: {name} is stale: run tools/paper_index.py", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
