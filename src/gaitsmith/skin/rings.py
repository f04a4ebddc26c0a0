"""Where the rings of a limb's cage go: frames along a chain of bones, points around them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.skin.fit import Fit


class Bones:
    """A chain of bones in the modelling pose, with a frame at every place of it."""

    def __init__(self, fit: Fit, names: Sequence[str], front: Float[np.ndarray, "3"]) -> None:
        at = fit.sculpt.posed[[fit.index(name) for name in names]]
        self.at, self.step = at, np.diff(at, axis=0)
        self.length = np.linalg.norm(self.step, axis=1)
        self.way, self.hint, self.girth = self.step / self.length[:, None], front, fit.girth

    def place(
        self, row: Float[np.ndarray, "columns"]
    ) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
        """Point of a row ``(bone, share, meters beyond)``; rows (first, front, along) there."""
        bone = int(row[0])
        along = row[1] * self.length[bone] + row[2] * self.girth
        point = self.at[bone] + along * self.way[bone]
        way = self.way[bone]
        # near the joint between two bones the rings stand halfway between both
        start, end = along < 0.15 * self.length[bone], along > 0.85 * self.length[bone]
        near = bone - 1 if start else bone + 1 if end else bone
        if 0 <= near < len(self.way) and near != bone:
            apart = abs(along if start else self.length[bone] - along) / self.girth
            way = way + np.clip(1.0 - apart / 0.08, 0.0, 1.0) * self.way[near]
            way = way / np.linalg.norm(way)
        front = self.hint - (self.hint @ way) * way
        front /= np.linalg.norm(front)
        return point, np.stack([np.cross(front, way), front, way])


def ring_around(
    point: Float[np.ndarray, "3"],
    frame: Float[np.ndarray, "3 3"],
    radii: Float[np.ndarray, "4"],
    count: int,
    power: float = 1.0,
) -> Float[np.ndarray, "count 3"]:
    """Ring around ``point``; radii to +first, -first, +front, -front of its frame."""
    turn = 2.0 * np.pi * np.arange(count) / count
    first, front = np.cos(turn), np.sin(turn)
    first = np.sign(first) * np.abs(first) ** power
    front = np.sign(front) * np.abs(front) ** power
    reach = np.array(radii) / np.cos(np.pi / count) * (1.0 if count > 8 else 0.98)
    a = np.where(first > 0.0, reach[0], reach[1]) * first
    b = np.where(front > 0.0, reach[2], reach[3]) * front
    return point + a[:, None] * frame[0] + b[:, None] * frame[1]
