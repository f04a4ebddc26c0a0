"""The smallest straight-line walk: legs that do not bend, swinging about flat feet.

No measured data and none of :mod:`gaitsmith.walks` but the seam. What can be driven with it
is driven through the seam alone.
"""

from __future__ import annotations

import numpy as np

from gaitsmith.errors import InfeasibleStepError
from gaitsmith.walks.model import SagittalStep

#: Legs of a compass are nearly straight: hip to ankle over leg length.
STRAIGHTNESS = 0.99
#: Phase at which the swing foot leaves, and the longest step over leg length.
TOE_OFF, LONGEST = 0.125, 1.0


class CompassWalk:
    """Stiff legs on a pivot; starting and stopping are steps of which one half is missing."""

    def __init__(self, samples=33):
        self.samples = samples

    def step(self, body, request):
        longest = LONGEST * body.leg_length
        if max(request.length, request.previous_length) > longest:
            raise InfeasibleStepError(
                step=None,
                side="",
                needed=max(request.length, request.previous_length),
                available=longest,
                why="the compass does not open wider",
            )
        phase = np.linspace(0.0, 1.0, self.samples)
        x = 0.5 * (phase * request.length - (1.0 - phase) * request.previous_length)
        leg, foot = STRAIGHTNESS * body.leg_length, body.foot
        height = foot.ankle_height + np.sqrt(leg**2 - x**2)
        swung = np.clip((phase - TOE_OFF) / (1.0 - TOE_OFF), 0.0, 1.0)
        swung = 3.0 * swung**2 - 2.0 * swung**3
        ankle = np.zeros((len(phase), 2, 2))
        ankle[..., 1] = foot.ankle_height
        ankle[:, 1, 0] = swung * request.length - (1.0 - swung) * request.previous_length
        zero = np.zeros((len(phase), 2))
        return SagittalStep(
            phase=phase,
            flat=0.0,
            heel_off=1.0,
            meta_off=1.0,
            toe_off=TOE_OFF,
            center=np.stack([x, height], axis=-1),
            ankle=ankle,
            pitch=zero,
            meta=zero,
            bend=zero,
        )
