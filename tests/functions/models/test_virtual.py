"""Virtual wheels: the Ackermann condition, both ways, and what is refused."""

from __future__ import annotations

import math

import pytest
import sympy

from tests.functions.models.robots import FOUR_REAR, VIRTUAL_REAR, call, derived, s, zero
from tests.functions.refusals import refused
from tests.robots import of_text
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import Reason

A, D = sympy.Rational(27, 100), sympy.Rational(7, 5)
HEAD = "wmrgen: 1\nname: sample\nwheels:\n"


def test_ackermann_condition() -> None:
    """cot(right) - cot(left) = 2 a / D, and cot(psi) is their mean (Siegwart 3.3.2)."""
    angles = derived(FOUR_REAR, VIRTUAL_REAR).formula("virtual_steering").closed()
    left, right = (angles[f"front_{k}.steer"] for k in ("left", "right"))
    cot = [e.args[1] / e.args[0] for e in (left, right)]
    psi = s("psi.steer")
    assert zero(cot[1] - cot[0] - 2 * A / D)
    assert zero((cot[0] + cot[1]) / 2 - sympy.cos(psi) / sympy.sin(psi))


@pytest.mark.parametrize("backend", ["exact", "casadi", "c"])
def test_real_angles_for_every_finite_input(backend: str) -> None:
    d = derived(FOUR_REAR, VIRTUAL_REAR)
    for psi in (0.0, 1e-9, 0.35, -0.7, math.pi / 2, -math.pi / 2, 3.0, 100.0, 1e6):
        angles = call(d, "virtual_steering", {"psi.steer": psi}, backend)
        assert all(math.isfinite(v) for v in angles.values())
        for name, y in (("front_left", 0.27), ("front_right", -0.27)):
            x, z = 1.4 * math.cos(psi) - y * math.sin(psi), 1.4 * math.sin(psi)
            assert angles[f"{name}.steer"] == pytest.approx(math.atan2(z, x), abs=1e-9)


@pytest.mark.parametrize("psi", [0.0, 0.3, -0.9, 1.4])
def test_there_and_back(psi: float) -> None:
    d = derived(FOUR_REAR, VIRTUAL_REAR)
    real = call(d, "virtual_steering", {"psi.steer": psi})
    basis = call(d, "virtual_angle", {"front_left.steer": real["front_left.steer"]})
    assert basis["psi.steer"] == pytest.approx(psi, abs=1e-12)


def test_six_wheel_rover_one_angle_steers_four_corners() -> None:
    wheels = "\n".join(
        f"{{name: {n}, type: {t}, x: {x}, y: {y}, heading: 0, r: 0.1}}"
        for n, t, x, y in (
            ("fl", "steered", 0.5, 0.3), ("fr", "steered", 0.5, -0.3), ("ml", "fixed", 0, 0.35),
            ("mr", "fixed", 0, -0.35), ("bl", "steered", -0.4, 0.3), ("br", "steered", -0.4, -0.3),
        )
    )  # fmt: skip
    angles = call(
        derived(wheels, "virtual: [{name: front, steers: [fl, fr]}]"),
        "virtual_steering",
        {"front.steer": 0.4},
    )
    radius = 0.5 / math.tan(0.4)
    for name, x, y in (("fl", 0.5, 0.3), ("fr", 0.5, -0.3), ("bl", -0.4, 0.3), ("br", -0.4, -0.3)):
        assert angles[f"{name}.steer"] == pytest.approx(math.atan(x / (radius - y)), abs=1e-12)


def test_wheel_mounted_backwards_takes_the_near_side() -> None:
    wheels = FOUR_REAR.replace(
        "y: -a, heading: 0, r: r, actuated: [steer]", "y: -a, heading: pi, r: r, actuated: [steer]"
    )
    backwards = call(derived(wheels, VIRTUAL_REAR), "virtual_steering", {"psi.steer": 0.35})
    plain = call(derived(FOUR_REAR, VIRTUAL_REAR), "virtual_steering", {"psi.steer": 0.35})
    assert backwards == pytest.approx(plain, abs=1e-12)


