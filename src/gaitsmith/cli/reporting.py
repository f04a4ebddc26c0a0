"""What a command says of what it did: facts of motions, and warnings."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

    from gaitsmith.motion.motion import Motion


def facts_of(motion: Motion, files: list[Path], said: list[str]) -> dict[str, Any]:
    """The object that ``--json`` prints; docs/reference/json.md explains every key."""
    return {**motion_facts(motion), "files": [str(p) for p in files], "warnings": said}


def motion_facts(motion: Motion) -> dict[str, Any]:
    """What there is to say of one generated motion."""
    from gaitsmith.ground import ground_from_json
    from gaitsmith.measures.promises import promises

    assert motion.labels is not None
    measured = promises(motion, ground_from_json(motion.labels.ground))
    return {
        "frames": len(motion),
        "fps": motion.fps,
        "duration_s": motion.duration,
        "steps": len(motion.labels.footstep_side) - 2,
        **measured,
    }


@contextmanager
def collected_warnings() -> Generator[list[str]]:
    """Collect the library's warnings as lines; others pass."""
    import warnings

    from gaitsmith.errors import GaitsmithWarning

    lines: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", GaitsmithWarning)
        yield lines
    for warning in caught:
        if issubclass(warning.category, GaitsmithWarning):
            lines.append(str(warning.message))
        else:
            warnings.warn_explicit(
                warning.message, warning.category, warning.filename, warning.lineno
            )
