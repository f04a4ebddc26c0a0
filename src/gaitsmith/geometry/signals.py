"""Filters for measured signals. NumPy only; SciPy is the oracle of the tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float


def butterworth_zero_lag(
    signal: Float[np.ndarray, "n *c"], *, cutoff: float, rate: float
) -> Float[np.ndarray, "n *c"]:
    """Low-pass ``signal`` by a second-order Butterworth filter run forward and backward.

    The cut-off (Hz) is that of the two passes together: each pass runs at
    ``cutoff / 0.802`` (Winter, *Biomechanics and Motor Control of Human Movement*, section
    3.4.4.2). The ends are continued by point reflection, so slopes survive there.

    Raises
    ------
    InvalidInputError
        If the cut-off is not below half the rate.
    """
    corrected = cutoff / (np.sqrt(2.0) - 1.0) ** 0.25
    if not 0.0 < corrected < 0.5 * rate:
        raise InvalidInputError(
            f"cutoff must be between 0 and {0.5 * rate * 0.802:.3g} Hz at {rate:g} frames per "
            f"second, got {cutoff!r}"
        )
    c = np.tan(np.pi * corrected / rate)
    a0 = c * c / (1.0 + np.sqrt(2.0) * c + c * c)
    b1 = 2.0 * a0 * (1.0 / (c * c) - 1.0)
    b2 = 1.0 - 4.0 * a0 - b1
    pad = min(len(signal) - 1, int(np.ceil(3.0 * rate / cutoff)))
    head = 2.0 * signal[0] - signal[pad:0:-1]
    tail = 2.0 * signal[-1] - signal[-2 : -pad - 2 : -1]
    padded = np.concatenate([head, signal, tail])
    for _ in range(2):
        padded = _recursive(padded, a0, b1, b2)[::-1]
    return padded[pad : pad + len(signal)]


def _recursive(
    x: Float[np.ndarray, "n *c"], a0: float, b1: float, b2: float
) -> Float[np.ndarray, "n *c"]:
    """One pass of the difference equation; a recurrence, hence a loop (learning only)."""
    y = np.empty_like(x)
    y[0], y[1] = x[0], x[1] if len(x) > 1 else x[0]
    driven = a0 * (x[2:] + 2.0 * x[1:-1] + x[:-2])
    for i in range(2, len(x)):
        y[i] = driven[i - 2] + b1 * y[i - 1] + b2 * y[i - 2]
    return y
