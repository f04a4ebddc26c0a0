"""A script may begin anywhere, in any stance, later, and at paces of its own."""

from __future__ import annotations

import json

import numpy as np
import pytest
from judge import broken

from gaitsmith import InfeasibleError, InvalidInputError, regenerate, walk
from gaitsmith.geometry.rotations import rotate
from gaitsmith.motion.kinematics import joint_positions, motion_kinematics, sole_positions
from gaitsmith.plan.legs import legs_of
from gaitsmith.plan.pace import Pace
from gaitsmith.plan.paths import Path
from gaitsmith.plan.script import BeAt, Follow, LookAt, Stand, Step, Tempo, Turn, WalkTo
from gaitsmith.plan.start import Start

ACTIONS = [
    WalkTo((0.4, 2.5)),
    Follow(((1.5, 3.5), (3.0, 3.0))),
    Turn(1.3),
    Step("back", 0.3),
    BeAt((2.6, 2.4), 2.0),
]
ON_THE_SPOT = [Stand(0.5), Step("left", 0.3), LookAt((1.0, 1.2, 2.0)), Stand(1.0), Turn(-0.8)]


def moved(points, at, heading):
    """x, z turned left by ``heading`` and carried to ``at``."""
    x, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([at[0] + c * x + s * z, at[1] - s * x + c * z], axis=-1)


def carried(actions, at, heading):
    out = []
    for action in actions:
        if isinstance(action, WalkTo | BeAt):
            turned = {"point": tuple(moved(action.point, at, heading))}
            if isinstance(action, BeAt):
                turned["heading"] = action.heading + heading
            out.append(type(action)(**turned))
        elif isinstance(action, Follow):
            out.append(Follow(tuple(map(tuple, moved(action.points, at, heading)))))
        elif isinstance(action, LookAt):
            x, y, z = action.point
            (x, z) = moved((x, z), at, heading)
            out.append(LookAt((x, y, z)))
        else:
            out.append(action)
    return out


@pytest.mark.parametrize("actions", [ACTIONS, ON_THE_SPOT])
@pytest.mark.parametrize(("at", "heading"), [((3.0, -2.0), 1.1), ((-7.5, 4.0), -2.9)])
def test_a_script_carried_elsewhere_is_the_same_script(actions, at, heading):
    """Rigid motions of the floor change nothing, to 1e-9."""
    here = walk(do=actions, fps=24.0)
    there = walk(do=carried(actions, at, heading), start=Start(at=at, facing=heading), fps=24.0)
    assert len(here) == len(there)
    one, other = joint_positions(here), joint_positions(there)
    np.testing.assert_allclose(other[..., 1], one[..., 1], atol=1e-9)
    np.testing.assert_allclose(
        other[..., [0, 2]], moved(one[..., [0, 2]], at, heading), atol=1e-9, rtol=0
    )
    front = [
        rotate(motion_kinematics(motion)[1], np.array([0.0, 0.0, 1.0])) for motion in (here, there)
    ]
    np.testing.assert_allclose(
        front[1][..., [0, 2]], moved(front[0][..., [0, 2]], (0.0, 0.0), heading), atol=1e-9
    )
    turn = there.labels.footstep_heading - here.labels.footstep_heading
    np.testing.assert_allclose(turn, heading, atol=1e-9)


def test_a_distance_begins_where_it_is_told():
    here = walk(distance=2.0, fps=24.0)
    there = walk(distance=2.0, fps=24.0, start=Start(at=(1.0, 2.0), facing=0.7))
    one, other = joint_positions(here), joint_positions(there)
    np.testing.assert_allclose(
        other[..., [0, 2]], moved(one[..., [0, 2]], (1.0, 2.0), 0.7), atol=1e-9, rtol=0
    )


@pytest.mark.parametrize("script", ["walk to 0,2", "step left 0.4", "turn right 80"])
def test_who_starts_from_given_feet_stands_on_them(script):
    feet = ((0.12, 0.18, 0.25), (-0.08, -0.02, -0.1))
    motion = walk(do=script, start=Start(feet=feet), fps=60.0)
    assert not broken(motion)
    first = {
        int(s): (p, h)
        for s, p, h in zip(
            motion.labels.footstep_side[:2],
            motion.labels.footstep_position[:2],
            motion.labels.footstep_heading[:2],
            strict=True,
        )
    }
    for side, (x, z, heading) in enumerate(feet):
        np.testing.assert_allclose(first[side][0][[0, 2]], (x, z), atol=1e-12)
        assert first[side][1] == pytest.approx(heading, abs=1e-12)
    heel, ball = sole_positions(motion.skeleton, *motion_kinematics(motion))[0, 0, :2]
    way = ball - heel
    assert np.arctan2(way[0], way[2]) == pytest.approx(feet[0][2], abs=1e-9)


