"""A footstep, and a plan of them in order of landing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.plan.course import (
    course_change,
    course_curvature,
    course_gaze,
    course_lean,
    course_lengths,
    course_middle,
)

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.conventions import StepKind


@dataclass(frozen=True, eq=False)
class Footstep:
    """One foot, flat on the ground.

    Attributes
    ----------
    side
        0 left, 1 right.
    position
        ``(3,)`` N, meters.
    heading
        Of the foot, toe-out included, radians.
    direction
        Of the walk at this footstep, radians.
    time
        Seconds of landing.
    middle
        ``(2,)`` x,z of the point beside it on the line between left and right footsteps.
    curvature
        Change of direction per meter of the walk here.
    lean, gaze
        Tangent of the lean that the curve asks for here, left positive; heading that the face
        looks to, radians. Their first and second changes per meter go with them.
    """

    side: int
    position: Float[np.ndarray, "3"]
    heading: float
    direction: float
    time: float
    middle: Float[np.ndarray, "2"]
    curvature: float = 0.0
    lean: tuple[float, float, float] = (0.0, 0.0, 0.0)
    gaze: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class LocalStep:
    """How a local step is taken: the attribute parameters of [KB93] section 4.

    Attributes
    ----------
    swing_height
        swhf: 1 lifts the foot by 5 cm at most, 0 drags it.
    angles
        Foot pitches (stance at HSM+, swing at HSM+, swing at TOM), toes up positive, radians;
        None: what suits the step.
    gaze
        Heading looked at as the step begins, before any of ``glances``; None: what the step
        before left, else straight ahead.
    glances
        Turns of the gaze: (radians, phase at which it begins, phase at which it ends). They may
        begin before the step or end after it: the gaze leads.
    closes
        Whether the step ends in standing.
    toe_off
        Phase at which the swing foot leaves, once the weight is over the other; None: usual.
    """

    swing_height: float = 1.0
    angles: tuple[float, float, float] | None = None
    gaze: float | None = None
    glances: tuple[tuple[float, float, float], ...] = ()
    closes: bool = False
    toe_off: float | None = None


@dataclass(frozen=True, eq=False)
class PlannedStep:
    """One step of a plan: the swing foot goes from ``origin`` to ``target``.

    ``stance`` stays; ``following`` is where the stance foot goes next, None at the end;
    ``before`` is where the stance foot came from, None at the beginning. ``local`` says how a
    local step is taken; None: a step of a walk. ``gait`` names another gait than the person's
    own. ``climbs``: on level footsteps that are lifted onto the ground afterwards, meters that the
    stance foot lies above the rear one there, and the target above the stance foot.
    """

    index: int
    kind: StepKind
    stance: Footstep
    origin: Footstep
    target: Footstep
    before: Footstep | None
    following: Footstep | None
    duration: float
    local: LocalStep | None = None
    gait: str | None = None
    climbs: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class StepPlan:
    """N footsteps in order of landing; the first two are where the feet stand at time 0.

    Of those two the rear one comes first, or the left one where they stand side by side. From
    the third on, sides alternate.

    Attributes
    ----------
    side, position, heading, direction, time
        ``(N,)``, ``(N, 3)``, ``(N,)``, ``(N,)``, ``(N,)``: see :class:`Footstep`.
    kinds
        Kind of each of the N - 2 steps.
    path
        ``(P, 2)`` x,z of the path that the plan follows, at most 2 cm apart, or None.
    middle, lean, gaze
        ``(N, 2)``, ``(N,)``, ``(N,)``: see :class:`Footstep`; ``gaze`` is how far it goes beyond
        ``direction``, left positive. None: what the footsteps say by
        themselves (:mod:`gaitsmith.plan.course`).
    """

    side: Int[np.ndarray, "N"]
    position: Float[np.ndarray, "N 3"]
    heading: Float[np.ndarray, "N"]
    direction: Float[np.ndarray, "N"]
    time: Float[np.ndarray, "N"]
    kinds: tuple[StepKind, ...]
    path: Float[np.ndarray, "P 2"] | None = None
    middle: Float[np.ndarray, "N 2"] | None = None
    lean: Float[np.ndarray, "N"] | None = None
    gaze: Float[np.ndarray, "N"] | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.side)
        if count < 3:
            raise InvalidInputError(f"a plan needs at least one step (3 footsteps), got {count}")
        for name, shape, dtype in (
            ("side", (count,), np.int64),
            ("position", (count, 3), np.float64),
            ("heading", (count,), np.float64),
            ("direction", (count,), np.float64),
            ("time", (count,), np.float64),
        ):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape, dtype))
        if self.path is not None:
            object.__setattr__(self, "path", frozen_array("path", self.path, (None, 2)))
        if len(self.kinds) != count - 2:
            raise InvalidInputError(
                f"{count} footsteps make {count - 2} steps, got {len(self.kinds)} kinds"
            )
        if not np.isin(self.side, (0, 1)).all():
            raise InvalidInputError("side must be 0 (left) or 1 (right) for every footstep")
        if self.side[0] == self.side[1]:
            raise InvalidInputError(
                f"the initial feet must be a left and a right one, both are {SIDES[self.side[0]]}"
            )
        same = np.flatnonzero(self.side[3:] == self.side[2:-1]) + 2
        if same.size:
            i = int(same[0])
            raise InvalidInputError(
                f"sides must alternate: footsteps {i} and {i + 1} are both {SIDES[self.side[i]]}"
            )
        if self.time[0] != 0.0 or self.time[1] != 0.0 or (np.diff(self.time[1:]) <= 0.0).any():
            raise InvalidInputError("time must be 0 for both initial feet and then rise")
        self._complete()

    def _complete(self) -> None:
        """Fill in middle, lean and gaze."""
        count, middle = len(self.side), self.middle
        if middle is None:
            middle = course_middle(self.side, self.position, self.direction)
        lean, gaze = self.lean, self.gaze
        if lean is None or gaze is None:
            curvature = course_curvature(middle, self.direction)
            lengths = course_lengths(middle, self.direction, curvature)
            along = np.concatenate([[0.0], np.cumsum(lengths)])
            if lean is None:
                lean = course_lean(self.direction, lengths, self.time)
            if gaze is None:
                gaze = course_gaze(lambda s: np.interp(s, along, self.direction), along)
        object.__setattr__(self, "middle", frozen_array("middle", middle, (count, 2)))
        object.__setattr__(self, "lean", frozen_array("lean", lean, (count,)))
        object.__setattr__(self, "gaze", frozen_array("gaze", gaze, (count,)))

    @property
    def durations(self) -> Float[np.ndarray, "steps"]:
        """``(N - 2,)`` seconds of each step."""
        return np.diff(self.time[1:])

    @property
    def step_lengths(self) -> Float[np.ndarray, "N-1"]:
        """``(N - 1,)`` meters from each footstep to the next, along the walk."""
        assert self.middle is not None
        curvature = course_curvature(self.middle, self.direction)
        return course_lengths(self.middle, self.direction, curvature)

    def footstep(self, index: int) -> Footstep:
        """The footstep at ``index``."""
        return self.footsteps()[index]

    def footsteps(self) -> list[Footstep]:
        """All footsteps, in order of landing."""
        assert self.middle is not None
        assert self.lean is not None
        assert self.gaze is not None
        curvature = course_curvature(self.middle, self.direction)
        leading = []
        for values in (self.lean, self.direction + self.gaze):
            change = course_change(values, self.middle)
            further = course_change(change, self.middle)
            leading.append(np.stack([values, change, further], axis=-1).tolist())
        columns = zip(
            self.side.tolist(),
            self.position,
            self.heading.tolist(),
            self.direction.tolist(),
            self.time.tolist(),
            self.middle,
            curvature.tolist(),
            *(map(tuple, values) for values in leading),
            strict=True,
        )
        return [Footstep(*row) for row in columns]

    def steps(self) -> list[PlannedStep]:
        """Every step, in order."""
        feet = self.footsteps()
        stands = {foot.side: foot for foot in feet[:2]}
        came_from: dict[int, Footstep] = {}
        out = []
        for i, kind in enumerate(self.kinds):
            target = feet[i + 2]
            origin, stance = stands[target.side], stands[1 - target.side]
            out.append(
                PlannedStep(
                    index=i,
                    kind=kind,
                    stance=stance,
                    origin=origin,
                    target=target,
                    before=came_from.get(stance.side),
                    following=feet[i + 3] if i + 3 < len(feet) else None,
                    duration=target.time - feet[i + 1].time,
                )
            )
            came_from[target.side], stands[target.side] = origin, target
        return out
