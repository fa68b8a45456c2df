"""Programs of linear maps as graphs, and their transposes.

Every node has the value  factor * (+- source +- source ...).  Reversing all edges of a graph of a
map M gives a graph of its transpose with the same multiplications, and as many more additions as
M has more rows than columns (Tellegen's principle). So a program may be sought on either side.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field

from wmrgen.exact.number import ONE, Exact

Edge = tuple[int, int]  # (node, sign)


@dataclass(frozen=True, slots=True)
class Coefficient:
    """``value`` times an opaque non-zero quantity ``atom`` (None: nothing but the value)."""

    value: Exact
    atom: Hashable = None


class Magnitudes:
    """Coefficients up to sign as small integers; 0 is the coefficient one.

    The sign is that of the first non-zero part, not of the number: cheap, and as good here.
    """

    __slots__ = ("_index", "_ratios", "table")

    def __init__(self) -> None:
        self.table: list[Coefficient] = []
        self._index: dict[tuple[Exact, Hashable], int] = {}
        self._ratios: dict[tuple[int, int], tuple[int, int] | None] = {}
        self.split(Coefficient(ONE))

    def split(self, coefficient: Coefficient) -> tuple[int, int]:
        """(magnitude, sign) of a non-zero coefficient."""
        value, sign = coefficient.value, 1
        for part in value.num:
            if part:
                if part < 0:
                    value, sign = -value, -1
                break
        key = (value, coefficient.atom)
        found = self._index.get(key)
        if found is None:
            found = self._index[key] = len(self.table)
            self.table.append(Coefficient(value, coefficient.atom))
        return found, sign

    def ratio(self, a: int, b: int) -> tuple[int, int] | None:
        """a / b as (magnitude, sign); None where it is no coefficient."""
        if a == b:
            return 0, 1
        if b == 0:
            return a, 1
        if (a, b) not in self._ratios:
            p, q = self.table[a], self.table[b]
            known = q.atom is None or q.atom == p.atom
            atom = None if q.atom == p.atom else p.atom
            self._ratios[a, b] = self.split(Coefficient(p.value / q.value, atom)) if known else None
        return self._ratios[a, b]


@dataclass(slots=True)
class Graph:
    """Nodes 0 .. inputs-1 are the inputs. ``outputs[i]`` is a signed node, None for zero."""

    inputs: int
    factors: list[int] = field(default_factory=list)
    sources: list[list[Edge]] = field(default_factory=list)
    outputs: list[Edge | None] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.factors += [0] * self.inputs
        self.sources += [[] for _ in range(self.inputs)]

    def add(self, sources: list[Edge], factor: int = 0) -> Edge:
        """The signed node of factor * sum; an old one where nothing has to be computed."""
        if len(sources) == 1 and factor == 0:
            return sources[0]
        self.factors.append(factor)
        self.sources.append(sources)
        return len(self.factors) - 1, 1

    @property
    def cost(self) -> tuple[int, int]:
        """(additions + multiplications, multiplications)."""
        multiplications = sum(1 for factor in self.factors if factor)
        additions = sum(len(edges) - 1 for edges in self.sources if edges)
        return additions + multiplications, multiplications


def transpose(graph: Graph) -> Graph:
    """The graph of the transposed map; it has no unneeded nodes when ``graph`` has none."""
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
    made: list[Edge | None] = [None] * size
    for node in range(size - 1, -1, -1):
        inflow = list(place[node])
        for user, sign in users[node]:
            edge = made[user]
            if edge is not None:
                inflow.append((edge[0], edge[1] * sign))
        if inflow:
            made[node] = turned.add(inflow, graph.factors[node])
    turned.outputs = [made[i] for i in range(graph.inputs)]
    return turned
