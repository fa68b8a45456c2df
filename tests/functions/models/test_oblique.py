"""Models of robots that stand obliquely and off the centre in their frame: what the wheels do is what they ask for."""

from __future__ import annotations

import math
import random

import pytest

from tests.functions.models.robots import call, derived
from tests.functions.refusals import refused as refuses
from tests.robots import of_text
from wmrgen.functions.registry import Reason

TURN = "pi/6"
CASTOR = ("k", "castor", -0.7, 0.1, "0", "d: 0.1, actuated: []")
REAR = [("rl", "fixed", -0.4, 0.3, "0", ""), ("rr", "fixed", -0.4, -0.3, "pi", "")]
FRONT = [("fl", "steered", 0.5, 0.3, "0", ""), ("fr", "steered", 0.5, -0.3, "0", "")]
CRAB = [("ahead", "steered", 0.4, 0.1, "0", ""), ("behind", "steered", -0.3, -0.2, "pi/4", "offset_y: 0.05")]
PAIR = [("one", "fixed", 0.0, 0.3, "0", ""), ("two", "fixed", 0.0, -0.3, "0", "")]
PSI = "virtual: [{name: psi, steers: [fl, fr]}]"


def wheels(rows: list[tuple[str, str, float, float, str, str]]) -> str:
    """Wheels that are placed in a frame at (0.2, -0.1) turned by 30 degrees."""
    return "\n".join(
        f"{{name: {name}, type: {kind}, x: {place(x, y)[0]}, y: {place(x, y)[1]}, heading: {TURN} + {heading}, r: 0.1"
        + (f", {more}}}" if more else "}")
        for name, kind, x, y, heading, more in rows
    )


def place(x: float, y: float) -> tuple[str, str]:
    return f"0.2 + {x}*cos({TURN}) - ({y})*sin({TURN})", f"-0.1 + {x}*sin({TURN}) + {y}*cos({TURN})"


@pytest.mark.parametrize(
    ("rows", "extra"),
    [
        (PAIR, ""),
        ([*PAIR, CASTOR], ""),
        (REAR + FRONT, ""),
        (REAR + FRONT, PSI),
        ([*REAR, *FRONT, CASTOR], ""),
        (CRAB, ""),
        ([*CRAB, ("third", "steered", -0.5, 0.4, "0", "")], ""),
    ],
    ids=["axle", "castor", "car", "virtual", "car and castor", "crab", "three steered"],
)
def test_the_rates_of_a_model_ask_for_themselves(
    rows: list[tuple[str, str, float, float, str, str]], extra: str
) -> None:
    """No wheel slides under the twist of the model, and inverse commands the rates of the joints that it has."""
    d = derived(wheels(rows), extra)
    system = d.system("configuration")
    chance = random.Random(6)
    for _ in range(3):
        values = {p.name: chance.uniform(0.1, 0.5) for p in (*system.state, *system.inputs)}
        values |= {p.name: 0.0 for p in system.inputs if p.name.endswith("steer_rate")}
        rates = call(d, "configuration", values)
        theta = values["theta"]
        vx, vy = rates["x_rate"], rates["y_rate"]
        twist = {
            "vx": vx * math.cos(theta) + vy * math.sin(theta),
            "vy": vy * math.cos(theta) - vx * math.sin(theta),
            "omega": rates["theta_rate"],
        }
        assert max(map(abs, twist.values())) > 1e-3
        angles = {f"{w.name}.steer": values.get(f"{w.name}.steer", 0.0) for w in d.robot.wheels if w.turns}
        if "psi.steer" in values:
            angles |= call(d, "virtual_steering", {"psi.steer": values["psi.steer"]})
        joints = call(d, "inverse", twist | angles)
        assert joints["slip"] == pytest.approx(0, abs=1e-9)
        for w in d.robot.wheels:
            if f"{w.name}.spin" in rates and f"{w.name}.spin" in joints:
                assert abs(rates[f"{w.name}.spin"]) == pytest.approx(
                    abs(joints[f"{w.name}.spin"]), abs=1e-9
                ), w.name
            if w.kind.swivels and f"{w.name}.steer_rate" in joints:
                assert rates[f"{w.name}.steer_rate"] == pytest.approx(
                    joints[f"{w.name}.steer_rate"], abs=1e-9
                )


