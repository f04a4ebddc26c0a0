"""The curves of one step as a walker proposes them, side by side in one table."""

from __future__ import annotations

from itertools import pairwise
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import hermite, pchip_slopes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

#: The curves of a step, with the shape of a sample; -1: as many joints as the upper body has.
CURVES: dict[str, tuple[int, ...]] = {
    "center": (3,),
    "heading": (),
    "pelvis": (3,),
    "ankle": (2, 3),
    "foot_heading": (2,),
    "pitch": (2,),
    "meta": (2,),
    "bend": (2,),
    "upper": (-1, 3),
}
#: Farthest that two samples may be apart for the contact stage.
FINEST = 1.0 / 36.0


def _rows() -> dict[str, slice]:
    out, first = {}, 0
    for name, shape in CURVES.items():
        last = first + prod(shape)
        out[name] = slice(first, last if last > first else None)
        first = last
    return out


#: Rows of a table of curves. Samples are next to each other: they are worked on together.
ROWS = _rows()
#: Rows without the upper body.
WIDTH = ROWS["upper"].start


def curve_of(table: Float[np.ndarray, "C T"], name: str) -> Float[np.ndarray, "T ..."]:
    """One curve of a table of them: a view, samples first."""
    shape = CURVES[name]
    apart = table[ROWS[name]].reshape(*shape, table.shape[1])
    return apart.transpose(len(shape), *range(len(shape)))


def _curve(name: str) -> Any:
    def view(self: StepCurves) -> Float[np.ndarray, "T ..."]:
        return curve_of(self.table, name)

    return property(view)


class StepCurves:
    """Curves of one step as a walker proposes them, before the feet meet the ground.

    World axes, meters and radians; positions are relative to a point that
    :class:`ReferenceStep` names, so that equal steps share their curves. Side axes are
    [left, right].

    Attributes
    ----------
    phase
        ``(T,)`` from 0 to 1; holds the toe-off.
    center, heading, pelvis
        ``(T, 3)`` mid-point of the hips; ``(T,)`` heading of the walk, unwrapped; ``(T, 3)``
        rotation vector of the pelvis in the heading's frame.
    ankle
        ``(T, 2, 3)``; where a foot bears, the contact stage replaces it.
    foot_heading
        ``(T, 2)``, unwrapped.
    pitch, meta, bend
        ``(T, 2)`` sole pitch, toes against the floor, toes against the sole, as in
        :class:`gaitsmith.walks.model.SagittalStep`, against the foothold's plane.
    upper
        ``(T, U, 3)`` local rotation vectors of the upper body's joints.
    table
        ``(C, T)`` all of them, in the rows :data:`ROWS`; the others are views of it.
    """

    __slots__ = ("phase", "table")

    center, heading, pelvis = _curve("center"), _curve("heading"), _curve("pelvis")
    ankle, foot_heading = _curve("ankle"), _curve("foot_heading")
    pitch, meta, bend = _curve("pitch"), _curve("meta"), _curve("bend")
    upper = _curve("upper")

    def __init__(
        self, *, phase: Float[np.ndarray, "T"], **curves: Float[np.ndarray, "T ..."]
    ) -> None:
        """Copy, check and freeze the arrays."""
        if curves.keys() != CURVES.keys():
            raise TypeError(f"a step has the curves {', '.join(CURVES)}, got {', '.join(curves)}")
        n = len(phase)
        self.phase = frozen_array("phase", phase, (n,))
        parts = []
        for name, shape in CURVES.items():
            whole = tuple(None if size < 0 else size for size in shape)
            parts.append(frozen_array(name, curves[name], (n, *whole)).reshape(n, -1).T)
        self.table = np.concatenate(parts)
        self.table.flags.writeable = False
        if self.phase[0] != 0.0 or self.phase[-1] != 1.0 or (np.diff(self.phase) <= 0.0).any():
            raise InvalidInputError("phase must rise from 0 to 1 without repeating")

    @staticmethod
    def trusted(phase: Float[np.ndarray, "T"], table: Float[np.ndarray, "C T"]) -> StepCurves:
        """Curves that are known to be right, taken as they are: for batches checked as a whole."""
        out = object.__new__(StepCurves)
        out.phase, out.table = phase, table
        return out

    def with_(self, **changes: Float[np.ndarray, "T ..."]) -> StepCurves:
        """Copy with some fields replaced; the copy is checked again."""
        kept = {name: getattr(self, name) for name in ("phase", *CURVES)}
        return StepCurves(**(kept | changes))

    def refined(self, *events: float) -> StepCurves:
        """The same curves on samples well closer than :data:`FINEST`; itself if they are closer.

        The contact stage corrects on samples: a coarse walk would escape it between them.
        ``events`` are phases at which a curve may have a corner; none is read across them.
        """
        if np.diff(self.phase).max() <= FINEST * (1.0 + 1e-9):
            return self
        marks = np.array(sorted({0.0, *(e for e in events if 0.0 < e < 1.0), 1.0}))
        phases, tables = [], []
        for first, last in pairwise(marks):
            inside = (self.phase >= first) & (self.phase <= last)
            own, rows = self.phase[inside], self.table[:, inside].T
            more = [
                np.linspace(a, b, int(np.ceil(2.0 * (b - a) / FINEST)) + 1)[:-1]
                for a, b in pairwise(own)
            ]
            fine = np.concatenate([*more, [1.0] if last == 1.0 else []])
            phases.append(fine)
            tables.append(hermite(own, rows, pchip_slopes(own, rows), fine).T)
        return StepCurves.trusted(np.concatenate(phases), np.concatenate(tables, axis=1))


def end_speeds(
    curves: Sequence[StepCurves],
) -> tuple[Float[np.ndarray, "S 3"], Float[np.ndarray, "S 3"]]:
    """Speeds of the centers at phase 0 and at phase 1, meters per step."""
    own = list({id(c): c for c in curves}.values())
    index = {id(c): i for i, c in enumerate(own)}
    each = np.array([index[id(c)] for c in curves])
    centers = [c.table[ROWS["center"]] for c in own]
    out = []
    for end in (slice(None, 3), slice(None, -4, -1)):
        x = np.array([_three(c.phase[end]) for c in own])[:, None]
        y = np.array([_three(center[:, end]) for center in centers])
        h0, h1 = x[..., 1] - x[..., 0], x[..., 2] - x[..., 1]
        d0, d1 = (y[..., 1] - y[..., 0]) / h0, (y[..., 2] - y[..., 1]) / h1
        out.append(((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1))
    return out[0][each], out[1][each]


def _three(values: Float[np.ndarray, "*c n"]) -> Float[np.ndarray, "*c 3"]:
    """Three samples at an end; of two, a third on their line."""
    if values.shape[-1] == 3:
        return values
    first, second = values[..., 0], values[..., 1]
    return np.stack([first, second, 2.0 * second - first], axis=-1)
