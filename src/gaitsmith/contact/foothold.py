"""The plane a foot stands on, and the foot upon it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.sole import SolePose, rolled_ankle
from gaitsmith.conventions import TOE, UP, ahead
from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.rotations import (
    about,
    component_major,
    from_basis,
    inverse,
    log,
    multiply,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Foot
    from gaitsmith.ground import Ground


@dataclass(frozen=True, eq=False)
class Footholds:
    """Frames of footholds: N, the sole's forward direction and its normal, any leading axes.

    Attributes
    ----------
    position, forward, normal
        ``(*n, 3)``; ``forward`` has the foothold's heading seen from above.
    tilt
        ``(*n, 3)`` rotation vector, world: how a level foot of this heading is tilted to lie
        on the plane; all zero on level ground.
    toes
        ``(*n,)`` radians by which the toes of the flat foot are raised against its sole so that
        their tip touches; None: nowhere.
    bears
        ``(*n, 3)`` whether there is ground under heel, ball and toe tip; None: everywhere.
    """

    position: Float[np.ndarray, "*n 3"]
    forward: Float[np.ndarray, "*n 3"]
    normal: Float[np.ndarray, "*n 3"]
    tilt: Float[np.ndarray, "*n 3"]
    toes: Float[np.ndarray, "*n"] | None = None
    bears: Bool[np.ndarray, "*n 3"] | None = None

    def at(self, index: object) -> Footholds:
        """The footholds that NumPy index ``index`` picks, each component contiguous."""
        shape = self.position.shape[:-1]
        which = np.arange(math.prod(shape)).reshape(shape)[index]  # type: ignore[index]

        def picked(field: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*m 3"]:
            out = component_major(np.shape(which), 3)
            for i in range(3):
                out[..., i] = np.take(field[..., i], which)
            return out

        fields = map(picked, (self.position, self.forward, self.normal, self.tilt))
        more = (None if f is None else f[index] for f in (self.toes, self.bears))  # type: ignore[index]
        return Footholds(*fields, *more)

    @property
    def on_ball(self) -> Bool[np.ndarray, "*n"] | None:
        """Where the toes hang over an edge; None: nowhere."""
        return None if self.bears is None else ~self.bears[..., TOE]

    def place(self, points: Float[np.ndarray, "*n 2"]) -> Float[np.ndarray, "*n 3"]:
        """World position of sagittal points ``(forward, up)`` from N."""
        return self.position + points[..., :1] * self.forward + points[..., 1:] * self.normal

    def ankle(
        self,
        foot: Foot,
        pitch: Float[np.ndarray, "*n"] | float,
        meta: Float[np.ndarray, "*n"] | float,
    ) -> Float[np.ndarray, "*n 3"]:
        """World position of the ankle of a foot that stands here."""
        return self.place(rolled_ankle(foot, pitch, meta, self.toes, self.on_ball))


def footholds(
    position: Float[np.ndarray, "*n 3"], heading: Float[np.ndarray, "*n"], ground: Ground
) -> Footholds:
    """Frames of the footholds at N ``position`` on ``ground``."""
    normal = ground.normal(position[..., 0], position[..., 2])
    level = ahead(heading)
    forward = level - ((level * normal).sum(-1) / normal[..., 1])[..., None] * UP
    forward /= np.linalg.norm(forward, axis=-1, keepdims=True)
    turned = from_basis(np.cross(normal, forward), normal, forward)
    tilt = log(multiply(turned, inverse(about("y", heading))))
    tilt = np.where(np.abs(normal - UP).max(-1, keepdims=True) > 1e-15, tilt, 0.0)
    return Footholds(position, forward, normal, tilt)


def sole_in_air(
    foot: Foot,
    ankle_height: Float[np.ndarray, "*n"],
    pitch: Float[np.ndarray, "*n"],
    bend: Float[np.ndarray, "*n"],
) -> SolePose:
    """Sole points of a free foot, forward from its ankle, up as the ankle's height counts."""
    s, c = sine_cosine(pitch)

    def point(forward: float, up: float) -> Float[np.ndarray, "*n 2"]:
        out = component_major(np.broadcast_shapes(s.shape, np.shape(ankle_height)), 2)
        out[..., 0] = forward * c - up * s
        out[..., 1] = ankle_height + (forward * s + up * c)
        return out

    drop = -foot.ankle_height
    joint, tip = (point(foot.ball, drop + foot.toe_joint_height) for _ in range(2))
    s_toes, c_toes = sine_cosine(pitch + bend)
    tip[..., 0] += foot.toes * c_toes + foot.toe_joint_height * s_toes
    tip[..., 1] += foot.toes * s_toes - foot.toe_joint_height * c_toes
    return SolePose(
        heel=point(-foot.heel, drop),
        ball=point(foot.ball, drop),
        toe=tip,
        ankle=point(0.0, 0.0),
        toe_joint=joint,
    )
