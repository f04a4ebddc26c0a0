"""What a BVH file holds, to the digit: for conversions that must change nothing.

A :class:`BvhFile` keeps joints, offsets, channels and numbers in the file's own units, names
and orders. :func:`gaitsmith.io.bvh_parse.read_bvh_file` reads one from any dialect,
:func:`gaitsmith.io.bvh_print.write_bvh_file` writes it in the strict one, and
:func:`gaitsmith.io.bvh_motion.read_bvh` makes a Motion of it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, positive
from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from jaxtyping import Float

POSITIONS = ("Xposition", "Yposition", "Zposition")
ROTATIONS = ("Xrotation", "Yrotation", "Zrotation")
#: Channel names as written, by what a file may write.
CHANNELS: dict[str, str] = {name.lower(): name for name in POSITIONS + ROTATIONS}


@dataclass(frozen=True)
class EndSite:
    """Where the bone of a joint ends.

    Attributes
    ----------
    joint
        Index of the joint that the End Site belongs to.
    offset
        x, y, z in the joint's frame and the file's unit.
    name
        What some files write behind ``End Site``; mostly empty.
    """

    joint: int
    offset: tuple[float, float, float]
    name: str = ""


@dataclass(frozen=True, eq=False)
class BvhFile:
    """The J joints, C channels and F frames of a BVH, in the file's own terms.

    Attributes
    ----------
    names
        Joint names as the file has them: any characters, not always different.
    parents
        Index of each joint's parent, -1 for a ROOT. Joints stand in the order of the file,
        which is depth first.
    offsets
        ``(J, 3)`` OFFSET of each joint, in the file's unit.
    channels
        Channel names of each joint in their order, e.g. ``("Zrotation", "Xrotation")``.
    ends
        End Sites in the order of the file.
    frame_time
        Seconds from frame to frame, as the file's digits have it.
    values
        ``(F, C)`` the numbers of the MOTION section: degrees and the file's unit, the
        channels of all joints one after the other.
    warnings
        What was odd about the file that was read, a line each.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Float[np.ndarray, "joints 3"]
    channels: tuple[tuple[str, ...], ...]
    ends: tuple[EndSite, ...]
    frame_time: float
    values: Float[np.ndarray, "frames channels"]
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        count = len(self.names)
        if not count == len(self.parents) == len(self.channels) > 0:
            raise InvalidInputError(
                f"names, parents and channels must be of the same joints, at least one; got "
                f"{count}, {len(self.parents)} and {len(self.channels)}"
            )
        for name in self.names:
            if name != name.strip() or not name or re.search(r"\n|\s\{|\{$", name):
                raise InvalidInputError(
                    f"a joint cannot be called {name[:40]!r} in a BVH: a name has no blanks around "
                    "it, no line end, and no opening brace behind a blank or at its end"
                )
        path: list[int] = []
        for joint, parent in enumerate(self.parents):
            while path and path[-1] != parent:
                path.pop()
            if parent != -1 and not path:
                raise InvalidInputError(
                    f"joints must stand depth first, but {self.names[joint]!r} (joint {joint}) "
                    f"does not follow its parent {parent}"
                )
            path.append(joint)
        for joint, channels in enumerate(self.channels):
            if unknown := set(channels) - set(CHANNELS.values()):
                raise InvalidInputError(
                    f"joint {self.names[joint]!r} has unknown channels: {', '.join(unknown)}"
                )
        width = sum(map(len, self.channels))
        for name, shape in (("offsets", (count, 3)), ("values", (None, width))):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape))
        object.__setattr__(self, "frame_time", positive("frame_time", self.frame_time, "seconds"))

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.values)

    @property
    def columns(self) -> tuple[slice, ...]:
        """Columns of ``values`` that belong to each joint."""
        stops = np.cumsum([0, *map(len, self.channels)]).tolist()
        return tuple(slice(a, b) for a, b in pairwise(stops))

    def with_(self, **changes: object) -> BvhFile:
        """Copy with some fields replaced; the copy is checked again."""
        return replace(self, **changes)  # type: ignore[arg-type]
