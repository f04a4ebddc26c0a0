"""Boxes on a ground, from a TOML file."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, TypeVar

from gaitsmith._toml_lines import line_at, lines_of, read_toml
from gaitsmith.errors import FileFormatError, GaitsmithError, InvalidInputError
from gaitsmith.ground.boxes import Box, Boxes

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from gaitsmith._toml_lines import Place
    from gaitsmith.ground.model import Ground

_T = TypeVar("_T")
#: Keys of the file and of a ``[[box]]``.
KEYS, BOX_KEYS = ("ground", "box"), ("points", "height", "name")


def read_boxes(path: Path, read_base: Callable[[str, Path], Ground]) -> Boxes:
    """The ground of a file with ``ground`` (``"flat"`` if not said) and ``[[box]]`` tables.

    ``read_base`` makes a ground of what the file says of it and of the folder it is in.

    Raises
    ------
    FileFormatError
        With everything that is wrong, each by line, table and key.
    """
    text, data = read_toml(path)
    problems = _Problems(lines_of(text))
    problems.unknown((), data, KEYS)
    base = problems.tried(("ground",), lambda: _base(data.get("ground", "flat"), path, read_base))
    tables = data.get("box", [])
    if not isinstance(tables, list) or not tables or not all(isinstance(t, dict) for t in tables):
        problems.add((), "needs boxes: tables [[box]] with points = [[x, z], ...] and height")
        tables = []
    boxes = []
    for i, table in enumerate(tables):
        problems.unknown(("box", i), table, BOX_KEYS)
        missing = [key for key in ("points", "height") if key not in table]
        for key in missing:
            problems.add(("box", i), f"{key} is missing")
        name = table.get("name", "box")
        if not isinstance(name, str) or not name:
            problems.add(("box", i, "name"), f"must be text, got {name!r}")
        if missing:
            continue
        place: Place = ("box", i, "points")
        if not _is_height(table["height"]):
            place = ("box", i, "height")
        boxes.append(problems.tried(place, lambda table=table: _box(table)))  # type: ignore[misc]
    if problems.found:
        raise FileFormatError(path, problems.said())
    assert base is not None
    try:
        return Boxes(base, tuple(box for box in boxes if box is not None))
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def _base(given: object, path: Path, read_base: Callable[[str, Path], Ground]) -> Ground:
    if not isinstance(given, str):
        raise InvalidInputError(f'must be text as in "slope:10", got {given!r}')
    return read_base(given, path.parent)


def _is_height(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        Box(((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), value)
    except InvalidInputError:
        return False
    return True


def _box(table: Mapping[str, Any]) -> Box:
    points, height = table["points"], table["height"]
    if isinstance(height, bool) or not isinstance(height, int | float):
        raise InvalidInputError(f"must be a number of meters, got {height!r}")
    if not isinstance(points, list) or not all(_is_point(p) for p in points):
        raise InvalidInputError(f"must be corners [[x, z], [x, z], ...], got {points!r}")
    return Box(tuple(tuple(p) for p in points), height)


def _is_point(value: object) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(isinstance(v, int | float) and not isinstance(v, bool) for v in value)
    )


class _Problems:
    """What is wrong in a file, by line."""

    def __init__(self, lines: Mapping[Place, int]) -> None:
        self.lines = dict(lines)
        self.found: list[tuple[int, str]] = []

    def add(self, place: Place, what: str) -> None:
        """Note what is wrong at ``place``."""
        words = [
            f"{part} {place[k + 1] + 1}" if part == "box" else str(part)  # type: ignore[operator]
            for k, part in enumerate(place)
            if not isinstance(part, int)
        ]
        line = line_at(place, self.lines)
        at = "" if line is None else f"line {line}: "
        where = f"{', '.join(words)}: " if words else ""
        self.found.append((line or 0, f"{at}{where}{what}"))

    def unknown(self, place: Place, table: Mapping[str, Any], known: tuple[str, ...]) -> None:
        """Note the keys of ``table`` that nobody knows."""
        for key in table:
            if key not in known:
                close = get_close_matches(str(key).lower(), known, n=1, cutoff=0.4)
                hint = f"did you mean {close[0]!r}?" if close else f"known: {', '.join(known)}"
                self.add((*place, key), f"unknown key, {hint}")

    def tried(self, place: Place, make: Callable[[], _T]) -> _T | None:
        """What ``make`` gives, or None and a note of why not."""
        try:
            return make()
        except GaitsmithError as error:
            self.add(place, str(error))
        except OSError as error:
            self.add(place, f"{error.filename}: {(error.strerror or str(error)).lower()}")
        return None

    def said(self) -> str:
        """All of it, in the order of the lines."""
        return "; ".join(text for _, text in sorted(self.found, key=lambda found: found[0]))
