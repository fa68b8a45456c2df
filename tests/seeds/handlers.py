"""What each seed case claims, checked on a derived model."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle.harness import Model, named, rank, turn, twist_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Seed:
    """A case with the model of its layout; ``steer``: steering angle by wheel where the case is evaluated."""

    case: dict[str, Any]
    model: Model
    layout: dict[str, Any]
    steer: dict[str, float]

    @property
    def given(self) -> dict[str, Any]:
        given: dict[str, Any] = self.case["given"]
        return given

    @property
    def expect(self) -> dict[str, Any]:
        expect: dict[str, Any] = self.case["expect"]
        return expect

    @property
    def names(self) -> list[str]:
        return [w["name"] for w in self.layout["wheels"]]

    @property
    def present(self) -> dict[str, float]:
        """The steering angles as inputs."""
        turning = [w["name"] for w in self.layout["wheels"] if w["type"] in ("steered", "castor")]
        return {f"{n}.steer": self.steer.get(n, 0.0) for n in turning}

    def close(self, found: Any, expected: Any) -> None:
        np.testing.assert_allclose(
            np.asarray(found, float),
            np.asarray(expected, float),
            rtol=self.case["tol"],
            atol=self.case["tol"],
        )

    def heading(self, name: str) -> float:
        """Rolling direction of a wheel at steering zero."""
        return float(next(w["heading"] for w in self.layout["wheels"] if w["name"] == name))

    def inverse(self, twist: Any) -> dict[str, float]:
        return self.model.call("inverse", named(twist) | self.present)

    def spins(self, twist: Any, order: list[str] | None = None) -> list[float]:
        found = self.inverse(twist)
        return [found[f"{n}.spin"] for n in order or self.names]

    def forward(self, rates: dict[str, float]) -> Array:
        """Twist from joint rates, at the case's steering angles where they are inputs."""
        inputs = set(self.model.ports("forward")[0])
        return twist_of(
            self.model.call("forward", {k: v for k, v in (self.present | rates).items() if k in inputs})
        )


def deltas(s: Seed) -> None:
    m, e = s.model.data, s.expect
    long = {
        "delta_m": "degree_of_mobility",
        "delta_s": "degree_of_steerability",
        "delta_M": "degree_of_maneuverability",
    }
    long |= {"DDOF": "ddof", "DOF": "dof"}
    for key, value in e.items():
        if key == "rank_C1s_literal":
            assert rank(s.model.matrix("C1s", s.steer)) == value
        else:
            assert m[long.get(key, key)] == value, key
    mobility = s.model.derivation.mobility
    assert mobility.degree_of_mobility == e["delta_m"] and mobility.holonomic == e["holonomic"]
    null = s.model.matrix("null_space", s.steer)
    rows = [s.model.matrix(k, s.steer) for k in ("C1f", "C1s") if s.model.data[k]]
    if rows and e["delta_m"]:
        assert null.shape == (3, e["delta_m"]) and rank(null) == e["delta_m"]
        s.close(np.vstack(rows) @ null, np.zeros((sum(map(len, rows)), e["delta_m"])))


def ik_body(s: Seed) -> None:
    order = s.given.get("wheel_order")
    s.close(np.array([s.spins(axis, order) for axis in np.eye(3)]).T, s.expect["value"])


def fk_body(s: Seed) -> None:
    order = s.given.get("wheel_order") or s.names
    columns = [s.forward({f"{m}.spin": float(n == m) for m in order}) for n in order]
    s.close(np.array(columns).T, s.expect["value"])


def rows_j1(s: Seed) -> None:
    s.close(s.model.matrix("J1", s.steer), s.expect["value"])
    if s.given.get("J2"):
        s.close(s.model.matrix("J2", s.steer), s.expect["J2"])


def rows_c1(s: Seed) -> None:
    s.close(s.model.matrix("C1f", s.steer), s.expect["value"])


def rows_steered(s: Seed) -> None:
    s.close(s.model.matrix("J1", s.steer), s.expect["J1"])
    s.close(s.model.matrix("C1s", s.steer), s.expect["C1"])


