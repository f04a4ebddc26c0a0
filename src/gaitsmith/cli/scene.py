"""``gaitsmith walk --scene``: several people, as the walk command says them."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    import typer

    from gaitsmith.motion.performance import Performance

#: Options that go with a scene; all others are said in its file.
WITH_SCENE = ("output", "scene", "fps", "seed", "json")
#: Keys of a scene's file that are not called as the option is.
KEYS = {"vary": "variation", "start": "start, a table"}


def refuse_others(context: typer.Context) -> None:
    """Refuse options that a scene's file says for each walker by itself."""
    from gaitsmith.errors import InvalidInputError

    given: list[str] = []
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if name not in WITH_SCENE and source is not None and source.name == "COMMANDLINE":
            given.append(name)
    if given:
        options = " and ".join(f"--{name.replace('_', '-')}" for name in given)
        keys = ", ".join(KEYS.get(name, name) for name in given)
        raise InvalidInputError(
            f"{options} cannot go with --scene, whose file says it for each walker: write it "
            f"there ({keys})"
        )


def walk_scene(path: Path, output: list[Path], *, fps: float, seed: int, as_json: bool) -> None:
    """Everybody of a scene walks; files and report as the walk command has them."""
    from gaitsmith import pipeline
    from gaitsmith.cli.reporting import collected_warnings
    from gaitsmith.scene.perform import perform

    with collected_warnings() as said:
        performance = perform(path, fps=fps, seed=seed)
        if sys.stderr.isatty():
            print(f"writing {', '.join(p.name for p in output)} ...", file=sys.stderr)
        files = pipeline.save_all(performance, output)
    facts = facts_of(performance, files, said)
    if as_json:
        import json

        print(json.dumps(facts))
        return
    for line in said:
        print(f"gaitsmith: warning: {line}", file=sys.stderr)
    wide = max(map(len, performance.names))
    for walker in facts["walkers"]:
        print(
            f"{walker['name']:<{wide}}  {walker['steps']} steps over {walker['distance_m']:.2f} m"
        )
    people = "1 walker" if len(performance) == 1 else f"{len(performance)} walkers"
    print(f"{people}, {facts['duration_s']:.2f} s")
    for file in files:
        print(f"wrote {file}")


def facts_of(performance: Performance, files: list[Path], said: list[str]) -> dict[str, Any]:
    """The object that ``--json`` prints of a scene; docs/reference/json.md explains every key.

    Of one walker it has the keys of a walk besides.
    """
    from gaitsmith.cli.reporting import motion_facts

    first = performance.motions[0]
    walkers = [{"name": name, **motion_facts(motion)} for name, motion in performance]
    alone = {key: walkers[0][key] for key in walkers[0] if key != "name"}
    return {
        **(alone if len(walkers) == 1 else {}),
        "frames": len(first),
        "fps": first.fps,
        "duration_s": first.duration,
        "walkers": walkers,
        "files": [str(file) for file in files],
        "warnings": said,
    }
