"""``gaitsmith demo``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

#: What the demo writes.
FILES = ("walk.glb", "walk.bvh", "walk.npz", "walk.png", "walk.gif")
DISTANCE = 5.0


def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder to write into.")] = Path(
        "demo"
    ),
) -> None:
    """Walk 5 m on built-in data and write walk.glb, walk.bvh, walk.npz, walk.png, walk.gif."""
    from gaitsmith import pipeline
    from gaitsmith.cli.walk import report, write

    if output.exists() and not output.is_dir():
        raise NotADirectoryError(f"cannot write into {output}: it is a file; -o takes a folder")
    motion = pipeline.walk(distance=DISTANCE)
    output.mkdir(parents=True, exist_ok=True)
    report(motion, write(motion, [output / name for name in FILES]), [], as_json=False)
