"""Robots of the texts with their lengths as symbols, and functions through the command line on every backend."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import sympy

from tests.conftest import command_line
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.symbolic import parameter, signal

Expr = Any

OMNI_K = """\
wmrgen: 1
name: omni_k
parameters:
  a: {value: 0.25, tunable: true}
  r: {value: 0.06, tunable: true}
wheels:
  - {name: w1, type: swedish, l: a, alpha: 0, beta: 0, gamma: 0, r: r}
  - {name: w2, type: swedish, l: a, alpha: 2*pi/3, beta: 0, gamma: 0, r: r}
  - {name: w3, type: swedish, l: a, alpha: 4*pi/3, beta: 0, gamma: 0, r: r}
"""
DIFFERENTIAL = """\
wmrgen: 1
name: differential
parameters:
  a: {value: 0.27, tunable: true}
  r: {value: 0.11, tunable: true}
wheels:
  - {name: right, type: fixed, l: a, alpha: -pi/2, beta: pi, r: r}
  - {name: left, type: fixed, l: a, alpha: pi/2, beta: 0, r: r}
"""
TRICYCLE = """\
wmrgen: 1
name: tricycle
parameters:
  a: {value: 0.4, tunable: true}
  length: {value: 1.4, tunable: true}
wheels:
  - {name: rear_left, type: fixed, x: 0, y: a, heading: 0, r: 0.11, actuated: []}
  - {name: rear_right, type: fixed, x: 0, y: -a, heading: 0, r: 0.11, actuated: []}
  - {name: front, type: steered, x: length, y: 0, heading: 0, r: 0.11}
"""
OMNI_T = """\
wmrgen: 1
name: omni_three
parameters:
  half: {value: 0.2, tunable: true}
  r: {value: 0.05, tunable: true}
wheels:
  - {name: w1, type: swedish, l: half, alpha: -pi/2, beta: pi, gamma: 0, r: r}
  - {name: w2, type: swedish, l: half, alpha: pi/6, beta: pi, gamma: 0, r: r}
  - {name: w3, type: swedish, l: half, alpha: 5*pi/6, beta: pi, gamma: 0, r: r}
"""
OMNI4_T = """\
wmrgen: 1
name: omni_four
parameters:
  half: {value: 0.2, tunable: true}
  r: {value: 0.05, tunable: true}
  b1: {value: 80 deg, tunable: true}
  b2: {value: 175 deg, tunable: true}
  b3: {value: 260 deg, tunable: true}
wheels:
  - {name: w1, type: swedish, l: half, alpha: b1, beta: pi, gamma: 0, r: r}
  - {name: w2, type: swedish, l: half, alpha: b2, beta: pi, gamma: 0, r: r}
  - {name: w3, type: swedish, l: half, alpha: b3, beta: pi, gamma: 0, r: r}
  - {name: w4, type: swedish, l: half, alpha: 0, beta: pi, gamma: 0, r: r}
"""
MECANUM_T = """\
wmrgen: 1
name: mecanum
parameters:
  d1: {value: 0.18, tunable: true}
  d2: {value: 0.26, tunable: true}
  r: {value: 0.1, tunable: true}
wheels:
  - {name: w1, type: swedish, x: d1, y: d2, heading: pi/2, gamma: 45 deg, r: r}
  - {name: w2, type: swedish, x: -d1, y: d2, heading: pi/2, gamma: -45 deg, r: r}
  - {name: w3, type: swedish, x: -d1, y: -d2, heading: pi/2, gamma: 45 deg, r: r}
  - {name: w4, type: swedish, x: d1, y: -d2, heading: pi/2, gamma: -45 deg, r: r}
"""
FOUR_WS = """\
wmrgen: 1
name: four_ws
parameters:
  length: {value: 0.5, tunable: true}
  width: {value: 0.3, tunable: true}
  offset: {value: 0.07, tunable: true}
wheels:
  - {name: w1, type: steered, x: length, y: width, heading: 0, r: 0.1, offset_y: offset}
  - {name: w2, type: steered, x: length, y: -width, heading: 0, r: 0.1, offset_y: -offset}
  - {name: w3, type: steered, x: -length, y: width, heading: 0, r: 0.1, offset_y: offset}
  - {name: w4, type: steered, x: -length, y: -width, heading: 0, r: 0.1, offset_y: -offset}
"""
TWO_WHEELS = """\
wmrgen: 1
name: two_wheels
parameters:
  ax: {value: 0.9, tunable: true}
  ay: {value: 0.2, tunable: true}
  bx: {value: -0.7, tunable: true}
  by: {value: -0.1, tunable: true}
wheels:
  - {name: w1, type: steered, x: ax, y: ay, heading: 0, r: 0.1}
  - {name: w2, type: steered, x: bx, y: by, heading: 0, r: 0.1}
"""
CAR = """\
wmrgen: 1
name: car
wheels:
  - {name: fi1, type: fixed, x: 0.1, y: -0.6, heading: 0, r: 0.1}
  - {name: fi2, type: fixed, x: 0.1, y: 0.6, heading: 0, r: 0.1}
  - {name: fr, type: steered, x: 2.5, y: -0.6, heading: 0, r: 0.1}
  - {name: fl, type: steered, x: 2.5, y: 0.6, heading: 0, r: 0.1}
"""
SKEWED = """\
wmrgen: 1
name: skewed
wheels:
  - {name: one, type: steered, x: 0.9, y: 0.35, heading: 20 deg, r: 0.1, offset_y: 0.04}
  - {name: two, type: steered, x: -0.4, y: -0.5, heading: -70 deg, r: 0.08}
  - {name: three, type: steered, x: 0.2, y: -0.65, heading: 0, r: 0.12}
  - {name: tail, type: castor, x: -0.5, y: 0.3, heading: 10 deg, d: 0.05, offset_y: 0.02, r: 0.05}
"""


@cache
def derived(text: str) -> Derivation:
    """The derivation of a robot file's text, of which nothing is generated."""
    return of_text(text, [])


def closed(text: str, function: str) -> dict[str, Expr]:
    """Output name -> expression in the inputs and tunable parameters."""
    return derived(text).formula(function).closed()


def sym(*names: str) -> list[Expr]:
    """Symbols of inputs by contract name."""
    return [signal(n) for n in names]


def par(*names: str) -> list[Expr]:
    """Symbols of parameters."""
    return [parameter(n) for n in names]


def vanishes(difference: Expr) -> bool:
    """True when an expression is identically zero."""
    return bool(sympy.simplify(sympy.expand_trig(sympy.expand(difference.doit()))) == 0)


def run_cli(*words: str, code: int = 0) -> tuple[str, str]:
    """(stdout, stderr) of a command in this process."""
    done = command_line(*words)
    assert done.code == code, (done.out, done.err)
    return done.out, done.err


def compute(
    path: Path, function: str, cases: Sequence[dict[str, float]], backend: str
) -> list[dict[str, float]]:
    """``wmrgen eval --cases`` on a backend; C in double."""
    file = path.parent / f"{path.stem}_{function}.json"
    file.write_text(json.dumps(cases), encoding="utf-8")
    out, _ = run_cli(
        "eval",
        os.fspath(path),
        function,
        "--cases",
        os.fspath(file),
        "--backend",
        backend,
        "--scalar",
        "double",
    )
    result: list[dict[str, float]] = json.loads(out)
    return result
