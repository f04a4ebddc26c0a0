"""The BVH writer: every line of the strict dialect, and positions through another reader."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import exp
from gaitsmith.io._text import BLOCK, number_rows
from gaitsmith.io.bvh import MIXAMO_NAMES, bvh_names, write_bvh
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.motion.motion import Motion
from gaitsmith.motion.skeleton import HUMANOID, Skeleton

SEEDS = st.integers(0, 2**32 - 1)
fast = settings(max_examples=30, deadline=None)


# ------------------------------------------------------------------------------- an own reader
def axis_matrix(axis: str, degrees: np.ndarray) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"X": (1, 2), "Y": (2, 0), "Z": (0, 1)}[axis]
    m = np.zeros((len(degrees), 3, 3)) + np.eye(3)
    m[:, i, i], m[:, i, j], m[:, j, i], m[:, j, j] = c, -s, s, c
    return m


class Bvh:
    """What a plain reader understands of a file: words, channels, matrices."""

    def __init__(self, text: str) -> None:
        self.names, self.parents, self.offsets, self.channels = [], [], [], []
        self.tips: dict[str, np.ndarray] = {}
        words, stack, ends, i = text.split(), [], False, 1
        assert words[0] == "HIERARCHY"
        while words[i] != "MOTION":
            word, i = words[i], i + 1
            if word in ("ROOT", "JOINT"):
                self.names.append(words[i])
                self.parents.append(stack[-1] if stack else -1)
                stack.append(len(self.names) - 1)
                i += 1
            elif word == "End":
                assert words[i] == "Site"
                ends, i = True, i + 1
            elif word == "OFFSET":
                vector, i = np.array(words[i : i + 3], dtype=float), i + 3
                if ends:
                    self.tips[self.names[stack[-1]]] = vector
                else:
                    self.offsets.append(vector)
            elif word == "CHANNELS":
                count = int(words[i])
                self.channels.append(words[i + 1 : i + 1 + count])
                i += 1 + count
            elif word == "}":
                if ends:
                    ends = False
                else:
                    stack.pop()
            else:
                assert word == "{", word
        assert words[i + 1] == "Frames:"
        assert words[i + 3 : i + 5] == ["Frame", "Time:"]
        self.frame_time = float(words[i + 5])
        self.values = np.array(words[i + 6 :], dtype=float).reshape(int(words[i + 2]), -1)

    def positions(self) -> np.ndarray:
        """World positions (F, J, 3), meters."""
        frames, column = len(self.values), 0
        where, turned = [], []
        for joint, channels in enumerate(self.channels):
            local, matrix = np.tile(self.offsets[joint], (frames, 1)), np.eye(3)
            for channel in channels:
                value, axis = self.values[:, column], channel[0]
                if channel.endswith("position"):
                    local[:, "XYZ".index(axis)] = value
                else:
                    matrix = matrix @ axis_matrix(axis, value)
                column += 1
            parent = self.parents[joint]
            if parent < 0:
                where.append(local)
                turned.append(matrix)
            else:
                moved = turned[parent] @ local[..., None]
                where.append(where[parent] + moved[..., 0])
                turned.append(turned[parent] @ matrix)
        assert column == self.values.shape[1]
        return 0.01 * np.stack(where, axis=1)


# ------------------------------------------------------------------------------------- motions
def random_tree(seed: int, joints: int) -> Skeleton:
    rng = np.random.default_rng(seed)
    parents = [-1, *(int(rng.integers(0, joint)) for joint in range(1, joints))]
    names = [f"joint{i}" for i in range(joints)]
    return Skeleton(tuple(names), tuple(parents), rng.normal(0.0, 0.3, size=(joints, 3)))


def humanoid(*, toes: bool = True) -> Skeleton:
    rng = np.random.default_rng(0)
    pairs = [(n, p) for n, p in HUMANOID if toes or not n.endswith("Toes")]
    names = [name for name, _ in pairs]
    parents = tuple(-1 if parent is None else names.index(parent) for _, parent in pairs)
    offsets = rng.normal(0.0, 0.05, (len(names), 3)) + [0.0, 0.1, 0.0]
    return Skeleton(tuple(names), parents, offsets, rng.normal(0.0, 0.1, (2, 3, 3)))


def turning_motion(
    skeleton: Skeleton, seed: int = 0, frames: int = 40, fps: float = 60.0, **fields: object
) -> Motion:
    """Joints that turn smoothly all the way round, of a figure that walks about."""
    rng = np.random.default_rng(seed)
    turns = np.cumsum(rng.uniform(-0.1, 0.15, (frames, len(skeleton), 3)), axis=0)
    root = np.cumsum(rng.uniform(-0.02, 0.04, (frames, 3)), axis=0)
    return Motion(skeleton, root, exp(turns), fps, **fields)


def written(motion: Motion, folder) -> str:
    path = folder / "out.bvh"
    write_bvh(motion, path)
    return path.read_bytes().decode("utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("bvh")


# --------------------------------------------------------------------------------------- tests
@fast
@given(seed=SEEDS, joints=st.integers(1, 15), frames=st.integers(1, 60))
def test_another_reader_finds_every_joint_where_it_is(folder, seed, joints, frames):
    motion = turning_motion(random_tree(seed, joints), seed, frames)
    bvh = Bvh(written(motion, folder))

    order = [motion.skeleton.index(name) for name in bvh.names]
    assert sorted(order) == list(range(joints))
    np.testing.assert_allclose(bvh.positions(), joint_positions(motion)[:, order], atol=1e-6)


@fast
@given(seed=SEEDS)
def test_joints_that_stretch_have_positions_and_others_have_not(folder, seed):
    rng = np.random.default_rng(seed)
    skeleton = random_tree(seed, 8)
    stretching = rng.random(8) < 0.5
    moved = np.broadcast_to(skeleton.offsets, (20, 8, 3)).copy()
    moved[:, stretching] += rng.normal(0.0, 0.05, (20, stretching.sum(), 3))
    motion = turning_motion(skeleton, seed, 20, translations=moved)
    bvh = Bvh(written(motion, folder))

    order = [skeleton.index(name) for name in bvh.names]
    np.testing.assert_allclose(bvh.positions(), joint_positions(motion)[:, order], atol=1e-6)
    for joint, channels in zip(order, bvh.channels, strict=True):
        assert len(channels) == (6 if stretching[joint] or joint == 0 else 3)


def test_every_line_is_of_the_strict_dialect(folder):
    """Blender's reader: braces alone, one frame a line, no BOM, a Frame Time, 0 or 3 angles."""
    motion = turning_motion(humanoid(), frames=300)
    text = written(motion, folder)
    assert text.isascii()
    assert "\r" not in text
    assert text.endswith("\n")
    head, numbers = text.split("MOTION\n")
    number = r"-?\d+\.\d{6}"
    allowed = re.compile(
        rf"HIERARCHY|\t*(ROOT|JOINT) \w+|\t*[{{}}]|\t*End Site|\t*OFFSET {number} {number} {number}"
        r"|\t*CHANNELS (6 Xposition Yposition Zposition|3) Zrotation Xrotation Yrotation"
    )
    for line in head.splitlines():
        assert allowed.fullmatch(line), line
    assert head.count("{") == head.count("}") == len(motion.skeleton) + 5  # five End Sites
    assert head.splitlines()[1:5] == [
        "ROOT Hips",
        "{",
        "\tOFFSET 0.000000 0.000000 0.000000",
        "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation",
    ]

    frames, time, *rows = numbers.splitlines()
    assert frames == "Frames: 300"
    assert time == "Frame Time: 0.0166666667"
    assert len(rows) == 300
    one_row = re.compile(rf"{number}( {number}){{{3 * len(motion.skeleton) + 2}}}")
    for row in rows:
        assert one_row.fullmatch(row), row
        assert "-0.000000" not in row.split()


