"""[KN12] Table 1, read literally, beside events that are known: what it finds, what it does not."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from styles import rule_library

from gaitsmith.errors import InvalidInputError
from gaitsmith.gait.events import FootPath, stances
from gaitsmith.gait.table_events import table_events
from gaitsmith.motion.kinematics import forward_kinematics, sole_positions

RATE, STRIDES = 120.0, 5
#: Frames of a clip at 30 per second: what counts as found.
NEAR = 0.067
SIGMAS, TOLERANCES = (0.01, 0.02, 0.04, 0.06), (0.02, 0.05, 0.1, 0.2, 0.3)


@cache
def walks():
    """Of ten built-in styles: ankle, toe and sole points of both feet, and when things happen."""
    out = []
    for cycle in rule_library().cycles:
        count = round(STRIDES * cycle.duration * RATE)
        phase = np.arange(count) / (RATE * cycle.duration)
        center, turned = cycle.at(phase)
        center = center + phase[:, None] * [0.0, 0.0, cycle.stride_length]
        places, world = forward_kinematics(cycle.skeleton, center, turned)
        soles = sole_positions(cycle.skeleton, places, world)
        index = cycle.skeleton.index
        for side, name in enumerate(("left", "right")):
            strike = cycle.events[side, 0]
            own = strike + (cycle.events[side] - strike) % 1.0
            whole = np.arange(1, STRIDES - 2)
            true = (own + whole[:, None]) * cycle.duration
            # from the middle of a swing to that of the next
            swing = 0.5 * (own[3] - 1.0 + strike)
            begin = (swing + whole) * cycle.duration
            spans = [(float(b), float(b + cycle.duration)) for b in begin]
            ankle, toe = (places[:, index(f"{name}{part}")] for part in ("Foot", "Toes"))
            out.append((ankle, toe, soles[:, side], spans, true, cycle))
    return out


def scores(**setting):
    """F1 of each event over all strides: one is looked for in each, so it is the share found."""
    found = [
        np.abs(table_events(ankle, toe, RATE, spans, **setting) - true) <= NEAR
        for ankle, toe, _, spans, true, _ in walks()
    ]
    return np.concatenate(found).mean(axis=0)


@cache
def sweep():
    return np.array(
        [
            scores(sigma=sigma, tolerance=tolerance, reading=reading)
            for reading in ("vertical", "magnitude")
            for sigma in SIGMAS
            for tolerance in TOLERANCES
        ]
    )


def test_no_setting_finds_all_four_events():
    """Whatever the setting, one of them is hardly ever found; heel off alone is found by most."""
    assert sweep().shape == (40, 4)
    assert sweep().min(axis=1).max() < 0.2
    assert (np.median(sweep(), axis=0)[[0, 1, 3]] < 0.2).all()


def test_it_finds_what_it_describes():
    """Each event by itself is found by some setting in part of the strides."""
    assert (sweep().max(axis=0) > 0.3).all()


def test_ours_finds_all_of_them():
    for cycle in rule_library().cycles:
        feet = {
            side: FootPath(one[0], *(one[2][:, point] for point in range(3)))
            for side, one in enumerate(w for w in walks() if w[5] is cycle)
        }
        leg = rule_library().body.leg_length
        found = stances(feet, RATE, speed=cycle.speed, leg_length=leg)
        for side in (0, 1):
            strike = cycle.events[side, 0]
            true = (cycle.events[side] - strike) % 1.0 * cycle.duration
            own = [np.array(s.times) for s in found if s.side == side and not s.cut]
            assert len(own) >= STRIDES - 2
            away = np.array([t - strike * cycle.duration for t in own]) - true
            away -= np.round(away[:, :1] / cycle.duration) * cycle.duration
            assert (np.abs(away[:, [0, 3]]) <= NEAR).all(), away


def test_a_parabola_has_its_acceleration():
    """What falls with 2 m/s^2 is above zero all the time, what moves evenly is zero."""
    t = np.arange(240) / RATE
    rising = np.stack([t, t**2, t], axis=1)
    even = np.stack([t, 0.1 * t, t], axis=1)
    both = table_events(rising, rising, RATE, [(0.5, 1.5)])
    assert np.isnan(both[0, :3]).all()
    assert both[0, 3] == pytest.approx(0.5)  # both above zero, the toe lowest
    neither = table_events(even, even, RATE, [(0.5, 1.5)], tolerance=2.0)
    assert neither[0, 1] == pytest.approx(0.5)
    with pytest.raises(InvalidInputError, match="reading must be one of"):
        table_events(even, even, RATE, [], reading="signed")
