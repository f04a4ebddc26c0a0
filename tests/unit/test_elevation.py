"""Elevation angles: what they mean, and that they rebuild the legs they are of."""

from __future__ import annotations

import numpy as np
import pytest
from puppet import BODY, Puppet
from rigs import bare

from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.elevation import SAMPLES, SEGMENTS, ElevationData, elevation_of
from gaitsmith.gait.learn import learn_cycle
from gaitsmith.gait.person import person_of
from gaitsmith.motion.kinematics import forward_kinematics


@pytest.fixture(scope="module")
def cycle():
    return learn_cycle(person_of(bare(Puppet(right=0.46).clip(5.0)))).cycle


@pytest.fixture(scope="module")
def data(cycle):
    return elevation_of(cycle)


def test_sizes_and_names(cycle, data):
    assert SEGMENTS == ("foot", "shank", "thigh", "pelvis")
    assert data.angles.shape == (2, SAMPLES, 4)
    assert data.stride_length == cycle.stride_length
    assert data.duration == cycle.duration
    assert data.leg_length == pytest.approx(BODY.leg_length, abs=1e-6)


def test_a_flat_foot_is_at_90_degrees(data):
    """In mid-stance, which is own phase 0.3."""
    np.testing.assert_allclose(np.degrees(data.angles[:, int(0.3 * SAMPLES), 0]), 90.0, atol=1.5)


def test_legs_are_rebuilt_from_their_angles(cycle, data):
    """[SM01] Eq. 1: hip to ankle is thigh and shank along their angles."""
    for side, name in enumerate(("left", "right")):
        own = np.arange(SAMPLES) / SAMPLES + 0.5 * side
        right = cycle.events[1, 0]
        phase = np.floor(own) + np.interp(own % 1.0, [0.0, 0.5, 1.0], [0.0, right, 1.0])
        positions, _ = forward_kinematics(cycle.skeleton, *cycle.at(phase))
        hip, knee, ankle = (
            positions[:, cycle.skeleton.index(name + part)]
            for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        for segment, a, b in ((2, hip, knee), (1, knee, ankle)):
            bone = b - a
            size = np.hypot(bone[:, 1], bone[:, 2])
            angle = data.angles[side, :, segment]
            np.testing.assert_allclose(size * np.sin(angle), bone[:, 2], atol=1e-9)
            np.testing.assert_allclose(-size * np.cos(angle), bone[:, 1], atol=1e-9)


def test_angles_close(data):
    """From the last sample to the first it is no farther than from any to the next."""
    loop = np.concatenate([data.angles, data.angles[:, :1]], axis=1)
    steps = np.abs(np.diff(loop, axis=1))
    assert (steps[:, -1] <= 1.3 * steps[:, :-1].max(axis=1)).all()


def test_even_walkers_have_even_angles():
    even = learn_cycle(person_of(bare(Puppet().clip(5.0))), symmetric=True).cycle
    left, right = elevation_of(even).angles
    assert np.degrees(np.abs(left - right)).max() < 0.5


def test_nonsense_is_refused(data):
    with pytest.raises(InvalidInputError, match="angles"):
        ElevationData(np.full((2, 8, 4), np.nan), 1.0, 1.0, 0.8)
    with pytest.raises(InvalidInputError, match="leg_length"):
        ElevationData(data.angles, 1.0, 1.0, -1.0)
