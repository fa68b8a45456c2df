"""Writes operations down as they stand: equal ones once, none simplified.

The order of float operations is what a kernel is, so the rules of `wmrgen.ir.build` must not touch it.
"""

from __future__ import annotations

from wmrgen.exact.number import ZERO, Exact
from wmrgen.ir.nodes import Node, Op


class Tape:
    """Nodes of a new function, by hash-consing; the methods return their ids."""

    __slots__ = ("_consts", "_index", "_kept", "nodes")

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._index: dict[tuple[Op | str | None, tuple[int, ...]], int] = {}
        self._consts: dict[Exact, int] = {}
        self._kept: dict[
            int, tuple[Exact, int]
        ] = {}  # by identity: the constants of kernels come again and again

    def copy(self, node: Node, args: tuple[int, ...]) -> int:
        """``node`` of another function over ``args``."""
        if node.value is not None:
            return self.const(node.value)
        if node.name is not None:  # an input, a call or a part of one
            return self._new((f"{node.op} {node.name}", args), Node(node.op, args, name=node.name))
        return self.put(node.op, *args)

    def input(self, name: str) -> int:
        """An input."""
        return self.copy(Node(Op.INPUT, name=name), ())

    def call(self, kernel: str, *args: int) -> int:
        """A call of a kernel."""
        return self.copy(Node(Op.CALL, name=kernel), args)

    def result(self, call: int, number: int) -> int:
        """One of several results of a call."""
        return self.copy(Node(Op.RESULT, name=str(number)), (call,))

    def put(self, op: Op, *args: int) -> int:
        """The node of an operation."""
        found = self._index.get((op, args))
        return self._new((op, args), Node(op, args)) if found is None else found

    def _new(self, key: tuple[Op | str | None, tuple[int, ...]], node: Node) -> int:
        found = self._index.setdefault(key, len(self.nodes))
        if found == len(self.nodes):
            self.nodes.append(node)
        return found

    def const(self, value: Exact) -> int:
        """A constant."""
        kept = self._kept.get(id(value))
        if kept is not None:
            return kept[1]
        found = self._consts.setdefault(value, len(self.nodes))
        if found == len(self.nodes):
            self.nodes.append(Node(Op.CONST, value=value))
        self._kept[id(value)] = value, found
        return found

    def add(self, a: int, b: int) -> int:
        """a + b."""
        return self.put(Op.ADD, a, b)

    def sub(self, a: int, b: int) -> int:
        """a - b."""
        return self.put(Op.SUB, a, b)

    def mul(self, a: int, b: int) -> int:
        """a * b."""
        return self.put(Op.MUL, a, b)

    def div(self, a: int, b: int) -> int:
        """a / b."""
        return self.put(Op.DIV, a, b)

    def select(self, a: int, b: int, x: int, y: int) -> int:
        """x where a < b, else y."""
        return self.put(Op.SELECT, a, b, x, y)

    def horner(self, x: int, coefficients: tuple[Exact, ...]) -> int:
        """c0 + x (c1 + x (c2 + ...)), the last product computed first."""
        *rest, last = coefficients
        total = self.const(last)
        for c in reversed(rest):
            total = self.add(self.mul(x, total), self.const(c))
        return total

    def opposite(self, a: int) -> int:
        """-a; of a constant, a constant."""
        node = self.nodes[a]
        if node.value is not None:
            return self.const(-node.value)
        return node.args[0] if node.op is Op.NEG else self.put(Op.NEG, a)


def compared(tape: Tape, op: Op, a: int, b: int) -> int:
    """CLAMP, AT_LEAST or WITH_SIGN_OF by comparisons, for code that does not read the bits of a float."""
    match op:
        case Op.CLAMP:
            return tape.put(Op.MAX, tape.put(Op.MIN, a, b), tape.opposite(b))
        case Op.AT_LEAST:
            return compared(tape, Op.WITH_SIGN_OF, tape.put(Op.MAX, tape.put(Op.ABS, a), b), a)
        case _:
            return tape.select(b, tape.const(ZERO), tape.opposite(a), a)
