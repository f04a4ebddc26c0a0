"""[SM01] Eqs. 11-12 with the sign mended, and their inverse."""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.body.presets import body_from
from gaitsmith.plan.slope_steps import LEG, preferred_length, preferred_step

BODY = body_from(1.75).scaled(LEG / body_from(1.75).leg_length)


def test_figure_13_people_step_shorter_up_and_down(golden):
    slope = np.radians(np.linspace(-30.0, 30.0, 25))
    length, height = preferred_step(slope, BODY)
    assert length[0] < length[12] > length[-1]
    assert (np.diff(height) > 0.0).all()
    golden("sm01_fig13", atol=1e-6, slope_deg=np.degrees(slope), length_m=length, height_m=height)


@pytest.mark.parametrize(
    ("deg", "length"), [(-10.0, 0.552), (10.0, 0.604), (0.0, 0.625), (-1.0, 0.6195), (1.0, 0.6211)]
)
def test_numbers_by_hand(deg, length):
    """The paper is wrong: downhill, 0.627 + 0.0075 times a positive slope would be 0.702."""
    found, height = preferred_step(np.radians(deg), BODY)
    assert found == pytest.approx(length, abs=1e-9)
    assert height == pytest.approx(length * np.tan(np.radians(deg)), abs=1e-9)


def test_the_inverse():
    """Acceptance 7.6: to 1e-6 m for slopes within 30 degrees."""
    slope = np.radians(np.random.default_rng(0).uniform(-30.0, 30.0, 4000))
    length, height = preferred_step(slope, BODY)
    assert np.abs(preferred_length(height, BODY) - length).max() < 1e-9


def test_the_two_lines_become_one_smoothly():
    slope = np.radians(np.linspace(-3.0, 3.0, 60001))
    length, _ = preferred_step(slope, BODY)
    assert np.abs(np.diff(length)).max() < 2e-6


def test_heights_beyond_the_curve_take_its_last_length():
    deepest = preferred_length(np.array([-0.31, -0.5, -9.0]), BODY)
    assert deepest == pytest.approx([0.1995] * 3, abs=1e-6)
    assert np.isfinite(preferred_length(np.array([5.0]), BODY)).all()
    # so far down the height of a step grows: beyond -57.7 degrees it would shrink
    _, height = preferred_step(np.radians([-57.0, -56.0]), BODY)
    assert height[0] < height[1]


def test_by_body_and_by_the_walks_own_level_length():
    small = body_from(1.2)
    length, _ = preferred_step(0.1, small)
    assert length / small.leg_length == pytest.approx(preferred_step(0.1, BODY)[0] / LEG)
    assert preferred_step(0.0, small, level=0.8)[0] == pytest.approx(0.8)
    height = preferred_step(-0.2, small, level=0.8)[1]
    assert preferred_length(height, small, level=0.8) == pytest.approx(
        preferred_step(-0.2, small, level=0.8)[0], abs=1e-9
    )
