"""Laws of the library: every backend, every input, and what the functions say about each other."""

from __future__ import annotations

import math
from fractions import Fraction

import casadi
import numpy as np
import pytest
import sympy

from tests.functions.control import polar
from textbook import FUNCTIONS, formula, textbook
from textbook.emit import artifacts
from textbook.tests.common import call, integrate, matrix, one, spread, vector
from wmrgen.codegen.registry import BACKENDS
from wmrgen.functions.control.gains import judge
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import EXACT, evaluate_module

NAMES = sorted(FUNCTIONS)
BOOK = textbook()


def points(name: str, count: int, scale: float = 2.0) -> list[dict[str, float]]:
    rng = np.random.default_rng(list(name.encode()))
    return [
        {p.name: float(v) for p, v in zip(formula(name).inputs, row, strict=True)}
        for row in rng.uniform(-scale, scale, (count, len(formula(name).inputs)))
    ]


@pytest.mark.parametrize("name", NAMES)
def test_backends_agree(name: str) -> None:
    cases = points(name, 4)
    exact = [
        {k: float(v) for k, v in evaluate_module(BOOK.raw_module, name, case, EXACT).items()}
        for case in cases
    ]
    for backend in ("casadi", "numpy"):
        found = BACKENDS[backend].load().evaluate(BOOK.module, [(name, case) for case in cases])
        for ours, theirs in zip(found, exact, strict=True):
            assert ours == pytest.approx(theirs, rel=1e-9, abs=1e-9)


@pytest.mark.slow
def test_c_agrees_in_float() -> None:
    """All functions in one compiled library; inputs of moderate size, results to a few float roundings."""
    from wmrgen.codegen.c.driver import evaluate_c

    names = ("polar_rates", "two_step_acceleration", "castor_swivel", "mecanum_wheel_inverse", "inverse_3x4")
    requests = [(name, case) for name in names for case in points(name, 1)]
    for (name, case), found in zip(requests, evaluate_c(BOOK.c_module, requests), strict=True):
        theirs = {k: float(v) for k, v in evaluate_module(BOOK.raw_module, name, case, EXACT).items()}
        assert found == pytest.approx(theirs, rel=2e-4, abs=1e-4), name


@pytest.mark.parametrize("name", NAMES)
def test_defined_everywhere(name: str) -> None:
    """Zero, huge and tiny inputs give numbers, and so do the derivatives."""
    ports = [p.name for p in formula(name).inputs]
    cases = [dict.fromkeys(ports, v) for v in (0.0, 1e9, -1e9, 1e-200, math.pi / 2)]
    cases += [{p: float(k == i) for i, p in enumerate(ports)} for k in range(min(len(ports), 6))]
    found = BACKENDS["casadi"].load().evaluate(BOOK.module, [(name, case) for case in cases])
    assert all(math.isfinite(v) for result in found for v in result.values())
    f = textbook(name).casadi()[name]
    jacobian = _jacobian(f)
    for case in cases:
        if max(map(abs, case.values())) < 1e3:
            values = jacobian(casadi.DM(list(case.values())))
            assert np.isfinite(np.array(values)).all(), case


def _jacobian(f: casadi.Function) -> casadi.Function:
    x = casadi.SX.sym("x", f.n_in())
    y = casadi.vertcat(*f.call([x[k] for k in range(f.n_in())]))
    return casadi.Function("j", [x], [casadi.jacobian(y, x)])


def test_every_function_says_what_it_reproduces() -> None:
    for name in NAMES:
        text = formula(name).text
        assert any(seed in text for seed in ("Tzafestas", "Siegwart", "Kelly", "AA274")), name
        ports = formula(name).inputs
        assert all(p.text for p in ports), name


def test_generated_files() -> None:
    files = artifacts()
    assert {"functions.json", "report.md", "textbook.c", "textbook.h", "textbook.py"} <= files.keys()
    assert {f"textbook_{name}.casadi" for name in NAMES} <= files.keys()
    report = files["report.md"].decode()
    assert r"\operatorname" not in report
    assert all(f"### `{name}`" in report for name in NAMES)


# ---- what the functions say about each other


@pytest.mark.parametrize("size", [(3, 2), (4, 2), (4, 3), (2, 3), (2, 4), (3, 4), (2, 2), (3, 3)])
def test_tzafestas_2_8_against_lapack(size: tuple[int, int]) -> None:
    m, n = size
    rng = np.random.default_rng(m * 10 + n)
    for _ in range(3):
        J = rng.uniform(-2, 2, size)
        found = matrix(call("numpy", f"inverse_{m}x{n}", j=J), "p")
        np.testing.assert_allclose(found, np.linalg.pinv(J), rtol=1e-8, atol=1e-10)


