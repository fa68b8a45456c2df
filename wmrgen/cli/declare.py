"""How a command is declared: its group in the help, arguments and options that several have, where its work stands."""

from __future__ import annotations

import copy
import functools
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer._completion_shared import _completion_scripts
from typer.core import TyperGroup
from typer.main import get_command

from wmrgen.cli import console

# zsh loads the file that --install-completion writes at the first tab, and calls it: typer's defines what completes and
# completes nothing.
_completion_scripts["zsh"] += """
if [ "$funcstack[1]" = "_%(prog_name)s" ]; then
  %(complete_func)s "$@"
fi
"""
Declared = Callable[..., None]
GROUPS = ("Robot files", "Generate", "Compute", "Analyse")  # in the order of the help


class Commands(TyperGroup):
    """All commands, which help lists in groups. Words that they do not have get the nearest that they do."""

    def main(self, args: Sequence[str] | None = None, *rest: Any, **more: Any) -> Any:
        """Run the command that ``args`` name and exit with its code, 2 where no command can be called so."""
        words = sys.argv[1:] if args is None else list(args)
        try:
            sys.exit(super().main(args, *rest, **{**more, "standalone_mode": False}))
        except Exception as error:
            if not hasattr(error, "format_message"):  # of the classes of errors that typer has for usage
                raise
            sys.exit(_unusable(error, "--json" in words))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that the first of ``args`` names; typer's error for usage where there is none."""
        if args[0] not in self.commands and not ctx.resilient_parsing:
            from wmrgen.robotfile.text import quoted, suggestion

            ctx.fail(f"there is no command {quoted(args[0])}. {suggestion(args[0], list(self.commands))}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the groups, each with its commands in the order of their declaration."""
        longest = max(map(len, self.commands))
        for title in GROUPS:
            rows = [
                (f"{name:<{longest}}", command.get_short_help_str(formatter.width - longest - 6))
                for name, command in self.commands.items()
                if getattr(command, "rich_help_panel", None) == title
            ]
            with formatter.section(title):
                formatter.write_dl(rows)


class Verbs(typer.Typer):
    """All commands. Where the words that it is called with begin with a command's name, only that one is built."""

    def __call__(self, args: Sequence[str] | None = None, **options: Any) -> Any:
        """Run the command that ``args``, else those of the process, name. See `Commands.main`."""
        return get_command(self.named(sys.argv[1:] if args is None else args))(args, **options)

    def named(self, words: Sequence[str]) -> Verbs:
        """The one command with whose name ``words`` begin, else all of them."""
        chosen = copy.copy(self)
        named = [command for command in self.registered_commands if command.name in words[:1]]
        chosen.registered_commands = named or self.registered_commands
        return chosen


app = Verbs(
    cls=Commands,
    help="""Example:  wmrgen derive robots/pioneer3dx.yaml

    Compile a wheel layout into a verified kinematic model.
    """,
    epilog="Exit codes: 0 ok, 1 stale output or findings, 2 bad robot file or usage, 3 not derivable, 4 environment.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _unusable(error: Any, as_json: bool) -> int:
    """Tell what is wrong with the words of a command, below how it is called; the exit code."""
    from wmrgen.errors import UsageError
    from wmrgen.robotfile.text import quoted, suggestion

    text = str(error.format_message())
    if hasattr(error, "option_name") and hasattr(error, "possibilities"):
        wrong, params = error.option_name, error.ctx.command.get_params(error.ctx)
        options = [name for p in params for name in p.opts if name[:2] == "--"]
        hint = f" {suggestion(wrong, options)}" if wrong[:2] == "--" else ""
        text = f"there is no option {quoted(wrong)}.{hint}"
    if text.startswith("Usage:"):
        return console.failed(text, error.exit_code, as_json)
    text = " ".join(text.split())
    if error.ctx is not None:
        console.note(f"{error.ctx.get_usage()}\nTry '{error.ctx.command_path} --help' for help.\n")
    return console.failed(str(UsageError(text)), error.exit_code, as_json, [UsageError(text)])


def group(title: str) -> Callable[..., Callable[[Declared], Declared]]:
    """The decorator `_verb` of the commands that help lists under ``title``."""
    if title not in GROUPS:
        raise ValueError(f"help has no group {title}")
    return functools.partial(_verb, title)


def _verb(
    title: str, module: str, short_help: str, name: str | None = None
) -> Callable[[Declared], Declared]:
    """A command ``name``, else called as the function that it decorates, which declares options and help. The function
    of the same name and parameters in ``wmrgen.cli.<module>``, which is imported when the command runs, does the work
    and returns an exit code; no failure shows a stack trace."""

    def register(declared: Declared) -> Declared:
        @functools.wraps(declared)
        def run(**options: Any) -> None:
            def work() -> int:
                return int(getattr(import_module(f"wmrgen.cli.{module}"), declared.__name__)(**options))

            raise typer.Exit(console.outcome(work, options.get("as_json", False)))

        app.command(name or declared.__name__, short_help=short_help, rich_help_panel=title)(run)
        return declared

    return register


# ---- arguments and options that several commands have


Completion = Callable[[str], Sequence[str]]  # the beginning of a word -> the words that begin so


def argument(metavar: str, text: str | None = None, completion: Completion | None = None) -> Any:
    """A positional argument; help shows no default."""
    return typer.Argument(metavar=metavar, help=text, show_default=False, autocompletion=completion)


def words(text: str) -> Any:
    """An argument of NAME=VALUE words, which ``text`` names."""
    return argument("[NAME=VALUE]...", text)


def option(text: str, metavar: str | None = None, completion: Completion | None = None) -> Any:
    """An option with a value; help shows no default."""
    return typer.Option(metavar=metavar, help=text, show_default=False, autocompletion=completion)


def output(metavar: str, text: str) -> Any:
    """The option that says where what is written goes."""
    return typer.Option("-o", "--out", metavar=metavar, help=text)


def robot_files(incomplete: str) -> list[str]:
    """YAML files, and folders, whose paths begin so."""
    folder = Path(incomplete) if incomplete.endswith("/") else Path(incomplete).parent
    hidden = incomplete.rpartition("/")[2].startswith(".")
    paths = sorted(p for p in folder.iterdir() if hidden or p.name[0] != ".") if folder.is_dir() else []
    shown = [f"{p}/" if p.is_dir() else str(p) for p in paths if p.is_dir() or p.suffix in (".yaml", ".yml")]
    return [path for path in shown if path.startswith(incomplete)]


Words = list[str] | None
Robot = Annotated[Path, argument("ROBOT.yaml", completion=robot_files)]
Robots = Annotated[list[Path], argument("ROBOT.yaml...", "Robot files.", robot_files)]
Base = Annotated[str | None, option("The link that is the robot's frame.", "LINK")]
Package = Annotated[list[str] | None, option("The folder of a package that a file finds.", "NAME=DIR")]
Out = Annotated[Path, output("DIR", "Where the robots' folders stand.")]
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
