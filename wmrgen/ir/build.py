"""A builder of IR functions: equal operations share one node, and trivial operations are simplified.

Every simplification holds for all finite arguments, exactly and in floats (except for the sign of a zero). Sums have
constants last, products have them first; other arguments are in the order of their ids.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partialmethod

from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.ir.nodes import Function, Node, Op, Port, pruned
from wmrgen.ir.tape import Tape


class Builder(Tape):
    """Makes simplified nodes and returns their ids; `function` makes a function of the nodes that results need."""

    __slots__ = ()

    # ---- ring operations

    def add(self, a: int, b: int) -> int:
        """a + b."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.const(x + y)
        if x is not None:
            a, b, y = b, a, x
        if y is not None:
            return a if not y else self._with_constant(a, y)
        na, nb = self._negated(a), self._negated(b)
        if na is not None and nb is not None:
            return self.neg(self.add(na, nb))
        if nb is not None:
            return self.sub(a, nb)
        if na is not None:
            return self.sub(b, na)
        return self.put(Op.ADD, min(a, b), max(a, b))

    def sub(self, a: int, b: int) -> int:
        """a - b."""
        if a == b:
            return self.const(ZERO)
        x, y = self.value(a), self.value(b)
        if y is not None:
            return self.add(a, self.const(-y))
        if x is not None and not x:
            return self.neg(b)
        na, nb = self._negated(a), self._negated(b)
        if nb is not None:
            return self.add(a, nb)
        if na is not None:
            return self.neg(self.add(na, b))
        return self.put(Op.SUB, a, b)

    def neg(self, a: int) -> int:
        """-a; of a difference or a product with a constant it changes these instead of adding a node."""
        node = self.nodes[a]
        if node.value is not None:
            return self.const(-node.value)
        if node.op is Op.NEG:
            return node.args[0]
        if node.op is Op.SUB:
            return self.sub(node.args[1], node.args[0])
        scaled = self.scaled(a)
        if scaled is not None:
            return self.mul(self.const(-scaled[0]), scaled[1])
        return self.put(Op.NEG, a)

    def mul(self, a: int, b: int) -> int:
        """a * b; constant factors move to the front and merge."""
        x, y = self.value(a), self.value(b)
        if x is not None and y is not None:
            return self.const(x * y)
        if y is not None:
            a, b, x = b, a, y
        if x is not None:
            return self._scale(x, b)
        (c, p), (d, q) = self._split(a), self._split(b)
        if (p, q) != (a, b):
            return self._scale(c * d, self.mul(p, q))
        return self.put(Op.MUL, min(a, b), max(a, b))

    def div(self, a: int, b: int) -> int:
        """a / b. A constant divisor becomes a factor; the constant 0 raises ZeroDivisionError."""
        y = self.value(b)
        if y is not None:
            if not y:
                raise ZeroDivisionError("division by the constant zero")
            return self.mul(self.const(y.inverse()), a)
        x = self.value(a)
        if x is not None and not x:
            return a
        if x is not None and x != ONE:
            return self._scale(x, self.div(self.const(ONE), b))
        (c, p), (d, q) = self._split(a), self._split(b)
        if (p, q) != (a, b):
            return self._scale(c / d, self.div(p, q))
        return self.put(Op.DIV, a, b)

    # ---- order

    def abs(self, a: int) -> int:
        """|a|."""
        node = self.nodes[a]
        if node.op in (Op.ABS, Op.SQRT):
            return a
        if node.op is Op.SUB and node.args[0] > node.args[1]:
            return self.abs(self.sub(node.args[1], node.args[0]))
        return self._plain(Op.ABS, a)

    def min(self, a: int, b: int) -> int:
        """The smaller of a and b."""
        return a if a == b else self._plain(Op.MIN, a, b)

    def max(self, a: int, b: int) -> int:
        """The larger of a and b."""
        return a if a == b else self._plain(Op.MAX, a, b)

    def select(self, a: int, b: int, x: int, y: int) -> int:
        """Return x if a < b, else y. Both are always computed.

        Args:
            a: the node on the left of the comparison.
            b: the node on the right.
            x: the result if a < b.
            y: the result otherwise.

        Returns:
            The node of the choice: x or y itself if the outcome is known or both are the same.
        """
        p, q = self.value(a), self.value(b)
        if a == b or (p is not None and q is not None):
            return x if p is not None and q is not None and p < q else y
        return x if x == y else self.put(Op.SELECT, a, b, x, y)

    def with_sign_of(self, a: int, b: int) -> int:
        """-a if b < 0, else a."""
        value = self.value(b)
        if value is not None:
            return self.neg(a) if value.sign < 0 else a
        return self.put(Op.WITH_SIGN_OF, a, b)

    # ---- functions

    def sqrt(self, a: int) -> int:
        """The square root of a >= 0; a constant if it is in Q(sqrt2, sqrt3)."""
        value = self.value(a)
        if value is not None and value.sign < 0:
            raise ValueError("square root of a negative constant")
        return self._plain(Op.SQRT, a)

    def flip(self, a: int, n: int) -> int:
        """a if the whole number n is even, else -a."""
        value, inner = self.value(n), self._positive(n)
        if value is not None and value.is_rational:
            return self.neg(a) if value.parts[0] % 2 else a
        return self.put(Op.FLIP, a, n) if inner is None else self.flip(a, inner)

    def _plain(self, op: Op, *args: int) -> int:
        """Return an operation; constants are folded, and odd or even functions get a positive argument."""
        values = [self.value(a) for a in args]
        constants = [x for x in values if x is not None]
        folded = op.fold(*constants) if len(constants) == len(args) and op.fold is not None else None
        if folded is not None:
            return self.const(folded)
        inner = self._positive(args[0]) if op.parity else None
        if inner is not None:
            result = self.apply(op, (inner,))
            return self.neg(result) if op.parity < 0 else result
        return self.put(op, *(sorted(args) if op.commutative else args))

    sin = partialmethod(_plain, Op.SIN)
    cos = partialmethod(_plain, Op.COS)
    atan = partialmethod(_plain, Op.ATAN)
    atan2 = partialmethod(_plain, Op.ATAN2)
    rint = partialmethod(_plain, Op.RINT)

    # ---- helpers

    def sum(self, terms: Iterable[int]) -> int:
        """The sum of any number of terms, left to right."""
        total = self.const(ZERO)
        for term in terms:
            total = self.add(total, term)
        return total

    def product(self, factors: Iterable[int]) -> int:
        """The product of any number of factors, in the order of their ids."""
        total = self.const(ONE)
        for factor in sorted(factors):
            total = self.mul(total, factor)
        return total

    def square(self, a: int) -> int:
        """a * a."""
        return self.mul(a, a)

    def power(self, a: int, n: int) -> int:
        """a to a whole power, by repeated squaring; for a negative power, the reciprocal of that."""
        if n < 0:
            return self.div(self.const(ONE), self.power(a, -n))
        if n == 0:
            return self.const(ONE)
        half = self.power(self.square(a), n // 2) if n > 1 else self.const(ONE)
        return self.mul(half, a) if n % 2 else half

    def apply(self, op: Op, args: Sequence[int]) -> int:
        """Return an operation, simplified by its rule."""
        return _RULES[op](self, *args) if op in _RULES else self._plain(op, *args)

    def copy(self, node: Node, args: Sequence[int]) -> int:
        """Return ``node`` of another function, simplified; ``args`` are ids of this builder."""
        return super().copy(node, args) if node.op.exact is None else self.apply(node.op, args)

    def again(self, node: Node, args: Sequence[int]) -> int:
        """Return ``node`` of another function through `make`; ``args`` are ids of this builder."""
        return super().copy(node, args) if node.op.exact is None else self.make(node.op, args)

    def make(self, op: Op, args: Sequence[int]) -> int:
        """Return an operation, simplified only if an argument is a constant or a negation.

        For passes that choose the place of a factor, which must then not move.
        """
        if any(self.nodes[arg].op in (Op.CONST, Op.NEG) for arg in args):
            return self.apply(op, args)
        return self.put(op, *(sorted(args) if op.commutative else args))

    def function(
        self,
        name: str,
        inputs: tuple[Port, ...],
        outputs: tuple[Port, ...],
        results: Sequence[int],
        text: str = "",
    ) -> Function:
        """Return the function that computes ``results``, with the nodes that they need.

        Args:
            name: its name.
            inputs: its inputs.
            outputs: its outputs.
            results: the node of each output.
            text: what it computes.

        Returns:
            The function.
        """
        return pruned(Function(name, inputs, tuple(self.nodes), outputs, tuple(results), text))

    # ---- shapes of nodes

    def _with_constant(self, a: int, value: Exact) -> int:
        """Return a + value, for a value that is not 0, as x + c, x - c with c > 0, or c - x."""
        inner = self._negated(a)
        if inner is not None:
            return self.put(Op.SUB, self.const(value), inner)
        op = Op.ADD if value.sign > 0 else Op.SUB
        return self.put(op, a, self.const(abs(value)))

    def _scale(self, factor: Exact, a: int) -> int:
        """Return factor * a; a constant factor of ``a`` is merged into it."""
        own, inner = self._split(a)
        if inner != a:
            return self._scale(factor * own, inner)
        if not factor:
            return self.const(ZERO)
        if factor == ONE:
            return a
        if factor == -ONE:
            return self.neg(a)
        value = self.value(a)
        return self.put(Op.MUL, self.const(factor), a) if value is None else self.const(factor * value)

    def scaled(self, a: int) -> tuple[Exact, int] | None:
        """Return (c, x) if node ``a`` is a constant c times x, else None."""
        node = self.nodes[a]
        if node.op is not Op.MUL:
            return None
        value = self.nodes[node.args[0]].value
        return None if value is None else (value, node.args[1])

    def _negated(self, a: int) -> int | None:
        """Return x if node ``a`` is -x, else None."""
        node = self.nodes[a]
        return node.args[0] if node.op is Op.NEG else None

    def _split(self, a: int) -> tuple[Exact, int]:
        """Return (c, x) with node ``a`` = c x; c is 1 if ``a`` has no constant factor."""
        inner = self._negated(a)
        return (-ONE, inner) if inner is not None else self.scaled(a) or (ONE, a)

    def _positive(self, a: int) -> int | None:
        """Return -a if ``a`` is a negation, a negative constant or has a negative factor, else None."""
        value = self.value(a)
        if value is not None:
            return self.const(-value) if value.sign < 0 else None
        factor, inner = self._split(a)
        return self._scale(-factor, inner) if factor.sign < 0 else None


# Operations with simplifications of their own; `Builder._plain` makes the other ones.
_RULES: dict[Op, Callable[..., int]] = {
    Op.ADD: Builder.add, Op.SUB: Builder.sub, Op.MUL: Builder.mul, Op.DIV: Builder.div, Op.NEG: Builder.neg,
    Op.ABS: Builder.abs, Op.MIN: Builder.min, Op.MAX: Builder.max, Op.SELECT: Builder.select,
    Op.SQRT: Builder.sqrt, Op.FLIP: Builder.flip, Op.WITH_SIGN_OF: Builder.with_sign_of,
}  # fmt: skip
