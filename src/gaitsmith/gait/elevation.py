"""Sagittal elevation angles of a stride, the data of the elevation-angle walker [SM01]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, positive
from gaitsmith.conventions import BALL, HEEL, SIDES, UP
from gaitsmith.geometry.rotations import rotate
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.gait.cycle import Cycle

#: Segments, in the order of the data's last axis.
SEGMENTS = ("foot", "shank", "thigh", "pelvis")
#: Samples of a leg's own stride.
SAMPLES = 128
#: Top of the pelvis above the hips' middle, over leg length (hip to ankle).
_PELVIS_TOP = 0.118


@dataclass(frozen=True, eq=False)
class ElevationData:
    """Elevation angles of both legs over their own strides.

    Attributes
    ----------
    angles
        ``(2, K, 4)`` radians, [left, right] x samples x :data:`SEGMENTS`: the angle of distal
        minus proximal end against straight down, forward positive, ``atan2(forward, -up)``
        ([SM01] Eq. 1). The foot runs from heel to ball along the sole (flat is 90 deg), the
        pelvis from the middle of its top to the hip of the side. Sample ``k`` is at ``k / K``
        of the leg's own stride, from its heel strike; the other foot strikes at 1/2.
    stride_length, duration
        Meters, seconds.
    leg_length
        Hip to ankle of who was measured, meters.
    """

    angles: Float[np.ndarray, "2 K 4"]
    stride_length: float
    duration: float
    leg_length: float

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        object.__setattr__(self, "angles", frozen_array("angles", self.angles, (2, None, 4)))
        for name, unit in (
            ("stride_length", "meters"),
            ("duration", "seconds"),
            ("leg_length", "meters"),
        ):
            object.__setattr__(self, name, positive(name, getattr(self, name), unit))


def elevation_of(cycle: Cycle) -> ElevationData:
    """Elevation data of ``cycle``, re-timed so that the heel strikes are half a stride apart.

    The re-timing is linear between heel strikes; the walker of [SM01] takes one leg half a
    stride behind the other.
    """
    cycle = cycle.legs
    right = float(cycle.events[1, 0])
    own = np.arange(SAMPLES) / SAMPLES
    skeleton = cycle.skeleton
    index = skeleton.index
    leg = float(
        np.linalg.norm(skeleton.offsets[index("leftLowerLeg")])
        + np.linalg.norm(skeleton.offsets[index("leftFoot")])
    )
    out = np.empty((2, SAMPLES, 4))
    even = np.concatenate([own, own + 0.5])
    phase = np.floor(even) + np.interp(even % 1.0, [0.0, 0.5, 1.0], [0.0, right, 1.0])
    center, turned = cycle.at(phase)
    places, world = forward_kinematics(skeleton, center, turned)
    ground = sole_positions(skeleton, places, world)
    tops = center + rotate(world[:, 0], _PELVIS_TOP * leg * UP)
    for side, name in enumerate(SIDES):
        here = slice(side * SAMPLES, (side + 1) * SAMPLES)
        positions, soles, top = places[here], ground[here], tops[here]
        hip, knee, ankle = (
            positions[:, index(f"{name}{part}")] for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        segments = (
            soles[:, side, BALL] - soles[:, side, HEEL],
            ankle - knee,
            knee - hip,
            hip - top,
        )
        for i, vector in enumerate(segments):
            angle = np.unwrap(np.arctan2(vector[:, 2], -vector[:, 1]))
            out[side, :, i] = angle - 2.0 * np.pi * np.round(angle.mean() / (2.0 * np.pi))
    return ElevationData(out, cycle.stride_length, cycle.duration, leg)
