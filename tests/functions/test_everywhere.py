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
from wmrgen.backends.registry import BACKENDS
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import declaration, names
from wmrgen.ir.interpret import EXACT, FLOAT32, evaluate_module
from wmrgen.layout import build
from wmrgen.layout.records import Robot
from wmrgen.robot import Derivation
from wmrgen.spec.load import read_text

FAMILIES = tuple(f"wmrgen.functions.{family}." for family in ("control", "motion", "space"))
FUNCTIONS = [n for n in names() if declaration(n).build.__module__.startswith(FAMILIES)]
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
# Of `test_backends_agree`: without formulas of half a second and more that the car's cases stand for.
QUICK = {(n, f) for n in FEW for f in FUNCTIONS} - {
    (n, f) for n in ("skewed", "four_ws") for f in ("axles", "forward_covariance", "stability", "steer_to")
}
TINY = 1e-9


@cache
def robot(name: str) -> Robot:
    """With a centre of gravity."""
    text = TEXTS[name]
    return build(
        read_text(text if "cg:" in text else f"{text}cg: {{x: 0.02, y: 0.01, z: 0.6}}\n", f"{name}.yaml")
    )


def derivation(name: str, function: str) -> Derivation | None:
    """That function alone; None where the robot does not have it, which the error explains."""
    derived = wmrgen.derive(robot(name), [function])
    try:
        derived.formula(function)
    except NotDerivableError as error:
        assert error.what.startswith(f"{robot(name).name} ") and len(error.what) > 40
        return None
    return derived


def test_a_function_can_be_tried() -> None:
    """Each on some robot."""
    assert not [f for f in FUNCTIONS if not any(derivation(name, f) for name in (*MADE, "wpilib_swervebot"))]


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("name", everyday(TEXTS, FEW))
def test_every_function_is_defined_everywhere(name: str, function: str) -> None:
    """No division or root without proof; finite in float at rest and far out; Jacobians without NaN."""
    derived = derivation(name, function)
    if derived is None:
        return
    for f in derived.module.functions:
        assert not findings(f)
    assert not [f for f in findings(derived.raw_module.function(function)) if not f.geometry]
    ports = [p for p in derived.formula(function).inputs if p.default is None]
    for value in (0.0, 1e-30, 1.0, -1e6):
        result = evaluate_module(derived.module, function, {p.name: value for p in ports}, FLOAT32)
        assert all(math.isfinite(v) for v in result.values()), (value, result)
    f = derived.casadi()[function]
    x = casadi.SX.sym("x", f.n_in())
    jacobian = casadi.Function("j", [x], [casadi.jacobian(casadi.vertcat(*f.call(casadi.vertsplit(x))), x)])
    nominal = {p.name: float(p.nominal) for p in derived.robot.parameters}
    assert np.isfinite(np.array(jacobian([nominal.get(n, 0.3) for n in f.name_in()]))).all()


@pytest.mark.parametrize("function", ["inverse_world", "goto_pose", "pursuit", "accelerations"])
def test_what_is_built_on_inverse_keeps_its_kernels(function: str) -> None:
    """One steering kernel for each module of a swerve drive, as in `inverse`; they were expanded in some."""
    derived = derivation("wpilib_swervebot", function)
    assert derived is not None
    kernels = [c.kernel.name for c in derived.formula(function).calls]
    assert kernels == [c.kernel.name for c in derived.formula("inverse").calls] and len(kernels) == 4


CASTORS_AND_COUPLINGS = [
    ("ackermann_car", "accelerations"), ("kelly_4ws", "accelerations"), ("nomad_xr4000", "accelerations"),
    ("synchro_drive", "accelerations"), ("jpl_osr", "stability"), ("nomad_xr4000", "stability"), ("pr2", "stability"),
    ("wpilib_swervebot", "inverse_together"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "function"),
    [
        *(
            pytest.param(n, f, marks=() if (n, f) in QUICK else pytest.mark.slow)
            for n in MADE
            for f in FUNCTIONS
        ),
        *CASTORS_AND_COUPLINGS,
    ],
)
def test_backends_agree(name: str, function: str) -> None:
    derived = derivation(name, function)
    if derived is None:
        return
    rng = np.random.default_rng(3)
    ports = derived.formula(function).inputs
    nominal = {p.name: float(p.default) for p in ports if p.default is not None}
    cases = [{p.name: round(float(rng.uniform(-1, 1)), 6) for p in ports} | nominal for _ in range(3)]
    exact = [
        {k: float(v) for k, v in evaluate_module(derived.raw_module, function, case, EXACT).items()}
        for case in cases
    ]
    f = derived.casadi()[function]
    in_casadi = [
        dict(zip(f.name_out(), f.call([case[n] for n in f.name_in()]), strict=True)) for case in cases
    ]
    in_c = BACKENDS["c99"].evaluate(derived.c_module, function, cases, {"scalar": "double"})
    for result in (in_casadi, in_c):
        for a, b in zip(exact, result, strict=True):
            assert a.keys() == b.keys()
            np.testing.assert_allclose([float(b[k]) for k in a], list(a.values()), rtol=TINY, atol=TINY)
