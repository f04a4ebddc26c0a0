"""Acclaim skeletons (.asf): bones with their axes and degrees of freedom.

A bone is named by a direction and a length in the world of the rest pose; the joint that
turns it is at its start, the end of its parent. Angles are about the bone's own axes, which
``axis`` turns away from the world's. ``axis 0 0 20 XYZ`` and ``dof rx ry rz`` apply x first:
the matrix is Rz Ry Rx.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.rotations import IDENTITY, about, multiply
from gaitsmith.io._lines import Lines

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jaxtyping import Float

_MOST_BONES = 4096
#: Degrees of freedom of a bone. ``l`` (its length) and translations are read past: no
#: known data base has them.
_DOFS = {"rx", "ry", "rz"}
_ROOT_DOFS = {"tx", "ty", "tz", *_DOFS}


@dataclass(frozen=True)
class Bone:
    """One bone, in the file's unit; ``axes`` is the rotation of its axes at rest."""

    name: str
    vector: tuple[float, float, float]
    axes: Float[np.ndarray, "4"]
    dofs: tuple[str, ...]


@dataclass(frozen=True)
class Asf:
    """A skeleton: bones, parents first, the first one the root (without length).

    ``unit_length`` is the number of the file's units in an inch times that number: CMU's 0.45.
    """

    bones: tuple[Bone, ...]
    parents: tuple[int, ...]
    unit_length: float
    degrees: bool


@dataclass
class _Draft:
    """What was read so far."""

    bones: dict[str, Bone]
    children: dict[str, list[str]]
    unit_length: float = 1.0
    degrees: bool = True


def read_asf(path: Path) -> Asf:
    """Read the Acclaim skeleton at ``path``.

    Raises
    ------
    FileFormatError
        If it is none or a broken one; names the line.
    OSError
        If it cannot be opened.
    """
    lines, draft = Lines(path), _Draft({}, {})
    section, fields = "", dict[str, list[str]]()
    while (line := lines.next()) is not None:
        words = line.split("#")[0].replace("(", " ").replace(")", " ").split()
        if not words:
            continue
        if words[0].startswith(":"):
            if section == "root":
                _add_root(lines, draft, fields)
            section, fields = words[0][1:].lower(), {}
        elif section == "units" and len(words) > 1:
            _unit(lines, draft, words)
        elif section == "root":
            fields[words[0].lower()] = words[1:]
        elif section == "bonedata":
            if words[0].lower() == "end":
                _add_bone(lines, draft, fields)
            fields = {} if words[0].lower() in ("begin", "end") else fields
            fields[words[0].lower()] = words[1:]
        elif section == "hierarchy" and words[0].lower() not in ("begin", "end"):
            draft.children.setdefault(words[0], []).extend(words[1:])
    return _asf(lines, draft)


def _unit(lines: Lines, draft: _Draft, words: list[str]) -> None:
    if words[0].lower() == "length":
        draft.unit_length = lines.value(words[1], "the unit of length")
        if draft.unit_length <= 0.0:
            lines.fail(f"the unit of length must be positive, got {draft.unit_length:g}")
    elif words[0].lower() == "angle":
        draft.degrees = not words[1].lower().startswith("rad")


def _axes(lines: Lines, draft: _Draft, words: Sequence[str], what: str) -> Float[np.ndarray, "4"]:
    """Rotation of ``20 0 0 XYZ``."""
    if len(words) < 3:
        lines.fail(f"{what} needs three angles, got {len(words)}")
    angles = [lines.value(word, what) for word in words[:3]]
    order = words[3].lower() if len(words) > 3 else "xyz"
    if sorted(order) != list("xyz"):
        lines.fail(f"{what} must name the three axes in some order, got {order[:20]!r}")
    out = IDENTITY
    for axis, angle in zip(order, angles, strict=True):
        out = multiply(about(axis, np.radians(angle) if draft.degrees else angle), out)
    return out


def _add_root(lines: Lines, draft: _Draft, fields: dict[str, list[str]]) -> None:
    dofs = tuple(word.lower() for word in fields.get("order", ()))
    if not set(dofs) <= _ROOT_DOFS or len(set(dofs)) < len(dofs):
        lines.fail(f"the root's order has other words than {', '.join(sorted(_ROOT_DOFS))}")
    order = (fields.get("axis") or ["XYZ"])[0]
    words = [*(fields.get("orientation") or ["0", "0", "0"]), order]
    axes = _axes(lines, draft, words, "the root's orientation")
    draft.bones["root"] = Bone("root", (0.0, 0.0, 0.0), axes, dofs)


def _add_bone(lines: Lines, draft: _Draft, fields: dict[str, list[str]]) -> None:
    name = " ".join(fields.get("name", ()))
    if not name or name in draft.bones:
        lines.fail(f"a bone {'twice: ' + name[:40] if name else 'without a name'}")
    if len(draft.bones) == _MOST_BONES:
        lines.fail(f"more than {_MOST_BONES} bones")
    direction, length = fields.get("direction", ()), fields.get("length", ())
    if len(direction) < 3 or not length:
        lines.fail(f"bone {name[:40]!r} needs a direction and a length")
    size = lines.value(length[0], "length")
    x, y, z = (size * lines.value(word, "direction") for word in direction[:3])
    dofs = tuple(word.lower() for word in fields.get("dof", ()))
    if not set(dofs) <= _DOFS or len(set(dofs)) < len(dofs):
        lines.fail(f"bone {name[:40]!r} has other degrees of freedom than rx, ry, rz")
    axes = _axes(lines, draft, fields.get("axis", ("0", "0", "0")), "axis")
    draft.bones[name] = Bone(name, (x, y, z), axes, dofs)


def _asf(lines: Lines, draft: _Draft) -> Asf:
    if "root" not in draft.bones:
        lines.fail("this is no Acclaim skeleton: it has no :root")
    order, parents, ahead = list[str](), list[int](), [("root", -1)]
    seen: set[str] = set()
    while ahead:
        name, parent = ahead.pop()
        if name not in draft.bones:
            lines.fail(f"the hierarchy names {name[:40]!r}, which is no bone")
        if name in seen:
            lines.fail(f"bone {name[:40]!r} stands twice in the hierarchy")
        seen.add(name)
        order.append(name)
        parents.append(parent)
        here = len(order) - 1
        ahead.extend((child, here) for child in reversed(draft.children.get(name, [])))
    if loose := [name for name in draft.bones if name not in seen]:
        lines.fail(f"bone {loose[0][:40]!r} hangs on nothing")
    bones = tuple(draft.bones[name] for name in order)
    return Asf(bones, tuple(parents), draft.unit_length, draft.degrees)
