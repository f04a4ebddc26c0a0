"""A mesh that bends with a skeleton: vertices, up to four joints each, colours by name."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.geometry.rotations import to_matrix
from gaitsmith.skin.palette import WOOD

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.skin.palette import Color
    from gaitsmith.skin.shoe import Last

#: Joints that a vertex may follow.
LIMIT = 4


class Paint(NamedTuple):
    """A colour of the figure: what it is called, sRGB 0 to 255."""

    name: str
    color: Color


@dataclass(frozen=True, eq=False)
class SkinMesh:
    """A figure in the rest pose of its skeleton, soles at y = 0, ready to be bent.

    Attributes
    ----------
    vertices, normals
        ``(V, 3)`` meters and unit normals at rest, in the world. Vertices where normals or
        colours meet are doubled: same place, same weights.
    faces
        ``(T, 3)`` indices, counter-clockwise from outside.
    joints, weights
        ``(V, 4)`` joints that carry each vertex and their float32 shares, largest first,
        which add up to 1; unused ones are joint 0 with share 0.
    paints, face_paints
        The colours; ``(T,)`` index of each face's.
    rest
        ``(J, 3)`` joints at rest, meters: the mesh is bound to them there, unturned.
    stature
        Crown above the soles as estimated from the skeleton, meters; of what is no person
        its greatest extent.
    lasts
        The [left, right] shoe, or None where there is none.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    normals: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    joints: Int[np.ndarray, "vertices 4"]
    weights: Float[np.ndarray, "vertices 4"]
    paints: tuple[Paint, ...]
    face_paints: Int[np.ndarray, "faces"]
    rest: Float[np.ndarray, "joints 3"]
    stature: float
    lasts: tuple[Last | None, Last | None] = (None, None)

    @cached_property
    def face_colors(self) -> Float[np.ndarray, "faces 3"]:
        """Colour of each face, sRGB 0 to 1."""
        return np.array([paint.color for paint in self.paints])[self.face_paints] / 255.0

    def in_one_color(self) -> SkinMesh:
        """The same figure, all of wood."""
        paints = (Paint("wood", WOOD),)
        return replace(self, paints=paints, face_paints=np.zeros_like(self.face_paints))

    def pose(
        self, positions: Float[np.ndarray, "joints 3"], world: Float[np.ndarray, "joints 4"]
    ) -> tuple[Float[np.ndarray, "vertices 3"], Float[np.ndarray, "vertices 3"]]:
        """World vertices (meters) and unit normals in one pose of the skeleton.

        Linear blend skinning, as files and game engines do it.

        Parameters
        ----------
        positions, world
            World positions (meters) and rotations of the joints, of one frame of
            :func:`gaitsmith.motion.kinematics.motion_kinematics`.
        """
        turn = to_matrix(world)
        shift = positions - np.einsum("jab,jb->ja", turn, self.rest)
        table = np.concatenate([turn.reshape(-1, 9), shift], axis=1)
        mixed = self._shares[0][:, None] * table[self.joints[:, 0]]
        for k in range(1, LIMIT):
            mixed += self._shares[k][:, None] * table[self.joints[:, k]]
        x, y, z = (mixed[:, k:9:3] for k in range(3))
        at, up = self.vertices, self.normals
        vertices = x * at[:, :1] + y * at[:, 1:2] + z * at[:, 2:] + mixed[:, 9:]
        normals = x * up[:, :1] + y * up[:, 1:2] + z * up[:, 2:]
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        return vertices, normals

    @cached_property
    def _shares(self) -> Float[np.ndarray, "4 vertices"]:
        """The weights, which add up to 1 in double precision."""
        weights = self.weights.T.astype(np.float64)
        return weights / weights.sum(axis=0)


def strongest(
    weights: Float[np.ndarray, "vertices joints"],
) -> tuple[Int[np.ndarray, "vertices 4"], Float[np.ndarray, "vertices 4"]]:
    """The four largest weights of each row and their joints, as float32 that add up to 1."""
    wide = np.pad(weights, ((0, 0), (0, max(0, LIMIT - weights.shape[1]))))
    joints = np.argsort(-wide, axis=1, kind="stable")[:, :LIMIT]
    share = np.take_along_axis(wide, joints, axis=1)
    share = np.where(share < 1e-3, 0.0, share)
    share = (share / share.sum(axis=1, keepdims=True)).astype(np.float32)
    # what rounding has left over goes to the largest: it is exact, for the rest is small
    share[:, 0] = np.float32(1.0) - (share[:, 1] + share[:, 2] + share[:, 3])
    return np.where(share > 0.0, joints, 0), share


def vertex_normals(
    vertices: Float[np.ndarray, "vertices 3"], faces: Int[np.ndarray, "faces 3"]
) -> Float[np.ndarray, "vertices 3"]:
    """Unit normals of a smooth mesh: of the faces around each vertex, by area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = np.repeat(np.cross(b - a, c - a), 3, axis=0)
    out = np.stack(
        [np.bincount(faces.ravel(), weights=area[:, k], minlength=len(vertices)) for k in range(3)],
        axis=-1,
    )
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-300)


def split_corners(
    faces: Int[np.ndarray, "faces 3"], normals: Float[np.ndarray, "faces 3 3"]
) -> tuple[Int[np.ndarray, "faces 3"], Int[np.ndarray, "finer"], Float[np.ndarray, "finer 3"]]:
    """One vertex for each different normal at a vertex.

    Returns the faces with new indices, the old index and the normal of every new vertex.
    """
    rows = np.concatenate([faces.reshape(-1, 1), np.round(normals.reshape(-1, 3), 5)], axis=1)
    _, first, new = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return new.reshape(-1, 3), faces.ravel()[first], normals.reshape(-1, 3)[first]
