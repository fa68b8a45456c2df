"""Arguments of functions: shared types by names of ports, changes in place, one variable for input and output."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from tests.codegen.c.harness import COMPILERS
from tests.depth import everyday
from tests.ir.selftest.every import NAMES
from tests.robots import of_gallery
from wmrgen.codegen.c import sources
from wmrgen.codegen.c.emit import unit
from wmrgen.codegen.c.functions import call
from wmrgen.codegen.compiler import compile_program, run_program
from wmrgen.codegen.signature import arguments, members
from wmrgen.codegen.unit import Step, place_of
from wmrgen.geometry.ports import JOINTS, POSE, TWIST, output
from wmrgen.ir.build import Builder
from wmrgen.ir.nodes import Function, Module, Port, Role

SPINS = ("left.spin", "right.spin")
PROTOTYPES = {
    "pioneer3dx": (
        "void pioneer3dx_inverse( const pioneer3dx_prepared *prepared, const pioneer3dx_twist *twist, "
        "pioneer3dx_wheels *out);",
        "void pioneer3dx_forward( const pioneer3dx_prepared *prepared, const pioneer3dx_wheels *wheels, "
        "pioneer3dx_twist *twist);",
        "void pioneer3dx_odometry(pioneer3dx_pose *pose, const pioneer3dx_twist *twist, float dt);",
    ),
    "ackermann_car": (
        "void ackermann_car_inverse( const ackermann_car_twist *twist, const ackermann_car_wheels *now, "
        "ackermann_car_wheels *out);",
        "void ackermann_car_forward(const ackermann_car_wheels *wheels, ackermann_car_twist *twist);",
    ),
    "office_chair": ("void office_chair_forward(office_chair_twist *twist);",),  # nothing is driven or sensed
}


@pytest.mark.parametrize("robot", PROTOTYPES)
def test_prototypes(robot: str) -> None:
    header = re.sub(r"\s+", " ", sources(of_gallery(robot).c_module)[0])
    for prototype in PROTOTYPES[robot]:
        assert prototype in header


def test_passive_joints_are_not_members() -> None:
    assert of_gallery("pioneer3dx").c_module.joints == SPINS
    car = of_gallery("ackermann_car").c_module.joints
    assert car == ("rear_left.spin", "rear_right.spin", "front_left.steer", "front_right.steer")
    assert "wheels" not in members(of_gallery("office_chair").c_module)


def function(
    inputs: tuple[Port, ...], outputs: tuple[Port, ...], results: tuple[str, ...] = (), in_place: bool = False
) -> Function:
    """Return a function that returns its inputs, or the inputs ``results``."""
    b = Builder()
    read = {port.name: b.input(port.name) for port in inputs}
    names = results or tuple(port.name for port in inputs)[: len(outputs)]
    made = b.function("tried", inputs, outputs, [read[name] for name in names])
    return replace(made, in_place=in_place)


def joint(name: str, role: Role = Role.COMMAND) -> Port:
    return replace(JOINTS[name.rpartition(".")[2]], name=name, role=role)


def signature(f: Function, joints: tuple[str, ...] | None = SPINS) -> list[str]:
    """Return name:type of each argument, with < if it is read and > if it is written."""
    return [f"{a.name}:{a.kind}{'<' * bool(a.reads)}{'>' * bool(a.writes)}" for a in arguments(f, joints)]


DT = Port("dt", Role.COMMAND, "s")
SLIP = output("slip", "m/s", "")
LEFT, RIGHT = (joint(name) for name in SPINS)


@pytest.mark.parametrize(
    ("inputs", "outputs", "in_place", "expected"),
    [
        ((*POSE, *TWIST, DT), POSE, False, ["pose:pose<>", "twist:twist<", "dt:<"]),
        ((LEFT, RIGHT, *TWIST), (LEFT, SLIP), False, ["twist:twist<", "now:wheels<", "out:wheels>", "slip:>"]),
        ((LEFT, RIGHT), (LEFT, RIGHT), True, ["wheels:wheels<>"]),
        ((LEFT, RIGHT), TWIST[:2], False, ["wheels:wheels<", "twist:twist>"]),
        (TWIST, TWIST, False, ["twist:twist<", "out:twist>"]),
        ((LEFT, replace(LEFT, name="left.spin_wanted")), (RIGHT,), False,
         ["now:wheels<", "wanted:wheels<", "out:wheels>"]),
        ((LEFT, replace(LEFT, name="left.spin_now")), (RIGHT,), False,
         ["now:wheels<", "now_wheels:wheels<", "out:wheels>"]),
        ((POSE[2],), (replace(POSE[0], name="x_step"),), False, ["pose:pose<", "step:pose>"]),
        # Another unit, a wheel that is not a member, and many scalars: no shared types.
        ((replace(TWIST[0], unit=""),), (SLIP,), False, ["vx:<", "slip:>"]),
        ((joint("tail.spin"),), (joint("tail.steer"),), False, ["in:in<", "out:out>"]),
        (tuple(Port(f"q{k}", Role.COMMAND, "") for k in range(5)), (SLIP,), False, ["in:in<", "slip:>"]),
        ((DT, Port("radius", Role.GEOMETRY, "m")), (SLIP,), False, ["dt:<", "slip:>"]),
    ],
)  # fmt: skip
def test_arguments(
    inputs: tuple[Port, ...], outputs: tuple[Port, ...], in_place: bool, expected: list[str]
) -> None:
    names = tuple(port.name for port in inputs) * 3
    assert signature(function(inputs, outputs, names[: len(outputs)], in_place)) == expected


def test_without_a_robot_there_are_no_shared_types() -> None:
    f = function((*TWIST, DT), TWIST)
    assert signature(f, None) == ["in:in<", "out:out>"]
    assert members(Module("none", (f,))) == {}


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize("in_place", [True, False])
def test_nothing_is_read_after_it_was_overwritten(in_place: bool, tmp_path: Path) -> None:
    """The function swaps two speeds of one variable."""
    swapped = function((LEFT, RIGHT), (LEFT, RIGHT), ("right.spin", "left.spin"), in_place)
    module = Module("tried", (swapped,), joints=SPINS)
    for name, text in zip(("tried.h", "tried.c"), sources(module), strict=True):
        (tmp_path / name).write_text(text)
    call = "tried_tried(&w)" if in_place else "tried_tried(&w, &w)"
    main = f'#include "tried.h"\nint main(void) {{ tried_wheels w = {{{{1.0f}}, {{2.0f}}}}; {call};\n'
    main += "return (w.left.spin > 1.5f && w.right.spin < 1.5f) ? 0 : 1; }\n"
    (tmp_path / "main.c").write_text(main)
    assert run_program(compile_program(tmp_path, ["main.c", "tried.c"], None, ("-std=c99", "-O2")), "") == ""


def one_variable(step: Step, robot: str) -> str:
    """Return a C function that calls ``step`` with separate variables and with one, and counts different results."""
    pairs = [
        (i.name, o.name)
        for o in step.parameters
        for i in step.parameters
        if o.writes and not o.reads and i.reads and i.type == o.type
    ]
    name = step.name.removeprefix(f"{robot}_")
    lines = [f"static int {name}(void)", "{", "    int wrong = 0;"]
    lines += [f"    {kind} {variable};" for variable, kind in step.variables.items()]
    for given, result in pairs:
        lines += [f"    memset(&{result}, 0, sizeof {result});"]
        lines += [f"    {place} = any();" for place in step.inputs.values()]
        lines += [f"    {call(step)};", f"    {call(step, {result: given})};"]
        out = next(p for p in step.parameters if p.name == result)
        lines += [
            f"    wrong += differ({place_of(given, m)}, {place_of(result, m)});" for m in out.writes.values()
        ]
    return "\n".join([*lines, "    return wrong;", "}"]) if pairs else ""


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize("robot", everyday(NAMES, ("wpilib_swervebot", "nomad_xr4000", "kelly_4ws")))
def test_inputs_and_outputs_may_be_one_variable(robot: str, tmp_path: Path) -> None:
    module = of_gallery(robot).c_module
    if module.prepare is not None:
        return  # results of prepare are no outputs of a step
    for name, text in zip((f"{robot}.h", f"{robot}.c"), sources(module), strict=True):
        (tmp_path / name).write_text(text)
    checks = {s.name: text for s in unit(module).contract.values() if (text := one_variable(s, robot))}
    names = [name.removeprefix(f"{robot}_") for name in checks]
    parts = [
        f'#include "{robot}.h"\n#include <stdio.h>\n#include <string.h>',
        "static unsigned long seed = 7UL;",
        "static float any(void) { seed = (seed * 1103515245UL + 12345UL) & 0x7fffffffUL; "
        "return 4.0f * ((float)(seed >> 8) / 4194304.0f - 1.0f); }",
        "static int differ(float a, float b) { return memcmp(&a, &b, sizeof a) != 0; }",
        *checks.values(),
        "int main(void) { int k; for (k = 0; k < 500; ++k) {",
        *(f'if ({name}() != 0) {{ printf("{name}\\n"); return 0; }}' for name in names),
        "} (void)any; (void)differ; return 0; }",
    ]
    (tmp_path / "main.c").write_text("\n".join(parts))
    flags = ("-std=c99", "-O2", "-ffp-contract=off")
    assert run_program(compile_program(tmp_path, ["main.c", f"{robot}.c"], None, flags), "") == ""
    assert names or all("now" not in s.variables for s in unit(module).contract.values())
