"""The leg as two bones with a hinge between: where hip and ankle are, the knee follows."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.conventions import UP
from gaitsmith.conventions import ahead as heading_vector
from gaitsmith.geometry.rotations import component_major, from_basis, rotate

if TYPE_CHECKING:
    from jaxtyping import Float

    _Scalars = Float[np.ndarray, "*n"]
    _Vector = tuple[_Scalars, _Scalars, _Scalars]
    _Quaternion = tuple[_Scalars, _Scalars, _Scalars, _Scalars]

#: Square of the sine of the angle between hint and leg below which they count as parallel:
#: nearer, the plane they span is rounding noise.
_PARALLEL = 1e-18
_AHEAD = heading_vector(0.0)


class LegPose(NamedTuple):
    """What :func:`two_bone_ik` finds.

    Attributes
    ----------
    thigh, shin
        ``(*n, 4)`` world rotations, unit quaternions xyzw. The knee is at
        ``hip + thigh * (0, -thigh length, 0)``.
    flexion
        ``(*n,)`` knee flexion in [0, pi], radians: 0 is straight. ``shin`` is
        ``thigh`` times a rotation by ``flexion`` about +X.
    """

    thigh: Float[np.ndarray, "*n 4"]
    shin: Float[np.ndarray, "*n 4"]
    flexion: Float[np.ndarray, "*n"]


def two_bone_ik(
    hip: Float[np.ndarray, "*n 3"],
    ankle: Float[np.ndarray, "*n 3"],
    forward: Float[np.ndarray, "*n 3"],
    *,
    thigh: float,
    shin: float,
) -> LegPose:
    """Pose a leg so that its ankle is where it must be and its knee bends forward.

    At rest both bones hang along -Y and the knee's hinge is local +X, the walker's left;
    flexion turns the shin about it, heel towards the buttock. The hinge plane holds hip,
    ankle and the direction ``forward``.

    Parameters
    ----------
    hip, ankle
        ``(*n, 3)`` world positions, meters. Leading axes broadcast.
    forward
        ``(*n, 3)`` where the knee should point, any length; only its part across the line
        from hip to ankle counts.
    thigh, shin
        Lengths of the bones, meters.

    Returns
    -------
    World rotations of thigh and shin and the knee's flexion.

    Raises
    ------
    InvalidInputError
        If a length is not positive.

    Notes
    -----
    The distance from hip to ankle is limited to what the bones reach, from
    ``|thigh - shin|`` to ``thigh + shin``: beyond it the leg points at the ankle, exactly
    straight (flexion 0) or folded (flexion pi), and misses it. Whether that may happen is
    the caller's business: the contact stage keeps every leg within its reach.

    Where the three do not span a plane, one is chosen, so that nothing is ever NaN:

    * hip and ankle coincide: the line between them is taken as straight down;
    * ``forward`` is zero: +Z;
    * ``forward`` runs along the leg: a leg that points forward, as in a kick, bends
      upwards, one that points backward bends downwards: what turning a standing leg about
      its hinge gives. If the leg is vertical as well: +Z.

    The law of cosines gives the flexion's half-angle without any arccos or arctan,
    ``tan²(flexion / 2) = (reach² - d²) / (d² - fold²)`` with ``reach = thigh + shin`` and
    ``fold = thigh - shin``, accurate near the straight leg, where the cosine is flat.

    The sign of a quaternion is whatever comes out first; a sequence over time wants
    :func:`gaitsmith.geometry.rotations.sign_continuous`.
    """
    thigh, shin = positive("thigh", thigh, "meters"), positive("shin", shin, "meters")
    reach, fold = thigh + shin, abs(thigh - shin)
    line = np.asarray(ankle, dtype=np.float64) - np.asarray(hip, dtype=np.float64)
    line, forward = np.broadcast_arrays(line, np.asarray(forward, dtype=np.float64))
    # one array a component: sums over a last axis of three are slow in NumPy
    down, distance = _direction(line, 1e-12 * reach)
    ahead = _across(forward, down)

    # Half-angle of the flexion. Cutting the two differences off at 0 limits the distance;
    # within reach their sum is 4 thigh shin.
    open_ = np.maximum((reach - distance) * (reach + distance), 0.0)
    shut = np.maximum((distance - fold) * (distance + fold), 0.0)
    whole = open_ + shut
    sine, cosine = np.sqrt(open_ / whole), np.sqrt(shut / whole)

    # The thigh leads the line to the ankle by the angle of (x, y) = (thigh + shin cos f,
    # shin sin f), written so that nothing cancels when the leg is folded.
    lead_sine, lead_cosine = _half_angle(
        (thigh - shin) + 2.0 * shin * cosine * cosine, 2.0 * shin * sine * cosine
    )
    thigh_world = _then_about_x(_frame(down, ahead), -lead_sine, lead_cosine)
    shin_world = _then_about_x(thigh_world, sine, cosine)
    thighs, shins = component_major(sine.shape, 4), component_major(sine.shape, 4)
    for i in range(4):
        thighs[..., i], shins[..., i] = thigh_world[i], shin_world[i]
    return LegPose(thighs, shins, 2.0 * np.arctan2(sine, cosine))


def knee_position(
    hip: Float[np.ndarray, "*n 3"], thigh_world: Float[np.ndarray, "*n 4"], *, thigh: float
) -> Float[np.ndarray, "*n 3"]:
    """Where the knee is, meters: ``thigh`` meters from the hip down the thigh."""
    return np.asarray(hip) + rotate(np.asarray(thigh_world), np.array([0.0, -thigh, 0.0]))


def _direction(line: Float[np.ndarray, "*n 3"], tiny: float) -> tuple[_Vector, _Scalars]:
    """Unit vectors along ``line`` (straight down where shorter than ``tiny``), and lengths."""
    x, y, z = line[..., 0], line[..., 1], line[..., 2]
    distance = np.sqrt(x * x + y * y + z * z)
    lost = distance <= tiny
    if lost.any():
        safe = np.where(lost, 1.0, distance)
        x, y, z = np.where(lost, 0.0, x), np.where(lost, -1.0, y), np.where(lost, 0.0, z)
        return (x / safe, y / safe, z / safe), distance
    return (x / distance, y / distance, z / distance), distance


def _across(forward: Float[np.ndarray, "*n 3"], down: _Vector) -> _Vector:
    """Unit vectors across the leg, as near to ``forward`` as can be."""
    fx, fy, fz = forward[..., 0], forward[..., 1], forward[..., 2]
    dx, dy, dz = down
    along = fx * dx + fy * dy + fz * dz
    ax, ay, az = fx - along * dx, fy - along * dy, fz - along * dz
    square = ax * ax + ay * ay + az * az
    lost = square <= _PARALLEL * (fx * fx + fy * fy + fz * fz)
    if lost.any():
        chosen = _chosen_across(forward, np.stack(down, axis=-1))
        ax, ay, az = (
            np.where(lost, c, a)
            for c, a in zip(np.moveaxis(chosen, -1, 0), (ax, ay, az), strict=True)
        )
        square = ax * ax + ay * ay + az * az
    size = np.sqrt(square)
    return ax / size, ay / size, az / size


def _chosen_across(
    forward: Float[np.ndarray, "*n 3"], down: Float[np.ndarray, "*n 3"]
) -> Float[np.ndarray, "*n 3"]:
    """Directions across the leg where ``forward`` gives none: see :func:`two_bone_ik`."""
    given = np.abs(forward).max(axis=-1, keepdims=True) > 0.0
    forward = np.where(given, forward, _AHEAD)
    along = (forward * down).sum(-1, keepdims=True)
    out = np.zeros_like(down)
    for hint in (_AHEAD + 0.0 * down, np.sign(along) * UP, forward):  # the last that works stays
        across = hint - (hint * down).sum(-1, keepdims=True) * down
        square, full = ((v * v).sum(-1, keepdims=True) for v in (across, hint))
        out = np.where(square > _PARALLEL * full, across, out)
    return out


def _half_angle(x: _Scalars, y: _Scalars) -> tuple[_Scalars, _Scalars]:
    """Sine and cosine of half the angle of the vectors (x, y); of (0, 0) as of (0, +0)."""
    radius = np.sqrt(x * x + y * y)
    zero = radius == 0.0
    if zero.any():
        y, radius = np.where(zero, 1.0, y), np.where(zero, 1.0, radius)
    # the larger of the two from the sum that does not cancel, the other from sin = 2 s c
    large = np.sqrt(0.5 * (1.0 + np.abs(x) / radius))
    small = np.abs(y) / (2.0 * radius * large)
    right = x >= 0.0
    return np.copysign(np.where(right, small, large), y), np.where(right, large, small)


def _frame(down: _Vector, ahead: _Vector) -> _Quaternion:
    """Rotations that turn -Y to ``down`` and +Z to ``ahead`` (orthonormal)."""
    dx, dy, dz = down
    ax, ay, az = ahead
    # the shortest arc from -Y to down ...
    one_plus_cosine = 1.0 - dy
    lifted = dy > 0.9  # the arc is no good for a leg that points up
    safe = np.where(lifted, 1.0, one_plus_cosine)
    scale = np.sqrt(0.5 / safe)
    # ... then a twist about Y; (px, pz) is ahead seen from the end of the arc
    share = (ax * dx + az * dz) / safe
    px, pz = ax + ay * dx - share * dx, az + ay * dz - share * dz
    sine, cosine = _half_angle(pz, px)
    x, z, w = -dz * scale, dx * scale, one_plus_cosine * scale
    out = (x * cosine - z * sine, w * sine, z * cosine + x * sine, w * cosine)
    if not lifted.any():
        return out
    q = np.stack(out, axis=-1)
    up, forward = -np.stack(down, axis=-1)[lifted], np.stack(ahead, axis=-1)[lifted]
    q[lifted] = from_basis(np.cross(up, forward), up, forward)
    return q[..., 0], q[..., 1], q[..., 2], q[..., 3]


def _then_about_x(q: _Quaternion, sine: _Scalars, cosine: _Scalars) -> _Quaternion:
    """``q`` times the rotation about +X whose half-angle has this sine and cosine."""
    x, y, z, w = q
    return (
        x * cosine + w * sine,
        y * cosine + z * sine,
        z * cosine - y * sine,
        w * cosine - x * sine,
    )
