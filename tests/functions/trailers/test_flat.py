"""Flat outputs: states and inputs recovered from derivatives, against the path's own geometry and the robot's model."""

from __future__ import annotations

import math

import pytest
import sympy

from tests.depth import BACKENDS
from tests.functions.models.robots import (
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_REAR,
    OMNI,
    TRICYCLE,
    TWO_STEER,
    UNICYCLE,
    VIRTUAL_REAR,
    call,
    derived,
    evaluated,
    on_axle,
    p,
    s,
    zero,
)
from tests.functions.refusals import refused
from tests.functions.trailers.test_chained import inside
from wmrgen.functions.registry import Reason
from wmrgen.functions.trailers.flat import flatness

SYNCHRO = """{name: w1, type: steered, x: a, y: 0, heading: 0, r: r}
{name: w2, type: steered, x: -a, y: a, heading: 0, r: r}
{name: w3, type: steered, x: -a, y: -a, heading: 0, r: r}"""
COUPLED = "couplings: [{equal: [w1.steer, w2.steer, w3.steer]}, {equal: [w1.spin, w2.spin, w3.spin]}]"
BACK = CAR_REAR.replace("x: 0, y: 0", "x: -b, y: 0").replace("x: base", "x: a")


def path(t: float) -> dict[str, float]:
    """A figure eight, traversed forward, with three derivatives."""
    a, b = 2.0, 1.3
    x = (a * math.sin(t), a * math.cos(t), -a * math.sin(t), -a * math.cos(t))
    y = (b * math.sin(2 * t), 2 * b * math.cos(2 * t), -4 * b * math.sin(2 * t), -8 * b * math.cos(2 * t))
    values = {}
    for k, suffix in enumerate(("", "_rate", "_accel", "_jerk")):
        values |= {f"x{suffix}": x[k], f"y{suffix}": y[k]}
    return values


def recovered(wheels: str, extra: str, t: float, backend: str = "casadi") -> dict[str, float]:
    d = derived(wheels, extra, b="0.3")
    names = {port.name for port in d.formula("flat").inputs}
    return call(d, "flat", {k: v for k, v in path(t).items() if k in names}, backend)


@pytest.mark.parametrize(
    ("wheels", "extra"),
    [
        (UNICYCLE, ""), (DIFFERENTIAL, ""), (CAR_REAR, ""), (TRICYCLE, ""), (BACK, ""), (FOUR_REAR, ""),
        pytest.param(FOUR_REAR, VIRTUAL_REAR, marks=pytest.mark.slow),
    ],
    ids=["unicycle", "differential", "car", "tricycle", "reference", "ackermann", "virtual"],
)  # fmt: skip
@pytest.mark.parametrize("t", [0.1, 0.7, 2.0, 4.4])
def test_states_move_as_the_inputs_say(wheels: str, extra: str, t: float) -> None:
    """Rates of the recovered states by central differences: those of the recovered inputs and of the robot's model."""
    h = 1e-5
    now, before, after = (recovered(wheels, extra, t + k * h) for k in (0, -1, 1))
    rate = {k: (after[k] - before[k]) / (2 * h) for k in now}
    c, n = math.cos(now["theta"]), math.sin(now["theta"])
    assert rate["x"] == pytest.approx(now["vx"] * c - now["vy"] * n, abs=1e-6)
    assert rate["y"] == pytest.approx(now["vx"] * n + now["vy"] * c, abs=1e-6)
    assert rate["theta"] == pytest.approx(now["omega"], abs=1e-6)
    for name in now:
        if name.endswith(".steer"):
            assert rate[name] == pytest.approx(now[f"{name}_rate"], abs=1e-6)
    assert now["v"] == pytest.approx(math.hypot(path(t)["x_rate"], path(t)["y_rate"]))
    # The twist is one that the wheels allow, with the steering where it was recovered.
    d = derived(wheels, extra, b="0.3")
    joints = call(d, "inverse", {k: now[k] for k in ("vx", "vy", "omega")})
    assert joints["slip"] == pytest.approx(0, abs=1e-9)
    for name in now:
        if name.endswith(".steer") and name in joints:
            assert math.cos(joints[name] - now[name]) ** 2 == pytest.approx(1)


