"""Colours of the pictures: quiet paper, lines that tell the sides apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gaitsmith.skin.palette import Color

PAPER: Color = (250, 249, 246)
PANEL: Color = (255, 255, 254)
FLOOR: Color = (236, 233, 226)
GRID: Color = (224, 221, 213)
GRID_DARK: Color = (204, 200, 190)
FRAME: Color = (206, 203, 195)
INK: Color = (44, 47, 52)
MUTED: Color = (122, 124, 128)
SHADOW: Color = (70, 66, 74)

#: Lines, curves and footprints of [left, right]; they tell the sides apart in grey as well.
SIDE_LINES: tuple[Color, Color] = (38, 106, 168), (214, 92, 52)
#: People of a scene, told apart in the order of the scene; then again from the first.
PEOPLE: tuple[Color, ...] = (
    (38, 106, 168),
    (200, 84, 40),
    (52, 130, 78),
    (128, 74, 152),
    (168, 126, 22),
    (30, 134, 144),
    (176, 58, 106),
)
#: What stands around: filling, that of its sides, and edge.
SOLID: Color = (214, 207, 194)
SOLID_SIDE: Color = (190, 181, 165)
SOLID_EDGE: Color = (158, 148, 130)
PATH_LINE: Color = (140, 144, 150)
PELVIS_LINE: Color = (96, 74, 52)


def mix(a: Color, b: Color, share: float) -> Color:
    """``a`` with ``share`` of ``b`` in it."""
    red, green, blue = (round(p + (q - p) * share) for p, q in zip(a, b, strict=True))
    return red, green, blue
