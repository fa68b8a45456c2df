"""Tunable lengths and angles give what the numbers give: all of them at once, and at every rank."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.conftest import Outcome
from tests.depth import everyday
from tests.robots import of_text
from tests.work import ends
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, evaluate_module

MECANUM = [
    f"{{{{name: w{i}, type: swedish, x: {x}, y: {y}, heading: {{h{i}}}, gamma: {{g{i}}}, r: 0.1}}}}"
    for i, (x, y) in enumerate(((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)))
]
OMNI = [
    f"{{{{name: w{i}, type: swedish, x: {{x{i}}}, y: {{p{i}}}, heading: {{h{i}}}, gamma: 0, r: 0.1}}}}"
    for i in range(3)
]
FIXED = [
    f"{{{{name: w{i}, type: fixed, x: {{x{i}}}, y: {{p{i}}}, heading: {{h{i}}}, r: 0.1}}}}" for i in range(4)
]
SMALL = {"h0": 0.1, "h1": -0.2, "h2": 0.05, "h3": 0.15, "g0": 0.7, "g1": -0.8, "g2": -0.75, "g3": 0.85}
WIDE = {
    "x0": 0.2, "x1": -0.1, "x2": -0.12, "x3": 0.3, "p0": 0.01, "p1": 0.2, "p2": -0.21, "p3": 0.4,
    "h0": 1.6, "h1": 3.7, "h2": -0.5, "h3": 0.6,
}  # fmt: skip
ROBOTS = {"mecanum": (MECANUM, SMALL), "omni": (OMNI, WIDE), "fixed": (FIXED, WIDE)}


def written(folder: Path, wheels: list[str], values: dict[str, float], tunable: bool) -> Path:
    used = {n: v for n, v in values.items() if any(f"{{{n}}}" in w for w in wheels)}
    parameters = "".join(f"  {n}: {{value: {v}, tunable: true}}\n" for n, v in used.items())
    lines = [w.format(**({n: n for n in used} if tunable else used)) for w in wheels]
    path = folder / "robot.yaml"
    top = (
        f"wmrgen: 1\nname: robot\nsnap: false\nparameters:\n{parameters}"
        if tunable
        else "wmrgen: 1\nname: robot\nsnap: false\n"
    )
    ignored = "  # wmrgen: ignore WMR030"  # four fixed wheels may lock each other
    path.write_text(top + "wheels:\n" + "".join(f"  - {line}{ignored}\n" for line in lines), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", everyday(ROBOTS, ["mecanum"]))
def test_every_angle_and_length_tunable(
    name: str, tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    """Derived; in all backends, at other values, what the file with those values gives."""
    wheels, nominal = ROBOTS[name]
    file = written(tmp_path, wheels, nominal, tunable=True)
    with ends():
        assert wmrgen_cli("derive", file, "-o", tmp_path / "out").code == 0
    parameters = [p.name for p in wmrgen.load(file).parameters]
    other = {n: round(nominal[n] + 0.01 * (k % 3 + 1), 3) for k, n in enumerate(parameters)}
    spins = {f"w{i}.spin": 0.5 * i - 0.75 for i in range(len(wheels))}
    words = [f"{n}={v}" for n, v in {**spins, **other}.items()]
    found = {
        backend: json.loads(wmrgen_cli("eval", file, "forward", *words, "--backend", backend, "--json").out)
        for backend in ("exact", "casadi", "numpy", "c")
    }
    plain = written(tmp_path, wheels, other, tunable=False)
    wanted = json.loads(wmrgen_cli("eval", plain, "forward", *words[: len(spins)], "--json").out)
    for backend, values in found.items():
        near = 2e-5 if backend == "c" else 1e-9
        assert values == pytest.approx(wanted, rel=near, abs=near), backend


RANKS = {
    "one fixed": "{name: a, type: fixed, x: 0, y: B, heading: 0, r: 0.05}",
    "one omni": "{name: a, type: swedish, x: 0, y: -B/2, heading: 0, gamma: 0, r: 0.1}",
    "two mecanum": (
        "{name: a, type: swedish, x: B, y: B, heading: 0, gamma: 45 deg, r: 0.1}\n"
        "  - {name: b, type: swedish, x: -B, y: -B, heading: 0, gamma: -45 deg, r: 0.1}"
    ),
    "no lever": (
        "{name: a, type: fixed, x: 0, y: 0.2 - B, heading: 0, r: 0.1}\n"
        "  - {name: b, type: fixed, x: 0, y: 0.2 - B, heading: 0, r: B}"
    ),
    "two steered, in one place where B is 1": (
        "{name: a, type: steered, x: B, y: 0, heading: 0, r: 0.1}\n"
        "  - {name: b, type: steered, x: 2 - B, y: 0, heading: 0, r: 0.1, actuated: [steer]}"
    ),
    "fixed and castor": (
        "{name: a, type: fixed, x: B, y: 0.1, heading: 0, r: 0.1}\n"
        "  - {name: c, type: castor, x: -B, y: 0, heading: 0, d: 0.05, r: 0.04, actuated: []}"
    ),
}


def derived(wheels: str, parameters: str = "", more: str = "") -> Derivation:
    return of_text(f"wmrgen: 1\nname: robot\n{parameters}wheels:\n  - {wheels}\n{more}")


def numbers(values: Mapping[str, Exact]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}


@pytest.mark.parametrize("name", RANKS)
def test_tunable_geometry_of_any_rank(name: str) -> None:
    """At its nominal value a tunable length gives what the number gives: the solution of least norm."""
    tunable = derived(RANKS[name].replace("B", "h"), "parameters: {h: {value: 0.2, tunable: true}}\n")
    plain = derived(RANKS[name].replace("B", "0.2"))
    random = np.random.default_rng(5)
    ports = [p.name for p in plain.formula("forward").inputs]
    for _ in range(3):
        given = {p: Exact(Fraction(int(random.integers(-50, 50)), 16)) for p in ports}
        wanted = numbers(plain.evaluate("forward", given))
        found = numbers(tunable.evaluate("forward", given | {"h": Exact(Fraction(1, 5))}))
        assert found == pytest.approx(wanted, rel=1e-12, abs=1e-12)
        prepared = numbers(evaluate_module(tunable.c_module, "forward", given, EXACT))
        assert prepared == pytest.approx({k: wanted[k] for k in prepared}, rel=1e-12, abs=1e-12)
