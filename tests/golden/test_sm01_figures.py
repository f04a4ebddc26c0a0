"""[SM01] Figures 15 to 17 as data: positions that come out of elevation angles alone.

The printed figures are missing from our copy, so what the text says of them is asserted.
"""

from __future__ import annotations

import numpy as np
import pytest

from gaitsmith.gait.neutral import neutral_cycle, subject
from gaitsmith.synthesis.elevation_exact import ExactWalker
from gaitsmith.walks.elevation_sets import built_in_sets

FRAMES = 25


@pytest.fixture(scope="module")
def stride():
    """Phase, and the left leg's hip, knee and ankle ahead of its stance foot, from heel strike."""
    walker = ExactWalker(built_in_sets()[:1], subject())
    first, second, third = walker.walk(3, lambda t: 0.0 * t, frames=FRAMES)
    phase = np.arange(2 * FRAMES + 1) / (2 * FRAMES)
    start = first.ankle[:, 0, 2][first.time > 0.3][0]
    out = {"phase": phase}
    for name in ("hip", "knee", "ankle"):
        parts = [getattr(legs, name)[:-1, 0, 2] for legs in (first, second)]
        last = getattr(third, name)[:1, 0, 2]
        out[name] = np.concatenate([*parts, last]) - start
    middle = [legs.hip.mean(axis=1)[:, 2] for legs in (first, second)]
    out["middle"] = np.concatenate([middle[0][:-1], middle[1]])
    return out


def test_figure_15_positions_of_hip_knee_and_ankle(stride, golden):
    phase, ankle = stride["phase"], stride["ankle"]
    stride_length = stride["hip"][-1] - stride["hip"][0]
    assert stride_length == pytest.approx(2 * 0.719, abs=5e-3)
    # the ankle is still until the heel rises, then overtakes knee and hip
    assert np.ptp(ankle[(phase > 0.12) & (phase < 0.4)]) < 0.03
    assert (ankle < stride["hip"])[(phase > 0.35) & (phase < 0.6)].all()
    assert (ankle > stride["hip"])[phase > 0.9].all()
    for name in ("hip", "knee"):
        speed = np.diff(stride[name])
        assert speed.min() > 0.0
    golden("sm01_fig15", atol=1e-5, **{k: stride[k] for k in ("phase", "hip", "knee", "ankle")})


def test_figure_17_the_pelvis_runs_ahead_and_behind_twice_a_stride(stride, golden):
    phase, middle = stride["phase"], stride["middle"]
    even = middle[0] + (middle[-1] - middle[0]) * phase
    ahead = 100.0 * (middle - even)
    ahead = ahead - ahead[:-1].mean()
    size = np.abs(np.fft.rfft(ahead[:-1])) / FRAMES
    assert size[2] == size[1:].max()
    assert 0.3 < size[2] < 2.0
    np.testing.assert_allclose(ahead[: FRAMES + 1], ahead[FRAMES:], atol=0.05)
    golden("sm01_fig17", atol=1e-3, phase=phase, ahead_cm=ahead)


def test_figure_16_the_measured_pelvis_runs_ahead_and_behind_twice_a_stride(golden):
    """The man whose legs the sets are; what Figure 17 is to be compared with."""
    cycle = neutral_cycle()
    ahead = 100.0 * (cycle.center[:, 2] - cycle.center[:, 2].mean())
    size = 2.0 * np.fft.rfft(ahead) / len(ahead)
    assert np.abs(size)[2] == np.abs(size)[1:].max()
    # the form in which docs/papers/sm01.md gives it: cos and sin of 4 pi t, centimeters
    assert size[2].real == pytest.approx(-1.41, abs=0.02)
    assert -size[2].imag == pytest.approx(1.11, abs=0.02)
    phase = np.arange(len(ahead)) / len(ahead)
    golden("sm01_fig16", atol=1e-3, phase=phase, ahead_cm=ahead)
