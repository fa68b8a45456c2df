"""Steering limits: of all angles inside them the wheels take one that slides least, or keep their heading near it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.analysis.mobility.test_couplings import wheel
from tests.laws.common import derived, law
from tests.laws.layouts import decimals
from tests.oracle import oracle
from tests.oracle.harness import named
from tests.oracle.stops import right
from wmrgen.errors import RobotFileError

Layout = dict[str, Any]
twists = st.tuples(decimals(-2, 2), decimals(-2, 2), decimals(-3, 3))
places = st.tuples(decimals(-0.9, 0.9), decimals(-0.9, 0.9), decimals(-3, 3, 1))
limits = st.tuples(
    st.integers(-200, 120), st.sampled_from([20, 85, 95, 120, 150, 170, 179, 180, 181, 200, 350])
)


def robot(wheels: list[tuple[float, float, float]], interval: tuple[int, int], coupled: bool) -> Layout:
    """Steered wheels at (x, y, heading) with one interval (low, width) [deg] for all."""
    found = [
        wheel(f"w{i}", "steered", x, y) | {"heading": h, "limits": {"steer": interval}}
        for i, (x, y, h) in enumerate(wheels)
    ]
    return {"wheels": found, "couplings": [("steer", [w["name"] for w in found])] if coupled else []}


def sliding(layout: Layout, wheels: list[Any], twist: Any, angle: Any) -> Any:
    """Sum of the squared lateral speeds of ``wheels`` at a common joint angle."""
    total = 0.0
    for w in wheels:
        a, b = oracle.point_velocity(np.array([w["x"], w["y"]]), np.asarray(twist, float))
        h = w["heading"] + angle
        total = total + (b * np.cos(h) - a * np.sin(h)) ** 2
    return total


def least(layout: Layout, wheels: list[Any], twist: Any) -> float:
    """The angle at which they slide least: a - b cos 2t - c sin 2t, from three angles."""
    a, b, c = (sliding(layout, wheels, twist, t) for t in (0.0, math.pi / 4, math.pi / 2))
    mean = (a + c) / 2
    return math.atan2(mean - b, mean - a) / 2


def driven(layout: Layout, twist: Any) -> Any:
    """Wheels with equal headings on one motor cannot turn the robot: the velocity of their centroid is driven."""
    wheels = layout["wheels"]
    if not layout["couplings"] or any(math.sin(w["heading"] - wheels[0]["heading"]) for w in wheels):
        return np.asarray(twist, float)
    centre = np.mean([[w["x"], w["y"]] for w in wheels], axis=0)
    return np.array([*oracle.point_velocity(centre, np.asarray(twist, float)), 0.0])


def check(layout: Layout, groups: list[list[Any]], twist: Any, present: float) -> None:
    """``present`` in [0, 1]: from one limit to the other."""
    low, width = (math.radians(v) for v in layout["wheels"][0]["limits"]["steer"])
    now = low + present * width
    model = derived(layout)
    steers = {f"{w['name']}.steer": now for w in layout["wheels"]}
    found = model.call("inverse", named(twist) | steers)
    twist = driven(layout, twist)
    for wheels in groups:
        angle = found[f"{wheels[0]['name']}.steer"]
        assert low - 1e-12 <= angle <= low + width + 1e-12
        slides = sliding(layout, wheels, twist, angle)
        best = least(layout, wheels, twist)
        stops = [sliding(layout, wheels, twist, t) for t in right(best, low, low + width, now, 1e-9)]
        assert min(stops) - 1e-8 <= slides <= max(stops) + 1e-8
        for w in wheels:
            along = oracle.row(*oracle.geometry(w, angle)[::2]) @ twist
            assert found[f"{w['name']}.spin"] == pytest.approx(along / w["r"], abs=1e-9)


@law(40)
@given(st.lists(places, min_size=2, max_size=2, unique=True), limits, twists, decimals(0, 1, 2))
def test_a_lone_wheel_slides_least(wheels: Any, interval: Any, twist: Any, present: float) -> None:
    layout = robot(wheels, interval, coupled=False)
    check(layout, [[w] for w in layout["wheels"]], twist, present)


@law(40)
@given(st.lists(places, min_size=2, max_size=4, unique=True), limits, twists, decimals(0, 1, 2))
def test_a_coupled_group_slides_least(wheels: Any, interval: Any, twist: Any, present: float) -> None:
    layout = robot(wheels, interval, coupled=True)
    check(layout, [layout["wheels"]], twist, present)


def test_a_group_at_its_limit_takes_the_opposite_heading() -> None:
    """From its upper limit the nearest heading lies beyond it; the opposite one is inside."""
    layout = robot([(0.3, 0.2, 0.0), (-0.3, 0.2, 0.2)], (-80, 160), coupled=True)
    check(layout, [layout["wheels"]], (-0.3, 1.0, 0.1), 1.0)


def test_a_lone_wheel_takes_the_nearer_stop() -> None:
    """A line at 61 degrees between stops at -60 and 60: the stop at 60, wherever the wheel stands."""
    layout = robot([(0.3, 0.0, 0.0), (-0.3, 0.0, 0.0)], (-60, 120), coupled=False)
    for present in (0.0, 0.25, 1.0):
        check(layout, [[w] for w in layout["wheels"]], (math.cos(1.0647), math.sin(1.0647), 0.0), present)


PAIR = [wheel("a", "steered", 0.3, 0.2), wheel("b", "steered", -0.3, 0.2)]


def coupled(*limits: tuple[int, int]) -> Layout:
    """Two steered wheels on one motor, each with its interval (low, width) [deg]."""
    wheels = [w | {"limits": {"steer": interval}} for w, interval in zip(PAIR, limits, strict=True)]
    return {"wheels": wheels, "couplings": [("steer", ["a", "b"])]}


@pytest.mark.parametrize("limits", [((-90, 135), (-45, 135)), ((-45, 135), (-90, 135))])
def test_coupled_wheels_keep_the_limits_of_all(limits: tuple[tuple[int, int], ...]) -> None:
    model = derived(coupled(*limits))
    for vy in (1.0, -1.0):
        joints = model.call("inverse", {"vx": 0.1, "vy": vy})
        assert joints["a.steer"] == joints["b.steer"] == pytest.approx(vy * math.pi / 4)
        assert joints["slip"] > 0.5


def test_coupled_wheels_without_a_common_angle_are_refused() -> None:
    with pytest.raises(RobotFileError) as caught:
        derived(coupled((-45, 45), (10, 35)))
    assert caught.value.code == "WMR109" and {"a", "b", "steer"} <= {*caught.value.what.split()}
    assert caught.value.mark and "equal: [a.steer, b.steer]" in caught.value.mark.text
