"""Rounding errors of the generated C against 66 digits, in ulp of the sum of the terms' magnitudes.

The sum of magnitudes is what the formula adds up, signs aside: rounding is measured against it, not against a result
in which terms cancel. A sine or cosine counts 1: what it turns counts with its length.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath

import wmrgen
from benchmarks.counts import ROOT
from wmrgen.backends.c99 import evaluate
from wmrgen.exact.number import Exact
from wmrgen.ir.arithmetic import Arithmetic, Number
from wmrgen.ir.interpret import evaluate_nodes
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Function, Module, Node, Op, Role
from wmrgen.ir.rounding import nearest_float32

DIGITS = 66
LARGEST_STEER = 100.0  # rad
ROBOTS = (
    "textbook_differential", "clearpath_do100", "lekiwi", "ssl_parsian", "wpilib_swervebot", "agilex_ranger",
    "care_o_bot_4", "nomad_xr4000", "ackermann_car", "kelly_4ws", "textbook_tricycle",
)  # fmt: skip
Values = dict[str, float]


def _rational(x: Number) -> Any:
    if isinstance(x, float):
        return mpmath.mpf(x)
    q = x.rational(DIGITS + 4) if isinstance(x, Exact) else x
    return mpmath.mpf(q.numerator) / q.denominator


def _atan2(y: Any, x: Any) -> Any:
    return mpmath.atan2(y, x) if x or y else mpmath.mpf(0)


REFERENCE = Arithmetic(
    "66 digits",
    _rational,
    {
        Op.ADD: lambda a, b: a + b, Op.SUB: lambda a, b: a - b, Op.MUL: lambda a, b: a * b,
        Op.DIV: lambda a, b: a / b, Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: mpmath.sqrt,
        Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
        Op.SIN: mpmath.sin, Op.COS: mpmath.cos, Op.ATAN: mpmath.atan, Op.ATAN2: _atan2, Op.RINT: mpmath.nint,
        Op.FLIP: lambda a, n: -a if int(n) % 2 else a, Op.SELECT: lambda a, b, x, y: x if a < b else y,
    },
)  # fmt: skip


def magnitudes(function: Function, values: Sequence[Any]) -> list[float]:
    """For each node the sum of what it adds up, without signs."""
    found: list[float] = []
    for node, value in zip(function.nodes, values, strict=True):
        found.append(_magnitude(node, float(value), found, values))
    return found


def _magnitude(node: Node, value: float, known: list[float], values: Sequence[Any]) -> float:
    args = [known[a] for a in node.args]
    match node.op:
        case Op.ADD | Op.SUB:
            return args[0] + args[1]
        case Op.MUL:
            return args[0] * args[1]
        case Op.DIV:
            return args[0] / abs(float(values[node.args[1]]))
        case Op.NEG | Op.ABS:
            return args[0]
        case Op.FLIP:
            return args[0]
        case Op.SQRT:
            return math.sqrt(args[0])
        case Op.SIN | Op.COS:
            return 1.0
        case Op.SELECT:
            return args[2] if values[node.args[0]] < values[node.args[1]] else args[3]
        case Op.MIN | Op.MAX:
            return max(args)
        case _:
            return abs(value)


@dataclass
class Worst:
    """The largest error of a function, its output and inputs; ``other``: cases on the other branch of a tie."""

    ulp: float = 0.0
    output: str = ""
    case: Values | None = None
    cases: int = 0
    other: int = 0


def inputs(function: Function, source: random.Random) -> Values:
    """Rates and speeds up to 4, steering angles up to `LARGEST_STEER`; float32 values."""
    values = {}
    for port in function.inputs:
        if port.role is not Role.PREPARED and port.default is None:
            largest = source.choice((3.2, LARGEST_STEER)) if port.name.endswith(".steer") else 4.0
            values[port.name] = nearest_float32(source.uniform(-largest, largest))
    return values


def measure(
    reference: Function,
    module: Module,
    cases: Sequence[Values],
    name: str = "",
    compute: Callable[[Module, str, Sequence[Values]], list[Values]] | None = None,
) -> Worst:
    """The worst error of function ``name`` of ``module`` against ``reference`` over ``cases``."""
    name = name or reference.name
    found = evaluate(module, name, cases) if compute is None else compute(module, name, cases)
    worst = Worst(cases=len(cases))
    with mpmath.workdps(DIGITS):
        for case, outputs in zip(cases, found, strict=True):
            _compare(reference, case, outputs, worst)
    return worst


def _compare(reference: Function, case: Values, outputs: Mapping[str, float], worst: Worst) -> None:
    values = evaluate_nodes(reference, case, REFERENCE)
    sizes = magnitudes(reference, values)
    wanted = {p.name: i for p, i in zip(reference.outputs, reference.results, strict=True)}
    flipped = {
        key.removesuffix(".steer")
        for key in outputs
        if key.endswith(".steer") and abs(outputs[key] - float(values[wanted[key]])) > 1.0
    }
    worst.other += bool(flipped)
    for key, value in outputs.items():
        i = wanted[key]
        if key.split(".")[0] in flipped or (key == "slip" and flipped):
            continue
        error = float(abs(mpmath.mpf(value) - values[i]))
        ulp = math.ldexp(1.0, max(math.frexp(sizes[i])[1], -125) - 24)
        if error / ulp > worst.ulp:
            worst.ulp, worst.output, worst.case = error / ulp, key, case


def robot(name: str, count: int) -> Iterator[tuple[str, Worst]]:
    """Inverse and forward of a robot of the gallery, tunable parameters nominal."""
    derivation = wmrgen.derive(wmrgen.load(ROOT / "robots" / f"{name}.yaml"))
    module = derivation.c_module
    for function in ("inverse", "forward"):
        reference = derivation.raw_module.function(function)
        source = random.Random(f"{name} {function}")
        yield function, measure(reference, module, [inputs(reference, source) for _ in range(count)])


def table(total: int = 100_000) -> Iterator[str]:
    """The worst errors over ``total`` inputs, in the C that derive writes."""
    each = total // (2 * len(ROBOTS))
    yield f"Worst error of the float C ({DEFAULT.math}, {DEFAULT.target}) in ulp of the sum of the terms' magnitudes,"
    yield f"{each} inputs per function, steering angles up to +-{LARGEST_STEER:g} rad."
    yield ""
    yield "| robot | function | worst [ulp] | output |"
    yield "|---|---|---:|---|"
    for name in ROBOTS:
        for function, worst in robot(name, each):
            yield f"| {name} | {function} | {worst.ulp:.2f} | {worst.output} |"
