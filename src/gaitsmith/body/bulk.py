"""How much room a body takes: rounded cylinders around its bones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.body.rig import spine_heights, spine_names
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.rotations import rotate

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.motion.skeleton import Skeleton

#: Stature that the radii are given for, meters, and its height of the head over the head joint.
ADULT, CROWN = 1.75, 0.157
#: How far arms hang apart, radians: elbows are the widest part of who walks.
APART = float(np.radians(9.0))


@dataclass(frozen=True, eq=False)
class Bulk:
    """K capsules: every point within ``radius`` of a segment that moves with a joint.

    Attributes
    ----------
    parts
        What each is, for people: ``head``, ``left hand``.
    joints
        Name of the joint each moves with.
    ends
        ``(K, 2, 3)`` ends of its axis in the joint's frame, meters.
    radius
        ``(K,)`` meters.
    """

    parts: tuple[str, ...]
    joints: tuple[str, ...]
    ends: Float[np.ndarray, "K 2 3"]
    radius: Float[np.ndarray, "K"]

    def axes(
        self,
        skeleton: Skeleton,
        positions: Float[np.ndarray, "F J 3"],
        world: Float[np.ndarray, "F J 4"],
    ) -> Float[np.ndarray, "F K 2 3"]:
        """Ends of the capsules' axes in the world."""
        index = [skeleton.index(name) for name in self.joints]
        turned = [rotate(world[:, index], self.ends[:, k]) for k in (0, 1)]
        return positions[:, index, None] + np.stack(turned, axis=2)


def bulk_of(body: Body) -> Bulk:
    """The capsules of ``body``.

    They hold the skin that pictures and files show (:mod:`gaitsmith.skin`), whose girths are
    those of an adult of 1.75 m times the stature: head 0.17 x 0.21 m, chest 0.23 m deep, arms
    0.08-0.11 m, thighs 0.18 m, feet 0.10 m wide.
    """
    g, h = body.height / ADULT, body.head / CROWN
    rows: list[tuple[str, str, tuple[float, float, float], tuple[float, float, float], float]] = []

    def level(
        part: str, joint: str, height: float, half: float, radius: float, front: float = 0.0
    ) -> None:
        """Across the body, ``half`` wide with its ends."""
        reach = max(half - radius, 0.0)
        rows.append((part, joint, (-reach, height, front), (reach, height, front), radius))

    names, heights = spine_names(body.spine_segments), spine_heights(body)
    hips, shoulders = 0.5 * body.hip_width, 0.5 * body.shoulder_width
    level("hips", "hips", 0.0, hips + 0.087 * g, 0.122 * g)
    for part, share, half in (
        ("hips", 0.16, hips + 0.080 * g),
        ("belly", 0.38, 0.160 * g),
        ("chest", 0.58, 0.8 * shoulders),
        ("chest", 0.75, shoulders),
    ):
        above = share * body.trunk
        i = max(int(np.searchsorted(heights, above, side="right")) - 1, 0)
        level(part, names[i], above - float(heights[i]), half, 0.120 * g)
    top = body.trunk - body.shoulder_drop - float(heights[-1])
    level("shoulders", names[-1], top, shoulders, 0.070 * g, -0.01 * g)
    level("shoulders", names[-1], top + 0.01 * g, 0.14 * g, 0.080 * g, -0.035 * g)
    rows.append(("neck", "neck", (0.0, 0.0, 0.0), (0.0, body.neck, 0.0), 0.075 * g))
    crown = body.head - 0.083 * h
    rows.append(("head", "head", (0.0, crown, -0.016 * h), (0.0, crown, 0.022 * h), 0.090 * h))
    rows.append(("head", "head", (0.0, 0.0, 0.03 * h), (0.0, 0.02 * h, 0.05 * h), 0.085 * h))
    foot, thick = body.foot, 0.052 * g
    low = thick - foot.ankle_height
    for side, sign in zip(SIDES, SIDE_SIGN.tolist(), strict=True):
        out = sign * np.array([body.upper_arm, body.forearm, body.hand - 0.03 * g])
        limbs = (
            ("upper arm", "UpperArm", (0.0, 0.0, 0.0), (out[0], 0.0, 0.0), 0.057 * g),
            ("forearm", "LowerArm", (0.0, 0.0, 0.0), (out[1], 0.0, 0.0), 0.044 * g),
            (
                "hand",
                "Hand",
                (0.0, -0.012 * g, 0.012 * g),
                (out[2], -0.012 * g, 0.012 * g),
                0.055 * g,
            ),
            ("thigh", "UpperLeg", (0.0, 0.0, -0.01 * g), (0.0, -body.thigh, 0.0), 0.097 * g),
            ("shin", "LowerLeg", (0.0, 0.0, -0.005 * g), (0.0, -body.shin, 0.0), 0.062 * g),
            ("foot", "Foot", (0.0, low, 0.7 * thick - foot.heel), (0.0, low, foot.ball), thick),
            ("toes", "Toes", (0.0, 0.0, 0.0), (0.0, 0.0, foot.toes - 0.4 * thick), thick),
        )
        rows += [(f"{side} {part}", f"{side}{j}", a, b, r) for part, j, a, b, r in limbs]
    return Bulk(
        parts=tuple(row[0] for row in rows),
        joints=tuple(row[1] for row in rows),
        ends=np.array([row[2:4] for row in rows], dtype=np.float64),
        radius=np.array([row[4] for row in rows]),
    )


def half_width(body: Body) -> float:
    """From the middle of who walks to the outside of the elbows, meters; the widest part."""
    arm = 0.5 * body.shoulder_width + np.sin(APART) * body.upper_arm
    hips = 0.5 * body.hip_width + 0.082 * body.height / ADULT
    return float(max(arm + 0.057 * body.height / ADULT, hips))
