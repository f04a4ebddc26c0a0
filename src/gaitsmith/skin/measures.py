"""What the figure needs to know of a skeleton: where its joints are, its shoes, its size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.skin.shoe import Last, last_of

if TYPE_CHECKING:
    from gaitsmith.motion.skeleton import Skeleton

#: Height of the head joint above the soles over stature: the crown is 0.09 of it higher.
HEAD_JOINT = 0.91
#: The stature that all girths are written for, meters.
ADULT = 1.75


class Measures:
    """Sizes of a skeleton with VRM humanoid names; any joint may be missing.

    Attributes
    ----------
    skeleton
        Whose sizes these are.
    rest
        ``(J, 3)`` joints at rest, meters, the root over the origin.
    lasts
        The [left, right] shoe, or None where there is no foot.
    floor
        Height of the soles at rest, meters.
    stature, girth
        Crown above the soles, meters; and the same over that of an adult.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self.skeleton = skeleton
        # a file's root may stand anywhere; only the way from it matters here
        self.rest = skeleton.rest_positions() - skeleton.offsets[0] * [1.0, 0.0, 1.0]
        self.lasts = self._last(0), self._last(1)
        self.floor = self._floor()
        self.stature = self._stature()
        self.girth = self.stature / ADULT

    def find(self, name: str) -> int | None:
        """Index of the joint called ``name``, or None."""
        return self.skeleton.names.index(name) if name in self.skeleton.names else None

    def _floor(self) -> float:
        """Height of the soles at rest: 0 by convention, but a file's root may hang anywhere."""
        heels = [
            self.rest[foot, 1] + last.heel[1]
            for side, last in zip(SIDES, self.lasts, strict=True)
            if last is not None and (foot := self.find(f"{side}Foot")) is not None
        ]
        return float(min(heels)) if heels else float(self.rest[:, 1].min())

    @property
    def crown(self) -> float | None:
        """Height of the crown over the head joint, if the skeleton tells it, meters."""
        head, ends = self.find("head"), self.skeleton.ends
        if head is None or ends is None or ends[head, 1] <= 0.0:
            return None
        return float(ends[head, 1])

    def _stature(self) -> float:
        head, neck, hips = (self.find(name) for name in ("head", "neck", "hips"))
        for joint, share in ((head, HEAD_JOINT), (neck, 0.845), (hips, 0.53)):
            if joint is not None and joint == head and self.crown is not None:
                return float(self.rest[joint, 1] - self.floor) + self.crown
            if joint is not None and self.rest[joint, 1] > self.floor:
                return float(self.rest[joint, 1] - self.floor) / share
        return max(float(np.ptp(self.rest[:, 1])), 0.5)

    def _last(self, side: int) -> Last | None:
        foot = self.find(f"{SIDES[side]}Foot")
        if foot is None:
            return None
        toes = self.find(f"{SIDES[side]}Toes")
        to_toes = np.zeros(3) if toes is None else self.skeleton.offsets[toes]
        if self.skeleton.soles is not None:
            heel, front, tip = self.skeleton.soles[side]
            return last_of(heel, front, tip + to_toes, side)
        knee = abs(float(self.skeleton.offsets[foot, 1])) or 0.43
        drop = max(0.16 * knee, -float(to_toes[1]))
        reach = float(to_toes[2]) if toes is not None and to_toes[2] > 0.0 else 0.29 * knee
        heel, front = np.array([0.0, -drop, -0.15 * knee]), np.array([0.0, -drop, reach])
        return last_of(heel, front, front + [0.0, 0.0, 0.6 * reach], side)

    def spine(self) -> list[int]:
        """Joints from the hips up to the one that carries neck, head or arms."""
        hips = self.find("hips")
        if hips is None:
            return []
        ends = ("neck", "head", "leftShoulder", "rightShoulder", "leftUpperArm", "rightUpperArm")
        tip = next((j for name in ends if (j := self.find(name)) is not None), None)
        joint = hips if tip is None else self.skeleton.parents[tip]
        chain: list[int] = []
        while joint >= 0:
            chain.append(joint)
            if joint == hips:
                return chain[::-1]
            joint = self.skeleton.parents[joint]
        return [hips]
