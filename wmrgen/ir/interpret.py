"""One interpreter over three arithmetics, exact, float64 and float32, in list order; and many points at once.

Exact values are elements of Q(√2, √3). A square root that leaves the field, a sine, a cosine and an arctangent are
rational numbers good to 60 digits; everything else is exact. The float arithmetics follow IEEE 754 and C99: a quotient
by zero is an infinity or NaN, never an exception. float32 operations are float64 operations rounded once more, which
for + - * / and sqrt is the correctly rounded float32 result (Figueroa 1995: 53 >= 2 * 24 + 2). In float32 and float64
the interpreter predicts generated C compiled with ``-ffp-contract=off`` bit for bit, library functions aside.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache
from operator import attrgetter
from typing import Any, NamedTuple

from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.calls import by_name, inlined
from wmrgen.ir.nodes import Function, Module, Op, Role
from wmrgen.ir.rounding import nearest_float32, to_float32, to_float64

Number = Exact | Fraction | int | float


class Arithmetic(NamedTuple):
    """How to compute: ``enter`` takes a number in, ``of`` says what an operation does to such numbers."""

    enter: Callable[[Any], Any]
    of: Callable[[Op], Callable[..., Any]]


def _exact(value: Number) -> Exact:
    return Exact(Fraction(value)) if isinstance(value, float) else Exact.of(value)


def _shortened(value: Exact, digits: int) -> Exact:
    """``value``, or its first ``digits`` digits where its denominator has more than twice as many."""
    longest = digits * 10 // 3  # in bits
    if value.den.bit_length() < 2 * longest:
        return value
    near = value.rational(digits)
    places = longest - near.numerator.bit_length() + near.denominator.bit_length()
    return (
        Exact(Fraction((near.numerator << places) // near.denominator, 1 << places)) if places > 0 else value
    )


def in_the_field(digits: int) -> Arithmetic:
    """Exact arithmetic, except that a number with more than twice as many digits keeps that many.

    The sine of an odd angle has 60 digits, and every product of such numbers is longer.
    """

    @cache
    def of(op: Op) -> Callable[..., Exact]:
        meaning = op.exact
        if meaning is None:
            raise KeyError(f"{op} is an operation of floats alone")
        return lambda *args: _shortened(meaning(*args), digits)

    return Arithmetic(_exact, of)


def _enter64(value: Number) -> float:
    return value if isinstance(value, float) else to_float64(Exact.of(value))


def _enter32(value: Number) -> float:
    return nearest_float32(value) if isinstance(value, float) else to_float32(Exact.of(value))


EXACT = in_the_field(2_000)  # 64 Swedish wheels at odd angles, all tunable, reach tens of thousands of digits
FLOAT64 = Arithmetic(_enter64, attrgetter("float64"))
FLOAT32 = Arithmetic(_enter32, attrgetter("float32"))


def evaluate_nodes(function: Function, inputs: Mapping[str, Number], arithmetic: Arithmetic) -> list[Any]:
    """The value of every node, in list order. Inputs left out take the default of their port.

    UsageError where an input has neither value nor default; ZeroDivisionError and ValueError (exact arithmetic only)
    where a quotient or a square root is undefined.
    """
    defaults = {port.name: port.default for port in function.inputs}
    of, enter = arithmetic.of, arithmetic.enter
    values: list[Any] = []
    for i, node in enumerate(function.nodes):
        if node.value is not None:
            values.append(enter(node.value))
        elif node.op is Op.INPUT:
            name = node.name or ""
            value = inputs.get(name, defaults.get(name))
            if value is None:
                raise UsageError(f"{function.name} needs a value for {name}")
            values.append(enter(value))
        else:
            try:
                values.append(of(node.op)(*[values[arg] for arg in node.args]))
            except (ZeroDivisionError, ValueError) as error:
                raise type(error)(f"{function.name}, node {i}: {error}") from None
    return values


def evaluate(function: Function, inputs: Mapping[str, Number], arithmetic: Arithmetic) -> dict[str, Any]:
    """Output name to value: `Exact` in exact arithmetic, float (a float32 as float) otherwise."""
    return function.outputs_of(evaluate_nodes(function, inputs, arithmetic))


def evaluate_module(
    module: Module, name: str, inputs: Mapping[str, Number], arithmetic: Arithmetic
) -> dict[str, Any]:
    """`evaluate` of the function called ``name``, without calls, after ``prepare`` where the module has one."""
    function = inlined(module.function(name), by_name(module.kernels))
    whole: dict[str, Number] = dict(inputs)
    if module.prepare is not None and any(port.role is Role.PREPARED for port in function.inputs):
        whole.update(evaluate(module.prepare, inputs, arithmetic))
    return evaluate(function, whole, arithmetic)


def values_of(function: Function, inputs: Mapping[str, Any], kind: Any) -> list[Any]:
    """Every node at many points at once, in NumPy's arithmetic of ``kind``: the last place may be another."""

    def enter(value: Any) -> Any:
        return kind(to_float64(value)) if isinstance(value, Exact) else value.astype(kind)

    return evaluate_nodes(function, inputs, Arithmetic(enter, attrgetter("many")))
