"""Marker paths of motion laboratories: TRC (Track Row Column), as OpenSim and others have it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.io._lines import Lines
from gaitsmith.io.marker_paths import LARGEST, markers, y_up

if TYPE_CHECKING:
    from pathlib import Path

    from gaitsmith.motion.motion import Markers

#: Meters of the units that the header may name.
_UNITS = {
    "mm": 0.001,
    "millimeters": 0.001,
    "cm": 0.01,
    "m": 1.0,
    "meters": 1.0,
    "in": 0.0254,
    "inches": 0.0254,
}
_MOST_MARKERS = 10_000
#: Coordinates that need no character in the file to be believed.
_FREE_CELLS = 1_000_000


def read_trc(path: Path, *, up: str | None = None) -> Markers:
    """Markers in the TRC at ``path``, in meters with +Y up.

    Parameters
    ----------
    path
        The file; its header says millimeters or meters and the frame rate.
    up
        ``"y"`` (OpenSim's) or ``"z"``; None: y, unless the markers clearly stand on z = 0.

    Raises
    ------
    FileFormatError
        If it is no TRC or a broken one; names the line.
    OSError
        If it cannot be opened.

    Warns
    -----
    GaitsmithWarning
        Where gaps were filled (up to 0.1 s), or markers left out for longer ones, by name.
    """
    lines = Lines(path)
    if not lines.need("the header of a TRC").lstrip("\ufeff").lower().startswith("pathfiletype"):
        lines.fail("this is no TRC: it does not start with PathFileType")
    keys, values = lines.need("the names of the header").split(), lines.need("the header").split()
    if len(values) < len(keys):
        lines.fail(f"the header names {len(keys)} values, here are {len(values)}")
    header = {key.lower(): value for key, value in zip(keys, values, strict=False)}
    if missing := [key for key in ("datarate", "numframes", "units") if key not in header]:
        lines.fail(f"the header has no {missing[0]}")
    factor = _UNITS.get(header["units"].lower())
    rate = lines.value(header["datarate"], "DataRate")
    if factor is None or not 1e-3 < rate < 1e6:
        lines.fail(f"units {header['units'][:20]!r} at {rate:g} frames a second are of no TRC")
    declared = lines.value(header["numframes"], "NumFrames")
    names = _names(lines, header.get("nummarkers"))
    lines.need("the axes of the markers")
    rows = _rows(lines, 3 * len(names))
    if len(rows) < declared:
        lines.fail(f"declares {declared:.0f} frames, but ends after {len(rows)}")
    positions = factor * np.array(rows).reshape(len(rows), len(names), 3)
    if not np.abs(np.nan_to_num(positions)).max(initial=0.0) < LARGEST:
        lines.fail(f"a marker is more than {LARGEST:g} m away")
    return markers(path, names, y_up(path, positions, up), rate)


def _names(lines: Lines, declared: str | None) -> list[str]:
    """Marker names of the line that starts with Frame# and Time."""
    line = lines.need("the names of the markers")
    words = line.split("\t") if "\t" in line else line.split()
    names = [word.strip() for word in words if word.strip()]
    if len(names) < 3 or not names[0].lower().startswith("frame"):
        lines.fail("'Frame#', 'Time' and names of markers expected")
    names = names[2:]
    if declared is not None and lines.value(declared, "NumMarkers") != len(names):
        lines.fail(f"declares {declared[:20]} markers, but names {len(names)}")
    if len(names) > _MOST_MARKERS:
        lines.fail(f"more than {_MOST_MARKERS} markers")
    return names


def _rows(lines: Lines, width: int) -> list[np.ndarray]:
    """Coordinates of each frame, NaN where a cell is empty."""
    rows: list[np.ndarray] = []
    while (line := lines.next()) is not None:
        if not line.strip():
            continue
        cells = line.split("\t") if "\t" in line else line.split()
        cells = [cell.strip() for cell in cells]
        while len(cells) > width + 2 and not cells[-1]:
            cells.pop()
        if len(cells) > width + 2:
            lines.fail(f"{len(cells) - 2} coordinates where {width} were expected")
        cells += [""] * (width + 2 - len(cells))  # empty cells at the end are often left out
        if len(rows) * width > lines.size + _FREE_CELLS:
            lines.fail(f"{width} coordinates a frame, but hardly any are there")
        lines.value(cells[0], "the frame number")
        rows.append(np.array([_cell(lines, cell) for cell in cells[2:]]))
    return rows


def _cell(lines: Lines, cell: str) -> float:
    if not cell or cell.lower() == "nan":
        return float("nan")
    return lines.value(cell, "a coordinate")
