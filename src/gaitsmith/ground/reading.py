"""Grounds from words, files and JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith.errors import (
    FileFormatError,
    InvalidInputError,
    UnknownFormatError,
    UnknownNameError,
)
from gaitsmith.ground.boxes import BASES, Boxes
from gaitsmith.ground.boxes_file import read_boxes
from gaitsmith.ground.heightfield import MOST_SAMPLES, HeightField
from gaitsmith.ground.mesh import field_from_mesh
from gaitsmith.ground.obj import read_obj

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Shaped

    from gaitsmith.ground.model import Ground

#: Grounds by the name that the command line and JSON use; the kit of tests/conformance picks
#: each up from here. A new ground is one class in one file and one line in ``BASES``.
GROUNDS: dict[str, type[Ground]] = {**BASES, "boxes": Boxes}
#: How grounds of a few numbers are written, and what the numbers are.
_WORDS: dict[str, tuple[str, int]] = {
    "flat": ("flat", 0),
    "slope": ("slope:DEG as in slope:10", 1),
    "stairs": ("stairs:RISE,TREAD,COUNT as in stairs:0.17,0.29,10", 3),
}


def read_ground(text: str | Path) -> Ground:
    """Ground of ``flat``, ``slope:DEG``, ``stairs:RISE,TREAD,COUNT`` or of a file.

    Files are height fields (``.npz``; ``.png`` of 16 bits with a ``.toml`` of the same name),
    meshes looked at from above (``.obj``), or boxes on a ground (``.toml``);
    docs/reference/grounds.md has them in full.

    Raises
    ------
    InvalidInputError
        If the words are none of these, or a number is out of range.
    FileFormatError
        If the file is not what it claims to be.
    """
    if isinstance(text, Path):
        return _read_file(text)
    name, colon, numbers = text.strip().partition(":")
    suffix = Path(text).suffix.lower()
    if suffix in _FILES:
        return _read_file(Path(text))
    if name in _WORDS:
        return _from_words(name, numbers if colon else None)
    if name in ("heightfield", "boxes"):
        known = [".toml"] if name == "boxes" else sorted(set(_FILES) - {".toml"})
        raise InvalidInputError(
            f"ground {name!r} is read from a file: give one of {', '.join(known)}"
        )
    if suffix and not colon:
        raise UnknownFormatError(suffix, _FILES, verb="read a ground from")
    raise UnknownNameError("ground", name, [*_WORDS, *(f"FILE{s}" for s in _FILES)])


def ground_from_json(data: str | dict[str, Any]) -> Ground:
    """Ground of what ``as_json`` wrote: the ``ground`` of a motion.

    Raises
    ------
    InvalidInputError
        If it is no ground's JSON.
    """
    try:
        fact = json.loads(data) if isinstance(data, str) else data
        kind = fact["kind"]
    except (ValueError, TypeError, KeyError):
        raise InvalidInputError(
            'a ground\'s JSON is an object with its kind, as in {"kind": "flat", "height": 0}'
        ) from None
    if kind not in GROUNDS:
        raise UnknownNameError("ground", str(kind), GROUNDS)
    try:
        return GROUNDS[kind].from_json(fact)
    except KeyError as error:
        raise InvalidInputError(f"the JSON of a ground {kind!r} has no {error}") from None
    except TypeError as error:
        raise InvalidInputError(f"not the JSON of a ground {kind!r}: {error}") from None


def _from_words(name: str, numbers: str | None) -> Ground:
    """Ground ``name`` of comma-separated ``numbers``."""
    how, count = _WORDS[name]
    words = [] if numbers is None else numbers.split(",")
    if len(words) != count:
        given = name if numbers is None else f"{name}:{numbers}"
        raise InvalidInputError(f"a ground of this kind is {how}, got {given!r}")
    values = []
    for word in words:
        try:
            values.append(float(word))
        except ValueError:
            raise InvalidInputError(
                f"a ground of this kind is {how}; {word.strip()!r} is not a number"
            ) from None
    return GROUNDS[name](*values)


def _read_file(path: Path) -> Ground:
    suffix = path.suffix.lower()
    if suffix not in _FILES:
        raise UnknownFormatError(suffix, _FILES, verb="read a ground from")
    try:
        return _FILES[suffix](path)
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None
    except OSError as error:
        raise FileFormatError(path, f"cannot be read: {error.strerror or error}") from None


def _read_npz(path: Path) -> HeightField:
    """Arrays ``height`` (rows along +Z, columns along +X), ``cell``, ``origin`` (x,z)."""
    from zipfile import ZipFile

    arrays: dict[str, Shaped[np.ndarray, "..."]] = {}
    try:
        with ZipFile(path) as archive:
            names = [name.removesuffix(".npy") for name in archive.namelist()]
            for name in {"height", "cell", "origin"} & set(names):
                with archive.open(f"{name}.npy") as stream:
                    arrays[name] = np.lib.format.read_array(stream, allow_pickle=False)
    except OSError as error:
        if error.filename is not None:  # the disk's fault, and it says so
            raise
        raise FileFormatError(path, f"not a readable npz archive: {error}") from None
    except Exception as error:  # of a damaged header NumPy raises all that Python's parser may
        why = " ".join(str(error).split())[:200] or type(error).__name__
        raise FileFormatError(path, f"not a readable npz archive: {why}") from None
    for name in ("height", "cell", "origin"):
        if name not in arrays:
            raise FileFormatError(
                path,
                f"a height field has arrays height, cell and origin; {name} is missing, "
                f"there are {', '.join(names) or 'none'}",
            )
    cell, origin = arrays["cell"], arrays["origin"]
    if cell.size != 1 or origin.shape != (2,):
        raise FileFormatError(
            path, f"cell must be one number and origin x,z, got {cell.tolist()}, {origin.tolist()}"
        )
    return HeightField(arrays["height"], cell.reshape(()).item(), tuple(origin.tolist()))


def _read_png(path: Path) -> HeightField:
    """Gray levels of 16 bits; the ``.toml`` beside it says what they mean."""
    import tomllib

    from PIL import Image, UnidentifiedImageError

    facts_path = path.with_suffix(".toml")
    try:
        facts = tomllib.loads(facts_path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileFormatError(
            path,
            f"needs {facts_path.name} beside it, with cell, origin and height = [low, high], the "
            "meters of black and white",
        ) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileFormatError(facts_path, f"not a TOML file: {error}") from None
    low, high = _png_facts(facts_path, facts)
    try:
        with Image.open(path) as image:
            if image.format != "PNG" or image.mode not in ("I;16", "I;16B", "I;16L", "I"):
                raise FileFormatError(
                    path, f"must be a PNG of 16-bit gray levels, is {image.format} {image.mode}"
                )
            if image.width * image.height > MOST_SAMPLES:
                raise FileFormatError(path, f"has more than {MOST_SAMPLES:.0e} pixels; cut it")
            levels = np.array(image, dtype=np.float64)
    except (UnidentifiedImageError, Image.DecompressionBombError, SyntaxError) as error:
        raise FileFormatError(path, f"not a PNG picture: {error}") from None
    heights = np.round(low + (high - low) * levels / 65535.0, 6)
    return HeightField(heights, facts["cell"], tuple(facts["origin"]))


def _png_facts(path: Path, facts: dict[str, Any]) -> tuple[float, float]:
    """Check the facts of a picture; heights of black and white."""
    known = ("cell", "origin", "height")
    for name in facts:
        if name not in known:
            raise FileFormatError(path, f"{name}: unknown key, known: {', '.join(known)}")
    for name in known:
        if name not in facts:
            raise FileFormatError(
                path, f"{name} is missing; needed are cell, origin and height = [low, high]"
            )
    for name in ("origin", "height"):
        value = facts[name]
        if not isinstance(value, list) or len(value) != 2 or not all(map(_is_number, value)):
            raise FileFormatError(path, f"{name} must be two numbers of meters, got {value!r}")
    low, high = (float(value) for value in facts["height"])
    if low == high:
        raise FileFormatError(path, f"height must be two different heights, got {low:g} twice")
    return low, high


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _read_obj(path: Path) -> HeightField:
    return field_from_mesh(*read_obj(path))


def _read_toml(path: Path) -> Boxes:
    return read_boxes(path, _beside)


def _beside(text: str, folder: Path) -> Ground:
    """The ground of words or of a file beside another one."""
    suffix = Path(text).suffix.lower()
    if suffix == ".toml":
        raise InvalidInputError(
            f"boxes lie on words or on a file of heights, not on {text!r}; put all boxes into one "
            "file"
        )
    return _read_file(folder / text) if suffix in _FILES else read_ground(text)


_FILES: dict[str, Callable[[Path], Ground]] = {
    ".npz": _read_npz,
    ".png": _read_png,
    ".obj": _read_obj,
    ".toml": _read_toml,
}
