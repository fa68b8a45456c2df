"""Frama-C Eva finds nothing in generated C within the limits, and finds what is wrong in the controls."""

from __future__ import annotations

import pytest

from tests.external_tools import need
from tests.ir.bounds.gallery import NAMES, proved
from tests.ir.bounds.small import BAD, function, guarded, module
from wmrgen.cli.prove import eva
from wmrgen.codegen.c.driver import HARNESS, alarms, command, harness
from wmrgen.codegen.compiler import run_tool
from wmrgen.ir.bounds.partition import cases
from wmrgen.ir.nodes import Module

CLEAN = "\n".join(
    (
        "[eva] using specification for function Frama_C_float_interval",
        "[eva] eva_main.c:9: ",
        "  Frama_C_show_each_inverse:",
        "  [-1. .. 2.5], {0}",
        "[eva] done for function main",
    )
)


def test_reads_what_eva_prints() -> None:
    assert alarms(CLEAN) == ()
    bad = "[eva:alarm] a.c:1: Warning: \n  division by zero. assert x != 0;\n" + CLEAN
    assert alarms(bad) == ("a.c:1: Warning:  division by zero. assert x != 0;",)
    assert alarms("[kernel] Frama-C aborted")
    assert alarms(CLEAN.replace("Frama_C_float_interval", "unheard_of"))


def test_harness_calls_every_function_over_its_ranges() -> None:
    robot = proved("pioneer3dx")
    ranges = {b.name: [b.inputs] for _, b in robot.pairs}
    text = harness(robot.derivation.c_module, ranges)[HARNESS]
    unlimited = {b.name for b in robot.bounds.functions if b.unknown}
    assert unlimited == {"joints_from_counts"}  # how far counters turn in a step, no limit says
    for name in robot.functions.keys() - unlimited:
        assert f"pioneer3dx_{name}(" in text
    low, high = robot.bounds.declared["vx"]
    assert f"twist.vx = Frama_C_float_interval({low.hex()}f, {high.hex()}f);" in text
    assert text.count("pioneer3dx_prepare(&params, &prepared);") >= 2


def test_parts_cover_the_ranges() -> None:
    """Each part is met where the last ended, and together they are as large as the whole."""
    robot = proved("unicycle")
    bound = {b.name: b for _, b in robot.pairs}["odometry"]
    parts = cases(robot.functions["odometry"], bound.inputs, finer=2)
    assert len(parts) > 1

    def size(part: dict[str, tuple[float, float]]) -> float:
        return (part["omega"][1] - part["omega"][0]) * (part["dt"][1] - part["dt"][0])

    assert sum(size(part) for part in parts) == pytest.approx(size(bound.inputs), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_gallery_raises_no_alarm(name: str) -> None:
    need("frama-c")
    robot = proved(name)
    found = eva(robot.derivation, robot.bounds)
    assert found["run"]
    assert found["alarms"] == []


def _checked(made: Module, low: float, high: float) -> tuple[str, ...]:
    files = harness(made, {"control": [{"vx": (low, high)}]})
    return alarms(run_tool(command("frama-c", made.name), files))


@pytest.mark.slow
@pytest.mark.parametrize("what", BAD)
def test_controls_raise_alarms(what: str) -> None:
    need("frama-c")
    make, good, bad = BAD[what]
    made = module(function(make))
    assert _checked(made, *good) == ()
    assert _checked(made, *bad)


@pytest.mark.slow
def test_guarded_division_raises_none_in_parts() -> None:
    need("frama-c")
    control = function(guarded)
    parts = cases(control, {"vx": (-2.0, 2.0)})
    files = harness(module(control), {"control": parts})
    assert alarms(run_tool(command("frama-c", "bad"), files)) == ()
