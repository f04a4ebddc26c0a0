"""A sheet of several people: moments of the whole, the floor from above, a stride of each."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.viz import palette
from gaitsmith.viz.above import FloorMap, draw_edges, floor_grid, footprints
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.figures import figure_row, row_height
from gaitsmith.viz.stage import Stage
from gaitsmith.viz.tracks import stride_frames

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float, Int

    from gaitsmith.motion.motion import Motion
    from gaitsmith.motion.performance import Performance
    from gaitsmith.skin.palette import Color
    from gaitsmith.viz.terrain import Land
    from gaitsmith.viz.tracks import Tracks

_MARGIN, _HEADER, _CAPTION, _GAP = 40, 92, 26, 22
#: Moments of the whole, side by side; figures of a stride in a row.
_MOMENTS, _PHASES = 4, 8
#: Height of the view from above, pixels, at least and at most, and of a row of the tallest.
_LOW, _HIGH, _ROW = 220.0, 480.0, 250.0
#: Seconds between the dots on everybody's way, and between those with a number.
_TICK, _NUMBERED = 1.0, 2.0


def scene_sheet(performance: Performance, path: str | Path, *, width: int = 1600) -> None:
    """Write a PNG that shows ``performance`` at a glance.

    From top to bottom: moments of the whole; everybody's footprints and ways from above, with
    a dot a second; a stride of each from the right, all to one scale. The same performance
    gives the same bytes.

    Parameters
    ----------
    performance
        At least one frame.
    path
        Where to write; PNG whatever its suffix.
    width
        Of the picture, pixels, 800 to 6400.

    Raises
    ------
    InvalidInputError
        If there are no frames, or the width is out of range.
    """
    if not 800 <= width <= 6400 or width != int(width):
        raise InvalidInputError(f"width must be a whole number from 800 to 6400, got {width!r}")
    left, right = float(_MARGIN), float(width - _MARGIN)
    moment = int((right - left - (_MOMENTS - 1) * 16) / _MOMENTS)
    stage = Stage(performance, moment)
    floor = _Floor(performance, stage.tracks, stage.land, right - left)
    tallest = max(tracks.stature for tracks in stage.tracks)
    strides = [_longest_stride(tracks.motion) for tracks in stage.tracks]
    rows = [
        row_height(tracks, frames, _ROW * tracks.stature / tallest + 26.0)
        for tracks, (frames, _) in zip(stage.tracks, strides, strict=True)
    ]
    total = _HEADER + 2 * (_CAPTION + _GAP) + stage.size[1] + floor.height
    total += sum(rows) + len(rows) * (_CAPTION + _GAP)
    canvas = Canvas(width, round(total))
    _header(canvas, performance, stage.tracks)
    top = _HEADER + _CAPTION
    frames = _moments(performance)
    pictures = [stage.draw(int(frame)) for frame in frames.tolist()]
    places = [(round(left + k * (moment + 16)), round(top)) for k in range(_MOMENTS)]
    for frame, (x, _) in zip(frames.tolist(), places, strict=True):
        canvas.text(x, top - 8, f"{frame / performance.fps:.2f} s", color=palette.INK)
    top += stage.size[1] + _GAP + _CAPTION
    canvas.text(left, top - 8, "From above; a dot a second", color=palette.INK)
    floor.draw(canvas, Area(left, top, right, top + floor.height))
    top += floor.height + _GAP + _CAPTION
    for i, (name, tracks) in enumerate(zip(performance.names, stage.tracks, strict=True)):
        frames, stride = strides[i]
        span = "the longest stride" if stride else "the whole motion"
        canvas.text(left, top - 8, name, color=_color(i), size=14)
        words = f"{tracks.stature:.2f} m, from the right, {span}"
        canvas.text(left + 12 + 9 * len(name), top - 8, words)
        figure_row(canvas, tracks, Area(left, top, right, top + rows[i]), frames, "right")
        top += rows[i] + _GAP + _CAPTION
    image = canvas.finish()
    for picture, place in zip(pictures, places, strict=True):
        image.paste(picture, place)
    image.save(path, format="PNG", optimize=False, compress_level=6)


def _moments(performance: Performance) -> Float[np.ndarray, "n"]:
    """Frames of even instants, the last at the last landing of anybody."""
    landings = [m.labels.footstep_time[-1] for m in performance.motions if m.labels is not None]
    last = len(performance.motions[0]) - 1
    end = round(max(landings, default=0.0) * performance.fps) or last
    return np.round(np.linspace(0, min(end, last), _MOMENTS + 1)[1:])


def _longest_stride(motion: Motion) -> tuple[Int[np.ndarray, "n"], bool]:
    """Even instants of the stride that leads farthest: where somebody walks rather than turns."""
    labels = motion.labels
    if labels is not None and len(labels.footstep_side) > 4:
        side, place, time = labels.footstep_side, labels.footstep_position, labels.footstep_time
        same = (side[2:-2] == side[4:]) & (time[4:] > time[2:-2])
        far = np.where(same, np.linalg.norm(place[4:] - place[2:-2], axis=1).round(3), -1.0)
        if same.any():
            most = np.flatnonzero(far == far.max())
            k = 2 + int(most[len(most) // 2])
            at = np.linspace(time[k], time[k + 2], _PHASES, endpoint=False)
            return np.clip(np.round(at * motion.fps), 0, len(motion) - 1).astype(int), True
    return stride_frames(motion, _PHASES)


def _color(index: int) -> Color:
    return palette.PEOPLE[index % len(palette.PEOPLE)]


def _header(canvas: Canvas, performance: Performance, people: list[Tracks]) -> None:
    walkers = "1 walker" if len(people) == 1 else f"{len(people)} walkers"
    facts = [walkers, f"{performance.duration:.2f} s"]
    canvas.text(_MARGIN, 48, "  ·  ".join(facts), size=26, color=palette.INK)
    details = [f"{len(people[0].motion)} frames at {performance.fps:g} fps"]
    details += [
        f"{name} {tracks.distance:.2f} m"
        for name, tracks in zip(performance.names, people, strict=True)
    ]
    canvas.text(_MARGIN, 74, "   ·   ".join(details), size=14)


class _Floor:
    """Everybody's footprints and ways from above, on the axes of the world."""

    def __init__(
        self, performance: Performance, people: list[Tracks], land: Land, width: float
    ) -> None:
        self.names, self.people, self.width = performance.names, people, width
        self.ground = land.base
        self.prints = [footprints(tracks) for tracks in people]
        around = json.loads(performance.surroundings)
        self.solids = [solid.corners for solid in land.solids]
        self.bars = [np.array([b["begin"], b["end"]]) for b in around.get("bars", ())]
        self.posts = [(np.array(p["at"]), p["radius"]) for p in around.get("posts", ())]
        points = [tracks.motion.root_position[:, [0, 2]] for tracks in people]
        points += [shape[:, [0, 2]] for prints in self.prints for _, shape in prints]
        points += [*self.solids, *self.bars, *(at[None] for at, _ in self.posts)]
        flat = np.concatenate(points)
        # the world's Z or X to the right, whichever way is longer
        self.turned = bool(np.ptp(flat[:, 0]) > np.ptp(flat[:, 1]))
        self.low, self.high = flat.min(axis=0) - 0.4, flat.max(axis=0) + 0.4
        across, up = (self.high - self.low)[[0, 1] if self.turned else [1, 0]]
        self.scale = float(min(width / across, (_HIGH - 20.0) / up, 260.0))
        self.height = max(_LOW, self.scale * float(up) + 20.0)

    def draw(self, canvas: Canvas, area: Area) -> None:
        """The view from above in ``area``."""
        middle = 0.5 * (self.low + self.high)
        center = 0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom - 20.0)
        axes = np.eye(3)
        right, up = (axes[0], -axes[2]) if self.turned else (axes[2], axes[0])
        to = FloorMap(_floor(middle[None])[0], right, up, self.scale, center)
        canvas.box(area.left, area.top, area.right, area.bottom - 20.0, palette.PANEL)
        floor_grid(canvas, to, area, np.zeros(3), unit="m of x" if self.turned else "m of z")
        draw_edges(canvas, self.ground, to, area)
        for shape in self.solids:
            canvas.polygon(to(_floor(shape)), palette.SOLID, palette.SOLID_EDGE)
        for at, radius in self.posts:
            ((x, y),) = to(_floor(at[None]))
            canvas.dot(x, y, max(2.5, radius * self.scale), palette.SOLID, palette.SOLID_EDGE)
        for i, (tracks, prints) in enumerate(zip(self.people, self.prints, strict=True)):
            for _, shape in prints:
                canvas.polygon(to(shape), palette.mix(palette.PANEL, _color(i), 0.25), _color(i))
            canvas.line(to(tracks.motion.root_position), _color(i), 1.6)
            self._dots(canvas, to, tracks, _color(i))
        for ends in self.bars:
            canvas.line(to(_floor(ends)), palette.SOLID_EDGE, 4.0)
        for i, tracks in enumerate(self.people):
            ((x, y),) = to(tracks.motion.root_position[:1])
            canvas.text(x, y - 14, self.names[i], size=14, color=_color(i), anchor="ms")

    def _dots(self, canvas: Canvas, to: FloorMap, tracks: Tracks, color: Color) -> None:
        """Where the pelvis is every second; none twice in one place."""
        motion, last = tracks.motion, None
        for k in range(int(motion.duration / _TICK + 1e-9) + 1):
            frame = round(k * _TICK * motion.fps)
            ((x, y),) = to(motion.root_position[frame][None])
            if last is not None and np.hypot(x - last[0], y - last[1]) < 9.0:
                continue
            last = (x, y)
            canvas.dot(x, y, 3.0, palette.PANEL, color)
            if k * _TICK % _NUMBERED < 1e-9:
                canvas.text(x + 5, y - 5, f"{k * _TICK:g} s", size=11, color=color)


def _floor(flat: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
    return np.stack([flat[:, 0], np.zeros(len(flat)), flat[:, 1]], axis=-1)
