"""The engine's expressions minus the formulas of the texts are identically zero (corrected forms)."""

from __future__ import annotations

from typing import Any

import pytest
import sympy
from sympy import Matrix, Rational, cos, pi, sin, sqrt

from tests.functions.motion.common import (
    DIFFERENTIAL,
    FOUR_WS,
    MECANUM_T,
    OMNI4_T,
    OMNI_K,
    OMNI_T,
    TRICYCLE,
    TWO_WHEELS,
    closed,
    derived,
    par,
    sym,
    vanishes,
)
from wmrgen.geometry.symbolic import signal

Expr = Any
PHI = signal("theta")
XD, YD, PD = sym("x_rate", "y_rate", "theta_rate")
W = sym("w1.spin", "w2.spin", "w3.spin", "w4.spin")
A, R = par("a", "r")
PHI_I = [PHI, PHI + 2 * pi / 3, PHI + 4 * pi / 3]


def in_robot(expr: Expr) -> Expr:
    """The robot-frame twist replaced by the world one: xi_R = R(theta) xi_I (Siegwart (3.2))."""
    vx, vy, omega = sym("vx", "vy", "omega")
    return expr.subs({vx: XD * cos(PHI) + YD * sin(PHI), vy: -XD * sin(PHI) + YD * cos(PHI), omega: PD})


def lam(i: int) -> Expr:
    return XD * sin(PHI_I[i]) - YD * cos(PHI_I[i]) - A * PD


def mu(i: int) -> Expr:
    return XD * cos(PHI_I[i]) + YD * sin(PHI_I[i])


@pytest.fixture(scope="module")
def projected() -> dict[str, Expr]:
    return {k: in_robot(v) for k, v in closed(OMNI_K, "projections").items()}


@pytest.mark.parametrize("i", range(3))
def test_konstantinov_2_contact_velocities(projected: dict[str, Expr], i: int) -> None:
    assert vanishes(projected[f"w{i + 1}.x_rate"] - (XD - A * PD * sin(PHI_I[i])))
    assert vanishes(projected[f"w{i + 1}.y_rate"] - (YD + A * PD * cos(PHI_I[i])))


@pytest.mark.parametrize("i", range(3))
def test_konstantinov_1_is_the_integral_of_2(i: int) -> None:
    """x_i = x + a cos phi_i: its rate is the contact velocity."""
    t = sympy.Symbol("t")
    x, y, phi = (sympy.Function(n)(t) for n in "xyp")
    place = [x + A * cos(phi + 2 * pi * i / 3), y + A * sin(phi + 2 * pi * i / 3)]
    rates = {x.diff(t): XD, y.diff(t): YD, phi.diff(t): PD}
    expected = [in_robot(closed(OMNI_K, "projections")[f"w{i + 1}.{n}"]) for n in ("x_rate", "y_rate")]
    for p, e in zip(place, expected, strict=True):
        assert vanishes(p.diff(t).subs(rates).subs(phi, PHI) - e)


@pytest.mark.parametrize("i", range(3))
def test_konstantinov_3_lambda_and_mu(projected: dict[str, Expr], i: int) -> None:
    assert vanishes(projected[f"w{i + 1}.along"] - lam(i))
    assert vanishes(projected[f"w{i + 1}.across"] - mu(i))


@pytest.mark.parametrize("i", range(3))
def test_konstantinov_v_i_squared(projected: dict[str, Expr], i: int) -> None:
    result = projected[f"w{i + 1}.x_rate"] ** 2 + projected[f"w{i + 1}.y_rate"] ** 2
    v2 = XD**2 + YD**2
    assert vanishes(result - (v2 + A**2 * PD**2 - 2 * A * PD * (XD * sin(PHI_I[i]) - YD * cos(PHI_I[i]))))


def test_konstantinov_sums(projected: dict[str, Expr]) -> None:
    """v1 + v2 + v3 = 3 v; the drive parts and the roller parts each sum to 3 v / 2; mu1 + mu2 + mu3 = 0."""
    v = Matrix([XD, YD])
    total = sum(
        (Matrix([projected[f"w{k}.x_rate"], projected[f"w{k}.y_rate"]]) for k in (1, 2, 3)), sympy.zeros(2, 1)
    )
    u = sum(
        (projected[f"w{i + 1}.along"] * Matrix([sin(p), -cos(p)]) for i, p in enumerate(PHI_I)),
        sympy.zeros(2, 1),
    )
    w = sum(
        (projected[f"w{i + 1}.across"] * Matrix([cos(p), sin(p)]) for i, p in enumerate(PHI_I)),
        sympy.zeros(2, 1),
    )
    for result, wanted in ((total, 3 * v), (u, v * Rational(3, 2)), (w, v * Rational(3, 2))):
        assert all(vanishes(e) for e in result - wanted)
    assert vanishes(sum(projected[f"w{k}.across"] for k in (1, 2, 3)))


@pytest.mark.parametrize("i", range(3))
def test_konstantinov_4_inverse(i: int) -> None:
    assert vanishes(closed(OMNI_K, "inverse_world")[f"w{i + 1}.spin"] - lam(i) / R)


