"""``gaitsmith walk``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gaitsmith.cli.reporting import collected_warnings, facts_of

if TYPE_CHECKING:
    from gaitsmith.motion.motion import Motion


def walk(
    context: typer.Context,
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
    scene: Annotated[
        Path | None,
        typer.Option(metavar="FILE", readable=False, help="Several walkers: a TOML file."),
    ] = None,
    ground: Annotated[
        str,
        typer.Option(
            metavar="GROUND",
            help="flat, slope:DEG, stairs:RISE,TREAD,COUNT, or FILE.npz|.png|.obj.",
        ),
    ] = "flat",
    body: Annotated[
        str, typer.Option(help="Height in meters, a name of `list bodies`, FILE.toml or FILE.bvh.")
    ] = "1.75",
    gait: Annotated[
        str, typer.Option(help="A name of `list gaits`, FILE.gait.json, or a clip to learn from.")
    ] = "neutral",
    walker: Annotated[
        str, typer.Option(help="kinematic | elevation: how the legs are generalized.")
    ] = "kinematic",
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
    if scene is not None:
        from gaitsmith.cli.scene import refuse_others, walk_scene

        refuse_others(context)
        walk_scene(scene, output, fps=fps, seed=seed, as_json=json)
        return
    import math  # imported late, like the library: --help must cost nothing

    from gaitsmith import pipeline

    with collected_warnings() as said:
        motion = pipeline.walk(
            distance=distance,
            path=path,
            steps=steps,
            do=do,
            ground=ground,
            body=body,
            gait=gait,
            walker=walker,
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
    line = f"{facts['steps']} steps over {facts['distance_m']:.2f} m in {facts['duration_s']:.2f} s"
    if facts["step_length_m"] is not None:
        line += (
            f": {facts['step_length_m']:.3f} m at {facts['cadence_spm']:.1f} steps/min, "
            f"{facts['speed_mps']:.2f} m/s"
        )
    print(line)
    for path in files:
        print(f"wrote {path}")
