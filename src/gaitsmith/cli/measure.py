"""``gaitsmith measure``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Any

import typer

#: First figure of each part of the table, and the part's heading.
HEADINGS = {
    "frames": "File",
    "floor_m": "Floor and contact",
    "gmd_skating_ratio": "Skating as others count it",
    "knee_min_deg": "Legs",
    "joint_deg_per_60th_max": "Jumps",
    "steps": "Gait",
    "bob_mm": "Body",
    "distance_m": "Course",
}
#: Not in the table: said on stderr, or its first line.
_APART = ("file", "notes", "warnings")
_COLUMN = 18


def measure(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="*.bvh, *.amc, *.glb or *.npz, any rig.")
    ],
    unit: Annotated[
        str | None,
        typer.Option(help="cm | m | mm | inch | cmu: unit of FILE's lengths; else guessed."),
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Honest numbers of motions: contact, skating, smoothness, gait."""
    from gaitsmith import measuring  # imported late: --help must cost nothing
    from gaitsmith.cli.reporting import collected_warnings

    found = list[dict[str, Any]]()
    for path in files:
        for name, clip in measuring.people_in(path):
            with collected_warnings() as said:
                figures = measuring.measure(clip, unit=unit)
            found.append({"file": name, **figures, "warnings": said})
    if json:
        import json as encoder

        print(encoder.dumps(found[0] if len(found) == 1 else {"files": found}, allow_nan=False))
        return
    for figures in found:
        for kind in ("warning", "note"):
            for line in figures[f"{kind}s"]:
                print(f"gaitsmith: {kind}: {Path(figures['file']).name}: {line}", file=sys.stderr)
    print("\n".join(table(found)))


def table(found: list[dict[str, Any]]) -> list[str]:
    """Lines of a table: a row a figure, a column a file. Units are in the names."""
    names = [name for name in found[0] if name not in _APART]
    wide = max(map(len, names))
    titles = [_short(Path(figures["file"]).name) for figures in found]
    lines = [" " * wide + "".join(f"  {title:>{_COLUMN}}" for title in titles)]
    for name in names:
        if name in HEADINGS:
            lines += ["", HEADINGS[name]]
        cells = (_cell(figures[name]) for figures in found)
        lines.append(f"{name:<{wide}}" + "".join(f"  {_short(c):>{_COLUMN}}" for c in cells))
    return [line.rstrip() for line in lines]


def _short(text: str) -> str:
    """The end of ``text``, which tells files of one set apart."""
    return text if len(text) <= _COLUMN else "~" + text[1 - _COLUMN :]


def _cell(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, list):
        return f"{len(value)}: {', '.join(map(str, value))}" if value else "none"
    if isinstance(value, float):
        # what is below the digits of any file is nothing
        return "0" if abs(value) < 1e-9 else f"{value:.4g}"
    return str(value)