def test_konstantinov_5_forward() -> None:
    result = closed(OMNI_K, "forward_world")
    assert vanishes(result["theta_rate"] + R / (3 * A) * sum(W[:3]))
    assert vanishes(
        result["x_rate"] - Rational(2, 3) * R * sum(w * sin(p) for w, p in zip(W, PHI_I, strict=False))
    )
    assert vanishes(
        result["y_rate"] + Rational(2, 3) * R * sum(w * cos(p) for w, p in zip(W, PHI_I, strict=False))
    )


def test_konstantinov_6_heading() -> None:
    psi = sym("w1.angle", "w2.angle", "w3.angle")
    assert vanishes(closed(OMNI_K, "heading")["theta"] - (PHI - R / (3 * A) * sum(psi)))


def test_konstantinov_speed_and_mu() -> None:
    """v**2 = (2/3)(mu1**2 + mu2**2 + mu3**2), mu1 = (r/sqrt3)(w2 - w3) (corrected)."""
    twist = closed(OMNI_K, "forward")
    seen = {signal(n): twist[n] for n in ("vx", "vy", "omega")}
    across = [closed(OMNI_K, "projections")[f"w{k}.across"].subs(seen) for k in (1, 2, 3)]
    for i, m in enumerate(across):
        assert vanishes(m - R / sqrt(3) * (W[(i + 1) % 3] - W[(i + 2) % 3]))
    assert vanishes(twist["vx"] ** 2 + twist["vy"] ** 2 - Rational(2, 3) * sum(m**2 for m in across))


def test_konstantinov_radius_corrected() -> None:
    """|v| = 2 r Omega1 / 3 and |omega| = r |Omega| / (3a), hence R = 2 a Omega1 / |Omega|."""
    speed = closed(OMNI_K, "circle")["speed"]
    omega1 = W[0] ** 2 + W[1] ** 2 + W[2] ** 2 - W[0] * W[1] - W[1] * W[2] - W[2] * W[0]
    assert vanishes(speed**2 - 4 * R**2 * omega1 / 9)
    assert vanishes(closed(OMNI_K, "forward")["omega"] ** 2 - (R * sum(W[:3]) / (3 * A)) ** 2)


RIGHT, LEFT = sym("right.spin", "left.spin")


def test_tzafestas_2_37d_and_2_41c() -> None:
    result = closed(DIFFERENTIAL, "forward_world")
    assert vanishes(result["x_rate"] - R / 2 * cos(PHI) * (RIGHT + LEFT))
    assert vanishes(result["y_rate"] - R / 2 * sin(PHI) * (RIGHT + LEFT))
    assert vanishes(result["theta_rate"] - R / (2 * A) * (RIGHT - LEFT))
    back = closed(DIFFERENTIAL, "inverse_world")
    assert vanishes(back["right.spin"] - (XD * cos(PHI) + YD * sin(PHI) + A * PD) / R)
    assert vanishes(back["left.spin"] - (XD * cos(PHI) + YD * sin(PHI) - A * PD) / R)


def test_tzafestas_2_36c_integrates() -> None:
    turned = sym("right.angle", "left.angle")
    assert vanishes(closed(DIFFERENTIAL, "heading")["theta"] - (PHI + R / (2 * A) * (turned[0] - turned[1])))


def test_tzafestas_2_43_radius() -> None:
    """R = v / omega = a (vr + vl) / (vr - vl); the curvature is omega / v."""
    twist = closed(DIFFERENTIAL, "forward")
    vr, vl = R * RIGHT, R * LEFT
    assert vanishes(twist["vx"] / twist["omega"] - A * (vr + vl) / (vr - vl))


def test_tzafestas_2_48_radius() -> None:
    """R = D tan(pi/2 - psi): the admissible motion of the tricycle turns about (0, R)."""
    (length,) = par("length")
    motion = derived(TRICYCLE).null_space
    psi = signal("front.steer")
    assert motion.shape == (3, 1)
    assert vanishes(motion[0] / motion[2] - length * cos(psi) / sin(psi))
    assert vanishes(motion[1])


def test_tzafestas_2_72_to_2_74() -> None:
    vx, vy, omega = sym("vx", "vy", "omega")
    (half,) = par("half")
    result = closed(OMNI_T, "inverse")
    for i, beta in enumerate((0, 2 * pi / 3, 4 * pi / 3)):
        assert vanishes(result[f"w{i + 1}.spin"] - (vx * cos(beta) + vy * sin(beta) + half * omega) / R)
    back, third = closed(OMNI_T, "forward"), Rational(1, 3)
    assert vanishes(back["vx"] - R * third * (2 * W[0] - W[1] - W[2]))
    assert vanishes(back["vy"] - R / sqrt(3) * (W[1] - W[2]))
    assert vanishes(back["omega"] - R / (3 * half) * sum(W[:3]))


