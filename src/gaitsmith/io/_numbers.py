"""Long runs of numbers as text into arrays: quick, in little memory, with the line of a fault."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from gaitsmith.errors import FileFormatError

if TYPE_CHECKING:
    from jaxtyping import Float, Int

#: Bytes worked on at a time: their words are Python objects of twenty times the size.
CHUNK = 1 << 18
#: Characters of a number, at the border of two chunks.
LONGEST = 400
_SPACE = re.compile(rb"[ \t-\r]")


@dataclass(frozen=True)
class _Odd:
    """A line of note: its number, how many values came before it and how many it has."""

    line: int
    before: int
    count: int


class NumberScan:
    """Numbers from ``start`` to the end of ``data``, ``width`` a row, rows over any lines.

    ``line`` is the number of the line at ``start``; ``path`` names the file in messages and
    ``what`` its rows.
    """

    def __init__(
        self, path: str, data: bytes, start: int, line: int, width: int, what: str = "rows"
    ) -> None:
        self.what = what
        self.path, self.data, self.start, self.width = path, data, start, width
        self._line = line  # of the next byte
        self._last = line  # with a number on it
        self._total = self._at_line_start = 0
        self._blank: _Odd | None = None
        self._short: _Odd | None = None
        self._crossing: _Odd | None = None

    def rows(self, declared: int | None, said: list[str]) -> Float[np.ndarray, "rows width"]:
        """All rows; adds to ``said`` what is odd. Raises FileFormatError with the line.

        ``declared`` is how many rows the file says that it has, None if it does not.
        """
        blocks = [np.zeros(0), *self._blocks()]
        values = np.concatenate(blocks)
        rows, extra = divmod(len(values), self.width) if self.width else (0, len(values))
        crossing = self._crossing
        if self.width and crossing is not None and (extra or rows != declared):
            wanted, odd = self.width - crossing.before % self.width, crossing
            if self._short is not None and self._short.before + self._short.count == odd.before:
                wanted, odd = self.width, self._short
            raise FileFormatError(
                self.path,
                f"{odd.count} values where {wanted} were expected: each of the {self.what} has "
                f"{self.width}",
                line=odd.line,
            )
        if extra or rows < (declared or 0):
            says = "" if declared is None else f"declares {declared} {self.what}, but "
            more = f" and {extra} of {self.width} values of another" if extra else ""
            raise FileFormatError(
                self.path, f"{says}ends after {rows} {self.what}{more}", line=self._last
            )
        if self._blank is not None and self._blank.before < len(values):
            said.append(f"{self.path}:{self._blank.line}: blank line between the {self.what}")
        if declared is not None and rows > declared:
            said.append(f"{self.path}: declares {declared} {self.what}, has {rows}: all are read")
        return values.reshape(rows, self.width)

    def _blocks(self) -> list[Float[np.ndarray, "values"]]:
        at, end = self.start, len(self.data)
        while end > at and self.data[end - 1] in b"\x00\x1a \t\r\n":
            end -= 1
        blocks: list[Float[np.ndarray, "values"]] = []
        while at < end:
            stop = min(at + CHUNK, end)
            if stop < end:
                space = _SPACE.search(self.data, stop, stop + LONGEST)
                if space is None and stop + LONGEST < end:
                    line = self._line + self.data.count(b"\n", at, stop)
                    raise FileFormatError(self.path, "a word without end", line=line)
                stop = end if space is None else space.end()
            chunk = self.data[at:stop]
            if stop == end:
                chunk += b"\n"
            blocks.append(self._numbers(chunk))
            self._note_lines(chunk)
            at = stop
        return blocks

    def _numbers(self, chunk: bytes) -> Float[np.ndarray, "values"]:
        words = chunk.split()
        try:
            values = np.array(list(map(float, words)), dtype=np.float64)
        except ValueError:
            self._refuse(chunk)
        if not np.isfinite(values).all() or b"_" in chunk:
            self._refuse(chunk)
        return values

    def _refuse(self, chunk: bytes) -> NoReturn:
        """Name the first word of ``chunk`` that is no finite number."""
        for i, line in enumerate(chunk.split(b"\n")):
            for word in line.split():
                try:
                    fine = np.isfinite(float(word)) and b"_" not in word
                except ValueError:
                    fine = False
                if not fine:
                    shown = word[:40].decode("utf-8", errors="replace")
                    raise FileFormatError(
                        self.path, f"{shown!r} is not a finite number", line=self._line + i
                    )
        raise AssertionError("a refused chunk holds something to refuse")

    def _note_lines(self, chunk: bytes) -> None:
        """Which lines are blank, which are short of a row, which go on into the next row."""
        text = np.frombuffer(chunk, np.uint8)
        space = (text == 32) | ((text >= 9) & (text <= 13))
        starts = ~space
        starts[1:] &= space[:-1]
        counts = np.cumsum(starts, dtype=np.int32)
        ends = np.flatnonzero(text == 10)
        after = self._total + counts[ends].astype(np.int64)
        before = np.concatenate([[self._at_line_start], after[:-1]])[: len(after)]
        if self._blank is None and (after == before).any():
            self._blank = self._odd(int((after == before).argmax()), before, after)
        if self._crossing is None and self.width:
            crossing = (after > before) & ((after - 1) // self.width != before // self.width)
            short = (before % self.width == 0) & (after > before) & (after < before + self.width)
            if self._short is None and short.any():
                self._short = self._odd(int(short.argmax()), before, after)
            if crossing.any():
                self._crossing = self._odd(int(crossing.argmax()), before, after)
        self._total += int(counts[-1]) if len(counts) else 0
        if len(after):
            self._at_line_start = int(after[-1])
        filled = np.flatnonzero(after > before)
        if len(filled):
            self._last = self._line + int(filled[-1])
        self._line += len(ends)

    def _odd(
        self, i: int, before: Int[np.ndarray, "lines"], after: Int[np.ndarray, "lines"]
    ) -> _Odd:
        return _Odd(self._line + i, int(before[i]), int(after[i] - before[i]))
