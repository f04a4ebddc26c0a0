"""Any straight-line walk along a straight plan."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact import ReferenceStep, StepCurves
from gaitsmith.conventions import UP, ahead, leftward
from gaitsmith.errors import InvalidInputError
from gaitsmith.synthesis.overlay import stride_of
from gaitsmith.synthesis.step import PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.upper_body import RuleOverlay
from gaitsmith.walks.model import SagittalStep, StepRequest, StraightWalk

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.synthesis.overlay import Overlay, Overlayer

#: Footsteps farther than this from one line, meters or radians, are not a straight walk.
STRAIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class _Line:
    """The line a step walks along: a point of it, its direction and its left."""

    here: np.ndarray
    ahead: np.ndarray
    left: np.ndarray

    @staticmethod
    def of(step: PlannedStep) -> _Line:
        """Half way between the lines of the left and of the right feet."""
        line = _Line(
            step.stance.position, ahead(step.stance.direction), leftward(step.stance.direction)
        )
        middle = 0.5 * line.aside(step.target)
        if step.stance.direction != step.target.direction or (
            abs(line.aside(step.target) - line.aside(step.origin)) > STRAIGHT
        ):
            raise InvalidInputError(
                f"step {step.index} is not straight: its footsteps turn or leave their line; a "
                "straight walk needs footsteps of one direction on two parallel lines"
            )
        return _Line(line.here + middle * line.left, line.ahead, line.left)

    def along(self, foot: Footstep) -> float:
        """How far ahead of the stance foot, meters."""
        return float((foot.position - self.here) @ self.ahead)

    def aside(self, foot: Footstep) -> float:
        """How far to the left of the line, meters."""
        return float((foot.position - self.here) @ self.left)


def is_straight(step: PlannedStep) -> bool:
    """Whether :class:`StraightGenerator` walks this step: no turn, two parallel lines, no lean.

    A start or stop must have its feet side by side.
    """
    stance, target, origin = step.stance, step.target, step.origin
    if not (stance.direction == target.direction == origin.direction):
        return False
    if stance.lean != (0.0, 0.0) or target.lean != (0.0, 0.0) or origin.lean != (0.0, 0.0):
        return False
    if stance.gaze != (0.0, 0.0) or target.gaze != (0.0, 0.0) or origin.gaze != (0.0, 0.0):
        return False
    way, left = ahead(stance.direction), leftward(stance.direction)
    to_target, to_origin = target.position - stance.position, origin.position - stance.position
    if abs(float((to_target - to_origin) @ left)) > STRAIGHT:
        return False
    if step.kind == "start" and abs(float(to_origin @ way)) > STRAIGHT:
        return False
    return step.kind != "stop" or abs(float(to_target @ way)) <= STRAIGHT


@dataclass(frozen=True)
class _Setting:
    """How a step lies on its line; pairs are (stance, swing). Equal settings share curves."""

    direction: float
    aside: tuple[float, float]
    foot_heading: tuple[float, float]


class StraightGenerator:
    """Walks straight plans with any :class:`~gaitsmith.walks.model.StraightWalk`.

    Parameters
    ----------
    walk
        Gives hips and feet in the sagittal plane.
    ground
        Where the footsteps lie.
    overlay
        Pelvis, trunk, head and arms; None: the rules of :mod:`gaitsmith.synthesis.upper_body`.

    Notes
    -----
    What [KB92a] calls the degenerate case: on a straight line the curved walk must give the
    same poses.
    """

    def __init__(
        self, walk: StraightWalk, ground: Ground, overlay: Overlayer | None = None
    ) -> None:
        self._walk, self._ground, self._overlay = walk, ground, overlay or RuleOverlay()
        self._drawn = lru_cache(maxsize=512)(self._draw)

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        line = _Line.of(step)
        length = line.along(step.target)
        rise = float(step.target.position[1] - step.stance.position[1])
        request = StepRequest(
            side=step.stance.side,
            previous_length=-line.along(step.origin),
            length=length,
            next_length=line.along(step.following) - length if step.following else 0.0,
            duration=step.duration,
            rise=rise,
            hip_height=state.hip_height,
            kind=step.kind,
            previous_duration=state.duration,
            stride=stride_of(step) % self._overlay.strides,
        )
        setting = _Setting(
            direction=step.stance.direction,
            aside=(round(line.aside(step.stance), 12), round(line.aside(step.target), 12)),
            foot_heading=(step.stance.heading, step.target.heading),
        )
        sagittal, curves = self._drawn(body, _rounded(request), setting)
        stance, swing = step.stance.side, 1 - step.stance.side
        foothold, heading = np.empty((2, 3)), np.empty(2)
        foothold[stance], foothold[swing] = step.stance.position, step.origin.position
        heading[stance], heading[swing] = step.stance.heading, step.origin.heading
        reference = ReferenceStep(
            curves=curves,
            origin=line.here,
            stance=stance,
            toe_off=sagittal.toe_off,
            foothold=foothold,
            foothold_heading=heading,
            target=step.target.position,
            target_heading=step.target.heading,
        )
        height = float(sagittal.center[-1, 1]) - rise
        end = WalkerState(hip_height=height, duration=step.duration)
        return TabledStep(step.duration, end, reference, body, self._ground)

    def _draw(
        self, body: Body, request: StepRequest, setting: _Setting
    ) -> tuple[SagittalStep, StepCurves]:
        sagittal = self._walk.step(body, request)
        overlay = self._overlay(body, request, sagittal)
        return sagittal, _curves(request.side, sagittal, overlay, setting)


def _rounded(request: StepRequest) -> StepRequest:
    """Lengths to a picometer, so that equal steps are recognized and drawn once."""
    height, before = request.hip_height, request.previous_duration
    return replace(
        request,
        previous_length=round(request.previous_length, 12),
        length=round(request.length, 12),
        next_length=round(request.next_length, 12),
        duration=round(request.duration, 12),
        rise=round(request.rise, 12),
        hip_height=None if height is None else round(height, 12),
        previous_duration=None if before is None else round(before, 12),
    )


def _curves(stance: int, sagittal: SagittalStep, overlay: Overlay, setting: _Setting) -> StepCurves:
    """A sagittal step and its overlay about a point of the walk's line."""
    count = len(sagittal.phase)
    forward, left = ahead(setting.direction), leftward(setting.direction)

    def placed(points: np.ndarray, aside: np.ndarray | float) -> np.ndarray:
        side = np.broadcast_to(aside, (count,))[:, None]
        return points[:, :1] * forward + points[:, 1:] * UP + side * left

    by_side = [0, 1] if stance == 0 else [1, 0]  # (stance, swing) to (left, right)
    ankles = [placed(sagittal.ankle[:, i], setting.aside[i]) for i in by_side]
    return StepCurves(
        phase=sagittal.phase,
        center=placed(sagittal.center, overlay.sway),
        heading=np.full(count, setting.direction),
        pelvis=overlay.pelvis,
        ankle=np.stack(ankles, axis=1),
        foot_heading=np.tile([setting.foot_heading[i] for i in by_side], (count, 1)),
        pitch=sagittal.pitch[:, by_side],
        meta=sagittal.meta[:, by_side],
        bend=sagittal.bend[:, by_side],
        upper=overlay.upper,
    )
