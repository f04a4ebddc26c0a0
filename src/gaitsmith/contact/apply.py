"""A planned contact, looked up at any phases: hips, legs and feet of the body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.leg import two_bone_ik
from gaitsmith.body.sole import hanging_toes, rolled_ankle
from gaitsmith.contact.reach import SAMPLED_REACH
from gaitsmith.contact.step_curves import ROWS, WIDTH
from gaitsmith.conventions import BALL, HEEL, TOE, UP
from gaitsmith.geometry.angles import sine_cosine
from gaitsmith.geometry.curves import (
    hermite,
    parabola_slopes,
    pchip_slopes,
    smoothstep,
)
from gaitsmith.geometry.rotations import (
    about,
    component_major,
    exp,
    inverse,
    left_of,
    multiply,
    pitched,
    turned_left,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.contact.foothold import Footholds
    from gaitsmith.contact.reference import Proposal

#: Radians that are none.
ROUNDING = 1e-12
_BOTH = np.array([[0], [1]])
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
        np.copyto(curves["meta"], -curves["pitch"] - curves["bend"], where=free)
        table = np.ascontiguousarray(walk.table.T)
        rates = parabola_slopes(walk.at, table)
        for name in MONOTONE:
            rates[:, ROWS[name]] = pchip_slopes(walk.at, curves[name])
        _leave_as_rolled(walk, stands, body, rates)
        rates[:, ROWS["foot_heading"]][~free] = 0.0  # a foot that bears does not turn
        return ContactPlan(
            body=body,
            at=walk.at,
            table=table,
            slopes=rates,
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
        frames = len(walk_phase)
        rows = hermite(self.at, self.table, self.slopes, walk_phase)
        # a row a column of the table; below, sides come first and frames are next to each other
        rows = np.ascontiguousarray(rows.T)

        def read(name: str) -> Float[np.ndarray, "..."]:
            return rows[ROWS[name]]

        step = np.clip(walk_phase.astype(np.int64), 0, self.steps - 1)
        phase = walk_phase - step
        lifted, stance = phase > self.toe_off[step], self.stance[step]
        down = ~(lifted & (stance != _BOTH))
        # a rounding error off level is level: the sign says what of the sole bears
        pitch, meta, bend = _level(read("pitch")), _level(read("meta")), read("bend")
        bend = np.where(down, np.where(pitch < 0.0, -pitch - meta, 0.0), bend)
        if self._uneven:
            bend = self._uneven_bend((step, phase, stance), down, pitch, bend)
        heading, foot_heading = read("heading")[0], read("foot_heading")
        pelvis = turned_left(heading, exp(read("pelvis").T))
        ankle, foot = self._feet(
            (step, phase, stance),
            down,
            pitch,
            meta,
            read("ankle").reshape(2, 3, frames).transpose(0, 2, 1),
            foot_heading,
        )
        center, side = read("center").T, 0.5 * self.body.hip_width * left_of(pelvis)
        hip = component_major((2, frames), 3)
        np.add(center, side, out=hip[0])
        np.subtract(center, side, out=hip[1])
        # a walk that ends with a heel strike ends with that heel on the ground
        touching = down | (phase >= 1.0)
        center = center - self._too_high(hip, ankle, touching)
        # the knee points half way between where the foot and where the pelvis face
        towards = component_major((2, frames), 3)
        for axis, foot_faces, faces in zip(
            (0, 2), sine_cosine(foot_heading), sine_cosine(heading), strict=True
        ):
            np.add(foot_faces, faces, out=towards[..., axis])
        towards[..., 1] = 0.0
        leg = two_bone_ik(hip, ankle, towards, thigh=self.body.thigh, shin=self.body.shin)
        toes = touching & (pitch <= 0.0)
        # where the toes bend above the sole, the ball's sole point moves as soon as they bend
        ball = toes & (meta == 0.0)
        if self.body.foot.toe_joint_height > 0.0:
            ball &= pitch == 0.0
        contacts = np.empty((frames, 2, 3), dtype=np.bool_)
        for point, bears in ((HEEL, touching & (pitch >= 0.0)), (BALL, ball), (TOE, toes)):
            contacts[..., point] = bears.T
        if self.stands.bears is not None:
            contacts = self._borne(step, down, pitch, contacts)
        upper = read("upper").reshape((len(rows) - WIDTH) // 3, 3, frames)
        return Poses(
            center=center,
            heading=heading,
            pelvis=pelvis,
            thigh=leg.thigh.swapaxes(0, 1),
            shin=leg.shin.swapaxes(0, 1),
            foot=foot.swapaxes(0, 1),
            bend=bend.T,
            knee=leg.flexion.T,
            upper=upper.transpose(2, 0, 1),
            contacts=contacts,
        )

    def _too_high(
        self,
        hip: Float[np.ndarray, "2 F 3"],
        ankle: Float[np.ndarray, "2 F 3"],
        touching: Bool[np.ndarray, "2 F"],
    ) -> Float[np.ndarray, "F 3"] | float:
        """How far bearing legs are out of reach, which the hips come down by; moves ``hip``.

        Planning keeps legs in reach on its nodes; between them a curve may stray by tenths of
        a millimeter, which are degrees of a nearly straight knee.
        """
        limit = SAMPLED_REACH * self.body.leg_length
        line = hip - ankle
        square = line[..., 0] ** 2 + line[..., 1] ** 2 + line[..., 2] ** 2
        far = touching & (square > limit**2)
        if not far.any():
            return 0.0
        across = line[..., 0] ** 2 + line[..., 2] ** 2
        allowed = np.sqrt(np.maximum(limit**2 - across, 0.0))
        down_by = np.where(far, line[..., 1] - allowed, 0.0).max(axis=0)
        hip[..., 1] -= down_by
        return down_by[:, None] * UP

    @cached_property
    def _stands(self) -> tuple[Float[np.ndarray, "2 3 S"], ...]:
        """Position, forward, normal and tilt of the footholds, steps last."""
        fields = (self.stands.position, self.stands.forward, self.stands.normal, self.stands.tilt)
        return tuple(np.ascontiguousarray(f.transpose(1, 2, 0)) for f in fields)

    def _feet(
        self,
        when: tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"], Int[np.ndarray, "F"]],
        down: Bool[np.ndarray, "2 F"],
        pitch: Float[np.ndarray, "2 F"],
        meta: Float[np.ndarray, "2 F"],
        ankle: Float[np.ndarray, "2 F 3"],
        heading: Float[np.ndarray, "2 F"],
    ) -> tuple[Float[np.ndarray, "2 F 3"], Float[np.ndarray, "2 F 4"]]:
        """Ankles and world rotations of the feet; exact on their footholds where they bear."""
        step = when[0]
        count = 2 if self.level else 4
        stand = [np.take(f, step, axis=2).transpose(0, 2, 1) for f in self._stands[:count]]
        toes, on_ball = self.stands.toes, self.stands.on_ball
        points = rolled_ankle(
            self.body.foot,
            pitch,
            meta,
            None if toes is None else toes[step].T,
            None if on_ball is None else on_ball[step].T,
        )
        place = stand[0] + points[..., :1] * stand[1]
        if self.level:
            place[..., 1] += points[..., 1]
        else:
            place += points[..., 1:] * stand[2]
        ankle = np.where(down[..., None], place, ankle)
        flat = pitched(heading, -pitch)
        if self.level:
            return ankle, flat
        share = self._flown(when, down)[..., None]
        target = self.targets.tilt[step]
        return ankle, multiply(exp((1.0 - share) * stand[3] + share * target), flat)

    def _flown(
        self,
        when: tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"], Int[np.ndarray, "F"]],
        down: Bool[np.ndarray, "2 F"],
    ) -> Float[np.ndarray, "2 F"]:
        """How far each foot has taken on the lie of its next foothold: from toe-off on, 0 to 1."""
        step, phase, stance = when
        off = self.toe_off[step]
        share = smoothstep((phase - off) / np.where(off < 1.0, 1.0 - off, 1.0))
        return np.where((stance != _BOTH) & ~down, share, 0.0)

    @cached_property
    def _uneven(self) -> bool:
        """Whether toes bend to the ground, or hang over an edge, anywhere."""
        both = (self.stands, self.targets)
        return any((f.toes is not None and f.toes.any()) or f.bears is not None for f in both)

    def _uneven_bend(
        self,
        when: tuple[Int[np.ndarray, "F"], Float[np.ndarray, "F"], Int[np.ndarray, "F"]],
        down: Bool[np.ndarray, "2 F"],
        pitch: Float[np.ndarray, "2 F"],
        bend: Float[np.ndarray, "2 F"],
    ) -> Float[np.ndarray, "2 F"]:
        """Toes against the sole with what the ground under them asks for."""
        step = when[0]
        if self.stands.on_ball is not None:
            hangs = down & (pitch < 0.0) & self.stands.on_ball[step].T
            bend = np.where(hangs, hanging_toes(self.body.foot, np.minimum(pitch, 0.0)), bend)
        if self.stands.toes is None or self.targets.toes is None:
            return bend
        share = self._flown(when, down)
        return bend + (1.0 - share) * self.stands.toes[step].T + share * self.targets.toes[step]

    def _borne(
        self,
        step: Int[np.ndarray, "F"],
        down: Bool[np.ndarray, "2 F"],
        pitch: Float[np.ndarray, "2 F"],
        contacts: Bool[np.ndarray, "F 2 3"],
    ) -> Bool[np.ndarray, "F 2 3"]:
        """``contacts`` without what hangs over an edge; there the ball bears as the foot rolls."""
        assert self.stands.bears is not None
        under = self.stands.bears[step]
        rolls = (down & (pitch <= 0.0)).T & ~under[..., TOE]
        if self.targets.bears is not None:  # a walk that ends with a heel strike
            under = np.where(down.T[..., None], under, self.targets.bears[step][:, None])
        out = contacts & under
        out[..., BALL] |= rolls
        return out


def _level(angle: Float[np.ndarray, "2 F"]) -> Float[np.ndarray, "2 F"]:
    return np.where(np.abs(angle) < ROUNDING, 0.0, angle)


def _leave_as_rolled(
    walk: Proposal,
    stands: Footholds,
    body: Body,
    slopes: Float[np.ndarray, "M C"],
) -> None:
    """Give ankle and toes, at each toe-off, the speed that rolling over the toe tip gives them.

    Otherwise the toe tip would leave downward, into the ground.
    """
    node = np.flatnonzero(walk.phase == walk.toe_off[walk.step])
    if not len(node):
        return
    step = walk.step[node]
    side = 1 - walk.stance[step]
    stand, tiny = stands.at((step, side)), 1e-6
    at = {name: walk.curves[name][node, side] for name in ("pitch", "meta")}
    rate = {name: slopes[node, ROWS[name].start + side] for name in at}

    def ankle(ahead_of: float) -> Float[np.ndarray, "k 3"]:
        pitch, meta = (at[name] + ahead_of * rate[name] for name in at)
        return stand.ankle(body.foot, pitch, meta)

    speed = (ankle(tiny) - ankle(-tiny)) / (2.0 * tiny)
    column = ROWS["ankle"].start + 3 * side[:, None] + np.arange(3)
    slopes[node[:, None], column] = speed
    slopes[node, ROWS["bend"].start + side] = -rate["pitch"] - rate["meta"]


def local_legs(poses: Poses) -> dict[str, Float[np.ndarray, "F 2 4"]]:
    """Local rotations of [left, right] UpperLeg, LowerLeg, Foot and Toes, by name."""
    thigh, shin, foot = (q.swapaxes(0, 1) for q in (poses.thigh, poses.shin, poses.foot))
    turned = {
        "UpperLeg": multiply(inverse(poses.pelvis), thigh),
        "LowerLeg": about("x", poses.knee.T),
        "Foot": multiply(inverse(shin), foot),
        "Toes": about("x", -poses.bend.T),
    }
    return {name: q.swapaxes(0, 1) for name, q in turned.items()}
