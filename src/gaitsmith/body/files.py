"""Bodies from and to files: TOML that people write, plain JSON in recipes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.proportions import SHORTEST, TALLEST, body_from_height, height_from_leg
from gaitsmith.errors import FileFormatError, InvalidInputError, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pydantic import BaseModel

_FOOT_KEYS = tuple(f.name for f in fields(Foot))
_BODY_KEYS = tuple(f.name for f in fields(Body))


def body_to_dict(body: Body) -> dict[str, Any]:
    """``body`` as plain JSON: numbers, strings and one inner object ``foot``.

    ``body_from_dict(json.loads(json.dumps(body_to_dict(body)))) == body``, to the last bit.
    """
    out: dict[str, Any] = {name: getattr(body, name) for name in _BODY_KEYS}
    out["foot"] = {name: getattr(body.foot, name) for name in _FOOT_KEYS}
    return out


def body_from_dict(data: Mapping[str, Any]) -> Body:
    """The body that :func:`body_to_dict` wrote.

    Raises
    ------
    InvalidInputError
        If a key is missing or unknown (all of them named), or the values are no body.
    """
    if not isinstance(data, Mapping) or not isinstance(data.get("foot"), Mapping):
        raise InvalidInputError(f"a body must be an object with a 'foot' object, got {data!r}")
    foot = data["foot"]
    wrong = [*_wrong_keys(data, Body, ""), *_wrong_keys(foot, Foot, "foot.")]
    if wrong:
        raise InvalidInputError("not a body: " + "; ".join(wrong))
    values: dict[str, Any] = {**data, "foot": Foot(**foot)}
    return Body(**values)


def _wrong_keys(data: Mapping[str, Any], kind: type[Body] | type[Foot], where: str) -> list[str]:
    known = {f.name: f.default is MISSING for f in fields(kind)}
    missing = [
        f"{where}{k}: missing" for k, required in known.items() if required and k not in data
    ]
    return missing + [_unknown(where, str(k), known) for k in data if k not in known]


def _unknown(where: str, key: str, known: Iterable[str]) -> str:
    """What to say about a key that is not known."""
    known = list(known)
    close = nearest(key, known, cutoff=0.4)
    hint = f"did you mean {where + close!r}?" if close else f"known: {', '.join(known)}"
    return f"{where}{key}: unknown key, {hint}"


def body_from_toml(path: str | Path) -> Body:
    """Body from a TOML file of measures in meters and kilograms.

    .. code-block:: toml

        name = "Ada"
        height = 1.68          # or thigh and shin
        thigh = 0.40
        mass = 61
        spine_segments = 3
        [foot]
        ankle_height = 0.07

    Keys are those of :class:`~gaitsmith.body.body.Body` and, in ``[foot]``, of
    :class:`~gaitsmith.body.body.Foot`. What the file does not say is taken from
    :func:`~gaitsmith.body.proportions.body_from_height`; a measure does not change the others.
    Without ``height``, thigh and shin tell it: that of the body whose legs are so long, to
    which all measures then add up.

    Raises
    ------
    FileFormatError
        If the file cannot be read, is not TOML, has unknown keys or impossible values. All
        that is wrong is named at once.
    """
    import tomllib

    path = Path(path)
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileFormatError(path, f"cannot be read: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileFormatError(path, f"not a TOML file: {error}") from None
    given = _checked(path, data)
    try:
        return _completed(given, fallback_name=path.stem)
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def _completed(given: dict[str, Any], *, fallback_name: str) -> Body:
    """Body of the measures ``given``, the rest from its height."""
    foot = given.pop("foot", {})
    height = given.pop("height", None)
    guessed = height is None
    if guessed:
        height = height_from_leg(given["thigh"] + given["shin"])
    base = body_from_height(height, spine_segments=given.get("spine_segments", 3))
    values: dict[str, Any] = {"name": fallback_name, **given, "foot": replace(base.foot, **foot)}
    if guessed:
        stacked = {**body_to_dict(base), **values}
        parts = sum(float(stacked[k]) for k in ("thigh", "shin", "trunk", "neck", "head"))
        values["height"] = values["foot"].ankle_height + parts
    return replace(base, **values)


def _checked(path: Path, data: dict[str, Any]) -> dict[str, Any]:
    """``data`` if every key and value is allowed by itself; else one error that names all."""
    from pydantic import ValidationError

    problems: list[str] = []
    try:
        _model().model_validate(data)
    except ValidationError as error:
        problems = [
            _problem(e["loc"], e["type"], e["msg"], e["input"], e.get("ctx", {}))
            for e in error.errors()
        ]
    if "height" not in data and not {"thigh", "shin"} <= data.keys():
        problems.append("height: missing (needed unless thigh and shin are both given)")
    if problems:
        raise FileFormatError(path, "; ".join(problems))
    # pydantic has judged; integers become floats in Body
    return dict(data)


def _problem(
    place: Sequence[str | int], kind: str, message: str, value: object, context: Mapping[str, Any]
) -> str:
    """One thing wrong in a file: key, rule, value."""
    *table, key = map(str, place)
    where = "".join(f"{t}." for t in table)
    if kind == "extra_forbidden":
        return _unknown(where, key, _FOOT_KEYS if table else _BODY_KEYS)
    unit = {"mass": "kilograms", "spine_segments": "joints"}.get(key, "meters")
    rule = {
        "greater_than": f"must be a positive number of {unit}",
        "greater_than_equal": f"must be at least {context.get('ge')} {unit}",
        "less_than_equal": f"must be at most {context.get('le')} {unit}",
        "finite_number": f"must be a finite number of {unit}",
        "float_type": f"must be a number of {unit}",
        "int_type": f"must be a whole number of {unit}",
        "string_type": "must be a string",
        "model_type": "must be a table, [foot]",
    }.get(kind, message)
    return f"{where}{key}: {rule}, got {value!r}"


def _model() -> type[BaseModel]:
    """The pydantic model of a body file: every key optional, judged by itself."""
    from pydantic import ConfigDict, Field, create_model

    strict = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
    length = (float | None, Field(default=None, gt=0.0))
    foot_fields: dict[str, Any] = dict.fromkeys(_FOOT_KEYS, length)
    foot_fields["toe_joint_height"] = (float | None, Field(default=None, ge=0.0))
    foot = create_model("FootFile", __config__=strict, **foot_fields)
    body_fields: dict[str, Any] = dict.fromkeys(_BODY_KEYS, length)
    body_fields |= {
        "name": (str | None, None),
        "foot": (foot | None, None),
        "height": (float | None, Field(default=None, ge=SHORTEST, le=TALLEST)),
        "spine_segments": (int | None, Field(default=None, ge=1, le=40)),
    }
    return create_model("BodyFile", __config__=strict, **body_fields)
