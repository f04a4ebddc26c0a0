"""Low things are stepped over or on where that is cheaper than walking round; high ones never."""

from __future__ import annotations

import json

import numpy as np
import pytest
import shapely
from judge import along_soles, broken, shins_into_ground
from room import capsule_points

import gaitsmith
from gaitsmith.errors import GaitsmithError, InfeasibleError
from gaitsmith.learning import body_of
from gaitsmith.pipeline import regenerate, walk
from gaitsmith.plan.surroundings import Obstacle, Surroundings

#: A heel that hangs over an edge bears nothing: its footstep cannot be told from heel and ball.
ON_EDGES = ("footsteps_unseen",)


def box(x0, z0, x1, z1, height, name="box"):
    return Obstacle(((x0, z0), (x1, z0), (x1, z1), (x0, z1)), name, height)


KERB = box(-3.0, 2.0, 3.0, 2.3, 0.14, "kerb")
PLATFORM = box(-3.0, 2.0, 3.0, 4.0, 0.2, "platform")
BLOCK = box(-0.3, 3.0, 0.3, 5.0, 0.22, "block")


def among(*obstacles, **asked):
    """A walk at 120 frames a second that keeps the promises, on the ground and over its edges."""
    motion = walk(fps=120.0, surroundings=Surroundings(obstacles), **asked)
    assert broken(motion, but=ON_EDGES) == {}
    assert shins_into_ground(motion) <= 0.0005
    assert -along_soles(motion).max(0).min() <= 0.0005
    return motion


def aside(motion):
    return float(np.abs(motion.root_position[:, 0]).max())


def lift(motion):
    return float(motion.labels.footstep_position[:, 1].max())


@pytest.mark.parametrize("asked", [{"do": "walk to 0,4"}, {"distance": 4.0}, {"path": "0,0 0.2,4"}])
@pytest.mark.parametrize("body", [1.3, 1.75])
def test_a_kerb_across_the_way_is_gone_over(asked, body):
    motion = among(KERB, body=body, **asked)
    assert aside(motion) < 0.3
    assert motion.root_position[-1, 2] == pytest.approx(4.0, abs=0.15)
    assert json.loads(motion.labels.ground)["kind"] == "boxes"


@pytest.mark.slow
@pytest.mark.parametrize("ground", ["flat", "slope:7", "slope:-7"])
def test_a_wide_platform_is_stepped_on(ground):
    motion = among(PLATFORM, do="walk to 0,5.5", ground=ground)
    _, y, z = motion.labels.footstep_position.T
    level = z * np.tan(np.radians(float(ground.partition(":")[2] or 0.0)))
    on = (z > 2.2) & (z < 3.8)
    assert on.sum() >= 2
    np.testing.assert_allclose((y - level)[on], 0.2, atol=1e-6)
    assert aside(motion) < 0.1


@pytest.mark.slow
def test_what_is_narrow_is_walked_round():
    """A block in a long way: a little aside costs less than a step up and down."""
    motion = among(BLOCK, do="walk to 0,8")
    assert lift(motion) == 0.0
    assert aside(motion) > 0.5


@pytest.mark.slow
def test_the_same_block_is_gone_over_on_a_given_way():
    motion = among(BLOCK, do="follow 0,8")
    assert lift(motion) == pytest.approx(0.22)
    assert aside(motion) < 0.1


@pytest.mark.slow
def test_what_is_high_for_a_child_is_low_for_an_adult():
    wide = box(-0.8, 2.0, 0.8, 2.4, 0.2)
    child, adult = (among(wide, do="walk to 0,4", body=body) for body in (1.2, 1.8))
    assert aside(child) > 0.8 + 0.1
    assert aside(adult) < 0.1
    assert json.loads(child.labels.ground)["kind"] == "flat"


@pytest.mark.slow
def test_a_way_without_footholds_is_walked_round():
    """Planks too near to each other for a foot between them, and too narrow to stand on."""
    planks = [box(-0.7, z, 0.7, z + 0.03, 0.15, f"plank {z:.2f}") for z in np.arange(2.0, 4.0, 0.1)]
    motion = among(*planks, do="walk to 0,6")
    assert lift(motion) == 0.0
    assert aside(motion) > 0.7
    with pytest.raises(InfeasibleError, match=r"no place for a foot of 0\.\d+ m within a step"):
        walk(distance=6.0, surroundings=Surroundings(tuple(planks)))


@pytest.mark.slow
def test_a_goal_may_lie_on_something_low():
    motion = among(PLATFORM, do="walk to 0,3; turn left 180; walk to 0,0")
    assert lift(motion) == pytest.approx(0.2)
    assert motion.labels.footstep_position[-1, 1] == 0.0


def test_a_high_block_on_a_given_way_is_refused():
    high = box(-0.3, 3.0, 0.3, 5.0, 0.4, "crate")
    with pytest.raises(InfeasibleError, match="inside 'crate'"):
        walk(distance=6.0, surroundings=Surroundings((high,)))
    assert aside(among(high, do="walk to 0,8")) > 0.5


@pytest.mark.slow
def test_over_what_ends_below_the_hands_they_may_swing():
    """Beside a bench there is room for the legs; only a wall of the same outline is in the way."""
    bench = box(0.2, 1.0, 1.5, 3.0, 0.35, "bench")
    wall = Obstacle(bench.points, "wall")
    with pytest.raises(GaitsmithError, match="inside 'wall'"):
        walk(distance=4.0, surroundings=Surroundings((wall,)))
    motion = among(bench, distance=4.0)
    points, sizes = capsule_points(motion, body_of(1.75))
    low = points[..., 1] - sizes[:, None] < 0.35
    flat = shapely.points(points[..., 0], points[..., 2])
    away = shapely.distance(flat, shapely.Polygon(bench.points)) - sizes[:, None]
    assert away[low].min() > 0.0
    assert away.min() < 0.0


def test_its_top_is_over_the_ground_it_stands_on():
    """On a slope the bench of the same height is as high over the feet beside it."""
    bench = box(0.24, 1.0, 1.5, 3.0, 0.35, "bench")
    motion = among(bench, distance=4.0, ground="slope:8")
    assert motion.root_position[-1, 1] > 1.3


def test_it_is_reproduced_to_the_byte_and_measured(tmp_path):
    motion = walk(do="walk to 0,4", fps=60.0, ground="slope:5", surroundings=Surroundings((KERB,)))
    first, second = tmp_path / "one.npz", tmp_path / "two.npz"
    gaitsmith.save(motion, first)
    gaitsmith.save(regenerate(gaitsmith.load(first)), second)
    assert first.read_bytes() == second.read_bytes()
    figures = gaitsmith.measure(first)
    assert figures["penetration_mm_max"] < 0.5
    assert figures["float_mm_max"] < 1.0


def test_everybody_of_a_scene_has_their_own_way(tmp_path):
    (tmp_path / "yard.toml").write_text(
        """
[[walker]]
name = "adult"
do = "walk to 0,4"
[[walker]]
name = "child"
body = 1.2
start = {at = [0.5, 0], facing = 0}
do = "walk to 0.5,4"
begin = 2.0
[[obstacle]]
name = "step"
points = [[-1, 2], [1, 2], [1, 2.4], [-1, 2.4]]
height = 0.2
"""
    )
    both = gaitsmith.perform(tmp_path / "yard.toml", fps=30)
    adult, child = both.motions
    assert aside(adult) < 0.1
    assert np.abs(child.root_position[:, 0]).max() > 1.1
    assert json.loads(both.surroundings)["obstacles"][0]["height"] == 0.2
