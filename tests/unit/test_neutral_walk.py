"""`neutral` on any body at any pace walks as people are measured to."""

from __future__ import annotations

import csv
from functools import cache

import numpy as np
import pytest
from stride_numbers import apart, stride_numbers

import gaitsmith
from gaitsmith.body.proportions import body_from_height
from gaitsmith.conventions import SIDES
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.gait.posture import (
    with_easy_shoulders_and_hands,
    with_head_that_follows,
    with_pelvis_tilt,
)
from gaitsmith.motion.kinematics import forward_kinematics, motion_kinematics

#: Slow to fast for 1.75 m, meters per second; others keep the Froude number.
SPEEDS = (0.6, 0.9, 1.25, 1.6, 1.9)
BODIES = (1.2, 1.75, 2.1)


@cache
def numbers(height, speed):
    leg = body_from_height(height).leg_length
    speed = speed * np.sqrt(leg / body_from_height(1.75).leg_length)
    motion = gaitsmith.walk(
        distance=9.0 * leg, body=height, speed=speed, fps=120, start="walk", stop="walk"
    )
    return stride_numbers(motion, which=1)


def swing(curve):
    return float(np.ptp(curve, axis=0).mean())


everybody = pytest.mark.parametrize("height", BODIES)
every_pace = pytest.mark.parametrize("speed", SPEEDS)


def measured_band(folder, speed_class, joint):
    path = folder / "sharealike/normative/joint_angles_by_speed.csv"
    with path.open(encoding="utf-8") as file:
        rows = [
            [float(r["percent_cycle"]), float(r["mean_deg"]), float(r["sd_deg"])]
            for r in csv.DictReader(file)
            if (r["dataset"], r["speed_class"], r["joint"], r["axis"])
            == ("Schwartz2008", speed_class, joint, "X")
        ]
    return np.array(rows).T


@pytest.mark.parametrize(
    ("speed", "speed_class", "share"),
    [(0.75, "Slow", 0.88), (1.25, "Free", 0.95), (1.6, "Fast", 0.85)],
)
def test_joints_lie_inside_the_band_of_people(measured_data, speed, speed_class, share):
    """Mean +- 2 SD of Schwartz 2008, pooled over hip, knee and ankle of both sides."""
    stride = numbers(1.75, speed)
    inside = []
    for j, joint in enumerate(("hip", "knee", "ankle")):
        percent, mean, sd = measured_band(measured_data, speed_class, joint)
        for side in (0, 1):
            curve = np.append(stride.joints[:, side, j], stride.joints[0, side, j])
            value = np.interp(percent, np.arange(101.0), curve)
            inside.append(np.abs(value - mean) <= 2.0 * sd)
    assert np.mean(inside) >= share


@everybody
@every_pace
def test_arms_swing_against_their_own_leg(height, speed):
    stride = numbers(height, speed)
    for side in (0, 1):
        assert np.corrcoef(stride.arm[:, side], stride.thigh[:, side])[0, 1] < -0.8
    # healthy men swing by 24.6 +- 2.4 deg at their own pace
    assert swing(stride.arm) > (15.0 if speed >= 0.9 else 8.0)


@everybody
def test_arms_swing_more_when_faster(height):
    """17 deg at 0.90 m/s, 42 at 1.65 (CMU 12, ACCAD); elbows 24-35 deg bent, 20-39 deg of swing."""
    sizes = [swing(numbers(height, speed).arm) for speed in SPEEDS]
    assert (np.diff(sizes) > 3.0).all()
    assert sizes[1] == pytest.approx(17.0, abs=3.0)
    assert 25.0 < sizes[3] < 45.0
    for speed in SPEEDS[1:]:
        elbow = numbers(height, speed).elbow
        assert 22.0 < elbow.mean() < 37.0
        assert 12.0 < swing(elbow) < 40.0


@everybody
@every_pace
def test_pelvis_turns_lists_rises_and_sways_as_pelves_do(height, speed):
    """Schwartz 2008 by class: rotation 6.9-16, list 4.3-12.8 deg."""
    stride = numbers(height, speed)
    assert 3.5 < swing(stride.pelvis[:, 1]) < 14.0
    assert 4.0 < swing(stride.pelvis[:, 2]) < 12.0
    assert 2.0 < stride.pelvis[:, 0].mean() < 12.0
    assert swing(stride.pelvis[:, 0]) < 6.0
    size = height / 1.75
    assert 0.010 * size < stride.bob < 0.070 * size
    assert 0.020 * size < stride.sway < 0.085 * size


