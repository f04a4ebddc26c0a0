"""Any straight walk along any footsteps, [KB92a] sections 3 to 5.

For every step the paper considers its *underlying 2D step*: as long as the curve between the
points beside the two footsteps. A straight walk answers it; here the answer is bent. All steps
of a walk are bent at once, on all their samples.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.contact import ReferenceStep, StepCurves
from gaitsmith.contact.step_curves import CURVES, WIDTH, curve_of
from gaitsmith.conventions import BANKINGS, LEFT, RIGHT
from gaitsmith.errors import InfeasibleStepError, InvalidInputError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.plan.course import lean_lever
from gaitsmith.synthesis.asking import SETTLED, SHORTEST, Answer, Asker, usual_duration
from gaitsmith.synthesis.bent import Bent, Flat2D
from gaitsmith.synthesis.center import CenterPath, anchored, track
from gaitsmith.synthesis.overlay import ArmedOverlayer, stride_of
from gaitsmith.synthesis.step import PreparedStep, TabledStep, WalkerState
from gaitsmith.synthesis.straight import StraightGenerator, climbs_of
from gaitsmith.synthesis.swing_path import SwingPath
from gaitsmith.synthesis.turning import TRUNK_LEAN, Turning, bend_upper
from gaitsmith.synthesis.upper_body import RuleOverlay
from gaitsmith.walks.model import StepRequest, StraightWalk, climbs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.footsteps import Footstep, PlannedStep
    from gaitsmith.synthesis.overlay import Overlayer


class CurvedGenerator:
    """Walks any plan with any :class:`~gaitsmith.walks.model.StraightWalk`.

    Parameters
    ----------
    walk
        Gives hips and feet in the sagittal plane.
    ground
        Where the footsteps lie.
    overlay
        Pelvis, trunk, head and arms; None: the rules of :mod:`gaitsmith.synthesis.upper_body`.
    mode
        How the hips travel, seen from above. ``"track"``: on the curve between the footsteps.
        ``"anchored"``: straight ahead of the stance foot while both feet bear, then a spline,
        as the paper draws it, its drift removed (erratum D10).
    banking
        ``"body"``: hips and trunk together are so far inside the feet that the center of mass
        leans by [KB92a] Eq. 4, the trunk upright, as people do. ``"trunk"``: the trunk alone
        bends inside until it does, as the paper has it. ``"none"``.
    exact
        Draw every step by itself, straight ones too: slower, for comparison.

    Notes
    -----
    On straight parts the walk is the straight walk; [KB92a] section 5.3, last paragraph.
    """

    def __init__(
        self,
        walk: StraightWalk,
        ground: Ground,
        overlay: Overlayer | None = None,
        *,
        mode: str = "track",
        banking: str = "body",
        exact: bool = False,
    ) -> None:
        self._walk, self._ground, self._overlay = walk, ground, overlay or RuleOverlay()
        self._mode = one_of("mode", mode, ("track", "anchored"))
        self._banking = one_of("banking", banking, BANKINGS)
        self._exact = exact
        self._straight = StraightGenerator(walk, ground, self._overlay)
        self._asker, self._climbs = Asker(walk, self._overlay), climbs(walk)

    def prepare(self, body: Body, state: WalkerState, step: PlannedStep) -> PreparedStep:
        """See :meth:`gaitsmith.synthesis.step.StepGenerator.prepare`."""
        return self.prepare_all(body, state, [step])[0]

    def prepare_all(
        self, body: Body, state: WalkerState, steps: Sequence[PlannedStep]
    ) -> list[PreparedStep]:
        """Plan consecutive steps from ``state``.

        The same as one after the other to a millimeter, and much quicker: many steps are read
        off a table of the straight walk's (:mod:`gaitsmith.synthesis.asking`).
        """
        bent = Bent.of(steps)
        straight = [not self._exact and same for same in bent.straight(steps).tolist()]
        if all(straight):
            return self._straight.prepare_all(body, state, steps)
        tabled = not self._exact and len(steps) > 1
        # the table is of one pace; so are then the steps that it does not hold
        pace = usual_duration(steps) if tabled else None
        requests = _requests(body, state, steps, bent.length, self._overlay.strides, pace)
        if self._climbs:
            requests = [
                replace(r, climbs=climbs_of(s)) for r, s in zip(requests, steps, strict=True)
            ]
        anchor = _steady(bent.length[:, 1])
        if tabled:
            _bend_ends(straight, bent.length, anchor)
        curved = [i for i, same in enumerate(straight) if not same]
        read: dict[int, Answer | None] = {}
        climbing = any(requests[i].rise or any(requests[i].climbs) for i in curved)
        if tabled and curved:
            asked = [requests[i] for i in curved]
            if climbing:  # no two steps are alike: all are asked for, at once
                table = self._asker.answers(body, asked)
            else:
                table = self._asker.table(body, asked, anchor)
            read = dict(zip(curved, table, strict=True))
        out: dict[int, PreparedStep] = {}
        answers: list[Answer] = []
        for same, run in groupby(range(len(steps)), straight.__getitem__):
            which = list(run)
            if same:
                done = self._straight.prepare_all(body, state, [steps[i] for i in which])
                out |= dict(zip(which, done, strict=True))
                state = done[-1].end
                continue
            for i in which:
                before = answers[-1] if i and not straight[i - 1] else None
                answer = read.get(i)
                if answer is None:
                    request = replace(requests[i], hip_height=_rounded(state))
                    answer = self._ask(body, request, steps[i])
                answer.raised_from(state.hip_height)
                if before is not None and before.asked != answer.asked:
                    answer.joined_to(before)
                answers.append(answer)
                state = WalkerState(answer.end_height - requests[i].rise, steps[i].duration)
        if curved:
            rows = np.array(curved)
            done = self._bend(body, [steps[i] for i in curved], bent.rows(rows), answers)
            out |= dict(zip(curved, done, strict=True))
        return [out[i] for i in range(len(steps))]

    def _ask(self, body: Body, request: StepRequest, step: PlannedStep) -> Answer:
        try:
            return self._asker.ask(body, request)
        except InfeasibleStepError as error:
            raise _named(error, step) from None

    # ------------------------------------------------------------------- bending

    def _bend(
        self,
        body: Body,
        steps: Sequence[PlannedStep],
        bent: Bent,
        answers: Sequence[Answer],
    ) -> list[PreparedStep]:
        flat = Flat2D.of(answers, bent.length)
        offset = lean_lever(body) if self._banking == "body" else 0.0
        draw = track if self._mode == "track" else anchored
        path = draw(bent, flat, offset, standing=_standing(steps))
        upper = flat.column("upper").reshape(len(flat.step), -1, 3)
        trunk = TRUNK_LEAN.get(self._banking, 0.0)
        table = np.empty((WIDTH + 3 * upper.shape[1], len(flat.step)))
        curves = {name: curve_of(table, name) for name in CURVES}
        place = path.place + flat.column("sway") * path.left
        curves["center"][:, [0, 2]] = place
        curves["center"][:, 1] = _height(body, bent, flat, path)
        curves["heading"][:] = path.heading
        SwingPath.of(body, bent, flat).read(bent, flat, curves["ankle"], curves["foot_heading"])
        left = flat.each(bent.stance == LEFT)
        for name in ("pitch", "meta", "bend"):  # of (stance, swing) to (left, right)
            stance, swing = flat.column(name).T
            curves[name][:, LEFT] = np.where(left, stance, swing)
            curves[name][:, RIGHT] = np.where(left, swing, stance)
        curves["upper"][:], curves["pelvis"][:] = upper, flat.column("pelvis")
        turn = Turning(path.gaze, trunk * path.lean, path.bend * _walking(steps, flat))
        bend_upper(body, curves["upper"], curves["pelvis"], turn, self._arms_middle(body))
        for name, values in curves.items():
            if not np.isfinite(values).all():
                raise InvalidInputError(f"{name} of a step is not finite; its walk is no good")
        return self._cut(body, steps, bent, flat, answers, table)

    def _arms_middle(self, body: Body) -> Float[np.ndarray, "U 3"] | None:
        overlay = self._overlay
        return overlay.arms_middle(body) if isinstance(overlay, ArmedOverlayer) else None

    def _cut(
        self,
        body: Body,
        steps: Sequence[PlannedStep],
        bent: Bent,
        flat: Flat2D,
        answers: Sequence[Answer],
        table: Float[np.ndarray, "C M"],
    ) -> list[PreparedStep]:
        """Steps of their own again."""
        origin = np.array([s.stance.position for s in steps])
        away = flat.each(origin * [1.0, 0.0, 1.0])  # heights are from the stance foot's floor
        curve_of(table, "center")[:] -= away
        curve_of(table, "ankle")[:] -= away[:, None]
        foothold, heading = np.empty((len(steps), 2, 3)), np.empty((len(steps), 2))
        every = np.arange(len(steps))
        for k, side in ((0, 1 - bent.stance), (1, bent.stance)):
            foothold[every, side] = [(s.origin, s.stance)[k].position for s in steps]
            heading[every, side] = bent.heading[:, k]
        first = [*flat.first.tolist(), len(flat.step)]
        out: list[PreparedStep] = []
        for i, (step, answer) in enumerate(zip(steps, answers, strict=True)):
            stance, target = step.stance, step.target
            reference = ReferenceStep.trusted(
                StepCurves.trusted(answer.phase, table[:, first[i] : first[i + 1]]),
                origin[i],
                stance.side,
                answer.toe_off,
                foothold[i],
                heading[i],
                target.position,
                target.heading,
            )
            rise = float(target.position[1] - stance.position[1])
            end = WalkerState(answer.end_height - rise, step.duration)
            out.append(TabledStep(step.duration, end, reference, body, self._ground))
        return out


def _requests(
    body: Body,
    state: WalkerState,
    steps: Sequence[PlannedStep],
    lengths: Float[np.ndarray, "S 2"],
    strides: int,
    pace: float | None = None,
) -> list[StepRequest]:
    """The underlying 2D steps, [KB92a] section 3: as long as the curves beside the footsteps.

    They take ``pace`` seconds each; None: the steps' own.
    """
    least = SHORTEST * body.leg_length
    asked = np.round(np.maximum(lengths, least), 12).tolist()
    last = state.duration
    out = []
    for step, (previous, length) in zip(steps, asked, strict=True):
        stance, target, following = step.stance, step.target, 0.0
        if step.following is not None:
            following = math.dist(step.following.middle, target.middle)
        before = last if pace is None else None
        out.append(
            StepRequest(
                side=stance.side,
                previous_length=0.0 if step.kind == "start" else previous,
                length=0.0 if step.kind == "stop" else length,
                next_length=0.0 if following < 1e-9 else round(max(following, least), 12),
                duration=round(step.duration, 12) if pace is None else pace,
                rise=round(float(target.position[1] - stance.position[1]), 12),
                kind=step.kind,
                previous_duration=None if before is None else round(before, 12),
                stride=stride_of(step) % strides,
            )
        )
        last = step.duration
    return out


def _steady(lengths: Float[np.ndarray, "S"]) -> float:
    """The length that most steps have, if some have one; editing a step does not change it."""
    values, counts = np.unique(np.round(lengths, 9), return_counts=True)
    i = int(counts.argmax())
    return float(values[i]) if counts[i] >= 3 else 0.0


def _rounded(state: WalkerState) -> float | None:
    return None if state.hip_height is None else round(state.hip_height, 12)


def _bend_ends(straight: list[bool], lengths: Float[np.ndarray, "S 2"], anchor: float) -> None:
    """Where a straight part joins a curve, draw it as the curve is drawn up to a steady step.

    Steps off the grid of the table differ from the straight walk's by a hair; steady steps are
    on it, so the change from one to the other is made there and nothing jumps.
    """
    for i in range(1, len(straight)):
        if straight[i] and not straight[i - 1] and abs(lengths[i, 0] - anchor) > 1e-9:
            straight[i] = False
    for i in range(len(straight) - 2, -1, -1):
        if straight[i] and not straight[i + 1] and abs(lengths[i, 1] - anchor) > 1e-9:
            straight[i] = False


def _standing(steps: Sequence[PlannedStep]) -> Float[np.ndarray, "S 2 2"]:
    """How far from beside the stance foot the hips are when it starts and ends in standing."""
    out = np.zeros((len(steps), 2, 2))
    for i, step in enumerate(steps):
        for end, kind, other in ((0, "start", step.origin), (1, "stop", step.target)):
            if step.kind == kind:
                out[i, end] = _between(step.stance, other) - step.stance.middle
    return out


def _walking(steps: Sequence[PlannedStep], flat: Flat2D) -> Float[np.ndarray, "M"]:
    """0 in standing, 1 in the walk."""
    eased = smoothstep(flat.phase)
    starts, stops = (flat.each(np.array([s.kind == k for s in steps])) for k in ("start", "stop"))
    return np.where(starts, eased, np.where(stops, 1.0 - eased, 1.0))


def _between(one: Footstep, other: Footstep) -> Float[np.ndarray, "2"]:
    return 0.5 * (one.position + other.position)[[0, 2]]


def _height(body: Body, bent: Bent, flat: Flat2D, center: CenterPath) -> Float[np.ndarray, "M"]:
    """Height of the hips: the dynamic leg length of the 2D step, [KB92a] Eq. 5.

    With the STANCE hip (erratum D9). At the start of a step the height is the one the step
    before ended with; the difference is gone by toe-off, or later where that is early.
    """
    up = flat.center[:, 1]
    over_ankle = up - body.foot.ankle_height
    stands = bent.place[:, 1]
    aside = ((stands - bent.middle[:, 1]) * _left(bent.direction[:, 1])).sum(-1)
    half = 0.5 * body.hip_width
    straight = flat.center[:, 0] ** 2 + flat.each((half - bent.sign * aside) ** 2)

    # the stance hip from the stance foot
    x, z = (center.place + flat.each(half * bent.sign)[:, None] * center.left - flat.each(stands)).T
    square = over_ankle**2 + straight - (x * x + z * z)
    extra = np.sqrt(np.maximum(square, (0.5 * over_ankle) ** 2)) - over_ankle
    # what the step before ended with: its stance foot was the rear foot of this one
    start = flat.first
    aside_rear = ((bent.place[:, 0] - bent.middle[:, 0]) * _left(bent.direction[:, 0])).sum(-1)
    behind = flat.center[start, 0] + bent.length[:, 0]
    hip = center.place[start] - (half * bent.sign)[:, None] * center.left[start]
    hip = hip - bent.place[:, 0]
    square = behind**2 + (half + bent.sign * aside_rear) ** 2 - (hip * hip).sum(-1)
    tall = over_ankle[start]
    reached = np.sqrt(np.maximum(tall**2 + square, (0.5 * tall) ** 2)) - tall
    reached = np.where(center.resting, extra[start], reached)
    fade = 1.0 - smoothstep(flat.phase / flat.each(np.maximum(flat.toe_off, SETTLED)))
    return up + extra + flat.each(reached - extra[start]) * fade


def _left(direction: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 2"]:
    """x,z of the left."""
    return np.stack([np.cos(direction), -np.sin(direction)], axis=-1)


def _named(error: InfeasibleStepError, step: PlannedStep) -> InfeasibleStepError:
    """The error with the step's number and foot."""
    return InfeasibleStepError(
        step=step.index,
        side=("left", "right")[step.target.side],
        needed=error.needed,
        available=error.available,
        why="its legs do not reach",
    )
