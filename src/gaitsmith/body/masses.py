"""How a body's mass is shared out, and where its center of mass is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jaxtyping import Float

    from gaitsmith.body.body import Body
    from gaitsmith.motion.skeleton import Skeleton

# de Leva 1996, Table 4: (share of body mass, center of mass as a share of the length) of men
# and of women, lengths from -> to as named. A walker of no stated sex gets the mean of both.
_DE_LEVA: dict[str, tuple[tuple[float, float], tuple[float, float]]] = {
    "head": ((0.0694, 0.5002), (0.0668, 0.4841)),  # vertex -> cervicale, with the neck
    "trunk": ((0.4346, 0.5138), (0.4257, 0.4964)),  # cervicale -> mid-hip
    "upper_arm": ((0.0271, 0.5772), (0.0255, 0.5754)),  # shoulder -> elbow
    "forearm": ((0.0162, 0.4574), (0.0138, 0.4559)),  # elbow -> wrist
    "hand": ((0.0061, 0.3624), (0.0056, 0.3427)),  # wrist -> tip of the third finger
    "thigh": ((0.1416, 0.4095), (0.1478, 0.3612)),  # hip -> knee
    "shank": ((0.0433, 0.4395), (0.0481, 0.4352)),  # knee -> ankle
    "foot": ((0.0137, 0.4415), (0.0129, 0.4014)),  # heel -> tip of the longest toe
}


@dataclass(frozen=True)
class Segment:
    """A part of the body with mass.

    Attributes
    ----------
    name
        ``head``, ``trunk``, or a side and a part as in ``left_thigh``.
    mass
        Kilograms.
    proximal, distal
        Names of the joints whose line the center of mass lies on.
    com
        Where on that line: 0 at the proximal joint, 1 at the distal one; above 1 for head
        and hand, which have no joint at their far end.
    """

    name: str
    mass: float
    proximal: str
    distal: str
    com: float


def segments_of(body: Body) -> tuple[Segment, ...]:
    """The 14 segments of ``body``; their masses add up to ``body.mass``.

    Notes
    -----
    Mass shares and centers of mass: de Leva 1996, *Adjustments to Zatsiorsky-Seluyanov's
    segment inertia parameters*, J. Biomech. 29(9), Table 4, the mean of men and women,
    normalised to a sum of 1 (the printed columns add up to 1.0000 and .9999). They are those
    of young adults; children's heads are heavier and legs lighter than this.

    The centers are placed by joints alone, so three of them are ours: head and neck are one
    piece in line with the neck, the hand is in line with the forearm, and the foot's center is
    on the line from ankle to ball, above the point that de Leva gives along the sole. The
    trunk's is on the straight line from hips to neck.
    """
    mass, com = {}, {}
    for part, (man, woman) in _DE_LEVA.items():
        mass[part] = 0.5 * (man[0] + woman[0])
        com[part] = 0.5 * (man[1] + woman[1])
    pairs = ("upper_arm", "forearm", "hand", "thigh", "shank", "foot")
    whole = sum(mass[part] * (2.0 if part in pairs else 1.0) for part in mass)
    kilograms = {part: share * body.mass / whole for part, share in mass.items()}

    foot = body.foot
    lines = {
        "upper_arm": ("UpperArm", "LowerArm", com["upper_arm"]),
        "forearm": ("LowerArm", "Hand", com["forearm"]),
        "hand": ("LowerArm", "Hand", 1.0 + com["hand"] * body.hand / body.forearm),
        "thigh": ("UpperLeg", "LowerLeg", com["thigh"]),
        "shank": ("LowerLeg", "Foot", com["shank"]),
        "foot": ("Foot", "Toes", (com["foot"] * foot.length - foot.heel) / foot.ball),
    }
    head = (1.0 - com["head"]) * (body.neck + body.head) / body.neck
    segments = [
        Segment("head", kilograms["head"], "neck", "head", head),
        Segment("trunk", kilograms["trunk"], "hips", "neck", 1.0 - com["trunk"]),
    ]
    for side in SIDES:
        segments += [
            Segment(f"{side}_{part}", kilograms[part], f"{side}{start}", f"{side}{end}", share)
            for part, (start, end, share) in lines.items()
        ]
    return tuple(segments)


def center_of_mass(
    skeleton: Skeleton,
    positions: Float[np.ndarray, "*n joints 3"],
    segments: Sequence[Segment],
) -> Float[np.ndarray, "*n 3"]:
    """Where the center of mass of the whole body is, meters.

    Parameters
    ----------
    skeleton
        Names of the joints of ``positions``.
    positions
        ``(*n, J, 3)`` world positions of the joints, meters.
    segments
        What has mass: :func:`segments_of` of the body.

    Raises
    ------
    UnknownNameError
        If the skeleton lacks a joint that a segment needs.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape[-2:] != (len(skeleton), 3):
        raise InvalidInputError(
            f"positions must end in ({len(skeleton)}, 3), got shape {positions.shape}"
        )
    # a sum over segments of points on lines between joints is one weight a joint
    weights = np.zeros(len(skeleton))
    for segment in segments:
        weights[skeleton.index(segment.proximal)] += segment.mass * (1.0 - segment.com)
        weights[skeleton.index(segment.distal)] += segment.mass * segment.com
    total = float(weights.sum())
    if not total > 0.0:
        raise InvalidInputError(f"segments must have mass, got {total:g} kilograms in all")
    return np.matmul(weights / total, positions)
