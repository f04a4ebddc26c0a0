"""The legs of [SM01] at many instants: joint angles that keep elevations, widths, list, toe-out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith.errors import InfeasibleError
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.solve import newton
from gaitsmith.synthesis.exact_figure import (
    ExactFigure,
    X,
    Y,
    Z,
    about,
    ankle_axes,
    apply,
    elevation,
    ours,
    turn_to_elevation,
)
from gaitsmith.walks.elevation import FOOT, SHANK, THIGH

if TYPE_CHECKING:
    from collections.abc import Callable

    from jaxtyping import Float, Int

    from gaitsmith.synthesis.exact_foot import StanceFoot

#: Phases between which the swinging foot turns from the slope it left to that it lands on.
_OVER = (0.10, 0.40)
#: Shares of the stride after which a swinging foot has forgotten how it left the ground.
_FORGET = 0.25
#: What is left of an equation that counts as solved; radians, and meters over the leg.
_SOLVED = 1e-9


@dataclass(frozen=True)
class Manners:
    """What [SM01] leaves free: parameters of the legs that are not seen from aside.

    Attributes
    ----------
    inset, sway
        The ankle lies ``inset + sway sin(2 pi t)`` inside of its hip, over leg length, at phase t
        of its own stride: half the hip width less half the step width, and the sway.
    list_size
        Radians of the pelvis' list, of its first and third harmonic: odd ones only, or it would
        jump when legs change.
    toe_out
        Radians, of the swinging leg, outward positive on both sides.
    """

    inset: float = 0.049
    sway: float = 0.021
    list_size: tuple[float, float] = (float(np.radians(3.3)), float(np.radians(1.0)))
    toe_out: float = float(np.radians(6.0))

    def width(self, time: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """Ankle outward of its hip over leg length; one curve for stance and swing."""
        return -self.inset - self.sway * np.sin(2.0 * np.pi * time)

    def pelvic_list(self, time: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """How much higher the swing hip is, radians, at ``time`` of the stance leg's stride."""
        first, third = self.list_size
        turn = 2.0 * np.pi * (time - 0.14)
        return -(first * np.cos(turn) + third * np.cos(3.0 * turn))


class Legs(NamedTuple):
    """F instants of both legs and the pelvis, in the package's frame, axis 1 [left, right].

    Attributes
    ----------
    stance
        ``(F,)`` side of the stance leg.
    time
        ``(F,)`` phase of the stance leg's stride, in [0, 0.5].
    heading
        ``(F,)`` of the sagittal plane, radians.
    top, hip, knee, ankle
        ``(F, 3)`` top of the pelvis, then ``(F, 2, 3)`` joints, meters.
    heel_ball
        ``(F, 2, 3)`` unit vector along the sole.
    sole
        ``(F, 2, C, 3)`` corners of the soles.
    joint
        ``(F, 2, 3)`` joints of the toes.
    angles
        ``(F, 2, 7)`` radians: hip flexion, abduction, rotation, knee (flexed is negative), upper
        and lower ankle, toes.
    corner, bears
        ``(F,)`` corner that bears and ``(F, 3)`` point of the ground that the stance foot
        stands on; see :class:`~gaitsmith.synthesis.exact_foot.StanceFoot`.
    weights
        ``(F, S)`` of the sets.
    """

    stance: Int[np.ndarray, "F"]
    time: Float[np.ndarray, "F"]
    heading: Float[np.ndarray, "F"]
    top: Float[np.ndarray, "F 3"]
    hip: Float[np.ndarray, "F 2 3"]
    knee: Float[np.ndarray, "F 2 3"]
    ankle: Float[np.ndarray, "F 2 3"]
    heel_ball: Float[np.ndarray, "F 2 3"]
    sole: Float[np.ndarray, "F 2 C 3"]
    joint: Float[np.ndarray, "F 2 3"]
    angles: Float[np.ndarray, "F 2 7"]
    corner: Int[np.ndarray, "F"]
    bears: Float[np.ndarray, "F 3"]
    weights: Float[np.ndarray, "F S"]


