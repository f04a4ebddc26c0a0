"""BVH, in the strict dialect that every reader takes (Blender's is the strictest).

Centimeters and degrees; +Y up, the walker faces +Z, as inside. Braces stand on their own
line, each frame is one line, there is no byte order mark and a Frame Time always. VRM bone
names become Mixamo's without prefix (``hips`` is ``Hips``, ``leftUpperArm`` is ``LeftArm``);
other names stay, with ``_`` for blanks and braces.

The root has ``Xposition Yposition Zposition Zrotation Xrotation Yrotation``, every other
joint ``Zrotation Xrotation Yrotation``: its matrix is Rz Rx Ry. Angles are continuous in
time, so they may pass 180 degrees. The root's OFFSET is zero and its position channels are
world coordinates: readers that replace an offset by the channels (Blender) and readers that
add the two (three.js) then agree. A joint whose distance to its parent changes has six
channels as well; there the position replaces the OFFSET, as Blender and the files of motion
libraries have it.

Every joint without children ends in an End Site of some length, for Blender draws bones to
it: the toe tip of the sole, the crown, the finger tips, or half of the bone before.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES, TOE
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import continuous_euler, to_euler
from gaitsmith.io._text import number_rows

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Bool, Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.motion.skeleton import Skeleton

#: Mixamo's name, without prefix, of each VRM humanoid bone that a body has.
MIXAMO_NAMES: dict[str, str] = {
    "hips": "Hips",
    "spine": "Spine",
    "chest": "Spine1",
    "upperChest": "Spine2",
    "neck": "Neck",
    "head": "Head",
    **{
        f"{side}{vrm}": f"{side.capitalize()}{mixamo}"
        for side in SIDES
        for vrm, mixamo in (
            ("Shoulder", "Shoulder"),
            ("UpperArm", "Arm"),
            ("LowerArm", "ForeArm"),
            ("Hand", "Hand"),
            ("UpperLeg", "UpLeg"),
            ("LowerLeg", "Leg"),
            ("Foot", "Foot"),
            ("Toes", "ToeBase"),
        )
    },
}
_POSITION = "Xposition Yposition Zposition"
_ROTATION = "Zrotation Xrotation Yrotation"
#: Digits after the point, of degrees and centimeters: over ten joints of a person they add
#: up to less than a micrometer.
_DECIMALS = 6
_CENTIMETERS = 100.0
#: What a joint may move against its parent before it gets position channels, meters: what
#: the digits would not show.
_STILL = 1e-8
#: Lengths of what has no joint at its end. Hand over forearm: 0.108 / 0.146 of stature
#: (Winter, Biomechanics and Motor Control of Human Movement, Figure 4.1). Head joint to
#: crown over the head joint's height: 0.12 / 0.88, to the look.
_HAND_OVER_FOREARM, _CROWN_OVER_HEAD_HEIGHT, _TIP_OVER_BONE = 0.74, 0.14, 0.5
_SHORTEST_TIP = 0.01


def write_bvh(motion: Motion, path: Path) -> None:
    """Write ``motion`` to ``path`` as BVH; see the top of this module for the dialect.

    Positions read back differ by less than a micrometer on a body of human size. Contacts
    and labels have no place in a BVH.

    Raises
    ------
    InvalidInputError
        If there is no frame, or the frame rate or a position is beyond what the digits hold.
    """
    if len(motion) == 0:
        raise InvalidInputError("a BVH needs at least one frame, this motion has none")
    if not 1e-3 <= motion.fps <= 1e6:
        raise InvalidInputError(
            f"a BVH holds 0.001 to 1000000 frames per second, this motion has {motion.fps:g}"
        )
    moving = _moving_joints(motion)
    order = _depth_first(motion.skeleton)
    hierarchy = "\n".join(_hierarchy(motion.skeleton, order, moving))
    header = f"{hierarchy}\nMOTION\nFrames: {len(motion)}\nFrame Time: {1.0 / motion.fps:.10f}\n"
    channels = _channels(motion, order, moving)
    with path.open("wb") as file:
        file.write(header.encode("utf-8"))
        for rows in number_rows(channels, decimals=_DECIMALS):
            file.write(rows)


def bvh_names(skeleton: Skeleton) -> tuple[str, ...]:
    """Name in a BVH of each joint: Mixamo's for VRM bones, one word, all different."""
    names: list[str] = []
    taken = {MIXAMO_NAMES[name] for name in skeleton.names if name in MIXAMO_NAMES}
    for name in skeleton.names:
        if name in MIXAMO_NAMES:
            names.append(MIXAMO_NAMES[name])
            continue
        word = re.sub(r"[\s\x00-\x1f{}]+", "_", name) or "joint"
        unique, count = word, 1
        while unique in taken:
            count += 1
            unique = f"{word}_{count}"
        taken.add(unique)
        names.append(unique)
    return tuple(names)


