"""Counts of encoders to joint rates and angles, and what a robot file may say of encoders."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tests.functions.refusals import mistaken, refused
from tests.oracle.harness import robot_text
from tests.oracle.weighted import LAYOUTS
from tests.robots import of_text
from wmrgen import derive, load
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code
from wmrgen.functions.registry import Reason
from wmrgen.ir.kernels.choice import Choice

NAME = "joints_from_counts"
WHEEL = "{{name: {0}, type: {1}, x: {2}, y: 0, heading: 0, r: 0.1, encoder: {{{3}}}, {4}}}"
SPIN = "spin: {counts: 4096, gear: 61/2, reversed: true, bits: 16}"
STEER = "steer: {counts: 1000, gear: 3}"
ABSOLUTE = "steer: {counts: 3000, offset: 17}"


def derived(*wheels: str) -> Derivation:
    return of_text("wmrgen: 1\nname: counted\nwheels:\n" + "".join(f"  - {w}\n" for w in wheels), [NAME])


def fixed(encoder: str) -> str:
    return WHEEL.format("a", "fixed", 0, encoder, "")


def test_rates_and_angles() -> None:
    d = derived(
        fixed(SPIN),
        WHEEL.format("b", "steered", 1, f"{STEER}, spin: {{counts: 512}}", ""),
        WHEEL.format("c", "castor", 2, STEER, "d: 0.1, actuated: [spin, steer]"),
        WHEEL.format("e", "castor", 3, ABSOLUTE, "d: 0.1, actuated: [steer]"),
    )
    counts = {"a.spin_counts": 300, "b.spin_counts": -7, "b.steer_counts": 500, "c.steer_counts": -250,
              "e.steer_counts": 250, "e.steer_rate_counts": 12}  # fmt: skip
    wanted = {
        "a.spin": -300 / (4096 * 30.5) * math.tau / 0.01, "b.spin": -7 / 512 * math.tau / 0.01, "b.steer": math.pi / 3,
        "c.steer": math.pi / 3 - math.pi / 6, "c.steer_rate": -250 / 3000 * math.tau / 0.01,
        "e.steer": math.pi / 6, "e.steer_rate": 12 / 3000 * math.tau / 0.01,
    }  # fmt: skip
    counts |= {"b.steer": 0.0, "c.steer": math.pi / 3}
    assert d.numpy().joints_from_counts(**counts, dt=0.01) == pytest.approx(wanted, rel=1e-12)
    case = {n: float(v) for n, v in counts.items()} | {"dt": 0.01}
    (in_c,) = evaluate_c(d.c_module, [(NAME, case)], Choice())
    assert in_c == pytest.approx(wanted, rel=1e-6)


def test_no_time_passes() -> None:
    """Rates are 0 where no time passed, or a clock went back: a pose that they move would jump a million kilometres.
    A step counts as a nanosecond at least."""
    d = derived(fixed(SPIN))
    for dt in (0.0, -0.0, -1.0):
        for counts in (0.0, 1.0, -1.0):
            assert d.numpy().joints_from_counts(**{"a.spin_counts": counts}, dt=dt)["a.spin"] == 0
    short, shortest = (
        d.numpy().joints_from_counts(**{"a.spin_counts": 1.0}, dt=dt)["a.spin"] for dt in (1e-9, 1e-300)
    )
    assert math.isfinite(short) and short == shortest


def test_angles_alone_take_no_time() -> None:
    d = derived(WHEEL.format("b", "steered", 1, STEER, ""))
    assert [p.name for p in d.formula(NAME).inputs] == ["b.steer", "b.steer_counts"]


def test_who_has_no_encoder(tmp_path: Path) -> None:
    path = tmp_path / "plain.yaml"
    path.write_text(robot_text(LAYOUTS["swerve"]))
    with refused(Reason.NO_ENCODER, "encoder", "counts: 4096"):
        derive(load(path), [NAME]).formula(NAME)


@pytest.mark.parametrize(
    ("encoder", "code", "place", "names"),
    [("spin: {gear: 3}", Code.MISSING, "{gear: 3}", ("counts",)),
     ("spin: {counts: 0}", Code.VALUE, "0}", ("counts", "a")),
     ("spin: {counts: 10, gear: -3}", Code.VALUE, "-3}", ("gear", "a", "-3")),
     ("spin: {counts: 10, bits: 7}", Code.VALUE, "7}", ("bits", "8", "32")),
     ("spin: {counts: 10, bits: 24.5}", Code.VALUE, "24.5}", ("bits", "8", "32")),
     ("spin: {counts: 10, modulus: 1}", Code.VALUE, "1}", ("modulus", "2", "2147483648")),
     ("spin: {counts: 10, modulus: 90, bits: 8}", Code.TWICE, "bits: 8}", ("bits", "modulus")),
     ("spin: {counts: 10, offset: 3}", Code.UNKNOWN_KEY, "offset: 3}", ("offset",)),
     ("spin: {counts: 10 mm}", Code.FORM, "10 mm}", ("counts", "10 mm")),
     ("spin: {cpr: 10}", Code.UNKNOWN_KEY, "cpr: 10}", ("cpr",)),
     ("steer: {counts: 10}", Code.UNKNOWN_KEY, "steer: {counts: 10}", ("steer",)),
     ("counts: 10", Code.UNKNOWN_KEY, "counts: 10", ("counts",)),
     ("spin: 10", Code.FORM, "10}", ("spin",)),
     ("spin: {counts: 10, reversed: maybe}", Code.FORM, "maybe}", ("reversed", "maybe"))],
)  # fmt: skip
def test_encoders_that_make_no_sense(encoder: str, code: Code, place: str, names: tuple[str, ...]) -> None:
    with mistaken(code, place, *names):
        derived(fixed(encoder))


def test_encoders_of_the_robot(tmp_path: Path) -> None:
    """Of every joint that is sensed, and before them the wheel's own."""
    (tmp_path / "robot.yaml").write_text(
        robot_text(
            LAYOUTS["offset"], extra="encoder: {spin: {counts: 100}, steer: {counts: 200, bits: 16}}\n"
        ).replace("weight: 1.0", "encoder: {spin: {counts: 50}}")
    )
    ports = derive(load(tmp_path / "robot.yaml"), [NAME]).formula(NAME).inputs
    assert {p.name: p.reading.modulus for p in ports if p.reading} == {
        "w0.spin_counts": 2**32, "w0.steer_counts": 2**16, "w1.steer_counts": 2**16, "w2.spin_counts": 2**32,
    }  # fmt: skip
    same = dict.fromkeys(("w0.spin_counts", "w2.spin_counts"), 10.0)
    zero = {p.name: 0.0 for p in ports} | same | {"dt": 1.0}
    result = derive(load(tmp_path / "robot.yaml"), [NAME]).numpy().joints_from_counts(**zero)
    assert result["w2.spin"] == pytest.approx(2 * result["w0.spin"]) == pytest.approx(math.tau / 5)


