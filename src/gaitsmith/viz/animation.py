"""An animated GIF of a walk: the camera goes along, the ground scrolls by."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageChops, ImageDraw

from gaitsmith._checks import positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.viz import palette
from gaitsmith.viz.above import footprints
from gaitsmith.viz.around import draw_posts, draw_rods
from gaitsmith.viz.render import Camera, camera, draw_figure
from gaitsmith.viz.shadows import ELEVATION as _ELEVATION
from gaitsmith.viz.shadows import draw_prints, draw_shadow
from gaitsmith.viz.terrain import draw_land, draw_solids, hiding
from gaitsmith.viz.tracks import smooth, tracks_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.skin.palette import Color
    from gaitsmith.viz.tracks import Tracks

#: The picture's height over its width; how many statures fit into the height.
_ASPECT, _STATURES = 0.9, 1.34
_CELL = 0.5
# How far the ground is drawn around the figure, in statures.
_REACH = 1.8
_FINE = 2


def gif(motion: Motion, path: str | Path, *, width: int = 480, fps: float = 20.0) -> None:
    """Write an animated GIF of ``motion``, seen from ahead and to the right.

    The camera follows the pelvis and, slowly, its heading. Footprints stay on the ground
    where labels or contacts tell of them. The same motion gives the same bytes.

    Parameters
    ----------
    motion
        At least one frame. A rig with the bones of a person is shown as one, whatever its
        names and its rest pose; any other as a solid along each bone.
    path
        Where to write; GIF whatever its suffix.
    width
        Pixels, 120 to 1920.
    fps
        Pictures a second, at most the motion's; GIF counts hundredths of a second, so the
        nearest that this allows is taken.

    Raises
    ------
    InvalidInputError
        If the motion has no frames, or a number is out of range.
    """
    if not 120 <= width <= 1920 or width != int(width):
        raise InvalidInputError(f"width must be a whole number from 120 to 1920, got {width!r}")
    delay = delay_of(motion, fps)
    tracks = tracks_of(motion)
    scene = _Scene(tracks, width)
    write_pictures(path, scene.draw, motion, delay)


def delay_of(motion: Motion, fps: float) -> int:
    """Hundredths of a second between pictures, ``fps`` of them a second if that can be."""
    return max(2, round(100.0 / min(positive("fps", fps, "pictures per second"), motion.fps)))


def write_pictures(
    path: str | Path,
    draw: Callable[[int], Image.Image],
    motion: Motion,
    delay: int,
    colors: Sequence[Color] = (),
) -> None:
    """An animated GIF of the pictures that ``draw`` gives of frames of ``motion``.

    ``colors`` are rare ones that must not be lost.
    """
    count = int(np.floor(motion.duration * 100.0 / delay + 1e-9)) + 1
    frames = np.round(np.arange(count) * delay / 100.0 * motion.fps).astype(int)
    frames = np.minimum(frames, len(motion) - 1).tolist()
    table = _shared_palette([draw(frame) for frame in frames[:: max(1, count // 3)]], colors)
    pictures = (draw(frame).quantize(palette=table, dither=Image.Dither.NONE) for frame in frames)
    first = next(pictures)
    # the last picture stays a little: where a walk ends is worth a look
    times = [10 * delay] * (count - 1) + [max(600, 10 * delay)]
    first.save(
        path,
        format="GIF",
        save_all=True,
        append_images=pictures,
        duration=times if count > 1 else times[0],
        loop=0,
        optimize=False,
        disposal=1,
    )


def _shared_palette(samples: list[Image.Image], colors: Sequence[Color]) -> Image.Image:
    """One palette for all pictures, from a strip of samples."""
    width, height = samples[0].size
    strip = Image.new("RGB", (width * len(samples), height))
    for k, sample in enumerate(samples):
        strip.paste(sample, (k * width, 0))
    # thin and rare colours would be lost among those that fill the pictures
    pen = ImageDraw.Draw(strip)
    size = max(4, width // 24)
    for side, line in enumerate(palette.SIDE_LINES):
        for step in range(8):
            box = (step * size, side * size, (step + 1) * size, (side + 1) * size)
            pen.rectangle(box, fill=palette.mix(palette.FLOOR, line, 0.05 * (step + 1)))
    for row, color in enumerate(colors, start=2):
        for step in range(4):
            box = (step * size, row * size, (step + 1) * size, (row + 1) * size)
            pen.rectangle(box, fill=palette.mix(palette.PAPER, color, 0.25 * (step + 1)))
    return strip.quantize(255, method=Image.Quantize.MEDIANCUT, kmeans=2)


class _Scene:
    """Everything of the animation that does not change from picture to picture."""

    def __init__(self, tracks: Tracks, width: int) -> None:
        self.tracks = tracks
        self.size = (width, round(_ASPECT * width))
        self.large = (width * _FINE, self.size[1] * _FINE)
        stature = tracks.stature
        self.scale = self.large[1] / (_STATURES * stature)
        fps = tracks.motion.fps
        root = tracks.root
        level = smooth(tracks.ground(root[:, 0], root[:, 2]), 1.1 * fps)
        self.target = np.stack([root[:, 0], level, root[:, 2]], axis=1)
        self.heading = smooth(tracks.heading, 2.5 * fps)
        self.center = (0.5 * self.large[0], 0.84 * self.large[1])
        self.prints = footprints(tracks)
        # from behind when it goes up: from ahead, the higher steps would hide the feet
        self.view = "rear-quarter" if level[-1] - level[0] > 0.1 else "three-quarter"
        self.floor, self.fading = self._backdrop()

    def _backdrop(self) -> tuple[Image.Image, Image.Image]:
        """Paper with a pool of floor colour, and how strongly the grid shows at each pixel."""
        wide, high = self.large
        radius = 1.55 * self.tracks.stature * self.scale
        x = (np.arange(wide) + 0.5 - self.center[0]) / radius
        y = (np.arange(high) + 0.5 - self.center[1]) / (radius * np.sin(_ELEVATION) * 1.25)
        share = np.clip(1.0 - np.hypot(x[None], y[:, None]), 0.0, 1.0)
        share = share * share * (3.0 - 2.0 * share)
        mask = Image.fromarray(np.round(255.0 * share).astype(np.uint8))
        floor = Image.new("RGB", self.large, palette.PAPER)
        floor.paste(palette.FLOOR, (0, 0), mask)
        return floor, Image.fromarray(np.round(np.minimum(255.0, 510.0 * share)).astype(np.uint8))

    def draw(self, frame: int) -> Image.Image:
        """The finished RGB picture of one frame."""
        view = camera(
            self.view,
            heading=float(self.heading[frame]),
            target=self.target[frame],
            center=self.center,
            scale=self.scale,
            elevation=_ELEVATION,
        )
        image = self.floor.copy()
        tracks, land = self.tracks, self.tracks.land
        if land.is_level:
            self._grid(image, view)
        else:
            self._terrain(image, view)
        draw_posts(image, tracks.around, view, land.base)
        if land.solids:
            draw_solids(image, land, view, wide=_FINE)
        hidden = hiding(land, view, self.large)
        reach = 1.3 * tracks.stature
        draw_prints(image, tracks, self.prints, frame, view, reach=reach, hidden=hidden)
        draw_shadow(image, tracks, frame, view, hidden)
        place = tracks.motion.root_position[frame]
        draw_rods(image, tracks.around, view, place, tracks.stature, front=False)
        depth = None if hidden is None else hidden.depth
        draw_figure(image, tracks.figure, tracks.positions[frame], tracks.world[frame], view, depth)
        draw_rods(image, tracks.around, view, place, tracks.stature, front=True)
        return image.reduce(_FINE)

    def _grid(self, image: Image.Image, view: Camera) -> None:
        """Lines of half a metre on the ground, fading with distance."""
        reach = _REACH * self.tracks.stature
        lines: list[Float[np.ndarray, "points 3"]] = []
        for axis in (0, 2):
            middle = float(view.target[axis])
            across = float(view.target[2 - axis])
            run = np.array([across - reach, across + reach])
            for k in range(
                int(np.ceil((middle - reach) / _CELL)), int((middle + reach) / _CELL) + 1
            ):
                points = np.empty((len(run), 3))
                points[:, axis], points[:, 2 - axis] = k * _CELL, run
                points[:, 1] = self.tracks.land.base.height(points[:, 0], points[:, 2])
                lines.append(points)
        box = self.fading.getbbox()
        if box is None:
            return
        fading = self.fading.crop(box)
        mask = Image.new("L", fading.size, 0)
        pen = ImageDraw.Draw(mask)
        shown = view.project(np.stack(lines))[..., :2] - np.array(box[:2])
        for points in shown.reshape(len(lines), -1).tolist():
            pen.line(points, fill=255, width=_FINE)
        image.paste(palette.GRID_DARK, box[:2], ImageChops.multiply(mask, fading))

    def _terrain(self, image: Image.Image, view: Camera) -> None:
        """Slopes and steps as shaded cells."""
        reach, at = _REACH * self.tracks.stature, view.target[[0, 2]]
        layer = self.floor.copy()
        draw_land(layer, self.tracks.land, view, at - reach, at + reach, wide=_FINE)
        image.paste(layer, (0, 0), self.fading)
