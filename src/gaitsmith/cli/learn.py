"""``gaitsmith learn``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from gaitsmith.walks.learned import LearnedGait


def learn(
    clip: Annotated[
        list[Path],
        typer.Argument(
            help="*.bvh, *.amc or *.npz; markers in *.trc or *.csv. Several of one person at "
            "different step lengths: the usual one first."
        ),
    ],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE.gait.json", help="File to write.")
    ],
    name: Annotated[str | None, typer.Option(help="What to call the gait; else as CLIP.")] = None,
    symmetric: Annotated[
        bool, typer.Option("--symmetric", help="Make left and right mirror images.")
    ] = False,
    events: Annotated[
        Path | None,
        typer.Option(help="CSV: side,heel_strike,foot_flat,heel_off,toe_off in seconds."),
    ] = None,
    unit: Annotated[
        str | None, typer.Option(help="cm | m | mm | inch | cmu: unit of CLIP; else guessed.")
    ] = None,
    height: Annotated[
        float | None, typer.Option(help="Stature of who wears the markers, meters.")
    ] = None,
    license: Annotated[str, typer.Option(help="What may be done with CLIP; kept.")] = "",
    source: Annotated[
        str | None, typer.Option(help="Where CLIP comes from; kept. Else its name.")
    ] = None,
    lengths: Annotated[
        int, typer.Option(help="Strides of different length to learn of each CLIP, at most.")
    ] = 1,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Learn the gait of the person who walks in CLIP."""
    from gaitsmith import learning  # imported late: --help must cost nothing
    from gaitsmith.cli.reporting import collected_warnings
    from gaitsmith.errors import UnknownFormatError
    from gaitsmith.io import place
    from gaitsmith.walks.learned import SUFFIX, write_gait

    if not output.name.lower().endswith(".json"):
        raise UnknownFormatError("".join(output.suffixes[-2:]) or output.name, [SUFFIX])
    with collected_warnings() as said:
        gait = learning.learn(
            clip,
            name=name,
            symmetric=symmetric,
            events=None if events is None else learning.read_events(events),
            unit=unit,
            height=height,
            source=source,
            license=license,
            lengths=lengths,
        )
    place([(lambda path: write_gait(gait, path), output)])
    report(gait, output, said, as_json=json)


def report(gait: LearnedGait, output: Path, said: list[str], *, as_json: bool) -> None:
    """What was learned, for a person or for a program."""
    facts = facts_of(gait)
    if as_json:
        import json

        print(json.dumps({**facts, "files": [str(output)], "warnings": said}))
        return
    for line in said:
        print(f"gaitsmith: warning: {line}", file=sys.stderr)
    for line in gait.notes:
        print(f"gaitsmith: note: {line}", file=sys.stderr)
    print(
        f"{gait.name}: stride {facts['stride_length_m']:.3f} m in {facts['duration_s']:.3f} s, "
        f"{facts['speed_mps']:.2f} m/s at {facts['cadence_spm']:.1f} steps/min"
    )
    for other in gait.others:
        cycle = other.cycle
        print(
            f"and: stride {cycle.stride_length:.3f} m in {cycle.duration:.3f} s, "
            f"{cycle.speed:.2f} m/s"
        )
    print(f"wrote {output}")


def facts_of(gait: LearnedGait) -> dict[str, Any]:
    """The object that ``--json`` prints; docs/reference/json.md explains every key."""
    from gaitsmith.walks.learned import gait_to_dict

    data = gait_to_dict(gait)
    kept = (
        *("name", "source", "license", "stride_length_m", "duration_s", "speed_mps"),
        *("cadence_spm", "step_lengths_m", "step_width_m", "toe_out_deg", "events"),
        *("upper_body", "clip", "notes"),
    )
    facts = {key: data[key] for key in kept} | {"strides": data["cycle"]["strides"]}
    if gait.others:
        facts["other_stride_lengths_m"] = [other["stride_length_m"] for other in data["others"]]
    return facts
