"""Planted strides: feet that bear move nowhere, and the joint angles are those measured."""

from __future__ import annotations

import numpy as np
import pytest
from puppet import BODY, Puppet
from rigs import bare

from gaitsmith.body.sole import roll
from gaitsmith.gait.learn import learn_cycle, standing_feet
from gaitsmith.gait.person import person_of
from gaitsmith.walks import planting_fit
from gaitsmith.walks.planting import plant
from gaitsmith.walks.planting_fit import CURL, SAMPLES, SPLINES, Fit

WAYS = {
    "walk": Puppet(),
    "limp": Puppet(right=0.44, duty=(0.68, 0.58)),
    "flat": Puppet(strike=0.0, push=1.0),
    "toes first": Puppet(strike=-10.0),
    "on the toes": Puppet(strike=-15.0, level=-25.0, push=60.0),
    "hardly overlaps": Puppet(duty=(0.51, 0.51)),
}


@pytest.fixture(scope="module", params=WAYS)
def case(request):
    found = learn_cycle(person_of(bare(WAYS[request.param].clip(5.0))))
    feet = standing_feet(found.cycle)
    width = float(feet.place[0, 0] - feet.place[1, 0])
    return found, plant(found.cycle, found.body, place=feet.place[:, 1], width=width)


def own_phase(planted, side):
    return (np.arange(SAMPLES) / SAMPLES - planted.marks[side, 4]) % 1.0


def bearing(planted, side):
    return own_phase(planted, side) <= planted.marks[side, 3]


def test_a_bearing_foot_touches_one_place(case):
    """Heel, ball or tip is on its spot of the floor, to the last digit."""
    found, planted = case
    stride = planted.stride_length
    for side in (0, 1):
        down = bearing(planted, side)
        pitch, meta = planted.pitch[down, side], planted.meta[down, side]
        late = np.arange(SAMPLES)[down] / SAMPLES < planted.marks[side, 4]
        place = planted.place[side] - stride * late
        pose = roll(found.body.foot, pitch, meta)
        ankle = pose.ankle + place[:, None] * [1.0, 0.0]
        np.testing.assert_allclose(planted.ankle[down, side], ankle, atol=1e-12)


def test_the_sole_rolls_one_way(case):
    """It comes down to level, stays, and rises; between flat and heel off it is level."""
    _, planted = case
    for side in (0, 1):
        flat, heel_off, _, toe_off, _ = planted.marks[side]
        own = own_phase(planted, side)
        order = np.argsort(own)
        own, pitch = own[order], planted.pitch[order, side]
        level = (own >= flat) & (own <= heel_off)
        assert np.ptp(pitch[level]) < 0.05
        late = (own > heel_off) & (own <= toe_off)
        assert pitch[late].max() < 0.02


def test_events_are_in_order(case):
    _, planted = case
    assert (np.diff(planted.marks[:, :4], axis=1) > 0.0).all()
    other = (planted.marks[::-1, 4] - planted.marks[:, 4]) % 1.0
    assert (planted.marks[:, 3] > other + 0.01).all(), "both feet bear after each landing"


def test_toes_neither_curl_nor_pass_the_floor(case):
    _, planted = case
    for side in (0, 1):
        down = bearing(planted, side)
        pitch, meta = planted.pitch[down, side], planted.meta[down, side]
        assert meta.min() >= 0.0
        assert (meta <= np.maximum(-pitch, 0.0) + CURL + 1e-12).all()


def test_knees_are_those_measured(case):
    """Within 4 degrees, of bearing legs."""
    found, planted = case
    phase = np.arange(SAMPLES) / SAMPLES
    _, q = found.cycle.at(phase)
    index = found.cycle.skeleton.index
    for side, name in enumerate(("left", "right")):
        down = bearing(planted, side)
        hip = planted.center[down] + planted.hip[down, side]
        reach = ((planted.ankle[down, side] - hip) ** 2).sum(-1)
        cosine = (reach - BODY.thigh**2 - BODY.shin**2) / (2.0 * BODY.thigh * BODY.shin)
        flexion = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        knee = q[down, index(f"{name}LowerLeg")]
        measured = np.degrees(2.0 * np.arccos(np.clip(np.abs(knee[:, 3]), 0.0, 1.0)))
        assert np.sqrt(((flexion - measured) ** 2).mean()) < 4.0


