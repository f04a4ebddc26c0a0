"""ElevWalker of [SM01]: legs whose silhouette is the data's, along any heading.

Mode `exact`: the paper's walker, mended where it would pop (docs/papers/sm01.md). One step at a
time, all its instants at once. Its trailing foot is driven by data alone, so its toes cut the
ground after a swap; the product's walker has the contact stage instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InfeasibleError, InvalidInputError
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
    sagittal,
    turn_to_elevation,
)
from gaitsmith.synthesis.exact_foot import Landing, StanceFoot, land, stand
from gaitsmith.walks.elevation import FOOT, PELVIS, SHANK, THIGH
from gaitsmith.walks.interpolate import ElevInterp

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.walks.elevation import ElevationSet

#: Shares of the stride after which a swinging foot has forgotten how it left the ground.
_FORGET = 0.25
#: Phase of the stride at which new weights are reached; how often a landing is aimed again.
#: How near, meters.
_SETTLED, _AIMS, _AIMED = 0.46, 8, 1e-6
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


class _Leg(NamedTuple):
    """One leg, paper's frame."""

    hip: Float[np.ndarray, "F 3"]
    knee: Float[np.ndarray, "F 3"]
    ankle: Float[np.ndarray, "F 3"]
    thigh: Float[np.ndarray, "F 3 3"]
    foot: Float[np.ndarray, "F 3 3"]
    bend: Float[np.ndarray, "F"]
    ankles: Float[np.ndarray, "F 2"]
    toe: Float[np.ndarray, "F"]


class _Release(NamedTuple):
    """How a leg left the ground: its toe-out, the roll of its sole, its toes."""

    toe_out: float
    roll: float
    toe: float


class _State(NamedTuple):
    """What one step leaves to the next; ``bias`` is what its landing missed the planar f by."""

    landing: Landing
    release: _Release
    weights: Float[np.ndarray, "S"]
    bias: Float[np.ndarray, "2"]


class _Plane(NamedTuple):
    """What a step's instants share: time, heading and the sagittal plane."""

    time: Float[np.ndarray, "F"]
    heading: Float[np.ndarray, "F"]
    forward: Float[np.ndarray, "F 3"]
    normal: Float[np.ndarray, "F 3"]


