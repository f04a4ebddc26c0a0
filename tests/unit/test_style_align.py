"""Key times by event, bounded slots, and the maps between walks."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from styles import synthetic

from gaitsmith.errors import InfeasibleError
from gaitsmith.style.align import Timing, mapped, phases, slots_over, timing_of
from gaitsmith.style.interpolation import periodic_cubic, periodic_linear, periodic_slerp

SEEDS = st.integers(0, 30)


@given(SEEDS)
def test_contacts_are_the_events_unwrapped(seed):
    cycle = synthetic(seed)
    timing = timing_of(cycle)
    assert timing.ordered
    np.testing.assert_allclose(timing.events, cycle.events, atol=1e-12)
    assert (np.diff(timing.contacts, axis=1) > 0.0).all()


@given(SEEDS)
def test_slots_keep_heel_strikes_and_their_bounds(seed):
    timing = timing_of(synthetic(seed))
    slots = timing.slots
    assert slots[0] == 0.0
    assert slots[4] == timing.contacts[1, 0]
    for first, last in ((0, slots[4]), (4, 1.0)):
        _strike, flat, off, heel_off = slots[first : first + 4] - slots[first]
        assert 0.05 - 1e-12 <= off <= 0.15 + 1e-12
        assert 0.3 * off - 1e-12 <= flat <= 0.8 * off + 1e-12
        single = last - slots[first] - off
        assert 0.4 * single - 1e-12 <= heel_off - off <= 0.75 * single + 1e-12


def test_a_walk_on_the_toes_has_ordered_slots():
    """The heel that never lies is off at once; its slot waits for its turn."""
    cycle = synthetic(0).with_(events=[[0.0, 0.03, 0.031, 0.6], [0.5, 0.53, 0.531, 0.1]])
    timing = timing_of(cycle)
    assert timing.ordered
    assert timing.contacts[0, 2] == pytest.approx(0.031)
    assert timing.slots[3] > timing.slots[2]


def test_running_is_refused():
    cycle = synthetic(0).with_(events=[[0.0, 0.05, 0.2, 0.4], [0.5, 0.55, 0.7, 0.9]])
    with pytest.raises(InfeasibleError, match="flight phase"):
        timing_of(cycle)


@given(SEEDS, SEEDS)
def test_maps_run_forward_through_the_slots_and_back(one, other):
    a, b = timing_of(synthetic(one)).slots, timing_of(synthetic(other)).slots
    np.testing.assert_allclose(mapped(a, b, a), b, atol=1e-12)
    phase = np.linspace(0.0, 2.0, 1000)
    there = mapped(a, b, phase)
    slope = np.diff(there) / np.diff(phase)
    assert slope.min() > 1.0 / 8.0
    assert slope.max() < 8.0
    # periodic, and a map of a walk onto itself changes nothing
    np.testing.assert_allclose(mapped(a, b, phase + 1.0), there + 1.0, atol=1e-12)
    assert mapped(a, a, phase) is phase or np.array_equal(mapped(a, a, phase), phase)


def test_maps_are_smooth():
    """C1: the seam and the slots show no corner."""
    a, b = timing_of(synthetic(1)).slots, timing_of(synthetic(2)).slots
    for at in (*a, 1.0):
        left, right = (mapped(a, b, at + np.array([-d, d])) for d in (1e-6, 2e-6))
        rates = [(left[1] - left[0]) / 2e-6, (right[1] - right[0]) / 4e-6]
        ahead = (mapped(a, b, np.array([at + 1e-6, at + 2e-6])) @ [-1.0, 1.0]) / 1e-6
        behind = (mapped(a, b, np.array([at - 2e-6, at - 1e-6])) @ [-1.0, 1.0]) / 1e-6
        assert ahead == pytest.approx(behind, abs=1e-3), rates


def test_unordered_timing_says_so():
    timing = timing_of(synthetic(0))
    contacts = np.array(timing.contacts)
    contacts[0, 3] = contacts[1, 0] - 0.01
    assert not Timing(contacts, timing.slots).ordered


def test_two_strides_have_twice_the_keys():
    slots = timing_of(synthetic(0)).slots
    np.testing.assert_allclose(slots_over(slots, 2), [*slots, *(slots + 1.0)])
    assert len(phases(2)) == 2 * len(phases(1))


def test_the_periodic_cubic_is_scipys():
    knots = np.array([0.0, 0.07, 0.13, 0.4, 0.51, 0.58, 0.66, 0.9])
    values = np.random.default_rng(0).normal(size=8)
    at = np.linspace(-0.3, 1.7, 301)
    oracle = CubicSpline(np.append(knots, 1.0), np.append(values, values[0]), bc_type="periodic")
    np.testing.assert_allclose(periodic_cubic(knots, 1.0, at) @ values, oracle(at), atol=1e-12)
    line = np.interp(at % 1.0, np.append(knots, 1.0), np.append(values, values[0]))
    np.testing.assert_allclose(periodic_linear(knots, 1.0, at) @ values, line, atol=1e-12)


def test_slerp_meets_its_keys():
    cycle = synthetic(3)
    knots = timing_of(cycle).slots
    keys = cycle.at(knots)[1]
    there = periodic_slerp(keys, knots, 1.0, knots + 2.0)
    np.testing.assert_allclose(np.abs((there * keys).sum(-1)), 1.0, atol=1e-12)
