"""Curves of one local step, [KB93] sections 5 and 6: pure functions of the normalized time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.curves import hermite, parabola_slopes, smoothstep

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.walks.model import SagittalStep

#: Height of a swing of swhf = 1, meters.
SWING_HEIGHT = 0.05
#: Pitches smaller than this cannot be scaled, radians.
LEAST_PITCH = 1e-6


def swing_lift(u: Float[np.ndarray, "T"], swhf: float = 1.0) -> Float[np.ndarray, "T"]:
    """Height of the swinging ankle above the line between its ends, meters: [KB93] Eq. 3.

    ``u`` is the phase of the SWING, 0 to 1; 5 swhf cm at its middle. The printed formula counts
    centimeters.
    """
    ends = np.exp(0.5) + np.exp(-0.5)
    return SWING_HEIGHT * swhf / (ends - 2.0) * (ends - np.exp(u - 0.5) - np.exp(0.5 - u))


def forward_height(
    t: Float[np.ndarray, "T"], walked: Float[np.ndarray, "T"], begin: float, end: float
) -> Float[np.ndarray, "T"]:
    """Height of the hips of a forward step: the walk's, both ends met; [KB93] Eq. 4."""
    return walked + (1.0 - t) * (begin - walked[0]) + t * (end - walked[-1])


def backward_height(
    t: Float[np.ndarray, "T"], walked: Float[np.ndarray, "T"], begin: float, end: float
) -> Float[np.ndarray, "T"]:
    """Height of the hips of a backward step: the reversed walk's, both ends met; [KB93] Eq. 5.

    ``walked`` is the forward step sampled at ``t``; it is read at 1 - t. The printed
    ``h_(n-i+1)`` is that only for samples symmetric in t.
    """
    flat = walked[:, None]
    back = hermite(t, flat, parabola_slopes(t, flat), 1.0 - t)[:, 0]
    return forward_height(t, back, begin, end)


def lateral_height(
    t: Float[np.ndarray, "T"],
    distance: Float[np.ndarray, "T"],
    begin: float,
    end: float,
    ankle: float,
) -> Float[np.ndarray, "T"]:
    """Height of the hips of a lateral step: an inverted pendulum, [KB93] section 5.3.

    ``distance`` is that of the stance hip from the stance ankle, seen from above; the pendulum's
    length eases from what reaches ``begin`` to what reaches ``end``; ``ankle`` is the height of
    the stance ankle.
    """
    first, last = ((h - ankle) ** 2 + distance[i] ** 2 for h, i in ((begin, 0), (end, -1)))
    square = first + (last - first) * smoothstep(t)
    return ankle + np.sqrt(np.maximum(square - distance**2, 0.0))


@dataclass(frozen=True, eq=False)
class FootAngles:
    """Pitch of [stance, swing] soles over a step: the walk's, scaled piece by piece.

    [KB93] section 5.1: the curves of Figure 4 are scaled so that they pass through the pitch the
    feet begin with and the three of ``angles``.
    """

    stance: Float[np.ndarray, "T"]
    swing: Float[np.ndarray, "T"]

    @staticmethod
    def of(
        t: Float[np.ndarray, "T"],
        step: SagittalStep,
        begin: tuple[float, float],
        angles: tuple[float, float, float],
        toe_off: float,
    ) -> FootAngles:
        """From ``begin``, the pitch of stance and swing foot at 0, through ``angles``.

        The swing's phases are shifted so that the walk's toe-off comes at ``toe_off``.
        """
        st, sw, tom = angles

        def read(column: int, at: Float[np.ndarray, "T"]) -> Float[np.ndarray, "T"]:
            return np.interp(at, step.phase, step.pitch[:, column])

        walked, flat = read(0, t), step.flat
        first = step.pitch[0, 0]
        if flat > 0.0 and abs(first) > LEAST_PITCH:
            rolled = np.where(t <= flat, walked / first, 0.0)
        else:
            flat = 0.2
            rolled = np.where(t <= flat, 1.0 - smoothstep(t / flat), 0.0)
        last = step.pitch[-1, 0]
        lifted = np.where(t > flat, walked / last, 0.0) if last < -LEAST_PITCH else smoothstep(t)
        stance = begin[0] * rolled + st * lifted
        off = step.toe_off
        bears = t <= toe_off
        at = np.where(bears, t / toe_off * off, off + (t - toe_off) / (1.0 - toe_off) * (1.0 - off))
        raised = read(1, at)
        p0, p1, p2 = step.pitch[0, 1], read(1, np.array([off]))[0], step.pitch[-1, 1]
        rise = (raised - p0) / (p1 - p0) if abs(p1 - p0) > LEAST_PITCH else smoothstep(t / toe_off)
        fall = (raised - p1) / (p2 - p1) if abs(p2 - p1) > LEAST_PITCH else smoothstep(t)
        swing = np.where(bears, begin[1] + (tom - begin[1]) * rise, tom + (sw - tom) * fall)
        return FootAngles(stance, swing)


def eased(
    t: Float[np.ndarray, "T"],
    begin: Float[np.ndarray, "2"],
    end: Float[np.ndarray, "2"],
    speeds: tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]],
) -> Float[np.ndarray, "T 2"]:
    """From ``begin`` to ``end`` with these speeds (per step) there: a cubic.

    [KB93] section 5.3 has a line segment and leaves the speed open; on one line this is it.
    """
    u, v = t[:, None], 1.0 - t[:, None]
    rise = end - begin
    return begin + u * u * (3.0 - 2.0 * u) * rise + u * v * (v * speeds[0] - u * speeds[1])


def over_stance(t: Float[np.ndarray, "T"], toe_off: float) -> Float[np.ndarray, "T"]:
    """How far the weight is over the stance foot: 0 at both ends, 1 as the swing foot leaves."""
    hold = toe_off + 0.25 * (1.0 - toe_off)
    return smoothstep(t / toe_off) * (1.0 - smoothstep((t - hold) / (1.0 - hold)))
