"""The articulated wheel (Kelly (4.30), (4.31)) and the specific force (Kelly 4.1.3)."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import sympy
from numpy.typing import NDArray

from tests.depth import BACKENDS
from tests.functions.common import CASES, PAIR, ROBOTS, call, derived, write
from wmrgen.functions.space.wheel_motion import Frame, Point, cross, plus, scaled, seen_from_before
from wmrgen.geometry.symbolic import signal

Array = NDArray[np.float64]
OFFSET = """\
wmrgen: 1
name: offset
wheels:
  - {name: front,  type: steered, x: 0.8, y: -0.35, heading: 20 deg, offset_y: 0.06, r: 0.1}
  - {name: castor, type: castor,  x: -0.4, y: 0.3,  heading: 130 deg, d: 0.05, offset_y: -0.02, r: 0.07}
  - {name: rear,   type: fixed,   x: -0.2, y: 0.1,  heading: 0, r: 0.12}
"""


def vector(name: str) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
    x, y, z = (signal(f"{name}.{k}") for k in "xyz")
    return x, y, z


def vanishes(a: object, b: object) -> bool:
    return all(sympy.expand(p - q) == 0 for p, q in zip(a, b, strict=True))  # type: ignore[call-overload]


def test_kelly_4_30_and_4_31_are_the_recursion_taken_twice() -> None:
    """v_c and a_c of the articulated wheel as printed, Omega read as omega; all vectors in one frame."""
    r_s, r_c, v_o, a_o = (vector(n) for n in ("r_s", "r_c", "v_o", "a_o"))
    v, w, a, alpha = (vector(n) for n in ("v", "w", "a", "alpha"))
    vs, ws, as_, alphas = (vector(n) for n in ("vs", "ws", "as", "alphas"))
    wheel = seen_from_before(Frame(vs, ws, as_, alphas), r_s, Point(r_c, v_o, a_o))
    nothing = (sympy.S.Zero,) * 3
    result = seen_from_before(Frame(v, w, a, alpha), nothing, wheel)
    r_v = plus(r_s, r_c)
    assert vanishes(result.v, plus(v, cross(w, r_v), vs, cross(ws, r_c), v_o))
    seen = plus(vs, cross(ws, r_c), v_o)  # v_c^v
    steering = plus(as_, cross(alphas, r_c), cross(ws, cross(ws, r_c)), scaled(2, cross(ws, v_o)), a_o)
    body = plus(a, cross(alpha, r_v), cross(w, cross(w, r_v)), scaled(2, cross(w, seen)))
    assert vanishes(result.a, plus(body, steering))


def test_kelly_4_24_and_4_25_corrected_as_matrices() -> None:
    """The step is H(r) (v, omega) + v_o and H(r) (a, alpha) + Omega(omega) (r, v_o) + a_o."""

    def skew(u: sympy.Matrix) -> sympy.Matrix:
        return sympy.Matrix([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])

    r, v_o, a_o, v, w, a, alpha = (vector(n) for n in ("r", "v_o", "a_o", "v", "w", "a", "alpha"))
    result = seen_from_before(Frame(v, w, a, alpha), (sympy.S.Zero,) * 3, Point(r, v_o, a_o))
    columns = [sympy.Matrix(u) for u in (r, v_o, a_o, v, w, a, alpha)]
    mr, mv, mao, mvf, mw, ma, mal = columns
    h = sympy.Matrix.hstack(sympy.eye(3), -skew(mr))
    omega = sympy.Matrix.hstack(skew(mw) ** 2, 2 * skew(mw))
    assert vanishes(result.v, h * sympy.Matrix([mvf, mw]) + mv)
    assert vanishes(result.a, h * sympy.Matrix([ma, mal]) + omega * sympy.Matrix([mr, mv]) + mao)


def rotation(axis: Array, angle: float) -> Array:
    """Rodrigues."""
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * k @ k)


def poly(c: Array, t: float) -> Array:
    return np.asarray(c[0] + c[1] * t + c[2] * t * t / 2)


@pytest.mark.parametrize("backend", BACKENDS)
def test_contacts_move_as_positions_in_the_world_do(backend: str, tmp_path: Path) -> None:
    """Second differences of world positions of the contacts: body tumbling, steering and suspension moving."""
    path = write(tmp_path, OFFSET)
    robot = derived(path, "wheel_motion").robot
    generator = np.random.default_rng(3)
    origin = generator.uniform(-1, 1, (3, 3))
    axis = np.array([0.3, -0.5, 0.81])
    axis /= np.linalg.norm(axis)
    other = np.array([0.0, 0.6, 0.8])
    paces = generator.uniform(-1, 1, (2, 2))
    joints = {w.name: generator.uniform(-1, 1, (2, 3)) for w in robot.wheels}

    def attitude(t: float) -> Array:
        first, second = (p[0] * t + p[1] * t * t / 2 for p in paces)
        return np.asarray(rotation(axis, 0.4 + first) @ rotation(other, -0.7 + second))

    def position(name: str, t: float) -> Array:
        w = robot.wheel(name)
        steer, travel = (float(poly(c, t)) for c in joints[name])
        h = w.heading + (steer if w.turns else 0.0)
        d, o, r = (float(v) for v in (w.nominal.d, w.nominal.o, w.nominal.r))
        e, n = np.array([math.cos(h), math.sin(h), 0]), np.array([-math.sin(h), math.cos(h), 0])
        hub = np.array([float(w.nominal.x), float(w.nominal.y), r + travel])
        return np.asarray(poly(origin, t) + attitude(t) @ (hub + d * e + o * n - np.array([0, 0, r])))

    def omega(t: float) -> Array:
        step = 1e-4
        rate = (attitude(t + step) - attitude(t - step)) / (2 * step)
        spin = attitude(t).T @ rate  # body axes
        return np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0], spin[1, 0] - spin[0, 1]]) / 2

    back = attitude(0.0).T
    inputs: dict[str, float] = {}
    for name, value in (("v", back @ origin[1]), ("w", omega(0.0)), ("a", back @ origin[2])):
        inputs |= {f"{name}{k}": float(x) for k, x in zip("xyz", value, strict=True)}
    rate = (omega(1e-3) - omega(-1e-3)) / 2e-3
    inputs |= {f"w{k}_rate": float(x) for k, x in zip("xyz", rate, strict=True)}
    for w in robot.wheels:
        for joint, c in zip(("steer", "travel"), joints[w.name], strict=True):
            if joint == "travel" or w.turns:
                names = (joint, f"{joint}_rate", f"{joint}_acceleration")
                inputs |= {f"{w.name}.{n}": float(x) for n, x in zip(names, c, strict=True)}
    result = call(path, "wheel_motion", inputs, backend)
    h = 1e-3
    for w in robot.wheels:
        before, at, after = (position(w.name, t) for t in (-h, 0.0, h))
        v, a = back @ (after - before) / (2 * h), back @ (after - 2 * at + before) / h**2
        assert [result[f"{w.name}.v{k}"] for k in "xyz"] == pytest.approx(list(v), abs=1e-5)
        assert [result[f"{w.name}.a{k}"] for k in "xyz"] == pytest.approx(list(a), abs=1e-5)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda p: p.stem)
def test_in_the_plane_the_contacts_do_what_the_constraints_say(robot: Path) -> None:
    """Driven by `accelerations`, contacts of fixed, steered and castor wheels do not slide and move by r spin."""
    d = derived(robot, "inverse", "wheel_motion", "accelerations")
    if d.mobility.degenerate:
        return
    from tests.functions.space.test_accelerations import Drive, twist

    drive = Drive(robot)
    joints = drive.accelerations(0.0, drive.start)
    plane = twist(drive.profile, 0.0, 0)
    slip = call(robot, "inverse", plane | drive.start)["slip"]
    if slip > 1e-9:
        plane |= {"vy": 0.0}
        joints = call(robot, "accelerations", plane | drive.start)
        if call(robot, "inverse", plane | drive.start)["slip"] > 1e-9:
            return
    inputs = {"vx": plane["vx"], "vy": plane["vy"], "wz": plane["omega"]}
    for w in d.robot.wheels:
        if w.turns:
            inputs[f"{w.name}.steer"] = joints.get(f"{w.name}.steer", drive.start[f"{w.name}.steer"])
            inputs[f"{w.name}.steer_rate"] = joints[f"{w.name}.steer_rate"]
    result = call(robot, "wheel_motion", inputs)
    for w in d.robot.wheels:
        if w.type in ("fixed", "steered", "castor"):
            h = w.heading + inputs.get(f"{w.name}.steer", 0.0)
            vx, vy = result[f"{w.name}.vx"], result[f"{w.name}.vy"]
            assert vy * math.cos(h) - vx * math.sin(h) == pytest.approx(0, abs=1e-9)
            spin = float(w.nominal.r) * joints[f"{w.name}.spin"]
            assert vx * math.cos(h) + vy * math.sin(h) == pytest.approx(spin, abs=1e-9)
        assert result[f"{w.name}.vz"] == 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_case_ke_specific_force(backend: str, tmp_path: Path) -> None:
    """The robot's own function: the case's arm from the sensor to the centre of gravity."""
    g, expect = CASES["KE-specific-force"]["given"], CASES["KE-specific-force"]["expect"]
    path = write(tmp_path, PAIR + "cg: {x: 0.6, y: 0.3, z: 0.4}\n")
    inputs = {f"f{k}": v for k, v in zip("xyz", g["t_sensor"], strict=True)}
    inputs |= {f"w{k}": v for k, v in zip("xyz", g["omega"], strict=True)}
    inputs |= {f"w{k}_rate": v for k, v in zip("xyz", g["alpha"], strict=True)}
    inputs |= {f"sensor.{k}": c - r for k, c, r in zip("xyz", (0.6, 0.3, 0.4), g["r_cg"], strict=True)}
    result = call(path, "cg_force", inputs, backend)
    assert [result[f"f{k}"] for k in "xyz"] == pytest.approx(expect["t_cg"], abs=1e-9)
