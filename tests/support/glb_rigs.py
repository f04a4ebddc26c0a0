"""GLB files as other programs write them: other names, axes, units, armatures and keys."""

from __future__ import annotations

import json
import struct

import numpy as np

from gaitsmith.geometry.rotations import about, inverse, multiply, rotate

MIXAMO = {
    "hips": "Hips",
    "spine": "Spine",
    "chest": "Spine1",
    "upperChest": "Spine2",
    "neck": "Neck",
    "head": "Head",
    **{
        f"{side.lower()}{part}": f"{side}{name}"
        for side in ("Left", "Right")
        for part, name in {
            "Shoulder": "Shoulder",
            "UpperArm": "Arm",
            "LowerArm": "ForeArm",
            "Hand": "Hand",
            "UpperLeg": "UpLeg",
            "LowerLeg": "Leg",
            "Foot": "Foot",
            "Toes": "ToeBase",
        }.items()
    },
}


def glb(document, binary=b""):
    """The bytes of a file of a document and its binary chunk."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    size = 12 + 8 + len(text) + (8 + len(binary) if binary else 0)
    data = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON") + text
    return data + (struct.pack("<I4s", len(binary), b"BIN\0") + binary if binary else b"")


def foreign(motion, *, kind="LINEAR", every=1, unit=0.01, skin=True):
    """Document and binary of ``motion`` as an exporter with axes and units of its own has it.

    An armature lies on its back and is scaled by ``unit``; every bone's own frame is turned at
    rest; a mesh and a camera hang about; only every ``every``-th frame has keys.
    """
    skeleton = motion.skeleton
    count = len(skeleton)
    axes = multiply(about("z", 0.4 * np.arange(count)), about("x", 1.1 * np.arange(count)))
    stand = multiply(about("x", np.pi / 2), np.broadcast_to([0.0, 0, 0, 1.0], (1, 4)))[0]
    binary, views, accessors = b"", [], []

    def stored(array, kind_of):
        nonlocal binary
        data = np.ascontiguousarray(array, dtype="<f4").tobytes()
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": 5126,
                "count": len(array),
                "type": kind_of,
            }
        )
        binary += data
        return len(accessors) - 1

    frames = np.arange(0, len(motion), every)
    times = stored((frames / motion.fps)[:, None], "SCALAR")
    nodes = [
        {"name": "Armature", "scale": [unit] * 3, "rotation": inverse(stand).tolist()},
        {"name": "Camera", "camera": 0, "translation": [0.0, 3.0, 0.0]},
        {"name": "Body", "mesh": 0, "skin": 0} if skin else {"name": "Body", "mesh": 0},
    ]
    nodes[0]["children"] = [3]
    channels, samplers = [], []

    def animated(node, what, values):
        values = values[frames]
        if kind == "CUBICSPLINE":  # tangents of the straight lines between keys
            slope = np.gradient(values, frames / motion.fps, axis=0)
            values = np.stack([slope, values, slope], axis=1).reshape(-1, values.shape[1])
        output = stored(values, "VEC4" if what == "rotation" else "VEC3")
        samplers.append({"input": times, "output": output, "interpolation": kind})
        target = {"node": node, "path": what}
        channels.append({"sampler": len(samplers) - 1, "target": target})

    for j, name in enumerate(skeleton.names):
        parent = skeleton.parents[j]
        up = axes[parent] if parent >= 0 else np.array([0.0, 0.0, 0.0, 1.0])
        back = inverse(up)
        turn = multiply(multiply(back[None], motion.rotations[:, j]), axes[j][None])
        place = skeleton.offsets[j] / unit
        if parent < 0:
            place = rotate(stand, place)
            turn = multiply(stand[None], turn)
            moved = rotate(np.broadcast_to(stand, (len(motion), 4)), motion.root_position) / unit
            animated(3, "translation", moved)
        else:
            place = rotate(back, place)
        own = axes[j] if parent < 0 else multiply(back, axes[j])
        own = multiply(stand, own) if parent < 0 else own
        nodes.append(
            {
                "name": f"mixamorig:{MIXAMO[name]}",
                "translation": place.tolist(),
                "rotation": own.tolist(),
                "children": [3 + k for k, p in enumerate(skeleton.parents) if p == j],
            }
        )
        animated(3 + j, "rotation", turn)
    document = {
        "asset": {"version": "2.0", "generator": "another program"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}],
        "nodes": nodes,
        "cameras": [{"type": "perspective"}],
        "meshes": [{"primitives": []}],
        "animations": [{"channels": channels, "samplers": samplers}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    if skin:
        document["skins"] = [{"joints": list(range(3, 3 + count))}]
    return document, binary
