"""Triangle meshes of Wavefront OBJ files: corners and faces, nothing else of the format."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import FileFormatError

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float, Int


def read_obj(path: Path) -> tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "T 3"]]:
    """Corners (meters, +Y up) and triangles (indices of corners) of an OBJ file.

    Faces of more than three corners are cut into a fan. What a ground has no use for (texture
    coordinates, normals, groups, materials, lines) is passed over.

    Raises
    ------
    FileFormatError
        Naming the line, if a corner or a face is not what it should be.
    """
    corners: list[tuple[float, float, float]] = []
    faces: list[list[int]] = []
    lines: list[int] = []
    try:
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise FileFormatError(path, f"cannot be read: {error.strerror or error}") from None
    for number, line in _logical_lines(text):
        words = line.split()
        if not words or words[0] not in ("v", "f"):
            continue
        if words[0] == "v":
            corners.append(_corner(path, number, words[1:]))
        else:
            face = _face(path, number, words[1:], len(corners))
            faces += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
            lines += [number] * (len(face) - 2)
    if not faces:
        raise FileFormatError(path, "has no faces (lines 'f a b c'): not a mesh to walk on")
    triangles = np.array(faces, dtype=np.int64)
    beyond = np.flatnonzero((triangles >= len(corners)).any(axis=1))
    if beyond.size:
        k = int(beyond[0])
        raise FileFormatError(
            path,
            f"the face names corner {triangles[k].max() + 1}, the file has {len(corners)}",
            line=lines[k],
        )
    return np.array(corners, dtype=np.float64), triangles


def _logical_lines(text: str) -> list[tuple[int, str]]:
    """Lines without comments, those that end with a backslash joined, by number of the first."""
    out: list[tuple[int, str]] = []
    held, first = "", 0
    for number, line in enumerate(text.splitlines(), start=1):
        first = first if held else number
        held += line.partition("#")[0]
        if held.rstrip().endswith("\\"):
            held = held.rstrip()[:-1] + " "
            continue
        out.append((first, held))
        held = ""
    if held:
        out.append((first, held))
    return out


def _corner(path: Path, line: int, words: list[str]) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words[:3])
    except ValueError:
        raise FileFormatError(
            path, f"a corner is 'v x y z' in meters, got 'v {' '.join(words)}'", line=line
        ) from None
    if not np.isfinite([x, y, z]).all():
        raise FileFormatError(path, f"a corner must be finite, got 'v {x} {y} {z}'", line=line)
    return x, y, z


def _face(path: Path, line: int, words: list[str], count: int) -> list[int]:
    """Indices from 0 of a face; negative ones count back from the last corner so far."""
    if len(words) < 3:
        raise FileFormatError(path, f"a face has 3 or more corners, got {len(words)}", line=line)
    face: list[int] = []
    for word in words:
        try:
            index = int(word.partition("/")[0])
        except ValueError:
            raise FileFormatError(
                path,
                f"a corner of a face is an index as in '7' or '7/1/3', got {word!r}",
                line=line,
            ) from None
        if index == 0 or index < -count:
            raise FileFormatError(
                path, f"corner {index} of the face is none: {count} so far, from 1", line=line
            )
        face.append(index - 1 if index > 0 else count + index)
    return face
