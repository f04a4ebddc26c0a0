"""The steps of a walk side by side: where they are, and what the straight walk says of them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN
from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.plan.course import course_pieces
from gaitsmith.synthesis.asking import ROWS
from gaitsmith.synthesis.straight import STRAIGHT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.geometry.splines import PlaneCurves
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.synthesis.asking import Answer


@dataclass(frozen=True, eq=False)
class Bent:
    """Geometry of S steps: their places, the curves between them, and what leads along.

    ``before`` runs from beside the rear foot to beside the stance foot, ``after`` on to beside
    the target; lengths are arc lengths, meters.
    """

    stance: Int[np.ndarray, "S"]
    sign: Float[np.ndarray, "S"]
    place: Float[np.ndarray, "S 3 2"]
    heading: Float[np.ndarray, "S 3"]
    direction: Float[np.ndarray, "S 3"]
    curvature: Float[np.ndarray, "S 3"]
    middle: Float[np.ndarray, "S 3 2"]
    lean: Float[np.ndarray, "S 3 3"]
    gaze: Float[np.ndarray, "S 3 3"]

    @staticmethod
    def of(steps: Sequence[PlannedStep]) -> Bent:
        """Rear foot, stance foot, target of each step, in this order."""
        feet = {id(f): f for s in steps for f in (s.origin, s.stance, s.target)}
        number = {key: i for i, key in enumerate(feet)}
        each = np.array(
            [
                (
                    f.position[0],
                    f.position[2],
                    *f.middle,
                    f.heading,
                    f.direction,
                    f.curvature,
                    *f.lean,
                    *f.gaze,
                )
                for f in feet.values()
            ]
        )
        index = [[number[id(f)] for f in (s.origin, s.stance, s.target)] for s in steps]
        rows = each[np.array(index)]
        stance = np.array([s.stance.side for s in steps])
        return Bent(
            stance=stance,
            sign=SIDE_SIGN[stance],
            place=rows[..., 0:2],
            heading=rows[..., 4],
            direction=rows[..., 5],
            curvature=rows[..., 6],
            middle=rows[..., 2:4],
            lean=rows[..., 7:10],
            gaze=rows[..., 10:13],
        )

    @cached_property
    def curves(self) -> PlaneCurves:
        """The S curves from beside the rear foot to the stance foot, then those to the target."""
        middle, direction, curvature = self.middle, self.direction, self.curvature
        start, end = (np.concatenate([middle[:, i], middle[:, i + 1]]) for i in (0, 1))
        turned, bend = (
            tuple(np.concatenate([values[:, i], values[:, i + 1]]) for i in (0, 1))
            for values in (direction, curvature)
        )
        return course_pieces(start, end, (turned[0], turned[1]), (bend[0], bend[1]))

    @cached_property
    def length(self) -> Float[np.ndarray, "S 2"]:
        """Arc lengths of the curves before and after."""
        return self.curves.length().reshape(2, -1).T

    def rows(self, index: Int[np.ndarray, "k"]) -> Bent:
        """Some of the steps, in their order."""
        if len(index) == len(self.stance):
            return self
        return Bent(*(getattr(self, f.name)[index] for f in fields(self)))

    def straight(self, steps: Sequence[PlannedStep]) -> Bool[np.ndarray, "S"]:
        """Which steps :class:`StraightGenerator` walks: no turn, two parallel lines, no lean.

        A start or stop must have its feet side by side.
        """
        out = (self.direction == self.direction[:, 1:2]).all(-1)
        aside = self.lean.any(axis=(1, 2)) | self.gaze[..., 1:].any(axis=(1, 2))
        aside |= (self.gaze[..., 0] != self.direction).any(axis=1)
        out &= ~(aside | self.curvature.any(axis=1))
        sin, cos = sine_cosine(self.direction[:, 1:2])
        away = self.place - self.place[:, 1:2]
        along = away[..., 0] * sin + away[..., 1] * cos
        aside = away[..., 0] * cos - away[..., 1] * sin
        out &= np.abs(aside[:, 2] - aside[:, 0]) <= STRAIGHT
        for kind, foot in (("start", 0), ("stop", 2)):
            which = np.array([s.kind == kind for s in steps])
            out &= ~which | (np.abs(along[:, foot]) <= STRAIGHT)
        return out


@dataclass(frozen=True, eq=False)
class Flat2D:
    """The sagittal samples of S steps one after the other, x stretched to the true lengths.

    Attributes
    ----------
    first, counts
        ``(S,)`` index of each step's first sample, and how many it has.
    step
        ``(M,)`` index of the step of each sample.
    swing
        ``(M,)`` 0 up to toe-off, 1 at heel strike.
    off
        ``(S,)`` index of the sample at toe-off.
    """

    first: Int[np.ndarray, "S"]
    counts: Int[np.ndarray, "S"]
    step: Int[np.ndarray, "M"]
    off: Int[np.ndarray, "S"]
    phase: Float[np.ndarray, "M"]
    toe_off: Float[np.ndarray, "S"]
    swing: Float[np.ndarray, "M"]
    center: Float[np.ndarray, "M 2"]
    ankle: Float[np.ndarray, "M 2 2"]
    asked: Float[np.ndarray, "S 2"]
    table: Float[np.ndarray, "C M"]

    @staticmethod
    def of(answers: Sequence[Answer], length: Float[np.ndarray, "S 2"]) -> Flat2D:
        """Put the answers on one axis, for steps whose true lengths are ``length``."""
        counts = np.array([len(s.phase) for s in answers])
        first = np.concatenate([[0], np.cumsum(counts)[:-1]])
        step = np.repeat(np.arange(len(answers)), counts)
        phase = np.concatenate([s.phase for s in answers])
        toe_off = np.array([s.toe_off for s in answers])
        off = first + np.array([int(s.phase.searchsorted(s.toe_off)) for s in answers])
        lifted = np.repeat(toe_off, counts)
        swing = np.maximum((phase - lifted) / (1.0 - lifted), 0.0)
        asked = np.array([(s.previous, s.length) for s in answers])
        table = np.concatenate([answer.table() for answer in answers], axis=1)
        center = np.array(table[ROWS["center"]]).T
        # very short steps are asked for longer: smoothly pressed together over the step
        ratio = np.where(asked > 0.0, length / np.where(asked > 0.0, asked, 1.0), 1.0)
        ratio = np.where(np.abs(ratio - 1.0) < 1e-9, 1.0, ratio)
        ease = smoothstep(phase)
        early, late = np.repeat(ratio.T, counts, axis=1)
        center[:, 0] *= early + ease * (late - early)
        return Flat2D(
            first=first,
            counts=counts,
            step=step,
            off=off,
            phase=phase,
            toe_off=toe_off,
            swing=swing,
            center=center,
            ankle=table[ROWS["ankle"]].reshape(2, 2, -1).transpose(2, 0, 1),
            asked=asked,
            table=table,
        )

    def each(self, values: Float[np.ndarray, "S *c"]) -> Float[np.ndarray, "M *c"]:
        """What belongs to a step, given to each of its samples; components contiguous."""
        return np.repeat(values.T, self.counts, axis=-1).T

    def column(self, name: str) -> Float[np.ndarray, "M c"]:
        """Samples of one of the curves, each component contiguous."""
        return self.table[ROWS[name]].T

    @property
    def last(self) -> Int[np.ndarray, "S"]:
        """Index of each step's last sample."""
        return self.first + self.counts - 1
