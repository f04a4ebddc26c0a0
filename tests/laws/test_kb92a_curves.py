"""[KB92a]: any straight walk along any footsteps, and the straight walk where they are straight."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from compass_walk import CompassWalk
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from judge import broken, posed
from people import GROUND, person, the_walk
from printed_kb92a import printed_ends
from walkers import plan_of

from gaitsmith.body.masses import center_of_mass, segments_of
from gaitsmith.conventions import GRAVITY
from gaitsmith.errors import InfeasibleError, InvalidInputError
from gaitsmith.pipeline import walk
from gaitsmith.plan.course import lean_lever
from gaitsmith.plan.follow import follow
from gaitsmith.plan.footsteps import StepPlan
from gaitsmith.plan.given import GivenSteps, plan_given
from gaitsmith.plan.lengths import Stance
from gaitsmith.plan.pace import choose_pace, preferred_pace
from gaitsmith.plan.paths import Path
from gaitsmith.synthesis.curved import CurvedGenerator
from gaitsmith.synthesis.gaits import GAITS as BUILT_IN
from gaitsmith.synthesis.sample import sample_walk
from gaitsmith.synthesis.step import WalkerState, prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks.model import SagittalStep

FIELDS = ("center", "heading", "pelvis", "thigh", "shin", "foot", "bend", "knee", "upper")
ADULT = person(1.75)


class StiffWalk(CompassWalk):
    """Stiff legs whose pelvis bobs: another walk that only the seam knows."""

    def step(self, body, request):
        step = super().step(body, request)
        center = np.array(step.center)
        center[:, 1] -= 0.01 * np.sin(np.pi * step.phase) ** 2 * body.leg_length
        return SagittalStep(**{**vars(step), "center": center})


#: Styles by rule are asked in test_styles.py.
GAITS = {name: BUILT_IN[name] for name in ("neutral", "winter")}
WALKS = {"kinematic": the_walk, "compass": CompassWalk, "stiff": StiffWalk}


def difference(one, other, phases):
    a, b = one.contact.poses(phases), other.contact.poses(phases)
    return max(np.abs(getattr(a, f) - getattr(b, f)).max() for f in FIELDS)


def plan_along(path, body=ADULT, *, outside=True, start="stand", stop="stand", **changes):
    stance = Stance(max(0.057 * body.height, 0.066), 0.1)
    return follow(
        path,
        pace=changes.pop("pace", preferred_pace(body)),
        stance=stance,
        ground=GROUND,
        body=body if outside else None,
        start=start,
        stop=stop,
    )


def walked(plan, body=ADULT, gait="winter", fps=120.0, **options):
    style = GAITS[gait](None)
    generator = CurvedGenerator(style.walk, GROUND, style.overlay, **options)
    return sample_walk(
        prepare_walk(plan, generator, body, GROUND, rest=0.2), body, GROUND, fps=fps, recipe={}
    )


def moved(plan, turn, shift):
    """The plan turned by ``turn`` about the origin and shifted by ``shift`` (x, z)."""
    c, s = np.cos(turn), np.sin(turn)

    def go(points):
        x, z = points[..., 0], points[..., -1]
        return c * x + s * z + shift[0], c * z - s * x + shift[1]

    x, z = go(plan.position)
    return replace(
        plan,
        position=np.stack([x, plan.position[:, 1], z], axis=-1),
        heading=plan.heading + turn,
        direction=plan.direction + turn,
        middle=np.stack(go(plan.middle), axis=-1),
        path=None,
    )


# straight = the straight walk -------------------------------------------------------------------


@pytest.mark.parametrize("name", WALKS)
@pytest.mark.parametrize("mode", ["track", "anchored"])
@pytest.mark.parametrize("stand", [True, False])
@pytest.mark.parametrize(("turn", "shift"), [(0.0, (0.0, 0.0)), (1.234, (3.0, -7.0))])
def test_on_a_straight_path_it_is_the_straight_walk(name, mode, stand, turn, shift):
    """Unequal steps, any heading and place; [KB92a] sections 4 and 5, last paragraphs."""
    bodies = (ADULT,) if turn else (person("child"), person("kb92b-figure"))
    for body in bodies:
        lengths = np.array([0.5, 0.8, 0.6, 0.7]) * body.leg_length
        plan = moved(plan_of(body, lengths, stand=stand), turn, shift)
        one = prepare_walk(plan, StraightGenerator(WALKS[name](), GROUND), body, GROUND)
        generator = CurvedGenerator(WALKS[name](), GROUND, mode=mode, exact=True)
        other = prepare_walk(plan, generator, body, GROUND)
        assert difference(one, other, np.linspace(0.0, len(plan.kinds), 400)) < 1e-9


def test_a_distance_is_a_path_and_more_points_on_the_line_change_nothing():
    for gait in GAITS:
        one = walk(distance=4.0, gait=gait)
        for path in ("0,0 0,4", "0,0 0,0.3 0,1.7 0,4", [[0, 0], [0, 4]]):
            other = walk(path=path, gait=gait)
            np.testing.assert_allclose(other.rotations, one.rotations, atol=1e-9)
            np.testing.assert_allclose(other.root_position, one.root_position, atol=1e-9)


def test_a_hardly_bent_path_is_walked_like_a_straight_one():
    straight, bent = (walked(plan_along(p)) for p in (Path.line(4.0), Path.arc(4e5, 1e-5)))
    np.testing.assert_allclose(bent.root_position, straight.root_position, atol=2e-3)


# symmetry ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius", [5.0, 1.2, 0.6])
def test_moving_the_footsteps_moves_the_walk(radius):
    plan = plan_along(Path.arc(radius, 2.5))
    turn, shift = 0.7, np.array([3.0, -2.0])
    one, other = (walked(p) for p in (plan, moved(plan, turn, shift)))
    c, s = np.cos(turn), np.sin(turn)
    x, z = one.root_position[:, 0], one.root_position[:, 2]
    expected = np.stack(
        [c * x + s * z + shift[0], one.root_position[:, 1], c * z - s * x + shift[1]]
    )
    np.testing.assert_allclose(other.root_position, expected.T, atol=1e-9)
    np.testing.assert_allclose(other.rotations[:, 1:], one.rotations[:, 1:], atol=1e-9)


@pytest.mark.parametrize("radius", [5.0, 1.2, 0.6])
def test_mirrored_footsteps_make_the_mirrored_walk(radius):
    plan = plan_along(Path.arc(radius, 2.5))
    flip = np.array([-1.0, 1.0, 1.0])
    mirrored = StepPlan(
        side=1 - plan.side,
        position=plan.position * flip,
        heading=-plan.heading,
        direction=-plan.direction,
        time=plan.time,
        kinds=plan.kinds,
        middle=plan.middle * [-1.0, 1.0],
        lean=-plan.lean,
        gaze=-plan.gaze,
    )
    one, other = (walked(p) for p in (plan, mirrored))
    np.testing.assert_allclose(other.root_position, one.root_position * flip, atol=1e-9)
    index = one.skeleton.index
    for name in one.skeleton.names:
        swapped = name.replace("left", "R").replace("right", "left").replace("R", "right")
        q, m = one.rotations[:, index(name)], other.rotations[:, index(swapped)]
        expected = q * [1.0, -1.0, -1.0, 1.0]
        near = np.minimum(np.abs(m - expected).max(-1), np.abs(m + expected).max(-1))
        assert near.max() < 1e-9, name


# circles ----------------------------------------------------------------------------------------


def test_two_hundred_steps_on_a_circle_do_not_drift():
    motion = walked(plan_along(Path.arc(2.0, 200 * 0.63 / 2.0)), fps=30.0)
    off = np.hypot(motion.root_position[:, 0] - 2.0, motion.root_position[:, 2]) - 2.0
    times, fps = motion.labels.footstep_time, motion.fps
    assert len(times) > 180
    stride = round(2.0 * fps * float(np.median(np.diff(times[1:]))))
    mean = np.convolve(off, np.ones(stride) / stride, mode="valid")[2 * stride : -2 * stride]
    assert np.abs(mean).max() < 0.01


@pytest.mark.parametrize("radius", [5.0, 2.0, 1.2, 0.6])
def test_on_a_circle_the_heading_only_rises(radius):
    plan = plan_along(Path.arc(radius, 5.0))
    generator = CurvedGenerator(the_walk(), GROUND)
    prepared = prepare_walk(plan, generator, ADULT, GROUND)
    heading = prepared.contact.poses(np.linspace(0.0, len(plan.kinds), 2000)).heading
    assert np.diff(heading).min() > -1e-9  # to the very stop


@pytest.mark.parametrize("gait", GAITS)
@pytest.mark.parametrize("radius", [5.0, 2.0, 1.2])
@pytest.mark.parametrize("height", [1.3, 1.75])
def test_the_body_leans_as_the_curve_asks(radius, gait, height):
    """Line from the middle of the feet to the center of mass, over a stride: Eq. 4 to 10 %."""
    body = person(height)
    plan = plan_along(Path.arc(radius, max(12.0 / radius, 4.0)), body, start="walk", stop="walk")
    motion = walked(plan, body, gait)
    positions, _, _ = posed(motion)
    mass = center_of_mass(motion.skeleton, positions, segments_of(body))
    a, b = round(plan.time[6] * 120), round(plan.time[10] * 120)
    center = np.array([radius, 0.0])
    out = np.hypot(*(mass[a:b, [0, 2]] - center).T).mean()
    feet = np.hypot(*(plan.position[6:10, [0, 2]] - center).T).mean()
    speed = np.hypot(*np.diff(mass[a:b, [0, 2]], axis=0).T).mean() * 120
    lean = np.arctan((feet - out) / mass[a:b, 1].mean())
    assert lean == pytest.approx(np.arctan(speed**2 / (GRAVITY * out)), rel=0.1)


def test_nobody_leans_on_a_straight_path():
    plan = plan_along(Path.line(5.0))
    assert not plan.lean.any()
    assert not plan.gaze.any()


def test_the_trunk_leans_instead_where_the_paper_is_asked():
    path = Path.arc(2.0, 5.0)
    trunk = walked(plan_along(path, outside=False), banking="trunk")
    upright = walked(plan_along(path, outside=False), banking="none")
    positions = {k: posed(m)[0] for k, m in (("trunk", trunk), ("none", upright))}
    shifts = {}
    for name, p in positions.items():
        mass = center_of_mass(trunk.skeleton, p, segments_of(ADULT))
        shifts[name] = np.hypot(mass[200:-200, 0] - 2.0, mass[200:-200, 2]).mean()
    assert 0.04 < shifts["none"] - shifts["trunk"] < 0.10


def test_the_lever_of_a_lean_is_more_than_the_height_of_the_center_of_mass():
    assert 0.55 * ADULT.height < lean_lever(ADULT) < 0.7 * ADULT.height


def test_the_head_turns_first():
    motion = walked(plan_along(Path.rounded([[0, 0], [0, 3], [3, 3]])), gait="neutral")
    _, world, _ = posed(motion)

    def half_time(joint):
        facing = world[motion.skeleton.index(joint)].apply([0.0, 0.0, 1.0])
        return np.flatnonzero(np.arctan2(facing[:, 0], facing[:, 2]) > np.pi / 4)[0] / motion.fps

    assert 0.1 < half_time("hips") - half_time("head") < 0.6


# every promise ----------------------------------------------------------------------------------

PATHS = {
    **{f"circle {r:+g}": Path.arc(abs(r), 5.0 * np.sign(r)) for r in (0.6, -0.6, 0.8, -1.2, 2, -5)},
    "s": Path.of_turns([(1.2, 1.5), (1.2, -1.5), (1.0, 0.0)]),
    "eight": Path.figure_eight(6.0),
    "corner": Path.rounded([[0, 0], [0, 2], [-2, 2]], radius=0.6),
    "spiral": Path.of_turns([(0.5, 0.5 / r) for r in np.linspace(3.0, 0.6, 12)]),
    "hairpin": Path.of_turns([(2.0, 0.0), (0.6 * np.pi, np.pi), (2.0, 0.0)]),
}


@pytest.mark.parametrize("gait", GAITS)
@pytest.mark.parametrize("name", PATHS)
def test_every_promise_is_kept_on_curves(name, gait):
    motion = walked(plan_along(PATHS[name]), gait=gait)
    assert broken(motion) == {}


@st.composite
def given_footsteps(draw):
    """Lengths to 0.8 leg, widths 0.06-0.25 m, turns to 35 deg; feet may stand apart at first."""
    body = person(draw(st.floats(1.2, 2.1).map(lambda h: round(h, 2))))
    count, side = draw(st.integers(3, 8)), draw(st.integers(0, 1))
    toe, heading, here = draw(st.floats(0.0, 0.15)), draw(st.floats(-3.0, 3.0)), np.zeros(2)
    rows = []
    apart = draw(st.sampled_from([0.0, 0.3, -0.3]))
    for i in range(count + 2):
        turn = np.radians(draw(st.floats(-35.0, 35.0))) if i > 1 else 0.0
        length = (draw(st.floats(0.2, 0.8)) if i > 1 else apart) * body.leg_length
        width = draw(st.floats(0.06, 0.25))
        middle, sign = heading + 0.5 * turn, 1 - 2 * side
        if i:
            here = here + length * np.array([np.sin(middle), np.cos(middle)])
            here = here + width * sign * np.array([np.cos(middle), -np.sin(middle)])
        heading += turn
        rows.append((side, *here, heading + sign * toe))
        side = 1 - side
    if draw(st.booleans()):
        rows[:2] = rows[1::-1]  # the feet that stand may be given in any order
    table = np.array(rows)
    return body, GivenSteps(table[:, 0].astype(int), table[:, 1:3], table[:, 3])


@settings(max_examples=8)
@given(asked=given_footsteps())
def test_given_footsteps_are_hit_exactly(asked):
    body, steps = asked
    try:
        plan = plan_given(steps, body=body, pace=preferred_pace(body), ground=GROUND)
    except InfeasibleError as error:
        if "its axis is" not in str(error):  # only feet that would touch may be refused
            raise
        reject()
    np.testing.assert_array_equal(np.sort(plan.position[:, 0]), np.sort(steps.place[:, 0]))
    np.testing.assert_array_equal(plan.position[2:, [0, 2]], steps.place[2:])
    assert broken(walked(plan, body)) == {}


@pytest.mark.parametrize("first", [0, 1])
def test_either_foot_steps_first_in_whatever_order_the_feet_stand(first):
    pace = preferred_pace(ADULT)
    motions = []
    for order in ([0, 1], [1, 0]):
        side = np.array([*order, first, 1 - first, first])
        place = np.array([[0.1 * (1 - 2 * s), max(0.0, 0.5 * i - 0.5)] for i, s in enumerate(side)])
        place[-1, 1] = place[-2, 1]
        steps = GivenSteps(side, place, np.zeros(5))
        motions.append(walked(plan_given(steps, body=ADULT, pace=pace, ground=GROUND)))
    np.testing.assert_array_equal(motions[0].rotations, motions[1].rotations)


def test_a_single_step_from_standing_to_standing_is_refused():
    with pytest.raises(InvalidInputError, match="a single step from standing to standing"):
        GivenSteps(np.array([0, 1, 0]), np.array([[0.1, 0], [-0.1, 0], [0.1, 0.5]]), np.zeros(3))


@pytest.mark.parametrize("gait", GAITS)
@pytest.mark.parametrize("radius", [0.6, 2.0])
def test_nothing_jumps_at_heel_strike_and_toe_off_on_curves(radius, gait):
    plan, style = plan_along(Path.arc(radius, 5.0)), GAITS[gait](None)
    prepared = prepare_walk(plan, CurvedGenerator(style.walk, GROUND, style.overlay), ADULT, GROUND)
    contact, count = prepared.contact, len(plan.kinds)
    leaving = (np.arange(contact.steps) + contact.toe_off)[contact.toe_off < 1.0]
    events = np.concatenate([np.arange(1.0, count), leaving])
    before, after = contact.poses(events - 1e-9), contact.poses(events + 1e-9)
    for field in ("center", "pelvis", "thigh", "shin", "foot", "bend", "knee", "upper"):
        assert np.abs(getattr(before, field) - getattr(after, field)).max() < 1e-6, field


# errata -----------------------------------------------------------------------------------------


def test_d9_the_swing_hip_gives_another_height_on_a_straight_path():
    """Eq. 5 with the swing hip: legs hang 2 lambda apart, so the hips come out 20 mm lower."""
    half, leg = 0.5 * ADULT.hip_width, 0.95 * ADULT.leg_length
    swing = np.sqrt(leg**2 - (2.0 * half) ** 2)  # stance ankle to the other hip, feet under hips
    assert 0.008 < leg - swing < 0.03


def test_d10_eq_3_drifts_on_a_circle_and_never_forgets_an_offset():
    ends = printed_ends(2.0, 0.35, 14, kappa=0.446, toe_off=0.16)
    assert ends[-1] < ends[0] - 0.03
    straight = printed_ends(0.7, 0.0, 14, kappa=0.446, toe_off=0.16, offset=0.001)
    np.testing.assert_allclose((straight + 0.446) * 0.7, -0.001, atol=1e-5)


def test_d10_with_the_2d_toe_off_it_is_unstable():
    ends = printed_ends(0.7, 0.0, 6, kappa=0.446, toe_off=0.2, offset=1e-5, ratio=True)
    errors = np.abs((ends + 0.446) * 0.7)
    growth = errors[1:] / errors[:-1]
    assert (growth > 3.5).all()


def test_d11_the_hips_are_not_always_lower_than_in_the_2d_step():
    plan = plan_along(Path.arc(1.2, 4.0))
    generator = CurvedGenerator(the_walk(), GROUND, exact=True)
    prepared = generator.prepare_all(ADULT, prepare_state(), plan.steps())
    straight = the_walk()
    higher = -np.inf
    for step, done in list(zip(plan.steps(), prepared, strict=True))[2:-2]:
        asked = generator_request(step, prepared)
        mine = straight.step(ADULT, asked)
        higher = max(higher, (done.reference.curves.center[:, 1] - mine.center[:, 1]).max())
    assert higher > 0.001


def prepare_state():
    from gaitsmith.synthesis.step import WalkerState

    return WalkerState()


def generator_request(step, _):
    from gaitsmith.synthesis.bent import Bent
    from gaitsmith.synthesis.curved import _requests
    from gaitsmith.synthesis.step import WalkerState

    return _requests(ADULT, WalkerState(), [step], Bent.of([step]).length, 1)[0]


def heading_of(mode, radius):
    plan = plan_along(Path.arc(radius, 4.0))
    generator = CurvedGenerator(the_walk(), GROUND, mode=mode, exact=True)
    prepared = prepare_walk(plan, generator, ADULT, GROUND)
    return prepared.contact.poses(np.linspace(2.0, len(plan.kinds) - 3.0, 1500)).heading


def test_d12_the_paper_s_pelvis_turns_back_every_step():
    assert np.diff(heading_of("track", 1.2)).min() > -1e-6
    anchored = heading_of("anchored", 1.2)
    back = np.degrees(np.max(np.maximum.accumulate(anchored) - anchored))
    assert back > 1.0


def test_d13_eq_11_leaves_a_rest_at_heel_strike():
    """exp(-G) of the roll is left; ours is 0 there: the foot lands as its foothold has it."""
    gain = 5.0
    assert np.exp(-gain) == pytest.approx(0.0067, abs=1e-4)
    rescaled = (np.exp(-gain * np.array([0.0, 1.0])) - np.exp(-gain)) / (1.0 - np.exp(-gain))
    np.testing.assert_allclose(rescaled, [1.0, 0.0], atol=1e-15)


def test_d14_the_leg_is_rolled_at_heel_strike_where_the_hips_follow_the_curve():
    """The paper: theta7x becomes 0 by itself. Pelvis and foot face 5 deg apart there."""
    plan = plan_along(Path.arc(1.2, 4.0))
    prepared = prepare_walk(plan, CurvedGenerator(the_walk(), GROUND), ADULT, GROUND)
    landings = np.arange(4.0, len(plan.kinds) - 3.0)
    heading = prepared.contact.poses(landings).heading
    ahead_of = plan.direction[(landings + 1).astype(int)] - heading
    assert np.degrees(np.abs(ahead_of)).min() > 3.0


@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_steps_begin_where_the_step_before_ends_also_beside_one_that_no_table_holds(gait):
    """The long step is asked of the walk itself, its neighbors are read between others."""
    lengths = np.array([0.7, 0.7, 1.13, 0.72, 0.7, 0.7]) * ADULT.leg_length
    plan = plan_of(ADULT, lengths, stand=False)
    direction = plan.direction + 0.02 * np.arange(len(plan.side))
    plan = replace(plan, direction=direction, heading=plan.heading + 0.02, middle=None, gaze=None)
    style = GAITS[gait](None)
    generator = CurvedGenerator(style.walk, GROUND, style.overlay)
    steps = generator.prepare_all(ADULT, WalkerState(), plan.steps())
    for one, other in pairwise(s.reference for s in steps):
        np.testing.assert_allclose(
            one.curves.center[-1] + one.origin, other.curves.center[0] + other.origin, atol=1e-7
        )
        for name in ("heading", "pelvis", "upper"):
            end, begin = getattr(one.curves, name)[-1], getattr(other.curves, name)[0]
            np.testing.assert_allclose(end, begin, atol=1e-7)


@pytest.mark.parametrize("turn", [-1.0, 1.0])
@pytest.mark.parametrize("stop", ["stand", "walk"])
def test_fast_curves_one_way_and_the_other_do_not_tangle_the_legs(turn, stop):
    """Feet are set outside of each curve; between them hardly farther across than apart."""
    arc, angle = np.pi / 4.0, turn * np.pi / 4.0
    body = person(2.0)
    pace = choose_pace(body, step_length=0.95 * body.leg_length, speed=2.2)
    for start in np.linspace(1.0, 2.2, 7):
        path = Path.of_turns([(start, 0.0), (arc, angle), (arc, -angle), (arc, angle), (1.0, 0.0)])
        plan = plan_along(path, body, stop=stop, pace=pace)
        way = 0.5 * (plan.direction[1:] + plan.direction[:-1])
        gap = np.diff(plan.position, axis=0)
        across = gap[:, 0] * np.cos(way) - gap[:, 2] * np.sin(way)
        assert (across * (1 - 2 * plan.side[1:]))[2:-1].min() > -0.12