def test_angles_are_continuous_however_far_joints_turn(folder):
    motion = turning_motion(humanoid(), frames=400)
    values = Bvh(written(motion, folder)).values
    assert np.abs(values[:, 3:]).max() > 360.0  # they did go round
    assert np.percentile(np.abs(np.diff(values[:, 3:], axis=0)), 99.5) < 60.0
    assert np.abs(np.diff(values[:, 3:], axis=0)).max() < 190.0  # beside gimbal lock


@pytest.mark.parametrize("fps", [23.976, 24.0, 30.0, 59.94, 60.0, 120.0, 1000.0, 0.001])
def test_frame_time_has_digits_enough(folder, fps):
    bvh = Bvh(written(turning_motion(random_tree(0, 2), fps=fps), folder))
    assert bvh.frame_time == pytest.approx(1.0 / fps, rel=1e-6, abs=1e-10)


def test_vrm_bones_get_mixamo_names(folder):
    bvh = Bvh(written(turning_motion(humanoid()), folder))
    assert bvh.names == [
        *("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"),
        *(f"{s}{n}" for s in ("Left", "Right") for n in ("Shoulder", "Arm", "ForeArm", "Hand")),
        *(f"{s}{n}" for s in ("Left", "Right") for n in ("UpLeg", "Leg", "Foot", "ToeBase")),
    ]
    assert len(set(MIXAMO_NAMES.values())) == len(MIXAMO_NAMES) == len(HUMANOID)


