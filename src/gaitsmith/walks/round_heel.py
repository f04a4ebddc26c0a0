"""The sole with a round heel that [SM01]'s walker rolls over: a convex polygon, seen from aside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.body.body import Foot

#: Radius of the heel over the length from heel to ball; corners of its quarter circle.
RADIUS, CORNERS = 0.11, 9


@dataclass(frozen=True, eq=False)
class RoundHeel:
    """Profile of a sole: back of the heel, round to its bottom, flat to the ball.

    Attributes
    ----------
    corners
        ``(C, 2)`` (forward, up) from N of the flat foot, meters, from the back of the heel to
        the ball.
    laid
        ``(C,)`` how far ahead of N each corner comes to lie as the foot rolls flat: all keep
        their distance along the profile from the ball.
    ankle, joint
        ``(2,)`` the ankle, and the joint that the toes bend about.
    """

    corners: Float[np.ndarray, "C 2"]
    laid: Float[np.ndarray, "C"]
    ankle: Float[np.ndarray, "2"]
    joint: Float[np.ndarray, "2"]

    @classmethod
    def of(cls, foot: Foot) -> RoundHeel:
        """The profile of ``foot``."""
        radius = RADIUS * foot.heel_ball
        angle = np.linspace(0.5 * np.pi, 0.0, CORNERS)
        heel = np.stack(
            [-foot.heel + radius * (1.0 - np.sin(angle)), radius * (1.0 - np.cos(angle))], axis=-1
        )
        corners = np.concatenate([heel, [[foot.ball, 0.0]]])
        pieces = np.hypot(*np.diff(corners, axis=0).T)
        laid = foot.ball - np.concatenate([np.cumsum(pieces[::-1])[::-1], [0.0]])
        joint = np.array([foot.ball, foot.toe_joint_height])
        return cls(corners, laid, np.array([0.0, foot.ankle_height]), joint)

    def lowest(self, pitch: Float[np.ndarray, "*n"]) -> Int[np.ndarray, "*n"]:
        """Index of the corner that a foot pitched toes up stands on; of equals the hindmost."""
        x, y = self.corners[:, 0], self.corners[:, 1]
        pitch = np.real(np.asarray(pitch))[..., None]
        return np.argmin(x * np.sin(pitch) + y * np.cos(pitch), axis=-1)

    def stand(self, pitch: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n 2"]:
        """The ankle, (forward, up) from N, of a foot that rolls without slipping.

        Toes up it stands on a corner of the heel; heel up it turns about the toe joint, whose
        toes lie. Complex pitches pass through, for derivatives.
        """
        pitch = np.asarray(pitch)
        corner = self.lowest(pitch)
        on_heel = (np.real(pitch) >= 0.0)[..., None]
        turns_about = np.where(on_heel, self.corners[corner], self.joint)
        ground = np.stack([self.laid[corner], np.zeros(corner.shape)], axis=-1)
        arm = self.ankle - turns_about
        return np.where(on_heel, ground, self.joint) + turned(arm, pitch)


def turned(vector: Float[np.ndarray, "*n 2"], angle: Float[np.ndarray, "*n"]) -> np.ndarray:
    """(forward, up) vectors turned counter-clockwise: a positive pitch lifts the toes."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([x * c - y * s, x * s + y * c], axis=-1)
