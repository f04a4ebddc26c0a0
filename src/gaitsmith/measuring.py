"""Numbers of any motion: what ``measure`` does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from gaitsmith.errors import InfeasibleError, UnknownFormatError
from gaitsmith.io import PERFORMANCE_READERS, READERS, load_performance
from gaitsmith.io.npz import walkers_in
from gaitsmith.learning import load_clip
from gaitsmith.measures.report import measured
from gaitsmith.motion.motion import Markers, Motion

if TYPE_CHECKING:
    from os import PathLike

    from gaitsmith.measures.notes import Figures


def measure(clip: str | PathLike[str] | Motion, *, unit: str | None = None) -> Figures:
    """Honest numbers of a motion: contact, skating, smoothness, gait; of any rig.

    Parameters
    ----------
    clip
        A file (``.bvh``, ``.amc``, ``.glb``, ``.npz``) or a Motion. What a generated motion knows
        of its contacts and footsteps is used; else the floor, contacts and footsteps are found.
    unit
        Of a BVH or AMC file, see :func:`gaitsmith.io.bvh_motion.read_bvh`.

    Returns
    -------
    Figures by name; the reference of JSON output has unit and definition of each. A figure that
    cannot be had is None, and a line of ``notes`` says why. No NaN, no infinity.

    Raises
    ------
    InfeasibleError
        If the joints are no person's, or there are fewer than two frames.
    FileFormatError, OSError
        If the file cannot be read.

    Examples
    --------
    >>> from gaitsmith import walk
    >>> figures = measure(walk(distance=4.0, step_length=0.6, fps=30))
    >>> round(figures["step_length_m"], 6), figures["contacts"]
    (0.6, 'file')
    """
    if isinstance(clip, Motion):
        return measured(clip)
    path = Path(clip)
    if path.suffix.lower() not in READERS:  # markers are points, not a pose
        raise UnknownFormatError(path.suffix, READERS, verb="measure")
    motion = load_clip(path, unit)
    assert not isinstance(motion, Markers)
    try:
        return measured(motion)
    except InfeasibleError as error:
        raise InfeasibleError(f"{path}: {error}") from None


def people_in(path: str | PathLike[str]) -> list[tuple[str, Path | Motion]]:
    """What to measure in a file, and how to call it: everybody in a file of several people."""
    path = Path(path)
    if path.suffix.lower() == ".npz" and len(walkers_in(path)) < 2:
        return [(str(path), path)]
    if path.suffix.lower() not in PERFORMANCE_READERS:
        return [(str(path), path)]
    people = list(load_performance(path))
    if len(people) < 2:
        return [(str(path), motion) for _, motion in people]
    return [(f"{path}:{name}", motion) for name, motion in people]
