"""Lines of a text file, numbered, in whatever encoding and with whatever line ends."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, NoReturn

from gaitsmith.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path


class Lines:
    """The lines of the file at ``path`` one by one.

    ``number`` is that of the last one read, ``size`` the bytes of the file.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.number = path, 0
        data = path.read_bytes()
        self.size = len(data)
        if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
            text = data.decode("utf-16", errors="replace")
        else:
            try:
                text = data.decode("utf-8-sig")
            except UnicodeDecodeError:
                text = data.decode("latin-1")
        self._stream = io.StringIO(text.rstrip("\x00\x1a \t\r\n"), newline=None)

    def next(self) -> str | None:
        """The next line without its end, None behind the last one."""
        line = self._stream.readline()
        if not line:
            return None
        self.number += 1
        return line.rstrip("\n")

    def need(self, what: str) -> str:
        """The next line, or an error that says ``what`` is missing."""
        line = self.next()
        if line is None:
            self.fail(f"ends where {what} should be")
        return line

    def fail(self, why: str) -> NoReturn:
        """Refuse the file because of the last line read."""
        raise FileFormatError(self.path, why, line=max(self.number, 1))

    def value(self, word: str, what: str) -> float:
        """``word`` as a finite number, or an error that names ``what``."""
        try:
            value = float(word)
        except ValueError:
            value = float("nan")
        if not abs(value) < float("inf") or "_" in word:
            self.fail(f"{what} must be a finite number, got {word[:40]!r}")
        return value
