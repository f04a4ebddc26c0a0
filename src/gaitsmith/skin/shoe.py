"""Shoes around the sole points: a flat outsole, an upper, and toes that bend."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.skin.shapes import skin

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.shapes import Mesh

# A shoe last seen from above: share of the length from heel to toe tip, then half-widths of
# the lateral and of the medial side as shares of the width at the ball. The medial side is
# the straighter one and the tip lies toward it, so that left and right are told apart.
_LAST = np.array(
    [
        [0.00, 0.00, 0.00],
        [0.012, 0.30, 0.30],
        [0.04, 0.50, 0.50],
        [0.08, 0.62, 0.61],
        [0.15, 0.71, 0.68],
        [0.25, 0.76, 0.67],
        [0.36, 0.80, 0.66],
        [0.48, 0.87, 0.70],
        [0.60, 0.96, 0.78],
        [0.72, 1.00, 0.90],
        [0.80, 0.95, 0.92],
        [0.87, 0.82, 0.88],
        [0.93, 0.60, 0.78],
        [0.97, 0.34, 0.60],
        [0.99, 0.12, 0.40],
        [1.00, 0.00, 0.00],
    ]
)
_BALL = 0.72
# Height of the upper above the sole as a share of the ankle's height.
_UPPER = np.array(
    [
        [0.00, 0.62],
        [0.04, 0.92],
        [0.14, 1.12],
        [0.26, 1.16],
        [0.36, 1.04],
        [0.50, 0.84],
        [0.72, 0.66],
        [0.86, 0.57],
        [0.94, 0.46],
        [1.00, 0.24],
    ]
)
#: Half the width at the ball over the length of a shoe.
HALF_WIDTH = 0.182


@dataclass(frozen=True, eq=False)
class Last:
    """Where one shoe is, in the frame of the Foot joint at rest.

    Attributes
    ----------
    heel
        ``(3,)`` rearmost point of the sole, meters.
    axes
        Rows ``(forward, up, left)``, unit.
    ball, length
        Distance from the heel to the ball and to the toe tip, meters.
    ankle
        Height of the ankle above the sole, meters.
    medial
        +1 if the body's mid-line is to the left of this foot, -1 if to the right.
    """

    heel: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    ball: float
    length: float
    ankle: float
    medial: float

    def share(self, along: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Place on the standard last of meters ``along`` from the heel."""
        return np.interp(along, [0.0, self.ball, self.length], [0.0, _BALL, 1.0])

    def along(self, share: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Meters from the heel of places on the standard last."""
        return np.interp(share, [0.0, _BALL, 1.0], [0.0, self.ball, self.length])

    def sides(self, share: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 2"]:
        """Offsets of the [left, right] edge of the sole from its axis, meters."""
        width = HALF_WIDTH * self.length
        lateral, medial = (np.interp(share, _LAST[:, 0], _LAST[:, k]) * width for k in (1, 2))
        left, right = (medial, lateral) if self.medial > 0 else (lateral, medial)
        return np.stack([left, -right], axis=1)

    def place(self, local: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
        """Points ``(along, up, left)`` of the shoe in the frame of the Foot joint."""
        return local @ self.axes + self.heel


def last_of(
    heel: Float[np.ndarray, "3"],
    ball: Float[np.ndarray, "3"],
    tip: Float[np.ndarray, "3"],
    side: int,
) -> Last:
    """Last through the sole points of ``side`` (0 left), all in the frame of the Foot joint."""
    forward = ball - heel
    reach = float(np.linalg.norm(forward))
    forward = forward / reach
    left = np.cross([0.0, 1.0, 0.0], forward)
    left /= np.linalg.norm(left)
    up = np.cross(forward, left)
    length = max(float((tip - heel) @ forward), 1.05 * reach)
    ankle = max(float(-heel @ up), 0.15 * length)
    return Last(
        heel, np.stack([forward, up, left]), reach, length, ankle, -1.0 if side == 0 else 1.0
    )


def outline(last: Last) -> Float[np.ndarray, "points 2"]:
    """Closed outline of the sole seen from above: ``(forward, left)`` of the heel, meters."""
    share = _LAST[:, 0]
    edges, along = last.sides(share), last.along(share)
    left = np.stack([along, edges[:, 0]], axis=1)
    right = np.stack([along, edges[:, 1]], axis=1)[::-1]
    return np.concatenate([left, right[1:-1]])


def outsole(last: Last) -> Mesh:
    """Flat slab under the shoe; its underside is the sole."""
    share = _LAST[1:-1, 0]
    along, edges = last.along(share), last.sides(share) * 1.05
    thick = 0.24 * last.ankle
    zero, top = np.zeros_like(share), np.full_like(share, thick)
    columns = [  # counter-clockwise seen from the toe: left is +, up is +
        (zero, edges[:, 0]),
        (0.5 * top, 1.03 * edges[:, 0]),
        (top, edges[:, 0]),
        (top, zero),
        (top, edges[:, 1]),
        (0.5 * top, 1.03 * edges[:, 1]),
        (zero, edges[:, 1]),
        (zero, zero),
    ]
    rings = np.stack([np.stack([along, up, left], axis=1) for up, left in columns], axis=1)
    # the slab begins at the heel and ends at the tip exactly
    ends = np.array([[0.0, 0.0, 0.0], [last.length, 0.0, 0.0]])
    placed = last.place(ends)
    return skin(last.place(rings), placed[0], placed[1])


def upper(last: Last, *, around: int) -> Mesh:
    """Upper of the shoe, standing on the outsole."""
    share = _LAST[1:-1, 0]
    along, edges = last.along(share), last.sides(share) * 0.97
    high_up = np.interp(share, _UPPER[:, 0], _UPPER[:, 1]) * last.ankle
    base = np.full_like(share, 0.12 * last.ankle)
    turn = 2.0 * np.pi * np.arange(around) / around
    cosine, sine = np.cos(turn), np.sin(turn)
    middle, half = edges.mean(1)[:, None], 0.5 * (edges[:, :1] - edges[:, 1:])
    rise = np.where(sine > 0.0, np.abs(sine) ** 0.9, 0.0)
    # the upper leans in toward its top, as leather does
    across = np.sign(cosine) * np.abs(cosine) ** 0.75 * (1.0 - 0.18 * rise)
    rings = np.stack(
        [
            np.repeat(along[:, None], around, axis=1),
            base[:, None] + (high_up - base)[:, None] * rise,
            middle + half * across,
        ],
        axis=-1,
    )
    start = [0.002, float(0.5 * (base[0] + high_up[0])), 0.0]
    end = [last.length - 0.002, 0.5 * float(high_up[-1]), 0.0]
    placed = last.place(np.array([start, end]))
    return skin(last.place(rings), placed[0], placed[1])
