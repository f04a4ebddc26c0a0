"""Figures of motions whose values are known by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest

from gaitsmith.errors import InvalidInputError
from gaitsmith.ground import Flat
from gaitsmith.measures.promises import promises, steady_steps, step_lengths
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.motion.skeleton import Skeleton

FPS = 10.0
GROUND = Flat()
#: Hips at 1 m, legs straight down, feet 0.1 m to the sides.
JOINTS = [("hips", -1, (0.0, 1.0, 0.0))]
for _side, _x in (("left", 0.1), ("right", -0.1)):
    _at = len(JOINTS)
    JOINTS += [
        (f"{_side}UpperLeg", 0, (_x, 0.0, 0.0)),
        (f"{_side}LowerLeg", _at, (0.0, -0.5, 0.0)),
        (f"{_side}Foot", _at + 1, (0.0, -0.4, 0.0)),
        (f"{_side}Toes", _at + 2, (0.0, -0.1, 0.15)),
    ]
_SOLE = [[0.0, -0.1, -0.05], [0.0, -0.1, 0.15], [0.0, 0.0, 0.08]]
SKELETON = Skeleton(
    tuple(name for name, _, _ in JOINTS),
    tuple(parent for _, parent, _ in JOINTS),
    np.array([offset for _, _, offset in JOINTS]),
    np.array([_SOLE, _SOLE]),
)


def labels(frames, **changes):
    """Four footsteps, 0.5 m and 0.5 s apart, along +Z."""
    asked = {
        "phase": np.zeros(frames),
        "step": np.full(frames, 2),
        "footstep_side": [0, 1, 0, 1],
        "footstep_position": [[0.1, 0, 0], [-0.1, 0, 0.5], [0.1, 0, 1.0], [-0.1, 0, 1.5]],
        "footstep_heading": np.zeros(4),
        "footstep_time": [0.0, 0.0, 0.5, 1.0],
        "ground": json.dumps(GROUND.as_json()),
        "recipe": "{}",
    }
    return Labels(**asked | changes)


def motion(root, *, contacts=False, knee=0.0, **label_changes):
    """A figure with unbent legs that is carried along ``root``."""
    root = np.asarray(root, dtype=float)
    rotations = np.zeros((len(root), len(SKELETON), 4))
    rotations[..., 3] = 1.0
    for side in ("left", "right"):
        joint = SKELETON.index(f"{side}LowerLeg")
        rotations[:, joint] = [np.sin(0.5 * knee), 0.0, 0.0, np.cos(0.5 * knee)]
    flags = np.zeros((len(root), 2, 3), dtype=bool)
    flags[...] = contacts
    return Motion(
        skeleton=SKELETON,
        root_position=root,
        rotations=rotations,
        fps=FPS,
        contacts=flags,
        labels=labels(len(root), **label_changes),
    )


def standing(frames=5, up=0.0):
    return np.tile([0.0, 1.0 + up, 0.0], (frames, 1))


def figures(*args, **kwargs):
    return promises(motion(*args, **kwargs), GROUND)


def test_a_foot_that_stands_still():
    found = figures(standing(), contacts=True)
    assert found["slip_mm_max"] == 0.0
    assert found["penetration_mm_max"] == pytest.approx(0.0, abs=1e-9)
    assert found["float_mm_max"] == pytest.approx(0.0, abs=1e-9)


def test_a_sliding_foot():
    """It creeps 1 mm a frame: what counts is the whole contact, not a frame's part of it."""
    root = standing(6)
    root[:, 2] += 1e-3 * np.arange(6)
    assert figures(root, contacts=True)["slip_mm_max"] == pytest.approx(5.0)


def test_a_foot_that_slides_and_comes_back():
    root = standing(5)
    root[:, 0] += 1e-3 * np.array([0.0, 3.0, 1.0, 0.0, 0.0])
    assert figures(root, contacts=True)["slip_mm_max"] == pytest.approx(3.0)


def test_only_flagged_frames_of_one_contact_slip():
    root = standing(6)
    root[:, 2] += np.array([0.0, 1e-3, 0.5, 1.0, 1.0, 1.002])
    flags = np.zeros((6, 2, 3), dtype=bool)
    flags[[0, 1], 0, 0] = True  # slides 1 mm
    flags[[3, 4, 5], 0, 0] = True  # a contact of its own: slides 2 mm
    assert figures(root, contacts=flags)["slip_mm_max"] == pytest.approx(2.0)


@pytest.mark.parametrize("point", range(3))
@pytest.mark.parametrize("side", range(2))
def test_every_point_of_both_soles_is_looked_at(side, point):
    root = standing(3)
    root[2, 2] += 4e-3
    flags = np.zeros((3, 2, 3), dtype=bool)
    flags[:, side, point] = True
    assert figures(root, contacts=flags)["slip_mm_max"] == pytest.approx(4.0)


