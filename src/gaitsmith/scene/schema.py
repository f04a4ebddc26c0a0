"""The tables of a scene's file, as pydantic models: imported only where a file is read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    ValidationInfo,
    model_validator,
)

from gaitsmith.errors import GaitsmithError
from gaitsmith.ground.edges import LEAST_JUMP
from gaitsmith.learning import body_of, gait_from
from gaitsmith.motion.performance import checked_name
from gaitsmith.plan.manners import gait_of
from gaitsmith.plan.script import TEMPI, Action, read_script
from gaitsmith.plan.start import Start
from gaitsmith.plan.surroundings import Bar, Obstacle, Post
from gaitsmith.plan.where import read_where
from gaitsmith.scene.grounds import checked_ground
from gaitsmith.scene.model import LATEST

if TYPE_CHECKING:
    from collections.abc import Callable

#: Places of errors that are not in the file: which way a value was read.
TAGS = ("<text>", "<tables>")
#: Keys that say what an action of a ``[[do]]`` table is; the others say how.
VERBS = (
    *("walk_to", "follow", "step", "turn", "face", "look_at", "look_ahead", "stand", "lean"),
    *("be_at", "action"),
)
#: Farthest point, meters.
FARTHEST = 1000.0


def said(read: Callable[..., Any], *arguments: Any) -> Any:
    """What ``read`` gives; what it raises as pydantic wants it."""
    try:
        return read(*arguments)
    except OSError as error:
        what = error.strerror.lower() if error.strerror else str(error)
        raise ValueError(f"{error.filename}: {what}") from None
    except GaitsmithError as error:
        raise ValueError(str(error)) from None


def numbers(value: object, form: str) -> tuple[float, ...]:
    """Finite numbers of a list that looks like ``form``."""
    count = form.count(",") + 1
    given = value if isinstance(value, list) else []
    good = len(given) == count and all(
        isinstance(v, int | float) and not isinstance(v, bool) and math.isfinite(v) for v in given
    )
    if not good:
        raise ValueError(f"must be {form}, {count} finite numbers, got {value!r}")
    return tuple(float(v) for v in given)


def _point(value: object) -> tuple[float, float]:
    x, z = numbers(value, "[x, z]")
    if max(abs(x), abs(z)) > FARTHEST:
        raise ValueError(f"must be within {FARTHEST:g} m of 0,0, got {value!r}")
    return x, z


def _points(value: object) -> list[tuple[float, float]]:
    if not isinstance(value, list) or not value:
        raise ValueError(f"must be points [[x, z], [x, z], ...], got {value!r}")
    return [_point(v) for v in value]


def _gaze(value: object) -> tuple[float, ...]:
    return numbers(value, "[x, y, z]")


def _feet(value: object) -> Any:
    """(x, z, degrees) of [left, right], or None: side by side."""
    if value == "side by side":
        return None
    if not isinstance(value, dict) or set(value) != {"left", "right"}:
        raise ValueError(
            'must be "side by side" or {left = [x, z, degrees], right = [x, z, degrees]}, got '
            f"{value!r}"
        )
    return tuple(numbers(value[side], "[x, z, degrees]") for side in ("left", "right"))


def _file(name: str, info: ValidationInfo) -> str:
    """A file's name beside the scene's file."""
    assert info.context is not None
    return str(Path(info.context["folder"]) / name)


def _ground(value: object, info: ValidationInfo) -> str:
    if isinstance(value, str) and Path(value).suffix.lower() in (".npz", ".png", ".obj", ".toml"):
        value = _file(value, info)
    return said(checked_ground, value)


def _body(value: object, info: ValidationInfo) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"must be a height in meters, a name or a file, got {value!r}")
    if isinstance(value, str) and Path(value).suffix.lower() in (
        ".toml",
        ".bvh",
        ".amc",
        ".glb",
        ".npz",
    ):
        value = _file(value, info)
    return said(body_of, value)


def _gait(value: object, info: ValidationInfo) -> Any:
    if not isinstance(value, str):
        raise ValueError(f"must be a name or a file, got {value!r}")
    if not Path(value).suffix:
        said(gait_from, value)
        return value
    _, gait = said(gait_from, _file(value, info))
    return gait


def _action_gait(value: object, info: ValidationInfo) -> str:
    """The name of an action's gait; what it means is kept in the context."""
    assert info.context is not None
    if not isinstance(value, str) or not value or any(c.isspace() for c in value):
        raise ValueError(f"must be a name or a file without blanks in it, got {value!r}")
    known = info.context["gaits"]
    if value not in known:
        known[value] = _gait(value, info)
    return value


def _path(value: object, info: ValidationInfo) -> Any:
    if isinstance(value, list):
        given: Any = _points(value)
    elif isinstance(value, str):
        given = _file(value, info) if value.lower().endswith(".csv") else value
    else:
        raise ValueError(f"must be points or the name of a CSV file, got {value!r}")
    return said(read_where, None, given, None, None)[0]


