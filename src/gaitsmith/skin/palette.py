"""Colours of the figure: wood, a cool left side, a warm right side. sRGB, 0 to 255."""

from __future__ import annotations

Color = tuple[int, int, int]

WOOD: Color = (226, 190, 146)
WOOD_DARK: Color = (203, 161, 115)
#: Limbs, joint balls and shoes of [left, right].
SIDE_LIMBS: tuple[Color, Color] = (92, 150, 204), (232, 122, 84)
SIDE_JOINTS: tuple[Color, Color] = (60, 106, 152), (178, 82, 54)
SIDE_SHOES: tuple[Color, Color] = (46, 74, 108), (128, 56, 44)
OUTSOLE: Color = (244, 241, 234)
