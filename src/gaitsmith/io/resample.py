"""A motion or a BVH at another frame rate: rotations by slerp, positions in straight lines.

Frames of the new rate start at the first old one and end at or before the last. Where a new
frame falls on an old one it is that frame, to the last bit.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import from_euler, sign_continuous, slerp, to_euler
from gaitsmith.io.bvh_file import ROTATIONS, BvhFile
from gaitsmith.io.units import frame_rate
from gaitsmith.motion.motion import Labels, Motion

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: Fractions of a frame that are no difference: rates are rounded to some digits.
_SAME = 1e-6
_FASTEST = 10_000.0


@dataclass(frozen=True)
class _Grid:
    """New frames between old ones: old frame before, old frame after, fraction of the way."""

    before: Int[np.ndarray, "frames"]
    after: Int[np.ndarray, "frames"]
    way: Float[np.ndarray, "frames"]

    def mix(self, values: Float[np.ndarray, "old *n"]) -> Float[np.ndarray, "frames *n"]:
        """Straight lines; old values where the way is 0."""
        way = self.way.reshape(-1, *[1] * (values.ndim - 1))
        start = values[self.before]
        return np.where(way == 0.0, start, start + way * (values[self.after] - start))

    def turn(self, q: Float[np.ndarray, "old *n 4"]) -> Float[np.ndarray, "frames *n 4"]:
        """Slerp; old rotations where the way is 0."""
        way = self.way.reshape(-1, *[1] * (q.ndim - 2))
        start = q[self.before]
        turned = slerp(start, q[self.after], way)
        turned /= np.linalg.norm(turned, axis=-1, keepdims=True)
        return np.where(way[..., None] == 0.0, start, turned)


def _grid(frames: int, old: float, new: float) -> _Grid:
    positive("fps", new, "frames per second")
    if new > _FASTEST:
        raise InvalidInputError(f"fps must be at most {_FASTEST:g}, got {new:g}")
    if frames == 0:
        none = np.zeros(0, np.int64)
        return _Grid(none, none, np.zeros(0))
    count = int(np.floor((frames - 1) * new / old + _SAME)) + 1
    at = np.arange(count) * (old / new)
    near = np.rint(at)
    at = np.where(np.abs(at - near) < _SAME * np.maximum(1.0, at), near, at)
    before = np.minimum(np.floor(at).astype(np.int64), frames - 1)
    return _Grid(before, np.minimum(before + 1, frames - 1), at - before)


def resampled(motion: Motion, fps: float) -> Motion:
    """``motion`` at ``fps`` frames per second.

    A contact holds between two old frames that both have it. The recipe tells that the motion
    was resampled, for it no longer regenerates it to the byte.
    """
    grid = _grid(len(motion), motion.fps, fps)
    contacts, moved = motion.contacts, motion.translations
    return Motion(
        skeleton=motion.skeleton,
        root_position=grid.mix(motion.root_position),
        rotations=sign_continuous(grid.turn(motion.rotations)),
        fps=fps,
        contacts=None
        if contacts is None
        else contacts[grid.before] & (contacts[grid.after] | (grid.way == 0.0)[:, None, None]),
        translations=None if moved is None else grid.mix(moved),
        labels=None if motion.labels is None else _labels(motion.labels, grid, motion.fps, fps),
    )


def _labels(labels: Labels, grid: _Grid, old: float, fps: float) -> Labels:
    """Phases go on evenly between landings, whose times are known."""
    a, b = grid.before, grid.after
    here = a / old
    time, landing = here + grid.way / old, labels.footstep_time[labels.step[a]]
    same = (labels.step[a] == labels.step[b]) | (time < landing)
    # up to the landing the phase goes to 1; behind it, from 0 to that of the frame after
    rise = np.clip((time - here) / np.maximum(landing - here, 1e-12), 0.0, 1.0)
    fresh = np.clip((time - landing) / np.maximum(b / old - landing, 1e-12), 0.0, 1.0)
    phase_a, exact = labels.phase[a], grid.way == 0.0
    phase = np.where(same, phase_a + rise * (1.0 - phase_a), fresh * labels.phase[b])
    return Labels(
        phase=np.where(exact, phase_a, np.clip(phase, 0.0, 1.0)),
        step=np.where(exact | same, labels.step[a], labels.step[b]),
        footstep_side=labels.footstep_side,
        footstep_position=labels.footstep_position,
        footstep_heading=labels.footstep_heading,
        footstep_time=labels.footstep_time,
        ground=labels.ground,
        recipe=json.dumps({"resampled": {"fps": fps}, "from": json.loads(labels.recipe)}),
        path=labels.path,
    )


def resampled_bvh(file: BvhFile, fps: float) -> BvhFile:
    """``file`` at ``fps`` frames per second: same joints, channels and orders.

    Angles stay on the turn that the file's are on.
    """
    grid = _grid(len(file), frame_rate(file.frame_time), fps)
    values = grid.mix(file.values)
    for names, columns in zip(file.channels, file.columns, strict=True):
        where = [i for i, name in enumerate(names) if name in ROTATIONS]
        if not where:
            continue
        here = np.arange(columns.start, columns.stop)[where]
        angles = np.unwrap(file.values[:, here], axis=0, period=360.0)
        order = "".join(names[i][0] for i in where).lower()
        straight = grid.mix(angles)
        if len(where) == 3 and order[0] != order[1] != order[2]:
            q = from_euler(order, np.radians(angles))
            bent = _nearest(order, to_euler(order, grid.turn(q)), np.radians(straight))
            straight = np.where((grid.way == 0.0)[:, None], straight, np.degrees(bent))
        values[:, here] = straight
    return file.with_(values=values, frame_time=round(1.0 / fps, 10))


def _nearest(
    order: str, angles: Float[np.ndarray, "frames 3"], wanted: Float[np.ndarray, "frames 3"]
) -> Float[np.ndarray, "frames 3"]:
    """Of all triples of the same rotations the ones nearest to ``wanted``."""
    first, second, third = angles.T
    flipped = np.pi - second if order[0] != order[2] else -second
    pair = np.stack([angles, np.stack([first + np.pi, flipped, third + np.pi], axis=-1)])
    pair += 2.0 * np.pi * np.rint((wanted - pair) / (2.0 * np.pi))
    best = np.abs(pair - wanted).sum(axis=-1).argmin(axis=0)
    return pair[best, np.arange(len(angles))]