def test_a_floating_foot():
    flags = np.zeros((5, 2, 3), dtype=bool)
    flags[2, 1, 1] = True
    found = figures(standing(up=2e-3), contacts=flags)
    assert found["float_mm_max"] == pytest.approx(2.0)
    assert found["penetration_mm_max"] == 0.0


def test_a_foot_in_the_air_does_not_float():
    assert figures(standing(up=0.1))["float_mm_max"] == 0.0


@pytest.mark.parametrize("flags", [True, False])
def test_a_foot_in_the_ground(flags):
    """Flagged or not."""
    assert figures(standing(up=-3e-3), contacts=flags)["penetration_mm_max"] == pytest.approx(3.0)


def test_the_ground_may_lie_elsewhere():
    at = motion(standing(up=0.25), contacts=True)
    assert promises(at, Flat(0.25))["float_mm_max"] == pytest.approx(0.0, abs=1e-9)
    assert promises(at, Flat(0.26))["penetration_mm_max"] == pytest.approx(10.0)


@pytest.mark.parametrize("degrees", [0.0, 4.0, 30.0, 120.0])
def test_knee_of_a_bearing_leg(degrees):
    found = figures(standing(), contacts=True, knee=np.radians(degrees))
    assert found["knee_min_deg"] == pytest.approx(degrees, abs=1e-5)


PATH = np.stack([np.zeros(101), np.linspace(0.0, 2.0, 101)], axis=-1)


def along(aside, frames=21, far=1.5):
    root = standing(frames)
    root[:, 2] = np.linspace(0.0, far, frames)
    root[:, 0] = aside
    return root


@pytest.mark.parametrize("aside", [0.0, 0.05, -0.05])
def test_a_path_offset(aside):
    found = figures(along(aside), path=PATH)
    assert found["path_error_p95_m"] == pytest.approx(abs(aside), abs=1e-9)


def test_swaying_within_a_stride_is_no_path_error():
    """A stride is 10 frames here: a sway of that period averages out."""
    sway = 0.04 * np.sin(2.0 * np.pi * np.arange(41) / 10.0)
    found = figures(along(sway, frames=41, far=2.0), path=PATH)
    assert found["path_error_p95_m"] < 1e-3


def test_goal_error():
    found = figures(along(0.0), path=PATH)
    assert found["goal_error_m"] == pytest.approx(0.75)  # the last two N are at 1.0 and 1.5


def test_without_a_path_nothing_is_said_of_it():
    assert not {"path_error_p95_m", "goal_error_m"} & set(figures(along(0.0)))


def test_the_gait_s_own_numbers():
    found = figures(along(0.0, frames=21, far=1.5), path=PATH)
    assert found["distance_m"] == pytest.approx(1.5)
    assert found["step_length_m"] == pytest.approx(0.5)
    assert found["cadence_spm"] == pytest.approx(120.0)
    assert found["speed_mps"] == pytest.approx(1.0)
    assert found["mean_speed_mps"] == pytest.approx(1.5 / 2.0)


def test_step_lengths_do_not_count_width_and_toe_out():
    turned = 0.7  # the whole walk heads there
    way, left = (
        np.array([np.sin(turned), 0, np.cos(turned)]),
        np.array([np.cos(turned), 0, -np.sin(turned)]),
    )
    sides = np.array([0, 1, 0, 1])
    sign = np.where(sides == 0, 1.0, -1.0)
    position = np.outer([0.0, 0.4, 1.0, 1.7], way) + 0.08 * np.outer(sign, left)
    made = labels(2, footstep_position=position, footstep_heading=turned + 0.1 * sign)
    np.testing.assert_allclose(step_lengths(made), [0.6, 0.7], atol=1e-12)


def walk_labels(ends, times):
    count = len(ends)
    position = np.zeros((count, 3))
    position[:, 2] = ends
    return labels(
        2,
        footstep_side=np.arange(count) % 2,
        footstep_position=position,
        footstep_heading=np.zeros(count),
        footstep_time=times,
    )


def test_steady_steps_neither_start_nor_stop_nor_fit_the_end():
    made = walk_labels([0.0, 0.0, 0.5, 1.1, 1.7, 2.2, 2.2], [0.0, 0.0, 0.9, 1.5, 2.1, 2.7, 3.6])
    assert steady_steps(made).tolist() == [1, 2]


def test_where_no_step_is_steady_the_longer_ones_count():
    made = walk_labels([0.0, 0.0, 0.5, 0.9, 0.9], [0.0, 0.0, 0.9, 1.5, 2.4])
    assert steady_steps(made).tolist() == [0, 1]


@pytest.mark.parametrize("missing", ["labels", "contacts"])
def test_what_a_motion_must_have(missing):
    with pytest.raises(InvalidInputError, match="no labels and contacts"):
        promises(motion(standing()).with_(**{missing: None}), GROUND)
