"""The skinned figure: closed, smooth, fitted to any skeleton, and whole when it bends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gaitsmith.body.presets import body_from
from gaitsmith.body.rig import skeleton_of
from gaitsmith.conventions import SIDES
from gaitsmith.geometry.rotations import about, exp, multiply, rotate
from gaitsmith.motion.kinematics import forward_kinematics
from gaitsmith.motion.skeleton import HUMANOID, Skeleton
from gaitsmith.skin.build import build_skin
from gaitsmith.skin.cage import Cage, subdivide

MIXAMO = {"UpperArm": "Arm", "LowerArm": "ForeArm", "UpperLeg": "UpLeg", "LowerLeg": "Leg"}
CUBE = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1]]
    + [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]],
    dtype=float,
)


def person(height=1.75, spine=3):
    return skeleton_of(replace(body_from(height), spine_segments=spine))


PEOPLE = {
    "child": person(1.2),
    "adult": person(),
    "tall": person(2.1),
    "17 spine joints": person(1.8, 17),
    "1 spine joint": person(1.6, 1),
}


def posed(skeleton, turns):
    """Positions and world rotations with the joints of ``turns`` turned, others at rest."""
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (1, len(skeleton), 1))
    for name, turn in turns.items():
        rotations[0, skeleton.index(name)] = turn
    root = skeleton.offsets[:1] * [0.0, 1.0, 0.0]
    positions, world = forward_kinematics(skeleton, root, rotations)
    return positions[0], world[0]


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


@pytest.fixture(scope="module", params=PEOPLE)
def dressed(request):
    skeleton = PEOPLE[request.param]
    return skeleton, build_skin(skeleton)


def test_subdivided_cube():
    """Catmull & Clark 1978: corners move to 5/9, edge points to 3/4, face points stay."""
    points, quads, parent = subdivide(CORNERS, CUBE)
    assert len(points) == 8 + 6 + 12
    assert len(quads) == 24
    np.testing.assert_allclose(points[:8], 5.0 / 9.0 * CORNERS)
    np.testing.assert_allclose(np.sort(np.abs(points[14:])), [[0.0, 0.75, 0.75]] * 12)
    np.testing.assert_array_equal(np.bincount(parent), [4] * 6)
    assert volume(points, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])) > 0.0


def test_a_cage_with_a_hole_is_refused():
    with pytest.raises(AssertionError, match="closed"):
        subdivide(CORNERS, CUBE[:-1])


def test_points_in_no_face_are_left_out():
    cage = Cage(1)
    cage.ring(np.concatenate([CORNERS, [[9.0, 9.0, 9.0]]]), np.ones(1))
    for face in CUBE.tolist():
        cage.quad(*face, 0)
    points, weights, quads, _ = cage.smooth()
    assert np.abs(points).max() <= 1.0
    assert quads.max() == len(points) - 1
    np.testing.assert_allclose(weights, 1.0)


def test_mesh_is_closed_and_faces_outward(dressed):
    _, figure = dressed
    _, weld = np.unique(np.round(figure.vertices, 9), axis=0, return_inverse=True)
    faces = weld.reshape(-1)[figure.faces]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])]
    edges = np.concatenate([faces[:, k] for k in ([0, 1], [1, 2], [2, 0])])
    directed = set(map(tuple, edges.tolist()))
    assert all((b, a) in directed for a, b in directed)
    assert volume(figure.vertices, figure.faces) > 0.0
    assert 5000 <= len(figure.faces) <= 9500
    np.testing.assert_allclose(np.linalg.norm(figure.normals, axis=1), 1.0, atol=1e-9)
    a, b, c = (figure.vertices[figure.faces[:, k]] for k in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), figure.normals[figure.faces[:, 0]])
    assert (outward > 0.0).mean() > 0.998


def test_weights_add_up_to_one_in_single_precision(dressed):
    skeleton, figure = dressed
    weights = figure.weights
    assert weights.dtype == np.float32
    assert weights.shape == figure.joints.shape == (len(figure.vertices), 4)
    assert (weights >= 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1, dtype=np.float32), 1.0, atol=2e-7)
    assert figure.joints.min() >= 0
    assert figure.joints.max() < len(skeleton)
    assert (figure.joints[weights == 0.0] == 0).all()
    for part in ("hips", "head", "neck", "leftHand", "rightLowerLeg", "leftToes", "spine"):
        carried = (weights * (figure.joints == skeleton.index(part))).max()
        assert carried > 0.5, part


def test_figure_stands_on_the_floor_as_tall_as_the_skeleton_says(dressed):
    skeleton, figure = dressed
    vertices, _ = figure.pose(*posed(skeleton, {}))
    np.testing.assert_allclose(vertices, figure.vertices, atol=1e-12)
    assert vertices[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert vertices[:, 1].max() == pytest.approx(figure.stature, rel=0.01)
    hands = skeleton.rest_positions()[[skeleton.index(f"{s}Hand") for s in SIDES], 0]
    assert vertices[:, 0].max() > hands[0] + 0.05 * figure.stature
    assert vertices[:, 0].min() < hands[1] - 0.05 * figure.stature


def test_a_rigidly_moved_skeleton_moves_every_vertex_rigidly(dressed):
    skeleton, figure = dressed
    turn, shift = exp(np.array([0.7, -1.1, 2.0])), np.array([3.0, -2.0, 5.0])
    positions, world = posed(skeleton, {})
    vertices, normals = figure.pose(rotate(turn, positions) + shift, multiply(turn, world))
    np.testing.assert_allclose(vertices, rotate(turn, figure.vertices) + shift, atol=1e-12)
    np.testing.assert_allclose(normals, rotate(turn, figure.normals), atol=1e-12)


def test_the_hand_follows_the_wrist_and_nothing_else_does(dressed):
    skeleton, figure = dressed
    hand, turn = skeleton.index("leftHand"), about("z", 0.8)
    vertices, _ = figure.pose(*posed(skeleton, {"leftHand": turn}))
    at = figure.rest[hand]
    expected = rotate(turn, figure.vertices - at) + at
    share = (figure.weights * (figure.joints == hand)).sum(axis=1)
    tip = int(np.argmax(figure.vertices[:, 0]))
    assert share[tip] == 1.0
    np.testing.assert_allclose(vertices[share == 1.0], expected[share == 1.0], atol=1e-12)
    np.testing.assert_allclose(vertices[share == 0.0], figure.vertices[share == 0.0], atol=1e-12)


def test_fingers_are_four_and_curl_toward_the_palm(dressed):
    """Beyond the knuckles are the hand's four fingers, whose tips are below its back."""
    skeleton, figure = dressed
    _, piece = np.unique(loose_pieces(figure), return_inverse=True)
    hand = figure.joints[:, 0] == skeleton.index("leftHand")
    body = piece[np.argmax(figure.joints[:, 0] == skeleton.index("hips"))]
    fingers = np.unique(piece[hand & (piece != body)])
    assert len(fingers) == 4
    for finger in fingers:
        mine = figure.vertices[piece == finger]
        ends = mine[[np.argmin(mine[:, 0]), np.argmax(mine[:, 0])]]
        assert ends[1, 1] < ends[0, 1] - 0.005 * figure.stature


