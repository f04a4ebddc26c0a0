"""The GLB against our own kinematics, by a reader of its own: what a tool would show."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

import gaitsmith
from gaitsmith.geometry.rotations import multiply, rotate
from gaitsmith.motion.kinematics import joint_positions

WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}
KIND = {5126: "<f4", 5123: "<u2", 5125: "<u4", 5121: "u1"}


@pytest.fixture(scope="module", params=[1.2, 1.75])
def motion(request):
    return gaitsmith.walk(distance=2.0, body=request.param, fps=30)


@pytest.fixture(scope="module")
def glb(motion, tmp_path_factory):
    """The JSON and a function that reads an accessor."""
    path = gaitsmith.save(motion, tmp_path_factory.mktemp("glb") / "a.glb")
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON"
    doc = json.loads(data[20 : 20 + size])
    blob = data[28 + size :]

    def read(index):
        accessor = doc["accessors"][index]
        view = doc["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width, dtype = WIDTH[accessor["type"]], KIND[accessor["componentType"]]
        count = accessor["count"] * width
        return np.frombuffer(blob, dtype, count, start).reshape(-1, width)

    return doc, read


def posed(doc, read, frames):
    """World positions of the nodes by name at every key, (F, 3) each."""
    count = len(doc["nodes"])
    parents = np.full(count, -1)
    for i, node in enumerate(doc["nodes"]):
        parents[node.get("children", [])] = i
    shift = {
        i: np.tile(n.get("translation", [0, 0, 0]), (frames, 1)) for i, n in enumerate(doc["nodes"])
    }
    turn = {
        i: np.tile(n.get("rotation", [0, 0, 0, 1]), (frames, 1)) for i, n in enumerate(doc["nodes"])
    }
    animation = doc["animations"][0]
    for channel in animation["channels"]:
        values = read(animation["samplers"][channel["sampler"]]["output"])
        target = turn if channel["target"]["path"] == "rotation" else shift
        target[channel["target"]["node"]] = values.astype(float)
    places, turned = {}, {}

    def place(i):
        if i not in places:
            if parents[i] < 0:
                places[i], turned[i] = shift[i].astype(float), turn[i].astype(float)
            else:
                at, q = place(parents[i])
                places[i], turned[i] = at + rotate(q, shift[i]), multiply(q, turn[i])
        return places[i], turned[i]

    return {node["name"]: place(i)[0] for i, node in enumerate(doc["nodes"]) if "name" in node}


def test_joints_are_where_the_motion_has_them(motion, glb):
    found = posed(*glb, len(motion))
    positions = joint_positions(motion)
    for i, name in enumerate(motion.skeleton.names):
        np.testing.assert_allclose(found[name], positions[:, i], atol=1e-5, err_msg=name)


def test_keys_are_at_the_frames(motion, glb):
    doc, read = glb
    for sampler in doc["animations"][0]["samplers"]:
        times = read(sampler["input"])[:, 0]
        np.testing.assert_allclose(times, motion.times, atol=1e-6)
        assert sampler.get("interpolation", "LINEAR") == "LINEAR"


def test_the_skin_holds_together(motion, glb):
    """Weights sum to one, joints exist, the mesh stands on the ground as tall as the body."""
    doc, read = glb
    [skin] = doc["skins"]
    low, high = np.inf, -np.inf
    for primitive in doc["meshes"][0]["primitives"]:
        attributes = primitive["attributes"]
        weights, joints = read(attributes["WEIGHTS_0"]), read(attributes["JOINTS_0"])
        np.testing.assert_allclose(weights.sum(1), 1.0, atol=1e-6)
        assert joints.max() < len(skin["joints"])
        places = read(attributes["POSITION"])
        accessor = doc["accessors"][attributes["POSITION"]]
        np.testing.assert_allclose(accessor["min"], places.min(0), atol=1e-7)
        np.testing.assert_allclose(accessor["max"], places.max(0), atol=1e-7)
        low, high = min(low, places[:, 1].min()), max(high, places[:, 1].max())
    height = motion.skeleton.rest_positions()[:, 1].max() + motion.skeleton.ends[:, 1].max()
    assert low == pytest.approx(0.0, abs=2e-3)
    assert high == pytest.approx(height, rel=0.03)


def test_the_mesh_hangs_at_the_root_of_the_scene(glb):
    """Else tools apply the parent's transform twice, and the validator warns."""
    doc, _ = glb
    roots = doc["scenes"][doc.get("scene", 0)]["nodes"]
    skinned = [i for i, node in enumerate(doc["nodes"]) if "skin" in node]
    assert set(skinned) <= set(roots)


def test_same_motion_same_bytes(motion, tmp_path):
    one, two = (gaitsmith.save(motion, tmp_path / f"{n}.glb").read_bytes() for n in "ab")
    assert one == two
