"""A :class:`BvhFile` as text in the strict dialect that every reader takes.

Braces stand on their own line, a frame is one line, there is a Frame Time and no byte order
mark. Numbers have as many digits as their value needs, so that what is read back is the same
to the last bit. A joint with one or two rotation channels is written with three, the others
zero behind its own: readers take none or three (Blender's fails on one).
"""

from __future__ import annotations

import warnings
from decimal import Decimal
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import GaitsmithWarning
from gaitsmith.io._text import number_rows
from gaitsmith.io.bvh_file import ROTATIONS, BvhFile

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jaxtyping import Float

#: Decimals of a whole table before numbers are written one by one.
_MOST_DECIMALS = 9
#: Tabs before a line: a thousand joints one in the other need no thousand.
_DEEPEST = 60


def write_bvh_file(file: BvhFile, path: Path) -> None:
    """Write ``file`` to ``path``; see the top of this module for the dialect.

    Same names, hierarchy, offsets, channel orders, frame time and values: reading it again
    gives the same numbers. Names of End Sites are not written.

    Warns
    -----
    GaitsmithWarning
        Where a joint is given more rotation channels, and if there is no frame: Blender
        refuses such a file.
    """
    full = _full_rotations(file)
    if len(full) == 0:
        warnings.warn("this BVH has no frame: Blender refuses it", GaitsmithWarning, stacklevel=2)
    with path.open("wb") as out:
        out.write("\n".join(_header(full)).encode("utf-8", errors="replace"))
        for rows in _rows(full.values):
            out.write(rows)


def _full_rotations(file: BvhFile) -> BvhFile:
    """Every joint with three rotation channels or none."""
    channels: list[tuple[str, ...]] = []
    kept: list[int] = []
    filled: list[str] = []
    width = 0
    for name, names in zip(file.names, file.channels, strict=True):
        count = sum(channel in ROTATIONS for channel in names)
        missing = [axis for axis in ROTATIONS if axis not in names]
        extra = missing[: 3 - count] if 0 < count < 3 else []
        kept.extend(range(width, width + len(names)))
        channels.append((*names, *extra))
        width += len(channels[-1])
        if extra:
            filled.append(name)
    if not filled:
        return file
    warnings.warn(
        f"joint {filled[0][:40]!r}{f' and {len(filled) - 1} more' if len(filled) > 1 else ''} "
        "had less than three rotation channels: written with three, the others zero",
        GaitsmithWarning,
        stacklevel=3,
    )
    values = np.zeros((len(file), width))
    values[:, kept] = file.values
    return file.with_(channels=tuple(channels), values=values)


def _header(file: BvhFile) -> Iterator[str]:
    """Lines up to the numbers; the last one is empty."""
    ends: dict[int, list[str]] = {}
    for end in file.ends:
        ends.setdefault(end.joint, []).append(" ".join(map(digits, end.offset)))
    yield "HIERARCHY"
    path: list[int] = []
    for joint, parent in enumerate(file.parents):
        while path and path[-1] != parent:
            path.pop()
            yield _pad(len(path)) + "}"
        pad = _pad(len(path))
        path.append(joint)
        yield f"{pad}{'ROOT' if parent < 0 else 'JOINT'} {file.names[joint]}"
        yield pad + "{"
        pad = _pad(len(path))
        yield f"{pad}OFFSET {' '.join(map(digits, file.offsets[joint].tolist()))}"
        yield f"{pad}CHANNELS {len(file.channels[joint])} {' '.join(file.channels[joint])}".rstrip()
        for offset in ends.get(joint, ()):
            yield from (f"{pad}End Site", f"{pad}{{", f"{pad}\tOFFSET {offset}", f"{pad}}}")
    while path:
        path.pop()
        yield _pad(len(path)) + "}"
    decimals = digits(file.frame_time)
    fill = 7 - len(decimals.partition(".")[2])
    yield from ("MOTION", f"Frames: {len(file)}", f"Frame Time: {decimals}{'0' * max(fill, 0)}", "")


def _pad(depth: int) -> str:
    return "\t" * min(depth, _DEEPEST)


def digits(value: float) -> str:
    """The shortest digits that read back as ``value``, with a point and without exponent."""
    text = repr(float(value))
    if "e" in text:
        text = format(Decimal(text), "f")
    return text if "." in text else text + ".0"


def _rows(values: Float[np.ndarray, "frames channels"]) -> Iterator[bytes]:
    if not values.size:
        return
    for decimals in range(4, _MOST_DECIMALS + 1):
        if _holds(values[:10], decimals) and _holds(values, decimals):
            yield from number_rows(values, decimals=decimals)
            return
    for row in values.tolist():
        yield " ".join(map(digits, row)).encode("ascii") + b"\n"


def _holds(values: Float[np.ndarray, "frames channels"], decimals: int) -> bool:
    """Whether that many decimals give every value back; whole numbers below 2^53 are exact."""
    with np.errstate(over="ignore"):
        scaled = np.rint(values * 10.0**decimals)
    return bool((np.abs(scaled) < 2.0**52).all() and (scaled / 10.0**decimals == values).all())
