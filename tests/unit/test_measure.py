"""Numbers of motions that are known by hand, of walks that were generated, of measured clips."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

import gaitsmith
from gaitsmith.body.presets import body_from
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import SIDES
from gaitsmith.errors import (
    FileFormatError,
    GaitsmithWarning,
    InfeasibleError,
    UnknownFormatError,
)
from gaitsmith.geometry.rotations import about, multiply, rotate
from gaitsmith.measures import skating, smoothness
from gaitsmith.measures.contacts import gone, heights, runs, slips
from gaitsmith.measures.course import averaged
from gaitsmith.measures.legs import backward, knee_flexion, segment_gap
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import Skeleton

FPS = 60.0


def numbers(figures):
    """The figures that are numbers."""
    return {
        k: v for k, v in figures.items() if isinstance(v, int | float) and not isinstance(v, bool)
    }


def assert_honest(figures):
    """Finite, JSON, and a note for whatever is missing."""
    json.dumps(figures, allow_nan=False)
    said = " ".join(figures["notes"])
    assert not [key for key, value in figures.items() if value is None and key not in said]


def standing(frames=120, *, shift=None, contacts=True):
    """Our figure in its rest pose; its soles are on the ground and go where ``shift`` goes."""
    skeleton = skeleton_of(body_from(1.75))
    rotations = np.zeros((frames, len(skeleton), 4))
    rotations[..., 3] = 1.0
    root = np.tile(skeleton.offsets[0], (frames, 1))
    return Motion(
        skeleton=skeleton,
        root_position=root if shift is None else root + shift,
        rotations=rotations,
        fps=FPS,
        contacts=np.ones((frames, 2, 3), dtype=bool) if contacts else None,
    )


def turned(motion, joint, rotation, frames=slice(None)):
    """``motion`` with a joint turned further in some frames."""
    rotations = np.array(motion.rotations)
    index = motion.skeleton.index(joint)
    rotations[frames, index] = multiply(rotations[frames, index], rotation)
    return motion.with_(rotations=rotations)


def ramp(frames, axis, size):
    out = np.zeros((frames, 3))
    out[:, axis] = np.linspace(0.0, size, frames)
    return out


@pytest.fixture(scope="module")
def walked():
    return gaitsmith.walk(distance=8.0, step_length=0.6, cadence=100.0)


@pytest.fixture(scope="module")
def known(walked):
    return gaitsmith.measure(walked)


@pytest.fixture(scope="module")
def found(walked, tmp_path_factory):
    """What is measured of the same walk's BVH, where everything has to be found."""
    path = gaitsmith.save(walked, tmp_path_factory.mktemp("walk") / "walk.bvh")
    return gaitsmith.measure(path)


# what is known by hand: contact -------------------------------------------------


def test_a_foot_that_slides_30_mm():
    figures = gaitsmith.measure(standing(shift=ramp(120, 0, 0.03)))
    assert figures["contacts"] == "file"
    assert figures["slip_mm_max"] == pytest.approx(30.0)
    assert figures["slip_mm_median"] == pytest.approx(30.0)


def test_a_foot_that_slides_30_mm_and_nobody_says_that_it_bears():
    figures = gaitsmith.measure(standing(shift=ramp(120, 0, 0.03), contacts=False))
    assert figures["contacts"] == "estimated"
    assert figures["slip_mm_max"] == pytest.approx(30.0)


def test_nobody_walks_who_stands():
    figures = gaitsmith.measure(standing())
    assert figures["steps"] == 0
    assert figures["step_length_m"] is None
    assert any("nobody walks" in note for note in figures["notes"])
    assert_honest(figures)


@pytest.mark.parametrize(("up", "deep", "high"), [(-0.005, 5.0, 0.0), (0.007, 0.0, 7.0)])
def test_soles_below_and_above_the_ground(walked, up, deep, high):
    figures = gaitsmith.measure(walked.with_(root_position=walked.root_position + [0.0, up, 0.0]))
    assert figures["penetration_mm_max"] == pytest.approx(deep, abs=1e-6)
    assert figures["float_mm_max"] == pytest.approx(high, abs=1e-6)


def test_the_floor_is_found_where_the_feet_stand(walked):
    bare = walked.with_(
        labels=None, contacts=None, root_position=walked.root_position + [0.0, 0.31, 0.0]
    )
    figures = gaitsmith.measure(bare)
    assert figures["floor_m"] == pytest.approx(0.31, abs=1e-4)
    assert figures["penetration_mm_max"] < 0.1


