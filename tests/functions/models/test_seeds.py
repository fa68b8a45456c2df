"""The cases of the unicycle, slip, tricycle, car and trailer systems, on every backend.

Those of wheel speeds in the world frame and of constant ones are in functions/motion/test_seeds.py.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.depth import BACKENDS
from tests.functions.models.robots import CAR_REAR, UNICYCLE, call, derived
from tests.oracle.harness import robot_text, same_span, turn
from tests.robots import of_text
from tests.seeds import layouts
from wmrgen.derivation.facade import Derivation

Array = NDArray[np.float64]
CASES = json.loads((Path(__file__).parents[3] / "textbook" / "cases.json").read_text(encoding="utf-8"))[
    "cases"
]
SYSTEMS = (
    "T-UNI T-DD T-DDB T-SLIP T-TRI T-CAR T-CAR-RWD T-CAR-FWD T-CAR-ZETA T-TRAILER A-UNI A-TRI A-DISK"
).split()
MOTION = ("T-2.36", "T-2.36-arc", "T-2.37d", "T-2.41c", "T-2.48")
MINE = {c["id"]: c for c in CASES if c["system"] in SYSTEMS and c["id"] not in ("A-disk", *MOTION)}
DRIVEN = {"T-2.46": "front", "T-2.55": "rear", "T-2.56a": "front", "T-2.56a-singular": "front",
          "T-2.51b": "rear", "A-tricycle": "front"}  # fmt: skip


@dataclass(frozen=True)
class Run:
    """A case on a backend."""

    case: dict[str, Any]
    backend: str

    @property
    def given(self) -> dict[str, Any]:
        inputs: dict[str, Any] = self.case["given"]
        return inputs

    @property
    def steer(self) -> dict[str, float]:
        """Steering angles at which the case is evaluated."""
        return {f"{n}.steer": v for n, v in layouts.of(self.case, "cartesian")[1].items()}

    def call(self, function: str, values: dict[str, float]) -> dict[str, float]:
        return call(self.derivation, function, values, self.backend)

    @property
    def derivation(self) -> Derivation:
        return of_layout(self.case["id"])

    def column(self, function: str, values: dict[str, float], names: list[str]) -> list[float]:
        outputs = self.call(function, values)
        return [outputs[n] for n in names]

    def close(self, actual: Any, expected: Any) -> None:
        np.testing.assert_allclose(
            np.asarray(actual, float),
            np.asarray(expected, float),
            rtol=self.case["tol"],
            atol=self.case["tol"],
        )


POSE = ["x_rate", "y_rate", "theta_rate"]
CAR = [*POSE, "front.steer_rate"]


@cache
def of_layout(name: str) -> Derivation:
    layout, _ = layouts.of(MINE[name], "cartesian")
    for w in layout["wheels"]:
        if name in DRIVEN:
            spin = ["spin"] if w["name"] == DRIVEN[name] else []
            w["actuated"] = [*spin, "steer"] if w["type"] == "steered" else spin
    return of_text(robot_text(layout))


def columns(r: Run) -> None:
    """Two columns of G, an input each; the first counts rim speed or spin."""
    g, expected = r.given, np.array(r.case["expect"]["value"], float)
    state = {"theta": g["phi"]} | r.steer
    if g["inputs"] == ["v", "omega"]:
        fields = [r.column("dynamics", state | {f"eta{k}": 1.0}, POSE) for k in (1, 2)]
    else:
        wheel = DRIVEN[r.case["id"]]
        spin = 1.0 if g["inputs"][0] == "theta_w" else 1 / 0.11
        fields = [r.column("posture", state | {f"{wheel}.spin": spin}, CAR)]
        fields.append(r.column("posture", state | {"front.steer_rate": 1.0}, CAR))
    r.close(np.array(fields).T, expected)


def world_inverse(r: Run) -> None:
    """Spins of unit world velocities."""
    g = r.given
    twists = turn(-g["phi"]).T
    spins = [
        r.column("inverse", dict(zip(("vx", "vy", "omega"), map(float, t), strict=True)), _spins(r))
        for t in twists
    ]
    r.close(np.array(spins).T, r.case["expect"]["value"])


def _spins(r: Run) -> list[str]:
    return [f"{n}.spin" for n in r.given["wheel_order"]]


def slip_matrix(r: Run) -> None:
    g = r.given
    units = [dict(zip(("vx", "vy", "omega"), map(float, t), strict=True)) for t in turn(-g["phi"]).T]
    units += [{f"{n}.slip_x": 1.0} for n in g["wheel_order"]]
    spins = [r.column("slip_inverse", u, _spins(r)) for u in units]
    assert not any(p.name.endswith(".slip_y") for p in r.derivation.formula("slip_inverse").inputs)
    spins += [[0.0, 0.0]] * 2  # lateral slip turns no wheel: it is an output
    r.close(np.array(spins).T, r.case["expect"]["value"])


def slip_numbers(r: Run) -> None:
    g, e = r.given, r.case["expect"]
    x, y, phi, w_r, w_l = g["rates"]
    twist = turn(-g["phi"]) @ np.array([x, y, phi])
    values = dict(zip(("vx", "vy", "omega"), map(float, twist), strict=True))
    outputs = r.call("slip_inverse", values | {"right.slip_x": w_r, "left.slip_x": w_l})
    r.close([outputs[f"{n}.spin"] for n in ("right", "left")], [e["theta_r"], e["theta_l"]])
    r.close([outputs[f"{n}.slip_y"] for n in ("right", "left")], [e["z_r"], e["z_l"]])


def constraints(r: Run) -> None:
    """Rows of C1 in the world span those of the text, and the model's rates satisfy them."""
    g, expected = r.given, np.array(r.case["expect"]["value"], float)
    d, steer = r.derivation, {n.removesuffix(".steer"): v for n, v in r.steer.items()}
    rows = []
    for matrix in (d.C1f, d.C1s):
        at = {q: steer[q.name.removesuffix("_steer")] for q in matrix.free_symbols}
        rows += np.array(matrix.xreplace(at).evalf(), float).reshape(-1, 3).tolist()
    assert same_span(np.array(rows) @ turn(-g["phi"]), expected[:, :3])
    assert not expected[:, 3:].any()
    for k in range(1, len(d.system("eta").fields) - len(steer) + 1):
        rates = r.column("dynamics", {"theta": g["phi"], f"eta{k}": 0.7} | r.steer, POSE)
        r.close(expected[:, :3] @ rates, np.zeros(len(expected)))


