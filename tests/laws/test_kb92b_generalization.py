"""[KB92b] sections 2-5: the map itself, its values, and the theorems about composing it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import literal
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from walkers import BODIES, PROTOTYPE, assert_walks_equal, bodies, ratios, walks

from gaitsmith.body.body import Foot
from gaitsmith.body.presets import KB92B_FIGURE, KB92B_SUBJECT
from gaitsmith.walks.generalize import (
    ankle_at_heel_strike,
    ankle_at_toe_off,
    change_body,
    generalize,
    hip_height,
    mu,
    scale_step_length,
)

if TYPE_CHECKING:
    from gaitsmith.walks.data import WalkData

#: Ratios of steps of one body that stay within those for which the laws are asserted.
rho = st.floats(0.87, 1.15)
scales = st.floats(0.6, 1.6)


def phi(walk: WalkData, ratio: float, height: float | None = None) -> WalkData:
    """The paper's phi: this step ``ratio`` times as long, the one before as it was.

    ``height``: at which the hips are as the step begins, "given by the current posture".
    """
    return generalize(
        walk, walk.body, walk.previous_length, ratio * walk.length, start_height=height
    )


def stepping(walk: WalkData, body, before: float, now: float) -> WalkData:
    """``walk`` of ``body``, lengths as shares of its leg."""
    return generalize(walk, body, before * body.leg_length, now * body.leg_length)


# --- what the map gives: numbers, the paper written out, the lemmas -----------------------


@given(walk=walks(), body=bodies(), before=ratios, now=ratios, up=st.floats(-0.05, 0.05))
def test_the_map_is_the_paper_written_out(walk, body, before, now, up):
    """Eqs. 5-35, 120-128 sample by sample, with complex numbers; see support/literal.py."""
    sb, sl = before * body.leg_length, now * body.leg_length
    for y1 in (None, hip_height(walk.character, body, sb) + up):
        ours = generalize(walk, body, sb, sl, start_height=y1)
        for name, values in literal.tau(walk, body, sb, sl, y1).items():
            np.testing.assert_allclose(
                ours.sequences[name].values, values, rtol=0, atol=1e-12, err_msg=name
            )


@given(walk=walks(), body=bodies(), ratio=ratios)
def test_the_angles_of_the_measured_step_are_the_measured_angles(walk, body, ratio):
    """mu_i(S*, sl*) = mu_i*, and their slopes are the gains: pins what (124) leaves open."""
    c = walk.character
    measured = (c.knee, c.strike_pitch, c.off_pitch, c.off_meta)
    at_measured = mu(c, body, c.ratio * body.leg_length)
    np.testing.assert_allclose(at_measured, measured, rtol=0, atol=1e-12)

    signs = np.array([-1.0, 1.0, 1.0, 1.0])
    expected = np.array(measured) + signs * c.gains * np.array(ratio - c.ratio)
    expected[0] = min(expected[0], np.pi)
    np.testing.assert_allclose(mu(c, body, ratio * body.leg_length), expected, rtol=0, atol=1e-12)


@given(walk=walks(), body=bodies(), ratio=ratios, scale=scales)
def test_angles_know_only_the_step_length_over_the_leg_length(walk, body, ratio, scale):
    """[KB92b] Eq. 124: mu_i(alpha S, alpha sl) = mu_i(S, sl)."""
    sl = ratio * body.leg_length
    np.testing.assert_allclose(
        mu(walk.character, body.scaled(scale), scale * sl),
        mu(walk.character, body, sl),
        rtol=0,
        atol=1e-12,
    )


@pytest.mark.parametrize("name", BODIES)
def test_lemma_1_of_a_flat_foot_is_its_ankle(name):
    foot = BODIES[name].foot
    flat = [0.0, foot.ankle_height]
    np.testing.assert_allclose(ankle_at_toe_off(foot, 0.0, 0.0, 0.0), flat, rtol=0, atol=1e-15)
    np.testing.assert_allclose(ankle_at_heel_strike(foot, 0.0, 0.0), flat, rtol=0, atol=1e-15)


def test_numbers_worked_by_hand():
    """The figure of section 6: aN .1304, hN .0345, bN .1174, bt .072, thigh + shin .7525."""
    foot = KB92B_FIGURE.foot
    # tip at -.6 + .1894; ball .072 behind it at 45 deg; ankle from the ball turned by 60 deg
    np.testing.assert_allclose(
        ankle_at_toe_off(foot, 0.6, np.radians(60.0), np.radians(45.0)),
        [-0.4106 - 0.0509117 - 0.0587 + 0.1129297, 0.0509117 + 0.0652 + 0.1016714],
        atol=1e-7,
    )
    # heel at .7 - .0345; (.0345, .1304) turned by 30 deg about it
    np.testing.assert_allclose(
        ankle_at_heel_strike(foot, 0.7, np.radians(30.0)),
        [0.6655 + 0.0298779 - 0.0652, 0.01725 + 0.1129297],
        atol=1e-7,
    )
    # a straight leg of .7525 from there, the hips at .35: sqrt(.56625625 - .2801779²)
    straight = replace(
        PROTOTYPE.character,
        knee=np.pi,
        strike_pitch=np.radians(30.0),
        kappa=0.5,
        gains=(0.0, 0.0, 0.0, 0.0),
    )
    assert hip_height(straight, KB92B_FIGURE, 0.7) == pytest.approx(0.1301797 + 0.6983963, abs=1e-6)


@given(walk=walks(), body=bodies(), before=ratios, now=ratios)
def test_lemma_1_holds_at_both_ends_of_the_swing(walk, body, before, now):
    """[KB92b] Eqs. 32-35, theta_b and the previous step put in (erratum D5)."""
    data, f = stepping(walk, body, before, now), body.foot
    _, _, q, m = mu(walk.character, body, data.previous_length)
    _, p, _, _ = mu(walk.character, body, data.length)
    b1 = [
        -data.previous_length
        + f.ball
        + f.toes
        - f.toes * np.cos(m)
        - f.ankle_ball * np.cos(f.ball_angle + q),
        f.toes * np.sin(m) + f.ankle_ball * np.sin(f.ball_angle + q),
    ]
    b2 = [
        data.length - f.ankle_heel * (np.cos(f.heel_angle) - np.cos(f.heel_angle + p)),
        f.ankle_heel * np.sin(f.heel_angle + p),
    ]
    np.testing.assert_allclose(data.ankle.values[0], b1, rtol=0, atol=1e-12)
    np.testing.assert_allclose(data.ankle.values[-1], b2, rtol=0, atol=1e-12)


@given(walk=walks(), body=bodies(), before=ratios, now=ratios)
def test_every_sequence_ends_where_the_neighbors_take_over(walk, body, before, now):
    data, c = stepping(walk, body, before, now), walk.character
    _, strike_before, off_before, _ = mu(c, body, data.previous_length)
    _, strike, off, meta = mu(c, body, data.length)
    ends = {
        "foot1": (strike_before, 0.0),
        "foot2": (0.0, -off),
        "foot3": (-off_before, strike),
        "meta": (0.0, meta),
    }
    for name, expected in ends.items():
        values = data.sequences[name].values[[0, -1], 0]
        np.testing.assert_allclose(values, expected, rtol=0, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(
        data.hip.values[[0, -1]],
        [
            [-c.kappa * data.previous_length, hip_height(c, body, data.previous_length)],
            [(1.0 - c.kappa) * data.length, hip_height(c, body, data.length)],
        ],
        rtol=0,
        atol=1e-12,
    )


@given(walk=walks(), body=bodies(), ratio=ratios)
def test_the_knee_at_heel_strike_has_the_angle_asked_for(walk, body, ratio):
    """[KB92b] Eqs. 5, 7: the cosine law read backwards from hip and ankle."""
    data = stepping(walk, body, ratio, ratio)
    for hip, ankle in (
        (data.hip.values[-1], data.ankle.values[-1]),
        (data.hip.values[0], data.ankle.values[-1] - [data.length, 0.0]),
    ):
        square = ((hip - ankle) ** 2).sum()
        cosine = (body.thigh**2 + body.shin**2 - square) / (2.0 * body.thigh * body.shin)
        wanted = np.cos(mu(walk.character, body, data.length)[0])
        assert cosine == pytest.approx(wanted, abs=1e-12)


def test_a_longer_step_lands_with_a_more_bent_knee_and_a_steeper_foot():
    """What the paper takes from Inman, in the right direction (Eq. 5 is the INTERIOR angle)."""
    body = KB92B_SUBJECT
    short, long = (mu(PROTOTYPE.character, body, r * body.leg_length) for r in (0.6, 1.0))
    assert short[0] > long[0]
    assert all(a < b for a, b in zip(short[1:], long[1:], strict=True))


# --- theorems -------------------------------------------------------------------------------


@given(walk=walks(), body=bodies(), before=ratios, now=ratios, first=rho, second=rho)
def test_theorem_1_two_ratios_in_turn_are_their_product(walk, body, before, now, first, second):
    """[KB92b] Theorem 1, corollary 1, the previous step and its posture given."""
    data = stepping(walk, body, before, now)
    height = float(data.hip.values[0, 1])
    direct = phi(data, first * second, height)
    assert_walks_equal(phi(phi(data, first, height), second, height), direct)
    assert_walks_equal(phi(phi(data, second, height), first, height), direct)
    assert direct.length == pytest.approx(first * second * data.length, abs=1e-12)  # lemma 2


@given(walk=walks(), body=bodies(), before=ratios, now=ratios, first=rho, second=rho)
def test_theorem_1_holds_for_both_steps_scaled(walk, body, before, now, first, second):
    data = stepping(walk, body, before, now)
    direct = scale_step_length(data, first * second)
    assert_walks_equal(scale_step_length(scale_step_length(data, first), second), direct)
    assert_walks_equal(scale_step_length(scale_step_length(data, second), first), direct)


@given(walk=walks(), body=bodies(), ratio=ratios, a=rho, b=rho, c=rho)
def test_corollary_2_phi_is_associative(walk, body, ratio, a, b, c):
    """(phi_a phi_b) phi_c and phi_a (phi_b phi_c), each pair replaced by its product."""
    data = stepping(walk, body, ratio, ratio)
    left = phi(phi(data, c), a * b)
    right = phi(phi(data, b * c), a)
    assert_walks_equal(left, right)


@given(walk=walks(), body=bodies(), before=ratios, now=ratios, ratio=rho)
def test_phi_there_and_back_is_the_identity(walk, body, before, now, ratio):
    """Not in the paper; theorem 1 with r2 = 1/r1 forces it."""
    data = stepping(walk, body, before, now)
    assert_walks_equal(phi(phi(data, ratio), 1.0 / ratio), data)
    assert_walks_equal(scale_step_length(scale_step_length(data, ratio), 1.0 / ratio), data)


@given(walk=walks(), one=bodies(), two=bodies(), three=bodies(), ratio=ratios)
def test_theorem_3_psi_through_another_body_is_psi(walk, one, two, three, ratio):
    data = stepping(walk, one, ratio, ratio)
    direct = change_body(data, three)
    assert_walks_equal(change_body(change_body(data, two), three), direct)
    assert_walks_equal(change_body(change_body(data, two), one), data)  # round trip
    assert direct.length == pytest.approx(ratio * three.leg_length, abs=1e-12)  # lemma 3


@given(walk=walks(), body=bodies(), before=ratios, now=ratios, scale=scales)
def test_a_body_scaled_walks_with_lengths_scaled_and_angles_kept(walk, body, before, now, scale):
    """[KB92b] section 4: the similarity assumption."""
    data = stepping(walk, body, before, now)
    other = change_body(data, body.scaled(scale))
    for name in ("foot1", "foot2", "foot3", "meta"):
        np.testing.assert_allclose(
            other.sequences[name].values, data.sequences[name].values, rtol=0, atol=1e-12
        )
    for name in ("hip", "ankle"):
        np.testing.assert_allclose(
            other.sequences[name].values, scale * data.sequences[name].values, rtol=0, atol=1e-12
        )


@given(walk=walks(), one=bodies(), two=bodies(), before=ratios, now=ratios, ratio=rho)
def test_theorem_4_phi_and_psi_commute_for_bodies_of_any_proportions(
    walk, one, two, before, now, ratio
):
    """False as printed, because of Eqs. 123 and 170 (erratum D8)."""
    data = stepping(walk, one, before, now)
    assert_walks_equal(phi(change_body(data, two), ratio), change_body(phi(data, ratio), two))
    assert_walks_equal(
        scale_step_length(change_body(data, two), ratio),
        change_body(scale_step_length(data, ratio), two),
    )


def tau(walk: WalkData, body, length: float, *, psi_first: bool) -> WalkData:
    """To (S2, sl2): Eqs. 150-151 or 152-153, phi by (S1/S2)(sl2/sl1) either way."""
    ratio = walk.body.leg_length / body.leg_length * length / walk.length
    if psi_first:
        return phi(change_body(walk, body), ratio)
    return change_body(phi(walk, ratio), body)


@given(
    walk=walks(),
    one=bodies(),
    two=bodies(),
    three=bodies(),
    steps=st.tuples(ratios, ratios, ratios),
    orders=st.tuples(st.booleans(), st.booleans(), st.booleans()),
)
def test_theorem_5_to_another_walk_condition_by_way_of_a_third(
    walk, one, two, three, steps, orders
):
    """tau_23 tau_12 = tau_13, whichever of phi and psi comes first in each."""
    data = stepping(walk, one, steps[0], steps[0])
    by_way = tau(data, two, steps[1] * two.leg_length, psi_first=orders[0])
    arrived = tau(by_way, three, steps[2] * three.leg_length, psi_first=orders[1])
    direct = tau(data, three, steps[2] * three.leg_length, psi_first=orders[2])
    assert_walks_equal(arrived, direct)
    assert direct.length == pytest.approx(steps[2] * three.leg_length, abs=1e-12)


@given(walk=walks(), one=bodies(), two=bodies(), s=st.tuples(ratios, ratios, ratios, ratios))
def test_generalizing_a_generalized_walk_loses_nothing(walk, one, two, s):
    """Definition 4 for the one map that stands for all three, any lengths before and now."""
    direct = stepping(walk, two, s[2], s[3])
    assert_walks_equal(stepping(stepping(walk, one, s[0], s[1]), two, s[2], s[3]), direct)


def test_a_raised_toe_joint_changes_nothing_of_the_laws():
    """Bodies may bend their toes about an axis above the sole; the paper's do not."""
    foot = Foot(ankle_height=0.07, heel=0.06, ball=0.12, toes=0.07, toe_joint_height=0.02)
    round_toed = replace(KB92B_SUBJECT, foot=foot)
    one = stepping(PROTOTYPE, round_toed, 0.7, 0.9)
    assert_walks_equal(change_body(change_body(one, KB92B_FIGURE), round_toed), one)
    assert_walks_equal(
        phi(change_body(one, KB92B_FIGURE), 1.2), change_body(phi(one, 1.2), KB92B_FIGURE)
    )
