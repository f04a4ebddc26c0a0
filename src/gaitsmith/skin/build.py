"""The skinned figure of a skeleton: one smooth body, shoes that bend at the ball."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.geometry.curves import smoothstep
from gaitsmith.motion.roles import humanoid_roles
from gaitsmith.skin import palette
from gaitsmith.skin.bones import bone_parts
from gaitsmith.skin.cage import Cage
from gaitsmith.skin.fit import Fit, fits
from gaitsmith.skin.limb_cage import add_arm, add_leg
from gaitsmith.skin.mannequin import build_mannequin
from gaitsmith.skin.mesh import Paint, SkinMesh, split_corners, strongest, vertex_normals
from gaitsmith.skin.parts import Maker
from gaitsmith.skin.shapes import ball, corner_normals
from gaitsmith.skin.shoe import outsole, upper
from gaitsmith.skin.torso_cage import add_torso

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jaxtyping import Float, Int

    from gaitsmith.motion.skeleton import Skeleton
    from gaitsmith.skin.parts import Part
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
        self, paints: tuple[Paint, ...], rest: Float[np.ndarray, "joints 3"], stature: float
    ) -> SkinMesh:
        """All pieces as one mesh."""
        return SkinMesh(
            vertices=np.concatenate(self.vertices),
            normals=np.concatenate(self.normals),
            faces=np.concatenate(self.faces),
            joints=np.concatenate(self.joints),
            weights=np.concatenate(self.weights),
            paints=paints,
            face_paints=np.concatenate(self.paints),
            rest=rest,
            stature=stature,
        )


def build_skin(skeleton: Skeleton) -> SkinMesh:
    """A skinned figure around ``skeleton``, in its rest pose.

    A person whose rest pose is near the T-pose gets one smooth body of some 9000 triangles,
    whatever dialect its joints are named in. With VRM humanoid names, one that lacks limbs
    or stands otherwise gets the rigid pieces of
    :func:`~gaitsmith.skin.mannequin.build_mannequin`; any other skeleton a slim solid along
    each bone.
    """
    dressed = _renamed(skeleton)
    maker = Maker(dressed, 1.0)
    rest = maker.rest - [0.0, maker.floor, 0.0]
    if not fits(maker, rest):
        if any(name in skeleton.names for name in ("leftUpperLeg", "leftUpperArm")):
            figure = build_mannequin(skeleton)
            return _rigid(skeleton, figure.parts, rest, figure.stature)
        rest = maker.rest - [0.0, float(maker.rest[:, 1].min()), 0.0]
        size = max(float(np.ptp(rest, axis=0).max()), 1e-3)
        return _rigid(skeleton, bone_parts(skeleton, rest, size), rest, size)
    fit, pieces = Fit(maker, rest), _Pieces()
    _add_body(pieces, fit)
    _add_ears(pieces, fit)
    for side, last in enumerate(maker.lasts):
        if last is not None:
            _add_shoe(pieces, fit, side, last)
    return pieces.mesh(PAINTS, rest, maker.stature)


def _renamed(skeleton: Skeleton) -> Skeleton:
    """The skeleton with VRM's names for the bones of a human, which joints then have alone."""
    found = humanoid_roles(skeleton.names, skeleton.parents, need=()).joints
    names = [f"{name} " if name in found else name for name in skeleton.names]
    for role, joint in found.items():
        names[joint] = role
    return replace(skeleton, names=tuple(names))


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


def _add_ears(pieces: _Pieces, fit: Fit) -> None:
    unit = fit.head
    for sign in SIDE_SIGN.tolist():
        center = fit.trunk(np.array([[sign * 0.0755, 1.628, -0.006]]))[0]
        mesh = ball(center, np.array([0.010, 0.029, 0.018]) * unit, around=8, rings=4)
        share = np.tile(fit.one("head"), (len(mesh[0]), 1))
        pieces.add_creased(mesh, corner_normals(*mesh, crease=3.0), share, _WOOD)


def _add_shoe(pieces: _Pieces, fit: Fit, side: int, last: Last) -> None:
    """One shoe: a sole that folds at the ball, an upper that bends over it."""
    word = SIDES[side]
    foot = fit.sculpt.rest[fit.index(f"{word}Foot")]
    has_toes = f"{word}Toes" in fit.maker.skeleton.names
    for mesh, paint, bend in (
        (outsole(last, 0.0, 1.0), _OUTSOLE, 0.0),
        (upper(last, 0.0, 1.0, around=12), _SHOES[side], _BEND * last.length),
    ):
        along = (mesh[0] - last.heel) @ last.axes[0]
        ahead = along - last.ball
        toes = smoothstep(0.5 + 0.5 * ahead / bend) if bend else 1.0 * (ahead > 1e-9)
        toes = toes[:, None] * has_toes
        share = (1.0 - toes) * fit.one(f"{word}Foot")
        if has_toes:
            share = share + toes * fit.one(f"{word}Toes")
        pieces.add_creased((mesh[0] + foot, mesh[1]), corner_normals(*mesh), share, paint)


def _rigid(
    skeleton: Skeleton,
    parts: Iterable[Part],
    rest: Float[np.ndarray, "joints 3"],
    stature: float,
) -> SkinMesh:
    """Pieces that each follow one joint."""
    pieces, paints = _Pieces(), dict[tuple[int, int, int], int]()
    for part in parts:
        paint = paints.setdefault(part.color, len(paints))
        share = np.zeros((len(part.vertices), len(skeleton)))
        share[:, part.joint] = 1.0
        mesh = part.vertices + rest[part.joint], part.faces
        pieces.add_creased(mesh, part.normals, share, paint)
    names = {paint.color: paint.name for paint in PAINTS}
    known = tuple(Paint(names.get(color, f"paint{k}"), color) for color, k in paints.items())
    return pieces.mesh(known, rest, stature)
