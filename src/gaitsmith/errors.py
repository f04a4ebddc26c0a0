"""What can go wrong, as a tree.

GaitsmithError
├── InvalidInputError (also a ValueError)   the caller can fix the argument
│   ├── UnknownFormatError                  no reader or writer for a suffix
│   └── UnknownNameError                    a name that no table holds
├── InfeasibleError                         the task cannot be done
│   ├── InfeasibleStepError                 this body cannot take this step
│   ├── LegReachError                       a foothold is out of a leg's reach
│   └── InfeasibleSpeedError                nobody walks that fast
├── FileFormatError                         a file is not what it claims to be
└── MissingDependencyError (also ImportError)

GaitsmithWarning (a UserWarning)            done, but look at it
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


def nearest(name: str, known: Iterable[str], cutoff: float = 0.6) -> str | None:
    """The one of ``known`` that was probably meant by ``name``, if any is near."""
    from difflib import get_close_matches  # late: most runs are without mistakes

    close = get_close_matches(name, list(known), n=1, cutoff=cutoff)
    return close[0] if close else None


class GaitsmithError(Exception):
    """Base of every error this package raises on purpose."""


class InvalidInputError(GaitsmithError, ValueError):
    """An argument has the wrong shape, range or kind."""


class UnknownNameError(InvalidInputError):
    """A name is in no table. Attributes: ``name``, ``known`` (sorted)."""

    def __init__(self, what: str, name: str, known: Iterable[str]) -> None:
        self.name, self.known = name, sorted(known)
        close = nearest(name, self.known)
        hint = f" Did you mean {close!r}?" if close else ""
        super().__init__(f"unknown {what} {name!r}; known: {', '.join(self.known)}.{hint}")


class UnknownFormatError(InvalidInputError):
    """No reader or writer is registered for a file suffix. Attribute: ``suffix``."""

    def __init__(self, suffix: str, known: Iterable[str], *, verb: str = "write") -> None:
        self.suffix = suffix
        names = sorted(known)
        close = nearest(suffix, names)
        hint = f" Did you mean {close!r}?" if close else ""
        super().__init__(
            f"cannot {verb} {suffix!r} files; known suffixes: {', '.join(names)}.{hint}"
        )


class InfeasibleError(GaitsmithError):
    """What is asked for cannot be done; the message says why and what can."""


class InfeasibleStepError(InfeasibleError):
    """A step asks more of the leg than its length allows.

    Attributes: ``step`` (index in the plan, or None), ``side``, ``needed`` and ``available``
    (meters of step length), so that a planner can shorten the step and try again.
    """

    def __init__(
        self, *, step: int | None, side: str, needed: float, available: float, why: str
    ) -> None:
        self.step, self.side = step, side
        self.needed, self.available = needed, available
        which = "the step" if step is None else f"step {step} ({side})"
        super().__init__(
            f"{which}: a step length of {needed:.3f} m is too long for this body: {why}. "
            f"The longest that works is {available:.3f} m"
        )


class LegReachError(InfeasibleError):
    """A bearing foot would be farther from the hip than the leg is long.

    Attributes: ``step`` (index in the plan), ``side``, ``needed`` and ``available`` (meters from
    hip to ankle).
    """

    def __init__(self, *, step: int, side: str, needed: float, available: float) -> None:
        self.step, self.side = step, side
        self.needed, self.available = needed, available
        super().__init__(
            f"step {step} ({side}): the hip-to-ankle distance would be {needed:.3f} m, but this "
            f"body's leg reaches {available:.3f} m. Shorten the step, set the feet closer "
            "together, turn the toes out less, or give the body a longer foot"
        )


class InfeasibleSpeedError(InfeasibleError):
    """A walk above the Froude number at which people run.

    Attributes: ``speed`` and ``available`` (m/s).
    """

    def __init__(self, *, speed: float, froude: float, limit: float, available: float) -> None:
        self.speed, self.available = speed, available
        super().__init__(
            f"speed {speed:.3f} m/s is Froude number {froude:.2f} for this body, above {limit:g} "
            f"people run. The fastest walk is {available:.3f} m/s: shorten the step or lower "
            "the cadence"
        )


class FileFormatError(GaitsmithError):
    """A file is not what it claims to be. Attributes: ``path``, ``line`` (1-based or None)."""

    def __init__(self, path: object, why: str, *, line: int | None = None) -> None:
        self.path, self.line = str(path), line
        where = self.path if line is None else f"{self.path}:{line}"
        super().__init__(f"{where}: {why}")


class MissingDependencyError(GaitsmithError, ImportError):
    """An optional dependency is not installed; the message says which extra has it."""


class GaitsmithWarning(UserWarning):
    """The task was done, but something about it is unusual."""
