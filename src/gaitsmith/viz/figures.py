"""Rows of figures: one stride, instant by instant, on the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import ahead, leftward
from gaitsmith.ground import Flat
from gaitsmith.viz import palette
from gaitsmith.viz.around import BESIDE, draw_rods
from gaitsmith.viz.canvas import Area, pairs
from gaitsmith.viz.render import camera, draw_figure

if TYPE_CHECKING:
    from jaxtyping import Float, Int

    from gaitsmith.viz.canvas import Canvas
    from gaitsmith.viz.tracks import Tracks


def figure_row(
    canvas: Canvas,
    tracks: Tracks,
    area: Area,
    frames: Int[np.ndarray, "n"],
    view: str,
) -> None:
    """The figures of ``frames`` side by side, each seen along its own heading, on the ground."""
    column = area.width / len(frames)
    stature = tracks.stature
    over, under = _room(tracks, frames)
    scale = (area.height - 26.0) / (1.03 * stature + over + under)
    level = area.bottom - 18.0 - scale * under
    canvas.box(area.left, level, area.right, area.bottom, palette.FLOOR)
    for k, frame in enumerate(frames.tolist()):
        middle = area.left + (k + 0.5) * column
        heading = float(tracks.heading[frame])
        target = _target(tracks, frame, view)
        _ground_under(
            canvas,
            tracks,
            Area(middle - 0.5 * column, level, middle + 0.5 * column, area.bottom),
            target,
            heading,
            scale,
            view,
        )
        seen = camera(
            view,
            heading=heading,
            target=target,
            center=(middle * canvas.fine, level * canvas.fine),
            scale=scale * canvas.fine,
        )
        _contact_shadows(canvas, tracks, frame, seen.axes[0], target, (middle, level), scale)
        place, around = tracks.motion.root_position[frame], tracks.around
        draw_rods(canvas.image, around, seen, place, stature, front=False, near=BESIDE)
        draw_figure(canvas.image, tracks.figure, tracks.positions[frame], tracks.world[frame], seen)
        draw_rods(canvas.image, around, seen, place, stature, front=True, near=BESIDE)
    canvas.line([(area.left, area.bottom), (area.right, area.bottom)], palette.FLOOR)


def row_height(tracks: Tracks, frames: Int[np.ndarray, "n"], level: float) -> float:
    """Pixels that a row wants which on level ground is ``level`` high, at the same scale."""
    return level + (level - 26.0) / (1.03 * tracks.stature) * sum(_room(tracks, frames))


def _room(tracks: Tracks, frames: Int[np.ndarray, "n"]) -> tuple[float, float]:
    """Meters that figures rise over a stature, and that feet stand below the ground at the hips.

    None on level ground.
    """
    if isinstance(tracks.surface, Flat):
        return 0.0, 0.0
    over = under = 0.0
    for frame in frames.tolist():
        height = tracks.figure.pose(tracks.positions[frame], tracks.world[frame])[0][:, 1]
        for view in ("right", "front"):
            level = _target(tracks, frame, view)[1]
            over = max(over, float(height.max() - level) - 1.03 * tracks.stature)
            under = max(under, float(level - height.min()))
    return over, under


def _target(tracks: Tracks, frame: int, view: str) -> Float[np.ndarray, "3"]:
    """World point on the ground that is drawn in the middle of a column, meters."""
    target = tracks.motion.root_position[frame].copy()
    if view != "front":  # the pelvis may sway out of the column's middle only sideways
        target += 0.02 * tracks.stature * ahead(float(tracks.heading[frame]))
    target[1] = float(tracks.ground(target[0], target[2]))
    return target


def _ground_under(
    canvas: Canvas,
    tracks: Tracks,
    area: Area,
    target: Float[np.ndarray, "3"],
    heading: float,
    scale: float,
    view: str,
) -> None:
    """Profile of the ground in one column, filled down to the area's bottom."""
    x = np.arange(area.left, area.right + 0.5, 0.5)
    along = (x - 0.5 * (area.left + area.right)) / scale
    across = leftward(heading) if view == "front" else ahead(heading)
    points = target + along[:, None] * across
    y = area.top - scale * (tracks.ground(points[:, 0], points[:, 2]) - target[1])
    shown = np.minimum(y, area.bottom)
    canvas.polygon(
        [*pairs(x, shown), (area.right, area.bottom), (area.left, area.bottom)], palette.FLOOR
    )
    canvas.line(pairs(x, shown), palette.FRAME, 1.0)


def _contact_shadows(
    canvas: Canvas,
    tracks: Tracks,
    frame: int,
    right: Float[np.ndarray, "3"],
    target: Float[np.ndarray, "3"],
    base: tuple[float, float],
    scale: float,
) -> None:
    """A wide faint shadow under the body and a small dark one under each foot near the floor."""
    stature = tracks.stature
    offset = float((tracks.motion.root_position[frame] - target) @ right)
    canvas.shadow(base[0] + scale * offset, base[1] + 5, 0.24 * stature * scale, 7.0, 0.16)
    if tracks.soles is None:
        return
    for side in (0, 1):
        points = tracks.soles[frame, side]
        across = (points - target) @ right
        ground = tracks.ground(points[:, 0], points[:, 2])
        above = float((points[:, 1] - ground).min())
        near = np.clip(1.0 - above / (0.08 * stature), 0.0, 1.0)
        middle = 0.5 * (across.min() + across.max())
        half = 0.5 * np.ptp(across) + 0.03 * stature
        drop = scale * float(ground.max() - target[1])
        canvas.shadow(
            base[0] + scale * middle, base[1] - drop + 3, scale * half, 5.0, 0.42 * float(near)
        )


def column_notes(
    canvas: Canvas,
    tracks: Tracks,
    area: Area,
    frames: Int[np.ndarray, "n"],
    is_stride: bool,
) -> None:
    """Share of the stride, time and sole contacts under each figure."""
    column = area.width / len(frames)
    contacts = tracks.motion.contacts
    for k, frame in enumerate(frames.tolist()):
        middle = area.left + (k + 0.5) * column
        time = f"{frame / tracks.motion.fps:.2f} s"
        words = f"{100 * k / len(frames):.0f} %   {time}" if is_stride else time
        canvas.text(middle, area.top + 14, words, size=13, color=palette.INK, anchor="ms")
        if contacts is None:
            continue
        for side in (0, 1):
            for point in range(3):
                x = middle + (18 if side else -18) + 8.0 * (point - 1)
                fill = palette.SIDE_LINES[side] if contacts[frame, side, point] else palette.PAPER
                canvas.dot(x, area.top + 27, 3.0, fill, palette.SIDE_LINES[side])
