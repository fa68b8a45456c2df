"""Sparse polynomials over Q(sqrt2, sqrt3) in named generators. The whole derivation computes with them.

A generator is a parameter, pi, the cosine or sine of a joint angle, or a function of other polynomials that is not a
polynomial, such as sqrt(a**2 + b**2). Products apply the relations sin**2 = 1 - cos**2 and sqrt(p)**2 = p. Exponents
may be negative, so that one can divide by a monomial.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import prod
from typing import TypeVar
from weakref import WeakValueDictionary

from wmrgen.geometry.exact.number import ONE, Exact

Number = Exact | Fraction | int
T = TypeVar("T")


class Gen:
    """A generator of polynomials. Equal generators are identical objects."""

    __slots__ = ("__weakref__", "args", "key", "kind", "name")

    # param, input, local, pi; cos or sin of a joint angle; or a function of `args`: sqrt, inv, atan2, tan, cosf, sinf,
    # and free, a function that no relation is applied to
    kind: str
    name: str  # of a parameter, an input, a local or a joint; "" for the others
    args: tuple[Poly, ...]
    key: str  # a canonical text

    def __new__(cls, kind: str, name: str = "", args: tuple[Poly, ...] = ()) -> Gen:
        key = f"{kind}:{name}({';'.join(a.key for a in args)})"
        known = _generators.get(key)
        if known is None:
            known = _generators[key] = object.__new__(cls)
            known.kind, known.name, known.args, known.key = kind, name, args, key
        return known

    def __lt__(self, other: Gen) -> bool:
        return self.key < other.key

    @property
    def alone(self) -> Poly:
        """The polynomial that consists of this generator."""
        return Poly({((self, 1),): ONE})


_generators: WeakValueDictionary[str, Gen] = WeakValueDictionary()

Monomial = tuple[tuple[Gen, int], ...]


class Poly:
    """An immutable polynomial. ``terms`` maps monomials, sorted by generator key, to coefficients."""

    __slots__ = ("_key", "terms")

    def __init__(self, terms: Mapping[Monomial, Exact]) -> None:
        self.terms = {m: c for m, c in terms.items() if c}
        self._key: str | None = None

    @staticmethod
    def of(value: Poly | Number) -> Poly:
        """Return ``value`` as a polynomial."""
        if isinstance(value, Poly):
            return value
        e = Exact.of(value)
        return Poly({(): e} if e else {})

    @staticmethod
    def gen(kind: str, name: str = "", *args: Poly) -> Poly:
        """Return the polynomial that consists of one generator."""
        return Gen(kind, name, args).alone

    @property
    def key(self) -> str:
        """A canonical text: equal polynomials have equal keys."""
        if self._key is None:
            parts = sorted((_monomial_key(m), c.key) for m, c in self.terms.items())
            self._key = "+".join(f"{c}*{m}" for m, c in parts)
        return self._key

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Poly):
            return self.terms == other.terms
        return isinstance(other, Exact | Fraction | int) and self.terms == Poly.of(other).terms

    def __bool__(self) -> bool:
        return bool(self.terms)

    @property
    def constant(self) -> Exact | None:
        """The value if no generator occurs, else None."""
        if not self.terms:
            return Exact(0)
        return self.terms.get(()) if len(self.terms) == 1 else None

    @property
    def ordered(self) -> list[tuple[Monomial, Exact]]:
        """The terms in the order of their generators."""
        return sorted(self.terms.items(), key=lambda item: [(g.key, e) for g, e in item[0]])

    @property
    def generators(self) -> tuple[Gen, ...]:
        """The generators that occur, sorted."""
        return tuple(sorted({g for m in self.terms for g, _ in m}))

    def __add__(self, other: Poly | Number) -> Poly:
        o = Poly.of(other)
        if not o.terms:
            return self
        if not self.terms:
            return o
        terms = dict(self.terms)
        _add_to(terms, o.terms.items())
        return Poly(terms)

    __radd__ = __add__

    @staticmethod
    def sum(polys: Iterable[Poly]) -> Poly:
        """Return the sum of many polynomials, in one pass."""
        terms: dict[Monomial, Exact] = {}
        for p in polys:
            _add_to(terms, p.terms.items())
        return Poly(terms)

    def __neg__(self) -> Poly:
        return Poly({m: -c for m, c in self.terms.items()})

    def __sub__(self, other: Poly | Number) -> Poly:
        return self + (-Poly.of(other))

    def __rsub__(self, other: Poly | Number) -> Poly:
        return Poly.of(other) + (-self)

    def scale(self, k: Number) -> Poly:
        """Return k * self for a number k."""
        e = Exact.of(k)
        return self if e == ONE else Poly({m: c * e for m, c in self.terms.items()})

    def __mul__(self, other: Poly | Number) -> Poly:
        o = Poly.of(other)
        if not (self.terms and o.terms):
            return o if self.terms else self
        a, b = self.constant, o.constant
        if b is not None:
            return self.scale(b)
        if a is not None:
            return o.scale(a)
        related: list[Poly] = []
        plain: list[tuple[Monomial, Exact]] = []
        for m1, c1 in self.terms.items():
            for m2, c2 in o.terms.items():
                m, factor = _merge(m1, m2)
                if factor is None:
                    plain.append((m, c1 * c2))
                else:
                    related.append(Poly({m: c1 * c2}) * factor)
        terms: dict[Monomial, Exact] = {}
        _add_to(terms, plain)
        return Poly.sum((*related, Poly(terms)))

    __rmul__ = __mul__

    def __pow__(self, n: int) -> Poly:
        if n < 0:
            return self.inverse() ** -n
        return prod([self] * n, start=Poly.of(1))

    def inverse(self) -> Poly:
        """Return 1/self: a number, a monomial with negated exponents, or else the generator inv(self)."""
        value = self.constant
        if value is not None:
            return Poly.of(value.inverse())
        if len(self.terms) == 1:
            ((m, c),) = self.terms.items()
            return Poly({tuple((g, -e) for g, e in m): c.inverse()})
        return Poly.gen("inv", "", self)

    def substitute(self, value: Callable[[Gen], Poly | None]) -> Poly:
        """Return the polynomial with generators replaced by ``value(generator)``; None leaves a generator as it is."""
        if self.constant is not None:
            return self
        summands: list[Poly] = []
        cache: dict[Gen, tuple[Poly | None, Exact | None]] = {}
        for m, number in self.terms.items():
            kept: list[tuple[Gen, int]] = []
            factor: Poly | None = None
            for g, e in m:
                if g not in cache:
                    v = value(g)
                    cache[g] = v, None if v is None else v.constant
                v, constant = cache[g]
                if v is None:
                    kept.append((g, e))
                elif constant is not None:
                    number = number * constant**e
                else:
                    factor = v**e if factor is None else factor * v**e
            term = Poly({tuple(kept): number})
            summands.append(term if factor is None else term * factor)
        return Poly.sum(summands)

    def __repr__(self) -> str:
        return f"Poly({self.key})"


def _monomial_key(monomial: Monomial) -> str:
    """Return a canonical text: equal monomials have equal keys."""
    return "*".join(f"{g.key}^{e}" for g, e in monomial)


def _add_to(terms: dict[Monomial, Exact], others: Iterable[tuple[Monomial, Exact]]) -> None:
    for m, c in others:
        old = terms.get(m)
        terms[m] = c if old is None else old + c


def _merge(a: Monomial, b: Monomial) -> tuple[Monomial, Poly | None]:
    """Return the product of two monomials.

    The second part of the result is a factor by which relations replace squares of sines and roots, or None.
    """
    if not a:
        return b, None
    if not b:
        return a, None
    powers = dict(a)
    for g, e in b:
        powers[g] = powers.get(g, 0) + e
    special: Poly | None = None
    for g in [g for g, e in powers.items() if e >= 2 and g.kind in ("sin", "sqrt", "sinf")]:
        half, powers[g] = divmod(powers[g], 2)
        power = _square(g) ** half
        special = power if special is None else special * power
    return tuple(sorted(((g, e) for g, e in powers.items() if e), key=lambda power: power[0].key)), special


@lru_cache(maxsize=1000)
def _square(g: Gen) -> Poly:
    """Return the polynomial that replaces the square of a sine or of a square root."""
    if g.kind == "sqrt":
        return g.args[0]
    cosine = Gen("cos" if g.kind == "sin" else "cosf", g.name, g.args).alone
    return 1 - cosine * cosine


Row = tuple[Poly, Poly, Poly]


def triple(values: Iterable[T]) -> tuple[T, T, T]:
    """Return exactly three values as a tuple: a row, a twist or a vector."""
    a, b, c = values
    return a, b, c


def each(row: Sequence[Poly], function: Callable[[Poly], Poly]) -> Row:
    """Return a row with ``function`` applied to each entry."""
    return triple(map(function, row))


def sum_of_rows(rows: Sequence[Sequence[Poly]]) -> Row:
    """Return the sum of rows of three entries, entry by entry."""
    return (Poly.sum(r[0] for r in rows), Poly.sum(r[1] for r in rows), Poly.sum(r[2] for r in rows))


def cross(a: Row, b: Row) -> Row:
    """Return a x b, the null vector of two independent rows."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def common_powers(polys: Iterable[Poly]) -> dict[Gen, int]:
    """Return the largest monomial that divides all terms: for each generator its least power, which may be negative."""
    monomials = [dict(m) for p in polys for m in p.terms]
    powers = {}
    for g in {g for m in monomials for g in m}:
        powers[g] = min(m.get(g, 0) for m in monomials)
    return powers


def has_angles(row: Iterable[Poly]) -> bool:
    """Return whether the angle of a joint occurs."""
    return any(g.kind in ("cos", "sin") for p in row for g in p.generators)


def at_angle(p: Poly, c: Poly, s: Poly) -> Poly:
    """Return a polynomial with all joints at the same angle.

    Args:
        p: The polynomial.
        c: The cosine of the angle.
        s: The sine of the angle.

    Returns:
        The polynomial without joint angles.
    """
    return p.substitute(lambda g: {"cos": c, "sin": s}.get(g.kind))


def dot(a: Sequence[Poly], b: Sequence[Poly]) -> Poly:
    """Return a . b for vectors of three entries."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def derivative(poly: Poly, of_generator: Callable[[Gen], Poly]) -> Poly:
    """Return the derivative of ``poly`` by the chain rule, with ``of_generator(g)`` as the derivative of g."""
    parts = []
    for monomial, coefficient in poly.terms.items():
        for g, e in monomial:
            inner = of_generator(g)
            if inner:
                rest = tuple((h, n - (h == g)) for h, n in monomial if n - (h == g))
                parts.append(Poly({rest: coefficient * e}) * inner)
    return Poly.sum(parts)
