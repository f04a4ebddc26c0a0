"""Walks among things: nothing is touched, bars and posts are passed by 2 cm, just so."""

from __future__ import annotations

import re

import numpy as np
import pytest
from judge import broken, posed
from room import room_to_outline, room_to_rod

from gaitsmith.body.masses import center_of_mass, segments_of
from gaitsmith.errors import InfeasibleError
from gaitsmith.learning import body_of
from gaitsmith.pipeline import regenerate, walk
from gaitsmith.plan.surroundings import Bar, Obstacle, Post, Surroundings

TABLE = Obstacle(((-0.5, 2.0), (0.5, 2.0), (0.5, 3.0), (-0.5, 3.0)), "table")


def beam(height, **more):
    return Bar((-1.5, 2.5), (1.5, 2.5), height, name="beam", **more)


def room_under(motion, body, bar):
    (x0, z0), (x1, z1), y = bar.begin, bar.end, bar.height + bar.radius
    return room_to_rod(motion, body_of(body), (x0, y, z0), (x1, y, z1), bar.radius)


def room_beside(motion, body, post):
    x, z = post.at
    ends = (x, post.bottom, z), (x, post.top, z)
    return room_to_rod(motion, body_of(body), *ends, post.radius)


def test_nothing_around_changes_nothing():
    far = Surroundings(
        (Obstacle(((5, 0), (6, 0), (6, 4)), "far"),), (beam(2.2),), (Post((1.2, 2.0)),)
    )
    one, other = (
        walk(do="walk to 0,3", fps=30.0),
        walk(do="walk to 0,3", fps=30.0, surroundings=far),
    )
    np.testing.assert_array_equal(one.rotations, other.rotations)
    np.testing.assert_array_equal(one.root_position, other.root_position)
    assert "surroundings" not in one.labels.recipe


def test_a_walk_among_things_is_reproduced_to_the_byte():
    things = Surroundings((TABLE,), (Bar((-2, 4.2), (2, 4.2), 1.5),), (Post((0.3, 5.2)),))
    motion = walk(do="walk to 0,6", fps=30.0, surroundings=things)
    again = regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)
    np.testing.assert_array_equal(again.root_position, motion.root_position)
    assert again.labels.recipe == motion.labels.recipe


@pytest.mark.parametrize(
    ("script", "body"),
    [
        ("walk to 0.2,5", 1.75),
        ("be at 0,3.7 facing 180", 1.3),
        ("walk to 1.2,2.5; walk to 0,4", 2.0),
    ],
)
def test_an_obstacle_is_walked_round(script, body):
    motion = walk(do=script, body=body, surroundings=Surroundings((TABLE,)))
    assert room_to_outline(motion, body_of(body), TABLE.points) > 0.0
    assert not broken(motion)


@pytest.mark.parametrize(
    "where",
    [
        {"path": "0,0 0,5"},
        {"do": "follow 0.3,5"},
        {"do": "walk to 0,1.2; step forward 1"},
        {"distance": 4.0},
        {
            "steps": [
                {"side": "LR"[i % 2], "x": 0.05 - 0.1 * (i % 2), "z": 0.5 * max(i - 1, 0)}
                | {"heading_deg": 0.0}
                for i in range(7)
            ]
        },
    ],
    ids=["path", "follow", "step", "distance", "steps"],
)
def test_a_given_way_into_an_obstacle_is_refused_by_name_and_place(where):
    with pytest.raises(InfeasibleError, match=r"inside 'table' at x,y,z .* after .* s"):
        walk(**where, surroundings=Surroundings((TABLE,)))


def test_who_cannot_stand_at_a_goal_is_told_where():
    with pytest.raises(InfeasibleError, match=r"action 1 \(WalkTo\): .* 0.05 m from 'table'"):
        walk(do="walk to 0,3.05", surroundings=Surroundings((TABLE,)))
    with pytest.raises(InfeasibleError, match=r"action 2 \(BeAt\): .* reached is 0\.00,1\.5"):
        walk(do="walk to 0,1.5; be at 0,1.85", surroundings=Surroundings((TABLE,)))


