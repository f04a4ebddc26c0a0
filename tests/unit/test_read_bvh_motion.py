"""What a BVH means: rotations, positions, units, up, frame rate; measured clips."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest
from test_read_bvh import BASE, HEADER, QUIRKS, SPINE, VALUES, swap

from gaitsmith import io
from gaitsmith.errors import FileFormatError, GaitsmithWarning, InvalidInputError
from gaitsmith.geometry.rotations import about, from_euler, multiply
from gaitsmith.io.bvh_file import BvhFile
from gaitsmith.io.bvh_motion import read_bvh
from gaitsmith.io.bvh_parse import read_bvh_file
from gaitsmith.io.bvh_print import write_bvh_file
from gaitsmith.io.units import UNITS, frame_rate
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.roles import humanoid_roles


def motion(text: str, tmp_path, **options) -> io.Motion:
    (tmp_path / "m.bvh").write_text(text)
    return read_bvh(tmp_path / "m.bvh", **{"unit": "cm", **options})


def test_a_motion_has_meters_quaternions_and_the_file_s_names(tmp_path):
    got = motion(BASE, tmp_path)
    assert got.skeleton.names == ("Hips", "Spine", "LeftLeg")
    assert got.skeleton.parents == (-1, 0, 0)
    assert got.fps == 30.0
    assert got.translations is None
    assert got.contacts is None
    np.testing.assert_allclose(got.skeleton.offsets[1], [0.0, 0.105, 0.0025])
    np.testing.assert_allclose(got.skeleton.ends[1:], [[0.0, 0.2, 0.0], [0.0, -0.4, 0.01]])
    np.testing.assert_allclose(got.root_position, 0.01 * VALUES[:, :3])
    want = from_euler("zxy", np.radians(VALUES[:, 3:].reshape(3, 3, 3)))
    np.testing.assert_allclose(np.abs(np.sum(got.rotations * want, axis=-1)), 1.0, atol=1e-12)


def test_rotations_follow_the_order_of_the_channels(tmp_path):
    text = swap(
        (SPINE, SPINE.replace("Zrotation Xrotation Yrotation", "Yrotation Zrotation Xrotation"))
    )
    got = motion(text, tmp_path)
    y, z, x = np.radians(VALUES[:, 6:9]).T
    want = multiply(multiply(about("y", y), about("z", z)), about("x", x))
    np.testing.assert_allclose(np.abs(np.sum(got.rotations[:, 1] * want, axis=-1)), 1.0, atol=1e-12)
    one = motion(QUIRKS["joint of one channel"][0], tmp_path)
    want = about("x", np.radians(VALUES[:, 6]))
    np.testing.assert_allclose(np.abs(np.sum(one.rotations[:, 1] * want, axis=-1)), 1.0, atol=1e-12)


def test_positions_replace_the_offset_also_of_the_root(tmp_path):
    """The root's OFFSET is not added: ACCAD's files would stand at twice their height."""
    text = swap(("OFFSET 0.0 0.0 0.0\n  CHANNELS", "OFFSET -176.0 94.5 3.0\n  CHANNELS"))
    np.testing.assert_allclose(motion(text, tmp_path).root_position, 0.01 * VALUES[:, :3])
    moved = motion(QUIRKS["positions elsewhere"][0], tmp_path)
    np.testing.assert_allclose(moved.translations[:, 1], 0.01 * VALUES[:, 6:9])
    np.testing.assert_allclose(moved.translations[:, 2], [[0.09, -0.03, 0.0]] * 3)
    part = swap(
        ("6 Xposition Yposition Zposition Z", "4 Yposition Z"),
        ("OFFSET 0.0 0.0 0.0\n  CHANNELS", "OFFSET 1.0 2.0 3.0\n  CHANNELS"),
    )
    part = part.split("MOTION")[0] + "MOTION\nFrames: 1\nFrame Time: .1\n" + "7 " * 10
    np.testing.assert_allclose(motion(part, tmp_path).root_position, [[0.01, 0.07, 0.03]])


def six_channels(frames: np.ndarray) -> str:
    header = HEADER.split("MOTION")[0].replace(
        "CHANNELS 3 Z", "CHANNELS 6 Xposition Yposition Zposition Z"
    )
    rows = "\n".join(" ".join(map(repr, row)) for row in frames.tolist())
    return f"{header}MOTION\nFrames: {len(frames)}\nFrame Time: .01\n{rows}\n"


def test_positions_that_never_change_are_offsets(tmp_path):
    frames = np.zeros((4, 18))
    frames[:, 6:9], frames[:, 12:15] = [0.0, 11.0, 0.0], [9.0, -3.0, 0.0]
    still = motion(six_channels(frames), tmp_path)
    assert still.translations is None
    np.testing.assert_allclose(still.skeleton.offsets[1:], [[0, 0.11, 0], [0.09, -0.03, 0]])


def test_positions_of_zero_are_displacements(tmp_path):
    frames = np.zeros((4, 18))
    with pytest.warns(GaitsmithWarning, match="displacements"):
        got = motion(six_channels(frames), tmp_path)
    assert got.translations is None
    np.testing.assert_allclose(got.skeleton.offsets[1], [0.0, 0.105, 0.0025])


def test_names_become_different(tmp_path):
    text = swap(("JOINT Spine", "JOINT a"), ("JOINT LeftLeg", "JOINT a"))
    with pytest.warns(GaitsmithWarning, match="'a'"):
        assert motion(text, tmp_path).skeleton.names == ("Hips", "a", "a_2")


def test_two_figures_are_refused(tmp_path):
    body = BASE.split("MOTION")
    text = body[0] + body[0].replace("HIERARCHY\n", "") + "MOTION\nFrames: 0\nFrame Time: .1\n"
    (tmp_path / "two.bvh").write_text(text)
    with (
        pytest.warns(GaitsmithWarning, match="more than one joint"),
        pytest.raises(FileFormatError, match="2 ROOTs"),
    ):
        read_bvh(tmp_path / "two.bvh")


def test_no_frame_is_a_motion_of_no_frame(tmp_path):
    assert len(motion(QUIRKS["no frame"][0], tmp_path)) == 0


def person(factor: float, *, z_up: bool = False) -> str:
    """A standing person of 1.7 m, ``factor`` units a meter."""
    joints = [("Hips", -1, (0, 0.9, 0)), ("Spine", 0, (0, 0.2, 0)), ("Head", 1, (0, 0.5, 0))]
    for side, x in (("Left", 0.1), ("Right", -0.1)):
        n = len(joints)
        joints += [(f"{side}UpLeg", 0, (x, -0.05, 0)), (f"{side}Leg", n, (0, -0.4, 0)),
                   (f"{side}Foot", n + 1, (0, -0.4, 0))]  # fmt: skip
    turn = (lambda v: (v[0], -v[2], v[1])) if z_up else (lambda v: v)
    offsets = factor * np.array([turn(o) for _, _, o in joints])
    rotation = ("Zrotation", "Xrotation", "Yrotation")
    root = ("Xposition", "Yposition", "Zposition")
    values = np.zeros((3, 6 + 3 * (len(joints) - 1)))
    values[:, :3] = offsets[0]
    file = BvhFile(
        tuple(j[0] for j in joints), tuple(j[1] for j in joints), offsets,
        (root + rotation, *[rotation] * (len(joints) - 1)), (), 0.01, values)  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        write_bvh_file(file, Path(folder) / "p.bvh")
        return (Path(folder) / "p.bvh").read_text()


@pytest.mark.parametrize("unit", UNITS)
def test_the_unit_is_that_of_a_person(unit, tmp_path):
    text = person(1.0 / UNITS[unit])
    if unit == "cm":
        got = motion(text, tmp_path, unit=None)
    else:
        with pytest.warns(GaitsmithWarning, match="no unit is given; taken as"):
            got = motion(text, tmp_path, unit=None)
    np.testing.assert_allclose(got.root_position[0], [0.0, 0.9, 0.0], atol=1e-9)
    said = motion(text, tmp_path, unit=unit)
    np.testing.assert_allclose(said.root_position[0], [0.0, 0.9, 0.0], atol=1e-9)


def test_a_unit_that_makes_no_person_is_centimeters_and_said(tmp_path):
    with pytest.warns(GaitsmithWarning, match="a person's in no unit; taken as centimeters"):
        motion(person(1e6), tmp_path, unit=None)
    with pytest.raises(InvalidInputError, match="unit must be one of"):
        motion(BASE, tmp_path, unit="furlong")


def test_a_person_who_stands_on_z_is_turned_up(tmp_path):
    with pytest.warns(GaitsmithWarning, match="stands along \\+Z"):
        got = motion(person(100.0, z_up=True), tmp_path, unit=None)
    want = motion(person(100.0), tmp_path, unit=None)
    np.testing.assert_allclose(joint_positions(got), joint_positions(want), atol=1e-6)


@pytest.mark.parametrize(("text", "rate"), [
    ("0.0333333", 30.0), (".0083333", 120.0), ("0.00833333", 120.0), ("0.0416667", 24.0),
    ("0.04", 25.0), ("0.016667", 60.0), ("0.0333667", 30000 / 1001), ("0.01", 100.0),
    ("0.0055556", 180.0), ("0.0123", 1 / 0.0123), ("0.2", 5.0), ("0.03", 1 / 0.03),
])  # fmt: skip
def test_a_frame_time_means_the_rate_that_rounds_to_it(text, rate):
    assert frame_rate(float(text)) == pytest.approx(rate, rel=1e-12)


# ------------------------------------------------------------------------------- measured clips
def clips(folder):
    found = sorted(folder.rglob("*.bvh"))
    assert found
    return found


def quietly(read, *args):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        return read(*args)


def test_measured_clips_come_back_to_the_last_bit(measured_data, tmp_path):
    for clip in clips(measured_data):
        file = read_bvh_file(clip)
        numbers = np.array(clip.read_text().split("Frame Time:")[1].split()[1:], dtype=float)
        np.testing.assert_array_equal(file.values.ravel(), numbers, err_msg=clip.name)
        write_bvh_file(file, tmp_path / "out.bvh")
        back = read_bvh_file(tmp_path / "out.bvh")
        np.testing.assert_array_equal(back.values, file.values)
        np.testing.assert_array_equal(back.offsets, file.offsets)
        assert (back.names, back.parents, back.channels, back.ends, back.frame_time) == (
            *(file.names, file.parents, file.channels, file.ends, file.frame_time),
        )


def test_measured_people_are_of_human_size_and_stand_on_the_floor(measured_data):
    """Doubled root offsets, wrong units and wrong orders all break one of these."""
    for clip in clips(measured_data):
        got = quietly(read_bvh, clip)
        roles = humanoid_roles(got.skeleton.names, got.skeleton.parents).joints
        where = joint_positions(got)
        feet = [roles[f"{side}{part}"] for side in ("left", "right") for part in ("Foot", "Toes")]
        lowest = where[:, feet, 1].min(axis=1)
        head, hips = where[:, roles["head"], 1], where[:, roles["hips"], 1]
        assert 0.8 < np.median(hips) < 1.05, clip.name
        assert 1.2 < np.median(head) < 1.8, clip.name
        assert -0.02 < np.quantile(lowest, 0.1) < 0.08, clip.name
        assert np.quantile(lowest, 0.9) - np.quantile(lowest, 0.1) < 0.12, clip.name
        speed = np.linalg.norm(np.diff(where[:, roles["hips"]], axis=0), axis=-1) * got.fps
        assert 0.0 <= np.median(speed) < 2.0, clip.name
        assert got.fps in (30.0, 120.0)


def test_only_clips_that_move_their_joints_have_translations(measured_data):
    for clip in clips(measured_data):
        got = quietly(read_bvh, clip)
        assert (got.translations is not None) == (got.skeleton.names[0] == "joint_Root"), clip.name


def test_the_data_base_of_cmu_counts_in_its_own_inches(measured_data):
    with pytest.warns(GaitsmithWarning, match="unit of 1/0.45 inch"):
        got = read_bvh(measured_data / "permissive" / "cmu" / "cmu_12_01_walk.bvh")
    roles = humanoid_roles(got.skeleton.names, got.skeleton.parents).joints
    bones = np.linalg.norm(got.skeleton.offsets, axis=-1)
    leg = bones[roles["leftLowerLeg"]] + bones[roles["leftFoot"]]
    assert 0.75 < leg < 0.85
    speed = np.linalg.norm(np.diff(got.root_position[100:, [0, 2]], axis=0), axis=-1) * got.fps
    assert 0.7 < np.median(speed) < 1.5


def test_load_reads_them_by_suffix(tmp_path):
    (tmp_path / "a.BVH").write_text(person(100.0))
    assert len(io.load(tmp_path / "a.BVH")) == 3
