"""A wooden mannequin around any humanoid skeleton: one closed mesh a body part.

Proportions come from the skeleton's offsets; girths follow the stature. Everything is
built in the T-pose with identity rotations, in the frame of the joint that carries it, so
a part moves rigidly with its joint and a renderer or an exporter needs no skinning.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import rotate
from gaitsmith.skin.limbs import add_arm, add_leg, add_shoe
from gaitsmith.skin.parts import Maker, Part
from gaitsmith.skin.trunk import add_head, add_trunk

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.skin.shoe import Last

__all__ = ["Mannequin", "Part", "build_mannequin"]


@dataclass(frozen=True, eq=False)
class Mannequin:
    """All parts of one figure.

    Attributes
    ----------
    parts
        Closed pieces, each rigid with its joint.
    stature
        Crown above the soles in the T-pose as estimated from the skeleton, meters.
    lasts
        The [left, right] shoe, or None where there is no foot.
    """

    parts: tuple[Part, ...]
    stature: float
    lasts: tuple[Last | None, Last | None]

    @cached_property
    def vertices(self) -> Float[np.ndarray, "vertices 3"]:
        """Vertices of all parts, each in the frame of its joint, meters."""
        return np.concatenate([part.vertices for part in self.parts])

    @cached_property
    def normals(self) -> Float[np.ndarray, "faces 3 3"]:
        """Smooth unit normal at each corner of every face, in the frame of its joint."""
        return np.concatenate([part.normals for part in self.parts])

    @cached_property
    def faces(self) -> Int[np.ndarray, "faces 3"]:
        """Faces of all parts, indices into :attr:`vertices`."""
        starts = np.cumsum([0] + [len(part.vertices) for part in self.parts[:-1]])
        return np.concatenate(
            [part.faces + start for part, start in zip(self.parts, starts, strict=True)]
        )

    @cached_property
    def vertex_joints(self) -> Int[np.ndarray, "vertices"]:
        """Joint that carries each vertex."""
        return np.concatenate([np.full(len(p.vertices), p.joint) for p in self.parts])

    @cached_property
    def face_joints(self) -> Int[np.ndarray, "faces"]:
        """Joint that carries each face."""
        return np.concatenate([np.full(len(p.faces), p.joint) for p in self.parts])

    @cached_property
    def face_colors(self) -> Float[np.ndarray, "faces 3"]:
        """Colour of each face, sRGB 0 to 1."""
        return np.concatenate(
            [np.tile(np.array(p.color) / 255.0, (len(p.faces), 1)) for p in self.parts]
        )

    def pose(
        self, positions: Float[np.ndarray, "joints 3"], world: Float[np.ndarray, "joints 4"]
    ) -> tuple[Float[np.ndarray, "vertices 3"], Float[np.ndarray, "faces 3 3"]]:
        """World vertices (meters) and corner normals in one pose of the skeleton.

        Parameters
        ----------
        positions, world
            World positions (meters) and rotations of the joints, of one frame of
            :func:`gaitsmith.motion.kinematics.motion_kinematics`.
        """
        joints = self.vertex_joints
        vertices = positions[joints] + rotate(world[joints], self.vertices)
        return vertices, rotate(world[self.face_joints][:, None], self.normals)


def build_mannequin(skeleton: Skeleton, *, detail: float = 1.0) -> Mannequin:
    """Mannequin for ``skeleton``; joints it does not know by name carry nothing.

    Parameters
    ----------
    skeleton
        VRM humanoid names, T-pose with arms along +-X, identity rest rotations. Any number
        of joints between ``hips`` and ``neck``; any joint may be missing.
    detail
        Multiplies the number of vertices around and along every part. 1 gives some 4000
        triangles.

    Raises
    ------
    InvalidInputError
        If no joint has a humanoid name, or ``detail`` is not positive.
    """
    if not detail > 0.0:
        raise InvalidInputError(f"detail must be a positive number, got {detail!r}")
    maker = Maker(skeleton, detail)
    add_trunk(maker)
    add_head(maker)
    for side in (0, 1):
        add_arm(maker, side)
        add_leg(maker, side)
        add_shoe(maker, side)
    if not maker.parts:
        raise InvalidInputError(
            "a mannequin needs VRM humanoid joint names (hips, leftUpperLeg, ...), got "
            + ", ".join(skeleton.names[:6])
        )
    return Mannequin(tuple(maker.parts), maker.stature, (maker.lasts[0], maker.lasts[1]))
