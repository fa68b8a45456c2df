"""`lag:` of steering joints: the state space commands angles, which follow at first order."""

from __future__ import annotations

from math import exp, inf, radians, tan
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.functions.refusals import mistaken
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code
from wmrgen.functions.models.state_space import state_space
from wmrgen.report.sections.motion import regular

CAR = """\
wmrgen: 1
name: lagging
parameters: {{wheelbase: {{value: 1.1, tunable: true}}}}
limits: {{steer: [-30 deg, 40 deg], steer_rate: 2}}
{top}
wheels:
  - {{name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.3{rear}}}
  - {{name: front, type: steered, x: wheelbase, y: 0, heading: 0, r: 0.3, actuated: [steer]{front}}}
"""
TWO_STEER = """\
wmrgen: 1
name: two
lag: {steer: 0.2}
couplings: [{equal: [a.steer, b.steer]}]
wheels:
  - {name: a, type: steered, x: 0.6, y: 0.2, heading: 0, r: 0.1}
  - {name: b, type: steered, x: 0.6, y: -0.3, heading: 0, r: 0.1, lag: {steer: 300 ms}}
  - {name: c, type: steered, x: -0.5, y: 0.1, heading: 0, r: 0.1, lag: {steer: 50 ms}}
"""


AGILE = """\
  - {name: agile, type: steered, x: wheelbase, y: 0.3, heading: 0, r: 0.3, actuated: [steer], lag: {steer: 0.3}}
"""


def car(top: str = "", rear: str = "", front: str = "") -> wmrgen.Derivation:
    return of_text(CAR.format(top=top, rear=rear, front=front))


@pytest.mark.parametrize(
    ("top", "front", "constant"),
    [
        ("lag: {steer: 150 ms}", "", 0.15),
        ("", ", lag: {steer: 0.4}", 0.4),
        ("lag: {steer: 0.15 s}", ", lag: {steer: 0.4}", 0.4),
    ],
)
def test_a_step_of_the_command_is_answered_by_an_exponential(top: str, front: str, constant: float) -> None:
    derivation = car(top, "", front)
    space = derivation.model()["state_space"]
    assert [entry["name"] for entry in space["u"]] == ["rear.spin", "front.steer_command"]
    command = space["u"][1]
    assert (command["lower"], command["upper"]) == pytest.approx((radians(-30), radians(40)))
    step = derivation.state_space(discrete="rk4", dt=0.01)
    x = np.zeros(4)
    for _ in range(25):
        x = step(x, [2.0, 0.5], [1.1])[0].full().ravel()
    assert x[3] == pytest.approx(0.5 * (1 - exp(-0.25 / constant)), rel=1e-6)
    rates = derivation.state_space()([0, 0, 0, 0.3], [2.0, -0.0], [1.4]).full().ravel()
    assert rates == pytest.approx([0.6, 0, 0.6 * tan(0.3) / 1.4, -0.3 / constant])
    assert derivation.numpy().INPUTS == ("rear.spin", "front.steer_command")


def test_the_exact_step_takes_the_lag_in() -> None:
    """Twist form: the angle falls off exactly over a step of seconds; the limit of its rate is one of a function."""
    derivation = car("lag: {steer: 150 ms}")
    step = derivation.state_space("twist", "exact", 0.4)
    after, a, b, _ = step([1, 2, 0.3, 0.1], [0.0, 0.0, 0.5], [1.1])
    assert after.full().ravel() == pytest.approx([1, 2, 0.3, 0.5 - 0.4 * exp(-0.4 / 0.15)], abs=1e-15)
    assert float(a[3, 3]) == pytest.approx(exp(-0.4 / 0.15)) and float(b[3, 2]) == pytest.approx(
        1 - exp(-0.4 / 0.15)
    )
    (rate,) = derivation.entries("twist")["limits"]
    assert (rate["name"], rate["lower"], rate["upper"]) == ("front.steer_rate", -2, 2)
    h = derivation.limits("twist")([1, 2, 0.3, 0.1], [0.0, 0.0, 0.5], [1.1])
    assert float(h) == pytest.approx((0.5 - 0.1) / 0.15)


@pytest.mark.parametrize(
    ("kind", "lags", "stable"), [("rk4", 2.7, True), ("rk4", 2.9, False), ("collocation", 50, True)]
)
def test_steps_of_many_lags(kind: str, lags: float, stable: bool) -> None:
    """Runge and Kutta's is stable for steps of up to 2.785 time constants, Radau's for any (docs/mpc.md)."""
    step = car("lag: {steer: 0.1}").state_space(discrete=kind, dt=0.1 * lags)
    x = np.array([0, 0, 0, 0.3])
    for _ in range(20):
        x = step(x, [0.0, 0.0], [1.1])[0].full().ravel()
    assert (abs(x[3]) < 0.3) == stable


def test_without_lag_the_rate_is_the_input() -> None:
    space = car().default_state_space
    assert space is not None
    assert [port.name for port in space.inputs] == ["rear.spin", "front.steer_rate"]
    bounds = space.limited.bounds
    assert bounds["front.steer_rate"] == (-2, 2) and bounds["rear.spin"] == (-inf, inf)


