from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

from gaitsmith.body.body import Body, Foot
from gaitsmith.body.presets import BODIES, KB92B_FIGURE, KB92B_SUBJECT, body_from
from gaitsmith.body.proportions import body_from_height
from gaitsmith.errors import InvalidInputError

#: [KB92b] section 6 as printed: cm and radians; (subject, figure, ratio).
TABLE = {
    "ah": ("7.629", "13.49", "1.77"),
    "ab": ("12.20", "17.55", "1.44"),
    "hb": ("15.89", "15.19", "0.96"),
    "bt": ("7.095", "7.200", "1.01"),
    "th_b": ("0.4842", "0.8378", "1.73"),
    "th_h": ("0.8400", "1.312", "1.56"),
    "th_a": ("1.818", "0.9916", "0.55"),
    "hN": ("5.093", "3.450", "0.67"),
    "aN": ("5.680", "13.04", "2.30"),
    "bN": ("10.80", "11.74", "1.09"),
    "shin": ("38.05", "34.53", "0.91"),
    "thigh": ("35.85", "40.72", "1.14"),
    "ll": ("73.90", "75.25", "1.02"),
}
COLUMNS = pytest.mark.parametrize("column", [0, 1], ids=["subject", "figure"])


def printed(name: str, column: int) -> tuple[float, float]:
    """Value and half a unit of its last printed digit."""
    text = TABLE[name][column]
    return float(text), 0.5 * 10.0 ** -len(text.partition(".")[2])


def agrees(formula, result: str, parts: list[str], column: int) -> bool:
    """Can ``formula`` of values that print as the parts print as the result?"""
    values = np.array([printed(p, column)[0] for p in parts])
    spread = np.array([printed(p, column)[1] for p in parts])
    wanted, half = printed(result, column)
    # the formulas are monotone over such small boxes: their extremes are at corners
    corners = np.array(np.meshgrid(*[[-1, 1]] * len(parts))).reshape(len(parts), -1).T
    reached = np.array([formula(*(values + c * spread)) for c in corners])
    return bool(reached.min() - half <= wanted <= reached.max() + half)


@COLUMNS
@pytest.mark.parametrize(
    ("result", "parts", "formula"),
    [
        ("ah", ["aN", "hN"], np.hypot),
        ("ab", ["aN", "bN"], np.hypot),
        ("hb", ["hN", "bN"], np.add),
        ("th_h", ["aN", "hN"], np.arctan2),
        ("th_b", ["aN", "bN"], np.arctan2),
        ("th_a", ["aN", "hN", "bN"], lambda a, h, b: np.pi - np.arctan2(a, h) - np.arctan2(a, b)),
        ("ll", ["thigh", "shin"], np.add),
    ],
)
def test_kb92b_table_keeps_the_identities_of_the_foot_triangle(column, result, parts, formula):
    """All but one: see the misprints below."""
    assert agrees(formula, result, parts, column) != (result == "th_h" and column == 0)


def test_kb92b_misprints_are_small():
    """The subject's heel angle should read 0.8398, the ratio of heel to N 0.68."""
    assert np.arctan2(5.680, 5.093) == pytest.approx(0.8398, abs=5e-5)
    # with the printed 0.8400 the angles of the triangle miss pi by more than their last digits
    assert abs(0.8400 + 0.4842 + 1.818 - np.pi) == pytest.approx(6.1e-4, abs=1e-5)
    assert round(3.450 / 5.093, 4) == 0.6774


@pytest.mark.parametrize("row", TABLE)
def test_kb92b_ratio_column(row):
    (subject, s), (figure, f), (ratio, r) = (printed(row, i) for i in range(3))
    low, high = (figure - f) / (subject + s) - r, (figure + f) / (subject - s) + r
    assert (low <= ratio <= high) != (row == "hN")  # 0.677 is printed as 0.67


