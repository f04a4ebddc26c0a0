"""Marker paths in a CSV: a column a coordinate, a row a frame.

The first line names the columns: ``time`` or ``time_s`` in seconds, and for each marker
``hip_x,hip_y,hip_z`` (x and z level, y up) or, for a sagittal table, ``hip_x,hip_y`` (x
along the walk, y up). Other columns are not read. Lengths are meters unless the numbers can
only be centimeters or millimeters, or the names say so (``hip_x_mm``).
"""

from __future__ import annotations

import csv
import re
import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import positive
from gaitsmith.errors import GaitsmithWarning
from gaitsmith.io._lines import Lines
from gaitsmith.io.marker_paths import LARGEST, markers, walking_forward, y_up
from gaitsmith.io.units import UNITS, unit_factor

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.motion.motion import Markers

_COLUMN = re.compile(r"(.+)_([xyz])(?:_(m|cm|mm))?", re.IGNORECASE)
_TIMES = ("time", "time_s", "t", "seconds")
_MOST_COLUMNS = 30_000
_LARGEST_TIME = 1e9
#: Meters that the markers of a person do not span.
_HIGHEST = 4.0


def read_marker_csv(
    path: Path, *, rate: float | None = None, unit: str | None = None, up: str | None = None
) -> Markers:
    """Markers in the CSV at ``path``; see the top of this module for its columns.

    Sagittal tables walk along +Z, with x at 0.

    Parameters
    ----------
    path
        The file.
    rate
        Frames per second; None: from the column of times.
    unit
        ``"m"``, ``"cm"`` or ``"mm"``; None: what the names say, else meters unless the
        markers are then as high as no person.
    up
        ``"y"`` or ``"z"``, as in :func:`gaitsmith.io.trc.read_trc`.

    Raises
    ------
    FileFormatError
        If it is no such table; names the line.
    OSError
        If it cannot be opened.
    """
    lines = Lines(path)
    header = _cells(lines, lines.need("the names of the columns"))
    if len(header) > _MOST_COLUMNS:
        lines.fail(f"more than {_MOST_COLUMNS} columns")
    columns, units = _marker_columns(lines, header)
    table = _table(lines, header)
    if rate is None:
        rate = _rate(lines, header, table)
    names = list(columns)
    flat = any("z" not in axes for axes in columns.values())
    positions = np.zeros((len(table), len(names), 3))
    for marker, axes in enumerate(columns.values()):
        for axis, column in axes.items():
            positions[:, marker, "xyz".index(axis)] = table[:, column]
    if not np.abs(np.nan_to_num(positions)).max(initial=0.0) < LARGEST:
        lines.fail(f"a position beyond {LARGEST:g} is no marker's")
    positions *= _factor(path, positions, unit, units)
    if flat:
        positions[..., 2] = walking_forward(positions[..., 0])
        positions[..., 0] = 0.0
    else:
        positions = y_up(path, positions, up)
    return markers(path, names, positions, positive("rate", rate, "frames per second"))


def _cells(lines: Lines, line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line]), [])]
    except csv.Error as error:
        lines.fail(f"not a line of a CSV: {error}")


def _marker_columns(lines: Lines, header: list[str]) -> tuple[dict[str, dict[str, int]], set[str]]:
    """Columns of each marker by axis, and the units that their names have."""
    columns: dict[str, dict[str, int]] = {}
    units: set[str] = set()
    for column, title in enumerate(header):
        match = _COLUMN.fullmatch(title)
        if match is None:
            continue
        axes = columns.setdefault(match[1], {})
        if match[2].lower() in axes:
            lines.fail(f"column {title[:40]!r} stands twice")
        axes[match[2].lower()] = column
        units.add((match[3] or "").lower())
    kinds = {"".join(sorted(axes)) for axes in columns.values()}
    if not columns or not kinds <= {"xy", "xyz"} or len(kinds) > 1 or len(units) > 1:
        lines.fail(
            "this is no table of markers: all need columns NAME_x, NAME_y and NAME_z, or all of "
            "a sagittal table NAME_x and NAME_y"
        )
    return columns, units - {""}


def _table(lines: Lines, header: list[str]) -> Float[np.ndarray, "frames columns"]:
    """All cells of named columns, NaN where empty."""
    wanted = [title.lower() in _TIMES or bool(_COLUMN.fullmatch(title)) for title in header]
    rows: list[Float[np.ndarray, "columns"]] = []
    while (line := lines.next()) is not None:
        cells = _cells(lines, line)
        if not any(cells):
            continue
        if len(cells) != len(header):
            lines.fail(f"{len(cells)} cells, but {len(header)} columns have names")
        row = [
            lines.value(cell, title) if read and cell and cell.lower() != "nan" else float("nan")
            for cell, title, read in zip(cells, header, wanted, strict=True)
        ]
        rows.append(np.array(row))
    if not rows:
        lines.fail("a table without rows")
    return np.array(rows)


def _rate(lines: Lines, header: list[str], table: Float[np.ndarray, "frames columns"]) -> float:
    """Frames per second of the column of times, which must be even up to its digits."""
    titles = [title.lower() for title in header]
    column = next((titles.index(title) for title in _TIMES if title in titles), None)
    if column is None:
        lines.fail("no column is called time; give rate=")
    times = table[:, column]
    if not np.abs(times).max(initial=0.0) < _LARGEST_TIME:
        lines.fail("a time is missing or beyond any clip")
    steps = np.diff(times)
    if len(steps) == 0 or not (steps > 0.0).all():
        lines.fail("the times must increase from row to row, in two rows at least")
    step = (times[-1] - times[0]) / len(steps)
    if np.abs(steps - step).max() > 0.25 * step:
        lines.fail("the times are not even: this reader does not resample")
    return float(1.0 / step)


def _factor(
    path: Path, positions: Float[np.ndarray, "frames markers 3"], unit: str | None, named: set[str]
) -> float:
    if unit is not None:
        return unit_factor(unit)
    if named:
        return UNITS[named.pop()]
    heights = positions[..., 1].max(axis=1) - positions[..., 1].min(axis=1)
    heights = heights[~np.isnan(heights)]
    height = float(np.median(heights)) if len(heights) else 0.0
    guess = "m" if height < _HIGHEST else "cm" if height < 100.0 * _HIGHEST else "mm"
    if guess != "m":
        warnings.warn(
            f"{path}: no unit is given; taken as {guess}: the markers span {height:.4g} upward",
            GaitsmithWarning,
            stacklevel=3,
        )
    return UNITS[guess]
