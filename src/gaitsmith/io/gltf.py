"""GLB 2.0: a skinned, coloured figure and its animation in one binary file.

The frame of the package is that of glTF: meters, +Y up, facing +Z, quaternions xyzw. The
scene holds two nodes: ``Armature`` at the origin with the joints below it, and the mesh,
which glTF wants beside the armature, not below it. The nodes stand in the rest pose. A joint
that never moves has no animation channel where that is its rest pose, else one key.

Several people are one armature and one mesh each, all moved by one animation; every name of a
node begins with the person's, ``ann_hips``, for programs find what moves by its name.
"""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any

import numpy as np

from gaitsmith._version import __version__
from gaitsmith.conventions import SIDES
from gaitsmith.errors import InvalidInputError
from gaitsmith.geometry.rotations import IDENTITY, sign_continuous
from gaitsmith.motion.performance import Performance

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jaxtyping import Bool, Float, Int, Shaped

    from gaitsmith.motion.motion import Motion
    from gaitsmith.skin.mesh import Paint, SkinMesh
    from gaitsmith.skin.palette import Color

#: What changes less than this over a motion (meters, or components of a quaternion) is still.
STILL = 1e-7
_COMPONENTS = {"f4": 5126, "u1": 5121, "u2": 5123, "u4": 5125}
_KINDS = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_VERTICES, _INDICES = 34962, 34963
_POINTS = ("Heel", "Ball", "Toe")


def write_glb(motion: Motion | Performance, path: Path, *, neutral: bool = False) -> None:
    """Write ``motion`` to ``path`` as GLB with a figure fitted to its skeleton.

    Parameters
    ----------
    motion
        At least one frame. Any skeleton: what is no person gets a solid along every bone. Of a
        performance everybody.
    path
        Where to write. The same motion gives the same bytes.
    neutral
        One colour for everything instead of tinted sides.

    Raises
    ------
    InvalidInputError
        If the motion has no frames, or is so long and fine that its times coincide in the
        file's single precision.
    """
    if isinstance(motion, Performance) and len(motion) == 1:
        motion = motion.motions[0]
    people = list(motion) if isinstance(motion, Performance) else [("", motion)]
    if len(people[0][1]) == 0:
        raise InvalidInputError("there is nothing to write: the motion has no frames")
    from gaitsmith.skin.build import build_skin  # late: a walk to BVH needs no figure

    binary = _Binary()
    materials: list[Paint] = []
    document: dict[str, Any] = {
        "asset": {
            "version": "2.0",
            "generator": f"gaitsmith {__version__}",
            "extras": {"gaitsmith": _all_extras(motion)},
        },
        "scene": 0,
        "scenes": [{"name": "Scene", "nodes": []}],
        **{name: [] for name in ("nodes", "meshes", "materials", "skins")},
    }
    animation: dict[str, Any] = {"name": "motion", "channels": [], "samplers": []}
    for name, own in people:
        figure = build_skin(own.skeleton)
        if neutral:
            figure = figure.in_one_color()
        materials += [paint for paint in figure.paints if paint not in materials]
        paints = [materials.index(paint) for paint in figure.paints]
        base, number = len(document["nodes"]), len(document["skins"])
        document["scenes"][0]["nodes"] += [base, base + 1 + len(own.skeleton)]
        document["nodes"] += _nodes(own, figure, base, number, name)
        mesh = name or "mannequin"
        document["meshes"].append({"name": mesh, "primitives": _primitives(binary, figure, paints)})
        document["skins"].append({"name": mesh, **_skin(binary, figure, base)})
        _animate(animation, binary, own, figure.rest[0], base)
    document["materials"] = [_material(name, color) for name, color in materials]
    if animation["channels"]:  # glTF allows no animation without any
        document["animations"] = [animation]
    document |= binary.description()
    _write(path, document, binary.chunks)


