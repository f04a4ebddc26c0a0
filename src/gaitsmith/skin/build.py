"""The skinned figure of a skeleton: one smooth body, shoes that bend at the ball."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.skin import palette
from gaitsmith.skin.bones import bone_solids
from gaitsmith.skin.cage import Cage
from gaitsmith.skin.fit import Fit, fits
from gaitsmith.skin.hand import fingers
from gaitsmith.skin.limb_cage import add_arm, add_leg
from gaitsmith.skin.measures import Measures
from gaitsmith.skin.mesh import Paint, SkinMesh, split_corners, strongest, vertex_normals
from gaitsmith.skin.shapes import ball, corner_normals, skin
from gaitsmith.skin.shoe import outsole, upper
from gaitsmith.skin.t_pose import renamed
from gaitsmith.skin.torso_cage import add_torso

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.skin.shapes import Mesh
    from gaitsmith.skin.shoe import Last

#: Every colour of the smooth figure.
PAINTS = (
    Paint("wood", palette.WOOD),
    Paint("pelvis", palette.WOOD_DARK),
    *(Paint(f"{s}Limbs", c) for s, c in zip(SIDES, palette.SIDE_LIMBS, strict=True)),
    *(Paint(f"{s}Joints", c) for s, c in zip(SIDES, palette.SIDE_JOINTS, strict=True)),
    *(Paint(f"{s}Shoe", c) for s, c in zip(SIDES, palette.SIDE_SHOES, strict=True)),
    Paint("outsole", palette.OUTSOLE),
)
_WOOD, _PELVIS, _LIMBS, _JOINTS, _SHOES, _OUTSOLE = 0, 1, (2, 3), (4, 5), (6, 7), 8
# How far from the ball the upper of a shoe begins and ends to bend, over its length.
_BEND = 0.10
# Rim of the nose of the standard figure from the bridge counter-clockwise; its tip and, in the
# head, its back.
_NOSE_RIM = np.array(
    [
        [0.0, 1.642, 0.100],
        [-0.0085, 1.626, 0.099],
        [-0.0165, 1.598, 0.102],
        [0.0, 1.591, 0.106],
        [0.0165, 1.598, 0.102],
        [0.0085, 1.626, 0.099],
    ]
)
_NOSE_TIP = np.array([0.0, 1.602, 0.127])
_NOSE_ENDS = np.stack([[0.0, 1.612, 0.080], _NOSE_TIP])


class _Pieces:
    """Pieces of the figure at rest, collected into one mesh."""

    def __init__(self) -> None:
        self.vertices: list[Float[np.ndarray, "n 3"]] = []
        self.normals: list[Float[np.ndarray, "n 3"]] = []
        self.faces: list[Int[np.ndarray, "m 3"]] = []
        self.joints: list[Int[np.ndarray, "n 4"]] = []
        self.weights: list[Float[np.ndarray, "n 4"]] = []
        self.paints: list[Int[np.ndarray, "m"]] = []
        self.count = 0

    def add(
        self,
        mesh: Mesh,
        normals: Float[np.ndarray, "n 3"],
        skin: tuple[Int[np.ndarray, "n 4"], Float[np.ndarray, "n 4"]],
        paint: Int[np.ndarray, "m"] | int,
    ) -> None:
        """Add a piece with its vertex normals, its joints and weights, and its colours."""
        vertices, faces = mesh
        self.vertices.append(vertices)
        self.normals.append(normals)
        self.faces.append(faces + self.count)
        self.joints.append(skin[0])
        self.weights.append(skin[1])
        self.paints.append(np.broadcast_to(paint, len(faces)))
        self.count += len(vertices)

    def add_creased(
        self,
        mesh: Mesh,
        corners: Float[np.ndarray, "m 3 3"],
        share: Float[np.ndarray, "n joints"],
        paint: int,
    ) -> None:
        """Add a piece with normals at its corners; vertices on a crease are doubled."""
        faces, old, normals = split_corners(mesh[1], corners)
        self.add((mesh[0][old], faces), normals, strongest(share[old]), paint)

    def mesh(
        self,
        paints: tuple[Paint, ...],
        rest: Float[np.ndarray, "joints 3"],
        stature: float,
        lasts: tuple[Last | None, Last | None],
    ) -> SkinMesh:
        """All pieces as one mesh, with those of ``paints`` that it has."""
        used, face_paints = np.unique(np.concatenate(self.paints), return_inverse=True)
        return SkinMesh(
            vertices=np.concatenate(self.vertices),
            normals=np.concatenate(self.normals),
            faces=np.concatenate(self.faces),
            joints=np.concatenate(self.joints),
            weights=np.concatenate(self.weights),
            paints=tuple(paints[k] for k in used.tolist()),
            face_paints=face_paints,
            rest=rest,
            stature=stature,
            lasts=lasts,
        )


def build_skin(skeleton: Skeleton) -> SkinMesh:
    """A skinned figure around ``skeleton``, in its rest pose.

    A person whose rest pose is near the T-pose gets one smooth body of some 9000 triangles,
    whatever dialect its joints are named in; any other skeleton a slim solid along each bone.
    A person whose rest pose is another one can be had in the T-pose:
    :func:`gaitsmith.skin.t_pose.in_t_pose`.
    """
    measures = Measures(renamed(skeleton))
    rest = measures.rest - [0.0, measures.floor, 0.0]
    if not fits(measures, rest):
        return _of_bones(skeleton, measures)
    fit, pieces = Fit(measures, rest), _Pieces()
    _add_body(pieces, fit)
    _add_face(pieces, fit)
    for side, last in enumerate(measures.lasts):
        _add_fingers(pieces, fit, side)
        if last is not None:
            _add_shoe(pieces, fit, side, last)
    return pieces.mesh(PAINTS, rest, measures.stature, measures.lasts)


def _add_body(pieces: _Pieces, fit: Fit) -> None:
    """The welded body: modelled, subdivided, carried to the rest pose."""
    cage = Cage(fit.count)
    openings = add_torso(cage, fit, (_WOOD, _PELVIS))
    for side in (0, 1):
        add_arm(cage, fit, side, openings.arms[side], (_LIMBS[side], _JOINTS[side], _WOOD))
        add_leg(cage, fit, side, openings.legs[side], (_LIMBS[side], _JOINTS[side]))
    points, shares, quads, paint = cage.smooth()
    faces = _triangles(points, quads)
    joints, weights = strongest(shares)
    normals = vertex_normals(points, faces)
    points, normals = fit.sculpt.unpose(points, normals, joints, weights)
    pieces.add((points, faces), normals, (joints, weights), np.tile(paint, 2))


def _triangles(
    points: Float[np.ndarray, "n 3"], quads: Int[np.ndarray, "m 4"]
) -> Int[np.ndarray, "faces 3"]:
    """Quads cut along the shorter diagonal."""
    a, b, c, d = quads.T
    across = np.linalg.norm(points[a] - points[c], axis=1)
    is_first = across <= np.linalg.norm(points[b] - points[d], axis=1) + 1e-9
    first = np.where(is_first, np.stack([a, b, c]), np.stack([a, b, d]))
    second = np.where(is_first, np.stack([a, c, d]), np.stack([b, c, d]))
    return np.concatenate([first.T, second.T])


def _add_face(pieces: _Pieces, fit: Fit) -> None:
    """Ears, and a nose that shows where the head looks."""
    rings = np.stack([_NOSE_RIM, 0.45 * _NOSE_RIM + 0.55 * _NOSE_TIP + [0.0, 0.0, 0.003]])
    meshes = [skin(fit.trunk(rings.reshape(-1, 3)).reshape(rings.shape), *fit.trunk(_NOSE_ENDS))]
    for sign in SIDE_SIGN.tolist():
        center = fit.trunk(np.array([[sign * 0.0755, 1.628, -0.006]]))[0]
        meshes.append(ball(center, np.array([0.010, 0.029, 0.018]) * fit.head, around=8, rings=4))
    for mesh in meshes:
        share = np.tile(fit.one("head"), (len(mesh[0]), 1))
        pieces.add_creased(mesh, corner_normals(*mesh, crease=3.0), share, _WOOD)


def _add_fingers(pieces: _Pieces, fit: Fit, side: int) -> None:
    share = fit.one(f"{SIDES[side]}Hand")
    for points, faces in fingers(fit, side):
        corners = corner_normals(points, faces, crease=3.0)
        flat, old, normals = split_corners(faces, corners)
        carried = strongest(np.tile(share, (len(old), 1)))
        vertices, normals = fit.sculpt.unpose(points[old], normals, *carried)
        pieces.add((vertices, flat), normals, carried, _WOOD)


def _add_shoe(pieces: _Pieces, fit: Fit, side: int, last: Last) -> None:
    """One shoe: a sole that folds at the ball, an upper that bends over it."""
    word = SIDES[side]
    foot = fit.sculpt.rest[fit.index(f"{word}Foot")]
    has_toes = f"{word}Toes" in fit.measures.skeleton.names
    for mesh, paint, bend in (
        (outsole(last), _OUTSOLE, 0.0),
        (upper(last, around=12), _SHOES[side], _BEND * last.length),
    ):
        along = (mesh[0] - last.heel) @ last.axes[0]
        ahead = along - last.ball
        toes = smoothstep(0.5 + 0.5 * ahead / bend) if bend else 1.0 * (ahead > 1e-9)
        toes = toes[:, None] * has_toes
        share = (1.0 - toes) * fit.one(f"{word}Foot")
        if has_toes:
            share = share + toes * fit.one(f"{word}Toes")
        pieces.add_creased((mesh[0] + foot, mesh[1]), corner_normals(*mesh), share, paint)


def _of_bones(skeleton: Skeleton, measures: Measures) -> SkinMesh:
    """A solid along every bone, each rigid with one joint."""
    rest = measures.rest - [0.0, float(measures.rest[:, 1].min()), 0.0]
    size = max(float(np.ptp(rest, axis=0).max()), 1e-3)
    pieces = _Pieces()
    for joint, mesh, color in bone_solids(skeleton, rest, size):
        share = np.zeros((len(mesh[0]), len(skeleton)))
        share[:, joint] = 1.0
        paint = _WOOD if color == palette.WOOD else _PELVIS
        moved = mesh[0] + rest[joint], mesh[1]
        pieces.add_creased(moved, corner_normals(*mesh), share, paint)
    return pieces.mesh(PAINTS, rest, size, (None, None))
