"""The skeleton of a body: VRM humanoid joints in T-pose, soles at y = 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.motion.skeleton import Skeleton

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body, Foot

#: Lowest spine joint above the hip joints, as a share of the trunk. The lumbosacral joint is
#: some 0.10-0.12 m above the hip joints in an adult whose trunk is 0.55 m.
LOWEST_SPINE = 0.2
#: Inner end of the clavicle beside the mid-line, as a share of half the shoulder width: the
#: sternoclavicular joint, 2-3 cm from the mid-line in adults.
CLAVICLE = 0.15


def spine_names(count: int) -> tuple[str, ...]:
    """Names of the ``count`` joints of the trunk, lowest first.

    The canonical names stay landmarks that every humanoid tool knows: ``spine`` is the
    lowest joint and ``upperChest`` the highest, ``chest`` is in the middle. The joints
    between them are numbered by their place in the chain. VRM allows ``upperChest`` only
    above a ``chest``, so two joints are ``spine`` and ``chest``; one is ``spine``. Neck and
    shoulders always hang on the last one.

    >>> spine_names(3)
    ('spine', 'chest', 'upperChest')
    >>> spine_names(5)
    ('spine', 'spine_02', 'chest', 'spine_04', 'upperChest')
    """
    if count < 1:
        raise InvalidInputError(f"a spine needs at least one joint, got {count!r}")
    names = [f"spine_{joint + 1:02d}" for joint in range(count)]
    if count >= 3:
        names[(count - 1) // 2], names[-1] = "chest", "upperChest"
    elif count == 2:
        names[1] = "chest"
    names[0] = "spine"
    return tuple(names)


def spine_heights(body: Body) -> Float[np.ndarray, "spine_segments"]:
    """Heights of the trunk's joints above the hip joints, lowest first, meters.

    The lowest is ``LOWEST_SPINE`` of the trunk up; from there to the base of the neck the
    trunk is cut into equal segments.
    """
    count = body.spine_segments
    shares = LOWEST_SPINE + (1.0 - LOWEST_SPINE) * np.arange(count) / count
    return shares * body.trunk


def skeleton_of(body: Body) -> Skeleton:
    """The skeleton of ``body``: VRM humanoid names, T-pose, identity rest rotations.

    The root ``hips`` is the mid-point of the hip joints, ``hip_height`` above the floor, so
    that the soles rest on y = 0; the walker faces +Z, its left is +X. Legs hang straight
    down from ``hip_width``, arms stretch along +-X from ``shoulder_width`` at
    ``shoulder_drop`` below the base of the neck. Sole points are those of
    :class:`~gaitsmith.body.body.Foot`. With ``spine_segments=3`` the joints are exactly
    :data:`gaitsmith.motion.skeleton.HUMANOID`, in its order; see :func:`spine_names` for
    others.

    Parameters
    ----------
    body
        Lengths in meters.

    Returns
    -------
    Skeleton with offsets and soles in meters.
    """
    joints: list[tuple[str, str | None, tuple[float, float, float]]] = [
        ("hips", None, (0.0, body.hip_height, 0.0))
    ]
    heights = spine_heights(body)
    parent, below = "hips", 0.0
    for name, height in zip(spine_names(body.spine_segments), heights, strict=True):
        joints.append((name, parent, (0.0, float(height) - below, 0.0)))
        parent, below = name, float(height)
    joints.append(("neck", parent, (0.0, body.trunk - below, 0.0)))
    joints.append(("head", "neck", (0.0, body.neck, 0.0)))

    half = 0.5 * body.shoulder_width
    shoulder_up = body.trunk - body.shoulder_drop - below
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        joints += [
            (f"{side}Shoulder", parent, (sign * CLAVICLE * half, shoulder_up, 0.0)),
            (f"{side}UpperArm", f"{side}Shoulder", (sign * (1.0 - CLAVICLE) * half, 0.0, 0.0)),
            (f"{side}LowerArm", f"{side}UpperArm", (sign * body.upper_arm, 0.0, 0.0)),
            (f"{side}Hand", f"{side}LowerArm", (sign * body.forearm, 0.0, 0.0)),
        ]
    toe_drop = body.foot.ankle_height - body.foot.toe_joint_height
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        joints += [
            (f"{side}UpperLeg", "hips", (sign * 0.5 * body.hip_width, 0.0, 0.0)),
            (f"{side}LowerLeg", f"{side}UpperLeg", (0.0, -body.thigh, 0.0)),
            (f"{side}Foot", f"{side}LowerLeg", (0.0, -body.shin, 0.0)),
            (f"{side}Toes", f"{side}Foot", (0.0, -toe_drop, body.foot.ball)),
        ]
    names = [name for name, _, _ in joints]
    ends = np.zeros((len(names), 3))
    ends[names.index("head"), 1] = body.head
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        ends[names.index(f"{side}Hand"), 0] = sign * body.hand
        ends[names.index(f"{side}Toes")] = [0.0, -body.foot.toe_joint_height, body.foot.toes]
    return Skeleton(
        names=tuple(names),
        parents=tuple(-1 if p is None else names.index(p) for _, p, _ in joints),
        offsets=np.array([offset for _, _, offset in joints]),
        soles=soles_of(body.foot),
        ends=ends,
    )


def soles_of(foot: Foot) -> Float[np.ndarray, "2 3 3"]:
    """[left, right] x [heel, ball, toe tip] of a foot, meters.

    Heel and ball in the frame of the Foot joint (the ankle), toe tip in that of the Toes
    joint: what :class:`~gaitsmith.motion.skeleton.Skeleton` calls ``soles``.
    """
    points = [
        (0.0, -foot.ankle_height, -foot.heel),
        (0.0, -foot.ankle_height, foot.ball),
        (0.0, -foot.toe_joint_height, foot.toes),
    ]
    return np.array([points, points])
