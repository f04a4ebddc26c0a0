"""Swinging feet over ground that is not level: lifted over what they would touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.flights import along_sole, sole_points
from gaitsmith.contact.over_edges import over_edges
from gaitsmith.conventions import UP
from gaitsmith.geometry.curves import hermite, parabola_slopes, smoothstep

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact.flights import Flights
    from gaitsmith.ground import Ground

#: The sole keeps this far from the ground in swing, meters, rising over a fifth of the swing.
CLEARANCE, CLEARANCE_RAMP = 0.010, 0.2
#: So much of it at once, so that no curve dips below the ground between nodes.
AT_ONCE, AT_ONCE_RAMPS = 0.0004, (0.025, 0.05)
#: Deepest that the sole's lowest point may be drawn between nodes, meters, before they are lifted,
#: and by how much of what is deeper.
DIPS, LIFTED = 0.0001, 1.5


def cleared(
    flights: Flights, body: Body, ground: Ground
) -> tuple[
    Float[np.ndarray, "n 3"],
    Float[np.ndarray, "n"],
    Float[np.ndarray, "n"],
    Float[np.ndarray, "n"],
]:
    """Ankle, heading, pitch and bend of feet that clear ``ground``."""
    f, clearance = flights, CLEARANCE
    if ground.stepped:
        f, clearance = over_edges(f, body, ground), 0.0
    points = f.ankle[:, None] + sole_points(body.foot, *f.soles())
    if ground.stepped:
        points = along_sole(points)
    height = points[..., 1] - ground.height(points[..., 0], points[..., 2])
    up = lift(height, f.u, clearance)
    points[..., 1] += up[:, None]
    up += _dips(f, points.reshape(len(points), -1), ground)
    ankle = f.ankle + up[:, None] * UP
    return ankle[f.own], f.heading[f.own], f.pitch[f.own], f.bend[f.own]


def lift(
    height: Float[np.ndarray, "n p"], u: Float[np.ndarray, "n"], clearance: float
) -> Float[np.ndarray, "n"]:
    """How far a swinging foot must be lifted, meters, so that its sole clears the ground.

    ``height`` of points of the sole over the ground; ``u`` is the phase of the swing. Smooth in
    both.
    """
    want = clearance * smoothstep(u / CLEARANCE_RAMP) * smoothstep((1.0 - u) / CLEARANCE_RAMP)
    leaving, landing = AT_ONCE_RAMPS
    want = want + AT_ONCE * smoothstep(u / leaving) * smoothstep((1.0 - u) / landing)
    short = want - height.min(-1)
    soft = 0.3 * want + 1e-9  # a soft maximum: no corner where the lift begins
    return 0.5 * (short + np.sqrt(short**2 + soft**2))


def _dips(f: Flights, points: Float[np.ndarray, "n c"], ground: Ground) -> Float[np.ndarray, "n"]:
    """By how much samples are too low for curves through them to stay above the ground, meters.

    A foot that comes down fast would overshoot between the last two before it lands. ``points``
    of the sole, on its way; the ground may jump under them.
    """
    at, slopes = f.at, parabola_slopes(f.at, points)
    lowest = np.full(len(at) - 1, np.inf)
    for share in (0.25, 0.5, 0.75):
        read = hermite(at, points, slopes, at[:-1] + share * np.diff(at))
        x, y, z = np.moveaxis(read.reshape(len(lowest), -1, 3), -1, 0)
        lowest = np.minimum(lowest, (y - ground.height(x, z)).min(-1))
    dip = LIFTED * np.maximum(-DIPS - lowest, 0.0)
    dip = np.where(np.diff(f.swing) == 0, dip, 0.0)
    return np.maximum(np.append(dip, 0.0), np.append(0.0, dip)) * (f.u > 0.0)
