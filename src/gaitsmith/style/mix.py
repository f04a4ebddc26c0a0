"""Several cycles mixed into one, by weights for the root and for every part [KN12] section 4.1.

The ``"dense"`` engine mixes logs at every instant; the paper's ``"keys"`` mixes eight key
frames and adds the details between them as offsets. Both are the same linear mix of logs
about the mean pose, up to how details are added (``docs/papers/kn12.md``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.gait.cycle import Cycle
from gaitsmith.gait.learn import standing_feet, symmetrized
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.style.align import Timing, mapped, phases, slots_over
from gaitsmith.style.examples import AMBIGUOUS
from gaitsmith.style.hanging import with_hanging_arms
from gaitsmith.style.interpolation import periodic_cubic, periodic_linear, periodic_slerp
from gaitsmith.style.parts import PARTS
from gaitsmith.style.retarget import stride_by_feet
from gaitsmith.style.weights import SENSIBLE, vector

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float

    from gaitsmith.gait.learn import Standing
    from gaitsmith.style.components import Components
    from gaitsmith.style.examples import Examples
    from gaitsmith.style.weights import Mix

    #: Weights of one part: a number for each example, or one for each example and component.
    PartWeights = Float[np.ndarray, "L"] | Float[np.ndarray, "L Nc"]

#: Steps a second of people who walk.
SLOWEST_STEPS, FASTEST_STEPS = 0.8, 2.6
#: How far a leg with found weights goes over to the asked weights in the middle of its swing, where
#: no contact hangs on it.
SWINGS = 0.8


@dataclass(frozen=True, eq=False)
class Mixed:
    """A new cycle.

    Attributes
    ----------
    cycle
        On the examples' skeleton; closed.
    timing
        Of its feet: the mean of the examples' by the weights of the root.
    feet
        How they stand in it.
    notes
        What was changed or should be looked at.
    """

    cycle: Cycle
    timing: Timing
    feet: Standing
    notes: tuple[str, ...]


def mixed(
    examples: Examples,
    mix: Mix,
    components: Mapping[str, Components] | None = None,
    *,
    legs: Mapping[str, PartWeights] | None = None,
) -> Mixed:
    """The walk that ``mix`` makes of ``examples``.

    Parameters
    ----------
    examples
        From :func:`gaitsmith.style.examples.examples_of`.
    mix
        The weights.
    components
        From :func:`gaitsmith.style.components.decompose`: needed for weights by component, and
        taken by the engine ``"keys"``.
    legs
        Weights of ``left_leg`` and ``right_leg`` instead of the given ones: what
        :func:`gaitsmith.style.legs.leg_weights` found.

    Raises
    ------
    InvalidInputError
        If a weight is of an unknown example, or by component without ``components``.
    InfeasibleError
        If the result does not walk: feet out of order, or no way gained.
    """
    weights = part_weights(examples, mix, components)
    notes = list(_unusual(examples, mix))
    timing = mixed_timing(examples, mix)
    strides = _strides(examples, mix, weights)
    frame = _Frame(examples, mix, timing, strides, components, weights, dict(legs or {}))
    if mix.engine == "dense":
        center, turned = frame.dense()
        turned = with_hanging_arms(examples, frame.root, weights, turned)
    else:
        center, turned = frame.keyed()
    return _walking(examples, mix, timing, strides, center, turned, notes)


def part_weights(
    examples: Examples, mix: Mix, components: Mapping[str, Components] | None = None
) -> dict[str, PartWeights]:
    """Weights of every part in the order of the examples; the root's where none are given."""
    for name in mix.named:
        examples.index(name)
    out: dict[str, PartWeights] = {}
    for part in PARTS:
        given = mix.part(part)
        table = mix.root if given is None else given.weights
        if not any(isinstance(v, tuple | list) for v in table.values()):
            out[part] = vector(table, examples.names)  # type: ignore[arg-type]
            continue
        if components is None:
            raise InvalidInputError(
                f"{part} has weights by component, but nothing was decomposed: give one weight "
                "for each example, or more than one example"
            )
        count = len(components[part])
        rows = np.zeros((len(examples.names), count))
        for name, value in table.items():
            if isinstance(value, tuple | list) and len(value) != count:
                raise InvalidInputError(
                    f"{part} has {count} components, but {name!r} has {len(value)} weights there"
                )
            rows[examples.index(name)] = value
        out[part] = rows
    return out


