"""Exact polynomials as sympy expressions, over symbols that print as the contract's names."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, ClassVar, TypeAlias

import sympy

from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row

Expr: TypeAlias = Any  # sympy.Expr; sympy ships no types
_PLAIN = (sympy.Symbol, sympy.sin, sympy.cos)


class Quantity(sympy.Symbol):  # type: ignore[misc]
    """A real symbol. ``name`` is a C identifier."""

    def _latex(self, printer: Any) -> str:
        del printer
        return notation.parameter(self.name)


class Parameter(Quantity):
    """A named length or angle of the robot file."""


class Input(Quantity):
    """An input of a function: ``left_spin`` for the port ``left.spin``."""

    def _latex(self, printer: Any) -> str:
        del printer
        return notation.symbol(self.name)


class Local(Quantity):
    """A named intermediate result."""


class Operation(sympy.Function):  # type: ignore[misc]
    """A function that is one operation of the code, ``op``, and keeps its meaning down to it."""

    op: ClassVar[str]
    nargs = 2
    is_real = True


class Nearest(Operation):
    """The nearest whole number, ties to even. Nothing evaluates it; its derivative is 0."""

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
    """Clamp(a, m): a, or the end of [-m, m] that it lies beyond; m > 0."""

    op = "clamp"

    @classmethod
    def eval(cls, a: Expr, m: Expr) -> Expr | None:
        return sympy.Max(-m, sympy.Min(m, a)) if a.is_number and m.is_number else None


class AtLeast(Operation):
    """AtLeast(a, m): a where |a| >= m, else m with the sign of a, m where a is 0; m > 0. A divisor off zero."""

    op = "at_least"

    @classmethod
    def eval(cls, a: Expr, m: Expr) -> Expr | None:
        return (-1 if a < 0 else 1) * sympy.Max(abs(a), m) if a.is_number and m.is_number else None


class WithSignOf(Operation):
    """WithSignOf(a, b): -a where b < 0, else a. Code may take a zero b for negative if it is -0."""

    op = "with_sign_of"

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        return (-a if b < 0 else a) if b.is_number else None


class RoundingError(Operation):
    """RoundingError(a, b): what a + b loses where code rounds it: 0 in exact numbers, and so to sympy's numbers."""

    op = "rounding_error"

    @classmethod
    def eval(cls, a: Expr, b: Expr) -> Expr | None:
        return sympy.S.Zero if a.is_number and b.is_number else None


class Compensated(sympy.Add):  # type: ignore[misc]
    """Compensated(x, c y): x + c y, of which code makes the rounding of the product good. To sympy it is a sum."""

    op = "compensated"

    def __new__(cls, x: Expr, product: Expr) -> Compensated:
        return sympy.Add.__new__(cls, x, product, evaluate=False)  # type: ignore[no-any-return]

    func = sympy.Add  # what is made of one is a sum


def parameter(name: str) -> Parameter:
    """The symbol of a parameter."""
    return Parameter(name, real=True)


def signal(port: str) -> Input:
    """The symbol of an input, by its contract name."""
    return Input(port.replace(".", "_"), real=True)


def local(name: str) -> Local:
    """The symbol of an intermediate result."""
    return Local(name.replace(".", "_"), real=True)


@lru_cache(maxsize=65536)
def number(value: Exact) -> Expr:
    """A field element as a sympy number."""
    roots = (sympy.S.One, sympy.sqrt(2), sympy.sqrt(3), sympy.sqrt(6))
    parts = zip(value.parts, roots, strict=True)
    return add(*(sympy.Rational(p.numerator, p.denominator) * root for p, root in parts if p))


@lru_cache(maxsize=65536)
def generator(gen: Gen) -> Expr:
    """A generator as a sympy expression."""
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
    """A polynomial as a sympy expression, terms as they stand."""
    terms = []
    for monomial, coefficient in poly.terms.items():
        factors = [generator(g) if e == 1 else sympy.Pow(generator(g), e) for g, e in monomial]
        terms.append(_product(number(coefficient), factors))
    return add(*terms)


def _product(value: Expr, factors: Sequence[Expr]) -> Expr:
    """A number times factors; where sympy's own evaluation has nothing to do, which is slow, it is left out."""
    if len(factors) == 1 and value.is_Rational and isinstance(factors[0], _PLAIN):
        return times(value, factors[0])
    return sympy.Mul(value, *factors)


