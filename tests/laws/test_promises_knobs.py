"""Every knob does what it says, measured back from the motion."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judge import posed, seen_footsteps
from people import ENDS, errands, heights, people, person

from gaitsmith.body.presets import BODIES
from gaitsmith.pipeline import walk


def gaps(motion):
    """Distance of each footstep beyond the one before along +Z, where both are seen flat."""
    positions, _, soles = posed(motion)
    seen = [None if s is None else s[0].mean(0) for s in seen_footsteps(motion, positions, soles)]
    return [np.nan if a is None or b is None else b[2] - a[2] for a, b in pairwise(seen[1:])]


def steady(errand, steps):
    """Which of the steps neither start nor stop nor fit the end."""
    first = 1 if errand.start == "stand" else 0
    last = steps - 4 if errand.stop == "stand" else steps
    return slice(first, max(last, first))


@settings(max_examples=40)
@given(errand=errands(shortest=3.0))
def test_step_length(errand):
    """Exactly as asked, but for those that start, stop or fit the end: they are shorter."""
    found = np.array(gaps(walk(**errand.arguments)))
    full = found[steady(errand, len(found))]
    full = full[np.isfinite(full)]
    assert full == pytest.approx(errand.step_length, abs=1e-6)
    rest = found[np.isfinite(found)]
    assert rest.max() < errand.step_length + 1e-6
    assert rest.min() > -1e-6
    if errand.stop == "stand":
        assert found[-1] == pytest.approx(0.0, abs=1e-6)  # it closes beside the other


@settings(max_examples=40)
@given(errand=errands())
def test_cadence(errand):
    """Every step that neither starts nor stops takes 60 / cadence; the others no less."""
    motion = walk(**errand.arguments)
    took = np.diff(motion.labels.footstep_time[1:])
    plain = np.ones(len(took), dtype=bool)
    plain[0] = errand.start != "stand"
    plain[-1] &= errand.stop != "stand"
    assert took[plain] == pytest.approx(60.0 / errand.cadence, abs=1e-9)
    assert (took >= 60.0 / errand.cadence - 1e-9).all()


@settings(max_examples=30)
@given(who=people(), froude=st.floats(0.05, 0.399), fps=st.sampled_from([30.0, 120.0]))
def test_speed_alone(who, froude, fps):
    """Step length and cadence follow; the steady steps go at that speed, and so do the hips."""
    leg = who.thigh + who.shin + who.foot.ankle_height
    speed = np.sqrt(froude * 9.80665 * leg)
    motion = walk(distance=9.0, body=who, speed=speed, start="walk", stop="walk", fps=fps)
    took = np.diff(motion.labels.footstep_time[1:])
    assert np.array(gaps(motion))[1:-1] / took[1:-1] == pytest.approx(speed, abs=1e-6)
    first, last = (int(t) for t in motion.labels.footstep_time[[3, -1]] * fps)
    hips = motion.root_position[:, 2]
    measured = (hips[last] - hips[first]) / ((last - first) / fps)
    assert measured == pytest.approx(speed, rel=0.08)  # within a step the hips speed up and slow


@settings(max_examples=40)
@given(errand=errands())
def test_distance(errand):
    """Standing: the middle of both feet on the end. Walking: the last heel strike on the path."""
    motion = walk(**errand.arguments)
    labels = motion.labels
    if errand.stop == "stand":
        middle = labels.footstep_position[-2:].mean(0)
        assert middle == pytest.approx([0.0, 0.0, errand.distance], abs=1e-6)
    else:
        left = errand.distance - labels.footstep_position[-1, 2]
        assert left >= -1e-9
        assert left < errand.step_length
    # mid-walk the hips are behind the first point: the path begins at the rear foot
    begin = 0.0 if errand.start == "stand" else -errand.step_length
    np.testing.assert_allclose(labels.path[[0, -1]], [[0, begin], [0, errand.distance]], atol=1e-9)
    assert np.linalg.norm(np.diff(labels.path, axis=0), axis=-1).max() <= 0.02 + 1e-12


@given(errand=errands())
@settings(max_examples=40)
def test_start_and_stop(errand):
    motion = walk(**errand.arguments)
    labels, down = motion.labels, motion.contacts
    width = labels.footstep_position[labels.footstep_side == 0, 0][0] * 2.0
    assert width > 0.0
    sides = np.where(labels.footstep_side == 0, 0.5, -0.5)
    assert labels.footstep_position[:, 0] == pytest.approx(width * sides, abs=1e-9)
    first = [0, 1, 1] if errand.start == "stand" else [1, 0, 1]
    assert labels.footstep_side.tolist()[:3] == first, "the right foot lands first"
    assert (np.diff(labels.footstep_side[2:]) != 0).all()
    if errand.start == "stand":
        assert labels.footstep_position[:2, 2] == pytest.approx(0.0, abs=1e-9)
        assert down[0].all(), "flat on both feet"
    else:  # frame 0 is a heel strike at the first point
        assert labels.footstep_position[1, 2] == pytest.approx(0.0, abs=1e-9)
        assert down[0, labels.footstep_side[1]].tolist() == [True, False, False]
        assert not down[0, labels.footstep_side[0], 0], "the rear heel is up"
    if errand.stop == "stand":
        assert down[-1].all()
        still = motion.root_position[-int(0.2 * errand.fps) :]
        assert np.ptp(still, axis=0).max() < 1e-9, "it comes to rest"
    else:
        assert motion.duration <= labels.footstep_time[-1] + 1e-6
        assert motion.duration > labels.footstep_time[-1] - 1.0 / errand.fps - 1e-6


@given(height=heights())
@settings(max_examples=20)
def test_body_height(height):
    motion = walk(distance=1.0, body=height, fps=10)
    rest = motion.skeleton.rest_positions()
    body = person(height)
    crown = rest[motion.skeleton.index("head"), 1] + body.head
    assert crown == pytest.approx(height, abs=1e-9)
    feet = [motion.skeleton.index(f"{side}Foot") for side in ("left", "right")]
    soles = rest[feet][:, 1] + motion.skeleton.soles[:, 0, 1]
    assert soles == pytest.approx(0.0, abs=1e-9), "the soles rest on the floor"


@pytest.mark.parametrize("name", BODIES)
def test_body_by_name(name):
    motion = walk(distance=1.0, body=name, fps=10)
    skeleton, body = motion.skeleton, person(name)
    for part, length in (("LowerLeg", body.thigh), ("Foot", body.shin)):
        offset = skeleton.offsets[skeleton.index(f"left{part}")]
        assert np.linalg.norm(offset) == pytest.approx(length, abs=1e-12)


@pytest.mark.parametrize("fps", [5.0, 24.0, 29.97, 60.0, 144.0, 1000.0])
def test_fps(fps):
    """Another frame rate shows the same motion at other times."""
    motion, film = walk(distance=2.0, fps=fps), walk(distance=2.0, fps=10.0 * fps)
    assert motion.fps == fps
    assert 0.0 <= film.duration - motion.duration < 1.0 / fps
    same = film.root_position[::10][: len(motion)]
    np.testing.assert_allclose(same, motion.root_position[: len(same)], atol=1e-9)
    np.testing.assert_array_equal(film.contacts[::10][: len(motion)], motion.contacts[: len(same)])


@pytest.mark.parametrize("width", [0.09, 0.12, 0.3])
@pytest.mark.parametrize("toe_out", [-0.08, 0.0, 0.3])
def test_step_width_and_toe_out(width, toe_out):
    motion = walk(distance=2.0, step_width=width, toe_out=toe_out, fps=120)
    positions, _, soles = posed(motion)
    for i, found in enumerate(seen_footsteps(motion, positions, soles)):
        side = 1.0 if motion.labels.footstep_side[i] == 0 else -1.0
        foot, heading = found
        assert foot[:, 0] == pytest.approx(0.5 * width * side, abs=1e-6)
        assert heading == pytest.approx(toe_out * side, abs=1e-6)


@settings(max_examples=30)
@given(errand=errands(shortest=3.0))
def test_the_hips_stay_over_the_path(errand):
    """Swaying from foot to foot, but by the same to both sides, and never beyond the feet."""
    motion = walk(**vars(replace(errand, start="walk", stop="walk")))
    aside = motion.root_position[:, 0]
    assert np.abs(aside).max() < 0.06
    stride = round(2.0 * 60.0 / errand.cadence * errand.fps)
    if stride < len(aside):
        mean = np.convolve(aside, np.ones(stride) / stride, mode="valid")
        assert np.abs(mean).max() < 0.01


def test_the_ground_is_recorded():
    assert json.loads(walk(distance=1.0).labels.ground) == {"kind": "flat", "height": 0.0}


@pytest.mark.parametrize("start", ENDS)
@pytest.mark.parametrize("stop", ENDS)
def test_a_walk_of_many_steps_has_them_all(start, stop):
    motion = walk(distance=60.0, step_length=0.75, start=start, stop=stop, fps=24)
    # the last foot of stop="walk" is not seen flat, and the path may be left by part of a step
    assert np.nansum(gaps(motion)) == pytest.approx(60.0, abs=2 * 0.75)
    assert len(motion.labels.footstep_side) > 79
