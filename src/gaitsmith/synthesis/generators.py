"""Which step generator walks a plan: straight ahead, along a path, or steps of all kinds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.ground import Flat
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks.model import climbs

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gaitsmith.ground import Ground
    from gaitsmith.plan.timeline import Timeline
    from gaitsmith.synthesis.gaits import Gait
    from gaitsmith.synthesis.step import StepGenerator


def generator_for(
    plan: StepPlan | Timeline,
    style: Gait,
    ground: Ground,
    banking: str,
    *,
    ahead: bool,
    gaits: Mapping[str, Gait],
) -> StepGenerator:
    """What walks ``plan``; ``ahead``: it leads straight ahead with even widths.

    ``gaits`` are those that actions name.

    Imports are late: who walks straight ahead waits for nothing that bends or mixes walks.
    """
    if not isinstance(ground, Flat):
        from gaitsmith.synthesis.uneven import UnevenGenerator

        level = generator_for(plan, style, Flat(), banking, ahead=ahead, gaits=gaits)
        return UnevenGenerator(level, ground, climbs=climbs(style.walk))
    if ahead:
        return StraightGenerator(style.walk, ground, style.overlay)
    from gaitsmith.synthesis.curved import CurvedGenerator

    walking = CurvedGenerator(style.walk, ground, style.overlay, banking=banking)
    if isinstance(plan, StepPlan):
        return walking
    from gaitsmith.synthesis.mixed import MixedGenerator
    from gaitsmith.synthesis.stepping import LocalGenerator

    others = {
        name: CurvedGenerator(gait.walk, ground, gait.overlay, banking=banking)
        for name, gait in gaits.items()
    }
    return MixedGenerator(walking, LocalGenerator(style.walk, ground, style.overlay), others)


def walking_generator(style: Gait, ground: Ground, banking: str) -> StepGenerator:
    """What walks steps of which nothing is known beforehand."""
    from gaitsmith.synthesis.curved import CurvedGenerator

    if isinstance(ground, Flat):
        return CurvedGenerator(style.walk, ground, style.overlay, banking=banking)
    from gaitsmith.synthesis.uneven import UnevenGenerator

    level = CurvedGenerator(style.walk, Flat(), style.overlay, banking=banking)
    return UnevenGenerator(level, ground, climbs=climbs(style.walk))
