"""Which mix of datasets takes a step of a given length and height: ElevInterp of [SM01]."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.triangulation import Triangulation
from gaitsmith.walks.elevation import mixed
from gaitsmith.walks.step_of import PlanarFigure, step_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body
    from gaitsmith.walks.elevation import ElevationSet

#: Least weight of a set: so far, and no farther, sets are continued beyond the outermost ones.
LEAST_WEIGHT = -0.25
#: Meters by which a step that is reached may be off, and rounds of Newton until then.
REACHED, _ROUNDS = 1e-12, 20
#: Halvings to find how far a step beyond the limit must be pulled back.
_PULLS = 40


class Mix(NamedTuple):
    """Weights for n steps.

    Attributes
    ----------
    weights
        ``(n, S)`` of the sets, each row sums to 1.
    achieved
        ``(n, 2)`` step (length, height) that they take, meters: what was asked for, or the
        nearest that the sets reach.
    outside
        ``(n,)`` whether the step asked for is outside of what the sets span.
    """

    weights: Float[np.ndarray, "n S"]
    achieved: Float[np.ndarray, "n 2"]
    outside: Bool[np.ndarray, "n"]


class ElevInterp:
    """The map from step length and height to weights of elevation sets, for one body.

    Parameters
    ----------
    sets
        Three or more, whose steps are not all in line.
    body
        Who steps. The sets are of angles, so another body's steps differ, and its weights.
    others
        As many sets of the leg that lands, where it does not walk as the one that stands.

    Notes
    -----
    [SM01] section 5 caches every answer and starts the next search from it, so that an answer
    depends on what was asked before; :class:`~gaitsmith.walks.paper_interp.PaperInterp` does
    that. Here the start is the barycentric mix of the given sets, and the search goes the
    shortest way over all their weights: the same question always has the same answer.
    """

    def __init__(
        self,
        sets: Sequence[ElevationSet],
        body: Body,
        others: Sequence[ElevationSet] | None = None,
    ) -> None:
        self.sets = tuple(s.for_body(body) for s in sets)
        landing = self.sets if others is None else tuple(s.for_body(body) for s in others)
        self.figure = PlanarFigure.of(body)
        half = {len(s.angles) for s in (*self.sets, *landing)}
        if len(half) != 1 or len(landing) != len(self.sets):
            raise InvalidInputError("all sets need equally many samples, and each leg as many sets")
        middle = half.pop() // 2
        self._stance = np.stack([s.angles[middle] for s in self.sets])
        self._swing = np.stack([s.angles[0] for s in landing])
        self._slope = np.array([s.slope for s in self.sets])
        #: ``(S, 2)`` step (length, height) of each set, meters.
        self.steps = self.step(np.eye(len(self.sets)))
        try:
            self._plane = Triangulation(self.steps)
        except InvalidInputError:
            raise InvalidInputError(
                f"three or more sets whose steps are not all in line are needed, got "
                f"{', '.join(s.name for s in self.sets)}"
            ) from None

    def step(self, weights: Float[np.ndarray, "n S"]) -> Float[np.ndarray, "n 2"]:
        """Step (length, height) that mixes take, f of [SM01], meters."""
        return step_of(
            self.figure, weights @ self._stance, weights @ self._swing, weights @ self._slope
        )

    def slopes(self, weights: Float[np.ndarray, "n S"]) -> Float[np.ndarray, "n 2 S"]:
        """How the step changes with each weight, meters: exact, by the complex step."""
        weights = np.asarray(weights, dtype=np.float64)
        tiny = 1e-30
        moved = weights[..., None, :] + 1j * tiny * np.eye(weights.shape[-1])
        return np.swapaxes(np.imag(self.step(moved)) / tiny, -1, -2)

    def dataset(self, weights: Float[np.ndarray, "S"]) -> ElevationSet:
        """The mixed set, [SM01] Eq. 9."""
        return mixed(self.sets, weights)

    def find(self, steps: Float[np.ndarray, "n 2"]) -> Mix:
        """Weights that take ``steps`` (length, height), meters.

        A step that no weights of -0.25 and more take is pulled back toward those that the sets
        span, and said to be ``outside``, as every step beyond them is; nothing is refused.
        """
        steps = frozen_array("steps", steps, (None, 2))
        prior, inner, outside = self._priors(steps)
        weights, reached = self.refined(prior, steps)
        far = outside & ~(reached & (weights.min(axis=1) >= LEAST_WEIGHT - 1e-9))
        if far.any():
            weights[far] = self._pulled(inner[far], steps[far])
        lost = ~outside & ~reached
        if lost.any():
            raise AssertionError(f"no mix takes a step of {steps[lost][0].tolist()} m")
        return Mix(weights, self.step(weights), outside)

    def refined(
        self, weights: Float[np.ndarray, "n S"], steps: Float[np.ndarray, "n 2"]
    ) -> tuple[Float[np.ndarray, "n S"], Bool[np.ndarray, "n"]]:
        """Least change of ``weights``, their sum kept, to take ``steps``; whether they do."""
        weights = np.array(weights, dtype=np.float64)
        count = weights.shape[1]
        keep_sum = np.eye(count) - 1.0 / count
        error = steps - self.step(weights)
        for _ in range(_ROUNDS):
            if np.abs(error).max(initial=0.0) < REACHED:
                break
            slopes = self.slopes(weights) @ keep_sum
            normal = slopes @ np.swapaxes(slopes, 1, 2)
            change = np.swapaxes(slopes, 1, 2) @ np.linalg.solve(normal, error[..., None])
            longest = np.abs(change).max(axis=(1, 2))
            change *= np.minimum(1.0, 0.5 / np.maximum(longest, 1e-300))[:, None, None]
            weights = weights + change[..., 0]
            error = steps - self.step(weights)
        return weights, np.abs(error).max(axis=1, initial=0.0) < 1e-9

    def _priors(
        self, steps: Float[np.ndarray, "n 2"]
    ) -> tuple[Float[np.ndarray, "n S"], Float[np.ndarray, "n S"], Bool[np.ndarray, "n"]]:
        """Barycentric mixes of the sets; the same inside of what they span; what is outside."""
        triangles = self._plane.triangles
        corners = self.steps[triangles]
        table = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2)
        target = np.concatenate([steps, np.ones((len(steps), 1))], axis=1)
        shares = np.einsum("ni,tic->ntc", target, np.linalg.inv(table))
        which = shares.min(axis=2).argmax(axis=1)
        own = shares[np.arange(len(steps)), which]
        outside = own.min(axis=1) < -1e-9
        inner = np.maximum(own, 0.0)
        inner /= inner.sum(axis=1, keepdims=True)
        out = np.zeros((2, len(steps), len(self.sets)))
        rows = np.arange(len(steps))[:, None]
        out[0, rows, triangles[which]] = own
        out[1, rows, triangles[which]] = inner
        return out[0], out[1], outside

    def _pulled(
        self, inner: Float[np.ndarray, "n S"], steps: Float[np.ndarray, "n 2"]
    ) -> Float[np.ndarray, "n S"]:
        """Weights of the farthest step allowed between what ``inner`` takes and ``steps``."""
        start = self.step(inner)
        good, low, high = inner.copy(), np.zeros(len(steps)), np.ones(len(steps))
        for _ in range(_PULLS):
            middle = 0.5 * (low + high)
            target = start + middle[:, None] * (steps - start)
            weights, reached = self.refined(inner, target)
            allowed = reached & (weights.min(axis=1) >= LEAST_WEIGHT)
            good = np.where(allowed[:, None], weights, good)
            low, high = np.where(allowed, middle, low), np.where(allowed, high, middle)
        return good
