"""What is commanded can be driven, at any moment while steering swings: every wheel rolls and none slides.

The oracle is rigid-body kinematics: the contact of a wheel moves with the body and with its own swing, along the
wheel as fast as its rim and across it not at all.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from tests.laws.common import NAMES, admissible, gallery
from tests.oracle import oracle
from tests.oracle.harness import named, twist_of
from tests.robots import of_gallery, of_text, with_functions
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import NotDerivableError
from wmrgen.ir.interpret import FLOAT64, evaluate_module

Case = dict[str, float]
DT, STEPS = 0.02, 40
STEERED = [name for name in NAMES if any(w["type"] == "steered" for w in gallery(name)[1]["wheels"])]
LIMITED = ("spin", "steer", "steer_rate")


def call(d: Derivation, function: str, values: Case) -> Case:
    """The function of these values, of which it takes those that it knows."""
    known = {p.name for p in d.formula(function).inputs}
    return evaluate_module(d.module, function, {k: v for k, v in values.items() if k in known}, FLOAT64)


def commanded(d: Derivation, twist: Case, now: Case) -> Case:
    """`inverse` and, of robots that have it, `steer_toward`."""
    asked = call(d, "inverse", twist | now)
    asked |= {w.name + ".steer_rate": 0.0 for w in d.robot.wheels if w.kind.steers}
    if "steer_toward" not in {f.name for f in d.module.functions}:
        return asked
    wanted = {f"{name}_wanted": value for name, value in asked.items()}
    return asked | call(d, "steer_toward", now | wanted | {"dt": DT})


def check(d: Derivation, layout: dict[str, Any], twist: Any, commands: Case) -> None:
    """No wheel slides at ``twist``, `forward` finds it, and joints keep their limits."""
    for w in layout["wheels"]:
        spin, steer, rate = (commands.get(f"{w['name']}.{joint}", 0.0) for joint in LIMITED)
        spin -= w.get("per_steer", 0.0) * rate  # what the gears of the module turn
        for kind, row, per_spin, per_rate in oracle.wheel_rows(w, steer):
            if w["type"] != "castor":
                assert row @ twist + per_spin * spin + per_rate * rate == pytest.approx(0.0, abs=1e-9), kind
    found = call(d, "forward", commands)
    assert found["slip"] == pytest.approx(0.0, abs=1e-9)
    sensed = {p.name: commands.get(p.name, 0.0) for p in d.formula("forward").inputs}
    if oracle.forward(layout, sensed)[2] == 3:
        np.testing.assert_allclose(twist_of(found), twist, atol=1e-9)
    for wheel in d.robot.wheels:
        for joint in LIMITED:
            if (limit := d.robot.limit(wheel, joint)) and f"{wheel.name}.{joint}" in commands:
                value = commands[f"{wheel.name}.{joint}"]
                assert float(limit.low) - 1e-12 <= value <= float(limit.high) + 1e-12


def derived(name: str) -> Derivation:
    try:
        d = of_gallery(name, "inverse", "forward", "steer_toward")
        _ = d.module
    except NotDerivableError:
        d = of_gallery(name, "inverse", "forward")
    return d


@pytest.mark.parametrize("name", STEERED)
def test_a_twist_that_turns_is_driven_while_it_turns(name: str) -> None:
    """Slowly enough for the limits of steering, which `limit_twist` and the rates of a twist are about."""
    d, layout = derived(name), gallery(name)[1]
    straight = np.linalg.pinv(oracle.null(oracle.sliding_rows(layout, "fixed", {}))) @ (0.4, 0.0, 0.0)
    bend = np.linalg.pinv(oracle.null(oracle.sliding_rows(layout, "fixed", {}))) @ (0.0, 0.1, 0.1)
    now = {f"{w['name']}.steer": 0.0 for w in layout["wheels"] if w["type"] in oracle.STEERABLE}
    commands = now
    for k in range(STEPS):
        twist = admissible(layout, straight + bend * math.sin(1.5 * k * DT))
        commands = commanded(d, named(twist), now)
        if k:  # the first step swings to where the motion begins
            check(d, layout, twist, commands)
        now |= {name: value for name, value in commands.items() if name in now}


GEARED = [
    {"name": "fl", "type": "steered", "x": 0.3, "y": 0.25, "heading": 0.0, "r": 0.05, "per_steer": 0.7},
    {
        "name": "fr",
        "type": "steered",
        "x": 0.3,
        "y": -0.25,
        "heading": 0.0,
        "r": 0.05,
        "per_steer": -1.5,
        "o": 0.01,
    },
    {"name": "rear", "type": "steered", "x": -0.3, "y": 0.0, "heading": 0.0, "r": 0.05},
]


def geared() -> Derivation:
    """A swerve drive whose modules couple drive and steering, with encoders on the motors."""
    keys = [{("offset_y" if k == "o" else k): v for k, v in w.items()} for w in GEARED]
    wheels = [f"  - {{{', '.join(f'{k}: {v}' for k, v in w.items())}}}" for w in keys]
    encoder = "encoder: {spin: {counts: 100, gear: 6}, steer: {counts: 400}}"
    text = "\n".join(["wmrgen: 1", "name: geared", encoder, "wheels:", *wheels])
    return of_text(f"{text}\n", ["inverse", "forward", "steer_toward", "joints_from_counts"])


def test_the_gears_of_a_module_are_driven_along() -> None:
    d, now = geared(), {f"{w['name']}.steer": 0.0 for w in GEARED}
    for k in range(STEPS):
        angle = 1.5 * k * DT
        twist = np.array([0.5 * math.cos(angle), 0.5 * math.sin(angle), 0.3])
        commands = commanded(d, named(twist), now)
        if k:
            check(d, {"wheels": GEARED, "couplings": []}, twist, commands)
        now = {name: commands[name] for name in now}


def test_counters_of_a_module_that_steers_on_the_spot_show_standstill() -> None:
    """The motor turns by per_steer for 1 rad of the wheel that stands under its axis: the robot does not move."""
    d, turned = geared(), 0.1
    counts = {p.name: 0.0 for p in d.formula("joints_from_counts").inputs} | {"dt": DT}
    counts |= {f"fl.{joint}_counts": 400 * turned / math.tau for joint in ("steer", "steer_rate")}
    counts["fl.spin_counts"] = 600 * 0.7 * turned / math.tau
    joints = call(d, "joints_from_counts", counts) | {f"{n}.steer": 0.0 for n in ("fr", "rear")}
    assert joints["fl.spin"] == pytest.approx(0.7 * turned / DT)
    np.testing.assert_allclose(list(call(d, "forward", joints).values()), 0.0, atol=1e-12)


CAR = """\
wmrgen: 1
name: car
wheels:
  - {{name: fl, type: steered, x: 1.645, y: 0.495, heading: {heading}, r: 0.22, limits: {{steer: {stops}}}}}
  - {{name: fr, type: steered, x: 1.645, y: -0.495, heading: 0, r: 0.22, limits: {{steer: [-35 deg, 35 deg]}}}}
  - {{name: rl, type: fixed, x: {rear}, y: 0.521, heading: 0, r: 0.285}}
  - {{name: rr, type: fixed, x: {rear}, y: -0.521, heading: 0, r: 0.285}}
