"""From markers to walk data: what Winter's table gives, and a generated walk read back."""

from __future__ import annotations

import numpy as np
import pytest

import gaitsmith
from gaitsmith.body.presets import KB92B_SUBJECT, body_from
from gaitsmith.errors import FileFormatError, InvalidInputError
from gaitsmith.motion.kinematics import motion_kinematics, sole_positions
from gaitsmith.motion.motion import Markers
from gaitsmith.walks.extract import MARKERS, Extraction, extract, read_winter_table
from gaitsmith.walks.files import built_in, read_walk_data, walk_data_from_json, write_walk_data
from gaitsmith.walks.generalize import hip_height, mu

#: Half a unit of the last digit that files keep.
DIGITS = 0.51e-7


@pytest.fixture(scope="module")
def winter(measured_data) -> Extraction:
    table = measured_data / "permissive" / "prototype" / "winter_table_a1_raw_m.csv"
    if not table.is_file():
        pytest.skip(f"{table.name} is not among the measured data")
    return extract(read_winter_table(table), KB92B_SUBJECT)


def assert_is_winters_walk(walk) -> None:
    """What [KB92b] prints (its 70.69 cm) and what was measured from the same table."""
    angles = np.degrees(mu(walk.character, walk.body, walk.length))
    assert walk.length == pytest.approx(0.707, abs=1e-3)
    assert round(100.0 * walk.length, 2) == 70.69
    assert walk.flat == pytest.approx(0.18, abs=0.03)
    assert walk.toe_off == pytest.approx(0.16, abs=0.03)
    assert walk.heel_off == pytest.approx(0.66, abs=0.03)
    assert walk.meta_off == pytest.approx(0.98, abs=0.03)
    np.testing.assert_allclose(angles[1:], [24.2, 61.1, 45.7], rtol=0, atol=2.0)
    assert angles[0] == pytest.approx(172.0, abs=1e-4), "the straightest knee that is taken"
    assert walk.character.kappa == pytest.approx(0.457, abs=0.01)
    assert walk.character.ratio == pytest.approx(walk.length / 0.739, abs=1e-6)


def test_winters_table_gives_the_published_step(winter):
    assert_is_winters_walk(winter.walk)
    assert winter.step_time == pytest.approx(0.4936, abs=1e-3)


def test_the_shipped_walk_is_winters():
    """The same numbers, without the table."""
    assert_is_winters_walk(built_in("winter_step"))


def test_the_shipped_walk_is_a_fresh_extraction(winter):
    """To the digits that the file keeps."""
    shipped, fresh = built_in("winter_step"), winter.walk
    assert shipped.body == fresh.body
    for name in ("previous_length", "length", "flat", "heel_off", "meta_off", "toe_off"):
        assert getattr(shipped, name) == pytest.approx(getattr(fresh, name), abs=DIGITS), name
    for name in ("ratio", "knee", "strike_pitch", "off_pitch", "off_meta", "kappa"):
        one, two = (getattr(w.character, name) for w in (shipped, fresh))
        assert one == pytest.approx(two, abs=DIGITS), name
    assert shipped.character.gains == fresh.character.gains
    for name, sequence in fresh.sequences.items():
        kept = shipped.sequences[name]
        np.testing.assert_allclose(kept.times, sequence.times, rtol=0, atol=DIGITS)
        np.testing.assert_allclose(kept.values, sequence.values, rtol=0, atol=DIGITS)


def test_a_fresh_extraction_agrees_with_itself(winter):
    """Ends by the mu functions: every law holds for it to the last digits."""
    walk = winter.walk
    knee, strike, off, meta = mu(walk.character, walk.body, walk.length)
    character = walk.character
    measured = [character.knee, character.strike_pitch, character.off_pitch, character.off_meta]
    np.testing.assert_allclose([knee, strike, off, meta], measured, rtol=0, atol=1e-12)
    ends = [walk.foot1.values[0, 0], -walk.foot2.values[-1, 0], walk.meta.values[-1, 0]]
    np.testing.assert_allclose(ends, [strike, off, meta], rtol=0, atol=1e-12)
    height = hip_height(character, walk.body, walk.length)
    np.testing.assert_allclose(walk.hip.values[[0, -1], 1], height, rtol=0, atol=1e-12)


def test_the_measured_feet_turn_one_way_until_they_leave():
    walk = built_in("winter_step")
    assert (np.diff(walk.foot1.values[:, 0]) <= 0.0).all()
    assert walk.foot1.values[-1, 0] == 0.0
    assert (np.diff(walk.foot2.values[:, 0]) <= 0.0).all()
    assert walk.foot2.at(np.array([walk.heel_off]))[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(walk.meta.values[:, 0]) >= 0.0).all()
    assert walk.meta.values[0, 0] == 0.0


# --- a generated walk, read back ------------------------------------------------------------

STEP, RATE = 0.6, 100.0  # seconds, frames a second


