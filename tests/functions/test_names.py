"""Names of wheels and parameters that a formula or the generated code uses too: none stands for two things."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.conftest import Outcome
from tests.depth import everyday
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import names as functions
from wmrgen.geometry.exact.number import Exact

ROBOT = """\
wmrgen: 1
name: three
wheels:
  - {{name: {0}, type: steered, x: 0.3, y: 0.2, heading: 0, r: 0.1, limits: {{steer: [-100 deg, 100 deg]}}}}
  - {{name: {1}, type: steered, x: -0.3, y: 0.1, heading: 0, r: 0.1}}
  - {{name: {2}, type: castor, x: 0, y: -0.3, heading: 0, d: 0.05, r: 0.1, actuated: [spin, steer]}}
limits: {{vx: 1, vy: 1, omega: 1, spin: 100, steer_rate: 5}}
cg: {{x: 0, y: 0, z: 0.3}}
noise: {{spin: {{proportional: 0.1}}, steer: {{constant: 0.01}}, steer_rate: {{constant: 0.2}}}}
"""
Values = dict[str, Exact]
PLAIN = ("first_one", "second_one", "third_one")
# Words that begin the name of some intermediate result of which the rest may follow a wheel's name.
WORDS = ("half", "over", "point", "point_x", "point_y", "sum", "vector", "mean")


def derived(names: tuple[str, ...]) -> Derivation:
    return of_text(ROBOT.format(*names))


@pytest.fixture(scope="module")
def plain() -> dict[str, tuple[Values, Values]]:
    """What every function gives to wheels of unsuspicious names: inputs and outputs."""
    d = derived(PLAIN)
    random = np.random.default_rng(3)
    values = {}
    for name in functions():
        try:
            ports = d.formula(name).inputs
        except NotDerivableError:
            continue
        inputs = {p.name: Exact(Fraction(int(random.integers(-40, 40)), 32)) for p in ports}
        values[name] = inputs, d.evaluate(name, inputs)
    assert len(values) > 20
    return values


@pytest.mark.parametrize("word", everyday(WORDS, ["half", "point", "mean"]))
def test_a_wheel_with_the_name_of_a_word(word: str, plain: dict[str, tuple[Values, Values]]) -> None:
    """Every function gives what it gives to wheels of other names."""
    model = derived((word, PLAIN[1], f"{word}_x"))

    def renamed(name: str) -> str:
        return name.replace(PLAIN[0], word).replace(PLAIN[2], f"{word}_x")

    for name, (inputs, outputs) in plain.items():
        symbols = [symbol.name for symbol, _ in model.formula(name).locals]
        assert len(symbols) == len(set(symbols)), name
        results = model.evaluate(name, {renamed(k): v for k, v in inputs.items()})
        assert results == {renamed(k): v for k, v in outputs.items()}, name


PAIR = """\
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
    path.write_text(PAIR.format(name, value, function), encoding="utf-8")
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


@pytest.mark.parametrize("name", ["k0", "k1"])
def test_a_parameter_may_have_the_name_of_a_prepared_value(name: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(
        "wmrgen: 1\nname: robot\n"
        f"parameters: {{{name}: {{value: 0.05, tunable: true}}, a: {{value: 0.3, tunable: true}}}}\nwheels:\n"
        f"  - {{name: l, type: fixed, x: 0, y: a, heading: 0, r: {name}}}\n"
        f"  - {{name: r, type: fixed, x: 0, y: -0.2, heading: 0, r: {name}}}\n",
        encoding="utf-8",
    )
    prepare = wmrgen.derive(wmrgen.load(path)).c_module.prepare
    assert prepare is not None
    assert name not in {port.name for port in prepare.outputs}
