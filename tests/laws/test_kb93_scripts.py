"""Walks, local steps and turns in any order: every promise holds, and nothing jumps."""

from __future__ import annotations

import numpy as np
import pytest
from judge import broken, posed

from gaitsmith.conventions import SIDES
from gaitsmith.pipeline import regenerate, walk

SCRIPTS = (
    "walk to 0,2; step back 0.3; turn left 130; walk to 2,1",
    "step left 0.5; step forward 0.7; turn right 60; step right 0.3; step back 0.5",
    "turn left 300; walk to -2,-1; face 0; lean forward 15; stand 0.3; lean forward 0",
    "follow 1,1 0,3; look at 2,1.4,2; be at 0.6,2.4 facing -120; look ahead; stand 0.6",
    "follow 0,1.5 0.2,0 1,1.5",
)
BODIES = (1.75, "child", 2.05)


def gaps(motion):
    """Distances of the axes of shins and feet, left against right, meters: ``(8, F)``."""
    positions, _, soles = posed(motion)
    index = motion.skeleton.index
    axes = [
        [
            (positions[:, index(f"{name}LowerLeg")], positions[:, index(f"{name}Foot")]),
            (soles[:, side, 0], soles[:, side, 2]),
        ]
        for side, name in enumerate(SIDES)
    ]
    u = np.linspace(0.0, 1.0, 33)[:, None, None]
    out = []
    for one in axes[0]:
        for two in axes[1]:
            for (a, b), (c, d) in ((one, two), (two, one)):
                # points of one axis to the other, which is a segment
                points, line = a + u * (b - a), d - c
                t = ((points - c) * line).sum(-1) / (line * line).sum(-1)
                nearest = c + np.clip(t, 0.0, 1.0)[..., None] * line
                out.append(np.linalg.norm(points - nearest, axis=-1).min(axis=0))
    return np.array(out)


@pytest.mark.parametrize(
    ("script", "body"),
    [(s, BODIES[i % 3]) for i, s in enumerate((*SCRIPTS, SCRIPTS[1]))],
)
def test_every_promise_holds_in_any_order(script, body):
    motion = walk(do=script, body=body, fps=60.0)
    assert not broken(motion)
    stature = 1.2 if body == "child" else float(body)
    assert gaps(motion).min() > 0.05 * stature / 1.75


@pytest.mark.parametrize("gait", ["neutral", "winter"])
def test_hips_and_joints_have_no_jump_between_walks_and_steps(gait):
    """Positions, and speeds: what a frame changes of the velocity is that of a person."""
    motion = walk(do=SCRIPTS[0], gait=gait, fps=240.0)
    positions, *_ = posed(motion)
    step = np.diff(positions, axis=0)
    assert np.linalg.norm(step, axis=-1).max() < 6.0 / 240.0, "m/s"
    hips = np.diff(motion.root_position, 2, axis=0) * 240.0**2
    # a heel strike of the walk has 30 m/s2; from the stop to the next start there is none
    first, last = motion.labels.footstep_time[[6, 12]] * 240.0
    local = np.linalg.norm(hips[int(first) + 1 : int(last)], axis=-1)
    assert local.max() < 12.0, "m/s2"


def test_a_script_is_reproduced_from_its_recipe():
    motion = walk(do=SCRIPTS[1], body=1.6, fps=30.0)
    again = regenerate(motion)
    np.testing.assert_array_equal(again.rotations, motion.rotations)
    np.testing.assert_array_equal(again.root_position, motion.root_position)


def test_a_walk_to_a_point_ahead_is_the_walk_over_the_distance():
    one, other = walk(distance=3.0, fps=60.0), walk(do="walk to 0,3", fps=60.0)
    np.testing.assert_allclose(other.root_position, one.root_position, atol=1e-9)
    np.testing.assert_allclose(other.rotations, one.rotations, atol=1e-9)


