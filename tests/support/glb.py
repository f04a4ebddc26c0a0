"""A reader of GLB files as small as the tests need, written from the glTF 2.0 specification."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Glb:
    """One file: its document, and its numbers by accessor."""

    def __init__(self, data: bytes) -> None:
        magic, version, size = struct.unpack_from("<4sII", data)
        assert (magic, version, size) == (b"glTF", 2, len(data))
        length, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON"
        assert length % 4 == 0
        self.document: dict[str, Any] = json.loads(data[20 : 20 + length])
        size, kind = struct.unpack_from("<I4s", data, 20 + length)
        assert kind == b"BIN\0"
        self.binary = data[28 + length :]
        assert len(self.binary) == size == self.document["buffers"][0]["byteLength"]

    def numbers(self, accessor: int) -> np.ndarray:
        """Rows of an accessor."""
        fact = self.document["accessors"][accessor]
        view = self.document["bufferViews"][fact["bufferView"]]
        dtype, width = np.dtype(_TYPES[fact["componentType"]]), _WIDTHS[fact["type"]]
        start = view["byteOffset"] + fact.get("byteOffset", 0)
        flat = np.frombuffer(self.binary, dtype, fact["count"] * width, start)
        return flat if width == 1 else flat.reshape(-1, width)

    @property
    def nodes(self) -> list[dict[str, Any]]:
        return self.document["nodes"]

    def channels(self) -> dict[tuple[str, str], tuple[np.ndarray, np.ndarray]]:
        """Times and values of every channel, by the node's name and what moves."""
        found = {}
        for animation in self.document.get("animations", []):
            for channel in animation["channels"]:
                sampler = animation["samplers"][channel["sampler"]]
                assert sampler["interpolation"] == "LINEAR"
                key = self.nodes[channel["target"]["node"]]["name"], channel["target"]["path"]
                found[key] = self.numbers(sampler["input"]), self.numbers(sampler["output"])
        return found

    def world(self, frame: int) -> np.ndarray:
        """``(nodes, 4, 4)`` world matrices at a key frame; single keys hold all the time."""
        local = np.tile(np.eye(4), (len(self.nodes), 1, 1))
        moving = self.channels()
        for k, node in enumerate(self.nodes):
            assert not {"matrix", "scale"} & set(node)
            values = {"rotation": [0.0, 0.0, 0.0, 1.0], "translation": [0.0, 0.0, 0.0]} | node
            for what in ("rotation", "translation"):
                if (node["name"], what) in moving:
                    keys = moving[node["name"], what][1]
                    values[what] = keys[min(frame, len(keys) - 1)]
            local[k, :3, :3] = _matrix(np.array(values["rotation"], dtype=np.float64))
            local[k, :3, 3] = values["translation"]
        world = np.full_like(local, np.nan)

        def place(k: int, above: np.ndarray) -> None:
            world[k] = above @ local[k]
            for child in self.nodes[k].get("children", []):
                place(child, world[k])

        for root in self.document["scenes"][self.document["scene"]]["nodes"]:
            place(root, np.eye(4))
        return world

    def skinned(self, frame: int) -> dict[str, np.ndarray]:
        """World vertices of each primitive, by its material's name, at a key frame."""
        skin = self.document["skins"][0]
        bind = self.numbers(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        matrices = self.world(frame)[skin["joints"]] @ bind
        out = {}
        for primitive in self.document["meshes"][0]["primitives"]:
            attributes = {k: self.numbers(v) for k, v in primitive["attributes"].items()}
            mixed = np.einsum(
                "vk,vkab->vab", attributes["WEIGHTS_0"], matrices[attributes["JOINTS_0"]]
            )
            points = np.pad(attributes["POSITION"], ((0, 0), (0, 1)), constant_values=1.0)
            name = self.document["materials"][primitive["material"]]["name"]
            out[name] = np.einsum("vab,vb->va", mixed, points)[:, :3]
        return out


def _matrix(q: np.ndarray) -> np.ndarray:
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
