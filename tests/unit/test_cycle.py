"""A Cycle closes, has period 1 and is exact at its samples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from people import person
from scipy.spatial.transform import Rotation

from gaitsmith.body.rig import skeleton_of
from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.cycle import EVENTS, Cycle

SKELETON = skeleton_of(person(1.75))
GOOD_EVENTS = [[0.0, 0.09, 0.33, 0.58], [0.5, 0.59, 0.83, 0.08]]


def wave(count, seed=0):
    """A smooth closed stride: the same rotations whatever the number of samples."""
    rng = np.random.default_rng(seed)
    phase = np.arange(count) / count
    size = rng.uniform(-0.5, 0.5, (len(SKELETON), 3))
    shift = rng.uniform(0.0, 2.0 * np.pi, len(SKELETON))
    angle = np.sin(2.0 * np.pi * phase[:, None] + shift)[..., None] * size
    rotations = Rotation.from_rotvec(angle.reshape(-1, 3)).as_quat()
    center = np.stack(
        [
            0.02 * np.sin(2.0 * np.pi * phase),
            0.9 + 0.02 * np.cos(4.0 * np.pi * phase),
            0.01 * np.sin(4.0 * np.pi * phase),
        ],
        axis=-1,
    )
    return rotations.reshape(count, len(SKELETON), 4), center


def cycle(count=40, **changes):
    rotations, center = wave(count)
    asked = {
        "skeleton": SKELETON,
        "center": center,
        "rotations": rotations,
        "events": GOOD_EVENTS,
        "stride_length": 1.4,
        "duration": 1.1,
    }
    return Cycle(**asked | changes)


def apart(a, b):
    """Angles between rotations, radians."""
    chord = np.minimum(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
    return 4.0 * np.arcsin(np.clip(0.5 * chord, 0.0, 1.0))


@pytest.mark.parametrize("count", [4, 5, 40, 121])
def test_exact_at_its_samples(count):
    stride = cycle(count)
    center, rotations = stride.at(np.arange(count) / count)
    np.testing.assert_allclose(center, stride.center, atol=1e-12)
    assert apart(rotations, stride.rotations).max() < 1e-7


@settings(max_examples=50)
@given(phase=st.floats(-3.0, 3.0), turns=st.integers(-5, 5))
def test_period_one(phase, turns):
    stride = cycle()
    for a, b in zip(
        stride.at(np.array([phase])), stride.at(np.array([phase + turns])), strict=True
    ):
        np.testing.assert_allclose(a, b, atol=1e-9)


@pytest.mark.parametrize("count", [8, 40])
@pytest.mark.parametrize("flipped", [False, True])
def test_it_closes_without_a_jump_or_a_corner(count, flipped):
    """Where one stride meets the next; a sign flip of the quaternions there is no matter."""
    rotations, center = wave(count)
    if flipped:
        rotations = rotations * np.where(np.arange(count) > count // 2, -1.0, 1.0)[:, None, None]
    stride, h = cycle(rotations=rotations, center=center), 1e-6
    around = np.array([-2 * h, -h, h, 2 * h])
    places, turned = stride.at(around)
    assert np.abs(np.diff(places, axis=0)).max() < 1e-5
    assert apart(turned[1:], turned[:-1]).max() < 1e-4
    speed = np.diff(places, axis=0) / h
    np.testing.assert_allclose(speed[0], speed[2], atol=1e-3)
    spin = apart(turned[1:], turned[:-1]) / h
    np.testing.assert_allclose(spin[0], spin[2], atol=2e-2)


def test_between_samples_it_follows_the_motion():
    coarse, fine = cycle(40), wave(400)
    center, rotations = coarse.at(np.arange(400) / 400)
    np.testing.assert_allclose(center, fine[1], atol=1e-4)
    assert apart(rotations, fine[0]).max() < 2e-3


@given(phase=st.floats(0.0, 1.0))
def test_rotations_are_unit(phase):
    _, rotations = cycle().at(np.array([phase]))
    np.testing.assert_allclose(np.linalg.norm(rotations, axis=-1), 1.0, atol=1e-12)


def test_no_phase_nothing():
    center, rotations = cycle().at(np.empty(0))
    assert center.shape == (0, 3)
    assert rotations.shape == (0, len(SKELETON), 4)


def test_speed_and_events():
    stride = cycle()
    assert stride.speed == pytest.approx(1.4 / 1.1)
    assert EVENTS == ("heel_strike", "foot_flat", "heel_off", "toe_off")
    with pytest.raises(ValueError, match="read-only"):
        stride.events[0, 0] = 0.5


def test_with_checks_again():
    stride = cycle()
    assert stride.with_(duration=1.0).speed == pytest.approx(1.4)
    with pytest.raises(InvalidInputError, match="duration must be a positive number of seconds"):
        stride.with_(duration=0.0)


def bad_rotations():
    rotations, _ = wave(40)
    rotations[3, 2] *= 1.01
    return rotations


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"center": np.zeros((3, 3))}, "at least 4 samples, got 3"),
        ({"rotations": np.zeros((40, 3, 4))}, "rotations must have shape"),
        ({"rotations": bad_rotations()}, "must be unit quaternions"),
        ({"center": np.full((40, 3), np.nan)}, "center must be finite"),
        ({"events": [[0.1, 0.2, 0.3, 0.6], GOOD_EVENTS[1]]}, "the first of them 0"),
        ({"events": [[0.0, 0.2, 0.3, 1.2], GOOD_EVENTS[1]]}, r"stride phases in \[0, 1\)"),
        ({"events": [[0.0, 0.2, -0.3, 0.6], GOOD_EVENTS[1]]}, r"stride phases in \[0, 1\)"),
        ({"events": [[0.0, 0.4, 0.3, 0.6], GOOD_EVENTS[1]]}, "must follow each other"),
        ({"events": [GOOD_EVENTS[0], [0.5, 0.7, 0.6, 0.1]]}, "must follow each other"),
        ({"events": np.zeros((2, 3))}, "events must have shape"),
        ({"stride_length": -1.0}, "stride_length must be a positive number of meters"),
        ({"duration": np.nan}, "duration must be a positive number of seconds"),
    ],
)
def test_a_wrong_cycle_cannot_exist(wrong, message):
    with pytest.raises(InvalidInputError, match=message):
        cycle(**wrong)
