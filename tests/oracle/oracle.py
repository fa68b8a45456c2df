"""Wheeled-robot kinematics a second time, from contact-point velocities in plain numpy.

Shares no code with wmrgen. A layout is a dict of floats (SI, radians)::

    {"wheels": [{"name", "type", "x", "y", "heading", "r", "gamma", "d", "o"}, …],
     "couplings": [("steer", ["a", "b"]), …]}

A wheel of type spherical with ``driven`` is a ball that one drive rolls along ``heading``.
``heading`` is the rolling direction at steering zero; the contact is B = A + d e + o n.
A state of the joints is a dict of ``<wheel>.spin``, ``<wheel>.steer``, ``<wheel>.steer_rate``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Layout = dict[str, Any]
Wheel = dict[str, Any]
Array = NDArray[np.float64]

STEERABLE = ("steered", "castor")
TOL = 1e-9


def geometry(wheel: Wheel, steer: float) -> tuple[Array, Array, Array]:
    """Rolling direction e, lateral n and contact point B at a steering angle."""
    h = wheel["heading"] + steer
    e = np.array([math.cos(h), math.sin(h)])
    n = np.array([-math.sin(h), math.cos(h)])
    return e, n, np.array([wheel["x"], wheel["y"]]) + wheel.get("d", 0.0) * e + wheel.get("o", 0.0) * n


def point_velocity(point: Array, twist: Array) -> Array:
    """Velocity of a body-fixed point, in the robot frame."""
    return np.array([twist[0] - twist[2] * point[1], twist[1] + twist[2] * point[0]])


def row(direction: Array, point: Array) -> Array:
    """The row r with r @ twist = component of the velocity of ``point`` along ``direction``."""
    return np.array([direction[0], direction[1], point[0] * direction[1] - point[1] * direction[0]])


def wheel_rows(wheel: Wheel, steer: float) -> list[tuple[str, Array, float, float]]:
    """(kind, twist row, coefficient of spin, coefficient of steer rate): row @ twist + c1 spin + c2 rate = 0."""
    if wheel["type"] == "spherical" and not wheel.get("driven"):
        return []
    e, n, contact = geometry(wheel, steer)
    gamma = wheel.get("gamma", 0.0)
    axis = math.cos(gamma) * e + math.sin(gamma) * n  # force direction: the roller axis at the ground
    arm = contact - np.array([wheel["x"], wheel["y"]])
    steer_term = float(row(axis, arm)[2]) if wheel["type"] in STEERABLE else 0.0
    rows = [("rolling", row(axis, contact), -wheel["r"] * math.cos(gamma), steer_term)]
    if wheel["type"] not in ("swedish", "spherical"):
        side = float(row(n, arm)[2]) if wheel["type"] in STEERABLE else 0.0
        rows.append(("sliding", row(n, contact), 0.0, side))
    return rows


def measured_rows(layout: Layout, sensed: dict[str, float]) -> tuple[Array, Array]:
    """Every row whose rates are all in ``sensed``, and its value [m/s]."""
    rows, values = [], []
    for wheel in layout["wheels"]:
        name = wheel["name"]
        if wheel["type"] in STEERABLE and f"{name}.steer" not in sensed:
            continue
        for _, r, spin, rate in wheel_rows(wheel, sensed.get(f"{name}.steer", 0.0)):
            if spin and f"{name}.spin" not in sensed:
                continue
            if abs(rate) > 1e-15 and f"{name}.steer_rate" not in sensed:
                continue
            rows.append(r)
            values.append(
                -spin * sensed.get(f"{name}.spin", 0.0) - rate * sensed.get(f"{name}.steer_rate", 0.0)
            )
    return np.array(rows).reshape(-1, 3), np.array(values)


def forward(layout: Layout, sensed: dict[str, float]) -> tuple[Array, float, int]:
    """Least-squares twist, residual norm [m/s] and rank over every sensed row."""
    h, z = measured_rows(layout, sensed)
    if not len(h):
        return np.zeros(3), 0.0, 0
    twist, _, rank, _ = np.linalg.lstsq(h, z, rcond=1e-9)
    return twist, float(np.linalg.norm(h @ twist - z)), int(rank)


def steering(wheel: Wheel, twist: Array, present: float) -> float:
    """Steering angle nearest ``present`` that lets the pivot move as it does; ``present`` when it rests."""
    v = point_velocity(np.array([wheel["x"], wheel["y"]]), twist)
    if not v.any():
        return present
    turn = math.atan2(v[1], v[0]) - wheel["heading"] - present
    return present + turn - math.pi * round(turn / math.pi)


def joint_rates(wheel: Wheel, twist: Array, steer: float) -> dict[str, float]:
    """Spin and (castors) steer rate that obey this wheel's rows at ``twist``; steered wheels hold their angle."""
    name = wheel["name"]
    rows = {kind: (r, spin, rate) for kind, r, spin, rate in wheel_rows(wheel, steer)}
    if not rows:
        return {}
    out: dict[str, float] = {}
    steer_rate = 0.0
    if wheel["type"] == "castor":
        r, _, rate = rows["sliding"]
        steer_rate = out[f"{name}.steer_rate"] = -float(r @ twist) / rate
    r, spin, rate = rows["rolling"]
    if wheel["type"] == "steered" and rate:
        out[f"{name}.steer_rate"] = 0.0
    out[f"{name}.spin"] = -(float(r @ twist) + rate * steer_rate) / spin
    return out