class ExactWalker:
    """Walks elevation data on level ground, [SM01] section 4.

    Parameters
    ----------
    sets
        What is walked; their pelvis angles are fitted to ``body``. Of three and more, steps of
        any length are mixed ([SM01] section 5).
    body
        Who walks.
    manners
        What the data do not say.
    """

    def __init__(
        self, sets: Sequence[ElevationSet], body: Body, manners: Manners | None = None
    ) -> None:
        self.sets = tuple(s.for_body(body) for s in sets)
        self.figure = ExactFigure.of(body)
        self.manners = Manners() if manners is None else manners
        self._scale = body.leg_length
        self._mixer = ElevInterp(sets, body) if len(self.sets) > 2 else None

    def data(
        self, weights: Float[np.ndarray, "F S"], time: Float[np.ndarray, "F"]
    ) -> Float[np.ndarray, "F 4"]:
        """Elevations at phases ``time`` of a leg's own stride, of mixes, [SM01] Eq. 9.

        The foot's count from the slope that the mixed data are of: where they lay it flat, it
        lies on the level.
        """
        rows = zip(weights.T, self.sets, strict=True)
        angles = np.sum([w[:, None] * s.at(time) for w, s in rows], axis=0)
        angles[:, FOOT] -= weights @ np.array([s.slope for s in self.sets])
        return angles

    def walk(
        self,
        steps: int,
        heading: Callable[[Float[np.ndarray, "F"]], Float[np.ndarray, "F"]],
        *,
        length: float | None = None,
        frames: int = 36,
    ) -> list[Legs]:
        """``steps`` steps from the left heel strike, each at ``frames`` + 1 even instants.

        Parameters
        ----------
        steps
            One or more.
        heading
            Radians at any times in steps from the start, as arrays; smooth.
        length
            Of each step, N to N along the heading at landing, meters, and every foot lands on the
            ground; None: the first set is walked as it is, and its error in height fades.
        frames
            Intervals of a step; the last instant is the next step's first.

        Raises
        ------
        InfeasibleError
            If a leg cannot keep its data at the heading, or the sets take no such step.
        """
        if steps < 1 or frames < 2:
            raise InvalidInputError("a walk needs at least one step of two frames")
        if length is not None:
            self._check_length(length)
        state = self._begun(float(heading(np.zeros(1))[0]), length)
        time = 0.5 * np.arange(frames + 1) / frames
        out: list[Legs] = []
        for index in range(steps):
            turned = frozen_array("heading", heading(index + 2.0 * time), (frames + 1,))
            state, target = self._aimed(index, float(turned[-1]), state, length)
            legs, state = self._step(index, time, turned, state, target)
            out.append(legs)
        return out

    def _check_length(self, length: float) -> None:
        if self._mixer is None:
            raise InvalidInputError("a step length needs three or more sets to mix")
        found = self._mixer.find(np.array([[length, 0.0]])).achieved[0, 0]
        if abs(found - length) > _AIMED:
            raise InfeasibleError(
                f"a step of {length:g} m is beyond what the elevation data span; the nearest that "
                f"they take on this body is {found:.3f} m"
            )

    def _begun(self, heading: float, length: float | None) -> _State:
        """The state at a left heel strike of a walk that has gone on for two steps."""
        weights = np.eye(len(self.sets))[0]
        pitch = float(self.sets[0].angles[0, FOOT]) - 0.5 * np.pi
        turned = about(Y, np.array(heading)) @ about(Y, np.array(self.manners.toe_out))
        axis = sagittal(np.array(heading))[1]
        turned = about(axis, np.array(pitch)) @ turned
        landing = land(self.figure, turned, -(turned @ self.figure.sole[0]), heading)
        state = _State(landing, _Release(self.manners.toe_out, 0.0, 0.0), weights, np.zeros(2))
        time = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
        for index in range(4):
            state, target = self._aimed(index, heading, state, length)
            _, state = self._step(index, time, np.full(len(time), heading), state, target)
        shift = state.landing.places[0] * (X + Z)
        return state._replace(landing=state.landing.moved(-shift))

    def _aimed(
        self, index: int, heading: float, state: _State, length: float | None
    ) -> tuple[_State, Float[np.ndarray, "S"]]:
        """Weights at the end of a step, so that the foot lands as far off as asked, on the ground.

        What the planar f of [SM01] predicts is off by the pelvis' list and the legs' slant; that
        difference, measured on the landing itself, is taken off the request, and off the next.
        """
        if length is None or self._mixer is None:
            return state, state.weights
        wanted, end = np.array([length, 0.0]), np.array([0.5])
        bias, front = state.bias, sagittal(np.array(heading))[0]
        aimed, weights = state, state.weights
        for _ in range(_AIMS):
            weights = self._mixer.find((wanted + bias)[None]).weights[0]
            aimed = state._replace(bias=bias)
            _, after = self._step(index, end, np.array([heading]), aimed, weights)
            way = after.landing.lies(self.figure) - state.landing.lies(self.figure)
            missed = wanted - np.array([way @ front, after.landing.gap])
            if np.abs(missed).max() < _AIMED:
                break
            bias = bias + missed
        return aimed, weights

    def _step(
        self,
        index: int,
        time: Float[np.ndarray, "F"],
        heading: Float[np.ndarray, "F"],
        state: _State,
        target: Float[np.ndarray, "S"],
    ) -> tuple[Legs, _State]:
        """All instants of one step, and the state that the next one starts from."""
        side = index % 2
        moved = _minimum_jerk(time / _SETTLED)[:, None]
        weights = state.weights + moved * (target - state.weights)
        own, other = self.data(weights, time), self.data(weights, time + 0.5)
        plane = _Plane(time, heading, *sagittal(heading))
        sign = 2.0 * side - 1.0
        foot = stand(self.figure, state.landing, own[:, FOOT], heading, time)
        stance = self._stance_leg(plane, foot, own, sign, index)
        pelvis = self._pelvis(plane, own[:, PELVIS], other[:, PELVIS], sign, index)
        half = self.figure.half_hips * Z
        middle = stance.hip - apply(pelvis, sign * half)
        hip = middle - apply(pelvis, sign * half)
        swing = self._swing_leg(plane, pelvis, hip, other, -sign, state.release, index)
        legs = self._legs(side, plane, foot, stance, swing, pelvis, middle, weights)
        landed = land(self.figure, swing.foot[-1], swing.ankle[-1], float(heading[-1]))
        front, normal = plane.forward[-1], plane.normal[-1]
        out = stance.thigh[-1] @ X
        leaving = _Release(
            float(np.arctan2(sign * (out @ normal), out @ front)),
            float((stance.foot[-1] @ Y) @ normal),
            float(foot.toe[-1]),
        )
        return legs, _State(landed, leaving, target, state.bias)

    def _stance_leg(
        self,
        plane: _Plane,
        foot: StanceFoot,
        own: Float[np.ndarray, "F 4"],
        sign: float,
        index: int,
    ) -> _Leg:
        """Both ankle angles from the shank's elevation and the stance width, Eq. 8.

        The width counts to the hip, which the knee decides: so the knee, in closed form, is
        inside of the equations (the paper's order has it later).
        """
        upper, lower = ankle_axes(sign)

        def posed(ankles: Float[np.ndarray, "F 2"]) -> _Leg:
            unturned = about(lower, -ankles[:, 1]) @ about(upper, -ankles[:, 0])
            shank = foot.turned @ unturned
            knee = foot.ankle + apply(shank, self.figure.shin * Y)
            hinge = apply(shank, Z)
            down = apply(shank, -self.figure.thigh * Y)
            bend = -turn_to_elevation(down, hinge, own[:, THIGH], plane.heading, 0.5)
            thigh = shank @ about(Z, -bend)
            hip = knee - apply(thigh, -self.figure.thigh * Y)
            return _Leg(hip, knee, foot.ankle, thigh, foot.turned, bend, ankles, foot.toe)

        def residual(ankles: Float[np.ndarray, "F 2"]) -> Float[np.ndarray, "F 2"]:
            leg = posed(ankles)
            shank = elevation(leg.ankle - leg.knee, plane.forward)
            width = sign * ((leg.ankle - leg.hip) * plane.normal).sum(-1) / self._scale
            return np.stack([shank - own[:, SHANK], width - self._width(plane.time)], axis=-1)

        pitch = own[:, FOOT] - own[:, SHANK] - 0.5 * np.pi
        start = np.stack([pitch, np.zeros_like(pitch)], axis=-1)
        return posed(_solved(residual, start, "stance ankle", plane, index))

    def _pelvis(
        self,
        plane: _Plane,
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
        wanted = self._list(plane.time)

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

    def _swing_leg(
        self,
        plane: _Plane,
        pelvis: Float[np.ndarray, "F 3 3"],
        hip: Float[np.ndarray, "F 3"],
        other: Float[np.ndarray, "F 4"],
        sign: float,
        release: _Release,
        index: int,
    ) -> _Leg:
        """Hip from the thigh's elevation, the swing width and toe-out; ankle from foot and roll."""
        figure = self.figure
        fade = 1.0 - smoothstep(plane.time / _FORGET)
        toe_out = self.manners.toe_out + fade * (release.toe_out - self.manners.toe_out)
        width = self._width(plane.time + 0.5)

        def posed(hips: Float[np.ndarray, "F 3"]) -> _Leg:
            turned = about(Z, hips[:, 0]) @ about(X, -sign * hips[:, 1])
            thigh = pelvis @ turned @ about(Y, -sign * hips[:, 2])
            knee = hip + apply(thigh, -figure.thigh * Y)
            down = apply(thigh, -figure.shin * Y)
            bend = turn_to_elevation(down, apply(thigh, Z), other[:, SHANK], plane.heading, -0.5)
            shank = thigh @ about(Z, bend)
            ankle = knee + apply(shank, -figure.shin * Y)
            return _Leg(hip, knee, ankle, thigh, shank, bend, hips[:, :2], bend)

        def residual(hips: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "F 3"]:
            leg = posed(hips)
            lift = elevation(leg.knee - leg.hip, plane.forward)
            wide = sign * ((leg.ankle - leg.hip) * plane.normal).sum(-1) / self._scale
            front = apply(leg.thigh, X)
            out = np.arctan2(sign * (front * plane.normal).sum(-1), (front * plane.forward).sum(-1))
            return np.stack([lift - other[:, THIGH], wide - width, out - toe_out], axis=-1)

        start = np.stack([other[:, THIGH], *np.zeros((2, len(hip)))], axis=-1)
        leg = posed(_solved(residual, start, "swing hip", plane, index))
        upper, lower = ankle_axes(sign)
        roll = fade * release.roll

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

    def _width(self, time: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """Ankle outward of its hip over leg length; one curve for stance and swing."""
        return -self.manners.inset - self.manners.sway * np.sin(2.0 * np.pi * time)

    def _list(self, time: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
        """How much higher the swing hip is, radians."""
        first, third = self.manners.list_size
        turn = 2.0 * np.pi * (time - 0.14)
        return -(first * np.cos(turn) + third * np.cos(3.0 * turn))

    def _legs(
        self,
        side: int,
        plane: _Plane,
        foot: StanceFoot,
        stance: _Leg,
        swing: _Leg,
        pelvis: Float[np.ndarray, "F 3 3"],
        middle: Float[np.ndarray, "F 3"],
        weights: Float[np.ndarray, "F S"],
    ) -> Legs:
        """Both legs by side, in the package's frame."""
        figure, count = self.figure, len(plane.time)
        order = (stance, swing) if side == 0 else (swing, stance)

        def both(values: list[np.ndarray]) -> np.ndarray:
            return ours(np.stack(values, axis=1))

        def corners(leg: _Leg) -> np.ndarray:
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

    def _angles(self, leg: _Leg, pelvis: Float[np.ndarray, "F 3 3"], sign: float) -> np.ndarray:
        """The seven joint angles of one leg; the hip's by decomposition, Z then X then Y."""
        turned = np.swapaxes(pelvis, 1, 2) @ leg.thigh
        # R = Rz(h0) Rx(-s h1) Ry(-s h2)
        first = np.arctan2(-turned[:, 0, 1], turned[:, 1, 1])
        second = -sign * np.arcsin(np.clip(turned[:, 2, 1], -1.0, 1.0))
        third = -sign * np.arctan2(-turned[:, 2, 0], turned[:, 2, 2])
        hips = [first, second, third]
        return np.stack([*hips, leg.bend, leg.ankles[:, 0], leg.ankles[:, 1], leg.toe], axis=-1)


def _minimum_jerk(u: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
    """From 0 to 1 with no speed and no acceleration at both ends."""
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def _solved(
    residual: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
    what: str,
    plane: _Plane,
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
