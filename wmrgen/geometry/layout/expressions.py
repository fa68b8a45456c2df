"""Convert expressions of the robot file to exact polynomials in the parameters, and snap angles to multiples of pi/12.

A heading of 1.57 instead of pi/2 would make a differential drive a robot that cannot move. An angle within `TOLERANCE`
of a multiple of pi/12 is therefore replaced by that multiple, and a note reports it. An angle within `SUSPICIOUS` is
kept, and a note reports that too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from fractions import Fraction
from operator import add, mul, sub
from typing import Any, NamedTuple

from wmrgen.errors import Code, ErrorCollector, Mark, RobotFileError
from wmrgen.geometry.exact.evaluate import (
    angle_value,
    cos_sin,
    fix,
    number,
    parameters_in,
    pi_multiple,
    pi_rational,
    sqrt_poly,
)
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.layout.records import Length
from wmrgen.robotfile.records import Binary, Call, Expr, Neg, Num, Param, Pi, Quantity, WheelSpec

PI = Poly.gen("pi")
TOLERANCE = Fraction(1, 500)  # [rad] covers angles that are written with three decimals
# [rad] a note reports that an angle this close to a multiple of pi/12 is not snapped.
SUSPICIOUS = Fraction(1, 200)
_SAME = Fraction(1, 10**35)  # [rad] differences below the 40 digits of rounded angles, which need no note
LARGEST = 10**36  # SI units: above the largest number that the file format allows, in its largest unit
_OPERATORS: dict[str, Callable[[Poly, Poly], Poly]] = {"+": add, "-": sub, "*": mul}
_ELSE = "Change the expression or the parameters that it takes."


class Scope(NamedTuple):
    """The parameters that quantities of a robot file may use."""

    values: Mapping[str, Poly]  # nominal values of all parameters
    constants: Mapping[str, Poly]  # values of those that are not tunable, as polynomials in the tunable ones

    def poly(self, quantity: Quantity | None) -> Poly:
        """Return the quantity as a polynomial in its parameters, or 0 if it is not given.

        Raises:
            RobotFileError: If the quantity has no value at the nominal parameters, such as for a division by zero.
        """
        return Poly({}) if quantity is None else to_poly(quantity, self.values)

    def number(self, symbolic: Poly) -> Exact:
        """Return the value of the polynomial at the nominal parameters."""
        return number(symbolic, self.values)

    def views(self, symbolic: Poly) -> Length:
        """Return the polynomial in its three views: symbolic, working and nominal."""
        return Length(symbolic, fix(symbolic, self.constants), self.number(symbolic))

    def length(self, quantity: Quantity | None) -> Length:
        """Return the quantity in its three views: symbolic, working and nominal."""
        return self.views(self.poly(quantity))


def computable(w: WheelSpec, scope: Scope, collector: ErrorCollector) -> WheelSpec:
    """Return a wheel without the quantities that have no value.

    Args:
        w: The wheel in the robot file.
        scope: The parameters of the robot file.
        collector: Collects an error for each quantity without a value.

    Returns:
        The wheel with None for these quantities.
    """
    without: dict[str, Any] = {}
    for field in fields(w):
        value = getattr(w, field.name)
        try:
            scope.number(scope.poly(value if isinstance(value, Quantity) else None))
        except RobotFileError as error:
            collector.add(error)
            without[field.name] = None
    return replace(w, **without)


def to_poly(quantity: Quantity, values: Mapping[str, Poly]) -> Poly:
    """Return the quantity as a polynomial in its parameters.

    Raise RobotFileError if it has no value when the parameters have ``values``, or one above `LARGEST`.
    """
    poly = _Conversion(values, quantity.mark).poly(quantity.expr)
    if abs(number(poly, values).rational()) > LARGEST:
        raise RobotFileError(
            "a value above 1e36", quantity.mark, "No quantity of a robot is so large.", _ELSE
        )
    return poly


def evaluate(quantity: Quantity, values: Mapping[str, Poly]) -> Exact:
    """Return the value of the quantity at the nominal parameters."""
    return number(to_poly(quantity, values), values)


class _Conversion(NamedTuple):
    """The conversion of one quantity to a polynomial."""

    values: Mapping[str, Poly]  # nominal values of the parameters
    mark: Mark  # place of the quantity in the robot file

    def poly(self, expr: Expr) -> Poly:
        match expr:
            case Num(value):
                return Poly.of(value)
            case Pi():
                return PI
            case Param(name):
                if name not in self.values:
                    raise RobotFileError(f"{name} has no value", self.mark, code=Code.CONSEQUENCE)
                return Poly.gen("param", name)
            case Neg(arg):
                return -self.poly(arg)
            case Binary("**", base, Num(power)):
                left = self.poly(base)
                return (left if power >= 0 else self._divisor(left)) ** int(power)
            case Binary("/", above, below):
                return self.poly(above) * self._divisor(self.poly(below)).inverse()
            case Binary(op, first, second):
                return _OPERATORS[op](self.poly(first), self.poly(second))
            case Call(function, args):
                return self._call(function, [self.poly(a) for a in args])
        raise TypeError(f"not an expression: {expr!r}")

    def _call(self, function: str, args: list[Poly]) -> Poly:
        match function:
            case "sqrt":
                if number(args[0], self.values).sign < 0:
                    raise RobotFileError(
                        "square root of a negative number", self.mark,
                        "The argument of the root is negative at the nominal parameters.", _ELSE,
                    )  # fmt: skip
                return sqrt_poly(args[0])
            case "sin":
                return cos_sin(args[0])[1]
            case "cos":
                return cos_sin(args[0])[0]
            case "tan":
                c, s = cos_sin(args[0])
                return s * self._divisor(c).inverse()
            case "atan2":
                if not any(number(a, self.values) for a in args):
                    raise RobotFileError(
                        "atan2(0, 0) has no value", self.mark, "", "Give a direction other than zero."
                    )
                return Poly.gen("atan2", "", *args)
        raise ValueError(function)

    def _divisor(self, poly: Poly) -> Poly:
        if not number(poly, self.values):
            raise RobotFileError(
                "division by zero", self.mark, "The divisor is zero at the nominal parameters.", _ELSE
            )
        return poly


def snap(
    angle: Poly, values: Mapping[str, Poly], tunable: frozenset[str], what: str
) -> tuple[Poly, str | None]:
    """Snap an angle to a multiple of pi/12 if it is within `TOLERANCE` of one.

    Args:
        angle: The angle [rad]. It is not snapped if it depends on a tunable parameter.
        values: The nominal values of the parameters.
        tunable: The names of the tunable parameters.
        what: The wheel and the key of the angle, for the note.

    Returns:
        The angle, and a note if it was snapped or nearly so.
    """
    if parameters_in(angle) & tunable:
        return angle, None
    exact = pi_multiple(angle_value(angle, values))
    if exact is not None and (12 * exact).denominator == 1:
        return angle, None
    value = number(angle, values).rational()
    step = pi_rational() / 12
    k = round(value / step)
    error = abs(value - k * step)
    if error >= SUSPICIOUS:
        return angle, None
    if error >= TOLERANCE:
        note = f"{what}: {float(value):.12g} rad is {float(error):.2g} rad from {twelfths_of_pi(k)}, kept as written"
        return angle, note
    note = f"{what}: {float(value):.12g} rad is taken as {twelfths_of_pi(k)} ({float(error):.2g} rad away)"
    return PI.scale(Fraction(k, 12)), None if error < _SAME else note


def twelfths_of_pi(k: int) -> str:
    """Return k pi/12 in the notation of robot files: pi/2, -3*pi/4, 0."""
    return multiple_of_pi(Fraction(k, 12))


def multiple_of_pi(f: Fraction) -> str:
    """Return f pi in the notation of robot files."""
    if not f:
        return "0"
    head = {1: "pi", -1: "-pi"}.get(f.numerator, f"{f.numerator}*pi")
    return head if f.denominator == 1 else f"{head}/{f.denominator}"
