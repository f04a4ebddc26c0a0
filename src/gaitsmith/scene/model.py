"""What a scene is: who walks where, and what stands around."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from gaitsmith._checks import number, one_of
from gaitsmith.errors import InvalidInputError
from gaitsmith.motion.performance import checked_name
from gaitsmith.plan.start import Start, start_of
from gaitsmith.plan.surroundings import Surroundings
from gaitsmith.scene.grounds import checked_ground
from gaitsmith.synthesis.gaits import WALKERS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from gaitsmith.body.body import Body
    from gaitsmith.plan.script import Action
    from gaitsmith.plan.where import PathLike, StepsLike
    from gaitsmith.walks.learned import LearnedGait

#: Longest that anybody waits before beginning, seconds.
LATEST = 3600.0
#: Arguments of :func:`gaitsmith.walk` that a walker has under the same name.
SHARED = (
    *(
        "do",
        "path",
        "steps",
        "distance",
        "body",
        "gait",
        "gaits",
        "speed",
        "step_length",
        "cadence",
    ),
    *("step_width", "toe_out", "variation"),
)


@dataclass(frozen=True, eq=False)
class Walker:
    """One person of a scene. Arguments are those of :func:`gaitsmith.walk`, radians included.

    Attributes
    ----------
    name
        A letter, then letters, digits, ``_`` and ``-``: it becomes part of names of files,
        nodes and keys.
    body, gait, gaits
        Who, and how; what the gaits mean that actions name.
    legs
        The ``walker`` of :func:`gaitsmith.walk`: ``"kinematic"`` or ``"elevation"``.
    do, path, steps, distance
        Where; exactly one of them.
    start
        Where the person stands at first; of ``do`` and ``distance``. None: at 0,0 facing 0, or
        where the path or the footsteps begin.
    begin
        Seconds of standing before anything is done.
    speed, step_length, cadence, step_width, toe_out, variation
        See :func:`gaitsmith.walk`.
    seed
        Of the variation; None: the scene's seed plus the number of the walker, from 0.
    """

    name: str = "walker"
    body: str | float | Path | Body = 1.75
    gait: str | Path | LearnedGait | dict[str, Any] = "neutral"
    do: str | Sequence[str | Action] | None = None
    path: PathLike | None = None
    steps: StepsLike | None = None
    distance: float | None = None
    start: Start | None = None
    begin: float = 0.0
    speed: float | None = None
    step_length: float | None = None
    cadence: float | None = None
    step_width: float | None = None
    toe_out: float | tuple[float, float] | None = None
    variation: float = 0.0
    seed: int | None = None
    gaits: Mapping[str, str | Path | LearnedGait | dict[str, Any]] | None = None
    legs: str = "kinematic"

    def __post_init__(self) -> None:
        """Check what does not depend on the body."""
        checked_name(self.name)
        one_of("legs", self.legs, WALKERS)
        if self.start is not None:
            start = start_of(self.start)
            if not isinstance(start, Start):
                raise InvalidInputError(
                    f"{self.name}: start must have at, facing or feet, got {start!r}; in a scene "
                    "everybody starts standing"
                )
            object.__setattr__(self, "start", start)
        ways = ("do", "path", "steps", "distance")
        given = [name for name in ways if getattr(self, name) is not None]
        if len(given) != 1:
            raise InvalidInputError(
                f"{self.name}: say where to walk by one of {', '.join(ways)}, got "
                + (" and ".join(given) if given else "none of them")
            )
        begin = number(f"{self.name}: begin", self.begin, "seconds")
        if not 0.0 <= begin <= LATEST:
            raise InvalidInputError(
                f"{self.name}: begin must be from 0 to {LATEST:g} s, got {begin:g}"
            )


@dataclass(frozen=True, eq=False)
class Scene:
    """Walkers on one ground, at one time, among the same things.

    Attributes
    ----------
    walkers
        At least one; no two names alike but for their case.
    surroundings
        What stands around.
    ground
        What is walked on: ``"flat"``.
    source
        File that it was read from, which errors name; None: no file.
    """

    walkers: tuple[Walker, ...]
    surroundings: Surroundings = field(default_factory=Surroundings)
    ground: str = "flat"
    source: str | None = None

    def __post_init__(self) -> None:
        """Check that the walkers can be told apart."""
        object.__setattr__(self, "walkers", tuple(self.walkers))
        if not self.walkers:
            raise InvalidInputError("a scene needs at least one walker")
        seen: dict[str, str] = {}
        for walker in self.walkers:
            other = seen.setdefault(walker.name.casefold(), walker.name)
            if other is not walker.name:
                raise InvalidInputError(
                    f"two walkers have the name {walker.name!r}; rename one of them"
                )
        checked_ground(self.ground)
