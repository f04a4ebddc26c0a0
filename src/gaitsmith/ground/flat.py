"""Level ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number
from gaitsmith.ground.edges import NO_EDGES

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground.edges import Edges


@dataclass(frozen=True)
class Flat:
    """Level ground, at ``level`` meters."""

    level: float = 0.0

    def __post_init__(self) -> None:
        """Check the level."""
        object.__setattr__(self, "level", number("ground level", self.level, "meters"))

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """See :meth:`gaitsmith.ground.Ground.height`."""
        return np.full(np.broadcast_shapes(np.shape(x), np.shape(z)), self.level)

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """See :meth:`gaitsmith.ground.Ground.normal`."""
        out = np.zeros((*np.broadcast_shapes(np.shape(x), np.shape(z)), 3))
        out[..., 1] = 1.0
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
        return {"kind": "flat", "height": self.level}

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Flat:
        """See :meth:`gaitsmith.ground.Ground.from_json`."""
        return cls(data.get("height", 0.0))
