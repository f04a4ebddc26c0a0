"""One file of motion into another, losing nothing that the other can hold."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleError, InvalidInputError, UnknownFormatError
from gaitsmith.io import READERS, WRITERS, Writer, load, place, save
from gaitsmith.io.amc import read_amc
from gaitsmith.io.bvh_file import POSITIONS, BvhFile
from gaitsmith.io.bvh_motion import read_bvh
from gaitsmith.io.bvh_parse import read_bvh_file
from gaitsmith.io.bvh_print import write_bvh_file
from gaitsmith.io.resample import resampled, resampled_bvh
from gaitsmith.io.units import UNITS, unit_factor

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from gaitsmith.motion.motion import Motion


def convert(
    source: Path,
    target: Path,
    *,
    fps: float | None = None,
    unit: str | None = None,
    writers: Mapping[str, Writer] = WRITERS,
) -> Path:
    """Read the motion in ``source`` and write it to ``target``; suffixes say the formats.

    A BVH into a BVH keeps everything: names, hierarchy, offsets, channels and their order,
    translations, frame time and every number; only the dialect becomes the strict one.

    Parameters
    ----------
    source, target
        What to read and where to write.
    fps
        Frames per second of the result; None: the source's.
    unit
        What the numbers of a BVH or AMC are: ``"cm"``, ``"m"``, ``"mm"``, ``"inch"`` or
        ``"cmu"``. A BVH written from a BVH is then in centimeters.
    writers
        Formats that may be written, by suffix.

    Raises
    ------
    UnknownFormatError
        If a suffix has no reader or no writer.
    FileFormatError
        If the source is broken.
    InfeasibleError
        If the motion lacks what the target's format needs.
    OSError
        If a file cannot be read or written.
    """
    kind = source.suffix.lower()
    if kind not in READERS:
        raise UnknownFormatError(source.suffix, READERS, verb="read")
    if target.suffix.lower() not in writers:
        raise UnknownFormatError(target.suffix, writers)
    if unit is not None:
        unit_factor(unit)
        if kind not in (".bvh", ".amc"):
            raise InvalidInputError(f"unit is of BVH and AMC files; a {kind} is in meters")
    if kind == target.suffix.lower() == ".bvh":
        file = read_bvh_file(source)
        file = file if unit is None else _in_centimeters(file, unit)
        file = file if fps is None else resampled_bvh(file, fps)
        place([(partial(write_bvh_file, file), target)])
        return target
    motion = _read(source, unit)
    motion = motion if fps is None else resampled(motion, fps)
    try:
        return save(motion, target, writers)
    except InvalidInputError as error:
        raise InfeasibleError(f"cannot write {target}: {error}") from None


def _read(source: Path, unit: str | None) -> Motion:
    if source.suffix.lower() == ".bvh":
        return read_bvh(source, unit)
    if source.suffix.lower() == ".amc":
        return read_amc(source, unit=unit)
    return load(source)


def _in_centimeters(file: BvhFile, unit: str) -> BvhFile:
    """``file`` with every length in centimeters."""
    factor = unit_factor(unit) / UNITS["cm"]
    if factor == 1.0:
        return file
    lengths = [name in POSITIONS for names in file.channels for name in names]
    ends = tuple(
        type(end)(end.joint, (x * factor, y * factor, z * factor), end.name)
        for end in file.ends
        for x, y, z in [end.offset]
    )
    return file.with_(
        offsets=factor * file.offsets,
        values=np.where(lengths, factor * file.values, file.values),
        ends=ends,
    )
