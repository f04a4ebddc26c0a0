"""[SM01] section 5.1 and spec section 6: the datasets, their mixes, and the steps they take."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.body.presets import body_from
from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.walks.elevation import (
    FOOT,
    PELVIS,
    SAMPLES,
    SHANK,
    THIGH,
    ElevationSet,
    mixed,
    pelvis_height,
    set_from_cycle,
)
from gaitsmith.walks.elevation_sets import REACH, built_in_sets
from gaitsmith.walks.round_heel import RoundHeel, turned
from gaitsmith.walks.step_of import PlanarFigure, printed_step_of, step_of

BODY = subject()
FIGURE = PlanarFigure.of(BODY)
SETS = {s.name: s for s in built_in_sets()}
EVERY = pytest.mark.parametrize("name", SETS)


def ends(dataset):
    return dataset.angles[SAMPLES // 2], dataset.angles[0]


def test_the_five_of_the_paper_and_what_of_them_is_constructed():
    assert list(SETS) == ["normal", "short", "long", "uphill", "downhill"]
    assert not SETS["normal"].constructed
    for name in ("short", "long", "uphill", "downhill"):
        assert "normal set" in SETS[name].constructed
    assert all("Rajagopal 2016" in s.source for s in SETS.values())


@pytest.mark.parametrize(
    ("name", "length"), [("normal", 0.71925), ("short", 0.46475), ("long", 0.88725)]
)
def test_level_sets_take_level_steps(name, length):
    found = step_of(FIGURE, *ends(SETS[name]))
    assert found[0] == pytest.approx(length, abs=2e-4)
    assert abs(found[1]) < 1e-4


@pytest.mark.parametrize(("name", "share", "deg"), [("uphill", 0.92, 11), ("downhill", 0.88, -11)])
def test_slope_sets_step_along_their_slope(name, share, deg):
    found = step_of(FIGURE, *ends(SETS[name]), SETS[name].slope)
    assert found[0] == pytest.approx(share * 0.71925, abs=2e-4)
    assert found[1] == pytest.approx(found[0] * np.tan(np.radians(deg)), abs=2e-4)
    assert SETS[name].slope == pytest.approx(np.radians(deg))


def test_the_paper_is_wrong_eq_10_is_no_step_length():
    """From the stance toe to the swing ankle: a third too short, and up on level ground.

    And a slope of -11 deg comes out as -5 cm instead of -12.
    """
    literal = printed_step_of(FIGURE, *ends(SETS["normal"]))
    assert literal == pytest.approx([0.469, 0.026], abs=2e-3)
    assert printed_step_of(FIGURE, *ends(SETS["downhill"]))[1] == pytest.approx(-0.050, abs=3e-3)


@EVERY
def test_foot_shank_and_thigh_covary_in_a_plane(name):
    assert SETS[name].planarity() > 0.98
    # that of people's normal gait is about (.28, -.80, .53) in (thigh, shank, foot)
    tilt = SETS[name].plane_normal() @ np.array([0.28, -0.80, 0.53])
    assert tilt > np.cos(np.radians(20.0))


def test_the_raw_stride_covaries_too():
    raw = set_from_cycle(neutral_cycle(), "neutral")
    assert raw.planarity() > 0.98
    planted = SETS["normal"].angles
    off = np.degrees(np.sqrt(((raw.angles - planted) ** 2).mean(axis=0)))
    # what planting the feet moved, and the pelvis not at all
    assert (off < [6.0, 5.0, 5.0, 0.01]).all()


@EVERY
def test_the_leg_is_a_persons(name):
    angles = np.degrees(SETS[name].angles)
    knee = angles[:, THIGH] - angles[:, SHANK]
    assert knee.min() > 5.0
    assert 50.0 < knee.max() < 80.0
    early = knee[: SAMPLES // 4]
    strike = {"uphill": (20, 35), "downhill": (8, 20)}.get(name, (4, 16))
    assert strike[0] < knee[0] < strike[1]
    if name == "downhill":
        assert 30.0 < early.max() < 50.0
    flat = 90.0 + np.degrees(SETS[name].slope)
    lies = np.abs(angles[:, FOOT] - flat) < 1e-9
    assert 0.1 < lies.mean() < 0.3
    assert (np.diff(angles[: SAMPLES // 2, FOOT]) <= 1e-12).all()


@EVERY
def test_curves_close_are_smooth_and_do_not_ripple_on_the_flat_foot(name):
    dataset = SETS[name]
    grid = np.arange(SAMPLES) / SAMPLES
    assert np.abs(dataset.at(grid) - dataset.angles).max() < 1e-12
    assert np.abs(dataset.at(grid + 3.0) - dataset.angles).max() < 1e-9
    step = 1e-7
    before, after = dataset.at(grid - step), dataset.at(grid + step)
    slopes = (dataset.angles - before) / step, (after - dataset.angles) / step
    assert np.abs(slopes[0] - slopes[1]).max() < 1e-3
    lies = np.flatnonzero(np.abs(dataset.angles[:, FOOT] - 0.5 * np.pi - dataset.slope) < 1e-12)
    fine = dataset.at(np.linspace(lies[1], lies[-2], 500) / SAMPLES)[:, FOOT]
    assert np.ptp(fine) < 1e-12


@EVERY
def test_stance_ankles_reach_hips_that_go_one_step_each_half_stride(name):
    """Thigh and shank from the rolling foot put the hips where the other leg has them."""
    dataset = SETS[name]
    half = SAMPLES // 2
    rho = dataset.slope
    pitch = dataset.angles[:, FOOT] - 0.5 * np.pi - rho
    t = np.arange(half + 1)
    foot = turned(FIGURE.sole.stand(pitch[t]), np.full(len(t), rho))

    def leg(rows):
        shank, thigh = dataset.angles[rows % SAMPLES, SHANK], dataset.angles[rows % SAMPLES, THIGH]
        down = [np.stack([np.sin(a), -np.cos(a)], axis=-1) for a in (shank, thigh)]
        return FIGURE.shin * down[0] + FIGURE.thigh * down[1]

    hip = foot - leg(t)
    tangent = FIGURE.pelvis * np.tan(dataset.angles[:, PELVIS])
    across = tangent[(t + half) % SAMPLES] - tangent[t]
    swing = hip + np.stack([across, np.zeros(half + 1)], axis=-1) + leg(t + half)
    # lands where its own stance starts, one step on
    step = step_of(FIGURE, *ends(dataset), rho)
    assert swing[-1] - step == pytest.approx(foot[0], abs=1e-9)
    # and left where the stance ended
    assert swing[0] + step == pytest.approx(foot[-1], abs=1e-9)
    reach = np.hypot(*leg(np.arange(SAMPLES)).T) / BODY.leg_length
    assert reach.max() <= REACH + 1e-9


def test_a_mix_is_affine():
    sets = list(SETS.values())
    weights = np.array([0.5, 0.2, -0.1, 0.3, 0.1])
    whole = mixed(sets, weights)
    wanted = sum(w * s.angles for w, s in zip(weights, sets, strict=True))
    np.testing.assert_allclose(whole.angles, wanted, atol=1e-14)
    assert whole.slope == pytest.approx(np.radians(11.0) * 0.2)
    assert whole.constructed == "mixed"
    assert np.array_equal(mixed(sets, np.eye(5)[2]).angles, sets[2].angles)
    with pytest.raises(InvalidInputError, match=r"weights must sum to 1, got 0\.5"):
        mixed(sets, np.array([0.5, 0, 0, 0, 0]))
    with pytest.raises(InvalidInputError, match="one body's hips"):
        mixed([sets[0], sets[1].for_body(body_from(1.2))], np.array([0.5, 0.5]))


def test_pelvis_angles_are_of_one_bodys_hips():
    """[SM01] takes them for any body's: the same angle on narrow hips is a larger rotation."""
    body = body_from(1.75)
    normal = SETS["normal"]
    same = normal.for_body(body)
    assert np.array_equal(same.angles[:, :PELVIS], normal.angles[:, :PELVIS])
    half = SAMPLES // 2

    def turn(dataset, who):
        tangent = np.tan(dataset.angles[:, PELVIS])
        ahead = 0.5 * pelvis_height(who) * (tangent - np.roll(tangent, half))
        return np.arcsin(ahead / (0.5 * who.hip_width))

    off = np.abs(np.sin(turn(same, body)) - np.sin(turn(normal, BODY))).max()
    assert off < 1e-12
    narrow = body_from(1.75)
    narrow = type(narrow)(**{**vars(narrow), "hip_width": 0.6 * narrow.hip_width})
    literal = np.degrees(np.abs(turn(normal, narrow)).max())
    assert literal > 1.5 * np.degrees(np.abs(turn(normal, BODY)).max())


