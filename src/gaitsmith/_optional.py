"""Import an optional dependency at the moment it is needed."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from gaitsmith.errors import MissingDependencyError

if TYPE_CHECKING:
    from types import ModuleType


def require(module: str, *, extra: str, purpose: str) -> ModuleType:
    """Import ``module``, or say which extra installs it and what for."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        if error.name != module.partition(".")[0]:
            raise  # the dependency is there but broken: do not hide that
        raise MissingDependencyError(
            f"{purpose} needs {module!r}: pip install 'gaitsmith[{extra}]'"
        ) from error
