"""A mix as a TOML file: which walks, which weights; and the recipes that [KN12] prints."""

from __future__ import annotations

from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from gaitsmith.errors import FileFormatError, InvalidInputError, UnknownNameError
from gaitsmith.style.parts import BOTH, PARTS
from gaitsmith.style.weights import BASES, ENGINES, LEGS, Mix, PartMix

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

_PARTS = (*PARTS, *BOTH)
_TOP = ("name", "paper", "input", "body", "speed", "engine", "base", "symmetric", "styles", "root")
_STYLE = ("from", "unit", "license", "source", "symmetric")


@dataclass(frozen=True)
class Style:
    """One walk that goes into a mix.

    Attributes
    ----------
    spec
        Name of a built-in gait, a gait file, or a clip to learn from.
    unit, license, source, symmetric
        As :func:`gaitsmith.learning.learn` takes them, for clips; ``license`` and ``source`` also
        replace what a gait file says.
    """

    spec: str
    unit: str | None = None
    license: str | None = None
    source: str | None = None
    symmetric: bool = False


@dataclass(frozen=True)
class Recipe:
    """A mix and the walks that it takes.

    Attributes
    ----------
    name
        Of the gait that it makes.
    styles
        Walks by the name that the weights use. All of them make the mean that weights are about,
        and lend their components to legs that are found, with a weight or without.
    mix
        The weights.
    input
        Whose body the result has, a name in ``styles``; the first of the root's by default.
    body
        A body instead: height, name or file.
    """

    name: str
    styles: Mapping[str, Style]
    mix: Mix
    input: str = ""
    body: str | float | None = None
    paper: str = field(default="")


