"""Posture models equation by equation: the engine's expression minus that of the text simplifies to 0."""

from __future__ import annotations

import pytest
import sympy

from tests.functions.models.robots import (
    CAR_FRONT,
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_FRONT,
    FOUR_REAR,
    OMNI,
    TRICYCLE,
    TWO_STEER,
    UNICYCLE,
    VIRTUAL_FRONT,
    VIRTUAL_REAR,
    derived,
    p,
    s,
    same,
    zero,
)
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.inputs import posture_motion

THETA, PSI, FRONT = s("theta"), s("psi.steer"), s("front.steer")
C, S = sympy.cos(THETA), sympy.sin(THETA)
A, B, D, R = p("a"), p("b"), p("base"), p("r")


def G(d: Derivation, name: str = "posture") -> sympy.Matrix:
    return d.system(name, symbolic=True).G


def states(d: Derivation, name: str = "posture") -> list[str]:
    return [port.name for port in d.system(name).state]


def inputs(d: Derivation, name: str = "posture") -> list[str]:
    return [port.name for port in d.system(name).inputs]


def pfaffian_in_world(d: Derivation, kind: str) -> sympy.Matrix:
    """Rows of C1f or C1s on (x', y', theta')."""
    turn = sympy.Matrix([[C, S, 0], [-S, C, 0], [0, 0, 1]])
    return getattr(d, kind) * turn


def test_tzafestas_2_26_to_2_32_siegwart_3_48_unicycle() -> None:
    d = derived(UNICYCLE)
    assert states(d, "eta") == ["x", "y", "theta"] and inputs(d, "eta") == ["eta1", "eta2"]
    same(G(d, "eta"), [[C, 0], [S, 0], [0, 1]])  # (2.28c), (2.32)
    same(pfaffian_in_world(d, "C1f"), [[-S, C, 0]])  # (2.27)
    v, omega = s("eta1"), s("eta2")
    same([d.system("eta").rates], [[v * C, v * S, omega]])  # Siegwart (3.48)


def test_tzafestas_2_36_to_2_38_differential_drive() -> None:
    d = derived(DIFFERENTIAL, b="0")
    assert inputs(d) == ["right.spin", "left.spin"]
    r, a = R, A
    expected = [[r * C / 2, r * C / 2], [r * S / 2, r * S / 2], [r / (2 * a), -r / (2 * a)]]  # (2.37d)
    same(G(d).subs(B, 0), expected)
    same(pfaffian_in_world(d, "C1f").subs(B, 0) * G(d).subs(B, 0), sympy.zeros(2, 2))  # (2.39), (2.42)
    assert d.system("posture").domain == ()
    assert d.system("posture").G.free_symbols == {THETA}  # no parameter is tunable


def test_tzafestas_example_2_2_reference_behind_the_axle() -> None:
    """xG' = xQ' + b theta' sin(theta), yG' = yQ' - b theta' cos(theta)."""
    d = derived(DIFFERENTIAL, b="0.13")
    v, omega = R / 2, R / (2 * A)
    expected = [
        [v * C + B * omega * S, v * C - B * omega * S],
        [v * S - B * omega * C, v * S + B * omega * C],
        [omega, -omega],
    ]
    same(G(d), expected)


def test_tzafestas_2_46_and_aa274_tricycle() -> None:
    """AA274 has (cos xi cos theta, cos xi sin theta, sin xi / L) u1, u1 the speed of the front wheel and L = 1."""
    d = derived(TRICYCLE)
    assert states(d) == ["x", "y", "theta", "front.steer"] and inputs(d) == ["front.spin", "front.steer_rate"]
    c, n = sympy.cos(FRONT), sympy.sin(FRONT)
    same(G(d), [[R * c * C, 0], [R * c * S, 0], [R * n / D, 0], [0, 1]])
    assert d.system("posture").domain == ()


def test_tzafestas_2_47_tricycle_inverse() -> None:
    """psi = atan2(D omega, v), rim speed sqrt(v**2 + (D omega)**2): back through the posture model."""
    d = derived(TRICYCLE)
    v, omega = sympy.symbols("v omega", positive=True)
    rim = sympy.sqrt(v**2 + (D * omega) ** 2)
    twist = G(d)[:3, 0].subs(FRONT, sympy.atan2(D * omega, v)) * rim / R
    d_positive = sympy.Symbol("D", positive=True)
    same(twist.subs(THETA, 0).subs(D, d_positive), [[v], [0], [omega]])


@pytest.mark.parametrize(
    "wheels, extra", [(CAR_REAR, ""), (FOUR_REAR, VIRTUAL_REAR)], ids=["bicycle", "four"]
)
def test_tzafestas_2_52_to_2_55_rear_driven_car(wheels: str, extra: str) -> None:
    d = derived(wheels, extra)
    psi, scale = (FRONT, R) if not extra else (PSI, 1)
    same(G(d) / scale, sympy.Matrix([[C, 0], [S, 0], [sympy.tan(psi) / D, 0], [0, sympy.Integer(1) / scale]]))
    (domain,) = d.system("posture").domain
    assert zero(domain.expression - sympy.cos(psi))


