"""A puppet whose feet do what they are told: clips of any way of going, events known exactly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaitsmith.body.leg import two_bone_ik
from gaitsmith.body.presets import body_from_height
from gaitsmith.body.rig import skeleton_of
from gaitsmith.body.sole import rolled_ankle
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import pchip, smoothstep
from gaitsmith.geometry.rotations import IDENTITY, about, inverse, multiply, rotate, sign_continuous
from gaitsmith.motion.motion import Motion

BODY = body_from_height(1.75)
X = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Puppet:
    """How it goes: meters, seconds, degrees; pairs are [left, right].

    ``duty`` is the share of the stride that a foot is down (under 0.5 it runs), ``strike`` and
    ``push`` the soles' pitch at heel strike and toe-off, ``level`` the pitch between them,
    ``way`` where it goes against where it faces (90 sideways to the left, 180 backward),
    ``turn`` how far it turns in a stride, ``crouch`` how far the hips are let down,
    ``fly`` how high they rise between two feet if it runs.
    """

    stride: float = 1.3
    period: float = 1.1
    width: float = 0.1
    duty: tuple[float, float] = (0.62, 0.62)
    right: float = 0.5
    strike: float = 20.0
    level: float = 0.0
    push: float = 55.0
    lift: float = 0.07
    toe_out: float = 6.0
    way: float = 0.0
    turn: float = 0.0
    crouch: float = 0.0
    swing: float = 20.0
    hop: bool = False
    fly: float = 0.05
    heading: float = 0.0

    def strikes(self, side: int, seconds: float) -> np.ndarray:
        """When a foot lands, seconds."""
        first = 0.0 if side == 0 or self.hop else self.right
        return (np.arange(-1, np.ceil(seconds / self.period) + 1) + first) * self.period

    def own(self, times: np.ndarray, side: int) -> tuple[np.ndarray, np.ndarray]:
        """Strides that a foot has begun, and its phase within the last one."""
        first = 0.0 if side == 0 or self.hop else self.right
        since = times / self.period - first
        return np.floor(since), since % 1.0

    def clip(self, seconds: float = 5.0, fps: float = 60.0) -> Motion:
        """The puppet's motion."""
        times = np.arange(round(seconds * fps) + 1) / fps
        way = np.radians(self.way)
        ahead = np.array([np.sin(way), 0.0, np.cos(way)])
        duty = 0.5 * sum(self.duty)
        # over the middle of a stance the hips are over the foot
        facing = np.radians(self.turn) * times / self.period
        hips = (times / self.period)[:, None] * self.stride * ahead
        feet = [self._foot(times, side, ahead, duty) for side in (0, 1)]
        run = np.zeros(len(times))
        if max(self.duty) < 0.5 or self.hop:
            up = (2.0 * times / self.period * (0.5 if self.hop else 1.0) - duty) % 1.0
            run = self.fly * np.sin(np.pi * up) ** 2
        top = self._height(hips, feet) - self.crouch
        hips = hips + (top + run)[:, None] * np.array([0.0, 1.0, 0.0])
        return self._posed(times, fps, hips, feet, facing)

    def _foot(self, times, side, ahead, duty):
        count, own = self.own(times, side)
        first = 0.0 if side == 0 or self.hop else self.right
        down = self.duty[side]
        swung = smoothstep((own - down) / (1.0 - down))
        far = (count + first + 0.5 * duty + swung) * self.stride
        knots = np.array([0.0, 0.12, 0.55, 1.0]) * down
        marks = np.array([*knots, down + 0.6 * (1.0 - down), 1.0])
        values = [self.strike, self.level, self.level, -self.push, 0.0, self.strike]
        pitch = np.radians(pchip(marks, np.array(values)[:, None], own)[:, 0])
        sagittal = rolled_ankle(BODY.foot, pitch, 0.0)
        lifted = np.sin(np.pi * np.clip((own - down) / (1.0 - down), 0.0, 1.0)) ** 2
        side_way = 0.5 * self.width * SIDE_SIGN[side]
        ankle = far[:, None] * ahead + side_way * X
        out = SIDE_SIGN[side] * np.radians(self.toe_out)
        ankle += sagittal[:, :1] * [np.sin(out), 0.0, np.cos(out)]
        ankle[:, 1] += sagittal[:, 1] + self.lift * lifted
        return ankle, pitch

    def _height(self, hips, feet):
        """Hips as high as the legs that bear allow, the same all the time."""
        reach = 0.985 * BODY.leg_length
        low = np.inf
        for side, (ankle, _) in enumerate(feet):
            hip = hips + 0.5 * BODY.hip_width * SIDE_SIGN[side] * X
            flat = ((ankle - hip)[:, [0, 2]] ** 2).sum(-1)
            high = ankle[:, 1] + np.sqrt(np.maximum(reach**2 - flat, 0.2 * reach**2))
            low = min(low, float(high.min()))
        return low

    def _posed(self, times, fps, hips, feet, facing):
        skeleton = skeleton_of(BODY)
        q = np.tile(IDENTITY, (len(times), len(skeleton), 1))
        swing = np.radians(self.swing) * np.cos(2.0 * np.pi * times / self.period)
        for side, name in enumerate(SIDES):
            sign = float(SIDE_SIGN[side])
            ankle, pitch = feet[side]
            hip = hips + 0.5 * BODY.hip_width * sign * X
            leg = two_bone_ik(
                hip, ankle, np.array([0.0, 0.0, 1.0]), thigh=BODY.thigh, shin=BODY.shin
            )
            out = about("y", sign * np.radians(self.toe_out))
            foot = multiply(out, about("x", -pitch))
            toes = multiply(out, about("x", np.where(pitch < 0.0, 0.0, -pitch)))
            for part, world, above in (
                ("UpperLeg", leg.thigh, IDENTITY),
                ("LowerLeg", leg.shin, leg.thigh),
                ("Foot", foot, leg.shin),
                ("Toes", toes, foot),
            ):
                q[:, skeleton.index(name + part)] = multiply(inverse(above), world)
            hang = multiply(about("x", sign * swing), about("z", -sign * np.radians(78.0)))
            q[:, skeleton.index(name + "UpperArm")] = hang
            q[:, skeleton.index(name + "LowerArm")] = about("y", -sign * np.radians(20.0))
        turned = about("y", facing + np.radians(self.heading))
        q[:, 0] = turned
        if self.turn == 0.0:
            hips = rotate(turned, hips)
        return Motion(skeleton, hips, sign_continuous(q), fps)
