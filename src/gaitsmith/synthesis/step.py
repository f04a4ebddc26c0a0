"""Seam 2: plan one step, then show any instant of it; and whole walks made of such steps."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from gaitsmith.contact import StepCurves, plan_contact
from gaitsmith.contact.step_curves import CURVES
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.synthesis.clock import Clock
from gaitsmith.synthesis.join import join_all

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact import ContactPlan, Poses, ReferenceStep
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.plan.timeline import Timeline


#: Seconds of a usual step: a shorter while of standing counts as the part of one that it is.
USUAL = 0.5


@dataclass(frozen=True)
class WalkerState:
    """What a step inherits from the one before.

    Attributes
    ----------
    hip_height
        Height of the hips over the stance foot's floor as the last step left them, before any
        correction, meters; None at the start of a walk.
    duration
        Seconds that the last step took; None at the start of a walk.
    local
        How a local step left the walker; None: in standing.
    """

    hip_height: float | None = None
    duration: float | None = None
    local: LocalState | None = None


@dataclass(frozen=True)
class LocalState:
    """How a local step leaves the walker: [KB93] section 3's state, of what is not in the feet.

    Attributes
    ----------
    center
        x, z of the hips, meters.
    speed
        Their velocity, meters per second.
    heading, gaze
        Of the pelvis and of the gaze, radians.
    pitch
        Of the soles of [left, right], toes up positive.
    arms
        Forward swing of [left, right] and how far both are held apart, beyond rest, radians.
    """

    center: tuple[float, float]
    speed: tuple[float, float]
    heading: float
    gaze: float
    pitch: tuple[float, float]
    arms: tuple[float, float, float] = (0.0, 0.0, 0.0)


@runtime_checkable
class PreparedStep(Protocol):
    """One step, planned to the end and ready to be looked at.

    Everything costly happened in ``prepare``; ``poses`` is O(1) per phase, pure, and may be
    called in any order: the same object serves a film renderer, which asks for all phases at
    once, and a browser that skips frames ([KB93] section 3).
    """

    duration: float
    end: WalkerState
    reference: ReferenceStep

    def poses(self, phases: Float[np.ndarray, "n"]) -> Poses:
        """Poses at normalized times ``phases``: 0 starts the step, 1 ends it.

        The step stands alone here: its legs are kept in reach and its feet on the ground
        without regard to its neighbors. :class:`PreparedWalk` regards them.
        """
        ...


@runtime_checkable
class StepGenerator(Protocol):
    """A way of stepping: straight walk, curved walk, elevation walk, sidestep, turnaround."""

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """Plan one step from ``state``; raise InfeasibleStepError if impossible."""
        ...


@runtime_checkable
class BatchGenerator(Protocol):
    """A step generator that plans consecutive steps together."""

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """What ``prepare`` gives step after step, each from where the one before ends."""
        ...


@dataclass(eq=False)
class TabledStep:
    """A prepared step that is its reference curves: what every generator here returns."""

    duration: float
    end: WalkerState
    reference: ReferenceStep
    body: Body
    ground: Ground
    _plan: ContactPlan | None = None

    def poses(self, phases: Float[np.ndarray, "n"]) -> Poses:
        """See :meth:`PreparedStep.poses`."""
        if self._plan is None:
            self._plan = plan_contact([self.reference], self.body, self.ground)
        return self._plan.poses(np.asarray(phases, dtype=np.float64))


class Bending(Protocol):
    """What is laid over finished poses: a bent trunk, a turned head."""

    def applied(self, times: Float[np.ndarray, "F"], poses: Poses) -> Poses:
        """The same poses, bent as at ``times``, seconds."""
        ...


@dataclass(frozen=True, eq=False)
class PreparedWalk:
    """Steps, their common contact plan and the clock: a walk that can be looked at any time.

    ``references`` are the joined proposals that ``contact`` was planned from; ``dodge`` is how
    the body bends past things.
    """

    plan: StepPlan | Timeline
    contact: ContactPlan
    clock: Clock
    attention: Bending | None = None
    references: tuple[ReferenceStep, ...] = ()
    dodge: Bending | None = None

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.clock.duration

    def poses(self, times: Float[np.ndarray, "F"]) -> Poses:
        """Poses at ``times`` in seconds, in [0, duration], in any order."""
        poses = self.contact.poses(self.clock.walk_phase(times))
        for more in (self.attention, self.dodge):
            poses = poses if more is None else more.applied(times, poses)
        return poses


def prepare_walk(
    plan: StepPlan | Timeline,
    generator: StepGenerator,
    body: Body,
    ground: Ground,
    *,
    rest: float = 0.0,
) -> PreparedWalk:
    """Plan every step of ``plan``, join them and put the feet on the ground.

    ``rest`` seconds of standing follow a walk that ends in standing.
    """
    prepared = prepared_steps(plan.steps(), generator, body)
    stands = plan.kinds[-1] not in ("start", "walk")
    clock = Clock.of(plan, rest=rest if stands else 0.0)
    references = join_all([p.reference for p in prepared], plan.kinds)
    if stands:
        references.append(stand_still(references[-1]))
    attention = None
    if not isinstance(plan, StepPlan):
        from gaitsmith.synthesis.attention import Attention, balanced  # late: of scripts only

        attention = Attention(body, plan.looks, plan.leans)
        references = balanced(references, plan.kinds, clock, attention)
    references = [
        r.with_(share=min(1.0, seconds / USUAL)) if kind == "stand" else r
        for r, kind, seconds in zip_longest(references, plan.kinds, plan.durations)
    ]
    contact = plan_contact(references, body, ground)
    return PreparedWalk(plan, contact, clock, attention, tuple(references))


def prepared_steps(
    steps: list[PlannedStep], generator: StepGenerator, body: Body
) -> list[PreparedStep]:
    """All steps, at once where the generator can."""
    if isinstance(generator, BatchGenerator):
        return generator.prepare_all(body, WalkerState(), steps)
    state, out = WalkerState(), []
    for step in steps:
        done = generator.prepare(body, state, step)
        out.append(done)
        state = done.end
    return out


def stand_still(last: ReferenceStep) -> ReferenceStep:
    """A step in which nothing moves, from the end of ``last``."""
    swing = 1 - last.stance
    foothold, heading = np.array(last.foothold), np.array(last.foothold_heading)
    foothold[swing], heading[swing] = last.target, last.target_heading
    still = {name: np.stack([getattr(last.curves, name)[-1]] * 2) for name in CURVES}
    flat = dict.fromkeys(("pitch", "meta", "bend"), np.zeros((2, 2)))
    return last.with_(
        speed_change=None,
        curves=StepCurves(phase=np.array([0.0, 1.0]), **(still | flat)),
        toe_off=1.0,
        foothold=foothold,
        foothold_heading=heading,
    )
