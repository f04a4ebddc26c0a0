"""Legs stay within their reach: hips come down, rear heels rise, swinging ankles draw near.

The papers place hips and ankles in space and let the knee follow, which asks more of a leg
than its length for long steps and for bodies of other proportions ([KB92b] errata D3, D4).
These corrections act on the pose, never on the walk data, so generalization stays exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import LegReachError
from gaitsmith.geometry.curves import hann_average, running_maximum, smoothstep

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.body.body import Body, Foot
    from gaitsmith.contact.foothold import Footholds

#: Hip to ankle over leg length that a bearing leg may reach (5.6 deg of knee flexion).
REACH = 0.9988
#: The same for the rear foot, which may raise its heel (4.3 deg).
REAR_REACH = 0.9993
#: The same for a swinging foot (3.6 deg), and how softly it is kept, over leg length.
SWING_REACH, SOFT = 0.9995, 0.0022
#: How softly at both ends of the swing, and over what part of it that changes.
HARD, EASED = 0.0003, (0.1, 0.05)
#: What a bearing leg may reach between the nodes that the others hold on (3.5 deg).
SAMPLED_REACH = 0.99953
#: Beyond this no pose is made.
LIMIT = 0.9997
#: Grid on which the lowering is found, and over what part of a step it is spread.
PER_STEP, SPREAD = 60, 0.12
#: The same on ground that is not level, where the hips come down farther.
UNEVEN_SPREAD = 0.28
#: The same where a walk ends in standing, the first that does not jolt, and over what part of the
#: last step it gets so.
ENDING_SPREADS, ENDING = (0.05, 0.08, 0.12, 0.28), 0.6
#: How much nearer the rear ankle may come by raising its heel, at toe-off, over leg length.
REAR_SLACK = 0.14
#: Largest extra rise of the rear heel, radians, and the least, with which a flat foot rolls.
LARGEST_RAISE, LEAST_RAISE = 0.8, 1e-6
#: Steepest that a rear foot is raised to, radians: on the tip of its toes; then hips come down.
STEEPEST = 1.3


def lengths(vectors: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n"]:
    """Lengths of vectors, much quicker than NumPy's norm where components are contiguous."""
    x, y, z = (vectors[..., i] for i in range(3))
    return np.sqrt(x * x + y * y + z * z)


def lowering(
    at: Float[np.ndarray, "M"],
    hip: Float[np.ndarray, "M 2 3"],
    ankle: Float[np.ndarray, "M 2 3"],
    slack: Float[np.ndarray, "M 2"],
    *,
    leg_length: float,
    spread: float = SPREAD,
    when: Float[np.ndarray, "M"] | None = None,
) -> Float[np.ndarray, "M"]:
    """How far the hips must come down at each node, meters, smooth over twice ``spread`` steps.

    Parameters
    ----------
    at
        Walk phase of the nodes.
    hip, ankle
        World positions of [left, right].
    slack
        Meters by which each ankle may still follow; inf where the foot does not bear.
    leg_length
        Thigh + shin, meters.
    when
        Time of the nodes in usual steps; None: ``at``.

    Raises
    ------
    LegReachError
        Where a bearing foot is farther to the side of the hips than the leg is long.
    """
    limit = REACH * leg_length
    line = hip - ankle
    across = line[..., 0] ** 2 + line[..., 2] ** 2
    bears = np.isfinite(slack)
    lost = bears & (across >= limit**2)
    if lost.any():
        node, side = np.argwhere(lost)[0]
        raise LegReachError(
            step=int(at[node]),
            side=SIDES[side],
            needed=float(np.sqrt(across[node, side])),
            available=limit,
        )
    top = np.sqrt(np.maximum(limit**2 - across, 0.0)) + ankle[..., 1] - hip[..., 1]
    need = np.maximum(0.0, -np.where(bears, top + np.where(bears, slack, 0.0), np.inf).min(-1))
    if not need.any():
        return np.zeros(len(at))
    when = at if when is None else when
    first, last = when[0] * PER_STEP, when[-1] * PER_STEP
    cells = np.zeros(int(np.ceil(last - first)) + 2)
    where = when * PER_STEP - first
    for cell in (np.floor(where).astype(int), np.ceil(where).astype(int)):
        np.maximum.at(cells, cell, need)
    half = int(np.ceil(spread * PER_STEP))
    smooth = hann_average(running_maximum(cells, half), half)
    grid = np.arange(len(cells), dtype=np.float64)
    return _cubic(grid, smooth, where)


