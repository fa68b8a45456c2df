"""Parts that repeat, grown from equal operations: what stands next to all places alike joins."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence

from wmrgen.ir.nodes import Op
from wmrgen.ir.outline.graph import Graph
from wmrgen.ir.outline.pattern import Pattern, pattern, widened
from wmrgen.ir.outline.sizes import Sizes

_SEEDS = 24
_LONGEST = 100  # nodes of a part
Column = dict[int, int]  # number of the place -> its node


def best(graph: Graph, sizes: Sizes) -> Pattern | None:
    """The part that saves most when it is written once; None when none saves anything."""
    found: Pattern | None = None
    tried: set[tuple[int, ...]] = set()
    for seed in _seeds(graph):
        if seed not in tried:
            growth = _Growth(graph, seed)
            made = max(growth.patterns(sizes), key=lambda p: p.saved, default=None)
            tried |= growth.columns
            if made is not None:
                made = widened(graph, made, sizes)
                if found is None or made.saved > found.saved:
                    found = made
    return found


def _seeds(graph: Graph) -> list[tuple[int, ...]]:
    """Nodes of equal form, the most frequent first."""
    groups: dict[tuple[int, ...], None] = {}
    for depth in (1, 2, 3):
        found: dict[int, list[int]] = defaultdict(list)
        for i, form in enumerate(graph.shapes[depth]):
            if graph.free(i) and graph.nodes[i].op not in (Op.CALL, Op.PART):
                found[form].append(i)
        groups |= {tuple(group): None for group in found.values() if len(group) > 1}
    return sorted(groups, key=lambda g: (-len(g), g))[:_SEEDS]


class _Growth:
    """Places that grow together by one node at a time; a place that lacks it is left behind."""

    def __init__(self, graph: Graph, seed: Sequence[int]) -> None:
        self.graph = graph
        self.places = {n: [i] for n, i in enumerate(seed)}
        self.inside = {n: {i: 0} for n, i in enumerate(seed)}  # node -> its position
        self.beside: list[Column] = list(self._neighbours(0))
        self.columns: set[tuple[int, ...]] = set()  # nodes that stood at one position of a part

    def patterns(self, sizes: Sizes) -> Iterator[Pattern]:
        """Parts on the way: before one that asks for more parameters, or that a place lacks."""
        while True:
            choice = self._choice()
            if choice is None or choice[0] < len(self.places) or choice[1] > 0:
                made = pattern(self.graph, [tuple(place) for place in self.places.values()], sizes)
                if made is not None:
                    self.columns |= {tuple(sorted(c)) for c in zip(*self.places.values(), strict=True)}
                    yield made
            if choice is None or len(self.places[next(iter(self.places))]) == _LONGEST:
                return
            self._join(choice[2])

    def _choice(self) -> tuple[int, int, Column] | None:
        """Who joins: at how many places, how many more values must then be handed in, the node of each."""
        n = next(iter(self.places))
        nodes, inside = self.graph.nodes, self.inside[n]
        needed = {a for k in inside for a in nodes[k].args}
        best: tuple[int, int, Column] | None = None
        kept: list[Column] = []
        for column in self.beside:
            left = {n: i for n, i in column.items() if n in self.places and i not in self.inside[n]}
            if len(left) < 2:
                continue
            kept.append(left)
            if best is not None and len(left) < best[0]:
                continue
            first = next(iter(left))
            if first != n:
                n = first
                inside = self.inside[n]
                needed = {a for k in inside for a in nodes[k].args}
            i = left[n]
            new = sum(
                a not in inside and a not in needed and nodes[a].value is None for a in set(nodes[i].args)
            )
            asked = new - (i in needed)
            if best is None or (len(left), -asked) > (best[0], -best[1]):
                best = len(left), asked, left
        self.beside = kept
        return best

    def _join(self, column: Column) -> None:
        self.places = {n: [*place, column[n]] for n, place in self.places.items() if n in column}
        position = len(next(iter(self.places.values()))) - 1
        for n in self.places:
            self.inside[n][column[n]] = position
        self.beside += self._neighbours(position)

    def _neighbours(self, k: int) -> Iterator[Column]:
        """Arguments and users, of one operation each, of the nodes at position ``k``."""
        nodes, users = self.graph.nodes, self.graph.users
        at = {n: place[k] for n, place in self.places.items()}
        for position in range(len(nodes[next(iter(at.values()))].args)):
            groups: dict[object, Column] = {}
            for n, i in at.items():
                arg = nodes[i].args[position]
                if self.graph.free(arg):
                    groups.setdefault((nodes[arg].op, nodes[arg].name), {})[n] = arg
            yield from (column for column in groups.values() if len(column) > 1)
        groups, taken = {}, set()
        for n, i in at.items():
            for user in filter(self.graph.free, users[i]):
                key = nodes[user].op, nodes[user].name, self._ends(user, n)
                column = groups.setdefault(key, {})
                if n not in column and user not in self.inside[n] and user not in taken:
                    column[n] = user
                    taken.add(user)
        yield from (column for column in groups.values() if len(column) > 1)

    def _ends(self, i: int, n: int) -> tuple[object, ...]:
        """Which arguments of ``i`` belong to place ``n``, and which constants it takes."""
        nodes, inside = self.graph.nodes, self.inside[n]
        return tuple(inside.get(a, nodes[a].value) for a in nodes[i].args)
