"""The largest effect that roundings can have at a point, found by moving each value by its rounding error.

To first order, a result moves by at most the sum of the effects of single roundings. This is an oracle for bounds that
shares no code with them: no bound may be below it at any point.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from tests.ir.bounds.observe import LIBRARY, decided, run
from wmrgen.ir.bounds.assumptions import LIBM, SINGLE
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float32, to_float64

_ROUNDED = (Op.ADD, Op.SUB, Op.MUL, Op.DIV, Op.SQRT)


def worst(function: Function, inputs: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return results x points: the largest error of the float results, in the branches of the float program."""
    both = run(function, inputs)
    total = np.zeros((len(function.results), len(both.exact[0])))
    for i, node in enumerate(function.nodes):
        noise = _noise(node, both.exact[i])
        if noise is None:
            continue
        noise = np.where(_is_exact(function, node, both.exact), 0.0, noise)
        if node.op in (Op.ADD, Op.SUB):
            # Each operand is a float: the float nearest to the sum is no farther from it than they are.
            noise = np.minimum(noise, np.min([np.abs(both.exact[k]) for k in node.args], axis=0))
        for users in _uses(function, i, node):
            moved = _moved(function, both.single, both.exact, i, noise, users)
            for row, k in enumerate(function.results):
                total[row] += np.abs(moved[k] - both.exact[k])
    return total


def _is_exact(function: Function, node: Node, exact: list[np.ndarray]) -> np.ndarray:
    """Return where a node is an exact product with a power of two: a constant or a whole number of turns."""
    powers = np.zeros(len(exact[0]), dtype=bool)
    for k in node.args if node.op is Op.MUL else ():
        factor = function.nodes[k]
        value = function.nodes[factor.args[0]].value if factor.op is Op.WITH_SIGN_OF else factor.value
        if value is not None or factor.op is Op.RINT:
            by = exact[k] if value is None else np.full(len(powers), to_float32(value))
            powers |= (np.abs(np.frexp(by)[0]) == 0.5) | (by == 0)
    return powers


def _noise(node: Node, value: np.ndarray) -> np.ndarray | None:
    """Return the largest rounding error of a node at these values, or None if it has none."""
    if node.value is not None:
        return np.full(len(value), abs(float(to_float32(node.value)) - to_float64(node.value)))
    if node.op in _ROUNDED:
        return SINGLE.half_ulp(np.abs(value))
    return 2 * LIBM.ulps(node.op) * SINGLE.half_ulp(np.abs(value)) if node.op.name in LIBRARY else None


def _uses(function: Function, i: int, node: Node) -> list[set[int]]:
    """Return groups of users that see the same rounding: all of them, or each of its own if a sum may be contracted."""
    users = {k for k, n in enumerate(function.nodes) if i in n.args}
    sums = any(function.nodes[k].op in (Op.ADD, Op.SUB) for k in users)
    if node.op is Op.MUL and len(users) > 1 and sums and i not in function.results:
        return [{k} for k in users]
    return [users]


def _moved(
    function: Function,
    single: list[np.ndarray],
    exact: list[np.ndarray],
    i: int,
    by: np.ndarray,
    users: set[int],
) -> list[np.ndarray]:
    """Return every value after node ``i`` is moved ``by`` for some of its users."""
    values, moved = list(exact), {i}
    for k, node in enumerate(function.nodes):
        if k in users or (
            not moved.isdisjoint(node.args) and k != i and not (i in node.args and k not in users)
        ):
            args = [values[a] + by if a == i else values[a] for a in node.args]
            values[k] = decided(node, [single[a] for a in node.args], args)
            moved.add(k)
    if i in function.results:
        values[i] = exact[i] + by
    return values
