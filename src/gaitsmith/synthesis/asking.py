"""Ask a straight walk for the 2D steps of a curve: one by one, or from a table of a few.

On a curve no two steps are equally long. To ask for each would cost more than all the rest, so
steps are read between those of a grid of lengths, linearly. Steady steps lie on the grid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleStepError
from gaitsmith.geometry.curves import smoothstep

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.synthesis.overlay import Overlayer
    from gaitsmith.walks.model import StepRequest, StraightWalk

#: Lengths of the grid are this far apart, over leg length; steps may be so short.
GRAIN, SHORTEST = 0.2, 0.1
#: Grid steps that are remembered.
REMEMBERED = 2048


@dataclass(eq=False, slots=True)
class Answer:
    """Sagittal curves and overlay of one step, as :class:`SagittalStep` and ``Overlay`` have them.

    ``previous`` and ``length`` are what was asked for; ``curves`` has all columns side by side.
    """

    previous: float
    length: float
    phase: Float[np.ndarray, "T"]
    toe_off: float
    curves: Float[np.ndarray, "T C"]

    def raised_from(self, height: float | None) -> None:
        """Begin at hip height ``height``, as the step before ended."""
        if height is not None and abs(height - self.curves[0, 1]) > 1e-12:
            gone = 1.0 - smoothstep(self.phase / self.toe_off)
            self.curves[:, 1] += (height - self.curves[0, 1]) * gone


#: Columns of ``Answer.curves``: the upper body's follow.
COLUMNS = {
    "center": slice(0, 2),
    "ankle": slice(2, 6),
    "pitch": slice(6, 8),
    "meta": slice(8, 10),
    "bend": slice(10, 12),
    "sway": slice(12, 13),
    "pelvis": slice(13, 16),
    "upper": slice(16, None),
}


class Asker:
    """Puts the questions to ``walk`` and lays ``overlay`` over the answers."""

    def __init__(self, walk: StraightWalk, overlay: Overlayer) -> None:
        self._walk, self._overlay = walk, overlay
        self._known: dict[tuple[Body, StepRequest], Answer] = {}

    def ask(self, body: Body, request: StepRequest) -> Answer:
        """The answer to just this request; a copy, to be changed at will."""
        key = (body, request)
        found = self._known.get(key)
        if found is None:
            step = self._walk.step(body, request)
            over = self._overlay(body, request, step)
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
            found = Answer(
                request.previous_length,
                request.length,
                step.phase,
                step.toe_off,
                np.concatenate(parts, axis=1),
            )
            if len(self._known) >= REMEMBERED:
                self._known.clear()
            self._known[key] = found
        return replace(found, curves=np.array(found.curves))

    def table(
        self, body: Body, requests: Sequence[StepRequest], anchor: float
    ) -> list[Answer | None]:
        """Answers read off a grid of lengths that holds ``anchor``; None where that is no good."""
        out: list[Answer | None] = [None] * len(requests)
        grid = _Grid(self, body, anchor, requests)
        groups: dict[tuple[str, int, int], list[int]] = {}
        for i, request in enumerate(requests):
            groups.setdefault((request.kind, request.side, request.stride), []).append(i)
        for members in groups.values():
            for i, answer in zip(members, grid.read([requests[i] for i in members]), strict=True):
                out[i] = answer
        return out


class _OffGridError(Exception):
    """A length beyond the longest of the grid that this body can walk."""


class _Grid:
    """Steps of lengths ``anchor`` plus whole grains."""

    def __init__(
        self, asker: Asker, body: Body, anchor: float, requests: Sequence[StepRequest]
    ) -> None:
        self._asker, self._body = asker, body
        self._anchor, self._grain = anchor, GRAIN * body.leg_length
        self._lowest = int(np.ceil((0.5 * SHORTEST * body.leg_length - anchor) / self._grain))
        values, counts = np.unique([round(r.duration, 2) for r in requests], return_counts=True)
        self._duration = float(values[counts.argmax()])
        self._highest: int | None = None

    def _node(self, index: int) -> float:
        return round(self._anchor + index * self._grain, 12)

    def _ask(self, like: StepRequest, previous: int, length: int) -> Answer:
        before = 0.0 if like.kind == "start" else self._node(previous)
        this = 0.0 if like.kind == "stop" else self._node(length)
        return self._asker.ask(
            self._body,
            replace(
                like,
                previous_length=before,
                length=this,
                next_length=0.0 if like.kind == "stop" else this,
                duration=self._duration,
                hip_height=None,
                previous_duration=None,
            ),
        )

    def _top(self, like: StepRequest, wanted: int) -> int:
        """The longest length of the grid, up to ``wanted``, that this body can walk."""
        if self._highest is None or self._highest < wanted:
            steady, top = replace(like, kind="walk"), wanted
            while top > self._lowest + 1:
                try:
                    self._ask(steady, top, top)
                    break
                except InfeasibleStepError:
                    top -= 1
            self._highest = top
            if top < wanted:
                self._highest = max(top, self._lowest + 1)
                return self._highest
        return min(wanted, self._highest)

    def _cell(self, like: StepRequest, length: float) -> tuple[int, float]:
        """Index of the grid length below, and how far on to the next."""
        index = int(np.floor((length - self._anchor) / self._grain + 1e-9))
        index = max(index, self._lowest)
        top = self._top(like, index + 1)
        if top < index + 1:
            raise _OffGridError
        return index, (length - self._node(index)) / self._grain

    def read(self, requests: Sequence[StepRequest]) -> list[Answer | None]:
        """Answers to requests of one kind and side; None for those off the grid."""
        cells: dict[int, tuple[tuple[int, float], tuple[int, float]]] = {}
        for i, r in enumerate(requests):
            try:
                cells[i] = (
                    (0, 0.0) if r.kind == "start" else self._cell(r, r.previous_length),
                    (0, 0.0) if r.kind == "stop" else self._cell(r, r.length),
                )
            except _OffGridError:
                continue
        on_grid = [requests[i] for i in cells]
        out: list[Answer | None] = [None] * len(requests)
        if cells:
            found = self._between(on_grid, list(cells.values()))
            for i, answer in zip(cells, found, strict=True):
                out[i] = answer
        return out

    def _between(
        self,
        requests: Sequence[StepRequest],
        cells: Sequence[tuple[tuple[int, float], tuple[int, float]]],
    ) -> Sequence[Answer | None]:
        """Answers between the four steps around each."""
        known: dict[tuple[int, int], int] = {}
        answers: list[Answer] = []
        corners, weights = [], []
        for request, ((i, a), (j, b)) in zip(requests, cells, strict=True):
            row, share = [], []
            for di, wi in ((0, 1.0 - a), (1, a)):
                for dj, wj in ((0, 1.0 - b), (1, b)):
                    at = (i + di if wi else i, j + dj if wj else j)
                    if at not in known:
                        try:
                            answers.append(self._ask(request, *at))
                        except InfeasibleStepError:
                            return [None] * len(requests)
                        known[at] = len(answers) - 1
                    row.append(known[at])
                    share.append(wi * wj)
            corners.append(row)
            weights.append(share)
        model = answers[0]
        for other in answers[1:]:
            if other.toe_off != model.toe_off or not np.array_equal(other.phase, model.phase):
                return [None] * len(requests)  # its events move with the length
        stacked = np.stack([a.curves for a in answers])
        index, share = np.array(corners), np.array(weights)
        curves = np.zeros((len(requests), *stacked.shape[1:]))
        for k in range(4):
            used = np.flatnonzero(share[:, k])
            curves[used] += share[used, k, None, None] * stacked[index[used, k]]
        return [
            Answer(r.previous_length, r.length, model.phase, model.toe_off, curves[i])
            for i, r in enumerate(requests)
        ]
