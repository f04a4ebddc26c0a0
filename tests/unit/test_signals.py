"""The zero-lag Butterworth filter against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal as scipy_signal

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.signals import butterworth_zero_lag

#: One pass of a second-order Butterworth has its -3 dB here, if two passes have it at 1.
TWO_PASSES = (np.sqrt(2.0) - 1.0) ** 0.25


def noisy_step(rate: float, seconds: float, seed: int = 0) -> np.ndarray:
    """A gait-like signal, (n, 2): trend, stride and its overtones, noise."""
    t = np.arange(int(rate * seconds)) / rate
    clean = 1.2 * t + 0.3 * np.sin(2 * np.pi * t) + 0.1 * np.cos(6 * np.pi * t)
    noise = 0.01 * np.random.default_rng(seed).normal(size=(len(t), 2))
    return clean[:, None] * [1.0, -0.5] + noise


@pytest.mark.parametrize(("cutoff", "rate"), [(6.0, 100.0), (6.0, 69.9), (12.0, 240.0)])
def test_it_is_scipys_filtfilt_but_for_the_first_instants_of_the_padding(cutoff, rate):
    x = noisy_step(rate, 6.0)
    b, a = scipy_signal.butter(2, cutoff / TWO_PASSES, fs=rate)
    pad = int(np.ceil(3.0 * rate / cutoff))
    oracle = scipy_signal.filtfilt(b, a, x, axis=0, padtype="odd", padlen=pad)
    ours = butterworth_zero_lag(x, cutoff=cutoff, rate=rate)

    inside = slice(int(0.5 * rate), -int(0.5 * rate))
    np.testing.assert_allclose(ours[inside], oracle[inside], atol=1e-6)
    np.testing.assert_allclose(ours, oracle, atol=1e-4)  # start values of the padding differ


@pytest.mark.parametrize(("cutoff", "rate"), [(6.0, 240.0), (6.0, 1000.0), (2.0, 100.0)])
def test_two_passes_leave_half_the_power_at_the_cutoff(cutoff, rate):
    """Amplitude 1 / sqrt(2); to 0.2 %, the bilinear transform's share at 40 samples a period."""
    t = np.arange(int(rate * 60.0 / cutoff)) / rate
    filtered = butterworth_zero_lag(np.sin(2 * np.pi * cutoff * t), cutoff=cutoff, rate=rate)
    inside = slice(len(t) // 4, -len(t) // 4)
    turned = filtered[inside] * np.exp(-2j * np.pi * cutoff * t[inside])
    amplitude = 2.0 * np.abs(turned.mean())
    assert amplitude == pytest.approx(np.sqrt(0.5), rel=2e-3)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(52, 400))
def test_lines_pass_unchanged_if_long_enough_to_be_continued(seed, count):
    start, slope = np.random.default_rng(seed).normal(size=(2, 3))
    line = start + slope * np.arange(count)[:, None] / 100.0
    out = butterworth_zero_lag(line, cutoff=6.0, rate=100.0)
    np.testing.assert_allclose(out, line, atol=1e-6)


@pytest.mark.parametrize("count", [2, 3, 10])
def test_constants_pass_unchanged_in_every_length(count):
    out = butterworth_zero_lag(np.full((count, 2), 0.7), cutoff=6.0, rate=100.0)
    np.testing.assert_allclose(out, 0.7, atol=1e-12)


def test_no_lag_a_symmetric_signal_stays_symmetric():
    x = np.exp(-0.5 * ((np.arange(401) - 200) / 6.0) ** 2)
    out = butterworth_zero_lag(x, cutoff=6.0, rate=100.0)
    assert out.argmax() == 200
    np.testing.assert_allclose(out, out[::-1], atol=1e-9)


def test_columns_are_filtered_each_for_itself():
    x = noisy_step(100.0, 3.0)
    both = butterworth_zero_lag(x, cutoff=6.0, rate=100.0)
    one = butterworth_zero_lag(x[:, 1], cutoff=6.0, rate=100.0)
    np.testing.assert_array_equal(both[:, 1], one)


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 50.0, 60.0, float("nan"), float("inf")])
def test_a_cutoff_that_cannot_be_is_refused(cutoff):
    with pytest.raises(InvalidInputError, match="cutoff must be between"):
        butterworth_zero_lag(np.zeros(100), cutoff=cutoff, rate=100.0)
