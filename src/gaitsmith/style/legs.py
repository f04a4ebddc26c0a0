"""Weights for the components of the legs that leave the feet where the base has them.

[KN12] section 4.3. Legs mixed from other examples than the root slide and float. The paper looks
for weights of their components with which the standing feet are where the base sequence (the
root's weights for everything) puts them, Eq. 6. Its minimum is plain: the base's own weights,
whatever was asked for. So what is minimised here also holds the weights near the asked ones, and
the components of all examples may change, not only of those that were picked.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._checks import one_of
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import exp, multiply, rotate, to_matrix
from gaitsmith.geometry.threads import on_one_thread
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.style.align import mapped, slots_over
from gaitsmith.style.interpolation import periodic_cubic
from gaitsmith.style.mix import mixed_timing, part_weights
from gaitsmith.style.ranks import displacements, ranked
from gaitsmith.style.weights import vector

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float, Int

    from gaitsmith.style.components import Components
    from gaitsmith.style.examples import Examples
    from gaitsmith.style.weights import Mix

#: Pull of the weights to the asked ones, square meters per squared unit of weight: where feet are
#: compared at key frames, and where they are compared all through and swing as asked.
DAMPING = {"keys": 30e-4, "stance": 1e-4}
METHODS, FREE = ("optimized", "joint", "greedy"), ("all", "active")
INSTANTS = ("stance", "keys")
#: Instants of a stance at which feet are compared, and of a swing; how much less the way of a
#: swinging foot counts than the place of one that stands.
STANCE, SWING, SHAPE = 24, 12, 0.25
#: Key frames of a stride in which a foot bears, from its heel strike on: as it leaves it bears no
#: more. Where feet are compared all through, together they count as so many.
KEYS, LIKE = 6, 7
_ROUNDS, _STILL = 40, 1e-10


@dataclass(frozen=True, eq=False)
class LegWeights:
    """What was found.

    Attributes
    ----------
    weights
        ``left_leg`` and ``right_leg``: ``(L, Nc)`` for :func:`gaitsmith.style.mix.mixed`.
    before, after
        Of [left, right]: root mean square distance of ankles and toes from where the base has
        them while they stand, meters, with the asked and with the found weights.
    """

    weights: dict[str, Float[np.ndarray, "L Nc"]]
    before: tuple[float, float]
    after: tuple[float, float]


@on_one_thread
def leg_weights(
    examples: Examples,
    mix: Mix,
    components: Mapping[str, Components],
    *,
    method: str = "optimized",
    free: str = "all",
    at: str = "stance",
    damping: float | None = None,
) -> LegWeights:
    """Weights near those that ``mix`` has for the legs, with which feet stand as in the base.

    Parameters
    ----------
    method
        ``"optimized"`` is damped least squares with the exact Jacobian, ``"joint"`` conjugate
        gradients on all weights, ``"greedy"`` the paper's: one component after the other, by rank.
    free
        Weights of ``"all"`` examples, or of those ``"active"`` in root or legs. With these
        alone and no damping the result is the base's legs: nothing asked for is left.
    at
        Feet are compared at ``"keys"``, the paper's key frames, or all through the ``"stance"``.
    damping
        Pull to the asked weights, square meters per squared unit of weight; None: as usual for
        ``at``, 30 cm2 at the keys and 1 cm2 through the stance.

    Raises
    ------
    InvalidInputError
        If an argument makes no sense.

    Notes
    -----
    With no more than the two examples of an exchange free and no damping, all methods end at the
    base's own legs, the plain minimum of Eq. 6; ``free="all"`` has many more weights than feet
    have coordinates, and the nearest solution keeps what was asked for where feet do not bear.
    At key frames alone feet slide between them; the default compares them all through the stance
    and, with a small weight, lets the swinging foot go where the asked weights would take it.
    """
    one_of("method", method, METHODS)
    one_of("free", free, FREE)
    one_of("at", at, INSTANTS)
    damping = DAMPING[at] if damping is None else damping
    if not damping >= 0.0:
        raise InvalidInputError(f"damping must be 0 or more, got {damping!r}")
    given = part_weights(examples, mix, components)
    root = vector(mix.root, examples.names)
    weights, before, after = {}, [], []
    for side, name in enumerate(SIDES):
        part = f"{name}_leg"
        found = components[part]
        start = np.array(np.broadcast_to(_columns(given[part]), (len(root), len(found))))
        active = np.abs(start).sum(axis=1) + np.abs(root) > 0.0
        rows = np.flatnonzero(active) if free == "active" else np.arange(len(root))
        problem = _Feet(
            examples, mix, found, root, start, side, rows, damping, at_keys=at == "keys"
        )
        if method == "optimized":
            best = problem.least_squares()
        elif method == "joint":
            best = problem.gradients([np.arange(len(found))])
        else:
            displaced = displacements(examples, {part: found})[part]
            order = ranked(displaced, np.flatnonzero(active).tolist())
            best = problem.gradients([np.array([k]) for k in order])
        weights[part] = best
        before.append(problem.apart(start))
        after.append(problem.apart(best))
    return LegWeights(weights, (before[0], before[1]), (after[0], after[1]))


def _columns(weights: Float[np.ndarray, "L *Nc"]) -> Float[np.ndarray, "L c"]:
    return weights if weights.ndim == 2 else weights[:, None]


class _Feet:
    """One leg at instants in which its foot stands; the root as in the base.

    Its key frames differ from the base's by the components' weights, and what is between them by
    the periodic cubic through these differences: as :func:`gaitsmith.style.mix.mixed` leads them.
    """

    def __init__(
        self,
        examples: Examples,
        mix: Mix,
        found: Components,
        root: Float[np.ndarray, "L"],
        start: Float[np.ndarray, "L Nc"],
        side: int,
        rows: Int[np.ndarray, "l"],
        damping: float,
        *,
        at_keys: bool,
    ) -> None:
        self.found, self.start, self.rows, self.damping = found, start, rows, damping
        timing = mixed_timing(examples, mix)
        strike, off = timing.contacts[side, 0], timing.contacts[side, 3]
        if at_keys:  # the paper's
            at = timing.slots[(np.arange(KEYS) + 4 * side) % 8]
            weight = np.ones(KEYS)
        else:
            stance = np.linspace(strike, off, STANCE + 1)[:-1]
            u = (np.arange(SWING) + 1.0) / (SWING + 1.0)
            at = np.concatenate([stance, off + u * (strike + 1.0 - off)])
            # none where the swing begins and ends
            swing = SHAPE * np.sin(np.pi * u) ** 2 * np.sqrt(LIKE / SWING)
            weight = np.concatenate([np.full(STANCE, np.sqrt(LIKE / STANCE)), swing])
        self.stands = slice(0, KEYS if at_keys else STANCE)
        slots = slots_over(timing.slots, examples.strides)
        led = periodic_cubic(slots, float(examples.strides), at)
        self.values = found.keys @ led.T  # (L, Nc, n)
        self.root = root
        self.weight = np.tile(weight[:, None, None], (1, 2, 3))
        skeleton = examples.skeleton
        self.chain = [skeleton.index(f"{SIDES[side]}{b}") for b in ("UpperLeg", "LowerLeg", "Foot")]
        self.columns = [found.joints.index(joint) for joint in self.chain]
        toes = f"{SIDES[side]}Toes"
        tip = skeleton.offsets[skeleton.index(toes)] if toes in skeleton.names else np.zeros(3)
        self.bones = [skeleton.offsets[self.chain[1]], skeleton.offsets[self.chain[2]], tip]
        self.reference = examples.reference[self.chain]
        self.base = np.zeros((len(at), len(skeleton), 3))
        asked = np.zeros((len(at), len(found.joints), 3))
        for j, own in enumerate(examples.timings):
            if root[j] or start[j].any():
                turned = examples.cycles[j].at(mapped(timing.slots, own.slots, at))[1]
                logs = examples.logs(turned)
                self.base += root[j] * logs
                rows = (found.of(logs) * start[j]) @ found.mix.T + start[j].mean() * found.rest(
                    logs
                )
                asked += rows.reshape(asked.shape)
        turned = multiply(examples.reference, exp(self.base))
        places, world = forward_kinematics(skeleton, np.zeros((len(at), 3)), turned)
        self.hips, self.hip = world[:, 0], places[:, self.chain[0]]
        self.goal = self.points(self.base[:, self.chain])[0]
        if not at_keys:  # in swing the foot goes as asked
            self.goal[STANCE:] = self.points(asked[:, self.columns])[0][STANCE:]

    def points(
        self, logs: Float[np.ndarray, "n 3 3"]
    ) -> tuple[Float[np.ndarray, "n 2 3"], Float[np.ndarray, "n 3 3"], Float[np.ndarray, "n 3 4"]]:
        """Ankle and toes, and the joints' places and world rotations on the way."""
        local = multiply(self.reference, exp(logs))
        world, place = self.hips, self.hip
        joints, turns = [], []
        for i, bone in enumerate(self.bones):
            world = multiply(world, local[:, i])
            joints.append(place)
            turns.append(world)
            place = place + rotate(world, bone)
        return np.stack([joints[2], place], axis=1), np.stack(joints, 1), np.stack(turns, 1)

    def logs(self, weights: Float[np.ndarray, "L Nc"]) -> Float[np.ndarray, "n 3 3"]:
        """Logs of hip, knee and ankle."""
        away = np.einsum("jk,jkn->nk", weights - self.root[:, None], self.values)
        rows = (away @ self.found.mix.T).reshape(len(away), -1, 3)
        return self.base[:, self.chain] + rows[:, self.columns]

    def residual(self, weights: Float[np.ndarray, "L Nc"]) -> Float[np.ndarray, "r"]:
        """Ankle and toes from where the base has them, meters."""
        return (self.weight * (self.points(self.logs(weights))[0] - self.goal)).ravel()

    def apart(self, weights: Float[np.ndarray, "L Nc"]) -> float:
        """Root mean square distance, meters."""
        away = (self.points(self.logs(weights))[0] - self.goal)[self.stands]
        return float(np.sqrt((away**2).sum(-1).mean()))

    def jacobian(self, weights: Float[np.ndarray, "L Nc"]) -> Float[np.ndarray, "r l Nc"]:
        """Of the residual by the free weights.

        A change ``d`` of a joint's log turns what hangs on it by ``R J_r(v) d``, R the joint's
        world rotation and ``J_r`` the right Jacobian of the exponential map.
        """
        logs = self.logs(weights)
        ends, joints, turns = self.points(logs)
        turning = to_matrix(turns) @ right_jacobian(logs)  # (n, 3, 3, 3)
        arms = ends[:, :, None] - joints[:, None]  # (n, end, joint, 3)
        moves = -_cross_matrix(arms) @ turning[:, None]  # (n, end, joint, 3, 3)
        moves[:, 0, 2] = 0.0  # the ankle does not move with itself
        mix = self.found.mix.reshape(-1, 3, len(self.found))[self.columns]
        by_component = self.weight[..., None] * np.einsum("neixc,ick->nexk", moves, mix)
        values = self.values[self.rows]
        out = np.einsum("nexk,jkn->nexjk", by_component, values)
        return out.reshape(-1, len(self.rows), len(self.found))

    def cost(self, weights: Float[np.ndarray, "L Nc"]) -> float:
        """Eq. 6 and the pull to the asked weights, square meters."""
        away = weights - self.start
        return float((self.residual(weights) ** 2).sum() + self.damping * (away**2).sum())

    def least_squares(self) -> Float[np.ndarray, "L Nc"]:
        """Gauss-Newton: the weights nearest to the asked ones that meet the linear problem."""
        weights, rows = np.array(self.start), self.rows
        shape = (len(rows), len(self.found))
        cost = self.cost(weights)
        for _ in range(_ROUNDS):
            jacobian = self.jacobian(weights).reshape(self.goal.size, -1)
            away = (weights - self.start)[rows].ravel()
            wanted = jacobian @ away - self.residual(weights)
            if self.damping > 0.0:
                # fewer residuals than weights: the dual form is the small one
                inner = jacobian @ jacobian.T + self.damping * np.eye(len(wanted))
                step = jacobian.T @ np.linalg.solve(inner, wanted) - away
            else:
                step = np.linalg.lstsq(jacobian, wanted, rcond=1e-12)[0] - away
            length = 1.0
            while length > 1e-4:
                tried = np.array(weights)
                tried[rows] += length * step.reshape(shape)
                if (now := self.cost(tried)) < cost:
                    break
                length *= 0.5
            else:
                break
            done = np.abs(length * step).max() < _STILL
            weights, cost = tried, now
            if done:
                break
        return weights

    def gradients(self, blocks: list[Int[np.ndarray, "k"]]) -> Float[np.ndarray, "L Nc"]:
        """Conjugate gradients on the weights of one block of components after the other."""
        weights = np.array(self.start)
        for block in blocks:
            tried = self._descended(weights, block)
            if self.cost(tried) < self.cost(weights):
                weights = tried
        return weights

    def _descended(
        self, weights: Float[np.ndarray, "L Nc"], block: Int[np.ndarray, "k"]
    ) -> Float[np.ndarray, "L Nc"]:
        from scipy.optimize import minimize  # late: walking needs no SciPy

        place = np.ix_(self.rows, block)

        def put(x: Float[np.ndarray, "m"]) -> Float[np.ndarray, "L Nc"]:
            tried = np.array(weights)
            tried[place] = x.reshape(len(self.rows), -1)
            return tried

        def value(x: Float[np.ndarray, "m"]) -> tuple[float, Float[np.ndarray, "m"]]:
            tried = put(x)
            jacobian = self.jacobian(tried)[:, :, block]
            slope = 2.0 * np.tensordot(self.residual(tried), jacobian, 1)
            slope += 2.0 * self.damping * (tried - self.start)[place]
            return self.cost(tried), slope.ravel()

        found: Any = minimize(value, weights[place].ravel(), method="CG", jac=True)
        return put(found.x)


def right_jacobian(logs: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3 3"]:
    """``J`` with ``exp(v + d) = exp(v) exp(J d)`` to first order in ``d``."""
    square = (logs**2).sum(-1)[..., None, None]
    small = square < 1e-8
    safe = np.where(small, 1.0, square)
    angle = np.sqrt(safe)
    first = np.where(small, 0.5 - square / 24.0, (1.0 - np.cos(angle)) / safe)
    second = np.where(small, 1.0 / 6.0 - square / 120.0, (angle - np.sin(angle)) / (safe * angle))
    cross = _cross_matrix(logs)
    return np.eye(3) - first * cross + second * (cross @ cross)


def _cross_matrix(v: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3 3"]:
    out = np.zeros((*v.shape, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return out - np.swapaxes(out, -1, -2)
