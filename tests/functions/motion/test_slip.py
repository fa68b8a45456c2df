"""Slip variables at any steering angle (Tzafestas Ex. 2.2, corrected for steered wheels)."""

from __future__ import annotations

import pytest
import sympy

from tests.functions.models.robots import CAR_REAR, DIFFERENTIAL, OMNI, derived, evaluated, p, s, zero
from wmrgen import derive

VX, VY, W = s("vx"), s("vy"), s("omega")
SLIP = "slip: true"


def test_tzafestas_example_2_2_inverse() -> None:
    """r theta_r,l = vx +- a omega + w; z = vy + b omega."""
    found = derived(DIFFERENTIAL, SLIP, b="0.13").formula("slip_inverse").closed()
    r, a, b = sympy.Rational(11, 100), sympy.Rational(27, 100), sympy.Rational(13, 100)
    for name, sign in (("right", 1), ("left", -1)):
        assert zero(r * found[f"{name}.spin"] - (VX + sign * a * W + s(f"{name}.slip_x")))
        assert zero(found[f"{name}.slip_y"] - (VY + b * W))


def test_tzafestas_example_2_2_pfaffian() -> None:
    """M = [[-s, c, b, 0, 0, -1, 0], [-s, c, b, 0, 0, 0, -1]] on (x', y', theta', w, z)."""
    d = derived(DIFFERENTIAL, SLIP, b="0.13")
    assert d.pfaffian_rates == (
        "vx", "vy", "omega", "right.spin", "left.spin",
        "right.slip_x", "left.slip_x", "right.slip_y", "left.slip_y",
    )  # fmt: skip
    a, b, r = p("a"), p("b"), p("r")
    expected = [
        [1, 0, a, -r, 0, 1, 0, 0, 0],
        [1, 0, -a, 0, -r, 0, 1, 0, 0],
        [0, 1, b, 0, 0, 0, 0, -1, 0],
        [0, 1, b, 0, 0, 0, 0, 0, -1],
    ]
    assert (d.pfaffian - sympy.Matrix(expected)).applyfunc(evaluated).is_zero_matrix


@pytest.mark.parametrize(("wheels", "direction"), [(DIFFERENTIAL, "longitudinal"), (OMNI, "roller axis")])
def test_what_slips_is_said(wheels: str, direction: str) -> None:
    inputs = derived(wheels, SLIP).formula("slip_inverse").inputs
    told = [port.text for port in inputs if port.name.endswith("slip_x")]
    assert told and all(direction in text and "slip" in text for text in told)


def test_steered_wheel_at_any_angle() -> None:
    """(r spin - w) e + z n is the contact's velocity: the corrected pair for zeta != 0."""
    found = derived(CAR_REAR, SLIP).formula("slip_inverse").closed()
    zeta, w = s("front.steer"), s("front.slip_x")
    base, r = sympy.Rational(7, 5), sympy.Rational(11, 100)
    along, across = r * found["front.spin"] - w, found["front.slip_y"]
    assert zero(along * sympy.cos(zeta) - across * sympy.sin(zeta) - VX)
    assert zero(along * sympy.sin(zeta) + across * sympy.cos(zeta) - (VY + base * W))


def test_castor_and_offset_wheels_take_their_steering_rate() -> None:
    wheels = "{name: c, type: castor, x: base, y: a, heading: 0, d: h, offset_y: b, r: r}"
    found = derived(wheels, SLIP, b="0.05").formula("slip_inverse").closed()
    beta, rate = s("c.steer"), s("c.steer_rate")
    base, a, d, o, r = (sympy.Rational(k) for k in ("7/5", "27/100", "1/5", "1/20", "11/100"))
    c, n = sympy.cos(beta), sympy.sin(beta)
    x, y = base + d * c - o * n, a + d * n + o * c
    contact = VX - W * y - rate * (y - a), VY + W * x + rate * (x - base)
    assert zero(r * found["c.spin"] - s("c.slip_x") - (contact[0] * c + contact[1] * n))
    assert zero(found["c.slip_y"] - (-contact[0] * n + contact[1] * c))


def test_slip_true_generates_the_function() -> None:
    d = derived(DIFFERENTIAL, SLIP, b="0.13")
    assert "slip_inverse" in [f.name for f in d.program.formulas]
    assert "slip_inverse" in [f.name for f in d.c_module.functions]
    model = d.model()
    assert model["pfaffian_rates"] == list(d.pfaffian_rates)
    assert len(model["pfaffian"]) == 4 and {len(row) for row in model["pfaffian"]} == {9}
    plain = derive(derived(DIFFERENTIAL, b="0.13").robot)
    assert "pfaffian" not in plain.model() and "slip_inverse" not in [f.name for f in plain.program.formulas]


@pytest.mark.parametrize("wrong", [VX, sympy.sin(VX) ** 2 + sympy.cos(VX) ** 2, sympy.tan(VX) - VX])
def test_zero_is_not_said_of_everything(wrong: sympy.Expr) -> None:
    assert not zero(wrong)
