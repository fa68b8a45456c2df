"""`setpoint`, `inverse` and `steer_toward` in a loop: joints keep their limits, no wheel slides, and what is wanted is
reached.

The oracle is time: no wanted twist takes longer than to brake, to swing each wheel by half
a turn one after the other, and to speed up.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest

from tests.functions.control.corners import MECANUM, SWERVE
from tests.laws.test_command_path import CAR, call
from tests.oracle.harness import named, twist_of
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.control.setpoint import CREEP

Case = dict[str, float]
DT = 0.02
SLIDES = 3 * float(CREEP)  # m/s: norm over the wheels
LIMITS = "limits: {spin: 30, spin_rate: 60, steer_rate: 8, steer: STOPS}"
STEPS = ("setpoint", "inverse", "forward", "steer_toward")


def robot(wheels: str, limits: str) -> str:
    return "\n".join(["wmrgen: 1", "name: tried", "wheels:", wheels, limits]) + "\n"


ROBOTS = {
    "swerve": robot(SWERVE, LIMITS.replace(", steer: STOPS", "")),
    "beside": robot(SWERVE.replace("}", ", offset_y: 0.02}"), LIMITS.replace(", steer: STOPS", "")),
    "stops": robot(SWERVE, LIMITS.replace("STOPS", "100 deg")),
    "mecanum": robot(MECANUM, "limits: {spin: 12, spin_rate: [-60, 30], vx_rate: 2}"),
    "car": CAR.format(heading=0, stops="[-35 deg, 35 deg]", rear=0).replace(
        "spin: 15}", "spin: 15, spin_rate: 20, steer_rate: 1}"
    ),
    "geared": robot(SWERVE.replace("}", ", per_steer: 0.7}"), LIMITS.replace(", steer: STOPS", "")),
}


def derived(name: str) -> Derivation:
    functions = [f for f in STEPS if f != "steer_toward" or name != "mecanum"]
    return of_text(ROBOTS[name], [*functions, *(["limit_twist"] if name == "car" else [])])


class Loop:
    """A robot that follows its commands at once."""

    def __init__(self, d: Derivation) -> None:
        self.d, self.twist = d, named((0.0, 0.0, 0.0))
        joints = ("spin", "steer", "steer_rate")
        self.commands = {f"{w.name}.{j}": 0.0 for w in d.robot.wheels for j in joints}

    def step(self, wanted: Case) -> Case:
        """The commands before; ``twist`` and ``commands`` are those after."""
        before = self.commands
        asked = {f"{name}_wanted": value for name, value in wanted.items()}
        self.twist = call(self.d, "setpoint", self.twist | asked | before | {"dt": DT})
        self.commands = before | call(self.d, "inverse", self.twist | before)
        if "steer_toward" in {f.name for f in self.d.module.functions}:
            asked = {f"{name}_wanted": value for name, value in self.commands.items()}
            self.commands |= call(self.d, "steer_toward", before | asked | {"dt": DT})
        return before


def rolls(d: Derivation, loop: Loop) -> None:
    """`forward` finds the twist, no wheel slides, and the contact of each moves with the body and its own swing."""
    found = call(d, "forward", loop.commands)
    assert found["slip"] <= SLIDES
    np.testing.assert_allclose(twist_of(found), twist_of(loop.twist), atol=5 * SLIDES)
    vx, vy, omega = twist_of(loop.twist)
    for w in d.robot.wheels:
        if w.kind.rollers:
            continue
        spin, steer, rate = (loop.commands[f"{w.name}.{j}"] for j in ("spin", "steer", "steer_rate"))
        e = np.exp(1j * (w.heading + steer))
        contact = complex(vx, vy) + 1j * omega * w.pivot + 1j * (omega + rate) * (1j * e * float(w.nominal.o))
        if w.commands("spin"):
            geared = float(w.nominal.r) * (spin - float(w.nominal.per_steer) * rate)
            assert abs(contact - geared * e) <= SLIDES, w.name
        else:
            assert abs((contact / e).imag) <= SLIDES, w.name


def within(d: Derivation, before: Case, commands: Case) -> None:
    """Every joint keeps its limits, and accelerations count without what steering turns of a wheel."""
    for w in d.robot.wheels:
        arm = float(w.working.steer_arm.constant or 0) / float(w.nominal.r) if w.kind.steers else 0.0
        spin, last = (
            joints[f"{w.name}.spin"] + arm * joints[f"{w.name}.steer_rate"] for joints in (commands, before)
        )
        steer = commands[f"{w.name}.steer"]
        found = {"spin": commands[f"{w.name}.spin"], "steer": steer}
        found["steer_rate"] = (steer - before[f"{w.name}.steer"]) / DT
        if w.commands("spin"):
            faster = abs(spin) > abs(last)
            found["spin_rate"] = abs(spin - last) / DT if faster else -abs(spin - last) / DT
        for joint, value in found.items():
            if (limit := d.robot.limit(w, joint)) is not None:
                slack = 1e-4 * (1 + abs(value))  # CREEP at a rim, and rounding
                if joint == "spin_rate" and spin * last < 0:  # through standstill: the faster of both at most
                    assert abs(value) <= max(float(limit.high), -float(limit.low)) + slack, (w.name, joint)
                else:
                    assert float(limit.low) - slack <= value <= float(limit.high) + slack, (w.name, joint)


def spins_full(d: Derivation, loop: Loop) -> bool:
    """A wheel is at its limit of spin, less what steering may take and twice what turning takes beside its axis."""
    for w in d.robot.wheels:
        limit, rate = d.robot.limit(w, "spin"), d.robot.limit(w, "steer_rate")
        if limit is None:
            continue
        arm = abs(float(w.working.steer_arm.constant or 0)) * float(rate.high if rate else 0)
        aside = 2 * abs(float(w.nominal.o) * loop.twist["omega"])
        spin = abs(loop.commands[f"{w.name}.spin"])
        if spin >= float(limit.high) * (1 - 1e-6) - (arm + aside) / float(w.nominal.r):
            return True
    return False


def wanted_twists(d: Derivation, name: str) -> Iterator[Case]:
    """Random twists, reversals, standstill, and turns about a wheel."""
    source = np.random.default_rng(len(name))
    turning = (1.0, 0.0, 0.3) if name == "car" else (1.0, 1.0, 2.0)
    for k, draw in enumerate(source.uniform(-1.0, 1.0, (5, 3))):
        pivot = d.robot.wheels[k % len(d.robot.wheels)].pivot
        about = (pivot.imag, -pivot.real, 1.0)
        for asked in (draw * turning, -draw * turning, about, draw * turning, (0.0, 0.0, 0.0)):
            twist = named(asked)
            yield call(d, "limit_twist", twist) if name == "car" else twist


@pytest.mark.parametrize("name", ROBOTS)
def test_every_twist_is_reached_inside_the_limits_and_without_slip(name: str) -> None:
    d = derived(name)
    loop = Loop(d)
    most = 2 * 60 + len(d.robot.wheels) * math.pi / (1.0 if name == "car" else 8.0) / DT
    for wanted in wanted_twists(d, name):
        steps, still = 0, 0
        while still < 2:
            before = loop.step(wanted)
            within(d, before, loop.commands)
            rolls(d, loop)
            still = still + 1 if before == loop.commands else 0
            steps += 1
            assert steps < most, (wanted, loop.twist)
        size = np.linalg.norm(twist_of(wanted))
        slower = np.linalg.norm(twist_of(loop.twist)) / size if size else 1.0
        np.testing.assert_allclose(twist_of(loop.twist), np.array(twist_of(wanted)) * slower, atol=1e-9)
        assert slower == pytest.approx(1.0) or spins_full(d, loop)
