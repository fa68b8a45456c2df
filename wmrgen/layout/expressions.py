"""Expression trees of the robot file to exact polynomials in the parameters."""

from __future__ import annotations

from collections.abc import Mapping

from wmrgen.errors import Mark, RobotFileError
from wmrgen.exact.evaluate import cos_sin, number, sqrt_poly
from wmrgen.exact.number import Exact
from wmrgen.exact.poly import Poly
from wmrgen.spec.records import Binary, Call, Expr, Neg, Num, Param, Pi, Quantity

PI = Poly.gen("pi")


def to_poly(quantity: Quantity, values: Mapping[str, Poly]) -> Poly:
    """The quantity as a polynomial in its parameters. ``values`` decide signs and zeros.

    RobotFileError at the quantity's place for a division by zero or the root of a negative number.
    """
    return _convert(quantity.expr, values, quantity.mark)


def _convert(expr: Expr, values: Mapping[str, Poly], mark: Mark) -> Poly:
    match expr:
        case Num(value):
            return Poly.of(value)
        case Pi():
            return PI
        case Param(name):
            return Poly.gen("param", name)
        case Neg(arg):
            return -_convert(arg, values, mark)
        case Binary(op, left, right):
            return _binary(op, _convert(left, values, mark), right, values, mark)
        case Call(function, args):
            return _call(function, [_convert(a, values, mark) for a in args], values, mark)
    raise TypeError(f"not an expression: {expr!r}")


def _binary(op: str, left: Poly, right: Expr, values: Mapping[str, Poly], mark: Mark) -> Poly:
    if op == "**":
        exponent = _convert(right, values, mark).constant
        power = int(exponent.parts[0]) if exponent is not None else 0
        if power < 0:
            _nonzero(left, values, mark)
        return left**power
    b = _convert(right, values, mark)
    match op:
        case "+":
            return left + b
        case "-":
            return left - b
        case "*":
            return left * b
        case "/":
            _nonzero(b, values, mark)
            return left * b.inverse()
    raise ValueError(op)


def _call(function: str, args: list[Poly], values: Mapping[str, Poly], mark: Mark) -> Poly:
    match function:
        case "sqrt":
            if number(args[0], values).sign < 0:
                raise RobotFileError(
                    "square root of a negative number",
                    mark,
                    "What stands under the root is negative at the nominal parameters.",
                    "Change the expression or the parameters that it takes.",
                )
            return sqrt_poly(args[0])
        case "sin":
            return cos_sin(args[0])[1]
        case "cos":
            return cos_sin(args[0])[0]
        case "tan":
            c, s = cos_sin(args[0])
            _nonzero(c, values, mark)
            return s * c.inverse()
        case "atan2":
            if not number(args[0], values) and not number(args[1], values):
                raise RobotFileError(
                    "atan2(0, 0) has no value", mark, "", "Give a direction other than zero."
                )
            return Poly.gen("atan2", "", *args)
    raise ValueError(function)


def _nonzero(divisor: Poly, values: Mapping[str, Poly], mark: Mark) -> None:
    if not number(divisor, values):
        raise RobotFileError(
            "division by zero",
            mark,
            "The divisor is zero at the nominal parameters.",
            "Change the expression or the parameters that it takes.",
        )


def evaluate(quantity: Quantity, values: Mapping[str, Poly]) -> Exact:
    """The number that the quantity is worth at the nominal parameters."""
    return number(to_poly(quantity, values), values)
