"""Parts written once: put back in their places they are the operations that were there, on the same values."""

from __future__ import annotations

from collections import Counter
from functools import cache

import pytest

from tests.backends.modules import MODULES
from tests.backends.samples import samples
from tests.c.harness import robot_module
from tests.conftest import GALLERY
from tests.depth import everyday
from wmrgen.ir.arithmetic import FLOAT32
from wmrgen.ir.inline import hand_through
from wmrgen.ir.interpret import evaluate_module
from wmrgen.ir.kernels import expand
from wmrgen.ir.nodes import Function, Op
from wmrgen.ir.outline import Outlined, outline, sizes
from wmrgen.ir.outline.sizes import LEAST_OPERATIONS, MOST_PARAMETERS, MOST_RESULTS
from wmrgen.ir.outline.undo import calls, inline

BY_HAND = {module.name: module for module in MODULES}
FEW = ("wpilib_swervebot", "kelly_4ws", "nomad_xr4000", "ackermann_car", "lekiwi")
COMMUTE = (Op.ADD, Op.MUL, Op.FMA)


@cache
def small(robot: str, target: str = "m4f", math: str = "inline") -> tuple[tuple[Function, ...], Outlined]:
    """The functions of a robot before and after."""
    module = hand_through(BY_HAND.get(robot) or robot_module(robot))
    functions = expand(module, "float", math, target, small=True).functions
    return functions, outline(functions, f"{robot}_part", sizes(target))


def values(function: Function) -> tuple[int, ...]:
    """What the results of ``function`` are, as numbers of their expressions."""
    found: list[int] = []
    for node in function.nodes:
        args = tuple(found[a] for a in node.args)
        if node.op in COMMUTE:
            args = (*sorted(args[:2]), *args[2:])
        key = node.op, node.value, node.name if node.op is Op.INPUT else None, args
        found.append(NUMBERS.setdefault(key, len(NUMBERS)))
    return tuple(found[r] for r in function.results)


NUMBERS: dict[object, int] = {}


def check(functions: tuple[Function, ...], made: Outlined) -> None:
    parts = {part.name: part for part in made.parts}
    for before, after in zip(functions, made.functions, strict=True):
        assert values(inline(after, parts)) == values(before), before.name
        assert (before.name, before.inputs, before.outputs) == (after.name, after.inputs, after.outputs)


@pytest.mark.slow
@pytest.mark.parametrize("robot", FEW)
def test_every_result_is_the_same_expression(robot: str) -> None:
    check(*small(robot))


@pytest.mark.slow
@pytest.mark.parametrize("target", ["m4f", "m0", "avr", "host"])
@pytest.mark.parametrize("robot", [*BY_HAND, *(path.stem for path in GALLERY)])
def test_every_result_of_every_robot(robot: str, target: str) -> None:
    check(*small(robot, target))


@pytest.mark.parametrize("robot", everyday(FEW, FEW[:2]))
def test_a_part_is_worth_its_calls(robot: str) -> None:
    _, made = small(robot)
    count = calls([node for f in (*made.functions, *made.parts) for node in f.nodes])
    assert count.keys() == {part.name for part in made.parts}
    for part in made.parts:
        kinds = Counter(node.op for node in part.nodes)
        assert count[part.name] > 1
        assert kinds[Op.CALL] == 0
        assert kinds[Op.INPUT] <= MOST_PARAMETERS and len(part.results) <= MOST_RESULTS
        assert sum(bool(node.args) for node in part.nodes) >= LEAST_OPERATIONS


def test_a_swerve_has_one_part_per_wheel_and_way() -> None:
    """The wave of an angle, and what a wheel does in inverse kinematics."""
    _, made = small("wpilib_swervebot")
    assert len(made.parts) == 2
    by_name = {f.name: calls(f.nodes) for f in made.functions}
    assert [sum(by_name[name].values()) for name in ("inverse", "forward", "odometry")] == [4, 4, 2]


@pytest.mark.parametrize("robot", FEW)
def test_waves_with_their_own_sign_give_the_same_bits(robot: str) -> None:
    module = robot_module(robot)
    usual, own = (expand(module, "float", "inline", "m4f", small=way) for way in (False, True))
    for function in module.functions:
        for case in samples(module, function, 12):
            a, b = (evaluate_module(m, function.name, case, FLOAT32) for m in (usual, own))
            assert {k: v.hex() for k, v in a.items()} == {k: v.hex() for k, v in b.items()}