def face(motion):
    """Heading and rise of the face, and where the head is."""
    positions, world, _ = posed(motion)
    i = motion.skeleton.index("head")
    way = world[i].apply([0.0, 0.0, 1.0])
    return np.arctan2(way[:, 0], way[:, 2]), np.arcsin(way[:, 1]), positions[:, i]


@pytest.mark.parametrize("point", [(2.0, 1.5, 2.0), (-1.5, 0.3, 2.0), (0.0, 2.5, 3.0)])
def test_who_looks_at_a_point_faces_it(point):
    yaw, rise, head = face(walk(do=f"look at {point[0]},{point[1]},{point[2]}; stand 1.5"))
    way = np.array(point) - head[-1]
    assert np.degrees(yaw[-1] - np.arctan2(way[0], way[2])) == pytest.approx(0.0, abs=3.0)
    up = np.arctan2(way[1], np.hypot(way[0], way[2]))
    assert np.degrees(rise[-1] - up) == pytest.approx(0.0, abs=6.0)
    assert (np.abs(np.diff(yaw)) * 60.0).max() < np.radians(400.0), "as people turn it"


@pytest.mark.parametrize("degrees", [60, 90, -180, 360])
def test_the_head_turns_before_the_pelvis(degrees):
    """A quarter of a second before (0.1 s measured at 180 deg), by 20 deg and more (a man 23)."""
    motion = walk(do=f"turn left {degrees}" if degrees > 0 else f"turn right {-degrees}", fps=120.0)
    yaw, *_ = face(motion)
    pelvis = posed(motion)[1][0].apply([0.0, 0.0, 1.0])
    pelvis = np.unwrap(np.arctan2(pelvis[:, 0], pelvis[:, 2]))
    sign, half = np.sign(degrees), 0.5 * np.radians(abs(degrees))
    yaw = np.unwrap(yaw)
    lead = (np.argmax(sign * pelvis > half) - np.argmax(sign * yaw > half)) / 120.0
    assert 0.15 < lead < 0.5
    assert 15.0 < np.degrees(np.abs(yaw - pelvis).max()) < 30.0


def test_a_lean_stays_until_it_is_taken_back():
    motion = walk(do="lean forward 20; stand 0.5; lean forward 0; stand 0.5", fps=60.0)
    _, world, _ = posed(motion)
    up = world[motion.skeleton.index("upperChest")].apply([0.0, 1.0, 0.0])
    lean = np.degrees(np.arctan2(up[:, 2], up[:, 1]))
    lean -= lean[0]
    assert lean[70] == pytest.approx(20.0, abs=0.5)
    assert lean[-1] == pytest.approx(0.0, abs=1e-6)


def test_hips_come_down_in_time_before_a_walk_that_follows_a_short_stand():
    """The walk asks for lower hips; a tenth of a second of standing is not a whole step's time."""
    do = "turn left 291.7; follow -0.442,-0.477 0.291,-1.275"
    motion = walk(do=do, body=2.05, gait="winter", fps=120)
    height = motion.root_position[:, 1]
    assert np.abs(np.diff(height, 2)).max() * 120.0**2 < 5.0  # m/s2; 25 before, 2.4 now


def test_hips_that_balance_a_lean_change_over_while_no_walk_starts_or_stops():
    """At the very ends of a walk its clock stands still: what moved in time there would jolt."""
    motion = walk(do="lean right 16; walk to -1.5,-0.5; turn left 90", gait="winter", fps=120)
    moved = np.linalg.norm(np.diff(motion.root_position, 2, axis=0), axis=1) * 120.0**2
    near = np.array([np.percentile(moved[max(0, i - 60) : i + 61], 75) for i in range(len(moved))])
    assert (moved / np.maximum(near, 3.0)).max() < 3.0


def test_the_head_does_not_spin_after_a_point_over_the_feet():
    motion = walk(do="walk to 0,3; look at 0,1.62,3; stand 1; turn left 180", fps=120)
    assert not broken(motion)
