"""The ground in pictures: where feet stand there is ground, and what is behind it is hidden."""

from __future__ import annotations

import numpy as np
import pytest

import gaitsmith
from gaitsmith import Scene, Start, Walker, perform
from gaitsmith.ground import Box, Boxes, Flat, HeightField, Slope, Stairs
from gaitsmith.plan.surroundings import Obstacle, Surroundings
from gaitsmith.viz import palette, scene_gif
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.figures import figure_row, row_height
from gaitsmith.viz.stage import Stage
from gaitsmith.viz.terrain import Land, hiding
from gaitsmith.viz.tracks import stride_frames, tracks_of


def rectangle(x0, z0, x1, z1):
    return ((x0, z0), (x1, z0), (x1, z1), (x0, z1))


BENCH = Obstacle(rectangle(-0.5, 1.0, 0.5, 2.0), "bench", 0.5)
RUG = Obstacle(rectangle(-2.0, 1.0, -1.5, 2.0), "rug")
STEP = Obstacle(rectangle(1.5, 1.0, 3.5, 1.5), "step", 0.15)


def scene(ground="flat", *around, x=2.5):
    """Somebody who walks along +Z, on the far side of the bench."""
    walker = Walker("walker", start=Start((x, 0.0)), do=f"walk to {x},3")
    made = Scene((walker,), Surroundings(around), ground)
    return perform(made, fps=20.0)


def color_at(stage, point):
    x, y = stage.view.project(np.asarray(point, dtype=float))[:2]
    return stage.floor.getpixel((round(x), round(y)))


@pytest.mark.parametrize(
    "ground", ["stairs:-0.17,0.29,5", "stairs:0.17,0.29,5", "slope:-12", "slope:12"]
)
@pytest.mark.parametrize("view", ["right", "front"])
def test_no_foot_is_drawn_below_its_panel(ground, view):
    tracks = tracks_of(gaitsmith.walk(distance=4.0, ground=ground, fps=30))
    frames, _ = stride_frames(tracks.motion, 8)
    canvas = Canvas(1600, 600)
    area = Area(40.0, 60.0, 1560.0, 60.0 + row_height(tracks, frames, 350.0))
    figure_row(canvas, tracks, area, frames, view)
    picture = np.asarray(canvas.finish(), dtype=int)
    outside = np.concatenate([picture[: int(area.top) - 1], picture[int(area.bottom) + 2 :]])
    assert (outside == palette.PAPER).all()


def test_on_level_ground_a_row_has_no_more_room():
    tracks = tracks_of(gaitsmith.walk(distance=3.0, fps=30))
    frames, _ = stride_frames(tracks.motion, 8)
    assert row_height(tracks, frames, 350.0) == 350.0


@pytest.mark.parametrize("ground", ["flat", "slope:8", "stairs:0.12,0.9,3"])
def test_solids_stand_on_the_ground_of_the_scene(ground):
    stage = Stage(scene(ground, BENCH, RUG, STEP), 600)
    base = stage.land.base
    top = np.array([0.0, float(base.height(0.0, 1.95)) + 0.5, 1.95])
    assert color_at(stage, top) == palette.SOLID
    step = np.array([2.5, float(base.height(2.5, 1.25)) + 0.15, 1.25])
    assert color_at(stage, step) == palette.SOLID
    right = stage.view.axes[2][0] > 0.0  # which side of the bench is seen
    side = np.array([0.5 if right else -0.5, float(base.height(0.5, 1.6)) + 0.25, 1.6])
    assert color_at(stage, side) == palette.SOLID_SIDE


