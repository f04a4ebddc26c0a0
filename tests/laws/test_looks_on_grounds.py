"""What people look like on slopes and stairs: knees, heels and ankles; how long they step."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest
from judge import along_soles, broken, posed
from people import person

import gaitsmith
from gaitsmith.errors import InfeasibleError
from gaitsmith.ground import HeightField, Slope, Stairs

SIDES = ("left", "right")
FPS = 120


@cache
def walked(ground, gait="neutral", body=1.75, **asked):
    distance = 3.0 + asked.pop("more", 0.0)
    return gaitsmith.walk(distance=distance, ground=ground, gait=gait, body=body, fps=FPS, **asked)


def legs(motion):
    """Knee flexion and ankle dorsiflexion (F, 2), pitch of the soles in space, degrees."""
    positions, _, soles = posed(motion)[:3]

    def joint(name):
        places = [positions[:, motion.skeleton.index(side + name)] for side in SIDES]
        return np.stack(places, axis=1)

    def elevation(bone):
        return np.degrees(np.arctan2(bone[..., 2], -bone[..., 1]))

    thigh, shin = joint("LowerLeg") - joint("UpperLeg"), joint("Foot") - joint("LowerLeg")
    sole = soles[:, :, 1] - soles[:, :, 0]
    pitch = np.degrees(np.arcsin(sole[..., 1] / np.linalg.norm(sole, axis=-1)))
    return elevation(thigh) - elevation(shin), pitch - elevation(shin), pitch


def landings(motion, which):
    """(frame, side) of some footsteps."""
    frame = np.ceil(motion.labels.footstep_time * FPS - 1e-6).astype(int)
    return [(frame[i], int(motion.labels.footstep_side[i])) for i in which]


def front_knee(motion):
    """Flexion of the knee in front as steady steps land, degrees."""
    knee = legs(motion)[0]
    return float(np.mean([knee[frame, side] for frame, side in landings(motion, (3, 4))]))


# ------------------------------------------------------------------------------- uphill


@pytest.mark.parametrize("gait", ["neutral", "winter", "proud", "sad", "hurried", "swagger"])
def test_the_knee_in_front_does_not_fold_uphill(gait):
    """10-20 deg more than on the level at 10 deg (human-facts U6), not a lunge."""
    level, ten, fifteen = (front_knee(walked(Slope(d), gait)) for d in (0.0, 10.0, 15.0))
    assert level + 5.0 < ten < min(level + 23.0, max(level + 12.0, 33.0))
    assert ten < fifteen < max(level + 17.0, 38.0)


@pytest.mark.parametrize("gait", ["neutral", "winter", "proud"])
def test_the_knee_behind_yields_downhill_but_does_not_fold(gait):
    """It bears the weight as the other foot lands at -10 deg: 60 deg before."""
    motion = walked(Slope(-10.0), gait)
    knee = legs(motion)[0]
    behind = [knee[frame, 1 - side] for frame, side in landings(motion, (3, 4))]
    assert 25.0 < np.mean(behind) < 52.0


@pytest.mark.parametrize("body", [1.2, 2.1])
@pytest.mark.parametrize("share", [0.5, 0.75])
def test_whoever_walks_and_however_long_the_steps(body, share):
    length = round(share * person(body).leg_length, 3)
    motion = walked(Slope(12.0), body=body, step_length=length, more=body - 1.2)
    assert front_knee(motion) < 35.0
    assert broken(motion) == {}


@pytest.mark.parametrize("deg", [5.0, 10.0, 15.0])
@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_the_heel_behind_never_sinks_again(gait, deg):
    """From where it is up until the foot leaves."""
    motion = walked(Slope(deg), gait)
    pitch = legs(motion)[2]
    for (frame, side), (leaves, _) in zip(
        landings(motion, (3, 4)), landings(motion, (5, 6)), strict=True
    ):
        bears = motion.contacts[frame:leaves, side]
        up = np.flatnonzero(~bears[:, 0])[0]
        off = up + np.flatnonzero(~bears[up:].any(-1))[0]
        assert np.diff(pitch[frame + up : frame + off, side]).max() < 0.05


@pytest.mark.parametrize("deg", [5.0, 15.0])
def test_hips_stand_over_the_feet_uphill(deg):
    """The trunk leans: to hold the balance the hips are a little behind the ankles."""
    motion = walked(Slope(deg))
    positions = posed(motion)[0]
    for frame in (0, -1):
        hip, foot = (
            np.mean([positions[frame, motion.skeleton.index(s + n)] for s in SIDES], axis=0)
            for n in ("UpperLeg", "Foot")
        )
        assert -0.035 < (hip - foot)[2] < 0.0


def test_hips_neither_jerk_nor_stop_where_slopes_change():
    """Onto and off a flight the way of the hips has no corner: 22 m/s2 with one."""
    ground = Stairs(0.15352596, 0.28609124, 8)
    root = walked(ground, "winter", 2.01, more=1.29).root_position
    change = np.abs(np.diff(root[:, 2], 2)) * FPS**2
    assert change.max() < 12.0


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
def test_hips_go_over_a_box_without_a_jerk():
    """What holds them back comes and goes with the steps: 18 m/s2 with a corner where it ends."""
    root = gaitsmith.walk(distance=4.0, ground=box(0.15, 0.8), fps=FPS).root_position
    assert np.abs(np.diff(root[:, 2], 2)).max() * FPS**2 < 10.0


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
def test_hips_rise_less_than_a_box_that_one_foot_steps_on():
    """The knee on it bends; 15 and 18 cm before."""
    for high, most in ((0.15, 0.13), (0.2, 0.16)):
        motion = walk_over(high)
        assert (motion.labels.footstep_position[:, 1] > 0.01).sum() == 1
        hips = motion.root_position
        over = (
            hips[hips[:, 2] > 1.2, 1].max() - hips[(hips[:, 2] > 0.4) & (hips[:, 2] < 1.2), 1].max()
        )
        assert 0.6 * high < over < most
        assert broken(motion, but=("footsteps_unseen",)) == {}


def walk_over(high):
    return gaitsmith.walk(distance=4.0, ground=box(high, 0.6), fps=FPS)


def box(high, length):
    z = np.arange(-0.6, 4.6, 0.02)
    height = np.where((z >= 1.6) & (z < 1.6 + length), high, 0.0)
    return HeightField(np.tile(height[:, None], (1, 61)), 0.02, (-0.6, -0.6))


# ------------------------------------------------------------------------------- stairs


@pytest.mark.parametrize("rise", [-0.17, 0.17])
@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_ankles_are_not_bent_up_on_stairs(gait, rise):
    """People 11 deg up and 21 deg down at most (human-facts K1); 40 and 34 before this held."""
    motion = walked(Stairs(rise, 0.29, 8), gait, more=1.4)
    knee, ankle, _ = legs(motion)
    on = slice(*(landings(motion, (i,))[0][0] for i in (4, 8)))
    bears = motion.contacts[on].any(-1)
    stance, swing = ankle[on][bears].max(), ankle[on][~bears].max()
    assert stance < (17.0 if rise > 0.0 else 23.0)
    assert swing < 19.0
    assert 85.0 < knee[on].max() < 100.0


@pytest.mark.parametrize(
    ("ground", "do"),
    [
        (Stairs(-0.168, 0.583, 4), "be at 0.26,1.22 facing 93"),
        (Stairs(-0.156, 0.484, 4), "walk to 0,0.69; be at 0.01,1.42 facing -156"),
    ],
)
def test_who_turns_on_a_tread_comes_to_stand_there_without_a_jolt(ground, do):
    """The hips have stopped when the last foot is down: 12 and 16 m/s2 before."""
    motion = gaitsmith.walk(do=do, ground=ground, fps=FPS)
    end = int(motion.labels.footstep_time[-1] * FPS)
    change = np.abs(np.diff(motion.root_position[end - 4 :, 1], 2)) * FPS**2
    assert change.max() < 4.0
    assert legs(motion)[0][-1].max() < 12.0


def test_who_turns_backward_down_a_riser_keeps_every_promise():
    """Toes turned by 23 degrees per 1/60 s, and the hips dropped in an instant before."""
    motion = gaitsmith.walk(
        do="be at -0.12,1.02 facing -94", ground=Stairs(-0.156, 0.425, 8), fps=FPS
    )
    assert broken(motion, but=("footsteps_unseen",)) == {}


# ------------------------------------------------------------------------------- length


@pytest.mark.parametrize("body", [1.2, 1.75, 2.1])
@pytest.mark.parametrize("deg", [-12.0, -8.0, -4.0, -1.0, 1.0, 4.0, 8.0, 12.0])
def test_steps_on_slopes_are_as_long_as_the_paper_says(body, deg):
    """[SM01] Eqs. 11-12 (downhill with the sign mended) scaled to the body, within 1 cm."""

    def steady(ground):
        motion = walked(ground, body=body, more=4.0 * body)
        return float(np.diff(motion.labels.footstep_position[3:7, 2]).mean())

    own = 0.623 - 0.0019 * deg if deg > 0.0 else 0.627 + 0.0075 * deg
    assert steady(Slope(deg)) == pytest.approx(own * steady(Slope(0.0)) / 0.625, abs=0.01)


# ------------------------------------------------------------------------------- ridges


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
@pytest.mark.parametrize("aslant", [0.0, 0.4])
def test_nobody_starts_or_ends_standing_across_a_ridge(aslant):
    """Feet stand apart fore and aft instead, their middle where it was; 12 mm sunk in before."""
    cell, out = 0.04, []
    z, x = np.meshgrid(np.arange(-1.5, 6.0, cell), np.arange(-2.0, 2.0, cell), indexing="ij")
    along = np.cos(aslant) * (z - 0.04) + np.sin(aslant) * x
    roof = np.abs((along + 2.0) % 4.0 - 2.0)  # ridges 4 m apart
    ground = HeightField(-roof * np.tan(np.radians(8.0)), cell, (-2.0, -1.5))
    motion = gaitsmith.walk(distance=4.0 / np.cos(aslant), ground=ground, body=2.0, fps=FPS)
    assert -along_soles(motion).min() <= 0.010
    place = motion.labels.footstep_position[:, [0, 2]]
    for feet, end in ((slice(0, 2), 0.0), (slice(-2, None), 4.0 / np.cos(aslant))):
        apart = np.diff(place[feet, 1])[0]
        out.append(abs(apart))
        np.testing.assert_allclose(place[feet].mean(axis=0), [0.0, end], atol=0.021)
    assert min(out) > 0.03
    assert max(out) <= 0.21


# ----------------------------------------------------------------------------- refusals


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "what", "z", "ground"),
    [
        ("path", "0,0 {}", 1.5, "stairs:0.15,0.3,20"),
        ("do", "walk to {}", 1.5, "stairs:0.15,0.3,20"),
        ("do", "be at {} facing 90", 1.45, "stairs:0.15,0.4,3"),
        ("do", "be at {}", 1.45, "stairs:-0.15,0.4,3"),
    ],
)
def test_the_place_that_a_refusal_names_works(how, what, z, ground):
    with pytest.raises(InfeasibleError, match=r"place for .+ is \(") as refusal:
        gaitsmith.walk(**{how: what.format(f"0,{z}")}, ground=ground)
    x, near = re.search(r"is \((\S+), (\S+)\)", str(refusal.value)).groups()
    assert abs(float(near) - z) < 0.2
    gaitsmith.walk(**{how: what.format(f"{float(x):g},{near}")}, ground=ground)


def test_the_steepest_slope_is_walked_and_a_steeper_one_refused_with_a_way_out():
    assert broken(walked(Slope(30.0))) == {}
    with pytest.raises(InfeasibleError, match=r"slopes by 30.4 deg, .* make it less steep, or"):
        gaitsmith.walk(distance=3.0, ground=Slope(30.4))
