"""The upper body of a measured Cycle, read by phase and side and laid over any walk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import SIDES
from gaitsmith.gait.posture import mean_rotation, trunk_names
from gaitsmith.geometry.curves import hermite
from gaitsmith.geometry.rotations import IDENTITY, about, exp, inverse, log, multiply, rotate
from gaitsmith.synthesis.overlay import Overlay, Samples, upper_joints
from gaitsmith.synthesis.upper_body import shifted_sway

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.walks.model import SagittalStep, StepRequest

    _Pair = tuple[Float[np.ndarray, "M"], Float[np.ndarray, "M"]]

#: How far the measured excursions may be scaled.
MOST = 1.7
#: Powers of the step length (leg lengths) and the cadence (equal Froude), both over the cycle's
#: own, with which an excursion grows. At the usual walk ratio both go with the root of the speed.
#: Pelvis: list 6.0, 8.2, 11.0 deg, rotation 6.9, 8.9, 12.8 deg at 0.69, 1, 1.33 of the free
#: speed (Schwartz 2008), list 12.9 deg per meter of step (CMU 07).
PELVIS = (1.0, 0.5)
#: Thorax in space: 9-14 deg at all natural paces, 15-20 deg with very long steps (CMU 07).
THORAX = (1.0, 0.0)
#: Upper arm: 17 deg at 0.9 m/s, 24 at 1.26, 42 at 1.65; 94 deg per meter of step (CMU 07). Hands
#: follow less swing, but never wag more than they were seen to.
ARMS = (1.5, 0.5)
#: Head in space: 2-5 deg at 0.9-1.65 m/s.
HEAD = (0.75, 0.25)
#: Lean of the trunk per unit of speed over the own one: 1.2 deg at 1.2, 4.5-5 at 1.65 m/s (CMU 02,
#: ACCAD); the pelvis tips half as far (Schwartz 2008: 1.7 deg from free to fast). None when slow.
LEAN, PELVIS_LEAN = float(np.radians(10.0)), 0.5
#: Elbows bend by this share of their mean more, per unit of speed over the own one.
ELBOW = 0.3
#: Sideways path per unit of speed over the own one: 7 cm at 0.7, 4 cm at 1.6 m/s (Orendurff 2004;
#: CMU 07: less), within these factors.
SWAY, SWAY_RANGE = -0.6, (0.7, 1.4)
#: Part of a stride by which the pelvis turns earlier per unit of speed over the own one, and at
#: most: pelvis and thorax turn nearly together when slow, against each other when fast (Lamoth
#: 2002).
EARLIER, EARLIEST = 0.35, 0.11
#: Where speed has these effects, units of speed over the own one.
FASTER = 0.6
#: Step length over the own one below which arms begin to hang, and arms that hang at all: their
#: mean is less than this from straight down.
HANG, HANGING = 0.5, float(np.radians(40.0))
#: Share of the mean elbow flexion that is gone in standing.
STRAIGHTER = 0.5
_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")


@dataclass(frozen=True)
class _Ends:
    """Step length and cadence over the cycle's own at both ends of the step of each sample."""

    length: _Pair
    cadence: _Pair
    ease: Float[np.ndarray, "M"]

    def between(self, values: Sequence[Float[np.ndarray, "M"]]) -> Float[np.ndarray, "M"]:
        """From the value at the begin to that at the end."""
        return values[0] + (values[1] - values[0]) * self.ease

    def size(self, powers: tuple[float, float]) -> Float[np.ndarray, "M"]:
        """Of an excursion that goes with these powers of length and cadence."""
        a, b = powers
        pairs = zip(self.length, self.cadence, strict=True)
        return self.between([np.minimum(e**a * c**b, MOST) for e, c in pairs])

    @property
    def speed(self) -> list[Float[np.ndarray, "M"]]:
        """Over the cycle's own, at both ends."""
        return [e * c for e, c in zip(self.length, self.cadence, strict=True)]

    @property
    def faster(self) -> Float[np.ndarray, "M"]:
        """Speed beyond the cycle's own, over it."""
        return self.between([np.clip(v - 1.0, 0.0, FASTER) for v in self.speed])

    @property
    def hanging(self) -> Float[np.ndarray, "M"]:
        """1 in standing, 0 in steps that are long enough to swing the arms."""
        return self.between([np.maximum(1.0 - e / HANG, 0.0) ** 2 for e in self.length])


