"""The product's elevation walker: [SM01]'s data, the shared contact stage, any ground."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import along_soles, broken, posed, shins_into_ground
from people import heights, person

import gaitsmith
from gaitsmith.errors import GaitsmithWarning, InvalidInputError
from gaitsmith.ground import HeightField, Slope, Stairs
from gaitsmith.synthesis.gaits import GAITS, by_elevation
from gaitsmith.walks.elevation import SHANK, THIGH
from gaitsmith.walks.elevation_sets import neutral_legs, spanning_sets
from gaitsmith.walks.elevation_walk import ElevationWalk
from gaitsmith.walks.model import ClimbingWalk, StepRequest

WALK = ElevationWalk(spanning_sets(neutral_legs()))


def walked(**asked):
    """A motion at 120 frames a second that keeps the promises."""
    motion = gaitsmith.walk(**{"fps": 120, "walker": "elevation", **asked})
    assert broken(motion, but=("footsteps_unseen",)) == {}
    assert shins_into_ground(motion) <= 0.0005
    return motion


def elevations(motion, side):
    """(F, 2) of shank and thigh, radians, forward positive, for a walk along +Z."""
    at, names = posed(motion)[0], motion.skeleton
    hip, knee, ankle = (
        at[:, names.index(side + part)] for part in ("UpperLeg", "LowerLeg", "Foot")
    )
    ways = np.stack([ankle - knee, knee - hip], axis=1)
    return np.arctan2(ways[..., 2], -ways[..., 1])


def at_strikes(motion):
    """Frames of heel strikes in mid-walk, and the side that lands: index 0 left, 1 right."""
    labels = motion.labels
    picked = slice(4, len(labels.footstep_time) - 3)
    frames = np.round(np.array(labels.footstep_time[picked]) * motion.fps).astype(int)
    return list(zip(frames.tolist(), labels.footstep_side[picked].tolist(), strict=True))


def landing_knee(motion):
    """Mean flexion of the landing knee at heel strike, degrees."""
    both = [elevations(motion, side) for side in ("left", "right")]
    knees = [both[s][f, 1] - both[s][f, 0] for f, s in at_strikes(motion)]
    return float(np.degrees(np.mean(knees)))


# ------------------------------------------------------------------------------- promises


@settings(max_examples=6, deadline=None)
@given(body=heights(), ratio=st.floats(0.35, 0.95), deg=st.floats(-15.0, 15.0))
def test_promises_on_slopes(body, ratio, deg):
    who = person(body)
    walked(distance=4.0, body=who, step_length=ratio * who.leg_length, ground=Slope(deg))


@pytest.mark.slow
@pytest.mark.parametrize("gait", ["neutral", "winter", "sneaky", "elderly"])
def test_promises_on_a_curve(gait):
    walked(path="0,0 0,2 1.5,3.5 3,3", gait=gait)


@pytest.mark.parametrize("rise", [0.17, -0.17])
def test_promises_on_stairs(rise):
    motion = walked(distance=5.0, ground=Stairs(rise, 0.29, 5))
    assert -along_soles(motion).max(0).min() <= 0.0005


def test_promises_on_bumps_and_height_fields():
    """Acceptance 7.4: feet land on the ground where the paper's prototype misses by 6 mm."""
    z = np.arange(-1.0, 9.0, 0.05)
    bumps = HeightField(np.tile(0.03 * np.sin(2.0 * np.pi * z / 3.0)[:, None], (1, 61)), 0.05)
    with pytest.warns(GaitsmithWarning, match="the ground is curved"):
        walked(path="1,1 1,6", ground=bumps)


def test_scripts_of_all_actions():
    walked(do="walk to 0,2; turn left 90; step right 0.3; walk to 2,2; be at 2,3 facing 0")


def test_the_recipe_regenerates_it_to_the_byte():
    motion = gaitsmith.walk(distance=3.0, walker="elevation", ground=Slope(6.0))
    again = gaitsmith.regenerate(motion)
    assert json.loads(motion.labels.recipe)["walk"]["walker"] == "elevation"
    np.testing.assert_array_equal(motion.rotations, again.rotations)
    np.testing.assert_array_equal(motion.root_position, again.root_position)


