"""The legs of a whole-body Cycle as walk data."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import BALL, HEEL, TOE
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.motion.motion import Markers
from gaitsmith.walks.extract import MARKERS, extract

if TYPE_CHECKING:
    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.walks.data import WalkData

#: Samples per stride at which a cycle is read.
SAMPLES = 200


def walk_data_of(cycle: Cycle, body: Body) -> WalkData:
    """Six timed sequences of the left leg of a symmetric ``cycle`` of ``body``.

    The cycle is walked by forward kinematics, and virtual markers on hips' middle, knee, ankle
    and sole points are extracted as those of a person are; its own events are used, so nothing
    is guessed.
    """
    margin = SAMPLES // 10
    frames = np.arange(-margin, SAMPLES + margin + 1)
    phase = frames / SAMPLES
    center, rotations = cycle.at(phase)
    center = center + phase[:, None] * np.array([0.0, 0.0, cycle.stride_length])
    positions, world = forward_kinematics(cycle.skeleton, center, rotations)
    soles = sole_positions(cycle.skeleton, positions, world)[:, 0]
    index = cycle.skeleton.index
    hips = 0.5 * (positions[:, index("leftUpperLeg")] + positions[:, index("rightUpperLeg")])
    paths = {
        "hip": hips,
        "knee": positions[:, index("leftLowerLeg")],
        "ankle": positions[:, index("leftFoot")],
        "heel": soles[:, HEEL],
        "ball": soles[:, BALL],
        "toe": soles[:, TOE],
    }
    markers = Markers(MARKERS, np.stack([paths[name] for name in MARKERS], axis=1), float(SAMPLES))
    off = margin + round(cycle.events[0, 3] * SAMPLES)
    found = extract(markers, body, cutoff=None, events=(margin, margin + SAMPLES, off), center=True)
    return found.walk
