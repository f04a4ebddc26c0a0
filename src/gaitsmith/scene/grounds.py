"""The ground of a scene: the one place where its text gets a meaning."""

from __future__ import annotations

from typing import Any

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground import read_ground


def checked_ground(text: object) -> str:
    """``text`` if it is a ground: words, or a file that is there."""
    if not isinstance(text, str):
        raise InvalidInputError(f"ground must be text as in 'slope:10', got {text!r}")
    read_ground(text)
    return text


def ground_arguments(text: str) -> dict[str, Any]:
    """What :func:`gaitsmith.walk` is told of the ground; of level ground nothing."""
    return {} if text == "flat" else {"ground": checked_ground(text)}
