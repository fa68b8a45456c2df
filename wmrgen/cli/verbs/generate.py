"""Commands that make something of a robot file: models, code, reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from wmrgen.cli.declare import (
    Json,
    Math,
    Out,
    Robots,
    Scalar,
    Target,
    argument,
    group,
    option,
    robot_files,
)

verb = group("Generate")

Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs", metavar="N", min=1, help="Processes that derive several robots. Default: one a processor."
    ),
]


def _kinds(incomplete: str) -> list[str]:
    from wmrgen.codegen.packages import PACKAGES

    return [kind for kind in PACKAGES if kind.startswith(incomplete)]


@verb("generate", "Derive robots and write their model, report and code.")
def derive(
    robots: Robots,
    out: Out = Path("generated"),
    as_json: Annotated[
        bool, typer.Option("--json", help='Print model.json; of several: {"robots": […]}.')
    ] = False,
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of the generated C.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    fuzz: Annotated[bool, typer.Option("--fuzz", help="Write a libFuzzer harness of the C too.")] = False,
    batch: Annotated[
        bool, typer.Option("--batch", help="Write the C functions over arrays of states too.")
    ] = False,
    package: Annotated[
        list[str] | None,
        option(
            "Write DIR/package-KIND/<name>/ too: cmake, arduino, platformio, esp-idf, zephyr, ros2, rust, javascript.",
            "KIND",
            _kinds,
        ),
    ] = None,
    html: Annotated[
        bool, typer.Option("--html", help="Write report.html too: one file, and the robot to drive.")
    ] = False,
    pdf: Annotated[
        bool,
        typer.Option("--pdf", help="Write report.pdf too, by an installed Chromium, or pandoc and a TeX."),
    ] = False,
    jobs: Jobs = None,
) -> None:
    """Example:  wmrgen derive robots/pioneer3dx.yaml -o build

    Derive robots and write DIR/<name>/: model, report, C, CasADi, NumPy. A robot whose files are up to date is not
    derived again, unless there were notes or warnings about it.
    """


@verb("generate", "Say which generated files are out of date.")
def check(
    robots: Annotated[
        list[Path] | None, argument("ROBOT.yaml...", "Default: robots/*.yaml.", robot_files)
    ] = None,
    out: Out = Path("generated"),
    full: Annotated[
        bool,
        typer.Option("--full", help="Derive every robot, even if its manifest says that nothing changed."),
    ] = False,
    jobs: Jobs = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen check

    Report which generated files are not what the robot files give today. Exit code 1 if there are any.
    """


@verb("gallery", "Write pages of all robots that are derived, with top views.", "gallery")
def write_gallery(out: Out = Path("generated"), as_json: Json = False) -> None:
    """Example:  wmrgen gallery -o generated

    Write DIR/README.md and DIR/index.html: the robots that stand in DIR with top view, type, degrees and operations.
    `wmrgen check` looks after these pages where they are.
    """