@pytest.mark.parametrize(
    ("start", "error", "says"),
    [
        ({"feet": ((-0.1, 0, 0), (0.1, 0, 0))}, InfeasibleError, "left foot is -0.200 m to the"),
        ({"feet": ((0.02, 0, 0), (0.0, 0, 0))}, InfeasibleError, "0.045 m apart"),
        ({"feet": ((0.4, 0, 0), (-0.4, 0, 0))}, InfeasibleError, "0.800 m apart, more than"),
        ({"feet": ((0.1, 0, 1.2), (-0.1, 0, -1.2))}, InfeasibleError, "138 deg apart"),
    ],
)
def test_feet_that_nobody_stands_on_are_refused(start, error, says):
    with pytest.raises(error, match=says):
        walk(do="stand 1", start=Start(**start))


@pytest.mark.parametrize(
    ("start", "says"),
    [
        ({"at": (1.0, 0.0), "feet": ((0.1, 0, 0), (-0.1, 0, 0))}, "not the middle of the feet"),
        ({"facing": 1.0, "feet": ((0.1, 0, 0), (-0.1, 0, 0))}, "not the mean of the feet"),
        ({"at": (1.0, float("nan"))}, "finite"),
        ({"at": (2000.0, 0.0)}, "within 1000 m"),
    ],
)
def test_starts_that_contradict_themselves_are_refused(start, says):
    with pytest.raises(InvalidInputError, match=says):
        Start(**start)


def test_a_path_begins_where_its_first_point_is():
    with pytest.raises(InvalidInputError, match="a path and footsteps begin where they say"):
        walk(path="0,0 0,3", start=Start(at=(1.0, 0.0)))
    with pytest.raises(InvalidInputError, match="needs start and stop 'stand'"):
        walk(distance=3.0, start="walk", begin=1.0)


# later --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("where", [{"do": "walk to 0,1.5"}, {"distance": 1.5}])
def test_who_begins_later_stands_until_then_and_stands_on_after(where):
    """A whole number of frames late, it is the same walk."""
    now, late = walk(**where, fps=30.0), walk(**where, fps=30.0, begin=1.5, until=8.0)
    assert len(late) == 241
    before, after = slice(0, 46), slice(45 + len(now) - 1, None)
    np.testing.assert_allclose(late.rotations[45 : 45 + len(now)], now.rotations, atol=1e-12)
    for part, pose in ((before, 0), (after, -1)):
        still = np.broadcast_to(now.rotations[pose], late.rotations[part].shape)
        np.testing.assert_array_equal(late.rotations[part], still)
        assert late.contacts[part].all()
    np.testing.assert_allclose(
        late.labels.footstep_time[2:], now.labels.footstep_time[2:] + 1.5, atol=1e-12
    )
    assert not broken(late)
    again = regenerate(late)
    assert again.labels.recipe == late.labels.recipe
    np.testing.assert_array_equal(again.root_position, late.root_position)


# tempo --------------------------------------------------------------------------------------------


def test_an_action_that_walks_all_the_way_at_one_speed_is_that_walk():
    one, other = walk(distance=4.0, speed=1.0, fps=24.0), walk(do="walk to 0,4 speed 1", fps=24.0)
    np.testing.assert_allclose(other.root_position, one.root_position, atol=1e-9)
    np.testing.assert_allclose(other.rotations, one.rotations, atol=1e-9)


def test_half_of_the_change_of_pace_is_done_where_two_legs_meet():
    slow, quick = Pace(0.4, 90.0), Pace(0.8, 120.0)
    path = Path.through([(0.0, 0.0), (1.0, 5.0), (4.0, 8.0)])
    base, legs = legs_of(path, [np.array([1.0, 5.0]), np.array([4.0, 8.0])], [slow, quick])
    assert base == quick
    meet = path.along[np.linalg.norm(path.points - [1.0, 5.0], axis=1).argmin()]
    at = meet + np.array([-0.8, 0.0, 0.8])
    np.testing.assert_allclose(legs.length_at(at), [0.5, 0.75, 1.0], atol=1e-12)
    np.testing.assert_allclose(legs.duration_at(at), [4.0 / 3.0, 7.0 / 6.0, 1.0], atol=1e-12)


