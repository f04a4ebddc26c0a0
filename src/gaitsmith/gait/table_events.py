"""Key frames by Table 1 of [KN12], read literally: for comparison, not for use.

The table names an acceleration without its component, a filter without its width and "zero"
without a tolerance. Whatever one takes, no one setting finds all four events
(``docs/papers/kn12.md``); :mod:`gaitsmith.gait.events` is what everything else uses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import one_of, positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

#: What "acceleration" may mean: its vertical component with its sign, or how large it is.
READINGS = ("vertical", "magnitude")
#: Share of the accelerations that are not larger than what "zero" is compared with.
_LARGE = 0.95


def table_events(
    ankle: Float[np.ndarray, "F 3"],
    toe: Float[np.ndarray, "F 3"],
    rate: float,
    strides: Sequence[tuple[float, float]],
    *,
    sigma: float = 0.04,
    tolerance: float = 0.2,
    reading: str = "vertical",
) -> Float[np.ndarray, "S 4"]:
    """Heel strike, foot flat, heel off and toe-off of one foot in each stride, seconds.

    Parameters
    ----------
    ankle, toe
        Paths of the two joints, meters.
    rate
        Frames per second.
    strides
        Begin and end of each, seconds: the table finds one of each event in a stride.
    sigma
        Width of the Gaussian whose second derivative gives the acceleration, seconds.
    tolerance
        What counts as zero, over the acceleration that 95 % of all are below.
    reading
        ``"vertical"`` or ``"magnitude"``.

    Returns
    -------
    Not a number where no frame meets the conditions.

    Notes
    -----
    [KN12] Table 1: at heel strike the ankle's acceleration is zero, the toe's above it, the ankle
    lowest; foot flat is the first frame with both zero; at push-off the ankle's is above zero, the
    toe's zero, the ankle lowest; at toe-off both are above zero, the toe lowest.
    """
    one_of("reading", reading, READINGS)
    rate, sigma = positive("rate", rate, "1/s"), positive("sigma", sigma, "seconds")
    heel, tip = (_acceleration(path, rate, sigma, reading) for path in (ankle, toe))
    still = [np.abs(a) <= tolerance * np.quantile(np.abs(a), _LARGE) for a in (heel, tip)]
    above = [(a > 0.0) & ~zero for a, zero in zip((heel, tip), still, strict=True)]
    order = np.arange(len(heel), dtype=np.float64)
    rules = (
        (still[0] & above[1], ankle[:, 1]),
        (still[0] & still[1], order),
        (above[0] & still[1], ankle[:, 1]),
        (above[0] & above[1], toe[:, 1]),
    )
    out = np.full((len(strides), len(rules)), np.nan)
    for row, (begin, end) in enumerate(strides):
        inside = (order >= begin * rate) & (order < end * rate)
        for column, (meets, least) in enumerate(rules):
            frames = np.flatnonzero(inside & meets)
            if len(frames):
                out[row, column] = frames[least[frames].argmin()] / rate
    return out


def _acceleration(
    path: Float[np.ndarray, "F 3"], rate: float, sigma: float, reading: str
) -> Float[np.ndarray, "F"]:
    """Second derivative of a Gaussian laid over the path, m/s^2."""
    half = int(np.ceil(4.0 * sigma * rate))
    t = np.arange(-half, half + 1) / rate
    bell = np.exp(-0.5 * (t / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi)) / rate
    kernel = bell * (t**2 / sigma**4 - 1.0 / sigma**2)
    kernel -= bell * (kernel.sum() / bell.sum())  # nothing for what stands still
    padded = np.pad(path, ((half, half), (0, 0)), mode="reflect", reflect_type="odd")
    each = np.stack([np.convolve(column, kernel, mode="valid") for column in padded.T])
    return each[1] if reading == "vertical" else np.linalg.norm(each, axis=0)