@pytest.mark.parametrize("ground", ["slope:8", "stairs:0.12,0.9,3"])
def test_the_floor_of_a_scene_is_its_ground(ground):
    """Beside the footprints the picture has floor; where a level one would be seen it has none."""
    stage = Stage(scene(ground), 600)
    for position in stage.tracks[0].motion.labels.footstep_position:
        beside = position + [0.25, 0.0, 0.0]
        beside[1] = stage.land.base.height(beside[0], beside[2])
        around = [color_at(stage, beside + [0.01 * k, 0.0, 0.01 * k]) for k in range(-3, 4)]
        off = np.abs(np.array(around) - palette.FLOOR).max(axis=1)
        assert np.median(off) <= 12
    level = stage.land.base.height(np.array([2.5, 2.5]), np.array([0.0, 3.0]))
    assert np.ptp(level) > 0.3


def test_who_is_behind_a_bench_is_hidden_by_it():
    """The picture with the bench has no shoe where it stands before it; the head is seen."""
    stage = Stage(scene("flat", BENCH, x=2.5), 600)
    far = -1.3 if stage.view.axes[2][0] > 0.0 else 1.3
    stage = Stage(scene("flat", BENCH, x=far), 600)
    tracks = stage.tracks[0]
    frame = int(np.abs(tracks.positions[:, 0, 2] - 1.5).argmin())
    image = stage.draw(frame)
    open_ground = Stage(scene("flat", x=far), 600)
    shoe = tracks.soles[frame].mean(axis=(0, 1)) + [0.0, 0.03, 0.0]
    assert stage.hidden is not None
    assert open_ground.hidden is None
    assert stage.hidden.hides(shoe)
    head = tracks.positions[frame, tracks.joint("head")]
    assert not stage.hidden.hides(head)
    x, y = (stage.view.project(shoe)[:2] / 2.0).astype(int)
    assert image.getpixel((int(x), int(y))) in (palette.SOLID_SIDE, palette.SOLID)


def test_what_stands_on_a_box_is_not_hidden_by_it():
    ground = Boxes(Slope(6.0), (Box(rectangle(-1.0, 1.0, 1.0, 2.5), 0.2),))
    tracks = tracks_of(gaitsmith.walk(distance=3.5, ground=ground, fps=30))
    stage = Stage(scene(), 600)
    hidden = hiding(Land.of(ground), stage.view, (1200, 1200))
    x, z = np.random.default_rng(0).uniform([-0.9, 1.1], [0.9, 2.4], (200, 2)).T
    assert not hidden.hides(np.stack([x, ground.height(x, z), z], axis=1)).any()
    assert hidden.hides(np.stack([x, ground.height(x, z) - 0.12, z], axis=1)).any()
    assert tracks.land.solids[0].height == 0.2


def test_a_box_of_the_ground_and_the_obstacle_it_is_are_one():
    shape = rectangle(-1.0, 1.0, 1.0, 2.5)
    surface = Boxes(Flat(), (Box(shape, 0.2),))
    assert len(Land.of(surface, (Obstacle(shape, "step", 0.2), RUG)).solids) == 2


@pytest.mark.parametrize("base", [Slope(5.0), Stairs(0.15, 0.3, 3), HeightField()])
def test_cells_and_grid_lie_on_the_ground(base):
    land = Land.of(base)
    low, high = np.array([-1.0, 0.0]), np.array([2.0, 3.0])
    cells = land.cells(*land.lines(low, high))
    points = np.concatenate([cells.reshape(-1, 3), *land.grid(low, high)])
    np.testing.assert_allclose(base.height(points[:, 0], points[:, 2]), points[:, 1])
    assert (points[:, [0, 2]] >= low - 1e-9).all()
    assert (points[:, [0, 2]] <= high + 1e-9).all()


@pytest.mark.slow
def test_the_same_scene_gives_the_same_bytes(tmp_path):
    performance = scene("slope:8", BENCH, STEP)
    scene_gif(performance, tmp_path / "one.gif", width=240, fps=4.0)
    scene_gif(performance, tmp_path / "two.gif", width=240, fps=4.0)
    assert (tmp_path / "one.gif").read_bytes() == (tmp_path / "two.gif").read_bytes()