@pytest.mark.parametrize(
    "script", ["walk to 0,5 {}; walk to 0,12 {}", "follow 1,5 {}; walk to 5,9 {}"]
)
def test_the_pace_changes_on_the_way_without_a_stop(script):
    """Steady steps on both legs have what was asked for; the change takes about two steps."""
    motion = walk(
        do=script.format("step-length 0.5 cadence 100", "speed 1.5 cadence 120"), fps=60.0
    )
    assert not broken(motion)
    labels = motion.labels
    place, time = labels.footstep_position[:, [0, 2]], labels.footstep_time
    assert (np.diff(time[1:]) < 1.0).all(), "nowhere a stop"
    if "follow" not in script:
        steps = np.diff(place[2:, 1])
        np.testing.assert_allclose(steps[1:7], 0.5, atol=1e-9)
        np.testing.assert_allclose(np.diff(time)[3:9], 0.6, atol=1e-9)
        fast = np.flatnonzero(np.abs(steps - 0.75) < 1e-9)
        assert len(fast) >= 3
        np.testing.assert_allclose(np.diff(time)[2:][fast], 0.5, atol=1e-9)
        change = (steps > 0.5 + 1e-9) & (steps < 0.75 - 1e-9) & (place[3:, 1] < 7.0)
        assert 1 <= change.sum() <= 4


def jolt(motion):
    """Largest change of the hips' velocity, m/s2."""
    change = np.diff(motion.root_position, 2, axis=0) * motion.fps**2
    return np.linalg.norm(change, axis=-1).max()


@pytest.mark.parametrize(
    "script",
    [
        "walk to 0,3 gait winter; walk to 0,6; turn left 90; walk to 3,6 gait winter",
        "step left 0.3; follow 0.5,2 0,4 gait winter speed 0.9; be at 1,5 facing 30 gait winter",
    ],
)
def test_actions_walk_in_gaits_of_their_own_without_a_hitch(script):
    """Every promise, and hips that change their velocity no more than within one gait."""
    motion = walk(do=script, fps=120.0)
    assert not broken(motion)
    plain = script.replace(" gait winter", "")
    pure = [walk(do=plain, gait=gait, fps=120.0) for gait in ("neutral", "winter")]
    assert jolt(motion) < 1.1 * max(map(jolt, pure))
    again = regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)


def test_an_action_in_another_gait_is_that_gait():
    """But for the stance, which stays the person's own."""
    own = walk(distance=1.0, fps=24.0)
    width = json.loads(own.labels.recipe)["walk"]["step_width"]
    other = walk(distance=3.0, gait="winter", step_width=width, toe_out=np.radians(6.0), fps=24.0)
    script = walk(do="walk to 0,3 gait winter", step_width=width, toe_out=np.radians(6.0), fps=24.0)
    named = walk(
        do="walk to 0,3 gait w",
        gaits={"w": "winter"},
        step_width=width,
        toe_out=np.radians(6.0),
        fps=24.0,
    )
    np.testing.assert_allclose(script.root_position, other.root_position, atol=1e-9)
    np.testing.assert_array_equal(named.rotations, script.rotations)
    assert np.abs(script.rotations - walk(do="walk to 0,3", fps=24.0).rotations).max() > 0.05


def test_walks_in_two_gaits_meet_in_standing():
    both = walk(do="walk to 0,3 gait winter; walk to 0,6 gait winter", fps=30.0)
    change = walk(do="walk to 0,3 gait winter; walk to 0,6", fps=30.0)
    assert (np.diff(both.labels.footstep_time[1:]) < 1.0).all()
    feet = change.labels.footstep_position[:, 2]
    assert (np.abs(feet - 3.0) < 1e-9).sum() == 2, "both feet at the point where the gait changes"


def test_a_gait_that_nobody_knows_names_the_action():
    with pytest.raises(InvalidInputError, match=r"action 2: unknown gait 'wintr'.*'winter'"):
        walk(do="stand 1; walk to 0,3 gait wintr")
    with pytest.raises(InvalidInputError, match="a name without blanks"):
        Tempo(gait="a b")


def test_a_tempo_that_nobody_walks_names_the_action():
    with pytest.raises(InfeasibleError, match=r"action 2 \(WalkTo\): speed 9"):
        walk(do="stand 1; walk to 0,3 speed 9")
    assert walk(do=[WalkTo((0.0, 2.0), Tempo(speed=0.8))], fps=24).labels.recipe.count("speed 0.8")
