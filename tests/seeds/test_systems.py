"""Every system of the texts: derived, in CasADi, in C and in a report. The table is tests/README.md."""

from __future__ import annotations

import json
import math
import random
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.robots import of_text
from tests.seeds.systems import ROBOTS, SYSTEMS, TEXTBOOK, asked, robot_file
from textbook.library import textbook
from wmrgen.codegen.c.driver import answer, calls, driver, request
from wmrgen.codegen.c.emit import sources, unit
from wmrgen.codegen.compiler import DEFAULT_FLAGS, compile_and_run
from wmrgen.codegen.registry import BACKENDS
from wmrgen.functions.registry import optional_names
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.ir.kernels.choice import Choice

IN_C = frozenset(optional_names())
PAGE = Path(__file__).parents[1] / "README.md"
COLUMNS = ("derived", "CasADi", "C", "report")


@cache
def derivation(robot: str) -> Any:
    if robot == TEXTBOOK:
        return textbook()
    return of_text(robot_file(robot, IN_C))


@cache
def report(robot: str) -> str:
    from wmrgen.derivation.emit import facts

    if robot == TEXTBOOK:
        from textbook.emit import artifacts

        return artifacts()["report.md"].decode()
    d = derivation(robot)
    pages = BACKENDS["report"].load().emit(d, facts(d, Choice(), b""))
    return (pages["report.md"] + pages["numerics.md"]).decode()


def samples(robot: str, name: str) -> dict[str, float]:
    """Seeded inputs, all different, so that swapped ones show."""
    ports = derivation(robot).raw_module.function(name).inputs
    rng = random.Random(f"{robot} {name}")
    drawn = {p.name: round(rng.uniform(0.1, 0.9), 4) for p in ports}
    return drawn | {p.name: float(p.default) for p in ports if p.default is not None}


@cache
def exact(robot: str, name: str) -> dict[str, float]:
    given = {k: Exact(Fraction(v)) for k, v in samples(robot, name).items()}
    return {k: float(v) for k, v in evaluate_module(derivation(robot).raw_module, name, given, EXACT).items()}


@cache
def in_c(robot: str) -> dict[str, dict[str, float]]:
    """Every function asked of a robot, from one compiled program in double."""
    module = derivation(robot).c_module
    available = calls(unit(module, Choice("double")))
    header, source = sources(module, Choice("double"))
    files = {f"{module.name}.h": header, f"{module.name}.c": source, "driver.c": driver(available)}
    wanted = [
        (n, k) for n in asked(robot) for k, c in enumerate(available) if c.function == f"{module.name}_{n}"
    ]
    lines = [request(k, available[k], samples(robot, n)) for n, k in wanted]
    printed = compile_and_run(files, "\n".join(lines) + "\n", None, DEFAULT_FLAGS).splitlines()
    return {n: answer(available[k], line) for (n, k), line in zip(wanted, printed, strict=True)}


def column(what: str, robot: str, name: str) -> bool:
    """Whether one function of one system stands in a column."""
    d = derivation(robot)
    if what == "derived":
        return all(math.isfinite(v) for v in exact(robot, name).values()) and bool(exact(robot, name))
    if what == "report":
        page = report(robot)
        return f"`{name}`" in page
    if what == "C":
        found = in_c(robot)[name]
    else:
        (found,) = BACKENDS["casadi"].load().evaluate(d.module, [(name, samples(robot, name))])
    truth = exact(robot, name)
    return bool(found) and all(math.isclose(found[k], truth[k], rel_tol=1e-9, abs_tol=1e-9) for k in found)


@pytest.mark.parametrize("what", COLUMNS)
@pytest.mark.parametrize("robot", [*ROBOTS, TEXTBOOK])
def test_functions(robot: str, what: str) -> None:
    missing = [name for name in asked(robot) if not column(what, robot, name)]
    assert not missing


def test_every_system_of_the_cases_is_there() -> None:
    cases = json.loads((Path(__file__).parents[2] / "textbook" / "cases.json").read_text(encoding="utf-8"))[
        "cases"
    ]
    assert {c["system"] for c in cases} <= SYSTEMS.keys()
    assert all(asked(robot) for robot in ROBOTS)


def table() -> list[str]:
    """The rows of tests/README.md; `test_functions` shows that each tick holds."""
    head = f"| system | functions | {' | '.join(COLUMNS)} |"
    rows = []
    for system, entries in SYSTEMS.items():
        parts = [f"{robot}: {', '.join(f'`{n}`' for n in names.split())}" for robot, names in entries.items()]
        rows.append(f"| {system} | {'; '.join(parts)} | {' | '.join('✓' for _ in COLUMNS)} |")
    return [head, "|---|---|---|---|---|---|", *rows]


def test_the_table_in_the_readme() -> None:
    assert "\n".join(table()) in PAGE.read_text(encoding="utf-8")
