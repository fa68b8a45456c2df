"""An oracle that shares nothing with the models: contact points written down from the robot file, moved by
finite differences along the rates. Standard wheels must not slide, and must roll as fast as they turn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.functions.models.robots import (
    CAR_FRONT,
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_FRONT,
    FOUR_REAR,
    OMNI,
    TRICYCLE,
    TWO_STEER,
    VIRTUAL_FRONT,
    VIRTUAL_REAR,
    call,
    derived,
    on_axle,
)
from wmrgen.derivation.facade import Derivation

STEP = 1e-5
CASTORS = "\n".join(
    f"{{name: c{k}, type: castor, x: {x}, y: {y}, d: 0.05, offset_y: {o}, r: r, actuated: [spin, steer]}}"
    for k, (x, y, o) in enumerate(((0.3, 0.1, 0.0), (-0.2, 0.25, 0.02), (-0.25, -0.2, 0.0)))
)
OFFSET = FOUR_REAR.replace(
    "y: a, heading: 0, r: r, actuated: [steer]", "y: a, heading: 0, offset_y: 0.03, r: r"
)
TAIL = DIFFERENTIAL + "\n{name: tail, type: castor, x: -0.3, y: 0, d: 0.04, r: 0.05}"
ROBOTS = {
    "bicycle": (CAR_REAR, ""),
    "front driven": (CAR_FRONT, ""),
    "tricycle": (TRICYCLE, ""),
    "ackermann": (FOUR_REAR, VIRTUAL_REAR),
    "ackermann front": (FOUR_FRONT, VIRTUAL_FRONT),
    "ackermann real angles": (FOUR_REAR, ""),
    "offset axles": (OFFSET, "virtual: [{name: psi, steers: [front_left, front_right]}]"),
    "offset driven": (OFFSET, "virtual: [{name: psi, steers: [front_left, front_right]}]"),
    "two steer": (TWO_STEER, ""),
    "differential": (DIFFERENTIAL, ""),
    "castor tail": (TAIL, ""),
    "powered castors": (CASTORS, ""),
    "omni": (OMNI, ""),
}


def derivation(name: str) -> Derivation:
    wheels, extra = ROBOTS[name]
    if name == "offset driven":
        wheels = wheels.replace("heading: 0, r: r, actuated: [spin]", "heading: 0, r: r, actuated: []")
    return derived(wheels, extra, b="0.13")


def start(d: Derivation, form: str, seed: int) -> tuple[list[str], list[str], dict[str, float]]:
    """Names of state and inputs, and values of both."""
    system = d.system(form)
    state, inputs = [q.name for q in system.state], [u.name for u in system.inputs]
    random = np.random.default_rng(seed)
    return state, inputs, {n: float(random.uniform(-0.6, 0.6)) for n in (*state, *inputs)}


def moved(
    values: dict[str, float], rates: dict[str, float], state: list[str], step: float
) -> dict[str, float]:
    change = {n: n[:-6] + ".spin" if n.endswith(".angle") else f"{n}_rate" for n in state}
    return values | {n: values[n] + step * rates[change[n]] for n in state}


def steering(d: Derivation, values: dict[str, float]) -> dict[str, float]:
    """Angles of all turning wheels: states, or by the condition that its axle passes through the ICR."""
    angles = {
        w.name: values[f"{w.name}.steer"] for w in d.robot.wheels if w.turns and f"{w.name}.steer" in values
    }
    virtual = [v for v in d.robot.virtual if f"{v.name}.steer" in values]
    points = [(float(v.x.nominal), float(v.y.nominal), values[f"{v.name}.steer"]) for v in virtual]
    points += [
        (float(w.nominal.x), float(w.nominal.y), angles[w.name])
        for w in d.robot.wheels
        if w.type == "steered" and w.name in angles
    ]
    for w in d.robot.wheels:
        if w.type == "steered" and w.name not in angles:
            angles[w.name] = _follow(float(w.nominal.x), float(w.nominal.y), points[0])
    return angles


def _follow(x: float, y: float, lead: tuple[float, float, float]) -> float:
    """The axle of a car's wheel through the ICR on the rear axle line x = 0."""
    lx, ly, angle = lead
    icr = ly + lx / math.tan(angle)
    return math.atan(x / (icr - y))


def contact(d: Derivation, wheel: Any, values: dict[str, float]) -> tuple[np.ndarray, float]:
    """World position of a contact point and world angle of its rolling direction."""
    g = wheel.nominal
    angle = math.atan2(float(g.sh), float(g.ch)) + (steering(d, values)[wheel.name] if wheel.turns else 0.0)
    e = np.array([math.cos(angle), math.sin(angle)])
    n = np.array([-e[1], e[0]])
    body = np.array([float(g.x), float(g.y)]) + float(g.d) * e + float(g.o) * n
    c, s = math.cos(values["theta"]), math.sin(values["theta"])
    return np.array([values["x"], values["y"]]) + np.array([[c, -s], [s, c]]) @ body, values["theta"] + angle


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", ROBOTS)
def test_wheels_roll_and_do_not_slide(name: str, seed: int) -> None:
    d = derivation(name)
    state, inputs, values = start(d, "configuration", seed)
    rates = call(d, "configuration", values)
    assert all(rates[u] == pytest.approx(values[u], abs=1e-9) for u in inputs if u in rates)
    ahead, behind = moved(values, rates, state, STEP), moved(values, rates, state, -STEP)
    for w in d.robot.wheels:
        if not w.kind.directed:
            continue
        velocity = (contact(d, w, ahead)[0] - contact(d, w, behind)[0]) / (2 * STEP)
        angle = contact(d, w, values)[1]
        e = np.array([math.cos(angle), math.sin(angle)])
        rim = float(w.nominal.r) * rates[f"{w.name}.spin"]
        assert velocity @ e == pytest.approx(rim, abs=1e-8)
        if w.kind.sliding_row:
            assert velocity @ np.array([-e[1], e[0]]) == pytest.approx(0.0, abs=1e-8)


