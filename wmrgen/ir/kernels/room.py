"""How many registers a function asks for, and an order for functions of many angles that asks for fewer.

What gcc does with straight code: every constant that is needed again stays in a register. A function may overwrite
16 registers of an Arm FPU; more it saves to the stack first.
"""

from __future__ import annotations

from collections import Counter
from itertools import accumulate

from wmrgen.ir.kernels.constants import EVEN32
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.passes.schedule import reordered

ROOM = 20  # 16 and four that are saved in 16 bytes
ANGLES = range(4, 7)  # of fewer the constants are not needed for long; more leave no room either way


def crowded(function: Function) -> bool:
    """Whether a function, not expanded, takes sines or cosines of so many angles that their form matters."""
    return len({node.args for node in function.nodes if node.op in (Op.SIN, Op.COS)}) in ANGLES


def wanted(function: Function) -> int:
    """How many registers: values alive at once, at most, and constants that are needed more than once."""
    uses = Counter(arg for node in function.nodes for arg in node.args)
    kept = sum(node.value is not None and uses[i] > 1 for i, node in enumerate(function.nodes))
    return kept + alive(function)


def alive(function: Function) -> int:
    """How many values are alive at most. Constants are not counted."""
    nodes, end = function.nodes, len(function.nodes)
    last = {arg: i for i, node in enumerate(nodes) for arg in node.args} | dict.fromkeys(
        function.results, end
    )
    first: dict[int, int] = {}
    for i, node in enumerate(nodes):
        for arg in node.args:
            first.setdefault(arg, i)
    change = [0] * (end + 1)
    for i, node in enumerate(nodes):
        if node.value is None and i in last:
            change[i if node.args else first.get(i, i)] += 1  # an input is read where it is first needed
            change[last[i]] -= 1
    return max(accumulate(change))


def angle_by_angle(function: Function) -> Function:
    """``function`` with one angle done after the other: what depends on the angles so far is computed at once."""
    nodes = function.nodes
    angles = [0] * len(nodes)  # bit masks of what a node depends on
    count = 0
    for i, node in enumerate(nodes):
        for arg in node.args:
            angles[i] |= angles[arg]
        if node.op is Op.FMA and nodes[node.args[2]].value == EVEN32:
            angles[i] |= 1 << count
            count += 1
    order: list[int] = []
    done = bytearray(len(nodes))
    for k in range(count + 1):
        later = -1 << k  # the angles from the k-th on
        for i in range(len(nodes)):
            if angles[i] and not angles[i] & later:
                _compute(function, i, done, order)
    for i in function.results:
        _compute(function, i, done, order)
    return reordered(function, order)


def _compute(function: Function, target: int, done: bytearray, order: list[int]) -> None:
    """What ``target`` still needs, in the order that it has, and ``target``."""
    needed, stack = set[int](), [target]
    while stack:
        i = stack.pop()
        if not done[i]:
            done[i] = 1
            needed.add(i)
            stack += function.nodes[i].args
    order += sorted(needed)
