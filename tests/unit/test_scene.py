"""Scenes: one time axis, everybody as alone, who walks through whom, and every file."""

from __future__ import annotations

import json

import numpy as np
import pytest
from glb import Glb
from judge import broken

import gaitsmith
from gaitsmith import (
    FileFormatError,
    GaitsmithWarning,
    InfeasibleError,
    InvalidInputError,
    Performance,
    Scene,
    Start,
    Walker,
    load,
    load_performance,
    perform,
    regenerate,
    save_all,
    walk,
)
from gaitsmith.errors import UnknownNameError
from gaitsmith.io.gltf import write_glb
from gaitsmith.motion.kinematics import joint_positions
from gaitsmith.plan.surroundings import Obstacle, Surroundings
from gaitsmith.scene.meeting import closest_points, encounters

CHILD = Walker("child", body=1.2, do="walk to 0,1.5; turn left 90", variation=1.0)
TALL = Walker(
    "tall", body=2.0, start=Start((1.5, 2.0), -0.7), do="walk to 1.2,0 speed 1", begin=0.7
)
FAR = Walker("far", distance=2.0, start=Start((4.0, 0.0), 1.0), speed=1.1)


@pytest.fixture(scope="module")
def three():
    return perform(Scene((CHILD, TALL, FAR)), fps=30.0, seed=3)


def same(one, other):
    np.testing.assert_array_equal(one.rotations, other.rotations)
    np.testing.assert_array_equal(one.root_position, other.root_position)
    np.testing.assert_array_equal(one.contacts, other.contacts)
    assert one.labels.recipe == other.labels.recipe
    np.testing.assert_array_equal(one.labels.footstep_time, other.labels.footstep_time)


def test_everybody_is_on_one_time_axis_and_keeps_every_promise(three):
    assert three.names == ("child", "tall", "far")
    assert {(len(m), m.fps) for _, m in three} == {(len(three.motions[0]), 30.0)}
    for name, motion in three:
        assert not broken(motion), name


def test_everybody_walks_as_alone(three):
    """Sizes, places, begins; who has arrived stands on."""
    alone = walk(do="walk to 0,1.5; turn left 90", body=1.2, variation=1.0, seed=3, fps=30.0)
    motion = three["child"]
    np.testing.assert_array_equal(motion.rotations[: len(alone)], alone.rotations)
    rest = np.broadcast_to(alone.root_position[-1], motion.root_position[len(alone) :].shape)
    np.testing.assert_array_equal(motion.root_position[len(alone) :], rest)
    begun = np.flatnonzero(np.abs(np.diff(three["tall"].rotations, axis=0)).max((1, 2)) > 0.0)
    assert begun[0] == 21, "the first frame after 0.7 s moves"
    np.testing.assert_allclose(three["far"].root_position[0, [0, 2]], (4.0, 0.0), atol=1e-3)


def test_each_recipe_regenerates_its_walker(three):
    for _, motion in three:
        same(regenerate(motion), motion)


def test_the_seed_of_a_scene_gives_everybody_another_one():
    def seeds(walkers, seed):
        made = perform(Scene(walkers), fps=10.0, seed=seed)
        return [json.loads(m.labels.recipe)["walk"]["seed"] for _, m in made]

    two = Walker("a", distance=1.0), Walker("b", distance=1.0, start=Start((3, 0)), seed=9)
    assert seeds(two, 0) == [0, 9]
    assert seeds((*two, Walker("c", distance=1.0, start=Start((6, 0)))), 5) == [5, 9, 7]


def test_a_scene_of_one_is_the_walk():
    one = perform(Scene((Walker(distance=1.5, speed=1.0),)), fps=24.0)
    same(one["walker"], walk(distance=1.5, speed=1.0, fps=24.0))


def test_all_who_cannot_are_named():
    fast = Walker("fast", distance=2.0, speed=5.0)
    long = Walker("long", distance=2.0, step_length=2.0)
    odd = Walker("odd", distance=2.0, step_width=1.9)
    with pytest.raises(InfeasibleError, match=r"^fast: speed 5.000 .*; long: .* step length of 2"):
        perform(Scene((fast, CHILD, long)), fps=10.0)
    with pytest.raises(InvalidInputError, match="odd: step_width"):
        perform(Scene((odd, CHILD)), fps=10.0)
    with pytest.raises(FileFormatError, match=r"s\.toml: odd: step_width"):
        perform(Scene((odd, CHILD), source="s.toml"), fps=10.0)


