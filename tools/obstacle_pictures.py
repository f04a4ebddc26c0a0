"""Make the pictures of walks among things: docs/pictures/obstacles-*.

A duck under a bar and a lean past a post in rows of snapshots, at their real distances; a walk
round obstacles from above; a lean and how the hips balance it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import gaitsmith
from gaitsmith.plan.surroundings import Bar, Obstacle, Post, Surroundings
from gaitsmith.viz.above import map_panel
from gaitsmith.viz.around import draw_rods
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.render import camera, draw_figure
from gaitsmith.viz.tracks import tracks_of

TARGET = Path(__file__).parent.parent / "docs/pictures"
BAR = Surroundings(bars=(Bar((-1.0, 2.5), (1.0, 2.5), 1.35, name="beam"),))
POST = Surroundings(posts=(Post((0.24, 2.5), 0.03, name="post"),))
ROOM = Surroundings(
    (
        Obstacle(((-0.6, 1.6), (0.5, 1.6), (0.5, 2.4), (-0.6, 2.4)), "table"),
        Obstacle(((0.2, 3.9), (1.7, 3.4), (2.0, 4.4), (0.9, 4.8)), "sofa"),
        Obstacle(((-1.6, 4.0), (-0.7, 4.0), (-0.7, 4.9), (-1.6, 4.9)), "chest"),
    )
)
ROWS = (
    ({"distance": 5.0}, BAR, "Under a beam of 1.35 m", "right"),
    ({"path": "0,0 0,5"}, POST, "Past a post 24 cm beside the way", "front"),
    ({"do": "lean forward 35; stand 1"}, None, "lean forward 35: the hips go back", "right"),
    ({"do": "lean left 25; stand 1"}, None, "lean left 25: the hips go right", "front"),
)


def snapshots(path: Path) -> None:
    """Rows of one person each, at even times around what is to be seen."""
    width, height, count = 1500, 350, 9
    canvas = Canvas(width, height * len(ROWS) + 40, fine=2)
    for row, (where, things, title, view) in enumerate(ROWS):
        tracks = tracks_of(gaitsmith.walk(**where, fps=120, surroundings=things))
        level = height * (row + 1) - 14.0
        canvas.box(20.0, level - 6.0, width - 20.0, level + 14.0, "#e8e6e0")
        root = tracks.motion.root_position
        middle = np.abs(root[:, 2] - 2.5).argmin() if things else 0.55 * 120
        span = 1.05 if things else 0.5
        seconds = middle / 120.0 + np.linspace(-span, span, count)
        for k, second in enumerate(seconds):
            frame = int(np.clip(round(second * 120), 0, len(root) - 1))
            at = (110.0 + k * (width - 220.0) / (count - 1), level)
            target = root[frame] * [0.0, 0.0, 1.0]
            seen = camera(
                view,
                heading=0.0,
                target=target,
                center=(at[0] * canvas.fine, at[1] * canvas.fine),
                scale=150.0 * canvas.fine,
            )
            for front in (False, True):
                if front:
                    draw_figure(
                        canvas.image,
                        tracks.figure,
                        tracks.positions[frame],
                        tracks.world[frame],
                        seen,
                    )
                draw_rods(
                    canvas.image, tracks.around, seen, root[frame], 1.3, front=front, near=0.4
                )
            canvas.text(at[0] - 20.0, level + 30.0, f"{second:.2f} s")
        canvas.text(24.0, level - height + 50.0, title)
    canvas.save(path)


def above(path: Path) -> None:
    """A walk among three pieces of furniture."""
    canvas = Canvas(1100, 520, fine=2)
    script = "walk to 0.2,5.6; walk to 2.4,3.0; be at 1.1,2.6 facing 180"
    motion = gaitsmith.walk(do=script, surroundings=ROOM)
    map_panel(canvas, tracks_of(motion), Area(20.0, 40.0, 1080.0, 500.0))
    canvas.text(24.0, 28.0, script)
    canvas.save(path)


if __name__ == "__main__":
    snapshots(TARGET / "obstacles-bent.png")
    above(TARGET / "obstacles-above.png")