def test_other_names_stay_one_word_each_and_all_different():
    names = ("hips", "Hips", "tail tip", "tail_tip", "mixamorig:Spine", "a{b}", "", " \t", "été")
    skeleton = Skeleton(names, (-1, *[0] * 8), np.zeros((9, 3)))
    assert bvh_names(skeleton) == (
        *("Hips", "Hips_2", "tail_tip", "tail_tip_2", "mixamorig:Spine", "a_b_", "joint", "_"),
        "été",
    )


@pytest.mark.parametrize("toes", [True, False])
def test_feet_end_at_the_toe_tip_and_no_end_site_is_short(folder, toes):
    skeleton = humanoid(toes=toes)
    bvh = Bvh(written(turning_motion(skeleton), folder))
    part = "ToeBase" if toes else "Foot"
    assert set(bvh.tips) == {"Head", "LeftHand", "RightHand", f"Left{part}", f"Right{part}"}
    for side, name in enumerate(("Left", "Right")):
        np.testing.assert_allclose(
            bvh.tips[name + part], 100.0 * skeleton.soles[side, 2], atol=1e-6
        )
        wrist = skeleton.offsets[skeleton.index(f"{name.lower()}Hand")]
        np.testing.assert_allclose(bvh.tips[name + "Hand"], 74.0 * wrist, atol=1e-6)
    assert bvh.tips["Head"][1] > 5.0


@fast
@given(seed=SEEDS, joints=st.integers(1, 10), size=st.sampled_from([0.0, 1e-6, 0.3]))
def test_every_leaf_has_an_end_site_of_a_centimeter_at_least(folder, seed, joints, size):
    tree = random_tree(seed, joints)
    tree = Skeleton(tree.names, tree.parents, size * tree.offsets)
    bvh = Bvh(written(turning_motion(tree, frames=1), folder))
    leaves = set(range(joints)) - set(tree.parents)
    assert set(bvh.tips) == {tree.names[leaf] for leaf in leaves}
    assert min(np.linalg.norm(tip) for tip in bvh.tips.values()) >= 1.0 - 1e-6


def test_a_chain_of_a_thousand_joints_is_written(folder):
    chain = Skeleton(
        tuple(f"j{i}" for i in range(1000)), tuple(range(-1, 999)), np.full((1000, 3), 0.001)
    )
    assert len(Bvh(written(turning_motion(chain, frames=1), folder)).names) == 1000


@pytest.mark.parametrize("fps", [1e-4, 2e6])
def test_what_the_dialect_cannot_hold_is_refused(folder, fps):
    tree = random_tree(0, 2)
    with pytest.raises(InvalidInputError, match="frames per second"):
        write_bvh(turning_motion(tree, fps=fps), folder / "no.bvh")
    with pytest.raises(InvalidInputError, match="at least one frame"):
        write_bvh(turning_motion(tree, frames=0), folder / "no.bvh")


# --------------------------------------------------------------------------------- number rows
@settings(max_examples=100, deadline=None)
@given(
    st.lists(
        st.one_of(
            st.floats(-1e9, 1e9), st.floats(-1e-5, 1e-5), st.integers(-(10**6), 10**6).map(float)
        ),
        min_size=1,
        max_size=30,
    ),
    st.integers(1, 6),
)
def test_numbers_are_printed_as_python_prints_them(values, decimals):
    out = b"".join(number_rows(np.array([values]), decimals=decimals)).decode("ascii")
    assert out.endswith("\n")
    for word, value in zip(out.split(), values, strict=True):
        assert re.fullmatch(rf"-?(0|[1-9]\d*)\.\d{{{decimals}}}", word)
        assert not re.fullmatch(r"-0\.0*", word)
        # ties of the last digit may fall to either side
        assert abs(float(word) - value) <= 0.5 * 10.0**-decimals + 1e-15 * abs(value) + 1e-18


def test_rows_of_many_blocks_and_whole_columns():
    values = np.random.default_rng(0).uniform(-500.0, 500.0, (2 * BLOCK // 3 + 5, 3))
    values[:, 1] = np.arange(len(values)) - 7.0
    whole = np.array([False, True, False])
    blocks = list(number_rows(values, decimals=3, separator=",", whole=whole))
    want = "".join(f"{a:.3f},{b:.0f},{c:.3f}\n" for a, b, c in values.tolist())
    assert len(blocks) == 3
    assert b"".join(blocks).decode("ascii").replace("-0.000", "0.000") == want.replace(
        "-0.000", "0.000"
    )


def test_numbers_beyond_double_precision_are_refused():
    assert b"".join(number_rows(np.array([[9e9]]), decimals=5)) == b"9000000000.00000\n"
    with pytest.raises(InvalidInputError, match="too large"):
        list(number_rows(np.array([[0.0, 1e11]]), decimals=6))