class _Binary:
    """The one buffer of the file, and the accessors that say what is where in it."""

    def __init__(self) -> None:
        self.chunks: list[bytes] = []
        self.size = 0
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        #: Accessor of the times of so many keys; all motions of a file have one time axis.
        self.times: dict[int, int] = {}

    def add(
        self,
        array: Shaped[np.ndarray, "n ..."],
        dtype: str,
        *,
        target: int | None = None,
        bounds: bool = False,
    ) -> int:
        """Store an array; index of its accessor."""
        stored = np.ascontiguousarray(array, dtype=f"<{dtype}")
        data = stored.tobytes()
        view: dict[str, Any] = {"buffer": 0, "byteOffset": self.size, "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        accessor: dict[str, Any] = {
            "bufferView": len(self.views),
            "componentType": _COMPONENTS[dtype],
            "count": len(stored),
            "type": _KINDS[stored.shape[1:]],
        }
        if bounds:
            rows = stored.reshape(len(stored), -1).astype(np.float64)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        self.views.append(view)
        self.accessors.append(accessor)
        padding = -len(data) % 4
        self.chunks.append(data + b"\0" * padding)
        self.size += len(data) + padding
        return len(self.accessors) - 1

    def description(self) -> dict[str, Any]:
        """The parts of the document that tell of the buffer."""
        return {
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": self.size}],
        }


def _nodes(
    motion: Motion, figure: SkinMesh, base: int, number: int, who: str
) -> list[dict[str, Any]]:
    """Armature, joints in the order of the skeleton, mesh: the nodes from ``base`` on."""
    before = f"{who}_" if who else ""
    skeleton = motion.skeleton
    children: list[list[int]] = [[] for _ in skeleton.names]
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            children[parent].append(base + 1 + joint)
    nodes: list[dict[str, Any]] = [{"name": f"{before}Armature", "children": [base + 1]}]
    for joint, name in enumerate(skeleton.names):
        place = figure.rest[0] if joint == 0 else skeleton.offsets[joint]
        node: dict[str, Any] = {"name": before + name, "translation": place.tolist()}
        if children[joint]:
            node["children"] = children[joint]
        nodes.append(node)
    return [*nodes, {"name": f"{before}mannequin", "mesh": number, "skin": number}]


def _primitives(
    binary: _Binary, figure: SkinMesh, materials: Sequence[int]
) -> list[dict[str, Any]]:
    """One primitive a colour, each with vertices of its own."""
    primitives: list[dict[str, Any]] = []
    small = len(figure.rest) <= 256
    for paint in range(len(figure.paints)):
        faces = figure.faces[figure.face_paints == paint]
        used = np.unique(faces)
        indices = np.searchsorted(used, faces).ravel()
        attributes = {
            "POSITION": binary.add(figure.vertices[used], "f4", target=_VERTICES, bounds=True),
            "NORMAL": binary.add(figure.normals[used], "f4", target=_VERTICES),
            "JOINTS_0": binary.add(figure.joints[used], "u1" if small else "u2", target=_VERTICES),
            "WEIGHTS_0": binary.add(figure.weights[used], "f4", target=_VERTICES),
        }
        kind = "u2" if len(used) < 65535 else "u4"
        primitives.append(
            {
                "attributes": attributes,
                "indices": binary.add(indices, kind, target=_INDICES),
                "material": materials[paint],
            }
        )
    return primitives


def _material(name: str, color: Color) -> dict[str, Any]:
    """Matt, not metallic; glTF wants the colour linear, not as the screen shows it."""
    shown = np.array(color) / 255.0
    linear = np.where(shown <= 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return {
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*np.round(linear, 6).tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.65,
        },
    }


def _skin(binary: _Binary, figure: SkinMesh, base: int) -> dict[str, Any]:
    """All joints, bound where they are at rest; a matrix there is stored column by column."""
    matrices = np.tile(np.eye(4), (len(figure.rest), 1, 1))
    matrices[:, 3, :3] = -figure.rest
    return {
        "inverseBindMatrices": binary.add(matrices, "f4"),
        "joints": list(range(base + 1, base + 1 + len(figure.rest))),
        "skeleton": base + 1,
    }


