"""A gait from markers: the best closed stride of the legs, on a body of their lengths.

What is measured are the legs' angles in the plane that holds hip, ankle and the walk's
direction, the soles' and toes' against where they stand flat, and the hips' path. Everything
above stays at rest: it moves by rules. ``docs/reference/markers.md`` says what is derived how.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.cycle import EVENTS, Cycle
from gaitsmith.gait.learn import SAMPLES, Learned, standing_feet, symmetrized
from gaitsmith.gait.marker_body import FlatFoot, body_of_legs, flat_foot
from gaitsmith.gait.marker_joints import MarkerLeg, walker_of
from gaitsmith.gait.marker_strides import (
    MarkerClip,
    Span,
    is_straight,
    known,
    read,
    score,
    spans_of,
    stances_of,
    way_of,
)
from gaitsmith.gait.neutral import neutral_cycle
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import (
    IDENTITY,
    about,
    from_euler,
    inverse,
    multiply,
    rotate,
    to_euler,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.events import Stance
    from gaitsmith.motion.motion import Markers

#: Shares of a stride: the longest blend, and the shortest worth one (else the gap is spread).
_LONGEST, _SHORTEST = 0.6, 0.15
#: Least double support after each heel strike, and between events of a foot, shares of the stride.
_DOUBLE, _APART = 0.02, 0.004
#: Flexion of the straightest knee in a stride, least; the walk `neutral` has no less.
_STRAIGHTEST = float(np.radians(3.0))
#: Frames by which a clip may miss the ends of its only stride.
_SPARE = 1.5
#: Columns of the hips and of each leg.
_HIPS = ("x", "y", "z", "yaw", "lean", "list")
_LEG = ("thigh", "knee", "aside", "pitch", "toes")
#: Of _HIPS: what a mirror reverses.
_MIRROR = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0])


def learn_from_markers(
    markers: Markers,
    *,
    height: float | None = None,
    symmetric: bool = False,
    events: Sequence[Stance] | None = None,
    source: str = "",
    license: str = "",
) -> Learned:
    """The best closed stride of the legs that wear ``markers``.

    Parameters
    ----------
    markers
        Of one leg or both; any names, any direction, over ground or on a treadmill.
    height
        Stature, meters; None: that of average people with such legs.
    symmetric
        Average the stride with its mirror image half a stride later.
    events
        Stances to use instead of those found, seconds.
    source, license
        Where the markers come from and what may be done with them; kept with the stride.

    Raises
    ------
    InfeasibleError
        If there is no whole leg, no stride from one heel strike to the next of the same foot,
        or if it is running.
    """
    notes: list[str] = []
    unsaid = RIGHT if not events else min(events, key=lambda s: s.heel_strike).side
    walker = walker_of(markers, unsaid, notes)
    found = stances_of(walker, events)
    spans = spans_of(found, walker)
    feet = {side: flat_foot(leg, side, found, walker) for side, leg in walker.legs.items()}
    clip = MarkerClip(walker, found, feet)
    spans = [s for s in spans if is_straight(clip, s)]
    if not spans:
        raise InfeasibleError(
            "no stride of the markers leads straight ahead; cut the clip to straight walking"
        )
    usual = float(np.median([s.duration for s in spans]))
    span = min(spans, key=lambda s: score(clip, s, usual))
    if not walker.flat:
        way = way_of(clip, span)
        walker = walker.turned(float(np.arctan2(way[0], way[2])))
        feet = {side: flat_foot(leg, side, found, walker) for side, leg in walker.legs.items()}
        clip = MarkerClip(walker, found, feet)
    return _learned(clip, span, height, symmetric, notes, source, license)


def _learned(
    clip: MarkerClip,
    span: Span,
    height: float | None,
    symmetric: bool,
    notes: list[str],
    source: str,
    license: str,
) -> Learned:
    body = body_of_legs(clip.walker, clip.feet, height, notes)
    length = float(way_of(clip, span)[2])
    events = _phases(clip, span, notes)
    hips, legs = _closed(clip, span, length, events, body, notes)
    if len(clip.walker.legs) == 1:
        side = span.side
        notes.append(
            f"only the {SIDES[side]} leg was measured: the other does the same half a stride later"
        )
    legs = _bent_forward(legs, clip, body, notes)
    cycle = Cycle(
        skeleton=skeleton_of(body),
        center=hips[:, :3],
        rotations=_posed(body, hips, legs, clip),
        events=events,
        stride_length=length,
        duration=span.duration,
        source=source,
        license=license,
    )
    if symmetric and len(clip.walker.legs) == 2:
        cycle = symmetrized(cycle)
        notes.append("left and right made mirror images of each other")
    feet = standing_feet(cycle)
    middle = 0.5 * (feet.place[0, 0] + feet.place[1, 0])
    cycle = cycle.with_(center=cycle.center - [middle, feet.height, cycle.center[:, 2].mean()])
    right = float(feet.place[1, 1] - feet.place[0, 1])
    return Learned(
        cycle=cycle,
        body=body,
        stances=tuple(clip.found),
        span=(span.begin, span.end),
        step_lengths=(length - right, right),
        step_width=float(feet.place[0, 0] - feet.place[1, 0]),
        toe_out=(float(feet.heading[0]), float(-feet.heading[1])),
        notes=tuple(notes),
    )


def _phases(clip: MarkerClip, span: Span, notes: list[str]) -> Float[np.ndarray, "2 4"]:
    """Events of [left, right] as stride phases, the left heel strike at 0."""
    out = np.empty((2, 4))
    middle = 0.5 * (span.begin + span.end)
    for side in clip.walker.legs:
        for event in range(len(EVENTS)):
            times = known(clip.found, side, event)
            if event in (1, 2) and not times:
                raise InfeasibleError(
                    f"the markers do not show the {SIDES[side]} foot flat on the ground in a stance"
                )
            # of several strides, the one that is taken
            wanted = span.begin + 0.3 * span.duration if side == span.side else middle
            out[side, event] = min(times, key=lambda t: abs(t - wanted)) / span.duration
    for side in (LEFT, RIGHT):
        if side not in clip.walker.legs:
            out[side] = out[1 - side] + 0.5
    out[span.side, 0] = span.begin / span.duration
    since = (out - out[:, :1]) % 1.0
    strike = (out[:, 0] - out[0, 0]) % 1.0
    stretched = False
    for side, other in ((LEFT, RIGHT), (RIGHT, LEFT)):
        least = (strike[other] - strike[side]) % 1.0 + _DOUBLE
        if since[side, 3] < least:
            since[side, 3], stretched = least, True
    if stretched:
        notes.append("double support was under 4 % of the stride: stretched to that")
    for own in since:
        for i in (1, 2):
            own[i] = max(own[i], own[i - 1] + _APART)
        for i in (2, 1):
            own[i] = min(own[i], own[i + 1] - _APART)
    return (strike[:, None] + since) % 1.0


def _columns(
    clip: MarkerClip, span: Span, events: Float[np.ndarray, "2 4"], body: Body
) -> Float[np.ndarray, "F C"]:
    """Hips and measured legs, frame by frame: :data:`_HIPS`, then :data:`_LEG` of each leg."""
    walker = clip.walker
    legs = walker.legs
    count = len(clip.leg.hip)
    turn = np.zeros((count, 3))
    if len(legs) == 2 and not walker.flat:
        across = legs[LEFT].hip - legs[RIGHT].hip
        turn[:, 0] = np.arctan2(-across[:, 2], across[:, 0])
        turn[:, 2] = np.arctan2(across[:, 1], np.hypot(across[:, 0], across[:, 2]))
    elif len(legs) == 1:
        share = (np.arange(count) / walker.rate - span.begin) / span.duration
        turn = _usual_pelvis(share + events[span.side, 0])
    if walker.tilt is not None:
        turn[:, 1] = walker.tilt - walker.tilt.mean()
    half = np.array([0.5 * body.hip_width, 0.0, 0.0])
    pelvis = from_euler("yxz", turn)
    away = {side: rotate(pelvis, SIDE_SIGN[side] * half) for side in legs}
    if walker.flat:  # the markers are in one plane, the hip joints beside it
        away = {side: v * [0.0, 1.0, 1.0] for side, v in away.items()}
    center = np.mean([g.hip - away[side] for side, g in legs.items()], axis=0)
    return np.concatenate(
        [center, turn, *(_angles(leg, clip.feet[side]) for side, leg in legs.items())], axis=1
    )


def _usual_pelvis(phase: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F 3"]:
    """Turn, lean and list of the pelvis of the built-in walk: where markers do not tell them.

    Its hip joints rise and fall, and with them a marker that is on one of them.
    """
    _, turned = neutral_cycle().at(phase)
    turn = to_euler("yxz", turned[:, 0])
    turn[:, 1] = 0.0
    return turn


def _angles(leg: MarkerLeg, foot: FlatFoot) -> Float[np.ndarray, "F 5"]:
    """Columns :data:`_LEG`: thigh and knee in the leg's plane, and how far that leans aside."""
    ankle = leg.ankle + foot.beside
    line = ankle - leg.hip
    aside = np.arctan2(line[:, 0], -line[:, 1])
    out = [aside]
    for bone in (leg.knee - leg.hip, leg.ankle - leg.knee):
        down = np.sin(aside) * bone[:, 0] - np.cos(aside) * bone[:, 1]
        out.append(np.arctan2(bone[:, 2], down))
    pitch, toes = foot.pitch(leg)
    return np.stack([out[1], out[1] - out[2], aside, pitch, toes], axis=-1)