def test_a_floor_that_sinks_is_a_drift(walked):
    bare = walked.with_(labels=None, contacts=None)
    sunk = bare.with_(root_position=bare.root_position + ramp(len(bare), 1, -0.05))
    figures = gaitsmith.measure(sunk)
    assert figures["floor_drift_m"] == pytest.approx(-0.05, rel=0.12)
    assert figures["float_mm_max"] == pytest.approx(25.0, rel=0.3)


def test_slip_counts_from_where_a_contact_began():
    path = np.zeros((6, 2, 3, 3))
    path[:, 0, 0, 0] = [0.0, 0.0, 1.0, 3.0, 0.0, 2.0]
    down = np.zeros((6, 2, 3), dtype=bool)
    down[[1, 2, 4, 5], 0, 0] = True
    np.testing.assert_allclose(gone(path, down)[:, 0, 0], [0.0, 0.0, 1.0, 0.0, 0.0, 2.0])
    assert slips(path, down, down.any(-1)).tolist() == [1.0, 2.0]
    assert runs(down[:, 0, 0]).tolist() == [[1, 3], [4, 6]]


def test_heights_of_exact_and_of_estimated_contacts():
    above = np.tile([0.01, 0.02, 0.09], (3, 2, 1))
    down = np.zeros((3, 2, 3), dtype=bool)
    down[1, 0, :2] = True
    assert heights(above, down, exact=True).tolist() == [0.02]
    assert heights(above, down, exact=False).tolist() == [0.01]


# what is known by hand: skating -------------------------------------------------


def gliding(speed, height, frames=120):
    toes = np.zeros((frames, 2, 3))
    toes[..., 2] = (np.arange(frames) * speed / FPS)[:, None]
    toes[..., 1] = height
    return toes


def test_skating_ratios_of_a_foot_that_glides():
    toes = gliding(1.0, 0.02)
    # the first and the last mean of five hold two frames of nothing: 3/5 of 1 m/s, still skating
    assert skating.gmd_skating_ratio(toes, FPS) == 1.0
    assert skating.kimodo_skate(toes, FPS) == (1.0, pytest.approx(1.0))
    assert skating.camdm_sliding(toes, toes[:, 0], FPS) == pytest.approx(1.0)


@pytest.mark.parametrize(("speed", "gmd", "kimodo"), [(0.0, 0, 0), (0.3, 0, 1), (0.6, 1, 1)])
def test_skating_ratios_have_their_thresholds_of_speed(speed, gmd, kimodo):
    toes = gliding(speed, 0.02, 600)
    assert skating.gmd_skating_ratio(toes, FPS) == pytest.approx(gmd, abs=0.03)
    assert skating.kimodo_skate(toes, FPS)[0] == kimodo


def test_a_foot_above_5_cm_skates_only_from_a_higher_floor():
    toes = gliding(1.0, 0.06)
    assert skating.gmd_skating_ratio(toes, FPS) == 0.0
    assert skating.kimodo_skate(toes, FPS) == (None, None)
    assert skating.gmd_skating_ratio(toes, FPS, floor=0.06) == 1.0


def test_the_toe_of_a_stance_strays_as_far_as_it_goes():
    toes = gliding(0.1, 0.02, 31)  # half a second at 0.1 m/s
    np.testing.assert_allclose(skating.toe_excursions(toes, FPS), [0.05, 0.05])


def test_no_sliding_of_a_root_that_stays():
    toes = gliding(0.1, 0.0)
    assert skating.camdm_sliding(toes, np.zeros((120, 3)), FPS) is None


# what is known by hand: jumps and jerk ------------------------------------------


def test_a_flipped_quaternion_is_seen():
    motion = standing()
    rotations = np.array(motion.rotations)
    rotations[40:, 3] *= -1.0
    figures = gaitsmith.measure(motion.with_(rotations=rotations))
    assert figures["quaternion_flips"] == 1
    assert figures["joint_deg_per_60th_max"] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("fps", "per_60th"), [(30.0, 6.0), (60.0, 12.0), (120.0, 12.0)])
def test_a_joint_that_turns_12_deg_in_a_frame(fps, per_60th):
    motion = turned(
        standing().with_(fps=fps), "head", about("y", np.radians(12.0)), slice(50, None)
    )
    figures = gaitsmith.measure(motion)
    assert figures["joint_deg_per_60th_max"] == pytest.approx(per_60th)
    assert figures["joint_deg_per_60th_joint"] == "head"
    assert figures["joint_deg_per_60th_frame"] in (48, 49)


