"""One odometry step is the exponential of a constant twist, smoothly through omega = 0."""

from __future__ import annotations

import cmath
import math
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy
from hypothesis import given
from hypothesis import strategies as st

from tests.laws.common import NAMES, gallery, law
from tests.laws.layouts import twists
from tests.oracle import oracle
from wmrgen.analysis.kinematics.pose import SWITCH, WORST_ERROR
from wmrgen.analysis.kinematics.records import Locals
from wmrgen.geometry.ports import output
from wmrgen.geometry.symbolic import signal
from wmrgen.ir.interpret import FLOAT64, evaluate
from wmrgen.ir.lower import lower
from wmrgen.ir.nodes import Port, Role

TURNS = [0.0, 1e-300, 1e-12, 1e-8, 1e-5, 1e-3, 0.02, 0.0999999, 0.1, 0.1000001, 0.5, 1.0, 3.14159, 7.0]


def turned(theta: float) -> float:
    """The heading in [-pi, pi]."""
    return math.remainder(theta, math.tau)


def exponential(pose: Any, twist: Any, dt: float) -> np.ndarray[Any, Any]:
    """The pose of the oracle, its heading in [-pi, pi]."""
    x, y, theta = oracle.step(np.array(pose, float), np.array(twist), dt)
    return np.array([x, y, turned(theta)])


def step(twist: Any, pose: Any = (0.0, 0.0, 0.0), dt: float = 1.0) -> np.ndarray[Any, Any]:
    model, _ = gallery("unicycle")
    names = ("x", "y", "theta", "vx", "vy", "omega", "dt")
    out = model.call("odometry", dict(zip(names, (*pose, *twist, dt), strict=True)))
    return np.array([out["x"], out["y"], out["theta"]])


@pytest.mark.parametrize("omega", [s * w for w in TURNS for s in (1, -1)])
def test_exponential_through_zero(omega: float) -> None:
    twist = np.array([0.8, -0.3, omega])
    np.testing.assert_allclose(step(twist), exponential(np.zeros(3), twist, 1.0), rtol=0, atol=1e-12)


@pytest.mark.parametrize("vector", [(2, 0), (0, 3), (2, 3), (0, 0)])
def test_vectors_are_turned(vector: tuple[int, int]) -> None:
    """Also those along an axis, of which formulas are shorter."""
    names = Locals()
    x, y = names.turned("v", (sympy.Integer(vector[0]), sympy.Integer(vector[1])), signal("theta"))
    ports = (output("x", "", ""), x), (output("y", "", ""), y)
    angle = Port("theta", Role.COMMAND, "rad", "an angle")
    turned = evaluate(lower(names.formula("turned", [angle], ports, "")), {"theta": 0.7}, FLOAT64)
    assert complex(turned["x"], turned["y"]) == pytest.approx(complex(*vector) * cmath.rect(1, 0.7))


@law(200)
@given(twists, twists, st.floats(-2, 2))
def test_exponential(pose: Any, twist: Any, dt: float) -> None:
    np.testing.assert_allclose(step(twist, pose, dt), exponential(pose, twist, dt), rtol=0, atol=1e-11)


@law(100)
@given(twists, st.integers(-400, 400))
def test_smooth(twist: Any, exponent: int) -> None:
    """Neighbouring turning rates give neighbouring poses on both sides of every switch point."""
    omega = 10.0 ** (exponent / 100 - 4)
    a, b = (step((twist[0], twist[1], omega * (1 + e))) for e in (0.0, 1e-9))
    np.testing.assert_allclose(a, b, rtol=0, atol=1e-8 * max(1.0, omega))


@law(100)
@given(twists, st.floats(0.01, 1.5))
def test_two_steps_are_one(twist: Any, dt: float) -> None:
    np.testing.assert_allclose(
        step(twist, step(twist, dt=dt), dt), step(twist, dt=2 * dt), rtol=0, atol=1e-11
    )
    np.testing.assert_allclose(step(twist, step(twist, dt=dt), -dt), np.zeros(3), rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", NAMES)
def test_every_robot_has_the_same_step(name: str) -> None:
    model, _ = gallery(name)
    case = {"x": 0.1, "y": -0.2, "theta": 0.3, "vx": 0.5, "vy": 0.4, "omega": 0.7, "dt": 0.25}
    found = model.call("odometry", case)
    wanted = oracle.step(np.array([0.1, -0.2, 0.3]), np.array([0.5, 0.4, 0.7]), 0.25)
    np.testing.assert_allclose([found[k] for k in ("x", "y", "theta")], wanted, rtol=0, atol=1e-14)
    assert math.isfinite(found["theta"])


def test_the_series_of_odometry_is_as_good_as_the_quotient() -> None:
    """The chord is sinc(h) to a few units in the last place, the series as far as it is used included."""
    assert float(SWITCH) ** 8 / math.factorial(9) <= 2.0**-53 and WORST_ERROR <= 2.0**-53
    model, _ = gallery("unicycle")
    for k in range(1, 400):
        h = Fraction(k, 2000)
        out = model.call("odometry", {"vx": 1.0, "omega": float(2 * h), "dt": 1.0})
        with mpmath.workdps(30):
            half = mpmath.mpf(float(2 * h)) / 2
            chord = mpmath.sin(half) / half
        assert math.hypot(out["x"], out["y"]) == pytest.approx(float(chord), rel=0, abs=3.4e-16), h
