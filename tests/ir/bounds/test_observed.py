"""No rounding error that occurs is above its proved bound, and no bound is far above the errors that occur."""

from __future__ import annotations

import pytest

from tests.ir.bounds.gallery import NAMES, proved
from tests.ir.bounds.observe import draw
from tests.ir.bounds.search import shares, worst
from wmrgen.ir.bounds.robot import FunctionBound
from wmrgen.ir.nodes import Function

FAST = [
    "clearpath_do100",
    "pioneer3dx",
    "wpilib_swervebot",
    "agilex_ranger",
    "nomad_xr4000",
    "f1tenth",
    "bicycle",
]
LOOSEST = 32.0  # how far a bound may be above the worst that is found
GENERATIONS = (24, 40)  # the longer search only where the shorter one finds too little


def hold(function: Function, bound: FunctionBound) -> None:
    """At points drawn at random every output is in its range, and no error above its bound."""
    assert bound.proved, f"{function.name}: {bound.alarms}"
    if bound.inputs:
        for output, share in shares(function, bound, draw(bound.inputs, 3000, 7)).items():
            assert share.max() <= 1, f"{function.name}: {output}"


@pytest.mark.parametrize("name", FAST)
def test_bounds_hold(name: str) -> None:
    for function, bound in proved(name).pairs:
        hold(function, bound)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_bounds_hold_where_errors_are_largest(name: str) -> None:
    """A search for the worst inputs of each output finds none beyond the bound and some within `LOOSEST` of it."""
    robot = proved(name)
    pairs = {f.name: (f, b) for f, b in robot.pairs}
    for function, bound in robot.pairs:
        hold(function, bound)
        for o in bound.outputs:
            if (
                bound.inputs
                and o.error
                and not o.singular
                and not (function.name == "forward" and "forward_slip" in pairs)
            ):
                for generations in GENERATIONS:
                    share = worst(function, bound, o.name, pairs.get("inverse"), generations, 1 / LOOSEST)
                    assert share <= 1, f"{function.name}: {o.name}"
                    if share * LOOSEST >= 1:
                        break
                assert share == 0 or share * LOOSEST >= 1, f"{function.name}: {o.name}, {1 / share:.1f}"
