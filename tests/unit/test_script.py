"""Scripts: what they say, what is wrong in them, and the plans they become."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from people import GROUND, person

from gaitsmith.conventions import LEFT, RIGHT
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.plan.director import Manners, direct
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import preferred_pace
from gaitsmith.plan.script import (
    BeAt,
    Face,
    Follow,
    Lean,
    LookAt,
    Script,
    Stand,
    Step,
    Turn,
    WalkTo,
    read_script,
)

ADULT = person(1.75)
MANNERS = Manners(ADULT, preferred_pace(ADULT), Stance(0.1, 0.1), GROUND)


def planned(script, manners=MANNERS):
    return direct(read_script(script), manners)


def stands(plan):
    """Middle of the feet and mean of their headings at the end, degrees."""
    last = {int(s): i for i, s in enumerate(plan.side)}
    position, heading = plan.position, plan.heading
    middle = 0.5 * (position[last[LEFT]] + position[last[RIGHT]])
    return middle[[0, 2]], np.degrees(0.5 * (heading[last[LEFT]] + heading[last[RIGHT]]))


def test_every_action_is_read():
    text = (
        "walk to 0,3; follow 1,4 -2.5,6; step forward 0.5; step BACK .3; step left 1; turn left 90;"
        " turn right 30; face -45; look at 1,1.5,2; look ahead; stand 2; lean forward 10;"
        " be at 1,2; be at 1,2 facing 90 feet side by side; be at 0,0 feet L .1,0,5 R -.1,0,-5;"
    )
    assert read_script(text) == [
        WalkTo((0.0, 3.0)),
        Follow(((1.0, 4.0), (-2.5, 6.0))),
        Step("forward", 0.5),
        Step("back", 0.3),
        Step("left", 1.0),
        Turn(np.radians(90.0)),
        Turn(-np.radians(30.0)),
        Face(np.radians(-45.0)),
        LookAt((1.0, 1.5, 2.0)),
        LookAt(None),
        Stand(2.0),
        Lean("forward", np.radians(10.0)),
        BeAt((1.0, 2.0)),
        BeAt((1.0, 2.0), np.radians(90.0)),
        BeAt((0.0, 0.0), None, ((0.1, 0.0, np.radians(5.0)), (-0.1, 0.0, np.radians(-5.0)))),
    ]
    assert read_script(["walk to 0,3", Turn(1.0), "stand 1; stand 2"]) == [
        WalkTo((0.0, 3.0)),
        Turn(1.0),
        Stand(1.0),
        Stand(2.0),
    ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "script is empty"),
        ("stand 1;; stand 1", "action 2 is empty"),
        (
            "stand 1; wlak to 0,3",
            r"action 2 'wlak to 0,3': unknown action 'wlak', did you mean 'walk'",
        ),
        (
            "step sideways 1",
            r"action 1 .*unknown way 'sideways', did you mean .*write step forward",
        ),
        ("turn up 3", r"unknown way 'up'"),
        ("walk 0,3", r"unknown word '0,3', did you mean 'to'"),
        ("walk to 0", r"the point must be 2 numbers joined by commas, got '0'"),
        ("walk to 0,nan", r"the point must be 2 numbers"),
        ("walk to 0,3 4,5", r"'4,5' is one word too many"),
        ("turn left", r"the angle is missing; write turn left\|right DEGREES"),
        ("step forward -1", r"the distance must be above 0 and at most 100 m, got -1"),
        ("stand 0", r"the time must be above 0"),
        ("lean left 90", r"at most 45 deg"),
        ("look up", r"unknown word 'up'"),
        ("be at 1,2 faced 3", r"unknown word 'faced', did you mean 'facing'"),
    ],
)
def test_what_is_wrong_is_named_with_the_action_and_the_nearest_word(text, says):
    with pytest.raises(InvalidInputError, match=says):
        read_script(text)


numbers = st.floats(-20.0, 20.0).map(lambda v: round(v, 3))
sizes = st.floats(0.01, 30.0).map(lambda v: round(v, 3))
ways = st.sampled_from(["forward", "back", "left", "right"])
angles = st.floats(0.0, 6.0)
actions = st.one_of(
    st.builds(WalkTo, st.tuples(numbers, numbers)),
    st.builds(Follow, st.lists(st.tuples(numbers, numbers), min_size=1, max_size=3).map(tuple)),
    st.builds(Step, ways, sizes),
    st.builds(Turn, st.floats(-6.0, 6.0)),
    st.builds(Face, angles),
    st.builds(LookAt, st.none() | st.tuples(numbers, numbers, numbers)),
    st.builds(Stand, sizes),
    st.builds(Lean, ways, st.floats(0.0, 0.7)),
    st.builds(BeAt, st.tuples(numbers, numbers), st.none() | angles),
)


@given(st.lists(actions, min_size=1, max_size=5))
def test_what_is_written_is_read_back(script):
    back = read_script(Script(tuple(script)).text)
    assert [type(a) for a in back] == [type(a) for a in script]
    for one, other in zip(back, script, strict=True):
        for name in one.__dataclass_fields__:
            mine, theirs = getattr(one, name), getattr(other, name)
            if isinstance(theirs, float):
                assert mine == pytest.approx(theirs, abs=1e-12)
            elif name == "point" or name == "points" or isinstance(theirs, str):
                assert mine == theirs


# plans --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("script", "place", "facing"),
    [
        ("walk to 0,3", (0.0, 3.0), 0.0),
        ("walk to 2,2", (2.0, 2.0), None),
        ("step forward 0.5", (0.0, 0.5), 0.0),
        ("step back 1.3", (0.0, -1.3), 0.0),
        ("step left 0.4", (0.4, 0.0), 0.0),
        ("step right 2", (-2.0, 0.0), 0.0),
        ("step left 0.4; step right 0.4", (0.0, 0.0), 0.0),
        ("face 90", None, 90.0),
        ("face -135", None, -135.0),
        ("turn left 720", None, 720.0),
        ("turn right 30; face 0", None, 0.0),
        ("walk to 0,3; face 90; step forward 0.3", None, 90.0),
        ("be at 0.2,0.1", (0.2, 0.1), 0.0),
        ("be at 2,1 facing 120", (2.0, 1.0), 120.0),
        ("be at -0.3,-0.4 facing -90", (-0.3, -0.4), -90.0),
        ("be at 1,1 feet L 1.1,1,4 R 0.9,1,-2", (1.0, 1.0), 1.0),
    ],
)
def test_where_a_script_ends(script, place, facing):
    middle, heading = stands(planned(script))
    if place is not None:
        np.testing.assert_allclose(middle, place, atol=1e-9)
    if facing is not None:
        assert heading == pytest.approx(facing, abs=1e-6)


def test_walks_one_after_the_other_are_one_walk():
    plan = planned("walk to 0,4; walk to 3,6; follow 3,9 1,11")
    assert plan.kinds.count("start") == plan.kinds.count("stop") == 1
    on_the_way = np.linalg.norm(plan.path[:, None] - np.array([[0, 4], [3, 6], [3, 9]]), axis=-1)
    assert on_the_way.min(0).max() < 0.011
    assert planned("walk to 0,4; stand 1; walk to 0,8").kinds.count("start") == 2
    # where it would have to turn back it stops
    assert planned("walk to 0,4; walk to 0,0").kinds.count("stop") == 2


def test_a_turn_is_shared_out_and_the_gaze_leads_by_half_a_step():
    """At most 60 deg for a pair of steps, 2.5 steps for the first; the head a little ahead."""
    lead, first, second = planned("turn left 60").planned
    assert lead.kind == "stand"
    assert first.duration == second.duration
    assert lead.duration == pytest.approx(0.5 * first.duration)
    for step, start in ((lead, 0.0), (first, 0.5), (second, 1.5)):
        scale = step.duration / first.duration
        for turn, begin, end in step.local.glances:
            assert turn == pytest.approx(np.pi / 6.0), "what one step turns the pelvis by"
            assert start + scale * begin == pytest.approx(round(start + scale * begin))
            assert scale * (end - begin) == pytest.approx(1.0)
    assert second.local.gaze == pytest.approx(np.pi / 6.0), "the first turn of the gaze is over"
    pairs = {45: 1, 60: 1, 61: 2, 90: 2, 180: 3, 360: 6}
    for angle, count in pairs.items():
        assert len(planned(f"turn right {angle}").side) == 2 + 2 * count


def test_a_turn_before_a_walk_is_the_dynamic_one():
    """2 lambda ahead facilitates the step that follows; the rear foot takes it."""
    plan = planned("turn left 90; walk to 4,0")
    turn = [s for s in plan.planned if s.kind == "turn"]
    gap = turn[-1].target.position - turn[-2].target.position
    assert gap @ np.array([1.0, 0.0, 0.0]) == pytest.approx(ADULT.hip_width)
    start = next(s for s in plan.planned if s.kind == "start")
    assert start.target.side == LEFT
    still = [s for s in planned("turn left 90; stand 1").planned if s.kind == "turn"]
    gap = still[-1].target.position - still[-2].target.position
    assert gap @ np.array([1.0, 0.0, 0.0]) == pytest.approx(0.0, abs=1e-12)


def test_where_a_curve_turns_back_on_itself_the_walk_stops_and_turns():
    plan = planned("follow 0,3 0,0.5 0,3")
    assert plan.kinds.count("stop") == 3
    np.testing.assert_allclose(stands(plan)[0], (0.0, 3.0), atol=1e-9)
    stops = [
        0.5 * (s.stance.position + s.target.position) for s in plan.planned if s.kind == "stop"
    ]
    np.testing.assert_allclose(stops, [[0, 0, 3.0], [0, 0, 0.5], [0, 0, 3.0]], atol=1e-9)
    plan = planned("follow 1,1 0,0.5 2,0 -1,3")
    np.testing.assert_allclose(stands(plan)[0], (-1.0, 3.0), atol=1e-9)


@pytest.mark.parametrize(
    ("feet", "why"),
    [
        ("L 0.01,0,0 R -0.01,0,0", "axes would be 0.020 m apart"),
        ("L -0.1,0,0 R 0.1,0,0", "legs would cross"),
        ("L 0.6,0,0 R -0.6,0,0", "1.20 m apart"),
        ("L 0.15,0,80 R -0.15,0,-80", "turned 160 deg apart"),
    ],
)
def test_a_stance_that_nobody_takes_is_refused_with_the_nearest(feet, why):
    with pytest.raises(InfeasibleError, match=rf"action 1 \(BeAt\).*{why}.*nearest.* feet L") as e:
        planned(f"be at 0,0 feet {feet}")
    nearest = str(e.value).split("is: ")[1]
    assert stands(planned(f"be at 0,0 {nearest}"))[0] == pytest.approx((0.0, 0.0), abs=1e-3)


def test_what_cannot_be_done_names_the_action():
    with pytest.raises(InfeasibleError, match=r"action 2 \(BeAt\): nobody stands so"):
        planned("stand 1; be at 0,1 feet L 0,1,0 R 0,1,0")
