"""Any walker on any ground: what every motion promises, up and down, on slopes and stairs."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import along_soles, broken, overhang, posed, shins_into_ground
from people import heights, person

import gaitsmith
from gaitsmith.errors import GaitsmithWarning, InfeasibleError, InvalidInputError
from gaitsmith.ground import HeightField, Slope, Stairs
from gaitsmith.measures.promises import promises

#: A heel that hangs over an edge bears nothing: its footstep cannot be told from heel and ball.
ON_EDGES = ("footsteps_unseen",)
#: A sole is stiff: on curved ground its line sinks in, meters.
SUNK = 0.010


def walked(**asked):
    """A motion at 120 frames a second that keeps the promises."""
    motion = gaitsmith.walk(fps=120, **asked)
    assert broken(motion, but=ON_EDGES) == {}
    assert shins_into_ground(motion) <= 0.0005
    return motion


def stepped(**asked):
    """The same on a ground with edges: no part of a sole cuts one."""
    motion = walked(**asked)
    assert -along_soles(motion).max(0).min() <= 0.0005
    return motion


def bumps(relief=0.06, length=3.0, cell=0.05):
    z = np.arange(-1.0, 9.0, cell)
    return HeightField(np.tile(relief * np.sin(2.0 * np.pi * z / length)[:, None], (1, 61)), cell)


# ------------------------------------------------------------------------------- slopes


@pytest.mark.parametrize("deg", [-15.0, -6.0, 9.0, 15.0])
@pytest.mark.parametrize("path", ["0,0 0,3", "0,0 3,0", "0,0 2,1.5 3,3.5"])
def test_slopes_up_down_and_across(deg, path):
    motion = walked(path=path, ground=Slope(deg))
    assert -along_soles(motion).min() <= 0.0005


def test_steps_follow_the_lines_of_the_paper():
    """[SM01] Eqs. 11 and 12 over what they say of the level, to a millimeter."""
    level = steady(gaitsmith.walk(distance=9.0))
    up, down = (steady(gaitsmith.walk(distance=9.0, ground=Slope(d))) for d in (10.0, -10.0))
    assert up / level == pytest.approx((0.623 - 0.019) / 0.625, abs=1e-3)
    assert down / level == pytest.approx((0.627 - 0.075) / 0.625, abs=1e-3)


def steady(motion):
    return float(np.diff(motion.labels.footstep_position[4:7, 2]).mean())


def test_a_step_length_that_is_asked_for_is_kept_on_slopes():
    motion = gaitsmith.walk(distance=6.0, step_length=0.6, ground="slope:-8")
    assert steady(motion) == pytest.approx(0.6, abs=1e-6)


def test_people_lean_into_the_hill():
    def lean(ground):
        motion = gaitsmith.walk(distance=4.0, ground=ground, fps=30)
        positions = posed(motion)[0]
        hips, neck = positions[:, 0], positions[:, motion.skeleton.index("neck")]
        return float(np.degrees(np.arctan2(*(neck - hips).mean(0)[[2, 1]])))

    level = lean("flat")
    assert 4.0 < lean("slope:10") - level < 9.0
    assert -3.5 < lean("slope:-10") - level < -0.5


@settings(max_examples=6)
@given(deg=st.floats(-15.0, 15.0), height=heights(), turn=st.floats(-3.0, 3.0))
def test_anybody_on_any_slope(deg, height, turn):
    path = [(0.0, 0.0), (2.5 * np.sin(turn), 2.5 * np.cos(turn))]
    walked(path=path, ground=Slope(deg), body=person(height))


# ------------------------------------------------------------------------------- stairs


@pytest.mark.parametrize("rise", [-0.17, 0.17])
@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_a_usual_flight_is_walked_foot_over_foot(rise, gait):
    ground = Stairs(rise, 0.29, 6)
    motion = stepped(distance=4.0, ground=ground, gait=gait)
    place = motion.labels.footstep_position
    level = np.round(place[:, 1] / rise).astype(int)
    assert level.tolist() == sorted(level.tolist())
    assert sorted(set(level)) == list(range(7))
    on_stairs = (level > 0) & (level < 6)
    assert np.unique(level[on_stairs], return_counts=True)[1].max() == 1
    assert overhang(motion) <= 0.25


@pytest.mark.parametrize(
    ("rise", "tread", "body"), [(0.10, 0.25, 1.2), (-0.10, 0.25, 1.2), (0.15, 0.25, 1.9)]
)
def test_small_people_and_short_treads(rise, tread, body):
    motion = stepped(distance=3.0, ground=Stairs(rise, tread, 4), body=body)
    short = tread < person(body).foot.length
    assert overhang(motion) <= (0.35 if short else 0.25)


@pytest.mark.parametrize("rise", [-0.15, 0.15])
def test_stairs_at_an_angle(rise):
    stepped(path="-1,0 1,3.2", ground=Stairs(rise, 0.3, 5))


def test_a_foot_lands_flat_on_a_step_up_and_on_its_ball_on_a_deep_step_down():
    for rise, lands in ((0.17, 0.0), (-0.17, -15.0)):
        motion = gaitsmith.walk(distance=4.0, ground=Stairs(rise, 0.3, 6), fps=120)
        soles, labels = posed(motion)[2], motion.labels
        frame = np.ceil(labels.footstep_time * 120.0 - 1e-6).astype(int)
        for i in (5, 6):
            heel, ball = soles[frame[i], labels.footstep_side[i], :2]
            pitch = np.degrees(np.arcsin((ball - heel)[1] / np.linalg.norm(ball - heel)))
            assert pitch == pytest.approx(lands, abs=3.0)


def test_swinging_feet_keep_two_centimeters_over_nosings_going_up():
    ground = Stairs(0.17, 0.29, 6)
    soles = posed(gaitsmith.walk(distance=4.0, ground=ground, fps=120))[2]
    toe = soles[:, :, 2]
    for k, z in enumerate(ground.risers):
        for side in range(2):
            crosses = np.flatnonzero((toe[:-1, side, 2] < z) & (toe[1:, side, 2] >= z))
            over = toe[crosses + 1, side, 1] - 0.17 * (k + 1)
            assert over.min() >= 0.02


# ------------------------------------------------------------------------- height fields


def test_bumps():
    with pytest.warns(GaitsmithWarning, match="soles, which are stiff, sink in by up to"):
        motion = walked(distance=5.0, ground=bumps())
    assert -along_soles(motion).min() <= SUNK
    # the tips of flat feet touch: toes bend to the ground
    soles, down = posed(motion)[2], motion.contacts
    flat = down.all(-1)
    assert np.abs(along_soles(motion)[0][..., -1][flat]).max() < 1e-6
    assert soles.shape[1] == 2


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
def test_a_box_is_stepped_on_and_a_bar_stepped_over():
    height = np.zeros((351, 61))
    height[100:103] = 0.12  # 4 cm wide at z = 1.5
    height[200:260] = 0.15
    motion = walked(distance=5.0, ground=HeightField(height, 0.02, (-0.6, -0.5)))
    level = motion.labels.footstep_position[:, 1].round(3)
    assert set(level) == {0.0, 0.15}


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
def test_no_foot_stands_across_a_ridge():
    z = np.abs((np.arange(451) * 0.02) % 3.0 - 1.5)
    ramps = HeightField(
        np.tile((z * np.tan(np.radians(8.0)))[:, None], (1, 61)), 0.02, (-0.6, -2.0)
    )
    motion = walked(distance=5.0, ground=ramps)
    assert -along_soles(motion).min() <= SUNK


# --------------------------------------------------------------------- scripts, footsteps


def test_scripts_on_slopes_and_stairs():
    walked(do="walk to 0,1; turn left 90; step back 0.3; step right 0.3", ground="slope:10")
    stepped(do="walk to 0,2.6; turn right 180; walk to 0,0", ground="stairs:0.15,0.3,3")


def test_given_footsteps_have_their_height_from_the_ground():
    rows = [("L", 0.05, 0.0), ("R", -0.05, 0.0), ("R", -0.05, 0.6), ("L", 0.05, 1.1)]
    rows += [("R", -0.05, 1.1)]
    steps = [{"side": s, "x": x, "z": z, "heading_deg": 0.0} for s, x, z in rows]
    motion = walked(steps=steps, ground="slope:10")
    height = motion.labels.footstep_position[:, 1]
    np.testing.assert_allclose(height, [z * np.tan(np.radians(10.0)) for *_, z in rows], atol=1e-12)
    with_height = [row | {"y": float(y)} for row, y in zip(steps, height, strict=True)]
    gaitsmith.walk(steps=with_height, ground="slope:10")
    with pytest.raises(InvalidInputError, match="footstep 4: y is 0 m, a foot that stands there"):
        gaitsmith.walk(steps=[row | {"y": 0.0} for row in steps], ground="slope:10")


# ------------------------------------------------------------------------------- recipes


def test_level_ground_said_or_not_is_the_same_walk():
    said, silent = gaitsmith.walk(distance=2.0, ground="flat"), gaitsmith.walk(distance=2.0)
    assert said.rotations.tobytes() == silent.rotations.tobytes()
    assert said.labels.recipe == silent.labels.recipe


@pytest.mark.filterwarnings("ignore::gaitsmith.errors.GaitsmithWarning")
@pytest.mark.parametrize("ground", ["slope:5", "stairs:0.12,0.3,3", bumps(cell=0.25)], ids=str)
def test_a_recipe_holds_its_ground(ground):
    motion = gaitsmith.walk(distance=3.0, ground=ground)
    again = gaitsmith.regenerate(motion)
    assert again.rotations.tobytes() == motion.rotations.tobytes()
    assert json.loads(again.labels.recipe) == json.loads(motion.labels.recipe)


# ------------------------------------------------------------------------------ refusals


@pytest.mark.parametrize(
    ("ground", "says"),
    [
        ("stairs:0.5,0.4,3", r"rises by 0.50 m at \(0.00, 1.00\), more than the 0.23 m"),
        ("stairs:-0.5,0.4,3", r"drops by 0.50 m at \(0.00, 1.00\)"),
        ("stairs:0.15,0.15,5", r"no place for a foot of 0.27 m within a step"),
        ("slope:50", r"slopes by 50 deg, more than the 30 deg"),
        ("stairs:0.15,0.3,20", r"the path ends at \(0.00, 3.20\), where feet cannot stand"),
    ],
)
def test_what_nobody_can_walk_is_refused_with_place_and_limit(ground, says):
    with pytest.raises(InfeasibleError, match=says):
        gaitsmith.walk(distance=3.2, ground=ground)


@pytest.mark.slow
def test_a_gap_is_refused_and_a_narrow_one_is_stepped_over():
    def trench(width):
        height = np.zeros((401, 101))
        height[200 : 200 + round(100 * width)] = -1.0
        return HeightField(height, 0.01, (-0.5, -0.5))

    stepped_over = walked(distance=3.0, ground=trench(0.3))
    assert set(stepped_over.labels.footstep_position[:, 1]) == {0.0}
    with pytest.raises(InfeasibleError, match=r"drops by 1.00 m at \(0.00, 1.5"):
        gaitsmith.walk(distance=3.0, ground=trench(0.9))


def test_a_given_footstep_on_an_edge_is_refused():
    rows = [("L", 0.05, 0.6), ("R", -0.05, 0.6), ("R", -0.05, 0.95), ("L", 0.05, 0.95)]
    steps = [{"side": s, "x": x, "z": z, "heading_deg": 0.0} for s, x, z in rows]
    with pytest.raises(InfeasibleError, match=r"footstep 3 \(right\) at \(-0.05, 0.95\)"):
        gaitsmith.walk(steps=steps, ground="stairs:0.15,0.3,3")


def test_what_is_said_of_steps_upstairs_is_measured_upstairs():
    motion = gaitsmith.walk(distance=6.0, ground="stairs:0.17,0.29,10")
    facts = promises(motion, Stairs(0.17, 0.29, 10))
    assert facts["step_length_m"] == pytest.approx(0.29, abs=0.002)
    assert facts["speed_mps"] < 0.6


def test_a_script_starts_on_a_slope_without_a_jolt():
    """Feet that stand nearly side by side stand on one place, as the hips feel it."""
    motion = gaitsmith.walk(
        do="follow 0,3 1,5; walk to 3,6", ground="slope:-15", fps=120
    ).root_position
    assert np.abs(np.diff(motion[:240, 1], 2)).max() * 120.0**2 < 10.0  # m/s2; 44 before
