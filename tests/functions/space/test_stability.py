"""The support polygon and its margins (after Kelly 4.1.3; the formula is ours, so the oracle is geometric)."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.conftest import Outcome
from tests.depth import BACKENDS
from tests.functions.common import CASES, PAIR, ROBOTS, call, derived, write
from tests.functions.refusals import refused
from tests.robots import of_text
from wmrgen.functions.registry import Reason
from wmrgen.functions.space.stability import polygon

Array = NDArray[np.float64]
CG = "cg: {{x: {x}, y: {y}, z: {z}}}\n"
TWO = ("bicycle", "f1tenth", "locked_bicycle", "textbook_differential", "unicycle")  # contacts at most
THREE = [p for p in ROBOTS if p.stem not in TWO]


def car(half_track: float, height: float) -> str:
    wheels = "".join(
        f"  - {{name: {n}, type: fixed, x: {x}, y: {y}, heading: 0, r: 0.2}}\n"
        for n, x, y in (
            ("front_left", 2, half_track), ("front_right", 2, -half_track),
            ("rear_left", -2, half_track), ("rear_right", -2, -half_track),
        )
    )  # fmt: skip
    return f"wmrgen: 1\nname: car\nwheels:\n{wheels}" + CG.format(x=0, y=0, z=height)


@pytest.mark.parametrize("backend", BACKENDS)
def test_case_ke_liftoff(backend: str, tmp_path: Path) -> None:
    g, expect = CASES["KE-liftoff"]["given"], CASES["KE-liftoff"]["expect"]
    path = write(tmp_path, car(g["half_track"], g["cg_height"]))
    result = call(path, "stability", {"fy": g["a_lateral"], "fz": g["g"]}, backend)
    assert result["margin"] == pytest.approx(expect["margin_angle"], abs=1e-9)
    assert result["rear_right.margin"] == result["margin"]  # rear_right - front_right: out of a left turn
    assert result["fy_max"] == pytest.approx(expect["a_lateral_limit"], abs=1e-9)
    assert (result["margin"] <= 0) is expect["liftoff"]
    beyond = call(path, "stability", {"fy": expect["a_lateral_limit"] + 1e-6, "fz": g["g"]}, backend)
    at = call(path, "stability", {"fy": expect["a_lateral_limit"], "fz": g["g"]}, backend)
    assert beyond["margin"] < 0 and at["margin"] == pytest.approx(0, abs=1e-9)


def contacts(path: Path, steer: dict[str, float]) -> dict[str, Array]:
    """Where the wheels touch the ground, from the nominal geometry."""
    result = {}
    for w in derived(path, "stability").robot.wheels:
        h = w.heading + (steer.get(w.name, 0.0) if w.turns else 0.0)
        e, n = np.array([math.cos(h), math.sin(h)]), np.array([-math.sin(h), math.cos(h)])
        g = w.nominal
        result[w.name] = np.array([float(g.x), float(g.y)]) + float(g.d) * e + float(g.o) * n
    return result


def inside(points: list[Array], q: Array) -> float:
    """Least signed distance of q to the lines of the convex hull: positive inside; by brute force over pairs."""
    least = math.inf
    for a in points:
        for b in points:
            u = b - a
            if not np.hypot(*u) > 1e-9:
                continue
            sides = [(u[0] * (c - a)[1] - u[1] * (c - a)[0]) / np.hypot(*u) for c in points]
            if min(sides) > -1e-9:
                least = min(least, (u[0] * (q - a)[1] - u[1] * (q - a)[0]) / np.hypot(*u))
    return least


def tilted(force: Array, axis: Array, angle: float) -> Array:
    """The force turned about a horizontal axis (Rodrigues)."""
    axis = np.array([*axis, 0.0]) / np.hypot(*axis)
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(c * force + s * np.cross(axis, force) + (1 - c) * axis * (axis @ force))


@pytest.mark.parametrize("robot", THREE, ids=lambda p: p.stem)
def test_margin_is_positive_where_the_force_meets_the_polygon(robot: Path, tmp_path: Path) -> None:
    """Against the point where the ray from the centre of gravity meets the ground, castors at any angle."""
    text = robot.read_text(encoding="utf-8")
    generator = np.random.default_rng(11)
    places = contacts(write(tmp_path, text + CG.format(x=0, y=0, z=1)), {})
    x, y = np.mean(list(places.values()), axis=0)
    size = 1.2 * max(inside(list(places.values()), np.array([x, y])), 0.02)
    path = write(tmp_path, text + CG.format(x=repr(float(x)), y=repr(float(y)), z=0.4))
    turning = [w.name for w in derived(path, "stability").robot.wheels if w.turns]
    inputs = {p.name for p in derived(path, "stability").formula("stability").inputs}
    seen = set()
    for _ in range(25):
        steer = {n: float(generator.uniform(-3, 3)) for n in turning}
        steer = coupled(path, steer)
        f = np.array([*generator.normal(0, 9.81 * size / 0.4, 2), 9.81])
        case = dict(zip(("fx", "fy", "fz"), map(float, f), strict=True))
        case |= {f"{n}.steer": v for n, v in steer.items() if f"{n}.steer" in inputs}
        result = call(path, "stability", case)
        meets = np.array([x, y]) - 0.4 * f[:2] / f[2]
        points = contacts(path, steer)
        depth = inside(list(points.values()), meets)
        if abs(depth) > 1e-7:
            assert (result["margin"] > 0) == (depth > 0)
            seen.add(depth > 0)
        for axis in ("fx", "fy"):
            for end in (result[f"{axis}_min"], result[f"{axis}_max"]):
                if result["margin"] > 0 and abs(end) < 1e8:
                    assert call(path, "stability", case | {axis: end})["margin"] == pytest.approx(0, abs=1e-7)
    assert seen == {True, False}


def coupled(path: Path, steer: dict[str, float]) -> dict[str, float]:
    robot = derived(path, "stability").robot
    return {n: steer[robot.wheels[robot.steer_group[robot.wheel(n).index]].name] for n in steer}


def test_the_margin_is_the_tilt_that_is_left(tmp_path: Path) -> None:
    """Turning the force about an edge by the edge's margin, with no force along it, brings the robot to liftoff."""
    path = write(tmp_path, car(0.35, 0.6))
    points = contacts(path, {})
    for a, b, force in (
        ("rear_right", "front_right", np.array([0.0, 2.0, 9.81])),
        ("front_right", "front_left", np.array([-3.0, 0.0, 9.81])),
        ("front_left", "rear_left", np.array([0.0, -1.0, 9.0])),
    ):
        margin = call(path, "stability", dict(zip(("fx", "fy", "fz"), map(float, force), strict=True)))[
            f"{a}.margin"
        ]
        ends = [tilted(force, points[b] - points[a], sign * margin) for sign in (1, -1)]
        margins = [
            call(path, "stability", dict(zip(("fx", "fy", "fz"), map(float, f), strict=True)))[f"{a}.margin"]
            for f in ends
        ]
        assert min(map(abs, margins)) == pytest.approx(0, abs=1e-9)