def mixed_timing(examples: Examples, mix: Mix) -> Timing:
    """Contacts and slots averaged by the weights of the root, which are made to sum to 1."""
    shares = mix.shares(examples.names)
    contacts = np.tensordot(shares, [t.contacts for t in examples.timings], 1)
    slots = shares @ np.array([t.slots for t in examples.timings])
    contacts[0, 0] = slots[0] = 0.0
    out = Timing(contacts, slots)
    if not out.ordered:
        raise InfeasibleError(
            "with these weights of root the feet would not land and leave in order; take "
            "weights nearer to 0..1"
        )
    return out


def _strides(examples: Examples, mix: Mix, weights: Mapping[str, PartWeights]) -> int:
    """Two only where an example of two strides has a say."""
    used = np.abs(vector(mix.root, examples.names))
    for values in weights.values():
        used = used + np.abs(values.reshape(len(used), -1)).sum(axis=1)
    if mix.offsets:
        used = used + np.abs(vector(mix.offsets, examples.names))
    return max(c.strides for c, u in zip(examples.cycles, used, strict=True) if u > 0.0)


def _unusual(examples: Examples, mix: Mix) -> list[str]:
    least, most = SENSIBLE
    notes = [
        f"weights of {where} sum to {total:.2f}: outside {least:g} to {most:g} walks are unlike "
        "any example"
        for where, total in mix.sums().items()
        if not least <= total <= most
    ]
    widest, whose = examples.widest
    if widest > AMBIGUOUS:
        notes.append(
            f"{whose} is {np.degrees(widest):.0f} deg from the mean of all: there a mix is "
            "ambiguous"
        )
    return notes


