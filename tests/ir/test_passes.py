"""Every pass leaves every output unchanged, exactly, and does what it is for."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given, settings

from tests.depth import examples
from tests.ir.common import RING, build, functions, optimised, verify_function
from tests.ir.defined import findings
from wmrgen.ir.geometry import geometry_only
from wmrgen.ir.interpret import EXACT, FLOAT64, evaluate
from wmrgen.ir.linear_forms import share_linear_forms
from wmrgen.ir.nodes import Function, Op, Role, count, schedule
from wmrgen.ir.pipeline import AFTER_HOIST, BEFORE_HOIST, drop_dead_code, hoist, optimise
from wmrgen.ir.simplify import factor, reduce_strength, regroup_products
from wmrgen.ir.verify import PassError, points, verify_module


@pytest.mark.parametrize("step", [*BEFORE_HOIST, *AFTER_HOIST], ids=lambda step: step.__name__)
@given(f=functions())
@settings(max_examples=examples(100))
def test_a_pass_keeps_every_value(step, f: Function) -> None:
    verify_function(f, step(f), step.__name__, 3)


@given(functions(kinds=RING, size=40))
@settings(max_examples=examples(100))
def test_polynomials_keep_their_values_in_plain_exact_arithmetic(f: Function) -> None:
    module = optimise((f,), "m")
    for point in points(f, 3):
        known = dict(point)
        if module.prepare is not None:
            known.update(evaluate(module.prepare, point, EXACT))
        assert evaluate(module.functions[0], known, EXACT) == evaluate(f, point, EXACT)


@given(functions(), functions())
@settings(max_examples=examples(100))
def test_the_pipeline_keeps_every_value_and_reads_no_geometry(f: Function, g: Function) -> None:
    g = Function("g", g.inputs, g.nodes, g.outputs, g.results)
    module = optimised((f, g), "m")
    for function in module.functions:
        assert all(port.role is not Role.GEOMETRY for port in function.inputs)
        assert [port.name for port in function.inputs][:3] == ["x", "y", "z"]
        known = geometry_only(function)
        assert all(not known[i] or not node.args or not _reads_input(function, i)
                   for i, node in enumerate(function.nodes))  # fmt: skip
    if module.prepare is not None:
        assert [port.name for port in module.prepare.outputs] == [
            f"k{i}" for i in range(len(module.prepare.outputs))
        ]


def _reads_input(function: Function, i: int) -> bool:
    node = function.nodes[i]
    return node.op is Op.INPUT or any(_reads_input(function, arg) for arg in node.args)


@given(functions())
@settings(max_examples=examples(50))
def test_the_pipeline_is_repeatable(f: Function) -> None:
    assert optimise((f,), "m") == optimise((f,), "m")


def test_a_wrong_pass_is_caught() -> None:
    right = build(["x", "y"], lambda b, v: {"o": b.atan2(v["x"], b.mul(b.const(2), v["y"]))})
    wrong = build(["x", "y"], lambda b, v: {"o": b.atan2(v["x"], b.mul(b.const(3), v["y"]))})
    verify_function(right, right, "nothing")
    with pytest.raises(PassError) as caught:
        verify_function(right, wrong, "nothing")
    assert (caught.value.step, caught.value.output) == ("nothing of f", "o")


def test_linear_forms_share_what_common_subexpressions_miss() -> None:
    """vx + vy and vx - vy, each in two wheels, across outputs and inside functions."""
    f = build(["a", "b", "c"], lambda b, v: {
        "o0": b.sqrt(b.abs(b.sum([v["a"], v["b"], v["c"]]))),
        "o1": b.sum([v["a"], b.neg(v["c"]), v["b"]]),
        "o2": b.sin(b.sum([v["a"], b.neg(v["b"]), v["c"]])),
        "o3": b.sum([b.neg(v["c"]), b.neg(v["b"]), v["a"]]),
    })  # fmt: skip
    assert count(share_linear_forms(f)).flops == 6


def test_linear_forms_keep_intermediate_sums_that_pay() -> None:
    """Residuals z_i - h_i m of a mean m: expanding m would cost n^2."""
    names = [f"z{i}" for i in range(8)]

    def body(b, v):
        mean = b.mul(b.const(Fraction(1, 8)), b.sum(v[name] for name in names))
        return {f"e{i}": b.square(b.sub(v[name], mean)) for i, name in enumerate(names)}

    cost = count(share_linear_forms(build(names, body)))
    assert (cost.additions, cost.multiplications) == (15, 9)


def test_cancelling_terms_vanish() -> None:
    f = build(["a", "b"], lambda b, v: {"o": b.sub(b.add(b.add(v["a"], v["b"]), b.const(1)), v["b"])})
    assert count(share_linear_forms(f)).flops == 1


def test_tunable_coefficients_are_shared_up_to_sign() -> None:
    def body(b, v):
        arm = b.add(v["lx"], v["ly"])
        back = b.sub(b.neg(v["ly"]), v["lx"])
        return {
            "a": b.div(b.add(v["vx"], b.mul(arm, v["w"])), v["r"]),
            "b": b.div(b.add(v["vx"], b.mul(back, v["w"])), v["r"]),
        }

    geometry = {"r": Fraction(1, 20), "lx": Fraction(1, 5), "ly": Fraction(1, 6)}
    f = build(["vx", "w"], body, geometry)
    module = optimised((f,), "m")
    assert count(module.functions[0]).flops == 4
    assert count(module.functions[0]).divisions == 0
    assert module.prepare is not None
    assert [port.name for port in module.prepare.outputs] == ["k0", "k1"]
    assert [port.name for port in module.prepare.inputs] == ["r", "lx", "ly"]


def test_equal_prepared_values_are_shared_between_functions() -> None:
    f = build(["x"], lambda b, v: {"o": b.div(v["x"], v["r"])}, {"r": Fraction(1, 4)})
    g = build(["y"], lambda b, v: {"o": b.mul(v["y"], b.div(b.const(1), v["r"]))}, {"r": Fraction(1, 4)}, "g")
    module = hoist((reduce_strength(f), reduce_strength(g)), "m")
    verify_module((f, g), module, "hoist")
    assert module.prepare is not None
    assert len(module.prepare.outputs) == 1


def test_without_tunable_geometry_there_is_no_prepare() -> None:
    f = build(["x"], lambda b, v: {"o": b.sin(v["x"])})
    assert optimise((f,), "m").prepare is None


def test_factor_takes_out_common_factors_unless_products_are_shared() -> None:
    def alone(b, v):
        return {"o": b.add(b.mul(v["k"], v["x"]), b.mul(v["k"], v["y"]))}

    def shared(b, v):
        return {**alone(b, v), "p": b.mul(v["k"], v["x"])}

    assert count(factor(build(["k", "x", "y"], alone))).multiplications == 1
    assert count(factor(build(["k", "x", "y"], shared))).multiplications == 2


def test_strength_divides_once_by_a_value_far_from_zero() -> None:
    def body(b, v):
        divisor = b.add(b.square(v["z"]), b.const(1))
        return {"a": b.div(v["x"], divisor), "b": b.div(v["y"], divisor)}

    def risky(b, v):
        return {"a": b.div(v["x"], v["z"]), "b": b.div(v["y"], v["z"])}

    assert count(reduce_strength(build(["x", "y", "z"], body))).divisions == 1
    assert count(reduce_strength(build(["x", "y", "z"], risky))).divisions == 2


def test_regroup_multiplies_a_common_factor_by_its_constant_once() -> None:
    def body(b, v):
        return {n: b.mul(b.const(3), b.mul(v["x"], b.sin(v[n]))) for n in ("p", "q", "r")}

    assert count(regroup_products(build(["x", "p", "q", "r"], body))).multiplications == 4


def test_regroup_leaves_squares_whole() -> None:
    f = build(["x", "y"], lambda b, v: {"o": b.mul(b.const(3), b.square(b.add(v["x"], v["y"])))})
    assert count(regroup_products(f)) == count(f)


def test_factor_merges_like_terms() -> None:
    def body(b, v):
        twice = b.mul(v["x"], v["y"])
        return {"o": b.add(b.add(twice, b.mul(v["k"], v["x"])), twice)}

    assert count(optimise((build(["k", "x", "y"], body),), "m").functions[0]).flops <= 4


def test_schedule_computes_values_next_to_their_use() -> None:
    names = [f"x{i}" for i in range(6)]

    def body(b, v):
        squares = [b.square(v[name]) for name in names]
        return {f"o{i}": b.add(s, b.const(1)) for i, s in enumerate(squares)}

    nodes = schedule(build(names, body)).nodes
    for i, node in enumerate(nodes):
        if node.op is Op.MUL:
            assert nodes[i + 1].op in (Op.CONST, Op.ADD)


def test_dead_code_keeps_contract_inputs() -> None:
    f = build(["x", "y"], lambda b, v: {"o": v["x"]}, {"r": Fraction(1, 4)})
    assert [port.name for port in drop_dead_code(f).inputs] == ["x", "y"]


GUARDED = {
    "constant added to a square": lambda b, v: b.add(b.square(v["x"]), b.const(Fraction(1, 100))),
    "greater of it and a constant": lambda b, v: b.max(v["x"], b.const(Fraction(1, 100))),
    "select on the value": lambda b, v: b.select(v["x"], b.const(Fraction(1, 100)), b.const(1), v["x"]),
    "select, other way": lambda b, v: b.select(b.const(0), v["x"], v["x"], b.const(1)),
    "kept off zero": lambda b, v: b.apply(Op.AT_LEAST, (v["x"], b.const(Fraction(1, 100)))),
    "kept off zero and small": lambda b, v: b.apply(
        Op.CLAMP, (b.apply(Op.AT_LEAST, (v["x"], b.const(1))), b.const(2))
    ),
    "a size and one, with a sign": lambda b, v: b.with_sign_of(b.add(b.abs(v["x"]), b.const(1)), v["y"]),
    "root of a positive": lambda b, v: b.sqrt(b.add(b.square(v["x"]), b.const(1))),
    "three minus a sine": lambda b, v: b.sub(b.const(3), b.sin(v["x"])),
    "minus a size, minus one": lambda b, v: b.sub(b.neg(b.abs(v["x"])), b.const(1)),
    "product of two guarded": lambda b, v: b.mul(
        b.max(v["x"], b.const(1)), b.add(b.square(v["y"]), b.const(1))
    ),
}
UNGUARDED = {
    "an input": lambda b, v: v["x"],
    "a sum of squares": lambda b, v: b.add(b.square(v["x"]), b.square(v["y"])),
    "select the wrong way": lambda b, v: b.select(v["x"], b.const(Fraction(1, 100)), v["x"], b.const(1)),
    "select on something else": lambda b, v: b.select(v["y"], b.const(Fraction(1, 100)), b.const(1), v["x"]),
    "square of a non-zero, which may underflow": lambda b, v: b.square(
        b.select(b.const(0), v["x"], v["x"], b.const(1))
    ),
    # A comparison that fails leaves equality open: what is not less than 0 may be 0.
    "not less than zero": lambda b, v: b.select(v["x"], b.const(0), b.const(1), v["x"]),
    "not greater than zero": lambda b, v: b.select(b.const(0), v["x"], b.const(1), v["x"]),
    "of a size not less than zero": lambda b, v: b.select(b.abs(v["x"]), b.const(0), b.const(1), v["x"]),
    "of a square not less than zero": lambda b, v: b.select(b.square(v["x"]), b.const(0), b.const(1), v["x"]),
    "greater than a negative": lambda b, v: b.select(b.const(-1), v["x"], v["x"], b.const(1)),
    "greater of it and zero": lambda b, v: b.max(v["x"], b.const(0)),
    "smaller of it and zero": lambda b, v: b.min(v["x"], b.const(0)),
    "kept small": lambda b, v: b.apply(Op.CLAMP, (v["x"], b.const(1))),
    "with the sign of a size and one": lambda b, v: b.with_sign_of(v["x"], b.add(b.abs(v["y"]), b.const(1))),
    "root of a size": lambda b, v: b.sqrt(b.abs(v["x"])),
    "one and a cosine": lambda b, v: b.add(b.const(1), b.cos(v["x"])),
    "one minus a sine": lambda b, v: b.sub(b.const(1), b.sin(v["x"])),
    "one less a size up to one": lambda b, v: b.sub(b.const(1), b.min(b.abs(v["x"]), b.const(1))),
    "a size and one, less one": lambda b, v: b.sub(b.add(b.abs(v["x"]), b.const(1)), b.const(1)),
}


@pytest.mark.parametrize("name", GUARDED)
def test_guarded_divisors_are_recognised(name: str) -> None:
    f = build(["x", "y"], lambda b, v: {"o": b.div(v["y"], GUARDED[name](b, v))})
    assert findings(f) == ()


@pytest.mark.parametrize("name", UNGUARDED)
def test_unguarded_divisors_are_reported(name: str) -> None:
    f = build(["x", "y"], lambda b, v: {"o": b.div(v["y"], UNGUARDED[name](b, v))})
    (finding,) = findings(f)
    assert f.nodes[finding.node].op is Op.DIV
    assert not finding.geometry


@given(functions())
@settings(max_examples=examples(100))
def test_functions_without_findings_are_defined(f: Function) -> None:
    if not findings(f):
        for point in points(f, 3):
            for value in evaluate(f, point, EXACT).values():
                assert value == value


@given(functions())
@settings(max_examples=examples(60))
def test_optimised_floats_agree_with_the_exact_value(f: Function) -> None:
    if any(node.op in (Op.SELECT, Op.ATAN2, Op.AT_LEAST, Op.WITH_SIGN_OF) for node in f.nodes):
        return
    module = optimise((f,), "m")
    for point in points(f, 2):
        inputs = {name: value / 64 for name, value in point.items()}
        known = dict(inputs)
        if module.prepare is not None:
            known.update(evaluate(module.prepare, inputs, FLOAT64))
        exact = evaluate(f, inputs, EXACT)
        for name, value in evaluate(module.functions[0], known, FLOAT64).items():
            if abs(exact[name]) < 1000:
                assert value == pytest.approx(float(exact[name]), rel=1e-5, abs=1e-4)
