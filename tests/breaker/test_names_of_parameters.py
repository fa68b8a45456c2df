"""Tunable parameters with the name of a function's input: one number must not stand for both."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome

ROBOT = """\
wmrgen: 1
name: pair
parameters: {{{0}: {1}}}
wheels:
  - {{name: left,  type: fixed, x: 0, y: {0}, heading: 0, r: 0.1}}
  - {{name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}}
functions: [{2}]
"""
SHARED = [
    ("v", "pursuit"),
    ("u1", "chained_input"),
    ("direction", "goto_pose"),
]


def written(folder: Path, name: str, value: str, function: str) -> Path:
    path = folder / "robot.yaml"
    path.write_text(ROBOT.format(name, value, function), encoding="utf-8")
    return path


@pytest.mark.parametrize(("name", "function"), SHARED)
def test_a_tunable_parameter_called_as_an_input(
    name: str, function: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """A constant of that name is a number in the code; a tunable one would be a second input, and is refused."""
    file = written(tmp_path, name, "0.2", function)
    assert wmrgen_cli("derive", file, "-o", tmp_path / "out").code == 0
    inputs = wmrgen_cli("eval", file, function).err
    if name.replace("_", ".", 1) not in inputs and name not in inputs:
        pytest.fail(f"{function} has no input {name}: {inputs}")
    file = written(tmp_path, name, "{value: 0.2, tunable: true}", function)
    for words in (["derive", file, "-o", tmp_path / "out"], ["eval", file, function]):
        done = wmrgen_cli(*words)
        assert done.code == 3
        assert f"{name} is an input of it and a tunable parameter" in done.err and f"{name}_0" in done.err
    assert wmrgen_cli("eval", file, "inverse", f"{name}=0.3").code == 0
