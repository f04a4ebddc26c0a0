"""From markers to gaits: generated walks read back, and what was measured on people."""

from __future__ import annotations

import functools
import warnings

import numpy as np
import pytest
from judge import broken

import gaitsmith
from gaitsmith import io
from gaitsmith.body.presets import body_from
from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.errors import GaitsmithWarning, InfeasibleError
from gaitsmith.gait.events import Stance
from gaitsmith.gait.marker_legs import learn_from_markers
from gaitsmith.geometry.rotations import about, rotate
from gaitsmith.learning import learn
from gaitsmith.motion.kinematics import forward_kinematics, motion_kinematics, sole_positions
from gaitsmith.motion.motion import Markers, Motion

RATE, STEP, LENGTH = 100.0, 0.55, 0.68
WHO = body_from(1.75)
#: Where a laboratory puts its markers: outside of the joints, above the sole.
OUTSIDE = {"GTR": 0.08, "Knee": 0.055, "Ankle": 0.04, "Heel": 0.0, "MT5": 0.035, "Toe": 0.0}


def test_what_is_missing_is_named():
    markers = made(sides=("right",))
    with pytest.raises(InfeasibleError, match=r"lacks heel\. Understood: R\.GTR \(right hip\)"):
        learn_from_markers(without(markers, "R.Heel"))
    with pytest.raises(InfeasibleError, match=r"Understood: none\. Not understood: a, b"):
        learn_from_markers(Markers(("a", "b"), markers.positions[:, :2], RATE))


# --- a generated walk, read back ------------------------------------------------------------


@functools.cache
def walked() -> Motion:
    return gaitsmith.walk(
        distance=7.0, body=WHO, step_length=LENGTH, cadence=60.0 / STEP, fps=RATE, start="walk"
    )


def made(sides=SIDES, frames=slice(120, 370), motion=None) -> Markers:
    """Markers on a walk's skin."""
    motion = motion or walked()
    joints, world = motion_kinematics(motion)
    soles = sole_positions(motion.skeleton, joints, world)
    names, paths = list[str](), list[np.ndarray]()
    for side in sides:
        s = SIDES.index(side)
        foot = world[:, motion.skeleton.index(f"{side}Foot")]
        out = SIDE_SIGN[s] * np.array([1.0, 0.0, 0.0])
        above = rotate(foot, np.array([0.0, 0.03, 0.0]))
        points = {
            "GTR": joints[:, motion.skeleton.index(f"{side}UpperLeg")],
            "Knee": joints[:, motion.skeleton.index(f"{side}LowerLeg")],
            "Ankle": joints[:, motion.skeleton.index(f"{side}Foot")],
            "Heel": soles[:, s, 0],
            "MT5": soles[:, s, 1],
            "Toe": soles[:, s, 2],
        }
        for name, path in points.items():
            names.append(f"{side[0].upper()}.{name}")
            lifted = path + above if name in ("Heel", "MT5") else path
            paths.append(lifted + OUTSIDE[name] * rotate(foot * [0, 1, 0, 1], out))
    return Markers(tuple(names), np.stack(paths, axis=1)[frames], RATE)


def without(markers: Markers, *names: str) -> Markers:
    keep = [i for i, name in enumerate(markers.names) if name not in names]
    return Markers(tuple(markers.names[i] for i in keep), markers.positions[:, keep], markers.rate)


def changed(markers: Markers, positions) -> Markers:
    return Markers(markers.names, positions, markers.rate)


def angles(skeleton, joints, world) -> np.ndarray:
    """``(F, 2, 3)`` degrees: thigh against the vertical, knee, foot against the shin."""
    soles, out = sole_positions(skeleton, joints, world), []
    for s, side in enumerate(SIDES):
        hip, knee, ankle = (
            joints[:, skeleton.index(side + part)] for part in ("UpperLeg", "LowerLeg", "Foot")
        )
        thigh, shin, sole = knee - hip, ankle - knee, soles[:, s, 1] - soles[:, s, 0]
        lead = np.arctan2(thigh[:, 2], -thigh[:, 1])
        bend = np.arctan2(np.linalg.norm(np.cross(thigh, shin), axis=-1), (thigh * shin).sum(-1))
        pitch = np.arctan2(sole[:, 1], np.hypot(sole[:, 0], sole[:, 2]) * np.sign(sole[:, 2]))
        out.append(np.stack([lead, bend, np.unwrap(pitch) - lead + bend], axis=-1))
    return np.degrees(np.stack(out, axis=1))


