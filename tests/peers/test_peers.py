"""Test vectors of other projects, replayed through the Python API and the command line.

The peer, its commit and the test it comes from stand in vectors.json. Frames differ: a twist may be given in
the world (``heading``), or at a point other than the origin (``center_of_rotation``); speeds may be rim speeds
(radius 1). ``order`` is the order of the wheels in a vector's lists.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import command_line
from tests.oracle.harness import Model, named, robot_text, turn

Vector = dict[str, Any]
KINDS = ("ik", "fk", "steered_ik", "steered_fk", "odometry_open_loop")
VECTORS: list[Vector] = [
    v
    for v in json.loads((Path(__file__).parent / "vectors.json").read_text(encoding="utf-8"))
    if v["kind"] in KINDS
]
FUNCTION = {"ik": "inverse", "steered_ik": "inverse", "fk": "forward", "steered_fk": "forward"}


def layout(vector: Vector) -> dict[str, Any]:
    """The peer's robot. Steered wheels have their zero along robot x."""
    wheels = [
        {"name": w["name"], "type": w["type"], "x": w["x"], "y": w["y"], "heading": w.get("roll_dir_rad", 0.0),
         "r": w["radius"], "gamma": w.get("gamma_rad", 0.0)}
        for w in vector["robot"]["wheels"]
    ]  # fmt: skip
    return {"wheels": wheels}


def inputs(vector: Vector) -> dict[str, float]:
    """The vector's givens under the contract's names."""
    g, order = vector["given"], vector["robot"]["order"]
    if vector["kind"] == "odometry_open_loop":
        return dict(zip(("x", "y", "theta"), g["pose0"], strict=True)) | g["twist"] | {"dt": g["dt"]}
    if "wheels" in g:
        return {f"{n}.spin": v for n, v in zip(order, g["wheels"], strict=True)}
    if "modules_speed_angledeg" in g:
        pairs = list(zip(order, g["modules_speed_angledeg"], strict=True))
        steer = {f"{n}.steer": math.radians(angle) for n, (_, angle) in pairs}
        return {f"{n}.spin": speed for n, (speed, _) in pairs} | steer
    if "world_vx" in g:
        return named(turn(-g["heading"]) @ [g["world_vx"], g["world_vy"], g["omega"]])
    vx, vy, omega = g["twist"]["vx"], g["twist"]["vy"], g["twist"]["omega"]
    x, y = g.get("center_of_rotation", (0.0, 0.0))
    return named([vx + omega * y, vy - omega * x, omega])  # from that point to the origin


def compare(vector: Vector, found: dict[str, float]) -> None:
    e, order, tol = vector["expect"], vector["robot"]["order"], vector["tol_num"]
    if "twist" in e:
        for name, value in e["twist"].items():
            assert found[name] == pytest.approx(value, abs=tol)
    if "pose" in e:
        assert [found[n] for n in ("x", "y")] == pytest.approx(e["pose"][:2], abs=tol)
        assert found["theta"] == pytest.approx(e["pose"][2], rel=4 * 2.3e-16)
    for name, value in zip(order, e.get("wheels", []), strict=False):
        assert found[f"{name}.spin"] == pytest.approx(value, abs=tol)
    angles = [math.radians(a) for a in e["angles_deg"]] if "angles_deg" in e else e.get("angles_rad", [])
    loose = math.radians(0.1) if "angles_deg" in e else tol
    for name, angle in zip(order, angles, strict=False):
        half_turns = (found[f"{name}.steer"] - angle) / math.pi
        assert abs(half_turns - round(half_turns)) * math.pi <= loose  # a reversed wheel is the same wheel
        assert abs(found[f"{name}.steer"]) <= math.pi / 2 + 1e-12  # nearest to the present angle, 0
    for name, angle, speed in zip(order, angles, e.get("speeds", []), strict=False):
        forward = round((found[f"{name}.steer"] - angle) / math.pi) % 2 == 0
        assert found[f"{name}.spin"] == pytest.approx(speed if forward else -speed, abs=tol)


def test_all_vectors_of_these_kinds() -> None:
    assert Counter(v["kind"] for v in VECTORS) == {
        "ik": 8,
        "fk": 7,
        "steered_ik": 9,
        "steered_fk": 1,
        "odometry_open_loop": 1,
    }
    assert all(v["geometric_truth"] for v in VECTORS)


@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: f"{v['id']}-{v['case']}")
@pytest.mark.parametrize("polar", [False, True], ids=["xy", "polar"])
def test_python(vector: Vector, polar: bool, tmp_path: Path) -> None:
    model = Model.of(robot_text(layout(vector), polar=polar), tmp_path)
    compare(vector, model.call(FUNCTION.get(vector["kind"], "odometry"), inputs(vector)))


@pytest.mark.parametrize("vector", VECTORS, ids=lambda v: f"{v['id']}-{v['case']}")
def test_command_line(vector: Vector, tmp_path: Path) -> None:
    robot, cases = tmp_path / "case.yaml", tmp_path / "cases.json"
    robot.write_text(robot_text(layout(vector)), encoding="utf-8")
    cases.write_text(json.dumps([inputs(vector)] * 2), encoding="utf-8")
    function = FUNCTION.get(vector["kind"], "odometry")
    result = command_line("eval", robot, function, "--cases", cases)
    assert result.code == 0, result.err
    first, second = json.loads(result.out)
    assert first == second
    compare(vector, first)