def test_rank_deficient_matrices_give_zero() -> None:
    found = call("exact", "inverse_3x2", j=[[1, 2], [2, 4], [3, 6]])
    assert set(found.values()) == {0.0}


def test_tzafestas_2_14_inverts_2_11() -> None:
    R = np.array(matrix(call("exact", "rotation_x", angle=0.4), "m")) @ np.array(
        matrix(call("exact", "rotation_y", angle=-1.1), "m")
    )
    p, b = [0.3, -0.2, 0.7], [1.0, 2.0, -0.5]
    there = call("numpy", "transform_apply", r=R, p=p, b=b)
    back = call("numpy", "transform_inverse", r=R, p=p)
    here = call("numpy", "transform_apply", r=matrix(back, "r"), p=vector(back, "p"), b=list(there.values()))
    assert list(here.values()) == pytest.approx(b)
    both = call("numpy", "transform_compose", a=R, pa=p, b=matrix(back, "r"), pb=vector(back, "p"))
    np.testing.assert_allclose(matrix(both, "r"), np.eye(3), atol=1e-12)
    np.testing.assert_allclose(vector(both, "p"), np.zeros(3), atol=1e-12)


def test_pose_inverse_inverts_pose_compose() -> None:
    a = {"x": 0.3, "y": -1.2, "theta": 2.5}
    inverse = call("exact", "pose_inverse", **{f"a__{k}": v for k, v in a.items()})
    first = {f"a__{k}": v for k, v in a.items()}
    found = call("exact", "pose_compose", **first, **{f"b__{k}": v for k, v in inverse.items()})
    assert found == pytest.approx({"x": 0, "y": 0, "theta": 0}, abs=1e-12)


@pytest.mark.parametrize("d", [0.09, -0.09])
@pytest.mark.parametrize("velocity", [(0.8, 0.0), (-0.3, 0.5)])
def test_siegwart_3_18_castor_against_integration(d: float, velocity: tuple[float, float]) -> None:
    vx, vy = velocity
    alpha, beta, t, steps = 0.4, 1.9, 0.35, 4000

    def rate(b: np.ndarray) -> np.ndarray:  # cos(alpha+beta) vx + sin(alpha+beta) vy + d beta' = 0
        return -(np.cos(alpha + b) * vx + np.sin(alpha + b) * vy) / d

    end = float(integrate(rate, beta, t, steps))
    found = call("numpy", "castor_swivel", beta=beta, alpha=alpha, d=d, vx=vx, vy=vy, t=t)
    assert found["beta"] == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize("d", [0.09, -0.09])
def test_a_castor_ends_at_its_stable_angle(d: float) -> None:
    far = call("numpy", "castor_swivel", beta=0.3, alpha=0.2, d=d, vx=-0.4, vy=0.9, t=9.0)
    rest = call("numpy", "castor_alignment", alpha=0.2, d=d, r=0.12, vx=-0.4, vy=0.9)
    assert math.cos(far["beta"] - rest["beta_stable"]) == pytest.approx(1)
    assert math.cos(rest["beta_unstable"] - rest["beta_stable"]) == pytest.approx(-1)
    assert rest["spin"] == pytest.approx(-math.copysign(math.hypot(0.4, 0.9) / 0.12, d))


def test_kelly_recursion_is_the_matrices() -> None:
    """(4.23) by H and the centripetal and Coriolis terms by Omega."""
    r, v, omega = [0.5, 0.2, -0.1], [0.1, -0.3, 0.2], [0.2, -0.1, 0.9]
    H = np.array(matrix(call("exact", "h_matrix", r=r), "h"))
    one_step = call("exact", "moving_frame_velocity", v_m=v, omega=omega, r=r, v_o=[0, 0, 0])
    np.testing.assert_allclose(H @ np.array(v + omega), vector(one_step, "v"), atol=1e-12)
    zero = [0.0, 0.0, 0.0]
    terms = call(
        "exact", "moving_frame_acceleration", a_m=zero, alpha=zero, omega=omega, r=r, v_o=v, a_o=zero
    )
    blocks = np.array(matrix(call("exact", "omega_matrix", omega=omega), "o"))
    np.testing.assert_allclose(blocks @ np.array(r + v), vector(terms, "a"), atol=1e-12)
    S = np.array(matrix(call("exact", "skew_matrix", u=omega), "m"))
    np.testing.assert_allclose(S @ r, np.cross(omega, r), atol=1e-12)


