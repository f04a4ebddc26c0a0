"""A learned gait: a Cycle, the walk data of its legs, and where it came from; its JSON file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith._version import __version__
from gaitsmith.body.files import body_from_dict, body_to_dict
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import SIDES
from gaitsmith.errors import FileFormatError, GaitsmithError
from gaitsmith.gait.cycle import EVENTS, Cycle
from gaitsmith.gait.elevation import SEGMENTS, ElevationData, elevation_of
from gaitsmith.gait.events import Stance
from gaitsmith.gait.learn import Learned, standing_feet
from gaitsmith.walks.files import walk_data_from_dict, walk_data_to_dict
from gaitsmith.walks.from_cycle import walk_data_of

if TYPE_CHECKING:
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.walks.data import WalkData

FORMAT = "gaitsmith-gait-1"
SUFFIX = ".gait.json"
#: Digits kept after the point: a micrometer, a fifth of an arc second.
_DIGITS = 6
#: Times that rounding may change a file's last digits before they stay.
_ROUNDS = 8


@dataclass(frozen=True, eq=False)
class LearnedGait:
    """A person's walk, ready to be walked by any body.

    Attributes
    ----------
    name
        For people to read.
    body
        Who was measured.
    cycle
        One closed stride of the whole body (of the legs, where only they were measured).
    walk_data
        Steps on the left and on the right foot.
    elevation
        Elevation angles of the legs.
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
    """

    name: str
    body: Body
    cycle: Cycle
    walk_data: tuple[WalkData, WalkData]
    elevation: ElevationData
    step_lengths: tuple[float, float]
    step_width: float
    toe_out: tuple[float, float]
    upper_body: str
    clip: str
    stances: tuple[Stance, ...]
    span: tuple[float, float]
    notes: tuple[str, ...]
    recipe: dict[str, Any] | None = None

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
) -> LearnedGait:
    """The gait of a learned stride, exactly as its file will hold it."""
    gait = LearnedGait(
        name=name,
        body=found.body,
        cycle=found.cycle,
        walk_data=walk_data_of(found.cycle, found.body),
        elevation=elevation_of(found.cycle),
        step_lengths=found.step_lengths,
        step_width=found.step_width,
        toe_out=found.toe_out,
        upper_body=upper_body,
        clip=clip,
        stances=found.stances,
        span=found.span,
        notes=found.notes,
        recipe=recipe,
    )
    # what is walked right away and what is read from the file are the same, to the byte; unit
    # quaternions that were rounded and made unit again may be rounded otherwise
    data = gait_to_dict(gait)
    for _ in range(_ROUNDS):
        gait = gait_from_dict(data)
        before, data = data, gait_to_dict(gait)
        if data == before:
            break
    return gait


def gait_of_cycle(
    cycle: Cycle,
    body: Body,
    *,
    name: str,
    notes: tuple[str, ...] = (),
    recipe: dict[str, Any] | None = None,
) -> LearnedGait:
    """The gait of a whole-body stride that was made and not learned from a clip.

    Its steps, its width and its toe-out are what its feet do.
    """
    feet = standing_feet(cycle)
    middle = 0.5 * (feet.place[0, 0] + feet.place[1, 0])
    cycle = cycle.with_(center=cycle.center - [middle, feet.height, cycle.center[:, 2].mean()])
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
    return learned_gait(found, name=name, upper_body="measured", recipe=recipe)


def _rounded(value: Any) -> Any:
    return np.round(np.asarray(value), _DIGITS).tolist()


def gait_to_dict(gait: LearnedGait) -> dict[str, Any]:
    """``gait`` as plain JSON; ``docs/reference/gait-files.md`` explains every key."""
    cycle = gait.cycle
    made = {} if gait.recipe is None else {"recipe": gait.recipe}
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
            "span_s": _rounded(gait.span),
            "stances": [
                {"side": SIDES[s.side], **dict(zip(EVENTS, _rounded(s.times), strict=True))}
                | ({"cut": s.cut} if s.cut else {})
                for s in gait.stances
            ],
        },
        "body": body_to_dict(gait.body),
        "stride_length_m": _rounded(cycle.stride_length),
        "duration_s": _rounded(cycle.duration),
        "speed_mps": _rounded(cycle.speed),
        "cadence_spm": _rounded(gait.cadence),
        "step_lengths_m": dict(zip(SIDES, _rounded(gait.step_lengths), strict=True)),
        "step_width_m": _rounded(gait.step_width),
        "toe_out_deg": dict(zip(SIDES, _rounded(np.degrees(gait.toe_out)), strict=True)),
        "events": {
            side: dict(zip(EVENTS, _rounded(cycle.events[i]), strict=True))
            for i, side in enumerate(SIDES)
        },
        "upper_body": gait.upper_body,
        "cycle": {
            "strides": cycle.strides,
            "center": _rounded(cycle.center),
            "rotations": {
                joint: _rounded(cycle.rotations[:, i])
                for i, joint in enumerate(cycle.skeleton.names)
            },
        },
        "walk_data": {
            side: walk_data_to_dict(walk) for side, walk in zip(SIDES, gait.walk_data, strict=True)
        },
        "elevation": {
            "leg_length_m": _rounded(gait.elevation.leg_length),
            "segments": list(SEGMENTS),
            "angles": {side: _rounded(gait.elevation.angles[i]) for i, side in enumerate(SIDES)},
        },
    }


def gait_from_dict(data: dict[str, Any]) -> LearnedGait:
    """The gait that :func:`gait_to_dict` wrote; KeyError, TypeError, ValueError if it is none."""
    if data["format"] != FORMAT:
        raise ValueError(f"format is {data['format']!r}, not {FORMAT!r}")
    body = body_from_dict(data["body"])
    skeleton = skeleton_of(body)
    loop = data["cycle"]
    center = np.array(loop["center"], dtype=np.float64)
    rotations = np.stack(
        [np.array(loop["rotations"][joint], dtype=np.float64) for joint in skeleton.names], axis=1
    )
    norm = np.linalg.norm(rotations, axis=-1, keepdims=True)
    if not (np.abs(norm - 1.0) < 1e-3).all():
        raise ValueError("rotations must be unit quaternions")
    events = np.array([[data["events"][side][event] for event in EVENTS] for side in SIDES])
    cycle = Cycle(
        skeleton=skeleton,
        center=center,
        rotations=rotations / norm,
        events=events,
        stride_length=data["stride_length_m"],
        duration=data["duration_s"],
        strides=loop["strides"],
        source=data["source"],
        license=data["license"],
    )
    left, right = (walk_data_from_dict(data["walk_data"][side]) for side in SIDES)
    lift = data["elevation"]
    if data["upper_body"] not in ("measured", "rules"):
        raise ValueError(f"upper_body must be 'measured' or 'rules', got {data['upper_body']!r}")
    return LearnedGait(
        name=str(data["name"]),
        body=body,
        cycle=cycle,
        walk_data=(left, right),
        elevation=ElevationData(
            np.array([lift["angles"][side] for side in SIDES]),
            cycle.stride_length,
            cycle.duration,
            lift["leg_length_m"],
        ),
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
