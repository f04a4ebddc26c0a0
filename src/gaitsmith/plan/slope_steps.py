"""How long people step up and down: preferred step length for a height, [SM01] Eqs. 11-12."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import smoothstep

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body

#: Meters on the level and their change per degree, of average people, down and up. Downhill
#: slopes are negative: with the printed sign steps would grow where people shorten them.
DOWNHILL, UPHILL = (0.627, 0.0075), (0.623, -0.0019)
#: Degrees on both sides of level over which the lines, 4 mm apart there, become one.
BLEND = 1.0
#: Hip to ankle of who the lines are of, meters.
LEG = 0.92
#: Degrees: the height of a step down grows no more beyond the first; nobody walks the others.
STEEPEST_DOWN, STEEPEST_UP = -57.0, 60.0
_ROUNDS = 60


def preferred_step(
    slope: Float[np.ndarray, "*n"] | float, body: Body, *, level: float | None = None
) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
    """Step length and height that people prefer on a ``slope``, meters.

    Parameters
    ----------
    slope
        ``(*n,)`` radians that the ground rises ahead, within -57 and 60 degrees.
    body
        The lines are scaled by its leg.
    level
        Length of a step on level ground, meters; None: the lines' own, 0.625 m for a leg of
        0.92 m, which is a slow walk in a city.

    Notes
    -----
    [SM01] Eqs. 11 and 12, read off pedestrians on ramps to 9 degrees: beyond 15 they are a
    guess. The printed downhill line has the wrong sign (docs/papers/errata.md).
    """
    degrees = np.degrees(np.asarray(slope, dtype=np.float64))
    down, up = (base + change * degrees for base, change in (DOWNHILL, UPHILL))
    share = smoothstep(0.5 + 0.5 * degrees / BLEND)
    length = (down + share * (up - down)) * _scale(body, level)
    return length, length * np.tan(np.asarray(slope, dtype=np.float64))


def preferred_length(
    height: Float[np.ndarray, "*n"] | float, body: Body, *, level: float | None = None
) -> Float[np.ndarray, "*n"]:
    """Step length that people prefer for a step of ``height`` up (down: negative), meters.

    [SM01] section 6.2, step 3: the inverse of Eqs. 11-12, exact to rounding. Deeper or higher
    steps than the curves reach have no preferred length; the last one counts.
    """
    height = np.asarray(height, dtype=np.float64)
    low = np.full(height.shape, np.radians(STEEPEST_DOWN))
    high = np.full(height.shape, np.radians(STEEPEST_UP))
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        below = preferred_step(middle, body, level=level)[1] < height
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return preferred_step(0.5 * (low + high), body, level=level)[0]


def _scale(body: Body, level: float | None) -> float:
    if level is None:
        return body.leg_length / LEG
    return level / (0.5 * (DOWNHILL[0] + UPHILL[0]))
