"""Proof that no quotient has a zero divisor and no square root a negative argument.

Every node gets an enclosing interval, a bound away from zero, and whether it can be zero at all.
What a `select` has compared is used for the branch that it chooses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Node, Op


@dataclass(frozen=True, slots=True)
class Fact:
    """lo <= value <= hi (None: no bound), |value| >= away, and value != 0 where ``nonzero``."""

    lo: Exact | None = None
    hi: Exact | None = None
    away: Exact = ZERO
    nonzero: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """An operation that is not shown to be defined. ``geometry``: it depends on the parameters alone."""

    function: str
    node: int
    what: str
    geometry: bool

    def __str__(self) -> str:
        return f"{self.function}, node {self.node}: {self.what}"


def findings(function: Function) -> tuple[Finding, ...]:
    """Every division and square root of ``function`` that is not shown to be defined."""
    known = geometry_only(function)
    fact = facts(function)
    found: list[Finding] = []
    for i, node in enumerate(function.nodes):
        if node.op is Op.DIV and not fact[node.args[1]].nonzero:
            found.append(Finding(function.name, i, "the divisor may be zero", known[node.args[1]]))
        if node.op is Op.SQRT and not _at_least_zero(fact[node.args[0]]):
            found.append(
                Finding(function.name, i, "the root's argument may be negative", known[node.args[0]])
            )
    return tuple(found)


def facts(function: Function) -> list[Fact]:
    """A fact for every node, in list order."""
    known: list[Fact] = []
    for node in function.nodes:
        known.append(_fact(function.nodes, known, node))
    return known


def _interval(lo: Exact | None, hi: Exact | None, away: Exact = ZERO, nonzero: bool = False) -> Fact:
    """A fact whose bound away from zero takes the interval into account."""
    if lo is not None and lo > away:
        away = lo
    if hi is not None and -hi > away:
        away = -hi
    return Fact(lo, hi, away, nonzero or bool(away))


def _at_least_zero(fact: Fact) -> bool:
    return fact.lo is not None and fact.lo >= 0


def _least(a: Exact | None, b: Exact | None) -> Exact | None:
    """The smaller bound; None is no bound."""
    return None if a is None or b is None else min(a, b)


def _greatest(a: Exact | None, b: Exact | None) -> Exact | None:
    return None if a is None or b is None else max(a, b)


def _plus(a: Exact | None, b: Exact | None) -> Exact | None:
    return None if a is None or b is None else a + b


def _negative(a: Fact) -> Fact:
    lo, hi = a.lo, a.hi
    return Fact(None if hi is None else -hi, None if lo is None else -lo, a.away, a.nonzero)


def _sum(a: Fact, b: Fact) -> Fact:
    fact = _interval(_plus(a.lo, b.lo), _plus(a.hi, b.hi))
    one_sided = _at_least_zero(a) and _at_least_zero(b)
    return replace(fact, nonzero=fact.nonzero or (one_sided and (a.nonzero or b.nonzero)))


def _product(a: Fact, b: Fact, square: bool) -> Fact:
    """A product counts as non-zero where it is bounded away from zero: floats underflow."""
    away = a.away * b.away
    if square:
        ends = [bound * bound for bound in (a.lo, a.hi) if bound is not None]
        return _interval(away, max(ends) if len(ends) == 2 else None, away)
    if _at_least_zero(a) and _at_least_zero(b):
        both = a.hi is not None and b.hi is not None
        hi = a.hi * b.hi if both and a.hi is not None and b.hi is not None else None
        return _interval((a.lo or ZERO) * (b.lo or ZERO), hi, away)
    if a.lo is None or a.hi is None or b.lo is None or b.hi is None:
        return _interval(None, None, away)
    corners = (a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi)
    return _interval(min(corners), max(corners), away)


def _root(a: Fact) -> Fact:
    if a.lo is None or a.lo <= 0:
        return Fact(ZERO, None, ZERO, a.nonzero and _at_least_zero(a))
    q = a.lo.rational()
    scale = 10**40
    below = Exact(Fraction(max(isqrt(q.numerator * scale * scale // q.denominator) - 1, 0), scale))
    return _interval(below, None, nonzero=True)


def _absolute(a: Fact) -> Fact:
    bounded = a.lo is not None and a.hi is not None
    hi = max(-a.lo, a.hi) if bounded and a.lo is not None and a.hi is not None else None
    return _interval(a.away, hi, a.away, a.nonzero)


def _whole(a: Fact) -> Fact:
    half = Exact(Fraction(1, 2))
    return Fact(None if a.lo is None else a.lo - half, None if a.hi is None else a.hi + half)


def _fact(nodes: tuple[Node, ...], known: list[Fact], node: Node) -> Fact:
    args = [known[arg] for arg in node.args]
    match node.op:
        case Op.CONST:
            return _interval(node.value, node.value)
        case Op.ADD:
            return _sum(args[0], args[1])
        case Op.SUB:
            return _sum(args[0], _negative(args[1]))
        case Op.NEG:
            return _negative(args[0])
        case Op.MUL:
            return _product(args[0], args[1], node.args[0] == node.args[1])
        case Op.DIV:
            positive = _at_least_zero(args[0]) and _at_least_zero(args[1])
            return Fact(ZERO if positive else None)
        case Op.ABS:
            return _absolute(args[0])
        case Op.SQRT:
            return _root(args[0])
        case Op.SIN | Op.COS:
            return Fact(-ONE, ONE)
        case Op.ATAN:
            return Fact(Exact(-2), Exact(2))
        case Op.ATAN2:
            return Fact(Exact(-4), Exact(4))
        case Op.RINT:
            return _whole(args[0])
        case Op.FLIP:
            return _either(args[0], _negative(args[0]))
        case Op.MIN:
            return _negative(_larger(_negative(args[0]), _negative(args[1])))
        case Op.MAX:
            return _larger(args[0], args[1])
        case Op.SELECT:
            return _either(_chosen(nodes, known, node, 2), _chosen(nodes, known, node, 3))
        case _:
            return Fact()


def _larger(a: Fact, b: Fact) -> Fact:
    los = [lo for lo in (a.lo, b.lo) if lo is not None]
    fact = _interval(max(los) if los else None, _greatest(a.hi, b.hi), min(a.away, b.away))
    positive = (_at_least_zero(a) and a.nonzero) or (_at_least_zero(b) and b.nonzero)
    return replace(fact, nonzero=fact.nonzero or positive or (a.nonzero and b.nonzero))


def _either(a: Fact, b: Fact) -> Fact:
    away = min(a.away, b.away)
    return Fact(_least(a.lo, b.lo), _greatest(a.hi, b.hi), away, a.nonzero and b.nonzero)


def _chosen(nodes: tuple[Node, ...], known: list[Fact], node: Node, branch: int) -> Fact:
    """The fact of a branch of a select, knowing how the comparison went there."""
    small, large = (node.args[0], node.args[1]) if branch == 2 else (node.args[1], node.args[0])
    value, strict = node.args[branch], branch == 2
    fact, below, above = known[value], known[small], known[large]
    if value == large and below.lo is not None:  # value > small or value >= small
        lo = below.lo if fact.lo is None else max(fact.lo, below.lo)
        return _interval(lo, fact.hi, fact.away, fact.nonzero or (strict and below.lo >= 0))
    if value == small and above.hi is not None:
        hi = above.hi if fact.hi is None else min(fact.hi, above.hi)
        return _interval(fact.lo, hi, fact.away, fact.nonzero or (strict and above.hi <= 0))
    if below.lo is not None and below.lo >= 0:  # |value| is known through its size or its square
        bound = _size_bound(nodes, large, value, below.lo)
        if bound is not None and (strict or bound):
            return _interval(fact.lo, fact.hi, max(fact.away, bound), nonzero=True)
        if strict and _grows(nodes, value, large):
            return _interval(fact.lo, fact.hi, fact.away, nonzero=True)
    return fact


def _grows(nodes: tuple[Node, ...], value: int, size: int) -> bool:
    """True when ``value`` is a + s, s being ``size`` >= 0 with the sign of a: |a + s| = |a| + size."""
    node = nodes[value]
    if node.op is not Op.ADD:
        return False
    for a, s in (node.args, node.args[::-1]):
        signed = nodes[s]
        if signed.op is Op.SELECT and signed.args[0] == a and signed.args[3] == size:
            zero, opposite = nodes[signed.args[1]], nodes[signed.args[2]]
            if zero.value == ZERO and opposite.op is Op.NEG and opposite.args[0] == size:
                return True
    return False


def _size_bound(nodes: tuple[Node, ...], size: int, value: int, least: Exact) -> Exact | None:
    """A bound of |value| when node ``size`` >= ``least`` is s |z| or s z z, s > 0, and value is c z."""
    scale, inner = _without_factor(nodes, size)
    factor, base = _without_factor(nodes, value)
    node = nodes[inner]
    if scale.sign <= 0:
        return None
    if node.op is Op.ABS and node.args[0] in (base, value):
        return least / scale * (abs(factor) if node.args[0] == base else ONE)
    if node.op is Op.MUL and node.args in ((base, base), (value, value)):
        root = min(least / scale, ONE)  # z z >= b gives |z| >= min(b, 1)
        return root * (abs(factor) if node.args[0] == base else ONE)
    return None


def _without_factor(nodes: tuple[Node, ...], i: int) -> tuple[Exact, int]:
    """(c, x) where node ``i`` is c x, (1, i) otherwise."""
    node = nodes[i]
    constant = nodes[node.args[0]].value if node.op is Op.MUL else None
    return (ONE, i) if constant is None else (constant, node.args[1])
