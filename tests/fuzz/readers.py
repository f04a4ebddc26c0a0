"""What the fuzzers share: small good files of every format, and one run of a reader.

A reader may give a result or say that the file is broken; nothing else, and not slowly.
"""

from __future__ import annotations

import io
import json
import struct
import tempfile
import warnings
from pathlib import Path

import numpy as np
from PIL import Image

from gaitsmith.errors import FileFormatError, GaitsmithWarning, InvalidInputError
from gaitsmith.ground import read_ground
from gaitsmith.io import MARKER_READERS, READERS, TABLE_READERS
from gaitsmith.io.bvh_parse import parse_bvh
from gaitsmith.io.bvh_print import write_bvh_file

BVH = b"""HIERARCHY
ROOT Hips
{
\tOFFSET 0.0 90.0 0.0
\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
\tJOINT LeftUpLeg
\t{
\t\tOFFSET 9.0 -3.0 0.0
\t\tCHANNELS 3 Zrotation Xrotation Yrotation
\t\tJOINT LeftLeg {
\t\t\tOFFSET 0 -4e1 0
\t\t\tCHANNELS 6 Zrotation Xposition Yposition Zposition Xrotation Yrotation
\t\t\tEnd Site
\t\t\t{
\t\t\t\tOFFSET 0.0 -40.0 1.0
\t\t\t}
\t\t}
\t}
}
MOTION
Frames: 2
Frame Time: 0.0333333
1 90 2 10 20 30 -5 6 7 1 0 -40 0 2 3
1.5 91 2.5 11 21 31 -6 7 8 1.25 0 -40 0 2.5 3.5
"""
ASF = b""":units
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
:bonedata
  begin
    name lfemur
    direction 0 -1 0
    length 7.5
    axis 0 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
  end
  begin
    name ltibia
    direction 0 -1 0
    length 7
    axis 0 0 20 XYZ
    dof rx
  end
:hierarchy
  begin
    root lfemur
    lfemur ltibia
  end
"""
AMC = b""":DEGREES
1
root 1 2 3 10 20 30
lfemur -20 5 7
ltibia 40
2
root 1.5 2 3 11 20 30
lfemur -21 5 7
ltibia 41
"""
TRC = (
    b"PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t3\t2\tmm\n"
    b"Frame#\tTime\tHeel\t\t\tToe\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
    b"1\t0.00\t1\t2\t3\t4\t5\t6\n2\t0.01\t1\t2\t3\t\t\t\n3\t0.02\t1\t2\t3\t4\t5\t6\n"
)
CSV = b"time,hip_x,hip_y,toe_x,toe_y\n0,0,0.9,0,0\n0.1,0.1,0.9,,\n0.2,0.2,0.9,0.2,0\n"
STO = (
    b"Coordinates\ninDegrees=no\nnColumns=3\nnRows=3\nendheader\n"
    b"time\thip\tknee\n0\t1\t2\n0.1\t2\t3\n0.2\t3\t4\n"
)
OBJ = b"# two triangles\nv 0 0 0\nv 1 0.1 0\nv 1 0 1\nv 0 0.2 1\nvn 0 1 0\nf 1//1 2//1 3//1 -1\n"
BOXES = (
    b'ground = "slope:5"\n[[box]]\nname = "kerb"\n'
    b"points = [[-2, 1.5], [2, 1.5], [2, 1.8], [-2, 1.8]]\nheight = 0.12\n"
)
FACTS = b"cell = 0.5\norigin = [0.0, 1.0]\nheight = [0.0, 1.5]\n"


def _png() -> bytes:
    file = io.BytesIO()
    levels = (np.arange(20, dtype=np.uint16) * 3000).reshape(4, 5)
    Image.fromarray(levels).save(file, format="PNG")
    return file.getvalue()


def _npz() -> bytes:
    file = io.BytesIO()
    np.savez(file, height=np.arange(12.0).reshape(3, 4), cell=0.5, origin=np.zeros(2))
    return file.getvalue()


