"""Parts of the body that are mixed apart [KN12] Figure 4: torso and head, arms, legs, root."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.motion.roles import humanoid_roles

if TYPE_CHECKING:
    from gaitsmith.motion.skeleton import Skeleton

#: The parts, the root apart.
PARTS = ("torso_head", "left_arm", "right_arm", "left_leg", "right_leg")
#: Names that stand for both sides.
BOTH = {"arms": ("left_arm", "right_arm"), "legs": ("left_leg", "right_leg")}
_ARM = ("Shoulder", "UpperArm", "LowerArm", "Hand")
_LEG = ("UpperLeg", "LowerLeg", "Foot", "Toes")
_ROLES = {
    "torso_head": ("spine", "chest", "upperChest", "neck", "head"),
    **{f"{side}_arm": tuple(side + bone for bone in _ARM) for side in SIDES},
    **{f"{side}_leg": tuple(side + bone for bone in _LEG) for side in SIDES},
}
#: Roles without which a part cannot be mixed.
NEEDED = (
    *("hips", "spine", "neck", "head"),
    *(f"{side}{bone}" for side in SIDES for bone in (*_ARM[1:], *_LEG[:3])),
)


def parts_of(skeleton: Skeleton) -> dict[str, tuple[int, ...]]:
    """Joints of each part of ``skeleton``, by humanoid role; every joint but the root has one.

    A joint without a role (a finger, a twist) goes with the joint that it hangs on.

    Raises
    ------
    InfeasibleError
        If roles are missing; names them all.
    """
    roles = humanoid_roles(skeleton.names, skeleton.parents, need=()).joints
    missing = [role for role in NEEDED if role not in roles]
    if missing:
        raise InfeasibleError(
            f"the skeleton lacks {', '.join(missing)}, which a mix of styles needs; take a clip "
            "of the whole body"
        )
    home = {role: part for part, names in _ROLES.items() for role in names}
    by_joint = {joint: home[role] for role, joint in roles.items() if role in home}
    if roles["hips"] != 0:
        raise InfeasibleError(
            f"joint {skeleton.names[0]!r} is the root, but the hips are "
            f"{skeleton.names[roles['hips']]!r}; styles are mixed with the hips as the root"
        )
    for joint in range(1, len(skeleton)):  # parents come first
        by_joint.setdefault(joint, by_joint.get(skeleton.parents[joint], "torso_head"))
    return {part: tuple(sorted(j for j, p in by_joint.items() if p == part)) for part in PARTS}
