"""Level ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number

if TYPE_CHECKING:
    from jaxtyping import Float


@dataclass(frozen=True)
class Flat:
    """A level plane at ``level`` meters."""

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

    def as_json(self) -> dict[str, Any]:
        """See :meth:`gaitsmith.ground.Ground.as_json`."""
        return {"kind": "flat", "height": self.level}
