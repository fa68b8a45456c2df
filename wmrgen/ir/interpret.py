"""One interpreter for three arithmetics (exact, float64, float32) in list order, and for many points at once.

Exact values are elements of Q(√2, √3). Square roots that are not in the field, sines, cosines and arctangents are
rational numbers to 60 digits; all other operations are exact. The float arithmetics follow IEEE 754 and C99: a quotient
by zero is an infinity or NaN, and raises no exception. float32 operations are float64 operations that are rounded once
more. For + - * / and sqrt that is the correctly rounded float32 result (Figueroa 1995: 53 >= 2 * 24 + 2). So the
interpreter predicts generated C compiled with ``-ffp-contract=off`` bit for bit, except for library functions.
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
    """A kind of numbers to compute with."""

    enter: Callable[[Any], Any]  # converts a number into this kind
    of: Callable[[Op], Callable[..., Any]]  # returns the function that an operation is for this kind


def _exact(value: Number) -> Exact:
    return Exact(Fraction(value)) if isinstance(value, float) else Exact.of(value)


def _shortened(value: Exact, digits: int) -> Exact:
    """Return ``value``, rounded to ``digits`` digits if its denominator has more than twice as many."""
    longest = digits * 10 // 3  # in bits
    if value.den.bit_length() < 2 * longest:
        return value
    near = value.rational(digits)
    places = longest - near.numerator.bit_length() + near.denominator.bit_length()
    return (
        Exact(Fraction((near.numerator << places) // near.denominator, 1 << places)) if places > 0 else value
    )


def in_the_field(digits: int) -> Arithmetic:
    """Return exact arithmetic in which numbers of more than 2 * ``digits`` digits are rounded to ``digits``.

    Without a limit numbers grow: the sine of an arbitrary angle has 60 digits, and each product has more.
    """

    @cache
    def of(op: Op) -> Callable[..., Exact]:
        meaning = op.exact
        if meaning is None:
            raise KeyError(f"operation {op} is defined for floats only")
        return lambda *args: _shortened(meaning(*args), digits)

    return Arithmetic(_exact, of)


def _enter64(value: Number) -> float:
    return value if isinstance(value, float) else to_float64(Exact.of(value))


def _enter32(value: Number) -> float:
    return nearest_float32(value) if isinstance(value, float) else to_float32(Exact.of(value))


# Without the limit, 64 tunable Swedish wheels at arbitrary angles reach tens of thousands of digits.
EXACT = in_the_field(2_000)
FLOAT64 = Arithmetic(_enter64, attrgetter("float64"))
FLOAT32 = Arithmetic(_enter32, attrgetter("float32"))


def evaluate_nodes(function: Function, inputs: Mapping[str, Number], arithmetic: Arithmetic) -> list[Any]:
    """Return the value of every node, in list order.

    Args:
        function: the function.
        inputs: values by input name; an input that is left out takes the default of its port.
        arithmetic: what to compute with.

    Raises:
        UsageError: an input has neither value nor default.
        ZeroDivisionError, ValueError: a quotient or a square root is undefined (exact arithmetic only).
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
    """Return the outputs by name.

    Args:
        function: the function.
        inputs: values by input name, see `evaluate_nodes`.
        arithmetic: what to compute with.

    Returns:
        `Exact` in exact arithmetic, otherwise float (a float32 as float).
    """
    return function.outputs_of(evaluate_nodes(function, inputs, arithmetic))


def evaluate_module(
    module: Module, name: str, inputs: Mapping[str, Number], arithmetic: Arithmetic
) -> dict[str, Any]:
    """Return the outputs of a function of a module, after `prepare` if the module has one.

    Args:
        module: the module.
        name: the function's name.
        inputs: values by input name, tunable parameters included.
        arithmetic: what to compute with.

    Returns:
        The outputs by name, see `evaluate`.
    """
    function = inlined(module.function(name), by_name(module.kernels))
    whole: dict[str, Number] = dict(inputs)
    if module.prepare is not None and any(port.role is Role.PREPARED for port in function.inputs):
        whole.update(evaluate(module.prepare, inputs, arithmetic))
    return evaluate(function, whole, arithmetic)


def values_of(function: Function, inputs: Mapping[str, Any], kind: Any) -> list[Any]:
    """Return the values of every node at many points at once.

    Args:
        function: the function.
        inputs: arrays by input name, one value per point.
        kind: np.float32 or np.float64. Library functions are NumPy's, so that their last digit may differ.

    Returns:
        By node an array over the points, or one number for a constant.
    """

    def enter(value: Any) -> Any:
        return kind(to_float64(value)) if isinstance(value, Exact) else value.astype(kind)

    return evaluate_nodes(function, inputs, Arithmetic(enter, attrgetter("many")))