def test_another_walker_is_refused_by_name():
    with pytest.raises(InvalidInputError, match="walker must be one of kinematic, elevation"):
        gaitsmith.walk(distance=3.0, walker="elevator")


# ------------------------------------------------------------------------- what the data say


def test_legs_come_near_to_the_data_on_their_own_body():
    """Thigh and shank against the normal set, root mean square over a stride, degrees."""
    legs = neutral_legs()
    motion = gaitsmith.walk(
        distance=9.0, body=legs.body, walker="elevation", step_length=legs.length, fps=120
    )
    (first, side), (_, _), (last, _) = at_strikes(motion)[:3]
    own = elevations(motion, ("left", "right")[side])[first:last]
    data = spanning_sets(legs)[0].at(np.arange(last - first) / (last - first))
    errors = np.degrees(own - data[:, [SHANK, THIGH]])
    assert np.sqrt((errors**2).mean(axis=0)).max() < 3.0


@pytest.mark.parametrize(("deg", "least", "most"), [(10.0, 20.0, 33.0), (-10.0, 8.0, 25.0)])
def test_knees_at_heel_strike_on_slopes(deg, least, most):
    """U6: 10 to 20 deg more than on the level (about 8) uphill; downhill as on the level."""
    motion = gaitsmith.walk(distance=9.0, walker="elevation", ground=Slope(deg), fps=120)
    assert least < landing_knee(motion) < most


def test_the_knee_yields_downhill():
    """U7: 30 to 45 deg in loading at 10 deg down, where the level walk has some 20."""
    flexion = {}
    for deg in (0.0, -10.0):
        motion = gaitsmith.walk(distance=9.0, walker="elevation", ground=Slope(deg), fps=120)
        leg = elevations(motion, "left")
        frames = [f for f, side in at_strikes(motion) if side == 0]
        loads = [np.ptp(leg[f : f + 20], axis=1).max() for f in frames]
        flexion[deg] = np.degrees(np.mean(loads))
    assert flexion[0.0] < 25.0
    assert 30.0 < flexion[-10.0] < 48.0


def test_same_step_same_answer_whatever_was_asked_before():
    """Acceptance 7.7: no history."""
    body = person(1.6)
    fresh = ElevationWalk(spanning_sets(neutral_legs()))
    request = StepRequest(0, 0.6, 0.7, 0.7, 0.55, climbs=(0.03, 0.05))
    for length in (0.3, 0.5, 0.9):
        WALK.step(body, StepRequest(0, length, length, length, 0.5, climbs=(0.1, -0.1)))
    one, other = WALK.step(body, request), fresh.step(body, request)
    np.testing.assert_array_equal(one.center, other.center)
    np.testing.assert_array_equal(one.ankle, other.ankle)


def test_steps_outside_of_the_data_are_said_to_be():
    leg = person(1.75).leg_length
    inside, outside = np.array([[0.8 * leg, 0.1 * leg]]), np.array([[0.3 * leg, 0.5 * leg]])
    assert not WALK.taken(person(1.75), inside).outside[0]
    np.testing.assert_allclose(WALK.taken(person(1.75), inside).missed, 0.0, atol=1e-9)
    far = WALK.taken(person(1.75), outside)
    assert far.outside[0]
    assert np.abs(far.missed).max() > 0.02


@settings(max_examples=25, deadline=None)
@given(
    body=heights(),
    ratio=st.tuples(st.floats(0.2, 1.1), st.floats(0.2, 1.1), st.floats(0.2, 1.1)),
    grade=st.tuples(st.floats(-0.27, 0.27), st.floats(-0.27, 0.27), st.floats(-0.27, 0.27)),
)
def test_climbing_steps_join(body, ratio, grade):
    """The end of a step is the start of the next, with legs exchanged, whatever the ground."""
    who = person(body)
    lengths = [r * who.leg_length for r in ratio]
    climbs = [length * g for length, g in zip(lengths, grade, strict=True)]
    one, two = (
        WALK.step(
            who,
            StepRequest(
                i, lengths[i], lengths[i + 1], lengths[i + 1], 0.55, climbs=tuple(climbs[i : i + 2])
            ),
        )
        for i in (0, 1)
    )
    ahead = [lengths[1], 0.0]
    np.testing.assert_allclose(one.center[-1] - ahead, two.center[0], atol=1e-9)
    np.testing.assert_allclose(one.ankle[-1, ::-1] - ahead, two.ankle[0], atol=1e-9)
    np.testing.assert_allclose(one.pitch[-1, ::-1], two.pitch[0], atol=1e-9)


