"""A flight of stairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import number, positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.ground.edges import Edges

if TYPE_CHECKING:
    from jaxtyping import Float

#: What still is a flight of stairs: largest riser and longest tread (m), risers.
HIGHEST, LONGEST, MOST = 2.0, 100.0, 10_000


@dataclass(frozen=True)
class Stairs:
    """``stairs:RISE,TREAD,COUNT``: risers along +Z from z = 1 m, level before and after.

    ``count`` risers of ``rise`` meters, one a ``tread``, the first at z = ``start``. A negative
    rise goes down. The edge itself belongs to the tread beyond it.
    """

    rise: float = 0.17
    tread: float = 0.29
    count: int = 10
    start: float = 1.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        rise = number("stairs rise", self.rise, "meters")
        if rise == 0.0:
            raise InvalidInputError("stairs rise must not be 0: level ground is 'flat'")
        if abs(rise) > HIGHEST:
            raise InvalidInputError(
                f"stairs rise must be from -{HIGHEST:g} to {HIGHEST:g} meters, got {rise:g}"
            )
        tread = positive("stairs tread", self.tread, "meters")
        if tread > LONGEST:
            raise InvalidInputError(
                f"stairs tread must be at most {LONGEST:g} meters, got {tread:g}"
            )
        count = number("stairs count", self.count, "risers")
        if count != int(count) or not 1 <= count <= MOST:
            raise InvalidInputError(
                f"stairs count must be a whole number of risers from 1 to {MOST}, "
                f"got {self.count!r}"
            )
        start = number("stairs start", self.start, "meters")
        fixed = {"rise": rise, "tread": tread, "count": int(count), "start": start}
        for name, value in fixed.items():
            object.__setattr__(self, name, value)

    @property
    def risers(self) -> Float[np.ndarray, "count"]:
        """Z of each riser, meters, in order."""
        return self.start + self.tread * np.arange(self.count)

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """See :meth:`gaitsmith.ground.Ground.height`."""
        z = np.asarray(z, dtype=np.float64)
        climbed = np.floor((z - self.start) / self.tread) + 1.0
        # the quotient rounds; the height must jump exactly at `risers`
        climbed = climbed + (self.start + self.tread * climbed <= z)
        climbed = climbed - (self.start + self.tread * (climbed - 1.0) > z)
        level = self.rise * np.clip(climbed, 0.0, self.count)
        return np.array(np.broadcast_to(level, np.broadcast_shapes(np.shape(x), z.shape)))

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
        return True

    def edges(self, low: tuple[float, float], high: tuple[float, float]) -> Edges:
        """See :meth:`gaitsmith.ground.Ground.edges`: the risers, as wide as the box."""
        risers = self.risers
        inside = (risers >= low[1]) & (risers <= high[1])
        z, number_of = risers[inside], np.flatnonzero(inside)
        under = self.rise * number_of
        above = self.rise * (number_of + 1.0)
        return Edges(
            begin=np.stack([np.full_like(z, low[0]), z], axis=-1),
            end=np.stack([np.full_like(z, high[0]), z], axis=-1),
            low=np.minimum(under, above),
            high=np.maximum(under, above),
        )

    def as_json(self) -> dict[str, Any]:
        """See :meth:`gaitsmith.ground.Ground.as_json`."""
        return {
            "kind": "stairs",
            "rise": self.rise,
            "tread": self.tread,
            "count": self.count,
            "start": self.start,
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Stairs:
        """See :meth:`gaitsmith.ground.Ground.from_json`."""
        return cls(data["rise"], data["tread"], data["count"], data.get("start", 1.0))
