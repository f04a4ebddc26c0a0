"""The search of [SM01] section 5.1 as it is printed: every answer becomes a vertex."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.geometry.triangulation import Triangulation
from gaitsmith.walks.interpolate import REACHED, ElevInterp, Mix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.elevation import ElevationSet

#: No vertex is added nearer to another one than this, meters: the paper's cache has no end.
NEAREST = 0.01
_ROUNDS = 20


@dataclass
class SearchCost:
    """What the searches so far took: asked, triangles walked, rounds of Newton, vertices added."""

    asked: int = 0
    walked: int = 0
    rounds: int = 0
    added: int = 0


class PaperInterp:
    """ElevInterp with the paper's cache: the answer depends on what was asked before.

    Parameters
    ----------
    sets, body
        As of :class:`~gaitsmith.walks.interpolate.ElevInterp`.
    capped
        Whether a vertex nearer than 1 cm to another one, or already exact, is left out. The
        paper adds all: 600 frames leave some 600 of them.

    Notes
    -----
    [SM01] steps 1-6. A vertex keeps its weights over the given sets only. One triangulation, in
    the space of lengths and heights: the paper keeps a second one, of coordinates that it calls
    arbitrary, whose triangles need not be the same. Steps outside of the sets' hull are pulled
    to it, which the paper does not speak of.
    """

    def __init__(self, sets: Sequence[ElevationSet], body: Body, *, capped: bool = True) -> None:
        self.base = ElevInterp(sets, body)
        self.capped = capped
        self.cost = SearchCost()
        self._plane = Triangulation(self.base.steps)
        self._weights = list(np.eye(len(self.base.sets)))

    @property
    def vertices(self) -> Float[np.ndarray, "V 2"]:
        """Steps that are known by now, the given sets' first."""
        return self._plane.points

    def find(self, steps: Float[np.ndarray, "n 2"]) -> Mix:
        """Weights that take ``steps``, asked one after the other."""
        steps = frozen_array("steps", steps, (None, 2))
        rows = [self._find(step) for step in steps]
        weights = np.array([row for row, _ in rows]).reshape(-1, len(self.base.sets))
        return Mix(weights, self.base.step(weights), np.array([out for _, out in rows], dtype=bool))

    def _find(self, step: Float[np.ndarray, "2"]) -> tuple[Float[np.ndarray, "S"], bool]:
        triangle, walked = self._plane.locate(step)  # 1
        shares = self._plane.shares(triangle, step)  # 2
        outside = bool(shares.min() < -1e-9)
        if outside:
            shares = np.maximum(shares, 0.0)
            shares /= shares.sum()
            step = shares @ self._plane.points[list(triangle)]
        corners = np.stack([self._weights[i] for i in triangle])
        weights = shares @ corners  # 3
        error = step - self.base.step(weights)
        rounds, exact = 0, bool(np.abs(error).max() < 1e-9)  # 4
        while np.abs(error).max() >= REACHED and rounds < _ROUNDS:  # 5
            ways = (corners[:2] - corners[2]).T
            change = np.linalg.solve(self.base.slopes(weights) @ ways, error)
            weights = weights + ways @ change
            error = step - self.base.step(weights)
            rounds += 1
        self.cost.asked += 1
        self.cost.walked += walked
        self.cost.rounds += rounds
        gap = np.sqrt(((self._plane.points - step) ** 2).sum(-1)).min()
        if not outside and gap > 1e-9 and not (self.capped and (exact or gap < NEAREST)):
            self._plane.insert(step)  # 6
            self._weights.append(weights)
            self.cost.added += 1
        return weights, outside
