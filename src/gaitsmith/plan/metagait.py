"""MetaGait, [SM01] section 6: where the next feet go, seen from no more than two steps ahead.

What it is told may change with every step: a path or a heading, a pace, a stop. Nothing is
planned beyond what is looked at, so the same controller walks a path and obeys a hand.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, leftward
from gaitsmith.geometry.angles import wrapped
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.plan.course import NO_TURN, course_change, lean_lever, lean_tangent
from gaitsmith.plan.follow import FREE_RADIUS, LENGTH_SHARE, WIDENED
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.landing import LandingSearch
from gaitsmith.plan.lengths import EASED_DURATION, FIRST_STEP, stride_lengths

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground
    from gaitsmith.plan.lengths import Stance
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.start import Start

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
#: [SM01] section 6.1: from the first angle on feet point into the turn, by the second at most. The
#: paper's 45 deg are never reached here, steps turn by 40 at most.
TOE_OUT_FROM, TOE_OUT_MOST = float(np.radians(25.0)), float(np.radians(25.0))
#: Part of it for the foot inside of which the other one passes: toes in, it would be hit.
TOE_IN = 0.5
#: The pelvis turns so far beyond the foot that bears, radians (people's hips: 45 deg).
HIP_ROTATION = float(np.radians(38.0))
#: Who starts with a turn of more than this (radians) to the left starts with the left foot.
INSIDE = 0.1
#: Last step before the feet are closed over the others.
LAST_STEP = 0.7
#: Change of step length over the leg, and of duration, from one step to the next.
LENGTH_CHANGES, DURATION_CHANGES = 0.3, 1.25
#: Axes of feet are set so far apart (m), by moving one outward in so many such parts.
APART, APART_PART, APART_MOST = 0.07, 0.01, 12
#: So much farther (m) in a turn of this angle (radians).
APART_TURNING, APART_TURN = 0.025, float(np.radians(25.0))
#: Largest change of the walk's direction from one footstep to the next, radians.
LARGEST_CHANGE = float(np.radians(40.0))
#: How far the feet come across as the lean changes, over the step width.
ACROSS = 0.9
#: Largest turn of the face beyond the walk, radians.
GAZE = float(np.radians(35.0))
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


@dataclass(frozen=True, eq=False)
class Landing:
    """A foot where it stands or will stand, and the step that sets it there.

    Attributes
    ----------
    kind
        Of that step; ``"stand"`` for feet that nobody set.
    side, position, heading
        0 left, 1 right; ``(3,)`` N; of the foot, radians.
    line, direction, way
        ``(2,)`` x,z of the walk's line beside it; direction of that line here; direction of the
        chord that led here, radians.
    middle, lean, gaze
        As in :class:`~gaitsmith.plan.footsteps.Footstep`; the gaze is beyond ``direction``.
    length, duration, period
        Of the step, meters and seconds; seconds it would take in mid-walk.
    along
        Arc length of the path beside it, meters.
    closes
        The other foot is to be set beside it.
    """

    kind: StepKind
    side: int
    position: Float[np.ndarray, "3"]
    heading: float
    line: Float[np.ndarray, "2"]
    direction: float
    way: float
    middle: Float[np.ndarray, "2"]
    lean: float = 0.0
    gaze: float = 0.0
    length: float = 0.0
    duration: float = 0.0
    period: float = 0.0
    along: float = 0.0
    turn: float = 0.0
    closes: bool = False

    @property
    def stands(self) -> bool:
        """Whether both feet stand once it has landed."""
        return self.kind in ("stand", "stop")


@dataclass(frozen=True)
class _Chord:
    """One step of the line, straight from point to point.

    ``slower``: how much longer it takes for its turn; ``last``: the goal is at its end.
    """

    way: float
    length: float
    slower: float
    turn: float
    last: bool


class MetaGait:
    """Gives the next footsteps of a person, from where the feet are and what is wished.

    Parameters
    ----------
    body, stance
        Who walks, and how the feet are set.
    ground
        What is walked on: footsteps get its height, slopes shorten them ([SM01] Eqs. 11-12),
        where it jumps they are set where a whole sole stands.
    path
        What is followed when no heading is wished; it goes straight on beyond its end, where the
        person stops.
    outside
        Feet are set outside of curves by what the body leans inside.
    paper
        The paper's own rule, which looks at two points of the path and never at the distance
        to it. It drifts: by 0.3 m in three seconds on a circle of 3 m.
    """

    def __init__(
        self,
        body: Body,
        stance: Stance,
        ground: Ground,
        *,
        path: Path | None = None,
        outside: bool = True,
        paper: bool = False,
    ) -> None:
        self._body, self._stance, self._path, self._paper = body, stance, path, paper
        self._search = LandingSearch(body, ground)
        self._lever = lean_lever(body) if outside else 0.0

    # ----------------------------------------------------------------------- asking

    def standing(self, start: Start) -> list[Landing]:
        """The feet of who stands at ``start``, [left, right]."""
        held = start.footholds(self._body, self._stance)
        out = []
        middle = 0.5 * (held[LEFT][0] + held[RIGHT][0])
        for side, (place, heading) in enumerate(held):
            out.append(
                Landing(
                    kind="stand",
                    side=side,
                    position=self._search.placed(place, heading),
                    heading=heading,
                    line=middle,
                    direction=start.heading,
                    way=start.heading,
                    middle=middle,
                )
            )
        return out

    def ahead(
        self, feet: Sequence[Landing], wish: Wish, count: int, *, moving: Landing | None = None
    ) -> list[Landing]:
        """The next ``count`` footsteps after ``feet``; fewer where the person comes to stand.

        Parameters
        ----------
        feet
            Footsteps made so far, in order of landing; the last two are where the feet are.
        wish
            What is wished of all of them.
        count
            How many.
        moving
            Where the swinging foot was to land so far; None: no foot swings. The first footstep
            is then of that foot. It closes the feet only if it was to, else it is a short step,
            and the next one closes.
        """
        out = list(feet)
        for _ in range(count):
            following = self._next(out, wish, moving)
            if following is None:
                break
            out.append(following)
            moving = None
        return out[len(feet) :]

    def plan(self, feet: Sequence[Landing]) -> StepPlan:
        """Consecutive footsteps as a plan; the first two are where the feet stood."""
        side = np.array([f.side for f in feet])
        direction = np.array([f.direction for f in feet])
        lean, middle = np.array([f.lean for f in feet]), np.array([f.middle for f in feet])
        gaze = np.array([f.gaze for f in feet])
        drawn_in = np.zeros(len(feet))
        if lean.any():
            drawn_in = np.arctan(self._lever * course_change(lean, middle))
        durations = [f.duration for f in feet[2:]]
        return StepPlan(
            side=side,
            position=np.array([f.position for f in feet]),
            heading=np.array([f.heading for f in feet]),
            direction=direction - drawn_in,
            time=np.concatenate([[0.0, 0.0], np.cumsum(durations)]),
            kinds=tuple(f.kind for f in feet[2:]),
            middle=middle,
            lean=lean,
            gaze=gaze,
        )

    def limited(self, old: Landing, new: Landing, stance: Landing, share: float) -> Landing:
        """``new``, but no more than ``share`` of the way there from ``old``.

        For a foot that is in the air and was to land at ``old``, beside ``stance``.
        """
        if share >= 1.0:
            return new

        def between(a: object, b: object) -> object:
            return a + share * (b - a)  # type: ignore[operator]

        names = ("heading", "line", "direction", "way", "middle", "lean", "gaze", "length")
        names = (*names, "duration", "period", "along", "turn")
        mixed = {name: between(getattr(old, name), getattr(new, name)) for name in names}
        place = between(old.position[[0, 2]], new.position[[0, 2]])
        if not self._search.stands(place, mixed["heading"], stance.position[1]):  # type: ignore[arg-type]
            return old
        position = self._search.placed(place, mixed["heading"])  # type: ignore[arg-type]
        return replace(new, position=position, **mixed)  # type: ignore[arg-type]

    # ------------------------------------------------------------------ one footstep

    def _next(self, feet: list[Landing], wish: Wish, moving: Landing | None) -> Landing | None:
        last, close = feet[-1], moving is None or moving.kind == "stop"
        done = wish.stop or (wish.heading is None and self._arrived(last))
        if last.stands and done and close:
            return None
        if done and close and (last.closes or last.length < SHORTEST * self._body.leg_length):
            return self._closing(last, wish)
        first = self._chord(last, wish)
        if last.stands:
            side = LEFT if first.turn > INSIDE else RIGHT
            side = side if moving is None else moving.side
            stance = feet[-1] if feet[-1].side != side else feet[-2]
        else:
            side, stance = 1 - last.side, last
        found = self._set(first, side, stance, last, wish)
        if found is None:  # nowhere to go
            return None if last.stands else self._closing(last, wish)
        return found

    def _set(
        self, chord: _Chord, side: int, stance: Landing, last: Landing, wish: Wish
    ) -> Landing | None:
        """Where the foot goes that ends ``chord``."""

        def landing(length: float) -> Landing:
            return self._landing(replace(chord, length=length), side, stance, last, wish)

        found = self._search.find(
            landing,
            chord.length,
            stance.position[1],
            keep_length=wish.keep_length or chord.last,
        )
        if found is None:
            return None
        foot, longer = found
        duration = foot.period * (1.0 if wish.keep_duration else longer)
        eased = EASED_DURATION if foot.kind == "start" else 1.0
        return replace(foot, duration=duration * eased, period=duration)

    def _landing(
        self, chord: _Chord, side: int, stance: Landing, last: Landing, wish: Wish
    ) -> Landing:
        way, body = chord.way, self._body
        line = last.line + chord.length * np.array([np.sin(way), np.cos(way)])
        along = self._closest(line, last.along)
        here = replace(
            last, line=line, way=way, along=along, turn=chord.turn, length=chord.length, kind="walk"
        )
        turn = 0.0
        if not chord.last:
            following = self._chord(here, wish)
            turn = wrapped(following.way - way)
        if self._paper and wish.heading is None and self._path is not None and not chord.last:
            direction = self._paper_heading(along, chord.length, way)
        else:
            direction = way + 0.5 * turn
        change = wrapped(direction - stance.direction)
        direction += float(np.clip(change, -LARGEST_CHANGE, LARGEST_CHANGE)) - change
        beyond = wrapped(direction - stance.heading)
        direction += float(np.clip(beyond, -HIP_ROTATION, HIP_ROTATION)) - beyond
        period = wish.duration * chord.slower
        if last.period > 0.0:
            low, high = last.period / DURATION_CHANGES, last.period * DURATION_CHANGES
            period = float(np.clip(period, low, high))
        lean = self._lean(here, turn, period, last, wish)
        left = leftward(float(direction))[[0, 2]]
        middle = line - self._lever * lean * left
        if chord.last:
            lean, line = 0.0, middle
        sign = float(SIDE_SIGN[side])
        half = 0.5 * self._stance.width
        if not chord.last:
            half += 0.25 * WIDENED * (abs(turn) + abs(wrapped(way - last.way)))
        sharp = wrapped(direction - stance.direction)
        into = float(np.clip(abs(sharp) - TOE_OUT_FROM, 0.0, TOE_OUT_MOST))
        into *= 1.0 if sign * sharp > 0.0 else TOE_IN
        heading = direction + sign * self._stance.toe_out[side] + np.sign(sharp) * into  # type: ignore[index]
        place = middle + half * sign * left
        want = min(APART, 0.8 * self._stance.width)
        want += APART_TURNING * min(1.0, abs(sharp) / APART_TURN)
        for _ in range(APART_MOST):
            apart = feet_apart(
                place[None],
                np.array([heading]),
                stance.position[None, [0, 2]],
                np.array([stance.heading]),
                back=body.foot.heel,
                front=body.foot.ball + body.foot.toes,
            )
            if apart[0] >= want:
                break
            place = place + APART_PART * sign * left
        return Landing(
            kind="start" if last.stands else "walk",
            side=side,
            position=np.array([place[0], 0.0, place[1]]),
            heading=float(heading),
            line=line,
            direction=float(direction),
            way=way,
            middle=middle,
            lean=lean,
            gaze=self._gaze(direction, turn, wish),
            length=chord.length,
            period=period,
            duration=period,
            along=along,
            turn=chord.turn,
            closes=chord.last,
        )

    def _lean(self, here: Landing, turn: float, period: float, last: Landing, wish: Wish) -> float:
        """Tangent of the lean, which follows the turn, ends with the walk, crosses no feet."""
        if not self._lever:
            return 0.0
        length = max(here.length, 0.1)
        bend = (0.5 * turn + 0.5 * here.turn) / length
        wanted = float(lean_tangent(np.array(length / period), np.array(bend)))
        if wish.stop:
            wanted = 0.0
        elif wish.heading is None and self._path is not None:
            rest = self._path.length - here.along
            wanted *= float(np.clip(rest / (2.0 * wish.length), 0.0, 1.0))
        room = ACROSS * self._stance.width / self._lever
        return float(np.clip(wanted, last.lean - room, last.lean + room))

    def _gaze(self, direction: float, turn: float, wish: Wish) -> float:
        if wish.heading is not None:
            return float(np.clip(0.5 * wrapped(wish.heading - direction), -GAZE, GAZE))
        return float(np.clip(turn, -GAZE, GAZE))

    def _closing(self, last: Landing, wish: Wish) -> Landing | None:
        """The other foot set beside ``last``."""
        side = 1 - last.side
        place = 2.0 * last.middle - last.position[[0, 2]]
        heading = last.direction + float(SIDE_SIGN[side]) * self._stance.toe_out[side]  # type: ignore[index]
        period = wish.duration if last.period == 0.0 else last.period
        return Landing(
            kind="stop",
            side=side,
            position=self._search.placed(place, heading),
            heading=float(heading),
            line=last.middle,
            direction=last.direction,
            way=last.direction,
            middle=last.middle,
            duration=EASED_DURATION * period,
            period=period,
            along=last.along,
        )

    # ------------------------------------------------------------------------ chords

    def _chord(self, last: Landing, wish: Wish) -> _Chord:
        """The next step of the line from beside ``last``, on level ground."""
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

    def _turned(self, last: Landing, way: float, length: float, wish: Wish) -> _Chord:
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
        return _Chord(last.way + turn, float(length), float(slow ** (power - 1.0)), turn, ends)

    def _arrived(self, last: Landing) -> bool:
        return (
            self._path is not None
            and self._path.length - last.along < REACHED * self._body.leg_length
        )

    def _closest(self, line: Float[np.ndarray, "2"], near: float) -> float:
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
            return chord + 0.5 * wrapped(self._paper_heading(s + length, length, chord) - chord)
        return chord + FEEDBACK * wrapped(_heading(there - last.line) - chord)

    def _paper_heading(self, along: float, length: float, near: float) -> float:
        assert self._path is not None
        ends = self._path.at(np.array([along, along + length]))
        return near + wrapped(_heading(ends[1] - ends[0]) - near)

    def _shorter(self, along: float, length: float) -> float:
        """SL_max: shorter steps where two of them would turn too far."""
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
