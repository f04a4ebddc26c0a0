"""Straight-line walks. A new one is a file with a ``step`` method and a line in ``WALKS``."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from gaitsmith.walks.files import built_in
from gaitsmith.walks.kinematic import KinematicWalk
from gaitsmith.walks.model import SagittalStep, StepRequest, StraightWalk

if TYPE_CHECKING:
    from collections.abc import Callable


@cache
def winter() -> KinematicWalk:
    """The measured prototype of [KB92b]: one step of one person, legs only."""
    return KinematicWalk([built_in("winter_step")])


#: Built-in walks by the name the command line uses.
WALKS: dict[str, Callable[[], StraightWalk]] = {"winter": winter}

__all__ = ["WALKS", "KinematicWalk", "SagittalStep", "StepRequest", "StraightWalk", "winter"]
