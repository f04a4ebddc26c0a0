"""What is walked on. A ground is one class in one file and one line in ``GROUNDS``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.ground.flat import Flat
from gaitsmith.ground.model import Ground

if TYPE_CHECKING:
    from collections.abc import Callable

#: Grounds by the name the command line uses; tests/conformance picks each up from here.
GROUNDS: dict[str, Callable[[], Ground]] = {"flat": Flat}

__all__ = ["GROUNDS", "Flat", "Ground"]