def _closed(
    clip: MarkerClip,
    span: Span,
    length: float,
    events: Float[np.ndarray, "2 4"],
    body: Body,
    notes: list[str],
) -> tuple[Float[np.ndarray, "K 6"], Float[np.ndarray, "2 K 5"]]:
    """Hips less their travel and both legs on the samples of a stride from the left strike."""
    rate, period = clip.walker.rate, span.duration
    table = _columns(clip, span, events, body)
    slack = clip.last - period
    if slack < -_SPARE / rate:
        raise InfeasibleError(f"the clip of {clip.last:.2f} s is shorter than its stride")
    # after the stride what follows can be blended in; what came before it is as good
    begin = min(span.begin, max(0.0, slack - _LONGEST * period))
    blend = min(_LONGEST * period, clip.last - begin - period)
    left = span.begin - float(events[span.side, 0]) * period
    phase = np.arange(SAMPLES) / SAMPLES
    travel = np.zeros(table.shape[1])
    travel[_HIPS.index("z")] = length

    def at(share: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n C"]:
        """Columns at shares of the stride from ``begin``, less their travel."""
        times = np.clip(begin + share * period, 0.0, clip.last)
        return read(table, times * rate) - share[:, None] * travel

    share = (left - begin) / period + phase
    share = share % 1.0
    out = at(share)
    if blend > _SHORTEST * period:
        weight = smoothstep(share * period / blend)[:, None]
        early = share * period < blend
        out[early] = (weight * out)[early] + (1.0 - weight[early]) * at(share[early] + 1.0)
    else:
        notes.append("just one stride: what keeps it from closing is spread over it")
        gap = at(np.array([1.0])) - at(np.array([0.0]))
        out = out - (share[:, None] - 0.5) * gap
    hips, legs = out[:, : len(_HIPS)], out[:, len(_HIPS) :].reshape(SAMPLES, -1, len(_LEG))
    if legs.shape[1] == 2:
        return hips, legs.transpose(1, 0, 2)
    later = np.roll(np.arange(SAMPLES), -SAMPLES // 2)
    hips = 0.5 * (hips + hips[later] * _MIRROR)
    leg = legs[:, 0]
    both = np.stack([leg, leg[later]] if span.side == LEFT else [leg[later], leg])
    both[RIGHT if span.side == LEFT else LEFT, :, _LEG.index("aside")] *= -1.0
    return hips, both


def _bent_forward(
    legs: Float[np.ndarray, "2 K 5"], clip: MarkerClip, body: Body, notes: list[str]
) -> Float[np.ndarray, "2 K 5"]:
    """Knees put so far ahead that even the straightest is bent a little, hip to ankle as they were.

    A marker beside the knee tells its axis to some 3 cm, which are 5 deg.
    """
    least = _STRAIGHTEST - legs[..., 1].min(axis=1)
    out = np.array(legs)
    for side in (LEFT, RIGHT):
        if least[side] <= 0.0:
            continue
        out[side, :, 0] += least[side] * body.shin / body.leg_length
        out[side, :, 1] += least[side]
        if side in clip.walker.legs:
            notes.append(
                f"the {SIDES[side]} knee's marker is behind its axis: knee bent by "
                f"{np.degrees(least[side]):.1f} deg more throughout"
            )
    return out


def _posed(
    body: Body, hips: Float[np.ndarray, "K 6"], legs: Float[np.ndarray, "2 K 5"], clip: MarkerClip
) -> Float[np.ndarray, "K J 4"]:
    """Local rotations of the body's joints; those above the hips stay at rest."""
    skeleton = skeleton_of(body)
    out = np.tile(IDENTITY, (len(hips), len(skeleton), 1))
    out[:, 0] = pelvis = from_euler("yxz", hips[:, 3:])
    for side, name in enumerate(SIDES):
        thigh, knee, aside, pitch, toes = legs[side].T
        upper = multiply(about("z", aside), about("x", -thigh))
        lower = multiply(upper, about("x", knee))
        other = next(iter(clip.feet))
        heading = clip.feet[side].heading if side in clip.feet else -clip.feet[other].heading
        foot = multiply(about("y", np.array(heading)), about("x", -pitch))
        for part, local in (
            ("UpperLeg", multiply(inverse(pelvis), upper)),
            ("LowerLeg", about("x", knee)),
            ("Foot", multiply(inverse(lower), foot)),
            ("Toes", about("x", pitch - toes)),
        ):
            out[:, skeleton.index(f"{name}{part}")] = local
    return out
