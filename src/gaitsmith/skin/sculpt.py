"""The pose a skin is modelled in, and the way from there to the rest pose.

A skin that is modelled in the T-pose looks wrong wherever its joints are far from it: the
shoulders of a walker hang 80 degrees lower. So it is modelled with hanging arms and slightly
bent elbows and knees, halfway between what walkers do, and then carried to the T-pose by
the inverse of its own skinning: posed like the model again, it is the model again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.rotations import about, between, exp, multiply, to_matrix
from gaitsmith.motion.kinematics import forward_kinematics

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.motion.skeleton import Skeleton

#: Radians below the horizontal that the arms of the model hang; bend of elbows and knees.
ARM_DROP, ELBOW, KNEE = 1.05, 0.35, 0.42


class Sculpt:
    """Where the joints of a humanoid skeleton are, at rest and in the modelling pose.

    Attributes
    ----------
    rest, posed
        ``(J, 3)`` positions, meters.
    turn
        ``(J, 3, 3)`` world rotations of the joints in the modelling pose.
    """

    def __init__(self, skeleton: Skeleton, rest: Float[np.ndarray, "joints 3"]) -> None:
        local = np.tile([0.0, 0.0, 0.0, 1.0], (len(skeleton), 1))
        names = skeleton.names
        for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
            arm, elbow, hand = (names.index(side + j) for j in ("UpperArm", "LowerArm", "Hand"))
            hang = np.array([sign * np.cos(ARM_DROP), -np.sin(ARM_DROP), 0.0])
            bone = rest[elbow] - rest[arm]
            local[arm] = between(bone, hang)
            fore = skeleton.offsets[hand]
            # a rest pose that is no T-pose may have its own bend: straighten it first
            straight = between(fore, bone)
            hinge = np.cross(bone, [0.0, 0.0, 1.0])
            local[elbow] = multiply(exp(ELBOW * hinge / np.linalg.norm(hinge)), straight)
            local[names.index(f"{side}LowerLeg")] = about("x", KNEE)
        posed, turn = forward_kinematics(skeleton, rest[:1], local[None])
        self.rest, self.posed, self.turn = rest, posed[0], to_matrix(turn[0])

    def unpose(
        self,
        points: Float[np.ndarray, "vertices 3"],
        normals: Float[np.ndarray, "vertices 3"],
        joints: Int[np.ndarray, "vertices 4"],
        weights: Float[np.ndarray, "vertices 4"],
    ) -> tuple[Float[np.ndarray, "vertices 3"], Float[np.ndarray, "vertices 3"]]:
        """Rest-pose points and unit normals that skinning carries to the given ones."""
        mixed = np.einsum("vk,vkab->vab", weights, self.turn[joints])
        shift = self.posed - np.einsum("jab,jb->ja", self.turn, self.rest)
        moved = points - np.einsum("vk,vka->va", weights, shift[joints])
        back = np.linalg.solve(mixed, np.stack([moved, normals], axis=-1))
        unit = back[..., 1] / np.linalg.norm(back[..., 1], axis=1, keepdims=True)
        return back[..., 0], unit
