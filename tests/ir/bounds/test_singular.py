"""A formula that is singular within the limits has no bound; header, report and model.json say so."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction

import pytest

import wmrgen
from tests.ir.bounds.gallery import NAMES, ROBOTS, proved
from wmrgen.derivation.emit import artifacts
from wmrgen.derivation.facade import Derivation
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.layout.records import Interval
from wmrgen.ir.bounds.robot import SINGULAR


def _derived(name: str, **limits: Fraction | int) -> Derivation:
    robot = wmrgen.load(ROBOTS[NAMES.index(name)])
    ends = {n: Interval(Exact(-v), Exact(v)) for n, v in limits.items()}
    wheels = tuple(replace(w, limits={}) for w in robot.wheels)
    return wmrgen.derive(replace(robot, limits={**robot.limits, **ends}, wheels=wheels))


@pytest.mark.parametrize("steer", [Fraction(3, 2), Fraction(8, 5)])
def test_a_bicycle_that_steers_across_has_no_bound_of_its_speed(steer: Fraction) -> None:
    """The rear wheel's spin says nothing of vx where the front wheel stands across: 86 degrees are fine, 92 are not."""
    derivation = _derived("bicycle", vx=2, omega=3, steer=steer)
    outputs = {f.name: {o.name: o for o in f.outputs} for f in derivation.bounds.functions}
    across = steer > Fraction(157, 100)
    assert outputs["forward"]["vx"].singular == outputs["forward"]["omega"].singular == across
    assert not any(o.singular for o in outputs["inverse"].values())
    files = artifacts(derivation)
    stored = json.loads(files["model.json"])["bounds"]["functions"]["forward"]["outputs"]["vx"]
    assert (stored == {"no_bound": SINGULAR}) == across
    header = " ".join(files["bicycle.h"].decode().replace("*", " ").split())
    assert (f"forward: vx, omega has no bound: {SINGULAR}" in header) == across
    assert (f"No bound for `vx`, `omega` of `forward`: {SINGULAR}" in files["numerics.md"].decode()) == across


def test_no_bound_is_larger_than_what_it_bounds() -> None:
    """Without limits of steering an angle's tangent is singular; the other outputs keep their bounds."""
    derivation = _derived("car_with_trailers", vx=2, omega=3, steer_rate=5)
    for f in derivation.bounds.functions:
        assert f.proved
        assert [o.name for o in f.outputs if o.singular] == (
            ["theta_rate"] if f.name in ("posture", "trailer") else []
        )
        for o in f.outputs:
            assert o.singular or o.error <= 1e-2 * max(-o.low, o.high)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_in_the_gallery_is_singular(name: str) -> None:
    """Except quotients by a time that may be 0: `limit_acceleration`, `setpoint`, steering rates of `steer_toward`."""
    for function, bound in proved(name).pairs:
        assert bound.proved
        for o in bound.outputs:
            rate = function.name == "steer_toward" and not o.name.endswith(".steer")
            if o.high > o.low:
                assert o.singular == (rate or function.name in ("limit_acceleration", "setpoint")), (
                    function.name,
                    o.name,
                )
