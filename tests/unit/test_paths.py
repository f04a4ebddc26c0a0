"""Paths, where to walk as people write it, and edits of plans."""

from __future__ import annotations

import numpy as np
import pytest
from people import GROUND, person

from gaitsmith.errors import FileFormatError, InfeasibleError, InvalidInputError
from gaitsmith.geometry.splines import PlaneCurves, natural_spline
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.pipeline import regenerate, walk
from gaitsmith.plan import editing
from gaitsmith.plan.follow import LARGEST_TURN, follow
from gaitsmith.plan.given import GivenSteps, plan_given
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import Pace, preferred_pace
from gaitsmith.plan.paths import Path
from gaitsmith.plan.where import load_footsteps, load_points, parse_points

BODY = person(1.75)


def plan_on(path, **options):
    return follow(
        path, pace=Pace(0.7, 105.0), stance=Stance(0.1, 0.1), ground=GROUND, body=BODY, **options
    )


# shapes -----------------------------------------------------------------------------------


def test_the_spline_is_scipy_s():
    from scipy.interpolate import CubicSpline

    points = np.random.default_rng(0).uniform(-3, 3, (9, 2))
    ours = natural_spline(points)
    theirs = CubicSpline(ours.knots, points, bc_type="natural")
    u = np.linspace(ours.knots[0], ours.knots[-1], 200)
    np.testing.assert_allclose(ours.at(u), theirs(u), atol=1e-12)
    np.testing.assert_allclose(ours.derivative(u), theirs(u, 1), atol=1e-12)


@pytest.mark.parametrize(
    "path",
    [
        Path.arc(2.0, 3.0, heading=0.4),
        Path.figure_eight(6.0),
        Path.through([[0, 0], [0, 4], [2, 7], [-1, 9]]),
        Path.rounded([[0, 0], [0, 3], [3, 3], [3, 0]]),
    ],
)
def test_a_path_knows_its_arc_length_and_heading(path):
    s = np.linspace(0.0, path.length, 4001)
    points = path.at(s)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    np.testing.assert_allclose(steps, s[1], rtol=1e-4)
    way = np.diff(points, axis=0)
    seen = np.unwrap(np.arctan2(way[:, 0], way[:, 1]))
    np.testing.assert_allclose(path.heading_at(0.5 * (s[1:] + s[:-1])), seen, atol=2e-3)


def test_points_of_a_path_are_on_it():
    points = np.array([[0, 0], [0, 4], [2, 7], [-1, 9]])
    path = Path.through(points)
    s = np.linspace(0.0, path.length, 20001)
    apart = np.linalg.norm(path.at(s)[:, None] - points, axis=-1).min(0)
    assert apart.max() < 1e-3


def test_points_on_a_line_make_a_straight_path():
    path = Path.through([[1, 1], [1, 1.5], [1, 7]])
    assert path.straight
    assert path.length == pytest.approx(6.0)
    np.testing.assert_allclose(path.at(np.array([-1.0, 8.0])), [[1, 0], [1, 9]])


def test_a_rounded_corner_has_its_radius():
    path = Path.rounded([[0, 0], [0, 3], [3, 3]], radius=0.6)
    assert np.abs(path.curvature).max() == pytest.approx(1 / 0.6)
    assert path.length == pytest.approx(6.0 - 1.2 + 0.6 * np.pi / 2)
    np.testing.assert_allclose(path.points[-1], [3, 3], atol=1e-12)


def test_arc_lengths_of_plane_curves_and_back():
    rng = np.random.default_rng(1)
    start, end = rng.normal(0, 1, (2, 5, 2))
    curves = PlaneCurves.bezier(start, 0.5 * (start + end) + rng.normal(0, 0.2, (5, 2)), end)
    fine = np.stack([curves.at(np.full(5, u)) for u in np.linspace(0, 1, 20001)])
    np.testing.assert_allclose(
        curves.length(), np.linalg.norm(np.diff(fine, axis=0), axis=-1).sum(0), rtol=1e-7
    )
    row = np.arange(5)
    u = curves.parameter(row, 0.3 * curves.length())
    for i in range(5):
        part = fine[: int(u[i] * 20000) + 1, i]
        walked = np.linalg.norm(np.diff(part, axis=0), axis=-1).sum()
        assert walked == pytest.approx(0.3 * curves.length()[i], abs=2e-4)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[0, 0]], "at least two points, got 1"),
        ([], "at least two points|shape"),
        ([[0, 0], [0, 0], [1, 1]], "points 1 and 2 of the path are the same"),
        ([[0, 0], [0, np.nan]], "finite"),
        ([[0, 0, 1], [0, 1, 1]], "shape"),
    ],
)
def test_points_that_make_no_path(points, message):
    with pytest.raises(InvalidInputError, match=message):
        Path.through(points)