def behind(r: Run) -> None:
    """eta counts along the columns of the null space: forward, and turning about the axle's centre."""
    g, null = r.given, np.array(r.derivation.null_space.evalf(), float)
    assert null[0, 1] == null[2, 0] == 0.0
    values = {"theta": g["phi"], "eta1": g["v_Q"] / null[0, 0], "eta2": g["omega"] / null[2, 1]}
    r.close(r.column("dynamics", values, POSE), r.case["expect"]["G_rate_world"])


def car_rates(r: Run) -> None:
    g = r.given
    u1, u2 = g["input"].values()
    values = {"theta": g["state"]["phi"], "front.steer": g["state"]["psi"], "front.steer_rate": u2}
    wheel = next(w["r"] for w in r.case["layout"]["wheels"] if w["name"] == "front")
    rates = r.column("posture", values | {"front.spin": u1 / wheel}, CAR)
    r.close(rates, r.case["expect"]["rate"])


def zeta(r: Run) -> None:
    g, e = r.given, r.case["expect"]
    values = {"theta": g["state"]["phi"], "zeta": g["state"]["zeta"], **g["input"]}
    outputs = r.call("zeta", values)
    r.close([outputs[n] for n in ("xp_rate", "yp_rate", "theta_rate", "zeta_rate")], e["rate"])
    r.close([g["input"]["v1"], outputs["u2"]], e["u"])


def unicycle(r: Run) -> None:
    g = r.given
    values = {"theta": g["state"]["phi"], "eta1": g["input"]["v"], "eta2": g["input"]["omega"]}
    r.close(r.column("dynamics", values, POSE), r.case["expect"]["rate"])


