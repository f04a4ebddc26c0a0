"""Cycles to be mixed, on one skeleton, as logs about a common reference pose."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InfeasibleError, InvalidInputError, UnknownNameError
from gaitsmith.gait.learn import standing_feet
from gaitsmith.geometry.rotations import exp, inverse, log, multiply
from gaitsmith.style.align import Timing, mapped, phases, slots_over, timing_of
from gaitsmith.style.parts import parts_of
from gaitsmith.style.retarget import on_body, stride_by_feet

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.motion.skeleton import Skeleton

#: Radians from the reference beyond which a mix of rotations hangs on how it is taken.
AMBIGUOUS = 2.5
_ROUNDS, _STILL = 60, 1e-14


@dataclass(frozen=True, eq=False)
class Examples:
    """What is mixed: L cycles on one skeleton. Made by :func:`examples_of`.

    Attributes
    ----------
    names
        Of the examples, in order.
    cycles, timings
        Of the examples, all on the skeleton of ``body``.
    body
        Whose skeleton.
    reference
        ``(J, 4)`` the mean rotation of every joint over all key frames of all examples: logs are
        taken about it, and it is what a mix of weight 0 shows (the paper's mean of V).
    """

    names: tuple[str, ...]
    cycles: tuple[Cycle, ...]
    timings: tuple[Timing, ...]
    body: Body
    reference: Float[np.ndarray, "J 4"]

    @property
    def skeleton(self) -> Skeleton:
        """That all are on."""
        return self.cycles[0].skeleton

    @cached_property
    def parts(self) -> dict[str, tuple[int, ...]]:
        """Joints of each part."""
        return parts_of(self.skeleton)

    @property
    def strides(self) -> int:
        """Strides after which all close."""
        return max(cycle.strides for cycle in self.cycles)

    def index(self, name: str) -> int:
        """Which example is called ``name``; UnknownNameError if none is."""
        if name not in self.names:
            raise UnknownNameError("example", name, self.names)
        return self.names.index(name)

    @cached_property
    def keys(self) -> Float[np.ndarray, "L N J 3"]:
        """Logs of the key frames, radians: N is 8 a stride."""
        return np.stack([self._logs(j, self.key_phases(j)) for j in range(len(self.names))])

    @cached_property
    def heights(self) -> Float[np.ndarray, "L"]:
        """Height of the soles where they stand, meters: 0 where a cycle was learned."""
        return np.array([standing_feet(cycle).height for cycle in self.cycles])

    @cached_property
    def strides_by_feet(self) -> Float[np.ndarray, "L"]:
        """How far each gets by its feet, meters; see :func:`stride_by_feet`."""
        return np.array([stride_by_feet(cycle) for cycle in self.cycles])

    def key_phases(self, j: int) -> Float[np.ndarray, "N"]:
        """Stride phases of the key frames of example ``j``."""
        return slots_over(self.timings[j].slots, self.strides)

    def dense(
        self, j: int, slots: Float[np.ndarray, "8"], strides: int
    ) -> tuple[Float[np.ndarray, "K 3"], Float[np.ndarray, "K J 3"]]:
        """Center (meters) and logs of example ``j``, timed as a walk with ``slots``."""
        at = mapped(slots, self.timings[j].slots, phases(strides))
        center, turned = self.cycles[j].at(at)
        return center, self.logs(turned)

    def logs(self, rotations: Float[np.ndarray, "n J 4"]) -> Float[np.ndarray, "n J 3"]:
        """Rotation vectors from the reference, radians."""
        return log(multiply(inverse(self.reference), rotations))

    def rotations(self, logs: Float[np.ndarray, "n J 3"]) -> Float[np.ndarray, "n J 4"]:
        """The inverse."""
        return multiply(self.reference, exp(logs))

    def _logs(self, j: int, phase: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n J 3"]:
        return self.logs(self.cycles[j].at(phase)[1])

    @cached_property
    def widest(self) -> tuple[float, str]:
        """Largest log of any key frame, radians, and whose joint it is."""
        size = np.linalg.norm(self.keys, axis=-1).max(axis=1)
        j, joint = np.unravel_index(size.argmax(), size.shape)
        return float(size.max()), f"{self.skeleton.names[joint]} of {self.names[j]!r}"


def examples_of(
    cycles: Mapping[str, Cycle], body: Body, *, reference: Float[np.ndarray, "J 4"] | None = None
) -> Examples:
    """``cycles`` made ready to be mixed, on ``body``.

    Parameters
    ----------
    cycles
        By name, on any skeletons.
    body
        Whose walk the mix will be; cycles of other people are brought to it.
    reference
        That of other examples, which weights should mean the same with; else their own.

    Raises
    ------
    InvalidInputError
        If there are none.
    InfeasibleError
        If a cycle shows no legs, trunk or arms (names the roles missing), or running.
    """
    if not cycles:
        raise InvalidInputError("a mix needs at least one example")
    brought: list[Cycle] = []
    timings: list[Timing] = []
    for name, cycle in cycles.items():
        try:
            parts_of(cycle.skeleton)
            timings.append(timing_of(cycle))
            brought.append(on_body(cycle, body))
        except InfeasibleError as error:
            raise InfeasibleError(f"example {name!r}: {error}") from None
    if reference is not None:
        return Examples(tuple(cycles), tuple(brought), tuple(timings), body, reference)
    strides = max(cycle.strides for cycle in brought)
    keys = np.concatenate(
        [
            cycle.at(slots_over(timing.slots, strides))[1]
            for cycle, timing in zip(brought, timings, strict=True)
        ]
    )
    return Examples(tuple(cycles), tuple(brought), tuple(timings), body, karcher_mean(keys))


def karcher_mean(rotations: Float[np.ndarray, "n J 4"]) -> Float[np.ndarray, "J 4"]:
    """Rotation of every joint about which the logs average to nothing.

    Starts from the extrinsic mean (of q and -q alike) and steps by the mean log.
    """
    q = np.asarray(rotations)
    _, vectors = np.linalg.eigh(np.einsum("nja,njb->jab", q, q))
    mean = vectors[..., -1]
    mean = np.where(mean[:, 3:] < 0.0, -mean, mean)
    for _ in range(_ROUNDS):
        step = log(multiply(inverse(mean), q)).mean(axis=0)
        mean = multiply(mean, exp(step))
        mean = mean / np.linalg.norm(mean, axis=-1, keepdims=True)
        if np.abs(step).max() < _STILL:
            break
    return np.ascontiguousarray(mean)
