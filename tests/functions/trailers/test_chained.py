"""Chained form (Tzafestas (2.58), (2.61)-(2.69); Sordalen (1993)): identities proved, and every output finite."""

from __future__ import annotations

import math
from typing import Any

import pytest
import sympy

from tests.depth import BACKENDS, everyday
from tests.functions.models.robots import (
    CAR_REAR,
    DIFFERENTIAL,
    FOUR_REAR,
    OMNI,
    TRICYCLE,
    TWO_STEER,
    UNICYCLE,
    VIRTUAL_REAR,
    call,
    derived,
    evaluated,
    on_axle,
    p,
    s,
    zero,
)
from tests.functions.refusals import refused
from wmrgen import derive
from wmrgen.codegen.c import evaluate as in_c
from wmrgen.derivation.facade import Derivation
from wmrgen.functions.registry import Reason
from wmrgen.functions.trailers import chained_sheet
from wmrgen.functions.trailers.chained import chained
from wmrgen.functions.trailers.chained_sheet import verify
from wmrgen.geometry.symbolic import AtLeast

FREE = {k: f"{{value: {v}, tunable: true}}" for k, v in (("base", "1.4"), ("b", "0.3"), ("a", "0.27"))}
LENGTHS = {f"l{k}": f"{{value: {1.5 - 0.2 * k:.1f}, tunable: true}}" for k in range(1, 4)}
X, Y, THETA, STEER = s("x"), s("y"), s("theta"), s("front.steer")
U1, U2, V = s("u1"), s("u2"), s("v")
C, S = sympy.cos(THETA), sympy.sin(THETA)


def inside(expr: Any) -> Any:
    """The expression inside its domain: every guard open."""
    if isinstance(expr, sympy.Piecewise):
        return inside(expr.args[-1][0])
    if isinstance(expr, AtLeast):
        return inside(expr.args[0])
    return expr.func(*(inside(a) for a in expr.args)) if expr.args else expr


def closed(d: Derivation, name: str) -> dict[str, Any]:
    return {k: evaluated(inside(e)) for k, e in d.formula(name).closed().items()}


def independent(trailers: int) -> dict[Any, Any]:
    """Headings by the last one and the hitch angles."""
    headings = [THETA, *(s(f"trailer{k + 1}.theta") for k in range(trailers))]
    total, sums = sympy.Symbol("last"), {}
    for k in range(trailers, -1, -1):
        sums[headings[k]] = total
        total = total + sympy.Symbol(f"hitch{k}")
    return sums


