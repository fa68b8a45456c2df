"""Names and comments of generated C are correct: a named value has that value, also at stops and at standstill."""

from __future__ import annotations

import re

import numpy as np
import pytest

from tests.robots import of_gallery, of_text
from wmrgen.codegen import arrays, javascript, rust
from wmrgen.codegen.c import places_in
from wmrgen.codegen.c.emit import sources
from wmrgen.codegen.registry import Facts
from wmrgen.ir.calls import by_name, inlined_calls, with_places
from wmrgen.ir.interpret import FLOAT64, evaluate, evaluate_nodes
from wmrgen.ir.kernels import with_kernels
from wmrgen.ir.kernels.choice import DEFAULT
from wmrgen.ir.nodes import contract

ROBOTS = ("wpilib_swervebot", "nomad_xr4000", "ackermann_car", "pioneer3dx", "agilex_ranger", "f1tenth")


@pytest.mark.parametrize("robot", ROBOTS)
def test_named_values_are_correct(robot: str) -> None:
    """In float64, of optimised code and of the code of a processor: the named value is that of the formula.

    Steering angles reach beyond every stop; every other twist is small.
    """
    derivation = of_gallery(robot)
    raw = {f.name: f for f in derivation.raw_module.functions}
    module = derivation.c_module
    compiled = with_kernels(module, "double", DEFAULT.math, DEFAULT.target)
    random = np.random.default_rng(4)
    seen = 0
    for code in (module, compiled):
        prepared = evaluate(code.prepare, {}, FLOAT64) if code.prepare else {}
        for function in code.functions:
            formula = raw[function.variant_of or function.name]
            node = {each.name: each.node for each in formula.named}
            plain, at = with_places(function, by_name(code.kernels))
            for k in range(20):
                size = (2.0, 1e-3)[k % 2]
                case = {port.name: float(random.uniform(-size, size)) for port in contract(formula)}
                case |= {name: float(random.uniform(-4, 4)) for name in case if name.endswith(".steer")}
                results = evaluate_nodes(plain, case | prepared, FLOAT64)
                exact = evaluate_nodes(formula, case, FLOAT64)
                for each in function.named:
                    expected = pytest.approx(exact[node[each.name]], rel=1e-9, abs=1e-9)
                    assert results[at[each.node]] == expected, (function.name, each.name)
                    seen += 1
    assert seen >= 20 * 8


def test_names_of_kernels_are_those_of_their_formulas() -> None:
    kernel = next(k for k in of_gallery("wpilib_swervebot").c_module.kernels if k.name == "steer_along")
    names = {each.name: each.node for each in kernel.named}
    assert {"size", "heading"} <= names.keys()
    at = {"x": -3.0, "y": 4.0, "now": 0.3, "per_rim": 2.0}
    results = evaluate_nodes(kernel, at, FLOAT64)
    assert results[names["size"]] == 5.0
    assert np.tan(results[names["heading"]]) == pytest.approx(-4 / 3)


def test_comments_and_lines() -> None:
    source = sources(of_gallery("wpilib_swervebot").c_module)[1]
    note = r"    /\* v_Ax of front_left, v_Ax of back_left \*/"
    assert re.search(rf"^    const float front_left_x = .*;{note[3:]}$", source, flags=re.M)
    car = sources(of_gallery("ackermann_car").c_module)[1]
    assert re.search(r"^    /\* t of front_left \*/\n    const float front_left_t = .*;$", car, flags=re.M)
    assert re.search(
        r"^    const float half_turn = .*; /\* sigma \*/$", source, flags=re.M
    )  # as in the report
    lines = source.splitlines()
    inverse = {p.function: p for p in places_in("wpilib_swervebot.c", source)}["wpilib_swervebot_inverse"]
    assert lines[inverse.line - 1].startswith("void wpilib_swervebot_inverse(")
    texts = {text for text, _ in inverse.quantities}
    assert "front_left.spin" in texts and sum("of front_left" in text for text in texts) >= 2
    for text, number in inverse.quantities:
        assert text in lines[number - 1] or (text in lines[number - 2] and ";" in lines[number - 1])


