"""A BVH as a Motion: meters, quaternions, +Y up.

What the files mean, where the format leaves it open:

* **Position channels replace the OFFSET** of their joint, axis by axis, of the root and of
  any other joint. So motion libraries write them (Bandai-Namco's have six channels at every
  joint, with the bone's length in the positions). ACCAD's files give their root an OFFSET of
  its place somewhere in the clip besides: added to the channels it would put the hips at
  twice their height, 1.9 m for a man of 1.75 m.
* Only where all the positions of a file are zero while its OFFSETs are not, they are taken
  as displacements: replacing would shrink the figure to a point. A warning says so.
* **Rotations** apply in the order of the channels, the first one outermost.
* **Units** are guessed, see :mod:`gaitsmith.io.units`; ``unit=`` overrides.
* **+Y is up**, unless the person in the file clearly stands on the plane z = 0.
* A ``Frame Time`` of 0.0333333 is 30 frames a second.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import FileFormatError, GaitsmithWarning
from gaitsmith.geometry.rotations import IDENTITY, about, multiply, rotate, sign_continuous
from gaitsmith.io.bvh_file import POSITIONS, BvhFile
from gaitsmith.io.bvh_parse import read_bvh_file
from gaitsmith.io.units import UNITS, frame_rate, guess_unit, stands_along_z, unit_factor
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

#: Meters that a joint may stray from its offset and still be called fixed.
_STILL = 1e-5
#: Larger numbers are of no figure; their squares would overflow.
_LARGEST = 1e9
#: Poses (joints x frames) that need no number in the file to be believed.
_FREE_POSES = 1_000_000


def read_bvh(path: Path, unit: str | None = None) -> Motion:
    """Motion in the BVH at ``path``, with the file's joint names; any dialect.

    Parameters
    ----------
    path
        The file.
    unit
        ``"cm"``, ``"m"``, ``"mm"``, ``"inch"`` or ``"cmu"`` (1/0.45 inch); None: the one
        that makes a person of the figure.

    Raises
    ------
    FileFormatError
        If it is not a BVH or a broken one, or has more than one figure.
    InvalidInputError
        If there is no such unit.
    OSError
        If it cannot be opened.

    Warns
    -----
    GaitsmithWarning
        Where the unit is not centimeters, +Y was not up, or the file is odd.
    """
    if unit is not None:
        unit_factor(unit)
    return motion_of_bvh(read_bvh_file(path), str(path), unit=unit)


def motion_of_bvh(file: BvhFile, path: str = "<bvh>", *, unit: str | None = None) -> Motion:
    """The Motion that ``file`` means; ``path`` names it in messages. See :func:`read_bvh`."""
    frames, joints = len(file), len(file.names)
    if file.parents.count(-1) > 1:
        raise FileFormatError(path, f"{file.parents.count(-1)} ROOTs: one figure a file is read")
    if frames * joints > max(_FREE_POSES, 8 * file.values.size):
        raise FileFormatError(
            path, f"{joints} joints with {file.values.shape[1]} channels are no figure"
        )
    rotations = _rotations(file)
    local = _local_positions(file, path)
    if max(np.abs(local).max(initial=0.0), np.abs(file.offsets).max()) > _LARGEST:
        raise FileFormatError(path, f"a position beyond {_LARGEST:g} units is no figure's")
    if unit is None:
        unit = _guessed_unit(file, local, path)
    factor = UNITS[unit]
    skeleton = _skeleton(file, factor)
    offsets, moved = _fixed_or_moved(file, factor * local, skeleton)
    skeleton = Skeleton(skeleton.names, skeleton.parents, offsets, ends=skeleton.ends)
    root = factor * local[:, 0]
    roles = humanoid_roles(file.names, file.parents, need=()).joints
    if stands_along_z(skeleton, root, rotations, moved, roles):
        _say(f"{path}: the figure stands along +Z; turned so that +Y is up")
        up = about("x", -0.5 * np.pi)
        root = rotate(up, root)
        rotations[:, 0] = multiply(up, rotations[:, 0])
    return Motion(
        skeleton=skeleton,
        root_position=root,
        rotations=sign_continuous(rotations),
        fps=frame_rate(file.frame_time),
        translations=moved,
    )


def _say(line: str) -> None:
    warnings.warn(line, GaitsmithWarning, stacklevel=4)


def _rotations(file: BvhFile) -> Float[np.ndarray, "frames joints 4"]:
    out = np.empty((len(file), len(file.names), 4))
    for joint, (names, columns) in enumerate(zip(file.channels, file.columns, strict=True)):
        turned = None
        for name, angle in zip(names, file.values[:, columns].T, strict=True):
            if name not in POSITIONS:
                turn = about(name[0].lower(), np.radians(angle))
                turned = turn if turned is None else multiply(turned, turn)
        out[:, joint] = IDENTITY if turned is None else turned
    return out


def _local_positions(file: BvhFile, path: str) -> Float[np.ndarray, "frames moving 3"]:
    """Joint minus parent in the file's unit, of the joints of :func:`_moving`, root first."""
    moving = _moving(file)
    out = np.empty((len(file), len(moving), 3))
    out[:] = file.offsets[moving]
    for i, joint in enumerate(moving):
        for name, value in zip(
            file.channels[joint], file.values[:, file.columns[joint]].T, strict=True
        ):
            if name in POSITIONS:
                out[:, i, POSITIONS.index(name)] = value
    bones = file.offsets[moving[1:]]
    if len(file) and len(bones) and np.abs(bones).max() > 0.0 and not out[:, 1:].any():
        _say(
            f"{path}: all positions of joints are zero and their OFFSETs are not: taken as "
            "displacements from the OFFSETs"
        )
        out[:, 1:] = bones
    return out


