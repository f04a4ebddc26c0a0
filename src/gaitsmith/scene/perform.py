"""A scene becomes motions: everybody walks, then all stand on until the last has arrived."""

from __future__ import annotations

import json
import warnings
from typing import TYPE_CHECKING, Any

from gaitsmith.errors import (
    FileFormatError,
    GaitsmithError,
    GaitsmithWarning,
    InfeasibleError,
    InvalidInputError,
)
from gaitsmith.motion.performance import Performance
from gaitsmith.pipeline import stand_on, walk
from gaitsmith.scene.grounds import ground_arguments
from gaitsmith.scene.meeting import encounters
from gaitsmith.scene.model import SHARED, Scene

if TYPE_CHECKING:
    from pathlib import Path

    from gaitsmith.motion.motion import Motion
    from gaitsmith.plan.surroundings import Surroundings
    from gaitsmith.scene.model import Walker


def perform(scene: Scene | str | Path, *, fps: float = 60.0, seed: int = 0) -> Performance:
    """Everybody of a scene walks, on one time axis.

    Parameters
    ----------
    scene
        The scene, or a TOML file of one.
    fps
        Frames per second of all motions.
    seed
        Of variation: of the walker at index i ``seed + i``, where it has none of its own.

    Returns
    -------
    Motions of the same number of frames: who begins later stands until then, who ends earlier
    stands on. The recipe of each regenerates it alone, to the byte.

    Raises
    ------
    FileFormatError, OSError
        If the file is bad or cannot be opened.
    InvalidInputError, InfeasibleError
        If somebody cannot do what is asked; all who cannot are named.

    Warns
    -----
    GaitsmithWarning
        Where two walk through each other, and as :func:`gaitsmith.walk` does.

    Examples
    --------
    >>> from gaitsmith import Scene, Start, Walker, perform
    >>> ann = Walker("ann", do="walk to 0,2")
    >>> ben = Walker("ben", body=1.2, start=Start((2.0, 0.0)), do="walk to 2,2", begin=1.0)
    >>> perform(Scene((ann, ben)), fps=30)
    <Performance: ann, ben; 135 frames at 30 fps>
    """
    if not isinstance(scene, Scene):
        from gaitsmith.scene.file import read_scene  # late: pydantic

        scene = read_scene(scene)
    motions: list[Motion] = []
    problems: list[tuple[str, GaitsmithError]] = []
    for i, walker in enumerate(scene.walkers):
        named = f"{walker.name}: " if len(scene.walkers) > 1 else ""
        try:
            motions.append(_walked(walker, scene, named, fps, seed + i))
        except (InvalidInputError, InfeasibleError) as error:
            problems.append((named, error))
    if problems:
        raise _all_of(problems, scene)
    until = max(motion.duration for motion in motions)
    if len(motions) > 1:
        motions = [stand_on(motion, until) for motion in motions]
    performance = Performance(
        names=tuple(walker.name for walker in scene.walkers),
        motions=tuple(motions),
        surroundings=json.dumps(_said_of(scene.surroundings), sort_keys=True),
    )
    for meeting in encounters(performance):
        warnings.warn(meeting.text, GaitsmithWarning, stacklevel=2)
    return performance


def _walked(walker: Walker, scene: Scene, named: str, fps: float, seed: int) -> Motion:
    """The motion of one walker; its warnings say whose they are."""
    arguments: dict[str, Any] = {name: getattr(walker, name) for name in SHARED}
    arguments["walker"] = walker.legs
    if walker.start is not None:
        arguments["start"] = walker.start
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", GaitsmithWarning)
        motion = walk(
            **arguments,
            **ground_arguments(scene.ground),
            **_among(scene.surroundings),
            begin=walker.begin,
            fps=fps,
            seed=seed if walker.seed is None else walker.seed,
        )
    for warning in caught:
        text = str(warning.message)
        if issubclass(warning.category, GaitsmithWarning):
            warnings.warn(f"{named}{text}", GaitsmithWarning, stacklevel=3)
        else:
            warnings.warn_explicit(
                warning.message, warning.category, warning.filename, warning.lineno
            )
    return motion


def _among(surroundings: Surroundings) -> dict[str, Any]:
    """What ``walk`` is told of what stands around."""
    return {} if surroundings.empty else {"surroundings": surroundings}


def _said_of(surroundings: Surroundings) -> dict[str, Any]:
    """What stands around as JSON can hold it; of kinds that there are."""
    return {kind: things for kind, things in surroundings.as_dict().items() if things}


def _all_of(problems: list[tuple[str, GaitsmithError]], scene: Scene) -> GaitsmithError:
    """One error for all walkers who cannot do what is asked."""
    text = "; ".join(f"{named}{error}" for named, error in problems)
    bad = any(isinstance(error, InvalidInputError) for _, error in problems)
    if bad and scene.source is not None:
        return FileFormatError(scene.source, text)
    if bad:
        return InvalidInputError(text)
    return InfeasibleError(text)
