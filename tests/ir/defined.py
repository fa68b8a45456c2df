"""Whether every quotient and root of a function is defined for all inputs: exact ranges without limits.

Every node gets an enclosing interval, a bound away from zero, and whether it can be zero. The comparison of a `select`
is used for the branch that it takes. The tested code has its own ranges, in floats and within limits
(`wmrgen.ir.bounds`); this module shares nothing with it.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt

from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Node, Op


@dataclass(frozen=True, slots=True)
class Fact:
    """lo <= value <= hi (None: no bound), |value| >= away, and value != 0 where ``nonzero``."""

    lo: Exact | None = None
    hi: Exact | None = None
    away: Exact = ZERO
    nonzero: bool = False

    @classmethod
    def between(cls, lo: Exact | None, hi: Exact | None, away: Exact = ZERO, nonzero: bool = False) -> Fact:
        """A fact whose bound away from zero takes the interval into account."""
        if lo is not None and lo > away:
            away = lo
        if hi is not None and -hi > away:
            away = -hi
        return cls(lo, hi, away, nonzero or bool(away))

    @property
    def at_least_zero(self) -> bool:
        return self.lo is not None and self.lo >= 0

    def __neg__(self) -> Fact:
        lo, hi = self.lo, self.hi
        return Fact(None if hi is None else -hi, None if lo is None else -lo, self.away, self.nonzero)

    def __or__(self, other: Fact) -> Fact:
        """Of a value that is one or the other."""
        lo = None if self.lo is None or other.lo is None else min(self.lo, other.lo)
        hi = None if self.hi is None or other.hi is None else max(self.hi, other.hi)
        return Fact(lo, hi, min(self.away, other.away), self.nonzero and other.nonzero)


def _size_fact(a: Fact) -> Fact:
    hi = None if a.lo is None or a.hi is None else max(-a.lo, a.hi)
    return Fact.between(a.away, hi, a.away, a.nonzero)


def _larger_fact(a: Fact, b: Fact) -> Fact:
    los = [lo for lo in (a.lo, b.lo) if lo is not None]
    hi = None if a.hi is None or b.hi is None else max(a.hi, b.hi)
    positive = (a.at_least_zero and a.nonzero) or (b.at_least_zero and b.nonzero)
    return Fact.between(
        max(los) if los else None, hi, min(a.away, b.away), positive or (a.nonzero and b.nonzero)
    )


def _root_fact(a: Fact) -> Fact:
    if a.lo is None or a.lo <= 0:
        return Fact(ZERO, None, ZERO, a.nonzero and a.at_least_zero)
    q = a.lo.rational()
    scale = 10**40
    below = Exact(Fraction(max(isqrt(q.numerator * scale * scale // q.denominator) - 1, 0), scale))
    return Fact.between(below, None, nonzero=True)


def _sum_fact(a: Fact, b: Fact) -> Fact:
    lo = None if a.lo is None or b.lo is None else a.lo + b.lo
    hi = None if a.hi is None or b.hi is None else a.hi + b.hi
    one_sided = a.at_least_zero and b.at_least_zero
    return Fact.between(lo, hi, nonzero=one_sided and (a.nonzero or b.nonzero))


def _product_fact(a: Fact, b: Fact) -> Fact:
    """A product counts as non-zero where it is bounded away from zero: floats underflow."""
    away = a.away * b.away
    if a.at_least_zero and b.at_least_zero:
        hi = None if a.hi is None or b.hi is None else a.hi * b.hi
        return Fact.between((a.lo or ZERO) * (b.lo or ZERO), hi, away)
    if a.lo is None or a.hi is None or b.lo is None or b.hi is None:
        return Fact.between(None, None, away)
    corners = (a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi)
    return Fact.between(min(corners), max(corners), away)


def _square_fact(a: Fact) -> Fact:
    ends = [bound * bound for bound in (a.lo, a.hi) if bound is not None]
    return Fact.between(a.away * a.away, max(ends) if len(ends) == 2 else None, a.away * a.away)


def _nearest_fact(a: Fact) -> Fact:
    half = Exact(Fraction(1, 2))
    return Fact(None if a.lo is None else a.lo - half, None if a.hi is None else a.hi + half)


# Of the results of an operation, from facts of its arguments; of others nothing is known.
RULES: dict[Op, Callable[..., Fact]] = {
    Op.ADD: _sum_fact,
    Op.SUB: lambda a, b: _sum_fact(a, -b),
    Op.COMPENSATED: _sum_fact,
    Op.NEG: operator.neg,
    Op.MUL: _product_fact,
    Op.SQUARE: _square_fact,
    Op.DIV: lambda a, b: Fact(ZERO if a.at_least_zero and b.at_least_zero else None),
    Op.SQRT: _root_fact,
    Op.ABS: _size_fact,
    Op.MIN: lambda a, b: -_larger_fact(-a, -b),
    Op.MAX: _larger_fact,
    Op.SELECT: lambda a, b, x, y: x | y,
    Op.CLAMP: lambda a, m: replace(m | -m, away=min(a.away, m.away), nonzero=a.nonzero),
    Op.WITH_SIGN_OF: lambda a, b: a | -a,
    Op.AT_LEAST: lambda a, m: replace(a | m | -m, away=m.away, nonzero=True),
    Op.SIN: lambda a: Fact(-ONE, ONE),
    Op.COS: lambda a: Fact(-ONE, ONE),
    Op.ATAN: lambda a: Fact(Exact(-2), Exact(2)),
    Op.ATAN2: lambda y, x: Fact(Exact(-4), Exact(4)),
    Op.RINT: _nearest_fact,
    Op.FLIP: lambda a, n: a | -a,
}
# Which argument must have which property, and what is wrong where it has not.
NEEDS = {
    Op.DIV: (1, "nonzero", "the divisor may be zero"),
    Op.SQRT: (0, "at_least_zero", "the root's argument may be negative"),
}


@dataclass(frozen=True, slots=True)
class Finding:
    """An operation that is not shown to be defined."""

    function: str
    node: int
    what: str  # what may happen
    geometry: bool  # whether it depends on parameters alone

    def __str__(self) -> str:
        return f"{self.function}, node {self.node}: {self.what}"


def findings(function: Function) -> tuple[Finding, ...]:
    """Every operation of ``function`` that is not shown to be defined: divisions and square roots, say."""
    early, ranges = geometry_only(function), facts(function)
    undefined: list[Finding] = []
    for i, node in enumerate(function.nodes):
        if node.op in NEEDS:
            position, needed, what = NEEDS[node.op]
            argument = node.args[position]
            if not getattr(ranges[argument], needed):
                undefined.append(Finding(function.name, i, what, early[argument]))
    return tuple(undefined)


def facts(function: Function) -> list[Fact]:
    """A fact for every node, in list order."""
    before: list[Fact] = []
    for node in function.nodes:
        if node.value is not None:
            before.append(Fact.between(node.value, node.value))
            continue
        op, args = node.meaning
        below = [before[arg] for arg in args]
        if op is Op.SELECT:
            below[2:] = (_chosen(before, node, branch) for branch in (2, 3))
        before.append(RULES[op](*below) if op in RULES else Fact())
    return before


def _chosen(before: list[Fact], node: Node, branch: int) -> Fact:
    """The fact of a branch of a select, knowing how the comparison went there."""
    small, large = (node.args[0], node.args[1]) if branch == 2 else (node.args[1], node.args[0])
    value, strict = node.args[branch], branch == 2
    fact, below, above = before[value], before[small], before[large]
    if value == large and below.lo is not None:  # value > small or value >= small
        lo = below.lo if fact.lo is None else max(fact.lo, below.lo)
        return Fact.between(lo, fact.hi, fact.away, fact.nonzero or (strict and below.lo >= 0))
    if value == small and above.hi is not None:
        hi = above.hi if fact.hi is None else min(fact.hi, above.hi)
        return Fact.between(fact.lo, hi, fact.away, fact.nonzero or (strict and above.hi <= 0))
    return fact
