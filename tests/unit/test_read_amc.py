"""Acclaim's skeletons and motions."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from gaitsmith import io
from gaitsmith.errors import FileFormatError, GaitsmithWarning
from gaitsmith.geometry.rotations import about, inverse, multiply
from gaitsmith.io.amc import read_amc
from gaitsmith.io.asf import read_asf
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.roles import humanoid_roles

ASF = """# made by hand
:version 1.10
:units
  mass 1.0
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name lfemur
    direction 0 -1 0
    length 7.5
    axis 0 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-60.0 70.0)
  end
  begin
    id 2
    name ltibia
    direction 0 -1 0
    length 7
    axis 0 30 20 XYZ
    dof rx
  end
  begin
    id 3
    name lfoot
    direction 0 0 1
    length 2
    axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root lfemur
    lfemur ltibia
    ltibia lfoot
  end
"""
AMC = """#!OML:ASF
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
lfemur -20 5 7
ltibia 40
2
root 1.5 2 3 11 20 30
ltibia 41
lfemur -21 5 7
"""
FACTOR = 0.0254 / 0.45


def written(tmp_path, asf: str = ASF, amc: str = AMC):
    (tmp_path / "02.asf").write_text(asf)
    (tmp_path / "02_01.amc").write_text(amc)
    return tmp_path / "02_01.amc"


def euler(x: float, y: float, z: float) -> np.ndarray:
    """Matrix Rz Ry Rx."""
    turn = multiply(about("y", np.radians(y)), about("x", np.radians(x)))
    return multiply(about("z", np.radians(z)), turn)


def test_bones_turn_about_their_own_axes(tmp_path):
    got = read_amc(written(tmp_path), fps=60.0)
    assert got.fps == 60.0
    assert got.skeleton.names == ("root", "lfemur", "ltibia", "lfoot")
    assert got.skeleton.parents == (-1, 0, 1, 2)
    np.testing.assert_allclose(
        got.skeleton.offsets, FACTOR * np.array([[0, 0, 0], [0, 0, 0], [0, -7.5, 0], [0, -7, 0]])
    )
    np.testing.assert_allclose(got.skeleton.ends[3], [0.0, 0.0, 2 * FACTOR])
    assert not got.skeleton.ends[:3].any()
    np.testing.assert_allclose(got.root_position[1], FACTOR * np.array([1.5, 2, 3]))
    thigh, shin = euler(0, 0, 20), euler(0, 30, 20)
    want = [
        euler(11, 20, 30),
        multiply(multiply(thigh, euler(-21, 5, 7)), inverse(thigh)),
        multiply(multiply(shin, euler(41, 0, 0)), inverse(shin)),
        [0.0, 0.0, 0.0, 1.0],
    ]
    np.testing.assert_allclose(np.abs(np.sum(got.rotations[1] * want, axis=-1)), 1.0, atol=1e-12)


def test_the_rate_is_not_in_the_file_and_said(tmp_path):
    with pytest.warns(GaitsmithWarning, match="names no frame rate; 120"):
        assert io.load(written(tmp_path)).fps == 120.0


def test_radians_are_radians(tmp_path):
    amc = AMC.replace(":DEGREES", ":RADIANS").replace("ltibia 40", "ltibia 0.5")
    got = read_amc(written(tmp_path, amc=amc), fps=60.0)
    shin = euler(0, 30, 20)
    want = multiply(multiply(shin, about("x", 0.5)), inverse(shin))
    assert abs(np.dot(got.rotations[0, 2], want)) == pytest.approx(1.0)


def test_a_skeleton_is_found_beside_or_named(tmp_path):
    path = written(tmp_path)
    (tmp_path / "02.asf").rename(tmp_path / "other.asf")
    assert len(read_amc(path, fps=60.0)) == 2  # the only one in the folder
    (tmp_path / "third.asf").write_text(ASF)
    with pytest.raises(FileFormatError, match=r"there is no 02\.asf beside it"):
        read_amc(path, fps=60.0)
    assert len(read_amc(path, tmp_path / "third.asf", fps=60.0)) == 2
    with pytest.raises(FileNotFoundError):
        read_amc(tmp_path / "missing.amc")


@pytest.mark.parametrize(("old", "new", "cause"), [
    ("1\nroot", "root", "outside of the frames"),
    ("lfemur -20 5 7", "lfemur -20 5", "has 3 values, here are 2"),
    ("lfemur -20 5 7", "nobody 1", "no bone of its skeleton"),
    ("ltibia 40", "lfemur 1 2 3", "twice"),
    ("ltibia 40\n", "", "frame 1 has no values of 'ltibia'"),
    ("ltibia 41\n", "", "frame 2 has no values of 'ltibia'"),
    ("ltibia 40", "ltibia x", "got 'x'"),
    ("ltibia 40", "ltibia nan", "finite"),
    (AMC, ":DEGREES\n", "no frames"),
    ("root 1 2 3", "root 1e30 2 3", "no figure"),
])  # fmt: skip
def test_a_broken_motion_is_refused(old, new, cause, tmp_path):
    with pytest.raises(FileFormatError, match=r"02_01\.amc:\d+: ") as error:
        read_amc(written(tmp_path, amc=AMC.replace(old, new)), fps=60.0)
    assert cause in str(error.value)


@pytest.mark.parametrize(("old", "new", "cause"), [
    (ASF, "hello", "no :root"),
    ("length 0.45", "length -1", "positive"),
    ("length 7.5", "length x", "got 'x'"),
    ("direction 0 0 1\n", "", "needs a direction"),
    ("name lfoot", "name ltibia", "twice"),
    ("dof rx\n", "dof tx\n", "other degrees of freedom"),
    ("axis 0 30 20 XYZ", "axis 0 30 20 XXZ", "three axes"),
    ("ltibia lfoot", "ltibia nobody", "which is no bone"),
    ("ltibia lfoot", "ltibia lfemur", "stands twice"),
    ("    ltibia lfoot\n", "", "hangs on nothing"),
    ("order TX", "order TW", "other words"),
])  # fmt: skip
def test_a_broken_skeleton_is_refused(old, new, cause, tmp_path):
    assert old in ASF
    with pytest.raises(FileFormatError, match=r"02\.asf:\d+: ") as error:
        read_amc(written(tmp_path, asf=ASF.replace(old, new)), fps=60.0)
    assert cause in str(error.value)


def test_bones_that_nothing_turns_do_not_fill_the_memory(tmp_path):
    bones = "".join(
        f"begin\nname b{i}\ndirection 0 1 0\nlength 1\naxis 0 0 0 XYZ\nend\n" for i in range(2000)
    )
    asf = f":root\norder RX\naxis XYZ\n:bonedata\n{bones}:hierarchy\nbegin\n" + "".join(
        f"root b{i}\n" for i in range(2000)
    )
    amc = "".join(f"{i}\nroot 0\n" for i in range(10_000))
    with pytest.raises(FileFormatError, match="are no figure"):
        read_amc(written(tmp_path, asf, amc), fps=60.0)


def test_measured_people_walk_on_the_floor(measured_data):
    folder = measured_data / "permissive" / "cmu"
    assert read_asf(folder / "02.asf").unit_length == 0.45
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GaitsmithWarning)
        got = io.load(folder / "02_01.amc")
        uneven = io.load(folder / "03_01.amc")
    for motion in (got, uneven):
        roles = humanoid_roles(motion.skeleton.names, motion.skeleton.parents).joints
        bones = np.linalg.norm(motion.skeleton.offsets, axis=-1)
        assert 0.75 < bones[roles["leftLowerLeg"]] + bones[roles["leftFoot"]] < 0.95
    roles = humanoid_roles(got.skeleton.names, got.skeleton.parents).joints
    where = joint_positions(got)
    feet = [roles[f"{side}{part}"] for side in ("left", "right") for part in ("Foot", "Toes")]
    lowest = where[:, feet, 1].min(axis=1)
    assert lowest.min() > -0.02
    assert lowest.max() < 0.09
    assert 0.9 < np.median(where[:, 0, 1]) < 1.05
    way = np.linalg.norm(where[-1, 0, [0, 2]] - where[0, 0, [0, 2]])
    assert 1.0 < way / got.duration < 1.6
