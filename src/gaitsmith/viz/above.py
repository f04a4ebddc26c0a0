"""The whole walk from above: footprints, way of the pelvis, the path that was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import ahead, leftward
from gaitsmith.skin.shoe import outline
from gaitsmith.viz import palette
from gaitsmith.viz.around import draw_on_map
from gaitsmith.viz.canvas import Area, nice_step, pairs

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.ground import Ground
    from gaitsmith.viz.canvas import Canvas
    from gaitsmith.viz.tracks import Tracks


@dataclass(frozen=True, eq=False)
class FloorMap:
    """World to the picture from above: ``right`` and ``up`` are its level directions."""

    origin: Float[np.ndarray, "3"]
    right: Float[np.ndarray, "3"]
    up: Float[np.ndarray, "3"]
    scale: float
    center: tuple[float, float]

    def __call__(self, points: Float[np.ndarray, "n 3"]) -> list[tuple[float, float]]:
        """Pixels of world points."""
        flat = points - self.origin
        x = self.center[0] + self.scale * (flat @ self.right)
        y = self.center[1] - self.scale * (flat @ self.up)
        return pairs(x, y)


def footprints(tracks: Tracks) -> list[tuple[int, Float[np.ndarray, "points 3"]]]:
    """Side and world outline (meters) of every footprint, from the labels or the contacts."""
    labels, found = tracks.motion.labels, []
    if labels is not None:
        rows = zip(
            labels.footstep_side.tolist(),
            labels.footstep_position,
            labels.footstep_heading.tolist(),
            strict=True,
        )
        for side, position, heading in rows:
            last = tracks.figure.lasts[side]
            if last is not None:
                flat = outline(last)
                behind = flat[:, :1] + float(last.heel @ last.axes[0])
                found.append(
                    (side, position + behind * ahead(heading) + flat[:, 1:] * leftward(heading))
                )
        return found
    if tracks.motion.contacts is None or tracks.soles is None:
        return found
    for side in (0, 1):
        last = tracks.figure.lasts[side]
        flat_foot = tracks.motion.contacts[:, side, :2].all(axis=1)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], flat_foot.astype(int), [0]])))
        for start, stop in edges.reshape(-1, 2).tolist():
            heel, front = tracks.soles[(start + stop - 1) // 2, side, :2]
            if last is not None:
                heading = float(np.arctan2(front[0] - heel[0], front[2] - heel[2]))
                flat = outline(last)
                found.append(
                    (side, heel + flat[:, :1] * ahead(heading) + flat[:, 1:] * leftward(heading))
                )
    return found


def _long_way(tracks: Tracks) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Horizontal unit vectors (right, up) of the map: the walk's longest extent to the right."""
    way = tracks.root[:, [0, 2]]
    chord = way[-1] - way[0]
    if np.linalg.norm(chord) < 0.5 * tracks.distance:
        spread = way - way.mean(axis=0)
        chord = np.linalg.svd(spread, full_matrices=False)[2][0]
        chord = chord * (
            1.0 if chord @ [np.sin(tracks.heading[0]), np.cos(tracks.heading[0])] >= 0 else -1.0
        )
    if np.linalg.norm(chord) < 0.2:
        chord = np.array([np.sin(tracks.heading[0]), np.cos(tracks.heading[0])])
    angle = float(np.arctan2(chord[0], chord[1]))
    return ahead(angle), leftward(angle)


def map_height(tracks: Tracks, width: float, least: float, most: float) -> float:
    """Height in pixels that the view from above wants at ``width``."""
    right, up = _long_way(tracks)
    points = _map_points(tracks)
    span = np.ptp(points @ right) + 0.5, np.ptp(points @ up) + 0.5
    return float(np.clip(width * span[1] / span[0] + 30.0, least, most))


def _map_points(tracks: Tracks) -> Float[np.ndarray, "n 3"]:
    points = [tracks.motion.root_position, *(shape for _, shape in footprints(tracks))]
    if tracks.soles is not None:
        points.append(tracks.soles.reshape(-1, 3))
    if tracks.motion.labels is not None and tracks.motion.labels.path is not None:
        path = tracks.motion.labels.path
        points.append(np.stack([path[:, 0], np.zeros(len(path)), path[:, 1]], axis=1))
    return np.concatenate(points)


