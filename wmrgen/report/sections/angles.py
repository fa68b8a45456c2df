"""Sines and cosines as a reader writes them: addition theorems, no fractions in a column of N, angles in degrees."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import atan2, pi

from wmrgen.functions.models.polynomials import whole, without_lengths
from wmrgen.geometry import notation
from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.geometry.exact.poly import Gen, Poly, Row, each, triple
from wmrgen.report.sections.latex import COMMON, terms, total
from wmrgen.report.sections.terms import Factor, Term, merged


def upright(column: Row) -> Row:
    """A column of N, which has no scale: it turns at 1 to the left, or by the sine of a sum of angles, where that
    halves no named length; else no number is a fraction."""
    turn = column[2]
    sizes = {abs(c) for c in turn.terms.values()}
    if len(sizes) == 1:
        rate = next(iter(turn.terms.values())) if len(turn.terms) == 1 else sizes.pop()
        once = each(column, lambda p: p.scale(rate.inverse()))
        if not _halves_a_length(once):
            return once
    return triple(whole(column))


def _halves_a_length(column: Row) -> bool:
    """Whether a fraction stands before a named length."""
    numbers = (c for p in column for m, c in p.terms.items() if any(g.kind == "param" for g, _ in m))
    return any(c.den > 1 for c in numbers)


def readable(p: Poly) -> str:
    """A polynomial with sums of angles."""
    return total(gathered(terms(p)))


def gathered(summed: Sequence[Term]) -> list[Term]:
    """The sum with sin a cos b +- cos a sin b and cos a cos b +- sin a sin b as one sine or cosine."""
    rest = list(summed)
    done: list[Term] = []
    while rest:
        first = rest.pop(0)
        for other in rest:
            joined = _joined(first, other)
            if joined is not None:
                rest.remove(other)
                first = joined
                break
        done.append(first)
    return done


def over(above: Sequence[Term], below: Term) -> list[Term]:
    """The sum divided by a term: what both have cancels, cos a / sin a is cot a."""
    turned = [replace(f, power=-f.power) for f in below.factors]
    quotients = [Term(t.number / below.number, merged((*t.factors, *turned))) for t in above]
    return [Term(t.number, _by_one_name(t.factors, r"\cos", r"\sin", r"\cot")) for t in quotients]


def with_tangents(summed: Sequence[Term]) -> list[Term]:
    """The sum with sin a / cos a as tan a."""
    return [Term(t.number, _by_one_name(t.factors, r"\sin", r"\cos", r"\tan")) for t in summed]


def _by_one_name(factors: tuple[Factor, ...], above: str, below: str, name: str) -> tuple[Factor, ...]:
    """The factors with above a / below a as name a."""
    for top in (f for f in factors if f.power == 1 and f.base.startswith(above)):
        angle = top.base.removeprefix(above)
        bottom = next((f for f in factors if f.power == -1 and f.base == below + angle), None)
        if bottom:
            rest = tuple(f for f in factors if f not in (top, bottom))
            return _by_one_name((*rest, replace(top, base=name + angle)), above, below, name)
    return factors


def _joined(s: Term, t: Term) -> Term | None:
    """n (f a g b) +- n (f' a g' b), each function and its co-function, as one term."""
    if abs(s.number) != abs(t.number):
        return None
    own = [f for f in s.factors if f not in t.factors]
    others = [f for f in t.factors if f not in s.factors]
    if len(own) != 2 or len(others) != 2 or any(f.power != 1 or f.rank != 1 for f in (*own, *others)):
        return None
    heads, angles = zip(*((f.base[:4], f.base[4:]) for f in own), strict=True)
    if angles[0] == angles[1] or {f.base for f in others} != {
        (r"\sin" if h == r"\cos" else r"\cos") + a for h, a in zip(heads, angles, strict=True)
    }:
        return None
    rest = tuple(f for f in s.factors if f not in own)
    alike = s.number == t.number
    if heads[0] == heads[1]:  # cos a cos b + sin a sin b = cos(a - b)
        number = s.number if heads[0] == r"\cos" or alike else -s.number
        return Term(number, (*rest, _of_two(own[0], r"\cos", angles, "-" if alike else "+")))
    if alike:
        return Term(s.number, (*rest, _of_two(own[0], r"\sin", angles, "+")))
    if heads[0] == r"\cos":  # sin b cos a - cos b sin a = sin(b - a)
        angles = angles[::-1]
    if s.number.sign < 0:
        return Term(-s.number, (*rest, _of_two(own[0], r"\sin", angles[::-1], "-")))
    return Term(s.number, (*rest, _of_two(own[0], r"\sin", angles, "-")))


def _of_two(like: Factor, head: str, angles: Sequence[str], sign: str) -> Factor:
    return replace(like, base=rf"{head}\left({angles[0]}{sign}{angles[1]}\right)")


def equation(p: Poly) -> Poly:
    """The left-hand side of ``p = 0`` without a common number or length; with the sign of most of its terms."""
    p = without_lengths(p)
    numbers = list(p.terms.values())
    least = min(map(abs, numbers))
    simple = all(max(map(abs, (*q.num, q.den))) <= COMMON for q in (c / least for c in numbers))
    size = least if simple else Exact(1)
    negative = sum(c.sign for c in numbers) < 0 or (numbers[0].sign < 0 and sum(c.sign for c in numbers) == 0)
    return p.scale((-size if negative else size).inverse())


def short(p: Poly) -> Poly:
    """The left-hand side of ``p = 0`` in which 900 a - 4500 b is 0.9 a - 4.5 b: integers of three digits and more are
    lengths without their point."""
    digits = len(str(int(max(abs(float(c)) for c in p.terms.values())))) - 1
    return p.scale(Exact(Fraction(1, 10**digits))) if digits > 1 else p


def roots(p: Poly) -> str:
    """Where a cos psi + b sin psi = 0, in degrees, as LaTeX; "" for what is not of that form."""
    numbers: dict[Gen, float] = {}
    for monomial, c in p.terms.items():
        if len(monomial) != 1 or monomial[0][0].kind not in ("cos", "sin") or monomial[0][1] != 1:
            return ""
        numbers[monomial[0][0]] = float(c)
    joints = {g.name for g in numbers}
    if len(joints) != 1:
        return ""
    (joint,) = joints
    a, b = (numbers.get(Gen(kind, joint), float(ZERO)) for kind in ("cos", "sin"))
    angle = atan2(-a, b) * 180 / pi
    low, high = sorted((angle % 180 - 180, angle % 180)) if angle % 180 else (0.0, 180.0)
    psi = notation.port(f"{joint}.steer")
    return rf"{psi} = {_degrees(low)}\;\mathrm{{or}}\;{_degrees(high)}"


def _degrees(angle: float) -> str:
    return rf"{round(angle, 4) + 0.0:.7g}^{{\circ}}"
