"""Where a person looks and how the trunk leans, over time, laid over finished poses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_names
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.geometry.rotations import exp, log, multiply, rotate

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.contact import Poses

#: Seconds in which the head turns to a new point (head 70-400 deg/s in turns).
LOOK_SECONDS = 0.55
#: A point is followed up to EASY aside; beyond, the head turns less, and not at all to what is
#: right behind. Up and down as far as STEEP, radians.
EASY, STEEP = float(np.radians(60.0)), float(np.radians(55.0))
#: Shares of a turn of the gaze that spine and neck take; the head has the rest.
SPINE, NECK = 1.0 / 3.0, 1.0 / 3.0
#: Part of a lean that neck and head take back.
LEVEL = 0.6


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
        lean, before = np.zeros((len(times), 2)), np.zeros(2)
        for begin, end, pitch, roll in self.leans:
            goal = np.array([pitch, roll])
            lean += smoothstep((times - begin) / (end - begin))[:, None] * (goal - before)
            before = goal
        count = len(spine_names(self.body.spine_segments))
        turn = np.stack([lean[:, 0], np.zeros(len(times)), -lean[:, 1]], axis=-1)
        for i in range(count):
            upper[:, i] = log(multiply(exp(turn / count), exp(upper[:, i])))
        for i in (count, count + 1):
            upper[:, i] = log(multiply(exp(-0.5 * LEVEL * turn), exp(upper[:, i])))

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
                yaw = _easy(_wrapped(np.arctan2(way[:, 0], way[:, 2]) - heading))
                flat = np.maximum(np.hypot(way[:, 0], way[:, 2]), 1e-6)
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
