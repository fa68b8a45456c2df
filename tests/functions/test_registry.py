"""Functions are declared where they are written: found one by one, and from outside the package as from inside."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import sympy

import wmrgen
from tests.conftest import ROOT
from tests.functions.refusals import refused
from wmrgen.analysis.kinematics.pose import SINC
from wmrgen.analysis.kinematics.records import Formula, Locals
from wmrgen.errors import Code, NotDerivableError, RobotFileError
from wmrgen.functions import registry
from wmrgen.functions.registry import Kind, Reason, declaration, has_function, names, optional_names
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import TWIST, Limits, Port, Role, output
from wmrgen.geometry.symbolic import Expr, local, parameter, signal
from wmrgen.ir.lower import lower
from wmrgen.robotfile.schema import json_schema

UNICYCLE = (ROOT / "robots" / "unicycle.yaml").read_text(encoding="utf-8").split("functions:")[0]


def asking(directory: Path, *functions: str) -> Path:
    path = directory / "robot.yaml"
    path.write_text(f"{UNICYCLE}functions: [{', '.join(functions)}]\n", encoding="utf-8")
    return path


def run(code: str, *arguments: str) -> str:
    command = [sys.executable, "-c", code, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout


@pytest.mark.slow
def test_a_function_is_found_by_name_alone() -> None:
    """In fresh interpreters, so that no other look-up has imported its module."""
    code = (
        "import os, sys\nimport wmrgen.functions.registry as registry, wmrgen.functions.standard\n"
        "for name in sys.argv[1:]:\n"
        "    if not (child := os.fork()):\n        os._exit(0 if registry.has_function(name) else 1)\n"
        "    if os.waitpid(child, 0)[1]: print(name)"
    )
    assert not run(code, *names()).split()


def test_nothing_is_found_where_nothing_is_declared() -> None:
    for name in (
        "",
        "_",
        "registry",
        "functions",
        "frame",
        "drive",
        "circle_of",
        "os",
        "wmrgen",
        "x" * 10_000,
    ):
        assert not has_function(name)


def test_a_robot_that_asks_for_nothing_loads_no_family() -> None:
    code = (
        "import sys, wmrgen\nwmrgen.derive(wmrgen.load(sys.argv[1])).c_module\n"
        "print(*(m for m in sys.modules if m.startswith('wmrgen.functions.')))"
    )
    loaded = set(run(code, str(ROOT / "robots" / "turtlebot3_burger.yaml")).split())
    assert loaded == {"wmrgen.functions.registry", "wmrgen.functions.standard"}


@pytest.mark.parametrize(
    ("function", "code", "near"),
    [
        ("dynamcs", Code.UNDECLARED, "dynamics"),
        ("goto_pos", Code.UNDECLARED, "goto_pose"),
        ("inverse", Code.VALUE, ""),
    ],
)
def test_names_that_a_file_cannot_ask_for(tmp_path: Path, function: str, code: Code, near: str) -> None:
    path = asking(tmp_path, "circle", function)
    with pytest.raises(RobotFileError) as caught:
        wmrgen.load(path)
    line = len(UNICYCLE.splitlines()) + 1
    assert caught.value.code == code and function in caught.value.what
    assert caught.value.instead and near in caught.value.instead
    assert caught.value.mark is not None
    assert (caught.value.mark.line, caught.value.mark.column) == (line, len("functions: [circle, ") + 1)


def test_the_schema_lists_what_a_file_may_ask_for() -> None:
    listed = json_schema(optional_names())["$defs"]["function"]["enum"]
    assert set(listed) == set(names()) - {n for n in names() if declaration(n).kind is Kind.FIRMWARE}


OUTSIDE = '''
"""A function from outside the package: half the twist."""
from wmrgen.functions.registry import function
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.geometry.ports import TWIST, Port, Role
from wmrgen.geometry.symbolic import number, signal, times
from wmrgen.geometry.exact.number import Exact
from fractions import Fraction

@function(source="ours: half of everything")
def half_twist(robot, mobility):
    half = number(Exact(Fraction(1, 2)))
    out = (Port(f"half.{n}", Role.COMMAND, "m/s", "half") for n in ("vx", "omega"))
    results = (times(half, signal(n)) for n in ("vx", "omega"))
    return Formula("half_twist", TWIST[::2], (), tuple(zip(out, results)), "half the twist")
'''
USE = """
import sys; sys.path.insert(0, sys.argv[1])
import outside, wmrgen
from fractions import Fraction
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.emit import artifacts
from wmrgen.geometry.exact.number import Exact
d = wmrgen.derive(wmrgen.load(sys.argv[2]))
case = {"vx": 3.0, "omega": -5.0}
print(d.evaluate("half_twist", {"vx": Exact(3), "omega": Exact(-5)})["half.omega"])
for name in ("numpy", "casadi", "c99"):
    entry = BACKENDS[name]
    print(entry.load().evaluate(getattr(d, entry.source), [("half_twist", case)])[0]["half.omega"])
