"""Closed triangle meshes from rings, and their normals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    Mesh = tuple[Float[np.ndarray, "vertices 3"], Int[np.ndarray, "faces 3"]]


def skin(
    rings: Float[np.ndarray, "rings around 3"],
    start: Float[np.ndarray, "3"],
    end: Float[np.ndarray, "3"],
) -> Mesh:
    """Closed mesh through ``rings``, from the pole ``start`` to the pole ``end``.

    Seen from the end, every ring runs counter-clockwise; then all faces look outward.
    """
    count, around = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), start[None], end[None]])
    here = np.arange(around)
    after = (here + 1) % around
    base = around * np.arange(count - 1)[:, None]
    lower, upper = (base + here).ravel(), (base + around + here).ravel()
    lower_next, upper_next = (base + after).ravel(), (base + around + after).ravel()
    first, last = count * around, count * around + 1
    top = (count - 1) * around
    faces = np.concatenate(
        [
            np.stack([lower, lower_next, upper_next], axis=1),
            np.stack([lower, upper_next, upper], axis=1),
            np.stack([np.full(around, first), after, here], axis=1),
            np.stack([np.full(around, last), top + here, top + after], axis=1),
        ]
    )
    return vertices, faces


def frame_along(axis: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Rows ``(front, side, axis)``, right-handed; front is as near to +Z as can be."""
    d = axis / np.linalg.norm(axis)
    hint = np.array([0.0, 0.0, 1.0]) if abs(d[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    front = hint - (hint @ d) * d
    front /= np.linalg.norm(front)
    return np.stack([front, np.cross(d, front), d])


def ball(
    center: Float[np.ndarray, "3"], radii: Float[np.ndarray, "3"], *, around: int, rings: int
) -> Mesh:
    """Ellipsoid with half-axes ``radii`` along x, y, z, meters."""
    polar = np.pi * np.arange(1, rings + 1) / (rings + 1)
    turn = 2.0 * np.pi * np.arange(around) / around
    unit = np.stack(
        [
            np.outer(np.sin(polar), np.sin(turn)),
            np.repeat(-np.cos(polar)[:, None], around, axis=1),
            np.outer(np.sin(polar), np.cos(turn)),
        ],
        axis=-1,
    )
    low, high = np.array([0.0, -radii[1], 0.0]), np.array([0.0, radii[1], 0.0])
    return skin(unit * radii + center, center + low, center + high)


def corner_normals(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    *,
    crease: float = 0.9,
) -> Float[np.ndarray, "faces 3 3"]:
    """Unit normal at the three corners of every face, smooth but across creases.

    A corner takes the area-weighted mean of those faces around its vertex that lean less
    than ``crease`` radians from its own face. So rounded ends stay round, and the rim where
    a piece of the trunk dives into the next one does not darken.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    unit = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300)
    owner = np.repeat(np.arange(len(faces)), 3)  # face of each corner
    around = np.argsort(faces.ravel(), kind="stable")  # corners, vertex by vertex
    valence = np.bincount(faces.ravel(), minlength=len(vertices))
    start = np.cumsum(valence) - valence
    # all pairs (corner, other corner of the same vertex)
    count = valence[faces.ravel()]
    corner = np.repeat(np.arange(3 * len(faces)), count)
    within = np.arange(len(corner)) - np.repeat(np.cumsum(count) - count, count)
    other = owner[around[start[faces.ravel()[corner]] + within]]
    near = (unit[owner[corner]] * unit[other]).sum(1) > np.cos(crease)
    out = np.stack(
        [
            np.bincount(corner, weights=area[other, k] * near, minlength=3 * len(faces))
            for k in range(3)
        ],
        axis=-1,
    )
    out = out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-300)
    return out.reshape(-1, 3, 3)