def test_castors_move_the_polygon(tmp_path: Path) -> None:
    pioneer = next(p for p in ROBOTS if p.stem == "pioneer3dx")
    path = write(tmp_path, pioneer.read_text(encoding="utf-8") + CG.format(x=-0.05, y=0, z=0.3))
    back = call(path, "stability", {"fx": 1.0, "fz": 9.81})
    turned = call(path, "stability", {"fx": 1.0, "fz": 9.81, "tail.steer": math.pi})
    assert back["fx_max"] == pytest.approx(turned["fx_max"]) or back["fx_max"] > turned["fx_max"]
    sideways = call(path, "stability", {"fz": 9.81, "tail.steer": math.pi / 2})
    assert sideways["fy_max"] != pytest.approx(-sideways["fy_min"], rel=1e-3)


def test_twin_wheels_take_turns_at_the_corners(tmp_path: Path) -> None:
    """The corners of a PR2 base change as its castors turn; the polygon and the margins follow."""
    robot = next(p for p in ROBOTS if p.stem == "pr2")
    path = write(tmp_path, robot.read_text(encoding="utf-8") + CG.format(x=0, y=0, z=0.6))
    base = derived(path, "stability").robot
    corners = {polygon(base, {w.name: 0.01 + k * math.pi / 4 for w in base.wheels}) for k in range(8)}
    assert len(corners) > 2
    names = polygon(base, {w.name: 0.3 for w in base.wheels})
    result = call(path, "stability", {"fz": 9.81} | {f"{w.name}.steer": 0.3 for w in base.wheels})
    for w in base.wheels:
        assert (result[f"{w.name}.margin"] < 3.14) == (w.name in names)


