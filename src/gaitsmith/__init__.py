"""Give it a body, a place to go, a ground and a way of walking; get a person who walks it.

>>> import gaitsmith
>>> motion = gaitsmith.walk(distance=5, body=1.75)
>>> gaitsmith.save(motion, "walk.bvh")  # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaitsmith._version import __version__
    from gaitsmith.body.body import Body, Foot
    from gaitsmith.body.presets import BODIES, body_from
    from gaitsmith.composing import compose
    from gaitsmith.errors import (
        FileFormatError,
        GaitsmithError,
        GaitsmithWarning,
        InfeasibleError,
        InvalidInputError,
    )
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.ground import GROUNDS, Ground, read_ground
    from gaitsmith.io import load, load_performance
    from gaitsmith.learning import learn
    from gaitsmith.live import Controls, LivePose, LiveWalker
    from gaitsmith.measuring import measure
    from gaitsmith.motion.motion import Labels, Markers, Motion
    from gaitsmith.motion.performance import Performance
    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.pipeline import regenerate, save, save_all, walk
    from gaitsmith.plan.start import Start
    from gaitsmith.scene.file import read_scene
    from gaitsmith.scene.model import Scene, Walker
    from gaitsmith.scene.perform import perform
    from gaitsmith.synthesis.upper_body import Manner
    from gaitsmith.walks import WALKS, StraightWalk
    from gaitsmith.walks.learned import LearnedGait

#: Where each public name lives. They load when first asked for, so that importing the package
#: and asking the command line for help cost nothing.
_HOMES = {
    "__version__": "_version",
    "BODIES": "body.presets",
    "Body": "body.body",
    "body_from": "body.presets",
    "compose": "composing",
    "Controls": "live",
    "Cycle": "gait.cycle",
    "FileFormatError": "errors",
    "Foot": "body.body",
    "GaitsmithError": "errors",
    "GaitsmithWarning": "errors",
    "Ground": "ground",
    "GROUNDS": "ground",
    "InfeasibleError": "errors",
    "InvalidInputError": "errors",
    "Labels": "motion.motion",
    "learn": "learning",
    "LearnedGait": "walks.learned",
    "LivePose": "live",
    "LiveWalker": "live",
    "load": "io",
    "load_performance": "io",
    "Manner": "synthesis.upper_body",
    "Markers": "motion.motion",
    "measure": "measuring",
    "Motion": "motion.motion",
    "perform": "scene.perform",
    "Performance": "motion.performance",
    "read_ground": "ground",
    "read_scene": "scene.file",
    "regenerate": "pipeline",
    "save": "pipeline",
    "save_all": "pipeline",
    "Scene": "scene.model",
    "Skeleton": "motion.skeleton",
    "Start": "plan.start",
    "StraightWalk": "walks",
    "walk": "pipeline",
    "Walker": "scene.model",
    "WALKS": "walks",
}

__all__ = [
    "__version__",
    "BODIES",
    "Body",
    "body_from",
    "compose",
    "Controls",
    "Cycle",
    "FileFormatError",
    "Foot",
    "GaitsmithError",
    "GaitsmithWarning",
    "Ground",
    "GROUNDS",
    "InfeasibleError",
    "InvalidInputError",
    "Labels",
    "learn",
    "LearnedGait",
    "LivePose",
    "LiveWalker",
    "load",
    "load_performance",
    "Manner",
    "Markers",
    "measure",
    "Motion",
    "perform",
    "Performance",
    "read_ground",
    "read_scene",
    "regenerate",
    "save",
    "save_all",
    "Scene",
    "Skeleton",
    "Start",
    "StraightWalk",
    "walk",
    "Walker",
    "WALKS",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'gaitsmith' has no attribute {name!r}")
    value = getattr(import_module(f"gaitsmith.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