@pytest.mark.parametrize(("body", "column"), [(KB92B_SUBJECT, 0), (KB92B_FIGURE, 1)])
def test_kb92b_bodies_are_the_table(body, column):
    foot = body.foot
    got = {
        "ah": 100 * foot.ankle_heel,
        "ab": 100 * foot.ankle_ball,
        "hb": 100 * foot.heel_ball,
        "bt": 100 * foot.toes,
        "th_b": foot.ball_angle,
        "th_h": foot.heel_angle,
        "th_a": foot.ankle_angle,
        "hN": 100 * foot.heel,
        "aN": 100 * foot.ankle_height,
        "bN": 100 * foot.ball,
        "shin": 100 * body.shin,
        "thigh": 100 * body.thigh,
        "ll": 100 * body.leg_length,
    }
    for name, value in got.items():
        wanted, half = printed(name, column)
        # what is derived may be off by its parts' last digits as well as its own
        assert value == pytest.approx(wanted, abs=4 * half), name
    assert foot.toe_joint_height == 0.0
    stacked = body.hip_height + body.trunk + body.neck + body.head
    assert body.height == pytest.approx(stacked, abs=1e-12)


def lengths() -> list[str]:
    return [f.name for f in fields(Body) if f.name not in ("name", "foot", "spine_segments")]


@pytest.mark.parametrize("bad", [0.0, -0.4, float("nan"), float("inf"), "long", None])
@pytest.mark.parametrize("name", lengths())
def test_every_measure_must_be_a_positive_number(name, bad):
    with pytest.raises(
        InvalidInputError, match=rf"body\.{name} must be a positive number of .*got"
    ):
        replace(body_from("adult"), **{name: bad})


@pytest.mark.parametrize("name", [f.name for f in fields(Foot)])
def test_every_measure_of_the_foot_must_be_a_number_that_can_be(name):
    foot = body_from("adult").foot
    for bad in (-0.01, float("nan"), float("inf")):
        with pytest.raises(InvalidInputError, match=rf"foot\.{name} must be"):
            replace(foot, **{name: bad})
    with pytest.raises(InvalidInputError, match=r"below the ankle \(0.068 m\)"):
        replace(foot, toe_joint_height=0.07)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"thigh": 1.0}, "between half and twice"),
        ({"shoulder_drop": 0.6}, "shoulder_drop .* below the trunk"),
        ({"hip_width": 0.9}, "hip_width .* below the leg length"),
        ({"height": 2.3}, "within 25% of"),
        ({"height": 1.3}, "within 25% of"),
        ({"foot": Foot(0.07, 0.1, 0.4, 0.2)}, "shorter than 0.7 of the leg"),
        ({"foot": Foot(0.22, 0.06, 0.12, 0.08)}, "below half the shin"),
        ({"spine_segments": 0}, "whole number from 1 to 40, got 0"),
        ({"spine_segments": 2.0}, "whole number"),
        ({"spine_segments": True}, "whole number"),
    ],
)
def test_impossible_bodies_are_refused(change, words):
    with pytest.raises(InvalidInputError, match=words):
        replace(body_from("adult"), **change)


def test_all_contradictions_are_named_at_once():
    with pytest.raises(InvalidInputError, match=r"twice body\.shin.*hip_width.*body\.height"):
        replace(body_from("adult"), thigh=1.4, hip_width=2.0)


def test_scaling_scales_everything():
    body = body_from("adult")
    double = body.scaled(2.0, name="giant")
    for name in lengths():
        factor = 8.0 if name == "mass" else 2.0
        assert getattr(double, name) == pytest.approx(factor * getattr(body, name), rel=1e-15)
    assert double.foot.length == pytest.approx(2.0 * body.foot.length, rel=1e-15)
    assert double.foot.ankle_angle == pytest.approx(body.foot.ankle_angle, rel=1e-14)
    with pytest.raises(InvalidInputError, match="factor"):
        body.scaled(-1.0)


@pytest.mark.parametrize("name", BODIES)
def test_presets_are_bodies_with_one_line_about_them(name):
    preset = BODIES[name]
    assert isinstance(preset(), Body)
    assert preset() == preset() == body_from(name)
    assert preset.about
    assert "\n" not in preset.about
    assert abs(preset().height - body_from_height(preset().height).height) < 1e-12
