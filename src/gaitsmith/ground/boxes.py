"""Low things that lie on another ground: boxes, kerbs, planks."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import frozen_array, number
from gaitsmith.errors import InvalidInputError, UnknownNameError
from gaitsmith.geometry.outlines import simple_outline
from gaitsmith.geometry.solids import inside_polygon
from gaitsmith.ground.edges import LEAST_JUMP, Edges
from gaitsmith.ground.flat import Flat
from gaitsmith.ground.heightfield import HeightField
from gaitsmith.ground.slope import Slope
from gaitsmith.ground.stairs import Stairs

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.ground.model import Ground

#: What boxes may lie on: grounds that know no other ground. A new ground is one line here.
BASES: dict[str, type[Ground]] = {
    "flat": Flat,
    "slope": Slope,
    "stairs": Stairs,
    "heightfield": HeightField,
}
#: Highest box (m), farthest corner (m), most corners of one and most boxes.
HIGHEST, FARTHEST, MOST_CORNERS, MOST = 3.0, 2000.0, 1000, 1000
#: Sides on ground that is not level are cut into pieces of this length (m), each with its heights.
PIECE = 0.05
#: So far beside the middle of a side (m) the ground is read on both its sides.
ASIDE = 1e-7
#: Pieces of sides shorter than this (m) are none.
NOTHING = 1e-9

Point = tuple[float, float]


@dataclass(frozen=True)
class Box:
    """A solid of one height whose outline, seen from above, is a simple polygon.

    Attributes
    ----------
    points
        x,z of its corners, meters, in either order, three or more.
    height
        Of its top over the ground that it lies on, meters: the top is as steep as that ground.
    """

    points: tuple[Point, ...]
    height: float

    def __post_init__(self) -> None:
        """Check both."""
        height = number("the height of a box", self.height, "meters")
        if not LEAST_JUMP <= height <= HIGHEST:
            raise InvalidInputError(
                f"the height of a box must be from {LEAST_JUMP:g} to {HIGHEST:g} m, got "
                f"{height:g}; what is lower is not felt underfoot and may be left out"
            )
        points = simple_outline("a box", self.points, most=MOST_CORNERS, farthest=FARTHEST)
        object.__setattr__(self, "height", height)
        object.__setattr__(self, "points", points)

    @cached_property
    def corners(self) -> Float[np.ndarray, "m 2"]:
        """The corners as an array."""
        return frozen_array("corners", self.points, (None, 2))

    def covers(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Bool[np.ndarray, "*n"]:
        """Whether points lie under the outline."""
        (x0, z0), (x1, z1) = self.corners.min(axis=0), self.corners.max(axis=0)
        out = (x >= x0) & (x <= x1) & (z >= z0) & (z <= z1)
        if out.any():  # of most boxes all points are far away
            near = np.stack([x[out], z[out]], axis=-1)
            out[out] = inside_polygon(near, self.corners)
        return out

    def as_json(self) -> dict[str, Any]:
        """JSON object of it."""
        return {"points": [list(p) for p in self.points], "height": self.height}


#: A kerb across the way and a step on it.
_EXAMPLE = (
    Box(((-2.0, 1.5), (2.0, 1.5), (2.0, 2.5), (-2.0, 2.5)), 0.1),
    Box(((-1.0, 2.0), (1.0, 2.0), (1.0, 3.5), (-1.0, 3.5)), 0.2),
)


@dataclass(frozen=True, eq=False)
class Boxes:
    """``FILE.toml``: boxes on a ground; where they overlap the highest counts.

    Attributes
    ----------
    base
        What they lie on; boxes on boxes are one ground of all of them.
    boxes
        One or more.
    """

    base: Ground = field(default_factory=Flat)
    boxes: tuple[Box, ...] = _EXAMPLE

    def __post_init__(self) -> None:
        """Check that there are some, and put them on one ground."""
        boxes = tuple(self.boxes)
        if not 1 <= len(boxes) <= MOST:
            raise InvalidInputError(
                f"a ground with boxes needs 1 to {MOST} of them, got {len(boxes)}"
            )
        base = self.base
        if isinstance(base, Boxes):
            base, boxes = base.base, (*base.boxes, *boxes)
        object.__setattr__(self, "base", base)
        object.__setattr__(self, "boxes", boxes)

    def height(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """See :meth:`gaitsmith.ground.Ground.height`."""
        return self.base.height(x, z) + self._on_top(x, z)

    def _on_top(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n"]:
        """Meters by which boxes lift the ground."""
        shape = np.broadcast_shapes(np.shape(x), np.shape(z))
        flat_x, flat_z = (np.broadcast_to(v, shape).reshape(-1) for v in (x, z))
        out = np.zeros(flat_x.shape)
        for box in self.boxes:
            covered = box.covers(flat_x, flat_z)
            out[covered] = np.maximum(out[covered], box.height)
        return out.reshape(shape)

    def normal(
        self, x: Float[np.ndarray, "*n"], z: Float[np.ndarray, "*n"]
    ) -> Float[np.ndarray, "*n 3"]:
        """See :meth:`gaitsmith.ground.Ground.normal`: tops are as steep as what they lie on."""
        return self.base.normal(x, z)

    @property
    def stepped(self) -> bool:
        """See :attr:`gaitsmith.ground.Ground.stepped`."""
        return True

    def edges(self, low: tuple[float, float], high: tuple[float, float]) -> Edges:
        """See :meth:`gaitsmith.ground.Ground.edges`.

        The sides of all boxes and the edges of the ground below, cut where they meet: what lies
        under a higher box is none, what crosses a box is lifted by it.
        """
        level = isinstance(self.base, Flat | Stairs)
        corners = [box.corners for box in self.boxes]
        sides = np.concatenate([np.stack([c, np.roll(c, -1, axis=0)], axis=1) for c in corners])
        sides = _clipped(sides, np.array(low), np.array(high))
        found = self.base.edges(low, high)
        below = np.stack([found.begin, found.end], axis=1)
        of = np.arange(len(below))
        lines, _ = _cut(sides, np.concatenate([sides, below]))
        below, of = _cut(below, sides)
        if not level:
            lines = _pieces(lines)
        beside = self._beside(lines)
        if isinstance(self.base, Stairs):
            under = self._beside(below)
        else:  # jumps of a field are as wide as its cells
            middle = below.mean(axis=1)
            under = np.stack([found.low[of], found.high[of]]) + self._on_top(*middle.T)
        heights = np.sort(np.concatenate([beside, under], axis=1), axis=0)
        lines = np.concatenate([lines, below])
        jumps = heights[1] - heights[0] >= 0.5 * LEAST_JUMP
        return Edges(lines[jumps, 0], lines[jumps, 1], *heights[:, jumps])

    def _beside(self, lines: Float[np.ndarray, "n 2 2"]) -> Float[np.ndarray, "2 n"]:
        """Heights on both sides of the middle of straight lines."""
        along = lines[:, 1] - lines[:, 0]
        size = np.maximum(np.linalg.norm(along, axis=-1), 1e-300)
        across = ASIDE * np.stack([-along[:, 1], along[:, 0]], axis=-1) / size[:, None]
        middle = lines.mean(axis=1)
        return np.stack([self.height(*(middle + sign * across).T) for sign in (-1.0, 1.0)])

    def as_json(self) -> dict[str, Any]:
        """See :meth:`gaitsmith.ground.Ground.as_json`."""
        return {
            "kind": "boxes",
            "ground": self.base.as_json(),
            "boxes": [box.as_json() for box in self.boxes],
        }

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Boxes:
        """See :meth:`gaitsmith.ground.Ground.from_json`."""
        kind = data["ground"]["kind"]
        if kind not in BASES:
            raise UnknownNameError("ground below boxes", str(kind), BASES)
        boxes = tuple(Box(tuple(box["points"]), box["height"]) for box in data["boxes"])
        return cls(BASES[kind].from_json(data["ground"]), boxes)


def _clipped(
    lines: Float[np.ndarray, "n 2 2"], low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "m 2 2"]:
    """What of straight lines is inside a box (Liang and Barsky's way)."""
    begin, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    first, last = np.zeros(len(lines)), np.ones(len(lines))
    inside = (low <= high).all() & np.ones(len(lines), dtype=np.bool_)
    for k in (0, 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            at = np.sort(
                [(low[k] - begin[:, k]) / along[:, k], (high[k] - begin[:, k]) / along[:, k]],
                axis=0,
            )
        still = along[:, k] == 0.0
        inside &= ~still | ((begin[:, k] >= low[k]) & (begin[:, k] <= high[k]))
        first = np.where(still, first, np.maximum(first, at[0]))
        last = np.where(still, last, np.minimum(last, at[1]))
    inside &= first < last
    ends = [begin + share[:, None] * along for share in (first, last)]
    return np.clip(np.stack(ends, axis=1)[inside], low, high)


def _cut(
    lines: Float[np.ndarray, "n 2 2"], by: Float[np.ndarray, "k 2 2"]
) -> tuple[Float[np.ndarray, "m 2 2"], Int[np.ndarray, "m"]]:
    """Lines cut where they meet any of the lines ``by``, and which each piece is of."""
    knives = Edges(by[:, 0], by[:, 1], np.zeros(len(by)), np.zeros(len(by)))
    met = knives.crossings(lines[:, 0], lines[:, 1])
    every = np.arange(len(lines))
    which = np.concatenate([every, met.way, every])
    at = np.concatenate([np.zeros(len(lines)), met.at, np.ones(len(lines))])
    order = np.lexsort((at, which))
    which, at = which[order], at[order]
    along = lines[:, 1] - lines[:, 0]
    size = np.linalg.norm(along, axis=-1)[which[1:]]
    piece = (which[1:] == which[:-1]) & (size * np.diff(at) > NOTHING)
    of, first, last = which[1:][piece], at[:-1][piece], at[1:][piece]
    ends = [lines[of, 0] + share[:, None] * along[of] for share in (first, last)]
    return np.stack(ends, axis=1), of


def _pieces(lines: Float[np.ndarray, "n 2 2"]) -> Float[np.ndarray, "m 2 2"]:
    """Lines cut into short pieces."""
    along = lines[:, 1] - lines[:, 0]
    count = np.maximum(np.ceil(np.linalg.norm(along, axis=-1) / PIECE), 1.0).astype(np.int64)
    line = np.repeat(np.arange(len(lines)), count)
    number_of = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    first, last = (((number_of + k) / count[line])[:, None] for k in (0, 1))
    return np.stack(
        [lines[line, 0] + first * along[line], lines[line, 0] + last * along[line]], axis=1
    )
