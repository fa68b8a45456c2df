"""Exact checks that a pass changed no output.

Both functions are evaluated over the field at pseudo-random rational points. A square root, sine,
cosine or arctangent is replaced by an opaque rational function of its exact arguments, the same
before and after, so that equality stays a matter of exact numbers. Opaque sines are odd, opaque
cosines even, opaque arctangents odd, roots in the field and values at zero true; no pass uses any other property.
Comparisons are made on the exact values.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

from wmrgen.exact.number import ONE, Exact, exact_sqrt
from wmrgen.ir.arithmetic import EXACT, Arithmetic
from wmrgen.ir.interpret import evaluate
from wmrgen.ir.nodes import Function, Module, Op
from wmrgen.ir.residues import RESIDUES, Residue

_MODULUS = 2**61 - 1


class PassError(AssertionError):
    """A pass changed the value of an output: a bug of wmrgen."""


def mix(*numbers: int) -> int:
    """A deterministic hash of integers, independent of the interpreter's own."""
    state = 0x2545F4914F6CDD1D
    for number in numbers:
        state = (state * 6364136223846793005 + number % _MODULUS + 1442695040888963407) % 2**64
        state ^= state >> 29
    return state


def _digest(value: Exact) -> tuple[int, ...]:
    return (*value.num, value.den)


def _opaque(salt: int) -> Callable[..., Exact]:
    """A rational number in [1/64, 4) decided by the arguments."""
    return lambda *args: Exact(Fraction(mix(salt, *(n for a in args for n in _digest(a))) % 255 + 1, 64))


_SQRT, _SIN, _COS, _ATAN2, _ATAN = (_opaque(salt) for salt in (1, 2, 3, 4, 5))


def _sqrt(a: Exact) -> Exact:
    root = exact_sqrt(a)  # as the builder folds constants
    return _SQRT(a) if root is None else root


def _sin(a: Exact) -> Exact:
    return a if not a else _SIN(a) if a.sign > 0 else -_SIN(-a)


def _atan(a: Exact) -> Exact:
    return a if not a else _ATAN(a) if a.sign > 0 else -_ATAN(-a)


def _cos(a: Exact) -> Exact:
    return _COS(abs(a)) if a else ONE


def _atan2(y: Exact, x: Exact) -> Exact:
    return y if not y and x.sign >= 0 else _ATAN2(y, x)


OPAQUE = Arithmetic(
    "opaque",
    EXACT.enter,
    {
        **EXACT.apply,
        Op.SQRT: _sqrt,
        Op.SIN: _sin,
        Op.COS: _cos,
        Op.ATAN: _atan,
        Op.ATAN2: _atan2,
    },
)


def points(function: Function, count: int) -> list[dict[str, Exact]]:
    """``count`` rational points of the inputs, which depend on their names alone."""
    names = [port.name for port in function.inputs]
    return [{name: _number(name, k) for name in names} for k in range(count)]


def _number(name: str, k: int) -> Exact:
    seed = mix(k, *name.encode())
    return Exact(Fraction(seed % 1999 - 999 or 7, 16 + (seed >> 32) % 5))


def verify_function(before: Function, after: Function, step: str, count: int = 2) -> None:
    """PassError unless both functions have the same outputs at ``count`` points."""
    for point in points(before, count):
        _compare(_values(before, point), _values(after, point), f"{step} of {before.name}")


def check_module(before: tuple[Function, ...], after: Module, step: str) -> None:
    """A quick `verify_module`: one point, residues modulo a prime. What differs there is decided exactly."""
    try:
        _check(before, after, step, 1, RESIDUES)
    except PassError:
        verify_module(before, after, step, 1)


def verify_module(before: tuple[Function, ...], after: Module, step: str, count: int = 2) -> None:
    """PassError unless the module's functions, after its `prepare`, have the outputs of ``before``."""
    _check(before, after, step, count, OPAQUE)


def _check(
    before: tuple[Function, ...], after: Module, step: str, count: int, arithmetic: Arithmetic
) -> None:
    prepared: dict[int, dict[str, Any]] = {}
    for function in before:
        for k, point in enumerate(points(function, count)):
            if after.prepare is not None and k not in prepared:
                prepared[k] = _prepared(after.prepare, k, arithmetic)
            whole = {**prepared.get(k, {}), **point}
            new = _values(after.function(function.name), whole, arithmetic)
            _compare(_values(function, point, arithmetic), new, f"{step} of {function.name}")


def _prepared(prepare: Function, k: int, arithmetic: Arithmetic) -> dict[str, Any]:
    point = {port.name: _number(port.name, k) for port in prepare.inputs}
    return evaluate(prepare, point, arithmetic)


def _values(
    function: Function, point: dict[str, Any], arithmetic: Arithmetic = OPAQUE
) -> dict[str, Any] | None:
    """The outputs, None where the point is outside the domain."""
    try:
        return evaluate(function, point, arithmetic)
    except ZeroDivisionError:
        return None


def _compare(before: dict[str, Any] | None, after: dict[str, Any] | None, step: str) -> None:
    if before is None:
        return
    if after is None:
        raise PassError(f"{step}: defined before, undefined after")
    for name, value in before.items():
        if _identity(after.get(name)) != _identity(value):
            raise PassError(f"{step}: {name} was {value} and is {after.get(name)}")


def _identity(value: Any) -> Any:
    """What equality is decided on: the exact value, or the residue without its size."""
    return value.r if isinstance(value, Residue) else value