def arc(r: Run) -> None:
    g = r.given
    twist = {"vx": g["input"]["v"], "omega": g["input"]["omega"]}
    pose = dict(zip(("x", "y", "theta"), map(float, g["state0"]), strict=True))
    end = call(derived(UNICYCLE), "odometry", pose | twist | {"dt": g["t"]}, r.backend)
    r.close([end[n] for n in ("x", "y", "theta")], r.case["expect"]["state"])


def train(lengths: list[float]) -> Derivation:
    listed = ", ".join(f"{{length: {v}}}" for v in lengths)
    return derived(CAR_REAR, f"trailers: [{listed}]")


def headings(phi: list[float]) -> dict[str, float]:
    return {"theta": phi[0]} | {f"trailer{k}.theta": v for k, v in enumerate(phi[1:], 1)}


def trailer_rates(r: Run) -> None:
    g, e = r.given, r.case["expect"]["rate"]
    assert g["D"] == 1.4
    values = headings(g["state"]["phi"]) | {"front.steer": g["state"]["psi"]}
    values |= {"rear.spin": g["input"]["v1"] / 0.11, "front.steer_rate": g["input"]["v2"]}
    rates = call(train(g["L"]), "trailer", values, r.backend)
    turns = ["theta_rate", *(f"trailer{k + 1}.theta_rate" for k in range(g["N"]))]
    r.close([rates[n] for n in ("x_rate", "y_rate", *turns, "front.steer_rate")],
            [e["x"], e["y"], *e["phi"], e["psi"]])  # fmt: skip


def trailer_constraints(r: Run) -> None:
    """2.3.6 with corrected indices, in the rates that the model gives."""
    g = r.given
    phi, lengths = g["phi"], g["L"]
    psi = math.atan(g["phi_rates"][0] * 1.4 / g["v1"])
    values = headings(phi) | {"front.steer": psi, "rear.spin": g["v1"] / 0.11}
    outputs = call(train(lengths), "trailer", values, r.backend)
    turns = [outputs[f"trailer{k + 1}.theta_rate"] for k in range(len(lengths))]
    np.testing.assert_allclose(turns, g["phi_rates"][1:], rtol=1e-12)
    for i in range(1, len(phi)):
        total = outputs["x_rate"] * math.sin(phi[i]) - outputs["y_rate"] * math.cos(phi[i])
        total += sum(turns[j] * lengths[j] * math.cos(phi[i] - phi[j + 1]) for j in range(i))
        r.close(total, r.case["expect"]["residual"][i - 1])


def positions(r: Run) -> None:
    g = r.given
    values = headings(g["phi"]) | {"x": g["x_Q"], "y": g["y_Q"]}
    outputs = call(train(g["L"]), "trailer_positions", values, r.backend)
    places = [[outputs[f"trailer{k + 1}.{a}"] for a in "xy"] for k in range(len(g["L"]))]
    r.close(places, r.case["expect"]["positions"])


CHECKS: dict[str, Callable[[Run], None]] = {
    "T-2.28c": columns, "T-2.26-arc": arc, "T-Ex2.2-b-IK": world_inverse, "T-Ex2.2-b-M": constraints,
    "T-Ex2.2-b-G": behind, "T-Ex2.2-slip-J": slip_matrix, "T-Ex2.2-slip-num": slip_numbers, "T-2.46": columns,
    "T-2.51b": constraints, "T-2.55": columns, "T-2.56a": columns, "T-2.56a-singular": car_rates, "T-2.56b": zeta,
    "T-2.70-N2": trailer_rates, "T-2.70-N3": trailer_rates, "T-trailer-constraint": trailer_constraints,
    "T-trailer-pos": positions, "A-disk-M": constraints, "A-unicycle": unicycle, "A-tricycle": car_rates,
}  # fmt: skip


def test_every_case_is_run() -> None:
    assert CHECKS.keys() == MINE.keys()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", CHECKS)
def test_seed(name: str, backend: str) -> None:
    CHECKS[name](Run(MINE[name], backend))