TRAINS = {
    "three on the axle": (CAR_REAR, on_axle(3)),
    "off axle": (CAR_REAR, "trailers: [{length: l1, hitch: h}, {length: l2, hitch: -0.1}, {length: l3}]"),
    "tractor": (DIFFERENTIAL, "trailers: [{length: l1, hitch: h}, {length: l2}]"),
    "front driven": (FOUR_FRONT, f"{VIRTUAL_FRONT}\ntrailers: [{{length: l1}}]"),
    "two steer": (TWO_STEER, "trailers: [{length: l1, hitch: h}, {length: l2, hitch: h}]"),
}


def axles(d: Derivation, values: dict[str, float], b: float) -> list[np.ndarray]:
    """World positions of the trailers' axles: on bars of their lengths behind their couplings."""
    at = np.array([values["x"], values["y"]])
    heading = values["theta"]
    at = at + b * np.array([math.cos(heading), math.sin(heading)])
    points = []
    for t in d.robot.trailers:
        own = values[f"{t.name}.theta"]
        at = at - float(t.hitch.nominal) * np.array([math.cos(heading), math.sin(heading)])
        at = at - float(t.length.nominal) * np.array([math.cos(own), math.sin(own)])
        heading = own
        points.append(at)
    return points


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", TRAINS)
def test_trailer_axles_do_not_slide(name: str, seed: int) -> None:
    wheels, extra = TRAINS[name]
    d = derived(wheels, extra, b="0.13")
    b = 0.13 if name == "tractor" else 0.0
    state, _, values = start(d, "trailer", seed)
    rates = call(d, "trailer", values)
    ahead, behind = moved(values, rates, state, STEP), moved(values, rates, state, -STEP)
    for k, t in enumerate(d.robot.trailers):
        velocity = (axles(d, ahead, b)[k] - axles(d, behind, b)[k]) / (2 * STEP)
        own = values[f"{t.name}.theta"]
        assert velocity @ [-math.sin(own), math.cos(own)] == pytest.approx(0.0, abs=1e-8)
        assert velocity @ [math.cos(own), math.sin(own)] == pytest.approx(rates[f"{t.name}.speed"], abs=1e-8)
    posed = {n: values[n] for n in ("x", "y", "theta")} | {
        f"{t.name}.theta": values[f"{t.name}.theta"] for t in d.robot.trailers
    }
    places = call(d, "trailer_positions", posed)
    for t, at in zip(d.robot.trailers, axles(d, values, b), strict=True):
        assert [places[f"{t.name}.x"], places[f"{t.name}.y"]] == pytest.approx(list(at), abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["three on the axle", "off axle"])
def test_a_train_settles_on_the_steady_circle(name: str) -> None:
    """Driving forward with a constant steering angle: the hitch angles approach those of the closed form."""
    d = derived(*TRAINS[name], b="0.13")
    kappa = 0.3
    values = {q.name: 0.0 for q in d.system("trailer").state}
    values |= {"front.steer": math.atan(kappa * 1.4), "rear.spin": 1 / 0.11, "front.steer_rate": 0.0}
    state = [q.name for q in d.system("trailer").state]
    step = 0.02
    for _ in range(1500):
        first = call(d, "trailer", values)
        middle = call(d, "trailer", moved(values, first, state, step / 2))
        values = moved(values, middle, state, step)
    steady = call(d, "steady_circle", {"curvature": kappa})
    assert steady["margin"] > 0
    heading = values["theta"]
    for t in d.robot.trailers:
        own = values[f"{t.name}.theta"]
        assert heading - own == pytest.approx(steady[f"{t.name}.hitch_angle"], abs=1e-6)
        heading = own


@pytest.mark.parametrize("backend", ["exact", "casadi", "c"])
def test_singular_configurations_give_finite_rates(backend: str) -> None:
    """At cos(psi) = 0 the quotient reads 0, and the Jacobian that CasADi differentiates holds no NaN."""
    d = derived(CAR_REAR, on_axle(2))
    for function in ("posture", "trailer", "configuration"):
        values = {"front.steer": math.pi / 2, "rear.spin": 1.0, "front.steer_rate": 0.5}
        rates = call(d, function, values, backend)
        assert all(math.isfinite(v) for v in rates.values())
        assert rates["theta_rate"] == 0.0 and rates["x_rate"] == pytest.approx(0.11)


def test_jacobians_are_finite_at_the_singularity() -> None:
    from wmrgen import derive

    d = derive(derived(FOUR_REAR, VIRTUAL_REAR).robot, ["posture", "configuration", "virtual_steering"])
    for name, f in d.casadi().items():
        at = [math.pi / 2 if n == "psi.steer" else 0.3 for n in f.name_in()]
        for block in f.jacobian()(*at, *f(*at)):
            assert np.isfinite(np.array(block, float)).all(), name