def _steps(value: object, info: ValidationInfo) -> Any:
    if isinstance(value, str):
        return said(read_where, None, None, _file(value, info), None)[0]
    if isinstance(value, list):
        return said(read_where, None, None, value, None)[0]
    raise ValueError(f"must be the name of a CSV file or a list of footsteps, got {value!r}")


def _toe_out(value: object) -> Any:
    pair = value if isinstance(value, list) else [value, value]
    left, right = (math.radians(v) for v in numbers(pair, "[left, right]"))
    return (left, right)


def _script(value: object, info: ValidationInfo) -> list[Action]:
    """The actions of a script; all that is wrong in it is said."""
    if not isinstance(value, str):
        raise ValueError(f"must be a script or [[do]] tables, got {value!r}")
    parts = value.split(";")
    while len(parts) > 1 and not parts[-1].strip():
        parts.pop()
    actions, problems = list[Action](), list[str]()
    for i, part in enumerate(parts, start=1):
        try:
            (action,) = read_script(part)
            gait = gait_of(getattr(action, "tempo", None))
            if gait is not None:
                _action_gait(gait, info)
            actions.append(action)
        except (GaitsmithError, ValueError) as error:
            text = str(error) if part.strip() else "action 1 is empty; remove a semicolon"
            text = text.replace("action 1", f"action {i}", 1)
            problems.append(text if text.startswith("action") else f"action {i}: {text}")
    if problems:
        raise ValueError("; ".join(problems))
    return actions


def _which(value: object) -> str:
    return TAGS[1] if isinstance(value, list) else TAGS[0]


Point = Annotated[tuple[float, float], PlainValidator(_point)]
Points = Annotated[list[tuple[float, float]], PlainValidator(_points)]
Feet = Annotated[Any, PlainValidator(_feet)]
Name = Annotated[str, AfterValidator(lambda v: said(checked_name, v))]
Degrees = Annotated[float, Field(ge=-3600.0, le=3600.0)]
Speed = Annotated[float, Field(gt=0.0, le=10.0)]
Length = Annotated[float, Field(gt=0.0, le=5.0)]
Cadence = Annotated[float, Field(gt=0.0, le=600.0)]


class Table(BaseModel):
    """A table whose keys are all known and whose numbers are finite."""

    model_config = ConfigDict(
        strict=True, extra="forbid", allow_inf_nan=False, arbitrary_types_allowed=True
    )


class StartTable(Table):
    """``start = {at = [x, z], facing = degrees, feet = ...}``."""

    at: Point | None = None
    facing: Degrees | None = None
    feet: Feet = None

    def start(self) -> Start:
        """What it says; feet that contradict the place are refused."""
        feet = self.feet and tuple((x, z, math.radians(a)) for x, z, a in self.feet)
        facing = None if self.facing is None else math.radians(self.facing)
        return said(Start, self.at, facing, feet)

    @model_validator(mode="after")
    def _agrees(self) -> StartTable:
        self.start()
        return self


class DoTable(Table):
    """One action of a ``[[do]]`` table."""

    action: str | None = None
    walk_to: Point | None = None
    follow: Points | None = None
    step: str | None = None
    turn: str | None = None
    face: Degrees | None = None
    look_at: Annotated[Any, PlainValidator(_gaze)] = None
    look_ahead: bool | None = None
    stand: float | None = None
    lean: str | None = None
    be_at: Point | None = None
    facing: Degrees | None = None
    feet: Feet = None
    speed: Speed | None = None
    step_length: Length | None = None
    cadence: Cadence | None = None
    gait: Annotated[Any, PlainValidator(_action_gait)] = None

    def read(self) -> Action:
        """The action that the table says."""
        verbs = [verb for verb in VERBS if getattr(self, verb) is not None]
        if len(verbs) != 1:
            raise ValueError(
                f"must have exactly one of {', '.join(VERBS)}, got "
                + (" and ".join(verbs) if verbs else "none of them")
            )
        verb, how = verbs[0], self.model_fields_set - set(VERBS)
        walking = {*TEMPI, "gait"}
        allowed = {"walk_to": walking, "follow": walking, "action": walking}
        allowed["be_at"] = {*walking, "facing", "feet"}
        odd = sorted(how - allowed.get(verb, set()))
        if odd:
            homes = {"facing": "be_at", "feet": "be_at"}
            where = homes.get(odd[0], "walk_to, follow and be_at")
            raise ValueError(f"{odd[0]} is of {where}, not of {verb}")
        actions = said(read_script, self._text(verb))
        if len(actions) != 1:
            raise ValueError(f"one table is one action, got {len(actions)}: {self.action!r}")
        return actions[0]

    def _text(self, verb: str) -> str:
        """The action as a script writes it."""
        value = getattr(self, verb)
        words = [] if verb == "action" else [verb.replace("_", " ")]
        if verb == "look_ahead":
            if not value:
                raise ValueError("look_ahead can only be true")
        elif verb == "follow":
            words += [_joined(point) for point in value]
        elif isinstance(value, tuple):
            words.append(_joined(value))
        else:
            words.append(value if isinstance(value, str) else repr(value))
        if self.facing is not None:
            words.append(f"facing {self.facing!r}")
        if self.feet is not None:
            left, right = self.feet
            words.append(f"feet L {_joined(left)} R {_joined(right)}")
        words += [
            f"{name.replace('_', '-')} {value!r}"
            for name in TEMPI
            if (value := getattr(self, name)) is not None
        ]
        words += [f"gait {self.gait}"] if self.gait is not None else []
        return " ".join(words)

    @model_validator(mode="after")
    def _reads(self) -> DoTable:
        self.read()
        return self


