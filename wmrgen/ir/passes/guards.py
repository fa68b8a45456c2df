"""Proof that no quotient has a zero divisor and no square root a negative argument.

Every node gets an enclosing interval, a bound away from zero, and whether it can be zero at all.
What a `select` has compared is used for the branch that it chooses between the values compared.
"""

from __future__ import annotations

from dataclasses import dataclass

from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.ops.analysis import Fact


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
    """Every operation of ``function`` that is not shown to be defined: divisions and square roots, say."""
    known = geometry_only(function)
    fact = facts(function)
    return tuple(
        Finding(function.name, i, node.op.needs[2], known[node.args[node.op.needs[0]]])
        for i, node in enumerate(function.nodes)
        if node.op.needs and not getattr(fact[node.args[node.op.needs[0]]], node.op.needs[1])
    )


def facts(function: Function) -> list[Fact]:
    """A fact for every node, in list order."""
    known: list[Fact] = []
    for node in function.nodes:
        if node.value is not None:
            known.append(Fact.between(node.value, node.value))
            continue
        op, args = node.meaning
        below = [known[arg] for arg in args]
        if op is Op.SELECT:
            below[2:] = (_chosen(function.nodes, known, node, branch) for branch in (2, 3))
        known.append(op.fact(*below))
    return known


def _chosen(nodes: tuple[Node, ...], known: list[Fact], node: Node, branch: int) -> Fact:
    """The fact of a branch of a select, knowing how the comparison went there."""
    small, large = (node.args[0], node.args[1]) if branch == 2 else (node.args[1], node.args[0])
    value, strict = node.args[branch], branch == 2
    fact, below, above = known[value], known[small], known[large]
    if value == large and below.lo is not None:  # value > small or value >= small
        lo = below.lo if fact.lo is None else max(fact.lo, below.lo)
        return Fact.between(lo, fact.hi, fact.away, fact.nonzero or (strict and below.lo >= 0))
    if value == small and above.hi is not None:
        hi = above.hi if fact.hi is None else min(fact.hi, above.hi)
        return Fact.between(fact.lo, hi, fact.away, fact.nonzero or (strict and above.hi <= 0))
    return fact
