"""What a ground must be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Float


@runtime_checkable
class Ground(Protocol):
    """Ground that can be asked for its height. Vectorised; total on the plane."""

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """Height in meters above world points ``(x, z)``; finite everywhere."""
        ...

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """Upward unit normal at world points ``(x, z)``."""
        ...

    def as_json(self) -> dict[str, Any]:
        """JSON object that rebuilds this ground (design: ``ground`` of a motion)."""
        ...
