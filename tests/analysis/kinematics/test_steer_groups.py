"""Wheels on one steering motor or one chain, against every angle: least sliding, limits, and turning the same way."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Sequence
from functools import cache

import pytest

from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.ir.interpret import FLOAT64, evaluate_module

Case = dict[str, float]
# Name -> x, y [m], heading [deg], r [m], type.
PLACES = {
    "a": (0.4, 0.3, 0, 0.1, "steered"),
    "b": (-0.5, 0.2, 30, 0.1, "steered"),
    "c": (0.1, -0.6, -45, 0.1, "steered"),
    "d": (-0.2, -0.3, 0, 0.1, "fixed"),
    "e": (-0.3, 0.5, 0, 0.1, "steered"),
}


@cache
def derived(names: str, couplings: str = "", limits: str = "") -> Derivation:
    """The wheels ``names``; ``limits`` of all that steer."""
    lines = [
        f"  - {{name: {n}, type: {t}, x: {x}, y: {y}, heading: {h} deg, r: {r}}}"
        for n, (x, y, h, r, t) in PLACES.items()
        if n in names
    ]
    text = "\n".join(["wmrgen: 1", "name: sample", "wheels:", *lines, f"couplings: [{couplings}]", limits])
    return of_text(text)


def velocity(name: str, twist: Sequence[float]) -> complex:
    """Of the pivot, in the robot frame [m/s]."""
    x, y, *_ = PLACES[name]
    return complex(twist[0] - twist[2] * y, twist[1] + twist[2] * x)


def seen(name: str, twist: Sequence[float], steer: float) -> complex:
    """The same along and across the wheel."""
    return velocity(name, twist) * cmath.exp(-1j * (math.radians(PLACES[name][2]) + steer))


def cases(d: Derivation, count: int) -> list[tuple[list[float], dict[str, float]]]:
    chance = random.Random(11)
    steered = [w.name for w in d.robot.wheels if w.kind.steers]
    return [
        ([chance.uniform(-1, 1) for _ in range(3)], {n: chance.uniform(-3, 3) for n in steered})
        for _ in range(count)
    ]


def inverse(d: Derivation, twist: Sequence[float], now: dict[str, float]) -> Case:
    case = dict(zip(("vx", "vy", "omega"), twist, strict=True)) | {f"{n}.steer": v for n, v in now.items()}
    return {k: float(v) for k, v in evaluate_module(d.raw_module, "inverse", case, FLOAT64).items()}


@pytest.mark.parametrize("names", ["ab", "bc", "abc"])
def test_a_chain_turns_steered_wheels_the_same_way_round(names: str) -> None:
    """Each rolls along its pivot's velocity; the first takes its nearer heading, the rest the one that goes with it.

    Three on a chain cannot turn the robot.
    """
    d = derived(names, f"{{equal: [{', '.join(f'{n}.spin' for n in names)}]}}")
    for twist, now in cases(d, 40):
        twist[2] *= len(names) < 3
        out = inverse(d, twist, now)
        along = {n: seen(n, twist, out[f"{n}.steer"]) for n in names}
        for n, v in along.items():
            assert abs(v.imag) < 1e-9 and v.real * along[names[0]].real > 0, n
            assert (
                abs(out[f"{n}.steer"] - now[n]) <= (math.pi / 2 if n == names[0] else 3 * math.pi / 2) + 1e-9
            )
        mean = sum(v.real for v in along.values()) / len(names)
        assert all(out[f"{n}.spin"] == pytest.approx(mean / 0.1, rel=1e-9) for n in names)


def test_wheels_without_a_chain_take_their_nearer_heading() -> None:
    d, opposed = derived("abc"), 0
    for twist, now in cases(d, 40):
        out = inverse(d, twist, now)
        along = [seen(n, twist, out[f"{n}.steer"]) for n in "abc"]
        assert all(abs(out[f"{n}.steer"] - now[n]) <= math.pi / 2 + 1e-9 for n in "abc")
        assert all(abs(v.imag) < 1e-9 for v in along)
        assert [out[f"{n}.spin"] for n in "abc"] == pytest.approx([v.real / 0.1 for v in along])
        opposed += len({v.real > 0 for v in along}) > 1
    assert opposed > 10, "so the chain above has something to turn"


@pytest.mark.parametrize("names", ["ad", "abd"])
def test_a_fixed_wheel_decides_which_way_the_chain_runs(names: str) -> None:
    d = derived(names, f"{{equal: [{', '.join(f'{n}.spin' for n in names)}]}}")
    reversed_ = 0
    for twist, now in cases(d, 40):
        twist[1] = 0.2 * twist[2]  # which the fixed wheel allows
        out = inverse(d, twist, now)
        along = {n: seen(n, twist, out.get(f"{n}.steer", 0.0)) for n in names}
        assert all(abs(v.imag) < 1e-9 for v in along.values())
        assert all(v.real * along["d"].real > 0 for v in along.values())
        reversed_ += abs(out["a.steer"] - now["a"]) > math.pi / 2 + 1e-9
    assert 5 < reversed_ < 35


@pytest.mark.parametrize(
    ("limits", "room"), [("[-1.9, 1.9]", False), ("[-3, 3]", False), ("[-3.15, 3.15]", True)]
)
def test_a_chain_turns_wheels_as_far_as_their_limits_let_it(limits: str, room: bool) -> None:
    d = derived("ab", "{equal: [a.spin, b.spin]}", f"limits: {{steer: {limits}}}")
    end = float(limits.split(",")[1].strip(" ]"))
    alike = both = 0
    for twist, now in cases(d, 60):
        out = inverse(d, twist, {n: max(-end, min(end, v)) for n, v in now.items()})
        assert all(abs(out[f"{n}.steer"]) <= end + 1e-9 for n in "ab")
        if abs(seen("a", twist, out["a.steer"]).imag) + abs(seen("b", twist, out["b.steer"]).imag) > 1e-9:
            continue  # at a limit
        both += 1
        va, vb = (seen(n, twist, out[f"{n}.steer"]).real for n in "ab")
        back = min(abs(out["b.steer"] + k * math.pi) for k in (-1, 1))
        assert va * vb > 0 or back > end, "there is room for the other heading"
        alike += va * vb > 0
    assert both > 20 and (alike == both if room else alike < both)


def sliding(names: str, twist: Sequence[float], offset: float) -> float:
    """Sum of squares of the lateral speeds of wheels at one joint angle."""
    return sum(seen(n, twist, offset).imag ** 2 for n in names)


GRID = [k * math.pi / 720 for k in range(-1440, 1441)]


@pytest.mark.parametrize("names", ["ab", "abc"])
@pytest.mark.parametrize("limits", ["", "0.5", "1.2", "[-0.3, 1.9]", "1.7", "3"])
def test_one_motor_takes_the_angle_of_least_sliding(names: str, limits: str) -> None:
    d = derived(
        names,
        f"{{equal: [{', '.join(f'{n}.steer' for n in names)}]}}",
        f"limits: {{steer: {limits}}}" if limits else "",
    )
    limit = d.robot.limit(d.robot.wheels[0], "steer")
    low, high = (float(limit.low), float(limit.high)) if limit else (-10.0, 10.0)
    for twist, now in cases(d, 25):
        out = inverse(d, twist, dict.fromkeys(names, now[names[0]]))  # beyond the limits, too
        steer = out[f"{names[0]}.steer"]
        assert low - 1e-9 <= steer <= high + 1e-9
        assert all(out[f"{n}.steer"] == pytest.approx(steer, abs=1e-12) for n in names)
        least = min(sliding(names, twist, angle) for angle in [*GRID, low, high] if low <= angle <= high)
        assert sliding(names, twist, steer) <= least + 1e-9
        if not limits:
            assert abs(steer - now[names[0]]) <= math.pi / 2 + 1e-9
        for n in names:
            assert out[f"{n}.spin"] == pytest.approx(seen(n, twist, steer).real / 0.1, abs=1e-9)


def test_parallel_wheels_on_one_motor_are_one() -> None:
    """They cannot turn the robot; each rolls where it drives, on the nearer heading."""
    d = derived("ae", "{equal: [a.steer, e.steer]}")
    for (vx, vy, _), now in cases(d, 20):
        out = inverse(d, (vx, vy, 0.0), dict.fromkeys("ae", now["a"]))
        assert out["a.steer"] == out["e.steer"] and abs(out["a.steer"] - now["a"]) <= math.pi / 2 + 1e-9
        along = seen("a", (vx, vy, 0.0), out["a.steer"])
        assert abs(along.imag) < 1e-9 and out["slip"] < 1e-9
        assert [out["a.spin"], out["e.spin"]] == pytest.approx([along.real / 0.1] * 2)


def test_wheels_of_a_synchro_drive_turn_as_their_own_radii_say() -> None:
    """One belt steers all, so that their pivots move alike: the rims move at that speed, whatever the radii."""
    rows = [("a", 0.3, 0.2, 0.05), ("b", 0.3, -0.2, 0.1), ("c", -0.4, 0.0, 0.2)]
    wheels = "\n".join(
        f"  - {{name: {n}, type: steered, x: {x}, y: {y}, heading: 0, r: {r}}}" for n, x, y, r in rows
    )
    d = of_text(
        f"wmrgen: 1\nname: belt\nwheels:\n{wheels}\ncouplings: [{{equal: [a.steer, b.steer, c.steer]}}]\n"
    )
    found = inverse(d, [0.3, 0.4, 0.0], dict.fromkeys("abc", 0.9))
    assert [found[f"{n}.spin"] * r for n, _, _, r in rows] == pytest.approx([0.5] * 3)
    assert found["slip"] == pytest.approx(0, abs=1e-12)
