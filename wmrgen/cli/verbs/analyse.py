"""What a robot is and can: models, proofs, likely mistakes."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import Annotated, Literal

import typer

from wmrgen.cli.declare import (
    Base,
    Json,
    Package,
    Robot,
    Words,
    argument,
    group,
    option,
    output,
    robot_files,
    words,
)

verb = group("Analyse")


def _codes(incomplete: str) -> list[str]:
    from wmrgen.cli.lint import explained

    return [code for code in explained() if code.startswith(incomplete.upper())]


@verb("model", "Print a model of a robot: state, inputs, equations, singular sets.")
def model(
    robot: Robot,
    values: Annotated[Words, words("With --discrete: state and inputs at which A, B, c are printed.")] = None,
    form: Annotated[
        Literal["posture", "configuration", "twist", "eta", "zeta", "trailer", "chained"] | None,
        option(
            "Driven speeds, all joints, twist, null-space inputs, front wheel, trailers, chained; without it twist "
            "where two axles steer, castors are driven or wheels skid, else trailer or posture.",
        ),
    ] = None,
    discrete: Annotated[
        Literal["rk4", "exact", "collocation"] | None,
        option("A step of constant inputs with its derivatives A, B and c; exact is for a constant twist."),
    ] = None,
    dt: Annotated[
        str | None, option("Length of the step [s]; with -o it may be left out: dt is then an input.", "T")
    ] = None,
    out: Annotated[
        Path | None,
        output("FILE", "Write the step for casadi.Function.load."),
    ] = None,
    as_latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX.")] = False,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen model robots/bicycle.yaml --form posture

    Print a model x' = G(x) u of a robot: state, inputs, equations, vector fields, and where it is singular. With
    --discrete its step x, u, p -> xnext, A, B, c, xnext = A x + B u + c to first order.
    """


@verb("model", "Say what integrates, what Lie brackets reach, what is flat or chained.")
def structure(
    robot: Robot,
    form: Annotated[
        str | None,
        option(
            "Model whose Lie brackets are formed: configuration has the angles of wheels and castors.", "NAME"
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen structure robots/unicycle.yaml --form configuration

    Test every rolling constraint by Frobenius, proof printed, and all together; relations that they integrate to;
    Lie brackets with the growth vector, and the configurations at which it is another one; flat outputs; the chained
    form, or why there is none.
    """


@verb("model", "Say which functions a robot has.")
def functions(robot: Robot, as_json: Json = False) -> None:
    """Example:  wmrgen functions robots/pioneer3dx.yaml

    Say which functions a robot has, in a sentence each, and why it does not have the others. Those marked * are
    generated; a robot file asks for more under `functions`, and `wmrgen eval` computes every one.
    """


@verb("lint", "Say what is likely wrong with a robot.")
def lint(
    robots: Annotated[
        list[str],
        argument("ROBOT.yaml...", "Robot files, URDF, xacro, SDF; NAME:=VALUE for xacro.", robot_files),
    ],
    base: Base = None,
    package: Package = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen lint robots/pioneer3dx.yaml

    Say what is likely wrong with robots that can be derived, each finding with a code. Exit code 1 when there are
    any. The comment # wmrgen: ignore CODE on a line keeps it as it is.
    """


@verb("lint", "Explain a finding, with a wrong and a right example.")
def explain(
    code: Annotated[str | None, argument("[CODE]", "WMR012; none lists all.", _codes)] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen explain WMR012

    Say what a rule of `wmrgen lint` looks for and why, with a wrong and a right robot file.
    """


@verb("compare", "Say what descriptions of one robot say differently, and what that does.")
def compare(
    files: Annotated[
        list[str],
        argument(
            "FILE...",
            "Robot files, URDF, xacro, SDF, controllers' YAML, generated headers; NAME:=VALUE for xacro.",
        ),
    ],
    base: Base = None,
    package: Package = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen compare my_robot.urdf controllers.yaml

    Say what differs from the first file that has wheels to each other: track, wheelbase, radius, signs, rollers, order;
    and how that robot moves when the other's numbers command it. Lengths within 0.2 % and angles within 0.002 rad are
    equal. Exit code 1 when something differs.
    """


@verb("prove", "Prove ranges and rounding errors of the generated C.")
def prove(robot: Robot, as_json: Json = False) -> None:
    """Example:  wmrgen prove robots/pioneer3dx.yaml

    Prove, for all inputs within the limits of the robot file, that no function of the generated C divides by zero or
    gives NaN or infinity; the range of every output; and a bound of its rounding error. Frama-C Eva looks for alarms,
    too, where it is installed. Exit code 3 when something is not proved or limits are missing.
    """


@verb("design", "Say how far a robot is from tipping over.")
def stability(
    robot: Robot,
    values: Annotated[
        Words, words("Specific force a - g at the centre of gravity: fx fy fz; <wheel>.steer of castors.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen stability my_robot.yaml fx=0 fy=4

    Say how far a robot is from tipping over about each edge of its support polygon, and about which line it lifts
    off. The robot file gives the centre of gravity: cg: {x: 0, y: 0, z: 0.6}.
    """


@verb("design", "Judge gains of the polar feedback law.")
def gains(
    values: Annotated[
        Words,
        argument(
            "[ROBOT.yaml] [NAME=VALUE]...",
            "k_rho k_alpha k_beta [1/s]; what is not given is the robot file's or the text's.",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen gains k_rho=3 k_alpha=8 k_beta=-1.5

    Judge gains of the polar feedback law of goto_pose: stable near the goal, and from how far, with the conditions
    violated and the eigenvalues (Siegwart (3.60)-(3.65), corrected). Decided exactly.
    """


@verb("calibrate", "Estimate a robot's parameters from logs of drives.")
def calibrate(
    robot: Robot,
    logs: Annotated[
        list[Path] | None,
        argument("[LOG.csv]...", "Columns t [s] and <wheel>.angle, .counts or .spin, <wheel>.steer."),
    ] = None,
    truth: Annotated[
        list[Path] | None,
        option("Where the robot was: columns t, x, y, theta; once per log, else LOG.truth.csv.", "POSES.csv"),
    ] = None,
    out: Annotated[
        Path | None,
        output("ROBOT.yaml", "Write the robot file with the new values."),
    ] = None,
    files: Annotated[
        Path | None,
        option("Write the robot file, a picture, parameters for ROS and the numbers for the C.", "DIR"),
    ] = None,
    plan: Annotated[bool, typer.Option("--plan", help="Say which drives would tell the parameters.")] = False,
    precision: Annotated[float, option("What --plan aims at, relative to nominal.", "0.01")] = 0.01,
    one_clock: Annotated[
        bool, typer.Option("--one-clock", help="Log and truth have one clock: no offset is estimated.")
    ] = False,
    start_error: Annotated[
        float, option("What the first pose of each truth may be off by [m]: it then counts so.", "0.001")
    ] = inf,
    scheduler: Annotated[
        str | None, option("Add the drives up on the Dask cluster of this scheduler.", "ADDRESS")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen calibrate robot.yaml run-1.csv run-2.csv

    Estimate the parameters that are tunable, with standard deviations, from joint readings and from where the robot
    was; say which of them the drives do not tell, and what would.
    """
