"""Rust has the bits of the C of the same choice: for all kinds of robots, choices, functions and inputs."""

from __future__ import annotations

import math
import random
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from struct import pack

import pytest

from tests.codegen.backends.modules import MODULES
from tests.codegen.c.harness import gallery
from tests.depth import everyday, examples
from tests.external_tools import need
from tests.robots import of_gallery
from wmrgen import derive, load
from wmrgen.codegen.c.driver import answer, calls, driver, request
from wmrgen.codegen.c.emit import printed
from wmrgen.codegen.c.emit import unit as c_unit
from wmrgen.codegen.compiler import compile_and_run
from wmrgen.codegen.rust import evaluate
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import names
from wmrgen.ir.calls import nominal
from wmrgen.ir.kernels.choice import Choice
from wmrgen.ir.nodes import Module, contract
from wmrgen.ir.selftest.vectors import tables

FLOAT, DOUBLE = Choice(), Choice("double", "libm")
CHOICES = (
    FLOAT,
    DOUBLE,
    Choice(math="libm"),
    Choice(target="m0"),
    Choice(target="host"),
    Choice(target="avr"),
)
# Tunable parameters, rollers, steered modules, a car with limits, castors.
ROBOTS = ("pioneer3dx", "kuka_youbot", "wpilib_swervebot", "ackermann_car", "office_chair")
# Planted faults gave as many wrong bits at either level. An integer overflow shows only without
# optimisation, for every robot. With optimisation, each choice and each robot is compiled once.
OPTIMISED = {(ROBOTS[k % len(ROBOTS)], choice) for k, choice in enumerate(CHOICES)}
BUILDS = [
    (robot, choice, level)
    for robot in ROBOTS
    for choice in CHOICES
    for level in ("0", "3")
    if level == "0" or (robot, choice) in OPTIMISED
]
ALWAYS = [("pioneer3dx", FLOAT, "3")]
EDGES = (
    0.0, -0.0, math.pi / 2, -math.pi / 2, math.pi, 3 * math.pi / 2, 1.0, -1.0, 3 / 64, 3 / 64 - 2**-29, 1e-6, -1e-6,
    1e-12, 1e-12 * (1 - 2**-24), -1e-30, 100.0,
)  # fmt: skip
Cases = list[tuple[str, dict[str, float]]]
Answers = list[dict[str, float]]


def cases_of(module: Module, scalar: str, count: int) -> Cases:
    """The rows of the self-test, then ``count`` points per function, where two inputs of five are special."""
    source, tunables = random.Random(module.name), nominal(module)
    cases: Cases = [
        (table.functions[0], dict(zip(table.inputs, vector.inputs, strict=True)))
        for table in tables(module, scalar)
        for vector in table.vectors
    ]
    for function in (f for f in module.functions if f.outputs):
        for _ in range(count):
            special = (
                source.choice(EDGES) if source.random() < 0.4 else source.uniform(-4, 4) for _ in iter(int, 1)
            )
            case = dict(zip((port.name for port in contract(function)), special, strict=False))
            scaled = {name: value * source.uniform(0.9, 1.1) for name, value in tunables.items()}
            cases.append((function.name, {**case, **scaled}))
    return cases


def by_c(module: Module, cases: Cases, choice: Choice) -> Answers:
    """Return the results of the C with the same choice."""
    functions = c_unit(module, choice)
    wrappers = {call.function: (k, call) for k, call in enumerate(calls(functions))}
    header, source, _ = printed(functions)
    files = {f"{module.name}.h": header, f"{module.name}.c": source}
    files["driver.c"] = driver([call for _, call in wrappers.values()])
    called = [wrappers[f"{module.name}_{name}"] for name, _ in cases]
    tunables = nominal(module)
    lines = [
        request(k, call, {**tunables, **case}) for (k, call), (_, case) in zip(called, cases, strict=True)
    ]
    answers = compile_and_run(files, "\n".join([*lines, ""])).splitlines()
    return [answer(call, line) for (_, call), line in zip(called, answers, strict=True)]


def bits(value: float) -> str:
    return "NaN" if math.isnan(value) else pack(">d", value).hex()


