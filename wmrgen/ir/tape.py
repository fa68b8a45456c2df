"""Writing operations in order: equal ones are shared, none is simplified.

The result of a float kernel depends on the order of its operations, so `wmrgen.ir.build` must not simplify them.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from wmrgen.geometry.exact.number import ZERO, Exact
from wmrgen.ir.nodes import Node, Op


class Tape:
    """The nodes of a new function; equal nodes are shared, and the methods return their ids."""

    __slots__ = ("_consts", "_index", "nodes")

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._index: dict[tuple[Op, Sequence[int], str | None], int] = {}
        self._consts: dict[Exact, int] = {}

    # ---- leaves

    def const(self, value: Exact | Fraction | int) -> int:
        """The node of a constant."""
        exact = Exact.of(value)
        index = self._consts.setdefault(exact, len(self.nodes))
        if index == len(self.nodes):
            self.nodes.append(Node(Op.CONST, value=exact))
        return index

    def input(self, name: str) -> int:
        """The node of an input port."""
        return self.put(Op.INPUT, name=name)

    def value(self, a: int) -> Exact | None:
        """Return the value of node ``a`` if it is a constant, else None."""
        return self.nodes[a].value

    # ---- operations

    def put(self, op: Op, *args: int, name: str | None = None) -> int:
        """The node of an operation."""
        index = self._index.setdefault((op, args, name), len(self.nodes))
        if index == len(self.nodes):
            self.nodes.append(Node(op, args, name=name))
        return index

    def copy(self, node: Node, args: Sequence[int]) -> int:
        """Return ``node`` of another function; ``args`` are ids of this one."""
        return self.put(node.op, *args, name=node.name) if node.value is None else self.const(node.value)

    def call(self, kernel: str, *args: int) -> int:
        """A call of a kernel, see `wmrgen.ir.calls`."""
        return self.put(Op.CALL, *args, name=kernel)

    def result(self, call: int, number: int) -> int:
        """One of several results of a call."""
        return self.put(Op.RESULT, call, name=str(number))

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
        """Return x if a < b, else y.

        Args:
            a: the node on the left of the comparison.
            b: the node on the right.
            x: the result if a < b.
            y: the result otherwise.

        Returns:
            The node of the choice.
        """
        return self.put(Op.SELECT, a, b, x, y)

    def horner(self, x: int, coefficients: tuple[Exact, ...]) -> int:
        """c0 + x (c1 + x (c2 + ...)), from the innermost product outwards."""
        *rest, last = coefficients
        total = self.const(last)
        for c in reversed(rest):
            total = self.add(self.mul(x, total), self.const(c))
        return total

    def neg(self, a: int) -> int:
        """-a; a constant if ``a`` is one."""
        node = self.nodes[a]
        if node.value is not None:
            return self.const(-node.value)
        return node.args[0] if node.op is Op.NEG else self.put(Op.NEG, a)


def compared(tape: Tape, op: Op, a: int, b: int) -> int:
    """Write CLAMP, AT_LEAST or WITH_SIGN_OF with comparisons, for code that does not read the bits of a float.

    Args:
        tape: the nodes.
        op: the operation.
        a: its first argument.
        b: its second argument.

    Returns:
        The node of the result.
    """
    match op:
        case Op.CLAMP:
            return tape.put(Op.MAX, tape.put(Op.MIN, a, b), tape.neg(b))
        case Op.AT_LEAST:
            return compared(tape, Op.WITH_SIGN_OF, tape.put(Op.MAX, tape.put(Op.ABS, a), b), a)
        case _:
            return tape.select(b, tape.const(ZERO), tape.neg(a), a)