files = artifacts(d)
print("_half_twist(" in files["unicycle.h"].decode(), "ours: half of everything" in files["numerics.md"].decode())
"""


@pytest.mark.parametrize(("first", "second"), [("a", "b"), ("b", "a")])
def test_a_function_is_declared_in_one_module(
    first: str, second: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which may be read again."""
    with monkeypatch.context() as patch:
        patch.setitem(registry.FUNCTIONS, "mine", registry.declaration("circle"))  # removed again at the end
        patch.delitem(registry.FUNCTIONS, "mine")
        declare_in_two_modules(first, second)


def declare_in_two_modules(first: str, second: str) -> None:
    """The first may declare it again, the second may not."""

    def declare(module: str) -> None:
        def mine(robot: Any, mobility: Any) -> Any: ...

        mine.__module__ = module
        registry.function(source="ours")(mine)

    declare(first)
    declare(first)
    with pytest.raises(ValueError, match=r"\bmine\b") as caught:
        declare(second)
    assert all(re.search(rf"\b{module}\b", str(caught.value)) for module in (first, second))


def test_a_function_from_outside_is_derived_printed_and_reported(tmp_path: Path) -> None:
    (tmp_path / "outside.py").write_text(OUTSIDE, encoding="utf-8")
    lines = run(USE, str(tmp_path), str(asking(tmp_path, "half_twist"))).split("\n")
    assert lines[:5] == ["-5/2", "-2.5", "-2.5", "-2.5", "True True"]


def test_an_input_without_a_port_is_told() -> None:
    """A builder that forgets `tunable_ports`, which robots of constants would not show."""
    out = Port("half", Role.COMMAND, "m", "half of the radius")
    formula = Formula("half_radius", (), (), ((out, parameter("radius")),), "half of the radius")
    with pytest.raises(ValueError, match=r"half_radius .*\bradius\b.* tunable_ports\(robot\)"):
        lower(formula)


VX, VY = signal("vx"), signal("vy")


@pytest.mark.parametrize(
    ("value", "names"),
    [
        (0.5 * VX, ("0.5", "Float")),
        (3, ("3", "int")),
        (Exact(3), ("3", "Exact")),
        (VX / sympy.Integer(0), ("zoo",)),
        (sympy.exp(VX), ("exp(vx)",)),
        (sympy.Symbol("vx"), ("vx", "Symbol")),
        (sympy.cbrt(VX), ("vx**(1/3)", "Pow")),
        (sympy.Max(VX, VY, 1), ("Max(1, vx, vy)",)),
        (sympy.Piecewise((VX, VX <= 0), (VY, True)), ("Piecewise",)),
        (sympy.Piecewise((VX, VX < 0), (VY, VY < 1), (VX, True)), ("Piecewise",)),
        (sympy.Piecewise((VX, VX < 0), (VY, VY < 1)), ("Piecewise",)),
        (sympy.Piecewise((VX, VX < 0)), ("Piecewise",)),
        (local("half"), ("half",)),
    ],
)
def test_what_is_no_operation_is_told(value: Expr, names: tuple[str, ...]) -> None:
    formula = Formula("wrong", TWIST, (), ((output("value", "m", ""), value),), "")
    with pytest.raises(ValueError, match="wrong") as caught:
        lower(formula)
    assert all(name in str(caught.value) for name in names)


def test_a_condition_may_be_written_from_either_side() -> None:
    out = output("value", "m", "")
    least, turned = (
        lower(Formula("least", TWIST, (), ((out, sympy.Piecewise((VX, less), (VY, True))),), ""))
        for less in (sympy.StrictLessThan(VX, VY), sympy.StrictGreaterThan(VY, VX))
    )
    assert least == turned and len(least.nodes) == 3


def test_a_kernel_is_called_with_its_arguments() -> None:
    for args in ({"x": VX}, {"h": VX, "x": VX}, {}):
        with pytest.raises(ValueError, match=r"\bsinc\b.*\bh\b"):
            Locals().call(SINC, args)


