"""An animated GIF of a walk: the camera goes along, the ground scrolls by."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from gaitsmith._checks import positive
from gaitsmith.errors import InvalidInputError
from gaitsmith.viz import palette
from gaitsmith.viz.above import footprints
from gaitsmith.viz.render import Camera, camera, draw_figure
from gaitsmith.viz.tracks import smooth, tracks_of

if TYPE_CHECKING:
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.motion.motion import Motion
    from gaitsmith.viz.tracks import Tracks

#: The picture's height over its width; how many statures fit into the height.
_ASPECT, _STATURES = 0.9, 1.34
_ELEVATION = 0.27
_CELL = 0.5
# How far the ground is drawn around the figure, in statures.
_REACH = 1.8
# Where the sun stands in the camera's level frame (right, up, toward the viewer).
_SUN = np.array([0.38, 1.0, 0.16])
_FINE = 2
# Pixels of the picture to one of the shadow's mask.
_COARSE = 6


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
    delay = max(2, round(100.0 / min(positive("fps", fps, "pictures per second"), motion.fps)))
    tracks = tracks_of(motion)
    scene = _Scene(tracks, width)
    count = int(np.floor(motion.duration * 100.0 / delay + 1e-9)) + 1
    frames = np.round(np.arange(count) * delay / 100.0 * motion.fps).astype(int)
    frames = np.minimum(frames, len(motion) - 1).tolist()
    colors = _shared_palette([scene.draw(frame) for frame in frames[:: max(1, count // 3)]])
    pictures = (
        scene.draw(frame).quantize(palette=colors, dither=Image.Dither.NONE) for frame in frames
    )
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


def _shared_palette(samples: list[Image.Image]) -> Image.Image:
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
        labels = tracks.motion.labels
        self.landings = None if labels is None else labels.footstep_time
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
        if self.tracks.is_level:
            self._grid(image, view)
        else:
            self._terrain(image, view)
        self._footprints(image, view, frame)
        self._shadow(image, view, frame)
        tracks = self.tracks
        draw_figure(image, tracks.figure, tracks.positions[frame], tracks.world[frame], view)
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
                points[:, 1] = self.tracks.ground(points[:, 0], points[:, 2])
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
        """Slopes and steps as shaded cells, the far ones first."""
        x, z = self.tracks.ground_lines(view.target, _REACH * self.tracks.stature)
        points = np.empty((len(z), len(x), 3))
        points[..., 0], points[..., 2] = x[None], z[:, None]
        points[..., 1] = self.tracks.ground(points[..., 0], points[..., 2])
        cells = np.stack(
            [points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2
        )
        cells = cells.reshape(-1, 4, 3)
        normal = np.cross(cells[:, 2] - cells[:, 0], cells[:, 1] - cells[:, 3])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
        share = 0.75 * np.clip(1.0 - np.abs(normal[:, 1]) ** 4, 0.0, 1.0)
        flat = view.project(cells)
        layer = self.floor.copy()
        pen = ImageDraw.Draw(layer)
        edge = palette.GRID_DARK if len(x) < 40 else None
        for k in np.argsort(flat[..., 2].mean(axis=1), kind="stable").tolist():
            fill = palette.mix(palette.FLOOR, palette.GRID_DARK, float(share[k]))
            pen.polygon(flat[k, :, :2].ravel().tolist(), fill=fill, outline=edge)
        image.paste(layer, (0, 0), self.fading)

    def _footprints(self, image: Image.Image, view: Camera, frame: int) -> None:
        """Prints of the feet that have landed by now."""
        now = frame / self.tracks.motion.fps
        pen = ImageDraw.Draw(image)
        for k, (side, shape) in enumerate(self.prints):
            if self.landings is not None and self.landings[k] > now + 1e-9:
                continue
            away = float(np.linalg.norm((shape.mean(axis=0) - view.target)[[0, 2]]))
            share = 0.34 * np.clip(1.25 - away / (1.3 * self.tracks.stature), 0.0, 1.0)
            if share > 0.02:
                tint = palette.mix(palette.FLOOR, palette.SIDE_LINES[side], float(share))
                pen.polygon(view.project(shape)[:, :2].ravel().tolist(), fill=tint)

    def _shadow(self, image: Image.Image, view: Camera, frame: int) -> None:
        """The figure's own shape on the ground, soft, and darker where the feet bear."""
        tracks = self.tracks
        vertices, _ = tracks.figure.pose(tracks.positions[frame], tracks.world[frame])
        level = np.array([view.axes[2, 0], 0.0, view.axes[2, 2]])
        level /= np.linalg.norm(level)
        sun = _SUN[0] * view.axes[0] + _SUN[1] * np.array([0.0, 1.0, 0.0]) + _SUN[2] * level
        ground = tracks.ground(*tracks.motion.root_position[frame, [0, 2]])
        a, b, c = (vertices[corner] for corner in tracks.figure.faces.T)
        points = np.concatenate([vertices, (a + b + c) / 3.0])
        fallen = points - ((points[:, 1] - ground) / sun[1])[:, None] * sun
        # a coarse picture of dots, grown until they meet: it is blurred anyway
        wide, high = (size // _COARSE for size in image.size)
        x, y = (view.project(fallen)[:, :2] / _COARSE).astype(np.int64).T
        inside = (x >= 0) & (x < wide) & (y >= 0) & (y < high)
        dots = np.zeros((high, wide), np.uint8)
        dots[y[inside], x[inside]] = 66
        soft = 0.014 * tracks.stature * self.scale / _COARSE
        mask = Image.fromarray(dots).filter(ImageFilter.MaxFilter(3))
        mask = mask.filter(ImageFilter.GaussianBlur(soft))
        box = mask.getbbox()
        if box is not None:
            left, top, right, bottom = (_COARSE * edge for edge in box)
            shadow = mask.crop(box).resize((right - left, bottom - top), Image.Resampling.BILINEAR)
            image.paste(palette.SHADOW, (left, top), shadow)
        self._contact(image, view, frame)

    def _contact(self, image: Image.Image, view: Camera, frame: int) -> None:
        """A dark soft patch under each shoe, which goes as the shoe lifts."""
        tracks = self.tracks
        if tracks.soles is None:
            return
        mask = Image.new("L", image.size, 0)
        pen = ImageDraw.Draw(mask)
        for side in (0, 1):
            points = tracks.soles[frame, side].copy()
            ground = tracks.ground(points[:, 0], points[:, 2])
            above = np.clip((points[:, 1] - ground) / (0.05 * tracks.stature), 0.0, 1.0)
            points[:, 1] = ground
            wide = 0.05 * tracks.stature * self.scale
            for (x, y), fade in zip(
                view.project(points)[:, :2].tolist(), above.tolist(), strict=True
            ):
                tall = wide * np.sin(_ELEVATION) * 1.6
                fill = round(130 * (1.0 - fade) ** 2)
                pen.ellipse((x - wide, y - tall, x + wide, y + tall), fill=fill)
        box = mask.getbbox()
        if box is None:
            return
        pad = int(0.05 * self.scale)
        box = (box[0] - pad, box[1] - pad, box[2] + pad, box[3] + pad)
        blurred = mask.crop(box).filter(ImageFilter.GaussianBlur(0.016 * self.scale))
        image.paste(palette.SHADOW, box[:2], blurred)
