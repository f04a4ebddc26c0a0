"""GLB files as motions: our own, those of other programs, and broken ones."""

from __future__ import annotations

import json

import numpy as np
import pytest
from glb_rigs import foreign, glb

import gaitsmith
from gaitsmith import Scene, Start, Walker, perform
from gaitsmith.errors import FileFormatError, GaitsmithWarning
from gaitsmith.io import load, load_performance
from gaitsmith.io.convert import convert
from gaitsmith.motion.kinematics import joint_positions


@pytest.fixture(scope="module")
def walked():
    return gaitsmith.walk(path="0,0 0,3 1,4", fps=30)


def written(folder, document, binary=b""):
    path = folder / "motion.glb"
    path.write_bytes(glb(document, binary))
    return path


# ------------------------------------------------------------------------------ our own


@pytest.mark.parametrize("fps", [24.0, 29.97, 60.0, 120.0])
def test_our_own_come_back(tmp_path, fps):
    motion = gaitsmith.walk(distance=2.0, body=1.4, fps=fps)
    gaitsmith.save(motion, tmp_path / "walk.glb")
    again = load(tmp_path / "walk.glb")
    assert again.skeleton.names == motion.skeleton.names
    assert again.skeleton.parents == motion.skeleton.parents
    assert again.fps == fps
    assert len(again) == len(motion)
    np.testing.assert_allclose(joint_positions(again), joint_positions(motion), atol=1e-5)
    np.testing.assert_array_equal(again.contacts, motion.contacts)


def test_everybody_of_a_scene_comes_back(tmp_path):
    ann, ben = (
        Walker("ann", do="walk to 0,2"),
        Walker("ben", body=1.2, start=Start((2.0, 0.0)), do="stand 1"),
    )
    both = perform(Scene((ann, ben)), fps=20)
    gaitsmith.save(both, tmp_path / "both.glb")
    again = load_performance(tmp_path / "both.glb")
    assert again.names == ("ann", "ben")
    for (_, old), (_, new) in zip(both, again, strict=True):
        assert new.skeleton.names == old.skeleton.names
        np.testing.assert_allclose(joint_positions(new), joint_positions(old), atol=1e-5)
    with pytest.warns(GaitsmithWarning, match="of the people ann, ben the first is taken"):
        assert len(load(tmp_path / "both.glb")) == len(both.motions[0])


def test_figures_are_those_of_the_bvh(tmp_path, walked):
    """Both know poses only; the figures of one are those of the other."""
    figures = []
    for suffix in (".bvh", ".glb"):
        gaitsmith.save(walked, tmp_path / f"walk{suffix}")
        figures.append(gaitsmith.measure(tmp_path / f"walk{suffix}"))
    one, other = figures
    for name in ("step_length_m", "cadence_spm", "speed_mps", "height_m", "slip_mm_max"):
        assert other[name] == pytest.approx(one[name], rel=1e-3, abs=1e-3), name
    assert other["steps"] == one["steps"]


@pytest.mark.parametrize("suffix", [".bvh", ".csv", ".glb", ".png"])
def test_convert_takes_them(tmp_path, walked, suffix):
    from gaitsmith.pipeline import WRITERS

    gaitsmith.save(walked, tmp_path / "walk.glb")
    target = convert(tmp_path / "walk.glb", tmp_path / f"again{suffix}", writers=WRITERS)
    assert target.stat().st_size > 0


# ---------------------------------------------------------------------- other programs'


@pytest.mark.parametrize("kind", ["LINEAR", "CUBICSPLINE"])
@pytest.mark.parametrize("skin", [True, False])
@pytest.mark.parametrize("unit", [1.0, 0.01])
def test_joints_of_a_foreign_rig_are_where_they_are(tmp_path, walked, kind, skin, unit):
    """Bones with axes of their own under an armature that lies and is scaled."""
    motion = load(written(tmp_path, *foreign(walked, kind=kind, skin=skin, unit=unit)))
    assert motion.fps == 30.0
    assert len(motion) == len(walked)
    expected, found = joint_positions(walked), joint_positions(motion)
    for j, name in enumerate(walked.skeleton.names):
        k = [n.lower() for n in motion.skeleton.names].index(_mixamo(name))
        np.testing.assert_allclose(found[:, k], expected[:, j], atol=2e-5, err_msg=name)
    hips = motion.skeleton.names.index("mixamorig:Hips")
    rest = motion.skeleton.rest_positions() - motion.skeleton.rest_positions()[hips]
    own = walked.skeleton.rest_positions() - walked.skeleton.rest_positions()[0]
    head = motion.skeleton.names.index("mixamorig:Head")
    np.testing.assert_allclose(rest[head], own[walked.skeleton.index("head")], atol=1e-5)


def _mixamo(name):
    from glb_rigs import MIXAMO

    return f"mixamorig:{MIXAMO[name]}".lower()


def test_between_keys_it_is_interpolated(tmp_path, walked):
    """Keys of every second frame are those of half the rate; at the keys nothing is lost."""
    motion = load(written(tmp_path, *foreign(walked, every=2)))
    assert motion.fps == 15.0
    np.testing.assert_allclose(
        motion.root_position, walked.root_position[::2][: len(motion)], atol=1e-5
    )


