"""Several measured steps of one person: exact at each, blended and continuous between."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from walkers import BODIES, PROTOTYPE, chain

from gaitsmith.errors import InvalidInputError
from gaitsmith.walks import WALKS, KinematicWalk, StraightWalk
from gaitsmith.walks.blend import blend
from gaitsmith.walks.data import TimedSequence, WalkData
from gaitsmith.walks.generalize import (
    ankle_at_heel_strike,
    ankle_at_toe_off,
    generalize,
    hip_height,
    mu,
)
from gaitsmith.walks.kinematic import densified, phase_grid

EXACT = {"rtol": 0, "atol": 1e-12}


def another_step() -> WalkData:
    """A shorter step of the same person, made up: other angles, other events, other kappa."""
    events = {"flat": 0.20, "heel_off": 0.62, "meta_off": 1.02, "toe_off": 0.20}
    marks = {
        "hip": (0.0, 1.0),
        "foot1": (0.0, events["flat"]),
        "foot2": (events["flat"], 1.0 + events["toe_off"]),
        "foot3": (events["toe_off"], 1.0),
        "meta": (events["meta_off"], 1.0 + events["toe_off"]),
        "ankle": (events["toe_off"], 1.0),
    }
    moved = {
        name: TimedSequence(first + (last - first) * s.unit, s.values)
        for (name, s), (first, last) in zip(
            PROTOTYPE.sequences.items(), marks.values(), strict=True
        )
    }
    # in F2 the heel leaves at its own share of the interval
    f2 = PROTOTYPE.foot2
    at = np.interp(
        f2.times,
        [PROTOTYPE.flat, PROTOTYPE.heel_off, 1.0 + PROTOTYPE.toe_off],
        [events["flat"], events["heel_off"], 1.0 + events["toe_off"]],
    )
    moved["foot2"] = TimedSequence(at, f2.values)
    character = replace(
        PROTOTYPE.character,
        ratio=0.70,
        knee=2.95,
        strike_pitch=0.35,
        off_pitch=0.92,
        off_meta=0.66,
        kappa=0.48,
        gains=(0.1, 0.3, 0.4, 0.3),
    )
    walk = PROTOTYPE.with_(character=character, **events, **moved)
    length = 0.70 * walk.body.leg_length
    return generalize(walk, walk.body, length, length)


LONG, SHORT = PROTOTYPE, another_step()
BOTH = KinematicWalk([LONG, SHORT])


def equal(one: WalkData, two: WalkData, atol: float = 1e-12) -> None:
    for name in ("flat", "heel_off", "meta_off", "toe_off"):
        assert getattr(one, name) == pytest.approx(getattr(two, name), abs=atol), name
    for name, sequence in one.sequences.items():
        other = two.sequences[name]
        np.testing.assert_allclose(
            sequence.values, other.at(sequence.times), rtol=0, atol=atol, err_msg=name
        )


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("measured", [LONG, SHORT], ids=["long", "short"])
def test_at_a_measured_ratio_the_walk_is_that_measured_step(name, measured):
    body = BODIES[name]
    length = measured.character.ratio * body.leg_length
    expected = generalize(densified(measured), body, length, length)
    equal(BOTH.walk_data(body, length, length), expected)
    for alone in (measured, densified(measured)):
        single = KinematicWalk([alone]).walk_data(body, length, length)
        equal(BOTH.walk_data(body, length, length), single)


def test_the_order_of_the_measured_steps_does_not_matter():
    body, other = BODIES["child"], KinematicWalk([SHORT, LONG])
    length = 0.8 * body.leg_length
    assert [w.character.ratio for w, _ in BOTH.prototypes] == sorted(
        w.character.ratio for w in (LONG, SHORT)
    )
    equal(BOTH.walk_data(body, length, length), other.walk_data(body, length, length))


@settings(max_examples=50)
@given(name=st.sampled_from(list(BODIES)), before=st.floats(0.5, 1.1), now=st.floats(0.5, 1.1))
def test_between_measured_steps_the_ends_are_those_of_the_blended_angles(name, before, now):
    body = BODIES[name]
    sb, sl = before * body.leg_length, now * body.leg_length

    def blended(ratio: float):
        """Angles and kappa by hand: linear in the ratio between the two, each by its gains."""
        low, high = SHORT.character, LONG.character
        share = np.clip((ratio - low.ratio) / (high.ratio - low.ratio), 0.0, 1.0)
        ends = [np.array([*mu(c, body, ratio * body.leg_length), c.kappa]) for c in (low, high)]
        return (1.0 - share) * ends[0] + share * ends[1]

    walk = BOTH.walk_data(body, sb, sl)
    _, strike_before, off_before, meta_before, kappa_before = blended(before)
    knee, strike, off, meta, kappa = blended(now)
    assert walk.foot1.values[0, 0] == pytest.approx(strike_before, abs=1e-12)
    assert walk.foot2.values[-1, 0] == pytest.approx(-off, abs=1e-12)
    assert walk.meta.values[-1, 0] == pytest.approx(meta, abs=1e-12)
    assert walk.foot3.values[0, 0] == pytest.approx(-off_before, abs=1e-12)
    assert walk.foot3.values[-1, 0] == pytest.approx(strike, abs=1e-12)
    np.testing.assert_allclose(
        walk.ankle.values[[0, -1]],
        [
            ankle_at_toe_off(body.foot, sb, off_before, meta_before),
            ankle_at_heel_strike(body.foot, sl, strike),
        ],
        **EXACT,
    )
    ends = [-kappa_before * sb, (1.0 - kappa) * sl]
    np.testing.assert_allclose(walk.hip.values[[0, -1], 0], ends, **EXACT)
    square = ((walk.hip.values[-1] - walk.ankle.values[-1]) ** 2).sum()
    cosine = (body.thigh**2 + body.shin**2 - square) / (2.0 * body.thigh * body.shin)
    assert cosine == pytest.approx(np.cos(knee), abs=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_the_walk_is_continuous_in_the_step_length(name):
    """Also across the measured ratios, where the pair that is blended changes."""
    body, tiny = BODIES[name], 1e-7
    marks = [SHORT.character.ratio, LONG.character.ratio, 0.62, 0.83, 1.02]
    at = np.linspace(0.0, 1.0, 101)
    for ratio in marks:
        one, two = (
            BOTH.walk_data(body, r * body.leg_length, r * body.leg_length)
            for r in (ratio - tiny, ratio + tiny)
        )
        for name_, sequence in one.sequences.items():
            other = two.sequences[name_]
            first = sequence.at(sequence.times[0] + np.ptp(sequence.times) * at)
            second = other.at(other.times[0] + np.ptp(other.times) * at)
            # the phase grid may gain a sample: then what is read between samples moves a little
            atol = 1e-4 if name_ in ("hip", "ankle") else 1e-3
            np.testing.assert_allclose(first, second, rtol=0, atol=atol, err_msg=name_)


@settings(max_examples=40)
@given(
    name=st.sampled_from(list(BODIES)),
    shares=st.lists(st.floats(0.55, 1.1), min_size=3, max_size=6),
    stand=st.booleans(),
)
def test_unequal_steps_between_measured_ones_join(name, shares, stand):
    """The step before is blended otherwise; what it ends with is where this one begins."""
    body = BODIES[name]
    steps = chain(BOTH, body, [r * body.leg_length for r in shares], stand=stand)
    for (request, one), (_, two) in pairwise(steps):
        ahead = [request.length, 0.0]
        np.testing.assert_allclose(one.center[-1] - ahead, two.center[0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(one.ankle[-1, ::-1] - ahead, two.ankle[0], rtol=0, atol=1e-9)
        for field in ("pitch", "meta", "bend"):
            np.testing.assert_allclose(
                getattr(one, field)[-1, ::-1], getattr(two, field)[0], rtol=0, atol=1e-9
            )
    for request, step in steps:
        # the rear foot leaves where its roll ends and the swing begins
        off = int(np.flatnonzero(step.phase == step.toe_off)[0])
        if request.kind == "walk":
            walk = BOTH.walk_data(body, request.previous_length, request.length, request.hip_height)
            np.testing.assert_allclose(step.ankle[off, 1], walk.ankle.values[0], rtol=0, atol=1e-9)
            assert step.pitch[off, 1] == pytest.approx(walk.foot3.values[0, 0], abs=1e-9)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_a_blend_with_all_of_one_is_that_one(share):
    body = BODIES["adult"]
    length = 0.8 * body.leg_length
    first, second = (generalize(w, body, length, length) for w in (SHORT, LONG))
    mixed = blend(first, second, share)
    expected = (first, second)[int(share)]
    equal(expected, mixed)
    assert hip_height(mixed.character, body, length) == pytest.approx(
        hip_height(expected.character, body, length), abs=1e-12
    )


@pytest.mark.parametrize("share", [0.0, 0.25, 0.5, 1.0])
def test_events_are_blended_not_smeared(share):
    body = BODIES["adult"]
    length = 0.8 * body.leg_length
    mixed = blend(*(generalize(w, body, length, length) for w in (SHORT, LONG)), share)
    for name in ("flat", "heel_off", "meta_off", "toe_off"):
        expected = (1.0 - share) * getattr(SHORT, name) + share * getattr(LONG, name)
        assert getattr(mixed, name) == pytest.approx(expected, abs=1e-12)
    assert mixed.foot1.values[-1, 0] == 0.0
    before = mixed.foot2.times <= mixed.heel_off + 1e-12
    np.testing.assert_allclose(mixed.foot2.values[before], 0.0, **EXACT)


def test_a_walk_needs_a_measured_step():
    with pytest.raises(InvalidInputError, match="at least one measured step"):
        KinematicWalk([])


def test_the_built_in_walks_are_straight_walks():
    assert set(WALKS) >= {"winter"}
    for make in WALKS.values():
        assert isinstance(make(), StraightWalk)


def test_the_grid_holds_its_events_and_is_nowhere_coarse():
    grid = phase_grid(0.18, 0.66, 0.98, 0.16)
    assert {0.0, 0.16, 0.18, 0.66, 0.98, 1.0} <= set(grid.tolist())
    assert np.diff(grid).max() <= 1.0 / 36.0 + 1e-12
    assert (np.diff(grid) > 0.0).all()


def test_reading_the_measured_step_on_the_grid_keeps_it():
    """Same ends and events, and within half a millimeter or a quarter of a degree between."""
    dense = densified(LONG)
    for name, sequence in LONG.sequences.items():
        values = dense.sequences[name].at(sequence.times)
        tolerance = 5e-4 if name in ("hip", "ankle") else 5e-3
        np.testing.assert_allclose(values, sequence.values, rtol=0, atol=tolerance, err_msg=name)
        np.testing.assert_array_equal(
            dense.sequences[name].values[[0, -1]], sequence.values[[0, -1]]
        )
