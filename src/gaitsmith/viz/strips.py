"""Strips along the way and along time: leg sticks, joint angles, contacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.conventions import SIDES, ahead
from gaitsmith.viz import palette
from gaitsmith.viz.canvas import Area, nice_step, pairs
from gaitsmith.viz.tracks import flexion

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.viz.canvas import Canvas
    from gaitsmith.viz.tracks import Tracks

# Room below and beside the sticks, pixels.
_EDGE = 10.0


@dataclass(frozen=True, eq=False)
class Sticks:
    """The legs of all frames, unrolled.

    Each frame is seen along its own heading and set at the distance walked so far, so that a
    curved walk lies flat on the page.

    Attributes
    ----------
    legs
        Of [left, right]: ``(F, P, 2)`` (forward, up) of the joints and the sole, meters.
    low, high
        ``(2,)`` corners of everything.
    base
        Height that counts as 0, meters.
    """

    legs: tuple[Float[np.ndarray, "frames points 2"], ...]
    low: Float[np.ndarray, "2"]
    high: Float[np.ndarray, "2"]
    base: float


def sticks_of(tracks: Tracks) -> Sticks | None:
    """Sticks of the whole motion; None if a leg is missing."""
    chains = []
    for side in SIDES:
        names = [f"{side}{bone}" for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes")]
        chains.append([j for name in names if (j := tracks.joint(name)) is not None])
    if not all(len(chain) >= 2 for chain in chains):
        return None
    root, forward = tracks.motion.root_position, ahead(tracks.heading)
    base = float(tracks.ground(root[:, 0], root[:, 2]).min())
    legs = []
    for side, chain in enumerate(chains):
        leg = _leg_points(tracks, side, chain)
        along = tracks.progress[:, None] + ((leg - root[:, None]) * forward[:, None]).sum(-1)
        legs.append(np.stack([along, leg[..., 1] - base], axis=-1))
    every = np.concatenate([leg.reshape(-1, 2) for leg in legs])
    low = np.minimum(every.min(axis=0), [np.inf, 0.0])
    return Sticks(tuple(legs), low, every.max(axis=0), base)


def stick_height(sticks: Sticks | None, width: float, most: float) -> float:
    """Height in pixels that the sticks want at ``width``."""
    if sticks is None:
        return 0.0
    span = sticks.high - sticks.low
    return min(most, (width - 2 * _EDGE) * float(span[1] / span[0]) + 2.4 * _EDGE)


def stick_panel(canvas: Canvas, tracks: Tracks, area: Area, sticks: Sticks) -> None:
    """Side view of the legs all along the walk, every n-th frame, with traces of the joints."""
    low, span = sticks.low, sticks.high - sticks.low
    scale = float(min((area.width - 2 * _EDGE) / span[0], (area.height - 2 * _EDGE) / span[1]))
    shift = area.left + 0.5 * (area.width - scale * float(span[0])) - scale * float(low[0])
    floor = area.bottom - _EDGE + scale * float(low[1])
    canvas.box(area.left, area.top, area.right, area.bottom, palette.PANEL)
    _stick_ground(canvas, tracks, area, shift, floor, scale, sticks.base)
    frames = len(tracks.motion)
    spacing = float(np.ptp(tracks.progress)) * scale / max(frames - 1, 1)
    every = min(max(1, round(11.0 / max(spacing, 1e-6))), max(1, frames // 8))
    for side in (0, 1):
        x = shift + scale * sticks.legs[side][..., 0]
        y = floor - scale * sticks.legs[side][..., 1]
        thin = palette.mix(palette.PANEL, palette.SIDE_LINES[side], 0.55)
        for frame in range(0, frames, every):
            canvas.line(pairs(x[frame], y[frame]), thin, 1.0)
        for point in {0, 1, 2, x.shape[1] - 1}:
            canvas.line(pairs(x[:, point], y[:, point]), palette.SIDE_LINES[side], 1.0)


def _leg_points(
    tracks: Tracks, side: int, chain: list[int]
) -> Float[np.ndarray, "frames points 3"]:
    """Hip, knee and ankle, then the sole's heel, ball and toe tip where they are known."""
    leg = tracks.positions[:, chain[:3]]
    if tracks.soles is None:
        return tracks.positions[:, chain]
    return np.concatenate([leg, tracks.soles[:, side]], axis=1)


