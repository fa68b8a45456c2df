"""Programs of linear maps y = M t as graphs, their transposes, and the operations that they become.

Every node has the value  factor * (+- source +- source ...).  Reversing all edges of a graph of M gives a graph of its
transpose. It has the same multiplications, and as many more additions as M has more rows than columns (Tellegen's
principle). So a program may be searched for on either side.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from wmrgen.geometry.exact.number import ONE, Exact
from wmrgen.ir.build import Builder

Edge = tuple[int, int]  # (node, sign)


class Coefficient(NamedTuple):
    """A coefficient of a linear map: a number times a quantity that is known to be non-zero."""

    value: Exact
    atom: Hashable = None  # the quantity; None if the coefficient is a number


class Magnitudes:
    """Numbers coefficients up to their sign; number 0 is the coefficient one.

    The sign is taken from the first non-zero part of a number of the field. It need not be that of the number, but it
    is cheap to find and serves as well.
    """

    __slots__ = ("_index", "_inverses", "_ratios", "table")

    def __init__(self) -> None:
        self.table: list[Coefficient] = []
        self._index: dict[tuple[Exact, Hashable], int] = {}
        self._inverses: dict[int, Exact] = {}
        self._ratios: dict[tuple[int, int], tuple[int, int] | None] = {}
        self.split(Coefficient(ONE))

    def split(self, coefficient: Coefficient) -> tuple[int, int]:
        """Return (magnitude, sign) of a non-zero coefficient."""
        value, sign = coefficient.value, 1
        for part in value.num:
            if part:
                if part < 0:
                    value, sign = -value, -1
                break
        key = (value, coefficient.atom)
        index = self._index.get(key)
        if index is None:
            index = self._index[key] = len(self.table)
            self.table.append(Coefficient(value, coefficient.atom))
        return index, sign

    def ratio(self, a: int, b: int) -> tuple[int, int] | None:
        """Return a / b as (magnitude, sign), or None if it is not a coefficient."""
        if a == b:
            return 0, 1
        if b == 0:
            return a, 1
        if (a, b) not in self._ratios:
            p, q = self.table[a], self.table[b]
            comparable = q.atom is None or q.atom == p.atom
            atom = None if q.atom == p.atom else p.atom
            if comparable and b not in self._inverses:  # each divides many others
                self._inverses[b] = q.value.inverse()
            self._ratios[a, b] = (
                self.split(Coefficient(p.value * self._inverses[b], atom)) if comparable else None
            )
        return self._ratios[a, b]


@dataclass(slots=True)
class Graph:
    """A program of a linear map. Nodes 0 .. inputs-1 are its inputs."""

    inputs: int
    factors: list[int] = field(default_factory=list)  # magnitude by node
    sources: list[list[Edge]] = field(default_factory=list)  # signed addends by node
    outputs: list[Edge | None] = field(default_factory=list)  # signed nodes, None for zero

    def __post_init__(self) -> None:
        self.factors += [0] * self.inputs
        self.sources += [[] for _ in range(self.inputs)]

    def add(self, sources: list[Edge], factor: int = 0) -> Edge:
        """Return the signed node of factor * sum; a source itself if nothing has to be computed."""
        if len(sources) == 1 and factor == 0:
            return sources[0]
        self.factors.append(factor)
        self.sources.append(sources)
        return len(self.factors) - 1, 1

    @property
    def cost(self) -> tuple[int, int]:
        """Return (additions + multiplications, multiplications)."""
        multiplications = sum(1 for factor in self.factors if factor)
        additions = sum(len(edges) - 1 for edges in self.sources if edges)
        return additions + multiplications, multiplications


def transpose(graph: Graph) -> Graph:
    """Return the graph of the transposed map; it has no unneeded nodes if ``graph`` has none."""
    size = len(graph.factors)
    users: list[list[Edge]] = [[] for _ in range(size)]
    for node, edges in enumerate(graph.sources):
        for source, sign in edges:
            users[source].append((node, sign))
    turned = Graph(len(graph.outputs))
    place: list[list[Edge]] = [[] for _ in range(size)]  # what flows into each node from the outputs
    for i, output in enumerate(graph.outputs):
        if output is not None:
            place[output[0]].append((i, output[1]))
    turned_edges: list[Edge | None] = [None] * size
    for node in range(size - 1, -1, -1):
        inflow = list(place[node])
        for user, sign in users[node]:
            edge = turned_edges[user]
            if edge is not None:
                inflow.append((edge[0], edge[1] * sign))
        if inflow:
            turned_edges[node] = turned.add(inflow, graph.factors[node])
    turned.outputs = [turned_edges[i] for i in range(graph.inputs)]
    return turned


Scale = Callable[[Coefficient, int], int]  # coefficient times node


class Emitter:
    """Makes the nodes of one program, those of each output when it is requested; its terms must exist by then."""

    def __init__(self, graph: Graph, factors: Sequence[Coefficient], builder: Builder, scale: Scale) -> None:
        self._graph, self._builder, self._scale = graph, builder, scale
        self._factors = factors
        self._signs = polarities(graph)
        self._place: dict[int, int] = {}

    def output(self, index: int, term: Callable[[int], int]) -> int:
        """Return the builder's node of output ``index``; ``term(j)`` is that of input j."""
        edge = self._graph.outputs[index]
        if edge is None:
            return self._builder.const(Exact(0))
        nodes, graph = self._place, self._graph
        stack = [edge[0]]
        while stack:
            node = stack[-1]
            missing = [source for source, _ in graph.sources[node] if source not in nodes]
            if node in nodes or not missing:
                stack.pop()
                if node not in nodes:
                    nodes[node] = term(node) if node < graph.inputs else self._emit(node)
            else:
                stack += missing
        result = nodes[edge[0]]
        return result if edge[1] == self._signs[edge[0]] else self._builder.neg(result)

    def _emit(self, node: int) -> int:
        signs, polarity = self._signs, self._signs[node]
        edges = [(source, sign * signs[source]) for source, sign in self._graph.sources[node]]
        factor = self._factors[self._graph.factors[node]]
        if self._graph.factors[node]:
            flip = 1 if any(sign > 0 for _, sign in edges) else -1
            total = self._sum([(source, sign * flip) for source, sign in edges])
            value = factor.value if flip == polarity else -factor.value
            return self._scale(Coefficient(value, factor.atom), total)
        return self._sum([(source, sign * polarity) for source, sign in edges])

    def _sum(self, edges: Sequence[Edge]) -> int:
        """Return the sum of signed nodes, starting with a positive one."""
        first = next((k for k, (_, sign) in enumerate(edges) if sign > 0), None)
        builder, nodes = self._builder, self._place
        if first is None:
            return builder.neg(self._sum([(node, -sign) for node, sign in edges]))
        total = nodes[edges[first][0]]
        for k, (node, sign) in enumerate(edges):
            if k != first:
                total = builder.add(total, nodes[node]) if sign > 0 else builder.sub(total, nodes[node])
        return total


def polarities(graph: Graph) -> list[int]:
    """Return by node 1 if it is computed and -1 if its negative is, so that every sum has a positive term.

    A product can have either sign at no cost, because its constant changes. A sum can if one of its terms is positive.
    The signs that users need are passed from the outputs down, then corrected from the inputs up where a sum has no
    positive term.
    """
    size = len(graph.factors)
    wish = [0] * size
    for output in graph.outputs:
        if output is not None and not wish[output[0]]:
            wish[output[0]] = output[1]
    for node in range(graph.inputs):
        wish[node] = 1
    for node in range(size - 1, graph.inputs - 1, -1):
        sign = wish[node] or 1
        wish[node] = sign
        edges = graph.sources[node]
        if graph.factors[node] or any(wish[source] == s * sign for source, s in edges):
            continue
        free = [(source, s) for source, s in edges if not wish[source]]
        for source, s in sorted(free, key=lambda edge: not graph.factors[edge[0]])[:1]:
            wish[source] = s * sign
    for node in range(graph.inputs, size):
        edges = graph.sources[node]
        if not graph.factors[node] and all(wish[source] * s != wish[node] for source, s in edges):
            wish[node] = -wish[node]
    return wish
