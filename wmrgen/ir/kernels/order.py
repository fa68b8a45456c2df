"""Which order of a function keeps fewer values alive across calls of library functions.

A call may overwrite the registers: what is computed before it and needed after it is saved to the stack, itself or
the register that keeps it. Inputs are read again instead.
"""

from __future__ import annotations

from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.passes.schedule import calls_first, schedule

_FREE = (Op.CONST, Op.INPUT)
_STATEMENTS = (Op.SELECT, Op.MIN, Op.MAX)  # other values that are used once are printed where they are used


def ordered(function: Function) -> Function:
    """``function`` depth first, or with its calls before the rest where that keeps fewer values by a fifth.

    Less does not pay: what stands apart from the call that it prepares is compared and loaded again.
    """
    deep = schedule(function)
    early = calls_first(deep)
    return early if 5 * kept_across(early) <= 4 * kept_across(deep) else deep


def kept_across(function: Function) -> int:
    """How many values are computed before a call and needed after it, as the code is printed."""
    nodes = function.nodes
    users: list[list[int]] = [[] for _ in nodes]
    for i, node in enumerate(nodes):
        for arg in set(node.args):
            users[arg].append(i)
    for result in function.results:
        users[result].append(len(nodes))
    place = [*range(len(nodes)), len(nodes)]  # of the statement that computes a node
    for i in range(len(nodes) - 1, -1, -1):
        if len(users[i]) == 1 and nodes[i].op not in _STATEMENTS:
            place[i] = place[users[i][0]]
    calls = [place[i] for i, node in enumerate(nodes) if node.op.ulps]
    return sum(
        node.op not in _FREE and any(place[i] < k < max(place[u] for u in users[i]) for k in calls)
        for i, node in enumerate(nodes)
    )
