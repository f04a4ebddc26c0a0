"""What figures leave on the ground of an animation: shadows, and prints of their feet."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from gaitsmith.viz import palette

if TYPE_CHECKING:
    from jaxtyping import Float

    from gaitsmith.viz.render import Camera
    from gaitsmith.viz.terrain import Hiding
    from gaitsmith.viz.tracks import Tracks

#: How far the camera of an animation looks down, radians.
ELEVATION = 0.27
#: Where the sun stands in the camera's level frame (right, up, toward the viewer).
SUN = np.array([0.38, 1.0, 0.16])
#: Pixels of the picture to one of the shadow's mask.
COARSE = 6


def draw_prints(
    image: Image.Image,
    tracks: Tracks,
    prints: list[tuple[int, Float[np.ndarray, "points 3"]]],
    frame: int,
    view: Camera,
    *,
    reach: float,
    hidden: Hiding | None = None,
) -> None:
    """Prints of the feet that have landed by now, fading ``reach`` meters from the middle."""
    now, labels = frame / tracks.motion.fps, tracks.motion.labels
    pen = ImageDraw.Draw(image)
    for k, (side, shape) in enumerate(prints):
        if labels is not None and labels.footstep_time[k] > now + 1e-9:
            continue
        if hidden is not None and hidden.hides(shape.mean(axis=0)):
            continue
        away = float(np.linalg.norm((shape.mean(axis=0) - view.target)[[0, 2]]))
        share = 0.34 * np.clip(1.25 - away / reach, 0.0, 1.0)
        if share > 0.02:
            tint = palette.mix(palette.FLOOR, palette.SIDE_LINES[side], float(share))
            pen.polygon(view.project(shape)[:, :2].ravel().tolist(), fill=tint)


def draw_shadow(
    image: Image.Image, tracks: Tracks, frame: int, view: Camera, hidden: Hiding | None = None
) -> None:
    """The figure's own shape on the ground, soft, and darker where the feet bear."""
    vertices, _ = tracks.figure.pose(tracks.positions[frame], tracks.world[frame])
    level = np.array([view.axes[2, 0], 0.0, view.axes[2, 2]])
    level /= np.linalg.norm(level)
    sun = SUN[0] * view.axes[0] + SUN[1] * np.array([0.0, 1.0, 0.0]) + SUN[2] * level
    ground = tracks.ground(*tracks.motion.root_position[frame, [0, 2]])
    a, b, c = (vertices[corner] for corner in tracks.figure.faces.T)
    points = np.concatenate([vertices, (a + b + c) / 3.0])
    fallen = points - ((points[:, 1] - ground) / sun[1])[:, None] * sun
    if hidden is not None:
        fallen = fallen[~hidden.hides(fallen)]
    # a coarse picture of dots, grown until they meet: it is blurred anyway
    wide, high = (size // COARSE for size in image.size)
    x, y = (view.project(fallen)[:, :2] / COARSE).astype(np.int64).T
    inside = (x >= 0) & (x < wide) & (y >= 0) & (y < high)
    dots = np.zeros((high, wide), np.uint8)
    dots[y[inside], x[inside]] = 66
    soft = 0.014 * tracks.stature * view.scale / COARSE
    mask = Image.fromarray(dots).filter(ImageFilter.MaxFilter(3))
    mask = mask.filter(ImageFilter.GaussianBlur(soft))
    box = mask.getbbox()
    if box is not None:
        left, top, right, bottom = (COARSE * edge for edge in box)
        shadow = mask.crop(box).resize((right - left, bottom - top), Image.Resampling.BILINEAR)
        image.paste(palette.SHADOW, (left, top), shadow)
    _contact(image, tracks, frame, view, hidden)


def _contact(
    image: Image.Image, tracks: Tracks, frame: int, view: Camera, hidden: Hiding | None
) -> None:
    """A dark soft patch under each shoe, which goes as the shoe lifts."""
    if tracks.soles is None:
        return
    mask = Image.new("L", image.size, 0)
    pen = ImageDraw.Draw(mask)
    points = tracks.soles[frame].reshape(-1, 3).copy()
    ground = tracks.ground(points[:, 0], points[:, 2])
    above = np.clip((points[:, 1] - ground) / (0.05 * tracks.stature), 0.0, 1.0)
    points[:, 1] = ground
    if hidden is not None:
        above[hidden.hides(points)] = 1.0
    wide = 0.05 * tracks.stature * view.scale
    tall = wide * np.sin(ELEVATION) * 1.6
    shown = view.project(points)
    for k in np.argsort(-above, kind="stable").tolist():  # the darkest on top
        (x, y), fill = shown[k, :2].tolist(), round(130 * (1.0 - above[k]) ** 2)
        pen.ellipse((x - wide, y - tall, x + wide, y + tall), fill=fill)
    box = mask.getbbox()
    if box is None:
        return
    pad = int(0.05 * view.scale)
    box = (box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad)
    blurred = mask.crop(box).filter(ImageFilter.GaussianBlur(0.016 * view.scale))
    image.paste(palette.SHADOW, box[:2], blurred)