def markers_of(body, ratio: float, side: str) -> tuple[Markers, float, list[float]]:
    """One stride and a bit of a leg of a walk, its step length and its landings in frames."""
    length = ratio * body.leg_length
    motion = gaitsmith.walk(
        distance=8.0, body=body, gait="winter", step_length=length, cadence=60.0 / STEP, fps=RATE
    )
    joints, world = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, joints, world)
    leg = [motion.skeleton.index(f"{side}{n}") for n in ("UpperLeg", "LowerLeg", "Foot")]
    which = ("left", "right").index(side)
    paths = np.concatenate([joints[:, leg], soles[:, which]], axis=1)
    labels = motion.labels
    landings = labels.footstep_time[labels.footstep_side == which][2:]
    first, last = (round(RATE * t) for t in (landings[0] - 0.35, landings[1] + 0.35))
    strikes = [RATE * t - first for t in landings[:2]]
    return Markers(MARKERS, paths[first:last], RATE), length, strikes


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("who", "ratio"),
    [
        ("adult", 0.85),
        ("adult", 0.6),
        ("child", 0.75),
        ("kb92b-subject", 0.95),
        ("kb92b-figure", 0.85),
    ],
)
def test_the_markers_of_a_generated_walk_give_it_back(who, ratio, side):
    """Thresholds of speed find heel strikes a frame or two early, toe-offs late."""
    body, made = body_from(who), built_in("winter_step")
    markers, length, strikes = markers_of(body, ratio, side)

    found = extract(markers, body)

    walk, frames = found.walk, STEP * RATE
    assert walk.length == pytest.approx(length, abs=1e-3)
    assert found.step_time == pytest.approx(STEP, abs=0.5 / RATE)
    assert walk.flat == pytest.approx(made.flat, abs=0.03)
    assert walk.toe_off == pytest.approx(made.toe_off, abs=0.06)
    assert np.abs(np.array(found.heel_strikes) - strikes).max() / frames < 0.05
    assert walk.heel_off == pytest.approx(made.heel_off, abs=0.12)
    assert walk.meta_off == pytest.approx(made.meta_off, abs=0.12)
    assert walk.character.kappa == pytest.approx(made.character.kappa, abs=0.05)
    angles = np.degrees(np.array(mu(walk.character, body, length)[1:]))
    wanted = np.degrees(np.array(mu(made.character, body, length)[1:]))
    # toe-off is found late, and pitch and toes turn on meanwhile
    assert (np.abs(angles - wanted) < [6.0, 7.0, 10.0]).all(), (angles, wanted)
    # the foot is measured, not believed
    assert walk.body.foot.ankle_height == pytest.approx(body.foot.ankle_height, abs=1e-3)
    assert walk.body.foot.ball == pytest.approx(body.foot.ball, abs=1e-3)
    assert walk.body.foot.toes == pytest.approx(body.foot.toes, abs=1e-3)
    assert walk.body.leg_length == body.leg_length


def test_where_the_floor_is_does_not_matter():
    """It is found from the flat foot: here it lies a decimeter up."""
    body = body_from("adult")
    markers, length, _ = markers_of(body, 0.8, "left")
    plain = extract(markers, body)
    lifted = np.array(markers.positions)
    lifted[..., 1] += 0.1
    moved = extract(Markers(MARKERS, lifted, RATE), body)
    assert moved.walk.length == pytest.approx(length, abs=1e-3)
    for name, sequence in plain.walk.sequences.items():
        np.testing.assert_allclose(
            moved.walk.sequences[name].values, sequence.values, rtol=0, atol=1e-9, err_msg=name
        )


def test_less_than_a_stride_is_refused():
    markers, _, _ = markers_of(body_from("adult"), 0.8, "left")
    short = Markers(MARKERS, markers.positions[:70], RATE)
    with pytest.raises(InvalidInputError, match="no full stride found: heel strikes at frames"):
        extract(short, body_from("adult"))


def test_markers_that_are_missing_are_named():
    markers, _, _ = markers_of(body_from("adult"), 0.8, "left")
    with pytest.raises(InvalidInputError, match="unknown marker 'toe'"):
        extract(Markers(MARKERS[:-1], markers.positions[:, :-1], RATE), body_from("adult"))


# --- files ------------------------------------------------------------------------------------


def test_walk_data_survive_a_file(tmp_path):
    walk = built_in("winter_step")
    path = tmp_path / "walk.json"
    write_walk_data(walk, path, source="a test", step_time=0.5)
    back = read_walk_data(path)
    assert back.body == walk.body
    assert back.character == walk.character
    for name, sequence in walk.sequences.items():
        np.testing.assert_array_equal(back.sequences[name].times, sequence.times)
        np.testing.assert_array_equal(back.sequences[name].values, sequence.values)
    again = tmp_path / "again.json"
    write_walk_data(back, again, source="a test", step_time=0.5)
    assert again.read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not walk data"),
        ("{}", "not walk data"),
        ('{"format": "gaitsmith-walk-data-9"}', "format is 'gaitsmith-walk-data-9'"),
        ('{"format": "gaitsmith-walk-data-1"}', "not walk data"),
    ],
)
def test_what_is_no_walk_data_is_refused_by_its_name(text, said):
    with pytest.raises(FileFormatError, match=rf"bad\.json: .*{said}"):
        walk_data_from_json(text, "bad.json")
