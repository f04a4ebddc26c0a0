"""Several people who move at the same time in one place."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gaitsmith.motion.motion import Motion

#: A name that is a good part of a file's name, of a node's and of a key: letters, digits, _ and -.
_NAME = re.compile(r"[^\W\d_][\w-]{0,39}")


def checked_name(name: object) -> str:
    """``name`` if a person in a scene may have it."""
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise InvalidInputError(
            "the name of a walker must begin with a letter and have only letters, digits, _ and "
            f"-, at most 40 of them, got {name!r}"
        )
    return name


@dataclass(frozen=True, eq=False, repr=False)
class Performance:
    """Motions of several people on one time axis: what a scene becomes.

    Every motion has the same frame rate and number of frames, in the same world.

    Attributes
    ----------
    names
        One a person, in the order of the scene; no two alike but for their case.
    motions
        Theirs, in the same order.
    surroundings
        JSON of what stands around: ``obstacles``, ``bars`` and ``posts``
        (:class:`~gaitsmith.plan.surroundings.Surroundings`).
    """

    names: tuple[str, ...]
    motions: tuple[Motion, ...]
    surroundings: str = "{}"

    def __post_init__(self) -> None:
        """Check that they fit together."""
        object.__setattr__(self, "names", tuple(checked_name(name) for name in self.names))
        object.__setattr__(self, "motions", tuple(self.motions))
        if not self.names or len(self.names) != len(self.motions):
            raise InvalidInputError(
                f"a performance needs a motion for each of its names, got {len(self.names)} names "
                f"and {len(self.motions)} motions"
            )
        if len({name.casefold() for name in self.names}) < len(self.names):
            raise InvalidInputError(f"two walkers have one name: {', '.join(self.names)}")
        first = self.motions[0]
        for name, motion in self:
            if len(motion) != len(first) or motion.fps != first.fps:
                raise InvalidInputError(
                    f"{name} has {len(motion)} frames at {motion.fps:g} fps, {self.names[0]} "
                    f"{len(first)} at {first.fps:g}: they need one time axis"
                )
        try:
            json.loads(self.surroundings)
        except ValueError as error:
            raise InvalidInputError(f"surroundings must be JSON: {error}") from None

    def __iter__(self) -> Iterator[tuple[str, Motion]]:
        """Pairs of name and motion."""
        return iter(zip(self.names, self.motions, strict=True))

    def __getitem__(self, name: str) -> Motion:
        """Motion of the walker called ``name``; UnknownNameError if there is none."""
        if name not in self.names:
            raise UnknownNameError("walker", name, self.names)
        return self.motions[self.names.index(name)]

    def __len__(self) -> int:
        """Number of people."""
        return len(self.names)

    def __repr__(self) -> str:
        """One line: who, how long."""
        first = self.motions[0]
        return f"<Performance: {', '.join(self.names)}; {len(first)} frames at {first.fps:g} fps>"

    @property
    def fps(self) -> float:
        """Frames per second."""
        return self.motions[0].fps

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return self.motions[0].duration