def test_results_of_a_kernel_for_one_wheel_have_the_name_of_the_wheel() -> None:
    """This also holds for a kernel that takes a clamped present angle, or a difference of two angles."""
    limited, swinging = (
        sources(of_gallery(name).c_module)[1] for name in ("agilex_ranger", "wpilib_swervebot")
    )
    steered = re.findall(
        r"const wmrgen_wheel (\w+) = wmrgen_steer_along\([^;]*wmrgen_clamp\(now->(\w+)", limited
    )
    assert len(steered) >= 4 and all(name == wheel for name, wheel in steered)
    body = swinging.partition("_compensate_steering(")[2].partition("\n}")[0]
    speeds = re.findall(r"wheels->(\w+)\.spin = wheels->\w+\.spin \* (\w+)\.x;", body)
    assert len(speeds) == 4 and all(name == wheel for wheel, name in speeds)


@pytest.mark.parametrize(("function", "most"), [("inverse_together", 10), ("accelerations", 24)])
def test_long_functions_name_what_they_compute(function: str, most: int) -> None:
    """For a swerve drive, only products and parts of sums are unnamed; both results of `accelerations` have a name."""
    source = sources(of_gallery("wpilib_swervebot", "inverse", "forward", function).c_module)[1]
    body = source.partition(f"_{function}(")[2].partition("\n}")[0]
    assert len(re.findall(r"const float t\d+ = ", body)) <= most < len(re.findall("const float ", body)) / 2
    assert "out_out" not in body and body.count("spin_rate = ") >= 4 * (function == "accelerations")


def test_clamped_angles_have_their_own_name() -> None:
    """The angle before clamping has another name than the angle within the limits."""
    source = sources(of_gallery("agilex_ranger").c_module)[1]
    targets = re.findall(r"const float (\w+_target) = (\w+)\(", source)
    assert targets and {kernel for _, kernel in targets} == {"wmrgen_clamp"}


def test_other_languages_have_the_names() -> None:
    """Results of kernels have names of wheels.

    Names of formulas begin with an underscore if a port may have the name.
    """
    module = of_gallery("wpilib_swervebot").c_module
    crate = next(t for n, t in rust.emit(module, Facts()).items() if n.endswith("lib.rs")).decode()
    assert "let front_left_x: f32 = " in crate and "let front_left: Wheel = wmrgen_steer_along(" in crate
    plain = inlined_calls(module)
    assert "_front_left_x = " in arrays.emit(plain, Facts())["wpilib_swervebot.py"].decode()
    assert "const _front_left_x = " in javascript.text(plain, Facts())


CALIBRATED = """wmrgen: 1
name: sample
parameters:
  half_track: {value: 0.21, tunable: true}
  radius: {value: 0.05, tunable: true}
  turned: {value: 0.1, tunable: true}
wheels:
  - {name: a, type: swedish, x: 0.3, y: half_track, heading: turned, gamma: -45 deg, r: radius}
  - {name: b, type: swedish, x: 0.3, y: -half_track, heading: 0, gamma: 45 deg, r: radius}
  - {name: c, type: swedish, x: -0.3, y: half_track, heading: 0, gamma: 45 deg, r: radius}
  - {name: e, type: swedish, x: -0.3, y: -half_track, heading: 0, gamma: -45 deg, r: radius}
"""


@pytest.mark.parametrize("text", ["pioneer3dx", "kuka_youbot", CALIBRATED])
def test_comments_on_prepared_numbers_are_correct(text: str) -> None:
    """Formulas in the header are correct for calibrated parameters; so are the factors given for long formulas."""
    d = of_text(text) if "\n" in text else of_gallery(text)
    header, prepare = sources(d.c_module)[0], d.c_module.prepare
    said = re.findall(r"float (k\d+); +/\*\*< (.*?) \*/", header)
    used = re.compile(r"(?:factor of -?(\S+(?: [+-] \S+)?) )?for (.*) in (\w+)")
    formulas = [(name, formula) for name, formula in said if not used.fullmatch(formula)]
    assert prepare and formulas and len(said) == len(prepare.outputs)
    for share in (1.0, 0.9):
        values = {p.name: share * float(p.default or 0) for p in prepare.inputs}
        results = evaluate(prepare, values, FLOAT64)
        for name, formula in formulas:
            assert not re.search(r"[^\w .*/+()-]", formula)
            assert eval(formula, {}, values) == pytest.approx(
                results[name], rel=1e-5
            )  # the text is generated, not user input
    for name, (factor, outputs, function) in ((k, m.groups()) for k, s in said if (m := used.fullmatch(s))):
        assert factor or function == "forward_slip"
        whole = next(f for f in d.c_module.functions if f.name == function)
        one = {p.name: results.get(p.name, float(p.name == factor)) for p in whole.inputs}
        for output in outputs.split(", ") if factor else ():
            assert abs(evaluate(whole, one, FLOAT64)[output]) == pytest.approx(abs(results[name]), rel=1e-9)
