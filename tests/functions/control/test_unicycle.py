"""The unicycle in a robot: which point of it drives (v, 0, omega), which way is forward, and who has none."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tests.functions.common import call, derived, write
from tests.functions.refusals import refused
from wmrgen.functions.control.unicycle import reference
from wmrgen.functions.models.axle import Axle
from wmrgen.functions.registry import Reason


def pair(heading: str, x: float = 0.3, y: float = -0.1, turned: str = "0") -> str:
    """Two fixed wheels about (x, y) on one axle; ``turned``: the second one's heading less that of the first."""
    return (
        "wmrgen: 1\nname: pair\nwheels:\n"
        f"  - {{name: a, type: fixed, x: {x} - 0.2*sin({heading}), y: {y} + 0.2*cos({heading}), "
        f"heading: {heading}, r: 0.1}}\n"
        f"  - {{name: b, type: fixed, x: {x} + 0.2*sin({heading}), y: {y} - 0.2*cos({heading}), "
        f"heading: {heading} + {turned}, r: 0.1}}\n"
    )


def of(path: Path) -> Axle:
    d = derived(path)
    return reference(d.robot, d.mobility, "pursuit")


def numbers(ref: Axle) -> list[float]:
    return [float(p.constant or 0) for p in (ref.x, ref.y, ref.ex, ref.ey)]


@pytest.mark.parametrize("turned", ["0", "pi"])
@pytest.mark.parametrize(
    ("heading", "forward"),
    [
        ("0", 0), ("pi", 0), ("pi/6", 30), ("-5*pi/6", 30), ("pi/3", 60), ("-pi/3", -60), ("2*pi/3", -60),
        ("5*pi/6", -30), ("pi/2", 90), ("-pi/2", 90), ("3*pi/2", 90),
    ],
)  # fmt: skip
def test_forward_is_ahead_or_to_the_left(heading: str, forward: float, turned: str, tmp_path: Path) -> None:
    """However the wheels are mounted, the axle's middle drives along its forward direction."""
    path = write(tmp_path, pair(heading, turned=turned))
    angle = math.radians(forward)
    wanted = [0.3, -0.1, math.cos(angle), math.sin(angle)]
    assert numbers(of(path)) == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("function", ["pursuit", "goto_pose"])
@pytest.mark.parametrize(("heading", "about"), [("0", "pi"), ("pi/2", "-pi/2"), ("pi/3", "-2*pi/3")])
def test_wheels_half_a_turn_about_only_turn_the_other_way(
    function: str, heading: str, about: str, tmp_path: Path
) -> None:
    one, other = (write(tmp_path, pair(h)) for h in (heading, about))
    inputs = [p.name for p in derived(one, function).formula(function).inputs]
    values = {name: 0.3 + 0.2 * k for k, name in enumerate(inputs) if name != "direction"}
    first, second = call(one, function, values), call(other, function, values)
    renamed = {"a.spin": "b.spin", "b.spin": "a.spin"}
    for name, value in first.items():
        turned = -second[renamed[name]] if name in renamed else second[name]
        assert turned == pytest.approx(value, rel=1e-12, abs=1e-12), name


def test_without_a_fixed_wheel_it_is_the_centre_of_the_robot(tmp_path: Path) -> None:
    omni = "".join(
        f"  - {{name: w{k}, type: swedish, l: 0.2, alpha: {k}*2*pi/3, beta: 0, gamma: 0, r: 0.05}}\n"
        for k in range(3)
    )
    assert numbers(of(write(tmp_path, f"wmrgen: 1\nname: omni\nwheels:\n{omni}"))) == [0, 0, 1, 0]


def four(spins: tuple[str, ...], heading: str = "0") -> str:
    """Four fixed wheels on two axles, with these joints driven; the last one's heading may differ."""
    places = ((0.2, 0.3), (0.2, -0.3), (-0.4, 0.3), (-0.4, -0.3))
    wheels = "".join(
        f"  - {{name: w{k}, type: fixed, x: {x}, y: {y}, heading: {heading if k == 3 else 0}, r: 0.1, "
        f"actuated: [{j}]}}\n"
        for k, ((x, y), j) in enumerate(zip(places, spins, strict=True))
    )
    return f"wmrgen: 1\nname: four\nwheels:\n{wheels}"


