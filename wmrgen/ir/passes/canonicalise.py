"""Canonical form: every operation through the simplifying rules of the builder."""

from __future__ import annotations

from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function


def canonicalise(function: Function) -> Function:
    """Constants folded, equal operations shared, constant factors in front, unneeded nodes gone."""
    builder = Builder()
    made: list[int] = []
    for node in function.nodes:
        made.append(builder.copy(node, [made[arg] for arg in node.args]))
    results = [made[result] for result in function.results]
    return builder.function(function.name, function.inputs, function.outputs, results, function.text)