@pytest.mark.parametrize("seed", range(6))
def test_corners_are_the_places_that_others_do_not_span(seed: int) -> None:
    """Each place once, counter-clockwise: also where wheels stand in one place or in the middle of an edge."""
    places = np.random.default_rng(seed).integers(0, 3, (9, 2))
    names = [f"w{k}" for k in range(len(places))]
    wheels = "".join(
        f"  - {{name: {n}, type: spherical, x: {x}, y: {y}}}\n"
        for n, (x, y) in zip(names, places, strict=True)
    )
    corners = polygon(of_text(f"wmrgen: 1\nname: balls\nwheels:\n{wheels}").robot, {})
    at = [complex(*places[names.index(n)]) for n in corners]
    for a, b, c in zip(at, at[1:] + at[:1], at[2:] + at[:2], strict=True):
        assert ((b - a).conjugate() * (c - b)).imag > 0
        assert all(((b - a).conjugate() * (complex(*p) - a)).imag >= 0 for p in places)


LINE = PAIR + "  - {name: middle, type: spherical, x: 0, y: 0}\n"


@pytest.mark.parametrize(
    ("text", "reason", "names"),
    [
        (LINE + CG.format(x=0, y=0, z=0.3), Reason.NO_POLYGON, ("3 contacts",)),
        (PAIR + CG.format(x=0, y=0, z=0.3), Reason.CENTRE_OF_GRAVITY, ("2 contacts",)),
        (PAIR + "  - {name: tail, type: spherical, x: -0.2, y: 0}\n", Reason.NO_CENTRE_OF_GRAVITY, ("cg",)),
        (
            PAIR + "  - {name: tail, type: spherical, x: -0.2, y: 0}\n" + CG.format(x=0, y=0, z=0),
            Reason.CENTRE_OF_GRAVITY,
            ("cg", "z > 0"),
        ),
    ],
)
def test_robots_without_a_polygon_or_a_centre_of_gravity_are_refused(
    text: str, reason: Reason, names: tuple[str, ...], tmp_path: Path
) -> None:
    with refused(reason, *names):
        derived(write(tmp_path, text), "stability").formula("stability")


def test_the_command_names_the_line_of_liftoff(tmp_path: Path, wmrgen_cli: Callable[..., Outcome]) -> None:
    path = write(tmp_path, car(0.35, 0.6))
    stands = wmrgen_cli("stability", path, "fy=4", "fz=9.81")
    assert (
        stands.code == 0
        and "stands; 0.140907 rad to liftoff about the line rear_right - front_right" in stands.out
    )
    lifts = wmrgen_cli("stability", path, "fy=-6", "fz=9.81")
    assert "liftoff about the line front_left - rear_left at -0.0" in lifts.out
    result = json.loads(wmrgen_cli("stability", path, "fy=4", "fz=9.81", "--json").out)
    assert result["about"] == ["rear_right", "front_right"] and not result["liftoff"]
    assert result["fy"] == pytest.approx([-5.7225, 5.7225])
