"""Acclaim motions (.amc) with their skeletons (.asf), as the CMU data base has them.

Each bone of the skeleton becomes a joint at its start that carries the bone's name, with
axes along the world's in the rest pose; the angles about the bone's own axes are converted.
The two tell neither the frame rate (CMU's is 120) nor the unit in so many words: CMU's
``length 0.45`` means that 0.45 units are an inch.
"""

from __future__ import annotations

import warnings
from array import array
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.errors import FileFormatError, GaitsmithWarning
from gaitsmith.geometry.rotations import IDENTITY, about, inverse, multiply, sign_continuous
from gaitsmith.io._lines import Lines
from gaitsmith.io.asf import Asf, Bone, read_asf
from gaitsmith.io.units import LONGEST_LEG, SHORTEST_LEG, UNITS, guess_unit, unit_factor
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

#: Frames per second of nearly all of the CMU data base.
CMU_RATE = 120.0
_INCH = 0.0254
_LARGEST = 1e9
#: Poses (joints x frames) that need no number in the file to be believed.
_FREE_POSES = 1_000_000


def read_amc(
    path: Path, asf: Path | None = None, *, fps: float | None = None, unit: str | None = None
) -> Motion:
    """Motion in the .amc at ``path``.

    Parameters
    ----------
    path
        The file of angles.
    asf
        Its skeleton; None: ``02.asf`` or ``02_01.asf`` beside ``02_01.amc``, or the only one
        in the folder.
    fps
        Frames per second, which the file does not tell; None: 120, with a warning.
    unit
        As in :func:`gaitsmith.io.bvh_motion.read_bvh`; None: by ``:units length``.

    Raises
    ------
    FileFormatError
        If either file is broken, or there is no skeleton.
    OSError
        If one cannot be opened.
    """
    skeleton_file = read_asf(_beside(path) if asf is None else asf)
    values, degrees = _frames(path, skeleton_file)
    if fps is None:
        fps = CMU_RATE
        warnings.warn(
            f"{path}: an .amc names no frame rate; {fps:g} frames a second taken",
            GaitsmithWarning,
            stacklevel=2,
        )
    factor = _factor(skeleton_file, path, unit)
    root, rotations = _poses(skeleton_file, values, factor, degrees)
    return Motion(
        skeleton=_skeleton(skeleton_file, factor),
        root_position=root,
        rotations=sign_continuous(rotations),
        fps=positive("fps", fps, "frames per second"),
    )


def _beside(path: Path) -> Path:
    """The skeleton that belongs to ``path``."""
    if not path.is_file():
        path.open("rb").close()  # the disk says what is wrong
    for stem in (path.stem, path.stem.rpartition("_")[0], path.stem.partition("_")[0]):
        for suffix in (".asf", ".ASF"):
            if stem and (found := path.with_name(stem + suffix)).is_file():
                return found
    others = sorted(p for p in path.parent.iterdir() if p.suffix.lower() == ".asf")
    if len(others) == 1:
        return others[0]
    wanted = f"{path.stem.partition('_')[0]}.asf"
    raise FileFormatError(path, f"an .amc needs its skeleton: there is no {wanted} beside it")


class _Frames:
    """Numbers frame by frame, bone by bone in the skeleton's order."""

    def __init__(self, lines: Lines, skeleton: Asf) -> None:
        self.lines, self.degrees = lines, skeleton.degrees
        self.widths = {bone.name: len(bone.dofs) for bone in skeleton.bones}
        stops = np.cumsum([0, *self.widths.values()]).tolist()
        self.starts = dict(zip(self.widths, stops, strict=False))
        self.width = stops[-1]
        self.count = 0
        self._numbers = array("d")
        self._row = [0.0] * self.width
        self._seen: set[str] = set()

    def begin(self) -> None:
        """A line that holds the number of the frame."""
        self.end()
        self.count += 1
        if self.count * len(self.widths) > max(_FREE_POSES, 8 * self.count * self.width):
            self.lines.fail(
                f"{len(self.widths)} bones with {self.width} values a frame are no figure"
            )

    def bone(self, name: str, words: list[str]) -> None:
        """A line that holds a bone's values."""
        if name not in self.widths or name in self._seen or self.count == 0:
            what = "outside of the frames" if self.count == 0 else "no bone of its skeleton"
            self.lines.fail(f"{name[:40]!r} is {'twice here' if name in self._seen else what}")
        if len(words) != self.widths[name]:
            self.lines.fail(f"{name[:40]!r} has {self.widths[name]} values, here are {len(words)}")
        self._seen.add(name)
        start = self.starts[name]
        self._row[start : start + len(words)] = [self.lines.value(w, name) for w in words]

    def end(self) -> None:
        """Keep the frame, which must be complete."""
        if self.count == 0:
            return
        missing = [name for name, w in self.widths.items() if w and name not in self._seen]
        if missing:
            self.lines.fail(f"frame {self.count} has no values of {missing[0][:40]!r}")
        self._numbers.extend(self._row)
        self._seen.clear()

    def values(self) -> Float[np.ndarray, "frames channels"]:
        """All of them."""
        if self.count == 0:
            self.lines.fail("this is no Acclaim motion: it has no frames")
        values = np.array(self._numbers).reshape(self.count, self.width)
        if np.abs(values).max(initial=0.0) > _LARGEST:
            self.lines.fail(f"a value beyond {_LARGEST:g} is no figure's")
        return values


