"""Walks and local steps one after the other: what a director plans and a generator prepares."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import ahead
from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.conventions import StepKind
    from gaitsmith.plan.footsteps import Footstep, PlannedStep


@dataclass(frozen=True, eq=False)
class Timeline:
    """Steps of all kinds in their order, a while of standing counted as one of them.

    It begins and ends in standing. Unlike in a :class:`~gaitsmith.plan.footsteps.StepPlan` the
    same foot may step twice in a row, and where it stands no foot lands.

    Attributes
    ----------
    planned
        Every step; each begins where the one before ends.
    path
        ``(P, 2)`` x,z of the path where all of it follows one, else None.
    looks
        From which second on the head turns to which point x,y,z; None: ahead.
    leans
        (begin, end, pitch, roll): by the second ``end`` the trunk leans by so many radians,
        forward and left positive, and stays so until the next.
    """

    planned: tuple[PlannedStep, ...]
    path: Float[np.ndarray, "P 2"] | None = None
    looks: tuple[tuple[float, tuple[float, float, float] | None], ...] = ()
    leans: tuple[tuple[float, float, float, float], ...] = ()

    def __post_init__(self) -> None:
        """Check that feet begin where they were left."""
        if not self.planned:
            raise InvalidInputError("a timeline needs at least one step")
        places = {f.side: f.position for f in (self.planned[0].stance, self.planned[0].origin)}
        for i, step in enumerate(self.planned):
            for foot in (step.stance, step.origin):
                if np.abs(places[foot.side] - foot.position).max() > 1e-9:
                    raise InvalidInputError(f"step {i} does not begin where the feet stand")
            places[step.target.side] = step.target.position

    def steps(self) -> list[PlannedStep]:
        """Every step, in order."""
        return list(self.planned)

    @property
    def kinds(self) -> tuple[StepKind, ...]:
        """Kind of each step."""
        return tuple(s.kind for s in self.planned)

    @cached_property
    def durations(self) -> Float[np.ndarray, "S"]:
        """Seconds of each step."""
        return np.array([s.duration for s in self.planned])

    @cached_property
    def _ends(self) -> Float[np.ndarray, "S"]:
        return np.cumsum(self.durations)

    @cached_property
    def _landed(self) -> tuple[list[Footstep], list[float]]:
        """Footsteps in order of landing, the two initial feet first, and when."""
        first = self.planned[0]
        feet = [first.origin, first.stance]
        if (
            abs(
                float(
                    (first.stance.position - first.origin.position) @ ahead(first.stance.direction)
                )
            )
            < 1e-6
        ):
            feet.sort(key=lambda f: f.side)
        times = [0.0, 0.0]
        for step, end in zip(self.planned, self._ends, strict=True):
            if step.kind != "stand":
                feet.append(step.target)
                times.append(float(end))
        return feet, times

    @property
    def side(self) -> Int[np.ndarray, "N"]:
        """``(N,)`` sides of the footsteps in order of landing."""
        return np.array([f.side for f in self._landed[0]])

    @property
    def position(self) -> Float[np.ndarray, "N 3"]:
        """``(N, 3)`` their N."""
        return np.stack([f.position for f in self._landed[0]])

    @property
    def heading(self) -> Float[np.ndarray, "N"]:
        """``(N,)`` of the feet, radians."""
        return np.array([f.heading for f in self._landed[0]])

    @property
    def time(self) -> Float[np.ndarray, "N"]:
        """``(N,)`` seconds of landing."""
        return np.array(self._landed[1])

    def position_at(
        self, times: Float[np.ndarray, "F"]
    ) -> tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"]]:
        """Index of the footstep that lands next, and the share of the time to it that passed."""
        return landing_at(self.time, times)


def landing_at(
    landing: Float[np.ndarray, "N"], times: Float[np.ndarray, "F"]
) -> tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"]]:
    """Index of the footstep that lands next, and the share of the time to it that passed.

    ``landing`` are the seconds of all footsteps, two of 0 first.
    """
    last = len(landing) - 1
    if last == 1:
        return np.ones(len(times), dtype=np.int64), np.ones(len(times))
    step = np.clip(np.searchsorted(landing, times + 1e-9, side="right"), 2, last)
    share = (times - landing[step - 1]) / (landing[step] - landing[step - 1])
    return step, np.clip(share, 0.0, 1.0)
