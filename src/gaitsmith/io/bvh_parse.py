"""BVH of every dialect, as files in the wild have it, into a :class:`BvhFile`.

Read without a word: any line end, tabs, a byte order mark, any case of the keywords, braces
anywhere, names with blanks and colons, joints with any number of channels in any order,
frames wrapped over lines, ``1e3`` notation, End Sites with names or none at all.

Read with a warning: no ``Frame Time`` (or one of zero), more frames than ``Frames:`` says,
blank lines between frames, two joints of one name.

Refused, with the line: what is no BVH, what ends too early, fewer frames than ``Frames:``
says, numbers that are none or not finite.

The parser does not recurse, and no number that a file merely declares is ever allocated: it
needs a few times the memory of the file and time in proportion, whatever the file says.
"""

from __future__ import annotations

import re
import warnings
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from gaitsmith.errors import FileFormatError, GaitsmithWarning
from gaitsmith.io._numbers import NumberScan
from gaitsmith.io.bvh_file import CHANNELS, BvhFile, EndSite

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

#: More than any figure has, few enough that a broken file is refused at once.
MAX_JOINTS = 4096
#: Three positions, three rotations.
MAX_CHANNELS = 6
#: Bytes of a line before the numbers; a longer one is not a BVH's.
MAX_LINE = 1 << 16
#: Seconds from frame to frame where a file does not say: the commonest rate of clips.
DEFAULT_FRAME_TIME = 1.0 / 30.0
_FRAMES = re.compile(r"frames?\s*:?\s*([^\s:]+)", re.IGNORECASE)
_FRAME_TIME = re.compile(r"frame\s*_?time\s*:?\s*([^\s:]+)", re.IGNORECASE)
_WORD = re.compile(r"[{}]|[^\s{}]+")


def read_bvh_file(path: Path) -> BvhFile:
    """Read the BVH at ``path``, whatever its dialect; see the top of this module.

    What is odd but readable is said as a GaitsmithWarning and kept in ``BvhFile.warnings``.

    Raises
    ------
    FileFormatError
        If it is not a BVH or a broken one; names the file, the line and the cause.
    OSError
        If it cannot be opened.
    """
    file = parse_bvh(path.read_bytes(), str(path))
    for line in file.warnings:
        warnings.warn(line, GaitsmithWarning, stacklevel=2)
    return file


def parse_bvh(data: bytes, path: str = "<bvh>") -> BvhFile:
    """Parse the bytes of a BVH; ``path`` names it in messages. Raises FileFormatError."""
    words = _Words(path, _plain(data))
    tree = _hierarchy(words)
    said: list[str] = []
    if twice := [name for name, count in Counter(tree.names).items() if count > 1]:
        said.append(f"{path}: more than one joint is called {twice[0][:40]!r}")
    declared, frame_time = _motion_header(words, said)
    width = sum(map(len, tree.channels))
    if width == 0 and declared > 0:
        words.fail(f"declares {declared} frames, but no joint has a channel")
    scan = NumberScan(path, words.data, words.at, words.line + 1, width, "frames")
    values = scan.rows(declared, said)
    return BvhFile(
        names=tuple(tree.names),
        parents=tuple(tree.parents),
        offsets=np.array(tree.offsets),
        channels=tuple(tree.channels),
        ends=tuple(EndSite(joint, offset, name) for joint, offset, name in tree.ends),
        frame_time=frame_time,
        values=values,
        warnings=tuple(said),
    )


