"""A sampled motion, and the markers of a measured one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, positive
from gaitsmith.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.motion.skeleton import Skeleton


#: Quaternions that are checked at a time.
BLOCK = 8192


@dataclass(frozen=True, eq=False, repr=False)
class Labels:
    """What a generator knows exactly and a reader of files has to guess.

    Attributes
    ----------
    phase
        ``(F,)`` time since the last landing over the step's duration, in [0, 1].
    step
        ``(F,)`` index of the footstep that lands next (the last one after it has landed).
    footstep_side, footstep_position, footstep_heading, footstep_time
        ``(N,)`` 0 left, 1 right; ``(N, 3)`` N, meters; ``(N,)`` radians; ``(N,)`` seconds of
        landing. All footsteps in order of landing, the two initial feet first with time 0.
    ground, recipe
        JSON that rebuilds the ground; JSON that regenerates the motion.
    path
        ``(P, 2)`` x,z of the path that was followed, or None.
    """

    phase: Float[np.ndarray, "frames"]
    step: Int[np.ndarray, "frames"]
    footstep_side: Int[np.ndarray, "footsteps"]
    footstep_position: Float[np.ndarray, "footsteps 3"]
    footstep_heading: Float[np.ndarray, "footsteps"]
    footstep_time: Float[np.ndarray, "footsteps"]
    ground: str
    recipe: str
    path: Float[np.ndarray, "points 2"] | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze the arrays."""
        frames, count = len(self.phase), len(self.footstep_side)
        for name, shape, dtype in (
            ("phase", (frames,), np.float64),
            ("step", (frames,), np.int64),
            ("footstep_side", (count,), np.int64),
            ("footstep_position", (count, 3), np.float64),
            ("footstep_heading", (count,), np.float64),
            ("footstep_time", (count,), np.float64),
        ):
            object.__setattr__(self, name, frozen_array(name, getattr(self, name), shape, dtype))
        if self.path is not None:
            object.__setattr__(self, "path", frozen_array("path", self.path, (None, 2)))


@dataclass(frozen=True, eq=False)
class Motion:
    """A sampled motion of one skeleton: the only motion type in the package.

    Generators return it; measures, styles, exporters and viewers take it. The arrays are
    read-only copies; to change a motion, make a new one with :meth:`with_`.

    Attributes
    ----------
    skeleton
        The J joints, parents before children.
    root_position
        ``(F, 3)`` world position of the root joint, meters.
    rotations
        ``(F, J, 4)`` unit quaternions ``(x, y, z, w)``, joint to parent.
    fps
        Frames per second; frame ``i`` is at ``i / fps`` seconds.
    contacts
        ``(F, 2, 3)`` [left, right] x [heel, ball, toe tip]: this point is on the ground and
        must not move. Generators know it exactly; None where nobody has told.
    translations
        ``(F, J, 3)`` joint minus parent in the parent's frame, meters, where a file moves its
        joints; None where the skeleton's offsets hold. Of the root: ignored.
    labels
        What a generator knows besides: phases, footsteps, ground, recipe. None otherwise.
    """

    skeleton: Skeleton
    root_position: Float[np.ndarray, "frames 3"]
    rotations: Float[np.ndarray, "frames joints 4"]
    fps: float
    contacts: Bool[np.ndarray, "frames 2 3"] | None = None
    translations: Float[np.ndarray, "frames joints 3"] | None = None
    labels: Labels | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze the arrays."""
        frames, joints = len(self.root_position), len(self.skeleton)
        rotations = frozen_array("rotations", self.rotations, (frames, joints, 4))
        fixed = {
            "root_position": frozen_array("root_position", self.root_position, (frames, 3)),
            "rotations": rotations,
            "fps": positive("fps", self.fps, "frames per second"),
        }
        if self.contacts is not None:
            fixed["contacts"] = frozen_array("contacts", self.contacts, (frames, 2, 3), np.bool_)
        if self.translations is not None:
            fixed["translations"] = frozen_array(
                "translations", self.translations, (frames, joints, 3)
            )
        if self.labels is not None and len(self.labels.phase) != frames:
            raise InvalidInputError(
                f"labels are of {len(self.labels.phase)} frames, the motion has {frames}"
            )
        self._check_unit(rotations)
        for name, value in fixed.items():
            object.__setattr__(self, name, value)

    def _check_unit(self, rotations: Float[np.ndarray, "frames joints 4"]) -> None:
        flat = rotations.reshape(-1, 4)
        for first in range(0, len(flat), BLOCK):  # in the processor's cache
            rows = flat[first : first + BLOCK]
            squares = rows * rows
            whole = squares[:, 0] + squares[:, 1] + squares[:, 2] + squares[:, 3]
            error = np.abs(whole - 1.0)
            if error.max() > 2e-6:
                frame, joint = divmod(first + int(error.argmax()), rotations.shape[1])
                raise InvalidInputError(
                    f"rotations must be unit quaternions; frame {frame}, joint "
                    f"{self.skeleton.names[joint]!r} is off by {0.5 * error.max():.2e}"
                )

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.root_position)

    def __repr__(self) -> str:
        """One line: size, rate, what it carries."""
        extras = [n for n in ("contacts", "translations", "labels") if getattr(self, n) is not None]
        return (
            f"<Motion: {len(self)} frames at {self.fps:g} fps, {len(self.skeleton)} joints"
            f"{', ' + ', '.join(extras) if extras else ''}>"
        )

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (len(self) - 1) / self.fps

    @property
    def times(self) -> Float[np.ndarray, "frames"]:
        """``(F,)`` seconds of each frame."""
        return np.arange(len(self)) / self.fps

    def with_(self, **changes: object) -> Motion:
        """Copy with some fields replaced; the copy is checked again."""
        return replace(self, **changes)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Markers:
    """Measured marker paths, in package units and frame.

    Attributes
    ----------
    names
        One name a marker.
    positions
        ``(F, M, 3)`` meters, +Y up. Sagittal tables put their walking direction on +Z and
        leave x at 0.
    rate
        Frames per second.
    """

    names: tuple[str, ...]
    positions: Float[np.ndarray, "frames markers 3"]
    rate: float

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        object.__setattr__(self, "names", tuple(self.names))
        shape = (None, len(self.names), 3)
        object.__setattr__(self, "positions", frozen_array("positions", self.positions, shape))
        object.__setattr__(self, "rate", positive("rate", self.rate, "frames per second"))

    def __getitem__(self, name: str) -> Float[np.ndarray, "frames 3"]:
        """Path of the marker called ``name``; UnknownNameError if there is none."""
        if name not in self.names:
            raise UnknownNameError("marker", name, self.names)
        return self.positions[:, self.names.index(name)]