def test_siegwart_3_53_is_the_unicycle_in_polar_coordinates() -> None:
    """Finite differences of the coordinates along the motion."""
    pose, v, omega, h = (0.6, -0.9, 0.7), 0.75, -0.4, 1e-6

    def polar(x: float, y: float, theta: float) -> np.ndarray:
        return np.array(list(call("numpy", "polar_coordinates", x=x, y=y, theta=theta).values()))

    for name, sign in (("polar_rates", 1.0), ("polar_rates_reverse", -1.0)):
        state = polar(*pose)
        moved = [pose[0] + h * sign * v * math.cos(pose[2]), pose[1] + h * sign * v * math.sin(pose[2])]
        difference = (polar(*moved, pose[2] + h * omega) - state) / h
        rho, alpha, beta = state
        found = call("numpy", name, rho=rho, alpha=alpha, beta=beta, v=v, omega=omega)
        np.testing.assert_allclose(list(found.values()), difference, atol=1e-5)


def test_at_the_goal_the_polar_rates_are_finite() -> None:
    found = call("exact", "polar_rates", rho=0.0, alpha=0.3, beta=0.1, v=0.0, omega=0.5)
    assert list(found.values()) == [0.0, -0.5, 0.0]


def test_curvature_of_pursuit_is_that_of_its_steering() -> None:
    steer = call("exact", "pursuit", wheelbase=1.4, distance=3.0, epsilon=-0.8)
    turn = call("exact", "turning_radius", wheelbase=1.4, psi=steer["psi"])
    assert steer["curvature"] == pytest.approx(turn["curvature"])
    straight = call("exact", "pursuit", wheelbase=1.4, distance=3.0, epsilon=0.0)
    assert (straight["psi"], straight["curvature"], straight["arc"]) == (0.0, 0.0, 3.0)


def test_bounds_of_a_car_are_inside_the_exact_set() -> None:
    for v in np.linspace(-2, 2, 9):
        found = call("numpy", "car_bounds", u1_max=1.7, zeta_max=0.6, v=float(v), wheelbase=1.0)
        if abs(v) <= found["v_max"]:
            assert found["omega_max"] <= found["omega_max_exact"] + 1e-12
            assert v**2 + found["omega_max"] ** 2 <= 1.7**2 + 1e-12


def test_the_omni_roller_is_as_wide_as_nothing() -> None:
    found = call("exact", "mecanum_roller", radius=0.15, count=6, angle=math.pi / 2)
    assert found["length"] == pytest.approx(0.15) and found["width"] == pytest.approx(0, abs=1e-15)


def test_names_of_one_function() -> None:
    assert one("rotate").raw_module.functions[0].name == "rotate"
    assert spread({"v": (1, 2, 3)}) == {"v.x": 1.0, "v.y": 2.0, "v.z": 3.0}
    with pytest.raises(KeyError):
        assert textbook("rotat").formulas


@pytest.mark.slow
def test_the_linearised_loop_is_the_derived_one() -> None:
    """`polar_linearisation` against the Jacobian of the closed loop, and its polynomial against det(s I - A)."""
    outputs = {p.name: v for p, v in formula("polar_linearisation").outputs}
    A = sympy.Matrix(3, 3, [outputs[f"a{i}{j}"] for i in (1, 2, 3) for j in (1, 2, 3)])
    assert sympy.expand(A - polar.linearisation()) == sympy.zeros(3)
    s = sympy.Symbol("s")
    p = s**3 + outputs["p2"] * s**2 + outputs["p1"] * s + outputs["p0"]
    assert sympy.expand(p - polar.characteristic_polynomial(s)) == 0


@pytest.mark.parametrize("backend", ["exact", "casadi", "c"])
def test_gains_are_judged_as_the_command_does(backend: str) -> None:
    for gains in ((3, 8, -1.5), (3, 2, -1.5), (3, 8, 1.5), (-1, 8, -1.5), (0.5, 10.5, -6.0), (3, 2.9, -0.01)):
        verdict = judge(*(Exact(Fraction(g)) for g in gains))
        found = call(backend, "polar_gains", **dict(zip(("k_rho", "k_alpha", "k_beta"), gains, strict=True)))
        assert [found[k] > 0 for k in ("stable", "strong_3_65", "strong_all_beta")] == [
            verdict.stable, verdict.strong, verdict.strong_all_beta,
        ]  # fmt: skip