def test_at_1_25_meters_per_second():
    """The figures of the recipe: list, rotation, rise and sway of the pelvis, head."""
    stride = numbers(1.75, 1.25)
    assert swing(stride.arm) >= 15.0
    assert 4.0 < swing(stride.pelvis[:, 1]) < 14.0
    assert 4.0 < swing(stride.pelvis[:, 2]) < 12.0
    assert 0.02 < stride.bob < 0.06
    assert 0.02 < stride.sway < 0.06
    assert np.abs(stride.head[:, 0]).max() < 5.0


@everybody
def test_with_the_speed_pelvis_and_bob_grow_and_sway_falls(height):
    """Schwartz 2008; 12.9 deg of list and 15.7 cm of rise per meter of step (CMU 07);
    sway 12.7 - 3.1 v cm (CMU 07)."""  # fmt: skip
    strides = [numbers(height, speed) for speed in SPEEDS]
    for grows in (
        [swing(s.pelvis[:, 1]) for s in strides],
        [swing(s.pelvis[:, 2]) for s in strides],
        [s.bob for s in strides],
        [-s.sway for s in strides],
        [s.pelvis[:, 0].mean() for s in strides[1:]],
    ):
        assert (np.diff(grows) > 0.0).all()


@everybody
@pytest.mark.parametrize(("speed", "least", "most"), [(0.9, 0.25, 0.55), (1.6, 0.45, 0.7)])
def test_hips_rise_by_part_of_the_compass_arc(height, speed, least, most):
    """27 % of L - sqrt(L^2 - (step/2)^2) at 0.90 m/s, 58-70 % above 1.1 (pelvis markers); the
    hip joints of the measured man, 55 %."""  # fmt: skip
    stride, leg = numbers(height, speed), body_from_height(height).hip_height
    arc = leg - np.sqrt(leg**2 - 0.25 * stride.step**2)
    assert least < stride.bob / arc < most


@everybody
@pytest.mark.parametrize("speed", [0.9, 1.25, 1.6])
def test_the_body_keeps_an_even_pace(height, speed):
    """Ripple of the pelvis's speed, 0.31 m/s at 0.90, 0.47 at 1.25, 0.57 at 1.44, 0.34 at 1.65."""
    stride = numbers(height, speed)
    path = np.append(stride.root[:, 2], stride.root[0, 2] + 2.0 * stride.step)
    pace = np.diff(path) * len(stride.root) * stride.speed / (2.0 * stride.step)
    assert 0.12 < np.ptp(pace) / stride.speed < 0.45


@everybody
@every_pace
def test_share_of_stance(height, speed):
    """64.2 - 3.5 v % (Kirtley 1985) to 71.1 - 3.9 v % (CMU 07, from marker paths), +- 3 %."""
    stride = numbers(height, speed)
    v = stride.speed * np.sqrt(1.75 / height)
    assert 61.2 - 3.5 * v < 100.0 * stride.stance < 74.1 - 3.9 * v


@everybody
@every_pace
def test_feet_land_on_the_heel_and_leave_from_the_toes(height, speed):
    """+13 to +35 deg at heel strike; -38 - 17.5 v deg at toe-off (CMU 07, r 0.99)."""
    stride = numbers(height, speed)
    v = stride.speed * np.sqrt(1.75 / height)
    off = round(100.0 * stride.stance)
    for side in (0, 1):
        assert 13.0 < stride.foot[0, side] < 35.0
        assert stride.foot[off - 2 : off + 2, side].min() == pytest.approx(
            -38.0 - 17.5 * v, abs=8.0
        )


@everybody
def test_knees_bend_less_when_slow(height):
    """Swing 55 (slow) to 62 +- 8 deg (very fast), at 70-77 % of the stride; loading 13 to
    24 +- 6 deg (Schwartz 2008), 66 deg more per meter of step (CMU 07)."""  # fmt: skip
    strides = [numbers(height, speed) for speed in SPEEDS]
    peaks = [s.knee_peak for s in strides]
    assert (np.diff(peaks) > 0.0).all()
    assert 45.0 < peaks[0] < 65.0
    assert 60.0 < peaks[2] < 75.0
    assert peaks[-1] < 78.0
    loading = [s.joints[5:30, :, 1].max() for s in strides]
    assert (np.diff(loading) > 0.0).all()
    assert 8.0 < loading[0] < 20.0
    assert 16.0 < loading[2] < 30.0
    for s in strides:
        assert 68 <= 60 + s.joints[60:, :, 1].mean(1).argmax() <= 77


