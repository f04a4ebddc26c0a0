"""Who is measured: the paths of the joints by their roles, the soles, the footsteps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, SIDES, UP

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.ground import Ground
    from gaitsmith.measures.footsteps import Footsteps
    from gaitsmith.motion.motion import Labels, Motion


@dataclass(frozen=True, eq=False)
class Figure:
    """A motion with what measuring it takes.

    Attributes
    ----------
    motion
        As it was given, or carried over the ground if it walks in place.
    joints
        Index of the joint of each VRM humanoid bone.
    positions, world
        ``(F, J, 3)``, ``(F, J, 4)`` of every joint; y = 0 is where ``motion`` has it.
    soles, down
        ``(F, 2, 3, 3)`` sole points and ``(F, 2, 3)`` whether they bear.
    exact
        Whether ``down`` is the motion's own; else it is the flat part of each stance found.
    bearing
        ``(F, 2)`` from heel strike to toe-off.
    footsteps
        Of the motion's labels, else of the stances found.
    ground
        What is walked on: the labels', else the level floor found; None if it is unknown.
    height
        Of the body, meters; None where nothing tells.
    labels
        The motion's own, with a ground that is known.
    """

    motion: Motion
    joints: dict[str, int]
    positions: Float[np.ndarray, "F J 3"]
    world: Float[np.ndarray, "F J 4"]
    soles: Float[np.ndarray, "F 2 3 3"]
    down: Bool[np.ndarray, "F 2 3"]
    exact: bool
    bearing: Bool[np.ndarray, "F 2"]
    footsteps: Footsteps
    ground: Ground | None
    height: float | None
    labels: Labels | None

    def at(self, role: str) -> Float[np.ndarray, "F 3"]:
        """World path of a role's joint."""
        return self.positions[:, self.joints[role]]

    def has(self, *roles: str) -> bool:
        """Whether the figure has all these bones."""
        return set(roles) <= self.joints.keys()

    @cached_property
    def hips(self) -> Float[np.ndarray, "F 3"]:
        """Middle of the hip joints."""
        return 0.5 * (self.at("leftUpperLeg") + self.at("rightUpperLeg"))

    @cached_property
    def left(self) -> Float[np.ndarray, "F 3"]:
        """Unit vector from the right hip joint to the left one."""
        return _unit(self.at("leftUpperLeg") - self.at("rightUpperLeg"))

    @cached_property
    def ahead(self) -> Float[np.ndarray, "F 3"]:
        """Horizontal unit vector that the hips face."""
        return _unit(np.cross(self.left, UP))

    @cached_property
    def yaw(self) -> Float[np.ndarray, "F"]:
        """Heading of the hips, radians, unwrapped."""
        return np.unwrap(np.arctan2(self.ahead[:, 0], self.ahead[:, 2]))

    @cached_property
    def above(self) -> Float[np.ndarray, "F 2 3"] | None:
        """Height of the sole points over the ground, meters."""
        if self.ground is None:
            return None
        x, y, z = np.moveaxis(self.soles, -1, 0)
        return y - self.ground.height(x, z)

    @property
    def toes(self) -> Float[np.ndarray, "F 2 3"]:
        """Toe joints; the ball of the foot where a rig has none."""
        return np.stack(
            [
                self.at(f"{name}Toes") if self.has(f"{name}Toes") else self.soles[:, side, BALL]
                for side, name in enumerate(SIDES)
            ],
            axis=1,
        )


def _unit(v: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "F 3"]:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)
