"""Bodies by name, and what ``--body`` takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.files import body_from_dict, body_from_toml, body_to_dict
from gaitsmith.body.proportions import body_from_height, height_from_leg
from gaitsmith.errors import InvalidInputError, UnknownFormatError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = [
    "BODIES",
    "KB92B_FIGURE",
    "KB92B_SUBJECT",
    "Preset",
    "body_from",
    "body_from_dict",
    "body_from_height",
    "body_from_toml",
    "body_to_dict",
]


def _from_kb92b(name: str, *, thigh: float, shin: float, foot: Foot) -> Body:
    """Body with the legs and feet of [KB92b] section 6, the rest for legs of that length."""
    base = body_from_height(height_from_leg(thigh + shin))
    above = base.trunk + base.neck + base.head
    height = foot.ankle_height + thigh + shin + above
    return replace(base, name=name, height=height, thigh=thigh, shin=shin, foot=foot)


#: The measured subject of [KB92b] section 6, digits as printed (cm there). Legs and feet are
#: the paper's; all else is ours: of the stature that has such legs, 1.505 m, stacked on them.
#: The table's derived rows agree but for its heel angle, .8400 where the sides give .8398.
KB92B_SUBJECT = _from_kb92b(
    "KB92b subject",
    thigh=0.3585,
    shin=0.3805,
    foot=Foot(ankle_height=0.05680, heel=0.05093, ball=0.1080, toes=0.07095),
)

#: The animated figure of the same table: another leg, a much higher ankle. Made likewise; its
#: high ankles make it 1.603 m where legs alone would say 1.533 m.
KB92B_FIGURE = _from_kb92b(
    "KB92b figure",
    thigh=0.4072,
    shin=0.3453,
    foot=Foot(ankle_height=0.1304, heel=0.03450, ball=0.1174, toes=0.07200),
)


@dataclass(frozen=True)
class Preset:
    """A body by name: call it to get the body.

    Attributes
    ----------
    about
        One line for ``gaitsmith list bodies``.
    make
        Gives the body.
    """

    about: str
    make: Callable[[], Body]

    def __call__(self) -> Body:
        """The body."""
        return self.make()


def _of(height: float, about: str, name: str) -> Preset:
    return Preset(f"{about}, {height:.2f} m", lambda: body_from_height(height, name=name))


#: Bodies by the name the command line uses.
BODIES: dict[str, Preset] = {
    "adult": _of(1.75, "an adult of average proportions", "adult"),
    "small": _of(1.55, "a small adult", "small"),
    "tall": _of(1.95, "a tall adult", "tall"),
    "child": _of(1.20, "a child of about seven years, by a child's proportions", "child"),
    "kb92b-subject": Preset(
        "the measured subject of Ko & Badler 1992: legs and feet as printed", lambda: KB92B_SUBJECT
    ),
    "kb92b-figure": Preset(
        "the animated figure of Ko & Badler 1992: long thighs, high ankles", lambda: KB92B_FIGURE
    ),
}


def body_from(spec: str | float | Path | Body) -> Body:
    """The body that ``--body`` means.

    Parameters
    ----------
    spec
        A height in meters (also as text, ``"1.75"``), a name of :data:`BODIES`, a path to a
        ``.toml`` file of measures, or a body, which is returned as it is.

    Raises
    ------
    InvalidInputError
        If ``spec`` is none of these, or a height that no body has (UnknownNameError,
        UnknownFormatError where it is a name or a path).
    FileFormatError
        If the file is bad.
    """
    if isinstance(spec, Body):
        return spec
    if isinstance(spec, Path):
        return _from_file(spec)
    if isinstance(spec, bool) or not isinstance(spec, str | int | float):
        raise InvalidInputError(
            "a body must be a height in meters, a name, a .toml file or a Body, "
            f"got {type(spec).__name__}"
        )
    if not isinstance(spec, str):
        return body_from_height(spec)
    text = spec.strip()
    if text in BODIES:
        return BODIES[text]()
    try:
        height = float(text)
    except ValueError:
        pass
    else:
        return body_from_height(height)
    path = Path(text)
    # "1.75m" is a slip of the pen, not a file of the kind .75m
    if path.suffix and not path.suffix[1:2].isdigit():
        return _from_file(path)
    raise UnknownNameError("body (height in meters, .toml file or name)", text, BODIES)


def _from_file(path: Path) -> Body:
    if path.suffix.lower() != ".toml":
        raise UnknownFormatError(path.suffix, [".toml"], verb="read a body from")
    return body_from_toml(path)