@everybody
def test_short_steps_do_not_lift_the_foot_high(height):
    """45 +- 11 deg at the very slow pace of Schwartz 2008: 45-55 deg."""
    leg = body_from_height(height).leg_length
    motion = gaitsmith.walk(distance=5.0 * leg, body=height, step_length=0.4 * leg, fps=120)
    assert 42.0 < stride_numbers(motion).knee_peak < 57.0


@everybody
def test_hips_reach_farther_when_faster(height):
    """Flexion 34 to 45, extension 2 to 8 deg (Schwartz 2008, slow to very fast), SD 5-9."""
    strides = [numbers(height, speed) for speed in SPEEDS]
    most = [s.joints[:, :, 0].max() for s in strides]
    least = [s.joints[:, :, 0].min() for s in strides]
    assert (np.diff(most) > 0.0).all()
    assert (np.diff(least) < 0.0).all()
    assert most[0] > 27.0
    assert most[-1] < 50.0
    assert least[-1] > -17.0
    assert least[0] < 2.0


@everybody
@every_pace
def test_the_head_is_level_and_looks_ahead(height, speed):
    """Head in space: 2-5 deg of pitch, 2-4 of roll, 3-4 of yaw (ACCAD, CMU 12); under 6."""
    head = numbers(height, speed).head
    assert np.abs(head[:, 0]).max() < 5.0
    assert np.abs(head.mean(0)).max() < 1.0
    assert np.ptp(head, axis=0).max() < 6.0


@everybody
def test_pelvis_and_chest_turn_together_when_slow_and_against_each_other_when_fast(height):
    """71 deg at 0.90, ~90-115 at 1.25 and 148-180 at 1.4-1.9 m/s (Lamoth 2002; clips); the chest
    turns by 9-14 deg."""  # fmt: skip
    strides = [numbers(height, speed) for speed in SPEEDS[1:]]
    apart_by = [s.phase_difference for s in strides]
    assert (np.diff(apart_by) > 0.0).all()
    assert 55.0 < apart_by[0] < 95.0
    assert 85.0 < apart_by[1] < 125.0
    assert 130.0 < apart_by[2] < 180.0
    for s in strides:
        assert 8.0 < swing(s.thorax[:, 1]) < 15.0


@everybody
def test_the_trunk_is_upright_and_leans_a_little_when_fast(height):
    """1.2 deg at 1.18, 4.5-5 at 1.65 m/s (CMU 02, ACCAD); list 1.2-4, pitch 3-4 deg."""
    strides = [numbers(height, speed) for speed in SPEEDS]
    for s in strides[:3]:
        assert -1.0 < s.thorax[:, 0].mean() < 2.5
    assert 2.5 < strides[3].thorax[:, 0].mean() < 6.0
    for s in strides:
        assert swing(s.thorax[:, 2]) < 5.0
        assert swing(s.thorax[:, 0]) < 5.0


def test_nobody_starts_by_lifting_the_knee_high():
    """The first swing brings the thigh hardly farther forward than the next ones."""
    motion = gaitsmith.walk(distance=6.0, fps=120)
    positions, _ = motion_kinematics(motion)
    index, labels = motion.skeleton.index, motion.labels
    most = []
    for step in range(2, 6):
        side = SIDES[labels.footstep_side[step]]
        first, last = (int(labels.footstep_time[i] * motion.fps) for i in (step - 1, step))
        thigh = positions[:, index(f"{side}LowerLeg")] - positions[:, index(f"{side}UpperLeg")]
        forward = np.degrees(np.arctan2(thigh[first:last, 2], -thigh[first:last, 1]))
        most.append(forward.max())
    assert most[0] < max(most[1:]) + 3.0