def test_warnings_say_whose_they_are():
    brisk = Walker("brisk", distance=2.0, speed=2.0)
    with pytest.warns(GaitsmithWarning, match=r"^brisk: 2.00 m/s is Froude number"):
        perform(Scene((brisk, FAR)), fps=10.0)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Scene(()), "at least one walker"),
        (lambda: Scene((FAR, Walker("FAR", distance=1))), "two walkers have the name 'FAR'"),
        (lambda: Scene((FAR,), ground="moon"), "unknown ground 'moon'"),
        (lambda: Walker("a b", distance=1), "must begin with a letter"),
        (lambda: Walker("a"), "say where to walk by one of"),
        (lambda: Walker("a", distance=1, do="stand 1"), "got do and distance"),
        (lambda: Walker("a", distance=1, begin=-1.0), "begin must be from 0 to 3600 s"),
        (lambda: Walker("a", distance=1, start="walk"), "everybody starts standing"),
    ],
)
def test_what_is_no_scene_is_refused(make, says):
    with pytest.raises(InvalidInputError, match=says):
        make()


# through each other ------------------------------------------------------------------------------


def meeting(gap, **changes):
    """Two who walk towards each other on lines ``gap`` apart."""
    ann = Walker("ann", body=1.7, do="walk to 0,4")
    ben = Walker("ben", body=1.5, start=Start((gap, 4.0), np.pi), do=f"walk to {gap},0", **changes)
    return Scene((ann, ben))


def test_two_who_walk_through_each_other_are_warned_of():
    with pytest.warns(GaitsmithWarning, match="ann and ben walk through each other") as caught:
        made = perform(meeting(0.0), fps=30.0)
    (found,) = encounters(made)
    assert str(caught[0].message) == found.text
    gap = np.linalg.norm(made["ann"].root_position - made["ben"].root_position, axis=1)
    assert found.time == pytest.approx(gap.argmin() / 30.0, abs=0.2)
    assert found.begin < found.time < found.end
    at = made["ann"].root_position[round(found.time * 30.0), [0, 2]]
    np.testing.assert_allclose(found.place, at, atol=0.3)
    assert 0.05 < found.depth < 0.35
    assert f"near {found.place[0]:.2f},{found.place[1]:.2f}" in found.text


@pytest.mark.parametrize("scene", [meeting(0.9), meeting(0.0, begin=12.0)])
def test_two_who_pass_are_not(scene):
    ends = [walker for walker in scene.walkers if walker.begin]
    if ends:  # who waits long finds the other on the spot: let that one walk on
        ann = Walker("ann", body=1.7, do="walk to 0,3; walk to 2,6")
        scene = Scene((ann, scene.walkers[1]))
    assert not encounters(perform(scene, fps=20.0))


def test_bodies_overlap_where_a_fine_search_says():
    """Nearest points of segments against a grid over both."""
    rng = np.random.default_rng(0)
    p, q, r, s = rng.normal(size=(4, 200, 3))
    q[:20] = p[:20]
    s[10:30] = r[10:30]
    s[30:40] = r[30:40] + 2.0 * (q[30:40] - p[30:40])  # parallel
    a, b = closest_points(p, q, r, s)
    t = np.linspace(0.0, 1.0, 101)[:, None, None]
    one, other = p + t * (q - p), r + t * (s - r)
    grid = np.linalg.norm(one[:, None] - other[None], axis=-1).min(axis=(0, 1))
    found = np.linalg.norm(a - b, axis=-1)
    assert (found <= grid + 1e-12).all()
    assert (found >= grid - 0.06).all()


# files -------------------------------------------------------------------------------------------


def test_an_npz_of_several_gives_everybody_back(three, tmp_path):
    path = tmp_path / "three.npz"
    gaitsmith.save(three, path)
    back = load_performance(path)
    assert back.names == three.names
    for (_, one), (_, other) in zip(back, three, strict=True):
        same(one, other)
    with pytest.warns(GaitsmithWarning, match="of the walkers child, tall, far the first is taken"):
        same(load(path), three["child"])
    same(load(path, walker="far"), three["far"])
    with pytest.raises(UnknownNameError, match=r"unknown walker 'fat'.*Did you mean 'far'"):
        load(path, walker="fat")


def test_the_first_walker_of_an_npz_is_a_motion_of_its_own(three, tmp_path):
    """Whoever reads a file of one person reads that."""
    together, alone = tmp_path / "three.npz", tmp_path / "child.npz"
    gaitsmith.save(three, together)
    gaitsmith.save(three["child"], alone)
    with np.load(together) as all_, np.load(alone) as one:
        assert all_["walkers"].tolist() == ["child", "tall", "far"]
        for key in one.files:
            np.testing.assert_array_equal(all_[key], one[key], err_msg=key)
        assert {k.partition("/")[0] for k in all_.files if "/" in k} == {"tall", "far"}
        theirs = {k.partition("/")[2] for k in all_.files if k.startswith("tall/")}
        assert theirs == set(one.files) - {"format"}
    assert load_performance(alone).names == ("walker",)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"walkers": np.array(["a", "b"])}, "'b/fps' is missing|b/format|is missing"),
        ({"walkers": np.array([1.0])}, "'walkers' must be names"),
        ({"walkers": np.array(["a/b"])}, "must begin with a letter"),
        ({"surroundings": np.array("{")}, "surroundings must be JSON"),
    ],
)
def test_a_broken_file_of_several_is_refused(three, tmp_path, change, says):
    path = tmp_path / "three.npz"
    gaitsmith.save(three, path)
    with np.load(path) as data:
        arrays = {**{key: data[key] for key in data.files}, **change}
    np.savez(path, **arrays)
    with pytest.raises(FileFormatError, match=says):
        load_performance(path)