def test_a_root_that_jumps():
    shift = ramp(120, 2, 2.0)
    assert gaitsmith.measure(standing(shift=shift))["root_jump_max"] < 0.1
    shift[70:, 2] += 0.05
    figures = gaitsmith.measure(standing(shift=shift))
    # 0.05 m in a frame is 180 m/s^2, of which 3 are no jump
    assert figures["root_jump_max"] == pytest.approx(60.0, rel=0.01)
    assert figures["root_jump_frame"] in (69, 70)


@pytest.mark.parametrize("fps", [30.0, 60.0, 120.0])
def test_jerk_of_a_cubic_is_its_third_derivative(fps):
    t = np.arange(round(2 * fps)) / fps
    path = np.stack([t**3, 0.0 * t, -2.0 * t**3], axis=-1)
    assert smoothness.jerk_rms(path, fps) == pytest.approx(6.0 * np.sqrt(5.0), rel=1e-6)


@pytest.mark.parametrize("duration", [2.0, 4.0])
def test_log_dimensionless_jerk_of_the_smoothest_reach(duration):
    """Of a minimum-jerk reach the integral is 720 D^2/T^5 and the peak speed 1.875 D/T."""
    u = np.linspace(0.0, 1.0, round(120 * duration) + 1)
    path = np.outer(0.4 * (10 * u**3 - 15 * u**4 + 6 * u**5), [0.6, 0.0, 0.8])
    got = smoothness.log_dimensionless_jerk(path, 120.0)
    assert got == pytest.approx(-np.log(720.0 / 1.875**2), abs=0.15)


def test_a_tremor_is_less_smooth():
    t = np.arange(241) / 120.0
    path = np.outer(np.sin(2.0 * t), [1.0, 0.0, 0.0])
    shaking = path + 0.005 * np.sin(2.0 * np.pi * 6.0 * t)[:, None]
    calm, worse = (smoothness.log_dimensionless_jerk(p, 120.0) for p in (path, shaking))
    assert worse < calm - 2.0


# what is known by hand: legs, course --------------------------------------------


@pytest.mark.parametrize(("bend", "back", "least"), [(20.0, 0.0, 0.0), (-10.0, 10.0, -10.0)])
def test_a_knee_that_bends_the_wrong_way(bend, back, least):
    motion = turned(standing(), "leftLowerLeg", about("x", np.radians(bend)))
    figures = gaitsmith.measure(motion)
    assert figures["knee_backward_deg_max"] == pytest.approx(back, abs=1e-6)
    assert figures["knee_min_deg"] == pytest.approx(least, abs=1e-5)


def test_knee_flexion_by_hand():
    hip, knee = np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 0.5, 0.0]])
    ankle = np.array([[0.0, 0.5, -0.5]])  # the shin points backward: 90 deg
    assert knee_flexion(hip, knee, ankle) == pytest.approx(np.pi / 2.0)
    ahead = np.array([[0.0, 0.0, 1.0]])
    assert backward(hip, knee, ankle, ahead) == 0.0
    assert backward(hip, knee, ankle, -ahead) == pytest.approx(np.pi / 2.0)


@pytest.mark.parametrize(
    ("points", "gap"),
    [
        (([-1, 0, 0], [1, 0, 0], [0, 2, -1], [0, 2, 1]), 2.0),  # crossing
        (([0, 0, 0], [1, 0, 0], [3, 0, 0], [4, 0, 0]), 2.0),  # in one line
        (([0, 0, 0], [1, 0, 0], [0.5, 1, 0], [1.5, 1, 0]), 1.0),  # side by side
        (([0, 0, 0], [1, 0, 0], [4, 4, 0], [4, 9, 0]), 5.0),  # end to end
        (([0, 0, 0], [0, 0, 0], [0, 3, 0], [0, 3, 0]), 3.0),  # points
    ],
)
def test_gap_between_segments(points, gap):
    a, b, c, d = np.array(points, dtype=float)
    assert segment_gap(a, b, c, d) == pytest.approx(gap)
    assert segment_gap(d, c, b, a) == pytest.approx(gap)


