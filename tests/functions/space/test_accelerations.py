"""Second-order inverse kinematics against differences of `inverse` along smooth twists, over the whole gallery."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import sympy

from tests.depth import BACKENDS
from tests.functions.common import ROBOTS, TRICYCLE, call, derived, write
from wmrgen.geometry.layout.records import Wheel
from wmrgen.geometry.symbolic import signal

TWIST = ("vx", "vy", "omega")
# mean, amplitude, frequency, phase of each component; the second stays inside steering limits
WIDE = ((0.7, 0.2, 0.9, 0.3), (0.2, 0.3, 1.1, 1.2), (0.4, 0.3, 0.7, -0.5))
NARROW = ((0.9, 0.1, 0.9, 0.3), (0.02, 0.03, 1.1, 1.2), (0.04, 0.03, 0.7, -0.5))
H = 1e-5


def twist(profile: tuple[tuple[float, ...], ...], t: float, order: int) -> dict[str, float]:
    """The twist at t, or its first or second derivative."""
    suffix = ("", "_rate", "_jerk")[order]
    result = {}
    for name, (mean, size, pace, phase) in zip(TWIST, profile, strict=True):
        value = size * pace**order * math.sin(pace * t + phase + order * math.pi / 2)
        result[name + suffix] = value + (mean if order == 0 else 0.0)
    return result


class Drive:
    """A robot driven along a profile: its steering follows `inverse`, its castors swivel."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.robot = derived(path, "inverse").robot
        limited = self.robot.limits.keys() & {"steer"} or any("steer" in w.limits for w in self.robot.wheels)
        self.profile = NARROW if limited else WIDE
        self.jerks = "vx_jerk" in [
            p.name for p in derived(path, "accelerations").formula("accelerations").inputs
        ]
        first = {w.index: 0.3 * w.index for w in self.robot.wheels if w.turns}
        self.start = {
            f"{w.name}.steer": first[self.robot.steer_group[w.index]] for w in self.robot.wheels if w.turns
        }
        for _ in range(3):
            self.start |= {k: v for k, v in self.inverse(0.0, self.start).items() if k in self.start}

    def inverse(self, t: float, steer: Mapping[str, float]) -> dict[str, float]:
        return call(self.path, "inverse", twist(self.profile, t, 0) | dict(steer))

    def accelerations(self, t: float, steer: Mapping[str, float]) -> dict[str, float]:
        inputs = twist(self.profile, t, 0) | twist(self.profile, t, 1) | dict(steer)
        return call(self.path, "accelerations", inputs | (twist(self.profile, t, 2) if self.jerks else {}))

    def at(self, t: float) -> dict[str, float]:
        """Steering angles a moment t later: castors by the midpoint rule."""
        rate = self.inverse(0.0, self.start)
        middle = {k: v + t / 2 * rate.get(f"{k}_rate", 0.0) for k, v in self.start.items()}
        rate = self.inverse(t / 2, middle)
        return {k: v + t * rate.get(f"{k}_rate", 0.0) for k, v in self.start.items()}


def offset(w: Wheel) -> float:
    return float(w.nominal.o) if w.type == "steered" else 0.0


ON_ONE_BELT = """\
wmrgen: 1
name: belt
wheels:
  - {name: a, type: steered, x: 0.3,  y: 0.25, heading: 0,    r: 0.05, offset_y: 0.04}
  - {name: b, type: steered, x: -0.3, y: 0.1,  heading: pi/2, r: 0.05, offset_y: -0.03}
couplings: [{equal: [a.steer, b.steer]}]
"""


def test_rates_of_wheels_that_see_different_velocities_on_one_belt(tmp_path: Path) -> None:
    """Their angle is half of a sum's double angle."""
    test_rates_are_differences_of_inverse(write(tmp_path, ON_ONE_BELT))


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda p: p.stem)
def test_rates_are_differences_of_inverse(robot: Path) -> None:
    drive = Drive(robot)
    now, result = drive.inverse(0.0, drive.start), drive.accelerations(0.0, drive.start)
    sides = [(drive.inverse(t, drive.at(t)), drive.accelerations(t, drive.at(t))) for t in (H, -H)]

    def slope(kind: int, name: str) -> float:
        return (sides[0][kind][name] - sides[1][kind][name]) / (2 * H)

    for w in drive.robot.wheels:
        if not w.has_spin:
            continue
        size = max(1.0, abs(result[f"{w.name}.spin_rate"]), abs(result[f"{w.name}.spin"]))
        pairs = []
        if offset(w):
            turn = offset(w) * result[f"{w.name}.steer_rate"] / float(w.nominal.r)
            pairs += [("spin", now[f"{w.name}.spin"] - turn), ("spin_rate", slope(1, f"{w.name}.spin"))]
            pairs.append(("steer_acceleration", slope(1, f"{w.name}.steer_rate")))
        else:
            pairs += [("spin", now[f"{w.name}.spin"]), ("spin_rate", slope(0, f"{w.name}.spin"))]
        if w.type == "steered":
            pairs += [("steer", now[f"{w.name}.steer"]), ("steer_rate", slope(0, f"{w.name}.steer"))]
        if w.type == "castor":
            pairs.append(("steer_rate", now[f"{w.name}.steer_rate"]))
            pairs.append(("steer_acceleration", slope(0, f"{w.name}.steer_rate")))
        for joint, value in pairs:
            assert result[f"{w.name}.{joint}"] == pytest.approx(value, abs=2e-6 * size), (w.name, joint)


