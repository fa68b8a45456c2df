"""An order of evaluation that keeps few values alive at once.

Depth first from the outputs in their order; of an operation's arguments, the one that needs more
registers first (Sethi and Ullman 1970, which is optimal for trees).
"""

from __future__ import annotations

from wmrgen.ir.nodes import Function, Node, Op, placed


def schedule(function: Function) -> Function:
    """``function`` with its nodes in a new order; unneeded ones are left out."""
    nodes = function.nodes
    needs = registers(nodes)
    scheduled = bytearray(len(nodes))
    order: list[int] = []
    for result in function.results:
        stack = [result]
        while stack:
            i = stack[-1]
            if scheduled[i]:
                stack.pop()
                continue
            waiting = {arg for arg in nodes[i].args if not scheduled[arg]}
            if len(waiting) > 1:
                stack += sorted(waiting, key=lambda arg: (needs[arg], -nodes[i].args.index(arg)))
            elif waiting:
                stack += waiting
            else:
                scheduled[i] = 1
                order.append(stack.pop())
    return placed(function, {i: k for k, i in enumerate(order)})


def registers(nodes: tuple[Node, ...]) -> list[int]:
    """Registers that each node needs when nothing is shared; constants need none."""
    needs: list[int] = []
    for node in nodes:
        if not node.args:
            needs.append(0 if node.op is Op.CONST else 1)
            continue
        wanted = sorted((needs[arg] for arg in set(node.args)), reverse=True)
        needs.append(max(1, *(need + k for k, need in enumerate(wanted))))
    return needs