def test_in_symbols_for_a_car() -> None:
    """theta, v, tan psi = D (x' y'' - y' x'') / v**3 (Tzafestas (2.52)-(2.55) solved for the inputs)."""
    outputs = derived(CAR_REAR, "", base="{value: 1.4, tunable: true}").formula("flat").closed()
    outputs = {k: evaluated(inside(e)) for k, e in outputs.items()}
    dx, dy, ax, ay = s("x_rate"), s("y_rate"), s("x_accel"), s("y_accel")
    kappa = (dx * ay - dy * ax) / sympy.sqrt(dx**2 + dy**2) ** 3
    steer = outputs["front.steer"]
    assert isinstance(steer, sympy.atan2)
    assert sympy.simplify(steer.args[0] / steer.args[1] - p("base") * kappa) == 0
    assert zero(outputs["v"] - sympy.sqrt(dx**2 + dy**2))


@pytest.mark.parametrize("backend", BACKENDS)
def test_backends_agree(backend: str) -> None:
    assert recovered(FOUR_REAR, "", 0.7, backend) == pytest.approx(recovered(FOUR_REAR, "", 0.7), rel=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_standing_still_is_finite(backend: str) -> None:
    outputs = call(derived(CAR_REAR), "flat", {"x_accel": 1.0, "y_jerk": 1.0}, backend)
    assert all(math.isfinite(v) for v in outputs.values())
    assert outputs["v"] == outputs["omega"] == outputs["front.steer"] == outputs["front.steer_rate"] == 0


def test_pose_of_an_omnidirectional_robot() -> None:
    d = derived(OMNI)
    twist = call(d, "flat", {"theta": 0.3, "x_rate": 0.5, "y_rate": -0.25, "theta_rate": 0.75})
    c, n = math.cos(0.3), math.sin(0.3)
    assert twist == pytest.approx({"vx": 0.5 * c - 0.25 * n, "vy": -0.25 * c - 0.5 * n, "omega": 0.75})


def test_what_is_claimed() -> None:
    def claimed(wheels: str, extra: str = "") -> tuple[str, int]:
        d = derived(wheels, extra)
        claim = flatness(d.robot, d.mobility)
        return claim.outputs, claim.order

    assert claimed(DIFFERENTIAL) == ("x, y of the centre of the axle", 2)
    assert claimed(CAR_REAR) == ("x, y of the centre of the axle", 3)
    assert claimed(CAR_REAR, on_axle(3)) == ("x, y of the axle of trailer3", 6)
    assert claimed(DIFFERENTIAL, on_axle(1)) == ("x, y of the axle of trailer1", 3)
    assert claimed(OMNI) == ("x, y, theta of the body", 1)
    assert claimed(TWO_STEER) == ("x, y, theta of the body", 2)


@pytest.mark.parametrize(
    ("wheels", "extra", "reason", "names"),
    [
        (CAR_REAR, on_axle(1), Reason.FLAT_OUTPUTS, ("trailer1", "chained_input")),
        (TWO_STEER, "", Reason.FLAT_OUTPUTS, ("x, y, theta", "inverse")),
        (SYNCHRO, COUPLED, Reason.FLAT_OUTPUTS, ("x, y", "inverse")),
        (CAR_REAR, "trailers: [{length: 1, hitch: 0.2}]", Reason.HITCH, ("hitch",)),
    ],
)
def test_refusals_say_why(wheels: str, extra: str, reason: Reason, names: tuple[str, ...]) -> None:
    with refused(reason, *names):
        derived(wheels, extra).formula("flat")
