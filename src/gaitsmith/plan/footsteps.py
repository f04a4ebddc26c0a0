"""A footstep, and a plan of them in order of landing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError

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
    """

    side: int
    position: Float[np.ndarray, "3"]
    heading: float
    direction: float
    time: float


@dataclass(frozen=True, eq=False)
class PlannedStep:
    """One step of a plan: the swing foot goes from ``origin`` to ``target``.

    ``stance`` stays; ``following`` is where the stance foot goes next, None at the end;
    ``before`` is where the stance foot came from, None at the beginning.
    """

    index: int
    kind: StepKind
    stance: Footstep
    origin: Footstep
    target: Footstep
    before: Footstep | None
    following: Footstep | None
    duration: float


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
    """

    side: Int[np.ndarray, "N"]
    position: Float[np.ndarray, "N 3"]
    heading: Float[np.ndarray, "N"]
    direction: Float[np.ndarray, "N"]
    time: Float[np.ndarray, "N"]
    kinds: tuple[StepKind, ...]
    path: Float[np.ndarray, "P 2"] | None = None

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

    @property
    def durations(self) -> Float[np.ndarray, "steps"]:
        """``(N - 2,)`` seconds of each step."""
        return np.diff(self.time[1:])

    def footstep(self, index: int) -> Footstep:
        """The footstep at ``index``."""
        return Footstep(
            side=int(self.side[index]),
            position=self.position[index],
            heading=float(self.heading[index]),
            direction=float(self.direction[index]),
            time=float(self.time[index]),
        )

    def steps(self) -> list[PlannedStep]:
        """Every step, in order."""
        feet = [self.footstep(i) for i in range(len(self.side))]
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
