"""Joints, their parents and their rest offsets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from jaxtyping import Float

#: VRM humanoid bones that a generated body has, parents first: (name, parent).
HUMANOID: tuple[tuple[str, str | None], ...] = (
    ("hips", None),
    ("spine", "hips"),
    ("chest", "spine"),
    ("upperChest", "chest"),
    ("neck", "upperChest"),
    ("head", "neck"),
    *(
        pair
        for side in SIDES
        for pair in (
            (f"{side}Shoulder", "upperChest"),
            (f"{side}UpperArm", f"{side}Shoulder"),
            (f"{side}LowerArm", f"{side}UpperArm"),
            (f"{side}Hand", f"{side}LowerArm"),
        )
    ),
    *(
        pair
        for side in SIDES
        for pair in (
            (f"{side}UpperLeg", "hips"),
            (f"{side}LowerLeg", f"{side}UpperLeg"),
            (f"{side}Foot", f"{side}LowerLeg"),
            (f"{side}Toes", f"{side}Foot"),
        )
    ),
)


@dataclass(frozen=True, eq=False)
class Skeleton:
    """The J joints of a figure, parents before children, with offsets at rest.

    Attributes
    ----------
    names
        One name a joint, all different. Generated bodies use VRM humanoid names.
    parents
        Index of each joint's parent; -1 for the root, which is joint 0.
    offsets
        ``(J, 3)`` joint minus parent at rest, meters; of the root: unused by kinematics.
    soles
        ``(2, 3, 3)`` [left, right] x [heel, ball, toe tip], meters: heel and ball in the
        frame of the Foot joint, toe tip in that of the Toes joint (of the Foot, where a
        figure has no toes). None if unknown.
    ends
        ``(J, 3)`` where the bone of a joint without children ends, in its frame, meters: the
        crown of the head, finger tips, toe tips. Zero for other joints; None if unknown.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Float[np.ndarray, "joints 3"]
    soles: Float[np.ndarray, "2 3 3"] | None = None
    ends: Float[np.ndarray, "joints 3"] | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.names)
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "parents", tuple(int(p) for p in self.parents))
        if count == 0:
            raise InvalidInputError("a skeleton needs at least one joint")
        if len(set(self.names)) != count:
            twice = sorted({n for n in self.names if self.names.count(n) > 1})
            raise InvalidInputError(f"joint names must be different; twice: {', '.join(twice)}")
        if len(self.parents) != count:
            raise InvalidInputError(f"{count} names but {len(self.parents)} parents")
        for joint, parent in enumerate(self.parents):
            if (joint == 0) != (parent == -1) or not -1 <= parent < max(joint, 1):
                raise InvalidInputError(
                    f"parents must come before children with joint 0 the only root (-1); joint "
                    f"{joint} ({self.names[joint]!r}) has parent {parent}"
                )
        object.__setattr__(self, "offsets", frozen_array("offsets", self.offsets, (count, 3)))
        if self.soles is not None:
            object.__setattr__(self, "soles", frozen_array("soles", self.soles, (2, 3, 3)))
        if self.ends is not None:
            object.__setattr__(self, "ends", frozen_array("ends", self.ends, (count, 3)))

    def __len__(self) -> int:
        """Number of joints."""
        return len(self.names)

    def __repr__(self) -> str:
        """One line: how many joints, and the first ones."""
        return f"<Skeleton: {len(self)} joints, {', '.join(self.names[:4])}, ...>"

    def index(self, name: str) -> int:
        """Index of the joint called ``name``; UnknownNameError if there is none."""
        try:
            return self.names.index(name)
        except ValueError:
            raise UnknownNameError("joint", name, self.names) from None

    def rest_positions(self) -> Float[np.ndarray, "joints 3"]:
        """World positions at rest (T-pose), the root where its offset puts it, meters."""
        positions = np.array(self.offsets)
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                positions[joint] += positions[parent]
        return positions

    @property
    def sole_joints(self) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
        """Joints that carry [heel, ball, toe tip] of the left and of the right foot."""
        feet = []
        for side in SIDES:
            foot = self.index(f"{side}Foot")
            toes = self.names.index(f"{side}Toes") if f"{side}Toes" in self.names else foot
            feet.append((foot, foot, toes))
        return feet[0], feet[1]