def _moving_joints(motion: Motion) -> Bool[np.ndarray, "joints"]:
    """Which joints have position channels: the root, and those that leave their offset."""
    moving = np.zeros(len(motion.skeleton), np.bool_)
    if motion.translations is not None:
        moving = np.abs(motion.translations - motion.skeleton.offsets).max((0, 2)) > _STILL
    moving[0] = True
    return moving


def _children(skeleton: Skeleton) -> list[list[int]]:
    children: list[list[int]] = [[] for _ in skeleton.names]
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            children[parent].append(joint)
    return children


def _depth_first(skeleton: Skeleton) -> list[int]:
    """Joints in the order in which a BVH names them, hence also of its columns."""
    children, order, ahead = _children(skeleton), list[int](), [0]
    while ahead:
        joint = ahead.pop()
        order.append(joint)
        ahead.extend(reversed(children[joint]))
    return order


def _hierarchy(
    skeleton: Skeleton, order: list[int], moving: Bool[np.ndarray, "joints"]
) -> list[str]:
    """Lines of the HIERARCHY section."""
    names, children = bvh_names(skeleton), _children(skeleton)
    tips = {joint: _tip(skeleton, joint) for joint in order if not children[joint]}
    lines, depth = ["HIERARCHY"], [0] * len(names)
    open_blocks = 0
    for joint in order:
        parent = skeleton.parents[joint]
        depth[joint] = 0 if parent < 0 else depth[parent] + 1
        while open_blocks > depth[joint]:
            open_blocks -= 1
            lines.append("\t" * open_blocks + "}")
        pad = "\t" * open_blocks
        offset = np.zeros(3) if parent < 0 else skeleton.offsets[joint]
        channels = f"6 {_POSITION} {_ROTATION}" if moving[joint] else f"3 {_ROTATION}"
        lines += [
            f"{pad}{'ROOT' if parent < 0 else 'JOINT'} {names[joint]}",
            f"{pad}{{",
            f"{pad}\tOFFSET {_vector(offset)}",
            f"{pad}\tCHANNELS {channels}",
        ]
        open_blocks += 1
        if joint in tips:
            tip = f"{pad}\t\tOFFSET {_vector(tips[joint])}"
            lines += [f"{pad}\tEnd Site", f"{pad}\t{{", tip, f"{pad}\t}}"]
    return lines + ["\t" * block + "}" for block in reversed(range(open_blocks))]


def _vector(meters: Float[np.ndarray, "3"]) -> str:
    """Three centimeters as text."""
    (line,) = number_rows(_CENTIMETERS * meters[None], decimals=_DECIMALS)
    return line.decode("ascii").rstrip()


def _tip(skeleton: Skeleton, joint: int) -> Float[np.ndarray, "3"]:
    """End Site of a joint without children, meters in its frame; never shorter than 1 cm."""
    if skeleton.ends is not None and np.linalg.norm(skeleton.ends[joint]) >= _SHORTEST_TIP:
        return skeleton.ends[joint]
    name, bone = skeleton.names[joint], skeleton.offsets[joint]
    tip = _TIP_OVER_BONE * bone
    if name == "head":
        heights = skeleton.rest_positions()[:, 1]
        tip = np.array([0.0, _CROWN_OVER_HEAD_HEIGHT * (heights[joint] - heights.min()), 0.0])
    elif name.endswith("Hand"):
        tip = _HAND_OVER_FOREARM * bone
    elif skeleton.soles is not None:
        for side, (_, _, toe_joint) in enumerate(skeleton.sole_joints):
            if joint == toe_joint:
                tip = skeleton.soles[side, TOE]
    if np.linalg.norm(tip) < _SHORTEST_TIP:
        return np.array([0.0, _SHORTEST_TIP, 0.0])
    return tip


def _channels(
    motion: Motion, order: list[int], moving: Bool[np.ndarray, "joints"]
) -> Float[np.ndarray, "frames channels"]:
    """The numbers of the MOTION section, centimeters and degrees."""
    first = np.cumsum([0, *(6 if moving[joint] else 3 for joint in order)])
    out = np.empty((len(motion), first[-1]))
    for joint, column in zip(order, first[:-1], strict=True):
        # joint by joint: what it takes for one fits the processor's cache, all at once do not
        if moving[joint]:
            where = motion.root_position
            if joint > 0 and motion.translations is not None:
                where = motion.translations[:, joint]
            out[:, column : column + 3] = _CENTIMETERS * where
            column += 3
        angles = continuous_euler("zxy", to_euler("zxy", motion.rotations[:, joint]))
        out[:, column : column + 3] = np.degrees(angles)
    return out