@pytest.mark.slow
def test_the_hips_keep_their_speed_at_heel_strike():
    """Acceptance 7.3: a step of less than 0.05 m/s, where the paper's walker has 0.4."""
    fps = 4000
    for deg in (0.0, 8.0, -8.0):
        motion = gaitsmith.walk(distance=4.0, walker="elevation", ground=Slope(deg), fps=fps)
        at = posed(motion)[0][:, [motion.skeleton.index(f"{s}UpperLeg") for s in ("left", "right")]]
        speed = np.diff(at.mean(axis=1), axis=0) * fps
        times = np.array(motion.labels.footstep_time[2:-1])
        frames = np.round(times * fps).astype(int)
        jumps = np.linalg.norm(speed[frames + 3] - speed[frames - 4], axis=-1)
        assert jumps.max() < 0.05


def test_level_walking_turns_no_joint_fast():
    """Acceptance 7.8: 12 degrees per 1/60 s."""
    for body in (1.2, 1.75, 2.1):
        motion = gaitsmith.walk(
            distance=6.0, body=body, walker="elevation", fps=120, start="walk", stop="walk"
        )
        q = motion.rotations
        turned = 2.0 * np.arccos(np.clip(np.abs((q[1:] * q[:-1]).sum(-1)), 0.0, 1.0))
        assert np.degrees(turned.max()) * 120 / 60 < 12.0


def test_toes_leave_as_the_own_walk_has_them():
    """Between samples, too: the meta angle ends there, and a set must not show half of it."""
    legs = neutral_legs()
    for toe_off in (0.2, 0.2466443, 0.31):
        late = LateToes(legs.walk, toe_off)
        walk = ElevationWalk(spanning_sets(replace(legs, walk=late)))
        asked = StepRequest(0, legs.length, legs.length, legs.length, 0.55)
        own, mixed = late.step(legs.body, asked), walk.step(legs.body, asked)
        ends = [s.meta[s.phase <= s.toe_off, 1][-1] for s in (own, mixed)]
        assert ends[1] == pytest.approx(ends[0], abs=np.radians(1.0))
        assert ends[0] > np.radians(5.0)


class LateToes:
    """A walk whose toes leave at another phase."""

    def __init__(self, walk, toe_off):
        self.walk, self.toe_off = walk, toe_off

    def step(self, body, request):
        step = self.walk.step(body, request)
        phase = np.interp(step.phase, [0.0, step.toe_off, 1.0], [0.0, self.toe_off, 1.0])
        flat, heel, meta = (
            float(np.interp(e, step.phase, phase)) if e < 1.0 else e
            for e in (step.flat, step.heel_off, step.meta_off)
        )
        return replace(
            step, phase=phase, toe_off=self.toe_off, flat=flat, heel_off=heel, meta_off=meta
        )


# ------------------------------------------------------------------------------- any gait


@pytest.mark.slow
def test_every_built_in_gait_has_elevation_data():
    for name in ("neutral", "winter", "proud"):
        walk = by_elevation(GAITS[name](None)).walk
        assert isinstance(walk, ClimbingWalk)
        assert walk.climbs


def test_a_limp_stays_a_limp():
    """Sets of either leg: steps on the left and on the right foot keep differing."""
    body, sets = neutral_legs().body, spanning_sets(neutral_legs())
    stiff = [replace(s, angles=s.angles * [1.0, 1.0, 0.9, 1.0]) for s in sets]
    for walk, differ in ((WALK, False), (ElevationWalk(sets, stiff), True)):
        left, right = (walk.step(body, StepRequest(i, 0.7, 0.7, 0.7, 0.55)) for i in (0, 1))
        assert (np.abs(left.center - right.center).max() > 0.005) == differ
