"""An operation from outside the package: one record, and every part of the package knows it."""

from __future__ import annotations

import ctypes
import math
import random
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from tests.codegen.c.harness import COMPILERS, STRICT, Program
from tests.external_tools import need
from tests.ir.bounds.small import walked
from tests.ir.common import optimised, verify_function
from tests.ir.defined import RULES, Fact, facts, findings
from wmrgen.analysis.kinematics.records import Formula
from wmrgen.codegen import arrays, casadi, rust
from wmrgen.codegen.registry import Facts
from wmrgen.codegen.rust.emit import library
from wmrgen.codegen.rust.functions import unit
from wmrgen.geometry.exact import interval as iv
from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.printing import Latex
from wmrgen.geometry.symbolic import Operation, signal
from wmrgen.ir.bounds.partition import cases
from wmrgen.ir.build import Builder
from wmrgen.ir.interpret import EXACT, FLOAT32, FLOAT64, evaluate
from wmrgen.ir.kernels import expand
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Function, Module, Op, Port, Role, count
from wmrgen.ir.ops import OPERATIONS
from wmrgen.ir.ops.analysis import Bounded
from wmrgen.ir.pipeline import optimise
from wmrgen.ir.selftest.rounding_bounds import bounds
from wmrgen.ir.selftest.vectors import tables
from wmrgen.ir.verify import RESIDUES, PassError

NAMES = ("x", "y", "z")


def excess_slopes(a: iv.Interval, b: iv.Interval) -> tuple[iv.Interval, iv.Interval]:
    """1 and -1 where a is above b, 0 where it is not."""
    lo, hi = np.where(a[0] > b[1], 1.0, 0.0), np.where(a[1] < b[0], 0.0, 1.0)
    return (lo, hi), (-hi, -lo)


def excess_range(a: iv.Interval, b: iv.Interval) -> iv.Interval:
    lo, hi = iv.minus(a, b)
    return np.maximum(lo, 0.0), np.maximum(hi, 0.0)


@pytest.fixture(scope="module")
def excess() -> Iterator[Op]:
    """What a has more than b: a - b where a > b, else 0. C calls it fdim."""
    yield Op(
        "excess", 2, lambda a, b: a - b if b < a else a - a, rounds=True,
        many=lambda a, b: np.maximum(a - b, 0.0), cost="additions",
        c="fdim{f}({0}, {1})", includes=("<math.h>",), arrays="xp.maximum({0} - {1}, 0.0)",
        casadi=lambda ca, a, b: ca.fmax(a - b, 0),
        interval=excess_range, slopes=excess_slopes,
    )  # fmt: skip
    del OPERATIONS["excess"]


def made(excess: Op) -> Function:
    """excess(x y, z) / (excess(y, x) + 1) and a root of an excess; one of constants is folded."""
    b = Builder()
    x, y, z = (b.input(name) for name in NAMES)
    two = b.apply(excess, (b.const(5), b.const(3)))
    assert b.value(two) == 2
    first = b.apply(excess, (b.mul(x, y), b.mul(two, z)))
    second = b.add(b.apply(excess, (y, x)), b.const(1))
    inputs = tuple(Port(name, Role.COMMAND, "m/s", "an input") for name in NAMES)
    outputs = tuple(Port(name, Role.COMMAND, "1", "an output") for name in ("u", "v"))
    return b.function("rates", inputs, outputs, [b.div(first, second), b.sqrt(b.apply(excess, (z, x)))])


def points() -> list[dict[str, float]]:
    """Random float32 numbers, equal ones among them."""
    chance = random.Random(5)
    rows = [[ctypes.c_float(chance.uniform(-9, 9)).value for _ in NAMES] for _ in range(200)]
    rows += [[2.0, 2.0, 2.0], [-0.0, 0.0, 0.0], [1.5, -1.5, 1.5]]
    return [dict(zip(NAMES, row, strict=True)) for row in rows]


def expected(p: dict[str, float]) -> tuple[float, float]:
    x, y, z = (p[name] for name in NAMES)
    return max(x * y - 2 * z, 0.0) / (max(y - x, 0.0) + 1), math.sqrt(max(z - x, 0.0))


def test_the_interpreter_knows_it(excess: Op) -> None:
    f = made(excess)
    for p in points():
        u, v = expected(p)
        exact = evaluate(f, p, EXACT)
        assert float(exact["u"]) == pytest.approx(u, rel=1e-12, abs=1e-15)
        assert float(exact["v"]) == pytest.approx(v, rel=1e-12)
        assert evaluate(f, p, FLOAT64) == {"u": u, "v": v}
        assert evaluate(f, p, FLOAT32)["u"] == pytest.approx(u, rel=3e-6, abs=1e-5)
    assert EXACT.of(excess)(Exact(3), ONE) == 2
    residue = RESIDUES.of(excess)(RESIDUES.enter(3), RESIDUES.enter(ONE))
    assert (residue.r, residue.size) == (2, 2.0)
    single = 1 / 3 - ctypes.c_float(1e-3).value
    assert FLOAT32.of(excess)(1 / 3, ctypes.c_float(1e-3).value) == ctypes.c_float(single).value


