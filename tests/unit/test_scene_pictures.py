"""Pictures of several people: to scale, at their places, none left out."""

from __future__ import annotations

import json
from dataclasses import asdict

import numpy as np
import pytest
from PIL import Image

from gaitsmith import InvalidInputError, Performance, Scene, Start, Walker, perform, walk
from gaitsmith.plan.surroundings import Bar, Obstacle, Post, Surroundings
from gaitsmith.viz import palette, scene_gif, scene_sheet
from gaitsmith.viz.stage import Stage

AROUND = Surroundings(
    (Obstacle(((2.0, 2.0), (3.0, 2.0), (3.0, 3.0))),),
    (Bar((-1.0, 1.0), (1.0, 1.0), 2.2),),
    (Post((-1.5, 0.5), 0.08),),
)


@pytest.fixture(scope="module")
def two():
    """A child and a man who stand 2 m apart, and things around them."""
    child = Walker("child", body=1.2, do="stand 1")
    man = Walker("man", body=1.8, start=Start((2.0, 0.0)), do="walk to 2,1.5")
    made = perform(Scene((child, man)), fps=20.0)
    return Performance(made.names, made.motions, json.dumps(asdict(AROUND)))


def test_people_are_seen_to_one_scale_at_their_places(two):
    stage = Stage(two, 600)
    view = stage.view
    assert view.axes[2] @ [0.0, 1.0, 0.0] > 0.0
    for tracks in stage.tracks:
        feet, crown = tracks.positions[0, 0] * [1, 0, 1], tracks.positions[0, 0] * [1, 0, 1]
        crown = crown + [0.0, tracks.stature, 0.0]
        (x0, y0, _), (x1, y1, _) = view.project(np.stack([feet, crown])) / [2.0, 2.0, 1.0]
        assert 0 < x0 < stage.size[0]
        assert 0 < y1 < y0 < stage.size[1]
        assert x0 == pytest.approx(x1)
        tall = (y0 - y1) * 2.0 / view.scale / view.axes[1, 1]
        assert tall == pytest.approx(tracks.stature, rel=1e-9)
    image = np.asarray(stage.draw(0), dtype=int)
    for tracks in stage.tracks:
        chest = tracks.positions[0, tracks.joint("upperChest")]
        x, y = (view.project(chest)[:2] / 2.0).astype(int)
        wood = image[y - 2 : y + 3, x - 2 : x + 3].reshape(-1, 3).mean(0)
        assert np.abs(wood - palette.FLOOR).sum() > 60, "somebody is there"


def test_everybody_stays_in_the_picture(two):
    stage = Stage(two, 600)
    for tracks in stage.tracks:
        seen = stage.view.project(tracks.positions.reshape(-1, 3))[:, :2] / 2.0
        assert (seen > 0).all()
        assert (seen < stage.size).all()


def test_what_stands_around_is_drawn(two):
    bare = Stage(Performance(two.names, two.motions), 600)
    full = Stage(two, 600)
    middle = np.array([2.7, 0.0, 2.3])
    x, y = (full.view.project(middle)[:2] / 2.0).astype(int)
    assert np.abs(np.array(full.draw(0).getpixel((x, y))) - palette.SOLID).max() < 12
    assert bare.size != full.size or bare.view.scale != full.view.scale
    post = full.view.project(np.array([-1.5, 1.0, 0.5]))[:2] / 2.0
    color = np.array(full.draw(0).getpixel(tuple(post.astype(int).tolist())))
    assert np.abs(color - palette.SOLID).max() < 20


def test_a_gif_shows_all_the_time_and_is_the_same_twice(two, tmp_path):
    made = [tmp_path / f"{k}.gif" for k in (0, 1)]
    for path in made:
        scene_gif(two, path, width=240, fps=4.0)
    assert made[0].read_bytes() == made[1].read_bytes()
    with Image.open(made[0]) as picture:
        seconds = 0.0
        for k in range(picture.n_frames):
            picture.seek(k)
            seconds += picture.info["duration"] / 1000.0
    # the last picture stays a little
    assert seconds == pytest.approx(two.duration + 0.6, abs=0.26)


def test_a_sheet_shows_everybody_and_is_the_same_twice(two, tmp_path):
    for k in (0, 1):
        scene_sheet(two, tmp_path / f"{k}.png", width=800)
    assert (tmp_path / "0.png").read_bytes() == (tmp_path / "1.png").read_bytes()
    with Image.open(tmp_path / "0.png") as picture:
        assert picture.width == 800
        sheet = np.asarray(picture.convert("RGB"), dtype=int)
    for color in palette.PEOPLE[:2]:
        assert (np.abs(sheet - np.array(color)).max(-1) < 8).sum() > 50, "footprints of each"


@pytest.mark.parametrize(("write", "width"), [(scene_gif, 100), (scene_sheet, 799)])
def test_a_width_out_of_range_is_refused(two, tmp_path, write, width):
    with pytest.raises(InvalidInputError, match="width must be a whole number"):
        write(two, tmp_path / "x", width=width)


def test_no_frames_are_no_picture(tmp_path):
    motion = walk(distance=1.0, fps=10.0)
    none = motion.with_(
        root_position=motion.root_position[:0],
        rotations=motion.rotations[:0],
        contacts=motion.contacts[:0],
        labels=None,
    )
    with pytest.raises(InvalidInputError, match="no frames"):
        scene_gif(Performance(("a",), (none,)), tmp_path / "x.gif")