@dataclass(eq=False)
class _Frame:
    """One mix, on its own phases."""

    examples: Examples
    mix: Mix
    timing: Timing
    strides: int
    components: Mapping[str, Components] | None
    weights: Mapping[str, PartWeights]
    legs: Mapping[str, PartWeights]

    def __post_init__(self) -> None:
        names = self.examples.names
        self.root = vector(self.mix.root, names)
        self.shares = self.mix.shares(names)
        given = self.mix.offsets
        self.offsets = None if given is None else vector(given, names)
        self.phase = phases(self.strides)
        self.scale = {
            part: 1.0 if (given := self.mix.part(part)) is None else float(given.offset_scale)
            for part in PARTS
        }
        used = np.abs(self.root) + (0.0 if self.offsets is None else np.abs(self.offsets))
        for values in (*self.weights.values(), *self.legs.values()):
            used = used + np.abs(values.reshape(len(used), -1)).sum(axis=1)
        # the base's legs, from which those with found weights differ
        self.asked = self.weights
        self.weights = dict(self.weights) | dict.fromkeys(self.legs, self.root)
        self.used = [int(j) for j in np.flatnonzero(used > 0.0)]

    def dense(self) -> tuple[Float[np.ndarray, "K 3"], Float[np.ndarray, "K J 4"]]:
        """Whole strides; details apart only where they have weights or scales of their own."""
        examples = self.examples
        seen = {j: examples.dense(j, self.timing.slots, self.strides) for j in self.used}
        logs = np.zeros((len(self.phase), len(examples.skeleton), 3))
        split = self.offsets is not None or any(s != 1.0 for s in self.scale.values())
        # (K, N): the smooth walk through an example's key frames
        smooth = self._smooth_matrix() if split or self.legs else None
        rows = self.root if self.offsets is None else self.offsets
        for j, (_, values) in seen.items():
            whole, detail = values, np.zeros_like(values)
            if split and smooth is not None:
                flat = self._keys_of(j).reshape(smooth.shape[1], -1)
                whole = (smooth @ flat).reshape(values.shape)
                detail = values - whole
            logs[:, 0] += self.root[j] * whole[:, 0] + rows[j] * detail[:, 0]
            for part, joints in examples.parts.items():
                own = self.offsets is None and part not in self.legs
                logs[:, joints] += self._weighed(part, j, whole)
                details = self._weighed(part, j, detail) if own else rows[j] * detail[:, joints]
                logs[:, joints] += self.scale[part] * details
        for part, joints in examples.parts.items():
            if part in self.legs and smooth is not None:
                logs[:, joints] += self._led(part, smooth)
                asked = sum(
                    self._weighed(part, j, v, self.asked[part]) for j, (_, v) in seen.items()
                )
                share = SWINGS * self._swinging(part)[:, None, None]
                logs[:, joints] += share * (asked - logs[:, joints])
        center = self._center({j: center for j, (center, _) in seen.items()}, smooth)
        return center, examples.rotations(logs)

    def _swinging(self, part: str) -> Float[np.ndarray, "K"]:
        """0 while the leg bears, smoothly 1 in the middle of its swing."""
        strike, _, _, off = self.timing.contacts[int(part == "right_leg")]
        u = (self.phase - off) % 1.0 / (strike + 1.0 - off)
        return np.where(u < 1.0, np.sin(np.pi * np.minimum(u, 1.0)) ** 2, 0.0)

    def _led(self, part: str, smooth: Float[np.ndarray, "K N"]) -> Float[np.ndarray, "K P 3"]:
        """How the key frames of a leg with found weights differ from the base's, smoothly led on.

        Weights that were found at key frames know nothing of what is between them.
        """
        joints = list(self.examples.parts[part])
        away = np.zeros((smooth.shape[1], len(joints), 3))
        for j in self.used:
            keys = self._keys_of(j)
            away += self._weighed(part, j, keys, self.legs[part])
            away -= self.root[j] * keys[:, joints]
        return (smooth @ away.reshape(len(away), -1)).reshape(len(smooth), len(joints), 3)

    def keyed(self) -> tuple[Float[np.ndarray, "K 3"], Float[np.ndarray, "K J 4"]]:
        """Eight key frames, joined, and offsets about the reconstructed ones [KN12] Eqs. 1, 4."""
        examples = self.examples
        rows = self.root if self.offsets is None else self.offsets
        keys = sum(
            (self._part_keys(j) for j in self.used),
            start=np.zeros((8 * self.strides, len(examples.skeleton), 3)),
        )
        period = float(self.strides)
        base = self._joined(keys, slots_over(self.timing.slots, self.strides), period, self.phase)
        scale = np.ones(len(examples.skeleton))
        for part, joints in examples.parts.items():
            scale[list(joints)] = self.scale[part]
        added = np.zeros((len(self.phase), len(examples.skeleton), 3))
        centers = {}
        for j in self.used:
            own = mapped(self.timing.slots, examples.timings[j].slots, self.phase)
            centers[j], turned = examples.cycles[j].at(own)
            if not rows[j]:
                continue
            knots = slots_over(examples.timings[j].slots, self.strides)
            smooth = self._joined(self._rebuilt(j), knots, period, own)
            offset = log(multiply(inverse(smooth), turned))
            added += rows[j] * offset
        turned = multiply(base, exp(scale[:, None] * added))
        return self._center(centers, self._smooth_matrix()), turned

    def _weighed(
        self,
        part: str,
        j: int,
        logs: Float[np.ndarray, "n J 3"],
        weights: PartWeights | None = None,
    ) -> Float[np.ndarray, "n P 3"]:
        """Logs of a part of example ``j`` by its weight, or its components' weights."""
        weights = self.weights[part] if weights is None else weights
        weight, joints = weights[j], list(self.examples.parts[part])
        if np.ndim(weight) == 0:
            return weight * logs[:, joints]
        assert self.components is not None
        found = self.components[part]
        # what no component holds goes with their mean
        rows = (found.of(logs) * weight) @ found.mix.T + weight.mean() * found.rest(logs)
        return rows.reshape(len(logs), len(joints), 3)

    def _keys_of(self, j: int) -> Float[np.ndarray, "N J 3"]:
        return self.examples.keys[j, : 8 * self.strides]

    def _rebuilt(self, j: int) -> Float[np.ndarray, "N J 3"]:
        """Key frames as their components show them."""
        keys = self._keys_of(j)
        if self.components is None:
            return keys
        keys = np.array(keys)
        for part, joints in self.examples.parts.items():
            found = self.components[part]
            keys[:, joints] = found.logs(found.of(keys))
        return keys

    def _part_keys(self, j: int) -> Float[np.ndarray, "N J 3"]:
        """Key frames of an example by the weights of root and parts."""
        keys = self._rebuilt(j)
        out = np.empty_like(keys)
        out[:, 0] = self.root[j] * keys[:, 0]
        for part, joints in self.examples.parts.items():
            out[:, joints] = self._weighed(part, j, keys, self.legs.get(part))
        return out

    def _joined(
        self,
        keys: Float[np.ndarray, "N J 3"],
        knots: Float[np.ndarray, "N"],
        period: float,
        at: Float[np.ndarray, "K"],
    ) -> Float[np.ndarray, "K J 4"]:
        if self.mix.base == "slerp":
            return periodic_slerp(self.examples.rotations(keys), knots, period, at)
        matrix = periodic_cubic(knots, period, at)
        logs = (matrix @ keys.reshape(len(knots), -1)).reshape(len(at), -1, 3)
        return self.examples.rotations(logs)

    def _smooth_matrix(self) -> Float[np.ndarray, "K N"]:
        knots = slots_over(self.timing.slots, self.strides)
        through = periodic_linear if self.mix.base == "slerp" else periodic_cubic
        return through(knots, float(self.strides), self.phase)

    def _center(
        self,
        centers: Mapping[int, Float[np.ndarray, "K 3"]],
        smooth: Float[np.ndarray, "K N"] | None,
    ) -> Float[np.ndarray, "K 3"]:
        """Where the root is: excursions by weight, mean heights by share."""
        out = np.zeros((len(self.phase), 3))
        for j in self.used:
            cycle = self.examples.cycles[j]
            mean = np.array([0.0, cycle.center[:, 1].mean(), 0.0])
            away = centers[j] - mean
            whole = away
            if smooth is not None and self.offsets is not None:
                knots = slots_over(self.examples.timings[j].slots, self.strides)
                whole = smooth @ (cycle.at(knots)[0] - mean)
            rows = self.root if self.offsets is None else self.offsets
            out += self.shares[j] * mean + self.root[j] * whole + rows[j] * (away - whole)
        return out


