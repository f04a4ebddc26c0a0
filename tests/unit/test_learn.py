"""What is learned of a puppet is what the puppet was told; what is no walk is refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from puppet import BODY, Puppet
from rigs import apart, bare, cut, cycle_angles, events_apart, every, in_a_mirror, moved, rms

from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.events import FootPath, Stance, stances
from gaitsmith.gait.learn import (
    learn_cycle,
    standing_feet,
    symmetrized,
    walking_speed,
    without_shaking,
)
from gaitsmith.gait.loop import mirrored
from gaitsmith.gait.person import person_of
from gaitsmith.geometry.rotations import about, multiply
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions
from gaitsmith.pipeline import walk

WAYS = {
    "walk": Puppet(),
    "flat": Puppet(strike=0.0),
    "always flat": Puppet(strike=0.0, push=1.0),
    "toes first": Puppet(strike=-10.0),
    "on the toes": Puppet(strike=-15.0, level=-25.0, push=60.0),
    "on the heels": Puppet(level=12.0, push=0.0),
    "wide": Puppet(width=0.35),
    "crossing": Puppet(width=-0.08),
    "limp": Puppet(right=0.44, duty=(0.68, 0.58)),
    "short": Puppet(stride=0.3),
    "long": Puppet(stride=1.7, period=1.0),
    "slow": Puppet(stride=0.9, period=1.8, duty=(0.7, 0.7)),
    "fast": Puppet(period=0.75, duty=(0.55, 0.55)),
    "crouched": Puppet(crouch=0.2),
    "arms high": Puppet(swing=80.0),
    "ducks": Puppet(toe_out=35.0),
    "pigeons": Puppet(toe_out=-12.0),
    "shuffle": Puppet(strike=2.0, push=20.0, lift=0.0),
}


def learned(clip, **options):
    return learn_cycle(person_of(bare(clip)), **options)


@pytest.mark.parametrize("name", WAYS)
def test_the_puppet_is_learned(name):
    puppet = WAYS[name]
    found = learned(puppet.clip(5.0))
    assert found.cycle.stride_length == pytest.approx(puppet.stride, rel=0.01)
    assert found.cycle.duration == pytest.approx(puppet.period, rel=0.01)
    far = puppet.right * puppet.stride
    np.testing.assert_allclose(found.step_lengths, [puppet.stride - far, far], atol=8e-3)
    assert found.step_width == pytest.approx(puppet.width, abs=3e-3)
    np.testing.assert_allclose(np.degrees(found.toe_out), puppet.toe_out, atol=0.5)
    assert np.abs(found.cycle.events[1, 0] - puppet.right) * puppet.period < 0.03
    since = (found.cycle.events - found.cycle.events[:, :1]) % 1.0
    np.testing.assert_allclose(since[:, 3], puppet.duty, atol=0.08)
    assert BODY.foot.heel == pytest.approx(found.body.foot.heel, abs=0.012)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ({"way": 180.0}, "walks backward"),
        ({"way": 90.0, "stride": 0.5, "width": 0.4}, "sideways"),
        ({"duty": (0.4, 0.4), "stride": 2.0, "period": 0.75}, "running"),
        ({"duty": (0.44, 0.44), "stride": 2.0, "period": 0.7}, "running"),
        ({"hop": True, "duty": (0.5, 0.5), "stride": 0.8}, "running"),
        ({"stride": 0.02}, "hardly get ahead"),
        ({"stride": 0.02, "turn": 60.0}, "hardly get ahead"),
    ],
)
def test_what_is_no_walk_is_refused(name, why):
    with pytest.raises(InfeasibleError, match=why):
        learned(Puppet(**name).clip(5.0))


def test_standing_is_no_walk():
    clip = Puppet().clip(2.0)
    still = clip.with_(
        root_position=np.repeat(clip.root_position[:1], 121, axis=0),
        rotations=np.repeat(clip.rotations[:1], 121, axis=0),
    )
    with pytest.raises(InfeasibleError, match="nobody walks in this clip"):
        learned(still)


@pytest.mark.parametrize("strides", [0.1, 1.0, 1.5])
def test_too_little_of_a_walk(strides):
    clip = cut(Puppet().clip(5.0), 1.0, 1.0 + 1.1 * strides)
    with pytest.raises(InfeasibleError, match=r"no 1\.6 strides of walking: from one heel strike"):
        learned(clip)


def test_just_enough_of_a_walk():
    """From one heel strike to the toe-off after the next one of that foot."""
    clip = cut(Puppet().clip(5.0), 1.0, 1.0 + 1.1 * 1.95)
    found = learned(clip)
    assert found.cycle.stride_length == pytest.approx(1.3, rel=0.01)


def test_left_and_right_exchanged_is_said():
    clip = Puppet().clip(4.0)
    names = tuple(
        n.replace("left", "?").replace("right", "left").replace("?", "right")
        for n in clip.skeleton.names
    )
    clip = clip.with_(skeleton=replace(clip.skeleton, names=names, soles=None))
    with pytest.raises(InfeasibleError, match="left and right are exchanged"):
        learn_cycle(person_of(clip))


def test_standing_before_and_after_is_left_out():
    found = learned(walk(distance=6.0, fps=60, step_length=0.7, cadence=110.0))
    assert found.cycle.stride_length == pytest.approx(1.4, abs=5e-3)
    assert found.cycle.duration == pytest.approx(120.0 / 110.0, abs=0.01)


@pytest.mark.parametrize("heading", [0.0, 123.0])
def test_the_heading_is_taken_out(heading):
    clip = moved(Puppet().clip(4.0), heading, [5.0, 0.0, 7.0])
    found = learned(clip)
    center, q = found.cycle.center, found.cycle.rotations
    assert np.abs(center[:, [0, 2]].mean(0)).max() < 0.02
    assert np.abs(2.0 * np.arctan2(q[:, 0, 1], q[:, 0, 3])).max() < 0.1


def test_a_treadmill_walk_is_carried_over_the_ground():
    clip = Puppet().clip(5.0)
    belt = clip.times[:, None] * [0.0, 0.0, 1.3 / 1.1]
    found = learned(clip.with_(root_position=clip.root_position - belt))
    assert any("in place" in note for note in found.notes)
    assert found.cycle.stride_length == pytest.approx(1.3, rel=0.03)


def test_a_root_that_never_moves():
    """The hips' own coming and going is lost, the walk is not."""
    clip = cut(walk(distance=8.0, fps=60, step_length=0.7, cadence=110.0), 1.5, 6.0)
    found = learned(clip.with_(root_position=clip.root_position * [1.0, 1.0, 0.0]))
    assert found.cycle.stride_length == pytest.approx(1.4, rel=0.03)


