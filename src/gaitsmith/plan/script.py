"""Actions of a director, and the script that writes them down: ``"walk to 0,3; turn left 90"``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

Point = tuple[float, float]


@dataclass(frozen=True)
class Tempo:
    """How one action walks: its pace, and its gait.

    Attributes
    ----------
    speed, step_length, cadence
        Meters per second, meters, steps per minute, as
        :func:`~gaitsmith.plan.pace.choose_pace` is told; None: not said. An action that says
        one of them is paced by what it says alone.
    gait
        Name of another gait than the person's own: a built-in one, or one of the ``gaits`` that
        :func:`gaitsmith.walk` is told; no blanks in it. None: the person's own.
    """

    speed: float | None = None
    step_length: float | None = None
    cadence: float | None = None
    gait: str | None = None

    def __post_init__(self) -> None:
        """Check the name of the gait."""
        if self.gait is not None and (
            not self.gait or any(c.isspace() or c == ";" for c in self.gait)
        ):
            raise InvalidInputError(
                f"the gait of an action must be a name without blanks and semicolons, got "
                f"{self.gait!r}"
            )

    @property
    def said(self) -> dict[str, float]:
        """What is said of the pace."""
        return {n: v for n in TEMPI if (v := getattr(self, n)) is not None}


@dataclass(frozen=True)
class WalkTo:
    """Walk to a point x,z; at ``tempo``, else as the person walks."""

    point: Point
    tempo: Tempo | None = None


@dataclass(frozen=True)
class Follow:
    """Walk a smooth curve through points; at ``tempo``, else as the person walks."""

    points: tuple[Point, ...]
    tempo: Tempo | None = None


@dataclass(frozen=True)
class Step:
    """Move the body by ``distance`` meters ``forward``, ``back``, ``left`` or ``right``."""

    way: str
    distance: float


@dataclass(frozen=True)
class Turn:
    """Turn on the spot by ``angle`` radians, left positive."""

    angle: float


@dataclass(frozen=True)
class Face:
    """Turn on the spot to a heading, radians, the shorter way."""

    heading: float


@dataclass(frozen=True)
class LookAt:
    """Look at a point x,y,z from now on; None: ahead again."""

    point: tuple[float, float, float] | None


@dataclass(frozen=True)
class Stand:
    """Stand for ``seconds``."""

    seconds: float


@dataclass(frozen=True)
class Lean:
    """Lean the trunk by ``angle`` radians ``forward``, ``back``, ``left`` or ``right``."""

    way: str
    angle: float


@dataclass(frozen=True)
class BeAt:
    """Stand with the middle of both N at ``point``, facing ``heading``; the feet as given.

    ``feet`` are (x, z, heading in radians) of left and right; None: side by side. Where it
    takes a walk to get there, ``tempo`` is that walk's.
    """

    point: Point
    heading: float | None = None
    feet: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    tempo: Tempo | None = None


Action = WalkTo | Follow | Step | Turn | Face | LookAt | Stand | Lean | BeAt


@dataclass(frozen=True)
class Script:
    """Actions in their order."""

    actions: tuple[Action, ...]

    @property
    def text(self) -> str:
        """The actions as they are written."""
        return "; ".join(written(a) for a in self.actions)


#: Ways that a step or a lean may go.
WAYS = ("forward", "back", "left", "right")
#: What a walking action may say of its tempo: field, and unit.
TEMPI = {"speed": "m/s", "step_length": "m", "cadence": "steps/min"}
#: The same as written in a script, and the field's name.
_TEMPO_WORDS = {**{name.replace("_", "-"): name for name in TEMPI}, "gait": "gait"}
_TEMPO_FORM = "[speed M/S] [step-length M] [cadence STEPS/MIN] [gait NAME]"
#: What an action looks like, by its first word.
FORMS = {
    "walk": f"walk to X,Z {_TEMPO_FORM}",
    "follow": f"follow X,Z X,Z ... {_TEMPO_FORM}",
    "step": "step forward|back|left|right METERS",
    "turn": "turn left|right DEGREES",
    "face": "face DEGREES",
    "look": "look at X,Y,Z, or look ahead",
    "stand": "stand SECONDS",
    "lean": "lean forward|back|left|right DEGREES",
    "be": "be at X,Z [facing DEGREES] [feet side by side | feet L X,Z,DEG R X,Z,DEG] "
    + _TEMPO_FORM,
}
#: Longest way (m), time (s), number of actions.
FARTHEST, LONGEST, MOST_ACTIONS = 1000.0, 3600.0, 1000
#: Largest speed, step length and cadence that anybody may write; a body walks less.
FASTEST = {"speed": 10.0, "step_length": 5.0, "cadence": 600.0}
#: Largest turn and lean, degrees.
LARGEST_TURN, LARGEST_LEAN = 3600.0, 45.0


def read_script(script: str | Sequence[str | Action]) -> list[Action]:
    """Actions of a script, or of a list of actions and pieces of script.

    Raises
    ------
    InvalidInputError
        Naming the action, what is wrong in it and, for an unknown word, the nearest known one.
    """
    if isinstance(script, str):
        parts = script.split(";")
        if parts and not parts[-1].strip():
            parts = parts[:-1]
        found = [_parsed(part, i) for i, part in enumerate(parts, start=1)]
    else:
        found = []
        for item in script:
            found += read_script(item) if isinstance(item, str) else [_known(item)]
    if not found:
        raise InvalidInputError(
            "the script is empty; write actions as in 'walk to 0,3; turn left 90; stand 1'"
        )
    if len(found) > MOST_ACTIONS:
        raise InvalidInputError(f"a script may have {MOST_ACTIONS} actions, got {len(found)}")
    return found


def _known(action: object) -> Action:
    if not isinstance(action, Action):
        raise InvalidInputError(f"an action must be text or one of {Action}, got {action!r}")
    return action


def written(action: Action) -> str:
    """The piece of script that says ``action``; reading it gives the same action."""

    def joined(*values: float) -> str:
        return ",".join(repr(float(v)) for v in values)

    def degrees(angle: float) -> str:
        """Shortest text that is read as just this angle."""
        near = math.degrees(angle)
        for text in (f"{near:.12g}", repr(near)):
            if math.radians(float(text)) == angle:
                return text
        return repr(near)

    def at(tempo: Tempo | None) -> str:
        if tempo is None:
            return ""
        said = [f" {n.replace('_', '-')} {float(v)!r}" for n, v in tempo.said.items()]
        return "".join(said) + (f" gait {tempo.gait}" if tempo.gait is not None else "")

    match action:
        case WalkTo(point, tempo):
            return f"walk to {joined(*point)}{at(tempo)}"
        case Follow(points, tempo):
            return "follow " + " ".join(joined(*p) for p in points) + at(tempo)
        case Step(way, distance):
            return f"step {way} {float(distance)!r}"
        case Turn(angle):
            return f"turn {'left' if angle >= 0.0 else 'right'} {degrees(abs(angle))}"
        case Face(heading):
            return f"face {degrees(heading)}"
        case LookAt(point):
            return "look ahead" if point is None else f"look at {joined(*point)}"
        case Stand(seconds):
            return f"stand {float(seconds)!r}"
        case Lean(way, angle):
            return f"lean {way} {degrees(angle)}"
        case BeAt(point, heading, feet, tempo):
            text = f"be at {joined(*point)}"
            if heading is not None:
                text += f" facing {degrees(heading)}"
            if feet is not None:
                (lx, lz, la), (rx, rz, ra) = feet
                text += f" feet L {joined(lx, lz)},{degrees(la)} R {joined(rx, rz)},{degrees(ra)}"
            return text + at(tempo)


class _Words:
    """The words of one action, taken one by one."""

    def __init__(self, text: str, number: int) -> None:
        self.text, self.number = " ".join(text.split()), number
        self.words = text.split()
        self.at = 0

    def wrong(self, why: str) -> InvalidInputError:
        form = FORMS.get(self.words[0].lower() if self.words else "")
        usage = f"; write {form}" if form else ""
        return InvalidInputError(f"action {self.number} {self.text!r}: {why}{usage}")

    @property
    def left(self) -> bool:
        return self.at < len(self.words)

    @property
    def next_is_point(self) -> bool:
        """Whether the next word is meant for a point."""
        return "," in self.words[self.at] or not self.words[self.at][0].isalpha()

    def take(self, what: str) -> str:
        if not self.left:
            raise self.wrong(f"{what} is missing")
        self.at += 1
        return self.words[self.at - 1]

    def word(self, what: str, *known: str) -> str:
        given = self.take(what)
        if given.lower() not in known:
            close = get_close_matches(given.lower(), known, n=1, cutoff=0.0)[0]
            raise self.wrong(f"unknown {what} {given!r}, did you mean {close!r}?")
        return given.lower()

    def numbers(self, what: str, count: int) -> tuple[float, ...]:
        given = self.take(what)
        try:
            values = tuple(float(v) for v in given.split(","))
        except ValueError:
            values = ()
        if len(values) != count or not all(math.isfinite(v) for v in values):
            kind = "a number" if count == 1 else f"{count} numbers joined by commas"
            raise self.wrong(f"{what} must be {kind}, got {given!r}")
        return values

    def point(self, what: str = "the point") -> Point:
        x, z = self.numbers(what, 2)
        if max(abs(x), abs(z)) > FARTHEST:
            raise self.wrong(f"{what} must be within {FARTHEST:g} m of 0,0, got {x:g},{z:g}")
        return x, z

    def size(self, what: str, unit: str, most: float, *, least: float = 0.0) -> float:
        (value,) = self.numbers(what, 1)
        if not least <= value <= most or (least == 0.0 and value == 0.0 and what != "the angle"):
            raise self.wrong(
                f"{what} must be above {least:g} and at most {most:g} {unit}, got {value:g}"
            )
        return value

    def done(self) -> None:
        if self.left:
            raise self.wrong(f"{self.words[self.at]!r} is one word too many")


def _parsed(text: str, number: int) -> Action:
    words = _Words(text, number)
    if not words.left:
        raise InvalidInputError(f"action {number} is empty; remove one of the semicolons")
    name = words.word("action", *FORMS)
    action = _READERS[name](words)
    words.done()
    return action


def _tempo(words: _Words) -> Tempo | None:
    """What follows of speed, step length and cadence, in any order."""
    said: dict[str, Any] = {}
    while words.left and not words.next_is_point:
        _take_tempo(words, words.word("word", *_TEMPO_WORDS), said)
    return Tempo(**said) if said else None


def _take_tempo(words: _Words, word: str, said: dict[str, Any]) -> None:
    name = _TEMPO_WORDS[word]
    if name in said:
        raise words.wrong(f"{word} is said twice")
    if name == "gait":
        said[name] = words.take("the gait")
    else:
        said[name] = words.size(f"the {word}", TEMPI[name], FASTEST[name])


def _walk(words: _Words) -> Action:
    words.word("word", "to")
    return WalkTo(words.point(), _tempo(words))


def _follow(words: _Words) -> Action:
    points = [words.point()]
    while words.left and words.next_is_point:
        points.append(words.point())
    return Follow(tuple(points), _tempo(words))


def _step(words: _Words) -> Action:
    way = words.word("way", *WAYS)
    return Step(way, words.size("the distance", "m", 100.0))


def _turn(words: _Words) -> Action:
    way = words.word("way", "left", "right")
    angle = words.size("the angle", "deg", LARGEST_TURN)
    return Turn(math.radians(angle if way == "left" else -angle))


def _face(words: _Words) -> Action:
    return Face(math.radians(words.size("the heading", "deg", LARGEST_TURN, least=-LARGEST_TURN)))


def _look(words: _Words) -> Action:
    if words.word("word", "at", "ahead") == "ahead":
        return LookAt(None)
    x, y, z = words.numbers("the point", 3)
    return LookAt((x, y, z))


def _stand(words: _Words) -> Action:
    return Stand(words.size("the time", "s", LONGEST))


def _lean(words: _Words) -> Action:
    way = words.word("way", *WAYS)
    return Lean(way, math.radians(words.size("the angle", "deg", LARGEST_LEAN)))


def _be(words: _Words) -> Action:
    words.word("word", "at")
    point, heading, feet = words.point(), None, None
    said: dict[str, Any] = {}
    while words.left:
        word = words.word("word", "facing", "feet", *_TEMPO_WORDS)
        if word == "facing":
            (degrees,) = words.numbers("the heading", 1)
            heading = math.radians(degrees)
        elif word in _TEMPO_WORDS:
            _take_tempo(words, word, said)
        elif words.word("word", "side", "l") == "side":
            words.word("word", "by")
            words.word("word", "side")
        else:
            left = words.numbers("the left foot", 3)
            words.word("word", "r")
            right = words.numbers("the right foot", 3)
            feet = (
                (left[0], left[1], math.radians(left[2])),
                (right[0], right[1], math.radians(right[2])),
            )
    return BeAt(point, heading, feet, Tempo(**said) if said else None)


_READERS = {
    "walk": _walk,
    "follow": _follow,
    "step": _step,
    "turn": _turn,
    "face": _face,
    "look": _look,
    "stand": _stand,
    "lean": _lean,
    "be": _be,
}