def map_panel(canvas: Canvas, tracks: Tracks, area: Area) -> None:
    """The whole walk from above: footprints, way of the pelvis, the path that was asked for."""
    right, up = _long_way(tracks)
    points = _map_points(tracks)
    x, y = points @ right, points @ up
    scale = min(area.width / (np.ptp(x) + 0.5), (area.height - 20.0) / (np.ptp(y) + 0.5), 420.0)
    origin = 0.5 * (x.min() + x.max()) * right + 0.5 * (y.min() + y.max()) * up
    center = 0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom - 20.0)
    to = FloorMap(origin, right, up, scale, center)
    canvas.box(area.left, area.top, area.right, area.bottom - 20.0, palette.PANEL)
    start = tracks.motion.root_position[0]
    floor_grid(canvas, to, area, start)
    draw_edges(canvas, tracks.surface, to, area)
    inside = Area(area.left, area.top, area.right, area.bottom - 20.0)
    draw_on_map(canvas, tracks.around, to, scale, inside)
    labels = tracks.motion.labels
    if labels is not None and labels.path is not None and len(labels.path) > 1:
        path = np.stack([labels.path[:, 0], np.zeros(len(labels.path)), labels.path[:, 1]], axis=1)
        canvas.dashes(np.array(to(path)), palette.PATH_LINE, 1.5, 5.0)
    shapes = footprints(tracks)
    for number, (side, shape) in enumerate(shapes):
        tint = palette.SIDE_LINES[side]
        canvas.polygon(to(shape), palette.mix(palette.PANEL, tint, 0.30), tint)
        if labels is not None and number >= 2 and _length(tracks, side) * scale > 28:
            ((cx, cy),) = to(shape.mean(axis=0)[None])
            canvas.text(cx, cy, str(number - 1), size=11, color=palette.INK, anchor="mm")
    if not shapes and tracks.soles is not None:
        for side in (0, 1):
            canvas.line(to(tracks.soles[:, side].mean(axis=1)), palette.SIDE_LINES[side], 1.0)
    canvas.line(to(tracks.motion.root_position), palette.PELVIS_LINE, 1.6)
    ((sx, sy),) = to(start[None])
    canvas.dot(sx, sy, 4.0, palette.PANEL, palette.PELVIS_LINE)
    _arrow(canvas, tracks, to)


def _length(tracks: Tracks, side: int) -> float:
    last = tracks.figure.lasts[side]
    return 0.0 if last is None else last.length


def _arrow(canvas: Canvas, tracks: Tracks, to: FloorMap) -> None:
    """Head of an arrow where the pelvis ends, as the figure faces."""
    heading, end = float(tracks.heading[-1]), tracks.motion.root_position[-1]
    size = 11.0 / to.scale
    front, left = ahead(heading), leftward(heading)
    tip = np.stack([end + size * front, end + 0.5 * size * left, end - 0.5 * size * left])
    canvas.polygon(to(tip), palette.PELVIS_LINE)


def draw_edges(canvas: Canvas, surface: Ground, to: FloorMap, area: Area) -> None:
    """Risers and other edges of the ground in a map."""
    if not surface.stepped:
        return
    half = 0.5 * np.array([area.width, area.height - 20.0]) / to.scale
    corners = np.array([u * half[0] * to.right + v * half[1] * to.up for u in _ENDS for v in _ENDS])
    box = (to.origin + corners)[:, [0, 2]]
    edges = surface.edges(tuple(box.min(axis=0).tolist()), tuple(box.max(axis=0).tolist()))
    inside = Area(area.left, area.top, area.right, area.bottom - 20.0)
    for ends in np.stack([edges.begin, edges.end], axis=1):
        line = np.insert(ends, 1, 0.0, axis=1)
        along = np.linspace(line[0], line[1], 65 if len(edges) < 200 else 2)
        shown = [(x, y) for x, y in to(along) if _in(inside, x, y)]
        canvas.line(shown, palette.FRAME, 1.6)


_ENDS = (-1.0, 1.0)


def _in(area: Area, x: float, y: float) -> bool:
    return area.left <= x <= area.right and area.top <= y <= area.bottom


def floor_grid(
    canvas: Canvas, to: FloorMap, area: Area, start: Float[np.ndarray, "3"], *, unit: str = "m"
) -> None:
    """Metre lines counted from ``start``, with numbers below."""
    step = max(nice_step(area.width / to.scale, 20), 0.5)
    ((x0, y0),) = to(start[None])
    bottom = area.bottom - 20.0
    for k in range(-200, 201):
        x = x0 + k * step * to.scale
        if area.left - 0.5 <= x <= area.right + 0.5:
            canvas.line([(x, area.top), (x, bottom)], palette.GRID)
            if area.left + 6 <= x <= area.right - 6 - 7 * len(unit):
                canvas.text(x, area.bottom - 4, f"{k * step:g}", size=12, anchor="ms")
        y = y0 - k * step * to.scale
        if area.top <= y <= bottom:
            canvas.line([(area.left, y), (area.right, y)], palette.GRID)
    canvas.text(area.right, area.bottom - 4, unit, size=12, anchor="rs")