def test_hips_and_feet_move_on_smoothly(case):
    """No jump from sample to sample, nor over the seam."""
    _, planted = case
    ahead = np.array([planted.stride_length, 0.0])
    center = np.concatenate([planted.center, planted.center[:2] + ahead])
    assert np.abs(np.diff(center, 2, axis=0)).max() < 2e-3
    for side in (0, 1):
        ankle = np.concatenate([planted.ankle[:, side], planted.ankle[:2, side] + ahead])
        assert np.linalg.norm(np.diff(ankle, axis=0), axis=-1).max() < 0.06


def test_the_shortest_double_support_is_kept():
    """Toes of a planted foot leave early, but never before the other foot bears."""
    found = learn_cycle(person_of(bare(Puppet().clip(5.0))))
    events = np.array(found.cycle.events)
    events[0, 3], events[1, 3] = events[1, 0] + 0.02, 0.02
    cycle = found.cycle.with_(events=events)
    feet = standing_feet(cycle)
    planted = plant(cycle, found.body, place=feet.place[:, 1], width=0.1)
    other = (planted.marks[::-1, 4] - planted.marks[:, 4]) % 1.0
    np.testing.assert_allclose(planted.marks[:, 3] - other, 0.02, atol=1e-9)


def test_the_system_is_that_of_the_residuals(monkeypatch):
    """Slope and Gauss-Newton matrix, put together spline by spline, against dense ones."""
    fits = []
    solved = Fit.solved
    monkeypatch.setattr(Fit, "solved", lambda fit: fits.append(fit) or solved(fit))
    found = learn_cycle(person_of(bare(WAYS["limp"].clip(5.0))))
    feet = standing_feet(found.cycle)
    plant(found.cycle, found.body, place=feet.place[:, 1], width=0.1)
    fit = fits[0]
    x = 0.01 * np.random.default_rng(3).normal(size=(6, SPLINES))

    def residuals(x):
        bend = np.eye(SPLINES) - 0.5 * (
            np.roll(np.eye(SPLINES), 1, 0) + np.roll(np.eye(SPLINES), -1, 0)
        )
        per = np.sqrt(SAMPLES / SPLINES)
        sizes, bends = np.array(planting_fit._SIZE)[:, None], np.array(planting_fit._BEND)[:, None]
        return np.concatenate(
            [fit._away(x).ravel(), (per * sizes * x).ravel(), (per * bends * (x @ bend.T)).ravel()]
        )

    here, tiny = residuals(x), 1e-6
    # each angle goes with a spline's value there, and the spline with its 30 numbers
    angles = np.einsum("nrk,ni->nrki", fit._slopes(x), fit.basis).reshape(6 * SAMPLES, -1)
    rest = np.stack([residuals(e.reshape(x.shape)) for e in np.eye(x.size)], axis=-1)
    dense = np.concatenate([angles, rest[6 * SAMPLES :]])
    value, slope, normal = fit._system(x, fit._away(x))
    assert value == pytest.approx(here @ here, rel=1e-12)
    np.testing.assert_allclose(slope, dense.T @ here, atol=1e-9)
    np.testing.assert_allclose(normal, dense.T @ dense, atol=1e-9)
    for k in range(2 * SPLINES):  # of the hips, whose splines nothing bounds
        nudged = x + tiny * np.eye(1, x.size, k).reshape(x.shape)
        np.testing.assert_allclose((residuals(nudged) - here) / tiny, dense[:, k], atol=1e-4)
