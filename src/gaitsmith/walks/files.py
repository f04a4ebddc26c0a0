"""Walk data as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.body.files import body_from_dict, body_to_dict
from gaitsmith.errors import FileFormatError
from gaitsmith.walks.data import Character, TimedSequence, WalkData

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = "gaitsmith-walk-data-1"
#: Digits kept after the point: a micrometer and a tenth of an arc second.
_DIGITS = 7


def walk_data_to_dict(walk: WalkData) -> dict[str, Any]:
    """``walk`` as plain JSON: meters, radians, step-normalised time, rounded."""

    def rounded(value: Any) -> Any:
        return np.round(np.asarray(value), _DIGITS).tolist()

    events = ("flat", "heel_off", "meta_off", "toe_off")
    return {
        "previous_length": rounded(walk.previous_length),
        "length": rounded(walk.length),
        "character": {k: rounded(v) for k, v in asdict(walk.character).items()},
        "events": {name: rounded(getattr(walk, name)) for name in events},
        "body": body_to_dict(walk.body),
        "sequences": {
            name: {"times": rounded(s.times), "values": rounded(s.values)}
            for name, s in walk.sequences.items()
        },
    }


def rounded_walk_data(walk: WalkData) -> WalkData:
    """``walk`` as :func:`walk_data_from_dict` will find it in a file."""

    def number(value: Any) -> float:
        return float(np.round(value, _DIGITS))

    def rounded(sequence: TimedSequence) -> TimedSequence:
        times, values = (np.round(v, _DIGITS) for v in (sequence.times, sequence.values))
        return TimedSequence(times, values)

    events = ("flat", "heel_off", "meta_off", "toe_off")
    character = {
        name: tuple(number(v) for v in value) if isinstance(value, tuple) else number(value)
        for name, value in asdict(walk.character).items()
    }
    return replace(
        walk,
        previous_length=number(walk.previous_length),
        length=number(walk.length),
        character=Character(**character),  # type: ignore[arg-type]
        **{name: number(getattr(walk, name)) for name in events},
        **{name: rounded(sequence) for name, sequence in walk.sequences.items()},  # type: ignore[arg-type]
    )


def walk_data_from_dict(data: dict[str, Any]) -> WalkData:
    """The walk data that :func:`walk_data_to_dict` wrote; KeyError, TypeError if it is none."""
    character = dict(data["character"])
    for name in ("gains", "hip"):
        if name in character:
            character[name] = tuple(character[name])
    fields: dict[str, Any] = dict(data["events"])
    for name, s in data["sequences"].items():
        fields[name] = TimedSequence(np.array(s["times"]), np.array(s["values"]))
    return WalkData(
        body=body_from_dict(data["body"]),
        previous_length=data["previous_length"],
        length=data["length"],
        character=Character(**character),
        **fields,
    )


def write_walk_data(walk: WalkData, path: Path, *, source: str, step_time: float) -> None:
    """Write ``walk`` as JSON: meters, radians, step-normalised time; ``step_time`` in seconds."""
    data: dict[str, Any] = {
        "format": FORMAT,
        "source": source,
        "step_time": round(step_time, _DIGITS),
        **walk_data_to_dict(walk),
    }
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in data.items()]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8", newline="\n")


def read_walk_data(path: Path) -> WalkData:
    """Walk data of a file; FileFormatError if it is not one."""
    return walk_data_from_json(path.read_text(encoding="utf-8"), path)


def walk_data_from_json(text: str, path: object = "walk data") -> WalkData:
    """Walk data of a JSON text; ``path`` is what errors call it."""
    try:
        data = json.loads(text)
        if data["format"] != FORMAT:
            raise FileFormatError(path, f"format is {data['format']!r}, not {FORMAT!r}")
        return walk_data_from_dict(data)
    except (json.JSONDecodeError, KeyError, TypeError) as error:
        raise FileFormatError(path, f"not walk data: {error}") from None


def built_in(name: str) -> WalkData:
    """Walk data that ship with the package, by file name without suffix."""
    text = files("gaitsmith.data").joinpath(f"{name}.json").read_text(encoding="utf-8")
    return walk_data_from_json(text, f"{name}.json")
