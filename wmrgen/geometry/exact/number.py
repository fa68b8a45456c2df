"""Numbers of the field Q(sqrt2, sqrt3), which contains the cosines of all multiples of pi/12.

An element a + b sqrt2 + c sqrt3 + d sqrt6 is stored as four integers over one common denominator.
"""

from __future__ import annotations

import sys
from fractions import Fraction
from functools import cache, total_ordering
from math import gcd, isqrt, lcm, prod

Rational = int | Fraction
_DIGITS = 60  # decimals of roots, far more than the 17 digits of a double
_NONE = (0, 0, 0, 0)
_MODULUS = sys.hash_info.modulus


@cache
def sqrt_rational(n: int, digits: int = _DIGITS) -> Fraction:
    """Return sqrt(n) rounded down to ``digits`` decimals, as a fraction."""
    scale = 10**digits
    return Fraction(isqrt(n * scale * scale), scale)


def _hash_of_ratio(num: int, den: int) -> int:
    """Return the hash of the equal int or Fraction, num / den in lowest terms, den > 0.

    The rule is in the Python manual, "Hashing of numeric types". Building a Fraction would compute the greatest common
    divisor again.
    """
    if den % _MODULUS == 0:
        return sys.hash_info.inf if num > 0 else -sys.hash_info.inf
    return hash(num * pow(den, -1, _MODULUS))