def loose_pieces(figure):
    """Number of the connected piece of each vertex; doubled vertices are one."""
    _, weld = np.unique(np.round(figure.vertices, 9), axis=0, return_inverse=True)
    weld = weld.reshape(-1)
    label, faces = np.arange(weld.max() + 1), weld[figure.faces]
    while True:
        low = label[faces].min(axis=1)
        new = label.copy()
        np.minimum.at(new, faces.ravel(), np.repeat(low, 3))
        if (new == label).all():
            return label[weld]
        label = new


def test_sides_are_mirror_images(dressed):
    _, figure = dressed
    names = [paint.name for paint in figure.paints]
    for part in ("Limbs", "Joints", "Shoe"):
        sides = []
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
            faces = figure.faces[figure.face_paints == names.index(side + part)]
            sides.append(figure.vertices[np.unique(faces)] * [sign, 1.0, 1.0])
        gap = np.linalg.norm(sides[0][:, None] - sides[1][None], axis=-1).min(axis=1)
        assert gap.max() < 1e-6, part


BENT = {
    "knee": {"leftLowerLeg": about("x", np.radians(65.0))},
    "elbow": {"rightLowerArm": about("y", np.radians(90.0))},
    "hip forward": {"leftUpperLeg": about("x", np.radians(-40.0))},
    "hip back": {"rightUpperLeg": about("x", np.radians(25.0))},
    "arms hang": {
        "leftUpperArm": about("z", np.radians(-82.0)),
        "rightUpperArm": multiply(about("x", 0.4), about("z", np.radians(82.0))),
    },
    "twist": {"chest": about("y", 0.3), "spine": about("y", 0.3), "neck": about("y", 0.6)},
}


