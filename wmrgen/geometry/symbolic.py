"""Exact polynomials as sympy expressions, over symbols that print as the contract names.

Most functions here build expressions without sympy's evaluation, so that code and reports show the operations that a
formula's author wrote.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, ClassVar, TypeAlias

import sympy

from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row

Expr: TypeAlias = Any  # sympy.Expr; sympy ships no types
_PLAIN = (sympy.Symbol, sympy.sin, sympy.cos)  # a product of one of these and a number needs no evaluation


class Quantity(sympy.Symbol):  # type: ignore[misc]
    """A real symbol whose ``name`` is a C identifier."""

    def _latex(self, printer: Any) -> str:
        del printer
        return notation.parameter(self.name)


class Parameter(Quantity):
    """A named parameter of the robot file."""


class Input(Quantity):
    """An input of a function: ``left_spin`` for the port ``left.spin``."""

    def _latex(self, printer: Any) -> str:
        del printer
        return notation.symbol(self.name)


class Local(Quantity):
    """A named intermediate result."""


class Operation(sympy.Function):  # type: ignore[misc]
    """A function that becomes one operation of the generated code."""

    op: ClassVar[str]  # name of the operation in `ir.ops`
    nargs = 2
    is_real = True


class Nearest(Operation):
    """The nearest integer, ties to even. sympy never evaluates it, and its derivative is 0."""

    op = "rint"
    nargs = 1
    is_integer = True

    @classmethod
    def eval(cls, _: Expr) -> None:
        return None

    def fdiff(self, argindex: int = 1) -> Expr:
        del argindex
        return sympy.S.Zero


class Clamp(Operation):
    """Clamp(a, m): a clamped to [-m, m], m > 0."""

    op = "clamp"

    @classmethod
    def eval(cls, a: Expr, m: Expr) -> Expr | None:
        return sympy.Max(-m, sympy.Min(m, a)) if a.is_number and m.is_number else None


class AtLeast(Operation):
    """AtLeast(a, m): a if |a| >= m, else m with the sign of a, and m if a is 0; m > 0. It keeps a divisor off zero."""

    op = "at_least"

    @classmethod
    def eval(cls, a: Expr, m: Expr) -> Expr | None:
        return (-1 if a < 0 else 1) * sympy.Max(abs(a), m) if a.is_number and m.is_number else None


class WithSignOf(Operation):
    """WithSignOf(a, b): -a if b < 0, else a. Generated code may treat b = -0.0 as negative."""

    op = "with_sign_of"

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        return (-a if b < 0 else a) if b.is_number else None


class RoundingError(Operation):
    """RoundingError(a, b): the rounding error of a + b in generated code, which is 0 for exact numbers."""

    op = "rounding_error"

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        return sympy.S.Zero if a.is_number and b.is_number else None


class Compensated(sympy.Add):  # type: ignore[misc]
    """Compensated(x, c y): x + c y, where generated code compensates the rounding of the product.

    sympy treats it as a sum.
    """

    op = "compensated"

    def __new__(cls, x: Expr, product: Expr) -> Compensated:
        return sympy.Add.__new__(cls, x, product, evaluate=False)  # type: ignore[no-any-return]

    func = sympy.Add  # an expression rebuilt from its arguments is a plain sum


def parameter(name: str) -> Parameter:
    """Return the symbol of a parameter."""
    return Parameter(name, real=True)


def signal(port: str) -> Input:
    """Return the symbol of an input, by its contract name."""
    return Input(port.replace(".", "_"), real=True)


def local(name: str) -> Local:
    """Return the symbol of an intermediate result."""
    return Local(name.replace(".", "_"), real=True)


@lru_cache(maxsize=65536)
def number(value: Exact) -> Expr:
    """Return a field element as a sympy number."""
    roots = (sympy.S.One, sympy.sqrt(2), sympy.sqrt(3), sympy.sqrt(6))
    parts = zip(value.parts, roots, strict=True)
    return add(*(sympy.Rational(p.numerator, p.denominator) * root for p, root in parts if p))


@lru_cache(maxsize=65536)
def generator(gen: Gen) -> Expr:
    """Return a generator as a sympy expression."""
    match gen.kind:
        case "param":
            return parameter(gen.name)
        case "input":
            return signal(gen.name)
        case "local":
            return local(gen.name)
        case "pi":
            return sympy.pi
        case "free":  # a sine or cosine that no relation is applied to, see `exact.lowest`
            return expression(gen.args[0])
        case "cos":
            return sympy.cos(signal(f"{gen.name}.steer"))
        case "sin":
            return sympy.sin(signal(f"{gen.name}.steer"))
    args = [expression(a) for a in gen.args]
    table: dict[str, Any] = {
        "sqrt": sympy.sqrt, "inv": lambda a: sympy.Pow(a, -1), "tan": sympy.tan,
        "cosf": sympy.cos, "sinf": sympy.sin, "atan2": lambda y, x: sympy.atan2(y, x, evaluate=False),
    }  # fmt: skip
    return table[gen.kind](*args)


def expression(poly: Poly) -> Expr:
    """Return a polynomial as a sympy expression, with its terms in their order."""
    terms = []
    for monomial, coefficient in poly.terms.items():
        factors = [generator(g) if e == 1 else sympy.Pow(generator(g), e) for g, e in monomial]
        terms.append(_product(number(coefficient), factors))
    return add(*terms)


def _product(value: Expr, factors: Sequence[Expr]) -> Expr:
    """Return a number times factors, without sympy's slow evaluation if it would change nothing."""
    if len(factors) == 1 and value.is_Rational and isinstance(factors[0], _PLAIN):
        return times(value, factors[0])
    return sympy.Mul(value, *factors)


