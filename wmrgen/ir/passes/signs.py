"""Signs where a reader expects them: a + (-20) x becomes a - 20 x. Counts and bits stay the same."""

from __future__ import annotations

from collections import Counter

from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Op


def settle_signs(function: Function) -> Function:
    """``function`` without sums over a product with a negative constant, where a positive one does."""
    nodes = function.nodes
    uses = Counter(arg for node in nodes for arg in node.args)
    uses.update(function.results)
    builder = Builder()
    made: list[int] = []

    def flipped(i: int) -> int | None:
        """The product at ``i`` with its constant positive; None when it has none or others need it."""
        node = nodes[i]
        if node.op is not Op.MUL or uses[i] != 1:
            return None
        value = nodes[node.args[0]].value
        if value is None or value.sign > 0:
            return None
        return builder.make(Op.MUL, (builder.const(-value), made[node.args[1]]))

    for node in nodes:
        args = [made[arg] for arg in node.args]
        if node.op in (Op.CONST, Op.INPUT):
            made.append(builder.copy(node, ()))
            continue
        if node.op in (Op.ADD, Op.SUB):
            a, b = node.args
            positive = flipped(b)
            if positive is not None:
                made.append(builder.make(Op.SUB if node.op is Op.ADD else Op.ADD, (args[0], positive)))
                continue
            positive = flipped(a) if node.op is Op.ADD else None
            if positive is not None:
                made.append(builder.make(Op.SUB, (args[1], positive)))
                continue
        made.append(builder.again(node, args))
    results = [made[result] for result in function.results]
    return builder.function(function.name, function.inputs, function.outputs, results, function.text)