def test_modulus_and_turn() -> None:
    encoders = derived(fixed(SPIN)).robot.wheels[0].encoders
    assert {j: (float(e.turn), e.reading) for j, e in encoders.items()} == {
        "spin": (-4096 * 30.5, (2**16, None))
    }
    (plain,) = derived(fixed("spin: {counts: 7}")).robot.wheels[0].encoders.values()
    assert (float(plain.turn), plain.reading.modulus) == (7.0, 2**32)


@pytest.mark.parametrize(
    ("encoder", "limits", "shown"),
    [("counts: 4096, bits: 12, offset: 9", "", ()),
     ("counts: 4096, offset: 9", "", ()), ("counts: 4096, gear: 2, offset: 9", "", ("-90", "90")),
     ("counts: 4096, bits: 14, offset: 9", "", ()),
     ("counts: 4096, bits: 12, offset: 9", "limits: {steer: 180 deg}", ()),
     ("counts: 4096, bits: 12, offset: 9", "limits: {steer: 270 deg}", ("-180", "180", "-270", "270")),
     ("counts: 4096, gear: 3, bits: 12, offset: 9", "limits: {steer: 59 deg}", ()),
     ("counts: 4096, gear: 3, bits: 12, offset: 9", "limits: {steer: [0, 90 deg]}", ("-60", "60", "0", "90")),
     ("counts: 4096, gear: 3, bits: 12, offset: 9", "", ("-60", "60")),
     ("counts: 2048, gear: 150/7, bits: 16", "", ())],
)  # fmt: skip
def test_an_absolute_encoder_shows_the_range_of_its_joint(
    encoder: str, limits: str, shown: tuple[str, ...]
) -> None:
    wheel = WHEEL.format("b", "steered", 1, f"steer: {{{encoder}}}", limits)
    if not shown:
        derived(wheel)
        return
    with mistaken(Code.VALUE, "9}", "b", *shown):
        derived(wheel)
