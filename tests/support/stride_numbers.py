"""What is measured on people's strides, measured on a steady stride of a generated walk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.geometry.rotations import inverse, multiply, rotate
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions

#: Samples of the stride, from left heel strike to left heel strike.
COUNT = 100


@dataclass(frozen=True)
class StrideNumbers:
    """Angles in degrees, lengths in meters, shares of the stride; ``(COUNT, ...)`` curves.

    ``joints`` is ``(COUNT, 2, 3)``: [left, right] x [hip against the pelvis, knee, ankle], each
    from its own side's heel strike.
    """

    joints: np.ndarray
    foot: np.ndarray  # (COUNT, 2) sole pitch, own phase
    arm: np.ndarray  # (COUNT, 2) upper arm forward, stride phase
    elbow: np.ndarray  # (COUNT, 2)
    thigh: np.ndarray  # (COUNT, 2) thigh forward, stride phase
    pelvis: np.ndarray  # (COUNT, 3) forward tilt, turn to the left, left side up
    thorax: np.ndarray  # (COUNT, 3)
    head: np.ndarray  # (COUNT, 3)
    root: np.ndarray  # (COUNT, 3)
    stance: float  # share of the stride
    step: float
    speed: float

    @property
    def bob(self) -> float:
        """Rise of the hips, meters."""
        return float(np.ptp(self.root[:, 1]))

    @property
    def sway(self) -> float:
        """Sideways path of the hips, meters."""
        return float(np.ptp(self.root[:, 0]))

    @property
    def knee_peak(self) -> float:
        """In swing."""
        return float(self.joints[60:, :, 1].max(0).mean())

    @property
    def phase_difference(self) -> float:
        """Of the turns of pelvis and thorax, first harmonic, degrees in [0, 180]."""
        one, two = (np.fft.fft(x[:, 1])[1] for x in (self.pelvis, self.thorax))
        return float(np.degrees(np.abs(np.angle(one / two))))


def stride_numbers(motion, which=2):
    """Numbers of a stride in the middle of ``motion``."""
    skeleton, labels = motion.skeleton, motion.labels
    index = skeleton.index
    positions, world = motion_kinematics(motion)
    soles = sole_positions(skeleton, positions, world)
    left = [i for i in range(2, len(labels.footstep_side) - 2) if labels.footstep_side[i] == 0]
    i = left[min(which, len(left) - 2)]
    t0, t2 = labels.footstep_time[i], labels.footstep_time[i + 2]
    right = (labels.footstep_time[i + 1] - t0) / (t2 - t0)
    share = np.arange(COUNT) / COUNT

    def read(values, late=0.0):
        t = t0 + (share + late) * (t2 - t0)
        flat = values.reshape(len(values), -1)
        out = np.stack([np.interp(t, motion.times, c) for c in flat.T], axis=-1)
        return out.reshape(COUNT, *values.shape[1:])

    def at(name):
        return positions[:, index(name)]

    def forward(v):
        return np.degrees(np.arctan2(v[..., 2], -v[..., 1]))

    up = rotate(world[:, index("hips")], np.array([0.0, 1.0, 0.0]))
    tilt = np.degrees(np.arctan2(up[:, 2], up[:, 1]))
    joints, foot, arm, elbow, thighs = [], [], [], [], []
    for k, side in enumerate(SIDES):
        late = right * k
        thigh = at(f"{side}LowerLeg") - at(f"{side}UpperLeg")
        shin = at(f"{side}Foot") - at(f"{side}LowerLeg")
        bend = np.degrees(_between(thigh, shin))
        sole = soles[:, k, 1] - soles[:, k, 0]
        pitch = np.degrees(np.arctan2(sole[:, 1], np.hypot(sole[:, 0], sole[:, 2])))
        three = np.stack([forward(thigh) + tilt, bend, pitch - (forward(thigh) - bend)], -1)
        joints.append(read(three, late))
        foot.append(read(pitch, late))
        upper = at(f"{side}LowerArm") - at(f"{side}UpperArm")
        arm.append(read(forward(upper)))
        elbow.append(read(np.degrees(_between(upper, at(f"{side}Hand") - at(f"{side}LowerArm")))))
        thighs.append(read(forward(thigh)))
    contact = motion.contacts[:, 0].any(-1)
    fine = np.linspace(t0, t2, 2000, endpoint=False)
    down = contact[np.clip(np.round(fine * motion.fps).astype(int), 0, len(contact) - 1)]
    root = read(motion.root_position)
    step = 0.5 * float(labels.footstep_position[i + 2, 2] - labels.footstep_position[i, 2])
    return StrideNumbers(
        joints=np.stack(joints, 1),
        foot=np.stack(foot, 1),
        arm=np.stack(arm, 1),
        elbow=np.stack(elbow, 1),
        thigh=np.stack(thighs, 1),
        pelvis=read(_tilts(world[:, index("hips")])),
        thorax=read(_tilts(world[:, index("upperChest")])),
        head=read(_tilts(world[:, index("head")])),
        root=root,
        stance=float(down.mean()),
        step=step,
        speed=2.0 * step / float(t2 - t0),
    )


def _between(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))


def _tilts(q):
    """Forward tilt, turn to the left and left side up of body frames, degrees."""
    side = rotate(q, np.array([1.0, 0.0, 0.0]))
    up = rotate(q, np.array([0.0, 1.0, 0.0]))
    turn = np.arctan2(-side[:, 2], side[:, 0])
    tip = np.arcsin(np.clip(side[:, 1], -1.0, 1.0))
    level = rotate(inverse(_yaw(turn)), up)
    return np.degrees(np.stack([np.arctan2(level[:, 2], level[:, 1]), turn, tip], axis=-1))


def _yaw(angle):
    out = np.zeros((len(angle), 4))
    out[:, 1], out[:, 3] = np.sin(0.5 * angle), np.cos(0.5 * angle)
    return out


def apart(a, b):
    """Angles between rotations, degrees."""
    q = multiply(inverse(a), b)
    return np.degrees(2.0 * np.arctan2(np.linalg.norm(q[..., :3], axis=-1), np.abs(q[..., 3])))
