"""The command line: its commands, which the modules here declare by groups of the help, and what holds for all."""

from __future__ import annotations

from typing import Annotated

import typer

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.cli.declare import app
from wmrgen.cli.verbs import analyse, compute, generate, inputs

__all__ = ["analyse", "app", "compute", "generate", "inputs"]


def _version(wanted: bool) -> None:
    if wanted:
        console.result(f"wmrgen {__version__}")
        raise typer.Exit


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass
