"""Pictures: the figure that is drawn, and that sheets and animations are what they claim."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import about, multiply
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.motion.motion import Labels, Motion
from gaitsmith.motion.skeleton import Skeleton
from gaitsmith.skin.build import build_skin
from gaitsmith.viz import contact_sheet, gif
from gaitsmith.viz.canvas import nice_step
from gaitsmith.viz.render import camera, draw_figure, rasterize
from gaitsmith.viz.tracks import flexion, smooth, stride_frames, tracks_of

STRIDE, SPEED = 1.08, 1.3


def person(spine: int = 3, scale: float = 1.0, soles: bool = True) -> Skeleton:
    chain = ["spine", *[f"spine_{k:02d}" for k in range(2, spine)], "upperChest"]
    joints = [("hips", None, (0.0, 0.93, 0.0))]
    parent = "hips"
    for k, name in enumerate(chain):
        joints.append((name, parent, (0.0, 0.11 if k == 0 else 0.30 / (spine - 1), 0.0)))
        parent = name
    joints += [("neck", parent, (0.0, 0.14, 0.0)), ("head", "neck", (0.0, 0.11, 0.0))]
    for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
        joints += [
            (f"{side}Shoulder", parent, (sign * 0.03, 0.09, 0.0)),
            (f"{side}UpperArm", f"{side}Shoulder", (sign * 0.16, 0.0, 0.0)),
            (f"{side}LowerArm", f"{side}UpperArm", (sign * 0.32, 0.0, 0.0)),
            (f"{side}Hand", f"{side}LowerArm", (sign * 0.26, 0.0, 0.0)),
            (f"{side}UpperLeg", "hips", (sign * 0.0875, 0.0, 0.0)),
            (f"{side}LowerLeg", f"{side}UpperLeg", (0.0, -0.43, 0.0)),
            (f"{side}Foot", f"{side}LowerLeg", (0.0, -0.432, 0.0)),
            (f"{side}Toes", f"{side}Foot", (0.0, -0.068, 0.125)),
        ]
    names = [name for name, _, _ in joints]
    sole = np.array([[0.0, -0.068, -0.064], [0.0, -0.068, 0.125], [0.0, 0.0, 0.075]]) * scale
    return Skeleton(
        tuple(names),
        tuple(-1 if p is None else names.index(p) for _, p, _ in joints),
        scale * np.array([offset for _, _, offset in joints]),
        np.stack([sole, sole]) if soles else None,
    )


def walk(skeleton: Skeleton, seconds: float = 4.0, labels: bool = True) -> Motion:
    fps = 30.0
    time = np.arange(round(seconds * fps) + 1) / fps
    root = np.zeros((len(time), 3))
    root[:, 1], root[:, 2] = skeleton.offsets[0, 1] - 0.02, SPEED * time
    rotations = np.zeros((len(time), len(skeleton), 4))
    rotations[..., 3] = 1.0
    for side, sign, phase in (("left", 1.0, 0.0), ("right", -1.0, np.pi)):
        swing = np.cos(2.0 * np.pi * time / STRIDE + phase)
        rotations[:, skeleton.index(f"{side}UpperLeg")] = about("x", -0.1 - 0.4 * swing)
        rotations[:, skeleton.index(f"{side}LowerLeg")] = about("x", 0.3 - 0.2 * swing)
        hang = about("z", -1.45 * sign)
        rotations[:, skeleton.index(f"{side}UpperArm")] = multiply(about("x", 0.4 * swing), hang)
    if not labels:
        return Motion(skeleton, root, rotations, fps)
    landing = np.arange(0.0, seconds, 0.5 * STRIDE)
    landing = np.concatenate([[0.0], landing])
    side = np.arange(len(landing)) % 2
    place = np.stack([0.08 * (1 - 2 * side), 0.0 * landing, SPEED * landing + 0.3], axis=1)
    ready = Labels(
        phase=np.zeros(len(time)),
        step=np.zeros(len(time), int),
        footstep_side=side,
        footstep_position=place,
        footstep_heading=np.zeros(len(landing)),
        footstep_time=landing,
        ground='{"kind": "flat", "height": 0}',
        recipe="{}",
        path=np.array([[0.0, 0.0], [0.0, 6.0]]),
    )
    contacts = np.zeros((len(time), 2, 3), bool)
    contacts[::2] = True
    return Motion(skeleton, root, rotations, fps, contacts=contacts, labels=ready)


def at_rest(skeleton: Skeleton) -> tuple[np.ndarray, np.ndarray]:
    identity = np.tile([0.0, 0.0, 0.0, 1.0], (1, len(skeleton), 1))
    positions, world = forward_kinematics(skeleton, skeleton.offsets[:1], identity)
    return positions[0], world[0]


def shown(figure, positions, world, view: str, size: int = 200) -> np.ndarray:
    """Which pixels the figure covers, seen from ``view`` at 100 pixels a meter."""
    image = Image.new("RGB", (size, size), (0, 0, 0))
    seen = camera(view, heading=0.0, target=np.zeros(3), center=(size / 2, 190), scale=100.0)
    draw_figure(image, figure, positions, world, seen)
    return np.asarray(image).max(axis=2) > 0


def test_silhouette_is_that_of_the_body():
    """As tall as the stature, as wide as the arms at rest; the two sides in their colours."""
    skeleton = person()
    figure = build_skin(skeleton)
    mask = shown(figure, *at_rest(skeleton), "front", 220)
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    assert np.ptp(rows) == pytest.approx(100.0 * figure.stature, abs=2.0)
    reach = 100.0 * np.ptp(figure.vertices[:, 0])
    assert np.ptp(columns) == pytest.approx(reach, abs=2.0)
    assert (mask != mask[:, ::-1]).mean() < 0.01


def test_hand_moves_on_the_picture_with_its_elbow():
    skeleton = person()
    figure = build_skin(skeleton)
    turns = np.tile([0.0, 0.0, 0.0, 1.0], (1, len(skeleton), 1))
    turns[0, skeleton.index("leftLowerArm")] = about("z", np.pi / 2)  # the hand goes up
    positions, world = forward_kinematics(skeleton, skeleton.offsets[:1], turns)
    before = shown(figure, *at_rest(skeleton), "front", 220)
    after = shown(figure, positions[0], world[0], "front", 220)
    elbow = 110 + round(100.0 * skeleton.rest_positions()[skeleton.index("leftLowerArm"), 0])
    assert before[:, elbow + 15 :].sum() > 100
    assert after[:, elbow + 15 :].sum() == 0
    assert (after & ~before)[:, elbow - 15 : elbow + 15].sum() > 100
    assert (before[:, :100] == after[:, :100]).all()


def test_nearest_face_wins():
    # two squares-as-triangles facing the viewer; the second is nearer and smaller
    far = [[0.0, 0.0, 0.0], [0.0, 8.0, 0.0], [8.0, 0.0, 0.0]]
    near = [[0.0, 0.0, 1.0], [0.0, 4.0, 1.0], [4.0, 0.0, 1.0]]
    seen = rasterize(np.array([near, far]), (8, 8))
    grid = np.full(64, -1)
    left, top, width, _ = seen.box
    rows, columns = np.divmod(seen.pixel, width)
    grid[(rows + top) * 8 + columns + left] = seen.face
    grid = grid.reshape(8, 8)
    assert grid[0, 0] == 0
    assert grid[0, 6] == 1
    assert grid[7, 7] == -1
    assert rasterize(np.array([near, far])[:, ::-1], (8, 8)) is None


@pytest.mark.parametrize("view", ["right", "left", "front", "top", "three-quarter"])
def test_views_show_the_figure(view):
    skeleton = person()
    positions, world = at_rest(skeleton)
    image = Image.new("RGB", (120, 120), (0, 0, 0))
    seen = camera(view, heading=0.0, target=positions[0], center=(60.0, 60.0), scale=50.0)
    draw_figure(image, build_skin(skeleton), positions, world, seen)
    pixels = np.asarray(image).astype(int)
    assert (pixels.sum(axis=-1) > 0).sum() > 300
    ahead = seen.project(positions[0] + np.array([0.0, 0.0, 1.0]))
    expected = {"right": 110.0, "left": 10.0, "front": 60.0, "top": 110.0}.get(view)
    assert expected is None or ahead[0] == pytest.approx(expected)


@pytest.mark.parametrize("spine", [3, 17])
def test_sheet_has_its_size_and_the_same_bytes(tmp_path, spine):
    motion = walk(person(spine))
    for name in ("a.png.partial", "b.png"):
        contact_sheet(motion, tmp_path / name, width=800, fine=1)
    assert (tmp_path / "a.png.partial").read_bytes() == (tmp_path / "b.png").read_bytes()
    with Image.open(tmp_path / "b.png") as image:
        assert image.format == "PNG"
        assert image.width == 800
        assert image.height > 600


def test_sheet_without_labels_soles_or_movement(tmp_path):
    skeleton = person(soles=False)
    still = walk(skeleton, labels=False)
    contact_sheet(still, tmp_path / "a.png", width=800, fine=1)
    one = Motion(skeleton, still.root_position[:1], still.rotations[:1], 30.0)
    contact_sheet(one, tmp_path / "b.png", width=800, fine=1, phases=3)
    gif(one, tmp_path / "b.gif", width=120)
    with Image.open(tmp_path / "b.gif") as image:
        assert image.n_frames == 1


@pytest.mark.parametrize(
    "ground",
    [
        '{"kind": "slope", "deg": 5}',
        '{"kind": "stairs", "rise": 0.1, "tread": 0.4, "count": 3, "start": 1.0}',
        '{"kind":"heightfield","shape":[2,2],"cell":3,"origin":[0,0],"height":[0,0,1,1]}',
    ],
)
def test_uneven_grounds_are_drawn(tmp_path, ground):
    motion = walk(person(), seconds=1.0)
    labels = Labels(**{**vars(motion.labels), "ground": ground})
    uneven = motion.with_(labels=labels)
    level = tracks_of(uneven).ground(np.array([0.0, 0.0]), np.array([0.0, 1.5]))
    assert level[0] == 0.0
    assert level[1] > 0.05
    contact_sheet(uneven, tmp_path / "a.png", width=800, fine=1)
    gif(uneven, tmp_path / "a.gif", width=120, fps=4)


def test_gif_has_its_frames_and_the_same_bytes(tmp_path):
    motion = walk(person(), seconds=1.0)
    for name in ("a.gif.partial", "b.gif"):
        gif(motion, tmp_path / name, width=160, fps=10)
    assert (tmp_path / "a.gif.partial").read_bytes() == (tmp_path / "b.gif").read_bytes()
    with Image.open(tmp_path / "b.gif") as image:
        assert image.format == "GIF"
        assert image.size == (160, 144)
        assert image.n_frames == 11
        assert image.info["loop"] == 0
        assert image.info["duration"] == 100


def chain_of(count: int) -> Motion:
    """A thing that is no person, waving."""
    names = tuple(f"j{k}" for k in range(count))
    skeleton = Skeleton(names, tuple(range(-1, count - 1)), np.tile([0.02, 0.2, 0.0], (count, 1)))
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (11, count, 1))
    rotations[:, -1] = about("x", np.linspace(0.0, 1.0, 11))
    return Motion(skeleton, np.zeros((11, 3)), rotations, 10.0)


def test_what_is_no_person_is_drawn_as_bones(tmp_path):
    contact_sheet(chain_of(4), tmp_path / "a.png", width=800, fine=1)
    gif(chain_of(4), tmp_path / "a.gif", width=120, fps=5)
    tracks = tracks_of(chain_of(4))
    assert tracks.figure.lasts == (None, None)
    # four joints, 0.2 m apart, stand 0.6 m high
    assert tracks.stature == pytest.approx(0.63)
    assert shown(tracks.figure, tracks.positions[0], tracks.world[0], "front").sum() > 50


def test_bad_arguments_are_refused(tmp_path):
    motion = walk(person(), seconds=0.2)
    empty = Motion(motion.skeleton, np.zeros((0, 3)), np.zeros((0, len(motion.skeleton), 4)), 30.0)
    for draw in (contact_sheet, gif):
        with pytest.raises(InvalidInputError, match="no frames"):
            draw(empty, tmp_path / "x")
        with pytest.raises(InvalidInputError, match="width"):
            draw(motion, tmp_path / "x", width=7)
    with pytest.raises(InvalidInputError, match="phases"):
        contact_sheet(motion, tmp_path / "x", phases=1)
    with pytest.raises(InvalidInputError, match="fps"):
        gif(motion, tmp_path / "x", fps=0)
    assert not (tmp_path / "x").exists()


def test_stride_is_from_the_middle_and_whole():
    motion = walk(person())
    frames, is_stride = stride_frames(motion, 8)
    assert is_stride
    assert len(frames) == 8
    assert (frames[4] - frames[0]) / motion.fps == pytest.approx(0.5 * STRIDE, abs=0.04)
    assert frames[0] / motion.fps < 0.5 * motion.duration < frames[-1] / motion.fps
    frames, is_stride = stride_frames(motion.with_(labels=None), 5)
    assert not is_stride
    assert frames.tolist() == [0, 30, 60, 90, 120]


def test_angles_are_those_of_the_joints():
    motion = walk(person())
    tracks = tracks_of(motion)
    swing = np.cos(2.0 * np.pi * motion.times / STRIDE)
    np.testing.assert_allclose(flexion(tracks, "hip")[:, 0], np.rad2deg(0.1 + 0.4 * swing))
    np.testing.assert_allclose(flexion(tracks, "knee")[:, 0], np.rad2deg(0.3 - 0.2 * swing))
    np.testing.assert_allclose(flexion(tracks, "ankle"), 0.0, atol=1e-9)
    assert tracks.distance == pytest.approx(SPEED * motion.duration)
    np.testing.assert_allclose(tracks.progress, SPEED * motion.times, atol=1e-9)


def test_smoothing_keeps_lines_and_ends():
    line = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(smooth(line, 9), line, atol=1e-12)


@pytest.mark.parametrize(("span", "most", "step"), [(5.0, 6, 1.0), (0.9, 5, 0.2), (70.0, 5, 20.0)])
def test_ticks_are_round_numbers(span, most, step):
    assert nice_step(span, most) == pytest.approx(step)
