"""``gaitsmith convert``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer


def convert(
    source: Annotated[Path, typer.Argument(metavar="IN", help="*.bvh, *.amc, *.glb or *.npz.")],
    target: Annotated[Path, typer.Argument(metavar="OUT", help="A suffix of `list formats`.")],
    fps: Annotated[float | None, typer.Option(help="Frames per second; else as in IN.")] = None,
    unit: Annotated[
        str | None,
        typer.Option(help="cm | m | mm | inch | cmu: unit of IN's lengths; else guessed."),
    ] = None,
) -> None:
    """Turn a file of motion into another format, another frame rate or a cleaner dialect."""
    from gaitsmith.cli.reporting import collected_warnings
    from gaitsmith.io.convert import convert as convert_file
    from gaitsmith.pipeline import WRITERS

    with collected_warnings() as said:
        written = convert_file(source, target, fps=fps, unit=unit, writers=WRITERS)
    for line in said:
        print(f"gaitsmith: warning: {line}", file=sys.stderr)
    print(f"wrote {written}")
