"""No jump and, for the hips, no change of speed at heel strike and toe-off (erratum D17)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from people import ENDS, people, person, prepared, straight_plan
from step_generator import legs

from gaitsmith.body.presets import BODIES

#: Seconds between the poses that speeds are taken from.
STEP = 1e-5
#: Meters per second by which the hips' speed may differ over an event: 1 mm/s of up to 2 m/s
#: (0.2 mm/s measured, what 30 microseconds of acceleration give). The paper's walk changes by
#: 150 mm/s and more where unequal steps meet.
HIPS = 1e-3
#: The same for the ankle of the foot that leaves the ground; m/s.
LEAVING_ANKLE = 0.05


def times_of(walk, phase_of):
    """Seconds at which each step reaches a walk phase."""
    out = []
    for i, phase in enumerate(phase_of):
        low, high = walk.clock.starts[i], walk.clock.starts[i + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            if walk.clock.walk_phase(np.array([middle]))[0] < i + phase:
                low = middle
            else:
                high = middle
        out.append(0.5 * (low + high))
    return np.array(out)


def events(walk):
    """Seconds of heel strikes and of toe-offs."""
    steps = len(walk.plan.kinds)
    return walk.clock.starts[1:steps], times_of(walk, walk.contact.toe_off[:steps])


def speeds(walk, body, times):
    """Speeds of hips (n, 3), pelvis (n, 4) and ankles (n, 2, 3) just before and after."""

    def at(shift):
        poses = walk.poses(times + shift)
        return poses.center, poses.pelvis, legs(poses, body)[0]

    before = [(b - a) / STEP for a, b in zip(at(-2 * STEP), at(-STEP), strict=True)]
    after = [(b - a) / STEP for a, b in zip(at(STEP), at(2 * STEP), strict=True)]
    return before, after


@settings(max_examples=25)
@given(
    who=people(),
    ratio=st.floats(0.3, 1.0),
    start=st.sampled_from(ENDS),
    stop=st.sampled_from(ENDS),
)
def test_nothing_jumps_at_heel_strike_and_toe_off(who, ratio, start, stop):
    walk = prepared(who, straight_plan(who, ratio=ratio, cadence=80.0, start=start, stop=stop))
    for times in events(walk):
        before, after = walk.poses(times - 1e-9), walk.poses(times + 1e-9)
        for name in ("center", "pelvis", "thigh", "shin", "foot", "bend", "knee", "upper"):
            gap = np.abs(getattr(before, name) - getattr(after, name)).max()
            assert gap < 1e-6, name
        for a, b in zip(legs(before, who), legs(after, who), strict=True):
            np.testing.assert_allclose(a, b, atol=1e-6)


@settings(max_examples=25)
@given(
    who=people(),
    ratio=st.floats(0.3, 1.0),
    start=st.sampled_from(ENDS),
    stop=st.sampled_from(ENDS),
)
def test_the_hips_keep_their_speed(who, ratio, start, stop):
    walk = prepared(who, straight_plan(who, ratio=ratio, cadence=80.0, start=start, stop=stop))
    for times in events(walk):
        before, after = speeds(walk, who, times)
        np.testing.assert_allclose(before[0], after[0], atol=HIPS)
        np.testing.assert_allclose(before[1], after[1], atol=5e-3)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("ratio", [0.4, 0.9])
def test_the_foot_leaves_with_the_speed_it_had(name, ratio):
    body = person(name)
    walk = prepared(body, straight_plan(body, ratio=ratio, start="walk", stop="walk"))
    _, leaving = events(walk)
    before, after = speeds(walk, body, leaving)
    swing = 1 - walk.contact.stance
    steps = np.arange(len(leaving))
    a, b = before[2][steps, swing], after[2][steps, swing]
    assert np.linalg.norm(a, axis=-1).min() > 0.3, "it is moving"
    np.testing.assert_allclose(a, b, atol=LEAVING_ANKLE)


def test_a_start_and_a_stop_are_eased():
    """From rest, to rest: no part of the body moves yet, or any more."""
    body = person(1.75)
    walk = prepared(body, straight_plan(body), rest=0.3)
    end = walk.clock.starts[-1]
    for instants in (np.array([0.0, 1e-4]), np.array([end - 1e-4, end]), end + np.array([0, 0.2])):
        poses = walk.poses(instants)
        ankles, _ = legs(poses, body)
        assert np.abs(np.diff(poses.center, axis=0)).max() < 1e-6
        assert np.abs(np.diff(ankles, axis=0)).max() < 1e-6
        assert np.abs(np.diff(poses.upper, axis=0)).max() < 1e-6
