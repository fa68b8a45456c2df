"""Commands that make something of a robot file: models, code, reports."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from wmrgen.cli.declare import (
    Json,
    Math,
    Out,
    Robot,
    Robots,
    Scalar,
    Target,
    argument,
    group,
    option,
    output,
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


@verb("view", "Show robots in the browser, again whenever a file is saved.")
def view(
    robots: Robots,
    no_open: Annotated[bool, typer.Option("--no-open", help="Write the page, open no browser.")] = False,
    out: Annotated[
        Path | None,
        output("DIR", "Where the page stands, a temporary folder otherwise."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print where the page is, and end.")] = False,
) -> None:
    """Example:  wmrgen view robots/pioneer3dx.yaml robots/kuka_youbot.yaml

    Show reports in the browser, with the robots side by side on top, to drive. When a robot file is saved the page
    follows; a mistake in it stands on the page until it is mended. Ctrl-C ends it.
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


@verb("exporting", "Describe a robot for another tool: URDF, SDF, ros2_control, WPILib.")
def export(
    robot: Robot,
    to: Annotated[
        Literal["urdf", "sdf", "ros2_control", "wpilib"],
        typer.Option(help="What to write. ros2_control: a URDF and the controller's parameters."),
    ],
    out: Annotated[
        Path | None,
        output("DIR|FILE", "Where; otherwise it is printed."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen export robots/pioneer3dx.yaml --to ros2_control -o build

    Describe a robot for another tool. Masses and whatever else a robot file does not say are marked placeholders. A
    drive that ros2_controllers or WPILib does not have is refused in words (exit code 3).
    """


@verb("textbook", "Write the library of textbook formulas and the errata of the texts.")
def textbook(out: Out = Path("generated"), as_json: Json = False) -> None:
    """Example:  wmrgen textbook -o generated

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (corrections to
    our copies of the texts, each with the check that decides it). `wmrgen eval textbook FUNCTION` computes a formula.
    """
