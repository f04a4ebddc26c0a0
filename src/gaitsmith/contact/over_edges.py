"""Swings over risers: up, a foot rises before it passes the edge; down, it passes, then sinks.

Where the ground jumps, what a sole needs jumps too. So the lift is not read off it: it is the
least bent curve over all that the swing needs, a thin beam over obstacles; and the foot goes ahead
later or sooner, whichever bends the beam less.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.flights import sole_points
from gaitsmith.conventions import UP
from gaitsmith.geometry.curves import pchip, smoothstep
from gaitsmith.geometry.rotations import about, exp, multiply

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact.flights import Flights
    from gaitsmith.ground import Ground

#: Samples of a swing, equally spaced in time.
SAMPLES = 49
#: Room that a sole keeps over edges and around them (m), and part of the swing in which it grows
#: and shrinks: at its ends the foot stands.
OVER, AROUND, RAMP = 0.024, 0.016, 0.16
#: Of the room around a standing foot so much is spared (m); higher ground by less is none. Part
#: of the wanted room that is kept in mid-swing where the foot stands with less.
SPARE, INTO, FREE = 0.004, 0.01, 0.0
#: How much later (of the swing) the foot is where it would be half way, or how long before it
#: lands it is over its goal (negative); and how far it is drawn back (m) at first, which is over
#: at this part of the swing: ways that are tried.
WAYS = tuple((by, 0.0) for by in (-0.4, -0.3, -0.2, -0.1)) + tuple(
    (by, back) for by in (0.0, 0.08, 0.16, 0.24, 0.3) for back in (0.0, 0.04, 0.08, 0.12)
)
DRAWN_BACK = 0.7
#: What a warp costs beside the bending energy (m^2 per swing time^3) that it saves.
WARP_COST, BACK_COST = 20.0, 400.0
#: Reach of a leg over its length; turn of the knee from sample to sample (radians) that costs
#: nothing, and what more costs, squared.
STRAIGHT, UNHURRIED, KNEE_COST = 0.9995, 0.1, 6000.0
#: Bend of the ankle (radians, toes up) beyond which a swinging foot hangs, by which share of what
#: is more, how softly (radians) that sets in, and over what part of the swing at its ends.
BENT_UP, HANGS, SOFTLY, HANGING = float(np.radians(12.0)), 0.8, float(np.radians(3.0)), 0.25
#: By how much more (radians a sample) the knee may turn for it.
STILL_CALM = 0.01
#: Rounds of the beam's solver, and its penalty.
ROUNDS, PENALTY = 160, 1.5e4


def warped(u: Float[np.ndarray, "*n"], by: Float[np.ndarray, "*n"] | float) -> np.ndarray:
    """Time of the swing that is shown at ``u``, leaving as ever.

    Later for ``by`` > 0; for ``by`` < 0 the foot has come over its goal so long before it lands.
    """
    late = u - np.maximum(by, 0.0) * 16.0 * (u * (1.0 - u)) ** 2
    whole = 1.0 + np.minimum(by, 0.0)
    v = np.minimum(u / whole, 1.0)
    soon = v * v * (3.0 - 2.0 * v) + whole * v * (1.0 - v) ** 2
    return np.where(np.asarray(by) < 0.0, soon, late)


def over_edges(flights: Flights, body: Body, ground: Ground) -> Flights:
    """The same swings, so that they clear ``ground`` with its edges."""
    f, swings = flights, len(flights.first)
    u = np.linspace(0.0, 1.0, SAMPLES)
    row = np.arange(swings)
    # swings side by side on one axis, two units apart
    axis = 2.0 * f.swing + f.u
    columns = np.column_stack([f.ankle, f.heading, f.pitch, f.bend])

    def read(at: Float[np.ndarray, "S K"]) -> Float[np.ndarray, "S K 6"]:
        return pchip(axis, columns, (2.0 * row[:, None] + at).ravel()).reshape(*at.shape, 6)

    plain = read(np.broadcast_to(u, (swings, SAMPLES)))
    hip = pchip(axis, f.hip, (2.0 * row[:, None] + u).ravel()).reshape(swings, SAMPLES, 3)
    gone = f.end.position - f.start.position
    ahead_ = gone / np.maximum(np.linalg.norm(gone[:, [0, 2]], axis=-1), 1e-6)[:, None]
    ahead_[:, 1] = 0.0
    lifts, costs = [], []
    for by, back in WAYS:
        moved = read(np.broadcast_to(warped(u, by), (swings, SAMPLES)))
        moved[..., 1] = plain[..., 1]
        moved[..., :3] -= back * _drawn_back(u)[:, None] * ahead_[:, None]
        need = _needed(f, moved, u, body, ground)
        lift = beam(need)
        short = np.maximum(need - lift, 0.0).max(-1)
        way = bending(plain[..., 1] + lift) + WARP_COST * by**2 + BACK_COST * back**2
        way += KNEE_COST * _knee_haste(moved[..., :3] + lift[..., None] * UP - hip, body) ** 2
        costs.append(way + 1e6 * np.maximum(short - 0.003, 0.0))
        lifts.append(lift)
    best = np.argmin(costs, axis=0)
    lift = np.array(lifts)[best, row]
    # the foot hangs from a knee that is bent so far, which asks for a little more lift
    by, back = np.array(WAYS)[best].T
    moved = read(warped(u, by[:, None]))
    moved[..., 1] = plain[..., 1]
    moved[..., :3] -= (back[:, None] * _drawn_back(u))[..., None] * ahead_[:, None]
    leg = moved[..., :3] + lift[..., None] * UP - hip
    hangs = _hanging(leg, moved[..., 3:5], u, body)
    moved[..., 4] -= hangs
    higher = beam(_needed(f, moved, u, body, ground))
    hurried = _knee_haste(moved[..., :3] + higher[..., None] * UP - hip, body)
    calm = (hurried <= _knee_haste(leg, body) + STILL_CALM)[:, None]
    lift, hangs = np.where(calm, higher, lift), np.where(calm, hangs, 0.0)
    by, back = by[f.swing], back[f.swing]
    out = pchip(axis, columns, 2.0 * f.swing + warped(f.u, by))
    more = np.stack([lift, hangs], axis=-1).reshape(-1, 2)
    more = pchip((2.0 * row[:, None] + u).ravel(), more, 2.0 * f.swing + f.u)
    out[:, :3] -= (back * _drawn_back(f.u))[:, None] * ahead_[f.swing]
    out[:, 1] = f.ankle[:, 1] + more[:, 0]
    out[:, 4] -= more[:, 1]
    return replace(f, ankle=out[:, :3], heading=out[:, 3], pitch=out[:, 4], bend=out[:, 5])


def _hanging(
    leg: Float[np.ndarray, "S K 3"],
    turns: Float[np.ndarray, "S K 2"],
    u: Float[np.ndarray, "K"],
    body: Body,
) -> Float[np.ndarray, "S K"]:
    """How much lower the toes hang, radians, than with an ankle that is bent up too far.

    ``leg`` leads from hip to ankle; ``turns`` are the foot's heading and pitch.
    """
    heading, pitch = np.moveaxis(turns, -1, 0)
    gone = leg[..., 0] * np.sin(heading) + leg[..., 2] * np.cos(heading)
    far = np.sqrt((leg**2).sum(-1))
    far = np.clip(far, abs(body.thigh - body.shin) + 1e-6, STRAIGHT * body.leg_length)
    cosine = (far**2 + body.shin**2 - body.thigh**2) / (2.0 * far * body.shin)
    shin = np.arctan2(gone, -leg[..., 1]) - np.arccos(np.clip(cosine, -1.0, 1.0))
    over = (pitch - shin - BENT_UP) / SOFTLY
    over = SOFTLY * np.where(over > 30.0, over, np.log1p(np.exp(np.minimum(over, 30.0))))
    return HANGS * over * smoothstep(u / HANGING) * smoothstep((1.0 - u) / HANGING)


def _drawn_back(u: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """0 at both ends of the swing, 1 early in it."""
    v = np.clip(u / DRAWN_BACK, 0.0, 1.0)
    return 16.0 * (v * (1.0 - v)) ** 2


def _needed(
    f: Flights,
    moved: Float[np.ndarray, "S K 6"],
    u: Float[np.ndarray, "K"],
    body: Body,
    ground: Ground,
) -> Float[np.ndarray, "S K"]:
    """Meters that each sample must be lifted at least; negative where there is room."""
    share = smoothstep(u)[:, None]
    tilt = (1.0 - share) * f.start.tilt[:, None] + share * f.end.tilt[:, None]
    toes = np.zeros(moved.shape[:2])
    if f.start.toes is not None and f.end.toes is not None:
        toes = (1.0 - share[:, 0]) * f.start.toes[:, None] + share[:, 0] * f.end.toes[:, None]
    turned = multiply(exp(tilt), multiply(about("y", moved[..., 3]), about("x", -moved[..., 4])))
    heel, ball, tip = np.moveaxis(sole_points(body.foot, turned, moved[..., 5] + toes), -2, 0)
    back, front = (np.linspace(0.0, 1.0, n)[:, None, None, None] for n in (8, 5))
    sole = moved[..., :3] + np.concatenate(
        [heel + back * (ball - heel), ball + front * (tip - ball)]
    )
    ramp = smoothstep(u / RAMP) * smoothstep((1.0 - u) / RAMP)
    way = np.stack([np.sin(moved[..., 3]), np.cos(moved[..., 3])], axis=-1)
    rooms = [_room(sole[:, :, end], way[:, end], ground) for end in (0, -1)]
    # no more around the foot than there is where it stands, near the ends of its way
    ends = rooms[0][:, None] * (1.0 - share[:, 0]) + rooms[1][:, None] * share[:, 0]
    reach = (ends + ramp * np.maximum(AROUND - ends, 0.0) * FREE)[..., None] * way
    below = np.full(sole.shape[:-1], -np.inf)
    for step in (-1.0, -0.5, 0.0, 0.5, 1.0):
        x, z = sole[..., 0] + step * reach[..., 0], sole[..., 2] + step * reach[..., 1]
        below = np.maximum(below, ground.height(x, z))
    return (below - sole[..., 1]).max(0) + OVER * ramp


def _room(
    sole: Float[np.ndarray, "p S 3"], way: Float[np.ndarray, "S 2"], ground: Ground
) -> Float[np.ndarray, "S"]:
    """Meters around a standing sole, along ``way``, to what it would run into."""
    beyond = np.linspace(0.0, AROUND, 13)[:, None, None]
    out = np.full(len(way), AROUND)
    for sign in (-1.0, 1.0):
        x = sole[..., 0] + sign * beyond * way[:, 0]
        z = sole[..., 2] + sign * beyond * way[:, 1]
        into = (ground.height(x, z) > sole[..., 1] + INTO).any(1)
        first = np.where(into.any(0), into.argmax(0), len(beyond))
        out = np.minimum(out, np.append(beyond, AROUND)[first])
    return np.maximum(out - SPARE, 0.0)


def _knee_haste(leg: Float[np.ndarray, "S K 3"], body: Body) -> Float[np.ndarray, "S"]:
    """By how much the knee turns too far from one sample to the next, at most, radians.

    ``leg`` leads from hip to ankle. A foot that is over its goal while the hips are still behind
    straightens the knee at once.
    """
    size = np.minimum((leg**2).sum(-1), (STRAIGHT * body.leg_length) ** 2)
    cosine = (size - body.thigh**2 - body.shin**2) / (2.0 * body.thigh * body.shin)
    flexion = np.arccos(np.clip(cosine, -1.0, 1.0))
    return np.maximum(np.abs(np.diff(flexion, axis=-1)).max(-1) - UNHURRIED, 0.0)


def bending(lift: Float[np.ndarray, "S K"]) -> Float[np.ndarray, "S"]:
    """Integral of the squared second derivative over the swing."""
    h = 1.0 / (lift.shape[-1] - 1)
    return (np.diff(lift, 2, axis=-1) ** 2).sum(-1) / h**3


def beam(need: Float[np.ndarray, "S K"]) -> Float[np.ndarray, "S K"]:
    """Least bent curves that start and end at 0 without slope and stay above ``need``.

    The obstacle problem of a clamped beam, by alternating directions: all swings at once.
    """
    solve = _solver(need.shape[-1])
    floor = need[:, 1:-1]
    lift = np.zeros_like(floor)
    if not (floor > 0.0).any():
        return np.zeros_like(need)
    kept, push = np.maximum(lift, floor), np.zeros_like(floor)
    for _ in range(ROUNDS):
        lift = (kept - push) @ solve
        over = 1.7 * lift - 0.7 * kept  # over-relaxed
        kept = np.maximum(over + push, floor)
        push = push + over - kept
    return np.pad(lift, ((0, 0), (1, 1)))


@cache
def _solver(samples: int) -> Float[np.ndarray, "K K"]:
    """Inverse of the beam's stiffness with the solver's penalty, over the penalty."""
    count = samples - 2
    h = 1.0 / (samples - 1)
    second = np.zeros((samples, count))
    for i in range(count):
        second[i, i] = 1.0
        second[i + 1, i] = -2.0
        second[i + 2, i] = 1.0
    second[0, 0] = second[-1, -1] = 2.0  # clamped: mirrored at both ends
    second[[0, -1]] *= np.sqrt(0.5)
    stiff = second.T @ second / h**4
    return PENALTY * np.linalg.inv(stiff + PENALTY * np.eye(count))
