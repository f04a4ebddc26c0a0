"""Low obstacles: part of the ground to who can step that high, and what it costs to do so."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from gaitsmith.ground import Box, Boxes
from gaitsmith.plan.footholds import HIGHEST

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.ground import Ground
    from gaitsmith.plan.surroundings import Obstacle, Surroundings

#: Meters of way that going over something low is worth, and what each meter of its height adds:
#: who steps up slows down by a third for two steps and lifts the whole body.
OVER, HIGHER = 0.2, 3.0
#: Feet come so near to the middle of the way, over the stature.
FEET = 0.12


def low_obstacles(surroundings: Surroundings, body: Body) -> tuple[Obstacle, ...]:
    """What of ``surroundings`` ``body`` can step onto."""
    limit = HIGHEST * body.leg_length
    return tuple(
        o for o in surroundings.obstacles if o.height is not None and o.height <= limit + 1e-9
    )


def with_low(ground: Ground, surroundings: Surroundings, body: Body) -> Ground:
    """``ground`` as ``body`` walks on it: with everything low that lies on it."""
    low = low_obstacles(surroundings, body)
    return Boxes(ground, tuple(Box(o.points, o.height) for o in low)) if low else ground  # type: ignore[arg-type]


def standing(surroundings: Surroundings, low: frozenset[str]) -> Surroundings:
    """What a body may run into: all but ``low``."""
    kept = tuple(one for one in surroundings.obstacles if one.name not in low)
    return replace(surroundings, obstacles=kept)


def cost_over(one: Obstacle) -> float:
    """Meters of way that stepping over or on ``one`` is worth."""
    assert one.height is not None
    return OVER + HIGHER * one.height
