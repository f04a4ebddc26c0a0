"""Make the pictures of walks on slopes and stairs: docs/pictures/ground-*."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import gaitsmith
from gaitsmith.ground import HeightField

TARGET = Path(__file__).parent.parent / "docs/pictures"
#: Rows of a contact sheet (shares of its height) that show the figures and their legs' way.
FIGURES, WAY = (0.055, 0.274), (0.665, 0.845)


def box_and_bar() -> HeightField:
    """A bar of 12 cm to step over and a box of 15 cm to step on."""
    height = np.zeros((401, 101))
    height[100:103] = 0.12
    height[200:280] = 0.15
    return HeightField(height, 0.02, (-1.0, -0.5))


def picture(name: str, **asked: object) -> None:
    """The figures of one stride, and the legs along the whole way."""
    motion = gaitsmith.walk(fps=60, **asked)  # type: ignore[arg-type]
    with tempfile.TemporaryDirectory() as folder:
        sheet = Image.open(gaitsmith.save(motion, Path(folder) / "sheet.png")).convert("RGB")
    rows = [
        sheet.crop((0, int(a * sheet.height), sheet.width, int(b * sheet.height)))
        for a, b in (FIGURES, WAY)
    ]
    out = Image.new("RGB", (sheet.width, sum(r.height for r in rows)), "white")
    top = 0
    for row in rows:
        out.paste(row, (0, top))
        top += row.height
    out = out.resize((out.width * 5 // 8, out.height * 5 // 8), Image.Resampling.LANCZOS)
    out.quantize(96).save(TARGET / f"ground-{name}.png", optimize=True)


def main() -> None:
    """Make them all."""
    picture("stairs-up", distance=5.4, ground="stairs:0.17,0.29,10")
    picture("stairs-down", distance=5.4, ground="stairs:-0.17,0.29,10")
    picture("uphill", distance=6.0, ground="slope:12")
    picture("downhill", distance=6.0, ground="slope:-12")
    picture("obstacles", distance=6.4, ground=box_and_bar())


if __name__ == "__main__":
    main()
