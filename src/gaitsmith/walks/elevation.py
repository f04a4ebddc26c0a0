"""Elevation data as [SM01] uses it: one periodic curve of four angles, mixed by weights."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, number, positive
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.elevation import elevation_of
from gaitsmith.geometry.curves import hermite, parabola_slopes, pchip_slopes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle

#: Segments, in the order of the data's last axis.
FOOT, SHANK, THIGH, PELVIS = range(4)
#: Samples of a stride; even, so that both heel strikes are samples.
SAMPLES = 240
#: Top of the pelvis above the hips' middle, over leg length, as in the measured data.
PELVIS_TOP = 0.118


def pelvis_height(body: Body) -> float:
    """Meters from the middle of the hips to the midline top of the pelvis."""
    return PELVIS_TOP * body.leg_length


@dataclass(frozen=True, eq=False)
class ElevationSet:
    """One dataset ``ds(t)`` of [SM01]: elevation angles of a leg over its own stride.

    Both legs take the same curve, half a stride apart.

    Attributes
    ----------
    angles
        ``(K, 4)`` radians of foot (heel to ball along the sole, flat on level ground is 90 deg),
        shank, thigh and pelvis (middle of its top to the hip of the side), each distal minus
        proximal end against straight down, forward positive. Sample ``k`` is at ``k / K`` of the
        stride from the leg's own heel strike; K is even, the other foot strikes at 1/2.
    pelvis_ratio
        Half hip width over pelvis height of who it is of: the pelvis' angle is the tilt plus
        this times the rotation, so another body needs another angle ([SM01] says none does).
    slope
        Radians that the ground rises ahead.
    step_duration, leg_length
        Seconds of a step of whom it is of, whose leg is so long (hip to ankle, meters).
    name, source
        What it is, and where from.
    constructed
        What was done instead of measuring; empty for measured data.
    meta
        ``(K,)`` radians of the toes against the ground as they turn about their tip, which the
        paper's four angles do not say; empty: they lie until they leave.
    toe_off
        Phase of the stride at which the toes leave, after 1/2.
    above
        ``(K,)`` how far the person's own hips run above those that legs on such feet can reach,
        over leg length: the product raises the heel there; empty: nowhere.
    """

    angles: Float[np.ndarray, "K 4"]
    pelvis_ratio: float
    slope: float
    step_duration: float
    leg_length: float
    name: str = ""
    source: str = ""
    constructed: str = ""
    meta: Float[np.ndarray, "K"] = field(default_factory=lambda: np.zeros(0))
    toe_off: float = 0.62
    above: Float[np.ndarray, "K"] = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        """Copy, check and freeze."""
        object.__setattr__(self, "angles", frozen_array("angles", self.angles, (None, 4)))
        none = np.zeros(len(self.angles))
        for name in ("meta", "above"):
            own = getattr(self, name)
            own = frozen_array(name, own if len(own) else none, (len(none),))
            object.__setattr__(self, name, own)
        if not 0.5 < number("toe_off", self.toe_off, "1") < 1.0:
            raise InvalidInputError(f"toe_off must be between 1/2 and 1, got {self.toe_off:g}")
        if len(self.angles) < 8 or len(self.angles) % 2:
            raise InvalidInputError(
                f"angles must have 8 or more samples, an even number, got {len(self.angles)}"
            )
        object.__setattr__(self, "slope", number("slope", self.slope, "radians"))
        for name, unit in (
            ("pelvis_ratio", "1"),
            ("step_duration", "seconds"),
            ("leg_length", "meters"),
        ):
            object.__setattr__(self, name, positive(name, getattr(self, name), unit))

    @cached_property
    def _table(self) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 4"], np.ndarray]:
        """Times, values and slopes, with some of the neighboring strides on both sides."""
        count, more = len(self.angles), 3
        times = np.arange(-more, count + more + 1) / count
        values = self.angles[np.arange(-more, count + more + 1) % count]
        slopes = parabola_slopes(times, values)
        # a foot that lies flat must not ripple
        slopes[:, FOOT] = pchip_slopes(times, values[:, :1])[:, 0]
        return times, values, slopes

    def at(self, stride_phase: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 4"]:
        """Angles at any phases of the leg's own stride, period 1; exact at the samples."""
        times, values, slopes = self._table
        return hermite(times, values, slopes, np.asarray(stride_phase, dtype=np.float64) % 1.0)

    def beside_at(self, stride_phase: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 2"]:
        """``meta`` and ``above`` at any phases of the leg's own stride, period 1."""
        index = np.arange(-3, len(self.meta) + 4)
        times = index / len(self.meta)
        values = np.stack([self.meta, self.above], axis=-1)[index % len(self.meta)]
        return hermite(times, values, parabola_slopes(times, values), stride_phase % 1.0)

    def for_body(self, body: Body) -> ElevationSet:
        """The same pelvis tilt and rotation on the hips of ``body``."""
        ratio = 0.5 * body.hip_width / pelvis_height(body)
        tangent = np.tan(self.angles[:, PELVIS])
        other = np.roll(tangent, len(tangent) // 2)
        tilt, turn = 0.5 * (tangent + other), 0.5 * (tangent - other)
        angles = self.angles.copy()
        angles[:, PELVIS] = np.arctan(tilt + turn * (ratio / self.pelvis_ratio))
        return replace(self, angles=angles, pelvis_ratio=ratio)

    def planarity(self) -> float:
        """Share of the variance of foot, shank and thigh that lies in one plane.

        People's elevation angles covary so ([SM01] refs. 2, 24): 0.97 and more.
        """
        centered = self.angles[:, :PELVIS] - self.angles[:, :PELVIS].mean(axis=0)
        size = np.linalg.svd(centered, compute_uv=False) ** 2
        return float(size[:2].sum() / size.sum())

    def plane_normal(self) -> Float[np.ndarray, "3"]:
        """Unit normal of that plane in (thigh, shank, foot), the thigh's part positive."""
        own = self.angles[:, [THIGH, SHANK, FOOT]]
        normal = np.linalg.svd(own - own.mean(axis=0), full_matrices=False)[2][2]
        return normal * np.sign(normal[0])


def mixed(sets: Sequence[ElevationSet], weights: Float[np.ndarray, "n"]) -> ElevationSet:
    """The affine mix of ``sets``, [SM01] Eq. 9; weights sum to 1 and may be negative."""
    weights = frozen_array("weights", weights, (len(sets),))
    if abs(float(weights.sum()) - 1.0) > 1e-9:
        raise InvalidInputError(f"weights must sum to 1, got {weights.sum():g}")
    first = sets[0]
    for other in sets[1:]:
        if other.angles.shape != first.angles.shape or not np.isclose(
            other.pelvis_ratio, first.pelvis_ratio
        ):
            raise InvalidInputError(
                "sets that are mixed must have equally many samples and one body's hips: "
                "call for_body on each"
            )

    def mean(values: list[float]) -> float:
        return float(weights @ np.array(values))

    return ElevationSet(
        np.tensordot(weights, np.stack([s.angles for s in sets]), axes=1),
        first.pelvis_ratio,
        mean([s.slope for s in sets]),
        mean([s.step_duration * np.sqrt(first.leg_length / s.leg_length) for s in sets]),
        first.leg_length,
        name=" + ".join(f"{w:.2f} {s.name}" for w, s in zip(weights, sets, strict=True) if w),
        constructed="mixed",
        meta=np.maximum(weights @ np.stack([s.meta for s in sets]), 0.0),
        toe_off=mean([s.toe_off for s in sets]),
        above=weights @ np.stack([s.above for s in sets]),
    )


def set_from_cycle(cycle: Cycle, name: str) -> ElevationSet:
    """The even set of both legs of a stride: the mean of left and right, as measured.

    Measured legs close to a degree or two and no foot lies quite flat; the sets of
    :mod:`gaitsmith.walks.elevation_sets` are made to walk with.
    """
    data = elevation_of(cycle)
    mean = data.angles.mean(axis=0)
    count = len(mean)
    extended = np.concatenate([mean[-3:], mean, mean[:4]])
    times = np.arange(-3, count + 4) / count
    at = np.arange(SAMPLES) / SAMPLES
    skeleton = cycle.skeleton
    left, right = (skeleton.offsets[skeleton.index(f"{side}UpperLeg")] for side in SIDES)
    return ElevationSet(
        hermite(times, extended, parabola_slopes(times, extended), at),
        0.5 * float(np.linalg.norm(left - right)) / (PELVIS_TOP * data.leg_length),
        0.0,
        0.5 * data.duration,
        data.leg_length,
        name=name,
        source=cycle.source,
    )
