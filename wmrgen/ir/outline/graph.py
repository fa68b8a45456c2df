"""The nodes of several functions side by side, with what is needed to find parts that repeat."""

from __future__ import annotations

from collections.abc import Sequence

from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.outline.undo import calls
from wmrgen.ir.prune import pruned

_COMMUTE = frozenset({Op.ADD, Op.MUL, Op.FMA})  # FMA in its first two arguments
_DEPTH = 3  # levels of arguments by which the order of two that commute is settled


class Graph:
    """Nodes are numbered through all functions, arguments first; constants and inputs are leaves.

    ``shapes[d]``: numbers of the forms that the nodes have, seen ``d`` levels deep.
    """

    __slots__ = ("above", "calls", "names", "nodes", "results", "shapes", "together", "users")

    def __init__(self, functions: Sequence[Function]) -> None:
        self.nodes: list[Node] = []
        self.results: list[tuple[int, ...]] = []
        self.names: list[tuple[tuple[str, int], ...]] = []  # intermediate results, per function
        for function in functions:
            short, start = pruned(function), len(self.nodes)
            self.nodes += [Node(n.op, tuple(start + a for a in n.args), n.value, n.name) for n in short.nodes]
            self.names.append(tuple((name, start + k) for name, k in short.named))
            self.results.append(tuple(start + r for r in short.results))
        self.shapes = self._seen()
        for i, node in enumerate(self.nodes):
            if node.op in _COMMUTE:
                self.nodes[i] = Node(node.op, self._settled(node), node.value, node.name)
        self.shapes = self._seen()
        self.users: list[list[int]] = [[] for _ in self.nodes]
        self.together = {n.args[0] for n in self.nodes if n.op is Op.PART}  # calls with several results
        self.calls = calls(self.nodes)
        self.above: list[int] = []  # bit masks: a node and all that it is computed from
        for i, node in enumerate(self.nodes):
            mask = 1 << i
            for arg in dict.fromkeys(node.args):
                self.users[arg].append(i)
                mask |= self.above[arg]
            self.above.append(mask)

    def free(self, i: int) -> bool:
        """Whether node ``i`` can belong to a part: it is no input and no constant."""
        return bool(self.nodes[i].args)

    def _seen(self) -> list[list[int]]:
        """The forms of the nodes from 0 levels deep (all one) to `_DEPTH`."""
        found = [[0 if n.args or n.value is None else 1 for n in self.nodes]]
        for _ in range(_DEPTH):
            index: dict[object, int] = {}
            last = found[-1]
            found.append([index.setdefault(self._form(node, last), len(index)) for node in self.nodes])
        return found

    def _form(self, node: Node, last: list[int]) -> object:
        if node.op is Op.INPUT:
            return "input"
        return node.op, node.name, node.value, tuple(last[a] for a in node.args)

    def _settled(self, node: Node) -> tuple[int, ...]:
        """The arguments of an operation that commutes, in an order that its form decides."""

        def rank(a: int) -> tuple[object, ...]:
            argument = self.nodes[a]
            seen = (self.shapes[depth][a] for depth in range(1, _DEPTH + 1))
            return argument.value is None, argument.op is not Op.INPUT, argument.op.value, *seen

        return (*sorted(node.args[:2], key=rank), *node.args[2:])