def _animate(
    animation: dict[str, Any],
    binary: _Binary,
    motion: Motion,
    root_rest: Float[np.ndarray, "3"],
    base: int,
) -> None:
    """Add rotations of the joints and translations of the root, and of others where they move."""
    times = (np.arange(len(motion)) / motion.fps).astype(np.float32)
    if (np.diff(times) <= 0.0).any():
        raise InvalidInputError(
            f"{len(motion)} frames at {motion.fps:g} fps are too long and too fine for GLB, whose "
            "times are single precision; write fewer frames a second or a part of the motion"
        )
    samplers: list[dict[str, Any]] = animation["samplers"]
    channels: list[dict[str, Any]] = animation["channels"]

    def follow(joint: int, what: str, values: Float[np.ndarray, "f n"], rest: Any) -> None:
        if (np.ptp(values, axis=0) <= STILL).all():
            values = values[:1]
            if np.abs(values - rest).max() <= STILL:
                return
        count = len(values)
        if count not in binary.times:
            binary.times[count] = binary.add(times[:count], "f4", bounds=True)
        output = binary.add(values, "f4")
        target = {"node": base + 1 + joint, "path": what}
        channels.append({"sampler": len(samplers), "target": target})
        samplers.append(
            {"input": binary.times[count], "output": output, "interpolation": "LINEAR"},
        )

    follow(0, "translation", motion.root_position, root_rest)
    rotations = sign_continuous(motion.rotations)
    for joint, offset in enumerate(motion.skeleton.offsets):
        turn = rotations[:, joint]
        follow(joint, "rotation", turn if turn[0, 3] >= 0.0 else -turn, IDENTITY)
        if joint and motion.translations is not None:
            follow(joint, "translation", motion.translations[:, joint], offset)


def _all_extras(motion: Motion | Performance) -> dict[str, Any]:
    """What glTF has no place for, of one person or of each by name."""
    if not isinstance(motion, Performance):
        return _extras(motion)
    common = ("fps", "frames", "units")
    each = {name: _extras(own) for name, own in motion}
    first = next(iter(each.values()))
    return {
        **{key: first[key] for key in common},
        "surroundings": motion.surroundings,
        "walkers": {n: {k: e[k] for k in e if k not in common} for n, e in each.items()},
    }


def _extras(motion: Motion) -> dict[str, Any]:
    """What glTF has no place for: frame rate, units, contacts, footsteps, ground, recipe."""
    out: dict[str, Any] = {
        "fps": motion.fps,
        "frames": len(motion),
        "units": "meters, seconds; +Y up, facing +Z",
    }
    if motion.contacts is not None:
        out["contacts"] = {
            f"{side}{point}": _intervals(motion.contacts[:, s, p])
            for s, side in enumerate(SIDES)
            for p, point in enumerate(_POINTS)
        }
    labels = motion.labels
    if labels is not None:
        out["footsteps"] = [
            {"side": SIDES[side], "position": position, "heading": heading, "time": time}
            for side, position, heading, time in zip(
                labels.footstep_side.tolist(),
                labels.footstep_position.tolist(),
                labels.footstep_heading.tolist(),
                labels.footstep_time.tolist(),
                strict=True,
            )
        ]
        out |= {"ground": labels.ground, "recipe": labels.recipe}
    return out


def _intervals(flags: Bool[np.ndarray, "frames"]) -> list[list[int]]:
    """First and last frame of every run of set flags."""
    edges: Int[np.ndarray, "n"] = np.flatnonzero(np.diff(flags, prepend=False, append=False))
    return np.stack([edges[::2], edges[1::2] - 1], axis=1).tolist()


def _write(path: Path, document: dict[str, Any], chunks: list[bytes]) -> None:
    """The file: a header, the JSON chunk padded with spaces, the binary chunk."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    size = sum(map(len, chunks))
    with path.open("wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + size))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", size, b"BIN\0"))
        for chunk in chunks:
            file.write(chunk)
