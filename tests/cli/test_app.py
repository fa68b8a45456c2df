"""The command line as a whole: help, version, usage, and that a verb loads what it needs and no more."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module

import pytest
import typer
from typer.main import get_command

import wmrgen
from tests.conftest import Outcome
from wmrgen.cli.commands import GROUPS, VERBS, app
from wmrgen.cli.declare import DECLARED

Cli = Callable[..., Outcome]
HEAVY = {"sympy", "numpy", "casadi", "scipy", "jinja2", "mpmath", "yaml"}


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
    assert list(listed) == list(VERBS)
    assert tuple(dict.fromkeys(listed.values())) == tuple(GROUPS)
    assert (listed["import"], listed["derive"], listed["eval"], listed["prove"]) == tuple(GROUPS)


def loaded(words: str) -> set[str]:
    """The modules that a process has loaded when ``wmrgen`` ends that was called with ``words``."""
    code = f"import contextlib, sys\nsys.argv[1:] = {words.split()!r}\nfrom wmrgen.__main__ import main\n"
    code += "with contextlib.suppress(SystemExit): main()\nprint(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stderr.splitlines()[-1].split())


def home(verb: str) -> str:
    return f"wmrgen.cli.{VERBS[verb].module}"


@pytest.mark.parametrize("verb", ["", "list", "model"])
def test_only_the_verb_that_is_named_is_loaded(verb: str) -> None:
    modules = loaded(f"{verb} --help")
    homes = {home(name) for name in VERBS}
    assert modules & homes == ({home(verb)} if verb else set())
    assert not modules & HEAVY


def test_no_verb_loads_anything_heavy_before_it_runs() -> None:
    """So that help and completion in a shell answer at once."""
    code = f"import sys, {', '.join(map(home, VERBS))}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not set(done.stdout.split()) & HEAVY


@pytest.mark.parametrize("name", VERBS)
def test_a_verb_is_declared_by_its_module(name: str) -> None:
    """As a function with help, every parameter an argument or an option."""
    import_module(home(name))
    work = DECLARED[name]
    help_text = inspect.getdoc(work) or ""
    assert help_text.startswith(f"Example:  wmrgen {name}")
    commands = get_command(app)
    command = commands.get_command(typer.Context(commands), name)  # type: ignore[attr-defined]
    assert {p.name for p in command.params} == set(inspect.signature(work).parameters)


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