def _plain(data: bytes) -> bytes:
    """The same text without byte order mark, in UTF-8 or ASCII, with newlines."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        data = data.decode("utf-16", errors="replace").encode("utf-8")
    data = data.removeprefix(b"\xef\xbb\xbf")
    if b"\r" in data and b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    return data


class _Words:
    """The words of the header one by one, and where they stand.

    ``at`` is the offset of the line after the current one, ``line`` the number of the current.
    """

    def __init__(self, path: str, data: bytes) -> None:
        self.path, self.data = path, data
        self.at = self.start = self.line = 0
        self.rest = ""

    def fail(self, why: str) -> NoReturn:
        raise FileFormatError(self.path, why, line=max(self.line, 1))

    def _next_line(self) -> bool:
        if self.at >= len(self.data):
            return False
        self.start = self.at
        end = self.data.find(b"\n", self.start, self.start + MAX_LINE)
        if end < 0:
            end = len(self.data)
            if end - self.start > MAX_LINE:
                self.line += 1
                self.fail(f"this is no BVH: a line of more than {MAX_LINE} characters")
        self.at, self.line = end + 1, self.line + 1
        raw = self.data[self.start : end]
        try:
            self.rest = raw.decode("utf-8").strip()
        except UnicodeDecodeError:
            self.rest = raw.decode("latin-1").strip()
        return True

    def text(self) -> str:
        """What is left of the line, or of the next that has something; empty at the end."""
        while not self.rest:
            if not self._next_line():
                return ""
        return self.rest

    def word(self) -> str:
        """The next word or brace; empty at the end."""
        match = _WORD.match(self.text())
        if match is None:
            return ""
        self.rest = self.rest[match.end() :].lstrip()
        return match[0]

    def name(self) -> str:
        """The rest of the line up to a brace that opens a block."""
        before, brace, after = self.rest, "", ""
        opening = re.search(r"(?:^|\s)\{", self.rest)
        if opening is not None:
            before, brace, after = self.rest[: opening.start()], "{", self.rest[opening.end() :]
        elif self.rest.endswith("{"):
            before, brace = self.rest[:-1], "{"
        self.rest = brace + after
        return before.strip()

    def number(self, what: str) -> float:
        word = self.word()
        try:
            value = float(word)
        except ValueError:
            value = float("nan")
        if not np.isfinite(value) or "_" in word:
            self.fail(f"{what} must be a finite number, got {word[:40]!r}")
        return value


@dataclass
class _Tree:
    """What the HIERARCHY says."""

    names: list[str] = field(default_factory=list[str])
    parents: list[int] = field(default_factory=list[int])
    offsets: list[tuple[float, float, float]] = field(
        default_factory=list[tuple[float, float, float]]
    )
    channels: list[tuple[str, ...]] = field(default_factory=list[tuple[str, ...]])
    ends: list[tuple[int, tuple[float, float, float], str]] = field(
        default_factory=list[tuple[int, tuple[float, float, float], str]]
    )
    #: Joints whose block is open; the block of an End Site in the innermost is open too.
    path: list[int] = field(default_factory=list[int])
    in_end: bool = False


def _hierarchy(words: _Words) -> _Tree:
    if words.word().lower() != "hierarchy":
        words.fail("this is no BVH: it does not start with HIERARCHY")
    tree = _Tree()
    while (word := words.word()).lower() != "motion":
        statement = _STATEMENTS.get(word.lower())
        if not word:
            words.fail("the file ends before MOTION")
        if statement is None:
            words.fail(f"{word[:40]!r} has no place in a HIERARCHY")
        statement(words, tree, word)
    if tree.path:
        words.fail(f"MOTION, but the block of {tree.names[tree.path[-1]]!r} is not closed")
    if not tree.names:
        words.fail("MOTION, but there was no ROOT")
    return tree


def _joint(words: _Words, tree: _Tree, word: str) -> None:
    name, root = words.name(), word.lower() == "root"
    if not name:
        words.fail(f"{word} without a name")
    if name.endswith("{"):
        words.fail(f"the name {name[:40]!r} ends in a brace")
    if root == bool(tree.path) or tree.in_end:
        inside = "inside another joint" if root else "outside of the joints"
        words.fail(f"{word} {name[:40]!r} stands {'in an End Site' if tree.in_end else inside}")
    if len(tree.names) == MAX_JOINTS:
        words.fail(f"more than {MAX_JOINTS} joints")
    _open(words)
    tree.names.append(name)
    tree.parents.append(-1 if root else tree.path[-1])
    tree.offsets.append((0.0, 0.0, 0.0))
    tree.channels.append(())
    tree.path.append(len(tree.names) - 1)


def _end(words: _Words, tree: _Tree, word: str) -> None:
    if not tree.path or tree.in_end:
        words.fail("an End Site outside of the joints")
    if len(tree.ends) == MAX_JOINTS:
        words.fail(f"more than {MAX_JOINTS} End Sites")
    text = words.name()
    site = re.match(r"site\b\s*", text, re.IGNORECASE)
    _open(words)
    tree.ends.append((tree.path[-1], (0.0, 0.0, 0.0), text[site.end() :] if site else text))
    tree.in_end = True


def _open(words: _Words) -> None:
    if (word := words.word()) != "{":
        words.fail(f"a block must open with '{{', got {word[:40]!r}")


def _close(words: _Words, tree: _Tree, word: str) -> None:
    if tree.in_end:
        tree.in_end = False
    elif tree.path:
        tree.path.pop()
    else:
        words.fail(f"{word!r} closes a block that is not open")


def _offset(words: _Words, tree: _Tree, word: str) -> None:
    if not tree.path:
        words.fail(f"{word} outside of the joints")
    offset = words.number("OFFSET"), words.number("OFFSET"), words.number("OFFSET")
    if tree.in_end:
        joint, _, name = tree.ends[-1]
        tree.ends[-1] = joint, offset, name
    else:
        tree.offsets[tree.path[-1]] = offset


def _channels(words: _Words, tree: _Tree, word: str) -> None:
    if not tree.path or tree.in_end:
        words.fail(f"{word} outside of a joint")
    count = words.number("the number of CHANNELS")
    if not 0 <= count <= MAX_CHANNELS or count != int(count):
        words.fail(f"the number of CHANNELS must be 0 to {MAX_CHANNELS}, got {count:g}")
    names: list[str] = []
    for _ in range(int(count)):
        written = words.word()
        if written.lower() not in CHANNELS:
            words.fail(f"{int(count)} channels expected, but {written[:40]!r} is none")
        names.append(CHANNELS[written.lower()])
    tree.channels[tree.path[-1]] = tuple(names)


_STATEMENTS: dict[str, Callable[[_Words, _Tree, str], None]] = {
    "root": _joint,
    "joint": _joint,
    "end": _end,
    "endsite": _end,
    "offset": _offset,
    "channels": _channels,
    "}": _close,
}


def _motion_header(words: _Words, said: list[str]) -> tuple[int, float]:
    """Declared frames and the frame time; the words then stand before the numbers."""
    match = _FRAMES.match(words.text())
    if match is None or _FRAME_TIME.match(words.rest):
        words.fail(f"'Frames:' expected after MOTION, got {words.rest[:40]!r}")
    try:
        declared = float(match[1])
    except ValueError:
        declared = float("nan")
    if not 0 <= declared < 1e15 or declared != int(declared) or "_" in match[1]:
        words.fail(f"'Frames:' must be a whole number from 0 on, got {match[1][:40]!r}")
    words.rest = words.rest[match.end() :].lstrip()
    match = _FRAME_TIME.match(words.text())
    if match is None:
        if words.rest:  # numbers already: the line is theirs
            words.at, words.line = words.start, words.line - 1
        said.append(
            f"{words.path}: no 'Frame Time:', {DEFAULT_FRAME_TIME:.7f} s (30 frames a second) taken"
        )
        return int(declared), DEFAULT_FRAME_TIME
    try:
        seconds = float(match[1])
    except ValueError:
        seconds = float("nan")
    if not (seconds == 0.0 or 1e-6 <= seconds <= 1e3) or "_" in match[1]:
        words.fail(f"'Frame Time:' must be 0.000001 to 1000 seconds, got {match[1][:40]!r}")
    if rest := words.rest[match.end() :].strip():
        words.fail(f"{rest[:40]!r} stands behind the 'Frame Time:'")
    if seconds == 0.0:
        said.append(
            f"{words.path}:{words.line}: a 'Frame Time:' of zero, {DEFAULT_FRAME_TIME:.7f} s "
            "(30 frames a second) taken"
        )
        seconds = DEFAULT_FRAME_TIME
    return int(declared), seconds
