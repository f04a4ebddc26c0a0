"""Recipes to ways of walking: what ``compose`` does."""

from __future__ import annotations

import re
import warnings
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitsmith.errors import (
    FileFormatError,
    GaitsmithError,
    GaitsmithWarning,
    InfeasibleError,
    InvalidInputError,
)
from gaitsmith.learning import CLIPS, body_of, learn
from gaitsmith.style.composition import at_other_lengths, composition
from gaitsmith.style.examples import Examples, examples_of
from gaitsmith.style.recipe import (
    Recipe,
    Style,
    read_recipe,
    recipe_from_dict,
    recipe_to_dict,
)
from gaitsmith.style.restyle import rule_gait
from gaitsmith.style.rules import RULES
from gaitsmith.walks.learned import (
    SUFFIX,
    LearnedGait,
    gait_of_cycle,
    grounded,
    read_gait,
    said_of,
    with_others,
)
from gaitsmith.walks.stride import stride_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle

#: Licenses that forbid selling, however they say it.
NON_COMMERCIAL = re.compile(r"non[\s-]?commercial|\bNC\b|\bBY-NC", re.IGNORECASE)
UNKNOWN = "unknown license"


def compose(
    recipe: str | Path | Mapping[str, Any] | Recipe,
    *,
    styles: Mapping[str, str | Path | LearnedGait] | None = None,
    name: str | None = None,
) -> LearnedGait:
    """The gait that ``recipe`` mixes, ready to be walked by any body.

    Parameters
    ----------
    recipe
        A TOML file, what it would hold, or a :class:`~gaitsmith.style.recipe.Recipe`;
        ``docs/styles.md`` explains every key.
    styles
        Walks by the names that the recipe uses, instead of or besides its own ``[styles]``:
        names of built-in styles, gait files, clips, or gaits that were learned.
    name
        What to call the gait, instead of what the recipe says.

    Returns
    -------
    A gait whose ``recipe`` records the weights and every source with its license, and whose
    license says what may be done with all of them together.

    Raises
    ------
    InvalidInputError
        If the recipe makes no sense; names all that is wrong at once.
    FileFormatError, OSError
        If a file cannot be read.
    InfeasibleError
        If a walk shows no whole body, or the mix does not walk.

    Warns
    -----
    GaitsmithWarning
        Where weights leave what walks like its examples.

    Examples
    --------
    >>> gait = compose({
    ...     "styles": {"a": "sad", "b": "happy"},
    ...     "root": {"weights": {"a": 0.5, "b": 0.5}},
    ... })
    >>> 0.85 < gait.cycle.speed < 1.55
    True
    """
    given = dict(styles or {})
    if isinstance(recipe, str | Path):
        path = Path(recipe)
        asked = read_recipe(path) if not given else _read_with(path, given)
        try:
            return _composed(asked, given, path.parent, name)
        except InvalidInputError as error:  # what is wrong is in the file
            raise FileFormatError(path, str(error)) from None
    if not isinstance(recipe, Recipe):
        recipe = recipe_from_dict(_with_styles(recipe, given))
    return _composed(recipe, given, Path(), name)


def _composed(
    asked: Recipe,
    given: Mapping[str, str | Path | LearnedGait],
    base: Path,
    name: str | None,
) -> LearnedGait:
    gaits = _gaits(asked, given, base)
    body = gaits[asked.input].body if asked.body is None else body_of(_beside(asked.body, base))
    examples = _ready(tuple(gaits), tuple(g.cycle for g in gaits.values()), body)
    found = composition(examples, asked.mix)
    for note in found.notes:
        if not note.startswith("leg weights"):
            warnings.warn(note, GaitsmithWarning, stacklevel=3)
    sources = [_source_of(n, asked.styles.get(n), g) for n, g in gaits.items()]
    title = name or asked.name
    said = {
        "source": "composed of " + ", ".join(s["name"] for s in sources),
        "license": license_of([s["license"] for s in sources]),
    }
    gait = gait_of_cycle(
        found.cycle.with_(**said),
        body,
        name=title,
        notes=found.notes,
        feet=found.feet,
        recipe={**recipe_to_dict(asked), "name": title, "sources": sources},
    )
    if not any(source.others for source in gaits.values()):
        return gait
    leveled = ((g.cycle, *(other.cycle for other in g.others)) for g in gaits.values())
    others = at_other_lengths(examples, asked.mix, dict(zip(gaits, leveled, strict=True)))
    brought = (grounded(mix.cycle.with_(**said), mix.feet) for mix in others)
    return with_others(gait, [stride_of(cycle, body, feet) for cycle, feet in brought])