def paper_recipes() -> dict[str, dict[str, Any]]:
    """The recipes of [KN12] Table 3 and Figure 5 by name, as a recipe file would hold them."""
    import tomllib

    text = files("gaitsmith.data").joinpath("kn12_recipes.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def read_recipe(path: Path) -> Recipe:
    """The recipe in a TOML file; what a relative path in it names is beside it.

    Raises
    ------
    FileFormatError
        If it is no recipe; all that is wrong is named at once.
    OSError
        If it cannot be opened.
    """
    import tomllib

    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileFormatError(path, f"not a TOML file: {error}") from None
    try:
        return recipe_from_dict(data, name=path.stem)
    except UnknownNameError as error:
        raise FileFormatError(path, str(error)) from None
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def recipe_from_dict(data: Mapping[str, Any], *, name: str = "mix") -> Recipe:
    """A recipe from what its TOML holds; InvalidInputError names all that is wrong."""
    wrong: list[str] = []
    whole = dict(data)
    if "paper" in whole:
        whole = _with_paper(whole, wrong)
    wrong += _unknown_keys("", whole, (*_TOP, *_PARTS, "about"))
    styles = _styles(whole.get("styles", {}), wrong)
    root = _table("root", whole.get("root", {}), wrong)
    wrong += _unknown_keys("root.", root, ("weights", "offsets"))
    parts: dict[str, PartMix] = {}
    for part in _PARTS:
        if part in whole:
            parts[part] = _part(part, whole[part], wrong)
    legs = _found(whole.get("legs", {}), wrong)
    mix: Mix | None = None
    try:
        mix = Mix(
            root=_table("root.weights", root.get("weights", {}), wrong),
            offsets=_table("root.offsets", root["offsets"], wrong) if "offsets" in root else None,
            parts=parts,
            speed=whole.get("speed"),
            engine=_word("engine", whole.get("engine", "dense"), ENGINES, wrong),
            base=_word("base", whole.get("base", "cubic"), BASES, wrong),
            legs=legs,
            symmetric=_flag("symmetric", whole.get("symmetric", False), wrong),
        )
    except InvalidInputError as error:
        wrong.append(str(error))
    who = str(whole.get("input", ""))
    if mix is not None:
        wrong += _unmapped(mix, who, styles)
    if wrong or mix is None:
        raise InvalidInputError("; ".join(dict.fromkeys(wrong)))
    return Recipe(
        name=str(whole.get("name", name)),
        styles=styles,
        mix=mix,
        input=who or next(iter(mix.root)),
        body=whole.get("body"),
        paper=str(whole.get("paper", "")),
    )


def _with_paper(data: dict[str, Any], wrong: list[str]) -> dict[str, Any]:
    """A recipe of the paper, with what the file itself says instead or besides."""
    known, asked = paper_recipes(), str(data["paper"])
    if asked not in known:
        wrong.append(f"paper: {UnknownNameError('recipe of the paper', asked, known)}")
        return data
    return {"name": asked, **known[asked], **data}


def _styles(table: Any, wrong: list[str]) -> dict[str, Style]:
    out: dict[str, Style] = {}
    for name, value in _table("styles", table, wrong).items():
        if isinstance(value, str):
            out[name] = Style(value)
            continue
        if not isinstance(value, dict) or not isinstance(value.get("from"), str):
            said = repr(value) if isinstance(value, dict | int | float) else type(value).__name__
            wrong.append(
                f"styles.{name} must be the name of a gait, a file, or a table with 'from', got "
                f"{said}; gaits themselves are given as styles={{name: gait}}"
            )
            continue
        wrong += _unknown_keys(f"styles.{name}.", value, _STYLE)
        texts = {}
        for key in ("unit", "license", "source"):
            if key in value and not isinstance(value[key], str):
                wrong.append(f"styles.{name}.{key} must be text, got {value[key]!r}")
            elif key in value:
                texts[key] = value[key]
        even = _flag(f"styles.{name}.symmetric", value.get("symmetric", False), wrong)
        out[name] = Style(value["from"], symmetric=even, **texts)
    return out


def _part(part: str, table: Any, wrong: list[str]) -> PartMix:
    held = _table(part, table, wrong)
    more = ("find",) if part == "legs" else ()
    wrong += _unknown_keys(f"{part}.", held, ("weights", "offset_scale", *more))
    if "weights" not in held:
        wrong.append(f"{part}.weights: missing")
    weights = _table(f"{part}.weights", held.get("weights", {}), wrong)
    lists = {n: tuple(v) if isinstance(v, list) else v for n, v in weights.items()}
    return PartMix(lists, held.get("offset_scale", 1.0))


def _found(table: Any, wrong: list[str]) -> str:
    if not isinstance(table, dict):
        return "given"
    return _word("legs.find", table.get("find", "given"), LEGS, wrong)


def _unmapped(mix: Mix, who: str, styles: Mapping[str, Style]) -> Iterator[str]:
    """Names that weights use and no style has."""
    used: list[str] = [*mix.named, who] if who else list(mix.named)
    for name in dict.fromkeys(used):
        if name not in styles:
            known = ", ".join(styles) or "none"
            close = get_close_matches(name, styles, n=1)
            hint = f", did you mean {close[0]!r}?" if close else ""
            yield (
                f"{name!r} is used but not in [styles] (there: {known}): say which walk it is{hint}"
            )


def _table(where: str, value: Any, wrong: list[str]) -> dict[str, Any]:
    if isinstance(value, dict):
        return value
    wrong.append(f"{where} must be a table, got {value!r}")
    return {}


def _word(where: str, value: Any, allowed: tuple[str, ...], wrong: list[str]) -> str:
    if value in allowed:
        return str(value)
    wrong.append(f"{where} must be one of {', '.join(allowed)}, got {value!r}")
    return allowed[0]


def _flag(where: str, value: Any, wrong: list[str]) -> bool:
    if not isinstance(value, bool):
        wrong.append(f"{where} must be true or false, got {value!r}")
    return bool(value)


def _unknown_keys(where: str, table: Mapping[str, Any], known: Iterable[str]) -> list[str]:
    names = list(known)
    out = []
    for key in table:
        if key not in names:
            close = get_close_matches(key, names, n=1, cutoff=0.5)
            hint = f"did you mean {close[0]!r}?" if close else f"known: {', '.join(names)}"
            out.append(f"{where}{key}: unknown key, {hint}")
    return out


def recipe_to_dict(recipe: Recipe) -> dict[str, Any]:
    """What a composed gait file records of ``recipe``: plain JSON, all defaults written out."""
    mix = recipe.mix
    parts = {
        part: {
            "weights": {n: list(v) if isinstance(v, tuple) else v for n, v in m.weights.items()},
            "offset_scale": m.offset_scale,
        }
        for part, m in mix.parts.items()
    }
    root: dict[str, Any] = {"weights": dict(mix.root)}
    if mix.offsets is not None:
        root["offsets"] = dict(mix.offsets)
    return {
        "name": recipe.name,
        **({"paper": recipe.paper} if recipe.paper else {}),
        "input": recipe.input,
        **({"body": recipe.body} if recipe.body is not None else {}),
        **({"speed": mix.speed} if mix.speed is not None else {}),
        "engine": mix.engine,
        "base": mix.base,
        "symmetric": mix.symmetric,
        "find_legs": mix.legs,
        "root": root,
        **parts,
    }
