"""The npz of a motion: the one file that holds everything, exactly.

An uncompressed NumPy archive of these arrays (F frames, J joints, N footsteps, P points;
meters, seconds, radians; float64 but for the integers and flags):

=================== =============== ==========================================================
``format``                          ``"gaitsmith-motion-1"``
``fps``                             frames per second
``joint_names``     (J)             one name a joint, the root first, parents before children
``parents``         (J)             index of each joint's parent, -1 for the root
``offsets``         (J, 3)          joint minus parent at rest
``root_position``   (F, 3)          world position of the root
``rotations``       (F, J, 4)       unit quaternions x, y, z, w, joint to parent
``positions``       (F, J, 3)       world position of every joint
``soles``           (F, 2, 3, 3)    world position of [left, right] x [heel, ball, toe tip]
``contacts``        (F, 2, 3) bool  this point of a sole is on the ground and must not move
``phase``           (F)             time since the last landing over the step's duration
``step``            (F) int         index of the footstep that lands next
``footstep_side``   (N) int         0 left, 1 right
``footstep_position`` (N, 3)        N, the floor point under the ankle of the flat foot
``footstep_heading`` (N)            of the foot
``footstep_time``   (N)             of landing
``ground``                          JSON that rebuilds the ground
``recipe``                          JSON that regenerates the motion
``path``            (P, 2)          x, z of the path, where there was one
``sole_offsets``    (2, 3, 3)       sole points in the frames of the Foot and Toes joints
``joint_ends``      (J, 3)          where bones without a child end, if that is known
``translations``    (F, J, 3)       joint minus parent, where a motion stretches its bones
=================== =============== ==========================================================

``positions`` and ``soles`` follow from the other arrays; they are there so that a reader
needs no kinematics. ``sole_offsets``, ``joint_ends`` and ``translations`` are what it takes
beyond them to get the same :class:`~gaitsmith.motion.motion.Motion` back, to the last bit.

A file of several people (:class:`~gaitsmith.motion.performance.Performance`) has the first
one's arrays under these keys, so that whoever reads one person reads that; besides

=================== =============== ==========================================================
``walkers``         (W)             names of all, the first one's first
``surroundings``                    JSON of what stands around
``NAME/KEY``                        each of the above but ``format``, of every further person
=================== =============== ==========================================================
"""

from __future__ import annotations

import json
import warnings
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import FileFormatError, GaitsmithWarning, InvalidInputError
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.motion.performance import Performance, checked_name
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float, Int, Shaped

FORMAT = "gaitsmith-motion-1"

#: Keys in the order of the file: their shape (letters are sizes that must agree) and kind
#: (f float64, i integer, b flag, U text).
_KEYS: dict[str, tuple[tuple[str | int, ...], str]] = {
    "format": ((), "U"),
    "fps": ((), "f"),
    "joint_names": (("J",), "U"),
    "parents": (("J",), "i"),
    "offsets": (("J", 3), "f"),
    "root_position": (("F", 3), "f"),
    "rotations": (("F", "J", 4), "f"),
    "positions": (("F", "J", 3), "f"),
    "soles": (("F", 2, 3, 3), "f"),
    "contacts": (("F", 2, 3), "b"),
    "phase": (("F",), "f"),
    "step": (("F",), "i"),
    "footstep_side": (("N",), "i"),
    "footstep_position": (("N", 3), "f"),
    "footstep_heading": (("N",), "f"),
    "footstep_time": (("N",), "f"),
    "ground": ((), "U"),
    "recipe": ((), "U"),
    "path": (("P", 2), "f"),
    "sole_offsets": ((2, 3, 3), "f"),
    "joint_ends": (("J", 3), "f"),
    "translations": (("F", "J", 3), "f"),
}
#: Keys of a file of several people.
_TOGETHER = ("walkers", "surroundings")
_OPTIONAL = ("path", "joint_ends", "translations")
#: Fixed byte order, so that the same motion is the same bytes on every machine.
_DTYPES = {"f": "<f8", "i": "<i8", "b": "|b1"}
_KINDS = {"f": "float64", "i": "integers", "b": "flags (bool)", "U": "text"}