@total_ordering
class Exact:
    """An immutable element of Q(sqrt2, sqrt3). Hashable, totally ordered, closed under + - * /."""

    __slots__ = ("_hash", "den", "num")

    num: tuple[int, int, int, int]
    den: int

    def __init__(self, a: Rational = 0, b: Rational = 0, c: Rational = 0, d: Rational = 0) -> None:
        self._hash: int | None = None
        if not (b or c or d):  # the common case, for speed
            self.num, self.den = (a.numerator, 0, 0, 0), a.denominator
            return
        parts = (Fraction(a), Fraction(b), Fraction(c), Fraction(d))
        den = lcm(*(part.denominator for part in parts))
        self.num = tuple(int(part * den) for part in parts)  # type: ignore[assignment]
        self.den = den

    @classmethod
    def _make(cls, num: tuple[int, int, int, int], den: int) -> Exact:
        g = gcd(den, *num)
        if den < 0:
            g = -g
        if g == 1:
            return cls._reduced(num, den)
        return cls._reduced((num[0] // g, num[1] // g, num[2] // g, num[3] // g), den // g)

    @classmethod
    def ratio(cls, num: int, den: int) -> Exact:
        """Return num / den, den > 0."""
        self, g = object.__new__(cls), gcd(num, den)
        self.num, self.den, self._hash = (num // g, 0, 0, 0), den // g, None
        return self

    @classmethod
    def _reduced(cls, num: tuple[int, int, int, int], den: int) -> Exact:
        """Return num / den, which must be in lowest terms, den > 0."""
        self = object.__new__(cls)
        self.num, self.den, self._hash = num, den, None
        return self

    @staticmethod
    def of(value: Exact | Rational) -> Exact:
        """Return ``value`` as a field element."""
        return value if isinstance(value, Exact) else Exact(value)

    @property
    def parts(self) -> tuple[Fraction, Fraction, Fraction, Fraction]:
        """Coefficients of 1, sqrt2, sqrt3, sqrt6."""
        a, b, c, d = self.num
        return Fraction(a, self.den), Fraction(b, self.den), Fraction(c, self.den), Fraction(d, self.den)

    @property
    def key(self) -> str:
        """A canonical text, in hexadecimal because Python refuses to write more than 4300 decimal digits."""
        return f"{','.join(map(hex, self.num))}/{self.den:x}"

    @property
    def is_rational(self) -> bool:
        """Whether the number has no root."""
        _, b, c, d = self.num
        return not (b or c or d)

    def __bool__(self) -> bool:
        return self.num != _NONE

    def __add__(self, other: Exact | Rational) -> Exact:
        o = other if isinstance(other, Exact) else Exact(other)  # faster than `of`: most time is spent here
        p, q = self.den, o.den
        a, b, c, d = self.num
        e, f, g, h = o.num
        if not (b or c or d or f or g or h):
            return Exact.ratio(a * q + e * p, p * q)
        return Exact._make((a * q + e * p, b * q + f * p, c * q + g * p, d * q + h * p), p * q)

    __radd__ = __add__

    def __neg__(self) -> Exact:
        a, b, c, d = self.num
        return Exact._reduced((-a, -b, -c, -d), self.den)

    def __sub__(self, other: Exact | Rational) -> Exact:
        return self + (-Exact.of(other))

    def __rsub__(self, other: Exact | Rational) -> Exact:
        return Exact.of(other) - self

    def __mul__(self, other: Exact | Rational) -> Exact:
        o = other if isinstance(other, Exact) else Exact(other)  # faster than `of`: most time is spent here
        a, b, c, d = self.num
        e, f, g, h = o.num
        if not (b or c or d or f or g or h):
            return Exact.ratio(a * e, self.den * o.den)
        if not (b or c or d):
            return Exact._make((a * e, a * f, a * g, a * h), self.den * o.den)
        return Exact._make(
            (
                a * e + 2 * b * f + 3 * c * g + 6 * d * h,
                a * f + b * e + 3 * (c * h + d * g),
                a * g + c * e + 2 * (b * h + d * f),
                a * h + d * e + b * g + c * f,
            ),
            self.den * o.den,
        )

    __rmul__ = __mul__

    def inverse(self) -> Exact:
        """Return 1/self. Raise ZeroDivisionError for 0."""
        if not self:
            raise ZeroDivisionError("1/0 in Q(sqrt2, sqrt3)")
        a, b, c, d = self.num
        if not (b or c or d):
            return Exact._reduced((self.den if a > 0 else -self.den, 0, 0, 0), abs(a))
        # Times its conjugate with -sqrt3 the numerator is p + q sqrt2, times p - q sqrt2 it is a whole number.
        p, q = a * a + 2 * b * b - 3 * c * c - 6 * d * d, 2 * a * b - 6 * c * d
        e, f, g, h = a * p - 2 * b * q, b * p - a * q, 2 * d * q - c * p, c * q - d * p
        n = self.den
        return Exact._make((n * e, n * f, n * g, n * h), p * p - 2 * q * q)

    def __truediv__(self, other: Exact | Rational) -> Exact:
        return self * Exact.of(other).inverse()

    def __rtruediv__(self, other: Exact | Rational) -> Exact:
        return Exact.of(other) * self.inverse()

    def __pow__(self, n: int) -> Exact:
        if n < 0:
            return self.inverse() ** -n
        return prod([self] * n, start=ONE)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Exact):
            return self.num == other.num and self.den == other.den
        if isinstance(other, int | Fraction):
            return self.num == (other.numerator, 0, 0, 0) and self.den == other.denominator
        return False

    def __hash__(self) -> int:
        if self._hash is None:
            a, b, c, d = self.num
            self._hash = hash((self.num, self.den)) if b or c or d else _hash_of_ratio(a, self.den)
        return self._hash

    def rational(self, digits: int = _DIGITS) -> Fraction:
        """Return the number itself if it is rational, else a fraction within 10**(3-digits) of it, relative."""
        a, b, c, d = self.num
        if not (b or c or d):
            return Fraction(a, self.den)
        value = a + b * sqrt_rational(2, digits) + c * sqrt_rational(3, digits) + d * sqrt_rational(6, digits)
        if abs(value) * 10 ** (digits // 2) < max(abs(n) for n in self.num):
            return self.rational(2 * digits)  # digits cancel: use more; a non-zero element never becomes 0
        return value / self.den

    @property
    def sign(self) -> int:
        """-1, 0 or 1, exactly."""
        if self.is_rational:
            return (self.num[0] > 0) - (self.num[0] < 0)
        return 1 if self.rational() > 0 else -1

    def __lt__(self, other: Exact | Rational) -> bool:
        return (self - other).sign < 0

    def __abs__(self) -> Exact:
        return -self if self.sign < 0 else self

    def __float__(self) -> float:
        a, b, c, d = self.num
        if not (b or c or d):
            return a / self.den
        value = self.rational()
        return value.numerator / value.denominator

    def __repr__(self) -> str:
        return f"Exact({self})"

    def __str__(self) -> str:
        """Plain Python syntax: ``33/200``, ``sqrt(2)/2``, ``1/4 + 3*sqrt(6)/4``."""
        terms: list[str] = []
        for part, root in zip(self.parts, ("", "sqrt(2)", "sqrt(3)", "sqrt(6)"), strict=True):
            if not part:
                continue
            n, q = abs(part.numerator), part.denominator
            factors = [str(n)] if n != 1 or not root else []
            body = "*".join([*factors, root] if root else factors)
            if q != 1:
                body = f"{body}/{q}"
            if terms:
                terms.append(f" - {body}" if part < 0 else f" + {body}")
            else:
                terms.append(f"-{body}" if part < 0 else body)
        return "".join(terms) or "0"


ZERO = Exact(0)
ONE = Exact(1)
SQRT2 = Exact(0, 1)
SQRT3 = Exact(0, 0, 1)


def exact_sqrt(value: Exact | Rational) -> Exact | None:
    """Return sqrt(value) if value is rational and the root is in the field, else None."""
    v = Exact.of(value)
    if not v.is_rational or v.sign < 0:
        return None
    q = v.parts[0]
    for n, root in ((1, ONE), (2, SQRT2), (3, SQRT3), (6, SQRT2 * SQRT3)):
        m = q / n
        p, r = isqrt(m.numerator), isqrt(m.denominator)
        if p * p == m.numerator and r * r == m.denominator:
            return root * Fraction(p, r)
    return None
