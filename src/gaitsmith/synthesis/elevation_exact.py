"""ElevWalker of [SM01]: legs whose silhouette is the data's, along any heading.

Mode `exact`: the paper's walker, mended where it would pop (docs/papers/sm01.md). One step at a
time, all its instants at once. Its trailing foot is driven by data alone, so its toes cut the
ground after a swap; the product's walker has the contact stage instead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gaitsmith._checks import frozen_array
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.geometry.curves import minimum_jerk
from gaitsmith.synthesis.exact_figure import ExactFigure, X, Y, Z, about, apply, sagittal
from gaitsmith.synthesis.exact_foot import Landing, land, stand
from gaitsmith.synthesis.exact_legs import Legs, LegSolver, Manners, Plane, Release
from gaitsmith.walks.elevation import FOOT, PELVIS
from gaitsmith.walks.interpolate import ElevInterp

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.ground import Slope
    from gaitsmith.walks.elevation import ElevationSet

#: Phase of the stride at which new weights are reached.
_SETTLED = 0.46
#: How often a landing is aimed again until it is so near (m), and what of it is a miss.
_AIMS, _AIMED, _MISSED = 8, 1e-6, 1e-4


class _State(NamedTuple):
    """What one step leaves to the next; ``bias`` is what its landing missed the planar f by."""

    landing: Landing
    release: Release
    weights: Float[np.ndarray, "S"]
    bias: Float[np.ndarray, "2"]


class ExactWalker:
    """Walks elevation data on a plane, [SM01] section 4.

    Parameters
    ----------
    sets
        What is walked; their pelvis angles are fitted to ``body``. Of three and more, steps of
        any length are mixed ([SM01] section 5).
    body
        Who walks.
    manners
        What the data do not say.
    ground
        Level through the origin, or a slope.
    """

    def __init__(
        self,
        sets: Sequence[ElevationSet],
        body: Body,
        manners: Manners | None = None,
        *,
        ground: Slope | None = None,
    ) -> None:
        self.sets = tuple(s.for_body(body) for s in sets)
        self.figure = ExactFigure.of(body)
        self.manners = Manners() if manners is None else manners
        rho = 0.0 if ground is None else np.radians(ground.deg)
        self._up = np.array([-np.sin(rho), np.cos(rho), 0.0])
        self._solver = LegSolver(self.figure, self.manners, self._up)
        self._mixer = ElevInterp(sets, body) if len(self.sets) > 2 else None

    def data(
        self, weights: Float[np.ndarray, "F S"], time: Float[np.ndarray, "F"]
    ) -> Float[np.ndarray, "F 4"]:
        """Elevations at phases ``time`` of a leg's own stride, of mixes, [SM01] Eq. 9.

        The foot's count from the slope that the mixed data are of, as if that were level: where
        they lay it flat, it lies on whatever ground there is.
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
        """The state at a left heel strike of a walk that has gone on for some steps."""
        weights = np.eye(len(self.sets))[0]
        pitch = float(self.sets[0].angles[0, FOOT]) - 0.5 * np.pi
        turned = about(Y, np.array(heading)) @ about(Y, np.array(self.manners.toe_out))
        axis = sagittal(np.array(heading))[1]
        turned = about(axis, np.array(pitch)) @ turned
        at = -(turned @ self.figure.sole[0])
        landing = land(self.figure, turned, at, heading, self._up, pitch)
        release = Release(self.manners.toe_out, 0.0, 0.0, sagittal(np.array(heading))[0])
        state = _State(landing, release, weights, np.zeros(2))
        time = np.array([0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
        for index in range(4):
            state, target = self._aimed(index, heading, state, length)
            _, state = self._step(index, time, np.full(len(time), heading), state, target)
        shift = state.landing.places[0] * (X + Z)
        shift = shift - (shift @ self._up) / self._up[1] * Y
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
        front = sagittal(np.array(heading))[0]
        rise = -length * float(front @ self._up) / float(self._up[1])
        wanted, end = np.array([length, rise]), np.array([0.5])
        bias = state.bias
        aimed, weights, missed = state, state.weights, np.zeros(2)
        for _ in range(_AIMS):
            weights = self._mixer.find((wanted + bias)[None]).weights[0]
            aimed = state._replace(bias=bias)
            _, after = self._step(index, end, np.array([heading]), aimed, weights)
            way = after.landing.lies(self.figure) - state.landing.lies(self.figure)
            missed = np.array([length - way @ front, -after.landing.gap])
            if np.abs(missed).max() < _AIMED:
                break
            bias = bias + missed
        else:
            if np.abs(missed).max() > _MISSED:
                raise InfeasibleError(
                    f"step {index + 1}: the elevation data take no step of {length:g} m that rises "
                    f"by {rise:.3f} m on this body; the nearest is {length - missed[0]:.3f} m and "
                    f"{rise - missed[1]:.3f} m"
                )
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
        moved = minimum_jerk(time / _SETTLED)[:, None]
        weights = state.weights + moved * (target - state.weights)
        own, other = self.data(weights, time), self.data(weights, time + 0.5)
        plane = Plane(time, heading, *sagittal(heading))
        sign = 2.0 * side - 1.0
        foot = stand(self.figure, state.landing, own[:, FOOT], heading, time)
        stance = self._solver.stance_leg(plane, foot, own, sign, index)
        pelvis = self._solver.pelvis(plane, own[:, PELVIS], other[:, PELVIS], sign, index)
        half = self.figure.half_hips * Z
        middle = stance.hip - apply(pelvis, sign * half)
        hip = middle - apply(pelvis, sign * half)
        raised = other[:, FOOT].copy()
        other[:, FOOT] += self._solver.slope_under(plane, state.release)
        swing = self._solver.swing_leg(plane, pelvis, hip, other, -sign, state.release, index)
        legs = self._solver.legs(side, plane, foot, stance, swing, pelvis, middle, weights)
        landed = land(
            self.figure,
            swing.foot[-1],
            swing.ankle[-1],
            float(heading[-1]),
            self._up,
            float(raised[-1]) - 0.5 * np.pi,
        )
        front, normal = plane.forward[-1], plane.normal[-1]
        out = stance.thigh[-1] @ X
        leaving = Release(
            float(np.arctan2(sign * (out @ normal), out @ front)),
            float((stance.foot[-1] @ Y) @ normal),
            float(foot.toe[-1]),
            state.landing.flat @ X,
        )
        return legs, _State(landed, leaving, target, state.bias)
