"""What a ground must be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

if TYPE_CHECKING:
    from typing import Self

    import numpy as np
    from jaxtyping import Float

    from gaitsmith.ground.edges import Edges


@runtime_checkable
class Ground(Protocol):
    """Ground that can be asked for its height. Vectorised; total on the plane.

    What planners ask beyond one point is in :mod:`gaitsmith.ground.foot_plane` (how a foot
    stands) and :mod:`gaitsmith.ground.edges` (where the height jumps).
    """

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """Height in meters above world points ``(x, z)``; finite everywhere."""
        ...

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """Upward unit normal at world points ``(x, z)``; beside an edge that of the own side."""
        ...

    @property
    def stepped(self) -> bool:
        """Whether the height jumps anywhere."""
        ...

    def edges(self, low: tuple[float, float], high: tuple[float, float]) -> Edges:
        """Where the height jumps, inside the box from x,z ``low`` to ``high`` (meters)."""
        ...

    def as_json(self) -> dict[str, Any]:
        """JSON object that rebuilds this ground (design: ``ground`` of a motion)."""
        ...

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Self:
        """Ground of what :meth:`as_json` wrote; KeyError or InvalidInputError if it is none."""
        ...