def _glb() -> bytes:
    """A chain of three joints, one of which turns."""
    names = ("hips", "leftUpperLeg", "leftLowerLeg")
    nodes = [
        {"name": name, "translation": [0.0, 0.5, 0.0], "children": [k + 1] if k < 2 else []}
        for k, name in enumerate(names)
    ]
    document = {
        "asset": {"version": "2.0", "extras": {"gaitsmith": {"fps": 10.0, "frames": 2}}},
        "nodes": nodes,
        "skins": [{"joints": [0, 1, 2]}],
        "animations": [
            {
                "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
                "samplers": [{"input": 0, "output": 1, "interpolation": "LINEAR"}],
            }
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC4"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 8},
            {"buffer": 0, "byteOffset": 8, "byteLength": 32},
        ],
        "buffers": [{"byteLength": 40}],
    }
    numbers = np.array([0.0, 0.1, 0, 0, 0, 1, 0, 1, 0, 0], dtype="<f4").tobytes()
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 20 + len(text) + 8 + len(numbers)
    head = struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON")
    return head + text + struct.pack("<I4s", len(numbers), b"BIN\0") + numbers


#: A good file of each suffix; an .asf is read with a good .amc beside it, a .png with its facts.
SEEDS: dict[str, bytes] = {
    ".bvh": BVH,
    ".asf": ASF,
    ".amc": AMC,
    ".trc": TRC,
    ".csv": CSV,
    ".sto": STO,
    ".obj": OBJ,
    ".png": _png(),
    ".npz": _npz(),
    ".toml": BOXES,
    ".glb": _glb(),
}
#: Those that are grounds.
GROUND_FILES = (".obj", ".png", ".npz", ".toml")
#: Words that mean something to some reader: what mutations put in.
WORDS: tuple[bytes, ...] = (
    *(b"HIERARCHY", b"MOTION", b"JOINT x", b"ROOT y", b"End Site", b"OFFSET 0 0 0", b"{", b"}"),
    *(b"CHANNELS 6 ", b"CHANNELS 0", b"Xposition", b"Frames: 1000000000", b"Frame Time: 0", b":"),
    *(b"begin", b"end", b"dof rx", b"axis 1 2 3 ZYX", b"length 0", b":root", b":hierarchy", b"#"),
    *(b"endheader", b"nRows=99999999999", b"time", b"_x", b"_z,", b",,", b"\t\t\t", b"\n\n\n"),
    *(b"nan", b"inf", b"-1", b"1e308", b"1e-320", b"1_0", b"0x1", b"9" * 400, b"\x00", b"\xff"),
    *(b"\r", b"\xef\xbb\xbf", b"\xff\xfe", b"\x1a", b'"', b" " * 70000, b"\xe2\x80\xa8"),
)


def try_to_read(suffix: str, data: bytes) -> bool:
    """Read ``data`` as a file of ``suffix``; whether it was one. Raises what must not be."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", GaitsmithWarning)
        path = Path(folder) / f"x{suffix}"
        path.write_bytes(data)
        if suffix == ".amc":
            path.with_suffix(".asf").write_bytes(ASF)
        if suffix == ".asf":
            path = path.with_suffix(".amc")
            path.write_bytes(AMC)
        if suffix == ".png":
            path.with_suffix(".toml").write_bytes(FACTS)
        motions = {**READERS, **MARKER_READERS, **TABLE_READERS}
        read = read_ground if suffix in GROUND_FILES else motions[path.suffix]
        try:
            result = read(path)
        except FileFormatError as error:
            refused = str(error)
        except InvalidInputError as error:
            refused = str(error)
        else:
            _check(suffix, data, result, Path(folder) / "again.bvh")
            return True
        assert len(refused.splitlines()) == 1
        return False


def _check(suffix: str, data: bytes, result: object, path: Path) -> None:
    """Numbers are finite, and a BVH survives being written."""
    for field in ("root_position", "rotations", "positions", "values", "heights"):
        assert np.isfinite(getattr(result, field, 0.0)).all()
    if suffix != ".bvh":
        return
    file = parse_bvh(data)
    write_bvh_file(file, path)
    back = parse_bvh(path.read_bytes())
    assert back.parents == file.parents
    assert back.frame_time == file.frame_time
    assert np.array_equal(back.offsets, file.offsets)
    kept = [
        column.start + i
        for names, column in zip(file.channels, back.columns, strict=True)
        for i in range(len(names))
    ]
    assert np.array_equal(back.values[:, kept], file.values)