class Leg(NamedTuple):
    """One leg, paper's frame."""

    hip: Float[np.ndarray, "F 3"]
    knee: Float[np.ndarray, "F 3"]
    ankle: Float[np.ndarray, "F 3"]
    thigh: Float[np.ndarray, "F 3 3"]
    foot: Float[np.ndarray, "F 3 3"]
    bend: Float[np.ndarray, "F"]
    ankles: Float[np.ndarray, "F 2"]
    toe: Float[np.ndarray, "F"]


class Release(NamedTuple):
    """How a leg left the ground: its toe-out, the roll of its sole, its toes, the flat foot."""

    toe_out: float
    roll: float
    toe: float
    front: Float[np.ndarray, "3"]


class Plane(NamedTuple):
    """What a step's instants share: time, heading and the sagittal plane."""

    time: Float[np.ndarray, "F"]
    heading: Float[np.ndarray, "F"]
    forward: Float[np.ndarray, "F 3"]
    normal: Float[np.ndarray, "F 3"]


@dataclass(frozen=True, eq=False)
class LegSolver:
    """Joint angles of both legs at many instants, [SM01] section 4.3.

    Attributes
    ----------
    figure, manners
        Whose legs; what the data do not say.
    up
        ``(3,)`` normal of the ground, paper's frame.
    """

    figure: ExactFigure
    manners: Manners
    up: Float[np.ndarray, "3"]

    def slope_under(self, plane: Plane, release: Release) -> Float[np.ndarray, "F"]:
        """What the ground adds to the swinging foot's elevation: as it left, then as it lands."""
        old = elevation(np.broadcast_to(release.front, plane.forward.shape), plane.forward)
        new = np.arctan2(-(plane.forward @ self.up), self.up[1])
        share = smoothstep((plane.time - _OVER[0]) / (_OVER[1] - _OVER[0]))
        return old - 0.5 * np.pi + share * (new - old + 0.5 * np.pi)

    def stance_leg(
        self,
        plane: Plane,
        foot: StanceFoot,
        own: Float[np.ndarray, "F 4"],
        sign: float,
        index: int,
    ) -> Leg:
        """Both ankle angles from the shank's elevation and the stance width, Eq. 8.

        The width counts to the hip, which the knee decides: so the knee, in closed form, is
        inside of the equations (the paper's order has it later).
        """
        upper, lower = ankle_axes(sign)

        def posed(ankles: Float[np.ndarray, "F 2"]) -> Leg:
            unturned = about(lower, -ankles[:, 1]) @ about(upper, -ankles[:, 0])
            shank = foot.turned @ unturned
            knee = foot.ankle + apply(shank, self.figure.shin * Y)
            hinge = apply(shank, Z)
            down = apply(shank, -self.figure.thigh * Y)
            bend = -turn_to_elevation(down, hinge, own[:, THIGH], plane.heading, 0.5)
            thigh = shank @ about(Z, -bend)
            hip = knee - apply(thigh, -self.figure.thigh * Y)
            return Leg(hip, knee, foot.ankle, thigh, foot.turned, bend, ankles, foot.toe)

        def residual(ankles: Float[np.ndarray, "F 2"]) -> Float[np.ndarray, "F 2"]:
            leg = posed(ankles)
            shank = elevation(leg.ankle - leg.knee, plane.forward)
            width = sign * ((leg.ankle - leg.hip) * plane.normal).sum(-1) / self.figure.leg_length
            return np.stack(
                [shank - own[:, SHANK], width - self.manners.width(plane.time)], axis=-1
            )

        pitch = own[:, FOOT] - own[:, SHANK] - 0.5 * np.pi
        start = np.stack([pitch, np.zeros_like(pitch)], axis=-1)
        return posed(_solved(residual, start, "stance ankle", plane, index))

    def pelvis(
        self,
        plane: Plane,
        own: Float[np.ndarray, "F"],
        other: Float[np.ndarray, "F"],
        sign: float,
        index: int,
    ) -> Float[np.ndarray, "F 3 3"]:
        """Orientation of the pelvis from its two elevations and its list.

        With the swing hip's three the paper's six equations for six angles; they part into
        these three and those.
        """
        figure = self.figure
        tips = [np.array([0.0, -figure.pelvis, s * figure.half_hips]) for s in (sign, -sign)]
        wanted = self.manners.pelvic_list(plane.time)

        def posed(angles: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "F 3 3"]:
            turned = about(Y, plane.heading + angles[:, 0])
            return turned @ about(X, angles[:, 1]) @ about(Z, angles[:, 2])

        def residual(angles: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "F 3"]:
            pelvis = posed(angles)
            stance, swing = (elevation(apply(pelvis, tip), plane.forward) for tip in tips)
            across = apply(pelvis, -2.0 * sign * figure.half_hips * Z)
            tilt = np.arctan2(across[:, 1], -sign * (across * plane.normal).sum(-1))
            return np.stack([stance - own, swing - other, tilt - wanted], axis=-1)

        start = np.zeros((len(own), 3))
        return posed(_solved(residual, start, "pelvis", plane, index))

    def swing_leg(
        self,
        plane: Plane,
        pelvis: Float[np.ndarray, "F 3 3"],
        hip: Float[np.ndarray, "F 3"],
        other: Float[np.ndarray, "F 4"],
        sign: float,
        release: Release,
        index: int,
    ) -> Leg:
        """Hip from the thigh's elevation, the swing width and toe-out; ankle from foot and roll."""
        figure = self.figure
        fade = 1.0 - smoothstep(plane.time / _FORGET)
        toe_out = self.manners.toe_out + fade * (release.toe_out - self.manners.toe_out)
        width = self.manners.width(plane.time + 0.5)

        def posed(hips: Float[np.ndarray, "F 3"]) -> Leg:
            turned = about(Z, hips[:, 0]) @ about(X, -sign * hips[:, 1])
            thigh = pelvis @ turned @ about(Y, -sign * hips[:, 2])
            knee = hip + apply(thigh, -figure.thigh * Y)
            down = apply(thigh, -figure.shin * Y)
            bend = turn_to_elevation(down, apply(thigh, Z), other[:, SHANK], plane.heading, -0.5)
            shank = thigh @ about(Z, bend)
            ankle = knee + apply(shank, -figure.shin * Y)
            return Leg(hip, knee, ankle, thigh, shank, bend, hips[:, :2], bend)

        def residual(hips: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "F 3"]:
            leg = posed(hips)
            lift = elevation(leg.knee - leg.hip, plane.forward)
            wide = sign * ((leg.ankle - leg.hip) * plane.normal).sum(-1) / self.figure.leg_length
            front = apply(leg.thigh, X)
            out = np.arctan2(sign * (front * plane.normal).sum(-1), (front * plane.forward).sum(-1))
            return np.stack([lift - other[:, THIGH], wide - width, out - toe_out], axis=-1)

        start = np.stack([other[:, THIGH], *np.zeros((2, len(hip)))], axis=-1)
        leg = posed(_solved(residual, start, "swing hip", plane, index))
        upper, lower = ankle_axes(sign)
        level = plane.normal @ self.up
        roll = level + fade * (release.roll - level)

        def foot(ankles: Float[np.ndarray, "F 2"]) -> Float[np.ndarray, "F 3 3"]:
            return leg.foot @ about(upper, ankles[:, 0]) @ about(lower, ankles[:, 1])

        def off(ankles: Float[np.ndarray, "F 2"]) -> Float[np.ndarray, "F 2"]:
            turned = foot(ankles)
            pitch = elevation(apply(turned, X), plane.forward) - other[:, FOOT]
            lean = (apply(turned, Y) * plane.normal).sum(-1) - roll
            return np.stack([(pitch + np.pi) % (2.0 * np.pi) - np.pi, lean], axis=-1)

        pitch = other[:, FOOT] - other[:, SHANK] - 0.5 * np.pi
        start = np.stack([pitch, np.zeros_like(pitch)], axis=-1)
        ankles = _solved(off, start, "swing ankle", plane, index)
        return leg._replace(foot=foot(ankles), ankles=ankles, toe=fade * release.toe)

    def legs(
        self,
        side: int,
        plane: Plane,
        foot: StanceFoot,
        stance: Leg,
        swing: Leg,
        pelvis: Float[np.ndarray, "F 3 3"],
        middle: Float[np.ndarray, "F 3"],
        weights: Float[np.ndarray, "F S"],
    ) -> Legs:
        """Both legs by side, in the package's frame."""
        figure, count = self.figure, len(plane.time)
        order = (stance, swing) if side == 0 else (swing, stance)

        def both(values: list[np.ndarray]) -> np.ndarray:
            return ours(np.stack(values, axis=1))

        def corners(leg: Leg) -> np.ndarray:
            return leg.ankle[:, None] + figure.sole @ np.swapaxes(leg.foot, 1, 2)

        angles = [self._angles(leg, pelvis, s) for leg, s in zip(order, (-1.0, 1.0), strict=True)]
        return Legs(
            stance=np.full(count, side),
            time=plane.time,
            heading=plane.heading,
            top=ours(middle + apply(pelvis, figure.pelvis * Y)),
            hip=both([leg.hip for leg in order]),
            knee=both([leg.knee for leg in order]),
            ankle=both([leg.ankle for leg in order]),
            heel_ball=both([apply(leg.foot, X) for leg in order]),
            sole=both([corners(leg) for leg in order]),
            joint=both([leg.ankle + apply(leg.foot, figure.joint) for leg in order]),
            angles=np.stack(angles, axis=1),
            corner=foot.corner,
            bears=ours(foot.bears),
            weights=weights,
        )

    def _angles(self, leg: Leg, pelvis: Float[np.ndarray, "F 3 3"], sign: float) -> np.ndarray:
        """The seven joint angles of one leg; the hip's by decomposition, Z then X then Y."""
        turned = np.swapaxes(pelvis, 1, 2) @ leg.thigh
        # R = Rz(h0) Rx(-s h1) Ry(-s h2)
        first = np.arctan2(-turned[:, 0, 1], turned[:, 1, 1])
        second = -sign * np.arcsin(np.clip(turned[:, 2, 1], -1.0, 1.0))
        third = -sign * np.arctan2(-turned[:, 2, 0], turned[:, 2, 2])
        hips = [first, second, third]
        return np.stack([*hips, leg.bend, leg.ankles[:, 0], leg.ankles[:, 1], leg.toe], axis=-1)


def _solved(
    residual: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    what: str,
    plane: Plane,
    index: int,
) -> np.ndarray:
    """Roots at all instants, or the step and the instant at which there is none."""
    found = newton(residual, start)
    worst = int(found.error.argmax())
    if found.error[worst] > _SOLVED:
        raise InfeasibleError(
            f"step {index + 1}: the {what} has no angles at {plane.time[worst]:.3f} of the stride, "
            f"heading {np.degrees(plane.heading[worst]):.0f} deg: turn less within a step"
        )
    return found.unknowns


def elevations_of(legs: Legs) -> Float[np.ndarray, "F 2 4"]:
    """Elevations of both legs' segments as they are seen: foot, shank, thigh, pelvis."""
    forward = np.stack(
        [np.sin(legs.heading), np.zeros(len(legs.heading)), np.cos(legs.heading)], axis=-1
    )[:, None]
    segments = (
        legs.heel_ball,
        legs.ankle - legs.knee,
        legs.knee - legs.hip,
        legs.hip - legs.top[:, None],
    )
    return np.stack([elevation(v, forward) for v in segments], axis=-1)