def test_a_formula_names_it(excess: Op) -> None:
    class Excess(Operation):
        """What the first has more than the second."""

        op = excess
        nargs = 2

    ports = tuple(Port(name, Role.COMMAND, "m/s", "an input") for name in NAMES)
    x, y, z = (signal(name) for name in NAMES)
    outputs = ((Port("u", Role.COMMAND, "1", "an output"), Excess(x * y, 2 * z) / (Excess(y, x) + 1)),)
    f = lower(Formula("rates", ports, (), outputs, "A formula with an operation from outside."))
    assert sum(node.op is excess for node in f.nodes) == 2
    for p in points():
        assert evaluate(f, p, FLOAT64)["u"] == expected(p)[0]
    assert Latex().doprint(Excess(y, x)) == rf"\mathrm{{{excess}}}\left(y,\, x\right)"


def test_passes_keep_it_and_their_checks_see_it(excess: Op) -> None:
    f = made(excess)
    module = optimised((f,), "outside")
    assert sum(node.op is excess for node in module.functions[0].nodes) == 3
    assert count(module.functions[0]).additions == 4 and count(module.functions[0]).multiplications == 2
    swapped = tuple(
        type(n)(n.op, n.args[::-1], n.value, n.name) if n.op is excess else n
        for n in module.functions[0].nodes
    )
    wrong = Function("rates", f.inputs, swapped, f.outputs, module.functions[0].results)
    with pytest.raises(PassError):
        verify_function(f, wrong, "a swap")


def test_its_facts_show_that_divisor_and_root_are_defined(
    excess: Op, monkeypatch: pytest.MonkeyPatch
) -> None:
    f = made(excess)
    assert len(findings(f)) == 2
    monkeypatch.setitem(RULES, excess, lambda a, b: Fact(ZERO))
    assert findings(f) == ()
    assert all(fact.at_least_zero for fact, node in zip(facts(f), f.nodes, strict=True) if node.op is excess)


def test_it_is_bounded(excess: Op) -> None:
    """By its interval and slopes alone: ranges hold, errors are not exceeded and not 32 times too large."""
    f = made(excess)
    ranges = dict.fromkeys(NAMES, (-9.0, 9.0)) | {"z": (10.0, 19.0)}
    walk = walked(f, ranges)
    assert walk.alarms == []
    errors = walk.errors(f.results).plain[:, 0]
    chance = random.Random(6)
    worst = {"u": 0.0, "v": 0.0}
    for _ in range(4000):
        p = {n: ctypes.c_float(chance.uniform(*ends)).value for n, ends in ranges.items()}
        single, exact = evaluate(f, p, FLOAT32), evaluate(f, p, FLOAT64)
        for k, name in enumerate(worst):
            lo, hi = walk.ranges[f.results[k]]
            assert lo[0] <= single[name] <= hi[0]
            worst[name] = max(worst[name], abs(single[name] - exact[name]))
    assert worst["u"] <= errors[0] <= 32 * worst["u"]
    assert worst["v"] <= errors[1] <= 32 * worst["v"]
    assert cases(f, ranges) == [ranges]


def test_self_tests_have_its_tolerances(excess: Op) -> None:
    f = made(excess)
    columns = {n: np.array([p[n] for p in points()]) for n in NAMES}
    known = {n: Bounded(c, np.zeros((2, len(c)))) for n, c in columns.items()}
    result = bounds(f, known, "float", len(points()))
    for k, p in enumerate(points()):
        single = evaluate(f, p, FLOAT32)
        for name, at in zip(("u", "v"), f.results, strict=True):
            assert abs(single[name] - result[at].value[k]) <= result[at].error[0, k] + 1e-300
    (table,) = tables(Module("outside", (f,)), "float")
    assert len(table.vectors) >= 8


@pytest.mark.skipif(not COMPILERS, reason="no C compiler here")
@pytest.mark.parametrize("target", ["m4f", "m0", "host"])
def test_c_has_the_bits_of_the_interpreter(excess: Op, target: str, tmp_path: Path) -> None:
    program = Program((optimise((made(excess),), "outside"),), "float", 40, target=target)
    program.write(tmp_path)
    assert (
        "fdimf(" in (tmp_path / "outside.c").read_text()
        and "<math.h>" in (tmp_path / "outside.c").read_text()
    )
    assert program.mismatches(tmp_path, COMPILERS[0], (*STRICT, "-O2")) == []


def test_rust_declares_it_and_has_the_bits_of_the_interpreter(excess: Op) -> None:
    need("rustc")
    module = optimise((made(excess),), "outside")
    assert "pub fn fdimf(a: f32, b: f32) -> f32;" in library(unit(module, DEFAULT))
    printed = expand(module, "float", "inline")
    expectation = [evaluate(printed.functions[0], p, FLOAT32) for p in points()]
    assert rust.evaluate(module, [("rates", p) for p in points()], **DEFAULT.words()) == expectation


def test_arrays_and_casadi_compute_it(excess: Op) -> None:
    module = optimise((made(excess),), "outside")
    expectation = [evaluate(module.functions[0], p, FLOAT64) for p in points()]
    requests = [("rates", p) for p in points()]
    assert arrays.evaluate(module, requests) == expectation
    for result, wanted in zip(casadi.evaluate(module, requests), expectation, strict=True):
        assert result == pytest.approx(wanted, rel=1e-15, abs=1e-300)
    source = arrays.emit(module, Facts())["outside.py"].decode()
    assert source.count("xp.maximum(") == 3


def test_a_name_stands_for_one_operation(excess: Op) -> None:
    with pytest.raises(ValueError, match="excess"):
        Op("excess", 1)
    assert OPERATIONS["excess"] is excess


def test_a_constant_is_a_field_element(excess: Op) -> None:
    """Folding stays exact."""
    b = Builder()
    third = b.apply(excess, (b.const(Fraction(1, 3)), b.const(Fraction(1, 7))))
    assert b.value(third) == Exact(Fraction(4, 21))
