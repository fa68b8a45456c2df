"""The seed cases of the systems that need no robot, through the library, on every backend."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from textbook import INPUT_SETS, textbook
from textbook.errata import engine
from textbook.tests.common import BACKEND_NAMES, CASES, call, integrate, matrix, output

Pairs = list[tuple[Any, Any]]
Check = Callable[[str, dict[str, Any], dict[str, Any]], Pairs]
CHECKS: dict[str, Check] = {}


def case(*names: str) -> Callable[[Check], Check]:
    def keep(check: Check) -> Check:
        CHECKS.update(dict.fromkeys(names, check))
        return check

    return keep


# Cases that are one call each, or two: function; inputs, `port=what is given`; outputs, `port=what is expected`.
# Several ports with commas take a list; `angle=a°` is given in degrees; a number or a list stands for itself; `wheel`
# is the first of the layout.
ROWS = {
    "T-2.8a": (("inverse_3x2", "j=J", "p=value"),),
    "T-2.8b": (("inverse_2x4", "j=J", "p=value"),),
    "T-2.15b": (("rotation_y", "angle=phi", "m=value"),),
    "T-2.17": (("rotate", "angle=phi x,y=p_local", "x,y=p_world"),),
    "T-2.57b": (("pursuit", "wheelbase=D distance=L epsilon=epsilon",
                 "psi=psi curvature=curvature offset=d gain=gain"),),
    "T-2.59": (("brockett", "x1,x2,x3=state u1,u2=u", "x1_rate,x2_rate,x3_rate=rate"),),
    "T-2.60": (("brockett_double", "x1=state.x1 x2=state.x2 x1_rate=state.x1d x2_rate=state.x2d u1,u2=u",
                "x1_rate_rate,x2_rate_rate=accel x3_rate=x3_rate"),),
    **dict.fromkeys(("T-VAF3", "T-VAF4"), (("omni_wheel", "v=1 beta=beta_deg° gamma=gamma_deg°", "vaf=VAF"),)),
    "T-2.71": (("omni_wheel", "v=v_h beta=beta gamma=gamma", "drive=v_i roller=v_roller_abs"),),
    **dict.fromkeys(("T-2.88-45-8", "T-2.88-90-6", "T-2.88-60-10"),
                    (("mecanum_roller", "radius=R count=n angle=alpha_deg°", "length=D_r width=d half_chord=b"),)),
    "KE-transport": (("transport_theorem", "u_rate=du_dt_m omega=omega u=u", "rate=du_dt_f"),),
    "KE-vel": (("moving_frame_velocity", "v_m=v_m omega=omega r=r v_o=v_o_m", "v=v_o_f"),),
    "KE-acc": (("moving_frame_acceleration", "a_m=a_m alpha=alpha omega=omega r=r v_o=v_o_m a_o=a_o_m",
                "a=a_o_f euler=euler centripetal=centripetal coriolis=coriolis"),),
    "KE-4.25": (("h_matrix", "r=r", "h=H"), ("omega_matrix", "omega=omega", "o=Omega")),
    "KE-4.30": (("articulated_wheel_velocity",
                 "r_vehicle=r_c_v r_steer=r_c_s v_vehicle=v_v omega_vehicle=omega_v v_steer=v_s_v "
                 "omega_steer=omega_s v_o=v_c_s", "v=v_c"),
                ("two_step_velocity",
                 "r_1=r_c_v r_2=r_c_s v_1=v_v omega_1=omega_v v_2=v_s_v omega_2=omega_s v_o=v_c_s", "v=v_c"),),
    "KE-4.31": (("articulated_wheel_acceleration",
                 "r_vehicle=r_c_v r_steer=r_c_s a_vehicle=a_v alpha_vehicle=alpha_v omega_vehicle=omega_v "
                 "v_steer=[0,0,0.05] a_steer=a_s_v alpha_steer=alpha_s omega_steer=omega_s v_o=v_c_s a_o=a_c_s",
                 "a=a_c v_seen=v_c_v"),),
    "KE-3d": (("wheel_velocity", "v=v_v omega=omega_v r=r_c", "v=v_c"),),
    "KE-specific-force": (("specific_force", "t=t_sensor alpha=alpha omega=omega r=r_cg v=v_cg a=a_cg", "t=t_cg"),),
    "KE-sense": (("steer_sense", "r=r spin=omega_wheel steer=gamma", "v=v vx,vy=v_xy"),),
    "S-3.2": (("rotation_world_to_robot", "theta=theta", "m=R"), ("rotation_robot_to_world", "theta=theta", "m=R_inv")),
    "S-3.5": (("world_to_robot", "theta=theta x_rate,y_rate,theta_rate=rate_world", "vx,vy,omega=rate_robot"),),
    "S-3.7": (("wheel_contributions", "r=r l=l right.spin=phidot1 left.spin=phidot2",
               "right.omega=omega1 left.omega=omega2"),),
    "S-3.20": (("swedish_wheel", "vx,vy,omega=twist_body l=wheel.l alpha=wheel.alpha beta=wheel.beta gamma=wheel.gamma "
                "r=wheel.r r_sw=wheel.r_sw", "spin=phi_dot roller=phi_sw_dot"),),
    "S-3.53": (("polar_rates", "rho,alpha,beta=state v=input.v omega=input.omega",
                "rho_rate,alpha_rate,beta_rate=rate"),),
    "S-3.55": (("polar_rates_reverse", "rho,alpha,beta=state v=input.v_reversed omega=input.omega",
                "rho_rate,alpha_rate,beta_rate=rate"),),
    "S-castor-align": (("castor_alignment", "alpha=alpha d=d r=wheel.r vx,vy=V",
                        "beta_stable=equilibria_beta.stable beta_unstable=equilibria_beta.unstable "
                        "rate=linear_rate_stable spin=phi_dot_at_stable"),),
    "S-3.58": (("polar_closed_loop", "rho,alpha,beta=state k_rho,k_alpha,k_beta=k",
                "rho_rate,alpha_rate,beta_rate=rate"),),
    "A-reduction": (("car_reduction", "u1=u1 xi=xi wheelbase=1", "v=v omega=omega"),),
}  # fmt: skip


def value(word: str, facts: dict[str, Any]) -> Any:
    """What a word of ROWS stands for: ``state.x1`` lies deeper, ``a°`` is an angle in degrees."""
    if word[0] in "[0123456789":
        return json.loads(word)
    if word.endswith("°"):
        return math.radians(facts[word[:-1]])
    for key in word.split("."):
        facts = facts[key]
    return facts


def row(name: str) -> Check:
    def check(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
        pairs: Pairs = []
        wheels = (CASES[name].get("layout") or {}).get("wheels", [{}])
        for function, inputs, outputs in ROWS[name]:
            arguments: dict[str, Any] = {}
            for ports, word in (pair.split("=") for pair in inputs.split()):
                what = value(word, {**g, "wheel": wheels[0]})
                several = "," in ports
                arguments |= zip(ports.split(","), what, strict=True) if several else {ports: what}
            found = call(b, function, **arguments)
            for ports, word in (pair.split("=") for pair in outputs.split()):
                pairs.append((output(found, ports), value(word, {**g, **e})))
        return pairs

    return check


CHECKS |= {name: row(name) for name in ROWS}


@case("S-3.5")
def back_to_the_world(b: str, g: dict[str, Any], e: dict[str, Any]) -> Pairs:
    there = row("S-3.5")(b, g, e)
    vx, vy, omega = there[0][0]
    back = call(b, "robot_to_world", theta=g["theta"], vx=vx, vy=vy, omega=omega)
    return [*there, (list(back.values()), g["rate_world"])]


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
