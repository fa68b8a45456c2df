"""The commands and their options. Each command's work stands in its own module, imported when it runs."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, ParamSpec

import typer

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.cli.choices import Form, Math, Scalar, Target
from wmrgen.cli.outcome import outcome

P = ParamSpec("P")

app = typer.Typer(
    help="""Example:  wmrgen derive robots/pioneer3dx.yaml

    Compile a wheel layout into a verified kinematic model.
    """,
    epilog="Exit codes: 0 ok, 1 stale output, 2 bad robot file or usage, 3 not derivable, 4 environment.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def guarded(command: Callable[P, int]) -> Callable[P, None]:
    """A command that ends with an exit code and never with a stack trace."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        raise typer.Exit(outcome(lambda: command(*args, **kwargs)))

    return run


def _version(wanted: bool) -> None:
    if wanted:
        console.result(f"wmrgen {__version__}")
        raise typer.Exit


Robots = Annotated[
    list[Path], typer.Argument(metavar="ROBOT.yaml...", help="Robot files.", show_default=False)
]
Out = Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Where the robots' folders stand.")]
ChosenMath = Annotated[
    Math | None,
    typer.Option(help="Sines and arctangents of the C: own float kernels (default), or libm's (for double)."),
]
ChosenTarget = Annotated[
    Target, typer.Option(help="Processor of the C: m4f has fused multiply-add, host is any with an FPU.")
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command(short_help="Derive robots and write their model, report and code.")
@guarded
def derive(
    robots: Robots,
    out: Out = Path("generated"),
    json: Annotated[
        bool, typer.Option("--json", help="Print model.json; a list when there are several.")
    ] = False,
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of the generated C.")] = Scalar.float,
    math: ChosenMath = None,
    target: ChosenTarget = Target.m4f,
    fuzz: Annotated[bool, typer.Option("--fuzz", help="Write a libFuzzer harness of the C too.")] = False,
) -> int:
    """Example:  wmrgen derive robots/pioneer3dx.yaml -o build

    Derive robots and write DIR/<name>/: model, report, C, CasADi, NumPy.
    """
    from wmrgen.cli.derive import run
    from wmrgen.ir.kernels.choice import choice

    chosen = choice(scalar.value, math and math.value, target.value)
    return run(robots, out, as_json=json, choice=chosen, fuzz=fuzz)


@app.command("eval", short_help="Compute a function of a robot's model.")
@guarded
def evaluate(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    function: Annotated[
        str,
        typer.Argument(
            metavar="FUNCTION",
            help="inverse, forward, motion, goto_pose and others; an unknown word lists them.",
            show_default=False,
        ),
    ],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE]...",
            help="Inputs in SI units: 0.5, 1/3, pi/2, '45 deg/s'.",
            show_default=False,
        ),
    ] = None,
    backend: Annotated[
        str,
        typer.Option(
            metavar="WORD", help="What computes: exact, c (with a C compiler); an unknown word lists all."
        ),
    ] = "exact",
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of backend c.")] = Scalar.float,
    math: ChosenMath = None,
    target: ChosenTarget = Target.m4f,
    cases: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.json", help="A list of {name: value}; prints the list of results. - is stdin."
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen eval robots/pioneer3dx.yaml inverse vx=0.5 omega="30 deg/s"

    Compute a function of a robot's model. Inputs that are not given are 0, parameters nominal. With the word
    textbook for the robot: a formula of the texts that needs none, as `wmrgen eval textbook pursuit distance=3`.
    """
    from wmrgen.cli.evaluate import run
    from wmrgen.ir.kernels.choice import choice

    return run(
        robot,
        function,
        values or [],
        backend=backend,
        choice=choice(scalar.value, math and math.value, target.value),
        cases=cases,
        as_json=json,
    )


@app.command(short_help="Say which generated files are out of date.")
@guarded
def check(
    robots: Annotated[
        list[Path] | None,
        typer.Argument(metavar="ROBOT.yaml...", help="Default: robots/*.yaml.", show_default=False),
    ] = None,
    out: Out = Path("generated"),
) -> int:
    """Example:  wmrgen check

    Say which generated files are not what the robot files give today. Exit code 1 when there are any.
    """
    from wmrgen.cli.check import run

    return run(robots or [], out)


@app.command(short_help="Print the JSON Schema of robot files.")
@guarded
def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="Print the keys as a page to read.")] = False,
    json: Json = False,
) -> int:
    """Example:  wmrgen schema > robot.schema.json

    Print the JSON Schema of robot files, for editors and validators; with --markdown their reference.
    """
    from wmrgen.cli.schema import run
    from wmrgen.errors import UsageError

    if markdown and json:
        raise UsageError("give --json or --markdown, not both")
    return run(markdown=markdown)


@app.command(short_help="Size the rollers of a mecanum wheel.")
@guarded
def rollers(
    radius: Annotated[str, typer.Option(help="Radius of the wheel: 150mm, 0.15.", show_default=False)],
    count: Annotated[str, typer.Option(help="Number of rollers, at least 3.", show_default=False)],
    angle: Annotated[
        str, typer.Option(help="Hub axis to roller axis: 45deg; 90deg is an omni wheel.", show_default=False)
    ],
    json: Json = False,
) -> int:
    """Example:  wmrgen rollers --radius 150mm --count 8 --angle 45deg

    Size the rollers of a mecanum wheel: length of a roller, width of the wheel (Tzafestas (2.86)-(2.91)).
    """
    from wmrgen.cli.rollers import run

    return run(radius, count, angle, as_json=json)


@app.command(short_help="Write the library of textbook formulas and the errata of the texts.")
@guarded
def textbook(out: Out = Path("generated")) -> int:
    """Example:  wmrgen textbook -o generated

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (misprints of
    the texts, each with the check that decides it). `wmrgen eval textbook FUNCTION` computes one of the formulas.
    """
    from wmrgen.cli.textbook import installed

    return installed().run(out)


@app.command(short_help="Say where constant wheel speeds take a robot.")
@guarded
def motion(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE]...",
            help="Speeds of wheels (left=4 or left.spin=4), steering angles, start pose x y theta.",
            show_default=False,
        ),
    ] = None,
    time: Annotated[str | None, typer.Option(metavar="T", help="How long [s].", show_default=False)] = None,
    segments: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.json",
            help="A list of {vx vy omega | x_rate y_rate theta_rate | x y theta: value, dt: value}; - is stdin.",
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen motion robots/pioneer3dx.yaml left=4 right=2 --time 2.3

    Say where constant wheel speeds take a robot: the pose at the end, and the straight line or circle driven. With
    --segments: the wheel commands of each segment, waits for steering included.
    """
    from wmrgen.cli.motion import run

    return run(robot, values or [], time=time, segments=segments, as_json=json)


