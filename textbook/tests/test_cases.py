"""The seed cases of the systems that need no robot, through the library, on every backend."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from textbook import INPUT_SETS, textbook
from textbook.errata import engine
from textbook.tests.common import BACKEND_NAMES, CASES, call, matrix, vector

Pairs = list[tuple[Any, Any]]
Check = Callable[[str, dict[str, Any], dict[str, Any]], Pairs]
CHECKS: dict[str, Check] = {}


def case(*names: str) -> Callable[[Check], Check]:
    def keep(check: Check) -> Check:
        CHECKS.update(dict.fromkeys(names, check))
        return check

    return keep


@case("T-2.8a", "T-2.8b")
def pinv(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    m, n = np.shape(g["J"])
    return [(matrix(call(b, f"inverse_{m}x{n}", j=g["J"]), "p", n, m), e["value"])]


@case("T-2.15b")
def r_y(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    return [(matrix(call(b, "rotation_y", angle=g["phi"]), "m", 3, 3), e["value"])]


@case("T-2.17")
def planar(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    x, y = g["p_local"]
    found = call(b, "rotate", angle=g["phi"], x=x, y=y)
    return [([found["x"], found["y"]], e["p_world"])]


@case("S-3.2")
def siegwart_rotation(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    return [
        (matrix(call(b, "rotation_world_to_robot", theta=g["theta"]), "m", 3, 3), e["R"]),
        (matrix(call(b, "rotation_robot_to_world", theta=g["theta"]), "m", 3, 3), e["R_inv"]),
    ]


@case("S-3.5")
def to_robot(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    x, y, t = g["rate_world"]
    found = call(b, "world_to_robot", theta=g["theta"], x_rate=x, y_rate=y, theta_rate=t)
    back = call(b, "robot_to_world", theta=g["theta"], **found)
    return [
        ([found[k] for k in ("vx", "vy", "omega")], e["rate_robot"]),
        ([back[k] for k in ("x_rate", "y_rate", "theta_rate")], g["rate_world"]),
    ]


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


@case("T-2.57b")
def pursuit(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "pursuit", wheelbase=g["D"], distance=g["L"], epsilon=g["epsilon"])
    names = {"psi": "psi", "curvature": "curvature", "offset": "d", "gain": "gain"}
    return [(found[ours], e[theirs]) for ours, theirs in names.items()]


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


@case("T-2.59")
def brockett(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    state = {f"x{k}": v for k, v in enumerate(g["state"], 1)}
    found = call(b, "brockett", **state, u1=g["u"][0], u2=g["u"][1])
    return [([found[f"x{k}_rate"] for k in (1, 2, 3)], e["rate"])]


@case("T-2.60")
def double(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    s = g["state"]
    found = call(
        b, "brockett_double", x1=s["x1"], x2=s["x2"], x1_rate=s["x1d"], x2_rate=s["x2d"],
        u1=g["u"][0], u2=g["u"][1],
    )  # fmt: skip
    return [
        ([found["x1_rate_rate"], found["x2_rate_rate"]], e["accel"]),
        (found["x3_rate"], e["x3_rate"]),
    ]


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


@case("T-VAF3", "T-VAF4")
def vaf(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    angles = {k: math.radians(g[f"{k}_deg"]) for k in ("beta", "gamma")}
    return [(call(b, "omni_wheel", v=1.0, **angles)["vaf"], e["VAF"])]


@case("T-2.71")
def omni_pair(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "omni_wheel", v=g["v_h"], beta=g["beta"], gamma=g["gamma"])
    return [(found["drive"], e["v_i"]), (found["roller"], e["v_roller_abs"])]


@case("T-2.79")
def mecanum(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    wheel = {
        "radius": g["R"], "r_sw": g["r_roller"], "alpha": g["alpha"], "phi": g["phi_c"], "dx": g["dx"],
        "dy": g["dy"],
    }  # fmt: skip
    found = call(b, "mecanum_wheel", **wheel)
    J = np.array(matrix(found, "m", 3, 3))
    rates = np.array([3.0, -7.0, 0.4])
    twist = dict(zip(("vx", "vy", "omega"), map(float, J @ rates), strict=True))
    back = call(b, "mecanum_wheel_inverse", **wheel, **twist)
    return [(J, e["value"]), (found["det"], e["det"]), (list(back.values()), rates)]


@case("T-2.88-45-8", "T-2.88-90-6", "T-2.88-60-10")
def roller(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "mecanum_roller", radius=g["R"], count=g["n"], angle=math.radians(g["alpha_deg"]))
    return [(found["length"], e["D_r"]), (found["width"], e["d"]), (found["half_chord"], e["b"])]


@case("KE-transport")
def transport(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "transport_theorem", u_rate=g["du_dt_m"], omega=g["omega"], u=g["u"])
    return [(vector(found, "rate"), e["du_dt_f"])]


@case("KE-vel")
def velocity(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "moving_frame_velocity", v_m=g["v_m"], omega=g["omega"], r=g["r"], v_o=g["v_o_m"])
    return [(vector(found, "v"), e["v_o_f"])]


@case("KE-acc")
def acceleration(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "moving_frame_acceleration", a_m=g["a_m"], alpha=g["alpha"], omega=g["omega"], r=g["r"],
        v_o=g["v_o_m"], a_o=g["a_o_m"],
    )  # fmt: skip
    terms = [(vector(found, k), e[k]) for k in ("euler", "centripetal", "coriolis")]
    return [(vector(found, "a"), e["a_o_f"]), *terms]


@case("KE-skew")
def skew(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    key = next(k for k, v in g.items() if isinstance(v, list))
    value = next(v for v in e.values() if np.shape(v) == (3, 3))
    return [(matrix(call(b, "skew_matrix", u=g[key]), "m", 3, 3), value)]


@case("KE-4.25")
def recursion(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    return [
        (matrix(call(b, "h_matrix", r=g["r"]), "h", 3, 6), e["H"]),
        (matrix(call(b, "omega_matrix", omega=g["omega"]), "o", 3, 6), e["Omega"]),
    ]


@case("KE-4.30")
def articulated(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "articulated_wheel_velocity", r_vehicle=g["r_c_v"], r_steer=g["r_c_s"], v_vehicle=g["v_v"],
        omega_vehicle=g["omega_v"], v_steer=g["v_s_v"], omega_steer=g["omega_s"], v_o=g["v_c_s"],
    )  # fmt: skip
    two = call(
        b, "two_step_velocity", r_1=g["r_c_v"], r_2=g["r_c_s"], v_1=g["v_v"], omega_1=g["omega_v"],
        v_2=g["v_s_v"], omega_2=g["omega_s"], v_o=g["v_c_s"],
    )  # fmt: skip
    return [(vector(found, "v"), e["v_c"]), (vector(two, "v"), e["v_c"])]


@case("KE-4.31")
def articulated_acceleration(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "articulated_wheel_acceleration", r_vehicle=g["r_c_v"], r_steer=g["r_c_s"], a_vehicle=g["a_v"],
        alpha_vehicle=g["alpha_v"], omega_vehicle=g["omega_v"], v_steer=[0.0, 0.0, 0.05], a_steer=g["a_s_v"],
        alpha_steer=g["alpha_s"], omega_steer=g["omega_s"], v_o=g["v_c_s"], a_o=g["a_c_s"],
    )  # fmt: skip
    return [(vector(found, "a"), e["a_c"]), (vector(found, "v_seen"), g["v_c_v"])]


@case("KE-3d")
def space(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "wheel_velocity", v=g["v_v"], omega=g["omega_v"], r=g["r_c"])
    return [(vector(found, "v"), e["v_c"])]


@case("KE-specific-force")
def force(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "specific_force", t=g["t_sensor"], alpha=g["alpha"], omega=g["omega"], r=g["r_cg"], v=g["v_cg"],
        a=g["a_cg"],
    )  # fmt: skip
    return [(vector(found, "t"), e["t_cg"])]


@case("KE-sense")
def sense(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "steer_sense", r=g["r"], spin=g["omega_wheel"], steer=g["gamma"])
    return [(found["v"], e["v"]), ([found["vx"], found["vy"]], e["v_xy"])]


@case("S-3.7")
def contributions(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "wheel_contributions", r=g["r"], l=g["l"], right__spin=g["phidot1"], left__spin=g["phidot2"]
    )
    return [(found["right.omega"], e["omega1"]), (found["left.omega"], e["omega2"])]


@case("S-3.20")
def swedish(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    wheel = CASES["S-3.20"]["layout"]["wheels"][0]
    vx, vy, omega = g["twist_body"]
    geometry = {k: wheel[k] for k in ("l", "alpha", "beta", "gamma", "r", "r_sw")}
    found = call(b, "swedish_wheel", vx=vx, vy=vy, omega=omega, **geometry)
    return [(found["spin"], e["phi_dot"]), (found["roller"], e["phi_sw_dot"])]


@case("S-3.50")
def polar(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    x, y, theta = next(v for v in g.values() if isinstance(v, list))
    found = call(b, "polar_coordinates", x=x, y=y, theta=theta)
    back = call(b, "polar_pose", **found)
    pairs = [(found[k], e[k]) for k in ("rho", "alpha", "beta") if k in e]
    assert pairs or "state" in e
    pairs += [(list(found.values()), e["state"])] if "state" in e else []
    return [*pairs, ([back["x"], back["y"]], [x, y])]


@case("S-3.53", "S-3.55")
def polar_rates(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    rho, alpha, beta = g["state"]
    reverse = g["model"] == "polar_reverse"
    v = g["input"]["v_reversed" if reverse else "v"]
    name = "polar_rates_reverse" if reverse else "polar_rates"
    found = call(b, name, rho=rho, alpha=alpha, beta=beta, v=v, omega=g["input"]["omega"])
    return [(list(found.values()), e["rate"])]


@case("S-3.58")
def closed_loop(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(
        b, "polar_closed_loop", **dict(zip(("rho", "alpha", "beta"), g["state"], strict=True)), **gains(g)
    )
    return [([found[f"{k}_rate"] for k in ("rho", "alpha", "beta")], e["rate"])]


def gains(g: dict[str, Any]) -> dict[str, float]:
    return dict(zip(("k_rho", "k_alpha", "k_beta"), g["k"], strict=True))


def integrate(rate: Callable[[np.ndarray], np.ndarray], state: Any, t: float, steps: int) -> np.ndarray:
    """Runge-Kutta of order 4."""
    s, h = np.array(state, float), t / steps
    for _ in range(steps):
        a = rate(s)
        b = rate(s + h / 2 * a)
        c = rate(s + h / 2 * b)
        s = s + h / 6 * (a + 2 * b + 2 * c + rate(s + h * c))
    return s


@case("S-F3.20-0", "S-F3.20-1", "S-F3.20-2", "S-F3.20-3", "S-F3.20-4", "S-3.65-counter")
def trajectory(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    if b != "casadi" or "state" not in e:  # one integration is enough: S-3.58 ties the backends together
        return []
    f = textbook("polar_closed_loop").casadi()["polar_closed_loop"]
    k = [float(v) for v in g["k"]]
    return [
        (
            integrate(lambda s: np.array([float(v) for v in f(*s, *k)[:3]]), g["state0"], g["t"], 400),
            e["state"],
        )
    ]


@case("S-castor-traj")
def castor(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    vx, vy, omega = g["twist_body"]
    assert omega == 0
    found = call(b, "castor_swivel", beta=g["beta0"], alpha=g["alpha"], d=g["d"], vx=vx, vy=vy, t=g["t"])
    return [(found["beta"], e["beta"])]


@case("S-castor-align")
def alignment(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    r = CASES["S-castor-align"]["layout"]["wheels"][0]["r"]
    vx, vy = g["V"]
    found = call(b, "castor_alignment", alpha=g["alpha"], d=g["d"], r=r, vx=vx, vy=vy)
    return [
        (found["beta_stable"], e["equilibria_beta"]["stable"]),
        (found["beta_unstable"], e["equilibria_beta"]["unstable"]),
        (found["rate"], e["linear_rate_stable"]),
        (found["spin"], e["phi_dot_at_stable"]),
    ]


@case("A-unicycle", "T-2.28")
def unicycle(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    state = g["state"]
    theta = state["phi"] if isinstance(state, dict) else state[2]
    found = call(b, "unicycle", theta=theta, v=g["input"]["v"], omega=g["input"]["omega"])
    return [(list(found.values()), e["rate"])]


@case("A-reduction")
def reduction(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    found = call(b, "car_reduction", u1=g["u1"], xi=g["xi"], wheelbase=1.0)
    return [(found["v"], e["v"]), (found["omega"], e["omega"])]


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
