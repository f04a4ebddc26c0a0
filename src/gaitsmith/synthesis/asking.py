"""Ask a straight walk for the 2D steps of a curve: one by one, or from a table of a few.

On a curve no two steps are equally long. To ask for each would cost more than all the rest, so
steps are read between those of a grid of lengths, linearly. Steady steps lie on the grid.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleStepError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.synthesis.overlay import overlays
from gaitsmith.walks.model import ClimbingWalk

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.synthesis.overlay import Overlay, Overlayer
    from gaitsmith.walks.model import SagittalStep, StepRequest, StraightWalk

#: Lengths of the grid are this far apart, over leg length; steps may be so short.
GRAIN, SHORTEST = 0.2, 0.1
#: Part of a step, at least, over which hips settle from the height they inherit to their own: of a
#: foot that leaves at once they would drop in an instant.
SETTLED = 0.3
#: Grid steps that are remembered.
REMEMBERED = 2048
#: Rows of a table of them: the upper body's follow.
ROWS = {
    "center": slice(0, 2),
    "ankle": slice(2, 6),
    "pitch": slice(6, 8),
    "meta": slice(8, 10),
    "bend": slice(10, 12),
    "sway": slice(12, 13),
    "pelvis": slice(13, 16),
    "upper": slice(16, None),
}
HIP_HEIGHT = 1


@dataclass(frozen=True, eq=False)
class Asked:
    """Sagittal curves and overlay of one step, as :class:`SagittalStep` and ``Overlay`` have them.

    ``table`` has all curves, in the rows :data:`ROWS`; ``settling`` falls from 1 to 0 while the
    rear foot bears, at least over :data:`SETTLED`. ``heights``: of the hips as it begins and
    ends, meters.
    """

    phase: Float[np.ndarray, "T"]
    toe_off: float
    table: Float[np.ndarray, "C T"]
    settling: Float[np.ndarray, "T"]
    heights: tuple[float, float]


@dataclass(eq=False, slots=True)
class Answer:
    """What a straight walk says to one request: one step that was asked for, or a mean of some.

    Attributes
    ----------
    previous, length
        What was asked for.
    steps, shares
        Of the mean; alike but for their tables.
    asked
        The walk said so itself; else it is read between what it said of other lengths.
    raised
        Meters by which the hips begin higher than these, and then settle.
    off
        What sway, pelvis and upper body begin with beyond these, and then settle.
    """

    previous: float
    length: float
    steps: list[Asked]
    shares: list[float]
    asked: bool = False
    raised: float = 0.0
    off: Float[np.ndarray, "C"] | None = None

    @property
    def phase(self) -> Float[np.ndarray, "T"]:
        """Of the samples."""
        return self.steps[0].phase

    @property
    def toe_off(self) -> float:
        """Phase at which the rear foot leaves."""
        return self.steps[0].toe_off

    @property
    def end_height(self) -> float:
        """Of the hips, meters."""
        return self._height(1)

    def raised_from(self, height: float | None) -> None:
        """Begin at hip height ``height``, as the step before ended."""
        if height is not None:
            miss = height - self._height(0)
            self.raised = miss if abs(miss) > 1e-12 else 0.0

    def joined_to(self, before: Answer) -> None:
        """Begin with the sway, pelvis and upper body with which ``before`` ends.

        What was asked differs by a millimeter from what is read of the same length.
        """
        self.off = before._above(-1) - self._above(0)

    def _above(self, sample: int) -> Float[np.ndarray, "C"]:
        rows = slice(ROWS["sway"].start, None)
        parts = [s.table[rows, sample] * w for s, w in zip(self.steps, self.shares, strict=True)]
        return np.sum(parts, axis=0)

    def _height(self, end: int) -> float:
        return sum(s.heights[end] * share for s, share in zip(self.steps, self.shares, strict=True))

    def table(self) -> Float[np.ndarray, "C T"]:
        """All curves, in the rows :data:`ROWS`."""
        if len(self.steps) == 1 and not self.raised and self.off is None:
            return self.steps[0].table
        out = self.steps[0].table * self.shares[0]
        part = np.empty_like(out)
        for step, share in zip(self.steps[1:], self.shares[1:], strict=True):
            out += np.multiply(step.table, share, out=part)
        if self.raised:
            out[HIP_HEIGHT] += self.raised * self.steps[0].settling
        if self.off is not None:
            out[ROWS["sway"].start :] += self.off[:, None] * self.steps[0].settling
        return out


class Asker:
    """Puts the questions to ``walk`` and lays ``overlay`` over the answers."""

    def __init__(self, walk: StraightWalk, overlay: Overlayer) -> None:
        self._walk, self._overlay = walk, overlay
        self._known: dict[Body, dict[StepRequest, Asked]] = {}

    def ask(self, body: Body, request: StepRequest) -> Answer:
        """The answer to just this request."""
        step = self.ask_all(body, [request])[0]
        return Answer(request.previous_length, request.length, [step], [1.0], asked=True)

    def answers(self, body: Body, requests: Sequence[StepRequest]) -> list[Answer | None]:
        """Answers to just these requests; None where ``body`` cannot take one of them."""
        if isinstance(self._walk, ClimbingWalk):
            self._walk.foresee(body, requests)
        try:
            steps = self.ask_all(body, requests)
        except InfeasibleStepError:
            return [None] * len(requests)
        return [
            Answer(r.previous_length, r.length, [step], [1.0], asked=True)
            for r, step in zip(requests, steps, strict=True)
        ]

    def can(self, body: Body, request: StepRequest) -> bool:
        """Whether ``body`` can take such a step."""
        try:
            self._walk.step(body, request)
        except InfeasibleStepError:
            return False
        return True

    def ask_all(self, body: Body, requests: Sequence[StepRequest]) -> list[Asked]:
        """The steps that answer these requests, remembered."""
        known = self._known.setdefault(body, {})
        if sum(map(len, self._known.values())) + len(requests) > REMEMBERED:
            self._known = {body: (known := {})}
        new = [r for r in dict.fromkeys(requests) if r not in known]
        if new:
            steps = [self._walk.step(body, r) for r in new]
            laid = overlays(self._overlay, body, new, steps)
            known |= dict(zip(new, map(_asked, steps, laid), strict=True))
        return [known[r] for r in requests]

    def table(
        self, body: Body, requests: Sequence[StepRequest], anchor: float
    ) -> list[Answer | None]:
        """Answers read off a grid of lengths that holds ``anchor``; None where that is no good."""
        out: list[Answer | None] = [None] * len(requests)
        grid = _Grid(self, body, anchor, requests)
        groups: dict[tuple[str, int, int], list[int]] = {}
        for i, request in enumerate(requests):
            groups.setdefault((request.kind, request.side, request.stride), []).append(i)
        places = [grid.places([requests[i] for i in members]) for members in groups.values()]
        with suppress(InfeasibleStepError):  # then those that can be asked are asked group by group
            self.ask_all(body, [r for at in places for r in at.nodes])
        for members, at in zip(groups.values(), places, strict=True):
            own = [members[k] for k in at.known.tolist()]
            for i, answer in zip(own, grid.read(at, [requests[i] for i in own]), strict=True):
                out[i] = answer
        return out


def usual_duration(steps: Sequence[PlannedStep | StepRequest]) -> float:
    """The duration that most steps have, to a hundredth of a second."""
    values, counts = np.unique([round(s.duration, 2) for s in steps], return_counts=True)
    return float(values[counts.argmax()])


def _asked(step: SagittalStep, over: Overlay) -> Asked:
    count = len(step.phase)
    parts = (
        step.center,
        step.ankle.reshape(count, 4),
        step.pitch,
        step.meta,
        step.bend,
        over.sway[:, None],
        over.pelvis,
        over.upper.reshape(count, -1),
    )
    return Asked(
        phase=step.phase,
        toe_off=step.toe_off,
        table=np.concatenate([part.T for part in parts]),
        settling=1.0 - smoothstep(step.phase / max(step.toe_off, SETTLED)),
        heights=(float(step.center[0, 1]), float(step.center[-1, 1])),
    )


@dataclass(frozen=True, eq=False)
class _Places:
    """Where R requests of one kind and side lie between the ``nodes`` of the grid.

    Attributes
    ----------
    known
        ``(R,)`` which of the requests those are; the others are off the grid.
    nodes
        What is asked at the nodes around them.
    corner, share
        ``(4, R)`` the nodes around each, and how much they count.
    """

    known: Int[np.ndarray, "R"]
    nodes: list[StepRequest]
    corner: Int[np.ndarray, "4 R"]
    share: Float[np.ndarray, "4 R"]


class _Grid:
    """Steps of lengths ``anchor`` plus whole grains."""

    def __init__(
        self, asker: Asker, body: Body, anchor: float, requests: Sequence[StepRequest]
    ) -> None:
        self._asker, self._body = asker, body
        self._anchor, self._grain = anchor, GRAIN * body.leg_length
        self._lowest = int(np.ceil((0.5 * SHORTEST * body.leg_length - anchor) / self._grain))
        self._duration = usual_duration(requests)
        self._highest: int | None = None

    def _node(self, index: int) -> float:
        return round(self._anchor + index * self._grain, 12)

    def _asked(self, like: StepRequest, previous: int, length: int) -> StepRequest:
        before = 0.0 if like.kind == "start" else self._node(previous)
        this = 0.0 if like.kind == "stop" else self._node(length)
        return replace(
            like,
            previous_length=before,
            length=this,
            next_length=0.0 if like.kind == "stop" else this,
            duration=self._duration,
            hip_height=None,
            previous_duration=None,
        )

    def _top(self, like: StepRequest, wanted: int) -> int:
        """The longest length of the grid, up to ``wanted``, that this body can walk."""
        if self._highest is None or self._highest < wanted:
            steady, top = replace(like, kind="walk"), wanted
            while top > self._lowest + 1 and not self._asker.can(
                self._body, self._asked(steady, top, top)
            ):
                top -= 1
            self._highest = max(top, self._lowest + 1)
        return min(wanted, self._highest)

    def _cells(
        self, like: StepRequest, lengths: Float[np.ndarray, "R"]
    ) -> tuple[Int[np.ndarray, "R"], Float[np.ndarray, "R"], Bool[np.ndarray, "R"]]:
        """Index of the grid length below, how far on to the next, and whether that is walked."""
        index = np.floor((lengths - self._anchor) / self._grain + 1e-9).astype(np.int64)
        index = np.maximum(index, self._lowest)
        top = self._top(like, int(index.max()) + 1)
        nodes = np.round(self._anchor + index * self._grain, 12)
        return index, (lengths - nodes) / self._grain, index < top

    def places(self, requests: Sequence[StepRequest]) -> _Places:
        """Places of requests of one kind, side and stride."""
        like, count = requests[0], len(requests)
        none = (np.zeros(count, dtype=np.int64), np.zeros(count), np.ones(count, dtype=np.bool_))
        asked = np.array([(r.previous_length, r.length) for r in requests])
        i, a, before = none if like.kind == "start" else self._cells(like, asked[:, 0])
        j, b, after = none if like.kind == "stop" else self._cells(like, asked[:, 1])
        known = np.flatnonzero(before & after)
        i, a, j, b = i[known], a[known], j[known], b[known]
        share = np.stack([(1.0 - a) * (1.0 - b), (1.0 - a) * b, a * (1.0 - b), a * b])
        # a corner without a share is not asked for: the one at hand stands in
        up, on = (a != 0.0).astype(np.int64), (b != 0.0).astype(np.int64)
        corners = np.array([[i, j], [i, j + on], [i + up, j], [i + up, j + on]])
        # pairs as complex numbers: sorted much more quickly than rows
        nodes, index = np.unique(corners[:, 0] + 1j * corners[:, 1], return_inverse=True)
        asks = [self._asked(like, int(n.real), int(n.imag)) for n in nodes.tolist()]
        return _Places(known, asks, index.reshape(4, len(known)), share)

    def read(self, at: _Places, requests: Sequence[StepRequest]) -> Sequence[Answer | None]:
        """Answers to the requests ``at``; None where the nodes around them are no good."""
        if not len(at.known):
            return []
        nothing = [None] * len(at.known)
        try:
            steps = self._asker.ask_all(self._body, at.nodes)
        except InfeasibleStepError:
            return nothing
        model = steps[0]
        for other in steps[1:]:
            if other.toe_off != model.toe_off or not np.array_equal(other.phase, model.phase):
                return nothing  # its events move with the length
        out = []
        corners, shares = at.corner.T.tolist(), at.share.T.tolist()
        for request, around, weights in zip(requests, corners, shares, strict=True):
            which = [k for k in range(4) if weights[k]]
            own, share = [steps[around[k]] for k in which], [weights[k] for k in which]
            out.append(Answer(request.previous_length, request.length, own, share))
        return out
