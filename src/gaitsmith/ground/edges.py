"""Where the height of a ground jumps: risers, kerbs, the rims of holes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: A height field jumps where neighboring samples differ by this (m) and by more than their
#: distance (45 deg): lower is a rough surface, flatter a slope.
LEAST_JUMP = 0.02
#: Entries of a table of places x edges at once.
_TABLE = 400_000
_NONE = np.empty(0, dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Edges:
    """E straight lines, seen from above, across which the height jumps.

    Attributes
    ----------
    begin, end
        ``(E, 2)`` x,z of their ends, meters.
    low, high
        ``(E,)`` heights of the ground on their two sides, meters.
    """

    begin: Float[np.ndarray, "E 2"]
    end: Float[np.ndarray, "E 2"]
    low: Float[np.ndarray, "E"]
    high: Float[np.ndarray, "E"]

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.low)
        for name, shape in (
            ("begin", (count, 2)),
            ("end", (count, 2)),
            ("low", (count,)),
            ("high", (count,)),
        ):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape))

    def __len__(self) -> int:
        """How many."""
        return len(self.low)

    def distance(self, places: Float[np.ndarray, "*n 2"]) -> Float[np.ndarray, "*n"]:
        """Meters, seen from above, from x,z ``places`` to the nearest edge; inf without one."""
        places = np.asarray(places, dtype=np.float64)
        if len(self) == 0:
            return np.full(places.shape[:-1], np.inf)
        along = self.end - self.begin
        size = np.maximum((along * along).sum(-1), 1e-300)
        each = places.reshape(-1, 2)
        out = np.empty(len(each))
        for part in self._parts(len(each)):
            from_begin = each[part, None, :] - self.begin
            share = np.clip((from_begin * along).sum(-1) / size, 0.0, 1.0)
            off = from_begin - share[..., None] * along
            out[part] = np.sqrt((off * off).sum(-1).min(-1))
        return out.reshape(places.shape[:-1])

    def crossings(
        self, begin: Float[np.ndarray, "n 2"], end: Float[np.ndarray, "n 2"]
    ) -> Crossings:
        """Which of the n straight ways from x,z ``begin`` to ``end`` cross which edges, where.

        A way that runs along an edge does not cross it. Ways are feet (heel to toe tip), or
        pieces of the track of a swinging foot.
        """
        begin = np.asarray(begin, dtype=np.float64)
        ways = np.asarray(end, dtype=np.float64) - begin
        along = self.end - self.begin
        found: list[tuple[np.ndarray, ...]] = [(_NONE, _NONE, np.empty(0))]
        for part in self._parts(len(begin) if len(self) else 0):
            way = ways[part, None]
            gap = self.begin - begin[part, None]
            across = _cross(way, along)
            with np.errstate(divide="ignore", invalid="ignore"):
                on_way = _cross(gap, along) / across
                on_edge = _cross(gap, way) / across
            hit = (across != 0.0) & (on_way >= 0.0) & (on_way <= 1.0)
            which, edge = np.nonzero(hit & (on_edge >= 0.0) & (on_edge <= 1.0))
            found.append((part.start + which, edge, on_way[which, edge]))
        which, edge, at = (np.concatenate(column) for column in zip(*found, strict=True))
        return Crossings(which, edge, at, self.low[edge], self.high[edge])

    def _parts(self, count: int) -> list[slice]:
        """``count`` rows in parts that keep tables of rows x edges small."""
        size = max(1, _TABLE // max(len(self), 1))
        return [slice(k, k + size) for k in range(0, count, size)]


@dataclass(frozen=True, eq=False)
class Crossings:
    """C crossings of ways with edges, by way, then by edge.

    Attributes
    ----------
    way, edge
        ``(C,)`` indices.
    at
        ``(C,)`` where on the way, 0 its begin, 1 its end.
    low, high
        ``(C,)`` heights of the ground on the two sides there, meters.
    """

    way: Int[np.ndarray, "C"]
    edge: Int[np.ndarray, "C"]
    at: Float[np.ndarray, "C"]
    low: Float[np.ndarray, "C"]
    high: Float[np.ndarray, "C"]

    def __len__(self) -> int:
        """How many."""
        return len(self.at)


def _cross(a: Float[np.ndarray, "*n 2"], b: Float[np.ndarray, "*n 2"]) -> Float[np.ndarray, "*n"]:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


NO_EDGES = Edges(np.empty((0, 2)), np.empty((0, 2)), np.empty(0), np.empty(0))
