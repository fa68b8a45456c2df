"""Trailers (Tzafestas 2.3.6, (2.70) corrected) for symbolic lengths: on the axle and off it."""

from __future__ import annotations

import pytest
import sympy

from tests.functions.models.robots import (
    CAR_FRONT,
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_REAR,
    VIRTUAL_REAR,
    derived,
    evaluated,
    on_axle,
    p,
    s,
    zero,
)
from tests.functions.refusals import refused
from tests.robots import of_text
from wmrgen.derivation.facade import Derivation
from wmrgen.errors import Code, RobotFileError
from wmrgen.functions.registry import Reason

HEAD = "wmrgen: 1\nname: sample\nwheels:\n"
D, R, A = p("base"), p("r"), p("a")
ANGLES = [s("theta"), *(s(f"trailer{k}.theta") for k in (1, 2, 3))]
LENGTHS = [p("l1"), p("l2"), p("l3")]
CARS = [(CAR_REAR, ""), (FOUR_REAR, f"{VIRTUAL_REAR}\n")]


def car(count: int, four: int) -> tuple[Derivation, sympy.Symbol, int | sympy.Symbol]:
    wheels, extra = CARS[four]
    return (
        derived(wheels, extra + on_axle(count)),
        s("psi.steer" if four else "front.steer"),
        1 if four else R,
    )


@pytest.mark.parametrize("four", [0, 1], ids=["bicycle", "four"])
@pytest.mark.parametrize("count", [1, 2, 3])
def test_tzafestas_2_70_corrected(count: int, four: int) -> None:
    """theta_i' = (v1/L_i) prod_{j<i} cos(theta_(j-1) - theta_j) sin(theta_(i-1) - theta_i)."""
    d, psi, scale = car(count, four)
    system = d.system("trailer", symbolic=True)
    field = [e / scale for e in system.fields[0]]
    assert [q.name for q in system.state][3:] == [
        str(psi).replace("_", "."),
        *(f"trailer{k + 1}.theta" for k in range(count)),
    ]
    assert zero(field[2] - sympy.tan(psi) / D)
    for i in range(1, count + 1):
        product = sympy.Mul(*(sympy.cos(ANGLES[j - 1] - ANGLES[j]) for j in range(1, i)))
        expected = product * sympy.sin(ANGLES[i - 1] - ANGLES[i]) / LENGTHS[i - 1]
        assert zero(field[3 + i] - expected)
    assert all(e is sympy.S.Zero or e == 0 for e in system.fields[1][4:])


@pytest.mark.parametrize("wheels", [CAR_REAR, CAR_FRONT], ids=["rear", "front"])
def test_tzafestas_2_3_6_constraints_hold_identically(wheels: str) -> None:
    """xQ' sin phi_i - yQ' cos phi_i + sum_{j<=i} phi_j' L_j cos(phi_i - phi_j) = 0 (corrected indices)."""
    d = derived(wheels, on_axle(3))
    for field in d.system("trailer", symbolic=True).fields:
        x, y, turns = field[0], field[1], field[4:]
        for i in range(1, 4):
            phi = ANGLES[i]
            total = x * sympy.sin(phi) - y * sympy.cos(phi)
            total += sum(turns[j - 1] * LENGTHS[j - 1] * sympy.cos(phi - ANGLES[j]) for j in range(1, i + 1))
            assert zero(total)


def axle_velocity(
    d: Derivation, count: int, hitches: list[sympy.Symbol]
) -> list[tuple[sympy.Expr, sympy.Expr]]:
    """d/dt of the axle points, positions written down independently, along the model's first field."""
    system = d.system("trailer", symbolic=True)
    state = [s(q.name) for q in system.state]
    rate = dict(zip(state, system.fields[0], strict=True))
    x, y = s("x"), s("y")
    velocities = []
    for k in range(count):
        ahead, own = ANGLES[k], ANGLES[k + 1]
        x = x - hitches[k] * sympy.cos(ahead) - LENGTHS[k] * sympy.cos(own)
        y = y - hitches[k] * sympy.sin(ahead) - LENGTHS[k] * sympy.sin(own)
        velocities.append(tuple(sum(sympy.diff(e, q) * rate[q] for q in state) for e in (x, y)))
    return velocities


@pytest.mark.parametrize("wheels", [CAR_REAR, DIFFERENTIAL], ids=["car", "differential"])
def test_off_axle_trailers_do_not_slide(wheels: str) -> None:
    h = p("h")
    extra = "trailers: [{length: l1, hitch: h}, {length: l2, hitch: -h}, {length: l3, hitch: h}]"
    d = derived(wheels, extra) if wheels == CAR_REAR else derived(wheels.replace("x: b", "x: 0"), extra)
    for k, (vx, vy) in enumerate(axle_velocity(d, 3, [h, -h, h])):
        own = ANGLES[k + 1]
        slides = -vx * sympy.sin(own) + vy * sympy.cos(own)
        at = {
            q: sympy.Rational(7 + 3 * i, 19 + i) for i, q in enumerate(sorted(slides.free_symbols, key=str))
        }
        assert abs(slides.subs(at).evalf(30)) < 1e-25


def test_jackknife_is_singular() -> None:
    knives = derived(CAR_FRONT, on_axle(2)).system("trailer", symbolic=True).domain
    assert [zero(dom.expression - sympy.cos(ANGLES[k] - ANGLES[k + 1])) for k, dom in enumerate(knives)] == [
        True,
        True,
    ]
    assert [f"`trailer{k + 1}`" in dom.text for k, dom in enumerate(knives)] == [True, True]


