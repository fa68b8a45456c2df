"""Orders of operations: the same expressions with fewer values alive."""

from __future__ import annotations

import pytest

from benchmarks.jobs import derivations
from tests.ir.test_outline import values
from wmrgen.exact.number import Exact
from wmrgen.ir.kernels import expand
from wmrgen.ir.nodes import Function, Module, Node, Op
from wmrgen.ir.passes.pressure import ENOUGH, alive, nearest, relieved
from wmrgen.ir.passes.schedule import schedule

ROBOTS = ("wpilib_swervebot", "swerve8", "nomad_xr4000", "ackermann_car")


def robot(name: str) -> Module:
    return expand(derivations()[name].c_module, "float", "inline")


@pytest.mark.parametrize("name", ROBOTS)
def test_an_order_computes_the_same_and_keeps_no_more_alive(name: str) -> None:
    for function in robot(name).functions:
        deep = schedule(function)
        made = relieved(deep)
        assert values(made) == values(deep)
        assert all(arg < i for i, node in enumerate(made.nodes) for arg in node.args)
        assert made is deep or alive(deep)[0] > max(ENOUGH, alive(made)[0])


def test_the_wheels_of_a_swerve_are_done_one_after_the_other() -> None:
    """Depth first keeps 17 values of four wheels, and 31 of eight; the registers that are free hold 16."""
    for name, most in (("wpilib_swervebot", 10), ("swerve8", 17)):
        assert alive(robot(name).function("forward"))[0] <= most


def pairs(count: int) -> Function:
    """(x0 + x1) + (x2 + x3) + ... and the difference of the same sums: all are needed twice."""
    nodes = [Node(Op.INPUT, name=f"x{k}") for k in range(2 * count)]
    sums = []
    for k in range(count):
        sums.append(len(nodes))
        nodes.append(Node(Op.ADD, (2 * k, 2 * k + 1)))
    results = []
    for op in (Op.ADD, Op.SUB):
        total = sums[0]
        for k in sums[1:]:
            nodes.append(Node(op, (total, k)))
            total = len(nodes) - 1
        results.append(total)
    return Function("f", (), tuple(nodes), (), tuple(results))


def test_values_alive_are_counted() -> None:
    """x and y until both are used up, their sum and product to the end; a constant needs no register."""
    x, y, c = Node(Op.INPUT, name="x"), Node(Op.INPUT, name="y"), Node(Op.CONST, value=Exact(2))
    both = Function(
        "f", (), (x, y, c, Node(Op.ADD, (0, 1)), Node(Op.MUL, (0, 1)), Node(Op.MUL, (2, 4))), (), (3, 5)
    )
    assert alive(both)[0] == 3
    assert alive(Function("f", (), (x, c, Node(Op.ADD, (0, 1))), (), (2,)))[0] == 1


def test_both_totals_grow_together() -> None:
    """Depth first finishes one total and keeps every sum for the other."""
    deep, near = (alive(way(pairs(20)))[0] for way in (schedule, nearest))
    assert deep >= 20
    assert near <= 5
