"""A picture drawn large and reduced: smooth lines, crisp text, soft shadows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from gaitsmith.viz import palette

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from jaxtyping import Float

    from gaitsmith.skin.palette import Color


@cache
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, ``size`` pixels."""
    return ImageFont.load_default(size=size)


@dataclass(frozen=True)
class Area:
    """Part of a picture, pixels."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def width(self) -> float:
        """Pixels from left to right."""
        return self.right - self.left

    @property
    def height(self) -> float:
        """Pixels from top to bottom."""
        return self.bottom - self.top


def pairs(x: Float[np.ndarray, "n"], y: Float[np.ndarray, "n"]) -> list[tuple[float, float]]:
    """Points for a line from their coordinates."""
    return list(zip(x.tolist(), y.tolist(), strict=True))


class Canvas:
    """Pillow image at ``fine`` times its size, in coordinates of the finished picture.

    Shapes are drawn large and reduced at the end; text is written after that, at its own
    size, where the font's hinting holds.
    """

    def __init__(self, width: int, height: int, *, fine: int = 2) -> None:
        self.width, self.height, self.fine = width, height, fine
        self.image = Image.new("RGB", (width * fine, height * fine), palette.PAPER)
        self.pen = ImageDraw.Draw(self.image)
        self._texts: list[tuple[float, float, str, int, Color, str]] = []

    def _scaled(self, points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
        # Pillow puts pixel k at k, the finished picture's pixel k spans k to k + 1
        return [(x * self.fine - 0.5, y * self.fine - 0.5) for x, y in points]

    def line(self, points: Iterable[tuple[float, float]], color: Color, width: float = 1.0) -> None:
        """Polyline, ``width`` pixels."""
        large = self._scaled(points)
        pen = max(1, round(width * self.fine))
        if len(large) > 1:
            self.pen.line(large, fill=color, width=pen, joint="curve" if pen > 2 else None)

    def dashes(
        self, points: Float[np.ndarray, "n 2"], color: Color, width: float = 1.0, dash: float = 6.0
    ) -> None:
        """Dashed polyline: ``dash`` pixels on, as many off."""
        length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        keep = np.concatenate([[True], np.diff(length) > 0.0])
        length, points = length[keep], points[keep]
        for start in np.arange(0.0, length[-1], 2.0 * dash):
            at = np.linspace(start, min(start + dash, length[-1]), 4)
            x, y = (np.interp(at, length, points[:, k]) for k in (0, 1))
            self.line(list(zip(x.tolist(), y.tolist(), strict=True)), color, width)

    def polygon(
        self, points: Iterable[tuple[float, float]], fill: Color, edge: Color | None = None
    ) -> None:
        """Filled polygon, with a thin ``edge`` if given."""
        large = self._scaled(points)
        self.pen.polygon(large, fill=fill)
        if edge is not None:
            self.pen.line([*large, large[0], large[1]], fill=edge, width=self.fine, joint="curve")

    def box(
        self,
        left: float,
        top: float,
        right: float,
        bottom: float,
        fill: Color,
        *,
        edge: Color | None = None,
        round_by: float = 0.0,
    ) -> None:
        """Filled rectangle with rounded corners."""
        ((x0, y0), (x1, y1)) = self._scaled([(left, top), (right, bottom)])
        self.pen.rounded_rectangle(
            (x0, y0, x1, y1),
            radius=round_by * self.fine,
            fill=fill,
            outline=edge,
            width=self.fine if edge is not None else 0,
        )

    def dot(
        self, x: float, y: float, radius: float, fill: Color, edge: Color | None = None
    ) -> None:
        """Filled disc."""
        ((cx, cy),) = self._scaled([(x, y)])
        r = radius * self.fine
        self.pen.ellipse((cx - r, cy - r, cx + r, cy + r), fill=fill, outline=edge, width=self.fine)

    def shadow(self, x: float, y: float, across: float, down: float, strength: float) -> None:
        """Soft elliptic shadow, ``across`` and ``down`` its half-axes in pixels."""
        soft_ellipse(
            self.image,
            (x * self.fine, y * self.fine),
            (across * self.fine, down * self.fine),
            strength,
        )

    def text(
        self,
        x: float,
        y: float,
        words: str,
        *,
        size: int = 13,
        color: Color = palette.MUTED,
        anchor: str = "ls",
    ) -> None:
        """Words at ``(x, y)``; ``anchor`` as Pillow means it."""
        self._texts.append((x, y, words, size, color, anchor))

    def finish(self) -> Image.Image:
        """The finished picture."""
        image = self.image.reduce(self.fine) if self.fine > 1 else self.image.copy()
        pen = ImageDraw.Draw(image)
        for x, y, words, size, color, anchor in self._texts:
            pen.text((round(x), round(y)), words, fill=color, font=font(size), anchor=anchor)
        return image

    def save(self, path: str | Path) -> None:
        """Write the finished picture as PNG, whatever the suffix of ``path``."""
        self.finish().save(path, format="PNG", optimize=False, compress_level=6)


def soft_ellipse(
    image: Image.Image,
    center: tuple[float, float],
    radii: tuple[float, float],
    strength: float,
) -> None:
    """Darken ``image`` in a soft ellipse; ``strength`` 0 to 1 in the middle."""
    (x, y), (across, down) = center, radii
    if across < 0.5 or down < 0.5 or strength <= 0.0:
        return
    x0, y0 = max(int(x - across), 0), max(int(y - down), 0)
    x1, y1 = min(int(x + across) + 1, image.width), min(int(y + down) + 1, image.height)
    if x1 <= x0 or y1 <= y0:
        return
    u = (np.arange(x0, x1) + 0.5 - x) / across
    v = (np.arange(y0, y1) + 0.5 - y) / down
    share = np.clip(1.0 - (u[None, :] ** 2 + v[:, None] ** 2), 0.0, 1.0) ** 1.6
    mask = Image.fromarray(np.round(255.0 * strength * share).astype(np.uint8))
    image.paste(palette.SHADOW, (x0, y0, x1, y1), mask)


def nice_step(span: float, most: int) -> float:
    """Smallest of 1, 2, 5 times a power of ten that cuts ``span`` into at most ``most`` parts."""
    if not span > 0.0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(span / most))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if factor * power * most >= span * (1.0 - 1e-9):
            return float(factor * power)
    return float(10.0 * power)
