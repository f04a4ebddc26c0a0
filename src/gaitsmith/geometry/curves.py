"""Piecewise cubic curves: slopes, look-up, smooth steps. NumPy only, SciPy is the oracle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float, Int


#: Rows that are worked on at a time, so that they stay in the processor's cache.
BLOCK = 512


def smoothstep(u: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n"]:
    """``3u^2 - 2u^3`` on [0, 1], 0 before and 1 after: eases with no speed at both ends."""
    u = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
    return u * u * (3.0 - 2.0 * u)


def minimum_jerk(u: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n"]:
    """``10u^3 - 15u^4 + 6u^5`` on [0, 1]: eases with no speed and no acceleration at both ends."""
    u = np.clip(np.asarray(u, dtype=np.float64), 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def pchip_slopes(
    x: Float[np.ndarray, "n"], y: Float[np.ndarray, "n *c"]
) -> Float[np.ndarray, "n *c"]:
    """Slopes of the monotone cubic (PCHIP) through ``(x, y)``.

    Fritsch & Butland's weighted harmonic mean inside, the three-point end formula kept
    shape-preserving. The curve never leaves the range of neighbouring samples.
    """
    h = np.diff(x)
    rows = np.ascontiguousarray(y.reshape(len(x), -1).T)  # columns are worked on one by one
    d = np.diff(rows, axis=1) / h
    if len(x) == 2:
        return np.repeat(d.T, 2, axis=0).reshape(y.shape)
    w1, w2 = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    same = d[:, :-1] * d[:, 1:] > 0.0
    safe = np.where(same, d[:, :-1], 1.0), np.where(same, d[:, 1:], 1.0)
    slopes = np.zeros_like(rows)
    slopes[:, 1:-1] = np.where(same, (w1 + w2) / (w1 / safe[0] + w2 / safe[1]), 0.0)
    slopes[:, 0] = _pchip_end(h[0], h[1], d[:, 0], d[:, 1])
    slopes[:, -1] = _pchip_end(h[-1], h[-2], d[:, -1], d[:, -2])
    return slopes.T.reshape(y.shape)


def _pchip_end(
    h0: Float[np.ndarray, "*c"],
    h1: Float[np.ndarray, "*c"],
    d0: Float[np.ndarray, "*c"],
    d1: Float[np.ndarray, "*c"],
) -> Float[np.ndarray, "*c"]:
    slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    slope = np.where(np.sign(slope) != np.sign(d0), 0.0, slope)
    steep = (np.sign(d0) != np.sign(d1)) & (np.abs(slope) > np.abs(3.0 * d0))
    return np.where(steep, 3.0 * d0, slope)


def parabola_slopes(
    x: Float[np.ndarray, "n"], y: Float[np.ndarray, "n *c"]
) -> Float[np.ndarray, "n *c"]:
    """Slopes of the parabola through each sample and its neighbours (smooth data)."""
    h = np.diff(x)
    flat = y.reshape(len(x), -1)
    if len(x) == 2:
        return np.repeat((flat[1:] - flat[:1]) / h[0], 2, axis=0).reshape(y.shape)
    whole = h[1:] + h[:-1]
    before = (h[1:] / (whole * h[:-1]))[:, None]
    after = (h[:-1] / (whole * h[1:]))[:, None]
    slopes = np.empty(flat.shape)
    for first in range(1, len(x) - 1, BLOCK):
        last = min(first + BLOCK, len(x) - 1)
        here, value, shares = flat[first:last], slopes[first:last], slice(first - 1, last - 1)
        np.subtract(here, flat[first - 1 : last - 1], out=value)
        value *= before[shares]
        other = flat[first + 1 : last + 1] - here
        other *= after[shares]
        value += other
    for end, one, two, h0, h1 in ((0, 1, 2, h[0], h[1]), (-1, -2, -3, -h[-1], -h[-2])):
        d0, d1 = (flat[one] - flat[end]) / h0, (flat[two] - flat[one]) / h1
        slopes[end] = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
    return slopes.reshape(y.shape)


def hermite(
    x: Float[np.ndarray, "n"],
    y: Float[np.ndarray, "n c"],
    slopes: Float[np.ndarray, "n c"],
    at: Float[np.ndarray, "f"],
    interval: Int[np.ndarray, "f"] | None = None,
) -> Float[np.ndarray, "f c"]:
    """Cubic Hermite curve through ``(x, y)`` with ``slopes``, read at ``at``; clamped outside.

    ``interval`` (index of the left node) may be given by the caller who knows it.
    """
    if interval is None:
        interval = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = x[interval + 1] - x[interval]
    u = np.clip((at - x[interval]) / h, 0.0, 1.0)
    v = 1.0 - u
    # y0 + u^2 (3 - 2u) (y1 - y0): exact where both ends are equal and the slopes zero
    blend = (u * u * (3.0 - 2.0 * u))[:, None]
    begin, end = (h * u * v * v)[:, None], (h * u * u * v)[:, None]
    out = np.empty((len(at), y.shape[1]))
    scratch = np.empty((min(BLOCK, len(at)), y.shape[1]))
    # blocks of rows stay in the processor's cache: twice as fast as whole columns
    for start in range(0, len(at), BLOCK):
        rows = slice(start, min(start + BLOCK, len(at)))
        left, value = interval[rows], out[rows]
        other = scratch[: len(value)]
        np.take(y, left + 1, axis=0, out=value, mode="clip")
        np.take(y, left, axis=0, out=other, mode="clip")
        value -= other
        value *= blend[rows]
        value += other
        np.take(slopes, left, axis=0, out=other, mode="clip")
        other *= begin[rows]
        value += other
        np.take(slopes, left + 1, axis=0, out=other, mode="clip")
        other *= end[rows]
        value -= other
    return out


def hermite_slopes(
    x: Float[np.ndarray, "n"],
    y: Float[np.ndarray, "n c"],
    slopes: Float[np.ndarray, "n c"],
    at: Float[np.ndarray, "f"],
) -> Float[np.ndarray, "f c"]:
    """Slopes at ``at`` of the curve that :func:`hermite` reads."""
    interval = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    h = (x[interval + 1] - x[interval])[:, None]
    u = np.clip((at - x[interval])[:, None] / h, 0.0, 1.0)
    rise = (y[interval + 1] - y[interval]) / h
    begin, end = slopes[interval], slopes[interval + 1]
    v = 1.0 - u
    return 6.0 * u * v * rise + begin * v * (1.0 - 3.0 * u) + end * u * (3.0 * u - 2.0)


def pchip(
    x: Float[np.ndarray, "n"], y: Float[np.ndarray, "n *c"], at: Float[np.ndarray, "f"]
) -> Float[np.ndarray, "f *c"]:
    """Monotone cubic through ``(x, y)``, read at ``at``; clamped outside."""
    flat = y.reshape(len(x), -1)
    out = hermite(x, flat, pchip_slopes(x, flat), np.atleast_1d(at))
    return out.reshape(-1, *y.shape[1:])


def end_slope_correction(
    u: Float[np.ndarray, "n"], start: Float[np.ndarray, "*n c"], end: Float[np.ndarray, "*n c"]
) -> Float[np.ndarray, "n c"]:
    """Cubic on [0, 1] that is 0 at both ends with slopes ``start`` and ``end`` there.

    Added to a curve it changes the speed with which the curve begins and ends, spread over
    the whole interval, and moves neither end. The slopes may differ from sample to sample,
    where samples are of different curves.
    """
    begins, ends = u * (1.0 - u) ** 2, -u * u * (1.0 - u)
    return begins[:, None] * start + ends[:, None] * end


def running_maximum(values: Float[np.ndarray, "n"], half: int) -> Float[np.ndarray, "n"]:
    """Maximum of each value and its ``half`` neighbours on both sides."""
    padded = np.pad(values, half, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1).max(axis=-1)


def hann_average(values: Float[np.ndarray, "n"], half: int) -> Float[np.ndarray, "n"]:
    """Mean of each value and its ``half`` neighbours on both sides under a Hann window."""
    window = np.hanning(2 * half + 3)[1:-1]
    return np.convolve(np.pad(values, half, mode="edge"), window / window.sum(), mode="valid")
