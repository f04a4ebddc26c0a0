"""What the names of markers mean."""

from __future__ import annotations

import pytest

from gaitsmith.gait.marker_names import ALIASES, meaning


@pytest.mark.parametrize(
    ("name", "side", "role"),
    [
        ("R.Heel", 1, "heel"), ("heel_r", 1, "heel"), ("RHEE", 1, "heel"), ("rHeel", 1, "heel"),
        ("RightHeel", 1, "heel"), ("Bob:LHEE", 0, "heel"), ("left heel", 0, "heel"),
        ("heel", None, "heel"), ("R.GTR", 1, "hip"), ("hip_l", 0, "hip"),
        ("L_HJC", 0, "hip center"),
        ("R.Knee", 1, "knee"), ("LKNE", 0, "knee"), ("R.Knee.Medial", 1, "knee medial"),
        ("L.Ankle.Medial", 0, "ankle medial"), ("RANK", 1, "ankle"), ("L.MT5", 0, "mt5"),
        ("mt1_r", 1, "mt1"), ("R_5th_metatarsal", 1, "mt5"), ("RMTH1", 1, "mt1"),
        ("LASI", 0, "asis"), ("R.PSIS", 1, "psis"), ("S2", None, "sacrum"),
        ("Sacrum", None, "sacrum"),
        ("ball_l", 0, "ball"), ("R.Toe", 1, "toe"), ("LTOE", 0, "toe"), ("lknee", 0, "knee"),
    ],
)  # fmt: skip
def test_names_of_laboratories_are_understood(name, side, role):
    assert meaning(name) == (side, role)


@pytest.mark.parametrize(
    "name", ["R.TH1", "L.Shoulder", "rib_cage", "fibula", "C7", "", "r", "R.HF"]
)
def test_other_names_mean_nothing(name):
    assert meaning(name) is None


def test_no_name_has_two_meanings():
    names = [name for aliases in ALIASES.values() for name in aliases]
    assert len(names) == len(set(names))
    for role, aliases in ALIASES.items():
        for name in aliases:
            assert meaning(name) == (None, role)
            assert meaning(f"R.{name}") == (1, role)
            assert meaning(f"{name}_l") == (0, role)