def four(x: float = 1.0, second: str = "0", rear: str = "steered") -> str:
    return HEAD + "".join(
        f"  - {{name: {n}, type: {t}, x: {px}, y: {y}, heading: {h}, r: 0.1}}\n"
        for n, t, px, y, h in (
            ("fl", "steered", x, 0.5, "0"), ("fr", "steered", 1.0, -0.5, second),
            ("rl", rear, -1.0, 0.5, "0"), ("rr", rear, -1.0, -0.5, "0"),
        )
    )  # fmt: skip


@pytest.mark.parametrize(
    ("text", "reason", "names"),
    [
        (four() + "virtual: [{name: psi, steers: [fl, fr]}]", Reason.ACKERMANN, ("psi", "2")),
        (
            four(rear="fixed", second="0.3") + "virtual: [{name: psi, steers: [fl, fr]}]",
            Reason.NOT_PARALLEL,
            ("psi", "fl", "fr"),
        ),
        (four(rear="fixed") + "virtual: [{name: psi, steers: [fl, fr], x: -1, y: 0.2}]", Reason.ACKERMANN, ("psi",)),
        (four(x=-1.0, rear="fixed") + "virtual: [{name: psi, steers: [fl, fr]}]", Reason.ACKERMANN, ("psi", "fl")),
        (
            four(rear="fixed") + "virtual: [{name: v, drives: [fl, rl]}]",
            Reason.NOT_PARALLEL,
            ("fl", "rl", "steered", "fixed"),
        ),
        (
            HEAD + "  - {name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\n"
            "  - {name: b, type: fixed, x: 1, y: 0, heading: 0, r: 0.1}\n"
            "  - {name: c, type: steered, x: 2, y: 0, heading: 0, r: 0.1}\nvirtual: [{name: psi, steers: [c]}]",
            Reason.ACKERMANN,
            ("psi", "0"),
        ),
    ],
)  # fmt: skip
def test_no_shared_ackermann_condition_is_refused(text: str, reason: Reason, names: tuple[str, ...]) -> None:
    """At derivation, whatever is asked for."""
    for functions in (None, ["inverse"], ["virtual_steering"]):
        with refused(reason, *names):
            of_text(text, functions).formula("inverse")


def test_two_virtual_wheels_steer_a_two_steer_robot() -> None:
    text = four() + "virtual: [{name: psi, steers: [fl, fr]}, {name: chi, steers: [rl, rr]}]"
    angles = call(of_text(text), "virtual_steering", {"psi.steer": 0.3, "chi.steer": -0.3})
    radius = 1.0 / math.tan(0.3)
    assert angles["fl.steer"] == pytest.approx(math.atan(1 / (radius - 0.5)), abs=1e-12)
    assert angles["rr.steer"] == pytest.approx(math.atan(-1 / (radius + 0.5)), abs=1e-12)


@pytest.mark.parametrize(
    "asked", ["trailers:\n  - {length: 1.1}\n", "virtual:\n  - {name: v, steers: [a, c]}\n"]
)
def test_what_the_layout_cannot_have_is_shown_where_it_stands(asked: str) -> None:
    """Two steered wheels have no Ackermann condition; a body on balls tows nothing."""
    kind = "steered" if "virtual" in asked else "spherical"
    wheels = [
        f"  - {{name: {n}, type: {kind}, x: {x}, y: 0, heading: 0, r: 0.1}}\n" for x, n in enumerate("ac")
    ]
    d = of_text(HEAD + "".join(wheels) + asked)
    with pytest.raises(NotDerivableError) as caught:
        _ = d.mobility
    what, place, shown, caret, *_ = str(caught.value).splitlines()
    assert what.startswith("error[WMR113]: ") and place.endswith(".yaml:7:5")
    assert shown == "7 | " + asked.splitlines()[1] and caret == "  |     ^"