PHASE = np.arange(100) / 100


def cycle_angles(cycle) -> np.ndarray:
    center, turned = cycle.at(PHASE)
    center = center + PHASE[:, None] * [0.0, 0.0, cycle.stride_length]
    return angles(cycle.skeleton, *forward_kinematics(cycle.skeleton, center, turned))


def walk_angles(motion: Motion, right: float) -> np.ndarray:
    """Of one stride in the middle of a walk, from a left heel strike."""
    labels = motion.labels
    left = [i for i in range(2, len(labels.footstep_side)) if labels.footstep_side[i] == 0][1]
    at = np.interp(PHASE, [0.0, right, 1.0], labels.footstep_time[left : left + 3])
    whole = angles(motion.skeleton, *motion_kinematics(motion)).reshape(len(motion), -1)
    return np.stack([np.interp(at, motion.times, c) for c in whole.T], axis=-1).reshape(-1, 2, 3)


def rms(v) -> float:
    return float(np.sqrt(np.mean(((v + 180.0) % 360.0 - 180.0) ** 2)))


def assert_is_the_walk(found, *, length=0.001, width=0.01) -> None:
    assert found.cycle.stride_length == pytest.approx(2.0 * LENGTH, abs=2.0 * length)
    assert found.cycle.duration == pytest.approx(2.0 * STEP, abs=0.02)
    assert found.step_lengths == pytest.approx((LENGTH, LENGTH), abs=10.0 * length)
    assert found.step_width == pytest.approx(walked_width(), abs=width)


def walked_width() -> float:
    labels = walked().labels
    return float(np.ptp(labels.footstep_position[:, 0]))


def test_a_generated_walk_is_read_back():
    found = learn_from_markers(made())
    assert_is_the_walk(found)
    assert found.body.thigh == pytest.approx(WHO.thigh, abs=0.006)
    assert found.body.shin == pytest.approx(WHO.shin, abs=0.006)
    # 38 mm above the markers' line are no ankle's: the usual height is taken
    assert found.body.foot.ankle_height == pytest.approx(WHO.foot.ankle_height, abs=0.003)
    assert found.body.height == pytest.approx(1.75, abs=0.04)
    away = cycle_angles(found.cycle) - walk_angles(walked(), 0.5)
    away -= away.mean(axis=0)  # markers beside the joints shift an angle, the walk is its course
    assert rms(away) < 2.5
    above = [n for n in found.cycle.skeleton.names if "Leg" not in n and "Foot" not in n]
    above = [found.cycle.skeleton.index(n) for n in above if n != "hips" and "Toes" not in n]
    assert (found.cycle.rotations[:, above, 3] == 1.0).all(), "the upper body is left to rules"


@pytest.mark.parametrize("heading", [0.7, 1.5708, -2.5])
def test_the_walk_may_lead_anywhere(heading):
    markers = made()
    turned = rotate(about("y", heading), markers.positions) + [3.0, 0.0, -7.0]
    one, two = learn_from_markers(markers), learn_from_markers(changed(markers, turned))
    np.testing.assert_allclose(two.cycle.rotations, one.cycle.rotations, rtol=0, atol=1e-6)
    np.testing.assert_allclose(two.cycle.center, one.cycle.center, rtol=0, atol=1e-6)
    assert two.cycle.stride_length == pytest.approx(one.cycle.stride_length, abs=1e-9)


def test_a_treadmill_carries_over_the_ground():
    markers, speed = made(), LENGTH / STEP
    time = np.arange(len(markers.positions)) / RATE
    still = markers.positions - (time * speed)[:, None, None] * np.array([0.0, 0.0, 1.0])
    found = learn_from_markers(changed(markers, still))
    assert any("treadmill" in note and "1.24 m/s" in note for note in found.notes)
    assert_is_the_walk(found, length=0.003)


