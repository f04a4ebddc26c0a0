"""What is laid over a sagittal step: pelvis, trunk, head and arms, relative to the heading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import SIDES
from gaitsmith.geometry.curves import smoothstep

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Bool, Float, Int

    from gaitsmith.body.body import Body
    from gaitsmith.plan.footsteps import PlannedStep
    from gaitsmith.walks.model import SagittalStep, StepRequest


@dataclass(frozen=True, eq=False)
class Overlay:
    """One step's worth.

    Attributes
    ----------
    sway
        ``(T,)`` the hips to the left, meters.
    pelvis
        ``(T, 3)`` rotation vector of the pelvis in the heading's frame.
    upper
        ``(T, U, 3)`` local rotation vectors, in the order of :func:`upper_joints`.
    """

    sway: Float[np.ndarray, "T"]
    pelvis: Float[np.ndarray, "T 3"]
    upper: Float[np.ndarray, "T U 3"]


class Overlayer(Protocol):
    """A way of carrying what is above the legs: by rule, or as a measured Cycle.

    Attributes
    ----------
    strides
        Strides after which it repeats, 1 or 2.
    """

    strides: int

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """The overlay of one step; joins that of the steps before and after."""
        ...


@runtime_checkable
class BatchOverlayer(Protocol):
    """An overlayer that lays many steps at once, which costs little more than one."""

    def many(
        self, body: Body, requests: Sequence[StepRequest], steps: Sequence[SagittalStep]
    ) -> list[Overlay]:
        """What one call for each gives."""
        ...


@runtime_checkable
class ArmedOverlayer(Protocol):
    """An overlayer that knows what its arms swing about."""

    def arms_middle(self, body: Body) -> Float[np.ndarray, "U 3"]:
        """Local rotation vectors in the middle of the swing; only those of arms count."""
        ...


def overlays(
    overlayer: Overlayer,
    body: Body,
    requests: Sequence[StepRequest],
    steps: Sequence[SagittalStep],
) -> list[Overlay]:
    """The overlay of every step, at once where ``overlayer`` can."""
    if isinstance(overlayer, BatchOverlayer):
        return overlayer.many(body, requests, steps)
    return [overlayer(body, r, s) for r, s in zip(requests, steps, strict=True)]


@dataclass(frozen=True, eq=False)
class Samples:
    """The samples of several requested steps one after the other.

    Attributes
    ----------
    counts
        ``(S,)`` samples of each step.
    phase, center, ankle
        ``(M,)``, ``(M, 2)``, ``(M, 2, 2)``: see :class:`~gaitsmith.walks.model.SagittalStep`.
    side, stride
        ``(M,)`` of each sample's step.
    starts, stops
        ``(M,)`` whether it starts from standing, ends in standing.
    """

    counts: Int[np.ndarray, "S"]
    phase: Float[np.ndarray, "M"]
    center: Float[np.ndarray, "M 2"]
    ankle: Float[np.ndarray, "M 2 2"]
    side: Int[np.ndarray, "M"]
    stride: Int[np.ndarray, "M"]
    starts: Bool[np.ndarray, "M"]
    stops: Bool[np.ndarray, "M"]

    @staticmethod
    def of(requests: Sequence[StepRequest], steps: Sequence[SagittalStep]) -> Samples:
        """Put them side by side."""
        counts = np.array([len(s.phase) for s in steps])
        kinds = [r.kind for r in requests]
        return Samples(
            counts=counts,
            phase=np.concatenate([s.phase for s in steps]),
            center=np.concatenate([s.center for s in steps]),
            ankle=np.concatenate([s.ankle for s in steps]),
            side=np.repeat([r.side for r in requests], counts),
            stride=np.repeat([r.stride for r in requests], counts),
            starts=np.repeat([k == "start" for k in kinds], counts),
            stops=np.repeat([k == "stop" for k in kinds], counts),
        )

    @property
    def eased(self) -> Float[np.ndarray, "M"]:
        """From 0 where a step begins to 1 where it ends, without speed at both."""
        return smoothstep(self.phase)

    def spread(self, values: Sequence[float]) -> Float[np.ndarray, "M"]:
        """One value a step, given to each of its samples."""
        return np.repeat(np.asarray(values, dtype=np.float64), self.counts)

    def lengths(
        self, requests: Sequence[StepRequest]
    ) -> tuple[Float[np.ndarray, "M"], Float[np.ndarray, "M"]]:
        """Lengths of the step before and of this one, 0 in standing, meters."""
        return (
            self.spread([0.0 if r.kind == "start" else r.previous_length for r in requests]),
            self.spread([0.0 if r.kind == "stop" else r.length for r in requests]),
        )

    def split(
        self,
        sway: Float[np.ndarray, "M"],
        pelvis: Float[np.ndarray, "M 3"],
        upper: Float[np.ndarray, "M U 3"],
    ) -> list[Overlay]:
        """The overlays of the steps."""
        ends = np.cumsum(self.counts)
        rows = [slice(int(e - n), int(e)) for e, n in zip(ends, self.counts, strict=True)]
        return [Overlay(sway=sway[r], pelvis=pelvis[r], upper=upper[r]) for r in rows]


def stride_of(step: PlannedStep) -> int:
    """Number of the stride that ``step`` belongs to; one begins with each left heel strike."""
    first = (step.index + step.stance.side) % 2  # side of the foot that the first step stands on
    return (step.index + first) // 2


def upper_joints(body: Body) -> tuple[str, ...]:
    """Names of the joints above the pelvis, in the order of ``Overlay.upper``."""
    arms = ("Shoulder", "UpperArm", "LowerArm", "Hand")
    return (
        *spine_names(body.spine_segments),
        "neck",
        "head",
        *(f"{side}{part}" for side in SIDES for part in arms),
    )
