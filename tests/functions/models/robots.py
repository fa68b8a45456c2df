"""Robot files of the texts' systems, parameters named as in the texts, and functions on every backend."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import Any

import sympy

from tests.robots import of_text, with_functions
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.symbolic import parameter, signal

UNICYCLE = "{name: wheel, type: fixed, x: 0, y: 0, heading: 0, r: r}"
DIFFERENTIAL = """{name: right, type: fixed, x: b, y: -a, heading: 0, r: r}
{name: left, type: fixed, x: b, y: a, heading: 0, r: r}"""
REAR = "{name: rear, type: fixed, x: 0, y: 0, heading: 0, r: r%s}"
FRONT = "{name: front, type: steered, x: base, y: 0, heading: 0, r: r, actuated: [%s]}"
CAR_REAR = f"{REAR % ''}\n{FRONT % 'steer'}"
CAR_FRONT = f"{REAR % ', actuated: []'}\n{FRONT % 'spin, steer'}"
TRICYCLE = f"""{{name: rear_left, type: fixed, x: 0, y: a, heading: 0, r: r, actuated: []}}
{{name: rear_right, type: fixed, x: 0, y: -a, heading: 0, r: r, actuated: []}}
{FRONT % "spin, steer"}"""
FOUR = """{{name: rear_left, type: fixed, x: 0, y: a, heading: 0, r: r, actuated: [{rear}]}}
{{name: rear_right, type: fixed, x: 0, y: -a, heading: 0, r: r, actuated: [{rear}]}}
{{name: front_left, type: steered, x: base, y: a, heading: 0, r: r, actuated: [{front}]}}
{{name: front_right, type: steered, x: base, y: -a, heading: 0, r: r, actuated: [{front}]}}"""
FOUR_REAR = FOUR.format(rear="spin", front="steer")
FOUR_FRONT = FOUR.format(rear="", front="spin, steer")
TWO_STEER = """{name: front, type: steered, x: base, y: 0, heading: 0, r: r}
{name: rear, type: steered, x: -base, y: 0, heading: 0, r: r}"""
STEERS = "virtual: [{name: psi, steers: [front_left, front_right]}%s]"
VIRTUAL_REAR = STEERS % ", {name: rear, drives: [rear_left, rear_right]}"
VIRTUAL_FRONT = STEERS % ", {name: drive, drives: [front_left, front_right]}"
OMNI = """{name: w1, type: swedish, l: a, alpha: -pi/2, beta: pi, gamma: 0, r: r}
{name: w2, type: swedish, l: a, alpha: pi/6, beta: pi, gamma: 0, r: r}
{name: w3, type: swedish, l: a, alpha: 5*pi/6, beta: pi, gamma: 0, r: r}"""
VALUES = {
    "base": "1.4",
    "a": "0.27",
    "b": "0",
    "r": "0.11",
    "l1": "1.1",
    "l2": "0.9",
    "l3": "0.7",
    "h": "0.2",
}


def on_axle(count: int) -> str:
    """The key ``trailers`` with so many, coupled on the axle in front."""
    return "trailers: [" + ", ".join(f"{{length: l{k + 1}}}" for k in range(count)) + "]"


@cache
def derived(wheels: str, extra: str = "", **values: str) -> Derivation:
    """The derivation of a robot file with these wheels; only parameters that occur are in it."""
    used = {k: v for k, v in (VALUES | values).items() if _occurs(k, wheels + extra)}
    listed = ", ".join(f"{k}: {v}" for k, v in used.items())
    items = "\n".join(f"  - {line}" for line in wheels.splitlines())
    text = (
        f"wmrgen: 1\nname: sample\n{f'parameters: {{{listed}}}' if used else ''}\nwheels:\n{items}\n{extra}\n"
    )
    return of_text(text)


def _occurs(name: str, text: str) -> bool:
    words = "".join(c if c.isalnum() or c == "_" else " " for c in text).split()
    keys = {"r", "l"} & {name}
    return words.count(name) > (text.count(f"{name}:") if keys else 0)


def p(name: str) -> Any:
    """A named parameter."""
    return parameter(name)


def s(name: str) -> Any:
    """A state or an input."""
    return signal(name)


def zero(expr: Any) -> bool:
    """True where an expression is identically 0: as a rational function of half-angle tangents, else by simplify."""
    expr = sympy.expand_trig(evaluated(expr).replace(sympy.tan, lambda a: sympy.sin(a) / sympy.cos(a)))
    angles = sorted({f.args[0] for f in expr.atoms(sympy.sin, sympy.cos)}, key=str)
    if not all(a.is_Symbol for a in angles):
        return bool(sympy.simplify(expr) == 0)
    table: dict[Any, Any] = {}
    for k, a in enumerate(angles):
        t = sympy.Symbol(f"half{k}")
        table |= {sympy.cos(a): (1 - t**2) / (1 + t**2), sympy.sin(a): 2 * t / (1 + t**2)}
    return bool(sympy.numer(sympy.together(expr.xreplace(table))).expand() == 0)


def evaluated(expr: Any) -> Any:
    """The expression with every sum and product evaluated."""
    return expr.func(*(evaluated(a) for a in expr.args)) if expr.args else expr


def same(actual: Any, expected: Any) -> None:
    """Two matrices agree identically."""
    difference = sympy.Matrix(actual) - sympy.Matrix(expected)
    assert all(zero(e) for e in difference), difference


def call(
    d: Derivation, function: str, values: Mapping[str, float], backend: str = "casadi"
) -> dict[str, float]:
    """A function of a robot on a backend; inputs left out are 0, parameters nominal."""
    one = _only(d, function)
    ports = one.raw_module.function(function).inputs
    unknown = values.keys() - {port.name for port in ports}
    assert not unknown, f"{function} has no input {sorted(unknown)}"
    if backend == "exact":
        numbers = {k: Exact(Fraction(v)) for k, v in values.items()}
        return {k: float(v) for k, v in one.evaluate(function, numbers).items()}
    full = {port.name: float(values.get(port.name, port.default or 0)) for port in ports}
    if backend == "casadi":
        f = _in_casadi(d, function)
        outputs = f.call([full[name] for name in f.name_in()])
        return {name: float(v) for name, v in zip(f.name_out(), outputs, strict=True)}
    from wmrgen.codegen.c import evaluate

    name = "forward_slip" if function == "forward" else function
    return dict(evaluate(one.c_module, [(name, full)], scalar="double")[0])


@cache
def _only(d: Derivation, function: str) -> Derivation:
    return with_functions(d, [function])


@cache
def _in_casadi(d: Derivation, function: str) -> Any:
    return _only(d, function).casadi()[function]
