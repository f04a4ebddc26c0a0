"""Actions become steps: walks, local steps and turns, one after the other."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import LEFT, RIGHT, SIDE_SIGN, ahead, leftward
from gaitsmith.errors import InfeasibleError
from gaitsmith.plan.follow import follow
from gaitsmith.plan.footsteps import Footstep, LocalStep, PlannedStep
from gaitsmith.plan.legs import Legs, legs_of
from gaitsmith.plan.manners import Manners, gait_of
from gaitsmith.plan.routes import is_blocked, path_among
from gaitsmith.plan.script import (
    Action,
    BeAt,
    Face,
    Follow,
    Lean,
    LookAt,
    Stand,
    Step,
    Turn,
    WalkTo,
)
from gaitsmith.plan.start import Start
from gaitsmith.plan.stepping import FARTHEST, LARGEST_TURN, classify, turnaround, turning_side
from gaitsmith.plan.timeline import Timeline
from gaitsmith.plan.ways import NO_WAY, from_feet, goals_of, leads, on_floor, wrapped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.pace import Pace
    from gaitsmith.plan.paths import Path
    from gaitsmith.plan.script import Tempo

    Way = list[Float[np.ndarray, "2"]]

#: Seconds of the first and of the closing step of a pair that moves the body by half a meter, of
#: an adult whose leg is LEG meters; others keep the Froude number.
SECONDS = {"forward": (0.90, 0.72), "backward": (0.95, 0.78), "lateral": (0.82, 0.67)}
LEG = 0.834
#: Part of that which a very small step takes, and the way (m) from which all of it is taken.
SMALL, WHOLE = 0.75, 0.5
#: Seconds of a step of a turn: of none, and more per radian.
TURN_SECONDS, PER_RADIAN = 0.52, 0.12
#: swhf of the foot that closes a lateral step, which heel and toes lift as well.
CLOSING_LIFT = 0.7
#: Lift of the foot in a turn (1-4 cm measured).
TURN_LIFT = 0.5
#: Seconds of standing between a walk and local steps, and between local steps and a walk.
AFTER_WALK, BEFORE_WALK = 0.25, 0.12
#: A walk that leads farther aside than this from where the person faces begins with a turn.
TURN_FIRST = float(np.radians(35.0))
#: A walk from point to point is stopped where it would turn farther than this.
LARGEST_CORNER = float(np.radians(100.0))
#: Seconds that a lean and a last look take.
LEAN_SECONDS, LOOK_SECONDS = 0.9, 0.8
#: ``be at`` walks where it is farther than this, meters; nearer it steps.
STEP_ONLY = 0.9
_KINDS: dict[str, StepKind] = {
    "forward": "forward",
    "back": "backward",
    "left": "lateral",
    "right": "lateral",
}


def direct(actions: Sequence[Action], manners: Manners, start: Start | None = None) -> Timeline:
    """Steps of ``actions`` from ``start``; None: from standing at 0,0 facing 0.

    Raises
    ------
    InfeasibleError
        Naming the action that cannot be done, and why.
    """
    director = _Director(manners, start or Start())
    i = 0
    while i < len(actions):
        group = [actions[i]]
        while isinstance(group[0], WalkTo | Follow) and i + len(group) < len(actions):
            following = actions[i + len(group)]
            if not isinstance(following, WalkTo | Follow):
                break
            group.append(following)
        after = actions[i + len(group)] if i + len(group) < len(actions) else None
        try:
            director.do(group, after)
        except InfeasibleError as error:
            named = f"action {i + 1} ({type(group[0]).__name__})"
            raise InfeasibleError(f"{named}: {error}") from None
        i += len(group)
    return director.timeline()


@dataclass
class _Director:
    """Where the person stands, and what is planned so far."""

    manners: Manners
    start: Start
    feet: dict[int, Footstep] = field(default_factory=dict)
    planned: list[PlannedStep] = field(default_factory=list)
    facing: float = 0.0
    gaze: float = 0.0
    clock: float = 0.0
    looks: list[tuple[float, tuple[float, float, float] | None]] = field(default_factory=list)
    leans: list[tuple[float, float, float, float]] = field(default_factory=list)
    paths: list[Float[np.ndarray, "P 2"]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.facing = self.gaze = self.start.heading
        held = self.start.footholds(self.manners.body, self.manners.stance)
        for side, (place, heading) in enumerate(held):
            foot = self._foot(side, on_floor(place), self.facing)
            self.feet[side] = replace(foot, heading=heading)

    # ---------------------------------------------------------------------- actions

    def do(self, group: Sequence[Action], after: Action | None) -> None:
        action = group[0]
        if isinstance(action, WalkTo | Follow):
            self._walk_all(group)  # type: ignore[arg-type]
        elif isinstance(action, Step):
            self._step(action)
        elif isinstance(action, Turn):
            self._turn(action.angle, walks_on=isinstance(after, WalkTo | Follow))
        elif isinstance(action, Face):
            self._turn(
                wrapped(action.heading - self.facing), walks_on=isinstance(after, WalkTo | Follow)
            )
        elif isinstance(action, Stand):
            self._stand(action.seconds)
        elif isinstance(action, LookAt):
            self.looks.append((self.clock, action.point))
            if after is None:
                self._stand(LOOK_SECONDS)
        elif isinstance(action, Lean):
            sign = {"forward": (1, 0), "back": (-1, 0), "left": (0, 1), "right": (0, -1)}
            pitch, roll = (s * action.angle for s in sign[action.way])
            self.leans.append((self.clock, self.clock + LEAN_SECONDS, pitch, roll))
            self._stand(LEAN_SECONDS)
        else:
            self._be_at(action)

    def timeline(self) -> Timeline:
        if not self.planned:
            self._stand(AFTER_WALK)
        whole = len(self.paths) == 1 and all(
            s.local is None or s.kind == "stand" for s in self.planned
        )
        return Timeline(
            tuple(self.planned),
            path=self.paths[0] if whole else None,
            looks=tuple(self.looks),
            leans=tuple(self.leans),
        )

    # ------------------------------------------------------------------------ walks

    def _walk_all(self, group: Sequence[WalkTo | Follow]) -> None:
        """Walk on from point to point without a stop, but where it turns too far."""
        ways = [
            [np.array(p) for p in (a.points if isinstance(a, Follow) else [a.point])] for a in group
        ]
        run: list[tuple[Way, bool, Tempo | None]] = []
        here = self.middle
        heading: float | None = None
        for way, action in zip(ways, group, strict=True):
            gap = way[0] - here
            if np.linalg.norm(gap) < NO_WAY and len(way) == 1:
                continue
            towards = float(np.arctan2(*gap))
            turns = heading is not None and abs(wrapped(towards - heading)) > LARGEST_CORNER
            if run and (turns or gait_of(action.tempo) != gait_of(run[-1][2])):
                self._walk(run)
                run = []
            run.append((way, isinstance(action, Follow), action.tempo))
            points = [here, *way]
            heading = float(np.arctan2(*(points[-1] - points[-2])))
            here = way[-1]
        if run:
            self._walk(run)

    def _walk(self, run: Sequence[tuple[Way, bool, Tempo | None]]) -> None:
        ways = [(way, soft) for way, soft, _ in run]
        path = path_among(self.manners.routes, self.middle, ways)
        if path is None:  # no one way past what stands around: from point to point
            for leg in run:
                self._walk([leg])
            return
        aside = wrapped(float(path.heading[0]) - self.facing)
        if abs(aside) > TURN_FIRST:
            self._turn(aside, walks_on=True)
            path = path_among(self.manners.routes, self.middle, ways) or path
        if self.planned and self.planned[-1].kind not in ("stop", "stand"):
            self._stand(BEFORE_WALK)
        gait = gait_of(run[0][2])
        manners = self.manners.in_gait(gait)
        lead = leads(self.feet, path)
        first = RIGHT if lead[RIGHT] <= lead[LEFT] + 0.01 else LEFT
        tempi = [tempo for *_, tempo in run]
        pace, legs = _legs(path, [way[-1] for way, _ in ways], [manners.pace_at(t) for t in tempi])
        plan = follow(
            path,
            pace=pace,
            stance=manners.stance,
            ground=manners.ground,
            body=manners.body,
            outside=manners.outside,
            keep_cadence=all(manners.keeps(tempo) for tempo in tempi),
            keep_length=all(manners.keeps_length(tempo) for tempo in tempi),
            legs=legs,
            rhythm=manners.rhythm,
            stature=manners.body.height,
            first=first,
        )
        plan = from_feet(plan, self.feet, path, self.facing)
        for step in plan.steps():
            self._add(replace(step, gait=gait))
        assert plan.path is not None
        self.paths.append(plan.path)
        self.facing = self.gaze = float(plan.direction[-1])
        for foot in plan.footsteps()[-2:]:
            self.feet[foot.side] = foot

    # ------------------------------------------------------------------ local steps

    def _stand(self, seconds: float, glances: tuple[tuple[float, float, float], ...] = ()) -> None:
        left, right = self.feet[LEFT], self.feet[RIGHT]
        how = LocalStep(gaze=self.gaze, glances=glances, closes=True)
        self._add(PlannedStep(0, "stand", right, left, left, None, None, seconds, how))

    def _turn(self, angle: float, *, walks_on: bool) -> None:
        """Turnarounds of at most 100 deg; the gaze leads, [KB93] Figure 9."""
        if abs(angle) < 1e-9:
            return
        manners = self.manners
        count = int(np.ceil(abs(angle) / LARGEST_TURN - 1e-9))
        part = angle / count
        seconds = self._scale() * (TURN_SECONDS + PER_RADIAN * abs(part))
        side = turning_side(angle)
        glances = [(part, seconds * (2 * k), seconds * (2 * k + 1)) for k in range(count)]
        lead = 0.5 * seconds
        self._stand(lead, tuple((a, b / lead, e / lead) for a, b, e in glances))
        for k in range(count):
            last = k == count - 1
            pivot = self.feet[1 - side]
            places = turnaround(
                pivot.position,
                self.facing,
                part,
                hip_width=manners.body.hip_width,
                kind="dynamic" if walks_on and last else "stationary",
            )
            goal = self.facing + part
            first = self._foot(side, places[0], goal)
            second = self._foot(1 - side, places[1], goal)
            for j, (target, following) in enumerate(((first, second), (second, None))):
                begin = lead + seconds * (2 * k + j)
                seen = tuple(
                    (a, (b - begin) / seconds, (e - begin) / seconds) for a, b, e in glances
                )
                how = LocalStep(swing_height=TURN_LIFT, gaze=self.gaze, glances=seen, closes=j == 1)
                self._local("turn", target, following, seconds, how)
            self.facing = goal
        self.gaze += angle

    def _step(self, action: Step) -> None:
        """Pairs of steps that move the body: one foot leads, the other closes."""
        if action.distance < NO_WAY:
            return
        self._settle()
        most = FARTHEST[action.way] * self.manners.body.leg_length
        count = int(np.ceil(action.distance / most - 1e-9))
        along = ahead(self.facing) if action.way in ("forward", "back") else leftward(self.facing)
        sign = 1.0 if action.way in ("forward", "left") else -1.0
        move = (sign * action.distance / count) * along
        lead = LEFT if action.way == "left" else RIGHT
        left = leftward(self.facing)
        width = float((self.feet[LEFT].position - self.feet[RIGHT].position) @ left)
        for _ in range(count):
            middle = on_floor(self.middle) + move
            targets = {
                s: self._foot(s, middle + 0.5 * width * SIDE_SIGN[s] * left, self.facing)
                for s in (LEFT, RIGHT)
            }
            self._pair(_KINDS[action.way], lead, targets)

    def _pair(self, kind: StepKind, lead: int, targets: dict[int, Footstep]) -> None:
        how = LocalStep(gaze=self.gaze)
        ways = [
            float(np.linalg.norm(targets[s].position - self.feet[s].position))
            for s in (LEFT, RIGHT)
        ]
        size = self._scale() * (SMALL + (1.0 - SMALL) * min(1.0, max(ways) / WHOLE))
        for j, side in enumerate((lead, 1 - lead)):
            stance = self.feet[1 - side]
            foot = self.manners.body.foot
            region = classify(
                stance.position - foot.heel * ahead(stance.direction),
                stance.direction,
                targets[side].position - foot.heel * ahead(targets[side].direction),
                targets[side].direction - stance.direction,
                side,
            )
            # a foot that closes comes from where the body does: it keeps that step's kind
            own = kind if j or kind != "stand" else region
            self._local(
                own,
                targets[side],
                targets[1 - side] if j == 0 else None,
                size * SECONDS[own][j],
                replace(
                    how,
                    closes=j == 1,
                    swing_height=CLOSING_LIFT if j and own == "lateral" else 1.0,
                ),
            )

    def _be_at(self, action: BeAt) -> None:
        goals = goals_of(action, self.facing, self.manners.stance)
        place = 0.5 * (goals[LEFT][0] + goals[RIGHT][0])
        facing = 0.5 * (goals[LEFT][1] + goals[RIGHT][1])
        away = float(np.linalg.norm(place - self.middle))
        if away > STEP_ONLY or is_blocked(self.manners.routes, self.middle, place):
            self._walk([([place], False, action.tempo)])
        self._turn(wrapped(facing - self.facing), walks_on=False)
        self._settle()
        whole = 2.0 * np.pi * np.round((self.facing - facing) / (2.0 * np.pi))
        for _ in range(12):
            gap = place - self.middle
            along = float(gap @ ahead(self.facing)[[0, 2]])
            aside = float(gap @ leftward(self.facing)[[0, 2]])
            leg = self.manners.body.leg_length
            if abs(along) <= 0.25 * leg and abs(aside) <= 0.25 * leg:
                break
            if abs(along) > 0.25 * leg:
                self._step(Step("forward" if along > 0.0 else "back", abs(along)))
            else:
                self._step(Step("left" if aside > 0.0 else "right", abs(aside)))
        targets = {
            s: replace(
                self._foot(s, on_floor(goals[s][0]), self.facing), heading=goals[s][1] + whole
            )
            for s in (LEFT, RIGHT)
        }
        moved = max(
            float(np.linalg.norm(targets[s].position - self.feet[s].position))
            + abs(targets[s].heading - self.feet[s].heading)
            for s in (LEFT, RIGHT)
        )
        if moved > 1e-9:
            self._reach(targets)

    def _reach(self, targets: dict[int, Footstep]) -> None:
        """A last pair of steps onto given footsteps, in the order in which no legs cross."""
        aside = float(
            sum(
                (targets[s].position - self.feet[s].position) @ leftward(self.facing)
                for s in (0, 1)
            )
        )
        lead = LEFT if aside > 0.0 else RIGHT
        before = (len(self.planned), dict(self.feet), self.clock)
        try:
            self._pair("lateral", lead, targets)
        except InfeasibleError:
            del self.planned[before[0] :]
            self.feet, self.clock = before[1], before[2]
            self._pair("lateral", 1 - lead, targets)

    def _local(
        self,
        kind: StepKind,
        target: Footstep,
        following: Footstep | None,
        seconds: float,
        how: LocalStep,
    ) -> None:
        side = target.side
        stance, origin = self.feet[1 - side], self.feet[side]
        self._add(PlannedStep(0, kind, stance, origin, target, None, following, seconds, how))
        self.feet[side] = target

    # ---------------------------------------------------------------------- helpers

    def _settle(self) -> None:
        if self.planned and self.planned[-1].kind == "stop":
            self._stand(AFTER_WALK)

    def _add(self, step: PlannedStep) -> None:
        self.planned.append(replace(step, index=len(self.planned)))
        self.clock += step.duration

    def _scale(self) -> float:
        return float(np.sqrt(self.manners.body.leg_length / LEG))

    def _foot(self, side: int, position: Float[np.ndarray, "3"], direction: float) -> Footstep:
        toe_out = np.array(self.manners.stance.toe_out)[side]
        x, _, z = position
        level = float(self.manners.ground.height(np.array([x]), np.array([z]))[0])
        return Footstep(
            side=side,
            position=np.array([x, level, z]),
            heading=float(direction + SIDE_SIGN[side] * toe_out),
            direction=float(direction),
            time=0.0,
            middle=np.array([x, z]),
        )

    @property
    def middle(self) -> Float[np.ndarray, "2"]:
        """x, z half way between the feet."""
        return 0.5 * (self.feet[LEFT].position + self.feet[RIGHT].position)[[0, 2]]


def _legs(path: Path, ends: Way, paces: Sequence[Pace]) -> tuple[Pace, Legs | None]:
    """The pace of the longest steps, and where others are taken."""
    if all(pace == paces[0] for pace in paces):
        return paces[0], None
    return legs_of(path, ends, paces)


__all__ = ["Manners", "direct"]
