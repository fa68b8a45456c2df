"""The tractor of a train: its axle is where nothing slides, however the layout gives it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.functions.models.robots import CAR_REAR, DIFFERENTIAL, TRICYCLE, UNICYCLE, derived, on_axle, s
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.models.axle import Axle
from wmrgen.functions.trailers.train import train
from wmrgen.geometry.exact.poly import Poly
from wmrgen.geometry.symbolic import expression

PLACES = [("0", "0"), ("0.3", "-0.2"), ("-0.1", "0.4")]


def two_fixed(x: str, y: str, turn: str) -> Derivation:
    """Two fixed wheels on one axle about (x, y), the second one half a turn about."""
    return derived(
        f"{{name: one, type: fixed, x: {x} - 0.3*sin({turn}), y: {y} + 0.3*cos({turn}), heading: {turn}, r: 0.1}}\n"
        f"{{name: two, type: fixed, x: {x} + 0.3*sin({turn}), y: {y} - 0.3*cos({turn}), heading: {turn} + pi, r: 0.1}}"
    )


def two_omni(x: str, y: str, turn: str) -> Derivation:
    """Three omni wheels about (x, y), of which a belt joins two of unlike size: a row that no wheel gives alone."""
    wheels = "\n".join(
        f"{{name: w{k}, type: swedish, x: {x} + 0.25*cos({a}), y: {y} + 0.25*sin({a}), heading: {a} + pi/2, gamma: 0, "
        f"r: {r}}}"
        for k, (a, r) in enumerate(((f"{turn}", 0.1), (f"{turn} + 2*pi/3", 0.2), (f"{turn} - 2*pi/3", 0.15)))
    )
    return derived(wheels, "couplings: [{equal: [w0.spin, w1.spin]}]")


def numbers(axle: Axle) -> list[float]:
    return [_number(p) for p in (axle.ex, axle.ey, axle.x, axle.y)]


def _number(p: Poly) -> float:
    return float(expression(p))


@pytest.mark.parametrize("robot", [two_fixed, two_omni])
@pytest.mark.parametrize(("x", "y"), PLACES)
@pytest.mark.parametrize("turn", ["0", "pi/6", "pi/2", "2*pi/3", "pi", "-3*pi/4", "-pi/2", "-pi/6"])
def test_the_axle_moves_along_its_direction_of_travel(robot: object, x: str, y: str, turn: str) -> None:
    """Under every motion of the robot; e is a unit vector that points forward, or left where it has no such part."""
    assert callable(robot)
    d = robot(x, y, turn)
    assert d.mobility.robot_type == (2, 0)
    axle = train(d.robot, d.mobility).axle
    ex, ey, qx, qy = numbers(axle)
    assert math.hypot(ex, ey) == pytest.approx(1)
    assert (ex if abs(ex) > 1e-12 else ey) > 0
    for vx, vy, omega in np.array(d.null_space.T.tolist(), float):
        across = -ey * (vx - omega * qy) + ex * (vy + omega * qx)
        assert across == pytest.approx(0, abs=1e-12)
    if robot is two_fixed:
        assert (qx, qy) == pytest.approx((float(x), float(y)), abs=1e-12)
    else:  # the point of the axle line nearest to P
        assert qx * ey - qy * ex == pytest.approx(0, abs=1e-12)
    v, omega, theta = 0.7, -1.3, 0.4
    vx, vy = (float(e) for e in axle.velocity_of_p(v, omega))
    assert (vx - omega * qy, vy + omega * qx) == pytest.approx((v * ex, v * ey), abs=1e-12)
    turned = [float(e) for e in axle.turned(math.cos(theta), math.sin(theta))]
    direction = complex(ex, ey) * complex(math.cos(theta), math.sin(theta))
    assert turned == pytest.approx([direction.real, direction.imag])
    behind = [float(e) for e in axle.coupling(Poly.of(2))]
    assert behind == pytest.approx([qx - 2 * ex, qy - 2 * ey], abs=1e-12)


@pytest.mark.parametrize(
    ("wheels", "trailers", "state", "turning", "by_heading"),
    [
        (UNICYCLE, 0, ["x", "y", "theta"], "omega", True),
        (UNICYCLE, 2, ["x", "y", "theta", "trailer1.theta", "trailer2.theta"], "omega", False),
        (CAR_REAR, 0, ["x", "y", "theta", "front.steer"], "front.steer_rate", False),
        (TRICYCLE, 1, ["x", "y", "theta", "front.steer", "trailer1.theta"], "front.steer_rate", False),
    ],
)
def test_states_and_inputs(
    wheels: str, trailers: int, state: list[str], turning: str, by_heading: bool
) -> None:
    d = derived(wheels, on_axle(trailers) if trailers else "")
    t = train(d.robot, d.mobility)
    assert [p.name for p in t.state] == state and t.size == len(state)
    assert t.turning.name == turning and t.by_heading == by_heading
    assert (t.steering is None) == (turning == "omega")


def test_the_steered_wheel_is_seen_from_the_axle() -> None:
    """Its pivot and its zero heading in a frame at the axle's middle along the direction of travel."""
    d = derived(
        "{name: rear, type: fixed, x: -0.2, y: 0.1, heading: -2*pi/3, r: 0.1, actuated: []}\n"
        "{name: front, type: steered, x: 0.7, y: 0.5, heading: pi/4, r: 0.1}"
    )
    t = train(d.robot, d.mobility)
    assert t.steering is not None
    e = complex(math.cos(math.pi / 3), math.sin(math.pi / 3))
    assert numbers(t.axle)[:2] == pytest.approx([e.real, e.imag])
    pivot = complex(0.7 + 0.2, 0.5 - 0.1) * e.conjugate()
    heading = complex(math.cos(math.pi / 4), math.sin(math.pi / 4)) * e.conjugate()
    steering = [_number(p) for p in (t.steering.x, t.steering.y, t.steering.ch, t.steering.sh)]
    assert steering == pytest.approx([pivot.real, pivot.imag, heading.real, heading.imag])


def test_results_of_brockett_are_called_by_their_place_in_the_chain() -> None:
    d = derived(DIFFERENTIAL, b="0.1")
    z = list(d.formula("chained").closed().values())
    for name in ("brockett", "brockett_rates"):
        formula = d.formula(name)
        values: dict[object, object] = {}
        for symbol, expr in formula.locals:
            values[symbol] = expr.xreplace(values)
        for k, wanted in enumerate(z, 1):
            (term,) = (value for symbol, value in values.items() if str(symbol) == f"chain_z{k}")
            assert abs(_at(term) - _at(wanted)) < 1e-12


def _at(expr: object) -> complex:
    return complex(expr.xreplace({s("x"): 0.3, s("y"): -0.7, s("theta"): 0.4}))  # type: ignore[attr-defined]