# footsteps --------------------------------------------------------------------------------


def test_a_path_begins_and_ends_as_the_contract_says():
    path = Path.arc(2.0, 3.0)
    plan = plan_on(path)
    for pair, at in ((slice(0, 2), 0.0), (slice(-2, None), path.length)):
        middle = plan.position[pair][:, [0, 2]].mean(0)
        np.testing.assert_allclose(middle, path.at(np.array([at]))[0], atol=1e-9)
    assert plan.side[2] == 1
    assert np.abs(np.diff(plan.direction)).max() < LARGEST_TURN
    mid_walk = plan_on(path, start="walk", stop="walk")
    first = mid_walk.position[1, [0, 2]]
    assert np.linalg.norm(first - path.points[0]) == pytest.approx(0.05, abs=1e-9)


def test_steps_are_shorter_and_slower_in_curves_only():
    plan = plan_on(Path.rounded([[0, 0], [0, 8], [8, 8]], radius=0.6))
    lengths, times = plan.step_lengths[1:], plan.durations
    assert lengths[2] == pytest.approx(0.7, abs=1e-6)
    turning = int(np.abs(np.diff(plan.direction[1:])).argmax())
    assert lengths[turning] < 0.62
    assert times[turning] > 1.1 * times[2]
    kept = plan_on(Path.rounded([[0, 0], [0, 8], [8, 8]], radius=0.6), keep_cadence=True)
    np.testing.assert_allclose(kept.durations[1:-1], 60.0 / 105.0)


def test_a_corner_that_no_step_can_turn_is_refused_with_its_place():
    with pytest.raises(InfeasibleError, match=r"turns by .* deg at .*, 3.00\).* 60 deg"):
        plan_on(Path.through([[0, 0], [0, 3], [0.3, 0]]))


def test_a_path_shorter_than_a_step_is_refused_in_mid_walk():
    with pytest.raises(InfeasibleError, match="holds no step"):
        plan_on(Path.arc(1.0, 0.3), start="walk", stop="walk")


def rows(count=6, turn=0.2):
    heading, here, side, out = 0.0, np.zeros(2), 0, []
    for i in range(count):
        sign = 1 - 2 * side
        if i > 1:
            heading += turn
            here = here + 0.5 * np.array([np.sin(heading), np.cos(heading)])
        place = here + 0.06 * sign * np.array([np.cos(heading), -np.sin(heading)])
        out.append((side, *place, heading + 0.1 * sign))
        side = 1 - side
    return np.array(out)


def given(table, **more):
    return GivenSteps(table[:, 0].astype(int), table[:, 1:3], table[:, 3], **more)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((4, 1, 3.0), "footstep 5|footstep 6"),
        ((4, 2, -3.0), "ahead, a walk needs|aside"),
        ((3, 3, 2.5), r"turn by .* deg in one step|axis is .* feet need"),
    ],
)
def test_footsteps_that_nobody_can_walk_name_the_step(change, message):
    table = rows()
    row, column, value = change
    table[row, column] = value
    with pytest.raises(InfeasibleError, match=message):
        plan_given(given(table), body=BODY, pace=preferred_pace(BODY), ground=GROUND)


def test_heights_and_times_of_given_footsteps():
    table, times = rows(), np.array([0.0, 0.0, 0.8, 1.5, 2.1, 3.0])
    plan = plan_given(
        given(table, time=times, height=np.full(6, 5e-4)),
        body=BODY,
        pace=preferred_pace(BODY),
        ground=GROUND,
    )
    np.testing.assert_array_equal(plan.time, times)
    with pytest.raises(InvalidInputError, match=r"footstep 2: y is 0\.01 m"):
        plan_given(
            given(table, height=np.array([0, 0.01, 0, 0, 0, 0])),
            body=BODY,
            pace=preferred_pace(BODY),
            ground=GROUND,
        )
    with pytest.raises(InvalidInputError, match="at least 4 rows"):
        given(table[:3])


# files and words --------------------------------------------------------------------------


def test_points_in_words():
    np.testing.assert_array_equal(parse_points("-1,2 3,4"), [[-1, 2], [3, 4]])
    for text in ("", "1,2", "1,2 x", "1,2 3,4,5", "0,0 nan,1"):
        with pytest.raises(InvalidInputError):
            parse_points(text)


