"""Calls of kernels: replacing them, equality of formulas and kernels, and calls in C."""

from __future__ import annotations

import re

import pytest

from tests.robots import ROBOTS, of_gallery
from wmrgen.codegen.c import sources
from wmrgen.derivation.program import optimised
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.build import Builder
from wmrgen.ir.calls import by_name, called, inlined, inlined_calls, with_places
from wmrgen.ir.interpret import EXACT, FLOAT32, evaluate
from wmrgen.ir.kernels import expand, with_kernels
from wmrgen.ir.kernels.choice import INLINE, LIBM, TARGETS
from wmrgen.ir.nodes import Function, Module, Op, count
from wmrgen.ir.verify import PassError, verify_module


def ports(*names: str) -> tuple[Port, ...]:
    return tuple(Port(name, Role.STATE, "", name) for name in names)


def swap() -> Function:
    """(a - b, b - a)."""
    b = Builder()
    x, y = b.input("a"), b.input("b")
    return b.function("swap", ports("a", "b"), ports("p", "q"), [b.sub(x, y), b.sub(y, x)])


def twice() -> Function:
    """Two calls, one of the result of the other: (x - 1) - (1 - x)."""
    b = Builder()
    inner = b.call("swap", b.input("x"), b.const(1))
    outer = b.call("swap", b.result(inner, 0), b.result(inner, 1))
    return b.function("twice", ports("x"), ports("y"), [b.result(outer, 0)])


def test_a_call_is_what_its_kernel_computes() -> None:
    plain = inlined(twice(), by_name([swap()]))
    assert called([twice()]) == {"swap"}
    assert not called([plain])
    assert evaluate(plain, {"x": 5}, EXACT) == {"y": Exact(8)}


def test_places_are_where_values_are() -> None:
    function = twice()
    plain, place = with_places(function, by_name([swap()]))
    assert plain.results == tuple(place[r] for r in function.results)
    assert len(place) == len(function.nodes)


def test_equal_calls_are_one_and_a_factor_of_one_is_none() -> None:
    b = Builder()
    x = b.input("x")
    results = [b.result(b.call("swap", x, b.const(2)), k) for k in (0, 1, 0)]
    assert results[0] == results[2]
    scaled = Builder()
    a, c = scaled.input("a"), scaled.input("c")
    kernel = scaled.function("scaled", ports("a", "c"), ports("y"), [scaled.mul(c, a)])
    one = Builder()
    call = one.call("scaled", one.input("x"), one.const(1))
    f = one.function("f", ports("x"), ports("y"), [call])
    assert all(node.op is not Op.MUL for node in inlined(f, by_name([kernel])).nodes)


STEERED = ("wpilib_swervebot", "agilex_ranger", "jpl_osr", "synchro_drive")


@pytest.mark.parametrize("name", STEERED)
def test_kernels_mean_what_the_formula_says(name: str) -> None:
    """The functions with calls and those without agree exactly, at several points; a wrong kernel does not."""
    derivation = of_gallery(name, "inverse")
    module = derivation._kept_whole
    assert {k.name for k in module.kernels} <= {"steer_along", "steer_along_from"} and module.kernels
    raw = derivation.raw_module.functions
    verify_module(raw, inlined_calls(module), "calls", 3)
    wrong = tuple(Function(**{**_fields(k), "results": k.results[::-1]}) for k in module.kernels)
    broken = Module(module.name, module.functions, module.prepare, wrong)
    with pytest.raises(PassError):
        verify_module(raw, inlined_calls(broken), "calls", 3)


@pytest.mark.parametrize("name", STEERED)
def test_forward_says_that_wheels_roll_at_their_angles(name: str) -> None:
    """A vector for each steered wheel, of its spin at its angle; size (sin, cos) in its place is refused."""
    derivation = of_gallery(name, "forward")
    module, raw = derivation._kept_whole, derivation.raw_module.functions
    (kernel,) = module.kernels
    steered = [w for w in derivation.robot.wheels if w.turns]
    calls = [node for node in module.function("forward").nodes if node.op is Op.CALL]
    assert kernel.name == "vector_at" and len(calls) == len(steered)
    verify_module(raw, inlined_calls(module), "calls", 3)
    wrong = Function(**{**_fields(kernel), "results": kernel.results[::-1]})
    with pytest.raises(PassError):
        verify_module(
            raw, inlined_calls(Module(module.name, module.functions, module.prepare, (wrong,))), "calls", 3
        )


def _fields(function: Function) -> dict[str, object]:
    return {name: getattr(function, name) for name in function.__dataclass_fields__}


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("math", [INLINE, LIBM])
def test_every_kernel_of_the_c_is_called_and_written_before(target: str, math: str) -> None:
    for name in STEERED:
        code = with_kernels(of_gallery(name).c_module, "float", math, target)
        wanted = called([*code.functions, *code.kernels])
        assert {k.name for k in code.kernels} == wanted
        known: set[str] = set()
        for kernel in code.kernels:
            assert called([kernel]) <= known
            known.add(kernel.name)
        assert not called(expand(code, "float", LIBM, target).functions)


def test_a_swerve_reads_as_a_person_would_write_it() -> None:
    """Issue 13: inverse and forward of a swerve in at most 60 lines, of a car too; wheels by their names."""
    for name in ("wpilib_swervebot", "ackermann_car"):
        derivation = of_gallery(name)
        source = sources(derivation.c_module)[1]
        bodies = re.findall(rf"^void {name}_(?:inverse|forward)\((?:.|\n)*?^\}}\n", source, flags=re.M)
        assert len(bodies) == 2
        assert sum(body.count("\n") for body in bodies) <= 60
    body = re.search(r"^void wpilib_swervebot_inverse\((?:.|\n)*?^\}\n", _swerve(), flags=re.M)
    assert body is not None
    assert len(re.findall(r"const wmrgen_wheel (\w+) = wmrgen_steer_along\(", body[0])) == 4
    unnamed = re.findall(r"const float t\d+ = (.*);", body[0])
    assert unnamed == ["0.381f * twist->omega"]  # the share of the yaw rate in all four velocities


def _swerve() -> str:
    derivation = of_gallery("wpilib_swervebot")
    return sources(derivation.c_module)[1]


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_calls_change_no_result(name: str) -> None:
    """In float32 the functions with calls of formulas' kernels are within a few units of those without, and have no
    more operations: CasADi and NumPy are given them."""
    derivation = of_gallery(name)
    kept, raw = derivation._kept_whole, derivation.raw_module
    for function in optimised(raw, raw).functions:
        other = inlined_calls(kept).function(function.name)
        assert sum(count(other)) <= sum(count(function))
        if any(port.role is Role.PREPARED for port in function.inputs):
            continue
        case = {port.name: 0.3 + 0.1 * k for k, port in enumerate(function.inputs)}
        want, found = evaluate(function, case, FLOAT32), evaluate(other, case, FLOAT32)
        assert found == {name: pytest.approx(value, rel=1e-5, abs=1e-5) for name, value in want.items()}
