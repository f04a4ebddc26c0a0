"""What [KB92b] draws or tells in words, as numbers beside this file."""

from __future__ import annotations

import numpy as np
from walkers import PROTOTYPE

from gaitsmith.body.presets import KB92B_SUBJECT
from gaitsmith.walks.generalize import generalize, hip_height, mu


def test_kb92b_eqs_5_6_21_24_the_angles_against_the_step_length(golden):
    """Longer steps: knee more bent at heel strike, foot steeper there and at toe-off."""
    body = KB92B_SUBJECT
    ratio = np.linspace(0.3, 1.15, 18)

    angles = np.degrees([mu(PROTOTYPE.character, body, r * body.leg_length) for r in ratio])

    assert (np.diff(angles[:, 0]) < 0.0).all(), "the interior knee angle falls"
    assert (np.diff(angles[:, 1:], axis=0) > 0.0).all(), "the others rise"
    assert angles[:, 0].max() <= 180.0
    slopes = np.diff(angles, axis=0) / np.diff(ratio)[:, None]
    np.testing.assert_allclose(slopes, slopes[:1].repeat(17, axis=0), atol=1e-9)  # linear
    golden(
        "kb92b_mu",
        atol=1e-4,
        ratio=ratio,
        mu1_deg=angles[:, 0],
        mu2_deg=angles[:, 1],
        mu3_deg=angles[:, 2],
        mu4_deg=angles[:, 3],
    )


def test_kb92b_figure_4_the_hips_are_lower_at_the_heel_strike_of_longer_steps(golden):
    body = KB92B_SUBJECT
    ratio = np.linspace(0.3, 1.15, 18)

    height = np.array([hip_height(PROTOTYPE.character, body, r * body.leg_length) for r in ratio])

    assert (np.diff(height) < 0.0).all()
    assert height[0] - height[-1] > 0.05
    golden("kb92b_fig4", atol=1e-5, ratio=ratio, hip_m=height)


def test_kb92b_figure_5_hip_paths_of_shorter_steps_are_higher_and_flatter(golden):
    body = KB92B_SUBJECT
    phase = np.linspace(0.0, 1.0, 21)
    ratios = (0.6, 0.8, 1.0)

    paths = {}
    for r in ratios:
        length = r * body.leg_length
        walk = generalize(PROTOTYPE, body, length, length)
        paths[r] = walk.hip.at(phase)

    for shorter, longer in ((0.6, 0.8), (0.8, 1.0)):
        assert (paths[shorter][[0, -1], 1] > paths[longer][[0, -1], 1]).all()
        assert np.ptp(paths[shorter][:, 1]) < np.ptp(paths[longer][:, 1])
    for path in paths.values():
        assert path[:, 1].argmax() in range(5, 16), "highest in the middle of the step"
    columns = {f"{a}_{int(100 * r)}": paths[r][:, i] for r in ratios for i, a in enumerate("xy")}
    golden("kb92b_fig5", atol=1e-5, phase=phase, **columns)


def test_the_six_sequences_of_the_measured_step(golden):
    """H, F1, F2, F3, M, A of W*, eleven samples each over its own interval."""
    share = np.linspace(0.0, 1.0, 11)
    columns = {}
    for name, sequence in PROTOTYPE.sequences.items():
        times = sequence.times[0] + share * np.ptp(sequence.times)
        values = sequence.at(times)
        columns[f"{name}_t"] = times
        if values.shape[1] == 1:
            columns[f"{name}_deg"] = np.degrees(values[:, 0])
        else:
            columns[f"{name}_x"], columns[f"{name}_y"] = values.T

    assert (np.diff(columns["hip_x"]) > 0.0).all(), "the hips never go back"
    assert columns["hip_x"][0] < 0.0 < columns["hip_x"][-1], "they pass over the stance ankle"
    assert columns["hip_y"][5] > columns["hip_y"][[0, -1]].max() + 0.02, "and rise over it"
    assert (columns["foot1_deg"] >= 0.0).all(), "the foot lands on its heel"
    assert (columns["foot2_deg"] <= 0.0).all(), "and leaves on its toes"
    assert columns["foot3_deg"].min() < -65.0, "in the swing it first points down"
    assert columns["foot3_deg"][-1] > 20.0, "then lands toes up"
    assert (np.diff(columns["meta_deg"]) > 0.0).all()
    assert columns["ankle_y"].max() > columns["ankle_y"][0], "the ankle rises after toe-off"
    assert columns["ankle_x"][0] < -0.5 < 0.6 < columns["ankle_x"][-1], "and goes 1.3 m ahead"
    golden("kb92b_prototype", atol=1e-4, share=share, **columns)
