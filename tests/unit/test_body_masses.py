from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gaitsmith.body.masses import center_of_mass, segments_of
from gaitsmith.body.presets import BODIES
from gaitsmith.body.proportions import SHORTEST, TALLEST, body_from_height
from gaitsmith.body.rig import skeleton_of
from gaitsmith.errors import InvalidInputError, UnknownNameError
from gaitsmith.motion.skeleton import Skeleton

heights = st.floats(SHORTEST, TALLEST)


@given(heights, st.floats(5.0, 200.0))
def test_masses_add_up(height, mass):
    segments = segments_of(body_from_height(height, mass=mass))
    assert sum(s.mass for s in segments) == pytest.approx(mass, rel=1e-9)
    assert len(segments) == len({s.name for s in segments}) == 14
    assert all(s.mass > 0 for s in segments)


def test_shares_are_the_mean_of_men_and_women():
    """de Leva 1996 Table 4: trunk .4346 and .4257, thigh .1416 and .1478."""
    share = {s.name: s.mass / 100.0 for s in segments_of(body_from_height(1.75, mass=100.0))}
    assert share["trunk"] == pytest.approx(0.43015, abs=1e-4)
    assert share["left_thigh"] == share["right_thigh"] == pytest.approx(0.1447, abs=1e-4)
    assert share["head"] == pytest.approx(0.0681, abs=1e-4)


def test_centers_of_trunk_and_head_are_measured_from_the_right_end():
    """de Leva 1996: .5138, .4964 from cervicale to mid-hip; .5002, .4841 from vertex down."""
    body = body_from_height(1.75)
    com = {s.name: s.com for s in segments_of(body)}
    assert com["trunk"] == pytest.approx(1.0 - 0.5051, abs=1e-9)
    above_neck_base = com["head"] * body.neck
    assert above_neck_base / (body.neck + body.head) == pytest.approx(1.0 - 0.49215, abs=1e-9)


@pytest.mark.parametrize("name", BODIES)
def test_centers_lie_in_their_segments(name):
    body = BODIES[name]()
    segments = {s.name: s for s in segments_of(body)}
    for part in (
        "trunk",
        "left_upper_arm",
        "left_forearm",
        "left_thigh",
        "left_shank",
        "left_foot",
    ):
        assert 0.2 < segments[part].com < 0.6
    # between head joint and crown; between wrist and finger tips
    assert body.neck < segments["head"].com * body.neck < body.neck + body.head
    reach = segments["right_hand"].com * body.forearm
    assert body.forearm < reach < body.forearm + body.hand


def test_standing_adults_have_it_near_the_navel():
    """.55 to .58 of stature with arms hanging; arms are put out sideways at rest: a bit higher."""
    body = body_from_height(1.75)
    skeleton = skeleton_of(body)
    com = center_of_mass(skeleton, skeleton.rest_positions(), segments_of(body))
    assert com[0] == pytest.approx(0.0, abs=1e-12)
    assert 0.55 < com[1] / body.height < 0.60
    assert 0.0 < com[2] < 0.01  # only the feet stick out forward


@given(heights, st.integers(0, 2**32 - 1))
def test_moves_with_the_body_and_only_with_its_mass(height, seed):
    body = body_from_height(height)
    skeleton, segments = skeleton_of(body), segments_of(body)
    rng = np.random.default_rng(seed)
    positions = rng.normal(size=(4, 5, len(skeleton), 3))
    com = center_of_mass(skeleton, positions, segments)
    assert com.shape == (4, 5, 3)
    shift = rng.normal(size=3)
    moved = center_of_mass(skeleton, positions + shift, segments)
    assert moved == pytest.approx(com + shift, abs=1e-12)
    heavier = [replace(s, mass=3.0 * s.mass) for s in segments]
    assert center_of_mass(skeleton, positions, heavier) == pytest.approx(com, abs=1e-12)
    # brute force
    at = {name: positions[2, 3, j] for j, name in enumerate(skeleton.names)}
    sums = sum(
        s.mass * (at[s.proximal] + s.com * (at[s.distal] - at[s.proximal])) for s in segments
    )
    assert com[2, 3] == pytest.approx(sums / body.mass, abs=1e-12)


def test_what_does_not_fit_is_refused():
    body = body_from_height(1.75)
    skeleton, segments = skeleton_of(body), segments_of(body)
    with pytest.raises(InvalidInputError, match=r"must end in \(22, 3\), got shape \(3,\)"):
        center_of_mass(skeleton, np.zeros(3), segments)
    with pytest.raises(InvalidInputError, match="must have mass"):
        center_of_mass(skeleton, skeleton.rest_positions(), [])
    pole = Skeleton(("hips",), (-1,), np.zeros((1, 3)))
    with pytest.raises(UnknownNameError, match="joint"):
        center_of_mass(pole, np.zeros((1, 3)), segments)
