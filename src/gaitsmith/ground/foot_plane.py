"""How a foot stands on ground: heel and ball on it, the sole across as the ground is there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import UP, ahead, leftward
from gaitsmith.ground.edges import LEAST_JUMP

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.ground.model import Ground

#: Meters that a point of the sole may be off the ground and still bear.
BEARS = 1e-6
#: Half of the width over which the ground under the ball counts, meters.
_HALF_WIDTH = 0.03
#: Rounds for the slope; on a plane the first is exact, on walkable curved ground a few do.
_ROUNDS = 40
_PLAN = [0, 2]
#: How far beyond the bearing end its own slope is looked at too, meters.
_BEYOND = (0.0, 0.015, 0.03)
#: Pieces in which the ground from heel to ball is looked at for a jump.
_PIECES = 24


@dataclass(frozen=True, eq=False)
class FootPlane:
    """Planes that feet stand on, any leading axes.

    Attributes
    ----------
    position
        ``(*n, 3)`` N: the point of the line from heel to ball under the ankle, along the
        sole's normal.
    forward
        ``(*n, 3)`` unit vector from heel to ball; seen from above it has the foot's heading.
    normal
        ``(*n, 3)`` unit normal of the sole.
    heel, ball
        ``(*n, 3)`` the two points of the sole.
    bears
        ``(*n, 2)`` whether [heel, ball] is on the ground. Where the ground jumps between them,
        the foot lies on the upper side as that side is, and the other end hangs over.
    """

    position: Float[np.ndarray, "*n 3"]
    forward: Float[np.ndarray, "*n 3"]
    normal: Float[np.ndarray, "*n 3"]
    heel: Float[np.ndarray, "*n 3"]
    ball: Float[np.ndarray, "*n 3"]
    bears: Bool[np.ndarray, "*n 2"]

    @property
    def pitch(self) -> Float[np.ndarray, "*n"]:
        """Radians that the sole rises from heel to ball."""
        return np.arcsin(np.clip(self.forward[..., 1], -1.0, 1.0))

    @property
    def roll(self) -> Float[np.ndarray, "*n"]:
        """Radians that the sole rises to the foot's left."""
        left = np.cross(self.normal, self.forward)
        return np.arcsin(np.clip(left[..., 1], -1.0, 1.0))


def foot_plane(
    ground: Ground,
    place: Float[np.ndarray, "*n 2"],
    heading: Float[np.ndarray, "*n"] | float,
    *,
    heel: float,
    ball: float,
) -> FootPlane:
    """How feet stand with N at ``place``, seen from above.

    [SM01] section 4.1 has the foot flat when "a point in the forefoot and a point in the
    hindfoot" touch. So the fore-aft slope is that from heel to ball, both on the ground at
    their own distances from N along the sole; the slope across is that of the ground at the
    ball, the median of three places over its width, so that a pebble does not count.

    Parameters
    ----------
    ground
        What is stood on.
    place
        ``(*n, 2)`` x,z of N, meters.
    heading
        ``(*n,)`` heading of the foot, radians.
    heel, ball
        How far the heel lies behind and the ball ahead of N, meters along the sole.
    """
    place = np.asarray(place, dtype=np.float64)
    heading = np.broadcast_to(np.asarray(heading, dtype=np.float64), place.shape[:-1])
    front, left = ahead(heading), leftward(heading)

    line = _Line(ground, place, front)
    height = line.height
    slope = np.zeros(place.shape[:-1])
    for _ in range(_ROUNDS):
        level = 1.0 / np.sqrt(1.0 + slope * slope)
        last, slope = (
            slope,
            (height(ball * level) - height(-heel * level)) / ((heel + ball) * level),
        )
        if not slope.size or np.abs(slope - last).max() < 1e-14:
            break
    level = 1.0 / np.sqrt(1.0 + slope * slope)
    on_heel, on_ball = height(-heel * level), height(ball * level)
    y = on_heel + heel * level * slope
    if ground.stepped:
        slope, y = _over_edges(line, (heel, ball), slope, y)
        level = 1.0 / np.sqrt(1.0 + slope * slope)
        on_heel, on_ball = height(-heel * level), height(ball * level)
    forward = level[..., None] * (front + slope[..., None] * UP)
    across = _slope_across(ground, line.at(ball * level), left)
    normal = np.cross(forward, left + across[..., None] * UP)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    position = np.stack([place[..., 0], y, place[..., 1]], axis=-1)
    off = np.stack(
        [y - heel * level * slope - on_heel, y + ball * level * slope - on_ball], axis=-1
    )
    return FootPlane(
        position=position,
        forward=forward,
        normal=normal,
        heel=position - heel * forward,
        ball=position + ball * forward,
        bears=np.abs(off) <= BEARS,
    )


@dataclass(frozen=True, eq=False)
class _Line:
    """The ground along the foot's axis, by meters ahead of N as seen from above."""

    ground: Ground
    place: Float[np.ndarray, "*n 2"]
    front: Float[np.ndarray, "*n 3"]

    def at(self, along: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n 2"]:
        return self.place + np.asarray(along)[..., None] * self.front[..., _PLAN]

    def height(self, along: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n"]:
        at = self.at(along)
        return self.ground.height(at[..., 0], at[..., 1])

    def slope(self, along: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n"]:
        at = self.at(along)
        normal = self.ground.normal(at[..., 0], at[..., 1])
        return -(normal * self.front).sum(-1) / normal[..., 1]


def _slope_across(
    ground: Ground, ball: Float[np.ndarray, "*n 2"], left: Float[np.ndarray, "*n 3"]
) -> Float[np.ndarray, "*n"]:
    """Rise of the ground to the left at the ball: the median over its width."""
    across = []
    for offset in (-_HALF_WIDTH, 0.0, _HALF_WIDTH):
        at = ball + offset * left[..., _PLAN]
        normal = ground.normal(at[..., 0], at[..., 1])
        across.append(-(normal * left).sum(-1) / normal[..., 1])
    return np.median(np.stack(across), axis=0)


def _over_edges(
    line: _Line,
    foot: tuple[float, float],
    slope: Float[np.ndarray, "*n"],
    y: Float[np.ndarray, "*n"],
) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
    """Slope and height of N where the ground jumps under the foot: those of the upper side."""
    heel, ball = foot
    piece = (heel + ball) / _PIECES
    heights = np.stack([line.height(-heel + piece * k) for k in range(_PIECES + 1)])
    window = max(1, round(0.02 / piece))
    jump = np.abs(heights[window:] - heights[:-window]).max(axis=0)
    jumped = jump >= max(LEAST_JUMP, 1.2 * window * piece)
    rise = heights[-1] - heights[0]
    jumped &= np.abs(rise) >= LEAST_JUMP
    if not jumped.any():
        return slope, y
    upper = np.where(rise > 0.0, ball, -heel)
    out = np.sign(upper)
    own, level = np.zeros_like(slope), np.ones_like(slope)
    for _ in range(4):
        near = [line.slope(level * upper + out * off) for off in _BEYOND]
        own = np.median(np.stack(near), axis=0)
        level = 1.0 / np.sqrt(1.0 + own * own)
    lifted = line.height(level * upper) - level * upper * own
    return np.where(jumped, own, slope), np.where(jumped, lifted, y)