def matrix(rows: Sequence[Row] | Sequence[Sequence[Poly]], columns: int) -> sympy.Matrix:
    """Rows of polynomials as a sympy matrix with ``columns`` columns (0 rows allowed)."""
    return sympy.Matrix(len(rows), columns, [expression(p) for row in rows for p in row])


def add(*terms: Expr) -> Expr:
    """A sum as it stands. Not evaluated: the first evaluated sum would load sympy's tensors and permutations."""
    kept = [t for t in terms if t is not sympy.S.Zero]
    return sympy.Add(*kept, evaluate=False) if len(kept) > 1 else kept[0] if kept else sympy.S.Zero


def subtract(a: Expr, b: Expr) -> Expr:
    """a - b as it stands."""
    return add(a, times(-1, b))


def times(*factors: Expr) -> Expr:
    """A product as it stands."""
    if any(f is sympy.S.Zero for f in factors):
        return sympy.S.Zero
    kept = [f for f in factors if f is not sympy.S.One]
    return sympy.Mul(*kept, evaluate=False) if len(kept) > 1 else kept[0] if kept else sympy.S.One


def over(above: Expr, below: Expr) -> Expr:
    """above / below as it stands; ``below`` is kept off zero by the caller."""
    return times(above, sympy.Pow(below, -1, evaluate=below.is_Rational))


def rotated(c: Expr, s: Expr, a: Expr, b: Expr) -> tuple[Expr, Expr]:
    """The vector (a, b) turned by the angle whose cosine and sine are c and s."""
    return subtract(times(a, c), times(b, s)), add(times(a, s), times(b, c))


def rotated_back(c: Expr, s: Expr, a: Expr, b: Expr) -> tuple[Expr, Expr]:
    """The vector (a, b) turned back by the angle whose cosine and sine are c and s: (a, b) in axes at that angle."""
    return add(times(c, a), times(s, b)), subtract(times(c, b), times(s, a))


def root(a: Expr) -> Expr:
    """The square root as it stands."""
    return sympy.Pow(a, sympy.S.Half, evaluate=False)


def norm(*components: Expr) -> Expr:
    """The length of a vector as it stands."""
    return root(add(*(square(c) for c in components)))


def square(a: Expr) -> Expr:
    """a**2 as it stands."""
    return sympy.Pow(a, 2, evaluate=False)


def select(a: Expr, b: Expr, then: Expr, otherwise: Expr) -> Expr:
    """``then`` where a < b, else ``otherwise``."""
    condition = sympy.StrictLessThan(a, b, evaluate=False)
    return sympy.Piecewise((then, condition), (otherwise, True), evaluate=False)


def maximum(a: Expr, b: Expr) -> Expr:
    """The larger of two expressions, unevaluated."""
    return sympy.Max(a, b, evaluate=False)


def minimum(a: Expr, b: Expr) -> Expr:
    """The smaller of two expressions, unevaluated."""
    return sympy.Min(a, b, evaluate=False)


def kept_between(low: Expr, a: Expr, high: Expr) -> Expr:
    """``a``, or the end of [low, high] that it lies beyond, unevaluated."""
    return Clamp(a, high, evaluate=False) if high == -low else maximum(low, minimum(high, a))


def at_least(a: Expr, least: Expr) -> Expr:
    """A divisor: ``a``, or ``least`` > 0 with the sign of a where a is nearer to zero, unevaluated."""
    return AtLeast(a, least, evaluate=False)


def with_sign_of(a: Expr, b: Expr) -> Expr:
    """-a where b < 0, else a, unevaluated. Either is right where b is 0: code may read the sign of a -0."""
    return WithSignOf(a, b, evaluate=False)


def rounding_error(a: Expr, b: Expr) -> Expr:
    """What code loses when it rounds ``compensated(a, b)``, unevaluated."""
    return RoundingError(a, b, evaluate=False)


def absolute(a: Expr) -> Expr:
    """|a|, unevaluated."""
    return a if a.is_zero else sympy.Abs(a, evaluate=False)


def angle_of(y: Expr, x: Expr) -> Expr:
    """atan2(y, x), unevaluated; atan2(0, 0) = 0 in every backend."""
    return sympy.atan2(y, x, evaluate=False)


def arctangent(a: Expr) -> Expr:
    """atan(a), unevaluated."""
    return sympy.atan(a, evaluate=False)


def nearest(a: Expr) -> Expr:
    """The whole number nearest to a, ties to even, unevaluated."""
    return Nearest(a, evaluate=False)


def alternating(n: Expr) -> Expr:
    """(-1)**n of a `nearest` whole number, unevaluated."""
    return sympy.Pow(-1, n, evaluate=False)
