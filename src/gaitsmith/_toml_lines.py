"""TOML files, and which line of one says what: good enough for the place of an error."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from gaitsmith.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path

#: Keys and indices from the top of a document.
Place = tuple[str | int, ...]

_HEADER = re.compile(r"\s*(\[\[?)\s*([\w.\- ]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"\s*([\w-]+)\s*=(.*)$")


def read_toml(path: Path) -> tuple[str, dict[str, Any]]:
    """Text and content of a TOML file; FileFormatError if it is none."""
    import tomllib  # late: few files are read

    try:
        text = path.read_text(encoding="utf-8-sig")
        return text, tomllib.loads(text)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileFormatError(path, f"not a TOML file: {error}") from None
    except RecursionError:
        raise FileFormatError(path, "not a TOML file: nested too deep") from None


def lines_of(text: str) -> dict[Place, int]:
    """Line (from 1) of every table and key of a TOML document that stands on a line of its own.

    Keys within inline tables, quoted and dotted keys are not found: the line of what holds them
    is near enough.
    """
    found: dict[Place, int] = {}
    counts: dict[Place, int] = {}
    table: Place = ()
    quote: str | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        if quote is not None:
            quote = None if quote in line else quote
            continue
        header = _HEADER.match(line)
        if header:
            table = _table(header[2].split("."), header[1] == "[[", counts)
            found.setdefault(table, number)
            continue
        key = _KEY.match(line)
        if key:
            found.setdefault((*table, key[1]), number)
            for mark in ('"""', "'''"):
                if key[2].count(mark) == 1:
                    quote = mark
    return found


def _table(names: list[str], many: bool, counts: dict[Place, int]) -> Place:
    """Place of a header; the last of its arrays of tables is meant."""
    place: Place = ()
    for i, raw in enumerate(names):
        place = (*place, raw.strip())
        if many and i == len(names) - 1:
            counts[place] = counts.get(place, -1) + 1
        if place in counts:
            place = (*place, counts[place])
    return place


def line_at(place: Place, lines: dict[Place, int]) -> int | None:
    """Line of ``place``, or of the nearest table around it."""
    while place:
        if place in lines:
            return lines[place]
        place = place[:-1]
    return None