limits: {{vx: 3, omega: 2, spin: 15}}
"""


def cars() -> list[tuple[Derivation, dict[str, Any]]]:
    """Cars of the gallery, one with stops that differ, and one that P is no axle of."""
    texts = [
        CAR.format(heading=0, stops="[-35 deg, 35 deg]", rear=0),
        CAR.format(heading="10 deg", stops="[-40 deg, 10 deg]", rear=-0.6),
    ]
    found = [
        (of_gallery(n, "inverse", "forward", "limit_twist"), gallery(n)[1])
        for n in ("f1tenth", "ackermann_car")
    ]
    for text in texts:
        d = of_text(text, ["inverse", "forward", "limit_twist"])
        wheels = [
            {"name": w.name, "type": w.type, "x": w.pivot.real, "y": w.pivot.imag, "heading": w.heading,
             "r": float(w.nominal.r)} for w in d.robot.wheels
        ]  # fmt: skip
        found.append((d, {"wheels": wheels, "couplings": []}))
    return found


@pytest.mark.parametrize("car", range(4))
def test_what_limit_twist_gives_is_inside_the_steering_stops(car: int) -> None:
    """Whatever is asked, `inverse` drives the result exactly; what the stops allow is kept."""
    (d, layout), source = cars()[car], np.random.default_rng(3)
    present = {f"{w['name']}.steer": 0.0 for w in layout["wheels"] if w["type"] == "steered"}
    cut = 0
    for asked in source.uniform(-1.0, 1.0, (60, 3)) * (1.0, 0.0, 2.0):
        kept = call(d, "limit_twist", named(asked))
        found = twist_of(kept)
        commands = call(d, "inverse", kept | present)
        assert commands["slip"] == pytest.approx(0.0, abs=1e-9)
        check(d, layout, found, commands)
        np.testing.assert_allclose(twist_of(call(d, "limit_twist", kept)), found, atol=1e-12)
        stops = [d.robot.limit(w, "steer") for w in d.robot.wheels if w.kind.steers]
        turned = [commands[name] for name in present]
        at_a_stop = any(
            min(abs(t - float(e)) for e in s) < 1e-6 for s, t in zip(stops, turned, strict=True) if s
        )
        cut += at_a_stop
        assert at_a_stop or found[2] * asked[0] == pytest.approx(found[0] * asked[2], abs=1e-9)
        present = {name: commands[name] for name in present}
    assert 10 < cut < 60


TWO_STEERED = """\
wmrgen: 1
name: both
wheels:
  - {{name: front, type: steered, x: 0.6, y: 0.1, heading: {front}, r: 0.1, limits: {{steer: [-35 deg, 25 deg]}}}}
  - {{name: rear, type: steered, x: -0.5, y: 0, heading: {rear}, r: 0.1, limits: {{steer: [-80 deg, 80 deg]}}}}