@pytest.mark.parametrize(
    "wheels, extra", [(CAR_FRONT, ""), (FOUR_FRONT, VIRTUAL_FRONT)], ids=["bicycle", "four"]
)
def test_tzafestas_2_56a_front_driven_car(wheels: str, extra: str) -> None:
    d = derived(wheels, extra)
    psi, scale = (FRONT, R) if not extra else (PSI, 1)
    c, n = sympy.cos(psi), sympy.sin(psi)
    same(G(d)[:3, 0] / scale, [c * C, c * S, n / D])
    assert d.system("posture").domain == ()


@pytest.mark.parametrize("wheels", [CAR_REAR, CAR_FRONT])
def test_tzafestas_2_50_2_51b_constraints(wheels: str) -> None:
    d = derived(wheels)
    phi, psi = THETA, FRONT
    rows = sympy.Matrix.vstack(pfaffian_in_world(d, "C1f"), pfaffian_in_world(d, "C1s"))
    same(rows, [[-S, C, 0], [-sympy.sin(phi + psi), sympy.cos(phi + psi), D * sympy.cos(psi)]])
    same(rows * G(d)[:3, :], sympy.zeros(2, 2))


@pytest.mark.parametrize(
    "wheels, extra, psi",
    [(CAR_REAR, "", 0), (CAR_FRONT, "", 0), (TRICYCLE, "", 0), (FOUR_REAR, VIRTUAL_REAR, 1)],
)
def test_tzafestas_2_56b_zeta_form(wheels: str, extra: str, psi: int) -> None:
    d = derived(wheels, extra)
    zeta, phi, v1 = s("zeta"), THETA, s("v1")
    turn = sympy.sin(zeta - phi) / D
    same(G(d, "zeta"), [[sympy.cos(zeta), 0], [sympy.sin(zeta), 0], [turn, 0], [turn, 1]])
    assert d.system("zeta").domain == ()
    u2 = d.formula("zeta").closed()["u2"]
    assert zero(u2.subs(p("base"), D) - (sympy.sin(zeta - phi) * v1 / sympy.Rational(7, 5) + s("v2")))


def test_tzafestas_2_74_three_omni_wheels() -> None:
    d = derived(OMNI)
    root = sympy.sqrt(3)
    body = R * sympy.Matrix([[2, -1, -1], [0, root, -root], [1 / A, 1 / A, 1 / A]]) / 3
    turn = sympy.Matrix([[C, -S, 0], [S, C, 0], [0, 0, 1]])
    same(G(d), turn * body)


def test_two_steer_robot_has_two_steering_coordinates() -> None:
    d = derived(TWO_STEER)
    assert inputs(d) == ["front.spin", "front.steer_rate", "rear.steer_rate"]
    f, r = FRONT, s("rear.steer")
    assert zero(G(d)[2, 0] - R * sympy.sin(f - r) / (2 * D * sympy.cos(r)))
    (domain,) = d.system("posture").domain
    assert zero(domain.expression - sympy.cos(r))


def test_driven_wheels_beyond_need_are_named() -> None:
    d = derived(FOUR_REAR, "virtual: [{name: psi, steers: [front_left, front_right]}]")
    system = d.system("posture", symbolic=True)
    assert [u.name for u in system.inputs] == ["rear_left.spin", "psi.steer_rate"]
    assert inputs(d, "eta") == ["eta1", "front_left.steer_rate"]  # as dynamics has it
    assert posture_motion(d.robot, d.mobility).followers == ("rear_right.spin",)
    assert "rear_right.spin" in system.text
    t = sympy.tan(PSI)
    # rear_left stands at y = a: r spin = (1 - a tan(psi)/D) v.
    assert zero(system.G[2, 0] - R * t / D / (1 - A * t / D))
    (domain,) = system.domain
    assert zero(domain.expression**2 - (D * sympy.cos(PSI) - A * sympy.sin(PSI)) ** 2)


def test_fields_by_input() -> None:
    system = derived(CAR_REAR).system("posture", symbolic=True)
    assert [port.name for port in system.inputs] == ["rear.spin", "front.steer_rate"]
    assert list(system.G[:, 0]) == list(system.fields[0])


def test_a_turn_about_the_pivot_of_the_driven_wheel() -> None:
    """The only motion there is: the wheel holds its angle and rolls beside its pivot, r spin = -o omega."""
    d = of_text("""
wmrgen: 1
name: pivots
wheels:
  - {name: a, type: fixed, x: -0.25, y: 0.2, r: 0.07, heading: pi}
  - {name: b, type: steered, x: 0.3, y: 0.45, r: 0.1, heading: 0, actuated: []}
  - {name: c, type: steered, x: -0.25, y: 0.2, r: 0.07, heading: pi/3, offset_y: 0.03}
couplings: [{equal: [b.steer, c.steer]}]
""")
    turn = sympy.Rational(-7, 3)
    assert G(d).subs(THETA, 0) == turn * sympy.Matrix([sympy.Rational(1, 5), sympy.Rational(1, 4), 1])
