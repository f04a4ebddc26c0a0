"""One joint angle that gives one limb segment its elevation, [SM01] section 4.2 in closed form."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: An axis whose turning changes the sagittal projection by less, over the segment's length.
_BLIND = 1e-10


class SingleDof(NamedTuple):
    """What :func:`solve_single_dof` finds.

    Attributes
    ----------
    angle
        ``(*n,)`` joint angle, radians, within half a turn of what it should be near to.
    roots
        ``(*n,)`` how many angles give the elevation: 0 where none does and ``angle`` comes
        nearest to it, 2 where the nearer one was taken.
    """

    angle: Float[np.ndarray, "*n"]
    roots: Int[np.ndarray, "*n"]


def solve_single_dof(
    segment: Float[np.ndarray, "*n 3"],
    axis: Float[np.ndarray, "*n 3"],
    elevation: Float[np.ndarray, "*n"] | float,
    *,
    heading: Float[np.ndarray, "*n"] | float = 0.0,
    near: Float[np.ndarray, "*n"] | float = 0.0,
) -> SingleDof:
    r"""Joint angle that gives a limb segment its sagittal elevation angle.

    Turning the segment about ``axis`` by :math:`\theta` moves its projection on the sagittal
    plane; this solves for the :math:`\theta` at which the projection makes the angle
    :math:`\phi` with straight down, forward positive.

    Parameters
    ----------
    segment
        ``(*n, 3)`` distal minus proximal end at :math:`\theta = 0`, world, meters.
    axis
        ``(*n, 3)`` unit joint axis, world.
    elevation
        ``(*n,)`` wanted elevation :math:`\phi`, radians.
    heading
        ``(*n,)`` heading :math:`\psi` of the sagittal plane, radians.
    near
        ``(*n,)`` of two angles that fit, the one closer to this is taken, radians.

    Notes
    -----
    [SM01] Eqs. 4-7, all times cos phi, which removes the pole at 90 degrees, where a foot stands.
    The joint's center cancels. Two claims of the paper do not hold (docs/papers/errata.md): the
    other root does not give -phi but phi + 180 degrees, since Eq. 3 fixes tan phi alone; and
    an axis off the plane's normal can leave two acceptable roots, or none.
    """
    segment, axis = np.broadcast_arrays(segment, axis)
    sx, sy, sz = segment[..., 0], segment[..., 1], segment[..., 2]
    ax, ay, az = axis[..., 0], axis[..., 1], axis[..., 2]
    _, elevation, heading, near = np.broadcast_arrays(sx, elevation, heading, near)
    front_x, front_z = np.sin(heading), np.cos(heading)
    c, s = np.cos(elevation), np.sin(elevation)
    # forward and up of the paper's d, e and f = c' - c'': across, its quarter turn, and along
    share = sx * ax + sy * ay + sz * az
    ahead = sx * front_x + sz * front_z
    along = share * (ax * front_x + az * front_z)
    quarter = (ay * sz - az * sy) * front_x + (ax * sy - ay * sx) * front_z
    forward = [ahead - along, quarter, along]
    up = [sy - share * ay, az * sx - ax * sz, share * ay]
    a, b, k = (c * x + s * y for x, y in zip(forward, up, strict=True))
    radius = np.hypot(a, b)
    size = np.sqrt(sx * sx + sy * sy + sz * sz)
    blind = radius <= _BLIND * size
    ratio = -k / np.where(blind, 1.0, radius)
    middle, spread = np.arctan2(b, a), np.arccos(np.clip(ratio, -1.0, 1.0))
    both = _wrapped(np.stack([middle - spread, middle + spread]), near)
    # along phi itself, not phi + 180 degrees
    reach = [s * x - c * y for x, y in zip(forward, up, strict=True)]
    right_way = np.cos(both) * reach[0] + np.sin(both) * reach[1] + reach[2] > _BLIND * size
    fits = right_way & (np.abs(ratio) <= 1.0) & ~blind
    # a touch of the ellipse is one root, not two
    roots = np.where(fits.all(axis=0) & (spread == 0.0), 1, fits.sum(axis=0))
    off = np.where(fits, np.abs(both - near), np.inf)
    chosen = np.where(off[0] <= off[1], both[0], both[1])
    if (roots == 0).any():
        chosen = np.where(roots > 0, chosen, _nearest(forward, up, c, s, near))
        chosen = np.where(blind, near, chosen)
    return SingleDof(chosen, roots)


def _nearest(
    forward: list[Float[np.ndarray, "*n"]],
    up: list[Float[np.ndarray, "*n"]],
    c: Float[np.ndarray, "*n"],
    s: Float[np.ndarray, "*n"],
    near: Float[np.ndarray, "*n"],
) -> Float[np.ndarray, "*n"]:
    """Angle of the elevation nearest to the wanted one, where none reaches it.

    The projection is an ellipse that does not surround the joint; seen from there its ends
    are where a line touches it, which again is an equation like Eq. 4.
    """
    (dx, ex, fx), (dy, ey, fy) = forward, up
    a, b, k = ex * fy - fx * ey, fx * dy - dx * fy, ex * dy - dx * ey
    radius = np.hypot(a, b)
    ratio = np.clip(-k / np.where(radius > 0.0, radius, 1.0), -1.0, 1.0)
    middle, spread = np.arctan2(b, a), np.arccos(ratio)
    both = _wrapped(np.stack([middle - spread, middle + spread]), near)
    cosine, sine = np.cos(both), np.sin(both)
    x, y = fx + dx * cosine + ex * sine, fy + dy * cosine + ey * sine
    size = np.maximum(np.hypot(x, y), 1e-300)
    agree = (s * x - c * y) / size  # cosine between the elevation reached and the wanted one
    return np.where(agree[0] >= agree[1], both[0], both[1])


def _wrapped(
    angle: Float[np.ndarray, "*n"], near: Float[np.ndarray, "*n"]
) -> Float[np.ndarray, "*n"]:
    """The same angle within half a turn of ``near``."""
    return near + (angle - near + np.pi) % (2.0 * np.pi) - np.pi