def _frames(path: Path, skeleton: Asf) -> tuple[Float[np.ndarray, "frames channels"], bool]:
    """All values, and whether angles are degrees."""
    lines = Lines(path)
    frames = _Frames(lines, skeleton)
    while (line := lines.next()) is not None:
        words = line.split("#")[0].split()
        if not words:
            continue
        if words[0].startswith(":"):
            if words[0].upper() in (":DEGREES", ":RADIANS"):
                frames.degrees = words[0].upper() == ":DEGREES"
        elif len(words) == 1 and words[0].isdigit():
            frames.begin()
        else:
            frames.bone(words[0], words[1:])
    frames.end()
    return frames.values(), frames.degrees


def _turns(
    bone: Bone, values: Float[np.ndarray, "frames dofs"], degrees: bool
) -> Float[np.ndarray, "frames 4"]:
    """Rotations of a bone about its own axes, first degree of freedom first."""
    out = np.broadcast_to(IDENTITY, (len(values), 4))
    for dof, angle in zip(bone.dofs, values.T, strict=True):
        if dof.startswith("r"):
            out = multiply(about(dof[1], np.radians(angle) if degrees else angle), out)
    return multiply(multiply(bone.axes, out), inverse(bone.axes))


def _poses(
    skeleton: Asf, values: Float[np.ndarray, "frames channels"], factor: float, degrees: bool
) -> tuple[Float[np.ndarray, "frames 3"], Float[np.ndarray, "frames joints 4"]]:
    root = np.zeros((len(values), 3))
    rotations = np.empty((len(values), len(skeleton.bones), 4))
    column = 0
    for joint, bone in enumerate(skeleton.bones):
        here = values[:, column : column + len(bone.dofs)]
        rotations[:, joint] = _turns(bone, here, degrees)
        column += len(bone.dofs)
        for dof, value in zip(bone.dofs, here.T, strict=True):
            if dof.startswith("t"):
                root[:, "xyz".index(dof[1])] = factor * value
    return root, rotations


def _skeleton(skeleton: Asf, factor: float) -> Skeleton:
    vectors = factor * np.array([bone.vector for bone in skeleton.bones])
    parents = skeleton.parents
    offsets = np.array([np.zeros(3) if parent < 0 else vectors[parent] for parent in parents])
    leaves = [joint not in set(parents) for joint in range(len(parents))]
    ends = np.where(np.array(leaves)[:, None], vectors, 0.0)
    return Skeleton(tuple(bone.name for bone in skeleton.bones), parents, offsets, ends=ends)


def _factor(skeleton: Asf, path: Path, unit: str | None) -> float:
    """Meters of the file's unit."""
    if unit is not None:
        return unit_factor(unit)
    factor = _INCH / skeleton.unit_length
    figure = _skeleton(skeleton, 1.0)
    if np.abs(figure.offsets).max() > _LARGEST:
        raise FileFormatError(path, f"a bone beyond {_LARGEST:g} units is no figure's")
    roles = humanoid_roles(figure.names, figure.parents, need=()).joints
    lengths = np.linalg.norm(figure.offsets, axis=-1)
    guess, why = guess_unit(lengths, figure, roles)
    thigh, shank = roles.get("leftLowerLeg"), roles.get("leftFoot")
    if thigh is None or shank is None:
        return factor
    leg = factor * float(lengths[thigh] + lengths[shank])
    if SHORTEST_LEG <= leg <= LONGEST_LEG or not why:
        return factor
    warnings.warn(f"{path}: its unit of length makes no person; {why}", GaitsmithWarning, 3)
    return UNITS[guess]
