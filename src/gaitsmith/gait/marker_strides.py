"""The strides that markers show: stances of the feet, and which stride to take."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.events import FootPath, Stance, check_order, stances
from gaitsmith.geometry.curves import hermite, parabola_slopes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.gait.marker_body import FlatFoot
    from gaitsmith.gait.marker_joints import MarkerLeg, MarkerWalker

#: Share of a stride after it that is best in the clip too, to be blended in.
_AFTER = 0.6
#: Leg lengths that a stride gets ahead at least, and radians that it turns at most.
_LEAST, _TURNS = 0.15, float(np.radians(20.0))
#: Seconds without ground that may be an error of the events.
_FLIGHT = 0.03


@dataclass(frozen=True)
class Span:
    """A stride that could be taken, from one heel strike to the next of the same foot."""

    side: int
    begin: float
    end: float

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.end - self.begin


@dataclass(eq=False)
class MarkerClip:
    """Who wears the markers, the stances found, and how each foot stands flat."""

    walker: MarkerWalker
    found: list[Stance]
    feet: dict[int, FlatFoot]

    @property
    def last(self) -> float:
        """Seconds of the last frame."""
        return (len(self.leg.hip) - 1) / self.walker.rate

    @property
    def leg(self) -> MarkerLeg:
        """One of the legs."""
        return next(iter(self.walker.legs.values()))


def stances_of(walker: MarkerWalker, events: Sequence[Stance] | None) -> list[Stance]:
    """Stances of the feet in order of heel strike: those given, else those found."""
    legs = walker.legs
    if events is None:
        paths = {s: FootPath(g.ankle, g.heel, g.ball, g.tip) for s, g in legs.items()}
        length = float(np.mean([g.length for g in legs.values()]))
        return stances(paths, walker.rate, speed=walker.speed, leg_length=length)
    found = sorted(events, key=lambda s: s.heel_strike)
    if other := [s for s in found if s.side not in legs]:
        raise InfeasibleError(
            f"the events are of the {SIDES[other[0].side]} foot, whose markers are not here"
        )
    return found


def spans_of(found: list[Stance], walker: MarkerWalker) -> list[Span]:
    """Every stride of either foot of which all events are known."""
    # whose heel strike the clip does not show has no place in the order of heel strikes
    shown = [s for s in found if s.cut not in ("start", "both")]
    if len(walker.legs) == 2:
        check_order(shown)
    out: list[Span] = []
    for side in walker.legs:
        own = [s for s in shown if s.side == side]
        out += [Span(side, a.heel_strike, b.heel_strike) for a, b in pairwise(own)]
        if len(walker.legs) == 1:
            _check_duty(own)
    if out and all(known(found, side, event) for side in walker.legs for event in (0, 3)):
        return out
    seen = "; ".join(
        f"{SIDES[s.side]} {s.heel_strike:.2f}-{s.toe_off:.2f} s"
        + (f" (cut at {s.cut})" if s.cut else "")
        for s in found
    )
    raise InfeasibleError(
        "the markers hold no stride: from one heel strike to the next of the same foot, with every "
        f"toe-off between. Feet on the ground: {seen or 'none found'}. Give a longer clip (1.6 "
        "strides), or the events if they are known (--events)"
    )


def _check_duty(own: list[Stance]) -> None:
    """Raise InfeasibleError if a foot that both feet are like bears less than half the time."""
    for one, two in pairwise(own):
        stride = two.heel_strike - one.heel_strike
        if not one.cut and one.toe_off - one.heel_strike < 0.5 * stride - _FLIGHT:
            raise InfeasibleError(
                f"the foot bears for {one.toe_off - one.heel_strike:.2f} s of a stride of "
                f"{stride:.2f} s: with less than half of it this is running, which is not learned"
            )


def known(found: list[Stance], side: int, event: int) -> list[float]:
    """Times of an event of a foot, of those stances that show it."""
    hidden = ("start", "both") if event < 2 else ("end", "both")
    return [s.times[event] for s in found if s.side == side and s.cut not in hidden]


def _place(clip: MarkerClip, side: int, strike: float) -> Float[np.ndarray, "3"] | None:
    """Where the ball of the foot stands after it struck, meters; None if the clip ends before."""
    stance = next(s for s in clip.found if s.side == side and s.heel_strike == strike)
    rate = clip.walker.rate
    a, b = stance.foot_flat, min(stance.heel_off, clip.last)
    if b - a < 0.1:
        return None
    return clip.walker.legs[side].ball[round(a * rate) : round(b * rate) + 1].mean(0)


def way_of(clip: MarkerClip, span: Span) -> Float[np.ndarray, "3"]:
    """How far the foot gets in a stride: where it stands, else where its heel strikes."""
    first, last = (_place(clip, span.side, t) for t in (span.begin, span.end))
    if first is None or last is None:
        heel = clip.walker.legs[span.side].heel
        first, last = read(heel, np.array([span.begin, span.end]) * clip.walker.rate)
    return last - first


def is_straight(clip: MarkerClip, span: Span) -> bool:
    """Whether a stride gets ahead, and the hips face one way at its ends."""
    if way_of(clip, span)[2] < _LEAST * clip.leg.length:
        return False
    legs = clip.walker.legs
    if len(legs) < 2 or clip.walker.flat:
        return True
    at = np.array([span.begin, span.end]) * clip.walker.rate
    across = read(legs[LEFT].hip - legs[RIGHT].hip, at)
    first, last = np.arctan2(-across[:, 2], across[:, 0])
    return bool(abs(np.angle(np.exp(1j * (last - first)))) < _TURNS)


def read(values: Float[np.ndarray, "F C"], at: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n C"]:
    """Values at frames ``at``, fractions of frames too, by the cubic."""
    frames = np.arange(len(values), dtype=np.float64)
    return hermite(frames, values, parabola_slopes(frames, values), at)


def score(clip: MarkerClip, span: Span, usual: float) -> float:
    """How ill a stride closes and how unusual it is."""
    ends = np.array([span.begin, span.end]) * clip.walker.rate
    gap = 0.0
    for leg in clip.walker.legs.values():
        shape = np.concatenate([leg.knee - leg.hip, leg.ankle - leg.hip], axis=-1)
        one, two = read(shape, ends)
        gap = max(gap, float(np.abs(two - one).max()) / leg.length)
    early = max(0.0, _AFTER - (clip.last - span.end) / span.duration)
    return gap + 4.0 * abs(span.duration / usual - 1.0) + 0.02 * early
