"""Colours of the pictures: one warm figure, one cool and one warm side, quiet paper."""

from __future__ import annotations

Color = tuple[int, int, int]

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
PATH_LINE: Color = (140, 144, 150)
PELVIS_LINE: Color = (96, 74, 52)

WOOD: Color = (226, 190, 146)
WOOD_DARK: Color = (203, 161, 115)
JOINT: Color = (158, 116, 80)
#: Limbs, joint balls and shoes of [left, right].
SIDE_LIMBS: tuple[Color, Color] = (92, 150, 204), (232, 122, 84)
SIDE_JOINTS: tuple[Color, Color] = (60, 106, 152), (178, 82, 54)
SIDE_SHOES: tuple[Color, Color] = (46, 74, 108), (128, 56, 44)
OUTSOLE: Color = (244, 241, 234)


def mix(a: Color, b: Color, share: float) -> Color:
    """``a`` with ``share`` of ``b`` in it."""
    red, green, blue = (round(p + (q - p) * share) for p, q in zip(a, b, strict=True))
    return red, green, blue
