"""Accepted ranges of the inputs of checked functions, and their safe outputs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.ir.common import build
from wmrgen.codegen.c.checked import LARGEST, Range, ranges, safe
from wmrgen.geometry.ports import OVERSHOOT, Site
from wmrgen.ir.nodes import Function, Limits, Port, Role

UNITS = {
    "vx": "m/s",
    "omega": "rad/s",
    "dt": "s",
    "theta": "rad",
    "a.steer": "rad",
    "a.spin": "rad/s",
    "x": "m",
}
SITE = Site(
    {"vx": (-0.5, 1.5), "omega": (-3.0, 1.0), "a.steer": (-0.2, 0.6), "a.spin": (2.0, 10.0)},
    reach={"vx": (-0.9, 2.0), "omega": (-500.0, 1.25)},
)


def function(limits: Limits, roles: dict[str, Role] | None = None) -> Function:
    """Every input is an output."""
    f = build(tuple(UNITS), lambda b, at: dict(at), name="echo")
    ports = tuple(Port(n, (roles or {}).get(n, Role.COMMAND), unit, "") for n, unit in UNITS.items())
    return replace(
        f, inputs=ports, outputs=tuple(replace(p, role=Role.COMMAND) for p in ports), limits=limits
    )


def numbers(accepted: tuple[Range, ...]) -> dict[str, tuple[float, float]]:
    return {r.port.name: (float(r.low.rstrip("f")), float(r.high.rstrip("f"))) for r in accepted}


def test_without_limits_an_input_has_to_give_finite_results() -> None:
    for limits, site in ((Limits.ASKED, SITE), (Limits.MEASURED, Site())):
        single, double = (numbers(ranges(function(limits), scalar, site)) for scalar in ("float", "double"))
        assert single == {
            "vx": (-1e9, 1e9), "x": (-1e9, 1e9), "a.spin": (-1e9, 1e9), "theta": (-1e4, 1e4), "a.steer": (-1e4, 1e4),
            "omega": (-200, 200), "dt": (-10, 10),
        }  # fmt: skip
        assert double == {
            "vx": (-1e100, 1e100), "x": (-1e100, 1e100), "a.spin": (-1e100, 1e100), "theta": (-1e9, 1e9),
            "a.steer": (-1e9, 1e9), "omega": (-1e6, 1e6), "dt": (-100, 100),
        }  # fmt: skip
    assert LARGEST["float"] * 200 * 10 < 3.4e38, "and what a step multiplies stays a float"


def test_commands_keep_their_limits_and_what_is_measured_may_overshoot() -> None:
    """A joint may exceed its limits by a quarter of their half width, a twist may be any result of `forward`."""
    joints = {"a.steer": (-0.3, 0.7), "a.spin": (1.0, 11.0)}
    assert OVERSHOOT == 1.25
    for scalar in ("float", "double"):
        commanded = numbers(ranges(function(Limits.COMMANDED), scalar, SITE))
        measured = numbers(ranges(function(Limits.MEASURED), scalar, SITE))
        undeclared = numbers(ranges(function(Limits.NONE), scalar, SITE))
        for name, ends in joints.items():
            assert undeclared[name] == measured[name] == commanded[name] == pytest.approx(ends, rel=1e-6)
        assert undeclared["vx"][1] >= 1e9 and undeclared["omega"][1] >= 200
        assert (commanded["vx"], commanded["omega"]) == (SITE.limits["vx"], SITE.limits["omega"])
        assert measured["vx"] == pytest.approx(SITE.reach["vx"], rel=1e-6)
        assert measured["omega"] == (-200.0 if scalar == "float" else -500.0, 1.25), (
            "and within the size of inputs without limits"
        )
        assert commanded["dt"] == measured["dt"] and commanded["theta"][1] >= 1e4


def test_states_and_commands_are_checked_and_geometry_is_not() -> None:
    roles = {"vx": Role.STATE, "x": Role.GEOMETRY, "dt": Role.GEOMETRY}
    accepted = ranges(function(Limits.NONE, roles), "float", SITE)
    assert [r.port.name for r in accepted] == [n for n in UNITS if n not in ("x", "dt")]


def test_literals() -> None:
    site = Site({"a.spin": (0.0, 8.0), "a.steer": (-20000.0, 12345.0)})
    of = {r.port.name: (r.low, r.high) for r in ranges(function(Limits.MEASURED), "float", site)}
    assert of["theta"] == ("-1e4f", "1e4f")
    assert of["a.spin"] == ("-1.0f", "9.0f") and of["vx"] == ("-1e9f", "1e9f")
    assert of["a.steer"] == ("-24043.125f", "16388.125f")
    of = {
        r.port.name: (r.low, r.high)
        for r in ranges(function(Limits.COMMANDED), "double", Site({"vx": (0.0, 5e3)}))
    }
    assert of["vx"] == ("0.0", "5000.0") and of["x"] == ("-1e100", "1e100")


def test_angles_and_places_are_held_and_steering_keeps_its_limits() -> None:
    f = function(Limits.MEASURED)
    outputs = {s.port.name: s for s in safe(f, "float", SITE)}
    assert {name for name, s in outputs.items() if s.held} == {"theta", "a.steer", "x"}
    assert {name for name, s in outputs.items() if s.limit} == {"a.steer"}
    assert outputs["a.steer"].limit == ("-0.2f", "0.6f")
    other = replace(f, inputs=tuple(p for p in f.inputs if p.name != "x"))
    assert not {s.port.name: s for s in safe(other, "float", SITE)}["x"].held, (
        "nothing is known of where it was"
    )