limits: {{vx: 3, vy: 3, omega: 3}}
"""


@pytest.mark.parametrize(("front", "rear"), [("0", "180 deg"), ("60 deg", "90 deg"), ("-90 deg", "-120 deg")])
def test_two_steered_wheels_keep_their_stops(front: str, rear: str) -> None:
    """No wheel slides at what `limit_twist` gives; the twist is left alone where the stops allow it."""
    text = TWO_STEERED.format(front=front, rear=rear)
    d = of_text(text, ["inverse", "forward", "limit_twist"])
    wheels = [
        {"name": w.name, "type": w.type, "x": w.pivot.real, "y": w.pivot.imag, "heading": w.heading, "r": 0.1}
        for w in d.robot.wheels
    ]
    source, kept_whole = np.random.default_rng(7), 0
    present = {"front.steer": 0.0, "rear.steer": 0.0}
    for asked in source.uniform(-1.0, 1.0, (200, 3)):
        kept = call(d, "limit_twist", named(asked))
        commands = call(d, "inverse", kept | present)
        check(d, {"wheels": wheels, "couplings": []}, twist_of(kept), commands)
        whole = call(d, "inverse", named(asked) | present)["slip"] < 1e-9
        assert whole == (np.abs(twist_of(kept) - asked).max() < 1e-9)
        kept_whole += whole
        present = {name: commands[name] for name in present}
    assert 5 < kept_whole < 150
    assert not np.any(twist_of(call(d, "limit_twist", named(np.zeros(3)))))


@pytest.mark.parametrize("car", range(4))
def test_fixed_wheels_roll_about_the_centre_that_the_steering_has(car: int) -> None:
    """Whatever was commanded: at the angles of another twist the wheels drive a multiple of that one, without slip."""
    source = np.random.default_rng(5)
    d = with_functions(cars()[car][0], ["inverse", "forward", "limit_twist", "compensate_steering"])
    steered = [w.name for w in d.robot.wheels if w.kind.steers]
    rest = {f"{n}.steer": 0.0 for n in steered}
    for asked, other in source.uniform(-1.0, 1.0, (30, 2, 3)) * (1.0, 0.0, 0.3):
        wanted, there = (call(d, "limit_twist", named(t)) for t in (asked, other))
        commands, stand = (call(d, "inverse", t | rest) for t in (wanted, there))
        now = {f"{n}.steer": stand[f"{n}.steer"] for n in steered}
        spins = call(d, "compensate_steering", commands | {f"{k}_now": v for k, v in now.items()})
        found = call(d, "forward", commands | spins | now)
        assert found["slip"] == pytest.approx(0.0, abs=1e-9)
        np.testing.assert_allclose(np.cross(twist_of(found), twist_of(there)), 0.0, atol=1e-9)
        same = call(d, "compensate_steering", commands | {f"{k}_now": commands[k] for k in now})
        assert same == pytest.approx({k: commands[k] for k in same}, abs=1e-9)
