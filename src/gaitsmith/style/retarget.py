"""Cycles of different people brought to one body, so that they can be mixed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import BALL, SIDES
from gaitsmith.gait.learn import standing_feet
from gaitsmith.geometry.rotations import IDENTITY, exp, log, multiply
from gaitsmith.motion.roles import humanoid_roles

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.gait.cycle import Cycle
    from gaitsmith.motion.skeleton import Skeleton


def on_body(cycle: Cycle, body: Body) -> Cycle:
    """``cycle`` as ``body`` would walk it: the same joint angles, lengths by the legs.

    Heights and ways are scaled by the length of the legs, times by its square root (equal Froude
    numbers); how far the stride gets follows from the feet, which stand still. A spine with
    another number of joints shares the turn of the whole.

    A cycle of ``body`` itself comes back as it is.
    """
    skeleton = skeleton_of(body)
    if same_bones(cycle.skeleton, skeleton):
        return cycle
    ratio = leg_of(skeleton) / leg_of(cycle.skeleton)
    moved = cycle.with_(
        skeleton=skeleton,
        center=cycle.center * ratio,
        rotations=_by_role(cycle.skeleton, cycle.rotations, skeleton),
        stride_length=cycle.stride_length * ratio,
        duration=cycle.duration * float(np.sqrt(ratio)),
    )
    length = cycle.stride_length * stride_by_feet(moved) / stride_by_feet(cycle)
    moved = moved.with_(stride_length=length)
    return moved.with_(center=moved.center - [0.0, standing_feet(moved).height, 0.0])


def same_bones(one: Skeleton, other: Skeleton) -> bool:
    """Whether poses of one skeleton are poses of the other."""
    alike = one.names == other.names and np.array_equal(one.offsets[1:], other.offsets[1:])
    if one.soles is None or other.soles is None:
        return alike and one.soles is other.soles
    return alike and np.array_equal(one.soles, other.soles)


def leg_of(skeleton: Skeleton) -> float:
    """Hip to ankle of a straight leg, meters."""
    bones = [skeleton.offsets[skeleton.index(f"left{bone}")] for bone in ("LowerLeg", "Foot")]
    return float(sum(np.linalg.norm(bone) for bone in bones))


def _by_role(
    old: Skeleton, rotations: Float[np.ndarray, "K J 4"], new: Skeleton
) -> Float[np.ndarray, "K N 4"]:
    """Rotations of joints with the same role; of a trunk with other joints, shares of its turn."""
    roles = humanoid_roles(old.names, old.parents).joints
    out = np.tile(IDENTITY, (len(rotations), len(new), 1))
    trunks = [
        [n for n in names if n.startswith("spine") or n in ("chest", "upperChest")]
        for names in (old.names, new.names)
    ]
    for joint, name in enumerate(new.names):
        if name in old.names:
            out[:, joint] = rotations[:, old.index(name)]
        elif name in roles:
            out[:, joint] = rotations[:, roles[name]]
    if trunks[0] != trunks[1] and trunks[1]:
        total = np.tile(IDENTITY, (len(rotations), 1))
        for name in trunks[0]:
            total = multiply(total, rotations[:, old.index(name)])
        share = exp(log(total) / len(trunks[1]))
        for name in trunks[1]:
            out[:, new.index(name)] = share
    return out


def stride_by_feet(cycle: Cycle) -> float:
    """How far the hips get in a stride, judged by the balls of feet that stand flat, meters.

    In the frame that travels with the walk a foot that stands goes back at the speed of the walk;
    the slope of its way over the stride phase, mean of both feet by the time they stand.
    """
    count = len(cycle.center) // cycle.strides
    phase = np.arange(count) / count
    balls = cycle.feet[1][:, :, BALL, 2]
    slopes, weights = np.empty(2), np.empty(2)
    for side in range(len(SIDES)):
        strike, flat, off, _ = cycle.events[side]
        first = strike + (flat - strike) % 1.0
        weights[side] = (off - flat) % 1.0
        at = np.linspace(first, first + weights[side], 33)
        way = np.interp(at, np.concatenate([phase, phase + 1.0, [2.0]]), _tiled(balls[:, side]))
        slopes[side] = np.polyfit(at, way, 1)[0]
    return float(-(slopes @ weights) / weights.sum())


def _tiled(values: Float[np.ndarray, "n"]) -> Float[np.ndarray, "m"]:
    return np.concatenate([values, values, values[:1]])
