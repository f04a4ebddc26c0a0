"""TRC, marker CSV and OpenSim's tables."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from gaitsmith import io
from gaitsmith.errors import FileFormatError, GaitsmithWarning, InvalidInputError, UnknownNameError
from gaitsmith.io.marker_csv import read_marker_csv
from gaitsmith.io.sto import Table, read_sto
from gaitsmith.io.trc import read_trc

RNG = np.random.default_rng(0)
PATHS = np.round(RNG.uniform(-900.0, 900.0, (30, 3, 3)), 3)
NAMES = ("R.Heel", "L Toe", "Sacrum")


def trc(paths=PATHS, units="mm", rate="100.00", frames=None, sep="\t", cells=None) -> str:
    cells = cells or {}
    head = sep.join(["Frame#", "Time", *(f"{name}{2 * sep}" for name in NAMES)])
    axes = sep.join(["", "", *(f"{a}{i + 1}" for i in range(3) for a in "XYZ")])
    rows = [
        sep.join([str(f + 1), f"{f / 100:.3f}",
                  *(cells.get((f, i), f"{v:.3f}") for i, v in enumerate(row.ravel()))])
        for f, row in enumerate(paths)
    ]  # fmt: skip
    return "\n".join(
        ["PathFileType\t4\t(X/Y/Z)\tC:\\data\\walk.trc",
         "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate",
         f"{rate}\t{rate}\t{frames or len(paths)}\t3\t{units}\t{rate}", head, axes, "", *rows, ""]
    )  # fmt: skip


def written(tmp_path, text: str, name: str):
    (tmp_path / name).write_text(text, newline="")
    return tmp_path / name


@pytest.mark.parametrize(("units", "factor"), [("mm", 1e-3), ("m", 1.0), ("cm", 1e-2)])
def test_a_trc_is_markers_in_meters(units, factor, tmp_path):
    got = io.load_markers(written(tmp_path, trc(units=units), "a.TRC"))
    assert got.names == NAMES
    assert got.rate == 100.0
    np.testing.assert_allclose(got.positions, factor * PATHS, rtol=1e-12)
    again = read_trc(written(tmp_path, trc(units=units).replace("\n", "\r\n"), "b.trc"))
    np.testing.assert_array_equal(again.positions, got.positions)


def test_short_gaps_are_filled_and_long_ones_leave_a_marker_out(tmp_path):
    cells = dict.fromkeys([(4, 0), (4, 1), (4, 2), (5, 0)], "")
    cells |= {(f, 4): "NaN" for f in range(10, 25)}
    with pytest.warns(GaitsmithWarning) as said:
        got = read_trc(written(tmp_path, trc(cells=cells), "a.trc"))
    assert got.names == ("R.Heel", "Sacrum")
    assert [str(w.message).split("a.trc: ")[1] for w in said] == [
        "gaps filled with straight lines: R.Heel (frames 5-6)",
        "left out for their gaps: L Toe (frames 11-25)",
    ]
    want = PATHS[3, 0] + (PATHS[6, 0] - PATHS[3, 0]) / 3.0
    np.testing.assert_allclose(got["R.Heel"][4], 1e-3 * want)
    np.testing.assert_allclose(got["R.Heel"][6:], 1e-3 * PATHS[6:, 0])


def test_empty_cells_at_the_end_of_a_line_may_be_missing(tmp_path):
    text = trc(cells=dict.fromkeys([(7, 6), (7, 7), (7, 8)], "")).replace("\t\t\t\n", "\n")
    with pytest.warns(GaitsmithWarning, match=r"Sacrum \(frames 8\)"):
        assert read_trc(written(tmp_path, text, "a.trc")).names == NAMES


def test_markers_on_z_are_turned_up(tmp_path):
    t = np.arange(200) / 100.0
    foot = np.stack([1200 * t, 0 * t, 30 + 20 * np.sin(9 * t)], axis=-1)
    head = np.stack([1200 * t, 300 * t, 1700 + 0 * t], axis=-1)
    paths = np.stack([foot, head, 0.5 * (foot + head)], axis=1)
    with pytest.warns(GaitsmithWarning, match="stand on z = 0"):
        got = read_trc(written(tmp_path, trc(paths), "a.trc"))
    np.testing.assert_allclose(got.positions[:, 1, 1], 1.7)
    np.testing.assert_allclose(got.positions[:, 1, 2], -0.3 * t, atol=1e-6)
    as_it_is = read_trc(written(tmp_path, trc(paths), "a.trc"), up="y")
    np.testing.assert_allclose(as_it_is.positions[:, 1, 2], 1.7)


@pytest.mark.parametrize(("text", "line", "cause"), [
    ("", 1, "header"),
    ("hello", 1, "PathFileType"),
    (trc(units="furlong"), 3, "furlong"),
    (trc(rate="0"), 3, "frames a second"),
    (trc(rate="x"), 3, "DataRate"),
    (trc(frames=31), 36, "declares 31 frames, but ends after 30"),
    (trc().replace("Frame#", "Bild"), 4, "'Frame#'"),
    (trc().replace("\t3\tmm", "\t4\tmm"), 4, "declares 4 markers, but names 3"),
    (trc(cells={(2, 3): "x"}), 9, "got 'x'"),
    (trc(cells={(2, 3): "1\t2"}), 9, "10 coordinates where 9"),
    (trc(cells={(2, 3): "1e30"}), 36, "m away"),
])  # fmt: skip
def test_a_broken_trc_is_refused_with_its_line(text, line, cause, tmp_path):
    with pytest.raises(FileFormatError, match=r"a\.trc") as error:
        read_trc(written(tmp_path, text, "a.trc"))
    assert error.value.line == line
    assert cause in str(error.value)


def test_rows_that_hold_nothing_do_not_fill_the_memory(tmp_path):
    count = 9000
    head = "Frame#\tTime\t" + "\t\t\t".join(f"m{i}" for i in range(count))
    text = (
        "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n"
        f"100\t2\t{count}\tmm\n{head}\n\n" + "1\n" * 100_000
    )
    with pytest.raises(FileFormatError, match="hardly any are there"):
        read_trc(written(tmp_path, text, "bomb.trc"))


# ------------------------------------------------------------------------------------------ CSV
def table(head: str, *columns: np.ndarray) -> str:
    rows = "\n".join(",".join(f"{v:.6g}" for v in row) for row in np.column_stack(columns))
    return f"{head}\n{rows}\n"


T = np.arange(50) / 50.0


def test_a_table_in_space_keeps_its_axes(tmp_path):
    text = table("time_s,hip_x,hip_y,hip_z,grf_N", T, 1.2 * T, 0 * T + 0.9, 0 * T + 0.1, T)
    got = io.load_markers(written(tmp_path, text, "a.csv"))
    assert got.names == ("hip",)
    assert got.rate == pytest.approx(50.0)
    np.testing.assert_allclose(got["hip"], np.stack([1.2 * T, 0 * T + 0.9, 0 * T + 0.1], -1))


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_sagittal_table_walks_along_z(way, tmp_path):
    text = table("frame,time,hip_x,hip_y,toe_x,toe_y", T, T, way * T, 0 * T + 0.9, way * T, 0 * T)
    got = read_marker_csv(written(tmp_path, text, "a.csv"))
    np.testing.assert_allclose(got["hip"], np.stack([0 * T, 0 * T + 0.9, T], -1), atol=1e-6)


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1000.0), ("cm", 100.0)])
def test_a_table_in_other_units_is_guessed_or_said(unit, factor, tmp_path):
    columns = [factor * v for v in (T, 0 * T + 0.9, T, 0 * T)]
    path = written(tmp_path, table("time,hip_x,hip_y,toe_x,toe_y", T, *columns), "a.csv")
    with pytest.warns(GaitsmithWarning, match=f"taken as {unit}"):
        got = read_marker_csv(path)
    np.testing.assert_allclose(got["hip"][:, 1], 0.9)
    np.testing.assert_array_equal(read_marker_csv(path, unit=unit).positions, got.positions)
    head = "time," + ",".join(f"{n}_{a}_{unit}" for n in ("hip", "toe") for a in "xy")
    named = read_marker_csv(written(tmp_path, table(head, T, *columns), "b.csv"))
    np.testing.assert_array_equal(named.positions, got.positions)


@pytest.mark.parametrize(("text", "cause"), [
    ("", "names of the columns"),
    ("a,b\n1,2\n", "no table of markers"),
    ("time,a_x\n1,2\n", "no table of markers"),
    ("time,a_x,a_y,b_x,b_y,b_z\n", "no table of markers"),
    ("time,a_x,a_y\n", "without rows"),
    ("a_x,a_y\n1,2\n2,3\n", "no column is called time"),
    ("time,a_x,a_y\n0,1,2\n", "must increase"),
    ("time,a_x,a_y\n0,1,2\n1,1\n", "2 cells, but 3"),
    ("time,a_x,a_y\n0,1,2\n1,1,x\n", "got 'x'"),
    ("time,a_x,a_y\n0,1,2\n1,1,2\n9,1,2\n", "not even"),
    ("time,a_x,a_y\n0,1,2\n,1,2\n", "is missing"),
    ("time,a_x,a_y,a_x\n", "stands twice"),
    ("time,a_x,a_y\n0,,2\n1,,2\n", "every marker has gaps"),
])  # fmt: skip
def test_a_broken_table_is_refused(text, cause, tmp_path):
    with pytest.raises(FileFormatError, match=r"a\.csv") as error:
        read_marker_csv(written(tmp_path, text, "a.csv"))
    assert cause in str(error.value)


# -------------------------------------------------------------------------------------- OpenSim
STO = (
    "Coordinates\ninDegrees=no\nnColumns=3\nnRows=4\nversion=3\nendheader\n"
    "time\t/jointset/hip/flexion/value\tknee\n"
    + "\n".join(f"{i / 10}\t{i}\t{-i}" for i in range(4))
)


def test_a_table_is_read_by_name(tmp_path):
    got = io.load_table(written(tmp_path, STO + "\n", "a.sto"))
    assert got.names == ("/jointset/hip/flexion/value", "knee")
    assert got.in_degrees is False
    assert got.rate == pytest.approx(10.0)
    np.testing.assert_array_equal(got["knee"], [0, -1, -2, -3])
    np.testing.assert_array_equal(got["flexion"], [0, 1, 2, 3])
    with pytest.raises(UnknownNameError, match="kne"):
        got["kne"]
    yes = STO.replace("=no", "=yes").replace("\n", "\r\n")
    assert read_sto(written(tmp_path, yes, "b.mot")).in_degrees is True


def test_counts_of_a_header_are_not_believed_but_rows_must_be_there(tmp_path):
    with pytest.warns(GaitsmithWarning, match="declares 40 columns, names 3: read by name"):
        read_sto(written(tmp_path, STO.replace("nColumns=3", "nColumns=40"), "a.sto"))
    with pytest.warns(GaitsmithWarning, match="declares 3 rows, has 4"):
        read_sto(written(tmp_path, STO.replace("nRows=4", "nRows=3"), "a.sto"))
    with pytest.raises(FileFormatError, match=r"a\.sto:11: declares 5 rows, but ends after 4"):
        read_sto(written(tmp_path, STO.replace("nRows=4", "nRows=5"), "a.sto"))


@pytest.mark.parametrize(("text", "cause"), [
    ("", "endheader"),
    ("hello\n" * 5000, "endheader"),
    (STO.replace("time\t", "t\t"), "first column must be time"),
    (STO.replace("\tknee", "\ttime"), "more than one column"),
    (STO.replace("nRows=4", "nRows=many"), "count"),
    (STO.replace("0.2\t", "0.1\t"), "must increase"),
    (STO.replace("0.2\t", "x\t"), "a.sto:10: 'x' is not a finite number"),
    (STO + "\t7", "a.sto:11: 4 values where 3"),
])  # fmt: skip
def test_a_broken_table_of_opensim_is_refused(text, cause, tmp_path):
    with pytest.raises(FileFormatError, match=r"a\.sto") as error:
        read_sto(written(tmp_path, text, "a.sto"))
    assert cause in str(error.value)


def test_a_table_checks_itself():
    with pytest.raises(InvalidInputError, match="different"):
        Table(("a", "a"), np.zeros(1), np.zeros((1, 2)))
    with pytest.raises(InvalidInputError, match="values"):
        Table(("a",), np.zeros(1), np.zeros((2, 1)))
    with pytest.raises(InvalidInputError, match="no rate"):
        _ = Table(("a",), np.zeros(1), np.zeros((1, 1))).rate


# --------------------------------------------------------------------------------- measured data
def quietly(read, path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        return read(path)


@pytest.mark.parametrize(("name", "markers", "rate", "speed"), [
    ("opensim/markers_walk.trc", 41, 100.0, 1.2),
    ("opensim/rajagopal_overground_m.csv", 20, 100.0, 1.2),
    ("prototype/walk1.trc", 28, 150.0, 1.2),
    ("prototype/bmc_overground_walk1_m.csv", 18, 150.0, 1.2),
    ("prototype/winter_wm_filtered_m.csv", 8, 69.9, 1.42),
    ("prototype/winter_table_a1_raw_m.csv", 8, 69.9, 1.42),
    ("prototype/csu_treadmill_right_leg_m.csv", 6, 100.0, 0.0),
])  # fmt: skip
def test_measured_markers(name, markers, rate, speed, measured_data):
    got = quietly(io.load_markers, measured_data / "permissive" / name)
    assert len(got.names) == markers
    assert got.rate == pytest.approx(rate, rel=2e-3)
    seconds = (len(got.positions) - 1) / got.rate
    way = np.median(got.positions[-1] - got.positions[0], axis=0)
    assert np.hypot(way[0], way[2]) / seconds == pytest.approx(speed, abs=0.25)
    assert 0.0 < got.positions[..., 1].min() < 0.06
    assert 0.8 < got.positions[..., 1].max() < 1.7


def test_measured_tables(measured_data):
    folder = measured_data / "permissive" / "opensim"
    angles = quietly(io.load_table, folder / "coordinates.sto")
    assert len(angles.names) == 31
    assert angles.rate == pytest.approx(1000.0)
    assert 0.8 < angles["pelvis_ty"].mean() < 1.1
    forces = quietly(io.load_table, folder / "grf_walk.mot")
    strike = forces.time[np.argmax(forces["ground_force_r_vy"] > 20.0)]
    assert forces.rate == pytest.approx(2000.0)
    off = (forces["ground_force_l_vy"] > 20.0) & (forces.time > 0.7)
    assert forces.time[np.argmax(off)] == pytest.approx(0.8355, abs=2e-3)
    assert strike >= 0.0
