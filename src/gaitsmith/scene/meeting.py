"""Where two people of a performance walk through each other: capsules of bodies in time."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.motion.kinematics import joint_positions

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.motion.performance import Performance

#: Capsules of a body: from joint, to joint, radius over stature. The trunk's is half the depth
#: of a chest and less than half its width, which shoulders and arms cover; hands and toes are
#: left out: they may brush.
CAPSULES: tuple[tuple[str, str, float], ...] = (
    ("hips", "neck", 0.070),
    ("neck", "head", 0.050),
    ("leftUpperArm", "rightUpperArm", 0.045),
    *(
        (f"{side}{begin}", f"{side}{end}", radius)
        for side in SIDES
        for begin, end, radius in (
            ("UpperArm", "LowerArm", 0.026),
            ("LowerArm", "Hand", 0.020),
            ("UpperLeg", "LowerLeg", 0.043),
            ("LowerLeg", "Foot", 0.028),
        )
    ),
)
#: The head: a ball so far above its joint and so wide, over stature.
HEAD_UP, HEAD = 0.040, 0.058
#: Bodies overlap where capsules do by more than this, meters: clothes give.
TOUCH = 0.01
#: Encounters of the same two closer in time than this are one, seconds.
APART = 1.0
#: Pairs of capsules times frames that are worked on at once.
BLOCK = 400


@dataclass(frozen=True)
class Encounter:
    """Two people in one place.

    Attributes
    ----------
    names
        Of the two.
    begin, end
        First and last second in which their bodies overlap.
    time, depth, place
        When they overlap most, seconds; by how much, meters; x,z there.
    """

    names: tuple[str, str]
    begin: float
    end: float
    time: float
    depth: float
    place: tuple[float, float]

    @property
    def text(self) -> str:
        """A sentence that says so."""
        x, z = self.place
        return (
            f"{self.names[0]} and {self.names[1]} walk through each other at {self.time:.2f} s "
            f"near {x:.2f},{z:.2f}: their bodies overlap by up to {100.0 * self.depth:.0f} cm "
            f"from {self.begin:.2f} to {self.end:.2f} s; let one begin later or walk elsewhere"
        )


def encounters(performance: Performance) -> list[Encounter]:
    """All encounters, in order of time; people without the joints of one are left out."""
    bodies = {name: shape for name, motion in performance if (shape := _shape(motion)) is not None}
    found: list[Encounter] = []
    for one, other in combinations(bodies, 2):
        found += _between((one, other), bodies[one], bodies[other], performance.fps)
    return sorted(found, key=lambda e: e.begin)


@dataclass(frozen=True, eq=False)
class _Shape:
    """Capsules of one person: ends (F, C, 3), radii (C,), and how far they reach from the hips."""

    begin: Float[np.ndarray, "F C 3"]
    end: Float[np.ndarray, "F C 3"]
    radius: Float[np.ndarray, "C"]
    root: Float[np.ndarray, "F 2"]
    reach: float


def _shape(motion: Motion) -> _Shape | None:
    skeleton = motion.skeleton
    if not {joint for a, b, _ in CAPSULES for joint in (a, b)} <= set(skeleton.names):
        return None
    rest = skeleton.rest_positions()
    # the crown is 0.09 of the stature above the head's joint
    stature = float(rest[skeleton.index("head"), 1]) / 0.91
    at = joint_positions(motion)
    parts = [(at[:, skeleton.index(a)], at[:, skeleton.index(b)], r) for a, b, r in CAPSULES]
    top = at[:, skeleton.index("head")] + [0.0, HEAD_UP * stature, 0.0]
    parts.append((top, top, HEAD))
    begin, end = (np.stack([part[k] for part in parts], axis=1) for k in (0, 1))
    radius = stature * np.array([part[2] for part in parts])
    root = motion.root_position[:, [0, 2]]
    away = [np.linalg.norm(e[..., [0, 2]] - root[:, None], axis=-1) for e in (begin, end)]
    return _Shape(begin, end, radius, root, float((np.maximum(*away) + radius).max()))


def _between(names: tuple[str, str], a: _Shape, b: _Shape, fps: float) -> list[Encounter]:
    near = np.flatnonzero(np.linalg.norm(a.root - b.root, axis=1) < a.reach + b.reach)
    depth, place = np.full(len(near), -np.inf), np.zeros((len(near), 2))
    for start in range(0, len(near), BLOCK):
        rows = slice(start, start + BLOCK)
        depth[rows], place[rows] = _deepest(a, b, near[rows])
    inside = depth > TOUCH
    frames, depth, place = near[inside], depth[inside], place[inside]
    if not len(frames):
        return []
    cuts = np.flatnonzero(np.diff(frames) > APART * fps) + 1
    found: list[Encounter] = []
    for run in np.split(np.arange(len(frames)), cuts):
        most = run[int(depth[run].argmax())]
        found.append(
            Encounter(
                names=names,
                begin=float(frames[run[0]] / fps),
                end=float(frames[run[-1]] / fps),
                time=float(frames[most] / fps),
                depth=float(depth[most]),
                place=(float(place[most, 0]), float(place[most, 1])),
            )
        )
    return found


def _deepest(
    a: _Shape, b: _Shape, frames: np.ndarray
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 2"]]:
    """How far the capsules of two people overlap at most in each frame, and x,z there."""
    p, q = a.begin[frames][:, :, None], a.end[frames][:, :, None]
    r, s = b.begin[frames][:, None], b.end[frames][:, None]
    on_a, on_b = closest_points(p, q, r, s)
    gap = np.linalg.norm(on_a - on_b, axis=-1)
    depth = (a.radius[:, None] + b.radius - gap).reshape(len(frames), -1)
    which = depth.argmax(axis=1)
    rows = np.arange(len(frames))
    middle = (0.5 * (on_a + on_b)).reshape(len(frames), -1, 3)[rows, which]
    return depth[rows, which], middle[:, [0, 2]]


def closest_points(
    p: Float[np.ndarray, "*n 3"],
    q: Float[np.ndarray, "*n 3"],
    r: Float[np.ndarray, "*n 3"],
    s: Float[np.ndarray, "*n 3"],
) -> tuple[Float[np.ndarray, "*n 3"], Float[np.ndarray, "*n 3"]]:
    """The points of segments pq and rs that are nearest to each other; segments may be points."""
    u, v, w = q - p, s - r, p - r
    a, b, c = (u * u).sum(-1), (u * v).sum(-1), (v * v).sum(-1)
    d, e = (u * w).sum(-1), (v * w).sum(-1)
    tiny = 1e-12
    # on the lines, then clamped to pq, then to rs, then to pq again (Ericson 2005, 5.1.9)
    cross = a * c - b * b
    t = np.where(cross > tiny, np.clip((b * e - c * d) / np.maximum(cross, tiny), 0.0, 1.0), 0.0)
    k = np.clip((b * t + e) / np.maximum(c, tiny), 0.0, 1.0)
    t = np.clip((b * k - d) / np.maximum(a, tiny), 0.0, 1.0)
    return p + t[..., None] * u, r + k[..., None] * v