def test_gap_between_random_segments_is_the_nearest_of_a_grid():
    rng = np.random.default_rng(7)
    a, b, c, d = rng.normal(size=(4, 300, 3))
    t = np.linspace(0.0, 1.0, 61)[:, None, None]
    p, q = a + t * (b - a), c + t * (d - c)
    nearest = np.linalg.norm(p[:, None] - q[None], axis=-1).min((0, 1))
    got = segment_gap(a, b, c, d)
    assert (got <= nearest + 1e-12).all()
    assert np.abs(got - nearest).max() < 0.02


def test_feet_of_the_standing_figure_are_as_far_apart_as_its_hips():
    figures = gaitsmith.measure(standing())
    assert figures["foot_gap_mm_min"] == pytest.approx(1e3 * body_from(1.75).hip_width)


def test_a_quarter_turn_to_the_left():
    motion = standing(600)
    heading = np.clip(np.linspace(-0.5, 1.5, 600), 0.0, 1.0) * np.pi / 2.0
    rotations = np.array(motion.rotations)
    rotations[:, 0] = about("y", heading)
    figures = gaitsmith.measure(motion.with_(rotations=rotations))
    assert figures["turned_deg"] == pytest.approx(90.0)
    assert figures["turning_deg"] == pytest.approx(90.0)


def test_averages_shrink_toward_the_ends():
    values = np.array([[0.0], [3.0], [0.0], [0.0], [6.0]])
    np.testing.assert_allclose(averaged(values, 1)[:, 0], [0.0, 1.0, 1.0, 2.0, 6.0])


# agreement with the walk that was generated -------------------------------------


def test_a_walk_that_says_what_it_is_is_measured_exactly(known):
    assert (known["contacts"], known["footsteps"]) == ("file", "file")
    for name, value in {
        "step_length_m": 0.6,
        "step_length_left_m": 0.6,
        "step_length_right_m": 0.6,
        "stride_length_m": 1.2,
        "cadence_spm": 100.0,
        "stride_time_s": 1.2,
        "speed_mps": 1.0,
        "distance_m": 8.0,
        "height_m": 1.75,
        "floor_m": 0.0,
    }.items():
        assert known[name] == pytest.approx(value, abs=1e-6), name
    assert known["slip_mm_max"] < 1e-6
    assert known["penetration_mm_max"] < 1e-6
    assert known["float_mm_max"] < 1e-6
    assert known["step_length_sd_m"] < 1e-6


def test_the_same_walk_is_found_in_its_bvh(known, found):
    assert (found["contacts"], found["footsteps"]) == ("estimated", "estimated")
    assert found["steps"] == known["steps"]
    assert found["step_length_m"] == pytest.approx(0.6, rel=0.02)
    assert found["step_length_mean_m"] == pytest.approx(0.6, rel=0.02)
    assert found["stride_length_m"] == pytest.approx(1.2, rel=0.02)
    assert found["cadence_spm"] == pytest.approx(100.0, rel=0.01)
    for name, atol in {
        "step_width_m": 0.01,
        "height_m": 0.03,
        "floor_m": 0.001,
        "toe_out_left_deg": 0.5,
        "toe_out_right_deg": 0.5,
        "stance_share": 0.02,
        "double_support_share": 0.04,
        "toe_clearance_mm_median": 1.0,
        "penetration_mm_max": 0.5,
        "slip_mm_median": 0.5,
        "float_mm_p95": 0.5,
        "knee_min_deg": 0.1,
        "bob_mm": 1.0,
        "sway_mm": 1.0,
        "arm_swing_left_deg": 0.1,
        "pelvis_list_deg": 0.1,
        "trunk_lean_deg": 0.1,
        "head_pitch_range_deg": 0.1,
        "distance_m": 1e-4,
        "joint_deg_per_60th_max": 0.01,
        "foot_gap_mm_min": 1.0,
    }.items():
        assert found[name] == pytest.approx(known[name], abs=atol), name


@pytest.mark.parametrize("distance", [6.0, 7.0])
def test_the_small_step_that_closes_to_standing_is_a_step(distance):
    """It is slow enough for a stance, but in the air."""
    motion = gaitsmith.walk(distance=distance, step_length=0.6, cadence=100.0, gait="neutral")
    known = gaitsmith.measure(motion)
    found = gaitsmith.measure(motion.with_(contacts=None, labels=None))
    assert found["steps"] == known["steps"]
    assert found["stances"] == known["stances"]
    assert found["slip_mm_max"] < 8.0


