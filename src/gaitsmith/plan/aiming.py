"""Where the next step of the walk's line leads: towards a heading, or along a path, [SM01] 6.1."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.angles import wrapped
from gaitsmith.plan.course import NO_TURN
from gaitsmith.plan.follow import FREE_RADIUS, LENGTH_SHARE
from gaitsmith.plan.lengths import FIRST_STEP, stride_lengths

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.plan.landing import Landing
    from gaitsmith.plan.paths import Path

#: Part of a step's direction that leads from where the person is to the path; the paper's rule
#: has none of it, and drifts.
FEEDBACK = 0.8
#: The closest point of the path is sought so far (m) behind and ahead of the last one, so that
#: a path may cross itself.
BEHIND, AHEAD = 0.3, 1.5
#: Two chords of the path turn by no more than this (radians), or steps get shorter, in parts of
#: the leg, from the longest to the shortest.
LARGEST_TURN = float(np.radians(35.0))
LONGEST, PART, SHORTEST = 1.3, 0.02, 0.25
#: A turn grows by so much from one step to the next, radians.
TURN_GROWS = float(np.radians(25.0))
#: Turns that are still to be made (radians) from which steps get shorter, and at which they are
#: as short as they get: who turns round does so nearly on the spot.
SPOT = (float(np.radians(80.0)), float(np.radians(160.0)))
#: The same where a path is to be kept to: corners are gone round by short steps.
CORNER = (float(np.radians(28.0)), float(np.radians(55.0)))
#: Last step before the feet are closed over the others.
LAST_STEP = 0.7
#: Change of step length over the leg from one step to the next.
LENGTH_CHANGES = 0.3
#: A goal so near (over the leg) has been reached: nobody makes a smaller step to it.
REACHED = 0.08


@dataclass(frozen=True)
class Wish:
    """What is wished of the next steps.

    Attributes
    ----------
    length, duration
        Of a step on straight level ground, meters and seconds.
    heading
        Where to, radians; None: along the path, or straight on where there is none.
    stop
        Come to stand, feet side by side.
    keep_duration, keep_length
        Curves and slopes change the lengths alone; slopes do not change them.
    """

    length: float
    duration: float
    heading: float | None = None
    stop: bool = False
    keep_duration: bool = False
    keep_length: bool = False


@dataclass(frozen=True)
class Chord:
    """One step of the line, straight from point to point.

    ``slower``: how much longer it takes for its turn; ``last``: the goal is at its end.
    """

    way: float
    length: float
    slower: float
    turn: float
    last: bool


class Aiming:
    """Gives one chord of the line after the other.

    Parameters
    ----------
    body
        Who walks.
    path
        What is followed when no heading is wished.
    paper
        By the paper's rule, without feedback.
    """

    def __init__(self, body: Body, path: Path | None, *, paper: bool) -> None:
        self._body, self._path, self._paper = body, path, paper

    def chord(self, last: Landing, wish: Wish) -> Chord:
        """The next step of the line from beside ``last``, on level ground.

        Along the path it goes to the point a step ahead, [SM01] section 6.1, with feedback: most
        of its direction is that from where the person is.
        """
        leg = self._body.leg_length
        usual = FIRST_STEP * wish.length if last.stands else wish.length
        low = last.length - LENGTH_CHANGES * leg if not last.stands else 0.0
        high = last.length + LENGTH_CHANGES * leg if not last.stands else np.inf
        length = float(np.clip(usual, low, high))
        if wish.heading is not None or self._path is None:
            way = last.way if wish.heading is None else wish.heading
            return self._turned(last, way, length, wish)
        level = self._shorter(last.along, length)
        chord = self._turned(last, self._aim(last, level), level, wish)
        # turning shortens the step: it is aimed at where it then ends
        aimed = self._turned(last, self._aim(last, chord.length), level, wish)
        return replace(chord, way=aimed.way, turn=aimed.turn)

    def _turned(self, last: Landing, way: float, length: float, wish: Wish) -> Chord:
        """The step that turns towards ``way`` as far as one step does, shorter for it."""
        leg = self._body.leg_length
        missing = wrapped(way - last.way)
        most = min(LARGEST_TURN, TURN_GROWS + max(0.0, last.turn * np.sign(missing)))
        if wish.stop:
            most = min(most, 0.5 * LARGEST_TURN)
        turn = float(np.clip(missing, -most, most))
        turn = 0.0 if abs(turn) < NO_TURN else turn
        power = 1.0 if wish.keep_duration else LENGTH_SHARE
        slow = min(1.0, (length / (max(abs(turn), NO_TURN) * FREE_RADIUS)) ** (1.0 / 3.0))
        least = min(length, SHORTEST * leg)
        low, high = SPOT if wish.heading is not None else CORNER
        spot = float(np.clip((high - abs(missing)) / (high - low), 0.0, 1.0))
        length = max(length * slow**power, least)
        length = least + spot * (length - least)
        ends = False
        if wish.stop:
            length, ends = max(LAST_STEP * length, least), True
        elif wish.heading is None and self._path is not None:
            rest = self._path.length - last.along
            if rest < 4.0 * length:
                parts = stride_lengths(max(rest, 1e-3), length, "walk", "stand")
                length, ends = min(parts[0], length), len(parts) == 1
        return Chord(last.way + turn, float(length), float(slow ** (power - 1.0)), turn, ends)

    def arrived(self, last: Landing) -> bool:
        """Whether the path ends beside ``last``, or nearly."""
        return (
            self._path is not None
            and self._path.length - last.along < REACHED * self._body.leg_length
        )

    def closest(self, line: Float[np.ndarray, "2"], near: float) -> float:
        """Arc length of the path's point closest to ``line``, not far from ``near``."""
        if self._path is None:
            return near
        low, high, best = max(near - BEHIND, 0.0), near + AHEAD, near
        for _ in range(3):  # 2 cm, 1 mm, 0.05 mm
            s = np.linspace(low, high, 91)
            best = float(s[((self._path.at(s) - line) ** 2).sum(-1).argmin()])
            reach = 2.0 * (high - low) / 90.0
            low, high = max(best - reach, 0.0), best + reach
        return best

    def _aim(self, last: Landing, length: float) -> float:
        """Direction of the next step along the path."""
        assert self._path is not None
        s = last.along
        here, there = self._path.at(np.array([s, s + length]))
        chord = _heading(there - here)
        if self._paper:  # psi is the body's heading at once: the step goes between two of them
            return chord + 0.5 * wrapped(self.paper_heading(s + length, length, chord) - chord)
        return chord + FEEDBACK * wrapped(_heading(there - last.line) - chord)

    def paper_heading(self, along: float, length: float, near: float) -> float:
        """[SM01] section 6.1: the direction from the path's point at ``along`` a step ahead."""
        assert self._path is not None
        ends = self._path.at(np.array([along, along + length]))
        return near + wrapped(_heading(ends[1] - ends[0]) - near)

    def _shorter(self, along: float, length: float) -> float:
        """SL_max of [SM01] section 6.1: shorter steps where two of them would turn too far."""
        assert self._path is not None
        leg = self._body.leg_length
        tried = np.arange(min(LONGEST * leg, length), SHORTEST * leg, -PART * leg)
        if not len(tried):
            return length
        points = self._path.at((along + np.arange(3)[:, None] * tried).ravel()).reshape(3, -1, 2)
        chords = np.diff(points, axis=0)
        way = np.arctan2(chords[..., 0], chords[..., 1])
        turn = np.abs(wrapped(way[1] - way[0]))
        fits = turn < LARGEST_TURN
        return float(tried[fits.argmax()]) if fits.any() else SHORTEST * leg


def _heading(vector: Float[np.ndarray, "2"]) -> float:
    return float(np.arctan2(vector[0], vector[1]))