def _joined(values: tuple[float, ...]) -> str:
    return ",".join(repr(v) for v in values)


class WalkerTable(Table):
    """``[[walker]]``, or a whole file of one walker."""

    name: Name | None = None
    body: Annotated[Any, PlainValidator(_body)] = 1.75
    gait: Annotated[Any, PlainValidator(_gait)] = "neutral"
    legs: Literal["kinematic", "elevation"] = "kinematic"
    start: StartTable | None = None
    begin: Annotated[float, Field(ge=0.0, le=LATEST)] = 0.0
    do: (
        Annotated[
            Annotated[Any, PlainValidator(_script), Tag(TAGS[0])]
            | Annotated[list[DoTable], Tag(TAGS[1])],
            Discriminator(_which),
        ]
        | None
    ) = None
    path: Annotated[Any, PlainValidator(_path)] = None
    steps: Annotated[Any, PlainValidator(_steps)] = None
    distance: Annotated[float, Field(gt=0.0, le=1e5)] | None = None
    speed: Speed | None = None
    step_length: Length | None = None
    cadence: Cadence | None = None
    step_width: Annotated[float, Field(gt=0.0, le=2.0)] | None = None
    toe_out: Annotated[Any, PlainValidator(_toe_out)] = None
    variation: Annotated[float, Field(ge=0.0, le=2.0)] = 0.0
    seed: Annotated[int, Field(ge=0)] | None = None


def _felt(value: float) -> float:
    if value < LEAST_JUMP:
        raise ValueError(
            f"must be at least {LEAST_JUMP:g} meters, got {value!r}; what is lower is not felt "
            "underfoot and may be left out"
        )
    return value


class ObstacleTable(Table):
    """``[[obstacle]]``: a polygon on the floor."""

    points: Points
    name: str = "obstacle"
    height: Annotated[float, AfterValidator(_felt), Field(le=10.0)] | None = None

    @model_validator(mode="after")
    def _simple(self) -> ObstacleTable:
        from shapely import Polygon  # late: only scenes with obstacles need it
        from shapely.validation import explain_validity

        if len(self.points) < 3:
            raise ValueError(f"points: a polygon needs three corners, got {len(self.points)}")
        shape = Polygon(self.points)
        if not shape.is_valid or shape.area < 1e-6:
            why = explain_validity(shape) if not shape.is_valid else "it has no area"
            raise ValueError(f"points: must be the corners of a simple polygon in order: {why}")
        return self

    def built(self) -> Obstacle:
        """As the package has it."""
        return Obstacle(tuple(self.points), self.name, self.height)


class BarTable(Table):
    """``[[bar]]``: a level bar overhead."""

    begin: Point
    end: Point
    height: Annotated[float, Field(gt=0.0, le=10.0)]
    radius: Annotated[float, Field(gt=0.0, le=1.0)] = 0.02
    name: str = "bar"

    def built(self) -> Bar:
        """As the package has it."""
        return Bar(self.begin, self.end, self.height, self.radius, self.name)


class PostTable(Table):
    """``[[post]]``: an upright post."""

    at: Point
    radius: Annotated[float, Field(gt=0.0, le=2.0)] = 0.05
    bottom: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    top: Annotated[float, Field(gt=0.0, le=10.0)] = 3.0
    name: str = "post"

    @model_validator(mode="after")
    def _upright(self) -> PostTable:
        if self.top <= self.bottom:
            raise ValueError(f"top {self.top:g} m must be above bottom {self.bottom:g} m")
        return self

    def built(self) -> Post:
        """As the package has it."""
        return Post(self.at, self.radius, self.bottom, self.top, self.name)


class SceneTable(Table):
    """A whole file; one walker's keys may stand at its top instead of in ``[[walker]]``."""

    ground: Annotated[Any, PlainValidator(_ground)] = "flat"
    walker: list[WalkerTable]
    obstacle: list[ObstacleTable] = []
    bar: list[BarTable] = []
    post: list[PostTable] = []
