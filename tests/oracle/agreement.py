"""What a robot's functions must give, from contact velocities alone: `check_inverse`, `check_forward`.

A command is judged by what the wheels then do, so that either of two equally good branches will do.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.oracle import oracle
from tests.oracle.freedom import Freedom, castor_angles
from tests.oracle.stops import right

Array = NDArray[np.float64]
Layout = dict[str, Any]
Case = dict[str, float]
CAMPION = ((3, 0), (2, 0), (2, 1), (1, 1), (1, 2))
WIDE = math.radians(190)  # limits so far apart leave every wheel on a heading that rolls


@dataclass(frozen=True)
class Driven:
    """The twist that is driven for a commanded one, and the root mean square of what was taken away [m/s]."""

    twist: Array
    distance: float
    projected: bool


def refused(layout: Layout) -> bool:
    """Couplings that have no model: steered wheels with castors, and spins of offset steered wheels."""
    kind = {w["name"]: w for w in layout["wheels"]}
    for joint in ("steer", "spin"):
        lead = oracle.leaders(layout, joint)
        for group in set(lead.values()):
            members = [kind[n] for n, g in lead.items() if g == group]
            types = {w["type"] for w in members}
            if len(members) > 1 and {"steered", "castor"} <= types:
                return True
            offset = any(w["type"] == "steered" and w.get("o") for w in members)
            if joint == "spin" and len(members) > 1 and offset:
                return True
    return False


def _groups(layout: Layout, joint: str, *types: str) -> list[list[dict[str, Any]]]:
    lead = oracle.leaders(layout, joint)
    found: dict[str, list[dict[str, Any]]] = {}
    for w in layout["wheels"]:
        if w["type"] in types:
            found.setdefault(lead[w["name"]], []).append(w)
    return list(found.values())


def _norm(layout: Layout, wheels: list[Any], difference: Array) -> float:
    del layout
    speeds = [oracle.point_velocity(np.array([w["x"], w["y"]]), difference) for w in wheels]
    return math.sqrt(sum(float(v @ v) for v in speeds))


def drive(layout: Layout, freedom: Freedom, twist: Array) -> Driven:
    """The nearest twist that the constant constraints allow, where those leave the robot a type of its own."""
    fixed = [w for w in layout["wheels"] if w["type"] == "fixed"]
    rows = [oracle.constraint(oracle.unsteered(layout), castor_angles(layout, k)) for k in range(2)]
    rank, moving = oracle.rank(rows[0]), oracle.rank(np.vstack(rows)) > oracle.rank(rows[0])
    if rank == 1 and oracle.rank(oracle.sliding_rows(layout, "fixed", {})) == 1:
        _, n, contact = oracle.geometry(fixed[0], 0.0)
        lateral = float(n @ oracle.point_velocity(contact, twist))
        taken = np.array([*(n * lateral), 0.0])
        return Driven(twist - taken, math.sqrt(len(fixed)) * abs(lateral), True)
    if freedom.translates and freedom.mobility + freedom.steerability + rank == 2:
        steered = [w for w in layout["wheels"] if w["type"] == "steered"]
        centre = np.mean([[w["x"], w["y"]] for w in steered], axis=0)
        left = np.array([*oracle.point_velocity(centre, twist), 0.0])
        return Driven(left, _norm(layout, steered, twist - left), True)
    if rank == 1 and not moving and (freedom.mobility, freedom.steerability) in CAMPION:
        points = [oracle.row(d, np.array([w["x"], w["y"]])) for w in layout["wheels"] for d in np.eye(2)]
        weight = np.array(points)
        allowed = oracle.null(rows[0])
        left = allowed @ np.linalg.lstsq(weight @ allowed, weight @ twist, rcond=None)[0]
        return Driven(left, _norm(layout, layout["wheels"], twist - left), True)
    return Driven(twist, 0.0, False)


def check_inverse(layout: Layout, freedom: Freedom, case: Case, out: Case, tol: float) -> None:
    """Every command and the slip of one call of ``inverse``."""
    twist = np.array([case[k] for k in ("vx", "vy", "omega")])
    way = drive(layout, freedom, twist)
    scale = 1.0 + float(np.abs(twist).max())
    held, squares = _check_steering(layout, way.twist, case, out, tol * scale)
    squares += _check_castors(layout, way.twist, case, out, tol * scale)
    squares += _check_spins(layout, way, case, out, tol * scale)
    if held:
        squares.append(float(np.sum(np.square(held))))
    fixed = [w for w in layout["wheels"] if w["type"] == "fixed"]
    if not way.projected and fixed:
        squares.append(float(np.sum((oracle.sliding_rows(layout, "fixed", {}) @ twist) ** 2)))
    wanted = math.sqrt(way.distance**2 + sum(squares))
    assert abs(out["slip"] - wanted) <= tol * scale + 1e-7 * wanted, ("slip", out["slip"], wanted)


def _lateral(w: dict[str, Any], angle: float, twist: Array) -> float:
    n = oracle.geometry(w, angle)[1]
    return float(n @ oracle.point_velocity(np.array([w["x"], w["y"]]), twist))


def _check_steering(
    layout: Layout, twist: Array, case: Case, out: Case, tol: float
) -> tuple[list[float], list[float]]:
    """Lateral speeds of wheels that may be held back; they slide as at the right angle inside the limits."""
    held: list[float] = []
    for group in _groups(layout, "steer", "steered"):
        angle = out[f"{group[0]['name']}.steer"]
        signs = [w.get("sign", 1) * group[0].get("sign", 1) for w in group]
        turns = list(zip(group, signs, strict=True))
        assert all(abs(out[f"{w['name']}.steer"] - k * angle) <= tol for w, k in turns)

        def slides(t: float, turns: list[Any] = turns) -> float:
            return sum(_lateral(w, k * t, twist) ** 2 for w, k in turns)

        # a - b cos 2t - c sin 2t, from three angles
        a, b, c = slides(0.0), slides(math.pi / 4), slides(math.pi / 2)
        mean = (a + c) / 2
        best = math.atan2(mean - b, mean - a) / 2
        limits = group[0].get("limits")
        tries = {best}
        if limits:
            low = math.radians(limits["steer"][0])
            high = low + math.radians(limits["steer"][1])
            assert low - tol <= angle <= high + tol, ("limits", angle)
            tries = right(best, low, high, case[f"{group[0]['name']}.steer"], 1e-7)
        least, most = min(map(slides, tries)), max(map(slides, tries))
        assert least - tol <= slides(angle) <= most + tol, ("sliding", group[0]["name"], slides(angle), least)
        one = len({(round(w["x"], 9), round(w["y"], 9)) for w in group}) == 1 or not twist[2]
        same = (
            one
            and len(set(signs)) == 1
            and max(abs(math.remainder(w["heading"] - group[0]["heading"], math.tau)) for w in group) < 1e-9
        )
        if not same or (limits and high - low < WIDE):
            held += [_lateral(w, k * angle, twist) for w, k in turns]
        if not limits and not _geared(layout, group):
            swing = abs(angle - case[f"{group[0]['name']}.steer"])
            assert swing <= math.pi / 2 + 1e-6, ("swing", swing)
    return held, []


def _geared(layout: Layout, group: list[Any]) -> bool:
    lead = oracle.leaders(layout, "spin")
    return any(list(lead.values()).count(lead[w["name"]]) > 1 for w in group)


def _check_castors(layout: Layout, twist: Array, case: Case, out: Case, tol: float) -> list[float]:
    """Swivel rates, and what a common rate leaves of the sliding rows."""
    squares = []
    for group in _groups(layout, "steer", "castor"):
        slide = []
        for w in group:
            _, n, contact = oracle.geometry(w, case[f"{w['name']}.steer"])
            slide.append(float(n @ oracle.point_velocity(contact, twist)))
        offsets = np.array([w["d"] for w in group])
        rate = -float(offsets @ slide) / float(offsets @ offsets)
        for w in group:
            assert abs(out[f"{w['name']}.steer_rate"] - rate) * min(map(abs, offsets)) <= tol, "steer_rate"
        squares.append(float(np.sum((np.array(slide) + offsets * rate) ** 2)) if len(group) > 1 else 0.0)
    return squares


def _rim(w: dict[str, Any], twist: Array, case: Case, out: Case) -> tuple[float, float]:
    """What spin times radius must be, and the radius, at the commanded angle and rate."""
    name = w["name"]
    steer = (
        out.get(f"{name}.steer", case.get(f"{name}.steer", 0.0))
        if w["type"] != "castor"
        else case[f"{name}.steer"]
    )
    for kind, row, spin, rate in oracle.wheel_rows(w, steer):
        if kind == "rolling":
            turning = out.get(f"{name}.steer_rate", 0.0) if w["type"] == "castor" else 0.0
            return float(row @ twist) + rate * turning, -spin
    raise AssertionError(name)


def _check_spins(layout: Layout, way: Driven, case: Case, out: Case, tol: float) -> list[float]:
    """Spins; what a common one leaves of the rolling rows; chained wheels roll the same way round."""
    squares: list[float] = []
    for group in _groups(layout, "spin", "fixed", "steered", "castor", "swedish"):
        rims, radii = map(np.array, zip(*(_rim(w, way.twist, case, out) for w in group), strict=True))
        spin = float(radii @ rims) / float(radii @ radii)
        for w, r in zip(group, radii, strict=True):
            assert abs(out[f"{w['name']}.spin"] - spin) * abs(r) <= tol * 10, ("spin", w["name"])
        if len(group) == 1:
            continue
        rest = float(np.sum((rims - radii * spin) ** 2))
        if any(w["type"] in ("steered", "castor") for w in group):
            squares.append(rest)
            _check_way(layout, group, rims * radii, tol)
        elif not way.projected:
            squares.append(rest)
    return squares


def _check_way(layout: Layout, group: list[Any], turning: Array, tol: float) -> None:
    """Steered wheels of one chain, each with an angle of its own and no limits: none runs backwards."""
    lead = oracle.leaders(layout, "steer")
    alone = [list(lead.values()).count(lead[w["name"]]) == 1 and "limits" not in w for w in group]
    unsteered = [w["type"] != "steered" for w in group]
    if any(unsteered):
        way = float(turning[unsteered].sum())
    elif all(alone):
        way = float(turning[0])
    else:
        return
    for w, rate, free in zip(group, turning, alone, strict=True):
        if w["type"] == "steered" and free:
            assert rate * way >= -tol, ("runs backwards", w["name"], rate, way)


def check_forward(layout: Layout, sensed: Case, out: Case, tol: float) -> None:
    """The least-squares twist of the sensed rows and what it leaves over."""
    rows, _ = oracle.measured_rows(layout, sensed)
    twist, residual, rank = oracle.forward(layout, sensed)
    if len(rows):
        s = np.linalg.svd(rows / np.array([1.0, 1.0, _reach(layout)]), compute_uv=False)
        if any(1e-9 < v / s[0] < 5e-3 for v in s):
            return  # too near to a lost rank, which is taken for one at run time
    size = 1.0 + max((abs(v) for v in sensed.values()), default=0.0)
    found = np.array([out[k] for k in ("vx", "vy", "omega")])
    low = min((v for v in np.linalg.svd(rows, compute_uv=False) if v > 1e-9), default=1.0) if rank else 1.0
    slack = tol * size * max(1.0, 1 / float(low) ** 2)
    assert np.abs(found - twist).max() <= slack, ("twist", found, twist)
    assert abs(out["slip"] - residual) <= slack, ("residual", out["slip"], residual)


def _reach(layout: Layout) -> float:
    return max(math.hypot(w["x"], w["y"]) for w in layout["wheels"]) or 1.0
