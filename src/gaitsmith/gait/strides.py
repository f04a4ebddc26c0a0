"""Strides of a clip that could be learned: whole, straight ahead, walked; and the best of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.events import Stance, check_order
from gaitsmith.gait.loop import read_pose
from gaitsmith.geometry.rotations import inverse, log, multiply, rotate

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.motion.motion import Motion

#: Radians that a stride may turn and still be straight.
_TURNS = float(np.radians(20.0))
#: Double support, share of the stride, below which the hips must not be higher than over the
#: feet by so many leg lengths.
_BRIEF, _VAULT = 0.04, 0.01
#: Leg lengths that a stride must get ahead.
_SHORTEST = 0.15
#: Radians of gap that a hundredth off the usual pace weighs as much as.
_ODD = 0.12


@dataclass(eq=False)
class Clip:
    """A person's motion over ground, with what is needed over and over."""

    motion: Motion
    body: Body
    soles: Float[np.ndarray, "F 2 3 3"]
    speed: float
    stances: list[Stance]

    def foot(self, stance: Stance) -> Float[np.ndarray, "3"]:
        """Where the ball stands during a stance, meters."""
        rate = self.motion.fps
        a, b = round(stance.foot_flat * rate), round(stance.heel_off * rate)
        return self.soles[a : max(b, a) + 1, stance.side, BALL].mean(0)

    def length(self, first: Stance, last: Stance) -> float:
        """From where one stands to where the other does, over the ground, meters."""
        return float(np.linalg.norm((self.foot(last) - self.foot(first))[[0, 2]]))

    def heading(self, time: float) -> float:
        """Of the pelvis."""
        _, turned = read_pose(self.motion, np.array([time]))
        left = rotate(turned[0, 0], np.array([1.0, 0.0, 0.0]))
        return float(np.arctan2(-left[2], left[0]))


@dataclass(frozen=True)
class Span:
    """A stride that could be taken: from one stance to the next of the same foot."""

    first: Stance
    last: Stance
    between: Stance

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.last.heel_strike - self.first.heel_strike

    @property
    def blend(self) -> float:
        """Seconds of the shorter of its two stances of one foot."""
        return min(s.toe_off - s.heel_strike for s in (self.first, self.last))


def spans_of(found: Sequence[Stance]) -> list[Span]:
    """Every stride of either foot that the clip holds up to its last toe-off."""
    out: list[Span] = []
    trouble: InfeasibleError | None = None
    for i, first in enumerate(found):
        rest = found[i : i + 3]
        if first.cut in ("start", "both") or len(rest) < 3 or rest[2].cut:
            continue
        try:
            check_order(rest)
        except InfeasibleError as error:
            trouble = error
            continue
        out.append(Span(rest[0], rest[2], rest[1]))
    if out:
        return out
    if trouble is not None:
        raise trouble
    known = "; ".join(f"{SIDES[s.side]} {s.heel_strike:.2f}-{s.toe_off:.2f} s" for s in found)
    raise InfeasibleError(
        "the clip holds no 1.6 strides of walking: from one heel strike to the toe-off after the "
        f"next one of the same foot. Feet on the ground: {known or 'none found'}"
    )


def straight(clip: Clip, spans: list[Span], notes: list[str]) -> list[Span]:
    """Those that lead straight ahead."""
    good: list[Span] = []
    why: list[str] = []
    for span in spans:
        way = (clip.foot(span.last) - clip.foot(span.first)) * [1.0, 0.0, 1.0]
        length = float(np.linalg.norm(way))
        start, end = (clip.heading(s.heel_strike) for s in (span.first, span.last))
        turn = float(np.angle(np.exp(1j * (end - start))))
        aside = float(np.arctan2(way[0], way[2])) - 0.5 * turn - start
        aside = abs(float(np.angle(np.exp(1j * aside))))
        if length < _SHORTEST * clip.body.leg_length:
            why.append(f"a stride of {length:.2f} m gets nowhere")
        elif aside > 2.0:
            why.append("it walks backward (or left and right are exchanged in its joints' names)")
        elif aside > 0.7:
            why.append("it walks sideways")
        elif abs(turn) > _TURNS:
            why.append(f"it turns by {np.degrees(abs(turn)):.0f} deg in a stride")
        else:
            good.append(span)
    if not good:
        raise InfeasibleError(
            f"no straight, forward stride to learn from: {why[0]}; cut the clip to straight walking"
        )
    if why:
        notes.append(f"{len(why)} of {len(spans)} strides left out: {why[0]}")
    return good


def walked(clip: Clip, spans: list[Span]) -> list[Span]:
    """Those in which nobody runs: who hardly has both feet down, and vaults between them, does.

    Walkers are highest over a bearing foot, runners between two.
    """
    good: list[Span] = []
    for span in spans:
        one, two, three = span.first, span.between, span.last
        both = (one.toe_off - two.heel_strike, two.toe_off - three.heel_strike)
        between = [0.5 * (a.toe_off + b.heel_strike) for a, b in ((one, two), (two, three))]
        over = [0.5 * (s.heel_strike + s.toe_off) for s in (one, two)]
        position, _ = read_pose(clip.motion, np.array([*between, *over]))
        vault = position[:2, 1].mean() - position[2:, 1].mean()
        if min(both) >= _BRIEF * span.duration or vault < _VAULT * clip.body.leg_length:
            good.append(span)
    if not good:
        raise InfeasibleError(
            "the hips fly from foot to foot, which are hardly ever both on the ground: this is "
            "running, which is not learned"
        )
    return good


def gap_between(clip: Clip, first: Stance, last: Stance, names: Sequence[str]) -> float:
    """Largest angle between the poses of two heel strikes, radians."""
    _, turned = read_pose(clip.motion, np.array([first.heel_strike, last.heel_strike]))
    joints = [clip.motion.skeleton.index(n) for n in names]
    apart = log(multiply(inverse(turned[0, joints]), turned[1, joints]))
    return float(np.linalg.norm(apart, axis=-1).max())


def score(clip: Clip, span: Span, spans: list[Span]) -> float:
    """How ill a stride closes and how unusual it is."""
    gap = gap_between(clip, span.first, span.last, clip.motion.skeleton.names[1:])
    turn = clip.heading(span.last.heel_strike) - clip.heading(span.first.heel_strike)
    turn = abs(float(np.angle(np.exp(1j * turn))))
    times = np.array([s.duration for s in spans])
    lengths = np.array([np.linalg.norm(clip.foot(s.last) - clip.foot(s.first)) for s in spans])
    own = spans.index(span)
    odd = sum(abs(v[own] / float(np.median(v)) - 1.0) for v in (times, lengths, lengths / times))
    return gap + turn + 100.0 * _ODD * odd
