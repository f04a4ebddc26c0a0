"""Walking that is steered: one step at a time, each planned anew as long as its foot may change.

The body, the gait and the ground are whatever :mod:`gaitsmith.synthesis.generators` walks with;
this plans a window of three steps with them, again and again, and lets the plans become each
other (:mod:`gaitsmith.synthesis.replanned`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact import StepCurves, plan_contact
from gaitsmith.contact.step_curves import CURVES
from gaitsmith.errors import InfeasibleError
from gaitsmith.synthesis.join import join_all
from gaitsmith.synthesis.replanned import Blend, LivePlan, Run
from gaitsmith.synthesis.step import prepared_steps, stand_still

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact import ContactPlan, Poses, ReferenceStep
    from gaitsmith.conventions import StepKind
    from gaitsmith.ground import Ground
    from gaitsmith.plan.aiming import Wish
    from gaitsmith.plan.landing import Landing
    from gaitsmith.plan.metagait import MetaGait
    from gaitsmith.synthesis.step import StepGenerator

#: The foot's goal may change up to this phase of the step ([SM01]: .34 of the stride).
HORIZON = 0.68
#: Phases after the toe-off at which wishes that have changed are looked at, and how far apart.
FIRST_LOOK, LOOKS = 0.02, 0.1
#: How far the goal of a swinging foot may move for each second until it lands: meters, radians.
MOVES, TURNS = 0.55, 1.0
#: A start is under way by this part of the time to its toe-off.
UNDER_WAY = 0.9
#: Footsteps before the present ones that the curves of a window are drawn from.
HISTORY = 6
#: A step that this body cannot take is tried so much shorter.
SHORTENED = (0.75, 0.5)
#: Seconds that are none.
INSTANT = 1e-9


@dataclass(eq=False)
class Steering:
    """A person who walks as is wished, for now.

    Attributes
    ----------
    feet, landed
        All footsteps made, and when, seconds; the first two are where the person began.
    target
        Where the swinging foot will land; None: standing.
    run
        How the phase of the present step passes; None: standing.
    step
        Number of the present step since the beginning, standing counted.
    """

    body: Body
    ground: Ground
    generator: StepGenerator
    gait: MetaGait
    feet: list[Landing]
    wish: Wish
    landed: list[float]
    target: Landing | None = None
    run: Run | None = None
    step: int = 0
    replans: int = 0

    def __post_init__(self) -> None:
        """Stand."""
        self._changed = False
        self._look = np.inf
        self._changed_by = 0.0
        self._refused: Wish | None = None
        planned = self.gait.ahead(self.feet, replace(self.wish, stop=False, heading=None), 2)
        if not planned:
            x, _, z = (0.5 * (self.feet[-1].position + self.feet[-2].position)).tolist()
            raise InfeasibleError(
                f"start ({x:.2f}, {z:.2f}): no step can be taken from there; the ground ahead is "
                "too steep or has no place for a foot: start elsewhere or with another heading"
            )
        self._still = self._standing(planned)
        self._plan = LivePlan(plan_contact([self._still], self.body, self.ground), 0)

    # ------------------------------------------------------------------- what happens

    def wished(self, wish: Wish, time: float) -> None:
        """From ``time`` on, ``wish`` holds."""
        if wish != self.wish:
            self.wish, self._changed = wish, True
            if self._look == np.inf:
                self._plan_looks(time)
        if self.target is None:
            self._begin(time)

    @property
    def next_event(self) -> float:
        """When something is to be done: the foot lands, or a wish is looked at."""
        if self.run is None:
            return np.inf
        return min(self.run.end, self._look)

    def happen(self) -> None:
        """What is to be done at :attr:`next_event`."""
        assert self.run is not None
        if self._look < self.run.end:
            self._replan(self._look)
        else:
            self._land(self.run.end)

    def poses(self, times: Float[np.ndarray, "F"]) -> Poses:
        """Poses at ``times`` from the last event to the next."""
        phases = np.zeros(len(times)) if self.run is None else self.run.phase(times)
        return self._plan.poses(self.step, phases)

    # -------------------------------------------------------------------------- steps

    def _begin(self, time: float) -> None:
        """Start to walk, if that is wished and there is a way."""
        if self.wish is self._refused:
            return
        if not self.gait.ahead(self.feet, self.wish, 1):
            self._refused = self.wish
            return
        self._take(time, rate=0.0)

    def _land(self, time: float) -> None:
        """The swinging foot is down: the next step begins."""
        assert self.target is not None
        assert self.run is not None
        foot, rate = self.target, self.run.rates[1]
        self.feet.append(foot)
        self.landed.append(time)
        self.step += 1
        self.target, self.run, self._look = None, None, np.inf
        self._plan = self._plan.at_step(self.step)
        if foot.kind == "stop":
            self._begin(time)
        else:
            self._take(time, rate)

    def _take(self, time: float, rate: float) -> None:
        """Plan the step that begins at ``time``, with the phase passing at ``rate``."""
        self._changed = False
        following = self._shortened()
        self._pass(time, 0.0, rate, following)

    def _shortened(self) -> Landing | None:
        """Plan the step as is wished or, where this body cannot take it, shorter."""
        for share in (1.0, *SHORTENED):
            wish = replace(self.wish, length=share * self.wish.length)
            (self.target,) = self.gait.ahead(self.feet, wish, 1)
            try:
                return self._window(0.0)
            except InfeasibleError:
                if share == SHORTENED[-1]:
                    raise
        raise AssertionError

    def _replan(self, time: float) -> None:
        """Plan the rest of the present step anew."""
        assert self.run is not None
        assert self.target is not None
        phase = self.run.phase_at(time)
        rate = self.run.rate(time)
        (new,) = self.gait.ahead(self.feet, self.wish, 1, moving=self.target)
        old, left = self.target, self.run.end - time
        away = float(np.linalg.norm((new.position - old.position)[[0, 2]]))
        turned = abs(new.heading - old.heading)
        share = min(1.0, left * MOVES / max(away, 1e-9), left * TURNS / max(turned, 1e-9))
        if old.kind == "stop" == new.kind:
            share = 0.0
        self.target = self.gait.limited(old, new, self._stance(new.side), share)
        try:
            following = self._window(phase, old)
        except InfeasibleError:  # not in this step; the next one tries
            self.target = old
            self._look = np.inf
            return
        self._changed = share < 1.0  # more of it at the next look
        self._pass(time, phase, rate, following)

    def _stance(self, side: int) -> Landing:
        return self.feet[-1] if self.feet[-1].side != side else self.feet[-2]

    def _pass(self, time: float, phase: float, rate: float, following: Landing | None) -> None:
        """Let the phase go on from ``phase`` at ``rate``, to the rate that the steps ask for."""
        assert self.target is not None
        left, own = 1.0 - phase, self.target.period
        if self.target.kind == "stop":
            last, seconds = 0.0, 1.5 * left / max(rate, 0.5 / own)
        else:
            last = 1.0 / own if following is None else min(1.0 / own, 1.0 / following.period)
            seconds = self.target.duration if rate <= 0.0 else 2.0 * left / (rate + last)
        self.run = Run.of(time, seconds, phase, (rate, last))
        self._plan_looks(time)

    def _plan_looks(self, time: float) -> None:
        """When the present step is next looked at after ``time``, should it be at all."""
        self._look = np.inf
        if not self._changed or self.run is None:
            return
        first = self._plan.toe_off(self.step) + FIRST_LOOK
        looks = np.append(np.arange(first, HORIZON - 0.25 * LOOKS, LOOKS), HORIZON)
        later = looks[looks > self.run.phase_at(time) + 1e-6]
        if len(later):
            self._look = self.run.time_of(float(later[0]))

    # ------------------------------------------------------------------------ windows

    def _window(self, phase: float, old: Landing | None = None) -> Landing | None:
        """Plan the step before, the present one and the next; the footstep of the next one.

        ``old`` is where the foot was to land so far, None: as was foreseen in the step before.
        """
        assert self.target is not None
        self.replans += 1
        ahead = self.gait.ahead([*self.feet, self.target], self.wish, 2)
        if self.target.kind == "stop":
            ahead = []
        if ahead and ahead[0].kind == "stop":
            ahead = ahead[:1]
        new, first = self._contact(ahead)
        begin = max(self.step + phase, self.step + min(self._plan.toe_off(self.step), 1.0))
        blend = Blend(begin, self.step + 1.0)
        if self.target.kind == "start" and phase == 0.0:
            off = float(new.toe_off[self.step - first])
            blend = Blend(self.step, self.step + UNDER_WAY * off)
        row = self.step - self._plan.first
        foreseen = self._plan.contact.targets.position[row] if old is None else old.position
        changed = float(np.linalg.norm((self.target.position - foreseen)[[0, 2]]))
        self._changed_by = max(changed, 0.0 if phase == 0.0 else self._changed_by)
        self._plan = self._plan.become(new, first, self.step, blend, self._changed_by)
        return ahead[0] if ahead else None

    def _contact(self, ahead: Sequence[Landing]) -> tuple[ContactPlan, int]:
        """The window on the ground, and the number of its first step."""
        assert self.target is not None
        past = self.feet[-HISTORY:]
        stood = [i for i, foot in enumerate(past) if foot.stands]
        if stood:  # what was before it stood is over; of one foot of two nothing follows
            past = past[stood[-1] - 1 :] if stood[-1] else past[1:]
        rows = [*past, self.target, *ahead]
        plan, here = self.gait.plan(rows), len(past) - 2
        before = min(here, 1)
        planned = plan.steps()[here - before : here + 1 + min(len(ahead), 1)]
        own = self.step - before
        planned = [replace(s, index=own + i) for i, s in enumerate(planned)]
        prepared = prepared_steps(planned, self.generator, self.body)
        references: list[ReferenceStep] = [p.reference for p in prepared]
        kinds: list[StepKind] = [s.kind for s in planned]
        if self.target.kind == "start":
            references.insert(0, self._still)
            kinds.insert(0, "stand")
            own -= 1
        joined = join_all(references, kinds)
        if kinds[-1] == "stop":
            self._still = stand_still(joined[-1])
            joined.append(self._still)
        return plan_contact(joined, self.body, self.ground), own

    def _standing(self, planned: Sequence[Landing]) -> ReferenceStep:
        """Standing as somebody does who is about to start."""
        rows = [*self.feet, *planned]
        steps = self.gait.plan(rows).steps()
        first = prepared_steps(steps, self.generator, self.body)[0].reference
        curves = {name: np.stack([getattr(first.curves, name)[0]] * 2) for name in CURVES}
        flat = dict.fromkeys(("pitch", "meta", "bend"), np.zeros((2, 2)))
        swing = 1 - first.stance
        return first.with_(
            curves=StepCurves(phase=np.array([0.0, 1.0]), **(curves | flat)),
            toe_off=1.0,
            target=first.foothold[swing],
            target_heading=float(first.foothold_heading[swing]),
            speed_change=None,
        )
