"""Signs as bits, for processors where a comparison costs more.

"-x where a < 0, else x" is x times the sign of a. Products, quotients, sines and arctangents hand a sign on, so it
travels to where a constant takes it in, and the comparison is gone. Signs by the parity of a whole number travel too,
to the very end, where they are stored with the value. (-0 counts as negative: it stands for a velocity
of zero, and both directions of the line across it are right. So that a function decides once, a comparison with zero
becomes a sign only where every choice that asks it is one between a value and its opposite.)
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.kernels.tape import Tape
from wmrgen.ir.nodes import Function, Node, Op, prune

_ODD = (Op.NEG, Op.ATAN, Op.SIN)
_EXTREMES = (Op.MIN, Op.MAX)


Sign = tuple[Op, int]  # SIGNED or FLIP, and by which node


@dataclass(frozen=True, slots=True)
class _Signed:
    """Node ``core`` times signs, each at most once."""

    core: int
    by: frozenset[Sign] = frozenset()


def signs_as_bits(function: Function) -> Function:
    """``function`` with `Op.WITH_SIGN_OF` in the place of choices between a value and its opposite."""
    return _Signs(function).run()


class _Signs:
    def __init__(self, function: Function) -> None:
        self.function, self.tape = function, Tape()
        self.uses = Counter(a for node in function.nodes for a in node.args) + Counter(function.results)
        self.made: list[_Signed] = []
        self.compared = {
            node.args[:2]
            for node in function.nodes
            if node.op is Op.SELECT and not self._between_opposites(node)
        }

    def run(self) -> Function:
        for i, node in enumerate(self.function.nodes):
            found = self._node(node)
            self.made.append(found if self.uses[i] == 1 else _Signed(self._whole(found)))
        nodes, results = prune(self.tape.nodes, [self._whole(self.made[r]) for r in self.function.results])
        return replace(self.function, nodes=nodes, results=results)

    def _whole(self, value: _Signed) -> int:
        """The node of a value with its signs, those by parity last."""
        made = value.core
        for op, b in sorted(value.by, key=lambda sign: (sign[0] is Op.FLIP, sign[1])):
            made = self.tape.put(op, made, b)
        return made

    def _node(self, node: Node) -> _Signed:
        args = [self.made[a] for a in node.args]
        if node.op is Op.SELECT and self._chooses_sign(node):
            return _Signed(args[3].core, args[3].by ^ {(Op.WITH_SIGN_OF, self._whole(args[0]))})
        if node.op is Op.FLIP:
            return _Signed(args[0].core, args[0].by ^ {(Op.FLIP, self._whole(args[1]))})
        if node.op in _ODD:
            return _Signed(self.tape.put(node.op, args[0].core), args[0].by)
        if node.op is Op.DIV:
            args = self._signed_divisor(*args)
        if node.op in (Op.MUL, Op.DIV):
            return self._product(node.op, args)
        if node.op in _EXTREMES and (kept := self._kept_within(node)) is not None:
            inside, limit = self.made[kept[0]], self.made[kept[1]]
            return _Signed(self.tape.put(Op.CLAMP, inside.core, limit.core), inside.by)
        return _Signed(self.tape.copy(node, tuple(self._whole(a) for a in args)))

    def _product(self, op: Op, args: list[_Signed]) -> _Signed:
        """A constant factor takes in signs of values; 1 times a sign is no factor."""
        (first, second), by = (a.core for a in args), args[0].by ^ args[1].by
        constant = self.tape.nodes[first].value
        if op is Op.MUL and constant == ONE:
            return _Signed(second, by)
        taken = (
            frozenset(sign for sign in by if sign[0] is Op.WITH_SIGN_OF)
            if constant is not None
            else frozenset()
        )
        return _Signed(self.tape.put(op, self._whole(_Signed(first, taken)), second), by - taken)

    def _signed_divisor(self, above: _Signed, below: _Signed) -> list[_Signed]:
        """The sign of a above max(|a|, c) as that of the divisor: a, or c with the sign of a."""
        nodes = self.tape.nodes
        for size, least in (pair for p in (nodes[below.core].args,) if len(p) == 2 for pair in (p, p[::-1])):
            value, a = nodes[least].value, nodes[size].args[0] if nodes[size].op is Op.ABS else -1
            sign = frozenset({(Op.WITH_SIGN_OF, a)})
            if nodes[below.core].op is Op.MAX and value is not None and value.sign > 0 and sign <= above.by:
                return [_Signed(above.core, above.by - sign), _Signed(self.tape.put(Op.AT_LEAST, a, least))]
        return [above, below]

    def _kept_within(self, node: Node) -> tuple[int, int] | None:
        """(x, m) of max(-m, min(m, x)) in any order."""
        nodes = self.function.nodes
        for outer, i in (node.args, node.args[::-1]):
            inner, limit = nodes[i], nodes[outer].value
            if limit is None or inner.op not in _EXTREMES or inner.op is node.op or self.uses[i] > 1:
                continue
            for other, x in (inner.args, inner.args[::-1]):
                if nodes[other].value == -limit:
                    return x, outer if limit.sign > 0 else other
        return None

    def _chooses_sign(self, node: Node) -> bool:
        return node.args[:2] not in self.compared and self._between_opposites(node)

    def _between_opposites(self, node: Node) -> bool:
        nodes = self.function.nodes
        _, zero, x, y = node.args
        return nodes[zero].value == ZERO and opposite(nodes, x, y)


def opposite(nodes: Sequence[Node], a: int, b: int) -> bool:
    """Whether a = -b by its shape."""
    p, q = nodes[a], nodes[b]
    if p.op is Op.SUB and q.op is Op.SUB:
        return p.args == q.args[::-1]
    (f, x), (g, y) = _scaled(nodes, a), _scaled(nodes, b)
    return x == y and f == -g


def _scaled(nodes: Sequence[Node], i: int) -> tuple[Exact, int]:
    """(c, x) of c x, -x; (1, i) otherwise."""
    node = nodes[i]
    if node.op is Op.NEG:
        return -ONE, node.args[0]
    value = nodes[node.args[0]].value if node.op is Op.MUL else None
    return (ONE, i) if value is None else (value, node.args[1])


def one_comparison(function: Function) -> Function:
    """max(s + t, c) as s + t where c < s, else c: where c < s is asked anyway, and s + t matters only then.

    That is so for directions: where the size s of a velocity is not above c the present angle is held.
    """
    nodes = list(function.nodes)
    asked = {node.args[:2] for node in nodes if node.op is Op.SELECT}
    for i, node in enumerate(nodes):
        if node.op is not Op.MAX:
            continue
        for least, total in (node.args, node.args[::-1]):
            value = nodes[least].value
            parts = nodes[total].args if nodes[total].op is Op.ADD else ()
            size = next((s for s in parts if (least, s) in asked and nodes[s].op is Op.SQRT), None)
            if value is not None and value.sign > 0 and size is not None:
                nodes[i] = Node(Op.SELECT, (least, size, total, least))
    return replace(function, nodes=tuple(nodes))
