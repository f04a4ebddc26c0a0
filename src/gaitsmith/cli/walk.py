"""``gaitsmith walk``."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from collections.abc import Generator

    from gaitsmith.motion.motion import Motion


def walk(
    output: Annotated[
        list[Path],
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            readable=False,
            help="File to write; the suffix says what. Repeatable.",
        ),
    ],
    distance: Annotated[
        float | None, typer.Option(help="How far to walk, straight ahead, meters.")
    ] = None,
    path: Annotated[
        str | None,
        typer.Option(metavar="POINTS", help='Curve through "x,z x,z ...", or through FILE.csv.'),
    ] = None,
    steps: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Footsteps: side,x,z,heading_deg[,y][,time] CSV."),
    ] = None,
    do: Annotated[
        str | None,
        typer.Option(metavar="SCRIPT", help='Actions: "walk to 0,3; turn left 90; stand 1".'),
    ] = None,
    body: Annotated[
        str, typer.Option(help="Height in meters, a name of `list bodies`, FILE.toml or FILE.bvh.")
    ] = "1.75",
    gait: Annotated[
        str, typer.Option(help="A name of `list gaits`, FILE.gait.json, or a clip to learn from.")
    ] = "neutral",
    step_length: Annotated[float | None, typer.Option(help="Meters.")] = None,
    speed: Annotated[float | None, typer.Option(help="Meters per second.")] = None,
    cadence: Annotated[float | None, typer.Option(help="Steps per minute.")] = None,
    start: Annotated[str, typer.Option(help="stand | walk: how the motion begins.")] = "stand",
    stop: Annotated[str, typer.Option(help="stand | walk: how the motion ends.")] = "stand",
    step_width: Annotated[
        float | None, typer.Option(help="Meters between left and right feet.")
    ] = None,
    toe_out: Annotated[
        float | None, typer.Option(help="Degrees that each foot turns out; else the gait's own.")
    ] = None,
    vary: Annotated[
        float, typer.Option(help="Natural variation from step to step: 0 none, 1 as people.")
    ] = 0.0,
    fps: Annotated[float, typer.Option(help="Frames per second.")] = 60.0,
    seed: Annotated[int, typer.Option(help="Seed of what is random; recorded.")] = 0,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Walk somewhere and write the motion."""
    import math  # imported late, like the library: --help must cost nothing

    from gaitsmith import pipeline

    with collected_warnings() as said:
        motion = pipeline.walk(
            distance=distance,
            path=path,
            steps=steps,
            do=do,
            body=body,
            gait=gait,
            step_length=step_length,
            cadence=cadence,
            speed=speed,
            start=start,
            stop=stop,
            step_width=step_width,
            toe_out=None if toe_out is None else math.radians(toe_out),
            variation=vary,
            fps=fps,
            seed=seed,
        )
        files = write(motion, output)
    report(motion, files, said, as_json=json)


def write(motion: Motion, paths: list[Path]) -> list[Path]:
    """Write all files or none; says so on a terminal where it takes long."""
    from gaitsmith import pipeline

    if sys.stderr.isatty():
        names = ", ".join(p.name for p in paths)
        print(f"writing {names} ...", file=sys.stderr)
    return pipeline.save_all(motion, paths)


def report(motion: Motion, files: list[Path], said: list[str], *, as_json: bool) -> None:
    """What was made, for a person or for a program."""
    facts = facts_of(motion, files, said)
    if as_json:
        import json

        print(json.dumps(facts))
        return
    for line in said:
        print(f"gaitsmith: warning: {line}", file=sys.stderr)
    print(
        f"{facts['steps']} steps over {facts['distance_m']:.2f} m in {facts['duration_s']:.2f} s: "
        f"{facts['step_length_m']:.3f} m at {facts['cadence_spm']:.1f} steps/min, "
        f"{facts['speed_mps']:.2f} m/s"
    )
    for path in files:
        print(f"wrote {path}")


def facts_of(motion: Motion, files: list[Path], said: list[str]) -> dict[str, Any]:
    """The object that ``--json`` prints; docs/reference/json.md explains every key."""
    from gaitsmith.ground import GROUNDS
    from gaitsmith.measures.promises import promises

    assert motion.labels is not None
    measured = promises(motion, GROUNDS["flat"]())
    return {
        "frames": len(motion),
        "fps": motion.fps,
        "duration_s": motion.duration,
        "steps": len(motion.labels.footstep_side) - 2,
        **measured,
        "files": [str(p) for p in files],
        "warnings": said,
    }


@contextmanager
def collected_warnings() -> Generator[list[str]]:
    """Collect the library's warnings as lines; others pass."""
    import warnings

    from gaitsmith.errors import GaitsmithWarning

    lines: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", GaitsmithWarning)
        yield lines
    for warning in caught:
        if issubclass(warning.category, GaitsmithWarning):
            lines.append(str(warning.message))
        else:
            warnings.warn_explicit(
                warning.message, warning.category, warning.filename, warning.lineno
            )