def test_a_foot_rolls_over_its_round_heel_without_slipping_or_sinking():
    sole = RoundHeel.of(BODY.foot)
    pitch = np.linspace(0.6, 0.0, 4001)
    ankle = sole.stand(pitch)
    arms = sole.corners - sole.ankle
    corners = ankle[:, None] + turned(arms[None], pitch[:, None])
    assert corners[..., 1].min() > -1e-12
    assert np.abs(corners[..., 1].min(axis=1)).max() < 1e-12
    # the corner that bears stays where it is laid down
    which = sole.lowest(pitch)
    bears = corners[np.arange(len(pitch)), which]
    np.testing.assert_allclose(bears[:, 0], sole.laid[which], atol=1e-12)
    assert ankle[-1] == pytest.approx([0.0, BODY.foot.ankle_height], abs=1e-12)
    assert np.abs(np.diff(ankle, axis=0)).max() < 2e-4
    heel_up = sole.stand(np.array([-1e-9]))
    assert heel_up[0] == pytest.approx(ankle[-1], abs=1e-8)


def test_data_that_are_none():
    with pytest.raises(InvalidInputError, match="8 or more samples, an even number, got 9"):
        ElevationSet(np.zeros((9, 4)), 1.0, 0.0, 0.5, 0.9)
    with pytest.raises(InvalidInputError, match="angles must be finite"):
        ElevationSet(np.full((10, 4), np.nan), 1.0, 0.0, 0.5, 0.9)
