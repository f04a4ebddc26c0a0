"""The standard figure, 1.75 m tall, and how it is stretched over another skeleton."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.skin.measures import HEAD_JOINT
from gaitsmith.skin.sculpt import Sculpt
from gaitsmith.skin.t_pose import NEEDED

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.measures import Measures

# Heights of the standard figure, meters: hips, shoulder joint, neck, head, crown; half the
# distance of its hip joints and of its shoulder joints; length of its hand.
HIPS, SHOULDER, NECK, HEAD, CROWN = 0.928, 1.432, 1.479, 1.593, 1.750
HALF_HIPS, HALF_SHOULDERS, HAND = 0.088, 0.192, 0.189


class Fit:
    """A skeleton seen as a stretched standard figure.

    Attributes
    ----------
    girth, head
        Size of limbs and trunk, and of the head, over those of the standard figure.
    sculpt
        The joints at rest and in the modelling pose.
    """

    def __init__(self, measures: Measures, rest: Float[np.ndarray, "joints 3"]) -> None:
        self.measures, self.girth = measures, measures.girth
        self.sculpt = Sculpt(measures.skeleton, rest)
        self.count = len(measures.skeleton)
        g, at = self.girth, self.sculpt.rest
        crown = measures.crown or (1.0 - HEAD_JOINT) * measures.stature
        self.head = crown / (CROWN - HEAD)
        self.chain = [*measures.spine(), self.index("neck"), self.index("head")]
        arms, legs = ([self.index(side + j) for side in SIDES] for j in ("UpperArm", "UpperLeg"))
        hips = float(at[legs, 1].mean())
        neck, head = (float(at[self.index(name), 1]) for name in ("neck", "head"))
        shoulder = float(at[arms, 1].mean())
        levels = [hips, shoulder, neck, head, head + crown]
        self._levels = np.maximum.accumulate(np.array(levels) + 1e-3 * g * np.arange(5))
        self.half_hips = float(np.abs(at[legs, 0]).mean()) / g
        self.half_shoulders = float(np.abs(at[arms, 0]).mean()) / g
        self._boundaries = self._spine_boundaries()

    def index(self, name: str) -> int:
        """Index of the joint called ``name``, which must be there."""
        return self.measures.skeleton.names.index(name)

    def one(self, name: str) -> Float[np.ndarray, "joints"]:
        """Weights of what is rigid with the joint called ``name``."""
        out = np.zeros(self.count)
        out[self.index(name)] = 1.0
        return out

    def height(self, y: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
        """Height on this body, meters, of heights of the standard figure."""
        known = np.array([HIPS, SHOULDER, NECK, HEAD, CROWN])
        below = self._levels[0] + self.girth * (np.asarray(y) - HIPS)
        above = self._levels[-1] + self.head * (np.asarray(y) - CROWN)
        inside = np.interp(y, known, self._levels)
        return np.where(y < HIPS, below, np.where(y > CROWN, above, inside))

    def trunk(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Points of the standard figure's trunk and head, on this body."""
        y = points[:, 1]
        hips = 0.35 + 0.65 * self.half_hips / HALF_HIPS
        shoulders = self.half_shoulders / HALF_SHOULDERS
        chest = 0.35 + 0.65 * shoulders
        head = self.head / self.girth
        wide = np.interp(
            y,
            [0.95, 1.10, 1.25, 1.36, 1.46, 1.51, 1.56],
            [hips, 0.5 * (hips + chest), chest, shoulders, shoulders, 1.0, head],
        )
        deep = np.interp(y, [1.50, 1.56], [1.0, head])
        out = np.empty_like(points)
        out[:, 0] = points[:, 0] * wide * self.girth
        out[:, 1] = self.height(y)
        out[:, 2] = points[:, 2] * deep * self.girth
        spine = self.sculpt.rest[self.chain]
        out[:, 2] += np.interp(out[:, 1], np.maximum.accumulate(spine[:, 1]), spine[:, 2])
        return out

    def _spine_boundaries(self) -> Float[np.ndarray, "chain 2"]:
        """Height at which each joint of the spine takes over, and over what way, meters."""
        y = self.sculpt.rest[self.chain, 1]
        gap = np.diff(y)
        wide = np.empty_like(y)
        wide[0], wide[1:-1], wide[-1] = 1.0, np.minimum(gap[:-1], gap[1:]), gap[-1]
        return np.stack([y, np.maximum(wide, 1e-4)], axis=1)

    def spine(self, y: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n joints"]:
        """Weights of hips, spine, neck and head at heights ``y`` of this body, meters."""
        at, wide = self._boundaries.T
        taken = smoothstep((y[:, None] - at) / wide + 0.5)
        taken[:, 0] = 1.0
        taken = np.minimum.accumulate(taken, axis=1)
        share = taken - np.concatenate([taken[:, 1:], np.zeros((len(y), 1))], axis=1)
        out = np.zeros((len(y), self.count))
        np.add.at(out.T, self.chain, share.T)
        return out


def fits(measures: Measures, rest: Float[np.ndarray, "joints 3"]) -> bool:
    """Whether the skeleton is a person near the T-pose, whom the one smooth skin can dress."""
    names = measures.skeleton.names
    if any(name not in names for name in NEEDED) or measures.stature < 0.2:
        return False
    at = {name: rest[names.index(name)] for name in NEEDED}
    size = measures.stature
    if len(measures.spine()) < 2 or np.abs(rest).max() > 3.0 * size:
        return False
    levels = [at[name][1] for name in ("hips", "neck", "head")]
    trunk = levels[1] - max(at[f"{side}UpperLeg"][1] for side in SIDES)
    upright = bool(np.diff(levels).min() > 0.01 * size and trunk > 0.15 * size)
    for sign, side in zip((1.0, -1.0), SIDES, strict=True):
        arm, elbow, hand = (at[side + joint] for joint in ("UpperArm", "LowerArm", "Hand"))
        hip, knee, foot = (at[side + joint] for joint in ("UpperLeg", "LowerLeg", "Foot"))
        upright &= bool(hip[1] - knee[1] > 0.08 * size and knee[1] - foot[1] > 0.08 * size)
        for bone in (hip - knee, knee - foot):
            upright &= bool(np.hypot(bone[0], bone[2]) < 0.6 * bone[1])
        upright &= bool(sign * hip[0] > 0.015 * size and abs(hip[1] - levels[0]) < 0.15 * size)
        upright &= bool(sign * arm[0] > 0.05 * size and abs(arm[1] - levels[1]) < 0.15 * size)
        if f"{side}Toes" in names:
            toes = rest[names.index(f"{side}Toes")] - foot
            upright &= bool(toes[2] > 0.5 * np.abs(toes[0]) and toes[1] < 0.5 * toes[2])
        for bone in (elbow - arm, hand - elbow):
            length = float(np.linalg.norm(bone))
            upright &= length > 0.05 * size and bool(np.abs(bone[2]) < 0.5 * length)
            upright &= bool(sign * bone[0] > -0.2 * length and bone[1] < 0.5 * length)
    return upright
