"""Rotations as unit quaternions ``(x, y, z, w)``, vectorised over any leading axes.

Every function broadcasts its leading axes. Results keep their components apart in memory, each
contiguous, which is several times faster to compute with. SciPy's ``Rotation`` is the oracle of the
tests; it is not used here because importing it costs more than a whole walk.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.angles import sine_cosine

if TYPE_CHECKING:
    from jaxtyping import Float

IDENTITY = np.array([0.0, 0.0, 0.0, 1.0])
IDENTITY.flags.writeable = False
_NO_ANGLE = 1e-150


def component_major(shape: tuple[int, ...], components: int) -> Float[np.ndarray, "*n c"]:
    """An empty ``(*shape, components)`` array whose components lie one after the other."""
    return np.empty((components, *shape)).transpose(*range(1, len(shape) + 1), 0)


def multiply(
    a: Float[np.ndarray, "*n 4"], b: Float[np.ndarray, "*n 4"]
) -> Float[np.ndarray, "*n 4"]:
    """Compose rotations: ``b`` first, then ``a``."""
    ax, ay, az, aw = a[..., 0], a[..., 1], a[..., 2], a[..., 3]
    bx, by, bz, bw = b[..., 0], b[..., 1], b[..., 2], b[..., 3]
    out = component_major(np.broadcast_shapes(a.shape[:-1], b.shape[:-1]), 4)
    out[..., 0] = aw * bx + ax * bw + ay * bz - az * by
    out[..., 1] = aw * by - ax * bz + ay * bw + az * bx
    out[..., 2] = aw * bz + ax * by - ay * bx + az * bw
    out[..., 3] = aw * bw - ax * bx - ay * by - az * bz
    return out


def inverse(q: Float[np.ndarray, "*n 4"]) -> Float[np.ndarray, "*n 4"]:
    """Inverse (conjugate) of unit quaternions."""
    out = component_major(q.shape[:-1], 4)
    np.negative(q[..., :3], out=out[..., :3])
    out[..., 3] = q[..., 3]
    return out


def rotate(q: Float[np.ndarray, "*n 4"], v: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Vectors ``v`` turned by ``q``."""
    qx, qy, qz, qw = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    tx = 2.0 * (qy * vz - qz * vy)
    ty = 2.0 * (qz * vx - qx * vz)
    tz = 2.0 * (qx * vy - qy * vx)
    out = component_major(np.broadcast_shapes(q.shape[:-1], v.shape[:-1]), 3)
    out[..., 0] = vx + qw * tx + qy * tz - qz * ty
    out[..., 1] = vy + qw * ty + qz * tx - qx * tz
    out[..., 2] = vz + qw * tz + qx * ty - qy * tx
    return out


def about(axis: str, angle: Float[np.ndarray, "*n"] | float) -> Float[np.ndarray, "*n 4"]:
    """Rotations by ``angle`` radians about a coordinate axis, ``"x"``, ``"y"`` or ``"z"``."""
    half = 0.5 * np.asarray(angle, dtype=np.float64)
    out = component_major(half.shape, 4)
    out[..., :3] = 0.0
    out[..., "xyz".index(axis)], out[..., 3] = sine_cosine(half)
    return out


def turned_left(
    heading: Float[np.ndarray, "*n"], q: Float[np.ndarray, "*n 4"]
) -> Float[np.ndarray, "*n 4"]:
    """``q``, then turned left about +Y by ``heading`` radians."""
    half = 0.5 * heading
    s, c = sine_cosine(half)
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    out = component_major(np.broadcast_shapes(half.shape, x.shape), 4)
    out[..., 0] = c * x + s * z
    out[..., 1] = c * y + s * w
    out[..., 2] = c * z - s * x
    out[..., 3] = c * w - s * y
    return out


def pitched(
    heading: Float[np.ndarray, "*n"], angle: Float[np.ndarray, "*n"]
) -> Float[np.ndarray, "*n 4"]:
    """By ``angle`` radians about +X, then turned left about +Y by ``heading``."""
    (s, c), (sine, cosine) = sine_cosine(0.5 * heading), sine_cosine(0.5 * angle)
    out = component_major(np.broadcast_shapes(s.shape, sine.shape), 4)
    np.multiply(c, sine, out=out[..., 0])
    np.multiply(s, cosine, out=out[..., 1])
    np.multiply(-s, sine, out=out[..., 2])
    np.multiply(c, cosine, out=out[..., 3])
    return out


def left_of(q: Float[np.ndarray, "*n 4"]) -> Float[np.ndarray, "*n 3"]:
    """+X, a person's left, turned by ``q``."""
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    out = component_major(x.shape, 3)
    out[..., 0] = 1.0 - 2.0 * (y * y + z * z)
    out[..., 1] = 2.0 * (x * y + w * z)
    out[..., 2] = 2.0 * (x * z - w * y)
    return out