@pytest.mark.parametrize("side", SIDES)
def test_one_leg_is_both_half_a_stride_apart(side):
    found = learn_from_markers(made(sides=(side,)))
    assert_is_the_walk(found)
    assert any(f"only the {side} leg" in note for note in found.notes)
    assert found.cycle.events[1, 0] == pytest.approx(0.5)
    both = cycle_angles(found.cycle)
    assert rms(np.roll(both[:, 1], 50, axis=0) - both[:, 0]) < 0.1


def test_a_sagittal_table_names_no_side():
    right = made(sides=("right",))
    flat = right.positions * [0.0, 1.0, 1.0]
    names = tuple({"R.GTR": "hip", "R.MT5": "mt5"}.get(n, n[2:].lower()) for n in right.names)
    found = learn_from_markers(Markers(names, flat, RATE))
    assert_is_the_walk(found, width=0.05)
    assert any("taken as the right leg" in note for note in found.notes)
    assert {s.side for s in found.stances} == {1}


def test_left_handed_axes_are_seen_in_a_mirror():
    markers = made()
    one, two = (
        learn_from_markers(m) for m in (markers, changed(markers, markers.positions * [-1, 1, 1]))
    )
    assert any("left-handed" in note for note in two.notes)
    np.testing.assert_allclose(two.cycle.rotations, one.cycle.rotations, rtol=0, atol=1e-6)


def test_noise_is_filtered_and_said():
    markers = made()
    noise = np.random.default_rng(1).normal(0.0, 0.002, markers.positions.shape)
    found = learn_from_markers(changed(markers, markers.positions + noise))
    assert any("low-pass" in note for note in found.notes)
    assert_is_the_walk(found, length=0.004)
    assert not any("low-pass" in note for note in learn_from_markers(markers).notes)


def test_one_stride_is_enough_where_events_are_known():
    labels, markers = walked().labels, made(frames=slice(None))
    times, sides = labels.footstep_time, labels.footstep_side
    first = next(i for i in range(2, len(times)) if sides[i] == 1)
    begin = times[first]
    strikes = [(int(sides[i]), float(times[i] - begin)) for i in range(first - 1, first + 3)]
    given = [
        Stance(s, t, t + 0.2 * STEP, t + 0.8 * STEP, t + 1.2 * STEP) for s, t in strikes if t >= 0.0
    ]
    given.append(Stance(0, -STEP, -0.8 * STEP, -0.2 * STEP, 0.2 * STEP))
    a, b = (round(t * RATE) for t in (begin, times[first + 2]))
    short = changed(markers, markers.positions[a : b + 1])
    found = learn_from_markers(short, events=given)
    assert_is_the_walk(found, length=0.004)
    assert any("just one stride" in note for note in found.notes)
    ends = found.cycle.at(np.array([0.0, 0.999999]))[0]
    assert np.abs(ends[1] - ends[0]).max() < 1e-4
    with pytest.raises(InfeasibleError, match=r"hold no stride.*1\.6 strides.*--events"):
        learn_from_markers(short)


def test_what_is_no_straight_walk_is_refused():
    markers = made()
    with pytest.raises(InfeasibleError, match="backward"):
        learn_from_markers(changed(markers, markers.positions[::-1]))
    still = np.repeat(markers.positions[:1], 200, axis=0)
    with pytest.raises(InfeasibleError, match="nobody walks"):
        learn_from_markers(changed(markers, still))
    with pytest.raises(InfeasibleError, match="unit"):
        learn_from_markers(changed(markers, 1000.0 * markers.positions))
    with pytest.raises(InfeasibleError, match="left foot, whose markers are not here"):
        learn_from_markers(
            made(sides=("right",)), events=[Stance(1, 0, 1, 2, 3), Stance(0, 1, 2, 3, 4)]
        )
    with pytest.raises(InfeasibleError, match=r"do not go with a height of 1\.10 m"):
        learn_from_markers(markers, height=1.1)


# --- people ---------------------------------------------------------------------------------