def test_a_skid_steer_robot_drives_the_middle_of_its_wheels(tmp_path: Path) -> None:
    for spins in (("spin",) * 4, ("spin", "spin", "", "")):
        assert numbers(of(write(tmp_path, four(spins)))) == pytest.approx([-0.1, 0, 1, 0], abs=1e-12)


@pytest.mark.parametrize(
    ("spins", "heading"),
    [
        (("spin", "", "", ""), "0"),  # turning cannot be commanded
        (("", "", "", ""), "0"),
        (("spin", "", "spin", ""), "0"),  # nor by wheels on one side
        (("spin",) * 4, "pi/6"),  # not parallel
    ],
)
def test_who_cannot_skid_at_will_has_no_reference(
    spins: tuple[str, ...], heading: str, tmp_path: Path
) -> None:
    with refused(Reason.AXLES):
        of(write(tmp_path, four(spins, heading)))


def test_one_wheel_off_the_axle_is_enough_to_lock(tmp_path: Path) -> None:
    text = pair("0", 0, 0) + "  - {name: c, type: fixed, x: 1, y: 0, heading: pi/2, r: 0.1}\n"
    with refused(Reason.AXLES, "pursuit"):
        of(write(tmp_path, text))


def test_who_is_to_blame_is_said(tmp_path: Path) -> None:
    """Three steered wheels on one chain cannot turn the robot; with a fixed wheel beside them the axles cannot."""
    places = ((0.4, 0.3), (-0.5, 0.2), (0.1, -0.6))
    wheels = "".join(
        f"  - {{name: w{k}, type: steered, x: {x}, y: {y}, heading: 0, r: 0.1}}\n"
        for k, (x, y) in enumerate(places)
    )
    chain = "couplings: [{equal: [w0.spin, w1.spin, w2.spin]}]\n"
    head = "wmrgen: 1\nname: chain\nwheels:\n"
    with refused(Reason.COUPLINGS):
        of(write(tmp_path, head + wheels + chain))
    parallel = "".join(
        f"  - {{name: f{k}, type: fixed, x: {k}, y: 0.1, heading: {k} * pi/4, r: 0.1}}\n" for k in range(2)
    )
    with refused(Reason.AXLES):
        of(write(tmp_path, head + parallel))


@pytest.mark.parametrize("heading", ["0", "pi/6", "-2*pi/3"])
def test_goto_pose_drives_the_axle_where_it_stands_at_the_goal(heading: str, tmp_path: Path) -> None:
    """Polar coordinates of the axle's middle about its own place at the goal, along its direction there."""
    path = write(tmp_path, pair(heading, x=-0.3, y=0.2))
    ref = numbers(of(path))
    q, e = complex(*ref[:2]), complex(*ref[2:])
    for x, y, theta, way in (
        (-1.2, 0.4, 0.3, 1),
        (0.9, -0.7, 2.0, 1),
        (0.9, 0.2, 0.4, -1),
        (0.3, 1.5, -2.2, -1),
    ):
        out = call(path, "goto_pose", {"x": x, "y": y, "theta": theta, "direction": way})
        there = (complex(x, y) + q * complex(math.cos(theta), math.sin(theta)) - q) * e.conjugate()
        toward = math.atan2(*(-way * v for v in (there.imag, there.real)))
        alpha, beta = math.remainder(toward - theta, math.tau), math.remainder(-toward, math.tau)
        wanted = {"rho": abs(there), "alpha": alpha, "beta": beta, "v": way * 3 * abs(there)}
        wanted |= {"omega": 8 * alpha - 1.5 * beta, "direction": way}
        assert {name: out[name] for name in wanted} == pytest.approx(wanted, abs=1e-9)
    still = call(path, "goto_pose", {})
    assert still["rho"] == still["v"] == still["omega"] == 0
