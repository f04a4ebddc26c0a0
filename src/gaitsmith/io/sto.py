"""Tables of OpenSim: .sto and .mot, read by column name."""

from __future__ import annotations

import warnings
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gaitsmith._checks import frozen_array
from gaitsmith.errors import (
    FileFormatError,
    GaitsmithWarning,
    InvalidInputError,
    UnknownNameError,
)
from gaitsmith.io._numbers import NumberScan

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from jaxtyping import Float

_MOST_HEADER_LINES = 1000
_LONGEST_HEADER = 1 << 22


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of numbers over time.

    Attributes
    ----------
    names
        Name of each column, without the time, as the file has it.
    time
        ``(R,)`` seconds.
    values
        ``(R, C)`` one column a name.
    in_degrees
        Whether its angles are degrees; None where the file does not say.
    """

    names: tuple[str, ...]
    time: Float[np.ndarray, "rows"]
    values: Float[np.ndarray, "rows columns"]
    in_degrees: bool | None = None

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        object.__setattr__(self, "names", tuple(self.names))
        if len(set(self.names)) < len(self.names):
            raise InvalidInputError("column names must be different")
        rows = len(self.time)
        object.__setattr__(self, "time", frozen_array("time", self.time, (rows,)))
        shape = (rows, len(self.names))
        object.__setattr__(self, "values", frozen_array("values", self.values, shape))

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def __getitem__(self, name: str) -> Float[np.ndarray, "rows"]:
        """Column called ``name``, or whose path ends in ``/name`` or ``/name/value``.

        Raises UnknownNameError if there is none.
        """
        if name in self.names:
            return self.values[:, self.names.index(name)]
        endings = (f"/{name}", f"/{name}/value")
        found = [i for i, full in enumerate(self.names) if full.endswith(endings)]
        if len(found) == 1:
            return self.values[:, found[0]]
        raise UnknownNameError("column", name, self.names)

    @property
    def rate(self) -> float:
        """Rows per second; needs two rows."""
        if len(self) < 2:
            raise InvalidInputError("a table of one row has no rate")
        return float((len(self) - 1) / (self.time[-1] - self.time[0]))


def read_sto(path: Path) -> Table:
    """Table in the .sto or .mot at ``path``.

    Column counts of the header are not believed (OpenSim's own files have wrong ones): the
    line of names counts.

    Raises
    ------
    FileFormatError
        If it is none or a broken one; names the line.
    OSError
        If it cannot be opened.
    """
    data = path.read_bytes()
    header, names, start, line = _header(path, data)
    said: list[str] = []
    declared = _count(path, header.get("nrows", header.get("datarows", "")))
    rows = NumberScan(str(path), data, start, line, len(names)).rows(declared, said)
    columns = _count(path, header.get("ncolumns", header.get("datacolumns", "")))
    if columns is not None and columns != len(names):
        said.append(f"{path}: declares {columns} columns, names {len(names)}: read by name")
    for text in said:
        warnings.warn(text, GaitsmithWarning, stacklevel=2)
    degrees = {"yes": True, "no": False}.get(header.get("indegrees", "").lower())
    if (rows[1:, 0] <= rows[:-1, 0]).any():
        raise FileFormatError(path, "the times must increase from row to row")
    return Table(tuple(names[1:]), rows[:, 0], rows[:, 1:], degrees)


def _header(path: Path, data: bytes) -> tuple[dict[str, str], list[str], int, int]:
    """Facts of the header, names of the columns, where the numbers start and on which line."""
    header: dict[str, str] = {}
    at, ended = 0, False
    for number in range(1, _MOST_HEADER_LINES + 1):
        end = data.find(b"\n", at, at + _LONGEST_HEADER)
        if end < 0:
            break
        text = data[at:end].decode("utf-8-sig", errors="replace").strip()
        at = end + 1
        if ended and text:
            return header, _names(path, text, number), at, number + 1
        ended = ended or text.lower() == "endheader"
        key, _, value = text.partition("=") if "=" in text else text.partition(" ")
        header.setdefault(key.strip().lower(), value.strip())
    what = "names of columns behind it" if ended else "'endheader' in it"
    raise FileFormatError(path, f"this is no table of OpenSim: there is no line of {what}")


def _names(path: Path, text: str, line: int) -> list[str]:
    names = [name.strip() for name in (text.split("\t") if "\t" in text else text.split())]
    if names[0].lower() != "time":
        raise FileFormatError(
            path, f"the first column must be time, got {names[0][:40]!r}", line=line
        )
    if twice := [name for name, count in Counter(names).items() if count > 1]:
        raise FileFormatError(path, f"more than one column is called {twice[0][:40]!r}", line=line)
    return names


def _count(path: Path, text: str) -> int | None:
    """A count of the header, None where there is none."""
    if not text:
        return None
    if not text.isdecimal() or len(text) > 15:
        raise FileFormatError(path, f"a count of {text[:20]!r} in the header")
    return int(text)
