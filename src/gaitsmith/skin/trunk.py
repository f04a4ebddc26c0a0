"""Pelvis, spine, neck and head of the mannequin."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDE_SIGN, SIDES
from gaitsmith.skin import palette
from gaitsmith.skin.parts import HEAD_JOINT
from gaitsmith.skin.shapes import ball, corner_normals, frame_along, resample, tube

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.skin.parts import Maker
    from gaitsmith.skin.shapes import Mesh

# Half-widths of the trunk: share of hips-to-neck, half-width, half-depth, forward shift.
_TRUNK = np.array(
    [
        [-0.140, 0.070, 0.072, -0.004],
        [-0.060, 0.128, 0.098, -0.010],
        [0.040, 0.158, 0.107, -0.010],
        [0.160, 0.152, 0.100, -0.004],
        [0.340, 0.124, 0.086, 0.004],
        [0.500, 0.134, 0.096, 0.006],
        [0.680, 0.158, 0.110, 0.004],
        [0.820, 0.166, 0.106, -0.004],
        [0.900, 0.152, 0.090, -0.010],
        [0.960, 0.112, 0.072, -0.012],
        [1.000, 0.074, 0.058, -0.012],
    ]
)


def add_trunk(maker: Maker) -> None:
    """Pelvis, then one piece a spine joint, on one continuous outline."""
    chain = spine_chain(maker)
    if not chain:
        return
    top = maker.find("neck")
    g, heights = maker.girth, maker.rest[chain, 1]
    base = float(heights[0])
    crest = float(maker.rest[top, 1]) if top is not None else base + 0.315 * maker.stature
    length = max(crest - base, 0.05)
    breadth = _breadth(maker)
    ends = [*heights[1:].tolist(), crest]
    for k, (joint, low, high) in enumerate(zip(chain, heights.tolist(), ends, strict=True)):
        first = base + _TRUNK[0, 0] * length if k == 0 else low
        if high - first < 1e-3:
            continue
        y = np.linspace(first, high, max(2, maker.rings(1.6 * (high - first))))
        # Each piece reaches into its neighbours, hidden until the spine bends. The sharp and
        # narrow rim where it dives keeps what is hidden out of the shading of the rest.
        under = np.ones(len(y))
        if k > 0:
            y = np.concatenate([low - np.array([0.045, 0.02, 1e-4]) * g, y])
            under = np.concatenate([[0.78, 0.90, 0.98], under])
        if k + 1 < len(chain):
            y = np.concatenate([y, high + np.array([1e-4, 0.012]) * g])
            under = np.concatenate([under, [0.99, 0.95]])
        share = (y - base) / length
        profile = np.stack([_smooth(share, c) for c in (1, 2, 3)])
        wide = np.interp(share, [0.0, 0.3, 0.8], breadth)
        shift = np.interp(y, np.maximum.accumulate(heights), maker.rest[chain, 2])
        stations = np.stack(
            [
                y - low,
                profile[1] * g * under,
                profile[0] * g * wide * under,
                profile[2] * g + shift - maker.rest[joint, 2],
                np.zeros_like(y),
            ],
            axis=1,
        )
        mesh = tube(
            stations,
            frame_along(np.array([0.0, 1.0, 0.0])),
            np.zeros(3),
            caps=(0.02 * g if k == 0 else 0.003 * g, 0.003 * g),
            around=maker.around + 4,
            rings=None,
            square=2.5,
        )
        color = palette.WOOD if k else palette.WOOD_DARK
        hidden = (low if k else -np.inf) - low, (high if k + 1 < len(chain) else np.inf) - low
        normals = _side_normals(mesh, hidden)
        maker.add(maker.skeleton.names[joint], joint, mesh, color, normals)


def _side_normals(mesh: Mesh, visible: tuple[float, float]) -> Float[np.ndarray, "faces 3 3"]:
    """Normals of a piece of the trunk; what lies beyond its ``visible`` heights looks sideways.

    When the spine turns, slivers of the hidden ends show; shaded like the side of the trunk
    they go unnoticed.
    """
    vertices, faces = mesh
    normals, corners = corner_normals(vertices, faces), vertices[faces]
    half = np.ptp(vertices, axis=0)
    outward = (corners - 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))) / half**2
    outward[..., 1] = 0.0
    length = np.linalg.norm(outward, axis=-1, keepdims=True)
    up = corners[..., 1]
    beyond = np.maximum(visible[0] - up, up - visible[1])
    # a corner on the rim belongs to the side of the piece and to its end: the end is steep
    hidden = (beyond > 1e-9) | ((beyond > -1e-9) & (np.abs(normals[..., 1]) > 0.6))
    hidden &= length[..., 0] * half.max() > 1e-6
    return np.where(hidden[..., None], outward / np.maximum(length, 1e-12), normals)


def spine_chain(maker: Maker) -> list[int]:
    """Joints from the hips up to the one that carries neck, head or arms."""
    hips = maker.find("hips")
    if hips is None:
        return []
    ends = ("neck", "head", "leftShoulder", "rightShoulder", "leftUpperArm", "rightUpperArm")
    tip = next((j for name in ends if (j := maker.find(name)) is not None), None)
    if tip is None:
        known = [j for n in ("upperChest", "chest", "spine") if (j := maker.find(n)) is not None]
        joint = known[0] if known else hips
    else:
        joint = maker.skeleton.parents[tip]
    chain = []
    while joint >= 0:
        chain.append(joint)
        if joint == hips:
            return chain[::-1]
        joint = maker.skeleton.parents[joint]
    return [hips]


def _breadth(maker: Maker) -> tuple[float, float, float]:
    """Factors on the trunk's width at hips, waist and chest, from the joints' distances."""
    half = []
    for name, share in (("UpperLeg", 0.05), ("UpperArm", 0.11)):
        pair = [maker.find(f"{side}{name}") for side in SIDES]
        found = [abs(float(maker.rest[j, 0])) for j in pair if j is not None]
        typical = share * maker.stature
        half.append(np.mean(found) / typical if found and min(found) > 0.0 else 1.0)
    hips, chest = (0.35 + 0.65 * float(f) for f in half)
    return hips, 0.5 * (hips + chest), chest


def _smooth(share: Float[np.ndarray, "n"], column: int) -> Float[np.ndarray, "n"]:
    """Column of the trunk's outline at ``share`` of the way from hips to neck."""
    fine = resample(_TRUNK, 200)
    return np.interp(share, fine[:, 0], fine[:, column])