def _moving(file: BvhFile) -> list[int]:
    """The root, and every joint with position channels."""
    return [
        joint
        for joint, names in enumerate(file.channels)
        if joint == 0 or any(name in POSITIONS for name in names)
    ]


def _guessed_unit(file: BvhFile, local: Float[np.ndarray, "frames moving 3"], path: str) -> str:
    bones = np.array(file.offsets)
    if len(file):
        bones[_moving(file)] = np.median(local, axis=0)
    bones[0] = 0.0
    lengths = np.linalg.norm(bones, axis=-1)
    roles = humanoid_roles(file.names, file.parents, need=()).joints
    figure = Skeleton(tuple(map(str, range(len(bones)))), file.parents, bones)
    unit, why = guess_unit(lengths, figure, roles)
    if why:
        _say(f"{path}: no unit is given; {why}. Say --unit (unit=) if that is wrong")
    return unit


def _skeleton(file: BvhFile, factor: float) -> Skeleton:
    parents = set(file.parents)
    ends = np.zeros_like(file.offsets)
    for end in reversed(file.ends):  # of several the first counts
        if end.joint not in parents:
            ends[end.joint] = factor * np.array(end.offset)
    return Skeleton(different_names(file.names), file.parents, factor * file.offsets, ends=ends)


def different_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """The same names, ``_2``, ``_3`` and so on behind those that were there before."""
    taken, count = set(names), dict[str, int]()
    out: list[str] = []
    for name in names:
        count[name] = count.get(name, 0) + 1
        unique = name
        if count[name] > 1:
            while (unique := f"{name}_{count[name]}") in taken:
                count[name] += 1
            taken.add(unique)
        out.append(unique)
    return tuple(out)


def _fixed_or_moved(
    file: BvhFile, local: Float[np.ndarray, "frames moving 3"], skeleton: Skeleton
) -> tuple[Float[np.ndarray, "joints 3"], Float[np.ndarray, "frames joints 3"] | None]:
    """Offsets, and the translations if any joint but the root really moves.

    A joint whose position channels never change has that position as its offset.
    """
    offsets, moving = np.array(skeleton.offsets), _moving(file)
    if len(moving) == 1 or len(file) == 0:
        return offsets, None
    still = np.abs(local - local[0]).max(axis=(0, 2)) <= _STILL
    strays = np.abs(local[0] - offsets[moving]).max(axis=-1) > _STILL
    for i, joint in enumerate(moving):
        if i > 0 and still[i] and strays[i]:
            offsets[joint] = local[0, i]
    if still[1:].all():
        return offsets, None
    moved = np.empty((len(file), len(offsets), 3))
    moved[:] = offsets
    moved[:, moving[1:]] = local[:, 1:]
    return offsets, moved
