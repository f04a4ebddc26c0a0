"""The person in a GLB 2.0 file as a Motion.

What glTF leaves open, and what is made of it:

* **Who.** Joints are those of a skin with the legs of a person, and the nodes between them; in a
  file without skins the nodes of the scene. Of several people the first is read, with a warning.
* **When.** glTF has keys at any time. The frame rate is what the file says it was written with,
  else that of a grid on which all keys lie, else 30, with a warning. Between keys it is as the
  sampler says: straight, by steps, or cubic.
* **Rest.** Joints of the result rest without a turn, where the file's nodes stand. So a rig
  whose bones have axes of their own becomes one that rests as it is drawn.
* Nodes above the joints carry them; what they scale evenly is scaled.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import FileFormatError, GaitsmithWarning, InfeasibleError, InvalidInputError
from gaitsmith.geometry.rotations import (
    IDENTITY,
    from_matrix,
    inverse,
    multiply,
    rotate,
    sign_continuous,
    slerp,
    to_matrix,
)
from gaitsmith.io.bvh_motion import different_names
from gaitsmith.io.glb_file import BROKEN, GlbFile
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.performance import Performance
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

#: Frames a second where nothing tells, and at most; most frames.
USUAL, FASTEST, MOST_FRAMES = 30.0, 1000.0, 1_000_000
#: Keys lie on a grid where none is farther from it than this share of its cell.
ON_GRID = 0.05
#: Rates within this share of a usual one are that one: times are single precision.
NEARLY = 2e-3
RATES = (*range(1, 241), 24000 / 1001, 30000 / 1001, 60000 / 1001)
#: A scale that differs from 1, or over its axes, by less than this (of 1) is none.
EVEN = 1e-3
#: What moves less than this (m) is still.
STILL = 1e-6
#: Nodes at most: deeper and longer files are no people.
MOST_NODES = 20_000
_POINTS = ("Heel", "Ball", "Toe")


def read_glb(path: Path) -> Motion:
    """Motion of the person in the GLB at ``path``; of several the first, with a warning.

    Raises
    ------
    FileFormatError
        If the file is broken, or has no animation of joints; the message says what is wrong.
    OSError
        If it cannot be opened.
    """
    reading = _guarded(path)
    if len(reading.people) > 1:
        shown = ", ".join(name for name, _ in reading.people)
        warnings.warn(
            f"{path}: of the people {shown} the first is taken", GaitsmithWarning, stacklevel=2
        )
    return reading.people[0][1]


def read_glb_performance(path: Path) -> Performance:
    """Everybody in the GLB at ``path``. Raises as :func:`read_glb` does."""
    reading = _guarded(path)
    try:
        names = tuple(name for name, _ in reading.people)
        return Performance(names, tuple(m for _, m in reading.people), reading.surroundings)
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


@dataclass(frozen=True, eq=False)
class _Read:
    people: list[tuple[str, Motion]]
    surroundings: str


def _guarded(path: Path) -> _Read:
    """What is in the file; whatever is wrong with it is a FileFormatError."""
    try:
        return _Reader(GlbFile(path)).read()
    except FileFormatError:
        raise
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None
    except (*BROKEN, RecursionError, MemoryError) as error:
        why = " ".join(str(error).split())[:120] or type(error).__name__
        raise FileFormatError(path, f"its data are not as glTF wants them: {why}") from None


@dataclass(frozen=True, eq=False)
class _Track:
    """Keys of one property of one node."""

    times: Float[np.ndarray, "k"]
    values: Float[np.ndarray, "k n"]
    kind: str

    def at(self, times: Float[np.ndarray, "F"], *, turn: bool) -> Float[np.ndarray, "F n"]:
        """Values at ``times``; the first and the last hold outside."""
        count = len(self.times)
        if self.kind == "CUBICSPLINE":
            values = self.values.reshape(count, 3, -1)
            first, middle, last = values[:, 0], values[:, 1], values[:, 2]
        else:
            middle = self.values
            first = last = middle
        if turn:
            size = np.linalg.norm(middle, axis=-1, keepdims=True)
            middle = np.where(size > 1e-6, middle / np.maximum(size, 1e-6), IDENTITY)
        if count == 1:
            return np.broadcast_to(middle[0], (len(times), middle.shape[1])).copy()
        after = np.clip(np.searchsorted(self.times, times, side="right"), 1, count - 1)
        before = after - 1
        gap = self.times[after] - self.times[before]
        share = np.clip((times - self.times[before]) / gap, 0.0, 1.0)
        # times are single precision: a frame that is meant to lie on a key does
        share = np.where(share < 1e-3, 0.0, np.where(share > 1.0 - 1e-3, 1.0, share))
        if self.kind == "STEP":
            return middle[np.where(share == 1.0, after, before)]
        if self.kind == "CUBICSPLINE":
            u, size = share[:, None], gap[:, None]
            out = (2 * u**3 - 3 * u**2 + 1) * middle[before] + (u**3 - 2 * u**2 + u) * size * last[
                before
            ]
            out += (3 * u**2 - 2 * u**3) * middle[after] + (u**3 - u**2) * size * first[after]
            return out / np.linalg.norm(out, axis=-1, keepdims=True) if turn else out
        if turn:
            return slerp(middle[before], _near(middle[after], middle[before]), share)
        return middle[before] + share[:, None] * (middle[after] - middle[before])


def _near(q: Float[np.ndarray, "F 4"], other: Float[np.ndarray, "F 4"]) -> np.ndarray:
    """The sign of ``q`` with which the way from ``other`` is the short one."""
    return np.where((q * other).sum(-1, keepdims=True) < 0.0, -q, q)


class _Reader:
    """One file, on the way to motions."""

    def __init__(self, file: GlbFile) -> None:
        self.file = file
        self.nodes = file.table("nodes")
        if not 0 < len(self.nodes) <= MOST_NODES:
            raise file.error(f"has {len(self.nodes)} nodes; 1 to {MOST_NODES} are read")
        self.parents = self._parents()
        self.rest = [self._at_rest(k) for k in range(len(self.nodes))]
        extras = file.document.get("asset", {}).get("extras", {}).get("gaitsmith", {})
        self.extras: dict[str, Any] = extras if isinstance(extras, dict) else {}
        told = self.extras.get("walkers")
        #: What this package tells of several people, by name.
        self.own: dict[str, Any] = told if isinstance(told, dict) else {}

    def read(self) -> _Read:
        """Everybody."""
        self.tracks = self._tracks()
        names, own = list(self.own), self.own
        groups = self._groups()
        times = self._times({k for group in groups for k in self._with_above(group)})
        people = []
        for i, joints in enumerate(groups):
            name = names[i] if len(names) == len(groups) else f"walker{i + 1}"
            facts = own.get(name, self.extras)
            prefix = f"{name}_" if name in own else ""
            people.append((name, self._motion(joints, times, facts, prefix)))
        around = self.extras.get("surroundings", "{}")
        return _Read(people, around if isinstance(around, str) else "{}")

    # ------------------------------------------------------------------------- nodes

    def _parents(self) -> list[int]:
        parents = [-1] * len(self.nodes)
        for k, node in enumerate(self.nodes):
            for child in node.get("children", []):
                self.file.item("nodes", child)
                if parents[child] >= 0:
                    raise self.file.error(f"nodes[{child}] has two parents")
                parents[child] = k
        for k in range(len(parents)):
            at, seen = k, 0
            while at >= 0:
                at, seen = parents[at], seen + 1
                if seen > len(parents):
                    raise self.file.error(f"nodes[{k}] is above itself")
        return parents

    def _named(self, k: int) -> str:
        name = self.nodes[k].get("name")
        return name if isinstance(name, str) and name else f"node{k}"

    def _at_rest(self, k: int) -> dict[str, Float[np.ndarray, "n"]]:
        """Translation, rotation and scale of a node as it stands."""
        node = self.nodes[k]
        if "matrix" in node:
            matrix = self._row(k, "matrix", 16, 0.0).reshape(4, 4).T
            size = np.linalg.norm(matrix[:3, :3], axis=0)
            if size.min() < 1e-9 or np.linalg.det(matrix[:3, :3]) <= 0.0:
                raise self.file.error(f"the matrix of node {self._named(k)!r} mirrors or flattens")
            turn = from_matrix(matrix[:3, :3] / size)
            if np.abs(to_matrix(turn) * size - matrix[:3, :3]).max() > EVEN * size.max():
                raise self.file.error(f"the matrix of node {self._named(k)!r} shears, not read")
            return {"translation": matrix[:3, 3], "rotation": turn, "scale": size}
        turn = self._row(k, "rotation", 4, IDENTITY)
        size = np.linalg.norm(turn)
        if not 0.5 < size < 2.0:
            raise self.file.error(f"the rotation of node {self._named(k)!r} is no unit quaternion")
        return {
            "translation": self._row(k, "translation", 3, 0.0),
            "rotation": turn / size,
            "scale": self._row(k, "scale", 3, 1.0),
        }

    def _row(self, k: int, what: str, width: int, default: Any) -> Float[np.ndarray, "n"]:
        row = self.nodes[k].get(what)
        out = np.full(width, default) if row is None else np.array(row, dtype=np.float64)
        if out.shape != (width,) or not np.isfinite(out).all() or np.abs(out).max() > 1e9:
            raise self.file.error(
                f"{what} of node {self._named(k)!r} must be {width} finite numbers"
            )
        return out

    # -------------------------------------------------------------------------- time

    def _tracks(self) -> dict[tuple[int, str], _Track]:
        """Keys by node and property, of the animation that moves most."""
        animations = self.file.table("animations")
        if not animations:
            raise self.file.error("has no animation; a motion needs one")
        most = max(range(len(animations)), key=lambda i: len(animations[i].get("channels", [])))
        if len(animations) > 1:
            shown = animations[most].get("name", f"animation {most + 1}")
            warnings.warn(
                f"{self.file.path}: of {len(animations)} animations the one with most channels is "
                f"read, {shown!r}",
                GaitsmithWarning,
                stacklevel=5,
            )
        animation, found = animations[most], dict[tuple[int, str], _Track]()
        for channel in animation.get("channels", []):
            target = channel.get("target", {})
            node, what = target.get("node"), target.get("path")
            if node is None or what not in ("translation", "rotation", "scale"):
                continue  # the weights of a face, or what an extension moves
            self.file.item("nodes", node)
            found[node, what] = self._track(animation["samplers"][channel["sampler"]], node, what)
        return found

    def _track(self, sampler: dict[str, Any], node: int, what: str) -> _Track:
        named = f"the {what} of node {self._named(node)!r}"
        kind = sampler.get("interpolation", "LINEAR")
        if kind not in ("LINEAR", "STEP", "CUBICSPLINE"):
            raise self.file.error(f"{named}: interpolation {kind!r} is none of glTF")
        times = self.file.numbers(sampler["input"])[:, 0]
        values = self.file.numbers(sampler["output"])
        rows, width = (
            len(times) * (3 if kind == "CUBICSPLINE" else 1),
            4 if what == "rotation" else 3,
        )
        if not len(times) or values.shape != (rows, width):
            raise self.file.error(
                f"{named} needs {rows} rows of {width} numbers for {len(times)} keys, has "
                f"{values.shape[0]} of {values.shape[1]}"
            )
        if (np.diff(times) <= 0.0).any():
            raise self.file.error(f"the keys of {named} must be at rising times")
        if np.abs(values).max() > 1e9:
            raise self.file.error(f"{named} is beyond all measure")
        return _Track(times, values, kind)

    def _times(self, nodes: set[int]) -> Float[np.ndarray, "F"]:
        """Seconds of the frames."""
        every = [t.times for (node, _), t in self.tracks.items() if node in nodes]
        if not every:
            raise self.file.error("its animation moves no joint of a person")
        keys = np.unique(np.concatenate(every))
        first, last = float(keys[0]), float(keys[-1])
        said = self.extras.get("fps")
        if isinstance(said, int | float) and not isinstance(said, bool) and 0.0 < said <= 1e5:
            rate = float(said)
            frames = self.extras.get("frames")
            if isinstance(frames, int) and 0 < frames <= MOST_FRAMES and first == 0.0:
                return np.arange(frames) / rate  # what is still at the end has no keys there
        else:
            rate = self._rate(keys)
        count = round((last - first) * rate) + 1
        if count > MOST_FRAMES:
            raise self.file.error(
                f"lasts {last - first:.0f} s, {count} frames; {MOST_FRAMES} are read"
            )
        self.rate = rate
        return first + np.arange(count) / rate

    def _rate(self, keys: Float[np.ndarray, "k"]) -> float:
        """Frames a second of the grid on which keys lie."""
        gaps = np.diff(keys)
        gaps = gaps[gaps > 1e-4]
        if not len(gaps):
            return USUAL
        near = gaps[gaps < 1.5 * gaps.min()]
        rate = 1.0 / float(near.mean())
        usual = min(RATES, key=lambda r: abs(r - rate))
        if abs(usual - rate) <= NEARLY * rate + 0.5 * rate / max(len(near), 50):
            rate = float(usual)
        at = (keys - keys[0]) * rate
        off = np.abs(at - np.round(at))
        if rate > FASTEST or np.quantile(off, 0.99) > ON_GRID:
            warnings.warn(
                f"{self.file.path}: its keys lie on no grid of frames; {USUAL:g} frames a second "
                "are read",
                GaitsmithWarning,
                stacklevel=6,
            )
            return USUAL
        return rate

    # ------------------------------------------------------------------------ joints

    def _above(self, k: int) -> list[int]:
        """The parent of a node, its parent and so on."""
        out = []
        while (k := self.parents[k]) >= 0:
            out.append(k)
        return out

    def _with_above(self, joints: list[int]) -> set[int]:
        return {*joints, *(k for joint in joints for k in self._above(joint))}

    def _groups(self) -> list[list[int]]:
        """Joints of each person, parents first."""
        marked: list[int] = []
        for skin in self.file.table("skins"):
            for k in skin.get("joints", []):
                self.file.item("nodes", k)
                marked.append(k)
        if not marked:  # whatever is moved, and what is below it, but for meshes and cameras
            marked = [k for k, node in enumerate(self.nodes) if not {"mesh", "camera"} & set(node)]
        marks = set(marked)
        groups: dict[int, list[int]] = {}
        placed: dict[int, int] = {}
        for joint in dict.fromkeys(marked):
            above = self._above(joint)
            tops = [k for k in above if k in marks]
            chain = above[: above.index(tops[-1]) + 1] if tops else []
            root = tops[-1] if tops else joint
            for k in [*reversed(chain), joint]:
                if k not in placed:
                    placed[k] = root
                    groups.setdefault(root, []).append(k)
        people = [joints for joints in groups.values() if self._is_person(joints)]
        return people or [max(groups.values(), key=len)]

    def _is_person(self, joints: list[int]) -> bool:
        names = [self._named(k) for k in joints]
        for name in self.own:
            if all(joint.startswith(f"{name}_") for joint in names):
                names = [joint.removeprefix(f"{name}_") for joint in names]
        try:
            humanoid_roles(names, self._within(joints))
        except InfeasibleError:
            return False
        return True

    def _within(self, joints: list[int]) -> list[int]:
        """Parents as places in ``joints``."""
        place = {k: i for i, k in enumerate(joints)}
        return [place.get(self.parents[k], -1) for k in joints]

    # ------------------------------------------------------------------------ motion

    def _local(self, k: int, what: str, times: Float[np.ndarray, "F"]) -> np.ndarray:
        """``(F, n)`` of a node's property over time; ``(1, n)`` where it is still."""
        track = self.tracks.get((k, what))
        if track is None:
            return self.rest[k][what][None]
        return track.at(times, turn=what == "rotation")

    def _scale(self, k: int, times: Float[np.ndarray, "F"]) -> float:
        """By how much a node scales what is below it."""
        size = self._local(k, "scale", times)
        middle = float(np.median(size))
        if middle <= 0.0 or np.abs(size - middle).max() > EVEN * middle:
            raise self.file.error(
                f"node {self._named(k)!r} is scaled unevenly or over time, which no bone is; apply "
                "its scale before the export"
            )
        return 1.0 if abs(middle - 1.0) < EVEN else middle

    def _motion(
        self, joints: list[int], times: Float[np.ndarray, "F"], facts: Any, prefix: str
    ) -> Motion:
        frames, parents = len(times), self._within(joints)
        carried = self._carried(self._above(joints[0]), times)
        names = different_names(tuple(self._named(k).removeprefix(prefix) for k in joints))
        turned = np.empty((frames, len(joints), 4))
        offsets, moved = np.zeros((len(joints), 3)), np.empty((frames, len(joints), 3))
        still = True
        rest = np.empty((len(joints), 4))  # how joints stand, in the world
        sizes = np.empty(len(joints))
        root = np.empty((frames, 3))
        for j, k in enumerate(joints):
            place = self._local(k, "translation", times)
            turn = self._local(k, "rotation", times)
            own = self.rest[k]
            if parents[j] < 0:
                above, turns, size, shift = carried
                root[:] = shift + size * rotate(turns, np.broadcast_to(place, (frames, 3)))
                rest[j] = multiply(above, own["rotation"])
                turned[:, j] = multiply(multiply(turns, turn), inverse(rest[j])[None])
                offsets[j] = moved[:, j] = 0.0
                sizes[j] = size * self._scale(k, times)
                continue
            up, size = rest[parents[j]], sizes[parents[j]]
            rest[j] = multiply(up, own["rotation"])
            turned[:, j] = multiply(multiply(up[None], turn), inverse(rest[j])[None])
            away = size * rotate(np.broadcast_to(up, (len(place), 4)), place)
            moved[:, j] = away
            fixed = np.ptp(away, axis=0).max() <= STILL
            offsets[j] = away[0] if fixed else size * rotate(up, own["translation"])
            still = still and bool(fixed)
            sizes[j] = size * self._scale(k, times)
        if np.abs(root).max(initial=0.0) > 1e6 or np.abs(moved).max(initial=0.0) > 1e3:
            raise self.file.error("its joints are kilometers apart; is its scale right?")
        turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
        offsets[0] = self._stands(joints[0])
        rate = 1.0 / float(times[1] - times[0]) if frames > 1 else getattr(self, "rate", USUAL)
        usual = self.extras.get("fps")
        return Motion(
            skeleton=Skeleton(names, tuple(parents), offsets),
            root_position=root,
            rotations=sign_continuous(turned),
            fps=float(usual) if isinstance(usual, int | float) and usual > 0 else _tidy(rate),
            contacts=_contacts(facts, frames),
            translations=None if still else moved,
        )

    def _carried(
        self, above: list[int], times: Float[np.ndarray, "F"]
    ) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Of the nodes above the root: turn at rest, turn, scale and shift over time."""
        stands, turns = np.array(IDENTITY), np.tile(IDENTITY, (len(times), 1))
        size, shift = 1.0, np.zeros((len(times), 3))
        for k in reversed(above):
            place = np.broadcast_to(self._local(k, "translation", times), (len(times), 3))
            shift = shift + size * rotate(turns, place)
            turns = multiply(turns, np.broadcast_to(self._local(k, "rotation", times), turns.shape))
            stands = multiply(stands, self.rest[k]["rotation"])
            size *= self._scale(k, times)
        return stands, turns, size, shift

    def _stands(self, root: int) -> Float[np.ndarray, "3"]:
        """Where the root stands at rest, in the world, meters."""
        point = self.rest[root]["translation"]
        for k in self._above(root):
            own = self.rest[k]
            point = own["translation"] + rotate(own["rotation"], own["scale"] * point)
        return point


def _tidy(rate: float) -> float:
    """A whole number of frames a second, where it is one but for rounding."""
    return float(round(rate)) if abs(rate - round(rate)) < 1e-6 * rate else rate


def _contacts(facts: Any, frames: int) -> np.ndarray | None:
    """Flags of the intervals that this package writes; None without them."""
    told = facts.get("contacts") if isinstance(facts, dict) else None
    if not isinstance(told, dict):
        return None
    out = np.zeros((frames, 2, 3), dtype=np.bool_)
    for s, side in enumerate(SIDES):
        for p, point in enumerate(_POINTS):
            for first, last in told[f"{side}{point}"]:
                out[int(first) : int(last) + 1, s, p] = True
    return out
