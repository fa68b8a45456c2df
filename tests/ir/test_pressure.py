"""Orders of operations: the same expressions with fewer values alive."""

from __future__ import annotations

import pytest

from benchmarks.jobs import derivations
from tests.ir.test_outline import values
from wmrgen.exact.number import Exact
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.constants import EVEN32
from wmrgen.ir.kernels.room import ROOM, alive, angle_by_angle, wanted
from wmrgen.ir.nodes import Function, Module, Node, Op
from wmrgen.ir.passes.pressure import nearest
from wmrgen.ir.passes.schedule import schedule

ROBOTS = ("wpilib_swervebot", "swerve8", "nomad_xr4000", "ackermann_car")


def robot(name: str) -> Module:
    return expand(derivations()[name].c_module, "float", "inline")


@pytest.mark.parametrize("name", ROBOTS)
def test_the_order_computes_the_same(name: str) -> None:
    for function in robot(name).functions:
        deep = schedule(function)
        made = nearest(deep)
        assert values(made) == values(deep)
        assert all(arg < i for i, node in enumerate(made.nodes) for arg in node.args)


def test_the_wheels_of_a_swerve_are_done_one_after_the_other() -> None:
    """Depth first keeps values of all wheels."""
    for name, most in (("wpilib_swervebot", 13), ("swerve8", 20)):
        deep = schedule(robot(name).function("forward"))
        assert alive(nearest(deep)) <= most < alive(deep)


@pytest.mark.parametrize("name", ROBOTS)
def test_angles_one_after_the_other_compute_the_same(name: str) -> None:
    for function in robot(name).functions:
        made = angle_by_angle(function)
        assert values(made) == values(schedule(function))
        assert all(arg < i for i, node in enumerate(made.nodes) for arg in node.args)


def test_four_angles_have_room_in_the_registers() -> None:
    """Cosines as sines of the rest where that is what makes room; eight wheels and castors do not fit either way."""
    for name in ROBOTS:
        forward = robot(name).function("forward")
        shared = any(node.value == EVEN32 for node in forward.nodes)
        assert shared == (name == "wpilib_swervebot") == (wanted(forward) <= ROOM), name


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
    assert alive(both) == 3
    assert alive(Function("f", (), (x, c, Node(Op.ADD, (0, 1))), (), (2,))) == 1


def test_both_totals_grow_together() -> None:
    """Depth first finishes one total and keeps every sum for the other."""
    deep, near = (alive(way(pairs(20))) for way in (schedule, nearest))
    assert deep >= 20
    assert near <= 5