def add_head(maker: Maker) -> None:
    """Neck, an egg with a jaw, and a nose that shows where it looks."""
    g, neck, head = maker.girth, maker.find("neck"), maker.find("head")
    wood = palette.WOOD
    if neck is not None:
        to_head = np.array([0.0, 0.06 * g, 0.0])
        if head is not None and np.linalg.norm(maker.skeleton.offsets[head]) > 0.0:
            to_head = maker.skeleton.offsets[head]
        length = max(float(np.linalg.norm(to_head)), 0.05 * g)
        stations = np.array(
            [
                [-0.032, 0.052, 0.104, -0.014, 0.0],
                [-0.004, 0.054, 0.074, -0.012, 0.0],
                [0.03, 0.051, 0.056, -0.008, 0.0],
                [length, 0.050, 0.050, 0.0, 0.0],
            ]
        )
        stations[:-1, 0] *= g
        stations[:, 1:] *= g
        caps = (0.02 * g, 0.035 * g)
        mesh = maker.tube(stations, to_head, caps, rings=7)
        maker.add("neck", neck, mesh, wood)
    if head is None:
        return
    crown = maker.crown or (1.0 - HEAD_JOINT) * maker.stature
    chin = -0.51 * crown
    tall = crown - chin
    # share of the height, half-depth, half-width, forward shift, on a head 0.23 m tall
    egg = np.array(
        [
            [0.05, 0.036, 0.034, 0.046],
            [0.18, 0.064, 0.053, 0.030],
            [0.36, 0.084, 0.067, 0.016],
            [0.58, 0.098, 0.076, 0.008],
            [0.76, 0.093, 0.073, 0.004],
            [0.90, 0.064, 0.052, 0.000],
        ]
    )
    stations = np.zeros((len(egg), 5))
    stations[:, 0] = chin + egg[:, 0] * tall
    stations[:, 1:4] = egg[:, 1:] * tall / 0.2275
    caps = (0.05 * tall, 0.10 * tall)
    up = np.array([0.0, 1.0, 0.0])
    maker.add("head", head, maker.tube(stations, up, caps, rings=11), wood)
    unit = tall / 0.2275
    details = [("nose", [0.0, 0.43, 0.103], [0.0115, 0.026, 0.020])]
    details += [
        (f"{s}Ear", [x * 0.073, 0.46, 0.002], [0.010, 0.028, 0.018])
        for s, x in zip(SIDES, SIDE_SIGN.tolist(), strict=True)
    ]
    for name, (x, share, z), radii in details:
        center = np.array([x * unit, chin + share * tall, z * unit])
        mesh = ball(center, np.array(radii) * unit, around=10, rings=5)
        maker.add(name, head, mesh, palette.WOOD_DARK)