@app.command(short_help="Find the centre of rotation of a twist or of steering angles.")
@guarded
def icr(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE]...",
            help="vx vy omega (and a point: point.x point.y), or <wheel>.steer, or icr.x icr.y.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen icr robots/ackermann_car.yaml front_left.steer=0.3 front_right.steer=0.25

    Find the centre of rotation (ICR) of a twist; or of the axles at given steering angles, with the wheels that do
    not point at it; or the steering angles that turn the robot about icr.x, icr.y.
    """
    from wmrgen.cli.icr import run

    return run(robot, values or [], as_json=json)


@app.command(short_help="Print a model of a robot: state, inputs, equations, singular sets.")
@guarded
def model(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    form: Annotated[
        Form,
        typer.Option(help="Driven speeds, all joints, null-space inputs, front wheel, trailers, chained."),
    ] = Form.posture,
    latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX.")] = False,
    json: Json = False,
) -> int:
    """Example:  wmrgen model robots/bicycle.yaml --form posture

    Print a model x' = G(x) u of a robot: state, inputs, equations, vector fields, and where it is singular.
    """
    from wmrgen.cli.model import run

    return run(robot, form.value, as_json=json, as_latex=latex)


@app.command(short_help="Say what integrates, what Lie brackets reach, what is flat or chained.")
@guarded
def structure(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    json: Json = False,
) -> int:
    """Example:  wmrgen structure robots/bicycle.yaml

    Test every rolling constraint by Frobenius, proof printed, and all together; relations that they integrate to;
    Lie brackets with the growth vector; flat outputs; the chained form, or why there is none.
    """
    from wmrgen.cli.structure import run

    return run(robot, as_json=json)


@app.command(short_help="Judge gains of the polar feedback law.")
@guarded
def gains(
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[ROBOT.yaml] [NAME=VALUE]...",
            help="k_rho k_alpha k_beta [1/s]; what is not given is the robot file's or the text's.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen gains k_rho=3 k_alpha=8 k_beta=-1.5

    Judge gains of the polar feedback law of goto_pose: stable near the goal, and from how far, with the conditions
    violated and the eigenvalues (Siegwart (3.60)-(3.65), corrected). Decided exactly.
    """
    from wmrgen.cli.gains import run

    return run(values or [], as_json=json)


@app.command(short_help="Say how far a robot is from tipping over.")
@guarded
def stability(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME=VALUE]...",
            help="Specific force a - g at the centre of gravity: fx fy fz; <wheel>.steer of castors.",
            show_default=False,
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen stability my_robot.yaml fx=0 fy=4

    Say how far a robot is from tipping over about each edge of its support polygon, and about which line it lifts
    off. The robot file gives the centre of gravity: cg: {x: 0, y: 0, z: 0.6}.
    """
    from wmrgen.cli.stability import run

    return run(robot, values or [], as_json=json)


@app.command(short_help="Prove ranges and rounding errors of the generated C.")
@guarded
def prove(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    json: Json = False,
) -> int:
    """Example:  wmrgen prove robots/pioneer3dx.yaml

    Prove, for all inputs within the limits of the robot file, that no function of the generated C divides by zero or
    gives NaN or infinity; the range of every output; and a bound of its rounding error. Frama-C Eva looks for alarms,
    too, where it is installed. Exit code 3 when something is not proved or limits are missing.
    """
    from wmrgen.cli.prove import run

    return run(robot, as_json=json)
