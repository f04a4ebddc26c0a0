"""Plan the contact of a whole walk: locks, lowering, heel raise, clearance, on its nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact.apply import ContactPlan
from gaitsmith.contact.clearing import cleared
from gaitsmith.contact.flights import Flights
from gaitsmith.contact.foothold import Footholds, sole_in_air
from gaitsmith.contact.reach import (
    ENDING,
    ENDING_SPREADS,
    REAR_REACH,
    REAR_SLACK,
    SPREAD,
    UNEVEN_SPREAD,
    check_reach,
    drawn_near,
    lengths,
    lowering,
    raised_heel,
)
from gaitsmith.contact.reference import Proposal, ReferenceStep, stack
from gaitsmith.contact.standing import standing
from gaitsmith.contact.step_curves import FINEST
from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.curves import parabola_slopes, smoothstep
from gaitsmith.geometry.rotations import exp, left_of, turned_left
from gaitsmith.ground import Flat

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground

#: The sole keeps this far from the ground in swing, meters, rising over a fifth of the swing.
CLEARANCE, CLEARANCE_RAMP = 0.010, 0.2
#: So much of it at once, so that no curve dips below the ground between nodes.
AT_ONCE, AT_ONCE_RAMPS = 0.0004, (0.025, 0.05)
#: Deepest that the sole's lowest point may be drawn between nodes, meters, before they are lifted,
#: and by how much of what is deeper.
DIPS, LIFTED = 0.0001, 1.5
#: Part of the swing over which a heel that was raised more for reach comes back.
RAISE_FADES = 0.6
#: Part of the swing over which its first speed is matched to the leaving foot's.
LEAVING = 0.2
#: Curves of one sole.
SOLE = ("pitch", "meta", "bend")
#: Change of speed (meters per usual step squared) that hips which stop at the end of a walk keep
#: below, if that can be.
JOLT = 12.0
#: Part of the swing over which toes that hung over an edge straighten.
STRAIGHTENED = 0.5


def plan_contact(steps: Sequence[ReferenceStep], body: Body, ground: Ground) -> ContactPlan:
    """Make the proposed steps meet the ground.

    Parameters
    ----------
    steps
        Consecutive steps: each begins where the one before ends.
    body
        Whose legs and feet.
    ground
        Where the footholds lie.

    Raises
    ------
    LegReachError
        If a leg cannot reach its foothold.
    """
    walk = stack(steps)
    stands = standing(walk.foothold, walk.foothold_heading, ground, body.foot)
    targets = standing(walk.target, walk.target_heading, ground, body.foot)
    down = walk.bearing()
    hip = _hips(walk, body)
    if stands.on_ball is not None:  # no toes to stand on the tip of
        node, side = np.nonzero(down)
        hangs = stands.on_ball[walk.step[node], side]
        walk.curves["meta"][node[hangs], side[hangs]] = 0.0
    _lock(walk, body, stands, down)
    # a foot that leaves from its heel, as in a step back, has no heel to raise
    rear = _rear(walk, down) & (walk.curves["pitch"] <= 1e-6)
    slack = np.where(down, 0.0, np.inf)
    share = walk.raising[walk.step] * walk.phase / np.minimum(walk.toe_off[walk.step], 1.0)
    slack[rear] = (REAR_SLACK * body.leg_length * share)[rear.any(-1)]
    ankle = np.array(walk.curves["ankle"])
    if walk.toe_off[-1] < 1.0:  # a walk that ends with a heel strike must reach that foothold
        swing = 1 - walk.stance[-1]
        last = walk.landing.pitch[-1]
        ankle[-1, swing] = targets.at(-1).ankle(body.foot, last, 0.0)
        slack[-1, swing] = 0.0
    when = _when(walk, steps)

    def lowered(spread: float) -> Float[np.ndarray, "M"]:
        return lowering(
            walk.at, hip, ankle, slack, leg_length=body.leg_length, spread=spread, when=when
        )

    if isinstance(ground, Flat):
        down_by = lowered(SPREAD)
    else:
        down_by = lowered(UNEVEN_SPREAD)
        if walk.toe_off[-1] >= 1.0 and len(steps) > 1 and down_by.any():
            # who comes to stand there stays as the last step ends: no lowering goes on
            share = smoothstep((walk.at - float(len(steps) - 1)) / ENDING + 1.0)
            ways = [down_by + share * (lowered(spread) - down_by) for spread in ENDING_SPREADS]
            up = walk.curves["center"][:, 1]
            calm = (w for w in ways if _jolt(up - w, when, share > 0.0) < JOLT)
            down_by = next(calm, ways[-1])
    walk.curves["center"][:, 1] -= down_by
    hip[..., 1] -= down_by[:, None]
    extra = _rear_raise(walk, body, stands, rear, hip)
    if _lower_the_rest(walk, body, stands, rear, extra, hip, when):
        extra = _rear_raise(walk, body, stands, rear, hip)  # of hips that are lower: less
    _raise_rear_heels(walk, rear, extra)
    _lock(walk, body, stands, rear)
    check_reach(walk.at, hip, walk.curves["ankle"], down, leg_length=body.leg_length)
    for side in (0, 1):
        _swing(walk, body, ground, stands, targets, side, hip[:, side])
    return ContactPlan.of(walk, stands, targets, body)


def _jolt(
    height: Float[np.ndarray, "M"], when: Float[np.ndarray, "M"], late: Bool[np.ndarray, "M"]
) -> float:
    """Largest change of speed of the hips in the ``late`` part, meters per usual step squared."""
    return float(np.abs(np.gradient(np.gradient(height, when), when))[late].max())


def _when(walk: Proposal, steps: Sequence[ReferenceStep]) -> Float[np.ndarray, "M"]:
    """Time of the nodes, in usual steps."""
    shares = np.array([s.share for s in steps])
    if (shares == 1.0).all():
        return walk.at
    begin = np.concatenate([[0.0], np.cumsum(shares)])
    return begin[walk.step] + shares[walk.step] * walk.phase


def _lower_the_rest(
    walk: Proposal,
    body: Body,
    stands: Footholds,
    rear: Bool[np.ndarray, "M 2"],
    extra: Float[np.ndarray, "k"],
    hip: Float[np.ndarray, "M 2 3"],
    when: Float[np.ndarray, "M"],
) -> bool:
    """Lower the hips once more where raising the heel could not bring the rear ankle near.

    That is a foot too short for the step; the others are in reach already. Says whether it did.
    """
    if not extra.any():
        return False
    node, side = np.nonzero(rear)
    ankle = np.array(walk.curves["ankle"])
    ankle[node, side] = stands.at((walk.step[node], side)).ankle(
        body.foot, walk.curves["pitch"][node, side] - extra, walk.curves["meta"][node, side]
    )
    short = rear & (lengths(hip - ankle) > (REAR_REACH + 1e-6) * body.leg_length)
    if not short.any():
        return False
    slack = np.where(short, 0.0, np.inf)
    down_by = lowering(walk.at, hip, ankle, slack, leg_length=body.leg_length, when=when)
    walk.curves["center"][:, 1] -= down_by
    hip[..., 1] -= down_by[:, None]
    return True


def _hips(walk: Proposal, body: Body) -> Float[np.ndarray, "M 2 3"]:
    """World positions of the hip joints."""
    pelvis = turned_left(walk.curves["heading"], exp(walk.curves["pelvis"]))
    half = 0.5 * body.hip_width * left_of(pelvis)
    center = walk.curves["center"]
    out = np.empty((2, 3, len(center))).transpose(2, 0, 1)  # as the ankles: components contiguous
    np.add(center, half, out=out[:, LEFT])
    np.subtract(center, half, out=out[:, RIGHT])
    return out


def _lock(walk: Proposal, body: Body, stands: Footholds, down: Bool[np.ndarray, "M 2"]) -> None:
    """Put the ankle and the heading of every bearing foot where its foothold has them."""
    curves = walk.curves
    for side in (LEFT, RIGHT):
        node = np.flatnonzero(down[:, side])
        step = walk.step[node]
        pitch, meta = curves["pitch"][node, side], curves["meta"][node, side]
        curves["ankle"][node, side] = stands.at((step, side)).ankle(body.foot, pitch, meta)
        curves["foot_heading"][node, side] = walk.foothold_heading[step, side]


def _rear(walk: Proposal, down: Bool[np.ndarray, "M 2"]) -> Bool[np.ndarray, "M 2"]:
    """Feet that still bear in a step in which they will leave."""
    rear = np.zeros_like(down)
    leaves = walk.toe_off[walk.step] < 1.0
    node = np.arange(len(down))
    swing = 1 - walk.stance[walk.step]
    rear[node, swing] = down[node, swing] & leaves
    return rear


def _rear_raise(
    walk: Proposal,
    body: Body,
    stands: Footholds,
    rear: Bool[np.ndarray, "M 2"],
    hip: Float[np.ndarray, "M 2 3"],
) -> Float[np.ndarray, "k"]:
    """How much farther each of the ``rear`` feet must raise its heel, radians."""
    node, side = np.nonzero(rear)
    return raised_heel(
        body.foot,
        stands.at((walk.step[node], side)),
        hip[node, side],
        walk.curves["pitch"][node, side],
        walk.curves["meta"][node, side],
        leg_length=body.leg_length,
    )


def _raise_rear_heels(
    walk: Proposal, rear: Bool[np.ndarray, "M 2"], extra: Float[np.ndarray, "k"]
) -> None:
    """Raise rear heels by ``extra``, and let the raise die in the swing."""
    if not extra.any():
        return
    node, side = np.nonzero(rear)
    curves = walk.curves
    curves["pitch"][node, side] -= extra
    curves["bend"][node, side] += extra
    leaving = np.zeros(len(walk.stance))
    at_off = walk.phase[node] == walk.toe_off[walk.step[node]]
    leaving[walk.step[node[at_off]]] = extra[at_off]
    swing = 1 - walk.stance[walk.step]
    u = _swing_phase(walk)
    fade = leaving[walk.step] * np.where(u > 0.0, 1.0 - smoothstep(u / RAISE_FADES), 0.0)
    every = np.arange(len(swing))
    curves["pitch"][every, swing] -= fade
    curves["bend"][every, swing] += fade


def _swing_phase(walk: Proposal) -> Float[np.ndarray, "M"]:
    """0 at toe-off, 1 at heel strike; below 0 while both feet bear."""
    off = walk.toe_off[walk.step]
    return np.where(off < 1.0, (walk.phase - off) / np.where(off < 1.0, 1.0 - off, 1.0), -1.0)


def _swing(
    walk: Proposal,
    body: Body,
    ground: Ground,
    stands: Footholds,
    targets: Footholds,
    side: int,
    hip: Float[np.ndarray, "M 3"],
) -> None:
    """Carry one foot through its swings: ends met, ground cleared, leg in reach."""
    u = _swing_phase(walk)
    swings = walk.stance[walk.step] == 1 - side
    free = swings & (u >= 0.0)
    if not free.any():
        return
    foot, node = body.foot, np.flatnonzero(free)
    curves = {name: walk.curves[name][:, side] for name in ("ankle", "foot_heading", *SOLE)}
    at, step, w = u[node], walk.step[node], smoothstep(u[node])
    pitch, meta, bend = (curves[name][node] for name in SOLE)
    ankle, heading = np.take(curves["ankle"].T, node, axis=1).T, curves["foot_heading"][node]
    first = np.flatnonzero(np.concatenate([[True], np.diff(step) > 0]))
    count = np.diff(np.append(first, len(step)))

    # both ends where the footholds have them: what the proposal misses is spread over the swing
    steps = step[first]
    start = stands.at((steps, side))
    strike = np.searchsorted(walk.at, steps + 1.0)
    land_pitch = curves["pitch"][strike]
    end = targets.at(steps).ankle(foot, land_pitch, np.zeros(len(steps)))
    ankle[first] = walk.leaving.ankle[steps]

    def spread(
        at_start: Float[np.ndarray, "k *c"], at_end: Float[np.ndarray, "k *c"]
    ) -> Float[np.ndarray, "n *c"]:
        begin, finish = (np.repeat(miss.T, count, axis=-1) for miss in (at_start, at_end))
        return (begin * (1.0 - w) + finish * w).T

    ankle += spread(
        start.ankle(foot, pitch[first], meta[first]) - walk.leaving.ankle[steps],
        end - walk.landing.ankle[steps],
    )
    heading[first] = walk.leaving.heading[steps]
    heading += spread(
        walk.foothold_heading[steps, side] - walk.leaving.heading[steps],
        walk.target_heading[steps] - walk.landing.heading[steps],
    )
    pitch += np.repeat(land_pitch - walk.landing.pitch[steps], count) * w

    if start.on_ball is not None:  # toes that hung over an edge are bent more as they leave
        bent = np.maximum(-pitch[first] - meta[first], 0.0)
        gone = 1.0 - smoothstep(at / STRAIGHTENED)
        bend = bend + np.repeat(np.where(start.on_ball, bent - bend[first], 0.0), count) * gone

    swing = np.array([*ankle.T, pitch, bend])
    swing += _leaving_speed(walk, side, node, first, swing.T).T
    ankle, (pitch, bend) = swing[:3].T, swing[3:]
    if isinstance(ground, Flat):
        heights = _heights(body, ground, ankle, pitch, bend, heading)
        lift = _clearance(heights, at)
        landed = _heights(
            body, ground, end, land_pitch, curves["bend"][strike], walk.target_heading[steps]
        )
        dips = _dips(walk.at[node], heights + lift[:, None], first, steps + 1.0, landed)
        ankle[:, 1] += lift + dips * (at > 0.0)
    else:
        faces, bent = walk.target_heading[steps], curves["bend"][strike]
        flights = Flights.of(
            (first, at, walk.at[node]),
            np.column_stack([ankle, heading, pitch, bend, hip[node]]),
            (steps + 1.0, np.column_stack([end, faces, land_pitch, bent, hip[strike]])),
            (start, targets.at(steps)),
        )
        ankle, heading, pitch, bend = cleared(flights, body, ground)
    reach = [
        np.repeat(lengths(hip[which] - foot_at), count)
        for which, foot_at in ((node[first], ankle[first]), (strike, end))
    ]
    here = np.take(hip.T, node, axis=1).T
    curves["ankle"][node] = drawn_near(here, ankle, at, np.array(reach), body)
    curves["foot_heading"][node] = heading
    curves["pitch"][node] = pitch
    curves["bend"][node] = bend


def _leaving_speed(
    walk: Proposal,
    side: int,
    node: Int[np.ndarray, "n"],
    first: Int[np.ndarray, "k"],
    swing: Float[np.ndarray, "n 5"],
) -> Float[np.ndarray, "n 5"]:
    """What makes the foot leave the ground with the speeds it had on the toe tip.

    Columns are the ankle's three, the pitch and the bend of the toes; rows are the nodes of
    ``node``, each swing beginning at ``first``. [KB92b] joins positions only (erratum D17). The
    correction fades over the first part of the swing and moves neither end.
    """
    at, curves = walk.at[node], walk.curves
    count = np.diff(np.append(first, len(at)))

    def slope(
        x: Float[np.ndarray, "k 3"], y: Float[np.ndarray, "k 3 c"]
    ) -> Float[np.ndarray, "k c"]:
        """End slope of the parabola through three samples, the first being the end."""
        h0, h1 = (x[:, 1] - x[:, 0])[:, None], (x[:, 2] - x[:, 1])[:, None]
        d0, d1 = (y[:, 1] - y[:, 0]) / h0, (y[:, 2] - y[:, 1]) / h1
        return ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)

    after = first[:, None] + np.arange(3)
    before = node[first, None] - np.arange(3)
    pitch, meta = curves["pitch"][before, side], curves["meta"][before, side]
    bend = np.where(pitch < 0.0, -pitch - meta, 0.0)
    rear = np.concatenate(
        [curves["ankle"][before, side], pitch[..., None], bend[..., None]], axis=-1
    )
    change = slope(walk.at[before], rear) - slope(at[after], swing[after])
    span = LEAVING * (1.0 - walk.toe_off[walk.step[node[first]]])
    u = np.clip((at - np.repeat(at[first], count)) / np.repeat(span, count), 0.0, 1.0)
    shape = u * (1.0 - u) ** 2
    return (np.repeat((change * span[:, None]).T, count, axis=1) * shape).T


def _heights(
    body: Body,
    ground: Ground,
    ankle: Float[np.ndarray, "n 3"],
    pitch: Float[np.ndarray, "n"],
    bend: Float[np.ndarray, "n"],
    heading: Float[np.ndarray, "n"],
) -> Float[np.ndarray, "n 3"]:
    """Heel, ball and toe tip of a swinging foot above the ground, meters."""
    sole = sole_in_air(body.foot, ankle[:, 1], pitch, bend)
    sine, cosine = sine_cosine(heading)
    points = (sole.heel, sole.ball, sole.toe)
    height = np.empty((len(ankle), len(points)))
    for i, point in enumerate(points):
        x, z = ankle[:, 0] + point[:, 0] * sine, ankle[:, 2] + point[:, 0] * cosine
        height[:, i] = point[:, 1] - ground.height(x, z)
    return height


def _clearance(
    height: Float[np.ndarray, "n 3"], u: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n"]:
    """How far a swinging foot must be lifted, meters, so that its sole clears the ground.

    ``u`` is the phase of the swing.
    """
    want = CLEARANCE * smoothstep(u / CLEARANCE_RAMP) * smoothstep((1.0 - u) / CLEARANCE_RAMP)
    leaving, landing = AT_ONCE_RAMPS
    want = want + AT_ONCE * smoothstep(u / leaving) * smoothstep((1.0 - u) / landing)
    short = want - height.min(-1)
    soft = 0.3 * want + 1e-9  # a soft maximum: no corner where the lift begins
    return 0.5 * (short + np.sqrt(short**2 + soft**2))


def _dips(
    at: Float[np.ndarray, "n"],
    height: Float[np.ndarray, "n 3"],
    first: Int[np.ndarray, "k"],
    strike: Float[np.ndarray, "k"],
    landed: Float[np.ndarray, "k 3"],
) -> Float[np.ndarray, "n"]:
    """By how much nodes are too low for curves through them to stay above 0, meters.

    A foot that comes down fast would overshoot between the last two nodes before it lands.
    ``first`` are the nodes at which swings begin; they land at ``strike`` as high as ``landed``.
    """
    last = np.append(first[1:], len(at))
    lands = at[last - 1] < strike - 1e-9  # the end of the walk is a node of the swing already
    own = np.insert(np.ones(len(at), dtype=np.bool_), last[lands], values=False)
    at = np.insert(at, last[lands], strike[lands])
    height = np.insert(height, last[lands], landed[lands], axis=0)
    step = np.diff(at)
    # components apart: rows of three are slow to work on
    height, slopes = (np.ascontiguousarray(v.T) for v in (height, parabola_slopes(at, height)))
    rise, leaving, arriving = np.diff(height), step * slopes[:, :-1], step * slopes[:, 1:]
    lowest = np.full(len(step), np.inf)
    for u in (0.25, 0.5, 0.75):
        v = 1.0 - u
        curve = height[:, :-1] + u * u * (3.0 - 2.0 * u) * rise
        curve += u * v * v * leaving - u * u * v * arriving
        np.minimum(lowest, curve.min(axis=0), out=lowest)
    dip = LIFTED * np.maximum(-DIPS - lowest, 0.0)
    dip = np.where(step < FINEST * (1.0 + 1e-9), dip, 0.0)  # not from one swing to the next
    return np.maximum(np.append(dip, 0.0), np.append(0.0, dip))[own]
