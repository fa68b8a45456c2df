"""Functions of a robot on every backend, and driving it: wheel commands through forward kinematics and odometry."""

from __future__ import annotations

import json
from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

import wmrgen
from tests.robots import with_functions
from wmrgen.codegen import registry
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact

Array = NDArray[np.float64]
ROOT = Path(__file__).resolve().parents[2]
ROBOTS = sorted((ROOT / "robots").glob("*.yaml"))
CASES: dict[str, dict[str, Any]] = {
    c["id"]: c for c in json.loads((ROOT / "textbook/cases.json").read_text(encoding="utf-8"))["cases"]
}
PAIR = """\
wmrgen: 1
name: pair
wheels:
  - {name: left,  type: fixed, x: 0, y: 0.2,  heading: 0, r: 0.1}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}
"""
# The axle centre stands at (-0.3, 0.1) and drives along 30 degrees.
SKEWED = """\
wmrgen: 1
name: skewed
wheels:
  - {name: left,  type: fixed, x: -0.3 - 0.2/2, y: 0.1 + 0.2*sqrt(3)/2, heading: 30 deg, r: 0.1}
  - {name: right, type: fixed, x: -0.3 + 0.2/2, y: 0.1 - 0.2*sqrt(3)/2, heading: 210 deg, r: 0.1}
"""
TRICYCLE = """\
wmrgen: 1
name: tricycle
wheels:
  - {{name: rear_left,  type: fixed, x: 0, y: 0.3,  heading: 0, r: 0.1}}
  - {{name: rear_right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}}
  - {{name: front, type: steered, x: {base}, y: 0, heading: 0, r: 0.1}}
"""


@lru_cache(maxsize=256)
def derived(path: Path, *names: str) -> Derivation:
    """The named functions of a robot file; without names what is generated for it."""
    return with_functions(derived(path), names) if names else wmrgen.derive(wmrgen.load(path))


def write(folder: Path, text: str) -> Path:
    """A robot file with this text."""
    path = folder / f"robot{abs(hash(text))}.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def call(path: Path, name: str, values: Mapping[str, float], backend: str = "casadi") -> dict[str, float]:
    """Outputs by contract name; inputs not given are 0, parameters nominal. C is evaluated in double."""
    d = derived(path, name)
    if backend == "exact":
        exact = {k: Exact(Fraction(v)) for k, v in values.items()}
        return {k: float(v) for k, v in d.evaluate(name, exact).items()}
    if backend == "c":
        ports = d.formula(name).inputs
        full = {p.name: float(p.default) if p.default is not None else 0.0 for p in ports}
        assert values.keys() <= full.keys()
        requests = [(name, full | dict(values))]
        return registry.BACKENDS["c99"].evaluate(d.c_module, requests, {"scalar": "double"})[0]
    f = _casadi(path, name)
    nominal = {p.name: float(p.nominal) for p in d.robot.tunable}
    result = f.call([values.get(n, nominal.get(n, 0.0)) for n in f.name_in()])
    return {n: float(v) for n, v in zip(f.name_out(), result, strict=True)}


@lru_cache(maxsize=256)
def _casadi(path: Path, name: str) -> Any:
    return derived(path, name).casadi()[name]


@lru_cache(maxsize=256)
def _of_columns(path: Path, name: str) -> casadi.Function:
    f = _casadi(path, name)
    inputs = casadi.SX.sym("inputs", f.n_in())
    return casadi.Function(name, [inputs], [casadi.vertcat(*f.call(casadi.vertsplit(inputs)))])


def calls(path: Path, name: str, cases: Mapping[str, Array | float]) -> dict[str, Array]:
    """As `call` with CasADi, of many cases at once: arrays of one length, and numbers that all cases have."""
    f = _casadi(path, name)
    nominal = {p.name: float(p.nominal) for p in derived(path, name).robot.tunable}
    inputs = np.broadcast_arrays(*(cases.get(n, nominal.get(n, 0.0)) for n in f.name_in()))
    return dict(zip(f.name_out(), np.array(_of_columns(path, name)(np.array(inputs))), strict=True))


def driven(path: Path, commands: Mapping[str, Array | float]) -> dict[str, Any]:
    """The twist that forward kinematics finds in joint commands, or in many; ``slip`` beside it."""
    sensed = {k: v for k, v in commands.items() if k in _casadi(path, "forward").name_in()}
    return (calls if any(map(np.ndim, sensed.values())) else call)(path, "forward", sensed)