@pytest.mark.parametrize(("share", "body"), [(0.66, 1.2), (0.75, 1.75), (0.95, 1.75)])
def test_a_bar_is_ducked_under_as_much_as_needed(share, body):
    bar = beam(share * body)
    motion = walk(distance=5.0, body=body, surroundings=Surroundings(bars=(bar,)))
    room = room_under(motion, body, bar)
    assert 0.0195 < room.min() < 0.032, "m"
    assert not broken(motion)
    # upright again two steps before and after
    rest = walk(distance=5.0, body=body)
    away = np.abs(rest.root_position[:, 2] - 2.5) > 1.9 * body / 1.75
    np.testing.assert_allclose(motion.root_position[away], rest.root_position[away], atol=1e-9)


def test_a_ducking_person_bends_hips_and_knees_and_looks_ahead():
    motion = walk(distance=5.0, surroundings=Surroundings(bars=(beam(1.3),)))
    free = walk(distance=5.0)
    positions, world, _ = posed(motion)
    at = int(np.abs(motion.root_position[:, 2] - 2.5).argmin())
    index = motion.skeleton.index

    def pitch(name, way):
        x, y, z = world[index(name)].apply(way)[at]
        return np.degrees(np.arctan2(y, np.hypot(x, z)))

    assert free.root_position[at, 1] - motion.root_position[at, 1] > 0.08, "knees bend"
    assert pitch("hips", [0.0, 0.0, 1.0]) < -12.0, "so do hips"
    assert pitch("upperChest", [0.0, 0.0, 1.0]) < -30.0
    assert pitch("head", [0.0, 0.0, 1.0]) > -40.0, "eyes stay on the way"
    turned = np.diff(motion.root_position, 2, axis=0) * 60.0**2
    assert np.abs(turned[:, 1]).max() < 12.0, "m/s2: no drop"
    hands = [positions[:, index(f"{s}Hand"), 1].min() for s in ("left", "right")]
    assert min(hands) > 0.25, "m"


def test_a_bar_that_is_too_low_is_refused_with_the_limit():
    with pytest.raises(InfeasibleError, match=r"'beam' at \(0\.00, 2\.50\), 1\.00 m high, is too"):
        walk(distance=5.0, surroundings=Surroundings(bars=(beam(1.0),)))
    with pytest.raises(InfeasibleError, match=r"ducks under bars from 1\.0") as caught:
        walk(distance=5.0, surroundings=Surroundings(bars=(beam(0.8),)))
    limit = float(str(caught.value).split("from ")[1].split(" m")[0])
    assert limit < 0.62 * 1.75
    bar = beam(limit + 0.01)
    motion = walk(distance=5.0, surroundings=Surroundings(bars=(bar,)))
    assert room_under(motion, 1.75, bar).min() > 0.0195


@pytest.mark.parametrize(
    ("at", "bottom"), [((0.30, 2.5), 0.0), ((-0.27, 2.2), 1.0), ((0.25, 2.9), 1.0)]
)
def test_a_post_is_leaned_past_on_a_given_way(at, bottom):
    post = Post(at, radius=0.02, bottom=bottom, name="pole")
    motion = walk(path="0,0 0,5", surroundings=Surroundings(posts=(post,)))
    room = room_beside(motion, 1.75, post)
    assert 0.0195 < room.min() < 0.05, "m"
    assert not broken(motion)
    free = walk(path="0,0 0,5")
    np.testing.assert_array_equal(motion.labels.footstep_position, free.labels.footstep_position)
    up = posed(motion)[1][motion.skeleton.index("upperChest")].apply([0.0, 1.0, 0.0])
    side = up[np.abs(up[:, 0]).argmax(), 0]
    assert side * at[0] < 0.0, "away from it"


def test_a_post_in_the_middle_is_refused_on_a_given_way_and_walked_round_on_a_free_one():
    post = Surroundings(posts=(Post((0.05, 2.5), name="pole"),))
    with pytest.raises(InfeasibleError, match=r"'pole' at \(0\.05, 2\.50\) stands in the way"):
        walk(path="0,0 0,5", surroundings=post)
    motion = walk(do="walk to 0,5", surroundings=post)
    assert room_beside(motion, 1.75, post.posts[0]).min() > 0.019


@pytest.mark.slow
def test_many_things_on_one_way():
    things = Surroundings(
        bars=(beam(1.5), Bar((-1, 3.0), (1, 3.2), 1.35), Bar((-1, 6), (1, 6.0), 1.6)),
        posts=(Post((0.28, 4.4), 0.02), Post((-0.28, 5.2), 0.02, bottom=0.7)),
    )
    motion = walk(distance=8.0, surroundings=things)
    for bar in things.bars:
        assert room_under(motion, 1.75, bar).min() > 0.0195
    for post in things.posts:
        assert room_beside(motion, 1.75, post).min() > 0.0195
    assert not broken(motion)


