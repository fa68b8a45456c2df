"""Passes that rewrite operation by operation: fewer divisions, common factors, shared products, signs.

Each pass goes through a function in its order and builds it anew.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Node, Op, pruned, rebuilt, uses_of

_FAR = 2.0**-64  # reciprocals of larger numbers are far from overflow in float32 (2**128) [SI units]
_SUMS = (Op.ADD, Op.SUB)

Built = list[int]  # by node of the function that was visited: its node in the builder
Rule = Callable[[Builder, int, Node, Built], int]


def _rewritten(function: Function, rule: Rule) -> Function:
    """Return ``function`` with each node replaced by the node that ``rule`` makes of it."""
    builder = Builder()
    built: Built = []
    for i, node in enumerate(function.nodes):
        built.append(rule(builder, i, node, built))
    return pruned(rebuilt(function, builder.nodes, dict(enumerate(built))))


def _args(node: Node, built: Built) -> list[int]:
    return [built[arg] for arg in node.args]


# ---- divisions


def reduce_strength(function: Function) -> Function:
    """Return ``function`` with divisions replaced by products where that is safe.

    The builder has already replaced constant divisors. A division by a geometry-only value becomes a product with its
    reciprocal, which `hoist` moves to `prepare`. Several divisions by one value share its reciprocal if the value is so
    far from zero that the reciprocal cannot overflow.
    """
    if all(node.op is not Op.DIV for node in function.nodes):
        return function
    early, shared = geometry_only(function), _shared_divisors(function)

    def rule(builder: Builder, i: int, node: Node, built: Built) -> int:
        args = _args(node, built)
        if node.op is Op.DIV and ((early[node.args[1]] and not early[i]) or node.args[1] in shared):
            return builder.mul(args[0], builder.div(builder.const(ONE), args[1]))
        return builder.copy(node, args)

    return _rewritten(function, rule)


def _shared_divisors(function: Function) -> set[int]:
    dividends: defaultdict[int, set[int]] = defaultdict(set)
    for node in function.nodes:
        if node.op is Op.DIV:
            dividends[node.args[1]].add(node.args[0])
    repeated = {divisor for divisor, divided in dividends.items() if len(divided) > 1}
    return repeated and repeated & _far_from_zero(function)


def _far_from_zero(function: Function) -> set[int]:
    """Return the nodes whose absolute value is at least `_FAR` for all inputs."""
    anything = np.array([-np.inf]), np.array([np.inf])
    ranges: list[iv.Interval] = []
    far: set[int] = set()
    with np.errstate(all="ignore"):
        for i, node in enumerate(function.nodes):
            op, args = node.meaning
            if node.value is not None:
                value = np.array([float(node.value)])
                ranges.append(iv.outward(value, value))
            else:
                ranges.append(op.interval(*(ranges[arg] for arg in args)) if op.interval else anything)
            if iv.smallest(ranges[args[1] if op is Op.AT_LEAST else i]) >= _FAR:
                far.add(i)
    return far


# ---- common factors


class _Term(NamedTuple):
    """An addend of a sum: a constant times a product."""

    value: Exact  # the constant
    factors: tuple[int, ...]  # nodes of the builder, sorted


def factor(function: Function) -> Function:
    """Return ``function`` with common non-constant factors taken out of its sums: k a + k b becomes k (a + b).

    Only products that nothing else uses are taken apart, so that every step saves a multiplication. Constant and
    geometry-only factors are left to the linear forms.
    """
    sums = _Sums(function)

    def rule(builder: Builder, i: int, node: Node, built: Built) -> int:
        terms = sums.terms(i, built) if sums.outer(i) else []
        return builder.copy(node, _args(node, built)) if _common(terms) is None else _sum(builder, terms)

    return _rewritten(function, rule)


class _Sums:
    """The sums of a function and their addends."""

    def __init__(self, function: Function) -> None:
        self._nodes, self._uses, self._geometric = function.nodes, uses_of(function), geometry_only(function)
        self._inside = self._inner_sums()

    def _inner_sums(self) -> set[int]:
        """Return the sums and negations whose only user is a larger sum."""
        inside: set[int] = set()
        for i, node in enumerate(self._nodes):
            if self._is_sum(i) or i in inside:
                inside.update(arg for arg in node.args if self._uses[arg] == 1 and self._is_sum(arg))
        return inside

    def _is_sum(self, i: int) -> bool:
        return self._nodes[i].op in (*_SUMS, Op.NEG) and not self._geometric[i]

    def outer(self, i: int) -> bool:
        """Return whether node ``i`` is a sum that is not part of a larger sum."""
        return self._is_sum(i) and i not in self._inside

    def terms(self, root: int, built: Built) -> list[_Term]:
        """Return the addends of sum ``root`` as products, in order; like terms are combined."""
        terms: dict[tuple[int, ...], Exact] = {}  # coefficients by factors
        stack: list[tuple[int, Exact]] = [(root, ONE)]
        while stack:
            i, sign = stack.pop()
            node = self._nodes[i]
            if i == root or i in self._inside:
                if node.op is Op.NEG:
                    stack.append((node.args[0], -sign))
                else:
                    second = sign if node.op is Op.ADD else -sign
                    stack += [(node.args[1], second), (node.args[0], sign)]
            else:
                term = self._product(i, sign, built)
                terms[term.factors] = terms.get(term.factors, ZERO) + term.value
        return [_Term(value, factors) for factors, value in terms.items() if value]

    def _product(self, root: int, sign: Exact, built: Built) -> _Term:
        """Return node ``root`` as a constant times factors; products with other users are not taken apart."""
        value, factors, stack = sign, [], [root]
        while stack:
            i = stack.pop()
            node = self._nodes[i]
            if node.value is not None:
                value = value * node.value
            elif node.op is Op.MUL and self._uses[i] == 1 and not self._geometric[i]:
                stack += reversed(node.args)
            else:
                factors.append(built[i])
        return _Term(value, tuple(sorted(factors)))


def _common(terms: list[_Term]) -> int | None:
    """Return the factor that most products have in common, None if no two products of several factors share one."""
    counts: Counter[int] = Counter()
    for term in terms:
        if len(term.factors) > 1:
            counts.update(set(term.factors))
    candidates = {k: n for k, n in counts.items() if n > 1}
    return min(candidates, key=lambda k: (-candidates[k], k)) if candidates else None


def _sum(builder: Builder, terms: list[_Term]) -> int:
    """Return the sum of ``terms``, factored repeatedly."""
    common = _common(terms)
    if common is None or len(terms) == 1:
        return builder.sum(builder.mul(builder.const(t.value), builder.product(t.factors)) for t in terms)
    inner = [_without(term, common) for term in terms if common in term.factors]
    outer = [term for term in terms if common not in term.factors]
    product = builder.mul(common, _sum(builder, inner))
    return builder.add(_sum(builder, outer), product) if outer else product


def _without(term: _Term, common: int) -> _Term:
    at = term.factors.index(common)
    return _Term(term.value, term.factors[:at] + term.factors[at + 1 :])


# ---- products of three factors


def regroup_products(function: Function) -> Function:
    """Return ``function`` with fewer multiplications by constants and geometry-only values.

    c (x y) and c (x z) become (c x) y and (c x) z if x y and x z have no other users.
    """
    chosen = _choices(function)
    if not chosen:
        return function

    def rule(builder: Builder, i: int, node: Node, built: Built) -> int:
        if i not in chosen:
            return builder.again(node, _args(node, built))
        scalar, common, other = (built[arg] for arg in chosen[i])
        return builder.make(Op.MUL, (builder.make(Op.MUL, (scalar, common)), other))

    return _rewritten(function, rule)


def _choices(function: Function) -> dict[int, tuple[int, int, int]]:
    """Return (c, x, y) by node of c (x y), for each pair (c, x) that occurs at least twice."""
    nodes, early, uses = function.nodes, geometry_only(function), uses_of(function)
    places: defaultdict[tuple[int, int], list[tuple[int, int]]] = defaultdict(list)
    for i, node in enumerate(nodes):
        if node.op is not Op.MUL or early[i]:
            continue
        for scalar, product in (node.args, node.args[::-1]):
            inner = nodes[product]
            if early[scalar] and inner.op is Op.MUL and not early[product] and uses[product] == 1:
                a, b = inner.args
                if not early[a] and not early[b]:
                    places[scalar, a].append((i, b))
                    if a != b:
                        places[scalar, b].append((i, a))
    chosen: dict[int, tuple[int, int, int]] = {}
    for (scalar, common), products in sorted(places.items(), key=lambda item: (-len(item[1]), item[0])):
        free = [(i, other) for i, other in products if i not in chosen]
        if len(free) > 1:
            chosen.update({i: (scalar, common, other) for i, other in free})
    return chosen


# ---- signs


def prefer_positive_constants(function: Function) -> Function:
    """Return ``function`` with readable signs: a + (-20) x becomes a - 20 x. Counts and bits do not change."""
    nodes, uses = function.nodes, uses_of(function)

    def positive(builder: Builder, i: int, built: Built) -> int | None:
        """Return node ``i`` with a positive constant if it is a product with a negative one and a single user."""
        value = nodes[nodes[i].args[0]].value if nodes[i].op is Op.MUL and uses[i] == 1 else None
        if value is None or value.sign > 0:
            return None
        return builder.make(Op.MUL, (builder.const(-value), built[nodes[i].args[1]]))

    def rule(builder: Builder, i: int, node: Node, built: Built) -> int:
        if node.op in _SUMS:
            a, b = node.args
            term = positive(builder, b, built)
            if term is not None:
                return builder.make(Op.SUB if node.op is Op.ADD else Op.ADD, (built[a], term))
            term = positive(builder, a, built) if node.op is Op.ADD else None
            if term is not None:
                return builder.make(Op.SUB, (built[b], term))
        return builder.again(node, _args(node, built))

    return _rewritten(function, rule)
