"""`desaturate`: limits kept, path kept."""

from __future__ import annotations

import random

import pytest

from tests.functions.control.corners import (
    CORNERS,
    FLOAT32,
    MECANUM,
    SWERVE,
    call,
    derived,
    robot_text,
    twists,
)
from tests.functions.refusals import missing_names, refused
from wmrgen.codegen.c.checked import ranges
from wmrgen.functions.registry import Reason, UnderivableError
from wmrgen.geometry.ports import Site
from wmrgen.ir.bounds.robot import data, header_lines
from wmrgen.ir.rounding import nearest_float32

LIMIT = 12.3


@pytest.mark.parametrize("wheels", [MECANUM, SWERVE], ids=["mecanum", "swerve"])
def test_the_twist_is_scaled(wheels: str) -> None:
    d = derived(robot_text(wheels, f"limits: {{spin: {LIMIT}}}"), "desaturate")
    scaled = 0
    for twist in twists(60):
        asked = call(d, "inverse", {**twist, **{f"{n}.steer": 0.2 for n in CORNERS}})
        kept = call(d, "desaturate", asked)
        peak = max(abs(asked[f"{n}.spin"]) for n in CORNERS)
        assert kept["scale"] == pytest.approx(min(1.0, LIMIT / peak), rel=1e-14)
        scaled += kept["scale"] < 1
        driven = call(d, "forward", {**asked, **kept})
        for name, value in twist.items():
            assert driven[name] == pytest.approx(kept["scale"] * value, abs=1e-12)
    assert 20 < scaled <= 60


def test_limits_hold_to_the_last_bit_in_float() -> None:
    d = derived(robot_text(MECANUM, "limits: {spin: [-11.7, 12.3]}"), "desaturate")
    source = random.Random(3)
    low, high = nearest_float32(-11.7), nearest_float32(12.3)
    reached = 0
    for _ in range(400):
        size = 10.0 ** source.uniform(-3, 9)
        kept = call(d, "desaturate", {f"{n}.spin": source.uniform(-size, size) for n in CORNERS}, FLOAT32)
        assert all(low <= kept[f"{n}.spin"] <= high for n in CORNERS)
        reached += any(kept[f"{n}.spin"] in (low, high) for n in CORNERS)
    assert reached > 200


def test_nothing_changes_inside_the_limits() -> None:
    d = derived(robot_text(MECANUM, f"limits: {{spin: {LIMIT}}}"), "desaturate")
    asked = {"fl.spin": 12.25, "fr.spin": -1.5, "bl.spin": 0.0, "br.spin": -12.25}
    assert call(d, "desaturate", asked, FLOAT32) == {**asked, "scale": 1.0}


def test_each_wheel_has_its_own_limit() -> None:
    wheels = MECANUM.replace("r: 0.1}", "r: 0.1, limits: {spin: 5}}", 1)
    d = derived(robot_text(wheels, "limits: {spin: 20}"), "desaturate")
    asked = dict.fromkeys((f"{n}.spin" for n in CORNERS), 10.0)
    assert call(d, "desaturate", asked)["scale"] == 0.5


@pytest.mark.parametrize(("asked", "scale"), [(-8.0, 0.5), (-4.0, 1.0), (8.0, 1.0), (40.0, 0.5)])
def test_each_side_has_its_own_limit(asked: float, scale: float) -> None:
    """Backwards a wheel may turn at 4 rad/s, forwards at 20; the others are scaled along."""
    d = derived(robot_text(MECANUM, "limits: {spin: [-4, 20]}"), "desaturate")
    rates = {"fl.spin": asked, "fr.spin": 2.0, "bl.spin": -1.0, "br.spin": 0.0}
    assert call(d, "desaturate", rates) == {k: v * scale for k, v in rates.items()} | {"scale": scale}


def test_a_rate_rounded_beyond_its_lower_limit_is_cut() -> None:
    """In float both limits hold to the last bit, each for itself."""
    for low, high in ((-11.7, 1e3), (-1e3, 11.7)):
        d = derived(robot_text(MECANUM, f"limits: {{spin: [{low}, {high}]}}"), "desaturate")
        source, side = random.Random(4), -1 if low == -11.7 else 1
        end = nearest_float32(11.7)
        reached = 0
        for _ in range(300):
            asked = dict.fromkeys((f"{n}.spin" for n in CORNERS), 0.0)
            kept = call(d, "desaturate", asked | {"fl.spin": side * source.uniform(11.7, 1e5)}, FLOAT32)
            assert abs(kept["fl.spin"]) <= end
            reached += abs(kept["fl.spin"]) == end
        assert reached > 100


