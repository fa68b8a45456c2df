"""The commands and their options. Each command's work stands in another module, imported when it runs."""

from __future__ import annotations

import functools
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from wmrgen import __version__
from wmrgen.cli import console

Declared = Callable[..., None]
app = typer.Typer(
    help="""Example:  wmrgen derive robots/pioneer3dx.yaml

    Compile a wheel layout into a verified kinematic model.
    """,
    epilog="Exit codes: 0 ok, 1 stale output or findings, 2 bad robot file or usage, 3 not derivable, 4 environment.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def verb(module: str, short_help: str, name: str | None = None) -> Callable[[Declared], Declared]:
    """A command ``name``, else called as the function that it decorates, which declares options and help. The function
    of the same name and parameters in ``wmrgen.cli.<module>``, which is imported when the command runs, does the work
    and returns an exit code; no failure shows a stack trace."""

    def register(declared: Declared) -> Declared:
        @functools.wraps(declared)
        def run(**options: Any) -> None:
            def work() -> int:
                return int(getattr(import_module(f"wmrgen.cli.{module}"), declared.__name__)(**options))

            raise typer.Exit(console.outcome(work))

        app.command(name, short_help=short_help)(run)
        return declared

    return register


def _version(wanted: bool) -> None:
    if wanted:
        console.result(f"wmrgen {__version__}")
        raise typer.Exit


# ---- arguments and options that several commands have


def argument(metavar: str, text: str | None = None) -> Any:
    """A positional argument; help shows no default."""
    return typer.Argument(metavar=metavar, help=text, show_default=False)


def words(text: str) -> Any:
    """An argument of NAME=VALUE words, which ``text`` names."""
    return argument("[NAME=VALUE]...", text)


def option(text: str, metavar: str | None = None) -> Any:
    """An option with a value; help shows no default."""
    return typer.Option(metavar=metavar, help=text, show_default=False)


Words = list[str] | None
Robot = Annotated[Path, argument("ROBOT.yaml")]
Out = Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Where the robots' folders stand.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON.")]
Scalar = Literal["float", "double"]
Math = Annotated[
    Literal["inline", "libm"] | None,
    typer.Option(help="Sines and arctangents of the C: own float kernels (default), or libm's (for double)."),
]
Target = Annotated[
    Literal["m4f", "m0", "avr", "host"],
    typer.Option(help="Processor of the C: m4f has fused multiply-add, host is any with an FPU."),
]


@app.callback()
def _main(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


# ---- the commands, in the order of the help


@verb("generate", "Derive robots and write their model, report and code.")
def derive(
    robots: Annotated[list[Path], argument("ROBOT.yaml...", "Robot files.")],
    out: Out = Path("generated"),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print model.json; a list when there are several.")
    ] = False,
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of the generated C.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    fuzz: Annotated[bool, typer.Option("--fuzz", help="Write a libFuzzer harness of the C too.")] = False,
    package: Annotated[
        list[str] | None,
        option(
            "Write DIR/package-KIND/<name>/ too: cmake, arduino, platformio, esp-idf, zephyr, ros2, rust.",
            "KIND",
        ),
    ] = None,
) -> None:
    """Example:  wmrgen derive robots/pioneer3dx.yaml -o build

    Derive robots and write DIR/<name>/: model, report, C, CasADi, NumPy.
    """


@verb("importing", "Make a robot file of a URDF or xacro.", "import")
def import_robot(
    file: Annotated[Path, argument("FILE", "A robot description: URDF or xacro.")],
    arguments: Annotated[Words, argument("[NAME:=VALUE]...", "Arguments of a xacro file.")] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", metavar="ROBOT.yaml", help="Write the robot file; otherwise it is printed."
        ),
    ] = None,
    base: Annotated[str | None, option("The link that is the robot's frame.", "LINK")] = None,
    package: Annotated[
        list[str] | None, option("The folder of a package that the file finds.", "NAME=DIR")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen import my_robot.urdf -o my_robot.yaml

    Make a robot file of a robot description. Wheels are told by geometry; what the file does not say stands as TODO
    with its question, and derive refuses the file until it is answered.
    """


@verb("evaluate", "Compute a function of a robot's model.", "eval")
def evaluate(
    robot: Robot,
    function: Annotated[
        str,
        argument("FUNCTION", "inverse, forward, motion, goto_pose and others; an unknown word lists them."),
    ],
    values: Annotated[Words, words("Inputs in SI units: 0.5, 1/3, pi/2, '45 deg/s'.")] = None,
    backend: Annotated[
        str,
        typer.Option(
            metavar="WORD", help="What computes: exact, c (with a C compiler); an unknown word lists all."
        ),
    ] = "exact",
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of backend c.")] = "float",
    math: Math = None,
    target: Target = "m4f",
    cases: Annotated[
        str | None,
        option("A list of {name: value}; prints the list of results. - is stdin.", "FILE.json"),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen eval robots/pioneer3dx.yaml inverse vx=0.5 omega="30 deg/s"

    Compute a function of a robot's model. Inputs that are not given are 0, parameters nominal. With the word
    textbook for the robot: a formula of the texts that needs none, as `wmrgen eval textbook pursuit distance=3`.
    """


@verb("generate", "Say which generated files are out of date.")
def check(
    robots: Annotated[list[Path] | None, argument("ROBOT.yaml...", "Default: robots/*.yaml.")] = None,
    out: Out = Path("generated"),
) -> None:
    """Example:  wmrgen check

    Say which generated files are not what the robot files give today. Exit code 1 when there are any.
    """


@verb("lint", "Say what is likely wrong with a robot.")
def lint(
    robots: Annotated[list[Path], argument("ROBOT.yaml...", "Robot files.")], as_json: Json = False
) -> None:
    """Example:  wmrgen lint robots/pioneer3dx.yaml

    Say what is likely wrong with robots that can be derived, each finding with a code. Exit code 1 when there are
    any. The comment # wmrgen: ignore CODE on a line keeps it as it is.
    """


@verb("lint", "Explain a finding, with a wrong and a right example.")
def explain(
    code: Annotated[str | None, argument("[CODE]", "WMR012; none lists all.")] = None, as_json: Json = False
) -> None:
    """Example:  wmrgen explain WMR012

    Say what a rule of `wmrgen lint` looks for and why, with a wrong and a right robot file.
    """


@verb("model", "Print the JSON Schema of robot files.")
def schema(
    as_markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the keys as a page to read.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen schema > robot.schema.json

    Print the JSON Schema of robot files, for editors and validators; with --markdown their reference.
    """


@verb("design", "Size the rollers of a mecanum wheel.")
def rollers(
    radius: Annotated[str, option("Radius of the wheel: 150mm, 0.15.")],
    count: Annotated[str, option("Number of rollers, at least 3.")],
    angle: Annotated[str, option("Hub axis to roller axis: 45deg; 90deg is an omni wheel.")],
    as_json: Json = False,
) -> None:
    """Example:  wmrgen rollers --radius 150mm --count 8 --angle 45deg

    Size the rollers of a mecanum wheel: length of a roller, width of the wheel (Tzafestas (2.86)-(2.91)).
    """


@verb("generate", "Write the library of textbook formulas and the errata of the texts.")
def textbook(out: Out = Path("generated")) -> None:
    """Example:  wmrgen textbook -o generated

    Write DIR/textbook/ (formulas that need no robot: report, C, CasADi, NumPy) and DIR/errata.md (misprints of
    the texts, each with the check that decides it). `wmrgen eval textbook FUNCTION` computes one of the formulas.
    """


@verb("motion", "Say where constant wheel speeds take a robot.")
def motion(
    robot: Robot,
    values: Annotated[
        Words, words("Speeds of wheels (left=4 or left.spin=4), steering angles, start pose x y theta.")
    ] = None,
    time: Annotated[str | None, option("How long [s].", "T")] = None,
    segments: Annotated[
        str | None,
        option(
            "A list of {vx vy omega | x_rate y_rate theta_rate | x y theta: value, dt: value}; - is stdin.",
            "FILE.json",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen motion robots/pioneer3dx.yaml left=4 right=2 --time 2.3

    Say where constant wheel speeds take a robot: the pose at the end, and the straight line or circle driven. With
    --segments: the wheel commands of each segment, waits for steering included.
    """


@verb("motion", "Find the centre of rotation of a twist or of steering angles.")
def icr(
    robot: Robot,
    values: Annotated[
        Words, words("vx vy omega (and a point: point.x point.y), or <wheel>.steer, or icr.x icr.y.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen icr robots/ackermann_car.yaml front_left.steer=0.3 front_right.steer=0.25

    Find the centre of rotation (ICR) of a twist; or of the axles at given steering angles, with the wheels that do
    not point at it; or the steering angles that turn the robot about icr.x, icr.y.
    """


@verb("model", "Print a model of a robot: state, inputs, equations, singular sets.")
def model(
    robot: Robot,
    form: Annotated[
        Literal["posture", "configuration", "eta", "zeta", "trailer", "chained"],
        typer.Option(help="Driven speeds, all joints, null-space inputs, front wheel, trailers, chained."),
    ] = "posture",
    as_latex: Annotated[bool, typer.Option("--latex", help="Print LaTeX.")] = False,
    as_json: Json = False,
) -> None:
    """Example:  wmrgen model robots/bicycle.yaml --form posture

    Print a model x' = G(x) u of a robot: state, inputs, equations, vector fields, and where it is singular.
    """


@verb("model", "Say what integrates, what Lie brackets reach, what is flat or chained.")
def structure(robot: Robot, as_json: Json = False) -> None:
    """Example:  wmrgen structure robots/bicycle.yaml

    Test every rolling constraint by Frobenius, proof printed, and all together; relations that they integrate to;
    Lie brackets with the growth vector; flat outputs; the chained form, or why there is none.
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


@verb("prove", "Prove ranges and rounding errors of the generated C.")
def prove(robot: Robot, as_json: Json = False) -> None:
    """Example:  wmrgen prove robots/pioneer3dx.yaml

    Prove, for all inputs within the limits of the robot file, that no function of the generated C divides by zero or
    gives NaN or infinity; the range of every output; and a bound of its rounding error. Frama-C Eva looks for alarms,
    too, where it is installed. Exit code 3 when something is not proved or limits are missing.
    """
