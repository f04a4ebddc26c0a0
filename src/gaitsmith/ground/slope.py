"""A plane that rises along +Z."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith.errors import InvalidInputError
from gaitsmith.ground.edges import NO_EDGES

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground.edges import Edges

#: Degrees; nobody stands on what is steeper, far less walks (walkers refuse long before).
STEEPEST = 60.0


@dataclass(frozen=True)
class Slope:
    """``slope:DEG``: a plane that rises along +Z, y = z tan DEG, everywhere."""

    deg: float = 10.0

    def __post_init__(self) -> None:
        """Check the angle."""
        deg = number("ground slope", self.deg, "degrees")
        if abs(deg) > STEEPEST:
            raise InvalidInputError(
                f"ground slope must be from -{STEEPEST:g} to {STEEPEST:g} degrees, got {deg:g}"
            )
        object.__setattr__(self, "deg", deg)

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """See :meth:`gaitsmith.ground.Ground.height`."""
        z = np.asarray(z, dtype=np.float64)
        rise = z * math.tan(math.radians(self.deg))
        return np.array(np.broadcast_to(rise, np.broadcast_shapes(np.shape(x), z.shape)))

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """See :meth:`gaitsmith.ground.Ground.normal`."""
        out = np.zeros((*np.broadcast_shapes(np.shape(x), np.shape(z)), 3))
        angle = math.radians(self.deg)
        out[..., 1], out[..., 2] = math.cos(angle), -math.sin(angle)
        return out

    @property
    def stepped(self) -> bool:
        """See :attr:`gaitsmith.ground.Ground.stepped`."""
        return False

    def edges(self, low: tuple[float, float], high: tuple[float, float]) -> Edges:
        """See :meth:`gaitsmith.ground.Ground.edges`: none."""
        return NO_EDGES

    def as_json(self) -> dict[str, Any]:
        """See :meth:`gaitsmith.ground.Ground.as_json`."""
        return {"kind": "slope", "deg": self.deg}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Slope:
        """See :meth:`gaitsmith.ground.Ground.from_json`."""
        return cls(data["deg"])
