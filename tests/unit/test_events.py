"""Events of feet that are known exactly, however they land, slide, tremble or are sampled."""

from __future__ import annotations

import numpy as np
import pytest
from puppet import Puppet
from rigs import bare, every

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InfeasibleError
from gaitsmith.gait.events import FootPath, Stance, check_order, stances
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions

WAYS = {
    "walk": Puppet(),
    "slow": Puppet(stride=0.9, period=1.8, duty=(0.7, 0.7)),
    "fast": Puppet(period=0.8, duty=(0.56, 0.56)),
    "flat": Puppet(strike=0.0),
    "shuffle": Puppet(strike=2.0, push=20.0, lift=0.0),
    "toes first": Puppet(strike=-10.0),
    "on the toes": Puppet(strike=-15.0, level=-25.0),
    "wide": Puppet(width=0.35),
    "crossing": Puppet(width=-0.08),
    "limp": Puppet(right=0.44, duty=(0.66, 0.58)),
    "short steps": Puppet(stride=0.3),
}


def feet_of(clip):
    positions, world = motion_kinematics(clip)
    soles = sole_positions(clip.skeleton, positions, world)
    return {
        side: FootPath(
            positions[:, clip.skeleton.index(f"{name}Foot")],
            *(soles[:, side, point] for point in range(3)),
        )
        for side, name in enumerate(SIDES)
    }


def found_in(clip, puppet):
    return stances(feet_of(clip), clip.fps, speed=puppet.stride / puppet.period, leg_length=0.86)


def errors(clip, puppet):
    """Seconds by which strikes and toe-offs of whole stances miss."""
    strikes, leaves = [], []
    for stance in found_in(clip, puppet):
        landed = puppet.strikes(stance.side, 6.0)
        true = landed[np.abs(landed - stance.heel_strike).argmin()]
        if stance.cut not in ("start", "both"):
            strikes.append(stance.heel_strike - true)
        if stance.cut not in ("end", "both") and stance.cut != "start":
            leaves.append(stance.toe_off - true - puppet.duty[stance.side] * puppet.period)
    return np.array(strikes), np.array(leaves)


@pytest.mark.parametrize("name", WAYS)
def test_every_stance_is_found_where_it_is(name):
    puppet = WAYS[name]
    clip = puppet.clip(6.0)
    found = found_in(clip, puppet)
    whole = [s for s in found if not s.cut]
    assert len(whole) >= 2 * int(6.0 / puppet.period) - 3
    check_order([s for s in found if s.cut != "start"])
    for stance in found:
        assert list(stance.times) == sorted(stance.times)
    strikes, leaves = errors(clip, puppet)
    assert np.abs(strikes).max() < 0.07
    assert abs(np.median(strikes)) < 0.05
    assert np.abs(leaves).max() < 0.09


@pytest.mark.parametrize("nth", [2, 4, 5])
def test_slow_cameras(nth):
    """30, 15 and 12 frames a second."""
    puppet = WAYS["walk"]
    clip = every(puppet.clip(6.0), nth)
    check_order([s for s in found_in(clip, puppet) if s.cut != "start"])
    strikes, leaves = errors(clip, puppet)
    frame = nth / 60.0
    assert np.abs(strikes).max() < max(0.05, 1.5 * frame)
    assert np.abs(leaves).max() < max(0.09, 1.5 * frame)


@pytest.mark.parametrize("seed", range(3))
def test_five_millimeters_of_noise_at_30_frames(seed):
    puppet = WAYS["walk"]
    clip = every(puppet.clip(6.0), 2)
    noise = np.random.default_rng(seed).normal(0.0, 0.005 / np.sqrt(3.0), (len(clip), 3))
    clip = clip.with_(root_position=clip.root_position + noise)
    check_order([s for s in found_in(clip, puppet) if s.cut != "start"])
    strikes, _ = errors(clip, puppet)
    assert np.abs(strikes).max() < 0.09


def test_feet_that_slide_five_centimeters():
    puppet = WAYS["walk"]
    clip = puppet.clip(6.0)
    slide = 0.025 * np.sin(2.0 * np.pi * clip.times / (0.5 * puppet.period))
    clip = clip.with_(root_position=clip.root_position + slide[:, None] * [0.0, 0.0, 1.0])
    check_order([s for s in found_in(clip, puppet) if s.cut != "start"])
    strikes, leaves = errors(clip, puppet)
    assert np.abs(strikes).max() < 0.08
    assert np.abs(leaves).max() < 0.12


@pytest.mark.parametrize("drift", [0.01, 0.02])
def test_a_floor_that_drifts(drift):
    puppet = WAYS["walk"]
    clip = puppet.clip(6.0)
    rising = np.linspace(0.0, drift, len(clip))[:, None] * [0.0, 1.0, 0.0]
    strikes, leaves = errors(clip.with_(root_position=clip.root_position + rising), puppet)
    assert np.abs(strikes).max() < 0.06
    assert np.abs(leaves).max() < 0.09


def test_size_scales_heights():
    """The same walk half as large: the same times."""
    puppet = WAYS["walk"]
    clip = puppet.clip(4.0)
    small = {
        side: FootPath(*(0.5 * p for p in (f.ankle, f.heel, f.ball, f.tip)))
        for side, f in feet_of(clip).items()
    }
    speed = puppet.stride / puppet.period
    one = found_in(clip, puppet)
    two = stances(small, clip.fps, speed=0.5 * speed, leg_length=0.43)
    np.testing.assert_allclose([s.times for s in one], [s.times for s in two], atol=1e-9)


def test_one_foot_alone():
    clip = WAYS["walk"].clip(4.0)
    alone = stances({1: feet_of(clip)[1]}, clip.fps, speed=1.2, leg_length=0.86)
    assert {s.side for s in alone} == {1}


def test_ends_that_a_clip_does_not_show_are_said():
    found = found_in(WAYS["walk"].clip(3.0), WAYS["walk"])
    assert [s.cut for s in found if s.cut] == ["start"] * sum(s.cut == "start" for s in found) + [
        "end"
    ] * sum(s.cut == "end" for s in found)
    assert all(s.heel_strike == 0.0 for s in found if s.cut == "start")


def stance(side, first, last):
    return Stance(side, first, first + 0.1, last - 0.2, last)


def test_feet_that_do_not_alternate():
    with pytest.raises(InfeasibleError, match=r"do not alternate: the left foot lands at 0\.00 s"):
        check_order([stance(0, 0.0, 0.6), stance(0, 0.9, 1.5)])


def test_flight_is_running():
    check_order([stance(0, 0.0, 0.5), stance(1, 0.52, 1.0)])
    with pytest.raises(InfeasibleError, match=r"nobody is on the ground from 0\.50 to 0\.56 s"):
        check_order([stance(0, 0.0, 0.5), stance(1, 0.56, 1.0)])


def test_a_bare_motion_is_all_it_takes():
    clip = bare(WAYS["walk"].clip(3.0))
    assert clip.contacts is None
    assert clip.skeleton.soles is None