def exp(vector: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 4"]:
    """Rotation by ``|vector|`` radians about ``vector``; exact at and near zero."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    # at zero a length that is none: its sine is itself, and the square of it still a number
    half = np.maximum(0.5 * np.sqrt(x * x + y * y + z * z), _NO_ANGLE)
    sine, cosine = sine_cosine(half)
    scale = 0.5 * sine / half
    out = component_major(vector.shape[:-1], 4)
    for i, component in enumerate((x, y, z)):
        np.multiply(component, scale, out=out[..., i])
    out[..., 3] = cosine
    return out


def between(a: Float[np.ndarray, "3"], b: Float[np.ndarray, "3"]) -> Float[np.ndarray, "4"]:
    """Least rotation that turns the direction of ``a`` to that of ``b``.

    None at all where there is no such rotation or many: opposite directions, no length.
    """
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    axis = np.cross(a, b)
    sine = float(np.linalg.norm(axis))
    if sine <= 1e-12 * size:
        return np.array(IDENTITY)
    return exp(axis / sine * np.arctan2(sine, float(np.dot(a, b))))


def log(q: Float[np.ndarray, "*n 4"]) -> Float[np.ndarray, "*n 3"]:
    """Rotation vectors (axis times angle, angle in ``[0, pi]``) of unit quaternions."""
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    sine = np.sqrt(x * x + y * y + z * z)
    # of q and -q, which are one rotation, the one whose angle is not above pi
    angle = 2.0 * np.arctan2(sine, np.abs(w))
    # angle / sine is 2 at zero, and 2 + sine**2 / 3 beside it
    small = sine < 1e-6
    scale = angle / np.where(small, 1.0, sine)
    if small.any():
        scale = np.where(small, 2.0 + sine**2 / 3.0, scale)
    scale = np.where(w < 0.0, -scale, scale)
    out = component_major(sine.shape, 3)
    for i, component in enumerate((x, y, z)):
        out[..., i] = scale * component
    return out


def from_basis(
    x: Float[np.ndarray, "*n 3"], y: Float[np.ndarray, "*n 3"], z: Float[np.ndarray, "*n 3"]
) -> Float[np.ndarray, "*n 4"]:
    """Rotation that maps the coordinate axes to orthonormal ``x``, ``y``, ``z``."""
    return from_matrix(np.stack([x, y, z], axis=-1))


def from_matrix(m: Float[np.ndarray, "*n 3 3"]) -> Float[np.ndarray, "*n 4"]:
    """Quaternions of rotation matrices (columns are the turned axes).

    Uses the largest of the four components as divisor (Shepperd 1978), so it is accurate
    for every rotation.
    """
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([xx - yy - zz, yy - xx - zz, zz - xx - yy, xx + yy + zz], axis=-1) + 1.0
    yz, zx, xy = m[..., 2, 1], m[..., 0, 2], m[..., 1, 0]
    zy, xz, yx = m[..., 1, 2], m[..., 2, 0], m[..., 0, 1]
    rows = np.stack(
        [
            np.stack([squares[..., 0], xy + yx, xz + zx, yz - zy], axis=-1),
            np.stack([xy + yx, squares[..., 1], yz + zy, zx - xz], axis=-1),
            np.stack([xz + zx, yz + zy, squares[..., 2], xy - yx], axis=-1),
            np.stack([yz - zy, zx - xz, xy - yx, squares[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = squares.argmax(axis=-1)[..., None, None]
    q = np.take_along_axis(rows, np.broadcast_to(best, (*best.shape[:-1], 4)), axis=-2)[..., 0, :]
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def to_matrix(q: Float[np.ndarray, "*n 4"]) -> Float[np.ndarray, "*n 3 3"]:
    """Rotation matrices (columns are the turned axes) of unit quaternions."""
    x, y, z, w = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    m = np.empty((*q.shape[:-1], 3, 3))
    m[..., 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    m[..., 0, 1] = 2.0 * (x * y - w * z)
    m[..., 0, 2] = 2.0 * (x * z + w * y)
    m[..., 1, 0] = 2.0 * (x * y + w * z)
    m[..., 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    m[..., 1, 2] = 2.0 * (y * z - w * x)
    m[..., 2, 0] = 2.0 * (x * z - w * y)
    m[..., 2, 1] = 2.0 * (y * z + w * x)
    m[..., 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    return m


def _check_order(order: str) -> None:
    order = order.lower()
    if not (len(order) == 3 and set(order) <= set("xyz")) or any(
        a == b for a, b in pairwise(order)
    ):
        raise InvalidInputError(
            f"order must be three axes, neighbours different, like 'ZXY', got {order!r}"
        )


def from_euler(order: str, angles: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 4"]:
    """Rotations from intrinsic Euler angles (radians) in the order written.

    ``from_euler("zxy", a)`` is the matrix product ``Rz(a0) Rx(a1) Ry(a2)``, as BVH
    channels mean it. All 12 orders.
    """
    _check_order(order)
    first, second, third = (about(a, angles[..., i]) for i, a in enumerate(order.lower()))
    return multiply(multiply(first, second), third)


def to_euler(order: str, q: Float[np.ndarray, "*n 4"]) -> Float[np.ndarray, "*n 3"]:
    """Intrinsic Euler angles (radians) of rotations; inverse of :func:`from_euler`.

    The middle angle is in ``[-pi/2, pi/2]`` (three different axes) or ``[0, pi]``. At
    gimbal lock the third angle is zero. Follows the direct quaternion method of Bernardes
    & Viollet 2022 (PLoS ONE 17(11): e0276302), which serves all orders alike.
    """
    _check_order(order)
    i, j, k = ("xyz".index(a) for a in order.lower())
    proper = i == k
    if proper:
        k = 3 - i - j
    sign = float((i - j) * (j - k) * (k - i) // 2)
    x = q[..., 3], q[..., i], q[..., j], sign * q[..., k]
    # i, j, k all different: turned by another 90 degrees about j it is a triple i, j, i
    a, b, c, d = x if proper else (x[0] - x[2], x[1] - x[3], x[2] + x[0], x[3] + x[1])
    middle = 2.0 * np.arctan2(np.hypot(c, d), np.hypot(a, b))
    plus, minus = np.arctan2(b, a), np.arctan2(d, c)  # half the sum and half the difference
    first, third = plus + minus, plus - minus
    lock_low, lock_high = np.abs(middle) < 1e-7, np.abs(middle - np.pi) < 1e-7
    first = np.where(lock_low, 2.0 * plus, np.where(lock_high, 2.0 * minus, first))
    third = np.where(lock_low | lock_high, 0.0, third)
    if not proper:
        third, middle = -sign * third, middle - 0.5 * np.pi
    return np.stack([_wrapped(first), middle, _wrapped(third)], axis=-1)


def _wrapped(angle: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """The same angle in [-pi, pi)."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi


def continuous_euler(
    order: str, angles: Float[np.ndarray, "frames *n 3"]
) -> Float[np.ndarray, "frames *n 3"]:
    """Euler angles of the same rotations without jumps from frame to frame.

    Each frame takes, of the two triples that give its rotation, the one nearer to the
    frame before, and full turns are added where an angle wraps.
    """
    _check_order(order)
    order = order.lower()
    first, second, third = angles[..., 0], angles[..., 1], angles[..., 2]
    flipped = np.pi - second if order[0] != order[2] else -second
    other = np.stack([first + np.pi, flipped, third + np.pi], axis=-1)
    pair = np.stack([angles, other])  # (2, frames, ..., 3)

    def gap(a: Float[np.ndarray, "..."], b: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        return np.abs(_wrapped(a - b)).sum(-1)

    # swap[f]: does going over to the other triple between f-1 and f bring them nearer?
    swap = gap(pair[1, 1:], pair[0, :-1]) < gap(pair[0, 1:], pair[0, :-1]) - 1e-12
    use = np.concatenate([np.zeros((1, *swap.shape[1:]), bool), np.cumsum(swap, axis=0) % 2 == 1])
    return np.unwrap(np.where(use[..., None], pair[1], pair[0]), axis=0)


def slerp(
    a: Float[np.ndarray, "*n 4"], b: Float[np.ndarray, "*n 4"], t: Float[np.ndarray, "*n"] | float
) -> Float[np.ndarray, "*n 4"]:
    """Rotation a fraction ``t`` of the shorter way from ``a`` to ``b``."""
    step = log(multiply(inverse(a), b))
    return multiply(a, exp(step * np.asarray(t, dtype=np.float64)[..., None]))


def swing_twist(
    q: Float[np.ndarray, "*n 4"], axis: Float[np.ndarray, "3"]
) -> tuple[Float[np.ndarray, "*n 4"], Float[np.ndarray, "*n"]]:
    """Split ``q = swing * twist``: twist is the angle about the unit ``axis`` (radians)."""
    along = q[..., :3] @ axis
    angle = 2.0 * np.arctan2(along, q[..., 3])
    angle = (angle + np.pi) % (2.0 * np.pi) - np.pi
    twist = exp(angle[..., None] * axis)
    return multiply(q, inverse(twist)), angle


def sign_continuous(q: Float[np.ndarray, "frames *n 4"]) -> Float[np.ndarray, "frames *n 4"]:
    """Same rotations with signs such that consecutive quaternions lie in one half-sphere."""
    if len(q) < 2:
        return q
    flip = np.einsum("...c,...c->...", q[1:], q[:-1]) < 0.0
    if not flip.any():
        return q
    sign = np.where(np.cumsum(flip, axis=0) % 2 == 1, -1.0, 1.0)[..., None]
    return np.concatenate([q[:1], q[1:] * sign])