def on_circles(expr: Any, hitches: dict[Any, Any]) -> Any:
    """The numerator over symbols for sines and cosines, with every square of a sine replaced: 0 only if it is."""
    expr = evaluated(expr).replace(sympy.tan, lambda a: sympy.sin(a) / sympy.cos(a)).xreplace(hitches)
    expr = sympy.expand_trig(expr)
    angles = sorted({f.args[0] for f in expr.atoms(sympy.sin, sympy.cos)}, key=str)
    if not angles:
        return sympy.expand(expr)
    assert all(a.is_Symbol for a in angles)
    cosines = {a: sympy.Symbol(f"c{k}") for k, a in enumerate(angles)}
    sines = {a: sympy.Symbol(f"s{k}") for k, a in enumerate(angles)}
    table = {sympy.cos(a): cosines[a] for a in angles} | {sympy.sin(a): sines[a] for a in angles}
    numerator = sympy.Poly(sympy.numer(sympy.together(expr.xreplace(table))), *sines.values())
    total = sympy.S.Zero
    for powers, coefficient in numerator.terms():
        term = coefficient
        for (a, sine), n in zip(sines.items(), powers, strict=True):
            term *= sine ** (n % 2) * (1 - cosines[a] ** 2) ** (n // 2)
        total += term
    return total.expand()


# ---- the texts' formulas


def test_tzafestas_2_62_2_63_unicycle() -> None:
    d = derived(UNICYCLE)
    z = closed(d, "chained")
    assert zero(z["z1"] - THETA) and zero(z["z2"] - (X * C + Y * S)) and zero(z["z3"] - (X * S - Y * C))
    own = closed(d, "chained_input")
    assert zero(own["omega"] - U1) and zero(own["v"] - (U2 + (X * S - Y * C) * U1))


@pytest.mark.parametrize(
    ("wheels", "extra", "steer"),
    [
        (CAR_REAR, "", "front.steer"),
        (TRICYCLE, "", "front.steer"),
        (FOUR_REAR, VIRTUAL_REAR, "psi.steer"),
    ],
    ids=["car", "tricycle", "virtual"],
)
def test_tzafestas_2_66_to_2_69_car(wheels: str, extra: str, steer: str) -> None:
    d = derived(wheels, extra, base=FREE["base"])
    psi, D = s(steer), p("base")
    z = closed(d, "chained")
    wanted = (X, sympy.tan(psi) / (D * C**3), sympy.tan(THETA), Y)
    assert all(zero(actual - e) for actual, e in zip(z.values(), wanted, strict=True))
    own = closed(d, "chained_input")
    assert zero(own["v"] - U1 / C)
    rate = -3 * sympy.sin(psi) ** 2 * S * U1 / (D * C**2) + D * sympy.cos(psi) ** 2 * C**3 * U2
    assert zero(own[f"{steer}_rate"] - rate)


def test_curvature_of_any_steered_wheel() -> None:
    """A wheel beside the centre line: kappa = sin/(X cos + Y sin), and the general form of (2.68)."""
    d = derived(FOUR_REAR, "", base=FREE["base"], a=FREE["a"])
    psi, x, y = s("front_left.steer"), p("base"), p("a")
    bend = x * sympy.cos(psi) + y * sympy.sin(psi)
    kappa = sympy.sin(psi) / bend
    assert zero(closed(d, "chained")["z2"] - kappa / C**3)
    rate = C**3 * (U2 - 3 * kappa**2 * S * U1 / C**5) * bend**2 / x
    assert zero(closed(d, "chained_input")["front_left.steer_rate"] - rate)


def test_tzafestas_2_64_2_65_brockett() -> None:
    d = derived(UNICYCLE)
    z, x, own = closed(d, "chained"), closed(d, "brockett"), closed(d, "brockett_input")
    assert zero(x["x3"] - (-2 * z["z3"] + z["z1"] * z["z2"]))
    assert own == closed(d, "chained_input")
    v, omega = own["v"], own["omega"]
    rates = {
        n: sympy.diff(e, X) * v * C + sympy.diff(e, Y) * v * S + sympy.diff(e, THETA) * omega
        for n, e in x.items()
    }
    assert zero(rates["x1"] - U1) and zero(rates["x2"] - U2)
    assert zero(rates["x3"] - (x["x1"] * U2 - x["x2"] * U1))


# ---- the identities, in symbols (sympy) and in exact numbers


ROBOTS = {
    "unicycle": (UNICYCLE, 0), "differential": (DIFFERENTIAL, 0), "car": (CAR_REAR, 0),
    "differential_1": (DIFFERENTIAL, 1), "car_1": (CAR_REAR, 1), "car_2": (CAR_REAR, 2),
}  # fmt: skip


@pytest.mark.parametrize("name", everyday(ROBOTS, [n for n in ROBOTS if n != "car_2"]))
def test_chain_identities_in_symbols(name: str) -> None:
    """z1' = u1, z2' = u2, z_{k+1}' = z_k u1 along the robot's own model, for all states, inputs and lengths."""
    wheels, trailers = ROBOTS[name]
    d = derived(wheels, on_axle(trailers) if trailers else "", **FREE, **LENGTHS)
    z, own, claimed = closed(d, "chained"), closed(d, "chained_input"), closed(d, "chained_rates")
    form = "trailer" if trailers else "eta" if wheels == UNICYCLE else "posture"
    system = d.system(form, symbolic=True)
    turning = "front.steer_rate" if wheels == CAR_REAR else "omega"
    v, omega, rate = sympy.symbols("v omega rate")
    inputs = {
        UNICYCLE: {s("eta1"): v, s("eta2"): omega},
        CAR_REAR: {s("rear.spin"): v / p("r"), s("front.steer_rate"): rate},
        DIFFERENTIAL: {
            s("right.spin"): (v + p("a") * omega) / p("r"), s("left.spin"): (v - p("a") * omega) / p("r"),
        },
    }[wheels]  # fmt: skip
    wheel = dict(zip(system.state, system.rates, strict=True))
    q = {s(port.name): evaluated(e).xreplace(inputs) for port, e in wheel.items()}
    along = {n: sum(sympy.diff(e, state) * r for state, r in q.items()) for n, e in z.items()}
    names, hitches = list(z), independent(trailers)
    third = rate if wheels == CAR_REAR else omega
    table = {V: v, s(turning): third}
    u1, u2 = (claimed[f"{n}_rate"].xreplace(table) for n in names[:2])
    assert on_circles(along["z1"] - u1, hitches) == 0
    assert on_circles(along["z2"] - u2, hitches) == 0
    for k in range(1, len(names) - 1):
        assert on_circles(along[names[k + 1]] - z[names[k]] * u1, hitches) == 0
    # The way back: chained_input gives v and the turning that produce u1, u2, and the twist of P.
    wanted = {"v": v, turning: third, "vx": q[X] * C + q[Y] * S, "vy": q[Y] * C - q[X] * S, "omega": q[THETA]}
    for output, expected in wanted.items():
        assert on_circles(own[output].xreplace({U1: u1, U2: u2}) - expected, hitches) == 0, output


@pytest.mark.parametrize("wheels", [CAR_REAR, DIFFERENTIAL], ids=["car", "differential"])
@pytest.mark.parametrize("count", everyday(range(3, 9), [3, 5]))
def test_chain_identities_exactly_for_n_trailers(wheels: str, count: int) -> None:
    trailers = "trailers: [" + ", ".join(f"{{length: {0.7 + 0.1 * k:.1f}}}" for k in range(count)) + "]"
    d = derived(wheels, trailers)
    verification = verify(d.robot, d.mobility, points=2)
    assert verification.holds
    n = 4 + count if wheels == CAR_REAR else 3 + count
    assert len(verification.residuals) == 2 * (2 * n + 2)


def test_verification_sees_a_wrong_formula(monkeypatch: pytest.MonkeyPatch) -> None:
    d = derived(CAR_REAR, "trailers: [{length: 0.9}]")
    other = derived(CAR_REAR, "trailers: [{length: 0.901}]")
    monkeypatch.setattr(
        chained_sheet, "chained", lambda robot, mobility: chained(other.robot, other.mobility)
    )
    verification = verify(d.robot, d.mobility)
    assert not verification.holds and any(verification.residuals)


# ---- backends, edges, refusals


@pytest.mark.parametrize("backend", BACKENDS)
def test_backends_agree(backend: str) -> None:
    d = derived(CAR_REAR, on_axle(2))
    state = {
        "x": 0.5,
        "y": 0.25,
        "theta": 0.25,
        "front.steer": -0.25,
        "trailer1.theta": 0.125,
        "trailer2.theta": -0.25,
    }
    values = {**state, "u1": 0.5, "u2": -1.25}
    own = call(d, "chained_input", values, backend)
    rates = call(d, "chained_rates", {**state, **{k: own[k] for k in ("v", "front.steer_rate")}}, backend)
    z = list(call(d, "chained", state, backend).values())
    wanted = [0.5, -1.25, *(0.5 * v for v in z[1:-1])]
    assert list(rates.values()) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("count", everyday([0, 1, 8], [0, 1]))
@pytest.mark.parametrize("scalar", ["float", "double"])
def test_finite_outside_the_domain(count: int, scalar: str) -> None:
    """cos theta = 0, jack-knifed trailers and a steering angle of 90 degrees: every output is a number, in float32."""
    trailers = "trailers: [" + ", ".join("{length: 0.8}" for _ in range(count)) + "]" if count else ""
    d = derived(CAR_REAR, trailers)
    names = ("chained", "chained_input", "chained_rates")
    one = derive(d.robot, names)
    turned = ("theta", "front.steer", *(f"trailer{k + 1}.theta" for k in range(count)))
    angles = (math.pi / 2, math.pi / 2 - 1e-4, -math.pi / 2 + 1e-7)
    idle = {name: {port.name: 0.3 for port in one.raw_module.function(name).inputs} for name in names}
    requests = [(name, idle[name] | {t: a}) for name in names for t in turned for a in angles]
    for request, outputs in zip(requests, in_c(one.c_module, requests, scalar=scalar), strict=True):
        assert all(math.isfinite(v) for v in outputs.values()), (request, outputs)


def test_jacobian_is_finite_at_the_edge() -> None:
    """The divisor itself is guarded: no NaN from the branch that is not taken."""
    import casadi

    f = derive(derived(CAR_REAR).robot, ["chained_input"]).casadi()["chained_input"]
    values = {"theta": math.pi / 2, "front.steer": math.pi / 2, "u1": 1.0, "u2": 1.0}
    inputs = [casadi.SX.sym(n) for n in f.name_in()]
    jacobian = casadi.Function(
        "j", inputs, [casadi.jacobian(casadi.vertcat(*f.call(inputs)), casadi.vertcat(*inputs))]
    )
    values_there = jacobian.call([values.get(n, 0.3) for n in f.name_in()])[0]
    assert all(math.isfinite(v) for v in values_there.full().ravel())


@pytest.mark.parametrize(
    ("wheels", "extra", "name", "reason", "names"),
    [
        (CAR_REAR, "trailers: [{length: 1, hitch: 0.2}]", "chained", Reason.HITCH, ("0.2", "hitch")),
        (
            CAR_REAR,
            "trailers: [{length: 1, hitch: 0.2}, {length: 1, hitch: 0.1}]",
            "chained",
            Reason.HITCH,
            ("hitch",),
        ),
        (OMNI, "", "chained", Reason.ROBOT_TYPE, ("(3, 0)",)),
        (TWO_STEER, "", "chained_input", Reason.ROBOT_TYPE, ("(1, 2)",)),
        (CAR_REAR, "", "brockett", Reason.ROBOT_TYPE, ("(2,4)", "chained")),
        (UNICYCLE, on_axle(1), "brockett_rates", Reason.ROBOT_TYPE, ("(2,4)", "chained")),
    ],
)
def test_refusals_say_why(wheels: str, extra: str, name: str, reason: Reason, names: tuple[str, ...]) -> None:
    d = derived(wheels, extra)
    with refused(reason, *names):
        d.formula(name)
