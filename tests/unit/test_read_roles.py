"""Names of joints in the dialects of programs and data bases, and the bones they are."""

from __future__ import annotations

import pytest

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.io.bvh import MIXAMO_NAMES
from gaitsmith.motion.roles import WALKING, humanoid_roles
from gaitsmith.motion.skeleton import HUMANOID

LEGS = ("UpperLeg", "LowerLeg", "Foot", "Toes")
ARMS = ("Shoulder", "UpperArm", "LowerArm", "Hand")
#: Trunk (hips, spine, chest, upperChest, neck, head; "" for none), leg, arm; L is the side.
DIALECTS: dict[str, tuple[tuple[str, str], str, str, str]] = {
    "Mixamo": (("Left", "Right"), ("mixamorig:Hips mixamorig:Spine mixamorig:Spine1 "
               "mixamorig:Spine2 mixamorig:Neck mixamorig:Head"),
               "mixamorig:*UpLeg mixamorig:*Leg mixamorig:*Foot mixamorig:*ToeBase",
               "mixamorig:*Shoulder mixamorig:*Arm mixamorig:*ForeArm mixamorig:*Hand"),
    "Mixamo without prefix": (("Left", "Right"), "Hips Spine Spine1 Spine2 Neck Head",
                              "*UpLeg *Leg *Foot *ToeBase", "*Shoulder *Arm *ForeArm *Hand"),
    "Mixamo, prefix glued": (("Left", "Right"), ("mixamorigHips mixamorigSpine mixamorigSpine1 "
                             "mixamorigSpine2 mixamorigNeck mixamorigHead"),
                             "mixamorig*UpLeg mixamorig*Leg mixamorig*Foot mixamorig*ToeBase",
                             "mixamorig*Shoulder mixamorig*Arm mixamorig*ForeArm mixamorig*Hand"),
    "CMU of cgspeed": (("Left", "Right"), "Hips LowerBack Spine Spine1 Neck Head",
                       "*UpLeg *Leg *Foot *ToeBase", "*Shoulder *Arm *ForeArm *Hand"),
    "joints' names": (("Left", "Right"), "Hips lowerback Chest Chest2 lowerneck Head",
                      "*Hip *Knee *Ankle *Toe", "*Collar *Shoulder *Elbow *Wrist"),
    "ACCAD": (("Left", "Right"), "Hips ToSpine Spine Spine1 Neck Head",
              "*UpLeg *Leg *Foot *ToeBase", "*Shoulder *Arm *ForeArm *Hand"),
    "Bandai-Namco": (("L", "R"), "Hips Spine Chest - Neck Head",
                     "UpperLeg_* LowerLeg_* Foot_* Toes_*",
                     "Shoulder_* UpperArm_* LowerArm_* Hand_*"),
    "3ds Max": (("L", "R"), ("Bip01~Pelvis Bip01~Spine Bip01~Spine1 Bip01~Spine2 Bip01~Neck "
                "Bip01~Head"), "Bip01~*~Thigh Bip01~*~Calf Bip01~*~Foot Bip01~*~Toe0",
                "Bip01~*~Clavicle Bip01~*~UpperArm Bip01~*~Forearm Bip01~*~Hand"),
    "Valve": (("L", "R"), ("ValveBiped.Bip01_Pelvis ValveBiped.Bip01_Spine "
              "ValveBiped.Bip01_Spine1 ValveBiped.Bip01_Spine2 ValveBiped.Bip01_Neck1 "
              "ValveBiped.Bip01_Head1"),
              ("ValveBiped.Bip01_*_Thigh ValveBiped.Bip01_*_Calf ValveBiped.Bip01_*_Foot "
              "ValveBiped.Bip01_*_Toe0"),
              ("ValveBiped.Bip01_*_Clavicle ValveBiped.Bip01_*_UpperArm "
              "ValveBiped.Bip01_*_Forearm ValveBiped.Bip01_*_Hand")),
    "Blender": (("L", "R"), "hips spine chest upper_chest neck head",
                "thigh.* shin.* foot.* toe.*", "shoulder.* upper_arm.* forearm.* hand.*"),
    "Unreal": (("l", "r"), "pelvis spine_01 spine_02 spine_03 neck_01 head",
               "thigh_* calf_* foot_* ball_*", "clavicle_* upperarm_* lowerarm_* hand_*"),
    "VRoid": (("L", "R"), ("J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_UpperChest "
              "J_Bip_C_Neck J_Bip_C_Head"),
              "J_Bip_*_UpperLeg J_Bip_*_LowerLeg J_Bip_*_Foot J_Bip_*_ToeBase",
              "J_Bip_*_Shoulder J_Bip_*_UpperArm J_Bip_*_LowerArm J_Bip_*_Hand"),
    "Acclaim": (("l", "r"), "root lowerback upperback thorax lowerneck head",
                "*femur *tibia *foot *toes", "*clavicle *humerus *radius *wrist"),
    "OpenSim": (("l", "r"), "pelvis torso - - - head", "femur_* tibia_* talus_* toes_*",
                "scapula_* humerus_* ulna_* hand_*"),
    "Daz": (("l", "r"), "pelvis abdomenLower chestLower - neckLower head",
            "*ThighBend *Shin *Foot *Toe", "*Collar *ShldrBend *ForearmBend *Hand"),
    "SMPL": (("L", "R"), "Pelvis Spine1 Spine2 Spine3 Neck Head", "*_Hip *_Knee *_Ankle *_Foot",
             "*_Collar *_Shoulder *_Elbow *_Wrist"),
    "capitals": (("LEFT", "RIGHT"), "HIPS SPINE CHEST - NECK HEAD", "*UPLEG *LEG *FOOT *TOEBASE",
                 "*SHOULDER *ARM *FOREARM *HAND"),
    "lower case, behind": (("left", "right"), "hips spine chest - neck head",
                           "thigh_* shin_* foot_* toe_*", "clavicle_* upperarm_* forearm_* hand_*"),
}  # fmt: skip