RAJAGOPAL = ("opensim/rajagopal_overground_m.csv", "opensim/markers_walk.trc")
WINTER = ("prototype/winter_table_a1_raw_m.csv", "prototype/winter_wm_filtered_m.csv")
BMC = ("prototype/bmc_overground_walk1_m.csv", "prototype/walk1.trc")
CSU = "prototype/csu_treadmill_right_leg_m.csv"
ALL = (*RAJAGOPAL, *WINTER, *BMC, CSU)


@pytest.fixture
def people(measured_data):
    def path(name: str):
        file = measured_data / "permissive" / name
        if not file.is_file():
            pytest.skip(f"{name} is not among the measured data")
        return file

    return path


@functools.cache
def markers_in(path) -> Markers:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # of gaps that were filled
        return io.load_markers(path)


@functools.cache
def gait_of(path):
    return learn(markers_in(path), name=path.stem)


def assert_events(stances, side: int, *, strikes, offs) -> None:
    """Every measured event is found within 30 ms."""
    own = [s for s in stances if s.side == side]
    for wanted, found in (
        (strikes, [s.heel_strike for s in own if s.cut not in ("start", "both")]),
        (offs, [s.toe_off for s in own if s.cut not in ("end", "both")]),
    ):
        for time in wanted:
            assert min(abs(t - time) for t in found) <= 0.030, (side, time, found)


@pytest.mark.parametrize("name", RAJAGOPAL)
def test_events_are_the_force_plates(people, name):
    stances = gait_of(people(name)).stances
    assert_events(stances, 1, strikes=[0.2665, 1.4110], offs=[1.0235, 2.1675])
    assert_events(stances, 0, strikes=[0.8355], offs=[1.5895])


@pytest.mark.parametrize("name", WINTER)
def test_events_are_winters(people, name):
    stances = gait_of(people(name)).stances
    frames = (np.array([28, 97, 70]) - 1) / 69.9
    assert_events(stances, 1, strikes=frames[:2], offs=frames[2:])


def test_events_are_the_treadmills(people):
    path = people(CSU)
    table = np.genfromtxt(path, delimiter=",", names=True)
    bears = table["grf_y_N"] > 20.0
    offs = table["time_s"][1:][bears[:-1] & ~bears[1:]]
    offs = [t for t in offs if t > 0.5]
    assert len(offs) >= 2
    assert_events(gait_of(path).stances, 1, strikes=[0.21, 1.41, 2.60], offs=offs)


@pytest.mark.parametrize("name", ALL)
def test_stride_and_pace_are_a_plain_measurement(people, name):
    """Of the heel from one stance to the next, and of the time between."""
    path = people(name)
    gait, markers = gait_of(path), markers_in(path)
    side = next(
        s for s in gait.stances if s.heel_strike == pytest.approx(gait.span[0], abs=1e-5)
    ).side
    word = ("l", "r")[side]
    names = [n for n in markers.names if n.lower() in (f"heel_{word}", f"{word}.heel", "heel")]
    heel = markers[names[0]]
    rows = [round(t * markers.rate) for t in gait.span]
    strikes = [heel[r + round(0.12 * markers.rate) if name not in WINTER else r] for r in rows]
    length = float(np.linalg.norm((strikes[1] - strikes[0])[[0, 2]]))
    duration = gait.span[1] - gait.span[0]
    if name == CSU:  # carried by the belt, which moves as the foot does that bears all the weight
        force = np.genfromtxt(path, delimiter=",", names=True)["grf_y_N"]
        belt = np.gradient(markers["mt5"][:, 2])[force > 0.9 * np.median(force[force > 100])]
        length = strikes[1][2] - strikes[0][2] - float(np.median(belt)) * markers.rate * duration
    assert gait.cycle.stride_length == pytest.approx(length, rel=0.02)
    assert gait.cycle.duration == pytest.approx(duration, rel=1e-5)
    assert gait.cycle.speed == pytest.approx(length / duration, rel=0.02)
    assert gait.cadence == pytest.approx(120.0 / duration, rel=0.02)


