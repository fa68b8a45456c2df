"""How the module of a verb declares its arguments and options, and those that several verbs share."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import typer

from wmrgen.cli import console

# Name of a verb -> what Typer runs, once its module is imported.
DECLARED: dict[str, Callable[..., None]] = {}


Work = TypeVar("Work", bound=Callable[..., int])


def verb(name: str) -> Callable[[Work], Work]:
    """Make a function the verb ``name``.

    The parameters of the function declare arguments and options, its docstring is the help, and its body does the work
    and returns the exit code. The decorated function itself is unchanged. As a verb its errors become an exit code and
    a message, never a stack trace.
    """

    def register(work: Work) -> Work:
        @functools.wraps(work)
        def run(**options: Any) -> None:
            raise typer.Exit(console.outcome(lambda: work(**options), options.get("as_json", False)))

        DECLARED[name] = run
        return work

    return register


# ---- kinds of arguments and options

# The beginning of a word -> the words that the shell offers for it.
Completion = Callable[[str], Sequence[str]]


def argument(metavar: str, text: str | None = None, completion: Completion | None = None) -> Any:
    """Return a positional argument. The help shows no default.

    Args:
        metavar: its name in the help.
        text: the help.
        completion: the words that the shell offers for it.

    Returns:
        The argument, for ``Annotated``.
    """
    return typer.Argument(metavar=metavar, help=text, show_default=False, autocompletion=completion)


def words(text: str) -> Any:
    """Return an argument of NAME=VALUE words, with its help."""
    return argument("[NAME=VALUE]...", text)


def option(
    text: str, metavar: str | None = None, completion: Completion | None = None, name: str | None = None
) -> Any:
    """Return an option that takes a value. The help shows no default.

    Args:
        text: the help.
        metavar: the placeholder of the value in the help; None for the name of its type.
        completion: the words that the shell offers for the value.
        name: the option, such as ``--from``; None for the name of the parameter.

    Returns:
        The option, for ``Annotated``.
    """
    names = () if name is None else (name,)
    return typer.Option(*names, metavar=metavar, help=text, show_default=False, autocompletion=completion)


def option_with_default(text: str, metavar: str | None = None) -> Any:
    """Return an option that takes a value. The help shows its default."""
    return typer.Option(metavar=metavar, help=text)


def flag(name: str, text: str) -> Any:
    """Return an option without a value, with its help."""
    return typer.Option(name, help=text)


def output(metavar: str, text: str) -> Any:
    """Return the option ``-o`` for the place of what is written."""
    return typer.Option("-o", "--out", metavar=metavar, help=text)


def robot_files(incomplete: str) -> list[str]:
    """Return the YAML files and folders whose paths start with ``incomplete``."""
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    hidden = incomplete.rpartition("/")[2].startswith(".")
    if not folder.is_dir():
        return []
    offered = []
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") and not hidden:
            continue
        if path.is_dir():
            offered.append(f"{path}/")
        elif path.suffix in (".yaml", ".yml"):
            offered.append(str(path))
    return [text for text in offered if text.startswith(incomplete)]


def count_option(name: str, text: str, least: int = 1) -> Any:
    """Return an option with a whole number.

    Args:
        name: the option, such as ``--jobs``.
        text: the help.
        least: the smallest number.

    Returns:
        The option, for ``Annotated``.
    """
    return typer.Option(name, metavar="N", min=least, help=text, show_default=False)


# ---- arguments and options of several verbs

Words = list[str] | None
Robot = Annotated[Path, argument("ROBOT.yaml", completion=robot_files)]
Robots = Annotated[list[Path], argument("ROBOT.yaml...", "Robot files.", robot_files)]
Base = Annotated[str | None, option("The link that is the robot's frame.", "LINK")]
Package = Annotated[
    list[str] | None, option("The folder of a package that a description refers to.", "NAME=DIR")
]
Distro = Annotated[
    Literal["humble", "jazzy", "kilted", "rolling"] | None,
    option_with_default(
        "The release of ROS 2 that runs the controllers; without it, all names are read, and the newest are written."
    ),
]
Out = Annotated[Path, output("DIR", "The folder that contains the folders of the robots.")]
Json = Annotated[bool, flag("--json", "Print JSON.")]
Scalar = Literal["float", "double"]
Math = Annotated[
    Literal["inline", "libm"] | None,
    option_with_default(
        "Sines and arctangents of the C: wmrgen's own (default for float) or libm's (default for double)."
    ),
]
Target = Annotated[
    Literal["m4f", "m0", "avr", "host"],
    option_with_default(
        "Processor of the C. m4f: FPU with fused multiply-add; host: any FPU; m0: no FPU; avr: AVR."
    ),
]