def _cubic(
    grid: Float[np.ndarray, "n"], values: Float[np.ndarray, "n"], where: Float[np.ndarray, "m"]
) -> Float[np.ndarray, "m"]:
    """Catmull-Rom on a unit grid."""
    i = np.clip(where.astype(int), 0, len(grid) - 2)
    slope = np.gradient(values)
    u = where - i
    v = 1.0 - u
    rise = values[i + 1] - values[i]
    return values[i] + u * u * (3.0 - 2.0 * u) * rise + u * v * (v * slope[i] - u * slope[i + 1])


def check_reach(
    at: Float[np.ndarray, "M"],
    hip: Float[np.ndarray, "M 2 3"],
    ankle: Float[np.ndarray, "M 2 3"],
    down: Bool[np.ndarray, "M 2"],
    *,
    leg_length: float,
) -> None:
    """Raise LegReachError if a bearing leg is longer than it can be."""
    distance = np.where(down, lengths(hip - ankle), 0.0)
    if distance.max() <= LIMIT * leg_length:
        return
    node, side = np.unravel_index(int(distance.argmax()), distance.shape)
    raise LegReachError(
        step=int(at[node]),
        side=SIDES[int(side)],
        needed=float(distance[node, side]),
        available=LIMIT * leg_length,
    )


def raised_heel(
    foot: Foot,
    stand: Footholds,
    hip: Float[np.ndarray, "n 3"],
    pitch: Float[np.ndarray, "n"],
    meta: Float[np.ndarray, "n"],
    *,
    leg_length: float,
) -> Float[np.ndarray, "n"]:
    """How much farther the rear foot must raise its heel to stay in reach, radians >= 0.

    [KB92a] section 5.2 proposes the raise. The first angle that fits is taken: searched on
    a grid, then bisected. 0 where the leg reaches, the largest where nothing fits; no foot is
    raised beyond :data:`STEEPEST`.
    """
    limit = REAR_REACH * leg_length
    extra = np.zeros(len(pitch))

    def beyond_reach(
        more: Float[np.ndarray, "k"],
        on: Footholds,
        hips: Float[np.ndarray, "k 3"],
        own: Float[np.ndarray, "k"],
        toes: Float[np.ndarray, "k"],
    ) -> Bool[np.ndarray, "k"]:
        raised = np.where(more > 0.0, np.minimum(own - more, -1e-9), own)
        return ((on.ankle(foot, raised, toes) - hips) ** 2).sum(-1) > limit**2

    far = beyond_reach(extra, stand, hip, pitch, meta)
    if not far.any():
        return extra
    them = (stand.at(far), hip[far], pitch[far], meta[far])
    low, high = np.zeros(int(far.sum())), np.full(int(far.sum()), LARGEST_RAISE)
    open_ = np.ones(len(low), dtype=np.bool_)
    for angle in np.linspace(0.0, LARGEST_RAISE, 21)[1:]:
        fits = open_ & ~beyond_reach(np.full(len(low), angle), *them)
        high[fits] = angle
        open_ &= ~fits
        low[open_] = angle
    for _ in range(34):
        middle = 0.5 * (low + high)
        beyond = beyond_reach(middle, *them)
        low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
    extra[far] = np.maximum(high, LEAST_RAISE)
    return np.minimum(extra, np.maximum(STEEPEST + pitch, 0.0))


def drawn_near(
    hip: Float[np.ndarray, "n 3"],
    ankle: Float[np.ndarray, "n 3"],
    u: Float[np.ndarray, "n"],
    ends: Float[np.ndarray, "2 n"],
    body: Body,
) -> Float[np.ndarray, "n 3"]:
    """Ankles of a swinging foot brought within reach of the hips, along the leg.

    The distance becomes a soft minimum (:data:`SOFT`) of itself and the limit, all through the
    swing: ``u`` is 0 at toe-off and 1 at heel strike, ``ends`` are the distances there (m). Those
    are reached as they are: the minimum is hard there, and what it would still take is given
    back.
    """
    limit = SWING_REACH * body.leg_length
    near = [smoothstep(part) for part in (u / EASED[0], (1.0 - u) / EASED[1])]
    soft = body.leg_length * (HARD + (SOFT - HARD) * near[0] * near[1])
    line = ankle - hip
    distance = lengths(line)
    less = _beyond(distance - limit, soft)
    for end, share in zip(ends, near, strict=True):
        less = less - _beyond(end - limit, HARD * body.leg_length) * (1.0 - share)
    return ankle - line * (less / np.maximum(distance, 1e-12))[:, None]


def _beyond(
    over: Float[np.ndarray, "n"], soft: Float[np.ndarray, "n"] | float
) -> Float[np.ndarray, "n"]:
    """``max(over, 0)`` made smooth."""
    share = over / soft
    return soft * np.where(share > 30.0, share, np.log1p(np.exp(np.minimum(share, 30.0))))