@lru_cache(8)
def _ready(names: tuple[str, ...], cycles: tuple[Cycle, ...], body: Body) -> Examples:
    """Examples that were mixed just now are mixed again: a recipe is tuned by trying."""
    return examples_of(dict(zip(names, cycles, strict=True)), body)


def _with_styles(
    data: Mapping[str, Any], given: Mapping[str, str | Path | LearnedGait]
) -> dict[str, Any]:
    """``data`` with the names of ``given`` among its styles; what they are is not in the data."""
    own = data.get("styles", {})
    if not isinstance(own, dict):
        return dict(data)
    named = {n: v if isinstance(v, str) else getattr(v, "name", str(v)) for n, v in given.items()}
    return {**data, "styles": {**own, **named}}


def _read_with(path: Path, given: Mapping[str, str | Path | LearnedGait]) -> Recipe:
    import tomllib

    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        return recipe_from_dict(_with_styles(data, given), name=path.stem)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, InvalidInputError) as error:
        raise FileFormatError(path, str(error)) from None


def _gaits(
    recipe: Recipe, given: Mapping[str, str | Path | LearnedGait], base: Path
) -> dict[str, LearnedGait]:
    """The walks of a recipe, learned or read; all that cannot be is named at once."""
    out: dict[str, LearnedGait] = {}
    wrong: list[str] = []
    kind: type[GaitsmithError] = InvalidInputError
    for name in recipe.styles:
        value = given.get(name)
        try:
            if isinstance(value, LearnedGait):
                out[name] = value
            elif value is not None:
                out[name] = _gait(Style(str(value)), Path())
            else:
                out[name] = _gait(recipe.styles[name], base)
            if out[name].upper_body != "measured":
                raise InfeasibleError(
                    "it lacks the arms (UpperArm, LowerArm, Hand of both sides); styles are mixed "
                    "of whole bodies"
                )
        except InvalidInputError as error:
            wrong.append(f"style {name!r}: {error}")
        except GaitsmithError as error:
            wrong.append(f"style {name!r}: {error}")
            kind = InfeasibleError
        except OSError as error:
            wrong.append(f"style {name!r}: {error.filename}: {(error.strerror or '').lower()}")
            kind = InfeasibleError
    if wrong:
        raise kind("; ".join(wrong))
    return out


def _gait(style: Style, base: Path) -> LearnedGait:
    spec = style.spec
    if spec in RULES or spec == "neutral":
        gait = rule_gait(spec)
    elif spec.lower().endswith((SUFFIX, ".json")):
        gait = read_gait(base / spec)
    elif Path(spec).suffix.lower() in CLIPS:
        return learn(
            base / spec,
            unit=style.unit,
            symmetric=style.symmetric,
            license=style.license or "",
            source=style.source,
        )
    else:
        known = ", ".join(sorted([*RULES, "neutral"]))
        raise InvalidInputError(
            f"{spec!r} is neither a built-in style ({known}), nor a gait file (*{SUFFIX}), nor a "
            f"clip ({', '.join(CLIPS)})"
        )
    return said_of(gait, license=style.license, source=style.source)


def _beside(body: str | float, base: Path) -> str | float | Path:
    if isinstance(body, str) and Path(body).suffix:
        return base / body
    return body


def _source_of(name: str, style: Style | None, gait: LearnedGait) -> dict[str, str]:
    """One source of a composed gait, as its file records it."""
    spec = gait.clip or gait.name if style is None else style.spec
    return {
        "name": name,
        "from": Path(spec).name,
        "source": gait.cycle.source,
        "license": gait.cycle.license or UNKNOWN,
    }


def license_of(licenses: list[str]) -> str:
    """What may be done with a mix: all licenses, and that it is non-commercial if one is."""
    each = list(dict.fromkeys(licenses))
    if any(NON_COMMERCIAL.search(one) for one in each):
        return "non-commercial; a mix of: " + " | ".join(each)
    if len(each) == 1:
        return each[0]
    return "a mix of: " + " | ".join(each)
