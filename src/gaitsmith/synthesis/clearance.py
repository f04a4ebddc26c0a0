"""How near a walking body comes to what stands around it: capsules against polygons and rods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.bulk import Bulk, bulk_of
from gaitsmith.body.rig import skeleton_of
from gaitsmith.geometry.solids import polygon_apart, segments_apart
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.synthesis.sample import local_rotations

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.contact import Poses
    from gaitsmith.ground import Ground
    from gaitsmith.plan.surroundings import Bar, Obstacle, Post, Surroundings
    from gaitsmith.synthesis.step import PreparedWalk

    Thing = Obstacle | Bar | Post

#: Frames a second that are looked at to bend, and to tell what is touched; how many at a time.
LOOKS, CLOSE_LOOKS, BLOCK = 60.0, 120.0, 600
#: No part of a body is farther than this from its hips, over the stature.
REACH = 0.75


@dataclass(frozen=True)
class Touch:
    """The worst that a walk does to one thing that stands around.

    ``gap`` is the smallest distance between body and thing, meters, below 0 inside it; ``at``
    the x,y,z of the body's ``part`` there and ``time`` the second.
    """

    thing: Thing
    gap: float
    part: str
    at: tuple[float, float, float]
    time: float


class Watch:
    """The capsules of a body over its poses, and their distances from things."""

    def __init__(self, body: Body, ground: Ground) -> None:
        self.body, self.ground = body, ground
        self.bulk: Bulk = bulk_of(body)
        self.skeleton = skeleton_of(body)

    def axes(self, poses: Poses) -> Float[np.ndarray, "F K 2 3"]:
        """Ends of the axes of all capsules."""
        turned = local_rotations(poses, self.body, self.skeleton).transpose(2, 0, 1)
        return self.bulk.axes(
            self.skeleton, *forward_kinematics(self.skeleton, poses.center, turned)
        )

    def gaps(self, axes: Float[np.ndarray, "F K 2 3"], thing: Thing) -> Float[np.ndarray, "F K"]:
        """Distance of every capsule from ``thing``, meters; below 0 where they meet."""
        a, b = axes[:, :, 0], axes[:, :, 1]
        corners = getattr(thing, "points", None)
        if corners is not None:
            return self._from_outline(a, b, np.array(corners), getattr(thing, "height", None))
        begin, end, radius = rod(thing)  # type: ignore[arg-type]
        return segments_apart(a, b, begin, end) - radius - self.bulk.radius

    def _from_outline(
        self,
        a: Float[np.ndarray, "F K 3"],
        b: Float[np.ndarray, "F K 3"],
        corners: Float[np.ndarray, "m 2"],
        top: float | None,
    ) -> Float[np.ndarray, "F K"]:
        """Distances of capsules from a solid up to a height over the ground, at least these."""
        flat, radius = [0, 2], self.bulk.radius
        if top is None:
            return polygon_apart(a[..., flat], b[..., flat], corners) - radius
        a_over, b_over = (p[..., 1] - self.ground.height(p[..., 0], p[..., 2]) for p in (a, b))
        swap = a_over > b_over
        foot, head = np.where(swap[..., None], b, a), np.where(swap[..., None], a, b)
        rise = np.maximum(np.abs(a_over - b_over), 1e-12)
        over = np.minimum(a_over, b_over) - top - radius
        share = np.where(over > 0.0, 1.0, np.clip(-over / rise, 0.0, 1.0))[..., None]
        low = foot + share * (head - foot)  # what is higher touches nothing
        return np.maximum(polygon_apart(foot[..., flat], low[..., flat], corners) - radius, over)


def rod(
    thing: Bar | Post,
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"], float]:
    """Axis and radius of a bar or a post, whose ends are round: a post's lie within it."""
    height = getattr(thing, "height", None)
    if height is not None:
        (x0, z0), (x1, z1) = thing.begin, thing.end  # type: ignore[union-attr]
        level = height + thing.radius
        return np.array([x0, level, z0]), np.array([x1, level, z1]), thing.radius
    x, z = thing.at  # type: ignore[union-attr]
    return np.array([x, thing.bottom, z]), np.array([x, thing.top, z]), thing.radius  # type: ignore[union-attr]


def toward(root: Float[np.ndarray, "F 3"], thing: Thing) -> Float[np.ndarray, "F 2"]:
    """From hips at ``root`` to the nearest of ``thing``'s outline or axis, seen from above."""
    flat, corners = root[:, None, [0, 2]], getattr(thing, "points", None)
    if corners is None:
        begin, end, _ = rod(thing)  # type: ignore[arg-type]
        starts, ends = begin[None, [0, 2]], end[None, [0, 2]]
    else:
        starts = np.array(corners)
        ends = np.roll(starts, -1, axis=0)
    line = ends - starts
    size = np.maximum((line * line).sum(-1), 1e-18)
    along = np.clip(((flat - starts) * line).sum(-1) / size, 0.0, 1.0)
    to = starts + along[..., None] * line - flat
    return to[np.arange(len(to)), (to**2).sum(-1).argmin(axis=1)]


def near(root: Float[np.ndarray, "F 3"], thing: Thing, reach: float) -> Int[np.ndarray, "n"]:
    """Frames in which hips at ``root`` are so near to ``thing`` that a body may touch it."""
    flat = root[:, [0, 2]]
    corners = getattr(thing, "points", None)
    if corners is not None:
        return np.flatnonzero(polygon_apart(flat, flat, np.array(corners)) < reach)
    begin, end, radius = rod(thing)  # type: ignore[arg-type]
    away = segments_apart(flat, flat, begin[[0, 2]], end[[0, 2]]) - radius
    return np.flatnonzero(away < reach)


def touches(
    walk: PreparedWalk, body: Body, ground: Ground, surroundings: Surroundings
) -> list[Touch]:
    """What the walk comes nearest to, the worst of every thing that it comes near at all."""
    watch, reach = Watch(body, ground), REACH * body.height
    count = int(np.ceil(walk.duration * CLOSE_LOOKS)) + 1
    times = np.minimum(np.arange(count) / CLOSE_LOOKS, walk.duration)
    things = (*surroundings.obstacles, *surroundings.bars, *surroundings.posts)
    worst: dict[str, Touch] = {}
    for start in range(0, count, BLOCK):
        poses = walk.poses(times[start : start + BLOCK])
        axes = None
        for thing in things:
            frames = near(poses.center, thing, reach)
            if not frames.size:
                continue
            axes = watch.axes(poses) if axes is None else axes
            gaps = watch.gaps(axes[frames], thing)
            f, k = np.unravel_index(int(gaps.argmin()), gaps.shape)
            key = f"{type(thing).__name__} {thing.name}"
            if key not in worst or gaps[f, k] < worst[key].gap:
                frame = int(frames[f])
                x, y, z = axes[frame, k].mean(axis=0).tolist()
                worst[key] = Touch(
                    thing,
                    float(gaps[f, k]),
                    watch.bulk.parts[int(k)],
                    (x, y, z),
                    float(times[start + frame]),
                )
    return list(worst.values())
