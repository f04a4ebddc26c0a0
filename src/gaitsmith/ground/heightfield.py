"""Ground as heights on a square grid."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import frozen_array, number, positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.ground.edges import LEAST_JUMP, Edges

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

#: Most samples of a field: 60 m x 60 m in cells of 2 cm.
MOST_SAMPLES = 10_000_000
#: Nothing to walk on is higher or lower, meters.
HIGHEST = 1e5


def bumps(height: float = 0.06, length: float = 3.0, size: float = 12.0) -> np.ndarray:
    """Heights of round bumps every ``length`` meters both ways, in cells of 10 cm."""
    at = 2.0 * np.pi / length * np.arange(0.0, size + 0.05, 0.1)
    wave = 0.5 * (1.0 - np.cos(at))
    return np.round(height * wave[:, None] * wave, 6)


@dataclass(frozen=True, eq=False)
class HeightField:
    """``FILE.npz``, ``FILE.png`` or ``FILE.obj``: heights on a grid, or a mesh from above.

    Bilinear between the samples, clamped outside.

    Attributes
    ----------
    heights
        ``(R, C)`` meters, rows along +Z, columns along +X; bumps of 6 cm if not given.
    cell
        Meters between neighboring samples, both ways.
    origin
        x,z of ``heights[0, 0]``, meters.
    """

    heights: Float[np.ndarray, "R C"] = field(default_factory=bumps)
    cell: float = 0.1
    origin: tuple[float, float] = (-6.0, 0.0)

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        heights = frozen_array("height", self.heights, (None, None))
        if min(heights.shape) < 2 or heights.size > MOST_SAMPLES:
            raise InvalidInputError(
                "height must have 2 or more rows and columns and at most "
                f"{MOST_SAMPLES:.0e} samples, got {heights.shape[0]} x {heights.shape[1]}"
            )
        if np.abs(heights).max() > HIGHEST:
            raise InvalidInputError(
                f"height must be within {HIGHEST:g} meters, got {np.abs(heights).max():g}"
            )
        origin = np.shape(self.origin)
        if origin != (2,):
            raise InvalidInputError(f"origin must be x,z in meters, got {self.origin!r}")
        x, z = (number("origin", value, "meters") for value in self.origin)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "cell", positive("cell", self.cell, "meters"))
        object.__setattr__(self, "origin", (x, z))

    @cached_property
    def most_bent(self) -> float:
        """Change of slope per meter, along any line, that is nowhere exceeded."""
        h, bent = self.heights, 0.0
        for a, b, c in ((h[:-2], h[1:-1], h[2:]), (h[:, :-2], h[:, 1:-1], h[:, 2:])):
            if a.size:
                bent = max(bent, float(np.abs(a - 2.0 * b + c).max()))
        twisted = float(np.abs(h[1:, 1:] - h[1:, :-1] - h[:-1, 1:] + h[:-1, :-1]).max())
        return (bent + twisted) / self.cell**2

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """See :meth:`gaitsmith.ground.Ground.height`."""
        at, u, v, _, _ = self._place(x, z)
        left, right, far_left, far_right = self._corners(at)
        near = left + u * (right - left)
        return near + v * (far_left + u * (far_right - far_left) - near)

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """See :meth:`gaitsmith.ground.Ground.normal`."""
        at, u, v, in_x, in_z = self._place(x, z)
        left, right, far_left, far_right = self._corners(at)
        near, far = right - left, far_right - far_left
        across, along = far_left - left, far_right - right
        out = np.empty((*np.shape(u), 3))
        out[..., 0] = np.where(in_x, (near + v * (far - near)) / -self.cell, 0.0)
        out[..., 1] = 1.0
        out[..., 2] = np.where(in_z, (across + u * (along - across)) / -self.cell, 0.0)
        out /= np.sqrt((out * out).sum(-1, keepdims=True))
        return out

    def _place(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> tuple[
        Int[np.ndarray, "*n"],
        Float[np.ndarray, "*n"],
        Float[np.ndarray, "*n"],
        Bool[np.ndarray, "*n"],
        Bool[np.ndarray, "*n"],
    ]:
        """Flat index of the cell's first corner, the place in it (0 to 1), whether inside."""
        rows, columns = self.heights.shape
        x, z = np.broadcast_arrays(x, z)
        u = (x - self.origin[0]) / self.cell
        v = (z - self.origin[1]) / self.cell
        inside_x, inside_z = (u >= 0.0) & (u <= columns - 1), (v >= 0.0) & (v <= rows - 1)
        u, v = np.clip(u, 0.0, columns - 1.0), np.clip(v, 0.0, rows - 1.0)
        column = np.minimum(u.astype(np.intp), columns - 2)
        row = np.minimum(v.astype(np.intp), rows - 2)
        return row * columns + column, u - column, v - row, inside_x, inside_z

    def _corners(self, at: Int[np.ndarray, "*n"]) -> tuple[Float[np.ndarray, "*n"], ...]:
        """Heights at the four corners of cells: low x and high x, then both at higher z."""
        flat, columns = self.heights.reshape(-1), self.heights.shape[1]
        return tuple(flat.take(at + k) for k in (0, 1, columns, columns + 1))

    @property
    def stepped(self) -> bool:
        """See :attr:`gaitsmith.ground.Ground.stepped`."""
        return self._jumps

    @cached_property
    def _jumps(self) -> bool:
        least = max(LEAST_JUMP, self.cell)
        return any(bool((np.abs(np.diff(self.heights, axis=k)) >= least).any()) for k in (0, 1))

    def edges(self, low: tuple[float, float], high: tuple[float, float]) -> Edges:
        """See :meth:`gaitsmith.ground.Ground.edges`.

        Between neighboring samples that differ by 2 cm or more and by more than their distance:
        a line half way between them, one cell long.
        """
        columns, rows = (self._range(low[k], high[k], k) for k in (0, 1))
        begin_x, begin_z = (
            self.origin[k] + self.cell * part.start for k, part in ((0, columns), (1, rows))
        )
        part = self.heights[rows, columns]
        least, half = max(LEAST_JUMP, self.cell), 0.5 * self.cell
        found: list[tuple[np.ndarray, ...]] = []
        for axis in (0, 1):
            first = part[:-1] if axis == 0 else part[:, :-1]
            second = part[1:] if axis == 0 else part[:, 1:]
            row, column = np.nonzero(np.abs(second - first) >= least)
            x = begin_x + self.cell * (column + 0.5 * axis)
            z = begin_z + self.cell * (row + 0.5 * (1 - axis))
            middle = np.stack([x, z], axis=-1)
            along = np.array([half, 0.0] if axis == 0 else [0.0, half])
            heights = first[row, column], second[row, column]
            found.append(
                (middle - along, middle + along, np.minimum(*heights), np.maximum(*heights))
            )
        begin, end, under, above = (np.concatenate(c) for c in zip(*found, strict=True))
        inside = ((begin <= np.array(high)) & (end >= np.array(low))).all(axis=-1)
        return Edges(begin[inside], end[inside], under[inside], above[inside])

    def _range(self, low: float, high: float, axis: int) -> slice:
        """Samples that edges between ``low`` and ``high`` may lie between; columns are axis 0."""
        count = self.heights.shape[1 - axis]
        first, last = ((value - self.origin[axis]) / self.cell for value in (low, high))
        start = min(max(math.floor(max(first, -1.0)) - 1, 0), count)
        return slice(start, max(start, math.ceil(min(last, count + 1.0)) + 2))

    def as_json(self) -> dict[str, Any]:
        """See :meth:`gaitsmith.ground.Ground.as_json`."""
        return {
            "kind": "heightfield",
            "shape": list(self.heights.shape),
            "cell": self.cell,
            "origin": list(self.origin),
            "height": self.heights.reshape(-1).tolist(),
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> HeightField:
        """See :meth:`gaitsmith.ground.Ground.from_json`."""
        flat = frozen_array("height", data["height"], (None,))
        shape = tuple(data["shape"])
        if len(shape) != 2 or shape[0] * shape[1] != len(flat):
            raise InvalidInputError(
                f"shape must be rows, columns of the {len(flat)} heights, got {list(shape)}"
            )
        return cls(flat.reshape(shape).copy(), data["cell"], tuple(data["origin"]))