def test_a_foreign_walk_is_measured(tmp_path, walked):
    gaitsmith.save(walked, tmp_path / "walk.bvh")
    one = gaitsmith.measure(tmp_path / "walk.bvh")
    other = gaitsmith.measure(written(tmp_path, *foreign(walked)))
    for name in ("step_length_m", "cadence_spm", "speed_mps", "height_m"):
        assert other[name] == pytest.approx(one[name], rel=0.01), name


def test_keys_on_no_grid_are_warned_of(tmp_path, walked):
    document, binary = foreign(walked)
    first = document["bufferViews"][0]
    size = first["byteLength"] // 4
    times = np.sort(np.random.default_rng(0).uniform(0.0, 4.0, size)).astype("<f4")
    binary = times.tobytes() + binary[first["byteLength"] :]
    with pytest.warns(GaitsmithWarning, match="on no grid of frames; 30 frames a second"):
        assert load(written(tmp_path, document, binary)).fps == 30.0


def test_of_several_animations_the_largest_is_said(tmp_path, walked):
    document, binary = foreign(walked)
    document["animations"].insert(0, {"name": "blink", "channels": [], "samplers": []})
    document["animations"][1]["name"] = "walk"
    with pytest.warns(GaitsmithWarning, match="of 2 animations the one with most.*'walk'"):
        load(written(tmp_path, document, binary))


# ------------------------------------------------------------------------------ refused


def changed(walked, change):
    document, binary = foreign(walked)
    change(document)
    return document, binary


REFUSED = {
    "no animation": lambda d: d.pop("animations"),
    "interpolation 'EASE' is none of glTF": lambda d: d["animations"][0]["samplers"][0].update(
        interpolation="EASE"
    ),
    "is sparse, which is not read": lambda d: d["accessors"][1].update(sparse={}),
    "compressed by meshopt": lambda d: d["bufferViews"][1].update(
        extensions={"EXT_meshopt_compression": {}}
    ),
    "is in another file ('walk.bin'); export all": lambda d: d["buffers"][0].update(uri="walk.bin"),
    "reaches byte": lambda d: d["accessors"][1].update(byteOffset=4_000_000),
    "has 99999999 rows": lambda d: d["accessors"][1].update(count=99_999_999),
    "needs 1 rows of 3": lambda d: d["accessors"][0].update(count=1),
    "there is no nodes[99]": lambda d: d["nodes"][0].update(children=[99]),
    "has two parents": lambda d: d["nodes"][1].update(children=[3]),
    "is above itself": lambda d: (
        d["nodes"][0].update(children=[]) or d["nodes"][3].update(children=[3])
    ),
    "translation of node 'mixamorig:Spine' must be 3 finite": lambda d: d["nodes"][4].update(
        translation=[1.0, 2.0]
    ),
    "scaled unevenly or over time": lambda d: d["nodes"][3].update(scale=[1.0, 2.0, 1.0]),
    "shears, not read": lambda d: d["nodes"][4].update(
        matrix=[1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    ),
    "is no unit quaternion": lambda d: d["nodes"][4].update(rotation=[0.0, 0.0, 0.0, 0.0]),
    "moves no joint of a person": lambda d: d["animations"][0].update(channels=[]),
    "nodes must be a list of objects": lambda d: d.update(nodes={}),
    "not as glTF wants them": lambda d: d["animations"][0].update(channels=[3]),
}


@pytest.mark.parametrize("says", REFUSED)
def test_what_is_not_read_is_said(tmp_path, walked, says):
    path = written(tmp_path, *changed(walked, REFUSED[says]))
    with pytest.raises(FileFormatError) as caught:
        load(path)
    assert says in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (b"", "does not begin with glTF"),
        (b'  {"asset": {}}', "it looks like a .gltf, which is text"),
        (b"glTF\x02\0\0\0", "ends after 8 bytes"),
        (b"glTF\x01\0\0\0" + b"\0" * 20, "of glTF version 1; version 2 is read"),
        (b"glTF\x02\0\0\0\xff\xff\0\0" + b"\0" * 20, "it was cut off"),
        (glb([]), "its JSON is no object"),
        (glb({}), "has 0 nodes"),
        (glb({}).replace(b"{", b"["), "its JSON cannot be read"),
        (glb({}).replace(b"JSON", b"BIN\0"), "its first chunk must be JSON"),
    ],
)
def test_what_is_no_glb_is_said(tmp_path, data, says):
    path = tmp_path / "motion.glb"
    path.write_bytes(data)
    with pytest.raises(FileFormatError) as caught:
        load(path)
    assert says in str(caught.value)


def test_a_thing_is_read_but_not_measured(tmp_path):
    document = {
        "asset": {"version": "2.0"},
        "nodes": [{"name": "box", "rotation": [0, 0, 0, 1]}],
        "animations": [
            {
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [{"input": 0, "output": 1}],
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 8},
            {"buffer": 0, "byteOffset": 8, "byteLength": 24},
        ],
        "buffers": [{"byteLength": 32}],
    }
    binary = np.array([0.0, 0.5, 0, 0, 0, 1, 2, 3], dtype="<f4").tobytes()
    path = written(tmp_path, document, binary)
    motion = load(path)
    assert json.loads(json.dumps(motion.root_position.tolist()))[-1] == [1.0, 2.0, 3.0]
    with pytest.raises(gaitsmith.GaitsmithError, match="no joint is recognised"):
        gaitsmith.measure(path)
