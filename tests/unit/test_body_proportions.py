from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.proportions import (
    ADULT_FROM,
    SHORTEST,
    TALLEST,
    body_from_height,
    height_from_leg,
)
from gaitsmith.body.rig import skeleton_of
from gaitsmith.errors import InvalidInputError

heights = st.floats(SHORTEST, TALLEST)


def measures(height: float) -> np.ndarray:
    body = body_from_height(height)
    own = [f.name for f in fields(Body) if f.name not in ("name", "foot", "spine_segments")]
    foot = [getattr(body.foot, f.name) for f in fields(Foot)]
    return np.array([getattr(body, name) for name in own] + foot)


@given(heights)
def test_the_joints_stack_up_to_the_height(height):
    body = body_from_height(height)
    stacked = body.hip_height + body.trunk + body.neck + body.head
    assert body.height == height
    assert stacked == pytest.approx(height, abs=1e-12)


@given(heights)
def test_arms_and_legs_keep_off_each_other(height):
    body = body_from_height(height)
    joints = skeleton_of(body).rest_positions()
    assert body.shoulder_width > body.hip_width
    # hanging down, the finger tips end between the hip and the knee
    tip = body.hip_height + body.trunk - body.shoulder_drop
    tip -= body.upper_arm + body.forearm + body.hand
    assert body.foot.ankle_height + body.shin < tip < body.hip_height
    assert np.isfinite(joints).all()


@given(st.floats(ADULT_FROM, TALLEST))
def test_adults_are_the_printed_shares_of_stature(height):
    body = body_from_height(height)
    share = 1.0 / height
    assert body.hip_height * share == pytest.approx(0.530, abs=1e-12)
    assert (body.foot.ankle_height + body.shin) * share == pytest.approx(0.285, abs=1e-12)
    assert body.foot.ankle_height * share == pytest.approx(0.039, abs=1e-12)
    shoulder = body.hip_height + body.trunk - body.shoulder_drop
    assert shoulder * share == pytest.approx(0.818, abs=1e-12)
    assert body.upper_arm * share == pytest.approx(0.186, abs=1e-12)
    assert body.forearm * share == pytest.approx(0.146, abs=1e-12)
    assert body.hand * share == pytest.approx(0.108, abs=1e-12)
    assert body.foot.length * share == pytest.approx(0.152, abs=1e-12)
    assert body.mass == pytest.approx(22.5 * height**2, rel=1e-12)


def test_children_have_shorter_legs_bigger_heads_longer_feet():
    share = {h: measures(h) / h for h in (0.8, 1.0, 1.15, 1.3, 1.5)}
    names = [f.name for f in fields(Body) if f.name not in ("name", "foot", "spine_segments")]
    column = {name: np.array([s[i] for s in share.values()]) for i, name in enumerate(names)}
    assert (np.diff(column["thigh"]) > 0).all()
    assert (np.diff(column["head"]) < 0).all()
    feet = [body_from_height(h).foot.length / h for h in share]
    assert (np.diff(feet) < 0).all()
    # hip height follows sitting height: .52 of stature in adults, .54 at 1.15 m, .56 at 1 m
    for height, sitting in ((1.0, 0.56), (1.15, 0.545), (1.3, 0.53), (1.5, 0.52)):
        wanted = 0.530 * (1.0 - sitting) / (1.0 - 0.52)
        assert body_from_height(height).hip_height / height == pytest.approx(wanted, abs=0.01)


@pytest.mark.parametrize("height", np.linspace(0.82, 2.28, 74).tolist() + [1.2, 1.5])
def test_no_kinks_in_height(height):
    """C1: the slopes to the left and to the right of every height agree."""
    step = 1e-5
    before, here, after = (measures(height + k * step) for k in (-1, 0, 1))
    slopes = (here - before) / step, (after - here) / step
    # u^1.5 has an infinite second derivative at 1.5 m, hence slopes differ by order sqrt(step)
    assert np.abs(slopes[1] - slopes[0]).max() < 1.5e-2


@given(heights)
def test_height_from_leg_inverts(height):
    leg = body_from_height(height).leg_length
    assert height_from_leg(leg) == pytest.approx(height, abs=1e-9)


@pytest.mark.parametrize("bad", [0.79, 2.31, -1.0, 0.0, float("nan"), float("inf")])
def test_heights_out_of_range_are_refused(bad):
    with pytest.raises(InvalidInputError, match="height must be"):
        body_from_height(bad)


def test_centimeters_get_a_hint():
    with pytest.raises(InvalidInputError, match=r"from 0.8 to 2.3 meters, got 175 .*1\.75\?"):
        body_from_height(175)


@pytest.mark.parametrize("bad", [0.1, 3.0, float("nan")])
def test_legs_that_no_height_has_are_refused(bad):
    with pytest.raises(InvalidInputError, match="must be"):
        height_from_leg(bad)


def test_mass_grows_with_height():
    masses = [body_from_height(h).mass for h in np.linspace(SHORTEST, TALLEST, 200)]
    assert (np.diff(masses) > 0).all()
    assert body_from_height(1.0).mass == pytest.approx(15.5)
    assert body_from_height(1.8, mass=90, name="heavy").mass == 90.0
