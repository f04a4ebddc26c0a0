"""What a marker's name means: which point of the leg or pelvis, and of which side.

Laboratories name markers as they like: ``R.Heel``, ``heel_r``, ``RHEE``, ``RightHeel``,
``subject1:RHEE``. ``docs/reference/markers.md`` lists what is understood.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.errors import InfeasibleError

if TYPE_CHECKING:
    from collections.abc import Iterable

#: Names of each point, lower case, without separators and without the side.
ALIASES: dict[str, tuple[str, ...]] = {
    "hip center": ("hjc", "hipjc", "hipcenter", "hipcentre", "hipjointcenter", "hipjointcentre"),
    "hip": (
        *("hip", "gtr", "gt", "tro", "troch", "trochanter", "greatertrochanter", "ftc"),
        *("greattrochanter", "hiplateral", "lateralhip"),
    ),
    "knee center": ("kjc", "kneejc", "kneecenter", "kneecentre", "kneejointcenter"),
    "knee": (
        *("knee", "kne", "kneelateral", "lateralknee", "kneelat", "latknee", "kneeouter"),
        *("lateralepicondyle", "lateralfemoralepicondyle", "epicondyle", "fle"),
    ),
    "knee medial": (
        *("kneemedial", "medialknee", "kneemed", "medknee", "kneemm", "mkne", "mknee"),
        *("kneeinner", "medialepicondyle", "medialfemoralepicondyle", "fme", "knem", "kneem"),
    ),
    "ankle center": ("ajc", "anklejc", "anklecenter", "anklecentre", "anklejointcenter"),
    "ankle": (
        *("ankle", "ank", "anklelateral", "lateralankle", "anklelat", "latankle", "malleolus"),
        *("lateralmalleolus", "malleoluslateral", "ankleouter", "fal"),
    ),
    "ankle medial": (
        *("anklemedial", "medialankle", "anklemed", "medankle", "mank", "mankle", "ankleinner"),
        *("medialmalleolus", "malleolusmedial", "tam", "ankm", "anklem"),
    ),
    "heel": ("heel", "hee", "cal", "calc", "calcaneus", "fcc", "heelback"),
    "ball": ("ball", "mt", "mtp", "met", "metatarsal", "forefoot", "ballfoot", "football"),
    "toe": ("toe", "toes", "toetip", "tiptoe", "hallux", "hal", "hlx", "bigtoe", "toeend"),
    "asis": ("asis", "asi", "ias", "anteriorsuperioriliacspine"),
    "psis": ("psis", "psi", "ips", "posteriorsuperioriliacspine"),
    "sacrum": ("sacrum", "sacr", "sac", "s2", "s1", "vsacral", "vsacrum"),
}
_ROLE = {alias: role for role, aliases in ALIASES.items() for alias in aliases}
_SIDE = {"l": LEFT, "left": LEFT, "r": RIGHT, "right": RIGHT}
_WORDS = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|[0-9]+")
_HEADS = r"(?:mt|mth|mtp|mtph|met|meta|metatarsal|metatarsalhead|fm)"
_METATARSAL = re.compile(rf"{_HEADS}([1-5])|([1-5])(?:st|nd|rd|th)?{_HEADS}")
_COUNTED = {"first": "1", "second": "2", "third": "3", "fourth": "4", "fifth": "5"}

#: A point of the body: side (None: not said) and role.
Point = tuple[int | None, str]


def meaning(name: str) -> Point | None:
    """Side and role of the marker called ``name``; None if it is not understood.

    >>> meaning("R.Knee.Medial"), meaning("LHEE"), meaning("mt5_r"), meaning("hip")
    ((1, 'knee medial'), (0, 'heel'), (1, 'mt5'), (None, 'hip'))
    """
    words = [w.lower() for w in _WORDS.findall(name.rsplit(":", 1)[-1])]
    for place, word in enumerate(words):
        if word in _SIDE:
            role = _role("".join(words[:place] + words[place + 1 :]))
            if role is not None:
                return _SIDE[word], role
    whole = "".join(words)
    if (role := _role(whole)) is not None:
        return None, role
    for word in ("left", "right", "l", "r"):
        for rest, there in (
            (whole.removeprefix(word), whole.startswith(word)),
            (whole.removesuffix(word), whole.endswith(word)),
        ):
            if there and (role := _role(rest)) is not None:
                return _SIDE[word], role
    return None


def _role(text: str) -> str | None:
    if text in _ROLE:
        return _ROLE[text]
    for word, digit in _COUNTED.items():
        text = text.replace(word, digit)
    found = _METATARSAL.fullmatch(text)
    return None if found is None else f"mt{found[1] or found[2]}"


def points_of(names: Iterable[str]) -> dict[Point, str]:
    """Marker of each point that the names tell; of two with one meaning, the first."""
    out: dict[Point, str] = {}
    for name in names:
        if (point := meaning(name)) is not None:
            out.setdefault(point, name)
    return out


def has_pelvis(points: Iterable[Point]) -> bool:
    """Whether hip joint centers can be told from the pelvis: both ASIS and what is behind."""
    there = set(points)
    behind = {(LEFT, "psis"), (RIGHT, "psis")} <= there or (None, "sacrum") in there
    return behind and {(LEFT, "asis"), (RIGHT, "asis")} <= there


def lacking(points: Iterable[Point], side: int | None) -> list[str]:
    """What a leg still needs, in words; empty if it is whole."""
    there = {role for s, role in points if s == side}
    out: list[str] = []
    sided = side is not None and has_pelvis(points)
    if not (there & {"hip", "hip center"} or sided):
        out.append("hip (greater trochanter; or ASIS and PSIS of both sides)")
    if not there & {"knee", "knee center", "knee medial"}:
        out.append("knee")
    if not there & {"ankle", "ankle center", "ankle medial"}:
        out.append("ankle")
    if "heel" not in there:
        out.append("heel")
    if not there & {"ball", "toe", *(f"mt{i}" for i in range(1, 6))}:
        out.append("ball (metatarsal 1, 2 or 5)")
    return out


def legs_in(points: dict[Point, str], names: Iterable[str]) -> list[int | None]:
    """Sides of the legs that are whole; [None] for one leg whose side is not said.

    Raises
    ------
    InfeasibleError
        If there is none; says what is needed and what was found.
    """
    sided = [side for side in (LEFT, RIGHT) if not lacking(points, side)]
    if sided:
        return list[int | None](sided)
    if not lacking(points, None):
        return [None]
    best = min((LEFT, RIGHT, None), key=lambda side: len(lacking(points, side)))
    whose = {LEFT: "left leg", RIGHT: "right leg", None: "leg"}[best]
    known = ", ".join(f"{name} ({_spoken(point)})" for point, name in points.items())
    others = [name[:40] for name in names if name not in points.values()]
    more = f", and {len(others) - 8} more" if len(others) > 8 else ""
    raise InfeasibleError(
        "a leg needs markers of hip, knee, ankle, heel and ball of the foot; here the "
        f"{whose} lacks {', '.join(lacking(points, best))}. Understood: {known or 'none'}. "
        f"Not understood: {', '.join(others[:8]) or 'none'}{more}"
    )


def _spoken(point: Point) -> str:
    side, role = point
    return role if side is None else f"{('left', 'right')[side]} {role}"
