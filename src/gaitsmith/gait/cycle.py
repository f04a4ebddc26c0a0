"""One closed stride of the whole body: the currency of style."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith._checks import frozen_array, positive
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.curves import hermite
from gaitsmith.geometry.rotations import sign_continuous
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from jaxtyping import Float

#: Events of one foot, in the order of ``Cycle.events``.
EVENTS = ("heel_strike", "foot_flat", "heel_off", "toe_off")


@dataclass(frozen=True, eq=False)
class Cycle:
    """A straight, level stride from left heel strike to left heel strike that closes on itself.

    Sample ``k`` of K is at ``stride_phase = k / K`` (times ``strides``); the sample after the
    last is the first, one loop ahead. The walk heads along +Z.

    Attributes
    ----------
    skeleton
        Whose stride it is; VRM humanoid names.
    center
        ``(K, 3)`` root minus uniform travel along +Z: sway, height, and what it runs ahead or
        behind, meters.
    rotations
        ``(K, J, 4)`` local unit quaternions xyzw, the heading taken out of the root's.
    events
        ``(2, 4)`` stride phases in [0, 1) of [left, right] x :data:`EVENTS`; the left heel
        strike is 0.
    stride_length, duration
        Meters and seconds of the stride.
    strides
        Strides after which the loop closes: 2 where the arms do not repeat with the legs, which
        always do; the stride phase then runs from 0 to 2.
    source, license
        Where it comes from and what may be done with it.
    """

    skeleton: Skeleton
    center: Float[np.ndarray, "K 3"]
    rotations: Float[np.ndarray, "K joints 4"]
    events: Float[np.ndarray, "2 4"]
    stride_length: float
    duration: float
    strides: int = 1
    source: str = ""
    license: str = ""

    def __post_init__(self) -> None:
        """Copy, check and freeze; signs of quaternions are made continuous."""
        count, joints = len(self.center), len(self.skeleton)
        if count < 4:
            raise InvalidInputError(f"a cycle needs at least 4 samples, got {count}")
        rotations = frozen_array("rotations", self.rotations, (count, joints, 4))
        norm = np.linalg.norm(rotations, axis=-1)
        if np.abs(norm - 1.0).max() > 1e-6:
            raise InvalidInputError("rotations of a cycle must be unit quaternions")
        rotations = frozen_array("rotations", sign_continuous(rotations), (count, joints, 4))
        events = frozen_array("events", self.events, (2, 4))
        if events[0, 0] != 0.0 or (events < 0.0).any() or (events >= 1.0).any():
            raise InvalidInputError("events must be stride phases in [0, 1), the first of them 0")
        since = (events - events[:, :1]) % 1.0
        if (np.diff(since, axis=1) <= 0.0).any():
            raise InvalidInputError(
                "events of a foot must follow each other: heel strike, foot flat, heel off, toe off"
            )
        if self.strides not in (1, 2):
            raise InvalidInputError(f"strides of a cycle must be 1 or 2, got {self.strides!r}")
        object.__setattr__(self, "center", frozen_array("center", self.center, (count, 3)))
        object.__setattr__(self, "rotations", rotations)
        object.__setattr__(self, "events", events)
        for name, unit in (("stride_length", "meters"), ("duration", "seconds")):
            object.__setattr__(self, name, positive(name, getattr(self, name), unit))

    def with_(self, **changes: object) -> Cycle:
        """Copy with some fields replaced; the copy is checked again."""
        return replace(self, **changes)  # type: ignore[arg-type]

    @property
    def speed(self) -> float:
        """Meters per second."""
        return self.stride_length / self.duration

    @cached_property
    def legs(self) -> Cycle:
        """The same with those joints alone that carry a sole: enough for who asks for feet."""
        skeleton = self.skeleton
        if skeleton.soles is None:
            return self
        carry = {joint for foot in skeleton.sole_joints for joint in foot}
        for joint in range(len(skeleton) - 1, 0, -1):  # parents come first
            if joint in carry:
                carry.add(skeleton.parents[joint])
        kept = sorted(carry)
        if len(kept) == len(skeleton):
            return self
        return self.with_(
            skeleton=Skeleton(
                names=tuple(skeleton.names[j] for j in kept),
                parents=(-1, *(kept.index(skeleton.parents[j]) for j in kept[1:])),
                offsets=skeleton.offsets[kept],
                soles=skeleton.soles,
            ),
            rotations=self.rotations[:, kept],
        )

    def at(
        self, stride_phase: Float[np.ndarray, "n"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n joints 4"]]:
        """Center offset (meters) and local rotations at any stride phases; period ``strides``.

        Periodic cubic through the samples; exact at them.
        """
        grid, table, slopes = self._table
        joints = len(self.skeleton)
        share = np.asarray(stride_phase, dtype=np.float64) / self.strides
        values = hermite(grid, table, slopes, share % 1.0)
        # each component contiguous: those who read it work on them one by one
        turned = np.ascontiguousarray(values.T)[3:].reshape(joints, 4, -1)
        x, y, z, w = turned.transpose(1, 0, 2)
        turned /= np.sqrt(x * x + y * y + z * z + w * w)[:, None]
        return values[:, :3], turned.transpose(2, 0, 1)

    @cached_property
    def feet(self) -> tuple[Float[np.ndarray, "n 2 3"], Float[np.ndarray, "n 2 3 3"]]:
        """Ankles and sole points of [left, right] at the samples of one stride, less the travel."""
        legs = self.legs
        count = len(self.center) // self.strides
        center, turned = legs.at(np.arange(count) / count)
        places, world = forward_kinematics(legs.skeleton, center, turned)
        ankles = np.stack([places[:, legs.skeleton.index(f"{s}Foot")] for s in SIDES], axis=1)
        return ankles, sole_positions(legs.skeleton, places, world)

    @cached_property
    def _table(
        self,
    ) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n c"], Float[np.ndarray, "n c"]]:
        """Loop phases, center and rotations there, and their slopes."""
        count = len(self.center)
        ends = np.where((self.rotations[-1] * self.rotations[0]).sum(-1) < 0.0, -1.0, 1.0)
        # two samples of the neighboring strides on both sides give the slopes at the seam
        before = self.rotations[-2:] * ends[:, None]
        after = self.rotations[:3] * ends[:, None]
        quats = np.concatenate([before, self.rotations, after]).reshape(count + 5, -1)
        center = np.concatenate([self.center[-2:], self.center, self.center[:3]])
        table = np.concatenate([center, quats], axis=1)
        grid = np.arange(-2, count + 3) / count
        return grid, table, np.gradient(table, 1.0 / count, axis=0)