@pytest.mark.parametrize("name", [*WINTER, CSU])
def test_angles_are_those_of_the_markers(people, name):
    """Of sagittal tables: thigh, knee and foot against the shin, straight from the columns.

    Each angle less its mean: markers beside the joints shift angles, see markers.md.
    """
    path = people(name)
    gait, markers = gait_of(path), markers_in(path)
    hip, knee, ankle, heel, ball = (
        markers[n][:, [2, 1]] for n in ("hip", "knee", "ankle", "heel", "mt5")
    )
    up = [np.arctan2(v[:, 0], -v[:, 1]) for v in (knee - hip, ankle - knee)]
    pitch = np.unwrap(np.arctan2((ball - heel)[:, 1], (ball - heel)[:, 0]))
    plain = np.degrees(np.stack([up[0], up[0] - up[1], pitch - up[1]], axis=-1))
    time = np.arange(len(plain)) / markers.rate
    at = gait.span[0] + PHASE * (gait.span[1] - gait.span[0])
    plain = np.stack([np.interp(at, time, c) for c in plain.T], axis=-1)
    learned = cycle_angles(gait.cycle)[:, 1]
    learned = np.roll(learned, -round(100 * gait.cycle.events[1, 0]), axis=0)
    motion = own_walk(gait)
    walked = walk_angles(motion, gait.cycle.events[1, 0])[:, 1]
    walked = np.roll(walked, -round(100 * gait.cycle.events[1, 0]), axis=0)
    for seen, limit in ((learned, 2.0), (walked, 4.0)):
        away = seen - plain
        away -= away.mean(axis=0)
        assert rms(away) <= limit


@pytest.mark.parametrize("name", WINTER)
def test_a_knee_marker_far_up_the_thigh_makes_no_short_thigh(people, name):
    """0.31 and 0.42 m between the markers; [KB92b] has 0.3585 and 0.3805 m for the same man."""
    body = gait_of(people(name)).body
    assert body.thigh == pytest.approx(0.3585, abs=0.02)
    assert body.leg_length == pytest.approx(0.739, abs=0.005)


def own_walk(gait) -> Motion:
    stride = gait.cycle.stride_length
    return gaitsmith.walk(
        distance=6.0 * stride, gait=gait, body=gait.body, step_length=0.5 * stride,
        cadence=gait.cadence, fps=120,
    )  # fmt: skip


@pytest.mark.parametrize("name", [RAJAGOPAL[1], *WINTER, *BMC, CSU])
def test_who_was_measured_walks_as_measured(people, name):
    gait = gait_of(people(name))
    shown = walk_angles(own_walk(gait), gait.cycle.events[1, 0])
    assert rms(shown - cycle_angles(gait.cycle)) <= 4.0


TWICE = {RAJAGOPAL[0], WINTER[1], BMC[0]}  # other files of the same walks


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in TWICE else n for n in ALL]
)
def test_every_promise_is_kept(people, name):
    gait = gait_of(people(name))
    for body in (gait.body, 1.2, 1.75, 2.05):
        assert broken(gaitsmith.walk(gait=gait, body=body, distance=6.0, fps=120)) == {}


def test_the_command_line_learns_and_walks(people, run, tmp_path):
    gait = tmp_path / "x.gait.json"
    code, out, err = run("learn", people(BMC[1]), "-o", gait, "--license", "CC BY 4.0")
    assert code == 0
    assert out.startswith("walk1: stride 1.2")
    assert "note: hip joint centers from ASIS and PSIS by Harrington et al. 2007" in err
    for spec in (gait, people(CSU)):
        file = tmp_path / f"{spec.stem}.npz"
        assert run("walk", "--distance", 4, "--gait", spec, "-o", file)[0] == 0
        assert file.is_file()


def test_a_file_without_legs_is_one_line_of_error(run, tmp_path):
    table = tmp_path / "arm.csv"
    rows = "\n".join(f"{i / 100:.2f},0,1,0" for i in range(50))
    table.write_text(f"time,L.Elbow_x,L.Elbow_y,L.Elbow_z\n{rows}\n")
    out = tmp_path / "x.gait.json"
    code, _, said = run("learn", table, "-o", out)
    assert code == 1
    assert "lacks hip" in said
    assert "Not understood: L.Elbow" in said
    assert said.count("\n") == 1
    assert not out.exists()
