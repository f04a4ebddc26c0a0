"""Where our axes lie in the joints of any rig: found from its rest pose or from how it moves.

A rig's joints may have any axes. CMU's are the world's at rest, in a T-pose; Bandai's and ACCAD's
lie along the bones, and their "rest" is no pose a person can take. What a bone's axes mean is
told by the person in motion: a thigh points at its knee and bends there about one axis; a foot
that stands still is level. So the frame of every bone is found from geometry that is the same
in every rig, and the rest pose is believed only where a person could stand in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES, UP
from gaitsmith.geometry.rotations import (
    from_basis,
    from_matrix,
    inverse,
    multiply,
    rotate,
    to_matrix,
)
from gaitsmith.motion.kinematics import motion_kinematics

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from gaitsmith.motion.motion import Motion

#: A hinge is believed if its mean sine of flexion is above this.
_BENDS = 0.10
#: Cosine of the angle within which a joint's own axes are taken for anatomical ones: 20 deg, 40
#: for neck and head, which may look down all the time, and 13 for the hips, whose bones leave at
#: odd angles.
_SNAP = {"hips": 0.974, "neck": 0.76, "head": 0.76}
_SNAP_SPINE = 0.94
#: Share of frames, the stillest ones, in which a foot is looked at for its sole.
_STILLEST = 0.12
#: Radians by which a still foot may differ from the rest pose's before the rest is believed.
_TIPTOE = 0.25
_TRUNK = ("spine", "chest", "upperChest", "neck", "head")

Vector = "Float[np.ndarray, '3']"


@dataclass(eq=False)
class Rig:
    """A clip with its roles: positions, rotations, and what they tell of the bones' axes.

    Attributes
    ----------
    motion
        The clip.
    joints
        Index of the joint of each VRM humanoid bone found.
    """

    motion: Motion
    joints: dict[str, int]

    def __post_init__(self) -> None:
        """Joints that lie on their parents are none."""
        for side in SIDES:
            foot, toes = f"{side}Foot", f"{side}Toes"
            if toes in self.joints and _length(self.at(toes) - self.at(foot)) < 0.05 * self.scale:
                self.joints = {r: j for r, j in self.joints.items() if r != toes}

    @cached_property
    def world(self) -> tuple[Float[np.ndarray, "F J 3"], Float[np.ndarray, "F J 4"]]:
        """World positions and rotations of every joint."""
        return motion_kinematics(self.motion)

    def at(self, role: str) -> Float[np.ndarray, "F 3"]:
        """World path of a role's joint."""
        return self.world[0][:, self.joints[role]]

    def turn(self, role: str) -> Float[np.ndarray, "F 4"]:
        """World rotation of a role's joint."""
        return self.world[1][:, self.joints[role]]

    def local(self, role: str, vector: Float[np.ndarray, "F 3"]) -> Float[np.ndarray, "3"]:
        """Mean of world vectors as the joint sees them; long ones count more."""
        return rotate(inverse(self.turn(role)), vector).mean(0)

    @cached_property
    def left(self) -> Float[np.ndarray, "F 3"]:
        """Unit vector from the right hip joint to the left."""
        return _unit(self.at("leftUpperLeg") - self.at("rightUpperLeg"))

    @cached_property
    def facing(self) -> Float[np.ndarray, "F 3"]:
        """Horizontal unit vector the pelvis faces."""
        return _unit(np.cross(self.left, UP))

    @cached_property
    def scale(self) -> float:
        """Leg length, hip to ankle along the bones, meters; the mean of both."""
        return 0.5 * sum(
            _length(self.at(f"{s}LowerLeg") - self.at(f"{s}UpperLeg"))
            + _length(self.at(f"{s}Foot") - self.at(f"{s}LowerLeg"))
            for s in SIDES
        )

    @cached_property
    def rest_turn(self) -> Float[np.ndarray, "4"] | None:
        """Heading that takes the rest pose to ours, or None if nobody can stand in it."""
        rest = self.motion.skeleton.rest_positions()

        def bone(a: str, b: str) -> Float[np.ndarray, "3"]:
            return _unit(rest[self.joints[b]] - rest[self.joints[a]])

        left = _unit(rest[self.joints["leftUpperLeg"]] - rest[self.joints["rightUpperLeg"]])
        top = next((r for r in ("head", "neck", *_TRUNK[2::-1]) if r in self.joints), None)
        if abs(left[1]) > 0.3 or top is None or bone("hips", top)[1] < 0.8:
            return None
        ahead = np.cross(left, UP)
        for side in SIDES:
            thigh = bone(f"{side}UpperLeg", f"{side}LowerLeg")
            shin = bone(f"{side}LowerLeg", f"{side}Foot")
            if thigh[1] > -0.7 or shin[1] > -0.7:
                return None
            if f"{side}Toes" in self.joints and bone(f"{side}Foot", f"{side}Toes") @ ahead < 0.5:
                return None
        left = _unit(left * [1.0, 0.0, 1.0])
        return from_basis(left, UP, np.cross(left, UP))


