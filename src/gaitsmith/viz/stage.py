"""Several people in one picture, to scale, at their places, seen by a camera that stands still."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from gaitsmith.conventions import ahead
from gaitsmith.errors import InvalidInputError
from gaitsmith.plan.surroundings import read_surroundings
from gaitsmith.viz import palette
from gaitsmith.viz.above import footprints
from gaitsmith.viz.animation import delay_of, write_pictures
from gaitsmith.viz.canvas import font
from gaitsmith.viz.render import camera, draw_figure
from gaitsmith.viz.shadows import ELEVATION, draw_prints, draw_shadow
from gaitsmith.viz.terrain import Land, draw_land, draw_solids, hiding
from gaitsmith.viz.tracks import tracks_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.motion.performance import Performance
    from gaitsmith.viz.tracks import Tracks

#: Height of the picture over its width, at least and at most.
_FLATTEST, _TALLEST = 0.42, 0.9
#: Meters of floor around all that people reach; the grid's cell.
_AROUND, _CELL = 0.45, 0.5
#: Meters of uneven ground that are drawn beyond: it fades.
_BEYOND = 4.0
_FINE = 2
#: Frames that are looked at to see how far people reach.
_LOOKED = 60


def scene_gif(
    performance: Performance, path: str | Path, *, width: int = 720, fps: float = 20.0
) -> None:
    """Write an animated GIF of everybody in ``performance``, to scale, at their places.

    The camera stands still and sees all of it. The same performance gives the same bytes.

    Parameters
    ----------
    performance
        At least one frame.
    path
        Where to write; GIF whatever its suffix.
    width
        Pixels, 240 to 1920.
    fps
        Pictures a second, at most the motions'.

    Raises
    ------
    InvalidInputError
        If there are no frames, or a number is out of range.
    """
    if not 240 <= width <= 1920 or width != int(width):
        raise InvalidInputError(f"width must be a whole number from 240 to 1920, got {width!r}")
    first = performance.motions[0]
    stage = Stage(performance, width)
    colors = palette.PEOPLE[: len(performance)] if len(performance) > 1 else ()
    write_pictures(path, stage.draw, first, delay_of(first, fps), colors)


class Stage:
    """People, floor and what stands around, and the camera that sees them all."""

    def __init__(self, performance: Performance, width: int) -> None:
        self.names = performance.names
        self.tracks = [tracks_of(motion) for motion in performance.motions]
        self.prints = [footprints(tracks) for tracks in self.tracks]
        self.around: dict[str, Any] = json.loads(performance.surroundings)
        self.land = _land(self.tracks, self.around)
        around = [ends for ends, _ in _rods(self.around)]
        around += [rim for solid in self.land.solids for rim in (solid.outline, solid.top)]
        points = np.concatenate([*map(_reached, self.tracks), *around])
        self.floor_points = points.copy()
        self.floor_points[:, 1] = self.land.base.height(points[:, 0], points[:, 2])
        heading = self._heading()
        target = 0.5 * (points.min(axis=0) + points.max(axis=0)) * [1.0, 0.0, 1.0]
        plain = camera(
            "right",
            heading=heading,
            target=target,
            center=(0.0, 0.0),
            scale=1.0,
            elevation=ELEVATION,
        )
        shown = plain.project(np.concatenate([points, self.floor_points]))[:, :2]
        low, high = shown.min(axis=0) - _AROUND, shown.max(axis=0) + _AROUND
        low[1] -= 0.12 * float(np.ptp(points[:, 1]))  # room for the names
        span = high - low
        aspect = float(np.clip(span[1] / span[0], _FLATTEST, _TALLEST))
        self.size = (width, round(aspect * width))
        self.large = (self.size[0] * _FINE, self.size[1] * _FINE)
        scale = float(min(self.large[0] / span[0], self.large[1] / span[1]))
        middle = (0.5 * (low + high) * scale).tolist()
        center = (0.5 * self.large[0] - middle[0], 0.5 * self.large[1] - middle[1])
        self.view = camera(
            "right",
            heading=heading,
            target=target,
            center=center,
            scale=scale,
            elevation=ELEVATION,
        )
        self.reach = 10.0 * float(np.ptp(self.floor_points, axis=0).max() + 1.0)
        self.floor = self._backdrop()
        low, high = self._corners()
        # steps hide what is behind them; smooth ground hardly ever does
        steps = self.land.base.stepped
        cells = self.land.cells(*self.land.lines(low, high)) if steps else ()
        self.hidden = hiding(self.land, self.view, self.large, cells)

    def _corners(self) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, "2"]]:
        """Corners x,z of the ground that is drawn."""
        flat = self.floor_points[:, [0, 2]]
        return flat.min(axis=0) - _BEYOND, flat.max(axis=0) + _BEYOND

    def _heading(self) -> float:
        """What points to the right of the picture: the long way, people rather facing us."""
        roots = np.concatenate([tracks.root[:, [0, 2]] for tracks in self.tracks])
        spread = roots - roots.mean(axis=0)
        way = np.linalg.svd(spread[:: max(1, len(spread) // 500)], full_matrices=False)[2][0]
        if np.ptp(spread @ way) < 0.3:  # all stand where they are: look at the first's side
            way = ahead(float(self.tracks[0].heading[0]))[[0, 2]]
        heading = float(np.arctan2(way[0], way[1]))
        # the viewer stands to the walker's right: at the heading less a right angle
        seen = sum(float(np.cos(t.heading - heading + 0.5 * np.pi).mean()) for t in self.tracks)
        return heading if seen >= 0.0 else heading + np.pi

    def _backdrop(self) -> Image.Image:
        """Floor with a grid that fades outside of where people go, and outlines on it."""
        points = self.view.project(self.floor_points)[:, :2]
        mask = Image.new("L", (self.large[0] // 8, self.large[1] // 8), 0)
        pen = ImageDraw.Draw(mask)
        wide = 1.3 * self.view.scale / 8.0
        tall = wide * np.sin(ELEVATION)
        for x, y in (points / 8.0).tolist():
            pen.ellipse((x - wide, y - tall, x + wide, y + tall), fill=255)
        mask = mask.filter(ImageFilter.GaussianBlur(0.35 * self.view.scale / 8.0))
        mask = mask.resize(self.large, Image.Resampling.BILINEAR)
        image = Image.new("RGB", self.large, palette.PAPER)
        image.paste(palette.FLOOR, (0, 0), mask)
        if self.land.is_level:
            self._grid(image, mask)
        else:
            ground = Image.new("RGB", self.large, palette.PAPER)
            draw_land(ground, self.land, self.view, *self._corners(), wide=_FINE)
            image.paste(ground, (0, 0), mask)
        draw_solids(image, self.land, self.view, wide=2 * _FINE)
        return image

    def _grid(self, image: Image.Image, mask: Image.Image) -> None:
        """Lines on level ground."""
        lines = Image.new("L", self.large, 0)
        pen = ImageDraw.Draw(lines)
        low, high = self.floor_points.min(axis=0) - 3.0, self.floor_points.max(axis=0) + 3.0
        for axis in (0, 2):
            for k in range(int(np.ceil(low[axis] / _CELL)), int(high[axis] / _CELL) + 1):
                ends = np.zeros((2, 3))
                ends[:, axis], ends[:, 2 - axis] = k * _CELL, (low[2 - axis], high[2 - axis])
                ends[:, 1] = low[1] + 3.0
                pen.line(self.view.project(ends)[:, :2].ravel().tolist(), fill=255, width=_FINE)
        image.paste(palette.GRID_DARK, (0, 0), ImageChops.multiply(lines, mask))

    def draw(self, frame: int) -> Image.Image:
        """The finished RGB picture of one frame."""
        image, view = self.floor.copy(), self.view
        for tracks, prints in zip(self.tracks, self.prints, strict=True):
            draw_prints(image, tracks, prints, frame, view, reach=self.reach, hidden=self.hidden)
        for tracks in self.tracks:
            draw_shadow(image, tracks, frame, view, self.hidden)
        things: list[tuple[float, Callable[[], None]]] = [
            (self._depth(tracks.positions[frame, 0]), self._person(image, tracks, frame))
            for tracks in self.tracks
        ]
        things += [
            (self._depth(ends.mean(axis=0)), self._rod(image, ends, radius))
            for ends, radius in _rods(self.around)
        ]
        for _, show in sorted(things, key=lambda thing: thing[0]):
            show()
        image = image.reduce(_FINE)
        self._names(image, frame)
        return image

    def _depth(self, point: Float[np.ndarray, "3"]) -> float:
        level = self.view.axes[2] * [1.0, 0.0, 1.0]
        return float((point - self.view.target) @ level)

    def _person(self, image: Image.Image, tracks: Tracks, frame: int) -> Callable[[], None]:
        positions, world = tracks.positions[frame], tracks.world[frame]
        depth = None if self.hidden is None else self.hidden.depth
        return lambda: draw_figure(image, tracks.figure, positions, world, self.view, depth)

    def _rod(
        self, image: Image.Image, ends: Float[np.ndarray, "2 3"], radius: float
    ) -> Callable[[], None]:
        """A bar or a post: a thick line with an edge."""
        wide = max(_FINE, round(2.0 * radius * self.view.scale))
        line = self.view.project(ends)[:, :2].ravel().tolist()

        def show() -> None:
            pen = ImageDraw.Draw(image)
            pen.line(line, fill=palette.SOLID_EDGE, width=wide + 2 * _FINE)
            pen.line(line, fill=palette.SOLID, width=wide)

        return show

    def _names(self, image: Image.Image, frame: int) -> None:
        """Everybody's name over the head, where there is more than one."""
        if len(self.names) < 2:
            return
        pen, taken = ImageDraw.Draw(image), list[tuple[float, float, float, float]]()
        for i, (name, tracks) in enumerate(zip(self.names, self.tracks, strict=True)):
            head = tracks.joint("head")
            at = tracks.positions[frame, 0 if head is None else head]
            x, y = (self.view.project(at + [0.0, 0.16 * tracks.stature, 0.0])[:2] / _FINE).tolist()
            box = pen.textbbox((round(x), round(y)), name, font=font(13), anchor="ms")
            while any(_overlap(box, other) for other in taken):
                y -= 4.0
                box = pen.textbbox((round(x), round(y)), name, font=font(13), anchor="ms")
            taken.append(box)
            color = palette.PEOPLE[i % len(palette.PEOPLE)]
            pen.text((round(x), round(y)), name, fill=color, font=font(13), anchor="ms")


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] + 3 and b[0] < a[2] + 3 and a[1] < b[3] + 1 and b[1] < a[3] + 1