def test_a_builder_that_returns_nothing(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def build(*_: object) -> Any:
        return None

    declared = registry.Declaration("mine", build, "ours", Kind.OPTIONAL, Limits.NONE, bool, False, False)
    monkeypatch.setitem(registry.FUNCTIONS, "mine", declared)
    with pytest.raises(TypeError, match=r"\bmine\b.*\bNone\b.*\bFormula\b"):
        _ = wmrgen.derive(wmrgen.load(asking(tmp_path, "mine"))).raw_module


@pytest.mark.parametrize(
    ("name", "inputs", "outputs", "names"),
    [
        ("other", (), ("a",), ("mine", "other")),
        ("mine", (), ("a", "a"), ("mine", "output", "a")),
        ("mine", ("vx",), ("a",), ("mine", "input", "vx")),
        ("mine", ("left.spin", "left_spin"), ("a",), ("mine", "input", "left_spin")),
        ("mine", (), ("my radius",), ("mine", "output", "my radius")),
        ("mine", ("2nd",), ("a",), ("mine", "input", "2nd")),
        ("mine", ("left.double",), ("a",), ("input", "double", "C ")),
        ("mine", (), ("lambda",), ("output", "lambda", "Python")),
        ("mine", ("ω",), ("a",), ("mine", "input", "ω")),
    ],
)
def test_a_formula_of_which_no_code_can_be_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, name: str, inputs: tuple[str, ...],
    outputs: tuple[str, ...], names: tuple[str, ...],
) -> None:  # fmt: skip
    def build(robot: object, mobility: object) -> Formula:
        del robot, mobility
        given = (*TWIST, *(Port(called, Role.COMMAND, "m") for called in inputs))
        return Formula(name, given, (), tuple((output(called, "m", ""), VX) for called in outputs), "")

    declared = registry.Declaration("mine", build, "ours", Kind.OPTIONAL, Limits.NONE, bool, False, False)
    monkeypatch.setitem(registry.FUNCTIONS, "mine", declared)
    derivation = wmrgen.derive(wmrgen.load(asking(tmp_path, "mine")))
    with pytest.raises(ValueError, match=name) as caught:
        _ = derivation.raw_module
    assert all(word in str(caught.value) for word in names)


SECTIONS = {
    "trailers": "trailers: [{name: cart, length: 1, hitch: 0.2}]",
    "cg": "cg: {x: 0, y: 0, z: 0.3}",
    "encoder": "encoder: {spin: {counts: 2000}}",
    "noise": "noise: {spin: {proportional: 0.02}}",
}
PAIR = """wmrgen: 1
name: pair
wheels:
  - {name: left, type: fixed, x: 0, y: 0.15, heading: 0, r: 0.05}
  - {name: right, type: fixed, x: 0, y: -0.15, heading: 0, r: 0.05}
"""
CAR = f"{PAIR}  - {{name: front, type: steered, x: 0.4, y: 0, heading: 0, r: 0.05}}\n"


def formulas(path: Path, text: str) -> dict[str, str]:
    """All functions of a robot as text; those that it does not have are empty."""
    path.write_text(text, encoding="utf-8")
    derivation = wmrgen.derive(wmrgen.load(path))
    found = {}
    for name in names():
        try:
            formula = derivation.formula(name)
            found[name] = repr((formula.inputs, formula.outputs))
        except NotDerivableError:
            found[name] = ""
    return found


@pytest.mark.slow
def test_functions_read_the_sections_that_change_them(tmp_path: Path) -> None:
    """Of a differential drive or a car: a function changes with a section exactly if it declares that it reads it."""
    assert SECTIONS.keys() == set(registry.SECTIONS)
    bare = {text: formulas(tmp_path / "robot.yaml", text) for text in (PAIR, CAR)}
    for section, line in SECTIONS.items():
        changed = set()
        for text, before in bare.items():
            after = formulas(tmp_path / "robot.yaml", f"{text}{line}\n")
            changed |= {name for name in names() if before[name] != after[name]}
        assert changed == {name for name in names() if section in declaration(name).reads}


def test_a_robot_without_rollers_has_no_contacts(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(PAIR, encoding="utf-8")
    with refused(Reason.NO_ROLLERS, "r_sw", "r"):
        wmrgen.derive(wmrgen.load(tmp_path / "robot.yaml")).formula("contacts")
