"""Steps of unequal length join: at heel strike, at toe-off, from standing and to standing."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from walkers import BODIES, PROTOTYPE, bodies, chain, plan_of, points_of

from gaitsmith.ground import GROUNDS
from gaitsmith.synthesis.step import prepare_walk
from gaitsmith.synthesis.straight import StraightGenerator
from gaitsmith.walks import KinematicWalk, kinematic

#: How far apart two instants are that should show the same, in phase.
GAP = 1e-9
AT_STRIKE, AT_TOE_OFF = 1e-9, 1e-6
lengths = st.lists(st.floats(0.5, 1.1), min_size=3, max_size=6)
FIELDS = ("pitch", "meta", "bend")


@pytest.fixture(scope="module", autouse=True)
def _samples_just_after_every_event():
    """Steps sampled at the usual phases and ``GAP`` after each event, so that jumps show."""
    usual = kinematic.phase_grid
    with pytest.MonkeyPatch.context() as patch:

        def dense(*events):
            after = [e + GAP for e in events if 0.0 < e < 1.0 - GAP]
            return usual(*events, *after)

        patch.setattr(kinematic, "phase_grid", dense)
        yield


def joints(steps):
    """What jumps where steps meet: {name: largest}, meters and radians."""
    found = dict.fromkeys(("center", "ankle", *FIELDS), 0.0)
    for (request, one), (_, two) in pairwise(steps):
        ahead = np.array([request.length, 0.0])
        found["center"] = max(found["center"], np.abs(one.center[-1] - ahead - two.center[0]).max())
        # the swing foot becomes the stance foot and the other way round
        found["ankle"] = max(
            found["ankle"], np.abs(one.ankle[-1, ::-1] - ahead - two.ankle[0]).max()
        )
        for name in FIELDS:
            gap = getattr(one, name)[-1, ::-1] - getattr(two, name)[0]
            found[name] = max(found[name], np.abs(gap).max())
    return found


def jumps_inside(step):
    """Largest difference between two samples ``GAP`` apart, of any curve."""
    close = np.flatnonzero(np.diff(step.phase) < 2 * GAP)
    assert close.size, "no event was sampled twice"
    curves = {"center": step.center, "ankle": step.ankle}
    curves |= {name: getattr(step, name) for name in FIELDS if name != "meta"}
    # the toes leave the floor at toe-off: only what they are against the sole goes on
    curves["meta"] = step.meta[:, 0]
    return max(np.abs(curve[close + 1] - curve[close]).max() for curve in curves.values())


@settings(max_examples=60)
@given(body=bodies(), shares=lengths, stand=st.booleans())
def test_proposed_steps_meet_at_heel_strike(body, shares, stand):
    steps = chain(
        KinematicWalk([PROTOTYPE]), body, [r * body.leg_length for r in shares], stand=stand
    )
    found = joints(steps)
    assert max(found.values()) < AT_STRIKE, found


@settings(max_examples=60)
@given(body=bodies(), shares=lengths, stand=st.booleans())
def test_proposed_steps_do_not_jump_at_any_event(body, shares, stand):
    steps = chain(
        KinematicWalk([PROTOTYPE]), body, [r * body.leg_length for r in shares], stand=stand
    )
    for request, step in steps:
        assert step.toe_off in step.phase
        assert jumps_inside(step) < AT_TOE_OFF, request


@pytest.mark.parametrize("stand", [False, True], ids=["walking", "from stand to stand"])
@pytest.mark.parametrize("name", BODIES)
def test_a_prepared_walk_of_unequal_steps_is_continuous(name, stand):
    """Every point of hips, legs and feet, with the contact stage, at every event."""
    body = BODIES[name]
    shares = [0.7, 0.9, 0.55, 1.05, 0.8, 0.6]
    plan = plan_of(body, [r * body.leg_length for r in shares], stand=stand)
    ground = GROUNDS["flat"]()
    walk = prepare_walk(
        plan, StraightGenerator(KinematicWalk([PROTOTYPE]), ground), body, ground, rest=0.5
    )
    count = len(plan.kinds)
    strikes = np.arange(1.0, count)
    offs = np.arange(count) + walk.contact.toe_off[:count]

    def seen(phases):
        return points_of(body, walk.contact.poses(phases))

    assert np.abs(seen(strikes) - seen(strikes - 1e-12)).max() < AT_STRIKE
    assert np.abs(seen(offs + GAP) - seen(offs)).max() < AT_TOE_OFF
    every = np.linspace(0.0, count, 97 * count)[:-1]
    assert np.abs(seen(every + GAP) - seen(every)).max() < AT_TOE_OFF

    if stand:
        end = walk.clock.starts[-1]
        standing = points_of(body, walk.poses(np.array([end - GAP, end, walk.duration])))
        assert np.abs(np.diff(standing, axis=0)).max() < AT_TOE_OFF


@pytest.mark.parametrize("name", BODIES)
def test_start_and_stop_stand_still(name):
    """The first and the last pose are the standing one, and nothing moves there."""
    body = BODIES[name]
    plan = plan_of(body, [r * body.leg_length for r in (0.7, 0.9, 0.6)], stand=True)
    ground = GROUNDS["flat"]()
    walk = prepare_walk(
        plan, StraightGenerator(KinematicWalk([PROTOTYPE]), ground), body, ground, rest=0.5
    )
    times = np.array([0.0, 1e-4, walk.clock.starts[-1] - 1e-4, walk.clock.starts[-1]])
    points = points_of(body, walk.poses(np.append(times, walk.duration)))
    hips = points[:, 0]
    # keeping legs in reach lowers the hips smoothly, which reaches into standing by about 1 mm
    standing = kinematic.standing_height(body)
    np.testing.assert_allclose(hips[[0, -1], 1], standing, rtol=0, atol=2e-3)
    feet = points[:, [3, 4, 5, 8, 9, 10]]  # heel, ball and toe tip of both
    assert np.abs(feet[[0, -1], :, 1]).max() < 1e-9, "on the floor"
    assert np.abs(points[1] - points[0]).max() / 1e-4 < 1e-2, "m/s at the start"
    assert np.abs(points[3] - points[2]).max() / 1e-4 < 1e-2, "m/s at the stop"
    np.testing.assert_allclose(points[4], points[3], rtol=0, atol=1e-12)


def test_the_height_of_the_hips_is_handed_on():
    """Eq. 14: "the height just before the current step, given by the current posture"."""
    body = BODIES["adult"]
    steps = chain(KinematicWalk([PROTOTYPE]), body, [0.6, 0.75, 0.7])
    request, second = steps[1]
    assert request.hip_height == steps[0][1].center[-1, 1]
    assert second.center[0, 1] == pytest.approx(request.hip_height, abs=1e-12)
    lowered = KinematicWalk([PROTOTYPE]).step(
        body, type(request)(**{**vars(request), "hip_height": request.hip_height - 0.02})
    )
    drop = second.center[:, 1] - lowered.center[:, 1]
    np.testing.assert_allclose(drop, 0.02 * (1.0 - second.phase), rtol=0, atol=2e-4)