@pytest.mark.parametrize("angle", [-0.6, -0.1, 0.0, 0.2, 0.7])
def test_virtual_and_real_angles_lead_back_to_each_other(angle: float) -> None:
    d = derived(wheels(REAR + FRONT), PSI)
    real = call(d, "virtual_steering", {"psi.steer": angle})
    lead = {p.name: real[p.name] for p in d.formula("virtual_angle").inputs}
    assert call(d, "virtual_angle", lead) == pytest.approx({"psi.steer": angle}, abs=1e-12)
    if angle:  # the Ackermann condition
        left, right = (1 / math.tan(real[f"{n}.steer"]) for n in ("fl", "fr"))
        assert right - left == pytest.approx(0.6 / 0.9)


@pytest.mark.parametrize(("x", "refused"), [(-0.4, True), (-0.4 + 1e-6, False), (-0.41, False), (0.3, False)])
@pytest.mark.parametrize("y", [0.0, 0.2, -0.7])
def test_a_virtual_wheel_stands_off_the_axle_line(x: float, y: float, refused: bool) -> None:
    """Wherever on the line, in whatever frame."""
    px, py = place(x, y)
    items = "\n".join(f"  - {line}" for line in wheels(REAR + FRONT).splitlines())
    text = f"virtual: [{{name: psi, steers: [fl, fr], x: {px}, y: {py}}}]"
    d = of_text(f"wmrgen: 1\nname: sample\nwheels:\n{items}\n{text}\n")
    if refused:
        with refuses(Reason.ACKERMANN, "psi"):
            d.formula("virtual_steering")
    else:
        assert d.formula("virtual_steering").outputs


@pytest.mark.parametrize("extra", ["", PSI], ids=["real", "virtual"])
def test_a_wheel_that_follows_rolls_with_its_own_steering_rate(extra: str) -> None:
    """r spin = v . e - o (omega + steering rate) of a wheel with offset o; the rate by differences of its angle."""
    follower = ("fr", "steered", 0.5, -0.3, "0", "offset_y: 0.05")
    d = derived(wheels([*REAR, FRONT[0], follower]), extra)
    system = d.system("configuration")
    lead = "psi.steer" if extra else "fl.steer"
    w = d.robot.wheel("fr")
    x, y = float(w.nominal.x), float(w.nominal.y)
    values = dict.fromkeys((p.name for p in (*system.state, *system.inputs)), 0.0)
    values |= {lead: 0.3, f"{lead}_rate": 0.7, "rl.spin": 2.0}

    def of(steer: float) -> tuple[dict[str, float], complex, float]:
        """Rates, the velocity of the pivot, and the angle of the wheel that follows."""
        rates = call(d, "configuration", values | {lead: steer})
        omega = rates["theta_rate"]
        velocity = complex(rates["x_rate"] - omega * y, rates["y_rate"] + omega * x)
        heading = math.atan2(velocity.imag, velocity.real) - w.heading
        return rates, velocity, math.remainder(heading, math.pi)

    rates, velocity, angle = of(0.3)
    h = 1e-6
    rate = 0.7 * (of(0.3 + h)[2] - of(0.3 - h)[2]) / (2 * h)
    along = (velocity * complex(math.cos(w.heading + angle), -math.sin(w.heading + angle))).real
    wanted = (along - 0.05 * (rates["theta_rate"] + rate)) / 0.1
    assert rates["fr.spin"] == pytest.approx(wanted, abs=1e-6) and abs(rate) > 0.1