@pytest.mark.parametrize(
    ("fps", "asked"),
    [
        (30.0, {"step_length": 0.7, "cadence": 110.0, "step_width": 0.14, "gait": "winter"}),
        (120.0, {"step_length": 0.45, "cadence": 95.0, "body": 1.4, "gait": "winter"}),
        (60.0, {"step_length": 0.8, "cadence": 120.0, "toe_out": (0.2, 0.0), "body": 1.9}),
    ],
)
def test_knobs_are_found_in_the_bvh(fps, asked, tmp_path):
    motion = gaitsmith.walk(distance=7.0, fps=fps, **asked)
    figures = gaitsmith.measure(gaitsmith.save(motion, tmp_path / "walk.bvh"))
    exact = gaitsmith.measure(motion)
    assert figures["step_length_m"] == pytest.approx(asked["step_length"], rel=0.02)
    assert figures["cadence_spm"] == pytest.approx(asked["cadence"], rel=0.01)
    assert figures["step_width_m"] == pytest.approx(exact["step_width_m"], abs=0.01)
    if "step_width" in asked:
        assert exact["step_width_m"] == pytest.approx(asked["step_width"], abs=1e-6)
    if "toe_out" in asked:
        for name, angle in zip(SIDES, asked["toe_out"], strict=True):
            assert figures[f"toe_out_{name}_deg"] == pytest.approx(np.degrees(angle), abs=0.5)
    assert_honest(figures)
    assert_honest(exact)


def test_where_a_clip_is_and_where_it_heads_changes_nothing(walked, found):
    """Turned by 130 deg and moved: every figure but the floor and the quaternions' is the same."""
    bare = walked.with_(labels=None, contacts=None)
    spin = about("y", np.radians(130.0))
    rotations = np.array(bare.rotations)
    rotations[:, 0] = multiply(spin, rotations[:, 0])
    moved = bare.with_(
        root_position=rotate(spin, bare.root_position) + [5.0, 0.2, -3.0], rotations=rotations
    )
    one, other = numbers(gaitsmith.measure(bare)), numbers(gaitsmith.measure(moved))
    assert one.keys() == other.keys()
    for name in one.keys() - {"floor_m"}:
        assert other[name] == pytest.approx(one[name], rel=1e-6, abs=1e-6), name
    assert other["floor_m"] == pytest.approx(one["floor_m"] + 0.2)


def test_a_walk_on_a_treadmill_gets_its_steps_back(walked, tmp_path):
    steady = gaitsmith.walk(distance=8.0, step_length=0.6, cadence=100.0, start="walk", stop="walk")
    belt = np.array(steady.root_position)
    belt[:, 2] -= steady.times * 1.0
    path = gaitsmith.save(
        steady.with_(root_position=belt, labels=None, contacts=None), tmp_path / "belt.bvh"
    )
    figures = gaitsmith.measure(path)
    assert any("walks in place" in note for note in figures["notes"])
    assert figures["step_length_m"] == pytest.approx(0.6, rel=0.03)
    assert figures["cadence_spm"] == pytest.approx(100.0, rel=0.01)


# what cannot be had -------------------------------------------------------------


def without(motion, *parts):
    """``motion`` without joints whose names hold one of ``parts``, and without soles."""
    old = motion.skeleton
    keep = [j for j, name in enumerate(old.names) if not any(p in name for p in parts)]
    skeleton = Skeleton(
        tuple(old.names[j] for j in keep),
        tuple(-1 if old.parents[j] < 0 else keep.index(old.parents[j]) for j in keep),
        old.offsets[keep],
    )
    return Motion(
        skeleton=skeleton,
        root_position=motion.root_position,
        rotations=motion.rotations[:, keep],
        fps=motion.fps,
    )


def test_no_arms_no_toes_no_head(walked):
    figures = gaitsmith.measure(without(walked, "Arm", "Hand", "Shoulder", "Toes", "head", "neck"))
    assert figures["arm_swing_left_deg"] is None
    assert figures["head_pitch_range_deg"] is None
    assert {"leftHand", "rightToes", "head"} <= set(figures["roles_missing"])
    assert figures["step_length_m"] == pytest.approx(0.6, rel=0.02)
    assert_honest(figures)


def test_a_ground_that_is_not_known_is_not_guessed(walked):
    labels = replace(walked.labels, ground='{"kind": "lava"}')
    figures = gaitsmith.measure(walked.with_(labels=labels))
    assert figures["penetration_mm_max"] is None
    assert any("lava" in note for note in figures["notes"])
    assert figures["step_length_m"] == pytest.approx(0.6)
    assert_honest(figures)