def test_offset_wheels_roll_and_do_not_slide() -> None:
    """Kelly's four-wheel steering: the contact's own velocity, steering rate included, is r spin along the wheel."""
    path = next(p for p in ROBOTS if p.stem == "kelly_4ws")
    drive = Drive(path)
    result, v = drive.accelerations(0.0, drive.start), twist(drive.profile, 0.0, 0)
    for w in drive.robot.wheels:
        h, o = result[f"{w.name}.steer"], offset(w)
        e, n = np.array([math.cos(h), math.sin(h)]), np.array([-math.sin(h), math.cos(h)])
        x, y = float(w.nominal.x), float(w.nominal.y)
        pivot = np.array([v["vx"] - v["omega"] * y, v["vy"] + v["omega"] * x])
        contact = pivot - (v["omega"] + result[f"{w.name}.steer_rate"]) * o * e
        assert contact @ n == pytest.approx(0, abs=1e-9)
        assert contact @ e == pytest.approx(0.1 * result[f"{w.name}.spin"], abs=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_wheel_held_by_its_limit_does_not_steer(backend: str, tmp_path: Path) -> None:
    path = write(tmp_path, TRICYCLE.format(base=1.0) + "limits: {steer: 0.5}\n")
    inputs = {"vx": 0.5, "omega": 1.0, "omega_rate": 0.3, "vx_rate": 0.2, "front.steer": 0.4}
    result = call(path, "accelerations", inputs, backend)
    assert result["front.steer"] == pytest.approx(0.5) and result["front.steer_rate"] == 0
    # the front pivot moves by (0.5, 1.0) and its velocity changes by (0.2, 0.3)
    assert result["front.spin_rate"] == pytest.approx((0.2 * math.cos(0.5) + 0.3 * math.sin(0.5)) / 0.1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_from_standstill_a_wheel_speeds_up_as_it_stands(backend: str, tmp_path: Path) -> None:
    path = write(tmp_path, TRICYCLE.format(base=1.0))
    result = call(path, "accelerations", {"vx_rate": 2.0, "omega_rate": 1.0, "front.steer": 0.3}, backend)
    assert result["front.steer"] == pytest.approx(0.3) and result["front.steer_rate"] == 0
    assert result["front.spin_rate"] == pytest.approx((2 * math.cos(0.3) + math.sin(0.3)) / 0.1)
    assert result["rear_left.spin_rate"] == pytest.approx((2 - 0.3) / 0.1)


@pytest.mark.parametrize(
    ("robot", "lead"), [(TRICYCLE.format(base=1.0), "front"), (ON_ONE_BELT.replace("pi/2", "0"), "a")]
)
def test_a_pivot_slower_than_a_micrometre_a_second_counts_as_that_fast(
    tmp_path: Path, robot: str, lead: str
) -> None:
    """Straight ahead, while the velocity begins to turn: v v'/|v|^2; alone and as half of a double angle."""
    path = write(tmp_path, robot)
    turned = "omega" if lead == "front" else "vy"
    for speed, rate in ((1e-5, 1e5), (1e-6, 1e6)):
        result = call(path, "accelerations", {"vx": speed, f"{turned}_rate": 1.0})
        assert result[f"{lead}.steer_rate"] == pytest.approx(rate, rel=1e-12)
    slower = call(path, "accelerations", {"vx": 1e-7, f"{turned}_rate": 1.0})[f"{lead}.steer_rate"]
    assert 0 < slower < 1e6


def test_steering_rate_is_the_closed_form(tmp_path: Path) -> None:
    """(vA x vA') / |vA|^2 of the pivot at (1, 0), away from standstill."""
    formula = derived(write(tmp_path, TRICYCLE.format(base=1.0)), "accelerations").formula("accelerations")
    result = formula.closed()["front.steer_rate"]
    a, b, a1, b1 = (signal(n) for n in ("vx", "omega", "vx_rate", "omega_rate"))
    moving = result.replace(
        lambda e: isinstance(e, sympy.Max), lambda e: max(e.args, key=lambda p: len(p.free_symbols))
    )
    assert sympy.simplify(moving - (a * b1 - b * a1) / (a**2 + b**2)) == 0