def stack(s: Seed) -> None:
    sliding = s.model.matrix("C1f", s.steer)
    assert rank(sliding) == 1 and len(sliding) == 2
    s.close(np.vstack([s.model.matrix("J1", s.steer), sliding[:1]]), s.expect["value"])


def castor_rows(s: Seed) -> None:
    """The sliding row of a castor stands in the inverse: steer_rate = -(row . twist) / d."""
    s.close(s.model.matrix("J1", s.steer), s.expect["J1"])
    d = s.expect["beta_dot_coeff"]
    found = [-d * s.inverse(axis)["c.steer_rate"] for axis in np.eye(3)]
    s.close([found], s.expect["C1"])


def pfaffian_rows(s: Seed, name: str) -> tuple[dict[str, float], dict[str, float]]:
    """The rolling and the sliding row of a wheel in A (vx, vy, omega, joint rates) = 0, by column name."""
    derivation = s.model.derivation
    matrix = s.model.evaluate(derivation.pfaffian, s.steer)
    rows = [dict(zip(derivation.pfaffian_rates, row, strict=True)) for row in matrix]
    rolling = next(row for row in rows if row[f"{name}.spin"])
    sliding = [w["name"] for w in s.layout["wheels"] if w["type"] in ("fixed", "steered", "castor")]
    return rolling, rows[derivation.J1.rows + sliding.index(name)]


def two_axis_balls(s: Seed) -> None:
    """Each ball is driven along x and along y (see `driven_balls`)."""
    order = ["b1_1", "b1_2", "b2_1", "b2_2"]
    columns = [s.forward({f"{m}.spin": float(n == m) for m in order}) for n in order]
    s.close(np.array(columns).T, s.expect["value"])


def driven_balls(layout: dict[str, Any]) -> dict[str, Any]:
    """The balls with their two drives, which the case says in words."""
    return layout | {
        "wheels": [
            w | ({"driven": [0.0, math.pi / 2]} if w["type"] == "spherical" else {}) for w in layout["wheels"]
        ]
    }


def mecanum_jacobians(s: Seed) -> None:
    """Columns of each wheel's Jacobian are twists: spin alone, roller alone, turning about the contact.

    Rolling sees the first with its spin and not the others; the three span all twists.
    """
    j1, j2 = s.model.matrix("J1"), s.model.matrix("J2")
    for i, jacobian in enumerate(np.array(s.expect["value"], float)):
        s.close(j1[i] @ jacobian, [j2[i, i], 0.0, 0.0])
        roller = s.model.call("inverse", named(jacobian[:, 1])).get(f"{s.names[i]}.spin")
        s.close(roller, 0.0)


def ik(s: Seed) -> None:
    e, g = s.expect, s.given
    twist: Any = g.get("twist_body")
    if "twist_world" in g:
        twist = turn(-g["phi"]) @ np.array(g["twist_world"])
    if "v_x" in g:
        twist = [g["v_x"], 0.0, g["omega"]]
    if "heading_of_roll" in e:
        sphere(s, named(twist))
        return
    found = s.inverse(twist)
    if "phi_sw_dot" in e:
        rollers = s.model.call("contacts", named(twist))
        s.close([rollers[f"{n}.roller"] for n in s.names], [e["phi_sw_dot"]])
    if "wheel_rates" in e:
        s.close([found[f"{n}.spin"] for n in s.names], e["wheel_rates"])
    if "wheel_linear_speeds" in e:
        s.close(
            [found[f"{n}.spin"] for n in e["wheel_linear_speeds"]], list(e["wheel_linear_speeds"].values())
        )
    if "phi_dot" in e:
        values = e["phi_dot"] if isinstance(e["phi_dot"], list) else [e["phi_dot"]]
        s.close([found[f"{n}.spin"] for n in s.names], values)
    if "beta_dot" in e:
        s.close([found[f"{n}.steer_rate"] for n in s.names], e["beta_dot"])
    if "matrix" in e:
        axes = np.eye(3)[
            [0, 1, 2] if len(e["matrix"][0]) == 3 else [0, 2]
        ]  # over (vx, omega) for a differential drive
        radius = {w["name"]: w["r"] for w in s.layout["wheels"]}
        s.close([[s.inverse(a)[f"{n}.spin"] * radius[n] for a in axes] for n in s.names], e["matrix"])
    if "gamma" in e:
        steering(s, np.array(twist, float), found)


