"""``gaitsmith compose``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def compose(
    recipe: Annotated[Path, typer.Argument(metavar="RECIPE.toml", help="Walks and weights.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE.gait.json", help="File to write.")
    ],
    name: Annotated[
        str | None, typer.Option(help="What to call the gait; else as the recipe says.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Mix walks into a new one: gaits, clips and weights as RECIPE says."""
    from gaitsmith import composing  # imported late: --help must cost nothing
    from gaitsmith.cli.learn import facts_of, report
    from gaitsmith.cli.reporting import collected_warnings
    from gaitsmith.errors import UnknownFormatError
    from gaitsmith.io import place
    from gaitsmith.walks.learned import SUFFIX, write_gait

    if not output.name.lower().endswith(".json"):
        raise UnknownFormatError("".join(output.suffixes[-2:]) or output.name, [SUFFIX])
    with collected_warnings() as said:
        gait = composing.compose(recipe, name=name)
    place([(lambda path: write_gait(gait, path), output)])
    if json:
        import json as text

        facts = {**facts_of(gait), "recipe": gait.recipe}
        print(text.dumps({**facts, "files": [str(output)], "warnings": said}))
        return
    report(gait, output, said, as_json=False)
