"""Fewer and cheaper divisions.

Constant divisors are gone since the builder saw them. A division by a geometry-only value becomes
a product with its reciprocal, which `hoist` moves to `prepare`. Several divisions by one value
share a reciprocal where that value is known to be far enough from zero for it not to overflow.
"""

from __future__ import annotations

from collections import defaultdict
from fractions import Fraction

from wmrgen.exact.number import ONE
from wmrgen.ir.build import Builder
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.passes.guards import facts

_FAR = Fraction(1, 2**64)


def reduce_strength(function: Function) -> Function:
    """``function`` with divisions replaced by products where that is safe."""
    if all(node.op is not Op.DIV for node in function.nodes):
        return function
    known, shared = geometry_only(function), _shared_divisors(function)
    builder = Builder()
    made: list[int] = []
    for i, node in enumerate(function.nodes):
        args = [made[arg] for arg in node.args]
        if node.op is Op.DIV and ((known[node.args[1]] and not known[i]) or node.args[1] in shared):
            reciprocal = builder.div(builder.const(ONE), args[1])
            made.append(builder.mul(args[0], reciprocal))
        else:
            made.append(builder.copy(node, args))
    results = [made[result] for result in function.results]
    return builder.function(function.name, function.inputs, function.outputs, results, function.text)


def _shared_divisors(function: Function) -> set[int]:
    dividends: defaultdict[int, set[int]] = defaultdict(set)
    for node in function.nodes:
        if node.op is Op.DIV:
            dividends[node.args[1]].add(node.args[0])
    repeated = {divisor for divisor, found in dividends.items() if len(found) > 1}
    if not repeated:
        return repeated
    fact = facts(function)
    return {divisor for divisor in repeated if fact[divisor].away >= _FAR}
