"""Scenes from TOML files; all that is wrong in a file is said at once, with its place."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitsmith._toml_lines import Place, line_at, lines_of, read_toml
from gaitsmith.errors import FileFormatError, GaitsmithError
from gaitsmith.plan.surroundings import Surroundings
from gaitsmith.scene.model import Scene, Walker

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from gaitsmith.scene.schema import SceneTable, WalkerTable

#: Units of numbers, for what is said of wrong ones.
UNITS = {
    **dict.fromkeys(("distance", "step_length", "step_width", "height", "radius"), "meters"),
    **dict.fromkeys(("bottom", "top"), "meters"),
    **dict.fromkeys(("begin", "stand"), "seconds"),
    **dict.fromkeys(("facing", "face"), "degrees"),
    "speed": "meters per second",
    "cadence": "steps per minute",
}
#: Ways of saying where to walk.
WAYS = ("do", "path", "steps", "distance")


def read_scene(path: str | Path) -> Scene:
    """The scene in the TOML file at ``path``; :doc:`reference/scenes` has every key.

    Raises
    ------
    FileFormatError
        Naming everything that is wrong in the file, each with its line and place.
    OSError
        If the file cannot be opened.
    """
    path = Path(path)
    text, data = read_toml(path)
    reading = _Reading(path, data, lines_of(text))
    table = reading.table()
    if reading.problems or table is None:
        raise FileFormatError(path, reading.said())
    try:
        return _scene(table, path, reading.gaits)
    except GaitsmithError as error:
        raise FileFormatError(path, str(error)) from None


def _scene(table: SceneTable, path: Path, gaits: dict[str, Any]) -> Scene:
    alone = len(table.walker) == 1
    walkers = [
        _walker(walker, "walker" if alone else f"walker{i}", gaits)
        for i, walker in enumerate(table.walker, start=1)
    ]
    return Scene(
        walkers=tuple(walkers),
        surroundings=Surroundings(
            obstacles=tuple(item.built() for item in table.obstacle),
            bars=tuple(item.built() for item in table.bar),
            posts=tuple(item.built() for item in table.post),
        ),
        ground=table.ground,
        source=str(path),
    )


def _walker(table: WalkerTable, name: str, gaits: dict[str, Any]) -> Walker:
    given = {key: getattr(table, key) for key in table.model_fields_set}
    given["name"] = table.name or name
    if table.start is not None:
        given["start"] = table.start.start()
    if isinstance(table.do, list):
        given["do"] = [item if not hasattr(item, "read") else item.read() for item in table.do]
    return Walker(**given, gaits=gaits)


class _Reading:
    """One file while it is judged: what it says, and what is wrong in it."""

    def __init__(self, path: Path, data: dict[str, Any], lines: Mapping[Place, int]) -> None:
        self.path, self.data, self.lines = path, data, dict(lines)
        self.problems: list[tuple[int | None, str]] = []
        self.flat = "walker" not in data
        #: What the gaits mean that actions name.
        self.gaits: dict[str, Any] = {}

    def said(self) -> str:
        """All problems in the order of their lines."""
        ordered = sorted(self.problems, key=lambda p: (p[0] is None, p[0] or 0))
        return "; ".join(text for _, text in ordered)

    def table(self) -> SceneTable | None:
        """The file's tables, or None if they cannot be read."""
        from pydantic import ValidationError

        from gaitsmith.scene.schema import SceneTable, WalkerTable

        self.known = {
            "": (*SceneTable.model_fields, *(WalkerTable.model_fields if self.flat else ())),
        }
        data = self._unfolded(set(WalkerTable.model_fields))
        try:
            context = {"folder": self.path.parent, "gaits": self.gaits}
            table = SceneTable.model_validate(data, context=context)
        except ValidationError as error:
            table = None
            for e in error.errors(include_url=False):
                self._add(e["loc"], e["type"], e["msg"], e["input"], e.get("ctx", {}))
        self._check_walkers(data.get("walker"))
        return table

    def _unfolded(self, of_walker: set[str]) -> dict[str, Any]:
        """The data with its walkers in a list, where the file has one at its top."""
        mine = {key: self.data[key] for key in self.data if key in of_walker}
        rest = {key: self.data[key] for key in self.data if key not in of_walker}
        if self.flat:
            return {**rest, "walker": [mine]}
        for key in mine:
            self._say((key,), "belongs into a [[walker]] table, since the file has such tables")
        return rest

    def _check_walkers(self, walkers: object) -> None:
        """What one table alone cannot tell: ways to walk, names, places of paths."""
        seen: dict[str, int] = {}
        for i, walker in enumerate(walkers if isinstance(walkers, list) else []):
            if not isinstance(walker, dict):
                continue
            given = [way for way in WAYS if way in walker]
            if len(given) != 1:
                self._say(
                    ("walker", i),
                    f"say where to walk by one of {', '.join(WAYS)}, got "
                    + (" and ".join(given) if given else "none of them"),
                )
            elif given[0] in ("path", "steps") and "start" in walker:
                self._say(
                    ("walker", i, "start"),
                    f"{given[0]} says itself where it begins; leave out start, or use do",
                )
            name = str(walker.get("name", f"walker{i + 1}")).casefold()
            if seen.setdefault(name, i) != i:
                self._say(
                    ("walker", i, "name"),
                    f"walker {seen[name] + 1} has the same name {walker.get('name', name)!r}",
                )

    def _add(
        self, loc: Iterable[str | int], kind: str, message: str, value: object, more: dict[str, Any]
    ) -> None:
        """One problem as pydantic tells it."""
        from gaitsmith.scene.schema import TAGS

        place = tuple(part for part in loc if part not in TAGS)
        key = str(place[-1])
        unit = UNITS.get(key)
        of = f" of {unit}" if unit else ""
        units = f" {unit}" if unit else ""
        rule = {
            "greater_than": f"must be above {more.get('gt', 0):g}{units}",
            "greater_than_equal": f"must be at least {more.get('ge', 0):g}{units}",
            "less_than_equal": f"must be at most {more.get('le', 0):g}{units}",
            "finite_number": f"must be a finite number{of}",
            "float_type": f"must be a number{of}",
            "int_type": "must be a whole number",
            "string_type": "must be text",
            "bool_type": "must be true or false",
            "list_type": f"must be tables [[{key}]]",
            "model_type": "must be a table",
            "model_attributes_type": "must be a table",
        }.get(kind)
        if kind == "extra_forbidden":
            self._say(place, self._unknown(place))
        elif kind == "missing":
            self._say(place, "is missing")
        elif kind == "value_error":
            self._say(place, message.removeprefix("Value error, "))
        elif rule is not None:
            self._say(place, f"{rule}, got {value!r}")
        else:
            self._say(place, f"{message}, got {value!r}")

    def _unknown(self, place: Place) -> str:
        """What to say about a key that is not known."""
        from gaitsmith.scene import schema

        tables = {
            "walker": schema.WalkerTable,
            "start": schema.StartTable,
            "do": schema.DoTable,
            "obstacle": schema.ObstacleTable,
            "bar": schema.BarTable,
            "post": schema.PostTable,
        }
        home = next((str(p) for p in reversed(place[:-1]) if isinstance(p, str)), "")
        known = tuple(tables[home].model_fields) if home in tables else self.known[""]
        close = get_close_matches(str(place[-1]).lower(), known, n=1, cutoff=0.4)
        hint = f"did you mean {close[0]!r}?" if close else f"known: {', '.join(known)}"
        return f"unknown key, {hint}"

    def _say(self, place: Place, what: str) -> None:
        """Note a problem with its line and its place in words."""
        shown = place[2:] if self.flat and place[:2] == ("walker", 0) else place
        line = line_at(shown, self.lines)
        words: list[str] = []
        for i, part in enumerate(shown):
            if isinstance(part, int):
                words[-1] += f" {part + 1}"
                if shown[:i] == ("walker",):
                    words[-1] += self._named(part)
            else:
                words.append(part)
        where = ", ".join(words)
        at = "" if line is None else f"line {line}: "
        self.problems.append((line, f"{at}{where}: {what}" if where else f"{at}{what}"))

    def _named(self, index: int) -> str:
        """The name of a walker, if it has one."""
        walkers = self.data.get("walker")
        if isinstance(walkers, list) and index < len(walkers) and isinstance(walkers[index], dict):
            name = walkers[index].get("name")
            return f" ({name})" if isinstance(name, str) else ""
        return ""
