"""What a component does: how far it moves its part, and in which plane [KN12] section 4.2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.geometry.rotations import exp, multiply, rotate
from gaitsmith.motion.kinematics import forward_kinematics

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jaxtyping import Float, Int

    from gaitsmith.style.components import Components
    from gaitsmith.style.examples import Examples

#: Planes by the axis across them: X is left, Y up, Z ahead.
PLANES = ("sagittal", "transverse", "coronal")


def displacements(
    examples: Examples, components: Mapping[str, Components]
) -> dict[str, Float[np.ndarray, "L Nc"]]:
    """How far the joints of a part are from where they were, without one component, meters.

    [KN12] Eq. 5: the mean over the key frames of an example of the summed distances of the part's
    joints and of the ends of its last bones; the root at the origin as the example turns it, other
    parts as they are. Printed with one letter for the component left out and the summation;
    ``V_j`` without it is meant.
    """
    out = {}
    for part, found in components.items():
        joints, rows = list(found.joints), []
        for keys in examples.keys:
            whole = _places(examples, keys, joints)
            # (Nc, N, P, 3): logs of the part less one component
            less = found.mix.T[:, None] * found.of(keys).T[..., None]
            moved = keys[:, joints] - less.reshape(len(found), len(keys), len(joints), 3)
            poses = np.broadcast_to(keys, (len(found), *keys.shape)).copy()
            poses[:, :, joints] = moved
            there = _places(examples, poses.reshape(-1, *keys.shape[1:]), joints)
            there = there.reshape(len(found), len(keys), *whole.shape[1:])
            rows.append(np.linalg.norm(there - whole, axis=-1).sum(-1).mean(-1))
        out[part] = np.array(rows)
    return out


def ranked(
    displaced: Float[np.ndarray, "L Nc"], active: Sequence[int] | None = None
) -> Int[np.ndarray, "Nc"]:
    """Components of a part, those first that do most in the ``active`` examples together."""
    rows = displaced if active is None else displaced[list(active)]
    return np.argsort(-rows.sum(axis=0), kind="stable")


def planes(examples: Examples, components: Mapping[str, Components]) -> dict[str, tuple[str, ...]]:
    """The plane in which each component mainly moves its part [KN12] Table 2.

    That out of which the joints move least when the component swings about the mean pose.
    """
    out = {}
    count = len(examples.skeleton)
    for part, found in components.items():
        joints = list(found.joints)
        poses = np.zeros((2, len(found), count, 3))
        swing = found.mix.T.reshape(len(found), len(joints), 3)
        poses[0][:, joints], poses[1][:, joints] = swing, -swing
        there = _places(examples, poses.reshape(-1, count, 3), joints)
        way = there[: len(found)] - there[len(found) :]
        across = (way**2).sum(axis=1)
        out[part] = tuple(PLANES[axis] for axis in across.argmin(axis=1))
    return out


def _places(
    examples: Examples, logs: Float[np.ndarray, "n J 3"], joints: Sequence[int]
) -> Float[np.ndarray, "n P 3"]:
    """Positions of joints and of the ends of bones that have no joint, meters."""
    skeleton = examples.skeleton
    turned = multiply(examples.reference, exp(logs))
    places, world = forward_kinematics(skeleton, np.zeros((len(logs), 3)), turned)
    out = [places[:, joint] for joint in joints]
    if skeleton.ends is not None:
        out += [
            places[:, joint] + rotate(world[:, joint], skeleton.ends[joint])
            for joint in joints
            if skeleton.ends[joint].any()
        ]
    return np.stack(out, axis=1)
