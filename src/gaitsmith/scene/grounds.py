"""The ground of a scene: the one place where its text gets a meaning."""

from __future__ import annotations

from typing import Any

from gaitsmith.errors import InvalidInputError

#: Grounds that a scene may name.
KNOWN = ("flat",)


def checked_ground(text: object) -> str:
    """``text`` if it names a ground."""
    if not isinstance(text, str) or text not in KNOWN:
        raise InvalidInputError(f"ground must be {' or '.join(KNOWN)}, got {text!r}")
    return text


def ground_arguments(text: str) -> dict[str, Any]:
    """What :func:`gaitsmith.walk` is told of the ground; of level ground nothing."""
    checked_ground(text)
    return {}
