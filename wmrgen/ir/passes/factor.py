"""Common non-constant factors of sums:  k a + k b  becomes  k (a + b).

Only products that nothing else uses are taken apart, so that every step saves a multiplication.
Constant and geometry-only factors are left to the linear forms.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Op

_SUMS = (Op.ADD, Op.SUB)


@dataclass(frozen=True, slots=True)
class _Term:
    """``value`` times the product of ``factors`` (nodes of the builder, sorted)."""

    value: Exact
    factors: tuple[int, ...]


def factor(function: Function) -> Function:
    """``function`` with common factors taken out of its sums."""
    return _Factoring(function).run()


class _Factoring:
    def __init__(self, function: Function) -> None:
        self._function, self._builder = function, Builder()
        self._made: list[int] = []
        self._known = geometry_only(function)
        self._uses = Counter(arg for node in function.nodes for arg in node.args)
        self._uses.update(function.results)
        self._inside = self._inner_sums()

    def _inner_sums(self) -> set[int]:
        """Sums, negations and scalings that only a larger sum uses."""
        inside: set[int] = set()
        for i, node in enumerate(self._function.nodes):
            if self._is_sum(i) or i in inside:
                inside.update(arg for arg in node.args if self._uses[arg] == 1 and self._is_sum(arg))
        return inside

    def _is_sum(self, i: int) -> bool:
        return self._function.nodes[i].op in (*_SUMS, Op.NEG) and not self._known[i]

    def run(self) -> Function:
        function, builder, made = self._function, self._builder, self._made
        for i, node in enumerate(function.nodes):
            plain = not self._is_sum(i) or i in self._inside
            terms = None if plain else self._terms(i)
            if terms is not None and self._common(terms) is not None:
                made.append(self._sum(terms))
            else:
                made.append(builder.copy(node, [made[arg] for arg in node.args]))
        results = [made[result] for result in function.results]
        return builder.function(function.name, function.inputs, function.outputs, results, function.text)

    def _terms(self, root: int) -> list[_Term]:
        """The addends of ``root`` as products, in order."""
        terms: dict[tuple[int, ...], Exact] = {}  # like terms meet
        stack: list[tuple[int, Exact]] = [(root, ONE)]
        while stack:
            i, sign = stack.pop()
            node = self._function.nodes[i]
            if i == root or i in self._inside:
                if node.op is Op.NEG:
                    stack.append((node.args[0], -sign))
                else:
                    second = sign if node.op is Op.ADD else -sign
                    stack += [(node.args[1], second), (node.args[0], sign)]
            else:
                term = self._product(i, sign)
                terms[term.factors] = terms.get(term.factors, ZERO) + term.value
        return [_Term(value, factors) for factors, value in terms.items() if value]

    def _product(self, root: int, sign: Exact) -> _Term:
        """Node ``root`` as constant times factors; products used elsewhere stay whole."""
        value, factors, stack = sign, [], [root]
        while stack:
            i = stack.pop()
            node = self._function.nodes[i]
            if node.value is not None:
                value = value * node.value
            elif node.op is Op.MUL and self._uses[i] == 1 and not self._known[i]:
                stack += reversed(node.args)
            else:
                factors.append(self._made[i])
        return _Term(value, tuple(sorted(factors)))

    def _common(self, terms: list[_Term]) -> int | None:
        """The factor that most products hold, at least two; products of one factor do not count."""
        counts: Counter[int] = Counter()
        for term in terms:
            if len(term.factors) > 1:
                counts.update(set(term.factors))
        candidates = {k: n for k, n in counts.items() if n > 1}
        return min(candidates, key=lambda k: (-candidates[k], k)) if candidates else None

    def _sum(self, terms: list[_Term]) -> int:
        """The sum of ``terms``, factored as often as it can be."""
        builder = self._builder
        common = self._common(terms)
        if common is None or len(terms) == 1:
            return builder.sum(self._value(term) for term in terms)
        inner = [_without(term, common) for term in terms if common in term.factors]
        outer = [term for term in terms if common not in term.factors]
        product = builder.mul(common, self._sum(inner))
        return builder.add(self._sum(outer), product) if outer else product

    def _value(self, term: _Term) -> int:
        builder = self._builder
        return builder.mul(builder.const(term.value), builder.product(term.factors))


def _without(term: _Term, factor: int) -> _Term:
    at = term.factors.index(factor)
    return _Term(term.value, term.factors[:at] + term.factors[at + 1 :])
