"""The commands, and what their exit codes mean."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from gaitsmith._version import __version__
from gaitsmith.cli.compose import compose
from gaitsmith.cli.convert import convert
from gaitsmith.cli.demo import demo
from gaitsmith.cli.learn import learn
from gaitsmith.cli.listing import listing
from gaitsmith.cli.measure import measure
from gaitsmith.cli.walk import walk
from gaitsmith.errors import GaitsmithError, InvalidInputError

app = typer.Typer(
    name="gaitsmith",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.command()(demo)
app.command()(walk)
app.command()(learn)
app.command()(compose)
app.command()(measure)
app.command()(convert)
app.command("list")(listing)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"gaitsmith {__version__}")
        raise typer.Exit


@app.callback()
def gaitsmith(
    _: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Give it a body, a place to go and a way of walking; get a person who walks it."""


def main() -> None:
    """Run the command line: exit 0 done, 1 the task failed, 2 wrong usage."""
    try:
        app()
    except InvalidInputError as error:
        code, text = 2, str(error)
    except GaitsmithError as error:
        code, text = 1, str(error)
    except OSError as error:
        code, text = 1, str(error)
        if error.strerror and error.filename is not None:
            text = f"{error.filename}: {error.strerror.lower()}; choose another file or folder"
    else:
        return
    print("gaitsmith: " + " ".join(text.split()), file=sys.stderr)
    raise SystemExit(code)