def mismatches(
    module: Module, cases: Cases, choice: Choice, level: str, of_c: Answers | None = None
) -> list[str]:
    """Return outputs with other bits than the C of the same choice, or than ``of_c``."""
    flags = (f"-Copt-level={level}", "-Ccodegen-units=1", "-Dwarnings")
    rust = evaluate(module, cases, flags, **choice.words())
    expected = of_c or by_c(module, cases, choice)
    return [
        f"{name}({case}).{key}: {mine[key]!r}, in C {value!r}"
        for (name, case), mine, right in zip(cases, rust, expected, strict=True)
        for key, value in right.items()
        if bits(mine[key]) != bits(value)
    ]


def test_a_mismatch_is_found() -> None:
    need("rustc", "cc")
    module = MODULES[0]
    cases: Cases = [("inverse", {"vx": 1.0, "vy": 0.0, "omega": 0.25})]
    assert len(mismatches(module, cases, FLOAT, "0", by_c(module, cases, DOUBLE))) == 2


def label(build: tuple[str, Choice, str]) -> str:
    robot, choice, level = build
    return "-".join((robot, *choice.words().values(), level))


@lru_cache(maxsize=2)
def of_robot(robot: str, scalar: str) -> Cases:
    """Return the cases of a robot for every choice."""
    return cases_of(of_gallery(robot).c_module, scalar, examples(1000))


@lru_cache(maxsize=1)
def in_c(robot: str, choice: Choice) -> Answers:
    """Return the results of its C, for both levels of Rust."""
    return by_c(of_gallery(robot).c_module, of_robot(robot, choice.scalar), choice)


@pytest.mark.parametrize("build", everyday(BUILDS, ALWAYS), ids=label)
def test_bits_are_those_of_the_c(build: tuple[str, Choice, str]) -> None:
    need("rustc", "cc")
    robot, choice, level = build
    cases = of_robot(robot, choice.scalar)
    assert mismatches(of_gallery(robot).c_module, cases, choice, level, in_c(robot, choice)) == []


@pytest.mark.slow
def test_bits_of_the_whole_gallery() -> None:
    """Of the other robots."""
    need("rustc", "cc")
    for module in (module for module in gallery() if module.name not in ROBOTS):
        assert mismatches(module, cases_of(module, "float", 100), FLOAT, "2") == [], module.name


EVERYTHING = """\
wmrgen: 1
name: everything
parameters: {radius: {value: 0.1, tunable: true}}
wheels:
  - {name: front, type: steered, x: 0.3, y: 0.2, heading: 0, r: radius,
     encoder: {spin: {counts: 4096, gear: 30, reversed: true, bits: 16}, steer: {counts: 16384}}}
  - {name: move, type: steered, x: -0.3, y: -0.2, heading: 0, r: 0.1,
     encoder: {spin: {counts: 4096}, steer: {counts: 512}}}
  - {name: tail, type: castor, x: -0.22, y: 0, d: 0.04, r: 0.05}
noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}, steer: {constant: 0.5 deg}}
limits:
  {vx: 2, vy: 1, omega: 4, spin: 35, steer: [-95 deg, 95 deg], steer_rate: 3, vx_rate: 1, vy_rate: 1, omega_rate: 2}
"""


@pytest.mark.slow
@pytest.mark.parametrize("choice", [FLOAT, DOUBLE], ids=["float", "double"])
def test_bits_of_every_function(choice: Choice, tmp_path: Path) -> None:
    """All functions of a robot with castors, tunable parameters, encoders, noise and every limit."""
    need("rustc", "cc")
    path = tmp_path / "everything.yaml"
    path.write_text(EVERYTHING)
    robot = load(path)
    derivable = []
    for name in names():
        with suppress(NotDerivableError):
            derivable += [f for f in (name,) if derive(robot, [f]).c_module]
    module = derive(robot, derivable).c_module
    assert {"desaturate", "limit_acceleration", "odometry_covariance", "joints_from_counts"} < set(derivable)
    assert mismatches(module, cases_of(module, choice.scalar, 100), choice, "1") == []
