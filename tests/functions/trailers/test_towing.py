"""Trailers in numbers: behind bodies that stand obliquely in their frame, axles follow and do not slide."""

from __future__ import annotations

import math
import random

import pytest

from tests.functions.models.robots import TWO_STEER, call, derived
from wmrgen.derivation.facade import Derivation

OBLIQUE = """{name: one, type: fixed, x: 0.2 - 0.3*sin(pi/6), y: -0.1 + 0.3*cos(pi/6), heading: -5*pi/6, r: 0.1}
{name: two, type: fixed, x: 0.2 + 0.3*sin(pi/6), y: -0.1 - 0.3*cos(pi/6), heading: pi/6, r: 0.2}"""
CAR = """{name: rear, type: fixed, x: -0.2, y: 0.1, heading: pi/3, r: 0.1}
{name: front, type: steered, x: 0.3, y: 0.9, heading: pi/4, r: 0.1, actuated: [steer]}"""
HITCHES = ["0, 0, 0", "0.2, 0, -0.1", "-0.15, 0.3, 0", "0, 0.1, 0.2"]
LENGTHS = (0.9, 0.7, 1.1)


def towing(wheels: str, hitches: str) -> Derivation:
    """Three trailers."""
    listed = ", ".join(
        f"{{length: {length}, hitch: {hitch}}}"
        for length, hitch in zip(LENGTHS, hitches.split(", "), strict=True)
    )
    return derived(wheels, f"trailers: [{listed}]")


def moved(state: dict[str, float], rates: dict[str, float], step: float) -> dict[str, float]:
    return {name: value + step * rates.get(f"{name}_rate", 0.0) for name, value in state.items()}


@pytest.mark.parametrize("hitches", HITCHES)
@pytest.mark.parametrize("wheels", [OBLIQUE, CAR, TWO_STEER], ids=["axle", "car", "two steered"])
def test_axles_of_trailers_move_along_their_headings(wheels: str, hitches: str) -> None:
    """Positions that are differentiated along the rates: the speed that the model gives, and nothing across."""
    d = towing(wheels, hitches)
    chance = random.Random(3)
    ports = [p.name for p in d.formula("trailer").inputs]
    names = [f"trailer{k}" for k in (1, 2, 3)]
    where = {"x", "y", "theta", *(f"{name}.theta" for name in names)}
    for _ in range(3):
        state = {name: chance.uniform(-0.7, 0.7) for name in ports}
        rates = call(d, "trailer", state)
        place = {name: state[name] for name in where}
        h = 1e-5
        after, before = (call(d, "trailer_positions", moved(place, rates, s)) for s in (h, -h))
        for name in names:
            velocity = [(after[f"{name}.{k}"] - before[f"{name}.{k}"]) / (2 * h) for k in "xy"]
            angle = state[f"{name}.theta"]
            along = [rates[f"{name}.speed"] * f(angle) for f in (math.cos, math.sin)]
            assert velocity == pytest.approx(along, abs=1e-7), name


@pytest.mark.parametrize("hitches", HITCHES)
@pytest.mark.parametrize("bend", [0.0, 0.35, -0.6])
def test_on_the_steady_circle_all_turn_alike(hitches: str, bend: float) -> None:
    """Behind two wheels of unlike size; speeds are those of the model, the margin is the least of their squares."""
    d = towing(OBLIQUE, hitches)
    circle = call(d, "steady_circle", {"curvature": bend})
    state = {"theta": 0.4}
    ahead = state["theta"] + math.pi / 6
    for k in (1, 2, 3):
        ahead -= circle[f"trailer{k}.hitch_angle"]
        state[f"trailer{k}.theta"] = ahead
    v, omega = 0.8, 0.8 * bend
    # Wheel one is mounted backwards, to the left of the axle's middle.
    spins = {"one.spin": -(v - 0.3 * omega) / 0.1, "two.spin": (v + 0.3 * omega) / 0.2}
    rates = call(d, "trailer", state | spins)
    assert rates["theta_rate"] == pytest.approx(omega, abs=1e-12)
    speeds = [circle[f"trailer{k}.speed"] for k in (1, 2, 3)]
    for k, speed in enumerate(speeds, 1):
        assert rates[f"trailer{k}.theta_rate"] == pytest.approx(omega, abs=1e-9)
        assert rates[f"trailer{k}.speed"] == pytest.approx(v * speed, abs=1e-9)
    assert circle["margin"] == pytest.approx(min(s**2 for s in speeds))


def test_beyond_the_margin_there_is_no_steady_circle() -> None:
    d = towing(OBLIQUE, "0, 0, 0")
    least = 1 / math.sqrt(sum(length**2 for length in LENGTHS))
    for bend, there in ((0.999 * least, True), (1.001 * least, False)):
        circle = call(d, "steady_circle", {"curvature": bend})
        assert (circle["margin"] >= 0) == there
        assert (circle["trailer3.speed"] > 0) == there and circle["trailer1.speed"] > 0
        assert circle["trailer1.hitch_angle"] == pytest.approx(math.asin(LENGTHS[0] * bend))
