"""Every function of control, motion and space: defined for every input, the same numbers on every backend."""

from __future__ import annotations

import math
from functools import cache

import casadi
import numpy as np
import pytest

import wmrgen
from tests.conftest import GALLERY
from tests.depth import everyday
from tests.functions.motion.common import CAR, DIFFERENTIAL, FOUR_WS, MECANUM_T, OMNI_K, SKEWED, TRICYCLE
from tests.ir.defined import findings
from tests.robots import with_functions
from wmrgen.codegen.registry import BACKENDS
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import declaration, names
from wmrgen.geometry.layout import build
from wmrgen.geometry.layout.records import Robot
from wmrgen.ir.interpret import EXACT, FLOAT32, evaluate_module
from wmrgen.robotfile.load import read_text

FAMILIES = tuple(f"wmrgen.functions.{family}." for family in ("control", "motion", "space"))
FUNCTIONS = tuple(n for n in names() if declaration(n).build.__module__.startswith(FAMILIES))
NOISE = "noise: {spin: {proportional: 0.02, constant: 0.1}, steer: {constant: 0.01}, steer_rate: {constant: 0.1}}\n"
ENCODER = "encoder: {spin: {counts: 4096, gear: 30}},"
TEXTS = {
    "car": CAR + "limits: {steer: 0.6, spin: 20}\n" + NOISE,
    "differential": (DIFFERENTIAL + NOISE).replace("type: fixed,", f"type: fixed, {ENCODER}"),
    "four_ws": FOUR_WS + NOISE,
    "mecanum": MECANUM_T + "limits: {spin: [-11, 12]}\n" + NOISE,
    "omni": OMNI_K,
    "skewed": SKEWED,
    "tricycle": TRICYCLE + "limits: {steer: 0.6, vx: 1.7, steer_rate: 2}\n",
}
TEXTS |= {p.stem: p.read_text(encoding="utf-8") for p in GALLERY}
MADE = [name for name in TEXTS if name not in {p.stem for p in GALLERY}]
FEW = ("car", "skewed", "four_ws")  # whose cases are everyday
LONG = ("axles", "forward_covariance", "stability", "steer_to")  # half a second and more each
TINY = 1e-9


@cache
def robot(name: str) -> Robot:
    """With a centre of gravity."""
    text = TEXTS[name]
    return build(
        read_text(text if "cg:" in text else f"{text}cg: {{x: 0.02, y: 0.01, z: 0.6}}\n", f"{name}.yaml")
    )


@cache
def derivation(name: str, functions: tuple[str, ...] = FUNCTIONS) -> Derivation:
    """Those of the functions that the robot has, and no others; the error of each that it has not explains that."""
    tried, has = wmrgen.derive(robot(name)), []
    for function in functions:
        try:
            tried.formula(function)
            has.append(function)
        except NotDerivableError as error:
            assert error.what.startswith(f"{robot(name).name} ") and len(error.what) > 40
    return with_functions(tried, has)


@pytest.mark.slow
def test_a_function_can_be_tried() -> None:
    """Each on some robot."""
    has = {f.name for name in (*MADE, "wpilib_swervebot") for f in derivation(name).program.formulas}
    assert has == set(FUNCTIONS)


@pytest.mark.parametrize("name", everyday(TEXTS, FEW))
def test_every_function_is_defined_everywhere(name: str) -> None:
    """No division or root without proof; finite in float at rest and far out; Jacobians without NaN."""
    derived = derivation(name)
    functions = derived.casadi()
    nominal = {p.name: float(p.nominal) for p in derived.robot.parameters}
    for f in derived.module.functions:
        assert not findings(f), f.name
    for formula in derived.program.formulas:
        raw = derived.raw_module.function(formula.name)
        assert not [f for f in findings(raw) if not f.geometry], formula.name
        ports = [p for p in formula.inputs if p.default is None]
        for value in (0.0, 1e-30, 1.0, -1e6):
            case = {p.name: value for p in ports}
            result = evaluate_module(derived.module, formula.name, case, FLOAT32)
            assert all(math.isfinite(v) for v in result.values()), (formula.name, value, result)
        f = functions[formula.name]
        x = casadi.SX.sym("x", f.n_in())
        columns = casadi.jacobian(casadi.vertcat(*f.call(casadi.vertsplit(x))), x)
        at = casadi.Function("j", [x], [columns])([nominal.get(n, 0.3) for n in f.name_in()])
        assert np.isfinite(np.array(at)).all(), formula.name


@pytest.mark.parametrize("function", ["inverse_world", "goto_pose", "pursuit", "accelerations"])
def test_what_is_built_on_inverse_keeps_its_kernels(function: str) -> None:
    """One steering kernel for each module of a swerve drive, as in `inverse`; they were expanded in some."""
    derived = derivation("wpilib_swervebot", (function,))
    kernels = [c.kernel.name for c in derived.formula(function).calls]
    assert kernels == [c.kernel.name for c in derived.formula("inverse").calls] and len(kernels) == 4


CASTORS_AND_COUPLINGS = {
    "ackermann_car": ("accelerations",),
    "jpl_osr": ("stability",),
    "kelly_4ws": ("accelerations",),
    "nomad_xr4000": ("accelerations", "stability"),
    "pr2": ("stability",),
    "synchro_drive": ("accelerations",),
    "wpilib_swervebot": ("inverse_together",),
}
QUICK = tuple(f for f in FUNCTIONS if f not in LONG)  # every day the car stands for the others


@pytest.mark.parametrize(
    ("name", "functions"),
    [
        pytest.param("car", FUNCTIONS, id="car"),
        *(pytest.param(n, QUICK, id=n) for n in FEW[1:]),
        *(pytest.param(n, LONG, id=f"{n}-long", marks=pytest.mark.slow) for n in FEW[1:]),
        *(pytest.param(n, FUNCTIONS, id=n, marks=pytest.mark.slow) for n in MADE if n not in FEW),
        *(pytest.param(n, functions, id=n) for n, functions in CASTORS_AND_COUPLINGS.items()),
    ],
)
def test_backends_agree(name: str, functions: tuple[str, ...]) -> None:
    derived = derivation(name, functions)
    rng = np.random.default_rng(3)
    requests = []
    for formula in derived.program.formulas:
        nominal = {p.name: float(p.default) for p in formula.inputs if p.default is not None}
        for _ in range(3):
            case = {p.name: round(float(rng.uniform(-1, 1)), 6) for p in formula.inputs} | nominal
            requests.append((formula.name, case))
    in_c = BACKENDS["c99"].evaluate(derived.c_module, requests, {"scalar": "double"})
    by_casadi = derived.casadi()
    for (function, case), of_c in zip(requests, in_c, strict=True):
        exact = evaluate_module(derived.raw_module, function, case, EXACT)
        f = by_casadi[function]
        in_casadi = dict(zip(f.name_out(), f.call([case[n] for n in f.name_in()]), strict=True))
        for found in (in_casadi, of_c):
            assert exact.keys() == found.keys(), function
            wanted = [float(v) for v in exact.values()]
            values = [float(found[k]) for k in exact]
            np.testing.assert_allclose(values, wanted, rtol=TINY, atol=TINY, err_msg=function)
