"""One piece of the mannequin, and the maker that collects them around a skeleton."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.skin.shapes import ball, corner_normals, frame_along, tube
from gaitsmith.skin.shoe import Last, last_of

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.skin.palette import Color
    from gaitsmith.skin.shapes import Mesh

#: Height of the head joint above the soles over stature: the crown is 0.09 of it higher.
HEAD_JOINT = 0.91
#: The stature that all girths are written for, meters.
ADULT = 1.75


@dataclass(frozen=True, eq=False)
class Part:
    """One closed piece of the figure.

    Attributes
    ----------
    name, joint
        What it is; index of the joint that carries it.
    vertices
        ``(V, 3)`` meters, in the joint's frame.
    faces
        ``(T, 3)`` indices, counter-clockwise from outside.
    color
        sRGB, 0 to 255.
    normals
        ``(T, 3, 3)`` unit normal at the corners of each face, in the joint's frame.
    """

    name: str
    joint: int
    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    color: Color
    normals: Float[np.ndarray, "faces 3 3"]


class Maker:
    """Collects parts; knows where the joints of the skeleton are at rest."""

    def __init__(self, skeleton: Skeleton, detail: float) -> None:
        self.skeleton = skeleton
        # a file's root may stand anywhere; only the way from it matters here
        self.rest = skeleton.rest_positions() - skeleton.offsets[0] * [1.0, 0.0, 1.0]
        self.around = max(6, 2 * round(6 * detail))
        self.detail = detail
        self.lasts = [self._last(0), self._last(1)]
        self.floor = self._floor()
        self.stature = self._stature()
        self.girth = self.stature / ADULT
        self.parts: list[Part] = []

    def find(self, name: str) -> int | None:
        """Index of the joint called ``name``, or None."""
        return self.skeleton.names.index(name) if name in self.skeleton.names else None

    def rings(self, length: float) -> int:
        """How many rings a piece ``length`` meters long gets."""
        return max(2, round(self.detail * (2.0 + length / (0.075 * self.girth))))

    def add(
        self,
        name: str,
        joint: int,
        mesh: Mesh,
        color: Color,
        normals: Float[np.ndarray, "faces 3 3"] | None = None,
    ) -> None:
        """Keep a piece; its mesh is in the frame of ``joint``. Smooth normals by default."""
        smooth = corner_normals(*mesh) if normals is None else normals
        self.parts.append(Part(name, joint, *mesh, color, smooth))

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

    def tube(
        self,
        stations: Float[np.ndarray, "stations 5"],
        axis: Float[np.ndarray, "3"],
        caps: tuple[float, float],
        *,
        rings: int | None = None,
    ) -> Mesh:
        """Tube along ``axis`` from the joint; ``stations`` as of :func:`shapes.tube`."""
        count = self.rings(float(np.ptp(stations[:, 0]))) if rings is None else rings
        count = max(count, 2) if rings is None else max(3, round(rings * self.detail))
        frame = frame_along(axis)
        return tube(stations, frame, np.zeros(3), caps=caps, around=self.around, rings=count)

    def limb(
        self,
        name: str,
        joint: int,
        to: Float[np.ndarray, "3"],
        shape: list[list[float]],
        color: Color,
        cap: float = 0.8,
    ) -> None:
        """Tube from ``joint`` to ``to``: rows of share, front, side, shift to front and down."""
        length, g = float(np.linalg.norm(to)), self.girth
        if length < 1e-6:
            return
        table = np.array(shape)
        stations = np.zeros((len(table), 5))
        stations[:, 0] = table[:, 0] * length
        stations[:, 1 : table.shape[1]] = table[:, 1:] * g
        if float(frame_along(to)[1] @ np.array([0.0, -1.0, 0.0])) < 0.0:
            stations[:, 4] *= -1.0
        caps = (cap * float(stations[0, 1:3].mean()), 0.8 * float(stations[-1, 1:3].mean()))
        self.add(name, joint, self.tube(stations, to, caps), color)

    def knob(self, name: str, joint: int, radius: float, color: Color) -> None:
        """Ball around ``joint``; its radius is for an adult, meters."""
        mesh = ball(
            np.zeros(3),
            np.full(3, radius * self.girth),
            around=self.around,
            rings=round(6 * self.detail),
        )
        self.add(name, joint, mesh, color)

    def to_child(
        self, joint: int, child: str, otherwise: Float[np.ndarray, "3"]
    ) -> Float[np.ndarray, "3"]:
        """Offset from ``joint`` to its ``child``, or ``otherwise`` if it has none."""
        index = self.find(child)
        if index is None or self.skeleton.parents[index] != joint:
            return otherwise
        return self.skeleton.offsets[index]
