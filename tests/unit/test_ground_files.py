"""Grounds from words, from height fields in files, and from meshes looked at from above."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from gaitsmith.errors import FileFormatError, InvalidInputError
from gaitsmith.ground import Flat, Slope, Stairs, field_from_mesh, read_ground

FIELD = {"height": np.arange(12.0).reshape(3, 4) / 10, "cell": 0.5, "origin": np.array([1.0, -2.0])}
SQUARE = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"


def obj(folder, text):
    path = folder / "ground.obj"
    path.write_text(text)
    return path


def test_words():
    assert read_ground("flat") == Flat()
    assert read_ground("slope:-10") == Slope(-10.0)
    assert read_ground(" stairs:0.17,0.29,10 ") == Stairs(0.17, 0.29, 10)
    assert read_ground("stairs:-0.15, 0.3, 4") == Stairs(-0.15, 0.3, 4)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("slope", "slope:DEG as in slope:10, got 'slope'"),
        ("slope:", "slope:DEG as in slope:10; '' is not a number"),
        ("slope:steep", "'steep' is not a number"),
        ("slope:nan", "ground slope must be a finite number of degrees"),
        ("slope:75", "from -60 to 60 degrees, got 75"),
        ("slope:1,2", "slope:DEG as in slope:10, got 'slope:1,2'"),
        ("flat:2", "this kind is flat, got 'flat:2'"),
        ("stairs:0.17,0.29", "stairs:RISE,TREAD,COUNT"),
        ("stairs:0,0.29,3", "rise must not be 0"),
        ("stairs:0.2,0.29,3.5", "whole number of risers"),
        ("stair:0.2,0.29,3", "unknown ground 'stair'.*Did you mean 'stairs'"),
        ("hills.tif", "cannot read a ground from '.tif' files; known suffixes: .npz, .obj, .png"),
        ("heightfield", "is read from a file"),
        ("", "unknown ground ''"),
    ],
)
def test_words_that_are_no_ground(words, says):
    with pytest.raises(InvalidInputError, match=says):
        read_ground(words)


def test_npz(tmp_path):
    np.savez(tmp_path / "hill.npz", **FIELD)
    ground = read_ground(str(tmp_path / "hill.npz"))
    assert np.array_equal(ground.heights, FIELD["height"])
    assert (ground.cell, ground.origin) == (0.5, (1.0, -2.0))
    assert ground.height(1.5, -1.5) == pytest.approx(0.5)
    assert read_ground(tmp_path / "hill.npz").as_json() == ground.as_json()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"cell": None}, "hill.npz: .*cell is missing, there are height, origin"),
        ({"cell": np.ones(2)}, "cell must be one number"),
        ({"cell": np.array(-1.0)}, "cell must be a positive number of meters"),
        ({"origin": np.zeros(3)}, "origin x,z"),
        ({"height": np.zeros(4)}, "height must have shape"),
        ({"height": np.full((3, 3), np.inf)}, "height must be finite"),
        ({"height": np.array(["a"])}, "array of numbers"),
        ({"height": np.array([None])}, "not a readable npz archive: Object arrays"),
    ],
)
def test_npz_that_is_no_height_field(tmp_path, change, says):
    arrays = {k: v for k, v in {**FIELD, **change}.items() if v is not None}
    np.savez(tmp_path / "hill.npz", **arrays)
    with pytest.raises(FileFormatError, match=says):
        read_ground(tmp_path / "hill.npz")


@pytest.mark.parametrize("suffix", [".npz", ".png", ".obj"])
def test_files_that_are_not_there_or_broken(tmp_path, suffix):
    path = tmp_path / f"hill{suffix}"
    path.with_suffix(".toml").write_text("cell = 1\norigin = [0, 0]\nheight = [0, 1]\n")
    with pytest.raises(FileFormatError, match=r"hill\S+: cannot be read: No such file"):
        read_ground(path)
    path.write_bytes(b"\x00\x01 nothing")
    with pytest.raises(FileFormatError, match=r"hill"):
        read_ground(path)


def png(folder, levels, facts="cell = 0.5\norigin = [1.0, -2.0]\nheight = [-1.0, 3.0]\n"):
    path = folder / "hill.png"
    Image.fromarray(levels).save(path)
    if facts is not None:
        path.with_suffix(".toml").write_text(facts)
    return path


def test_png(tmp_path):
    """The first row of the picture is height[0]; black and white are the two heights."""
    levels = np.array([[0, 65535, 0], [32768, 0, 0]], dtype=np.uint16)
    ground = read_ground(png(tmp_path, levels))
    assert ground.heights[0].tolist() == [-1.0, 3.0, -1.0]
    assert ground.heights[1, 0] == pytest.approx(-1.0 + 4.0 * 32768 / 65535, abs=1e-6)
    assert (ground.cell, ground.origin) == (0.5, (1.0, -2.0))


@pytest.mark.parametrize(
    ("facts", "says"),
    [
        (None, "needs hill.toml beside it"),
        ("cell = ", "hill.toml: not a TOML file"),
        ("cell = 1\norigin = [0, 0]", "height is missing"),
        ("cell = 1\norigin = [0, 0]\nheight = [0, 1]\nscale = 2", "scale: unknown key"),
        ("cell = 1\norigin = [0]\nheight = [0, 1]", "origin must be two numbers"),
        ("cell = 1\norigin = [0, 0]\nheight = [1, 1]", "two different heights"),
        ('cell = "a"\norigin = [0, 0]\nheight = [0, 1]', "cell must be a positive number"),
    ],
)
def test_png_without_its_facts(tmp_path, facts, says):
    with pytest.raises(FileFormatError, match=says):
        read_ground(png(tmp_path, np.zeros((3, 3), dtype=np.uint16), facts))


def test_png_of_8_bits_is_refused(tmp_path):
    with pytest.raises(FileFormatError, match="16-bit gray levels, is PNG L"):
        read_ground(png(tmp_path, np.zeros((3, 3), dtype=np.uint8)))


def test_obj_of_a_square(tmp_path):
    """A quadrangle, a comment, what ground does not need, indices of three parts."""
    text = f"# made by hand\no thing\n{SQUARE}vt 0 0\nvn 0 1 0\ns 1\nf 1/1/1 2/1/1 3//1 4\n"
    ground = read_ground(obj(tmp_path, text))
    assert ground.cell == pytest.approx(0.02)
    assert ground.origin == (-1.0, -1.0)
    assert ground.heights.shape == (101, 101)
    assert (ground.heights == 0.0).all()


def test_obj_counts_back_and_goes_on_in_the_next_line(tmp_path):
    assert (read_ground(obj(tmp_path, SQUARE + "f -4 -3 \\\n -2 -1")).heights == 0.0).all()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("v 0 0\n", "ground.obj:1: a corner is 'v x y z' in meters, got 'v 0 0'"),
        ("v 0 0 x\n", "obj:1: a corner"),
        ("v 0 0 nan\n", "obj:1: a corner must be finite"),
        (SQUARE + "f 1 2\n", "obj:5: a face has 3 or more corners, got 2"),
        (SQUARE + "f 1 2 b\n", "obj:5: a corner of a face is an index .* got 'b'"),
        (SQUARE + "f 1 2 0\n", "obj:5: corner 0 of the face is none: 4 so far"),
        (SQUARE + "f 1 2 -5\n", "obj:5: corner -5 of the face is none"),
        (SQUARE + "\nf 1 2 9\n", "obj:6: the face names corner 9, the file has 4"),
        (SQUARE, "has no faces"),
        ("", "has no faces"),
        (SQUARE + "f 1 1 2\n", "too small to stand on"),
        ("v 0 0 0\nv 0 1 0\nv 0.001 0 0\nf 1 2 3\n", "too small to stand on"),
        ("v 0 0 0\nv 1 1 1\nv 2 0 2\nf 1 2 3\n", "upright"),
        ("v 0 0 0\nv 900 0 0\nv 0 0 900\nf 1 2 3\n", "cut out the part that is walked on"),
    ],
)
def test_obj_that_is_no_ground(tmp_path, text, says):
    with pytest.raises(FileFormatError, match=says):
        read_ground(obj(tmp_path, text))


def test_a_tilted_triangle_is_its_plane():
    corners = np.array([[0.0, 0.0, 0.0], [3.0, 0.6, 0.0], [0.0, -0.9, 3.0]])
    ground = field_from_mesh(corners, np.array([[0, 1, 2]]))
    rng = np.random.default_rng(0)
    x, z = rng.uniform(0.0, 1.4, (2, 200))
    np.testing.assert_allclose(ground.height(x, z), 0.2 * x - 0.3 * z, atol=2e-5)
    # nobody is led over what is not there
    assert ground.height(2.5, 2.5) == pytest.approx(-0.9 - 1.0, abs=0.02)
    assert ground.stepped


def surface(count, size, height):
    """Triangles of a grid of ``count`` cells over ``size`` m, heights by a function."""
    x, z = np.meshgrid(*[np.linspace(0.0, size, count + 1)] * 2)
    corners = np.stack([x, height(x, z), z], axis=-1).reshape(-1, 3)
    k = np.arange(count)[:, None] * (count + 1) + np.arange(count)
    a, b, c, d = (i.reshape(-1) for i in (k, k + 1, k + count + 1, k + count + 2))
    return corners, np.concatenate([np.stack([a, c, b], 1), np.stack([b, c, d], 1)])


def test_a_surface_is_seen_as_it_is():
    """Fine waves of 6 cm, whatever the order of corners; between samples within a millimeter."""

    def wave(x, z):
        return 0.06 * np.sin(2.0 * x) * np.cos(1.5 * z + 0.3)

    corners, triangles = surface(150, 3.0, wave)
    triangles[::3] = triangles[::3, ::-1]
    ground = field_from_mesh(corners, triangles)
    x, z = np.random.default_rng(1).uniform(0.0, 3.0, (2, 2000))
    np.testing.assert_allclose(ground.height(x, z), wave(x, z), atol=3e-4)
    assert not ground.stepped


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_no_cracks_between_triangles(turn):
    """Of a plane in odd triangles, turned any way, no sample is missed inside."""
    rng = np.random.default_rng(3)
    corners, triangles = surface(37, 2.0, lambda x, z: 0.0 * x)
    inner = (corners[:, [0, 2]] > 0.01).all(1) & (corners[:, [0, 2]] < 1.99).all(1)
    corners[inner] += rng.uniform(-0.015, 0.015, (inner.sum(), 3)) * [1.0, 0.0, 1.0]
    c, s = np.cos(turn), np.sin(turn)
    corners = corners @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    ground = field_from_mesh(corners, triangles)
    x, z = rng.uniform(0.05, 1.95, (2, 4000))
    assert (ground.height(c * x + s * z, -s * x + c * z) == 0.0).all()


def test_the_highest_of_several_counts():
    """A table of 40 cm over the floor; its underside and legs are not seen."""
    floor, faces = surface(4, 2.0, lambda x, z: 0.0 * x)
    top = np.array([[0.5, 0.4, 0.5], [1.5, 0.4, 0.5], [1.5, 0.4, 1.5], [0.5, 0.4, 1.5]])
    corners = np.concatenate([floor, top, top - [0.0, 0.05, 0.0]])
    k = len(floor)
    table = np.array([[k, k + 1, k + 2], [k, k + 2, k + 3], [k + 4, k + 5, k + 6]])
    ground = field_from_mesh(corners, np.concatenate([faces, table]))
    assert ground.height(1.0, 1.0) == pytest.approx(0.4)
    assert ground.height(0.4, 1.0) == 0.0


def test_stairs_as_a_mesh_are_stairs_but_for_one_cell_at_each_riser():
    """Treads and risers as quadrangles in a file."""
    stairs = Stairs(0.17, 0.3, 4)
    z = [0.0, *stairs.risers, 3.0]
    corners, triangles = [], []
    for k in range(len(z) - 1):
        for low, high in ((0.17 * k, 0.17 * k), (0.17 * k, 0.17 * (k + 1))):
            n = len(corners)
            begin, end = (z[k], z[k + 1]) if low == high else (z[k + 1], z[k + 1])
            corners += [[0, low, begin], [1, low, begin], [1, high, end], [0, high, end]]
            triangles += [[n, n + 1, n + 2], [n, n + 2, n + 3]]
    ground = field_from_mesh(np.array(corners, dtype=float), np.array(triangles))
    at = np.linspace(0.01, 2.5, 900)
    off = np.abs(at[:, None] - stairs.risers).min(axis=1) > 0.021
    np.testing.assert_allclose(
        ground.height(np.full(900, 0.5), at)[off], stairs.height(0.0, at)[off], atol=1e-5
    )
    edges = ground.edges((0.4, 0.0), (0.42, 2.5))
    rows = np.unique(np.round(edges.begin[:, 1], 6))
    np.testing.assert_allclose(rows, stairs.risers, atol=0.0101)
