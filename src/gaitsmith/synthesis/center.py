"""Path of the hips seen from above, [KB92a] section 4: two readings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.splines import PlaneCurves

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.synthesis.bent import Bent, Flat2D

#: Over what part of a step the hips leave, or reach, the middle of feet that stand apart.
STANDING_SHARE = 0.7


@dataclass(frozen=True, eq=False)
class CenterPath:
    """Where the hips are above the ground, sway left out, and where the person looks.

    ``bend`` is how much the way turns per meter, left positive.
    ``resting``: steps (``(S,)``) whose hips do not begin where a step before left them.
    """

    place: Float[np.ndarray, "M 2"]
    heading: Float[np.ndarray, "M"]
    left: Float[np.ndarray, "M 2"]
    lean: Float[np.ndarray, "M"]
    gaze: Float[np.ndarray, "M"]
    bend: Float[np.ndarray, "M"]
    resting: np.ndarray


def track(
    bent: Bent, flat: Flat2D, offset: float, *, standing: Float[np.ndarray, "S 2 2"]
) -> CenterPath:
    """The hips run on the curve beside the footsteps, at the 2D step's distance along it.

    ``offset`` times the lean's tangent they are inside of it. Signed distance from beside the
    stance foot: negative is still on the curve before. All lengths are those of the 2D step,
    so Eq. 3 of the paper holds by itself, nothing is searched, and nothing drifts.
    """
    x = flat.center[:, 0]
    later = x >= 0.0
    row = np.where(later, flat.step + len(bent.sign), flat.step)
    whole = np.where(later, flat.each(bent.length[:, 1]), flat.each(bent.length[:, 0]))
    along = np.where(later, x, x + whole)
    curve, u = bent.curves.located(row, along)
    degenerate = whole < 1e-9
    u = np.where(degenerate, np.where(later, 0.0, 1.0), u)
    tangent = curve.derivative(u)
    stands = flat.each(bent.direction[:, 1])
    base = np.where(later, stands, flat.each(bent.direction[:, 0]))
    here = np.where(degenerate, 0.0, np.arctan2(tangent[:, 0], tangent[:, 1]) - base)
    here -= 2.0 * np.pi * np.rint(here / (2.0 * np.pi))
    here[np.abs(here) < 1e-13] = 0.0
    heading = np.where(degenerate, stands, base + here)
    way, left = _way_and_left(heading)
    over = np.where(along > whole, along - whole, np.minimum(along, 0.0))
    place = curve.at(u) + over[:, None] * way

    chords = np.sqrt((bent.curves.coefficients[1] ** 2).sum(-1))
    lean, lean_rate = _led(bent.lean, chords, row, u)
    ends = [np.concatenate([bent.curvature[:, i], bent.curvature[:, i + 1]])[row] for i in (0, 1)]
    bend = ends[0] + (ends[1] - ends[0]) * smoothstep(u)
    place = place + (offset * lean)[:, None] * left
    # hips that draw inside or come back face where they go themselves
    heading = heading + np.arctan(offset * lean_rate)
    # where the face points is a curve of its own, whatever the hips below it do
    looks = np.array(bent.gaze)
    looks[..., 0] += np.arctan(offset * bent.lean[..., 1]) - bent.direction[:, 1:2]
    looks[..., 1] += offset * bent.lean[..., 2]
    gaze, _ = _led(looks, chords, row, u)
    gaze -= heading - stands
    resting = np.any(standing[:, 0] != 0.0, axis=-1) | (bent.length[:, 0] < 1e-9)
    if standing.any():
        begins = 1.0 - smoothstep(flat.phase / STANDING_SHARE)
        ends = smoothstep((flat.phase - 1.0 + STANDING_SHARE) / STANDING_SHARE)
        place = place + begins[:, None] * flat.each(standing[:, 0])
        place = place + ends[:, None] * flat.each(standing[:, 1])
    return CenterPath(place, heading, left, lean, gaze, bend, resting)


def _way_and_left(
    heading: Float[np.ndarray, "n"],
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2"]]:
    """x,z of ahead and of the left."""
    sine, cosine = sine_cosine(heading)
    return np.array([sine, cosine]).T, np.array([cosine, -sine]).T


def _led(
    values: Float[np.ndarray, "S 3 3"],
    chords: Float[np.ndarray, "2S"],
    row: Int[np.ndarray, "M"],
    u: Float[np.ndarray, "M"],
) -> tuple[Float[np.ndarray, "M"], Float[np.ndarray, "M"]]:
    """What leads along the curves before and after all steps, and its change per meter.

    ``values`` and their first and second changes per meter are given at the footsteps; between
    them goes the polynomial that the curves are, so that a lean and feet that are set outside by
    as much cancel.
    """
    if not values.any():
        return np.zeros(len(u)), np.zeros(len(u))
    first = np.concatenate([values[:, 0], values[:, 1]])
    last = np.concatenate([values[:, 1], values[:, 2]])
    powers = np.stack([np.ones_like(chords), chords, chords**2], axis=-1)
    a, b = first * powers, last * powers
    made = PlaneCurves.quintic(a[:, :1], b[:, :1], a[:, 1:2], b[:, 1:2], (a[:, 2:], b[:, 2:]))
    c = np.take(made.coefficients[..., 0], row, axis=1)
    size = np.where(chords > 1e-6, 1.0 / np.maximum(chords, 1e-9), 0.0)[row]
    value, slope = c[-1], 5.0 * c[-1]
    for k in range(4, -1, -1):
        value = c[k] + u * value
    for k in range(4, 0, -1):
        slope = k * c[k] + u * slope
    return value, slope * size


def anchored(
    bent: Bent, flat: Flat2D, offset: float, *, standing: Float[np.ndarray, "S 2 2"]
) -> CenterPath:
    """The paper's picture: straight ahead of the stance foot while both feet bear, then a spline.

    The spline ends where the next step's straight part begins, at the 2D step's distance
    behind the new foot, so that nothing drifts (erratum D10).
    """
    tracked = track(bent, flat, offset, standing=standing)
    tracked_place = tracked.place - (offset * tracked.lean)[:, None] * tracked.left
    i, first, last = flat.step, flat.first, flat.last
    x = flat.center[:, 0]
    way = np.stack([np.sin(bent.direction), np.cos(bent.direction)], axis=-1)
    straight = bent.middle[i, 1] + x[:, None] * way[i, 1]
    off = flat.off
    here = bent.middle[:, 1] + x[off][:, None] * way[:, 1]
    behind = x[last] - bent.length[:, 1]
    there = bent.middle[:, 2] + behind[:, None] * way[:, 2]
    size = np.linalg.norm(there - here, axis=-1)[:, None]
    spline = PlaneCurves.hermite(here, there, size * way[:, 1], size * way[:, 2])
    whole = spline.length()
    share = (x - x[off][i]) / np.maximum((x[last] - x[off])[i], 1e-9)
    curve, u = spline.located(i, np.clip(share, 0.0, 1.0) * whole[i])
    tangent = curve.derivative(u)
    turn = np.arctan2(tangent[:, 0], tangent[:, 1]) - bent.direction[i, 1]
    turn -= 2.0 * np.pi * np.rint(turn / (2.0 * np.pi))
    flying = np.arange(len(i)) > off[i]
    heading = bent.direction[i, 1] + np.where(flying, turn, 0.0)
    place = np.where(flying[:, None], curve.at(u), straight)
    _, left = _way_and_left(heading)
    place = place + (offset * tracked.lean)[:, None] * left
    held = (bent.length[:, 0] < 1e-9) | (bent.length[:, 1] < 1e-9)  # starts and stops: as above
    held = held | np.any(standing != 0.0, axis=(1, 2))
    keep = held[i]
    # they join what the paper's steps begin and end with
    begun = (bent.length[:, 0] > 1e-9)[:, None]
    gone = (bent.length[:, 1] > 1e-9)[:, None]
    start = begun * (straight[first] - tracked_place[first])
    end = gone * (there - tracked_place[last])
    turn0 = begun[:, 0] * (bent.direction[:, 1] - tracked.heading[first])
    turn1 = gone[:, 0] * (bent.direction[:, 2] - tracked.heading[last])
    ease = smoothstep(flat.phase)
    held_place = tracked_place + (1.0 - ease)[:, None] * start[i] + ease[:, None] * end[i]
    held_heading = tracked.heading + (1.0 - ease) * turn0[i] + ease * turn1[i]
    _, held_left = _way_and_left(held_heading)
    held_place = held_place + (offset * tracked.lean)[:, None] * held_left
    return CenterPath(
        np.where(keep[:, None], held_place, place),
        np.where(keep, held_heading, heading),
        np.where(keep[:, None], held_left, left),
        tracked.lean,
        tracked.gaze,
        tracked.bend,
        tracked.resting,
    )