def matrix(rows: Sequence[Row] | Sequence[Sequence[Poly]], columns: int) -> sympy.Matrix:
    """Return rows of polynomials as a sympy matrix with ``columns`` columns; there may be no rows."""
    return sympy.Matrix(len(rows), columns, [expression(p) for row in rows for p in row])


def add(*terms: Expr) -> Expr:
    """Return an unevaluated sum. The first evaluated sum would load sympy's tensors and permutations."""
    kept = [t for t in terms if t is not sympy.S.Zero]
    return sympy.Add(*kept, evaluate=False) if len(kept) > 1 else kept[0] if kept else sympy.S.Zero


def subtract(a: Expr, b: Expr) -> Expr:
    """Return a - b, unevaluated."""
    return add(a, times(-1, b))


def times(*factors: Expr) -> Expr:
    """Return an unevaluated product."""
    if any(f is sympy.S.Zero for f in factors):
        return sympy.S.Zero
    kept = [f for f in factors if f is not sympy.S.One]
    return sympy.Mul(*kept, evaluate=False) if len(kept) > 1 else kept[0] if kept else sympy.S.One


def over(above: Expr, below: Expr) -> Expr:
    """Return above / below, unevaluated. The caller ensures that ``below`` is not 0."""
    return times(above, sympy.Pow(below, -1, evaluate=below.is_Rational))


def rotated(c: Expr, s: Expr, a: Expr, b: Expr) -> tuple[Expr, Expr]:
    """Rotate a vector counter-clockwise.

    Args:
        c: The cosine of the angle.
        s: The sine of the angle.
        a: The x component of the vector.
        b: The y component of the vector.

    Returns:
        The components (x, y) of the rotated vector.
    """
    return subtract(times(a, c), times(b, s)), add(times(a, s), times(b, c))


def rotated_back(c: Expr, s: Expr, a: Expr, b: Expr) -> tuple[Expr, Expr]:
    """Rotate a vector clockwise, which expresses it in axes that are rotated counter-clockwise.

    Args:
        c: The cosine of the angle.
        s: The sine of the angle.
        a: The x component of the vector.
        b: The y component of the vector.

    Returns:
        The components of the vector along the rotated x axis and y axis.
    """
    return add(times(c, a), times(s, b)), subtract(times(c, b), times(s, a))


def root(a: Expr) -> Expr:
    """Return the square root, unevaluated."""
    return sympy.Pow(a, sympy.S.Half, evaluate=False)


def norm(*components: Expr) -> Expr:
    """Return the Euclidean norm of a vector, unevaluated."""
    return root(add(*(square(c) for c in components)))


def square(a: Expr) -> Expr:
    """Return a**2, unevaluated."""
    return sympy.Pow(a, 2, evaluate=False)


def select(a: Expr, b: Expr, then: Expr, otherwise: Expr) -> Expr:
    """Return the expression "``then`` if a < b, else ``otherwise``".

    Args:
        a: The left side of the comparison.
        b: The right side of the comparison.
        then: The value if a < b.
        otherwise: The value if a >= b.

    Returns:
        An unevaluated `sympy.Piecewise`.
    """
    condition = sympy.StrictLessThan(a, b, evaluate=False)
    return sympy.Piecewise((then, condition), (otherwise, True), evaluate=False)


def maximum(a: Expr, b: Expr) -> Expr:
    """Return the larger of two expressions, unevaluated."""
    return sympy.Max(a, b, evaluate=False)


def minimum(a: Expr, b: Expr) -> Expr:
    """Return the smaller of two expressions, unevaluated."""
    return sympy.Min(a, b, evaluate=False)


def clamp_between(low: Expr, a: Expr, high: Expr) -> Expr:
    """Clamp ``a`` to an interval, unevaluated.

    Args:
        low: The lower end.
        a: The expression.
        high: The upper end.

    Returns:
        The expression clamped to [low, high], as a `Clamp` if the interval is symmetric about 0.
    """
    return Clamp(a, high, evaluate=False) if high == -low else maximum(low, minimum(high, a))


def at_least(a: Expr, least: Expr) -> Expr:
    """Return a divisor kept off zero: ``a``, or ``least`` > 0 with the sign of a if |a| < ``least``; unevaluated."""
    return AtLeast(a, least, evaluate=False)


def with_sign_of(a: Expr, b: Expr) -> Expr:
    """Return -a if b < 0, else a, unevaluated. For b = 0 both are right, because code may read the sign of -0.0."""
    return WithSignOf(a, b, evaluate=False)


def rounding_error(a: Expr, b: Expr) -> Expr:
    """Return the rounding error of a + b in generated code, unevaluated."""
    return RoundingError(a, b, evaluate=False)


def absolute(a: Expr) -> Expr:
    """Return |a|, unevaluated."""
    return a if a.is_zero else sympy.Abs(a, evaluate=False)


def angle_of(y: Expr, x: Expr) -> Expr:
    """Return atan2(y, x), unevaluated; atan2(0, 0) = 0 in every back end."""
    return sympy.atan2(y, x, evaluate=False)


def arctangent(a: Expr) -> Expr:
    """Return atan(a), unevaluated."""
    return sympy.atan(a, evaluate=False)


def nearest(a: Expr) -> Expr:
    """Return the integer nearest to a, ties to even, unevaluated."""
    return Nearest(a, evaluate=False)


def alternating(n: Expr) -> Expr:
    """Return (-1)**n for an integer n from `nearest`, unevaluated."""
    return sympy.Pow(-1, n, evaluate=False)
