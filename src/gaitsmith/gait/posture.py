"""Small changes of posture to a Cycle, each leaving what it does not name where it was."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.rotations import about, exp, inverse, log, multiply

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.gait.cycle import Cycle

#: Shoulder joint forward per forward swing of the arm about its middle.
CLAVICLE = 0.1
#: Resting wrist: towards the palm and towards the little finger, radians; share of the elbow's
#: swing that the hand hangs behind by, and by what part of a stride it is late.
WRIST, ULNAR, TRAIL, LATE = float(np.radians(6.0)), float(np.radians(5.0)), 0.25, 0.06
#: Shares of the chest's turn and list that a head takes: 3-4 and 2-4 deg in people (ACCAD, CMU 12)
#: over chests that turn 9-14 and list 2-4 deg.
HEAD_TURN, HEAD_LIST = 0.28, 0.6


def trunk_names(cycle: Cycle) -> tuple[str, ...]:
    """Joints of the cycle's trunk, lowest first."""
    names = cycle.skeleton.names
    return tuple(n for n in names if n.startswith("spine") or n in ("chest", "upperChest"))


def mean_rotation(q: Float[np.ndarray, "K 4"]) -> Float[np.ndarray, "4"]:
    """Rotation about which the excursions of ``q`` average to nothing."""
    mean = q.sum(0) / np.linalg.norm(q.sum(0))
    for _ in range(6):
        mean = multiply(mean, exp(log(multiply(inverse(mean), q)).mean(0)))
    return mean / np.linalg.norm(mean)


def with_pelvis_tilt(cycle: Cycle, angle: float) -> Cycle:
    """The pelvis tipped forward by ``angle`` radians about the line of the hip joints.

    Thighs, hip joints and the upper end of the trunk stay where they are: the small of the
    back takes the turn, its joints alike.
    """
    rotations, index = np.array(cycle.rotations), cycle.skeleton.index
    tip, back = about("x", angle), about("x", -angle)
    rotations[:, index("hips")] = multiply(rotations[:, index("hips")], tip)
    trunk = trunk_names(cycle)
    total = np.broadcast_to(back, (len(rotations), 4))
    for name in trunk:
        total = multiply(total, rotations[:, index(name)])
    share = exp(log(total) / len(trunk))
    for name in trunk:
        rotations[:, index(name)] = share
    for side in SIDES:
        leg = index(f"{side}UpperLeg")
        rotations[:, leg] = multiply(back, rotations[:, leg])
    return cycle.with_(rotations=rotations)


def with_head_that_follows(cycle: Cycle) -> Cycle:
    """A head that was kept quite still goes a little with the chest: it turns and lists."""
    rotations, index = np.array(cycle.rotations), cycle.skeleton.index
    chest = rotations[:, index("hips")]
    for name in trunk_names(cycle):
        chest = multiply(chest, rotations[:, index(name)])
    away = log(multiply(chest, inverse(mean_rotation(chest))))
    follow = exp(away * np.array([0.0, HEAD_TURN, HEAD_LIST]))
    neck, head = rotations[:, index("neck")], rotations[:, index("head")]
    seen = multiply(neck, head)
    wanted = multiply(inverse(chest), multiply(follow, multiply(chest, seen)))
    more = exp(0.5 * log(multiply(wanted, inverse(seen))))
    rotations[:, index("neck")] = multiply(more, neck)
    rotations[:, index("head")] = multiply(inverse(rotations[:, index("neck")]), wanted)
    return cycle.with_(rotations=rotations)


def with_easy_shoulders_and_hands(cycle: Cycle) -> Cycle:
    """Shoulders that go a little with the arms, hands that hang at rest and trail behind.

    For a cycle that was measured without them. The upper arms keep their directions.
    """
    rotations, index = np.array(cycle.rotations), cycle.skeleton.index
    late = -round(LATE * len(rotations) / cycle.strides)
    for side, sign in zip(SIDES, SIDE_SIGN, strict=True):
        shoulder, upper, lower, hand = (
            index(f"{side}{part}") for part in ("Shoulder", "UpperArm", "LowerArm", "Hand")
        )
        arm = rotations[:, upper]
        swing = -log(multiply(arm, inverse(mean_rotation(arm))))[:, 0]
        before = np.array(rotations[:, shoulder])
        rotations[:, shoulder] = multiply(before, about("y", -sign * CLAVICLE * swing))
        moved = multiply(inverse(rotations[:, shoulder]), before)
        rotations[:, upper] = multiply(moved, arm)
        bend = sign * log(rotations[:, lower])[:, 1]  # flexion is negative
        trail = TRAIL * np.roll(bend - bend.mean(), -late)
        rest = multiply(about("y", sign * (ULNAR - trail)), about("z", -sign * WRIST))
        rotations[:, hand] = multiply(rotations[:, hand], rest)
    return cycle.with_(rotations=rotations)