def _stick_ground(
    canvas: Canvas,
    tracks: Tracks,
    area: Area,
    shift: float,
    floor: float,
    scale: float,
    base: float,
) -> None:
    """Ground under the sticks, unrolled like them; beyond the walk it runs on level."""
    root, progress = tracks.motion.root_position, tracks.progress
    order = np.argsort(progress, kind="stable")
    x = np.arange(area.left, area.right + 0.5, 0.5)
    along = (x - shift) / scale
    at_x, at_z = (np.interp(along, progress[order], root[order, k]) for k in (0, 2))
    beyond = along - np.clip(along, progress.min(), progress.max())
    heading = np.interp(along, progress[order], tracks.heading[order])
    at_x, at_z = at_x + beyond * np.sin(heading), at_z + beyond * np.cos(heading)
    y = np.minimum(floor - scale * (tracks.ground(at_x, at_z) - base), area.bottom)
    canvas.polygon(
        [*pairs(x, y), (area.right, area.bottom), (area.left, area.bottom)], palette.FLOOR
    )
    canvas.line(pairs(x, y), palette.FRAME, 1.0)


def angle_panel(canvas: Canvas, tracks: Tracks, area: Area, which: str, title: str) -> None:
    """Angle of both sides over time, with landings and contact bars."""
    curves = flexion(tracks, which)
    canvas.text(area.left, area.top - 12, title, size=13, color=palette.INK)
    plot = Area(area.left + 30, area.top, area.right, area.bottom - 36)
    canvas.box(plot.left, plot.top, plot.right, plot.bottom, palette.PANEL)
    if curves is None:
        canvas.text(0.5 * (plot.left + plot.right), plot.top + 40, "no such joints", anchor="ms")
        return
    motion = tracks.motion
    step = nice_step(max(float(np.ptp(curves)), 10.0), 5)
    low, high = step * np.floor(curves.min() / step), step * np.ceil(curves.max() / step)
    high = max(high, low + step)
    seconds = max(motion.duration, 1.0 / motion.fps)
    x = plot.left + plot.width * motion.times / seconds
    y = plot.bottom - plot.height * (curves - low) / (high - low)
    for value in np.arange(low, high + 0.5 * step, step).tolist():
        at = plot.bottom - plot.height * (value - low) / (high - low)
        canvas.line(
            [(plot.left, at), (plot.right, at)], palette.FRAME if value == 0 else palette.GRID
        )
        canvas.text(plot.left - 6, at, f"{value:.0f}", size=11, anchor="rm")
    tick = nice_step(seconds, 6)
    for value in np.arange(0.0, seconds + 1e-9, tick).tolist():
        at = plot.left + plot.width * value / seconds
        canvas.line([(at, plot.top), (at, plot.bottom)], palette.GRID)
        unit = " s" if value + tick > seconds + 1e-9 else ""
        canvas.text(at, plot.bottom + 32, f"{value:g}{unit}", size=11, anchor="ms")
    for side in (0, 1):
        canvas.line(pairs(x, y[:, side]), palette.SIDE_LINES[side], 1.6)
    if motion.contacts is not None:
        _contact_bars(canvas, tracks, plot, seconds)


def _contact_bars(canvas: Canvas, tracks: Tracks, plot: Area, seconds: float) -> None:
    """When each foot bears, as bars under the plot."""
    contacts = tracks.motion.contacts
    assert contacts is not None
    for side in (0, 1):
        top = plot.bottom + 5 + 7 * side
        bears = contacts[:, side].any(axis=1)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], bears.astype(int), [0]])))
        for start, stop in edges.reshape(-1, 2).tolist():
            a, b = (
                plot.left + plot.width * f / tracks.motion.fps / seconds for f in (start, stop - 1)
            )
            canvas.box(a, top, max(b, a + 1), top + 4, palette.SIDE_LINES[side])