def _walking(
    examples: Examples,
    mix: Mix,
    timing: Timing,
    strides: int,
    center: Float[np.ndarray, "K 3"],
    turned: Float[np.ndarray, "K J 4"],
    notes: list[str],
) -> Mixed:
    """The poses as a cycle: its stride by the feet, its time by the speed, on the ground."""
    shares = mix.shares(examples.names)
    cycle = Cycle(
        skeleton=examples.skeleton,
        center=center,
        rotations=turned / np.linalg.norm(turned, axis=-1, keepdims=True),
        events=timing.events,
        stride_length=1.0,
        duration=1.0,
        strides=strides,
    )
    if mix.symmetric:
        cycle = symmetrized(cycle)
    by_feet = stride_by_feet(cycle)
    usual = float(shares @ examples.strides_by_feet)
    length = float(shares @ [c.stride_length for c in examples.cycles]) * by_feet / usual
    if not length > 0.1 * usual > 0.0:
        raise InfeasibleError(
            f"with these weights the feet would get {length:.2f} m ahead in a stride; give the "
            "legs weights that sum to more, or the same as the root"
        )
    speed = mix.speed
    if speed is None:
        speed = float(shares @ [c.speed for c in examples.cycles])
    duration = length / speed
    steps = 2.0 / duration
    if not SLOWEST_STEPS <= steps <= FASTEST_STEPS:
        kept = min(max(steps, SLOWEST_STEPS), FASTEST_STEPS)
        duration = 2.0 / kept
        notes.append(
            f"{speed:.2f} m/s with strides of {length:.2f} m would be {steps:.2f} steps/s: people "
            f"take {SLOWEST_STEPS:g} to {FASTEST_STEPS:g}, so it walks at "
            f"{length / duration:.2f} m/s"
        )
    feet = standing_feet(cycle, stride_length=length)
    lift = np.array([0.0, float(shares @ examples.heights) - feet.height, 0.0])
    cycle = cycle.with_(center=cycle.center + lift, stride_length=length, duration=duration)
    return Mixed(cycle, timing, feet.moved(lift), tuple(notes))
