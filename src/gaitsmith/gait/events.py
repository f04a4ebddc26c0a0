"""Heel strike, foot flat, heel off and toe-off of both feet, from the paths of their points.

Robust to sliding feet, 30 Hz clips, drifting floors and styles that land flat or on the toes:
speeds are compared with the walk's own, heights with those of the same stance. Nothing is
tuned to one rig.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.curves import hermite, parabola_slopes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

#: Frames per second at which events are looked for, at least.
RATE = 120.0
#: Leg length (hip to ankle), meters, for which the heights below hold.
_LEG = 0.83
#: A foot bears from where its slower end falls below the first share of the walking speed to
#: where it rises above the second.
_ON, _OFF = 0.35, 0.60
#: Shares of the walking speed at which a landing point stops, and at which the tip of the toes
#: (the ball, where the toes are not known) leaves. Toe-offs are then within 15 ms of the force
#: plates' (Rajagopal 2016, the CSU treadmill) and of the contacts published for Winter's subject.
_LANDS, _TIP_LEAVES, _BALL_LEAVES = 0.5, 0.75, 1.4
#: Seconds from when a landing point has stopped to when it bears, on the average of the same
#: ten heel strikes (-20 to +28 ms about it).
_LOADED = 0.012
#: Seconds without ground that may be an error of the events; longer ones are flight.
_FLIGHT = 0.03
#: Seconds: shorter gaps in a stance are filled, shorter stances are none.
_GAP, _SHORTEST = 0.08, 0.12
#: A foot that bears again within this many seconds and meters has not stepped.
_TWITCH, _SAME_PLACE = 0.3, 0.06


@dataclass(frozen=True, eq=False)
class FootPath:
    """Points of one foot over time, meters: ``(F, 3)`` each; the tip of the toes if known."""

    ankle: Float[np.ndarray, "F 3"]
    heel: Float[np.ndarray, "F 3"]
    ball: Float[np.ndarray, "F 3"]
    tip: Float[np.ndarray, "F 3"] | None = None

    def resampled(self, at: Float[np.ndarray, "n"]) -> FootPath:
        """The same paths at frames ``at``, fractions of frames too, by the cubic."""
        frames = np.arange(len(self.ankle), dtype=np.float64)

        def read(path: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "n 3"]:
            return hermite(frames, path, parabola_slopes(frames, path), at)

        tip = None if self.tip is None else read(self.tip)
        return FootPath(read(self.ankle), read(self.heel), read(self.ball), tip)


@dataclass(frozen=True)
class Stance:
    """One foot on the ground: its events in seconds, and whether the clip holds it whole.

    Attributes
    ----------
    side
        0 left, 1 right.
    heel_strike, foot_flat, heel_off, toe_off
        Seconds from the clip's first frame.
    cut
        Which ends the clip does not show: ``""``, ``"start"``, ``"end"`` or ``"both"``.
    """

    side: int
    heel_strike: float
    foot_flat: float
    heel_off: float
    toe_off: float
    cut: str = ""

    @property
    def times(self) -> tuple[float, float, float, float]:
        """Heel strike, foot flat, heel off, toe-off, seconds."""
        return self.heel_strike, self.foot_flat, self.heel_off, self.toe_off


def stances(
    feet: dict[int, FootPath], rate: float, *, speed: float, leg_length: float
) -> list[Stance]:
    """Every stance of the feet, in order of heel strike.

    Parameters
    ----------
    feet
        Paths by side (0 left, 1 right); one side alone will do.
    rate
        Frames per second.
    speed
        Of the walk, m/s: what "still" is compared with.
    leg_length
        Hip to ankle, meters.
    """
    found: list[Stance] = []
    for side, foot in feet.items():
        found += _of_foot(side, foot, rate, speed, leg_length / _LEG)
    return sorted(found, key=lambda s: s.heel_strike)


def check_order(found: Sequence[Stance]) -> None:
    """Raise InfeasibleError if stances of two feet do not alternate, or flight comes between."""
    for one, two in pairwise(found):
        if one.side == two.side:
            raise InfeasibleError(
                f"the feet do not alternate: the {SIDES[one.side]} foot lands at "
                f"{one.heel_strike:.2f} s and again at {two.heel_strike:.2f} s; cut the clip to "
                "straight walking, or give the events (--events)"
            )
        if two.heel_strike > one.toe_off + _FLIGHT:
            raise InfeasibleError(
                f"nobody is on the ground from {one.toe_off:.2f} to {two.heel_strike:.2f} s: "
                "this is running, which is not learned"
            )


def _speed(path: Float[np.ndarray, "n 3"], rate: float) -> Float[np.ndarray, "n"]:
    return np.linalg.norm(np.gradient(path, axis=0), axis=-1) * rate


def _of_foot(side: int, foot: FootPath, rate: float, speed: float, scale: float) -> list[Stance]:
    factor = max(1.0, np.ceil(RATE / rate - 1e-9))
    fine = rate * factor
    count = len(foot.ankle)
    foot = foot.resampled(np.arange((count - 1) * factor + 1) / factor)
    slow = np.minimum(_speed(foot.ankle, fine), _speed(foot.ball, fine)) / speed
    out: list[Stance] = []
    for first, last in _stepped(_blocks(slow, fine), foot.ball[:, [0, 2]], fine, scale):
        frames = _events_of_block(foot, first, last, fine, speed, scale)
        times = [float(f) / fine for f in frames]
        if first > 0:
            times[0] = min(times[0] + _LOADED, times[1])
        cut = {(True, True): "both", (True, False): "start", (False, True): "end"}
        ends = (first == 0, last == len(slow))
        out.append(Stance(side, times[0], times[1], times[2], times[3], cut.get(ends, "")))
    return out


def _blocks(slow: Float[np.ndarray, "n"], rate: float) -> list[tuple[int, int]]:
    """Runs ``[first, last)`` in which the foot bears, by hysteresis."""
    on, off = slow < _ON, slow > _OFF
    # the last decisive frame before each frame tells
    mark = np.where(on, 1, np.where(off, -1, 0))
    mark[0] = mark[0] if mark[0] else (1 if slow[0] < 0.5 * (_ON + _OFF) else -1)
    latest = np.maximum.accumulate(np.where(mark != 0, np.arange(len(mark)), 0))
    state = mark[latest] > 0
    edges = np.flatnonzero(np.diff(np.concatenate([[0], state.astype(np.int8), [0]])))
    runs = [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
    joined: list[tuple[int, int]] = []
    for a, b in runs:
        if joined and a - joined[-1][1] < _GAP * rate:
            joined[-1] = (joined[-1][0], b)
        else:
            joined.append((a, b))
    return [(a, b) for a, b in joined if b - a >= _SHORTEST * rate or a == 0 or b == len(slow)]


def _stepped(
    blocks: list[tuple[int, int]], ball: Float[np.ndarray, "n 2"], rate: float, scale: float
) -> list[tuple[int, int]]:
    """Blocks joined where the foot stands on where it stood: that was noise, no step."""
    out: list[tuple[int, int]] = []
    for first, last in blocks:
        if out and first - out[-1][1] < _TWITCH * rate:
            there, here = (np.median(ball[a:b], axis=0) for a, b in (out[-1], (first, last)))
            if np.linalg.norm(here - there) < _SAME_PLACE * scale:
                out[-1] = (out[-1][0], last)
                continue
        out.append((first, last))
    return out


def _events_of_block(
    foot: FootPath, first: int, last: int, rate: float, speed: float, scale: float
) -> tuple[int, int, int, int]:
    """Frames of the four events of the stance in ``[first, last)``."""
    heel, ball = foot.heel[:, 1], foot.ball[:, 1]
    heel_speed, ball_speed = _speed(foot.heel, rate) / speed, _speed(foot.ball, rate) / speed
    low_heel, low_ball = heel[first:last].min(), ball[first:last].min()
    landed = (heel_speed < _LANDS) & (heel < low_heel + 0.025 * scale)
    landed |= (ball_speed < _LANDS) & (ball < low_ball + 0.015 * scale)
    strike = first
    while strike > 0 and first - strike < 0.25 * rate and landed[strike - 1]:
        strike -= 1
    down = (
        (ball[strike:last] < low_ball + 0.0075 * scale)
        & (heel[strike:last] < low_heel + 0.015 * scale)
        & (ball_speed[strike:last] < 0.35)
    )
    if down.any():
        flat = strike + int(down.argmax())
    else:
        half = strike + max(1, (last - strike) // 2)
        flat = strike + int(foot.ankle[strike:half, 1].argmin())
    raised = heel[flat:last] > heel[flat:last].min() + 0.015 * scale
    up = np.flatnonzero(~raised)
    heel_off = flat + (int(up[-1]) + 1 if len(up) else 0)
    if foot.tip is None:
        leaves, limit = ball_speed, _BALL_LEAVES
    else:
        leaves, limit = _speed(foot.tip, rate) / speed, _TIP_LEAVES
    toe_off = min(last + round(0.15 * rate), len(heel) - 1)
    while toe_off > flat and leaves[toe_off] > limit:
        toe_off -= 1
    return strike, flat, min(heel_off, toe_off), toe_off
