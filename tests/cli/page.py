"""docs/command_line.md: the help of every command, as it is printed. ``python -m tests.cli.page`` writes it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer

from tests.conftest import ROOT
from wmrgen.cli.commands import GROUPS, app

PAGE = ROOT / "docs" / "command_line.md"
HEAD = """\
# The command line

Every command with its arguments and options, as `wmrgen COMMAND --help` prints them; [commands.md](commands.md) says
what the results mean. Results go to stdout, everything else to stderr. With `--json` stdout is one JSON value, on
failure too: `{"error": …, "exit_code": …, "errors": […]}`, each error with `file`, `line`, `column`, `what`, `why`,
`instead` and `exit_code`.

Exit codes: 0 ok, 1 stale output or findings, 2 bad robot file or usage, 3 not derivable, 4 environment.
`wmrgen --install-completion` teaches the shell the commands, robot files and names of functions.

`.pre-commit-hooks.yaml` has the hooks `wmrgen-check`, `wmrgen-lint` and `wmrgen-fmt` for pre-commit; `action.yml` is a
GitHub Action that runs `wmrgen check`: a step `uses: OWNER/wmrgen@VERSION`, `with: {robots: robots/*.yaml}`.
"""


def page() -> str:
    """The whole page."""
    return HEAD + "".join(_sections())


def _sections() -> Iterator[str]:
    commands: Any = typer.main.get_command(app)
    top = typer.Context(commands)
    for group, verbs in GROUPS.items():
        yield f"\n## {group}\n"
        for verb in verbs:
            command = commands.get_command(top, verb.name)
            context = typer.Context(
                command, info_name=f"wmrgen {verb.name}", terminal_width=100, max_content_width=100
            )
            yield f"\n### {verb.name}\n\n```text\n{command.get_help(context).rstrip()}\n```\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