def test_points_in_a_file(tmp_path):
    file = tmp_path / "p.csv"
    file.write_text("x,z\n0,0\n# so far\n0,4\n2,7\n")
    np.testing.assert_array_equal(load_points(file), [[0, 0], [0, 4], [2, 7]])


@pytest.mark.parametrize(
    ("text", "line"),
    [("x,z\n0,0\n0,zero\n", 3), ("0,0\n0,0\n1,1\n", 2), ("0,0,1\n", 1), ("a,b\n0,0\n", 1)],
)
def test_a_bad_file_of_points_names_the_line(text, line, tmp_path):
    file = tmp_path / "p.csv"
    file.write_text(text)
    with pytest.raises(FileFormatError) as caught:
        load_points(file)
    assert caught.value.line == line


STEPS = "side,x,z,heading_deg\nL,0.05,0,6\nR,-0.05,0,-6\nL,0.05,0.5,6\nR,-0.05,1.0,-6\n"


def test_footsteps_in_a_file(tmp_path):
    file = tmp_path / "s.csv"
    file.write_text(STEPS + "L,0.05,1.0,6\n")
    steps = load_footsteps(file)
    np.testing.assert_array_equal(steps.side, [0, 1, 0, 1, 0])
    np.testing.assert_allclose(np.degrees(steps.heading), [6, -6, 6, -6, 6])
    motion = walk(steps=file, fps=30)
    np.testing.assert_allclose(motion.labels.footstep_position[:, [0, 2]], steps.place)
    again = regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (STEPS + "R,0,1.5,0\n", 6),
        (STEPS + "X,0,1.5,0\n", 6),
        (STEPS + "L,0,1.5\n", 6),
        (STEPS + "L,0,1.5,north\n", 6),
        ("side,x,z\nL,0,0\n", 1),
        ("side,x,z,heading_deg,time\nL,0,0,0,0\nR,-.1,0,0,0.5\n", 3),
    ],
)
def test_a_bad_file_of_footsteps_names_the_line(text, line, tmp_path):
    file = tmp_path / "s.csv"
    file.write_text(text)
    with pytest.raises(FileFormatError) as caught:
        load_footsteps(file)
    assert (caught.value.line, caught.value.path) == (line, str(file))


def test_one_way_to_say_where():
    for where in ({}, {"distance": 1.0, "path": "0,0 0,1"}, {"path": "0,0 0,1", "steps": []}):
        with pytest.raises(InvalidInputError, match="one of distance, path, steps and do"):
            walk(**where)


@pytest.mark.parametrize("path", ["0,0 0,2 1,3", Path.arc(1.5, 1.0)])
def test_a_recipe_of_a_path_walks_it_again(path):
    motion = walk(path=path, fps=30)
    again = regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)
    assert again.labels.recipe == motion.labels.recipe


# editing ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def plan():
    return plan_on(Path.through([[0, 0], [0, 4], [2, 7], [2, 11]]))


@pytest.mark.parametrize(
    "edit",
    [
        lambda p: editing.move_step(p, 8, (0.04, 0.05)),
        lambda p: editing.rotate_step(p, 8, 0.2),
        lambda p: editing.retime_step(p, 8, 0.75),
        lambda p: editing.insert_steps(p, 8),
        lambda p: editing.delete_steps(p, 8),
    ],
    ids=["move", "rotate", "retime", "insert", "delete"],
)
def test_an_edit_changes_what_it_says_and_no_more(plan, edit):
    done = edit(plan)
    before, after = (joint_positions(walk(steps=p, fps=60)) for p in (plan, done.plan))
    frames = done.frames(60.0)
    assert 0 < frames.start < frames.stop
    np.testing.assert_allclose(after[: frames.start], before[: frames.start], atol=1e-9)
    assert (
        np.abs(after[frames.start : frames.stop][:100] - before[frames.start :][:100]).max() > 0.01
    )
    if done.shift == 0.0:
        np.testing.assert_allclose(after[frames.stop :], before[frames.stop :], atol=1e-6)
    else:
        assert done.plan.time[-1] - plan.time[-1] == pytest.approx(done.shift)


def test_edits_of_points():
    points = [[0, 0], [0, 4], [2, 7]]
    assert editing.move_point(points, 1, (1, 4)).tolist() == [[0, 0], [1, 4], [2, 7]]
    assert editing.insert_point(points, 3, (3, 9))[-1].tolist() == [3, 9]
    assert editing.delete_point(points, 0).tolist() == [[0, 4], [2, 7]]
    with pytest.raises(InvalidInputError):
        editing.delete_point(points, 3)
