"""Motions, markers and tables to files and back: tables of readers and writers, one `save`.

A new format is one module and one line in :data:`WRITERS`, :data:`READERS`,
:data:`MARKER_READERS` or :data:`TABLE_READERS`. Formats that other layers write (pictures)
are added by who calls :func:`save`, through ``writers``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from gaitsmith.errors import InvalidInputError, UnknownFormatError
from gaitsmith.motion.motion import Markers, Motion
from gaitsmith.motion.performance import Performance

__all__ = [
    "MARKER_READERS",
    "READERS",
    "PERFORMANCE_WRITERS",
    "TABLE_READERS",
    "WRITERS",
    "Reader",
    "Writer",
    "load",
    "load_markers",
    "load_performance",
    "load_table",
    "place",
    "save",
    "save_all",
    "save_performance",
]

if TYPE_CHECKING:
    from gaitsmith.io.sto import Table

_Read = TypeVar("_Read")
#: Writes a Motion in package conventions to a path; units, axes and quaternion order of the
#: format are its own business. The path has the format's suffix, though not its final name.
Writer = Callable[[Motion, Path], None]
#: Writes several people to one file, as :data:`Writer` does one.
PerformanceWriter = Callable[[Performance, Path], None]
#: Reads a file into a Motion in package conventions; FileFormatError if it cannot.
Reader = Callable[[Path], Motion]


def _late(module: str, name: str) -> Callable[..., Any]:
    """A reader or writer whose module is imported when it is called."""

    def call(*arguments: Any) -> Any:
        return getattr(import_module(f"gaitsmith.io.{module}"), name)(*arguments)

    return call


#: Writers by suffix, in lower case.
WRITERS: dict[str, Writer] = {
    ".bvh": _late("bvh", "write_bvh"),
    ".csv": _late("table", "write_csv"),
    ".glb": _late("gltf", "write_glb"),
    ".npz": _late("npz", "write_npz"),
}
#: Writers of several people in one file.
PERFORMANCE_WRITERS: dict[str, PerformanceWriter] = {
    ".glb": _late("gltf", "write_glb"),
    ".npz": _late("npz", "write_npz"),
}
#: What the name of a file has where the name of a walker goes: one file each.
WALKER = "{walker}"
#: Readers by suffix, in lower case.
READERS: dict[str, Reader] = {
    ".amc": _late("amc", "read_amc"),
    ".bvh": _late("bvh_motion", "read_bvh"),
    ".glb": _late("glb_motion", "read_glb"),
    ".npz": _late("npz", "read_npz"),
}
#: Readers of several people by suffix.
PERFORMANCE_READERS: dict[str, Callable[[Path], Performance]] = {
    ".glb": _late("glb_motion", "read_glb_performance"),
    ".npz": _late("npz", "read_npz_performance"),
}
#: Readers of measured markers by suffix.
MARKER_READERS: dict[str, Callable[[Path], Markers]] = {
    ".csv": _late("marker_csv", "read_marker_csv"),
    ".trc": _late("trc", "read_trc"),
}
#: Readers of tables of numbers over time by suffix.
TABLE_READERS: dict[str, Callable[[Path], Table]] = {
    ".mot": _late("sto", "read_sto"),
    ".sto": _late("sto", "read_sto"),
}


def save(motion: Motion, path: str | Path, writers: Mapping[str, Writer] = WRITERS) -> Path:
    """Write ``motion`` in the format of the suffix of ``path``, which is returned.

    The file appears whole or not at all: it is written beside the target and moved over it.

    Raises
    ------
    UnknownFormatError
        If no writer has the suffix; nothing was touched.
    InvalidInputError
        If the motion lacks what the format needs.
    OSError
        If the disk refuses, FileNotFoundError if the folder does not exist.
    """
    return save_all(motion, [path], writers)[0]


def save_all(
    motion: Motion, paths: Iterable[str | Path], writers: Mapping[str, Writer] = WRITERS
) -> list[Path]:
    """Write ``motion`` to every path, or to none of them if one cannot be written.

    Raises as :func:`save` does. All files are complete before the first takes its place.
    """
    targets = [Path(path) for path in paths]
    jobs = [(partial(_writer(target, writers), motion), target) for target in targets]
    place(jobs)
    return targets


def save_performance(
    performance: Performance,
    paths: Iterable[str | Path],
    writers: Mapping[str, Writer] = WRITERS,
    performance_writers: Mapping[str, PerformanceWriter] = PERFORMANCE_WRITERS,
) -> list[Path]:
    """Write several people: to one file, or to one each where its name has ``{walker}``.

    Returns the files, in the order of ``paths`` and of the people. All are complete before the
    first takes its place. Raises as :func:`save` does, and InvalidInputError for a format that
    holds one person, or two paths that would be one file.
    """
    jobs: list[tuple[Callable[[Path], None], Path]] = []
    alone = len(performance) == 1 and performance.surroundings == "{}"
    for path in map(Path, paths):
        if WALKER in path.name:
            for name, motion in performance:
                target = path.with_name(path.name.replace(WALKER, name))
                jobs.append((partial(_writer(target, writers), motion), target))
        elif alone or (len(performance) == 1 and path.suffix.lower() not in performance_writers):
            jobs.append((partial(_writer(path, writers), performance.motions[0]), path))
        else:
            jobs.append(
                (
                    partial(_performance_writer(path, writers, performance_writers), performance),
                    path,
                )
            )
    targets = [target for _, target in jobs]
    double = {target for target in targets if targets.count(target) > 1}
    if double:
        raise InvalidInputError(f"{min(double)} would be written twice; give it once")
    place(jobs)
    return targets


def _performance_writer(
    path: Path, writers: Mapping[str, Writer], performance_writers: Mapping[str, PerformanceWriter]
) -> PerformanceWriter:
    suffix = path.suffix.lower()
    if suffix not in performance_writers:
        _writer(path, writers)  # what no table has
        raise InvalidInputError(
            f"{path.name}: a {suffix} file holds one person; write one each with "
            f"{path.stem}-{WALKER}{path.suffix}, or all in one file with "
            + " or ".join(sorted(performance_writers))
        )
    return performance_writers[suffix]


def place(jobs: Iterable[tuple[Callable[[Path], None], Path]]) -> None:
    """Let every function write a file beside its target, then move all to their targets.

    The files appear whole or not at all, and none does if one cannot be written. Raises what
    the functions raise, and OSError as :func:`save` does.
    """
    todo = [(write, target, _beside(target)) for write, target in jobs]
    try:
        for write, target, temporary in todo:
            try:
                write(temporary)
            except OSError as error:
                if error.filename is not None and Path(os.fsdecode(error.filename)) == temporary:
                    error.filename = str(target)  # nobody knows the name of the other file
                raise
        for _, target, temporary in todo:
            temporary.replace(target)
    finally:
        for _, _, temporary in todo:
            temporary.unlink(missing_ok=True)


def load(
    path: str | Path, readers: Mapping[str, Reader] = READERS, *, walker: str | None = None
) -> Motion:
    """Motion in the file at ``path``, read by what the table has for its suffix.

    Of a file of several people the one called ``walker``; None: the first, with a warning.

    Raises
    ------
    UnknownFormatError
        If no reader has the suffix.
    UnknownNameError
        If nobody in the file is called ``walker``.
    FileFormatError
        If the file is not what its suffix says; the message says what is wrong.
    OSError
        If it cannot be opened.
    """
    if walker is not None:
        return load_performance(path)[walker]
    return _read(Path(path), readers)


def load_performance(path: str | Path) -> Performance:
    """Everybody in the file of people at ``path`` (.npz, .glb). Raises as :func:`load` does."""
    return _read(Path(path), PERFORMANCE_READERS)


def load_markers(path: str | Path) -> Markers:
    """Markers in the file at ``path`` (.trc, .csv). Raises as :func:`load` does."""
    return _read(Path(path), MARKER_READERS)


def load_table(path: str | Path) -> Table:
    """Table in the file at ``path`` (.sto, .mot). Raises as :func:`load` does."""
    return _read(Path(path), TABLE_READERS)


def _read(path: Path, readers: Mapping[str, Callable[[Path], _Read]]) -> _Read:
    read = readers.get(path.suffix.lower())
    if read is None:
        raise UnknownFormatError(path.suffix, readers, verb="read")
    return read(path)


def _writer(target: Path, writers: Mapping[str, Writer]) -> Writer:
    writer = writers.get(target.suffix.lower())
    if writer is None:
        raise UnknownFormatError(target.suffix, writers)
    return writer


def _beside(target: Path) -> Path:
    """Name beside ``target`` that no other file has, with its suffix, if there is a place."""
    if not target.parent.is_dir():
        raise FileNotFoundError(f"cannot write {target}: there is no folder {target.parent}")
    if target.is_dir():
        raise IsADirectoryError(f"cannot write {target}: it is a folder")
    return target.with_name(f".gaitsmith-{os.urandom(8).hex()}{target.suffix}")
