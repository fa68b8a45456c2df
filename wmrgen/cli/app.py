"""The commands and their options. Each command's work stands in its own module, imported when it runs."""

from __future__ import annotations

import functools
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, ParamSpec

import typer

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.errors import WmrgenError

P = ParamSpec("P")
_BUG = 70  # exit code of an internal error, as in sysexits.h
_INTERRUPTED = 130

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


class Scalar(StrEnum):
    """The floating-point type of the generated C."""

    float = "float"
    double = "double"


class Backend(StrEnum):
    """What computes the values of ``wmrgen eval``."""

    exact = "exact"
    casadi = "casadi"
    c = "c"


def guarded(command: Callable[P, int]) -> Callable[P, None]:
    """A command that ends with an exit code and never with a stack trace."""

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        raise typer.Exit(_outcome(lambda: command(*args, **kwargs)))

    return run


def _outcome(work: Callable[[], int]) -> int:
    try:
        return work()
    except WmrgenError as error:
        console.failure(str(error))
        return error.exit_code
    except KeyboardInterrupt:
        console.failure("interrupted")
        return _INTERRUPTED
    except BrokenPipeError:
        raise
    except (Exception, RecursionError) as error:
        console.failure(_bug(error))
        return _BUG


def _bug(error: BaseException) -> str:
    """One line about an error that is ours; the stack trace goes to a file."""
    import traceback

    from wmrgen.artifacts import write_log

    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    text = f"this is a bug in wmrgen {__version__}: {what}"
    try:
        log = write_log(f"wmrgen {__version__}\n" + "".join(traceback.format_exception(error)))
    except OSError:
        return text
    return f"{text} (details in {log})"


def _version(wanted: bool) -> None:
    if wanted:
        console.result(f"wmrgen {__version__}")
        raise typer.Exit


Robots = Annotated[list[Path], typer.Argument(metavar="ROBOT.yaml", help="Robot files.", show_default=False)]
Out = Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Where the robots' folders stand.")]
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
) -> int:
    """Example:  wmrgen derive robots/pioneer3dx.yaml -o build

    Derive robots and write DIR/<name>/: model, report, C, CasADi, NumPy.
    """
    from wmrgen.cli.derive import run

    return run(robots, out, as_json=json, scalar=scalar.value)


@app.command("eval", short_help="Compute a function of a robot's model.")
@guarded
def evaluate(
    robot: Annotated[Path, typer.Argument(metavar="ROBOT.yaml", show_default=False)],
    function: Annotated[
        str,
        typer.Argument(
            metavar="FUNCTION", help="inverse, forward, odometry or dynamics.", show_default=False
        ),
    ],
    values: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="NAME=VALUE", help="Inputs in SI units: 0.5, 1/3, pi/2, '45 deg/s'.", show_default=False
        ),
    ] = None,
    backend: Annotated[Backend, typer.Option(help="What computes; c needs a C compiler.")] = Backend.exact,
    scalar: Annotated[Scalar, typer.Option(help="Scalar type of backend c.")] = Scalar.float,
    cases: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.json", help="A list of {name: value}; prints the list of results. - is stdin."
        ),
    ] = None,
    json: Json = False,
) -> int:
    """Example:  wmrgen eval robots/pioneer3dx.yaml inverse vx=0.5 omega="30 deg/s"

    Compute a function of a robot's model. Inputs that are not given are 0, parameters nominal.
    """
    from wmrgen.cli.evaluate import run

    return run(
        robot,
        function,
        values or [],
        backend=backend.value,
        scalar=scalar.value,
        cases=cases,
        as_json=json,
    )


@app.command(short_help="Say which generated files are out of date.")
@guarded
def check(
    robots: Annotated[
        list[Path] | None,
        typer.Argument(metavar="ROBOT.yaml", help="Default: robots/*.yaml.", show_default=False),
    ] = None,
    out: Out = Path("generated"),
) -> int:
    """Example:  wmrgen check

    Say which generated files are not what the robot files give today. Exit code 1 when there are any.
    """
    from wmrgen.cli.check import run

    return run(robots or [], out)
