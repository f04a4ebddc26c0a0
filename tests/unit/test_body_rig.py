from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.body.presets import BODIES, body_from
from gaitsmith.body.proportions import SHORTEST, TALLEST, body_from_height
from gaitsmith.body.rig import skeleton_of, spine_heights, spine_names
from gaitsmith.conventions import BALL, HEEL, SIDE_SIGN, SIDES, TOE
from gaitsmith.errors import InvalidInputError
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.motion.skeleton import HUMANOID

heights = st.floats(SHORTEST, TALLEST)
spines = st.integers(1, 40)


def test_three_segments_are_the_humanoid_in_its_order():
    skeleton = skeleton_of(body_from("adult"))
    parents = [None if p < 0 else skeleton.names[p] for p in skeleton.parents]
    assert tuple(zip(skeleton.names, parents, strict=True)) == HUMANOID


@given(heights, spines)
def test_rest_pose_is_the_body(height, segments):
    body = body_from_height(height, spine_segments=segments)
    skeleton = skeleton_of(body)
    at = dict(zip(skeleton.names, skeleton.rest_positions(), strict=True))
    assert at["hips"] == pytest.approx([0, body.hip_height, 0], abs=1e-15)
    assert at["neck"] == pytest.approx([0, body.hip_height + body.trunk, 0], abs=1e-12)
    assert at["head"] + [0, body.head, 0] == pytest.approx([0, height, 0], abs=1e-12)
    shoulder = body.hip_height + body.trunk - body.shoulder_drop
    for side, sign in zip(SIDES, SIDE_SIGN, strict=True):
        hip = np.array([sign * body.hip_width / 2, body.hip_height, 0.0])
        assert at[f"{side}UpperLeg"] == pytest.approx(hip, abs=1e-12)
        assert at[f"{side}LowerLeg"] == pytest.approx(hip - [0, body.thigh, 0], abs=1e-12)
        assert at[f"{side}Foot"] == pytest.approx(hip - [0, body.leg_length, 0], abs=1e-12)
        toes = [hip[0], body.foot.toe_joint_height, body.foot.ball]
        assert at[f"{side}Toes"] == pytest.approx(toes, abs=1e-12)
        arm = sign * (body.shoulder_width / 2)
        assert at[f"{side}UpperArm"] == pytest.approx([arm, shoulder, 0], abs=1e-12)
        arm += sign * body.upper_arm
        assert at[f"{side}LowerArm"] == pytest.approx([arm, shoulder, 0], abs=1e-12)
        arm += sign * body.forearm
        assert at[f"{side}Hand"] == pytest.approx([arm, shoulder, 0], abs=1e-12)
        assert 0 < sign * at[f"{side}Shoulder"][0] < 0.1 * height


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("toe_joint", [0.0, 0.02])
def test_soles_lie_on_the_floor_at_rest(name, toe_joint):
    from dataclasses import replace

    body = BODIES[name]()
    body = replace(body, foot=replace(body.foot, toe_joint_height=toe_joint))
    skeleton = skeleton_of(body)
    rest = np.zeros((1, len(skeleton), 4))
    rest[..., 3] = 1.0
    positions, world = forward_kinematics(skeleton, skeleton.offsets[:1], rest)
    soles = sole_positions(skeleton, positions, world)[0]
    for side, sign in enumerate(SIDE_SIGN):
        assert soles[side, :, 0] == pytest.approx([sign * body.hip_width / 2] * 3, abs=1e-12)
        assert soles[side, :, 1] == pytest.approx([0.0] * 3, abs=1e-12)
        assert soles[side, HEEL, 2] == pytest.approx(-body.foot.heel, abs=1e-12)
        assert soles[side, BALL, 2] == pytest.approx(body.foot.ball, abs=1e-12)
        assert soles[side, TOE, 2] == pytest.approx(body.foot.ball + body.foot.toes, abs=1e-12)


@given(spines)
def test_spine_names_keep_the_landmarks(segments):
    names = spine_names(segments)
    assert len(set(names)) == len(names) == segments
    assert names[0] == "spine"
    if segments >= 3:
        assert names[-1] == "upperChest"
        assert "chest" in names[1:-1]
    body = body_from_height(1.75, spine_segments=segments)
    skeleton = skeleton_of(body)
    for child in ("neck", "leftShoulder", "rightShoulder"):
        assert skeleton.names[skeleton.parents[skeleton.index(child)]] == names[-1]
    heights = spine_heights(body)
    assert heights[0] > 0
    assert (np.diff(heights) > 0).all()
    assert heights[-1] < body.trunk


def test_short_spines():
    assert spine_names(1) == ("spine",)
    assert spine_names(2) == ("spine", "chest")
    with pytest.raises(InvalidInputError, match="at least one joint"):
        spine_names(0)
