"""Small systems of equations, many at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float

#: Difference by which slopes are taken.
_TINY = 1e-7


class Solved(NamedTuple):
    """``(n, k)`` unknowns, ``(n,)`` largest residual left, and how many rounds all took."""

    unknowns: Float[np.ndarray, "n k"]
    error: Float[np.ndarray, "n"]
    rounds: int


def newton(
    residual: Callable[[Float[np.ndarray, "n k"]], Float[np.ndarray, "n k"]],
    start: Float[np.ndarray, "n k"],
    *,
    tolerance: float = 1e-13,
    longest: float = 0.5,
    rounds: int = 30,
) -> Solved:
    """Roots of n independent systems of k equations, by Newton's steps from ``start``.

    ``residual`` is asked for all n at once; slopes are taken by differences. No unknown
    changes by more than ``longest`` in a round. A system that is solved, or gets no better,
    rests while others go on. What did not converge says so by its ``error``.
    """
    unknowns = np.array(start, dtype=np.float64)
    count = unknowns.shape[1]
    value = residual(unknowns)
    error = np.abs(value).max(axis=1, initial=0.0)
    done = 0
    while done < rounds and (error > tolerance).any():
        columns = [(residual(unknowns + step) - value) / _TINY for step in _TINY * np.eye(count)]
        slopes = np.stack(columns, axis=-1)
        # a touch of damping where a system is singular
        flat = np.abs(np.linalg.det(slopes)) < 1e-14
        slopes = slopes + 1e-9 * flat[:, None, None] * np.eye(count)
        change = np.linalg.solve(slopes, -value[..., None])[..., 0]
        size = np.abs(change).max(axis=1)
        change *= np.minimum(1.0, longest / np.maximum(size, 1e-300))[:, None]
        tried = unknowns + change
        new_value = residual(tried)
        new_error = np.abs(new_value).max(axis=1, initial=0.0)
        # far from the root a step may be worse and still lead on; near it rounding is the end
        better = (new_error < error) | ((error > 1e-9) & np.isfinite(new_error))
        done += 1
        if not better.any():
            break
        unknowns[better], value[better], error[better] = (
            tried[better],
            new_value[better],
            new_error[better],
        )
    return Solved(unknowns, error, done)