def inverse(layout: Layout, twist: Array, present: dict[str, float]) -> dict[str, float]:
    """Joint rates and steering angles of an admissible twist."""
    out: dict[str, float] = {}
    for wheel in layout["wheels"]:
        steer = present.get(f"{wheel['name']}.steer", 0.0)
        if wheel["type"] == "steered":
            steer = out[f"{wheel['name']}.steer"] = steering(wheel, twist, steer)
        out |= joint_rates(wheel, twist, steer)
    return out


def sliding_rows(layout: Layout, kind: str, steer: dict[str, float]) -> Array:
    """C1f (kind fixed) or C1s (kind steered) at the steering angles, one row per wheel."""
    found = [
        r
        for wheel in layout["wheels"]
        if wheel["type"] == kind
        for name, r, _, _ in wheel_rows(wheel, steer.get(wheel["name"], 0.0))
        if name == "sliding"
    ]
    return np.array(found).reshape(-1, 3)


def rank(matrix: Array, tol: float = TOL) -> int:
    """Rank at ``tol`` of the largest singular value."""
    if not matrix.size:
        return 0
    s = np.linalg.svd(matrix, compute_uv=False)
    return int((s > tol * max(s[0], 1e-300)).sum())


def null(matrix: Array, tol: float = TOL) -> Array:
    """Orthonormal basis of the null space, as columns."""
    if not matrix.size:
        return np.eye(matrix.shape[1])
    _, s, vt = np.linalg.svd(matrix)
    return np.asarray(vt[(s > tol * max(s[0], 1e-300)).sum() :].T)


def leaders(layout: Layout, joint: str) -> dict[str, str]:
    """Per wheel the first wheel that its joint is coupled to, directly or through others."""
    lead = {w["name"]: w["name"] for w in layout["wheels"]}
    order = list(lead)
    for kind, names in layout.get("couplings", []):
        if kind == joint:
            merged = {lead[n] for n in names}
            lead = {n: min(merged, key=order.index) if g in merged else g for n, g in lead.items()}
    return lead


def constraint(layout: Layout, steer: dict[str, float]) -> Array:
    """What constrains the twist when every joint is free but the couplings hold.

    The left null space of the joint-rate columns, times the twist columns.
    """
    a, b = contact_rows(layout, steer)
    return null(b.T).T @ a if b.size else a


def contact_rows(layout: Layout, steer: dict[str, float]) -> tuple[Array, Array]:
    """(A, B) with A twist + B rates = 0: every rolling and sliding row, coupled rates in one column."""
    spins, swivels = leaders(layout, "spin"), leaders(layout, "steer")
    rows, columns = [], []
    for wheel in layout["wheels"]:
        name = wheel["name"]
        for _, r, spin, rate in wheel_rows(wheel, steer.get(name, 0.0)):
            column = {}
            if spin:
                column[f"{spins[name]}.spin"] = spin
            # A steered wheel's rate is a free input chosen elsewhere: only a castor's follows the twist.
            if abs(rate) > 1e-15 and wheel["type"] == "castor":
                column[f"{swivels[name]}.steer"] = rate
            rows.append(r)
            columns.append(column)
    joints = sorted({joint for column in columns for joint in column})
    b = np.array([[column.get(joint, 0.0) for joint in joints] for column in columns])
    return np.array(rows).reshape(-1, 3), b.reshape(len(rows), len(joints))


