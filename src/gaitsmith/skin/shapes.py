"""Closed triangle meshes from stations along an axis: the clay of the mannequin."""

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


def resample(stations: Float[np.ndarray, "stations 5"], count: int) -> Float[np.ndarray, "count 5"]:
    """``count`` stations evenly along, on the smooth (PCHIP-like cosine) way between them."""
    from gaitsmith.geometry.curves import pchip_slopes

    x = stations[:, 0]
    at = np.linspace(x[0], x[-1], count)
    slopes = pchip_slopes(x, stations)
    k = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = (x[k + 1] - x[k])[:, None]
    u = (at - x[k])[:, None] / h
    a, b = stations[k], stations[k + 1]
    out = (
        (2 * u**3 - 3 * u**2 + 1) * a
        + (u**3 - 2 * u**2 + u) * h * slopes[k]
        + (3 * u**2 - 2 * u**3) * b
        + (u**3 - u**2) * h * slopes[k + 1]
    )
    out[:, 0] = at
    return out


def tube(
    stations: Float[np.ndarray, "stations 5"],
    frame: Float[np.ndarray, "3 3"],
    origin: Float[np.ndarray, "3"],
    *,
    caps: tuple[float, float],
    around: int,
    rings: int | None,
    square: float = 2.0,
) -> Mesh:
    """Elliptic tube with rounded ends.

    Parameters
    ----------
    stations
        Rows ``(along, front radius, side radius, front shift, side shift)``, meters.
    frame
        Rows ``(front, side, axis)`` in the joint's frame, as of :func:`frame_along`.
    origin
        Where ``along`` is 0, meters.
    caps
        How far the rounded ends reach beyond the first and the last station, meters.
    around, rings
        Vertices of a ring; rings between the caps, or None for one at each station.
    square
        Exponent of the superellipse: 2 is an ellipse, more is boxier.
    """
    table = stations if rings is None else resample(stations, rings)
    angles = np.deg2rad([64.0, 34.0])
    ends: list[Float[np.ndarray, "2 5"]] = []
    for row, reach in ((table[0], -caps[0]), (table[-1], caps[1])):
        end = np.repeat(row[None], len(angles), axis=0)
        end[:, 0] += reach * np.sin(angles)
        end[:, 1:3] *= np.cos(angles)[:, None]
        ends.append(end)
    table = np.concatenate([ends[0], table, ends[1][::-1]])
    turn = 2.0 * np.pi * np.arange(around) / around
    cosine, sine = np.cos(turn), np.sin(turn)
    unit_front = np.sign(cosine) * np.abs(cosine) ** (2.0 / square)
    unit_side = np.sign(sine) * np.abs(sine) ** (2.0 / square)
    local = np.stack(
        [
            table[:, 1:2] * unit_front + table[:, 3:4],
            table[:, 2:3] * unit_side + table[:, 4:5],
            np.broadcast_to(table[:, 0:1], (len(table), around)),
        ],
        axis=-1,
    )
    first, last = table[len(angles)], table[-len(angles) - 1]
    poles = np.array(
        [
            [first[3], first[4], first[0] - caps[0]],
            [last[3], last[4], last[0] + caps[1]],
        ]
    )
    placed = poles @ frame + origin
    return skin(local @ frame + origin, placed[0], placed[1])


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
