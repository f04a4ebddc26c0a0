"""A contact sheet: one picture that shows whether a walk is right."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gaitsmith.errors import InvalidInputError
from gaitsmith.skin.palette import SIDE_LIMBS
from gaitsmith.viz import palette
from gaitsmith.viz.above import map_height, map_panel
from gaitsmith.viz.canvas import Area, Canvas
from gaitsmith.viz.figures import column_notes, figure_row, row_height
from gaitsmith.viz.strips import angle_panel, stick_height, stick_panel, sticks_of
from gaitsmith.viz.tracks import stride_frames, tracks_of

if TYPE_CHECKING:
    from pathlib import Path

    from gaitsmith.motion.motion import Motion
    from gaitsmith.viz.tracks import Tracks

_MARGIN = 40
_HEADER = 92
_CAPTION = 26


def contact_sheet(
    motion: Motion, path: str | Path, *, phases: int = 8, width: int = 1600, fine: int = 2
) -> None:
    """Write a PNG that shows ``motion`` at a glance.

    From top to bottom: facts; one stride in the middle of the motion from the right and
    from ahead; the whole walk from above with footprints; the legs as sticks from the side;
    hip, knee and ankle angles over time. Without footsteps in the labels, the figures are
    spread over the whole motion. The same motion gives the same bytes.

    Parameters
    ----------
    motion
        At least one frame. A rig with the bones of a person is shown as one, whatever its
        names and its rest pose; any other as a solid along each bone.
    path
        Where to write; PNG whatever its suffix.
    phases
        Figures in a row, 2 to 16.
    width
        Of the picture, pixels, at least 800.
    fine
        How many times larger it is drawn before it is reduced, 1 to 4.

    Raises
    ------
    InvalidInputError
        If the motion has no frames, or a number is out of range.
    """
    for name, value, low, high in (
        ("phases", phases, 2, 16),
        ("width", width, 800, 6400),
        ("fine", fine, 1, 4),
    ):
        if not low <= value <= high or value != int(value):
            raise InvalidInputError(
                f"{name} must be a whole number from {low} to {high}, got {value!r}"
            )
    tracks = tracks_of(motion)
    unit = (width - 2 * _MARGIN) / 1520.0
    frames, _ = stride_frames(tracks.motion, phases)
    # figures of a row may just touch when they take long steps
    side, front = (
        min(1.03 * 190.0 * (8.0 / phases) / share, most) * unit + 26.0
        for share, most in ((0.60, 460.0), (0.62, 300.0))
    )
    heights = {
        "side": row_height(tracks, frames, side),
        "front": row_height(tracks, frames, front),
        "map": map_height(tracks, width - 2 * _MARGIN, 150.0 * unit, 420.0 * unit),
        "sticks": stick_height(sticks_of(tracks), width - 2.0 * _MARGIN, 270.0 * unit),
        "angles": 210.0 * unit,
    }
    total = _HEADER + sum(heights.values()) + 5 * _CAPTION + 40 + 5 * 22
    canvas = Canvas(width, round(total), fine=fine)
    _header(canvas, tracks)
    _body(canvas, tracks, heights, phases)
    canvas.save(path)


def _body(canvas: Canvas, tracks: Tracks, heights: dict[str, float], phases: int) -> None:
    """All panels, one under the other."""
    left, right = float(_MARGIN), float(canvas.width - _MARGIN)
    frames, is_stride = stride_frames(tracks.motion, phases)
    span = "one stride" if is_stride else "whole motion"
    top = _HEADER + _CAPTION
    canvas.text(left, top - 8, f"From the right, {span}", color=palette.INK)
    area = Area(left, top, right, top + heights["side"])
    figure_row(canvas, tracks, area, frames, "right")
    column_notes(
        canvas, tracks, Area(left, area.bottom + 2, right, area.bottom + 40), frames, is_stride
    )
    top = area.bottom + 40 + 22 + _CAPTION
    canvas.text(left, top - 8, "From ahead, the same instants", color=palette.INK)
    area = Area(left, top, right, top + heights["front"])
    figure_row(canvas, tracks, area, frames, "front")
    top = area.bottom + 22 + _CAPTION
    canvas.text(left, top - 8, "From above", color=palette.INK)
    _map_legend(canvas, tracks, right, top - 8)
    area = Area(left, top, right, top + heights["map"])
    map_panel(canvas, tracks, area)
    top = area.bottom + 22 + _CAPTION
    area = Area(left, top, right, top + heights["sticks"])
    sticks = sticks_of(tracks)
    if sticks is not None:
        canvas.text(left, top - 8, "Legs from the right along the way", color=palette.INK)
        stick_panel(canvas, tracks, area, sticks)
    top = area.bottom + 22 + _CAPTION
    gap = 28.0
    third = (right - left - 2 * gap) / 3
    for k, (which, title) in enumerate(
        (
            ("hip", "Hip flexion, degrees"),
            ("knee", "Knee flexion, degrees"),
            ("ankle", "Ankle dorsiflexion, degrees"),
        )
    ):
        start = left + k * (third + gap)
        angle_panel(
            canvas, tracks, Area(start, top, start + third, top + heights["angles"]), which, title
        )


def _header(canvas: Canvas, tracks: Tracks) -> None:
    """Key facts in one line, details in another, and which colour is which side."""
    motion, labels = tracks.motion, tracks.motion.labels
    speed = tracks.distance / motion.duration if motion.duration > 0 else 0.0
    facts = [f"{motion.duration:.2f} s", f"{tracks.distance:.2f} m", f"{speed:.2f} m/s"]
    details = [f"{len(motion)} frames at {motion.fps:g} fps", f"body {tracks.stature:.2f} m"]
    if labels is not None and len(labels.footstep_side) > 2:
        count = len(labels.footstep_side) - 2
        facts.insert(0, f"{count} step" + ("s" if count > 1 else ""))
        time, place = labels.footstep_time[2:], labels.footstep_position[2:]
        if count > 2 and time[-1] > time[0]:
            length = np.linalg.norm(np.diff(place[:, [0, 2]], axis=0), axis=1)
            details.append(f"median distance between landings {np.median(length):.2f} m")
            details.append(f"cadence {60.0 / np.median(np.diff(time)):.0f} steps/min")
    canvas.text(_MARGIN, 48, "  ·  ".join(facts), size=26, color=palette.INK)
    canvas.text(_MARGIN, 74, "   ·   ".join(details), size=14)
    right = canvas.width - _MARGIN
    for side, (word, x) in enumerate((("left", right - 120), ("right", right - 50))):
        canvas.box(x - 18, 37, x - 5, 50, SIDE_LIMBS[side], round_by=3)
        canvas.text(x, 48, word, size=14, color=palette.INK)


def _map_legend(canvas: Canvas, tracks: Tracks, right: float, y: float) -> None:
    labels = tracks.motion.labels
    canvas.line([(right - 74, y - 5), (right - 44, y - 5)], palette.PELVIS_LINE, 1.6)
    canvas.text(right, y, "pelvis", size=12, anchor="rs")
    if labels is not None and labels.path is not None:
        canvas.dashes(
            np.array([[right - 150.0, y - 5], [right - 120.0, y - 5]]), palette.PATH_LINE, 1.5, 5.0
        )
        canvas.text(right - 88, y, "path", size=12, anchor="rs")