def test_castors_turn_along() -> None:
    wheels = (
        "  - {name: fl, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.1}\n"
        "  - {name: fr, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.1}\n"
        "  - {name: tail, type: castor, x: -0.3, y: 0, d: 0.05, r: 0.04, limits: {steer_rate: 3}}"
    )
    d = derived(robot_text(wheels, "limits: {spin: 20}"), "desaturate")
    asked = {"fl.spin": 1.0, "fr.spin": 1.0, "tail.spin": 2.0, "tail.steer_rate": -6.0}
    assert call(d, "desaturate", asked) == {k: v / 2 for k, v in asked.items()} | {"scale": 0.5}


def test_the_limit_of_the_robot_is_not_that_of_a_passive_wheel() -> None:
    """A small castor turns eight times as fast as the wheels that are driven, and holds nothing back."""
    wheels = (
        "  - {name: fl, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.2}\n"
        "  - {name: fr, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.2}\n"
        "  - {name: tail, type: castor, x: -0.3, y: 0, d: 0.05, r: 0.025}"
    )
    d = derived(robot_text(wheels, "limits: {vx: 1.2, spin: 15, steer_rate: 1}"), "desaturate")
    asked = call(d, "inverse", {"vx": 1.2, "vy": 0.0, "omega": 0.0, "tail.steer": 1.0})
    del asked["slip"]
    assert asked["tail.spin"] > 15 and asked["tail.steer_rate"] > 1
    assert call(d, "desaturate", asked) == {**asked, "scale": 1.0}


def test_what_inverse_asks_beyond_the_limits_is_what_it_is_for() -> None:
    """Bounds are about all that `inverse` gives within the limits of the twist; checked code refuses nothing of it."""
    text = robot_text(MECANUM, "functions: [desaturate]", "limits: {vx: 1, vy: 1, omega: 2, spin: 8}")
    d = derived(text, "desaturate")
    inverse, scaling = (next(f for f in d.bounds.functions if f.name == n) for n in ("inverse", "desaturate"))
    asked = {o.name: (o.low, o.high) for o in inverse.outputs}
    assert asked["fl.spin"][1] > 20
    assert scaling.inputs == {f"{n}.spin": asked[f"{n}.spin"] for n in CORNERS}
    assert all(7.99 < o.high < 8.01 for o in scaling.outputs if o.name != "scale")
    assert next(o.low for o in scaling.outputs if o.name == "scale") < 0.4
    assert "desaturate is looked at for |fl.spin" in "\n".join(header_lines(d.bounds))
    assert list(data(d.bounds)["functions"]["desaturate"]["inputs"]) == [f"{n}.spin" for n in CORNERS]
    site = Site(dict.fromkeys(asked, (-8.0, 8.0)))
    scaled = next(f for f in d.c_module.functions if f.name == "desaturate")
    assert {(r.low, r.high) for r in ranges(scaled, "float", site)} == {("-1e9f", "1e9f")}


@pytest.mark.parametrize(
    ("limits", "reason", "names"),
    [
        ("", Reason.NO_LIMIT, ("fl", "fr", "bl", "br", "spin: 40")),
        ("limits: {spin: [0, 4]}", Reason.ONE_SIDED_LIMIT, ("fl.spin",)),
    ],
)
def test_what_is_missing_is_named(limits: str, reason: Reason, names: tuple[str, ...]) -> None:
    with refused(reason, *names):
        _ = derived(robot_text(MECANUM, limits), "desaturate").program


def test_one_wheel_without_a_limit_is_named() -> None:
    three = MECANUM.replace("}", ", limits: {spin: 4}}", 3)
    with pytest.raises(UnderivableError) as caught:
        _ = derived(robot_text(three), "desaturate").program
    assert caught.value.reason is Reason.NO_LIMIT
    assert missing_names(caught.value, tuple(CORNERS)) == [n for n in CORNERS if n != "br"]


def test_room_for_steering_beside_the_axis() -> None:
    """What `steer_toward` adds of its own, 0.02 / 0.05 * 3 rad/s, stays free of the limit of spin."""
    beside = SWERVE.replace("r: 0.05}", "r: 0.05, offset_y: 0.02}")
    text = robot_text(beside, "limits: {spin: 8, steer_rate: [-2, 3]}")
    d = derived(text, "desaturate", "steer_toward")
    fast = {f"{n}.spin": 50.0 for n in CORNERS}
    assert call(d, "desaturate", fast)["fl.spin"] == pytest.approx(8 - 1.2)
    with refused(Reason.LIMIT_TOO_NARROW, "fl", "1.2 rad/s"):
        _ = derived(robot_text(beside, "limits: {spin: 1, steer_rate: 3}"), "desaturate").program