def rig(dialect: str) -> tuple[list[str], list[int], dict[str, str]]:
    """Joints of a dialect, parents, and the name that each role should find."""
    sides, trunk, leg, arm = DIALECTS[dialect]
    want: dict[str, str] = {}
    parent_of = dict(HUMANOID)
    for role, name in zip(
        ("hips", "spine", "chest", "upperChest", "neck", "head"), trunk.split(), strict=True
    ):
        if name != "-":
            want[role] = name.replace("~", " ")
    for side, word in zip(SIDES, sides, strict=True):
        for parts, names in ((ARMS, arm), (LEGS, leg)):
            for part, name in zip(parts, names.split(), strict=True):
                want[f"{side}{part}"] = name.replace("*", word).replace("~", " ")
    roles = list(want)
    parents = []
    for role in roles:
        parent = parent_of[role]
        while parent is not None and parent not in want:
            parent = parent_of[parent]
        parents.append(-1 if parent is None else roles.index(parent))
    return list(want.values()), parents, want


@pytest.mark.parametrize("with_parents", [True, False])
@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_dialect_is_understood(dialect, with_parents):
    names, parents, want = rig(dialect)
    found = humanoid_roles(names, parents if with_parents else None)
    assert {role: names[joint] for role, joint in found.joints.items()} == want
    assert found.unassigned == ()


def test_our_own_names_and_those_we_write():
    names = [name for name, _ in HUMANOID]
    assert humanoid_roles(names).joints == {name: i for i, name in enumerate(names)}
    written = [MIXAMO_NAMES[name] for name in names]
    assert humanoid_roles(written).joints == {name: i for i, name in enumerate(names)}


def test_helpers_fingers_and_twists_are_left_over():
    text = """joint_Root Hips LHipJoint LeftUpLeg LeftUpLegRoll LeftLeg LeftFoot LeftToeBase
        LeftToe_End RightUpLeg RightLeg RightFoot Spine Neck Head HeadTop_End LeftArm LeftForeArm
        LeftHand LeftHandThumb1 LeftFingerBase ik_foot_l"""
    names = text.split()
    left = {names[joint] for joint in humanoid_roles(names).unassigned}
    assert left == {
        *("joint_Root", "LHipJoint", "LeftUpLegRoll", "LeftToe_End", "HeadTop_End"),
        *("LeftHandThumb1", "LeftFingerBase", "ik_foot_l"),
    }


def test_a_long_spine_gives_its_first_middle_and_last_joint():
    names = ["Hips", *(f"Spine{i}" for i in range(5)), "Neck", "Head"]
    found = humanoid_roles(names, range(-1, 7), need=()).joints
    assert [names[found[r]] for r in ("spine", "chest", "upperChest")] == [
        *("Spine0", "Spine2", "Spine4"),
    ]


def test_hips_are_what_both_legs_hang_on_whatever_the_name():
    """Blender's first spine bone is its hips; a pelvis beside the legs is none."""
    names = ["spine", "spine.001", "spine.002", "pelvis.L", "thigh.L", "shin.L", "foot.L",
             "thigh.R", "shin.R", "foot.R"]  # fmt: skip
    parents = [-1, 0, 1, 0, 0, 4, 5, 0, 7, 8]
    assert humanoid_roles(names, parents).joints["hips"] == 0
    names = ["Root", "Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "RightUpLeg", "RightLeg",
             "RightFoot", "Spine"]  # fmt: skip
    assert humanoid_roles(names, [-1, 0, 0, 2, 3, 0, 5, 6, 1]).joints["hips"] == 0


def test_a_shin_that_hangs_on_no_thigh_is_none():
    names = ["Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "RightUpLeg", "RightLeg", "RightFoot"]
    with pytest.raises(InfeasibleError, match="leftLowerLeg, leftFoot, which"):
        humanoid_roles(names, [-1, 0, 0, 1, 0, 4, 5])


def test_what_walking_needs_is_named():
    with pytest.raises(InfeasibleError, match="hips, leftUpperLeg") as error:
        humanoid_roles(["tail", "fin"])
    assert all(role in str(error.value) for role in WALKING)
    assert "tail, fin" in str(error.value)
    assert humanoid_roles(["tail", "fin"], need=()).joints == {}
    assert humanoid_roles([], need=()).unassigned == ()
