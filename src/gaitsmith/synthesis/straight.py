"""Any straight-line walk along a straight plan."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.contact import ReferenceStep, StepCurves
from gaitsmith.conventions import UP, ahead, leftward
from gaitsmith.errors import InvalidInputError
from gaitsmith.synthesis.overlay import overlays, stride_of
from gaitsmith.synthesis.step import PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.upper_body import RuleOverlay
from gaitsmith.walks.model import StepRequest, climbs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.synthesis.overlay import Overlay, Overlayer
    from gaitsmith.walks.model import SagittalStep, StraightWalk

#: Footsteps farther than this from one line, meters or radians, are not a straight walk.
STRAIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class _Lines:
    """The lines that S steps walk along: half way between the lines of left and right feet.

    ``along`` and ``aside`` are meters ahead of the stance foot and to the left of the line, of the
    origin, the stance foot, the target and the footstep that follows it (the target where none
    does).
    """

    here: Float[np.ndarray, "S 3"]
    along: Float[np.ndarray, "S 4"]
    aside: Float[np.ndarray, "S 4"]

    @staticmethod
    def of(steps: Sequence[PlannedStep]) -> _Lines:
        """Refuses steps that turn or leave their line."""
        feet = [(s.origin, s.stance, s.target, s.following or s.target) for s in steps]
        places = np.array([[foot.position for foot in four] for four in feet])
        direction = np.array([s.stance.direction for s in steps])
        away = places - places[:, 1:2]
        along = (away * ahead(direction)[:, None]).sum(-1)
        left = leftward(direction)
        aside = (away * left[:, None]).sum(-1)
        bent = np.abs(aside[:, 2] - aside[:, 0]) > STRAIGHT
        bent |= np.array([s.target.direction for s in steps]) != direction
        if bent.any():
            raise InvalidInputError(
                f"step {steps[int(bent.argmax())].index} is not straight: its footsteps turn or "
                "leave their line; a straight walk needs footsteps of one direction on two "
                "parallel lines"
            )
        middle = 0.5 * aside[:, 2:3]
        return _Lines(places[:, 1] + middle * left, along, aside - middle)


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
        self._climbs = climbs(walk)
        self._sagittal = lru_cache(maxsize=512)(self._walk.step)

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        return self.prepare_all(body, state, [step])[0]

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """See :meth:`gaitsmith.synthesis.step.BatchGenerator.prepare_all`."""
        lines = _Lines.of(steps)
        # to a picometer, so that equal steps are recognized and drawn once
        along, aside = np.round(lines.along, 12).tolist(), np.round(lines.aside, 12).tolist()
        ends, asked = [], []
        for i, step in enumerate(steps):
            rise = float(step.target.position[1] - step.stance.position[1])
            request = StepRequest(
                side=step.stance.side,
                previous_length=-along[i][0],
                length=along[i][2],
                next_length=round(along[i][3] - along[i][2], 12) if step.following else 0.0,
                duration=round(step.duration, 12),
                rise=round(rise, 12),
                hip_height=_rounded(state.hip_height),
                kind=step.kind,
                previous_duration=_rounded(state.duration),
                stride=stride_of(step) % self._overlay.strides,
                climbs=climbs_of(step) if self._climbs else (0.0, 0.0),
            )
            setting = _Setting(
                direction=step.stance.direction,
                aside=(aside[i][1], aside[i][2]),
                foot_heading=(step.stance.heading, step.target.heading),
            )
            sagittal = self._sagittal(body, request)
            state = WalkerState(float(sagittal.center[-1, 1]) - rise, step.duration)
            ends.append(state)
            asked.append((request, setting))
        drawn = self._drawn(body, asked)
        return [
            self._placed(body, step, here, end, *drawn[one])
            for step, here, end, one in zip(steps, lines.here, ends, asked, strict=True)
        ]

    def _drawn(
        self, body: Body, asked: Sequence[tuple[StepRequest, _Setting]]
    ) -> dict[tuple[StepRequest, _Setting], tuple[float, StepCurves]]:
        """Toe-off and curves of every step that is asked for, each drawn once."""
        each = list(dict.fromkeys(asked))
        sagittal = [self._sagittal(body, request) for request, _ in each]
        laid = overlays(self._overlay, body, [request for request, _ in each], sagittal)
        return {
            one: (step.toe_off, _curves(one[0].side, step, over, one[1]))
            for one, step, over in zip(each, sagittal, laid, strict=True)
        }

    def _placed(
        self,
        body: Body,
        step: PlannedStep,
        here: Float[np.ndarray, "3"],
        end: WalkerState,
        toe_off: float,
        curves: StepCurves,
    ) -> PreparedStep:
        stance, target = step.stance, step.target
        side, foothold, heading = stance.side, np.empty((2, 3)), np.empty(2)
        foothold[side], foothold[1 - side] = stance.position, step.origin.position
        heading[side], heading[1 - side] = stance.heading, step.origin.heading
        reference = ReferenceStep.trusted(
            curves, here, side, toe_off, foothold, heading, target.position, target.heading
        )
        return TabledStep(step.duration, end, reference, body, self._ground)


def climbs_of(step: PlannedStep) -> tuple[float, float]:
    """What the request says of climbing, to a picometer."""
    before, this = (round(climb, 12) for climb in step.climbs)
    return before, this


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 12)


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
