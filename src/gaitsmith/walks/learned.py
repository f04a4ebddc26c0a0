"""A learned gait: a Cycle, the walk data of its legs, and where it came from; its JSON file."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith._version import __version__
from gaitsmith.body.files import body_from_dict, body_to_dict
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import SIDES
from gaitsmith.errors import FileFormatError, GaitsmithError, InvalidInputError
from gaitsmith.gait.cycle import EVENTS
from gaitsmith.gait.events import Stance
from gaitsmith.gait.learn import Learned, standing_feet
from gaitsmith.walks.stride import (
    GaitStride,
    number_of,
    rounded,
    stride_from_dict,
    stride_of,
    stride_to_dict,
)

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.gait.elevation import ElevationData
    from gaitsmith.gait.learn import Standing
    from gaitsmith.walks.data import WalkData

FORMAT = "gaitsmith-gait-1"
SUFFIX = ".gait.json"
#: Leg lengths that the steps of a gait's strides differ by at least.
APART = 0.03


@dataclass(frozen=True, eq=False)
class LearnedGait:
    """A person's walk, ready to be walked by any body.

    Attributes
    ----------
    name
        For people to read.
    body
        Who was measured.
    stride
        The usual one of the whole body (of the legs, where only they were measured).
    step_lengths
        Meters that the [left, right] foot lands ahead of the other.
    step_width
        Meters between the lines of left and right feet.
    toe_out
        Radians that [left, right] feet turn out.
    upper_body
        ``"measured"``, or ``"rules"`` where the clip shows no arms.
    clip
        Name of the file it was learned from; ``stances`` and ``span`` are seconds of it.
    notes
        What was done to the data and should be known.
    recipe
        What a composed gait was mixed from and how: plain JSON, see
        :func:`gaitsmith.composing.compose`. None for a gait that was learned.
    others
        Strides of the same person and style with other step lengths: steps are made of the two
        that are nearest in length.
    """

    name: str
    body: Body
    stride: GaitStride
    step_lengths: tuple[float, float]
    step_width: float
    toe_out: tuple[float, float]
    upper_body: str
    clip: str
    stances: tuple[Stance, ...]
    span: tuple[float, float]
    notes: tuple[str, ...]
    recipe: dict[str, Any] | None = None
    others: tuple[GaitStride, ...] = ()

    @property
    def strides(self) -> tuple[GaitStride, ...]:
        """All, the usual one first."""
        return (self.stride, *self.others)

    @property
    def cycle(self) -> Cycle:
        """Of the usual stride."""
        return self.stride.cycle

    @property
    def walk_data(self) -> tuple[WalkData, WalkData]:
        """Steps of the usual stride on the left and on the right foot."""
        return self.stride.walk_data

    @property
    def elevation(self) -> ElevationData:
        """Elevation angles of the legs in the usual stride."""
        return self.stride.elevation

    @property
    def cadence(self) -> float:
        """Steps per minute."""
        return 120.0 / self.cycle.duration


def learned_gait(
    found: Learned,
    *,
    name: str,
    clip: str = "",
    upper_body: str,
    recipe: dict[str, Any] | None = None,
    feet: Standing | None = None,
) -> LearnedGait:
    """The gait of a learned stride, exactly as its file will hold it.

    ``feet`` says how they stand in the stride, where that is known already.
    """
    stride = stride_of(found.cycle, found.body, feet)
    return LearnedGait(
        name=name,
        body=found.body,
        stride=stride,
        step_lengths=_filed(found.step_lengths),
        step_width=number_of(found.step_width),
        toe_out=_filed(found.toe_out, degrees=True),
        upper_body=upper_body,
        clip=clip,
        stances=tuple(Stance(s.side, *rounded(s.times).tolist(), cut=s.cut) for s in found.stances),
        span=_filed(found.span),
        notes=found.notes,
        recipe=recipe,
    )


def said_of(gait: LearnedGait, *, license: str | None, source: str | None) -> LearnedGait:
    """``gait`` with another license and source, where they are given."""
    said = {k: v for k, v in (("license", license), ("source", source)) if v is not None}
    if not said:
        return gait
    strides = [replace(s, cycle=s.cycle.with_(**said)) for s in gait.strides]
    return replace(gait, stride=strides[0], others=tuple(strides[1:]))


def with_others(gait: LearnedGait, strides: Iterable[GaitStride]) -> LearnedGait:
    """``gait`` with ``strides`` of the same person and style at other step lengths.

    What is nearer than :data:`APART` to one before it, or whose left and right steps are in
    another order, is left out, and ``notes`` say so.

    Raises
    ------
    InvalidInputError
        If a stride is of another body.
    """
    kept, notes = [gait.stride], list(gait.notes)
    for stride in strides:
        if stride.walk_data[0].body != gait.body:
            raise InvalidInputError("the strides of a gait must be of one body; see on_body")
        off = np.array([np.subtract(stride.ratios, other.ratios) for other in kept])
        if (np.abs(off) >= APART).all() and (off[:, 0] * off[:, 1] > 0.0).all():
            kept.append(stride)
        else:
            notes.append(
                f"a stride of {stride.cycle.stride_length:.2f} m left out: too near in length to "
                "another"
            )
    others = sorted(kept[1:], key=lambda stride: stride.cycle.stride_length)
    return replace(gait, others=tuple(others), notes=tuple(notes))


def _filed(pair: tuple[float, float], *, degrees: bool = False) -> tuple[float, float]:
    """Two numbers as a file will hold them."""
    if degrees:
        one, two = np.radians(rounded(np.degrees(pair)))
    else:
        one, two = rounded(pair)
    return float(one), float(two)


def grounded(cycle: Cycle, feet: Standing | None = None) -> tuple[Cycle, Standing]:
    """``cycle`` with its feet on the ground at both sides of the line it walks along."""
    feet = standing_feet(cycle) if feet is None else feet
    middle = 0.5 * (feet.place[0, 0] + feet.place[1, 0])
    by = -np.array([middle, feet.height, cycle.center[:, 2].mean()])
    return cycle.with_(center=cycle.center + by), feet.moved(by)


def gait_of_cycle(
    cycle: Cycle,
    body: Body,
    *,
    name: str,
    notes: tuple[str, ...] = (),
    recipe: dict[str, Any] | None = None,
    feet: Standing | None = None,
) -> LearnedGait:
    """The gait of a whole-body stride that was made and not learned from a clip.

    Its steps, its width and its toe-out are what its feet do; ``feet`` says how they stand, where
    that is known already.
    """
    cycle, feet = grounded(cycle, feet)
    ahead = float(feet.place[1, 1] - feet.place[0, 1])
    found = Learned(
        cycle=cycle,
        body=body,
        stances=(),
        span=(0.0, 0.0),
        step_lengths=(cycle.stride_length - ahead, ahead),
        step_width=float(feet.place[0, 0] - feet.place[1, 0]),
        toe_out=(float(feet.heading[0]), float(-feet.heading[1])),
        notes=notes,
    )
    return learned_gait(found, name=name, upper_body="measured", recipe=recipe, feet=feet)


def gait_to_dict(gait: LearnedGait) -> dict[str, Any]:
    """``gait`` as plain JSON; ``docs/reference/gait-files.md`` explains every key."""
    cycle = gait.cycle
    made = {} if gait.recipe is None else {"recipe": gait.recipe}
    stride = stride_to_dict(gait.stride)
    return {
        "format": FORMAT,
        "name": gait.name,
        "source": cycle.source,
        "license": cycle.license,
        "made_with": f"gaitsmith {__version__}",
        "notes": list(gait.notes),
        **made,
        "clip": {
            "file": gait.clip,
            "span_s": rounded(gait.span).tolist(),
            "stances": [
                {"side": SIDES[s.side], **dict(zip(EVENTS, rounded(s.times).tolist(), strict=True))}
                | ({"cut": s.cut} if s.cut else {})
                for s in gait.stances
            ],
        },
        "body": body_to_dict(gait.body),
        "stride_length_m": stride.pop("stride_length_m"),
        "duration_s": stride.pop("duration_s"),
        "speed_mps": number_of(cycle.speed),
        "cadence_spm": number_of(gait.cadence),
        "step_lengths_m": dict(zip(SIDES, rounded(gait.step_lengths).tolist(), strict=True)),
        "step_width_m": number_of(gait.step_width),
        "toe_out_deg": dict(zip(SIDES, rounded(np.degrees(gait.toe_out)).tolist(), strict=True)),
        "events": stride.pop("events"),
        "upper_body": gait.upper_body,
        **stride,
        **({"others": [stride_to_dict(other) for other in gait.others]} if gait.others else {}),
    }


def gait_from_dict(data: dict[str, Any]) -> LearnedGait:
    """The gait that :func:`gait_to_dict` wrote; KeyError, TypeError, ValueError if it is none."""
    if data["format"] != FORMAT:
        raise ValueError(f"format is {data['format']!r}, not {FORMAT!r}")
    body = body_from_dict(data["body"])
    skeleton = skeleton_of(body)
    stride, *others = (
        stride_from_dict(each, skeleton, source=data["source"], license=data["license"])
        for each in (data, *data.get("others", ()))
    )
    if data["upper_body"] not in ("measured", "rules"):
        raise ValueError(f"upper_body must be 'measured' or 'rules', got {data['upper_body']!r}")
    return LearnedGait(
        name=str(data["name"]),
        body=body,
        stride=stride,
        step_lengths=_pair(data["step_lengths_m"]),
        step_width=number("step_width_m", data["step_width_m"], "meters"),
        toe_out=_pair({s: np.radians(v) for s, v in data["toe_out_deg"].items()}),
        upper_body=data["upper_body"],
        clip=str(data["clip"]["file"]),
        stances=tuple(
            Stance(SIDES.index(s["side"]), *(s[event] for event in EVENTS), cut=s.get("cut", ""))
            for s in data["clip"]["stances"]
        ),
        span=(float(data["clip"]["span_s"][0]), float(data["clip"]["span_s"][1])),
        notes=tuple(data["notes"]),
        recipe=data.get("recipe"),
        others=tuple(others),
    )


def _pair(by_side: dict[str, float]) -> tuple[float, float]:
    left, right = (number(side, by_side[side], "meters or degrees") for side in SIDES)
    return left, right


def write_gait(gait: LearnedGait, path: Path) -> None:
    """Write ``gait`` as JSON, one key a line."""
    lines = [f" {json.dumps(k)}: {json.dumps(v)}" for k, v in gait_to_dict(gait).items()]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8", newline="\n")


def read_gait(path: Path) -> LearnedGait:
    """The gait in the file at ``path``.

    Raises
    ------
    FileFormatError
        If it is no gait file; names what is missing or wrong.
    OSError
        If it cannot be opened.
    """
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        line = getattr(error, "lineno", None)
        raise FileFormatError(path, f"not JSON: {error}", line=line) from None
    if not isinstance(data, dict) or "format" not in data:
        raise FileFormatError(path, "not a gait file: it has no 'format'")
    try:
        return gait_from_dict(data)
    except KeyError as error:
        raise FileFormatError(path, f"not a gait file: {error.args[0]!r} is missing") from None
    except (TypeError, ValueError, IndexError, AttributeError, GaitsmithError) as error:
        raise FileFormatError(path, f"not a gait file: {error}") from None