def test_jackknife_off_the_axle() -> None:
    """v_1 = v cos(delta) + h omega sin(delta), delta = theta - theta_1; for a car omega = v tan(psi)/D.

    Lengths that all terms have are left out.
    """
    d = derived(CAR_REAR, "trailers: [{length: l1, hitch: h}]")
    drive, knife = d.system("trailer", symbolic=True).domain
    delta, psi = ANGLES[0] - ANGLES[1], s("front.steer")
    expected = R * (sympy.cos(delta) + p("h") * sympy.tan(psi) / D * sympy.sin(delta))
    assert zero(drive.expression - sympy.cos(psi)) and zero(knife.expression * R / D - expected)
    tractor = derived(DIFFERENTIAL.replace("x: b", "x: 0"), "trailers: [{length: l1, hitch: h}]")
    (knife,) = tractor.system("trailer", symbolic=True).domain
    right, left = s("right.spin"), s("left.spin")
    v, omega = R * (right + left) / 2, R * (right - left) / (2 * A)
    assert zero(knife.expression * R / (2 * A) - (v * sympy.cos(delta) + p("h") * omega * sympy.sin(delta)))


def test_hitch_is_measured_from_the_fixed_axle_not_from_p() -> None:
    """P of this tractor lies b ahead of the axle; the trailer sees the axle's centre."""
    d = derived(DIFFERENTIAL, "trailers: [{length: l1}]", b="-0.3")
    field = d.system("trailer", symbolic=True).fields[0]
    assert zero(field[3] - R / 2 * sympy.sin(ANGLES[0] - ANGLES[1]) / LENGTHS[0])


def test_body_without_fixed_axle_tows_from_p() -> None:
    wheels = (
        "{name: front, type: steered, x: base, y: 0, heading: 0, r: r}\n"
        "{name: rear, type: steered, x: -base, y: 0, heading: 0, r: r}"
    )
    system = derived(wheels, "trailers: [{length: l1, hitch: h}]").system("trailer", symbolic=True)
    field = system.fields[0]
    own, theta = ANGLES[1], ANGLES[0]
    vx = field[0] + p("h") * field[2] * sympy.sin(theta)
    vy = field[1] - p("h") * field[2] * sympy.cos(theta)
    assert zero(field[5] * LENGTHS[0] - (-vx * sympy.sin(own) + vy * sympy.cos(own)))


@pytest.mark.parametrize("extra", [on_axle(3), "trailers: [{length: l1, hitch: h}, {length: l2, hitch: -h}]"])
def test_steady_circle_is_an_equilibrium(extra: str) -> None:
    """At its hitch angles every trailer turns at the rate of the body (residual exactly evaluated to 40 digits)."""
    d = derived(CAR_REAR, extra)
    angles = d.formula("steady_circle").closed()
    kappa = sympy.Rational(2, 5)
    at = {
        s("curvature"): kappa,
        s("front.steer"): sympy.atan(kappa * sympy.Rational(7, 5)),
        ANGLES[0]: sympy.Rational(3, 10),
    }
    heading = at[ANGLES[0]]
    for k, t in enumerate(d.robot.trailers):
        heading = heading - evaluated(angles[f"{t.name}.hitch_angle"]).subs(s("curvature"), kappa)
        at[ANGLES[k + 1]] = heading
    system = d.system("trailer")
    rates = [evaluated(e).subs(at).evalf(40) for e in system.fields[0]]
    assert all(abs(rate - rates[2]) < sympy.Float("1e-30") for rate in rates[4:])


def test_steady_circle_exists_while_the_radius_is_not_imaginary() -> None:
    """R_i**2 = R_(i-1)**2 + h_i**2 - L_i**2, here 1/kappa**2 - L1**2 - L2**2."""
    kappa = s("curvature")
    margin = derived(CAR_REAR, on_axle(2)).formula("steady_circle").closed()["margin"]
    expected = 1 - kappa**2 * (sympy.Rational(11, 10) ** 2 + sympy.Rational(9, 10) ** 2)
    assert zero(margin.args[1] - expected) or zero(margin.args[0] - expected)


@pytest.mark.parametrize(
    "text",
    [
        HEAD + "".join(
            f"  - {{name: w{k}, type: swedish, l: 0.2, alpha: {a}, beta: 0, gamma: 0, r: 0.1}}\n"
            for k, a in enumerate(("0", "2*pi/3", "-2*pi/3"))
        ),
        HEAD + "".join(
            f"  - {{name: w{k}, type: castor, x: {x}, y: {y}, d: 0.05, r: 0.1, actuated: [spin, steer]}}\n"
            for k, (x, y) in enumerate(((0.3, 0), (-0.2, 0.2), (-0.2, -0.2)))
        ),
    ],
)  # fmt: skip
def test_a_robot_that_can_move_sideways_tows_nothing(text: str) -> None:
    with refused(Reason.MOBILITY, "trailers"):
        of_text(text + "trailers: [{length: 1}]").formula("inverse")


def test_a_trailer_needs_a_length() -> None:
    text = HEAD + "  - {name: a, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\ntrailers: [{length: 0}]"
    with pytest.raises(RobotFileError) as caught:
        of_text(text)
    assert caught.value.code == Code.VALUE
    assert caught.value.mark is not None and "length: 0" in caught.value.mark.text