def test_who_stands_stands_upright_with_hanging_arms():
    motion = gaitsmith.walk(distance=3.0, fps=60)
    positions, world = motion_kinematics(motion)
    index = motion.skeleton.index
    for frame in (0, -1):
        for side in SIDES:
            upper, lower, hand = (
                positions[frame, index(f"{side}{p}")] for p in ("UpperArm", "LowerArm", "Hand")
            )
            bone, fore = lower - upper, hand - lower
            assert abs(np.degrees(np.arctan2(bone[2], -bone[1]))) < 3.0
            assert 3.0 < np.degrees(np.arctan2(abs(bone[0]), -bone[1])) < 20.0
            bend = np.arccos(bone @ fore / np.linalg.norm(bone) / np.linalg.norm(fore))
            assert 5.0 < np.degrees(bend) < 20.0
        for joint in ("upperChest", "head"):
            assert apart(world[frame, index(joint)], np.array([0.0, 0.0, 0.0, 1.0])) < 3.0


class TestPosture:
    """Each rule leaves what it does not name where it was."""

    cycle = neutral_cycle()

    def world(self, cycle):
        return forward_kinematics(cycle.skeleton, cycle.center, cycle.rotations)

    def test_tilting_the_pelvis_moves_only_the_small_of_the_back(self):
        before, turned = self.world(self.cycle)
        after, tilted = self.world(with_pelvis_tilt(self.cycle, 0.1))
        index = self.cycle.skeleton.index
        for name in ("leftFoot", "rightFoot", "leftLowerLeg", "leftUpperLeg", "rightUpperLeg"):
            np.testing.assert_allclose(after[:, index(name)], before[:, index(name)], atol=1e-12)
        assert apart(tilted[:, index("upperChest")], turned[:, index("upperChest")]).max() < 1e-6
        tip = apart(tilted[:, index("hips")], turned[:, index("hips")])
        np.testing.assert_allclose(tip, np.degrees(0.1), atol=1e-6)

    def test_the_head_follows_and_the_chest_stays(self):
        _, turned = self.world(self.cycle)
        _, now = self.world(with_head_that_follows(self.cycle))
        index = self.cycle.skeleton.index
        assert apart(now[:, index("upperChest")], turned[:, index("upperChest")]).max() < 1e-6
        assert 1.0 < apart(now[:, index("head")], turned[:, index("head")]).max() < 3.0

    def test_easy_shoulders_leave_arms_their_directions(self):
        _, turned = self.world(self.cycle)
        easy = with_easy_shoulders_and_hands(self.cycle)
        after, now = self.world(easy)
        index = self.cycle.skeleton.index
        for side in SIDES:
            for part in ("UpperArm", "LowerArm"):
                joint = index(f"{side}{part}")
                assert apart(now[:, joint], turned[:, joint]).max() < 1e-6
            hand = index(f"{side}Hand")
            assert 4.0 < apart(now[:, hand], turned[:, hand]).mean() < 12.0
            before = self.world(self.cycle)[0]
            upper = index(f"{side}UpperArm")
            assert 0.001 < np.ptp((after - before)[:, upper, 2]) < 0.02


def test_the_walk_of_the_measured_man_is_symmetric_and_his_own():
    """At its own length the walk shows the stride's angles to 3 deg, rms."""
    cycle, body = neutral_cycle(), subject()
    step = 0.5 * cycle.stride_length
    motion = gaitsmith.walk(
        distance=12 * step,
        body=body,
        step_length=step,
        cadence=120.0 / cycle.duration,
        fps=120,
        start="walk",
        stop="walk",
    )
    stride = stride_numbers(motion)
    share = np.arange(100) / 100
    center, rotations = cycle.at(share)
    positions, _ = forward_kinematics(cycle.skeleton, center, rotations)
    index = cycle.skeleton.index
    for k, side in enumerate(SIDES):
        thigh = positions[:, index(f"{side}LowerLeg")] - positions[:, index(f"{side}UpperLeg")]
        shin = positions[:, index(f"{side}Foot")] - positions[:, index(f"{side}LowerLeg")]
        sine = np.linalg.norm(np.cross(thigh, shin), axis=-1)
        knee = np.degrees(np.arctan2(sine, (thigh * shin).sum(-1)))
        off = np.roll(knee, -50 * k) - stride.joints[:, k, 1]
        assert np.sqrt(np.mean(off**2)) < 3.0
        forward = np.degrees(np.arctan2(thigh[:, 2], -thigh[:, 1]))
        assert np.sqrt(np.mean((forward - stride.thigh[:, k]) ** 2)) < 3.0
    left, right = stride.joints[:, 0], stride.joints[:, 1]
    assert np.abs(left - right).max() < 2.0  # read between frames, where knees turn fast
    assert np.abs(left - right).mean() < 0.1
