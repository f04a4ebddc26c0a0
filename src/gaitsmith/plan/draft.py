"""A timeline in the making: where the person stands, and what is planned so far."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN
from gaitsmith.plan.footsteps import Footstep, LocalStep, PlannedStep
from gaitsmith.plan.timeline import Timeline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.manners import Manners
    from gaitsmith.plan.start import Start

#: Seconds of standing between a walk and local steps, and between local steps and a walk.
AFTER_WALK, BEFORE_WALK = 0.25, 0.12
#: Seconds of standing between two steps of the same foot, which has to take the weight first.
PAUSE = 0.12
#: The gaze turns as the pelvis does, so much of a step earlier ([KB93] Figure 9: half a step,
#: 2.5 steps in all); the head is then up to 25 deg ahead of the pelvis, as a man's is (23 deg).
GAZE_LEAD = 0.5
#: Smaller turns need no look ahead, radians.
NO_TURN = float(np.radians(3.0))


@dataclass(frozen=True)
class Footfall:
    """One local step to be taken: where the foot lands, the kind, seconds, and how."""

    target: Footstep
    kind: StepKind
    seconds: float
    closes: bool = False
    lift: float = 1.0


@dataclass
class Draft:
    """Steps planned so far, and what the person who takes them is left with.

    ``feet`` are the last footsteps of both sides, ``facing`` the direction that they stand in,
    ``gaze`` the one looked in, ``clock`` the seconds that passed.
    """

    manners: Manners
    feet: dict[int, Footstep] = field(default_factory=dict)
    planned: list[PlannedStep] = field(default_factory=list)
    facing: float = 0.0
    gaze: float = 0.0
    clock: float = 0.0
    looks: list[tuple[float, tuple[float, float, float] | None]] = field(default_factory=list)
    leans: list[tuple[float, float, float, float]] = field(default_factory=list)
    paths: list[Float[np.ndarray, "P 2"]] = field(default_factory=list)

    @staticmethod
    def standing(manners: Manners, start: Start) -> Draft:
        """Nothing planned yet."""
        draft = Draft(manners, facing=start.heading, gaze=start.heading)
        held = start.footholds(manners.body, manners.stance)
        for side, (place, heading) in enumerate(held):
            draft.feet[side] = draft.foot(side, place, start.heading, heading)
        return draft

    # ---------------------------------------------------------------------- reading

    @property
    def middle(self) -> Float[np.ndarray, "2"]:
        """x, z half way between the feet."""
        return 0.5 * (self.feet[LEFT].position + self.feet[RIGHT].position)[[0, 2]]

    def foot(
        self,
        side: int,
        place: Float[np.ndarray, "2"],
        direction: float,
        heading: float | None = None,
    ) -> Footstep:
        """A footstep at x, z; it points outward by the stance's toe-out where no heading is."""
        toe_out = np.array(self.manners.stance.toe_out)[side]
        x, z = place
        level = float(self.manners.ground.height(np.array([x]), np.array([z]))[0])
        outward = float(direction + SIDE_SIGN[side] * toe_out)
        return Footstep(
            side=side,
            position=np.array([x, level, z]),
            heading=outward if heading is None else float(heading),
            direction=float(direction),
            time=0.0,
            middle=np.array([x, z]),
        )

    def timeline(self) -> Timeline:
        """All that is planned; at least a while of standing."""
        if not self.planned:
            self.stand(AFTER_WALK)
        whole = len(self.paths) == 1 and all(
            s.local is None or s.kind == "stand" for s in self.planned
        )
        return Timeline(
            tuple(self.planned),
            path=self.paths[0] if whole else None,
            looks=tuple(self.looks),
            leans=tuple(self.leans),
        )

    # ---------------------------------------------------------------------- writing

    def mark(self) -> tuple[int, int, dict[int, Footstep], float, float, float]:
        """All that planning changes, to come :meth:`back_to`."""
        counts = len(self.planned), len(self.paths)
        return (*counts, dict(self.feet), self.facing, self.gaze, self.clock)

    def back_to(self, mark: tuple[int, int, dict[int, Footstep], float, float, float]) -> None:
        """Forget what was planned since ``mark``."""
        steps, paths, feet, self.facing, self.gaze, self.clock = mark
        self.feet = dict(feet)  # a mark may be come back to more than once
        del self.planned[steps:], self.paths[paths:]

    def add(self, step: PlannedStep) -> None:
        """Append one step."""
        self.planned.append(replace(step, index=len(self.planned)))
        self.clock += step.duration

    def stand(
        self,
        seconds: float,
        glances: tuple[tuple[float, float, float], ...] = (),
        gaze: float | None = None,
    ) -> None:
        """Stand, and only look."""
        left, right = self.feet[LEFT], self.feet[RIGHT]
        how = LocalStep(gaze=self.gaze if gaze is None else gaze, glances=glances, closes=True)
        self.add(PlannedStep(0, "stand", right, left, left, None, None, seconds, how))

    def settle(self) -> None:
        """Stand for a moment where a walk has just ended."""
        if self.planned and self.planned[-1].kind == "stop":
            self.stand(AFTER_WALK)

    def take(self, footfalls: Sequence[Footfall]) -> None:
        """Local steps one after the other; the gaze leads where they turn ([KB93] Figure 9)."""
        if not footfalls:
            return
        facing, turns = self._turned(footfalls)
        seconds = np.array([f.seconds for f in footfalls])
        pauses = self._pauses(footfalls)
        ends = np.cumsum(seconds + pauses)
        begins = ends - seconds
        lead = 0.0
        if np.abs(turns).max() > NO_TURN:
            lead = GAZE_LEAD * float(seconds[int((np.abs(turns) > NO_TURN).argmax())])
        if lead > begins[int((np.abs(turns) > 1e-9).argmax())]:
            self._look_and_stand(lead, turns, begins, ends)
        else:
            self.settle()
        for j, footfall in enumerate(footfalls):
            start = begins[j] - pauses[j]
            if pauses[j]:
                gaze, glances = self._glances(turns, begins - lead, ends - lead, start, pauses[j])
                self.stand(float(pauses[j]), glances, gaze)
            gaze, glances = self._glances(turns, begins - lead, ends - lead, begins[j], seconds[j])
            how = LocalStep(
                swing_height=footfall.lift,
                gaze=gaze,
                glances=glances,
                closes=footfall.closes,
            )
            side = footfall.target.side
            after = footfalls[j + 1].target if j + 1 < len(footfalls) else None
            following = after if after is not None and after.side != side else None
            stance, origin = self.feet[1 - side], self.feet[side]
            self.add(
                PlannedStep(
                    index=0,
                    kind=footfall.kind,
                    stance=stance,
                    origin=origin,
                    target=footfall.target,
                    before=None,
                    following=None if footfall.closes else following,
                    duration=footfall.seconds,
                    local=how,
                )
            )
            self.feet[side] = footfall.target
        self.facing = facing
        self.gaze += float(turns.sum())

    def _pauses(self, footfalls: Sequence[Footfall]) -> Float[np.ndarray, "n"]:
        """Seconds of standing before steps of a foot that has only just landed."""
        last = self.planned[-1] if self.planned else None
        landed = None if last is None or last.kind in ("stand", "stop") else last.target.side
        sides = [landed, *(f.target.side for f in footfalls)]
        return np.array([PAUSE if a == b else 0.0 for a, b in pairwise(sides)])

    def _turned(self, footfalls: Sequence[Footfall]) -> tuple[float, Float[np.ndarray, "n"]]:
        """Where the person faces in the end, and by how much each step turns the pelvis."""
        feet = dict(self.feet)
        now = [0.5 * (feet[LEFT].direction + feet[RIGHT].direction)]
        for footfall in footfalls:
            feet[footfall.target.side] = footfall.target
            now.append(0.5 * (feet[LEFT].direction + feet[RIGHT].direction))
        return float(now[-1]), np.diff(now)

    def _look_and_stand(
        self,
        lead: float,
        turns: Float[np.ndarray, "n"],
        begins: Float[np.ndarray, "n"],
        ends: Float[np.ndarray, "n"],
    ) -> None:
        """Stand while the gaze begins to turn."""
        _, glances = self._glances(turns, begins - lead, ends - lead, -lead, lead)
        self.stand(lead, glances)

    def _glances(
        self,
        turns: Float[np.ndarray, "n"],
        begins: Float[np.ndarray, "n"],
        ends: Float[np.ndarray, "n"],
        start: float,
        seconds: float,
    ) -> tuple[float, tuple[tuple[float, float, float], ...]]:
        """The gaze before a step from ``start`` on, and its turns in phases of that step."""
        done = ends <= start + 1e-9
        now = ~done & (begins < start + seconds - 1e-9) & (turns != 0.0)
        glances = tuple(
            (float(a), float((b - start) / seconds), float((e - start) / seconds))
            for a, b, e in zip(turns[now], begins[now], ends[now], strict=True)
        )
        return self.gaze + float(turns[done].sum()), glances