def sphere(s: Seed, twist: dict[str, float]) -> None:
    """The direction of rolling is known modulo pi with the sign of the rate: here the rate is positive."""
    found = s.model.call("contacts", twist)
    (name,) = s.names
    s.close(found[f"{name}.direction"], s.expect["heading_of_roll"])
    s.close(found[f"{name}.roll"], s.expect["phi_dot"])


def steering(s: Seed, twist: Array, found: dict[str, float]) -> None:
    """Steering angle and rim speed; the case's steering rate, if any, enters through the Pfaffian matrix."""
    steered = [w["name"] for w in s.layout["wheels"] if w["type"] == "steered"]
    gammas = np.atleast_1d(s.expect["gamma"])
    s.close([s.heading(n) + found[f"{n}.steer"] for n in steered], gammas)
    radius = [w["r"] for w in s.layout["wheels"] if w["type"] == "steered"]
    speeds = np.array([found[f"{n}.spin"] for n in steered]) * radius
    if "speed" in s.expect:
        s.close(speeds, s.expect["speed"])
    if "wheel_rate" in s.expect:
        rolling, sliding = pfaffian_rows(s, steered[0])
        rates = named(twist)
        rates |= {
            f"{steered[0]}.spin": s.expect["wheel_rate"],
            f"{steered[0]}.steer_rate": s.given["gamma_dot"],
        }
        s.close(
            [sum(row.get(k, 0.0) * v for k, v in rates.items()) for row in (rolling, sliding)], [0.0, 0.0]
        )
    elif "wheel_speed" in s.expect:
        s.close(speeds, s.expect["wheel_speed"])
    if "v_f" in s.expect:
        s.close(np.hypot(*s.expect["v_f"]), abs(speeds[0]))


def fk(s: Seed) -> None:
    g, e = s.given, s.expect
    rates: dict[str, float] = {}
    given: Any = g.get("wheel_rates", g.get("wheel_linear_speeds", g.get("phi_dot")))
    if "phi_dot_common" in g:
        given = [g["phi_dot_common"]] * len(s.names)
    if isinstance(given, list):
        given = dict(zip(s.names, given, strict=True))
    rates |= {f"{n}.spin": v for n, v in given.items()}
    rates |= {f"{n}.steer_rate": v for n, v in zip(s.names, g.get("beta_dot", []), strict=False)}
    twist = s.forward(rates)
    if "twist_body" in e:
        s.close(twist, e["twist_body"])
    if "twist_world" in e:
        s.close(turn(g["phi"]) @ twist, e["twist_world"])
    if "v_x" in e:
        s.close(twist, [e["v_x"], 0.0, e["omega"]])


ADAPT: dict[str, Callable[[dict[str, Any]], dict[str, Any]]] = {"S-3.7.2": driven_balls}
_WHAT: dict[str, Callable[[Seed], None]] = {
    "IK_body": ik_body, "FK_body": fk_body, "J1": rows_j1, "C1": rows_c1, "J1_C1": rows_steered,
    "stack_J1_C1": stack, "castor_rows": castor_rows, "FK_body_two_axis_balls": two_axis_balls,
    "mecanum_wheel_jacobians": mecanum_jacobians,
}  # fmt: skip


def handler(case: dict[str, Any]) -> Callable[[Seed], None]:
    """The check of a case."""
    if case["kind"] == "matrix":
        return _WHAT[case["given"]["what"]]
    return {"deltas": deltas, "ik": ik, "fk": fk}[case["kind"]]