def bone_frames(rig: Rig) -> dict[str, Float[np.ndarray, "4"]]:
    """Rotation of our axes of each role's bone (T-pose) in the frame of the rig's joint.

    ``world rotation of the joint * frame`` is the world rotation that our skeleton's joint
    must have to show the same pose.
    """
    out = _trunk_frames(rig)
    for side in SIDES:
        out |= _leg_frames(rig, side)
        out |= _arm_frames(rig, side, out)
    return out


def _unit(v: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def _length(v: Float[np.ndarray, "F 3"]) -> float:
    return float(np.linalg.norm(v, axis=-1).mean())


def frame(
    exact: tuple[int, Float[np.ndarray, "3"]], about: tuple[int, Float[np.ndarray, "3"]]
) -> Float[np.ndarray, "4"]:
    """Rotation that takes axis ``exact[0]`` to ``exact[1]`` and ``about[0]`` as near as can be."""
    axes = np.empty((3, 3))
    i, j = exact[0], about[0]
    axes[i] = _unit(exact[1])
    axes[j] = _unit(about[1] - (about[1] @ axes[i]) * axes[i])
    k = 3 - i - j
    axes[k] = np.cross(axes[(k + 1) % 3], axes[(k + 2) % 3])
    return from_matrix(axes.T)


def _snapped(q: Float[np.ndarray, "4"], near: float) -> Float[np.ndarray, "4"]:
    """The rotation between coordinate axes nearest to ``q``, or ``q`` if none is near.

    ``near`` is the least cosine between an axis and where it goes.
    """
    m = to_matrix(q)
    best = np.zeros((3, 3))
    for column in np.argsort(-np.abs(m).max(axis=0)):
        free = np.abs(m[:, column]) * (best == 0.0).all(axis=1)
        row = int(free.argmax())
        best[row, column] = np.sign(m[row, column])
    if np.linalg.det(best) < 0.5 or (best * m).sum(axis=0).min() < near:
        return q
    return from_matrix(best)


def _trunk_frames(rig: Rig) -> dict[str, Float[np.ndarray, "4"]]:
    """Hips, spine, neck and head: the rest pose, else ahead on the average.

    The spine then goes up the line from hips to neck, which keeps who leans leaning; hips and
    head are upright on the average.
    """
    out: dict[str, Float[np.ndarray, "4"]] = {}
    plumb = np.broadcast_to(UP, rig.left.shape)
    top = next((r for r in ("neck", "head") if r in rig.joints), None)
    line = plumb
    if top is not None:
        line = _unit(rig.at(top) - 0.5 * (rig.at("leftUpperLeg") + rig.at("rightUpperLeg")))
    for role in ("hips", *_TRUNK):
        if role not in rig.joints:
            continue
        if rig.rest_turn is not None:
            out[role] = rig.rest_turn
            continue
        across = rig.local(role, rig.left if role == "hips" else np.cross(UP, rig.facing))
        up = plumb if role in ("hips", "head") else line
        upright = frame((0, across), (1, rig.local(role, up)))
        out[role] = _snapped(upright, _SNAP.get(role, _SNAP_SPINE))
    if rig.rest_turn is None:  # the hips' axis is told by the hip joints, exactly
        left = rig.local("hips", rig.left)
        out["hips"] = frame((0, left), (1, rotate(out["hips"], UP)))
    return out


def _leg_frames(rig: Rig, side: str) -> dict[str, Float[np.ndarray, "4"]]:
    """Thigh and shin by bone and hinge, the foot by how it stands."""
    upper, lower, foot = (f"{side}{part}" for part in ("UpperLeg", "LowerLeg", "Foot"))
    thigh = rig.at(lower) - rig.at(upper)
    shin = rig.at(foot) - rig.at(lower)
    hinge = np.cross(_unit(shin), _unit(thigh))
    # of a leg that is bent the right way the hinge points to the left; a straight one tells little
    weight = np.maximum((hinge * rig.left).sum(-1, keepdims=True), 0.0)
    hinge = hinge * weight
    if np.sqrt(weight.mean()) < _BENDS:
        hinge = rig.left
    out = {
        upper: frame((1, rig.local(upper, -thigh)), (0, rig.local(upper, hinge))),
        lower: frame((1, rig.local(lower, -shin)), (0, rig.local(lower, hinge))),
    }
    return out | _foot_frames(rig, side)


def _foot_frames(rig: Rig, side: str) -> dict[str, Float[np.ndarray, "4"]]:
    foot, toes = f"{side}Foot", f"{side}Toes"
    still = still_frames(rig, side)
    if toes in rig.joints:
        ahead = rig.at(toes) - rig.at(foot)
    else:
        end = rig.motion.skeleton.ends
        tip = np.zeros(3) if end is None else end[rig.joints[foot]]
        ahead = rotate(rig.turn(foot), np.broadcast_to(tip, rig.left.shape))
        ahead = ahead if np.abs(tip).max() > 0.02 else rig.facing
    out = {}
    for role in (foot, toes):
        if role not in rig.joints:
            continue
        seen = inverse(rig.turn(role)[still])
        up = rotate(seen, UP).mean(0)
        out[role] = frame((1, up), (2, rotate(seen, ahead[still] * [1.0, 0.0, 1.0]).mean(0)))
    rest = rig.rest_turn
    if rest is not None and foot in out:
        # whoever never stands on a flat foot shows the sole only at rest
        raised = rotate(multiply(inverse(rest), out[foot]), np.array([0.0, 0.0, 1.0]))
        if raised[1] > np.sin(_TIPTOE):
            level = {
                role: frame((1, UP), (2, rotate(out[role], np.array([0.0, 0.0, 1.0]))))
                for role in out
            }
            out = level
    return out


def still_frames(rig: Rig, side: str) -> Bool[np.ndarray, "F"]:
    """Frames in which a foot stands still, low and as flat as it gets."""
    roles = [r for r in (f"{side}Foot", f"{side}Toes") if r in rig.joints]
    speed = np.max(
        [np.linalg.norm(np.gradient(rig.at(r), axis=0), axis=-1) * rig.motion.fps for r in roles],
        axis=0,
    )
    low = rig.at(roles[-1])[:, 1]
    low = low < np.quantile(low, 0.05) + 0.03 * rig.scale
    speed = np.where(low, speed, np.inf)
    count = max(3, int(_STILLEST * len(speed)))
    limit = np.sort(speed)[min(count, int(low.sum())) - 1]
    still = speed <= limit
    height = rig.at(roles[0])[:, 1]
    return still & (height <= np.quantile(height[still], 0.7))


def _arm_frames(
    rig: Rig, side: str, found: dict[str, Float[np.ndarray, "4"]]
) -> dict[str, Float[np.ndarray, "4"]]:
    """Arms by bone and by the plane of the elbow; shoulder and hand by the rest or the mean."""
    sign = float(SIDE_SIGN[SIDES.index(side)])
    shoulder, upper, lower, hand = (
        f"{side}{part}" for part in ("Shoulder", "UpperArm", "LowerArm", "Hand")
    )
    out: dict[str, Float[np.ndarray, "4"]] = {}
    if not {upper, lower, hand} <= rig.joints.keys():
        return out
    arm, fore = _unit(rig.at(lower) - rig.at(upper)), _unit(rig.at(hand) - rig.at(lower))
    along = (arm * fore).sum(-1, keepdims=True)
    bent_upper, bent_lower = fore - along * arm, along * fore - arm
    if _length(bent_upper) < _BENDS:
        bent_upper = bent_lower = rig.facing
    z = 2
    out[upper] = frame((0, sign * rig.local(upper, arm)), (z, rig.local(upper, bent_upper)))
    out[lower] = frame((0, sign * rig.local(lower, fore)), (z, rig.local(lower, bent_lower)))
    out[hand] = _mean_rotation(
        multiply(inverse(rig.turn(hand)), multiply(rig.turn(lower), out[lower]))
    )
    if shoulder in rig.joints:
        if rig.rest_turn is not None:
            out[shoulder] = rig.rest_turn
        else:
            chest = next(r for r in ("upperChest", "chest", "spine", "hips") if r in found)
            out[shoulder] = _mean_rotation(
                multiply(inverse(rig.turn(shoulder)), multiply(rig.turn(chest), found[chest]))
            )
    return out


def _mean_rotation(q: Float[np.ndarray, "F 4"]) -> Float[np.ndarray, "4"]:
    """The rotation nearest to all of ``q`` (their chordal mean)."""
    values, vectors = np.linalg.eigh(q.T @ q)
    mean = vectors[:, int(values.argmax())]
    return mean if mean[3] >= 0.0 else -mean