def write_npz(motion: Motion | Performance, path: Path) -> None:
    """Write ``motion`` to ``path`` as the npz of this module's page.

    The same motion gives the same bytes: no time stamps, fixed order, fixed byte order, no
    compression. A performance of one person is written as its motion.

    Raises
    ------
    InvalidInputError
        If a motion lacks contacts, sole points or labels: this file promises them, and
        nobody could tell guessed ones from known ones.
    """
    import zipfile  # late: half the import time of this module

    arrays = _arrays(motion) if isinstance(motion, Motion) else _all_arrays(motion)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for key, array in arrays.items():
            entry = zipfile.ZipInfo(f"{key}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            entry.create_system = 3  # else it names the system that wrote the file
            entry.external_attr = 0o600 << 16
            with archive.open(entry, "w", force_zip64=True) as stream:
                np.lib.format.write_array(stream, array, version=(1, 0), allow_pickle=False)


def read_npz(path: Path) -> Motion:
    """Motion in the npz at ``path``; what :func:`write_npz` wrote comes back bit by bit.

    ``positions`` and ``soles`` must be there but are not used: kinematics gives them. Of several
    people the first, with a warning.

    Raises
    ------
    FileFormatError
        If the file is not such an npz; the message says what is wrong with it.
    OSError
        If it cannot be opened.
    """
    arrays = _load(path)
    motion = _checked_motion(path, _of(arrays, ""))
    names = _names(path, arrays)
    if len(names) > 1:
        warnings.warn(
            f"{path}: of the walkers {', '.join(names)} the first is taken",
            GaitsmithWarning,
            stacklevel=2,
        )
    return motion


def read_npz_performance(path: Path) -> Performance:
    """Everybody in the npz at ``path``; a file of one person is one called ``walker``.

    Raises as :func:`read_npz` does.
    """
    arrays = _load(path, everybody=True)
    names = _names(path, arrays) or ("walker",)
    prefixes = ["", *(f"{name}/" for name in names[1:])]
    motions = [_checked_motion(path, _of(arrays, prefix), prefix) for prefix in prefixes]
    around = arrays.get("surroundings", np.array("{}"))
    try:
        return Performance(names, tuple(motions), str(around))
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def walkers_in(path: Path) -> tuple[str, ...]:
    """Names of the people in the npz at ``path``, if it is one of several; else none.

    Of a file that is no npz none, too: who reads it says what is wrong.
    """
    import zipfile

    try:
        with zipfile.ZipFile(path) as archive:
            if "walkers.npy" not in archive.namelist():
                return ()
            with archive.open("walkers.npy") as stream:
                array = np.lib.format.read_array(stream, allow_pickle=False)
        return _names(path, {"walkers": array})
    except Exception:  # as in _load, anything may be wrong
        return ()


def _of(
    arrays: dict[str, Shaped[np.ndarray, "..."]], prefix: str
) -> dict[str, Shaped[np.ndarray, "..."]]:
    """The arrays of one person, under their own keys."""
    own = {key: arrays[prefix + key] for key in _KEYS if prefix + key in arrays}
    return {"format": arrays["format"], **own} if prefix and "format" in arrays else own


def _names(path: Path, arrays: dict[str, Shaped[np.ndarray, "..."]]) -> tuple[str, ...]:
    """Names of the people in a file; none where it does not say."""
    if "walkers" not in arrays:
        return ()
    array = arrays["walkers"]
    if array.ndim != 1 or not len(array) or array.dtype.kind != "U":
        raise FileFormatError(path, f"'walkers' must be names, got {array.dtype} {array.shape}")
    try:
        return tuple(checked_name(name) for name in array.tolist())
    except InvalidInputError as error:
        raise FileFormatError(path, str(error)) from None


def _checked_motion(
    path: Path, arrays: dict[str, Shaped[np.ndarray, "..."]], prefix: str = ""
) -> Motion:
    _check(path, arrays, prefix)
    try:
        _check_labels(
            arrays["phase"],
            arrays["step"],
            arrays["footstep_side"],
            ground=str(arrays["ground"]),
            recipe=str(arrays["recipe"]),
        )
        return _motion(arrays)
    except InvalidInputError as error:
        raise FileFormatError(path, f"{prefix}{error}") from None


def _all_arrays(performance: Performance) -> dict[str, Shaped[np.ndarray, "..."]]:
    """Every array of a file of several people, in its order."""
    first, *others = performance
    arrays = _arrays(first[1])
    if others or json.loads(performance.surroundings):
        arrays["walkers"] = _text("walkers", performance.names)
        arrays["surroundings"] = _text("surroundings", performance.surroundings)
    for name, motion in others:
        own = _arrays(motion)
        arrays |= {f"{name}/{key}": own[key] for key in own if key != "format"}
    return arrays


def _arrays(motion: Motion) -> dict[str, Shaped[np.ndarray, "..."]]:
    """Every array of the file, in its order."""
    skeleton, labels, contacts = motion.skeleton, motion.labels, motion.contacts
    if labels is None or contacts is None or skeleton.soles is None:
        parts = {"contacts": contacts, "sole points": skeleton.soles, "labels": labels}
        missing = " and no ".join(name for name, value in parts.items() if value is None)
        raise InvalidInputError(
            f"this motion has no {missing}, which an npz promises; "
            "write .bvh or .csv, which do not need them"
        )
    _check_labels(
        labels.phase, labels.step, labels.footstep_side, ground=labels.ground, recipe=labels.recipe
    )
    positions, world = motion_kinematics(motion)
    values: dict[str, object] = {
        "format": FORMAT,
        "fps": motion.fps,
        "joint_names": skeleton.names,
        "parents": skeleton.parents,
        "offsets": skeleton.offsets,
        "root_position": motion.root_position,
        "rotations": motion.rotations,
        "positions": positions,
        "soles": sole_positions(skeleton, positions, world),
        "contacts": contacts,
        "phase": labels.phase,
        "step": labels.step,
        "footstep_side": labels.footstep_side,
        "footstep_position": labels.footstep_position,
        "footstep_heading": labels.footstep_heading,
        "footstep_time": labels.footstep_time,
        "ground": labels.ground,
        "recipe": labels.recipe,
        "path": labels.path,
        "sole_offsets": skeleton.soles,
        "joint_ends": skeleton.ends,
        "translations": motion.translations,
    }
    arrays: dict[str, Shaped[np.ndarray, "..."]] = {}
    for key, (_, kind) in _KEYS.items():
        if values[key] is not None:
            arrays[key] = _text(key, values[key]) if kind == "U" else _numbers(values[key], kind)
    return arrays


def _numbers(value: object, kind: str) -> Shaped[np.ndarray, "..."]:
    return np.asarray(value, dtype=_DTYPES[kind], order="C")


def _text(key: str, value: object) -> Shaped[np.ndarray, "..."]:
    array = np.array(value, dtype=np.str_)
    array = array.astype(array.dtype.newbyteorder("<"))
    if array.tolist() != (list(value) if isinstance(value, tuple) else value):
        raise InvalidInputError(f"{key} must not end in a NUL character: NumPy drops it")
    return array


def _load(path: Path, *, everybody: bool = False) -> dict[str, Shaped[np.ndarray, "..."]]:
    """Every known array of the archive; whatever NumPy and zipfile say becomes one error."""
    import zipfile

    arrays: dict[str, Shaped[np.ndarray, "..."]] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for entry in archive.namelist():
                name = entry.removesuffix(".npy")
                prefix, _, key = name.rpartition("/")
                known = key in _KEYS if prefix else key in (*_KEYS, *_TOGETHER)
                if entry.endswith(".npy") and known and (everybody or not prefix):
                    with archive.open(entry) as stream:
                        arrays[name] = np.lib.format.read_array(stream, allow_pickle=False)
    except OSError as error:
        if error.filename is not None:  # the disk's fault, and it says so
            raise
        raise _unreadable(path, error) from None
    except Exception as error:  # of a damaged header NumPy raises all that Python's parser may
        raise _unreadable(path, error) from None
    return arrays


def _unreadable(path: Path, error: Exception) -> FileFormatError:
    why = " ".join(str(error).split())[:200] or type(error).__name__
    return FileFormatError(path, f"not a readable npz archive: {why}")


def _check(path: Path, arrays: dict[str, Shaped[np.ndarray, "..."]], prefix: str) -> None:
    """Refuse what lacks a key or has a wrong shape or kind."""
    written = arrays.get("format")
    if written is None or written.shape != () or str(written) != FORMAT:
        has = "no format" if written is None else f"format {str(written)[:60]!r}"
        raise FileFormatError(path, f"not the npz of a motion: {has}, wanted {FORMAT!r}")
    sizes: dict[str | int, int] = {}
    for key, (shape, kind) in _KEYS.items():
        if key not in arrays:
            if key in _OPTIONAL:
                continue
            raise FileFormatError(path, f"{prefix + key!r} is missing")
        array = arrays[key]
        fits = array.ndim == len(shape) and all(
            sizes.setdefault(want, got) == got if isinstance(want, str) else want == got
            for want, got in zip(shape, array.shape, strict=True)
        )
        if not fits:
            known = ", ".join(f"{name} = {size}" for name, size in sizes.items())
            named = "(" + ", ".join(map(str, shape)) + ")"
            raise FileFormatError(
                path,
                f"{prefix + key!r} has shape {array.shape}, wanted {named}"
                + f" with {known}" * bool(known),
            )
        if array.dtype.kind not in ("iu" if kind == "i" else kind) or (
            kind == "f" and array.dtype.itemsize != 8
        ):
            raise FileFormatError(
                path, f"{prefix + key!r} holds {array.dtype}, wanted {_KINDS[kind]}"
            )


def _check_labels(
    phase: Float[np.ndarray, "frames"],
    step: Int[np.ndarray, "frames"],
    side: Int[np.ndarray, "footsteps"],
    **documents: str,
) -> None:
    """Refuse labels that cannot be, before writing and after reading alike."""
    if not ((phase >= -1e-9) & (phase <= 1.0 + 1e-9)).all():
        raise InvalidInputError("phase must lie in [0, 1]")
    if not ((step >= 0) & (step < len(side))).all() or (step[1:] < step[:-1]).any():
        raise InvalidInputError("step must be the index of a footstep and never go back")
    if not ((side == 0) | (side == 1)).all():
        raise InvalidInputError("footstep_side must be 0 (left) or 1 (right)")
    for key, text in documents.items():
        try:
            json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InvalidInputError(f"{key} is not JSON: {error}") from None


def _motion(arrays: dict[str, Shaped[np.ndarray, "..."]]) -> Motion:
    skeleton = Skeleton(
        names=tuple(arrays["joint_names"].tolist()),
        parents=tuple(arrays["parents"].tolist()),
        offsets=arrays["offsets"],
        soles=arrays["sole_offsets"],
        ends=arrays.get("joint_ends"),
    )
    labels = Labels(
        phase=arrays["phase"],
        step=arrays["step"],
        footstep_side=arrays["footstep_side"],
        footstep_position=arrays["footstep_position"],
        footstep_heading=arrays["footstep_heading"],
        footstep_time=arrays["footstep_time"],
        ground=str(arrays["ground"]),
        recipe=str(arrays["recipe"]),
        path=arrays.get("path"),
    )
    return Motion(
        skeleton=skeleton,
        root_position=arrays["root_position"],
        rotations=arrays["rotations"],
        fps=float(arrays["fps"]),
        contacts=arrays["contacts"],
        translations=arrays.get("translations"),
        labels=labels,
    )