def test_ten_frames_a_second():
    found = learned(every(Puppet().clip(6.0), 6))
    assert found.cycle.stride_length == pytest.approx(1.3, rel=0.01)
    assert found.cycle.duration == pytest.approx(1.1, rel=0.04)


def test_short_double_support_is_stretched_and_said():
    own = [
        Stance(side, float(t), float(t) + 0.1, float(t) + 0.3, float(t) + 0.505 * 1.1)
        for side in (0, 1)
        for t in Puppet().strikes(side, 4.0)
        if 0.5 < t < 4.2
    ]
    found = learned(Puppet().clip(5.0), events=own)
    assert any("4 %" in note for note in found.notes)
    events = found.cycle.events
    assert (events[0, 3] - events[1, 0]) % 1.0 == pytest.approx(0.02, abs=1e-9)
    assert events[1, 3] % 1.0 == pytest.approx(0.02, abs=1e-9)


@pytest.fixture(scope="module")
def cycle():
    return learned(Puppet(right=0.47, width=0.14, duty=(0.64, 0.6)).clip(5.0)).cycle


class TestTheLoop:
    def test_it_closes(self, cycle):
        """Speed and acceleration at the seam are as inside (A2)."""
        phase = np.arange(240) / 240
        center, q = cycle.at(phase)
        for table in (center, q.reshape(240, -1)):
            speed = np.abs(np.diff(np.concatenate([table, table[:2]]), axis=0)).max(axis=1)
            change = np.abs(np.diff(np.concatenate([table, table[:2]]), 2, axis=0)).max(axis=1)
            assert speed[239] <= 1.3 * np.quantile(speed[:238], 0.95)
            assert change[238:].max() <= 1.5 * change[:237].max()

    def test_its_contacts_are_found_again(self, cycle):
        """The loop tiled three times and looked at anew (A3)."""
        rate = 120.0
        times = np.arange(round(4.0 * cycle.duration * rate)) / rate
        center, q = cycle.at(times / cycle.duration)
        center = center + (times * cycle.speed)[:, None] * [0.0, 0.0, 1.0]
        positions, world = forward_kinematics(cycle.skeleton, center, q)
        soles = sole_positions(cycle.skeleton, positions, world)
        feet = {
            side: FootPath(
                positions[:, cycle.skeleton.index(f"{name}Foot")],
                *(soles[:, side, i] for i in range(3)),
            )
            for side, name in enumerate(("left", "right"))
        }
        again = stances(feet, rate, speed=cycle.speed, leg_length=0.86)
        misses = [
            ((np.array(s.times) / cycle.duration - cycle.events[s.side] + 0.5) % 1.0 - 0.5)
            for s in again
            if not s.cut
        ]
        misses = np.abs(np.array(misses)) * cycle.duration
        assert np.median(misses) <= 0.010
        assert misses.max() <= 0.080

    def test_symmetrized_twice_is_once(self, cycle):
        once = symmetrized(cycle)
        twice = symmetrized(once)
        np.testing.assert_allclose(twice.center, once.center, atol=2e-5)
        np.testing.assert_allclose(twice.rotations, once.rotations, atol=2e-5)
        np.testing.assert_allclose(twice.events, once.events, atol=1e-9)

    def test_symmetrized_is_its_own_mirror_image(self, cycle):
        even = symmetrized(cycle)
        half = len(even.center) // 2
        other = mirrored(even.skeleton, np.roll(even.rotations, -half, axis=0))
        assert np.abs(np.abs((other * even.rotations).sum(-1)) - 1.0).max() < 1e-9
        assert even.events[1, 0] == pytest.approx(0.5)

    def test_its_feet_stand_on_the_floor(self, cycle):
        feet = standing_feet(cycle)
        assert feet.height == pytest.approx(0.0, abs=1e-6)
        assert feet.place[0, 0] == pytest.approx(-feet.place[1, 0], abs=1e-6)


