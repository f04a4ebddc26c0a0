"""A clip becomes a Cycle: the best stride of straight walking in it, closed.

[KN12] sections 3.1-3.2, mended where literal readings fail (``docs/papers/errata.md``): events
by :mod:`gaitsmith.gait.events`, the later stride blended in by :mod:`gaitsmith.gait.loop`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import soles_of
from gaitsmith.conventions import BALL, HEEL, LEFT, SIDES, TOE
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.cycle import Cycle
from gaitsmith.gait.events import FootPath, Stance, stances
from gaitsmith.gait.loop import average, closed, mirrored
from gaitsmith.gait.strides import Clip, Span, gap_between, score, spans_of, straight, walked
from gaitsmith.geometry.rotations import about, multiply, rotate, sign_continuous
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.person import Person
    from gaitsmith.motion.motion import Motion

#: Samples of a learned stride.
SAMPLES = 128
#: Harmonics of the stride that the path of the hips keeps, about 9 Hz: markers shake by a
#: millimeter, which would be jolts of 15 m/s^2.
HARMONICS = 10
#: Radians that a stride's arms may be apart at its ends and still be closed within one stride.
_ARMS_GAP = float(np.radians(25.0))
#: Leg lengths by which strides that are learned of one clip differ.
DIFFERENT = 0.1
#: Least double support after each heel strike, share of the stride: 4 % in all.
_DOUBLE = 0.02
#: Least share of the stride between two events of a foot.
_APART = 0.004
#: Shares of the usual heel that a clip may tell.
_HEELS = (0.4, 1.3)
_ARMS = tuple(f"{s}{part}" for s in SIDES for part in ("Shoulder", "UpperArm", "LowerArm", "Hand"))


@dataclass(frozen=True, eq=False)
class Learned:
    """What was learned from a clip.

    Attributes
    ----------
    cycle
        The stride, on ``body``'s skeleton.
    body
        Who walks in the clip.
    stances
        All that were found, in order of heel strike, seconds of the clip.
    span
        Seconds of the clip from which the stride was taken.
    step_lengths, step_width, toe_out
        Meters that the [right, left] foot lands ahead of the other; meters between the lines
        of the feet; radians that [left, right] feet turn out.
    notes
        What was done to the data and should be known.
    """

    cycle: Cycle
    body: Body
    stances: tuple[Stance, ...]
    span: tuple[float, float]
    step_lengths: tuple[float, float]
    step_width: float
    toe_out: tuple[float, float]
    notes: tuple[str, ...]


def learn_cycle(
    person: Person,
    *,
    symmetric: bool = False,
    events: Sequence[Stance] | None = None,
    source: str = "",
    license: str = "",
) -> Learned:
    """The best closed stride of ``person``.

    Parameters
    ----------
    person
        From :func:`gaitsmith.gait.person.person_of`.
    symmetric
        Average the stride with its mirror image half a stride later.
    events
        Stances to use instead of those found.
    source, license
        Where the clip comes from and what may be done with it; kept with the stride.

    Raises
    ------
    InfeasibleError
        If the clip holds no 1.6 strides of straight, forward walking, or if it is running.
    """
    return learn_cycles(
        person, 1, symmetric=symmetric, events=events, source=source, license=license
    )[0]


def learn_cycles(
    person: Person,
    most: int,
    *,
    symmetric: bool = False,
    events: Sequence[Stance] | None = None,
    source: str = "",
    license: str = "",
) -> list[Learned]:
    """Up to ``most`` closed strides of ``person`` with different step lengths.

    The first is that of :func:`learn_cycle`; the others are those that close best of what differs
    in length by :data:`DIFFERENT` from all before.
    """
    notes: list[str] = []
    clip = _prepared(person, events, notes)
    spans = straight(clip, spans_of(clip.stances), notes)
    spans = walked(clip, spans)
    usual = _usual(clip, spans, symmetric, list(notes), source, license)
    out, lengths = [usual], [usual.cycle.stride_length]
    names = clip.motion.skeleton.names[1:]
    for span in sorted(spans, key=lambda s: gap_between(clip, s.first, s.last, names)):
        length = clip.length(span.first, span.last)
        near = DIFFERENT * clip.body.leg_length
        if len(out) < most and min(abs(length - other) for other in lengths) >= near:
            out.append(_learned(clip, span, span.last, 1, symmetric, [], source, license))
            lengths.append(length)
    return out


def _usual(
    clip: Clip, spans: list[Span], symmetric: bool, notes: list[str], source: str, license: str
) -> Learned:
    """The stride that closes best and is most usual; two where the arms need them."""
    best = min(spans, key=lambda s: score(clip, s, spans))
    strides, last = 1, best.last
    gap = gap_between(clip, best.first, best.last, _ARMS)
    if gap > _ARMS_GAP:
        twice = {
            gap_between(clip, one.first, two.last, _ARMS): (one, two.last)
            for one in spans
            for two in spans
            if two.first is one.last
        }
        if twice and min(twice) < 0.6 * gap:
            strides, (best, last) = 2, twice[min(twice)]
            notes.append("the arms repeat every two strides: the loop holds two")
        else:
            notes.append(f"the arms of the stride's ends are {np.degrees(gap):.0f} deg apart")
    return _learned(clip, best, last, strides, symmetric, notes, source, license)


def _prepared(person: Person, events: Sequence[Stance] | None, notes: list[str]) -> Clip:
    motion = over_ground(person.motion, notes)
    speed = walking_speed(motion)
    if speed < 0.1:
        raise InfeasibleError("nobody walks in this clip: the hips hardly get ahead")
    positions, world = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, positions, world)
    if events is None:
        feet = {
            side: FootPath(
                positions[:, motion.skeleton.index(f"{name}Foot")],
                *(soles[:, side, point] for point in (HEEL, BALL, TOE)),
            )
            for side, name in enumerate(SIDES)
        }
        found = stances(feet, motion.fps, speed=speed, leg_length=person.body.leg_length)
    else:
        found = sorted(events, key=lambda s: s.heel_strike)
        outside = [t for s in found for t in s.times if not 0.0 <= t <= motion.duration]
        if outside:
            raise InfeasibleError(
                f"an event at {outside[0]:.3f} s is not in the clip, which lasts "
                f"{motion.duration:.3f} s; give events in seconds of the clip (--events)"
            )
    body = _with_heel(person.body, soles, found, motion.fps)
    motion = motion.with_(skeleton=replace(motion.skeleton, soles=soles_of(body.foot)))
    return Clip(motion, body, sole_positions(motion.skeleton, positions, world), speed, found)


def _with_heel(
    body: Body, soles: Float[np.ndarray, "F 2 3 3"], found: Sequence[Stance], rate: float
) -> Body:
    """``body`` with heels as long as those that its feet land on in the clip.

    Rigs do not tell where the heel is. A foot that lands turns about it: how high the sole
    then lies tells how far behind the ankle it is (and less far if it is round).
    """
    foot, slopes, rises = body.foot, list[float](), list[float]()
    for stance in found:
        if stance.cut in ("start", "both"):
            continue
        a, b = round(stance.heel_strike * rate), round(stance.foot_flat * rate) + 1
        flat = round(0.5 * (stance.foot_flat + stance.heel_off) * rate)
        heel, ball = soles[a:b, stance.side, HEEL], soles[a:b, stance.side, BALL]
        floor = soles[flat, stance.side, :2, 1].mean()
        slope = (ball[:, 1] - heel[:, 1]) / foot.heel_ball
        slopes += slope.tolist()
        rises += (heel[:, 1] - floor).tolist()
    slope, rise = np.array(slopes), np.array(rises)
    slope = np.maximum(slope, 0.0)  # whoever lands on the toes tells nothing of the heel
    weight = float((slope**2).sum())
    if weight < 0.05:
        return body
    # a heel d farther back would lie slope * d lower
    longer = float((slope * rise).sum()) / weight
    heel = min(max(foot.heel + longer, _HEELS[0] * foot.heel), _HEELS[1] * foot.heel)
    return replace(body, foot=replace(foot, heel=heel))


def body_in(person: Person) -> Body:
    """The body of ``person``, its heels as long as those that it lands on if it walks."""
    try:
        return _prepared(person, None, []).body
    except InfeasibleError:
        return person.body


def walking_speed(motion: Motion) -> float:
    """Speed of the walking in ``motion``, m/s: standing before and after does not count."""
    way = motion.root_position[:, [0, 2]]
    window = min(len(way) - 1, max(1, round(motion.fps)))
    speed = np.linalg.norm(way[window:] - way[:-window], axis=-1) * motion.fps / window
    return float(np.quantile(speed, 0.75))


def over_ground(motion: Motion, notes: list[str]) -> Motion:
    """``motion`` as it would get ahead over ground, if it walks on a treadmill or in place."""
    positions, world = motion_kinematics(motion)
    ball = sole_positions(motion.skeleton, positions, world)[:, :, BALL]
    speed = np.gradient(ball, axis=0)[..., [0, 2]] * motion.fps
    low = ball[..., 1] <= np.quantile(ball[..., 1], 0.35, axis=0)
    belt = np.median(speed[low], axis=0)
    way = motion.root_position[-1] - motion.root_position[0]
    net = np.linalg.norm(way[[0, 2]]) / max(motion.duration, 1e-9)
    if np.hypot(*belt) < 0.25 or net > 0.4 * np.hypot(*belt):
        return motion
    # the mean speed of whatever point is lowest: it bears
    points = sole_positions(motion.skeleton, positions, world).reshape(len(motion), 6, 3)
    lowest = points[..., 1].argmin(axis=1)[:-1, None, None]
    passing = np.take_along_axis(np.diff(points, axis=0), lowest, axis=1)[:, 0] * motion.fps
    along = passing[:, [0, 2]] @ belt / np.hypot(*belt)
    belt = passing[along > 0.4 * np.hypot(*belt)][:, [0, 2]].mean(axis=0)
    notes.append(f"walks in place: carried over the ground at {np.hypot(*belt):.2f} m/s")
    carried = np.array(motion.root_position)
    carried[:, [0, 2]] -= motion.times[:, None] * belt
    return motion.with_(root_position=carried)


def _learned(
    clip: Clip,
    span: Span,
    last: Stance,
    strides: int,
    symmetric: bool,
    notes: list[str],
    source: str,
    license: str,
) -> Learned:
    begin, end = span.first.heel_strike, last.heel_strike
    way = (clip.foot(last) - clip.foot(span.first)) * [1.0, 0.0, 1.0]
    heading = float(np.arctan2(way[0], way[2]))
    ahead = about("y", -heading)
    rotations = np.array(clip.motion.rotations)
    rotations[:, 0] = multiply(ahead, rotations[:, 0])
    motion = clip.motion.with_(
        root_position=rotate(ahead, clip.motion.root_position),
        rotations=sign_continuous(rotations),
    )
    length = float(np.linalg.norm(way))
    blend = min(span.blend, last.toe_off - last.heel_strike)
    center, turned = closed(
        motion, begin, end, blend, np.array([0.0, 0.0, length]), SAMPLES * strides
    )
    duration = (end - begin) / strides
    cycle = _from_left(
        Cycle(
            skeleton=clip.motion.skeleton,
            center=center,
            rotations=turned,
            events=_phases(span, duration, notes),
            stride_length=length / strides,
            duration=duration,
            strides=strides,
            source=source,
            license=license,
        ),
        span.first.side,
    )
    if strides > 1:
        cycle = _legs_every_stride(cycle)
    if symmetric:
        cycle = symmetrized(cycle)
        notes.append("left and right made mirror images of each other")
    feet = standing_feet(cycle)
    middle = 0.5 * (feet.place[0, 0] + feet.place[1, 0])
    center = cycle.center - [middle, feet.height, cycle.center[:, 2].mean()]
    cycle = cycle.with_(center=without_shaking(center, cycle.strides))
    ahead_right = float(feet.place[1, 1] - feet.place[0, 1])
    return Learned(
        cycle=cycle,
        body=clip.body,
        stances=tuple(clip.stances),
        span=(begin, end),
        step_lengths=(cycle.stride_length - ahead_right, ahead_right),
        step_width=float(feet.place[0, 0] - feet.place[1, 0]),
        toe_out=(float(feet.heading[0]), float(-feet.heading[1])),
        notes=tuple(notes),
    )


def _phases(span: Span, duration: float, notes: list[str]) -> Float[np.ndarray, "2 4"]:
    """Events as stride phases of the foot that begins the stride, that foot first."""
    begin = span.first.heel_strike
    own = (np.array(span.first.times) - begin) / duration
    other = (np.array(span.between.times) - begin) / duration
    stretched = False
    for late, strike in ((own, other[0]), (other, 1.0)):
        if late[3] < strike + _DOUBLE:
            late[3], stretched = strike + _DOUBLE, True
    if stretched:
        notes.append("double support was under 4 % of the stride: stretched to that")
    for foot in (own, other):  # events that fall together are set apart
        for i in (1, 2):
            foot[i] = max(foot[i], foot[i - 1] + _APART)
        for i in (2, 1):
            foot[i] = min(foot[i], foot[i + 1] - _APART)
    return np.stack([own, other]) % 1.0


def _from_left(cycle: Cycle, first: int) -> Cycle:
    """A loop whose first events are those of foot ``first``, begun at a left heel strike."""
    if first == LEFT:
        return cycle
    start = float(cycle.events[1, 0])
    phase = start + np.arange(len(cycle.center)) * (cycle.strides / len(cycle.center))
    center, turned = cycle.at(phase)
    events = (cycle.events[::-1] - start) % 1.0
    events[0, 0] = 0.0
    return cycle.with_(center=center, rotations=turned, events=events)


def without_shaking(path: Float[np.ndarray, "K c"], strides: int) -> Float[np.ndarray, "K c"]:
    """A loop of ``strides`` strides without what is faster than bodies move."""
    harmonics = np.fft.rfft(path, axis=0)[: HARMONICS * strides + 1]
    return np.fft.irfft(harmonics, len(path), axis=0)


def _legs_every_stride(cycle: Cycle) -> Cycle:
    """Hips and legs of a loop of two strides averaged over both, so that they repeat."""
    half = len(cycle.center) // 2
    center, turned = np.array(cycle.center), np.array(cycle.rotations)
    center[:half] = center[half:] = 0.5 * (center[:half] + center[half:])
    for joint, name in enumerate(cycle.skeleton.names):
        if name == "hips" or name.endswith(("Leg", "Foot", "Toes")):
            turned[:half, joint] = average(turned[:half, joint], turned[half:, joint])
            turned[half:, joint] = turned[:half, joint]
    return cycle.with_(center=center, rotations=turned)


def symmetrized(cycle: Cycle) -> Cycle:
    """The average of ``cycle`` and its mirror image half a stride later."""
    right = float(cycle.events[1, 0])
    count = len(cycle.center)
    phase = np.arange(count) * (cycle.strides / count)

    def even(at: Float[np.ndarray, "n"]) -> tuple[np.ndarray, np.ndarray]:
        """The loop re-timed so that the right heel strikes at one half."""
        whole, part = np.floor(at), at % 1.0
        own = np.interp(part, [0.0, 0.5, 1.0], [0.0, right, 1.0])
        return cycle.at(whole + own)

    center, turned = even(phase)
    other_center, other = even(phase + 0.5)
    other = mirrored(cycle.skeleton, other)
    since = (cycle.events - cycle.events[:, :1]) % 1.0
    events = since.mean(axis=0)
    return cycle.with_(
        center=0.5 * (center + other_center * [-1.0, 1.0, 1.0]),
        rotations=average(other, turned),
        events=np.stack([events, (events + 0.5) % 1.0]),
    )


@dataclass(frozen=True, eq=False)
class Standing:
    """How the feet of a stride stand: ``place`` (side, [x, z]) of N, ``heading``, ``height``."""

    place: Float[np.ndarray, "2 2"]
    heading: Float[np.ndarray, "2"]
    height: float

    def moved(self, by: Float[np.ndarray, "3"]) -> Standing:
        """Of the same stride with its center moved."""
        return Standing(self.place + by[[0, 2]], self.heading, self.height + float(by[1]))


def standing_feet(cycle: Cycle, *, stride_length: float | None = None) -> Standing:
    """Where and how both feet stand flat in ``cycle``, meters and radians.

    N of the left foot's stance at stride phase 0, of the right one's within the same stride;
    ``height`` is that of the soles, the mean of both feet. ``stride_length``: instead of the
    cycle's own.
    """
    count = len(cycle.center) // cycle.strides
    ankles, soles = cycle.feet
    # a stance may begin in this stride and end in the next
    phase = np.arange(2 * count) / count
    length = cycle.stride_length if stride_length is None else stride_length
    ahead = (phase * length)[:, None, None] * np.array([0.0, 0.0, 1.0])
    ankles = np.concatenate([ankles, ankles]) + ahead
    soles = np.concatenate([soles, soles]) + ahead[..., None, :]
    place, heading, heights = np.empty((2, 2)), np.empty(2), np.empty(2)
    for side in range(len(SIDES)):
        strike, flat, off, _ = cycle.events[side]
        begin = strike + (flat - strike) % 1.0
        stands = (phase >= begin) & (phase <= begin + (off - flat) % 1.0)
        heel, ball = soles[stands, side, HEEL], soles[stands, side, BALL]
        along = (ball - heel) / np.linalg.norm(ball - heel, axis=-1, keepdims=True)
        ankle = ankles[stands, side]
        n = heel + ((ankle - heel) * along).sum(-1, keepdims=True) * along
        place[side] = n.mean(0)[[0, 2]]
        heading[side] = np.arctan2(along[:, 0].mean(), along[:, 2].mean())
        heights[side] = np.minimum(heel, ball)[:, 1].mean()
    return Standing(place, heading, float(heights.mean()))