def test_wheels_that_turn_together_have_the_longest_lag() -> None:
    """The twist form: a and b share one angle, c has its own."""
    derivation = of_text(TWO_STEER)
    f = derivation.state_space("twist")
    x, u = [0, 0, 0.4, 0.1, -0.2], [0.5, 0.1, -0.3, 0.7, 0.9]
    rates = f(x, u, []).full().ravel()
    assert rates[2:] == pytest.approx([-0.3, (0.7 - 0.1) / 0.3, (0.9 + 0.2) / 0.05])
    free = of_text(TWO_STEER.replace("lag: {steer: 0.2}\n", "").replace(", lag: {steer: 300 ms}", ""))
    space = state_space(free.robot, free.mobility, "twist")
    assert [port.name for port in space.inputs][3:] == ["a.steer_rate", "c.steer_command"]
    assert derivation.rolling()(x, u, []).full() == pytest.approx(free.rolling()(x, u, []).full())


def test_a_spin_is_commanded_as_it_was() -> None:
    text = CAR.format(top="lag: {steer: 150 ms}", rear=", actuated: []", front="")
    space = of_text(text.replace("actuated: [steer]", "actuated: [spin, steer]")).default_state_space
    assert space is not None
    assert [port.name for port in space.inputs] == ["front.spin", "front.steer_command"]


def test_a_virtual_wheel_has_the_lag_of_those_that_it_steers() -> None:
    text = (Path(__file__).parents[3] / "robots" / "car_with_trailers.yaml").read_text(encoding="utf-8")
    derivation = of_text(text.replace("wheels:\n", "lag: {steer: 0.5}\nwheels:\n", 1))
    space = derivation.default_state_space
    assert space is not None and [port.name for port in space.inputs] == ["rear.speed", "front.steer_command"]
    x = [0.0] * len(space.state)
    rates = derivation.state_space()(x, [0.0, 0.3], []).full().ravel()
    assert rates[[port.name for port in space.state].index("front.steer")] == pytest.approx(0.6)


def left_out(d: Derivation, form: str | None = None) -> tuple[str, ...]:
    """The wheels whose lag a form leaves out, which its description names."""
    space = state_space(d.robot, d.mobility, form)
    assert ("lag" in space.text) == bool(space.at_once)
    assert all(name in space.text for name in space.at_once)
    return space.at_once


def test_a_lag_that_a_form_leaves_out_is_said() -> None:
    """That of a wheel whose angle is no state: it follows others, turns with the motion or is a direction of travel;
    but not where it follows a coordinate that lags as long."""
    car = of_text(CAR.format(top="", rear="", front="") + AGILE)

    assert left_out(car, "posture") == left_out(car, "zeta") == ("agile",)
    assert left_out(car, "twist") == ()
    assert [e["name"] for e in car.entries("twist")["u"]][-1] == "agile.steer_command"
    both = of_text(CAR.format(top="lag: {steer: 0.4}", rear="", front="") + AGILE)
    assert left_out(both, "posture") == ()
    driven = (
        "{name: %s, type: castor, x: %s, y: 0.2, d: -0.05, r: 0.05, actuated: [spin, steer], lag: {steer: 1}}"
    )
    castors = of_text(f"wmrgen: 1\nname: castors\nwheels: [{driven % ('a', 0.3)}, {driven % ('b', -0.3)}]\n")
    assert left_out(castors) == ("a", "b")
    slower = "{name: c, type: steered, x: 0, y: -0.3, heading: 0, r: 0.1, lag: {steer: 2}}"
    wheels = f"wheels: [{driven % ('a', 0.3)}, {driven % ('b', -0.3)}, {slower}]"
    assert left_out(of_text(f"wmrgen: 1\nname: castors\n{wheels}\n")) == ("a", "b")
    assert all(name in "".join(regular(castors)) for name in ("`twist`", "`a`", "`b`"))
    assert "`front.steer_command`" in "".join(regular(both))


@pytest.mark.parametrize(
    ("top", "rear", "code", "place"),
    [
        ("lag: {steer: 0}", "", Code.VALUE, "0}"),
        ("lag: {steer: -0.1}", "", Code.VALUE, "-0.1}"),
        ("lag: {steer: 0.1 m}", "", Code.FORM, "0.1 m}"),
        ("lag: {spin: 0.1}", "", Code.UNKNOWN_KEY, "spin: 0.1}"),
        ("lag: {steer: wheelbase}", "", Code.VALUE, "wheelbase}"),
        ("", ", lag: {steer: 0.1}", Code.UNKNOWN_KEY, "steer: 0.1}"),
        ("lag: 0.1", "", Code.FORM, "0.1"),
    ],
)
def test_what_no_lag_is_is_said(top: str, rear: str, code: Code, place: str) -> None:
    with mistaken(code, place):
        car(top, rear, "")