def test_asked_for_symmetry_it_is_symmetric():
    found = learned(Puppet(right=0.45).clip(5.0), symmetric=True)
    assert found.cycle.events[1, 0] == pytest.approx(0.5)
    assert found.step_lengths[0] == pytest.approx(found.step_lengths[1], abs=2e-3)
    assert any("mirror" in note for note in found.notes)


def test_the_mirror_of_a_clip_is_the_mirror_of_its_stride():
    clip = Puppet(right=0.46, duty=(0.66, 0.6), width=0.14).clip(5.0)
    one, two = learned(clip), learned(in_a_mirror(clip))
    np.testing.assert_allclose(two.step_lengths, one.step_lengths[::-1], atol=3e-3)
    swapped = (one.cycle.events[::-1] - one.cycle.events[1, 0]) % 1.0
    swapped[0, 0] = 0.0
    assert np.abs(events_apart(two.cycle, one.cycle.with_(events=swapped))).max() < 0.03
    phase = np.arange(100) / 100
    turned = cycle_angles(two.cycle)
    own = cycle_angles(one.cycle, 1000)
    shifted = own[((phase + one.cycle.events[1, 0]) * 1000).astype(int) % 1000][:, ::-1]
    assert rms(apart(turned, shifted)) < 2.0


def test_a_limp_stays_a_limp():
    found = learned(Puppet(right=0.42, duty=(0.68, 0.58), strike=20.0).clip(5.0))
    left, right = found.step_lengths
    assert left - right == pytest.approx(1.3 * 0.16, abs=0.01)
    since = (found.cycle.events - found.cycle.events[:, :1]) % 1.0
    assert since[0, 3] - since[1, 3] == pytest.approx(0.1, abs=0.04)


def test_events_may_be_given():
    clip = Puppet().clip(5.0)
    own = [
        Stance(side, float(t), float(t) + 0.08, float(t) + 0.37, float(t) + 0.68)
        for side in (0, 1)
        for t in Puppet().strikes(side, 4.0)
        if 0.5 < t < 4.2
    ]
    found = learned(clip, events=own)
    assert found.stances == tuple(sorted(own, key=lambda s: s.heel_strike))
    assert found.cycle.duration == pytest.approx(1.1, abs=1e-9)
    assert found.cycle.events[0] == pytest.approx(np.array([0.0, 0.08, 0.37, 0.68]) / 1.1)


def test_arms_that_need_two_strides_get_them():
    """One arm lifts every other stride: the legs repeat, the arms close after two."""
    clip = Puppet().clip(8.0)
    q = np.array(clip.rotations)
    arm = clip.skeleton.index("leftUpperArm")
    beat = np.pi * clip.times / 1.1
    q[:, arm] = multiply(about("x", 0.7 * np.sin(beat + 0.8)), q[:, arm])
    found = learned(clip.with_(rotations=q))
    assert found.cycle.strides == 2
    assert any("two strides" in note for note in found.notes)
    half = len(found.cycle.center) // 2
    legs = [
        i for i, n in enumerate(clip.skeleton.names) if n.endswith(("Leg", "Foot")) or n == "hips"
    ]
    same = np.abs((found.cycle.rotations[:half, legs] * found.cycle.rotations[half:, legs]).sum(-1))
    assert np.abs(same - 1.0).max() < 1e-9


def test_walking_speed_leaves_standing_out():
    motion = walk(distance=4.0, fps=60, step_length=0.7, cadence=110.0)
    assert walking_speed(motion) == pytest.approx(0.7 * 110.0 / 60.0, rel=0.05)


def test_the_same_clip_the_same_stride():
    clip = Puppet().clip(4.0)
    one, two = learned(clip).cycle, learned(clip).cycle
    np.testing.assert_array_equal(one.rotations, two.rotations)
    np.testing.assert_array_equal(one.center, two.center)


def test_stances_are_in_order():
    found = learned(Puppet().clip(5.0)).stances
    found = [s for s in found if s.cut != "start"]
    assert all(a.heel_strike < b.heel_strike for a, b in pairwise(found))


def test_a_learned_way_of_the_hips_is_rid_of_shaking_and_keeps_its_sway():
    """Markers shake by a millimeter from frame to frame; bodies do not."""
    phase = np.arange(256) / 128.0
    sway = 0.02 * np.sin(2.0 * np.pi * phase) + 0.004 * np.cos(6.0 * np.pi * phase)
    shaking = 0.001 * np.cos(np.pi * np.arange(256))
    out = without_shaking(np.stack([sway, sway + shaking], axis=-1), strides=2)
    np.testing.assert_allclose(out, np.stack([sway, sway], axis=-1), atol=1e-12)
