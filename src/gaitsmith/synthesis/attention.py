"""Where a person looks and how the trunk leans, over time, laid over finished poses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.conventions import LOCAL_KINDS, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, log, multiply, rotate
from gaitsmith.synthesis.balance import Balance
from gaitsmith.synthesis.overlay import upper_joints
from gaitsmith.synthesis.shifting import shifted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact import Poses, ReferenceStep
    from gaitsmith.conventions import StepKind
    from gaitsmith.synthesis.clock import Clock

#: Seconds in which the head turns to a new point (head 70-400 deg/s in turns).
LOOK_SECONDS = 0.55
#: A point is followed up to EASY aside; beyond, the head turns less, and not at all to what is
#: right behind. Up and down as far as STEEP, radians.
EASY, STEEP = float(np.radians(60.0)), float(np.radians(55.0))
#: A point nearer than this, seen from above (m), has less and less of a direction: the head does
#: not follow it round.
NEAR = 0.4
#: Shares of a turn of the gaze that spine and neck take; the head has the rest.
SPINE, NECK = 1.0 / 3.0, 1.0 / 3.0
#: Part of a lean that neck and head, and that hanging arms take back.
LEVEL, HANGING = 0.6, 0.9
#: Part of the balance aside that hips keep in a walk, and seconds in which that changes.
WALKING, EASE = 0.3, 0.8


@dataclass(frozen=True, eq=False)
class Attention:
    """``looks`` and ``leans`` as of :class:`~gaitsmith.plan.timeline.Timeline`."""

    body: Body
    looks: tuple[tuple[float, tuple[float, float, float] | None], ...]
    leans: tuple[tuple[float, float, float, float], ...]

    def applied(self, times: Float[np.ndarray, "F"], poses: Poses) -> Poses:
        """The same poses with trunk and head turned."""
        if not self.looks and not self.leans:
            return poses
        upper = np.array(poses.upper)
        if self.leans:
            self._lean(times, upper)
        if any(point is not None for _, point in self.looks):
            self._look(times, poses, upper)
        return replace(poses, upper=upper)

    def _lean(self, times: Float[np.ndarray, "F"], upper: Float[np.ndarray, "F U 3"]) -> None:
        goals = np.array([(pitch, roll) for _, _, pitch, roll in self.leans])
        self.bend(upper, self.over_time(times, goals))

    def over_time(
        self, times: Float[np.ndarray, "F"], goals: Float[np.ndarray, "L c"]
    ) -> Float[np.ndarray, "F c"]:
        """From nothing to each of ``goals``, one a lean, as the leans are eased in."""
        out, before = np.zeros((len(times), goals.shape[1])), np.zeros(goals.shape[1])
        for (begin, end, _, _), goal in zip(self.leans, goals, strict=True):
            out += smoothstep((times - begin) / (end - begin))[:, None] * (goal - before)
            before = goal
        return out

    def bend(self, upper: Float[np.ndarray, "F U 3"], lean: Float[np.ndarray, "F 2"]) -> None:
        """Bend the trunk by (pitch, roll); the head stays more level, arms go on hanging."""
        count = len(spine_names(self.body.spine_segments))
        turn = np.stack([lean[:, 0], np.zeros(len(lean)), -lean[:, 1]], axis=-1)
        for i in range(count):
            upper[:, i] = log(multiply(exp(turn / count), exp(upper[:, i])))
        names = upper_joints(self.body)
        arms = [names.index(f"{side}UpperArm") for side in SIDES]
        for joints, back in (((count, count + 1), 0.5 * LEVEL), (arms, HANGING)):
            for i in joints:
                upper[:, i] = log(multiply(exp(-back * turn), exp(upper[:, i])))

    def _look(
        self, times: Float[np.ndarray, "F"], poses: Poses, upper: Float[np.ndarray, "F U 3"]
    ) -> None:
        count = len(spine_names(self.body.spine_segments))
        facing = rotate(poses.pelvis, np.array([0.0, 0.0, 1.0]))
        heading = np.arctan2(facing[:, 0], facing[:, 2])
        top = np.array([0.0, self.body.trunk + self.body.neck + 0.5 * self.body.head, 0.0])
        eyes = poses.center + top
        yaw0, pitch0 = self._gaze(poses, upper, count)
        ahead_yaw = _wrapped(yaw0 - heading)
        wanted_yaw, wanted_pitch = ahead_yaw, pitch0
        for begin, point in self.looks:
            share = smoothstep((times - begin) / LOOK_SECONDS)
            if point is None:
                yaw, pitch = ahead_yaw, pitch0
            else:
                way = np.array(point) - eyes
                flat = np.maximum(np.hypot(way[:, 0], way[:, 2]), 1e-6)
                aside = _easy(_wrapped(np.arctan2(way[:, 0], way[:, 2]) - heading))
                yaw = ahead_yaw + smoothstep(flat / NEAR) * (aside - ahead_yaw)
                pitch = STEEP * np.tanh(np.arctan2(way[:, 1], flat) / STEEP)
            wanted_yaw = wanted_yaw + share * (yaw - wanted_yaw)
            wanted_pitch = wanted_pitch + share * (pitch - wanted_pitch)
        for spine, neck in ((SPINE, NECK), (0.0, 0.0), (0.0, 0.0)):
            now, up = self._gaze(poses, upper, count)
            more = wanted_yaw - _wrapped(now - heading)
            down = up - wanted_pitch
            for i in range(count):
                if spine:
                    upper[:, i] = _turned(upper[:, i], spine * more / count, np.zeros_like(more))
            upper[:, count] = _turned(upper[:, count], neck * more, neck * down)
            rest = 1.0 - spine - neck
            upper[:, count + 1] = _turned(upper[:, count + 1], rest * more, rest * down)

    @staticmethod
    def _gaze(
        poses: Poses, upper: Float[np.ndarray, "F U 3"], count: int
    ) -> tuple[Float[np.ndarray, "F"], Float[np.ndarray, "F"]]:
        """Heading of the face and how far it looks up."""
        head = poses.pelvis
        for i in range(count + 2):
            head = multiply(head, exp(upper[:, i]))
        face = rotate(head, np.array([0.0, 0.0, 1.0]))
        return np.arctan2(face[:, 0], face[:, 2]), np.arcsin(np.clip(face[:, 1], -1.0, 1.0))


def balanced(
    steps: Sequence[ReferenceStep],
    kinds: Sequence[StepKind],
    clock: Clock,
    attention: Attention,
) -> Sequence[ReferenceStep]:
    """The same steps with the hips moved against the leans, the center of mass over the feet.

    People who bend forward move their hips back, who lean left move them right. In a walk the
    hips stay nearly over its path: they go aside by :data:`WALKING` of that.
    """
    if not attention.leans:
        return steps
    goals = np.array([(pitch, roll) for _, _, pitch, roll in attention.leans])
    curves, count = steps[0].curves, len(goals)
    pelvis = exp(np.tile(curves.pelvis[0], (count, 1)))
    before = np.tile(curves.upper[0], (count, 1, 1))
    after = np.array(before)
    attention.bend(after, goals)
    moves = Balance(attention.body).counter((pelvis, before), (pelvis, after))

    walks = [kind not in LOCAL_KINDS for kind in kinds]
    edges = np.flatnonzero(np.diff(np.concatenate([[0], walks, [0]]).astype(int)))
    spans = clock.starts[edges].reshape(-1, 2)

    def shift(times: Float[np.ndarray, "n"]) -> tuple[np.ndarray, np.ndarray]:
        out = attention.over_time(times, moves)
        for begin, end in spans.tolist():
            # before it starts and after it stops: at the very ends its clock stands still
            inside = smoothstep((times - begin) / EASE + 1.0) * smoothstep(
                (end - times) / EASE + 1.0
            )
            out[:, 0] *= 1.0 - (1.0 - WALKING) * inside
        return out, np.zeros(len(times))

    return shifted(steps, clock, shift)


def _turned(
    joint: Float[np.ndarray, "F 3"], yaw: Float[np.ndarray, "F"], down: Float[np.ndarray, "F"]
) -> Float[np.ndarray, "F 3"]:
    about_y = np.stack([np.zeros_like(yaw), yaw, np.zeros_like(yaw)], axis=-1)
    about_x = np.stack([down, np.zeros_like(yaw), np.zeros_like(yaw)], axis=-1)
    return log(multiply(multiply(exp(about_y), exp(joint)), exp(about_x)))


def _easy(angle: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
    """How far the head turns for something at ``angle`` aside; smooth all the way round."""
    return angle * (1.0 - smoothstep((np.abs(angle) - EASY) / (np.pi - EASY)))


def _wrapped(angle: Float[np.ndarray, "F"]) -> Float[np.ndarray, "F"]:
    return np.arctan2(np.sin(angle), np.cos(angle))