@pytest.mark.parametrize("frames", [2, 3, 5, 30])
def test_short_clips_have_few_figures_but_honest_ones(walked, frames):
    cut = walked.with_(
        root_position=walked.root_position[200 : 200 + frames],
        rotations=walked.rotations[200 : 200 + frames],
        contacts=None,
        labels=None,
    )
    assert_honest(gaitsmith.measure(cut))


def test_a_short_walk_with_labels():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        motion = gaitsmith.walk(distance=0.4, fps=30)
    assert_honest(gaitsmith.measure(motion))


def test_who_is_no_person_is_refused():
    skeleton = Skeleton(("root", "tail"), (-1, 0), np.array([[0, 1, 0], [0, 0, -1.0]]))
    rotations = np.zeros((5, 2, 4))
    rotations[..., 3] = 1.0
    motion = Motion(skeleton=skeleton, root_position=np.zeros((5, 3)), rotations=rotations, fps=30)
    with pytest.raises(InfeasibleError, match="no joint is recogni"):
        gaitsmith.measure(motion)


def test_one_frame_is_no_motion(walked):
    with pytest.raises(InfeasibleError, match="needs two"):
        gaitsmith.measure(
            walked.with_(
                root_position=walked.root_position[:1],
                rotations=walked.rotations[:1],
                contacts=None,
                labels=None,
            )
        )


def test_files_that_are_none(tmp_path):
    with pytest.raises(UnknownFormatError, match="measure"):
        gaitsmith.measure(tmp_path / "markers.trc")
    with pytest.raises(UnknownFormatError):
        gaitsmith.measure(tmp_path / "walk.fbx")
    bad = tmp_path / "bad.bvh"
    bad.write_text("HIERARCHY nonsense")
    with pytest.raises(FileFormatError):
        gaitsmith.measure(bad)
    with pytest.raises(FileNotFoundError):
        gaitsmith.measure(tmp_path / "none.npz")


# measured people ----------------------------------------------------------------


def measured(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)  # units that were guessed
        return gaitsmith.measure(path)


@pytest.mark.slow
def test_every_measured_clip_gives_finite_numbers(measured_data):
    clips = sorted([*measured_data.rglob("*.bvh"), *measured_data.rglob("*.amc")])
    assert clips
    for path in clips:
        figures = measured(path)
        assert_honest(figures)
        assert 1.4 < figures["height_m"] < 1.95, path.name
        assert figures["slip_mm_max"] < 250.0, path.name


@pytest.mark.parametrize("name", ["Male2_B3_Walk.bvh", "cmu_12_01_walk.bvh", "02_01.amc"])
def test_people_who_walk_are_within_wide_bands(measured_data, name):
    figures = measured(next(measured_data.rglob(name)))
    for key, (low, high) in {
        "speed_mps": (0.7, 1.9),
        "cadence_spm": (80, 135),
        "step_length_m": (0.45, 0.95),
        "step_width_m": (0.0, 0.25),
        "stance_share": (0.54, 0.70),
        "double_support_share": (0.08, 0.36),
        "slip_mm_median": (0.5, 25.0),
        "toe_excursion_mm_median": (3.0, 30.0),
        "toe_clearance_mm_median": (3.0, 40.0),
        "bob_mm": (10.0, 90.0),
        "sway_mm": (15.0, 100.0),
        "pelvis_list_deg": (2.0, 18.0),
        "arm_against_leg": (-1.0, -0.5),
        "gmd_skating_ratio_toe_floor": (0.0, 0.6),
    }.items():
        assert low <= figures[key] <= high, key


def test_a_person_who_walks_backward_has_steps_below_zero(measured_data):
    figures = measured(next(measured_data.rglob("Male2_B5_WalkBackwards.bvh")))
    assert -0.85 < figures["step_length_m"] < -0.6
    assert figures["speed_mps"] < 0.0


@pytest.mark.parametrize(
    ("name", "turned_deg"),
    [("Male2_B10_WalkTurnLeft45.bvh", 45.0), ("Male2_B9_WalkTurnLeft90.bvh", 90.0)],
)
def test_turns_are_told_by_their_names(measured_data, name, turned_deg):
    assert measured(next(measured_data.rglob(name)))["turned_deg"] == pytest.approx(
        turned_deg, abs=10.0
    )