def _reached(tracks: Tracks) -> Float[np.ndarray, "n 3"]:
    """Points around a person over the time: floor under and crown over the hips, a body wide."""
    step = max(1, len(tracks.positions) // _LOOKED)
    root = tracks.positions[::step, 0]
    half = 0.25 * tracks.stature
    shifts = np.array([[half, 0.0, 0.0], [-half, 0, 0], [0, 0, half], [0, 0, -half]])
    around = (root[:, None] + shifts).reshape(-1, 3)
    level = tracks.ground(around[:, 0], around[:, 2])
    low, high = around.copy(), around.copy()
    low[:, 1], high[:, 1] = level, level + tracks.stature
    return np.concatenate([low, high])


def _land(people: list[Tracks], around: dict[str, Any]) -> Land:
    """The ground of everybody: what is low to the tallest is on it, and all that is higher."""
    tallest = max(people, key=lambda tracks: tracks.stature)
    things = read_surroundings({"obstacles": around.get("obstacles", ())})
    return Land.of(tallest.surface, things.obstacles)


def _rods(around: dict[str, Any]) -> list[tuple[Float[np.ndarray, "2 3"], float]]:
    """Axes and radii of bars and posts."""
    found: list[tuple[Float[np.ndarray, "2 3"], float]] = []
    for bar in around.get("bars", ()):
        height = bar["height"] + bar["radius"]
        ends = np.array([[bar[e][0], height, bar[e][1]] for e in ("begin", "end")])
        found.append((ends, bar["radius"]))
    for post in around.get("posts", ()):
        x, z = post["at"]
        found.append((np.array([[x, post[e], z] for e in ("bottom", "top")]), post["radius"]))
    return found
