"""MetaGait, [SM01] section 6: where the next feet go, seen from no more than two steps ahead.

What it is told may change with every step: a path or a heading, a pace, a stop. Nothing is
planned beyond what is looked at, so the same controller walks a path and obeys a hand.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, leftward
from gaitsmith.geometry.angles import wrapped
from gaitsmith.geometry.planar import feet_apart
from gaitsmith.plan.aiming import SHORTEST, Aiming, Chord, Wish
from gaitsmith.plan.course import course_change, lean_lever, lean_tangent
from gaitsmith.plan.follow import WIDENED
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.landing import Landing, LandingSearch
from gaitsmith.plan.lengths import EASED_DURATION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.lengths import Stance
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.start import Start

#: [SM01] section 6.1: from the first angle on feet point into the turn, by the second at most. The
#: paper's 45 deg are never reached here, steps turn by 40 at most.
TOE_OUT_FROM, TOE_OUT_MOST = float(np.radians(25.0)), float(np.radians(25.0))
#: Part of it for the foot inside of which the other one passes: toes in, it would be hit.
TOE_IN = 0.5
#: The pelvis turns so far beyond the foot that bears, radians (people's hips: 45 deg).
HIP_ROTATION = float(np.radians(38.0))
#: Who starts with a turn of more than this (radians) to the left starts with the left foot.
INSIDE = 0.1
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
#: Change of duration from one step to the next.
DURATION_CHANGES = 1.25


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
        self._aiming = Aiming(body, path, paper=paper)
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
        done = wish.stop or (wish.heading is None and self._aiming.arrived(last))
        if last.stands and done and close:
            return None
        if done and close and (last.closes or last.length < SHORTEST * self._body.leg_length):
            return self._closing(last, wish)
        first = self._aiming.chord(last, wish)
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
        self, chord: Chord, side: int, stance: Landing, last: Landing, wish: Wish
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
        self, chord: Chord, side: int, stance: Landing, last: Landing, wish: Wish
    ) -> Landing:
        way, body = chord.way, self._body
        line = last.line + chord.length * np.array([np.sin(way), np.cos(way)])
        along = self._aiming.closest(line, last.along)
        here = replace(
            last, line=line, way=way, along=along, turn=chord.turn, length=chord.length, kind="walk"
        )
        turn = 0.0
        if not chord.last:
            following = self._aiming.chord(here, wish)
            turn = wrapped(following.way - way)
        if self._paper and wish.heading is None and self._path is not None and not chord.last:
            direction = self._aiming.paper_heading(along, chord.length, way)
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