def admissible_steering(layout: Layout, seed: int = 1) -> dict[str, float] | None:
    """Steering angles whose axles meet in one ICR and that the steer couplings allow, or None."""
    rng = np.random.default_rng(seed)
    allowed = null(constraint(unsteered(layout), {}))
    still = np.array([[0.0, 0.0, 1.0]])
    pure = allowed @ null(still @ allowed) if allowed.shape[1] else allowed
    for basis in (allowed, pure):  # any twist, else pure translation (belt-steered robots)
        if not basis.shape[1]:
            continue
        twist = basis @ rng.uniform(0.5, 1.5, basis.shape[1])
        steer = {w["name"]: steering(w, twist, 0.0) for w in layout["wheels"] if w["type"] == "steered"}
        groups = [names for joint, names in layout.get("couplings", []) if joint == "steer"]
        angles = [[steer[n] for n in names if n in steer] for names in groups]
        if all(abs(math.sin(a - g[0])) < 1e-9 for g in angles for a in g):
            return steer
    return None


def null_space_family(layout: Layout, steer: dict[str, float]) -> int:
    """Dimension of the family of null spaces reached by varying the ICR, by finite differences of the projector."""
    base = null(constraint(layout, steer))
    if base.shape[1] != 1:
        return 0
    seeds = range(2, 8)
    others = []
    for seed in seeds:
        moved = admissible_steering(layout, seed)
        if moved is not None:
            others.append(null(constraint(layout, moved))[:, 0])
    spread = np.array([base[:, 0], *others])
    return rank(spread) - 1


def mobility(layout: Layout) -> dict[str, int]:
    """degree_of_mobility, degree_of_steerability, rank_C1f, rank_C1 by SVD at ICR-compatible steering."""
    rank_f = rank(sliding_rows(layout, "fixed", {}))
    steer = admissible_steering(layout)
    if steer is None:
        return {"degree_of_mobility": 0, "degree_of_steerability": 0, "rank_C1f": rank_f, "rank_C1": 3}
    rank_c1 = rank(constraint(layout, steer))
    coupled = any(joint == "steer" for joint, _ in layout.get("couplings", []))
    delta_s = (
        null_space_family(layout, steer) if coupled else rank_c1 - rank(constraint(unsteered(layout), {}))
    )
    return {
        "degree_of_mobility": 3 - rank_c1,
        "degree_of_steerability": delta_s,
        "rank_C1f": rank_f,
        "rank_C1": rank_c1,
    }


def unsteered(layout: Layout) -> Layout:
    """The robot without its steered wheels and their couplings: what constrains it at any steering."""
    steered = {w["name"] for w in layout["wheels"] if w["type"] == "steered"}
    return {
        "wheels": [w for w in layout["wheels"] if w["name"] not in steered],
        "couplings": [
            (joint, [n for n in names if n not in steered]) for joint, names in layout.get("couplings", [])
        ],
    }


def expm(matrix: Array) -> Array:
    """Matrix exponential by scaling, Taylor series and squaring."""
    halvings = max(0, int(np.ceil(np.log2(max(np.abs(matrix).sum(), 1e-300)))) + 4)
    a = matrix / 2.0**halvings
    term = total = np.eye(len(a))
    for k in range(1, 25):
        term = term @ a / k
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return np.asarray(total)


def step(pose: Array, twist: Array, dt: float) -> Array:
    """Pose (x, y, theta) after a constant body twist for dt: the SE(2) exponential."""
    vx, vy, w = twist * dt
    motion = expm(np.array([[0.0, -w, vx], [w, 0.0, vy], [0.0, 0.0, 0.0]]))
    c, s = math.cos(pose[2]), math.sin(pose[2])
    dx, dy = motion[0, 2], motion[1, 2]
    return np.array([pose[0] + c * dx - s * dy, pose[1] + s * dx + c * dy, pose[2] + w])
