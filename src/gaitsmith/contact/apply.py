"""A planned contact, looked up at any phases: hips, legs and feet of the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.leg import two_bone_ik
from gaitsmith.body.sole import rolled_ankle
from gaitsmith.contact.reference import bearing
from gaitsmith.conventions import SIDE_SIGN, ahead
from gaitsmith.geometry.curves import hermite, parabola_slopes, pchip_slopes, smoothstep
from gaitsmith.geometry.rotations import about, exp, inverse, multiply, rotate

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.contact.foothold import Footholds
    from gaitsmith.contact.reference import Proposal

#: Radians that are none.
ROUNDING = 1e-12
#: Curves whose sign carries meaning (which part of the sole bears) are read monotonely.
MONOTONE = ("pitch", "meta", "bend")


@dataclass(frozen=True, eq=False)
class Poses:
    """F poses of a body whose feet are on the ground.

    Attributes
    ----------
    center
        ``(F, 3)`` mid-point of the hips, world, meters.
    heading
        ``(F,)`` of the walk, radians.
    pelvis
        ``(F, 4)`` world rotation.
    thigh, shin, foot
        ``(F, 2, 4)`` world rotations of [left, right].
    bend
        ``(F, 2)`` toes against the sole, toes up positive, radians.
    knee
        ``(F, 2)`` flexion, radians.
    upper
        ``(F, U, 3)`` local rotation vectors of the upper body's joints.
    contacts
        ``(F, 2, 3)`` [left, right] x [heel, ball, toe tip] bears.
    """

    center: Float[np.ndarray, "F 3"]
    heading: Float[np.ndarray, "F"]
    pelvis: Float[np.ndarray, "F 4"]
    thigh: Float[np.ndarray, "F 2 4"]
    shin: Float[np.ndarray, "F 2 4"]
    foot: Float[np.ndarray, "F 2 4"]
    bend: Float[np.ndarray, "F 2"]
    knee: Float[np.ndarray, "F 2"]
    upper: Float[np.ndarray, "F U 3"]
    contacts: Bool[np.ndarray, "F 2 3"]


@dataclass(frozen=True, eq=False)
class ContactPlan:
    """Everything that is needed to pose a walk at any walk phase: curves and footholds.

    A walk phase is the index of a step plus the phase within it.
    """

    body: Body
    at: Float[np.ndarray, "M"]
    table: Float[np.ndarray, "M C"]
    slopes: Float[np.ndarray, "M C"]
    columns: dict[str, slice]
    upper_joints: int
    stance: Int[np.ndarray, "S"]
    toe_off: Float[np.ndarray, "S"]
    stands: Footholds
    targets: Footholds
    level: bool

    @staticmethod
    def of(walk: Proposal, stands: Footholds, targets: Footholds, body: Body) -> ContactPlan:
        """Freeze the corrected curves of a walk into a look-up table."""
        # in the air the meta curve goes on as the toes turn, so that it is read with the right
        # slope up to the very toe-off; only bearing feet use it
        free, curves = ~walk.bearing(), walk.curves
        curves["meta"] = np.where(free, -curves["pitch"] - curves["bend"], curves["meta"])
        blocks, slopes, columns, width = [], [], {}, 0
        for name, values in walk.curves.items():
            flat = values.reshape(len(walk.at), -1)
            slope = pchip_slopes if name in MONOTONE else parabola_slopes
            blocks.append(flat)
            slopes.append(slope(walk.at, flat))
            columns[name] = slice(width, width + flat.shape[1])
            width += flat.shape[1]
        table, rates = np.concatenate(blocks, axis=1), np.concatenate(slopes, axis=1)
        _leave_as_rolled(walk, stands, body, rates, columns)
        rates[:, columns["foot_heading"]][~free] = 0.0  # a foot that bears does not turn
        return ContactPlan(
            body=body,
            at=walk.at,
            table=table,
            slopes=rates,
            columns=columns,
            upper_joints=walk.curves["upper"].shape[1],
            stance=walk.stance,
            toe_off=walk.toe_off,
            stands=stands,
            targets=targets,
            level=not (stands.tilt.any() or targets.tilt.any()),
        )

    @property
    def steps(self) -> int:
        """Number of steps planned."""
        return len(self.stance)

    def poses(self, walk_phase: Float[np.ndarray, "F"]) -> Poses:
        """Poses at walk phases in [0, steps], in any order; O(1) each."""
        values = hermite(self.at, self.table, self.slopes, walk_phase)

        def read(name: str, *shape: int) -> Float[np.ndarray, "F ..."]:
            return values[:, self.columns[name]].reshape(len(values), *shape)

        step = np.clip(walk_phase.astype(np.int64), 0, self.steps - 1)
        phase = walk_phase - step
        down = bearing(self.stance, self.toe_off, step, phase)
        center, heading = read("center", 3), read("heading")
        # a rounding error off level is level: the sign says what of the sole bears
        pitch, meta, bend = _level(read("pitch", 2)), _level(read("meta", 2)), read("bend", 2)
        bend = np.where(down, np.where(pitch < 0.0, -pitch - meta, 0.0), bend)
        pelvis = multiply(about("y", heading), exp(read("pelvis", 3)))
        ankle, foot = self._feet(
            step, phase, down, pitch, meta, read("ankle", 2, 3), read("foot_heading", 2)
        )
        half = (0.5 * self.body.hip_width) * rotate(pelvis, np.array([1.0, 0.0, 0.0]))
        hip = center[:, None] + SIDE_SIGN[:, None] * half[:, None]
        # the knee points half way between where the foot and where the pelvis face
        towards = ahead(read("foot_heading", 2)) + ahead(heading)[:, None]
        leg = two_bone_ik(hip, ankle, towards, thigh=self.body.thigh, shin=self.body.shin)
        # a walk that ends with a heel strike ends with that heel on the ground
        touching = down | (phase >= 1.0)[:, None]
        toes = touching & (pitch <= 0.0)
        # where the toes bend above the sole, the ball's sole point moves as soon as they bend
        ball = toes & (meta == 0.0)
        if self.body.foot.toe_joint_height > 0.0:
            ball &= pitch == 0.0
        contacts = np.stack([touching & (pitch >= 0.0), ball, toes], axis=-1)
        return Poses(
            center=center,
            heading=heading,
            pelvis=pelvis,
            thigh=leg.thigh,
            shin=leg.shin,
            foot=foot,
            bend=bend,
            knee=leg.flexion,
            upper=read("upper", self.upper_joints, 3),
            contacts=contacts,
        )

    def _feet(
        self,
        step: Int[np.ndarray, "F"],
        phase: Float[np.ndarray, "F"],
        down: Bool[np.ndarray, "F 2"],
        pitch: Float[np.ndarray, "F 2"],
        meta: Float[np.ndarray, "F 2"],
        ankle: Float[np.ndarray, "F 2 3"],
        heading: Float[np.ndarray, "F 2"],
    ) -> tuple[Float[np.ndarray, "F 2 3"], Float[np.ndarray, "F 2 4"]]:
        """Ankles and world rotations of the feet; exact on their footholds where they bear."""
        stand = self.stands.at(step)
        points = rolled_ankle(self.body.foot, pitch, meta)
        ankle = np.where(down[..., None], stand.place(points), ankle)
        level = multiply(about("y", heading), about("x", -pitch))
        if self.level:
            return ankle, level
        off = self.toe_off[step]
        share = smoothstep((phase - off) / np.where(off < 1.0, 1.0 - off, 1.0))
        swing = np.arange(2) != self.stance[step][:, None]
        share = np.where(swing & ~down, share[:, None], 0.0)[..., None]
        tilt = (1.0 - share) * stand.tilt + share * self.targets.tilt[step][:, None]
        return ankle, multiply(exp(tilt), level)


def _level(angle: Float[np.ndarray, "F 2"]) -> Float[np.ndarray, "F 2"]:
    return np.where(np.abs(angle) < ROUNDING, 0.0, angle)


def _leave_as_rolled(
    walk: Proposal,
    stands: Footholds,
    body: Body,
    slopes: Float[np.ndarray, "M C"],
    columns: dict[str, slice],
) -> None:
    """Give the ankle, at each toe-off, the very speed that rolling over the toe tip gives it."""
    node = np.flatnonzero(walk.phase == walk.toe_off[walk.step])
    if not len(node):
        return
    step = walk.step[node]
    side = 1 - walk.stance[step]
    stand, tiny = stands.at((step, side)), 1e-6
    at = {name: walk.curves[name][node, side] for name in ("pitch", "meta")}
    rate = {name: slopes[node, columns[name].start + side] for name in at}

    def ankle(ahead_of: float) -> Float[np.ndarray, "k 3"]:
        pitch, meta = (at[name] + ahead_of * rate[name] for name in at)
        return stand.ankle(body.foot, pitch, meta)

    speed = (ankle(tiny) - ankle(-tiny)) / (2.0 * tiny)
    column = columns["ankle"].start + 3 * side[:, None] + np.arange(3)
    slopes[node[:, None], column] = speed


def local_legs(poses: Poses) -> dict[str, Float[np.ndarray, "F 2 4"]]:
    """Local rotations of [left, right] UpperLeg, LowerLeg, Foot and Toes, by name."""
    return {
        "UpperLeg": multiply(inverse(poses.pelvis)[:, None], poses.thigh),
        "LowerLeg": about("x", poses.knee),
        "Foot": multiply(inverse(poses.shin), poses.foot),
        "Toes": about("x", -poses.bend),
    }