def test_a_glb_of_several_moves_everybody(three, tmp_path):
    path = tmp_path / "three.glb"
    write_glb(three, path)
    glb = Glb(path.read_bytes())
    names = [node["name"] for node in glb.nodes]
    assert len(set(names)) == len(names)
    assert len(glb.document["animations"]) == 1
    assert len(glb.document["skins"]) == len(glb.document["meshes"]) == 3
    roots = [names[k] for k in glb.document["scenes"][0]["nodes"]]
    assert roots == [f"{n}_{part}" for n in three.names for part in ("Armature", "mannequin")]
    for frame in (0, 40, len(three.motions[0]) - 1):
        world = glb.world(frame)
        for name, motion in three:
            expected = joint_positions(motion)[frame]
            for joint, at in zip(motion.skeleton.names, expected, strict=True):
                mine = world[names.index(f"{name}_{joint}"), :3, 3]
                np.testing.assert_allclose(mine, at, atol=1e-5)
    extras = glb.document["asset"]["extras"]["gaitsmith"]
    assert list(extras["walkers"]) == list(three.names)
    assert extras["walkers"]["far"]["recipe"] == three["far"].labels.recipe


def test_one_file_each_where_the_name_says_walker(three, tmp_path):
    made = save_all(three, [tmp_path / "x-{walker}.bvh", tmp_path / "all.glb"])
    assert [p.name for p in made] == ["x-child.bvh", "x-tall.bvh", "x-far.bvh", "all.glb"]
    assert all(p.stat().st_size > 1000 for p in made)
    assert len(load(made[1])) == len(three["tall"])


@pytest.mark.parametrize("name", ["all.bvh", "all.csv"])
def test_formats_of_one_person_name_the_way_out(three, tmp_path, name):
    stem, suffix = name.split(".")
    with pytest.raises(InvalidInputError, match=rf"{stem}-\{{walker\}}\.{suffix}, or all in one"):
        save_all(three, [tmp_path / "all.npz", tmp_path / name])
    with pytest.raises(InvalidInputError, match=r"cannot write '\.xyz' files"):
        save_all(three, [tmp_path / "all.xyz"])
    with pytest.raises(InvalidInputError, match="would be written twice"):
        save_all(three, [tmp_path / "{walker}.npz", tmp_path / "far.npz"])
    assert not list(tmp_path.iterdir())


def test_a_scene_of_one_is_written_as_its_walk(tmp_path):
    scene = Scene((Walker(distance=1.0),))
    one, motion = perform(scene, fps=20.0), walk(distance=1.0, fps=20.0)
    for suffix in (".npz", ".bvh", ".glb", ".csv"):
        made = [tmp_path / f"scene{suffix}", tmp_path / f"walk{suffix}"]
        gaitsmith.save(one, made[0])
        gaitsmith.save(motion, made[1])
        assert made[0].read_bytes() == made[1].read_bytes(), suffix


def test_what_stands_around_goes_along(tmp_path):
    table = Obstacle(((5.0, 5.0), (6.0, 5.0), (6.0, 6.0)), "table")
    made = perform(Scene((CHILD, FAR), Surroundings((table,))), fps=10.0)
    assert json.loads(made.surroundings)["obstacles"][0]["name"] == "table"
    gaitsmith.save(made, tmp_path / "a.npz")
    assert load_performance(tmp_path / "a.npz").surroundings == made.surroundings


def test_everybody_walks_round_what_stands_around():
    table = Obstacle(((-0.4, 1.5), (0.4, 1.5), (0.4, 2.0), (-0.4, 2.0)), "table")
    scene = Scene(
        (Walker("Ann", do="walk to 0,4"), Walker("Ben", start=Start((2.0, 0.0)), do="walk to 2,2")),
        Surroundings((table,)),
    )
    made = perform(scene, fps=10.0)
    assert np.abs(made.motions[0].root_position[:, 0]).max() > 0.7
    assert "table" in made.motions[0].labels.recipe
    with pytest.raises(InfeasibleError, match=r"Ann: action 1 .* inside 'table'"):
        perform(Scene((Walker("Ann", do="walk to 0,1.8"), CHILD), Surroundings((table,))))


def test_motions_of_other_lengths_are_no_performance():
    one, other = walk(distance=1.0, fps=10.0), walk(distance=2.0, fps=10.0)
    with pytest.raises(InvalidInputError, match="they need one time axis"):
        Performance(("a", "b"), (one, other))
    with pytest.raises(InvalidInputError, match="two walkers have one name"):
        Performance(("a", "A"), (one, one))
    with pytest.raises(InvalidInputError, match="a motion for each of its names"):
        Performance(("a",), ())
