"""Cheap programs of linear maps y = M t with exact coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from wmrgen.exact.number import Exact
from wmrgen.ir.build import Builder
from wmrgen.ir.linear.emit import Emitter
from wmrgen.ir.linear.graph import Coefficient, Graph, Magnitudes
from wmrgen.ir.linear.search import cheapest

__all__ = ["Coefficient", "Emitter", "Graph", "Magnitudes", "apply_matrix", "cheapest"]


def apply_matrix(builder: Builder, rows: Sequence[Sequence[Exact]], terms: Sequence[int]) -> list[int]:
    """The nodes of y = M t for a matrix of rows x len(terms), by the cheapest program found."""
    magnitudes = Magnitudes()
    sparse: list[Mapping[int, Coefficient]] = [
        {j: Coefficient(value) for j, value in enumerate(row) if value} for row in rows
    ]
    graph = cheapest(sparse, len(terms), magnitudes)

    def scale(coefficient: Coefficient, node: int) -> int:
        return builder.mul(builder.const(coefficient.value), node)

    emitter = Emitter(graph, magnitudes, builder, scale)
    term: Callable[[int], int] = terms.__getitem__
    return [emitter.output(i, term) for i in range(len(rows))]
