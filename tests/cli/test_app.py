"""The commands: what each declares is what the function that does its work takes."""

from __future__ import annotations

import pkgutil
from importlib import import_module
from inspect import isfunction, signature

import pytest

import wmrgen.cli
from wmrgen.cli.app import app

COMMANDS = [command.callback for command in app.registered_commands if command.callback]
MODULES = [
    import_module(f"wmrgen.cli.{m.name}")
    for m in pkgutil.iter_modules(wmrgen.cli.__path__)
    if m.name != "app"
]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.__name__)
def test_a_command_and_its_work_have_the_same_parameters(command: object) -> None:
    assert isfunction(command)
    homes = [vars(module).get(command.__name__) for module in MODULES]
    (work,) = {f for f in homes if isfunction(f) and f.__module__.startswith("wmrgen.cli.")}
    assert set(signature(work).parameters) == set(signature(command).parameters)