def test_tzafestas_2_75_corrected() -> None:
    """J^-1 = (1/r) [U^T R^-1(phi) | D], u_i = (-sin b_i, cos b_i)."""
    half, b1, b2, b3 = par("half", "b1", "b2", "b3")
    result = closed(OMNI4_T, "inverse_world")
    body = Matrix([[cos(PHI), sin(PHI)], [-sin(PHI), cos(PHI)]]) * Matrix([XD, YD])
    for i, b in enumerate((b1, b2, b3, sympy.S.Zero)):
        along = (Matrix([[-sin(b), cos(b)]]) * body)[0]
        assert vanishes(result[f"w{i + 1}.spin"] - (along + half * PD) / R)


def test_tzafestas_2_82_to_2_85() -> None:
    d1, d2 = par("d1", "d2")
    vx, vy, omega = sym("vx", "vy", "omega")
    s = d1 + d2
    inverse = Matrix([[-1, 1, s], [1, 1, -s], [-1, 1, -s], [1, 1, s]]) / R
    forward = R / 4 * Matrix([[-1, 1, -1, 1], [1, 1, 1, 1], [1 / s, -1 / s, -1 / s, 1 / s]])
    turn = Matrix([[cos(PHI), -sin(PHI), 0], [sin(PHI), cos(PHI), 0], [0, 0, 1]])
    result = closed(MECANUM_T, "inverse")
    world = closed(MECANUM_T, "inverse_world")
    in_body, in_world = inverse * Matrix([vx, vy, omega]), inverse * turn.T * Matrix([XD, YD, PD])
    for i in range(4):
        assert vanishes(result[f"w{i + 1}.spin"] - in_body[i])
        assert vanishes(world[f"w{i + 1}.spin"] - in_world[i])
    wanted = forward * Matrix(W)
    for name, e in zip(("vx", "vy", "omega"), wanted, strict=True):
        assert vanishes(closed(MECANUM_T, "forward")[name] - e)
    for name, e in zip(("x_rate", "y_rate", "theta_rate"), turn * wanted, strict=True):
        assert vanishes(closed(MECANUM_T, "forward_world")[name] - e)


def test_tzafestas_2_84_compatibility() -> None:
    """theta1 + theta2 = theta3 + theta4, in the wheel order of the text."""
    assert derived(MECANUM_T).compatibility == Matrix([[1, 1, -1, -1]])
    assert vanishes(closed(MECANUM_T, "compatibility")["residual1"] - (W[0] + W[1] - W[2] - W[3]))


def test_kelly_4_62_stacks() -> None:
    """Rows [1, 0, -(y + b)], [0, 1, x + a]; Q = (-b, a), (a, b) = d (-s, c) on the left, d (s, -c) on the right."""
    length, width, offset = par("length", "width", "offset")
    d = derived(FOUR_WS)
    for i, (fore, side) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        g = signal(f"w{i + 1}.steer")
        a, b = -side * offset * sin(g), side * offset * cos(g)
        H = Matrix([[1, 0, -(side * width + b)], [0, 1, fore * length + a]])
        assert all(vanishes(e) for e in d.H[2 * i : 2 * i + 2, :] - H)
        Q = sympy.zeros(2, 4)
        Q[0, i], Q[1, i] = -b, a
        assert all(vanishes(e) for e in d.Q[2 * i : 2 * i + 2, :] - Q)


def test_kelly_4_62_velocities_are_h_xi_plus_q_rate() -> None:
    d = derived(FOUR_WS)
    rates = Matrix(sym(*(f"w{k}.steer_rate" for k in range(1, 5))))
    stack = d.H * Matrix(sym("vx", "vy", "omega")) + d.Q * rates
    result = closed(FOUR_WS, "contact_velocity")
    for i in range(4):
        assert vanishes(result[f"w{i + 1}.vx"] - stack[2 * i])
        assert vanishes(result[f"w{i + 1}.vy"] - stack[2 * i + 1])


def test_kelly_box_4_2_gram() -> None:
    """det(H^T H) = 2 |p1 - p2|**2, and forward is the least squares solution for two wheels."""
    x1, y1, x2, y2 = par("ax", "ay", "bx", "by")
    H = derived(TWO_WHEELS).H
    assert Matrix([[1, 0, -y1], [0, 1, x1], [1, 0, -y2], [0, 1, x2]]) == H
    assert vanishes((H.T * H).det() - 2 * ((x1 - x2) ** 2 + (y1 - y2) ** 2))
    assert sympy.zeros(4, 2) == derived(TWO_WHEELS).Q
    r = Rational(1, 10)
    velocity = []
    for k in (1, 2):
        spin, steer = sym(f"w{k}.spin", f"w{k}.steer")
        velocity += [r * spin * cos(steer), r * spin * sin(steer)]
    wanted = (H.T * H).inv() * H.T * Matrix(velocity)
    result = closed(TWO_WHEELS, "forward")
    at = {x1: Rational(9, 10), y1: Rational(1, 5), x2: Rational(-7, 10), y2: Rational(-1, 10)}
    for name, e in zip(("vx", "vy", "omega"), wanted, strict=True):
        assert vanishes((result[name] - e).subs(at))
