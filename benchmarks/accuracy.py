"""Rounding errors of the generated C against 66 digits, in ulp of the sum of the terms' magnitudes.

The sum of magnitudes (`benchmarks.magnitudes`) is what the formula adds up, signs aside: rounding is measured against
it, not against a result in which terms cancel. A sine or cosine counts 1: what it turns counts with its length.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath

import wmrgen
from benchmarks.counts import ROOT
from benchmarks.magnitudes import magnitudes, ulps
from benchmarks.singularity import HEADING, NEAR, SPEED, TARGETS, nearby
from wmrgen.codegen.c import evaluate
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import Arithmetic, Number, evaluate_nodes
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import Function, Module, Op, Role
from wmrgen.ir.rounding import nearest_float32

DIGITS = 66
LARGEST_STEER = 100.0  # rad
LINEAR, STEERED = 2.5, 4.5  # ulp
ROBOTS = (
    "textbook_differential", "clearpath_do100", "lekiwi", "ssl_parsian", "wpilib_swervebot", "agilex_ranger",
    "care_o_bot_4", "nomad_xr4000", "ackermann_car", "kelly_4ws", "textbook_tricycle",
)  # fmt: skip
Values = dict[str, float]


def _entered(x: Number) -> Any:
    return mpmath.mpf(x) if isinstance(x, float) else _rational(x)


@cache
def _rational(x: Exact | Fraction) -> Any:
    """Return a number with `DIGITS` digits, the precision of this module."""
    q = x.rational(DIGITS + 4) if isinstance(x, Exact) else x
    return mpmath.mpf(q.numerator) / q.denominator


def _atan2(y: Any, x: Any) -> Any:
    return mpmath.atan2(y, x) if x or y else mpmath.mpf(0)


REFERENCE = Arithmetic(
    _entered,
    {
        Op.ADD: lambda a, b: a + b, Op.SUB: lambda a, b: a - b, Op.MUL: lambda a, b: a * b,
        Op.DIV: lambda a, b: a / b, Op.NEG: lambda a: -a, Op.ABS: abs, Op.SQRT: mpmath.sqrt,
        Op.MIN: lambda a, b: a if a < b else b, Op.MAX: lambda a, b: b if a < b else a,
        Op.SIN: mpmath.sin, Op.COS: mpmath.cos, Op.ATAN: mpmath.atan, Op.ATAN2: _atan2, Op.RINT: mpmath.nint,
        Op.FLIP: lambda a, n: -a if int(n) % 2 else a, Op.SELECT: lambda a, b, x, y: x if a < b else y,
        Op.COMPENSATED: lambda a, b: a + b,
        Op.CLAMP: lambda a, m: min(max(a, -m), m), Op.WITH_SIGN_OF: lambda a, b: -a if b < 0 else a,
        Op.AT_LEAST: lambda a, m: a if abs(a) >= m else -m if a < 0 else m,
    }.__getitem__,
)  # fmt: skip


@dataclass
class Worst:
    """The largest error of a function, its output and inputs; ``other``: cases on the other branch of a tie."""

    ulp: float = 0.0
    output: str = ""
    case: Values | None = None
    cases: int = 0
    other: int = 0


def inputs(function: Function, source: random.Random) -> Values:
    """Return random inputs in float32: rates and speeds up to 4, steering angles up to `LARGEST_STEER`."""
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
    """Return the worst error of the function ``name`` of ``module`` against ``reference`` over ``cases``."""
    name = name or reference.name
    requests = [(name, case) for case in cases]
    computed = evaluate(module, requests) if compute is None else compute(module, name, cases)
    worst = Worst(cases=len(cases))
    units = [ulps(size) for size in magnitudes(reference, cases)]
    with mpmath.workdps(DIGITS):
        for k, (case, outputs) in enumerate(zip(cases, computed, strict=True)):
            unit = {p.name: float(u[k]) for p, u in zip(reference.outputs, units, strict=True)}
            _compare(reference, case, outputs, unit, worst)
    return worst


def _compare(
    reference: Function, case: Values, outputs: Mapping[str, float], unit: Mapping[str, float], worst: Worst
) -> None:
    values = evaluate_nodes(reference, case, REFERENCE)
    wanted = {p.name: values[i] for p, i in zip(reference.outputs, reference.results, strict=True)}
    flipped = {
        key.removesuffix(".steer")
        for key in outputs
        if key.endswith(".steer") and abs(outputs[key] - float(wanted[key])) > 1.0
    }
    worst.other += bool(flipped)
    for key, value in outputs.items():
        if key.split(".")[0] in flipped or (key == "slip" and flipped):
            continue
        error = float(abs(mpmath.mpf(value) - wanted[key])) / unit[key]
        if error > worst.ulp:
            worst.ulp, worst.output, worst.case = error, key, case


def precise(name: str) -> Derivation:
    """A robot of the gallery that asks for `precise`: without it headings with the centre of rotation near a pivot are
    those of a pivot a hair away, see `benchmarks.singularity`."""
    text = (ROOT / "robots" / f"{name}.yaml").read_text(encoding="utf-8")
    return wmrgen.derive(wmrgen.load(f"{text}\nprecise: true\n"))


def robot(name: str, count: int) -> Iterator[tuple[str, Worst]]:
    """Return inverse and forward of a robot of the gallery, at nominal parameters."""
    derivation = precise(name)
    module = derivation.c_module
    for function in ("inverse", "forward"):
        reference = derivation.raw_module.function(function)
        source = random.Random(f"{name} {function}")
        yield function, measure(reference, module, [inputs(reference, source) for _ in range(count)])


def limit(reference: Function) -> float:
    """Return the largest error allowed; it is larger for steered wheels."""
    return STEERED if any(p.name.endswith(".steer") for p in reference.inputs) else LINEAR


def _rows(job: tuple[str, int]) -> list[str]:
    name, count = job
    functions = precise(name).raw_module
    return [
        f"| {name} | {function} | {worst.ulp:.2f} | {limit(functions.function(function))} "
        f"| {worst.output} | {worst.other} |"
        for function, worst in robot(name, count)
    ]


def table(total: int = 100_000) -> Iterator[str]:
    """Yield the worst errors of the generated C over ``total`` inputs, then those near singularities."""
    each = -(-total // (2 * len(ROBOTS)))
    yield f"Worst error of the float C ({DEFAULT.math}, {DEFAULT.target}) in ulp of the sum of the terms' magnitudes,"
    yield "of robots with `precise: true`."
    yield f"{each} inputs per function against {DIGITS} digits, steering angles up to +-{LARGEST_STEER:g} rad."
    yield "Other branch: inputs so near a tie of two steering angles that float and exact formula choose differently."
    yield ""
    yield "| robot | function | worst [ulp] | at most | output | other branch |"
    yield "|---|---|---:|---:|---|---:|"
    with ProcessPoolExecutor() as pool:
        for rows in pool.map(_rows, [(name, each) for name in ROBOTS]):
            yield from rows
        yield ""
        yield f"Steered wheels with the centre of rotation 1e-8 m to 1 m away, {NEAR} twists per target:"
        yield ""
        yield "| target | heading [rad] | at most | speed [ulp] | at most |"
        yield "|---|---:|---:|---:|---:|"
        for target, (heading, speed) in zip(TARGETS, pool.map(nearby, TARGETS), strict=True):
            yield f"| {target} | {heading:.1e} | {HEADING:.0e} | {speed:.2f} | {SPEED:g} |"