@pytest.mark.parametrize(
    ("lean", "body"),
    [("forward 30", 1.75), ("back 12", 2.0), ("left 20", 1.75), ("right 30", "child")],
)
def test_who_leans_keeps_the_mass_over_the_feet(lean, body):
    who = body_of(body)
    motion = walk(do=f"lean {lean}; stand 0.5; step back 0.2", body=body, fps=30.0)
    positions, *_ = posed(motion)
    com = center_of_mass(motion.skeleton, positions, segments_of(who))
    moved = np.linalg.norm((com - com[0])[:42, [0, 2]], axis=1)
    assert moved.max() < 0.006 * who.height, "m"
    hips = np.linalg.norm((motion.root_position - motion.root_position[0])[41, [0, 2]])
    assert hips > 0.012 * who.height, "the hips go the other way"
    assert not broken(motion)


def scene(seed):
    """A script and convex obstacles that leave the start free."""
    import shapely

    rng = np.random.default_rng(seed)
    obstacles: list[Obstacle] = []
    while len(obstacles) < 1 + seed % 8:
        points = rng.uniform(-4, 4, 2) + rng.uniform(0.1, 0.6) * rng.normal(size=(6, 2))
        hull = shapely.MultiPoint(points).convex_hull
        if hull.distance(shapely.Point(0, 0)) > 0.45 and hull.area > 0.01:
            corners = np.asarray(hull.exterior.coords)[:-1]
            obstacles.append(Obstacle(tuple(map(tuple, corners)), f"thing {len(obstacles)}"))
    (x, z), (x2, z2), a = rng.uniform(-4, 4, 2), rng.uniform(-4, 4, 2), rng.uniform(-180, 180)
    scripts = (
        f"walk to {x:.3f},{z:.3f}",
        f"be at {x:.3f},{z:.3f} facing {a:.1f}",
        f"walk to {x:.3f},{z:.3f}; walk to {x2:.3f},{z2:.3f}",
    )
    return scripts[seed % 3], tuple(obstacles)


@pytest.mark.slow
def test_no_body_point_is_inside_any_of_random_obstacles():
    refused = 0
    for seed in range(100):
        script, obstacles = scene(seed)
        body = (1.75, 1.2, 2.0)[seed % 3]
        try:
            motion = walk(do=script, body=body, fps=120.0, surroundings=Surroundings(obstacles))
        except InfeasibleError as error:
            refused += 1
            said = re.search(r"action (\d) .* reached is (\S+),(\S+)", str(error))
            if said is not None:  # what is named instead can be done
                actions = script.split("; ")[: int(said[1])]
                there = rf"\1 {said[2]},{said[3]}"
                actions[-1] = re.sub(r"(to|at) \S+", there, actions[-1])
                around = Surroundings(obstacles)
                walk(do="; ".join(actions), body=body, fps=30.0, surroundings=around)
            continue
        for obstacle in obstacles:
            assert room_to_outline(motion, body_of(body), obstacle.points) > 0.0, seed
        assert not broken(motion), seed
    assert refused < 20, "goals inside or too near, only"


@pytest.mark.slow
@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_random_bars_and_posts_are_passed_by_two_centimeters(gait):
    rng = np.random.default_rng(7)
    for _ in range(40):
        body = float(rng.uniform(1.2, 2.0))
        angle, z = rng.uniform(-0.6, 0.6), rng.uniform(2.0, 4.0)
        reach = 1.5 * np.array([np.cos(angle), np.sin(angle)])
        bar = Bar(
            tuple(np.array([0.0, z]) - reach),
            tuple(np.array([0.0, z]) + reach),
            float(rng.uniform(0.66, 1.0) * body),
            float(rng.uniform(0.01, 0.06)),
        )
        aside = float(rng.choice([-1, 1]) * rng.uniform(0.17, 0.3) * body)
        post = Post((aside, z + 1.6), 0.02, float(rng.choice([0.0, 0.5 * body])))
        motion = walk(
            distance=z + 3.5, body=body, gait=gait, surroundings=Surroundings((), (bar,), (post,))
        )
        assert room_under(motion, body, bar).min() > 0.0195
        assert room_beside(motion, body, post).min() > 0.0195
        assert not broken(motion)