@pytest.mark.parametrize("pose", BENT)
def test_bent_joints_keep_their_volume(pose):
    skeleton = PEOPLE["adult"]
    figure = build_skin(skeleton)
    at_rest = volume(figure.vertices, figure.faces)
    vertices, _ = figure.pose(*posed(skeleton, BENT[pose]))
    assert volume(vertices, figure.faces) == pytest.approx(
        at_rest, rel=0.03 if pose == "arms hang" else 0.008
    )


@pytest.mark.parametrize(("upper", "joint", "angle"), [("UpperLeg", "LowerLeg", 65.0)])
def test_a_bent_knee_is_no_candy_wrapper(upper, joint, angle):
    """Across the knee the skin is nowhere nearer to the joint than 70 % of a straight knee."""
    skeleton = PEOPLE["adult"]
    figure = build_skin(skeleton)
    knee = skeleton.index(f"left{joint}")
    near = {}
    for bend in (0.0, angle):
        turns = {f"left{joint}": about("x", np.radians(bend))}
        positions, world = posed(skeleton, turns)
        vertices, _ = figure.pose(positions, world)
        near[bend] = np.linalg.norm(vertices - positions[knee], axis=1).min()
    assert near[angle] > 0.7 * near[0.0]


def test_feet_are_rigid_and_toes_bend_at_the_ball():
    skeleton = PEOPLE["adult"]
    figure = build_skin(skeleton)
    shoes = [k for k, paint in enumerate(figure.paints) if paint.name == "outsole"]
    used = np.unique(figure.faces[np.isin(figure.face_paints, shoes)])
    side = np.where(figure.vertices[used, 0] > 0.0, 0, 1)
    for s, word in enumerate(SIDES):
        foot, toes = skeleton.index(f"{word}Foot"), skeleton.index(f"{word}Toes")
        mine = used[side == s]
        ball = figure.rest[foot, 2] + skeleton.soles[s, 1, 2]
        behind = figure.vertices[mine, 2] <= ball + 1e-9
        expected = np.where(behind, foot, toes)
        np.testing.assert_array_equal(figure.joints[mine, 0], expected)
        np.testing.assert_array_equal(figure.weights[mine, 0], 1.0)


def test_any_dialect_of_names_is_dressed_alike():
    skeleton = PEOPLE["adult"]
    names = []
    for name in skeleton.names:
        side = next((s for s in SIDES if name.startswith(s)), "")
        part = name.removeprefix(side)
        names.append(f"mixamorig:{side.capitalize()}{MIXAMO.get(part, part[0].upper() + part[1:])}")
    other = build_skin(replace(skeleton, names=tuple(names)))
    figure = build_skin(skeleton)
    np.testing.assert_array_equal(other.vertices, figure.vertices)
    np.testing.assert_array_equal(other.weights, figure.weights)


def test_a_skeleton_that_lacks_limbs_gets_solid_bones():
    skeleton = PEOPLE["adult"]
    keep = [k for k, n in enumerate(skeleton.names) if "Arm" not in n and "Hand" not in n]
    parents = tuple(-1 if k == 0 else keep.index(skeleton.parents[k]) for k in keep)
    part = Skeleton(tuple(skeleton.names[k] for k in keep), parents, skeleton.offsets[keep])
    figure = build_skin(part)
    assert len(figure.faces) > 1000
    assert (figure.weights == [1.0, 0.0, 0.0, 0.0]).all()
    assert figure.lasts == (None, None)


@pytest.mark.parametrize("count", [1, 2, 9])
def test_a_thing_that_is_no_person_gets_solid_bones(count):
    offsets = np.tile([0.1, 0.2, 0.0], (count, 1))
    skeleton = Skeleton(tuple(f"j{k}" for k in range(count)), tuple(range(-1, count - 1)), offsets)
    figure = build_skin(skeleton)
    assert np.isfinite(figure.vertices).all()
    assert set(figure.joints[:, 0]) == set(range(count))
    assert volume(figure.vertices, figure.faces) > 0.0


@pytest.mark.parametrize("seed", range(8))
def test_nonsense_under_human_names_still_gives_a_figure(seed):
    names = [name for name, _ in HUMANOID]
    parents = tuple(-1 if p is None else names.index(p) for _, p in HUMANOID)
    offsets = np.random.default_rng(seed).normal(0.0, 0.2, (len(names), 3))
    figure = build_skin(Skeleton(tuple(names), parents, offsets))
    assert np.isfinite(figure.vertices).all()
    assert np.isfinite(figure.normals).all()


def test_one_colour():
    figure = build_skin(PEOPLE["adult"]).in_one_color()
    assert [paint.name for paint in figure.paints] == ["wood"]
    assert (figure.face_paints == 0).all()
