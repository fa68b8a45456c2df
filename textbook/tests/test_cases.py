"""The seed cases of the systems that need no robot, through the library, on every backend."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from textbook import INPUT_SETS, textbook
from textbook.errata import engine
from textbook.index.records import LIBRARY, Row
from textbook.index.table import ROWS as TABLE
from textbook.tests.common import BACKEND_NAMES, CASES, call, integrate, matrix

Pairs = list[tuple[Any, Any]]
Check = Callable[[str, dict[str, Any], dict[str, Any]], Pairs]
CHECKS: dict[str, Check] = {}


def case(*names: str) -> Callable[[Check], Check]:
    def keep(check: Check) -> Check:
        CHECKS.update(dict.fromkeys(names, check))
        return check

    return keep


# Cases that are one call of the library each, or two: the rows of the table of places.
ROWS: dict[str, list[Row]] = {}
for _row in TABLE:
    if _row.robot == LIBRARY and _row.case:
        ROWS.setdefault(_row.case, []).append(_row)


def row(name: str) -> Check:
    def check(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
        pairs: Pairs = []
        for r in ROWS[name]:
            found = call(b, r.command.split()[1], **{k.replace(".", "__"): v for k, v in r.given.items()})
            pairs += [(found[port], value) for port, value in r.expected.items()]
        return pairs

    return check


CHECKS |= {name: row(name) for name in ROWS}


@case("T-2.25", "A-disk", "KE-pfaffian")
def disk(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    rates = call(b, "rolling_disk", r=0.3, spin=1.7, phi=0.9)
    found = call(b, "disk_constraint", phi=0.9, **rates)
    return [(found["slide"], 0.0), ([found["w1"], found["w2"]], [math.sin(0.9), -math.cos(0.9)])]


@case("T-2.25-frobenius")
def disk_is_not_integrable(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    value = engine.disk_curl()
    assert (value == 0) == e["integrable"]
    return [(float(value), e["c_dot_curl_c"])]


@case("T-2.48")
def radius(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "turning_radius", wheelbase=g["D"], psi=g["psi"])
    return [(found["radius"], e["R"]), (found["curvature"], 1 / e["R"])]


@case("T-RS-Dubins")
def sets(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    return [
        ([float(v) for v in INPUT_SETS["reeds_shepp"]], e["reeds_shepp_v1"]),
        ([float(v) for v in INPUT_SETS["dubins"]], e["dubins_v1"]),
    ]


@case("T-2.57-arc")
def pursuit_arc(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    """Steering by `pursuit` to the case's goal: after the arc's length the car is there."""
    x, y, phi, psi = g["state0"]
    dx, dy = e["position"][0] - x, e["position"][1] - y
    epsilon = math.remainder(math.atan2(dy, dx) - phi, math.tau)
    found = call(b, "pursuit", wheelbase=g["D"], distance=math.hypot(dx, dy), epsilon=epsilon)
    assert e["heading"] == pytest.approx(phi + 2 * epsilon)
    return [(found["psi"], psi), (found["arc"], g["t"] * g["input"]["v1"])]


@case("T-2.58")
def chain(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    n = g["n"]
    state = {f"x{k}": v for k, v in enumerate(g["state"], 1)}
    found = call(b, f"chain_{n}", **state, u1=g["u"][0], u2=g["u"][1])
    return [([found[f"x{k}_rate"] for k in range(1, n + 1)], e["rate"])]


@case("T-2.62", "T-2.64")
def unicycle_chain(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    x, y, theta = g["state"]
    v, omega = g["input"]["v"], g["input"]["omega"]
    found = call(b, "unicycle_to_chain", x=x, y=y, theta=theta, v=v, omega=omega)
    z = {f"z{k}": found[f"z{k}"] for k in (1, 2, 3)}
    inputs = {"u1": found["u1"], "u2": found["u2"]}
    if "z" in e:
        rates = call(b, "chain_3", x1=z["z1"], x2=z["z2"], x3=z["z3"], **inputs)
        return [
            (list(z.values()), e["z"]), (list(inputs.values()), e["u"]),
            ([rates[f"x{k}_rate"] for k in (1, 2, 3)], e["z_rate"]),
        ]  # fmt: skip
    state = call(b, "chain_to_brockett", **z)
    rates = call(b, "brockett", **state, **inputs)
    assert call(b, "brockett_to_chain", **state) == pytest.approx(z)
    return [(list(state.values()), e["x"]), ([rates[f"x{k}_rate"] for k in (1, 2, 3)], e["x_rate"])]


@case("T-2.79")
def mecanum(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    wheel = {
        "radius": g["R"], "r_sw": g["r_roller"], "alpha": g["alpha"], "phi": g["phi_c"], "dx": g["dx"],
        "dy": g["dy"],
    }  # fmt: skip
    found = call(b, "mecanum_wheel", **wheel)
    J = np.array(matrix(found, "m"))
    rates = np.array([3.0, -7.0, 0.4])
    twist = dict(zip(("vx", "vy", "omega"), map(float, J @ rates), strict=True))
    back = call(b, "mecanum_wheel_inverse", **wheel, **twist)
    return [(J, e["value"]), (found["det"], e["det"]), (list(back.values()), rates)]


@case("KE-skew")
def skew(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    key = next(k for k, v in g.items() if isinstance(v, list))
    value = next(v for v in e.values() if np.shape(v) == (3, 3))
    return [(matrix(call(b, "skew_matrix", u=g[key]), "m"), value)]


@case("S-3.50")
def polar(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    x, y, theta = next(v for v in g.values() if isinstance(v, list))
    found = call(b, "polar_coordinates", x=x, y=y, theta=theta)
    back = call(b, "polar_pose", **found)
    pairs = [(found[k], e[k]) for k in ("rho", "alpha", "beta") if k in e]
    assert pairs or "state" in e
    pairs += [(list(found.values()), e["state"])] if "state" in e else []
    return [*pairs, ([back["x"], back["y"]], [x, y])]


@case("S-F3.20-0", "S-F3.20-1", "S-F3.20-2", "S-F3.20-3", "S-F3.20-4", "S-3.65-counter")
def trajectory(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    if b != "casadi" or "state" not in e:  # one integration is enough: S-3.58 ties the backends together
        return []
    f = textbook("polar_closed_loop").casadi()["polar_closed_loop"]
    k = [float(v) for v in g["k"]]
    end = integrate(lambda s: np.array([float(v) for v in f(*s, *k)[:3]]), g["state0"], g["t"], 400)
    return [(end, e["state"])]


@case("S-castor-traj")
def castor(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    vx, vy, omega = g["twist_body"]
    assert omega == 0
    found = call(b, "castor_swivel", beta=g["beta0"], alpha=g["alpha"], d=g["d"], vx=vx, vy=vy, t=g["t"])
    return [(found["beta"], e["beta"])]


@case("A-unicycle", "T-2.28")
def unicycle(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    state = g["state"]
    theta = state["phi"] if isinstance(state, dict) else state[2]
    found = call(b, "unicycle", theta=theta, v=g["input"]["v"], omega=g["input"]["omega"])
    return [(list(found.values()), e["rate"])]


@case("A-bounds")
def bounds(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "car_bounds", u1_max=g["u1_max"], zeta_max=g["zeta_max"], v=g["v"], wheelbase=1.0)
    assert found["omega_max_exact"] <= found["omega_max"] + 1e-15
    names = {
        "v_max": "v_max",
        "omega_max": "omega_max",
        "reeds_shepp": "reeds_shepp_abs_v",
        "dubins": "dubins_v",
    }
    return [(found[ours], e[theirs]) for ours, theirs in names.items()]


# A case in C compiles: one of each text is everyday.
IN_C = {"S-3.2", "T-2.25", "KE-4.25", "A-bounds"}


@pytest.mark.parametrize(
    ("name", "backend"),
    [
        pytest.param(name, backend, marks=pytest.mark.slow)
        if backend == "c" and name not in IN_C
        else (name, backend)
        for name in sorted(CHECKS.keys() & CASES.keys())
        for backend in BACKEND_NAMES
    ],
)
def test_case(name: str, backend: str) -> None:
    found = CASES[name]
    for ours, theirs in CHECKS[name](backend, found["given"], found["expect"]):
        np.testing.assert_allclose(
            np.asarray(ours, float), np.asarray(theirs, float), rtol=found["tol"], atol=found["tol"]
        )