class CycleOverlay:
    """Lays the pelvis, trunk, head and arms of ``cycle`` over the steps of any walk.

    At the cycle's own step length and cadence, on its own body, this is the cycle. Elsewhere every
    part keeps its mean posture and its excursion about it is scaled, as people's are: pelvis,
    thorax and head in space, so that a head stays level whatever the trunk below it does, arms
    against the thorax. In standing the arms hang.

    Parameters
    ----------
    cycle
        Whose upper body; of one or two strides.
    leg_length
        Thigh and shin of who was measured, meters.
    """

    def __init__(self, cycle: Cycle, leg_length: float) -> None:
        self._cycle, self.strides = cycle, cycle.strides
        self.cycle = cycle
        self._length = 0.5 * cycle.stride_length / leg_length
        self._duration = 0.5 * cycle.duration / np.sqrt(leg_length)
        index, q = cycle.skeleton.index, cycle.rotations
        left, right = (cycle.skeleton.offsets[index(f"{s}UpperLeg"), 0] for s in SIDES)
        self._hip_width = float(left - right)
        self._trunk = trunk_names(cycle)
        self._pelvis = mean_rotation(q[:, index("hips")])
        chest, head = self._in_space(q)
        self._chest, self._head = mean_rotation(chest), mean_rotation(head)
        turn = log(multiply(inverse(self._pelvis), q[:, index("hips")]))[:, 1]
        self._turn = np.concatenate([turn[-3:], turn, turn[:3]])[:, None]
        names = [f"{side}{part}" for side in SIDES for part in _ARM]
        self._arms = [n for n in names if n in cycle.skeleton.names]
        self._arm_index = [index(n) for n in self._arms]
        self._arm_mean = np.stack([mean_rotation(q[:, i]) for i in self._arm_index])
        self._hang = [self._to_hanging(name) for name in self._arms]

    def __call__(self, body: Body, request: StepRequest, step: SagittalStep) -> Overlay:
        """See :class:`gaitsmith.synthesis.overlay.Overlayer`."""
        return self.many(body, [request], [step])[0]

    def many(
        self, body: Body, requests: Sequence[StepRequest], steps: Sequence[SagittalStep]
    ) -> list[Overlay]:
        """See :class:`gaitsmith.synthesis.overlay.BatchOverlayer`."""
        samples = Samples.of(requests, steps)
        sway, pelvis, upper = self.laid(body, requests, samples)
        return samples.split(sway, log(pelvis), upper)

    def laid(
        self, body: Body, requests: Sequence[StepRequest], samples: Samples
    ) -> tuple[Float[np.ndarray, "M"], Float[np.ndarray, "M 4"], Float[np.ndarray, "M U 3"]]:
        """Sway, pelvis and rotation vectors of the upper body at all samples."""
        ends = self._ends(body, requests, samples)
        right, phase = float(self._cycle.events[1, 0]), samples.phase
        own = np.where(samples.side == 0, phase * right, right + phase * (1.0 - right))
        own = own + samples.stride % self.strides
        center, rotations = self._cycle.at(own)
        pelvis = self._pelvis_of(ends, own, rotations)
        upper = self._upper(body, ends, rotations, pelvis)
        return self._sway(body, samples, ends, center[:, 0]), pelvis, upper

    def arms_middle(self, body: Body) -> Float[np.ndarray, "U 3"]:
        """See :class:`gaitsmith.synthesis.overlay.ArmedOverlayer`."""
        middle = dict(zip(self._arms, log(self._arm_mean), strict=True))
        return np.stack([middle.get(name, np.zeros(3)) for name in upper_joints(body)])

    def _ends(self, body: Body, requests: Sequence[StepRequest], samples: Samples) -> _Ends:
        own = self._duration * np.sqrt(body.leg_length)
        before = samples.spread([r.previous_duration or r.duration for r in requests])
        this = samples.spread([r.duration for r in requests])
        first, last = (
            np.maximum(length, 0.0) / body.leg_length / self._length
            for length in samples.lengths(requests)
        )
        return _Ends((first, last), (own / before, own / this), samples.eased)

    def _sway(
        self, body: Body, samples: Samples, ends: _Ends, path: Float[np.ndarray, "M"]
    ) -> Float[np.ndarray, "M"]:
        steady = (path - self._cycle.center[:, 0].mean()) * (body.hip_width / self._hip_width)
        first, last = (np.clip(1.0 + SWAY * (v - 1.0), *SWAY_RANGE) for v in ends.speed)
        # a start or stop goes by the pace of its other end
        first, last = (
            np.where(samples.starts, last, first),
            np.where(samples.stops, first, last),
        )
        steady = steady * ends.between([first, last]) / np.tanh(3.0)
        return shifted_sway(samples, steady, *ends.length, 0.12 * body.hip_width)

    def _pelvis_of(
        self,
        ends: _Ends,
        own: Float[np.ndarray, "T"],
        rotations: Float[np.ndarray, "T J 4"],
    ) -> Float[np.ndarray, "T 4"]:
        here = rotations[:, self._cycle.skeleton.index("hips")]
        away = log(multiply(inverse(self._pelvis), here))
        shifts = [np.clip(EARLIER * (v - 1.0), -EARLIEST, EARLIEST) for v in ends.speed]
        if np.any(shifts):
            count = len(self._cycle.center)
            grid = np.arange(-3, count + 3) / count
            at = (own + ends.between(shifts)) / self.strides % 1.0
            slopes = np.gradient(self._turn, 1.0 / count, axis=0)
            away[:, 1] = hermite(grid, self._turn, slopes, at)[:, 0]
        away *= ends.size(PELVIS)[:, None]
        out = multiply(self._pelvis, exp(away))
        return multiply(about("x", PELVIS_LEAN * LEAN * ends.faster), out)

    def _in_space(
        self, rotations: Float[np.ndarray, "T J 4"]
    ) -> tuple[Float[np.ndarray, "T 4"], Float[np.ndarray, "T 4"]]:
        """World rotations of the chest and of the head."""
        chest = rotations[:, self._cycle.skeleton.index("hips")]
        for name in self._trunk:
            chest = multiply(chest, self._local(rotations, name))
        head = chest
        for name in ("neck", "head"):
            head = multiply(head, self._local(rotations, name))
        return chest, head

    def _local(self, rotations: Float[np.ndarray, "T J 4"], name: str) -> Float[np.ndarray, "T 4"]:
        skeleton = self._cycle.skeleton
        if name in skeleton.names:
            return rotations[:, skeleton.index(name)]
        return np.tile(IDENTITY, (len(rotations), 1))

    def _upper(
        self,
        body: Body,
        ends: _Ends,
        rotations: Float[np.ndarray, "T J 4"],
        pelvis: Float[np.ndarray, "T 4"],
    ) -> Float[np.ndarray, "T U 3"]:
        seen_chest, seen_head = self._in_space(rotations)
        chest = scaled(self._chest, seen_chest, ends.size(THORAX))
        chest = multiply(about("x", LEAN * ends.faster), chest)
        head = scaled(self._head, seen_head, ends.size(HEAD))

        names = spine_names(body.spine_segments)
        trunk = multiply(inverse(pelvis), chest)
        if names == self._trunk:
            joints = shared([self._local(rotations, n) for n in names], trunk)
            turned = dict(zip(names, joints, strict=True))
        else:  # as many joints as there are share the turn of the trunk
            turned = dict.fromkeys(names, exp(log(trunk) / len(names)))
        neck = [self._local(rotations, n) for n in ("neck", "head")]
        joints = shared(neck, multiply(inverse(chest), head))
        turned |= dict(zip(("neck", "head"), joints, strict=True))
        turned |= self._arms_of(ends, rotations)
        still = np.tile(IDENTITY, (len(rotations), 1))
        return log(np.stack([turned.get(name, still) for name in upper_joints(body)], axis=1))

    def _arms_of(
        self, ends: _Ends, rotations: Float[np.ndarray, "T J 4"]
    ) -> dict[str, Float[np.ndarray, "T 4"]]:
        swing = np.tile(ends.size(ARMS), (len(self._arms), 1))
        hands = [name.endswith("Hand") for name in self._arms]
        swing[hands] = np.minimum(swing[hands], 1.0)
        # joints first: samples stay next to each other
        seen = np.take(rotations.transpose(1, 2, 0), self._arm_index, axis=0).transpose(0, 2, 1)
        moved = scaled(self._arm_mean[:, None], seen, swing)
        bent = ELBOW * ends.faster - STRAIGHTER * ends.hanging
        out = {}
        for i, name in enumerate(self._arms):
            more = self._hang[i] * ends.hanging[:, None]
            if name.endswith("LowerArm"):
                more = log(self._arm_mean[i]) * bent[:, None]
            out[name] = multiply(exp(more), moved[i]) if more.any() else moved[i]
        return out

    def _to_hanging(self, name: str) -> Float[np.ndarray, "3"]:
        """Turn that brings an upper arm from its mean to where it hangs, its width kept."""
        skeleton, index = self._cycle.skeleton, self._arms.index
        if not name.endswith("UpperArm"):
            return np.zeros(3)
        shoulder = name.replace("UpperArm", "Shoulder")
        base = self._arm_mean[index(shoulder)] if shoulder in self._arms else IDENTITY
        bone = skeleton.offsets[skeleton.index(name.replace("UpperArm", "LowerArm"))]
        now = rotate(multiply(base, self._arm_mean[index(name)]), bone / np.linalg.norm(bone))
        if -now[1] < np.cos(HANGING):
            return np.zeros(3)  # arms that are held somewhere are held in standing too
        down = np.array([now[0], now[1], 0.0]) / np.hypot(now[0], now[1])
        axis = np.cross(now, down)
        sine = np.linalg.norm(axis)
        if sine < 1e-12:
            return np.zeros(3)
        return rotate(inverse(base), axis * (np.arcsin(sine) / sine))


def scaled(
    mean: Float[np.ndarray, "*#n 4"],
    rotations: Float[np.ndarray, "*n 4"],
    size: Float[np.ndarray, "*#n"],
) -> Float[np.ndarray, "*n 4"]:
    """Rotations whose excursions about their mean are ``size`` times as large."""
    away = log(multiply(inverse(mean), rotations))
    return multiply(mean, exp(size[..., None] * away))


def shared(
    joints: Sequence[Float[np.ndarray, "T 4"]], total: Float[np.ndarray, "T 4"]
) -> list[Float[np.ndarray, "T 4"]]:
    """A chain of joints that together turn by ``total``: each takes as much of what is new."""
    seen = joints[0]
    for joint in joints[1:]:
        seen = multiply(seen, joint)
    part = exp(log(multiply(total, inverse(seen))) / len(joints))
    out = [multiply(part, joint) for joint in joints[:-1]]
    rest = total
    for joint in out:
        rest = multiply(inverse(joint), rest)
    return [*out, rest]
