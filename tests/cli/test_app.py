"""The commands: help, version, usage; what each declares is what the function that does its work takes."""

from __future__ import annotations

import pkgutil
import re
from collections.abc import Callable
from importlib import import_module
from inspect import isfunction, signature
from pathlib import Path

import pytest

import wmrgen
import wmrgen.cli
from tests.conftest import Outcome
from wmrgen.cli import declare
from wmrgen.cli.declare import GROUPS
from wmrgen.cli.verbs import app

Cli = Callable[..., Outcome]


COMMANDS = [command.callback for command in app.registered_commands if command.callback]


MODULES = [
    import_module(f"wmrgen.cli.{m.name}")
    for m in pkgutil.iter_modules(wmrgen.cli.__path__)
    if m.name not in ("declare", "verbs")
]


@pytest.mark.parametrize("command", [(), ("derive",), ("eval",), ("check",)])
def test_help_starts_with_an_example(wmrgen_cli: Cli, command: tuple[str, ...]) -> None:
    done = wmrgen_cli(*command, "--help")
    assert done.code == 0
    lines = [line.strip() for line in done.out.splitlines() if line.strip()]
    assert lines[0].startswith("Usage: wmrgen")
    assert lines[1].startswith("Example:  wmrgen")


def test_help_lists_every_command_once_in_its_group(wmrgen_cli: Cli) -> None:
    group, listed = "", {}
    for line in wmrgen_cli("--help").out.splitlines():
        if not line.startswith(" "):  # a blank line ends a section
            group = line.removesuffix(":")
        elif group in GROUPS and re.match(r"  [a-z]", line):
            name = line.split()[0]
            assert name not in listed
            listed[name] = group
    names = [command.name or command.callback.__name__ for command in app.registered_commands]
    assert sorted(listed) == sorted(names)
    assert tuple(dict.fromkeys(listed.values())) == GROUPS
    assert (listed["import"], listed["derive"], listed["eval"], listed["prove"]) == GROUPS


@pytest.mark.parametrize(
    ("words", "built"), [(["list", "--help"], 1), (["--help"], len(COMMANDS)), (["lst"], len(COMMANDS))]
)
def test_a_command_that_is_named_is_the_only_one_that_is_built(
    monkeypatch: pytest.MonkeyPatch, words: list[str], built: int
) -> None:
    counts = []
    monkeypatch.setattr(
        declare.Commands, "main", lambda commands, *_, **__: counts.append(len(commands.commands))
    )
    app(words)
    assert counts == [built]
    assert [command.callback for command in app.registered_commands] == COMMANDS


def test_a_group_that_help_does_not_have_is_refused() -> None:
    with pytest.raises(ValueError, match="no group Analyze"):
        declare.group("Analyze")


def test_no_words_at_all_are_a_question(wmrgen_cli: Cli) -> None:
    """The help, as an answer that is no success."""
    done, asked = wmrgen_cli(), wmrgen_cli("--help")
    assert done.code == 2
    assert (done.out + done.err).split() == asked.out.split()
    assert wmrgen_cli("-h") == asked


def test_version(wmrgen_cli: Cli) -> None:
    assert wmrgen_cli("--version").out == f"wmrgen {wmrgen.__version__}\n"


@pytest.mark.parametrize(
    "words", [("derive",), ("fly",), ("eval", "x.yaml"), ("derive", "--scalar", "half", "x.yaml")]
)
def test_bad_usage(wmrgen_cli: Cli, words: tuple[str, ...]) -> None:
    done = wmrgen_cli(*words)
    assert done.code == 2
    assert "Usage:" in done.err


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.__name__)
def test_a_command_and_its_work_have_the_same_parameters(command: object) -> None:
    assert isfunction(command)
    homes = [vars(module).get(command.__name__) for module in MODULES]
    (work,) = {f for f in homes if isfunction(f) and f.__module__.startswith("wmrgen.cli.")}
    assert set(signature(work).parameters) == set(signature(command).parameters)


@pytest.mark.parametrize(
    ("words", "what_to_do"),
    [
        ("check", "Name a robot file."),
        ("schema --json --markdown", "Give one of them, not both."),
        ("eval PAIR inverse vx=1 --cases x.json", "Give one of them, not both."),
        ("motion PAIR", "Give wheel speeds and --time, or --segments FILE.json."),
        ("motion PAIR --time 1 --segments x.json", "Give wheel speeds and --time, or --segments FILE.json."),
        ("icr PAIR", "Give vx= vy= omega=, or steering angles <wheel>.steer=, or icr.x= icr.y=."),
        ("gains k_rho=1e60", "Gains of robots are near 1 to 10."),
    ],
)
def test_what_to_do_is_a_sentence_of_its_own(
    wmrgen_cli: Cli, robot_file: Path, monkeypatch: pytest.MonkeyPatch, words: str, what_to_do: str
) -> None:
    """After what is wrong, a clause that begins small, as behind the place in a robot file."""
    monkeypatch.chdir(robot_file.parent)
    done = wmrgen_cli(*words.replace("PAIR", robot_file.name).split())
    assert done.code == 2 and bool(done.out) == ("--json" in words)
    what, hint, end = done.err.partition(f". {what_to_do}\n")
    assert what[:1] in "abcdefghijklmnopqrstuvwxyz-" and hint and not end
