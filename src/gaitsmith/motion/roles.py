"""Which joint of any rig is which bone of a human: names of many dialects to VRM's.

A name is taken apart into words (at separators, capitals and digits), prefixes of programs
are dropped, a side is recognised wherever it stands, and what is left is looked up in the
tables below. Where two dialects use one word for two bones (``Leg``, ``Shoulder``, ``Foot``,
``Hip``), the other names of the rig decide: the tables are in order of preference, and a
joint is used once. The hierarchy has the last word: a shin hangs on its thigh.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

#: Roles that a walk needs.
WALKING: tuple[str, ...] = (
    "hips",
    *(f"{side}{part}" for side in SIDES for part in ("UpperLeg", "LowerLeg", "Foot")),
)
#: Words of each bone that has a side, the surest first. Bones in this order take their joint.
_SIDED: dict[str, tuple[str, ...]] = {
    # Mixamo, Bandai and VRM, 3ds Max and Blender, ASF and OpenSim, Daz; then the joints' names
    "UpperLeg": (
        *("upperleg", "upleg", "thigh", "femur", "thighbend", "legupper", "uleg"),
        *("hip", "hipjoint", "leg"),
    ),
    "LowerLeg": (
        *("lowerleg", "lowleg", "calf", "shin", "tibia", "shank", "leglower", "lleg"),
        *("knee", "leg"),
    ),
    # an ankle beside a foot: that foot is the toes (SMPL)
    "Foot": ("ankle", "talus", "foot", "calcn"),
    "Toes": ("toes", "toebase", "toe", "ball", "metatarsals", "metatarsal", "foot"),
    "UpperArm": (
        *("upperarm", "uparm", "humerus", "shldr", "shldrbend", "armupper"),
        *("arm", "shoulder"),
    ),
    "LowerArm": (
        *("lowerarm", "lowarm", "forearm", "forearmbend", "ulna", "radius", "armlower"),
        "elbow",
    ),
    # of CMU's wrist and hand the wrist is where the hand turns
    "Hand": ("wrist", "hand"),
    "Shoulder": ("clavicle", "collar", "collarbone", "scapula", "shoulder"),
}
_HIPS = ("hips", "pelvis", "hip", "root", "cog")
_SPINE = (
    *("spine", "tospine", "lowerspine", "upperspine", "lowerback", "upperback", "back"),
    *("waist", "abdomen", "abdomenlower", "abdomenupper", "belly", "torso", "trunk"),
    *("chest", "chestlower", "chestupper", "upperchest", "thorax", "ribcage", "ribs"),
)
_NECK = ("neck", "lowerneck", "necklower", "upperneck", "neckupper")
_SPINE_ROLES = {1: ("spine",), 2: ("spine", "chest"), 3: ("spine", "chest", "upperChest")}
#: What programs put before or behind a name.
_PREFIXES = {
    *("mixamorig", "bip", "biped", "valve", "character", "cc", "base", "j", "jnt"),
    *("joint", "def", "org", "bone", "rig", "skeleton", "armature", "skel", "bind", "c", "b"),
}
_SUFFIXES = {"joint", "jnt", "bone", "bind", "def"}
_SIDE_WORDS = {"left": "left", "l": "left", "lft": "left", "right": "right", "r": "right"}
_WORDS_WITH_A_SIDE = frozenset(word for words in _SIDED.values() for word in words) | {
    *("fingers", "thumb", "hipjoint", "handindex")
}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


@dataclass(frozen=True)
class Roles:
    """What :func:`humanoid_roles` found.

    Attributes
    ----------
    joints
        Index of the joint of each VRM humanoid bone that was found, parents first.
    unassigned
        Joints that are none of them: helpers, fingers, twists, faces.
    """

    joints: dict[str, int]
    unassigned: tuple[int, ...]


def humanoid_roles(
    names: Sequence[str],
    parents: Sequence[int] | None = None,
    *,
    need: Iterable[str] = WALKING,
) -> Roles:
    """Find the VRM humanoid bones among joints named in any known dialect.

    Parameters
    ----------
    names
        Joint names: Mixamo, CMU/cgspeed, ACCAD, Bandai-Namco, ASF, 3ds Max Biped, Unreal,
        Blender, Daz, SMPL, OpenSim, VRM and the like, in any case, with any separators.
    parents
        Index of each joint's parent, -1 for none. With them the spine is what lies between
        hips and neck, and a bone that does not hang on the one it should is not taken.
    need
        Roles without which this fails; ``()`` takes what there is.

    Returns
    -------
    Joints by role, and what is left over. One to three joints of the spine are spine, chest
    and upperChest in order; of more, the first, the middle one and the last.

    Raises
    ------
    InfeasibleError
        If a role of ``need`` is missing; names all that are.

    Examples
    --------
    >>> names = ["Hips", "thigh.L", "shin.L", "foot.L", "thigh.R", "shin.R", "foot.R"]
    >>> humanoid_roles(names).joints["leftLowerLeg"]
    2
    """
    rig = _Rig(names, parents)
    found: dict[str, int] = {}
    for side in SIDES:
        found |= _limbs(rig, side)
    hips = _hips(rig, found)
    if hips is not None:
        found["hips"] = hips
    found |= _trunk(rig, found)
    missing = [role for role in need if role not in found]
    if missing:
        shown = ", ".join(name[:30] for name in names[:12]) + (", ..." if len(names) > 12 else "")
        raise InfeasibleError(
            f"no joint is recognised as {', '.join(missing)}, which walking needs; the joints "
            f"are {shown}"
        )
    used = set(found.values())
    order = sorted(found, key=lambda role: (found[role], role))
    return Roles(
        joints={role: found[role] for role in order},
        unassigned=tuple(joint for joint in range(len(names)) if joint not in used),
    )


@dataclass(frozen=True)
class _Joint:
    """A name taken apart: side or "", words in one, the same without suffix, its number."""

    side: str
    word: str
    short: str
    number: int


class _Rig:
    """Joints by word, and who hangs on whom."""

    def __init__(self, names: Sequence[str], parents: Sequence[int] | None) -> None:
        self.joints = [_taken_apart(name) for name in names]
        self.parents = parents
        self.by_word: dict[tuple[str, str], list[int]] = {}
        for index, joint in enumerate(self.joints):
            self.by_word.setdefault((joint.side, joint.word), []).append(index)
            if joint.short != joint.word:
                self.by_word.setdefault((joint.side, joint.short + "*"), []).append(index)

    def candidates(self, side: str, words: Iterable[str]) -> Iterator[int]:
        """Joints of these words, the surest first."""
        for word in words:
            for spelling in (word, word + "*"):
                here = self.by_word.get((side, spelling), [])
                yield from sorted(here, key=lambda i: (self.joints[i].number, i))

    def above(self, joint: int) -> Iterator[int]:
        """The parent, its parent and so on."""
        assert self.parents is not None
        while (joint := self.parents[joint]) >= 0:
            yield joint

    def hangs_on(self, joint: int, ancestor: int) -> bool:
        """Whether ``joint`` is below ``ancestor``; True where nobody knows."""
        return self.parents is None or ancestor in self.above(joint)


def _taken_apart(name: str) -> _Joint:
    words = [word.lower() for word in _WORD.findall(re.split(r"[:|]", name)[-1])]
    number = 0
    while words and words[-1].isdigit():
        number = int(words.pop()[-6:])
    while len(words) > 1 and (words[0] in _PREFIXES or words[0].isdigit()):
        words.pop(0)
    side = ""
    for i, word in enumerate(words):
        if word in _SIDE_WORDS and len(words) > 1:
            side = _SIDE_WORDS[word]
            del words[i]
            break
    while words and words[-1].isdigit():  # the number before a side: toe_01_l
        number = int(words.pop()[-6:])
    joined = "".join(words)
    if not side:
        side, joined = _glued_side(joined)
    short = joined
    if len(words) > 1 and words[-1] in _SUFFIXES:
        short = "".join(words[:-1])
    return _Joint(side, joined, short, number)


def _glued_side(word: str) -> tuple[str, str]:
    """Side of names in one case: ``lfemur``, ``RIGHTUPLEG``, ``lefthand``."""
    for start, side in sorted(_SIDE_WORDS.items(), key=lambda pair: -len(pair[0])):
        rest = word.removeprefix(start)
        if rest != word and rest in _WORDS_WITH_A_SIDE:
            return side, rest
    return "", word


def _limbs(rig: _Rig, side: str) -> dict[str, int]:
    """Leg and arm of a side: each bone the surest name that hangs on the bone before."""
    found: dict[str, int] = {}
    before = {"LowerLeg": "UpperLeg", "Foot": "LowerLeg", "Toes": "Foot"}
    before |= {"LowerArm": "UpperArm", "Hand": "LowerArm"}
    for part, words in _SIDED.items():
        hangs_on = before.get(part)
        parent = found.get(f"{side}{hangs_on}") if hangs_on else None
        if hangs_on and parent is None:
            continue
        for joint in rig.candidates(side, words):
            fits = parent is None or rig.hangs_on(joint, parent)
            if part == "Shoulder" and f"{side}UpperArm" in found:
                fits = rig.hangs_on(found[f"{side}UpperArm"], joint)
            if fits and joint not in found.values():
                found[f"{side}{part}"] = joint
                break
    return found


def _hips(rig: _Rig, found: dict[str, int]) -> int | None:
    """The joint called so that both legs hang on, and the spine; else the one they share."""
    named = list(rig.candidates("", _HIPS))
    legs = [found[f"{side}UpperLeg"] for side in SIDES if f"{side}UpperLeg" in found]
    if rig.parents is None or len(legs) < len(SIDES):
        if not named and rig.joints and rig.joints[0].word == "spine":  # Blender's
            return 0
        return named[0] if named else None
    spine = list(rig.candidates("", ("head", *_NECK, *_SPINE)))[:1]
    for need in (legs + spine, legs):
        for joint in named:
            if all(rig.hangs_on(below, joint) for below in need):
                return joint
    right = set(rig.above(legs[1]))
    return next((joint for joint in rig.above(legs[0]) if joint in right), None)


def _trunk(rig: _Rig, found: dict[str, int]) -> dict[str, int]:
    """Spine, chest, upperChest, neck and head."""
    trunk: dict[str, int] = {}
    hips, taken = found.get("hips"), set(found.values())
    head = next((j for j in rig.candidates("", ("head",)) if j not in taken), None)
    if head is not None:
        trunk["head"] = head
    necks = [j for j in rig.candidates("", _NECK) if j not in taken]
    spines = [j for j in rig.candidates("", _SPINE) if j not in taken]
    if rig.parents is not None and hips is not None:
        # between hips and head all that is no neck is spine, whatever its name
        top = head if head is not None else min(necks, default=max(spines, default=None))
        if top is not None and rig.hangs_on(top, hips):
            path = list(rig.above(top))
            path = path[: path.index(hips)] + ([top] if head is None else [])
            necks = [j for j in necks if j in path]
            low = min(necks, default=len(rig.joints))
            spines = [j for j in path if j < low and j not in taken and j not in necks]
    if necks:
        trunk["neck"] = min(necks)
    spines = sorted(set(spines))
    if len(spines) > 3:
        spines = [spines[0], spines[len(spines) // 2], spines[-1]]
    trunk |= dict(zip(_SPINE_ROLES.get(len(spines), ()), spines, strict=True))
    return trunk
