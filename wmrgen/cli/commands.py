"""The command line as a whole: the table of verbs, how `wmrgen --help` lists them, and how a verb is found and run."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Annotated, Any, NamedTuple

import typer
from typer._completion_shared import _completion_scripts
from typer.core import TyperGroup
from typer.main import get_command as build

from wmrgen import __version__
from wmrgen.cli import console
from wmrgen.cli.declare import DECLARED


class Verb(NamedTuple):
    """A verb as `wmrgen --help` lists it. Its module is imported when the verb is used."""

    name: str
    module: str  # in wmrgen.cli: declares the arguments and options of the verb, and does its work
    summary: str  # one line of the help


# The groups of the help, each with its verbs, in the order of the help.
GROUPS: dict[str, tuple[Verb, ...]] = {
    "Robot files": (
        Verb("list", "gallery", "List the robots that come with wmrgen."),
        Verb("new", "new", "Start a robot file for a kind of drive."),
        Verb("import", "importing", "Make a robot file from a URDF, xacro or SDF."),
        Verb("fmt", "fmt", "Format robot files."),
        Verb("schema", "schema", "Print the JSON Schema of robot files."),
    ),
    "Generate": (
        Verb("derive", "generate", "Derive robots and write their model, report and code."),
        Verb("view", "view", "Show robots in the browser and follow changes of their files."),
        Verb("exercise", "exercise", "Write a robot as an exercise for students, with or without its solution."),
        Verb("check", "generate", "List generated files that are out of date."),
        Verb("gallery", "gallery", "Write overview pages of all derived robots, with top views."),
        Verb("export", "export", "Describe a robot for another tool: URDF, SDF, ros2_control, WPILib."),
        Verb("textbook", "textbook", "Write the library of textbook formulas and the errata of the texts."),
    ),
    "Compute": (
        Verb("eval", "evaluate", "Compute a function of a robot's model."),
        Verb("motion", "motion", "Compute where constant wheel speeds take a robot."),
        Verb("simulate", "simulate", "Drive a robot in simulation; draw its path and play it."),
        Verb("icr", "icr", "Find the centre of rotation of a twist or of steering angles."),
        Verb("rollers", "rollers", "Size the rollers of a mecanum wheel."),
    ),
    "Analyse": (
        Verb("model", "model", "Print a model of a robot: state, inputs, equations, singular sets."),
        Verb("structure", "structure", "Test integrability, reachability, flatness and the chained form."),
        Verb("functions", "functions", "List the functions that a robot has."),
        Verb("lint", "lint", "Report likely mistakes in robot files."),
        Verb("explain", "explain", "Explain a finding, with a wrong and a right example."),
        Verb("designs", "designs", "Compare designs side by side, and sweep over their parameters."),
        Verb("compare", "compare", "Compare descriptions of one robot, and what differences do to its motion."),
        Verb("prove", "prove", "Prove ranges and rounding errors of the generated C."),
        Verb("stability", "stability", "Compute the margin before a robot tips over."),
        Verb("gains", "gains", "Check the gains of the polar feedback law."),
        Verb("calibrate", "calibrate", "Estimate a robot's parameters from logs of drives."),
    ),
}  # fmt: skip
VERBS = {verb.name: verb for verbs in GROUPS.values() for verb in verbs}

# zsh loads and runs the file that --install-completion writes when Tab is first pressed. Typer's file only defines the
# completion function, so the first Tab has no effect. These lines call the function.
_completion_scripts["zsh"] += """
if [ "$funcstack[1]" = "_%(prog_name)s" ]; then
  %(complete_func)s "$@"
fi
"""


class Commands(TyperGroup):
    """All verbs. The module of a verb is imported when the verb is used."""

    def main(self, args: Sequence[str] | None = None, *rest: Any, **more: Any) -> Any:
        """Run the verb that ``args`` name and exit with its code; exit with 2 for wrong usage."""
        words = sys.argv[1:] if args is None else list(args)
        try:
            sys.exit(super().main(args, *rest, **{**more, "standalone_mode": False}))
        except Exception as error:
            if not hasattr(error, "format_message"):  # which Typer's usage errors have
                raise
            sys.exit(_report_usage_error(error, "--json" in words))

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the verbs in the order of the help."""
        return list(VERBS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return the command of a verb, None for an unknown name."""
        verb = VERBS.get(cmd_name)
        if verb is None:
            return None
        import_module(f"wmrgen.cli.{verb.module}")
        alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
        alone.command(verb.name, short_help=verb.summary)(DECLARED[verb.name])
        return build(alone)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the verb that the first of ``args`` names. Fail with a suggestion if there is none."""
        if args[0] not in VERBS and not ctx.resilient_parsing:
            from wmrgen.robotfile.text import quoted, suggestion

            ctx.fail(f"there is no command {quoted(args[0])}. {suggestion(args[0], list(VERBS))}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each group with its verbs."""
        longest = max(map(len, VERBS))
        for title, verbs in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(f"{verb.name:<{longest}}", verb.summary) for verb in verbs])


def _report_usage_error(error: Any, as_json: bool) -> int:
    """Print the usage of the verb and what is wrong with the words after it; return the exit code."""
    from wmrgen.errors import UsageError
    from wmrgen.robotfile.text import quoted, suggestion

    text = str(error.format_message())
    if hasattr(error, "option_name") and hasattr(error, "possibilities"):
        wrong, params = error.option_name, error.ctx.command.get_params(error.ctx)
        options = [name for p in params for name in p.opts if name.startswith("--")]
        hint = f" {suggestion(wrong, options)}" if wrong.startswith("--") else ""
        text = f"there is no option {quoted(wrong)}.{hint}"
        if wrong[1:2].isdigit():
            text += " Write a negative number after its name, as in vx=-1.5."
    if text.startswith("Usage:"):
        return console.failed(text, error.exit_code, as_json)
    text = " ".join(text.split())
    if error.ctx is not None:
        console.note(f"{error.ctx.get_usage()}\nTry '{error.ctx.command_path} --help' for help.\n")
    return console.failed(str(UsageError(text)), error.exit_code, as_json, [UsageError(text)])


app = typer.Typer(
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
