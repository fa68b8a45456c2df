"""What is recorded of real robots whose files contradict one another: each discrepancy has its code."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from defusedxml.ElementTree import fromstring

import wmrgen
from tests.conftest import GALLERY
from wmrgen.tools.comparing.compare import compare
from wmrgen.tools.comparing.record import SAME, JointName, Layout, Side
from wmrgen.tools.comparing.sources import layouts, of_controller, of_robot
from wmrgen.tools.importing.controllers import plugin_controllers

CORPUS = json.loads((Path(__file__).parent / "corpus.json").read_text(encoding="utf-8"))
_KEYS = {"heading_rad": "heading", "gamma_rad": "gamma"}
DRIVES = {
    "differential": "type: diff_drive_controller/DiffDriveController,"
    " wheel_separation: {track}, wheel_radius: {radius}",
    "mecanum": "type: mecanum_drive_controller/MecanumDriveController, wheel_separation_y: {track}",
    "omni": "type: omnidirectional_controllers/OmnidirectionalController, robot_radius: {ring}, wheel_radius: 0.1",
}


def side(name: str, kind: str, x: float, y: float, heading: float = 0, **more: float) -> Side:
    return Side((name,), kind, {"x": x, "y": y, "heading": heading, "r": 0.1, "d": 0, "offset_y": 0} | more)


def snapped(key: str, value: float) -> float:
    """An angle of the corpus, which has six decimals, as the multiple of 15 degrees that `import` takes it for."""
    step = math.pi / 12
    near = round(value / step) * step
    return near if key.endswith("_rad") and abs(value - near) < 2e-3 else value


def of_facts(wheels: list[dict[str, Any]]) -> Layout:
    sides = []
    for w in wheels:
        values = {_KEYS.get(k, k): snapped(k, v) for k, v in w.items() if isinstance(v, int | float)}
        joints = {
            kind: JointName(w[key]) for kind, key in (("spin", "joint"), ("steer", "steer_joint")) if key in w
        }
        names = [joint.name for joint in joints.values()] or ["wheel"]
        actuated = tuple(w["actuated"]) if "actuated" in w else None
        sides.append(Side(tuple(names), w["type"], values, {}, actuated, joints))
    return Layout("facts", "description", tuple(sides))


def controllers(entry: dict[str, Any], folder: Path) -> list[Layout]:
    if "plugin" in entry:
        read = plugin_controllers(fromstring(f"<robot>{entry['plugin']}</robot>"))
        return [of_controller(controller, "plugin") for controller in read]
    path = folder / "parameters.yaml"
    path.write_text(json.dumps(entry["parameters"]), encoding="utf-8")
    return layouts(path)


@pytest.mark.parametrize("entry", CORPUS["sets"], ids=lambda entry: entry["robot"])
def test_parameters_against_the_description_of_the_robot(entry: dict[str, Any], tmp_path: Path) -> None:
    robot, given = of_facts(entry["wheels"]), controllers(entry, tmp_path)
    assert given
    for controller in given:
        result = compare(robot, controller)
        assert {d.code for d in result.differences} == set(entry["codes"]), result
        for effect in result.effects:  # numbers that are equal may differ by 0.2 %, and so may the motion
            assert entry["codes"] or (effect.words == "" and effect.ratio == pytest.approx(1, abs=SAME))


def stated_robot(kind: str, key: str, value: float) -> Layout:
    track, radius = (value if key == k else other for k, other in (("track", 0.4), ("radius", 0.1)))
    if kind == "omni":
        wheels = [
            side(f"w{k}", "swedish", value * math.cos(a), value * math.sin(a), a + math.pi / 2, gamma=0)
            for k, a in enumerate((0.0, 2 * math.pi / 3, -2 * math.pi / 3))
        ]
    elif kind == "mecanum":
        wheels = [
            side(f"w{sx}{sy}", "swedish", sx * 0.2, sy * track / 2, gamma=-sx * sy * math.pi / 4)
            for sx in (1, -1)
            for sy in (1, -1)
        ]
    else:
        wheels = [side(name, "fixed", 0, s * track / 2, r=radius) for name, s in (("left", 1), ("right", -1))]
    return Layout("robot", "description", tuple(wheels))


@pytest.mark.parametrize("fact", CORPUS["stated"], ids=lambda f: f"{f['robot']}-{f['key']}")
def test_what_a_survey_states(fact: dict[str, Any], tmp_path: Path) -> None:
    values = {"track": 0.4, "radius": 0.1, "ring": 0.3} | {fact["key"]: fact["of_parameters"]}
    path = tmp_path / "p.yaml"
    path.write_text(f"drive: {{{DRIVES[fact['kind']].format(**values)}}}\n", encoding="utf-8")
    robot = stated_robot(fact["kind"], fact["key"], fact["of_robot"])
    (controller,) = layouts(path)
    result = compare(robot, controller)
    assert [d.code for d in result.differences] == fact["codes"], result
    for d in result.differences:
        assert (d.a, d.b) == (pytest.approx(fact["of_robot"]), pytest.approx(fact["of_parameters"]))


# ---- two descriptions of one robot


def modules(y: float, offset: float, swapped: bool = False, r: float = 0.09) -> Layout:
    """The Neobotix MPO-700: pivots at (0.24, y), contacts ``offset`` farther out."""
    wheels = [
        side(f"{end}_{name}", "steered", x, s * y, offset_y=s * offset, r=r)
        for end, x in (("front", 0.24), ("back", -0.24))
        for name, s in (("left", 1), ("right", -1))
    ]
    if swapped:  # labels: back_left stands in front on the right, back_right behind on the left
        names = {"back_left": "front_right", "back_right": "back_left", "front_right": "back_right"}
        turned = {v: k for k, v in names.items()}
        wheels = [Side((turned.get(w.name, w.name),), w.type, w.values) for w in wheels]
    return Layout("modules", "description", tuple(wheels))


def mecanum(wheelbase: float, track: float, r: float) -> Layout:
    wheels = [
        side(f"{end}_{name}", "swedish", a * wheelbase / 2, b * track / 2, gamma=-a * b * math.pi / 4, r=r)
        for end, a in (("front", 1), ("rear", -1))
        for name, b in (("left", 1), ("right", -1))
    ]
    return Layout("mecanum", "description", tuple(wheels))


def rover(rear: float, turning: bool = False) -> Layout:
    """JPL's rover, seen from its middle axle; what its drive commands take the rear corners for, and, ``turning`` in
    place, two that stand across."""
    across = {"left_back": -0.274, "right_front": 0.310} if turning else {}
    wheels = [
        side(f"{name}_{end}", kind, across.get(f"{name}_{end}", x), s * y)
        for end, kind, x, y in (
            ("front", "steered", 0.274, 0.177),
            ("back", "steered", rear, 0.177),
            ("middle", "fixed", 0, 0.253),
        )
        for name, s in (("left", 1), ("right", -1))
    ]
    return Layout("rover", "description", tuple(wheels))


def bicycle(front: float, rear: float) -> Layout:
    wheels = (side("front", "steered", front, 0), side("rear", "fixed", rear, 0))
    return Layout("bicycle", "description", wheels)


def ring(radii: tuple[float, ...]) -> Layout:
    wheels = [
        side(f"w{k}", "swedish", r * math.cos(a), r * math.sin(a), a - math.pi / 2, gamma=0)
        for k, (r, a) in enumerate(zip(radii, (math.pi / 3, math.pi, -math.pi / 3), strict=True))
    ]
    return Layout("ring", "description", tuple(wheels))


RECORDED = {  # of real_robots.json: what its sources contradict one another in
    "MPO-700, controller and description": (modules(0.19, 0.045), modules(0.18, 0.045), {"WMR040"}),
    "MPO-700, description and simulation": (modules(0.18, 0.045), modules(0.18, 0.05), {"WMR050"}),
    "MPO-700, radius of two drivers": (modules(0.19, 0.045), modules(0.19, 0.045, r=0.088), {"WMR042"}),
    "MPO-700, labels of the simulation": (
        modules(0.18, 0.045), modules(0.18, 0.045, swapped=True), {"WMR044", "WMR050"},
    ),
    "youBot, description and driver": (
        mecanum(0.456, 0.316, 0.05), mecanum(0.47, 0.30, 0.0475), {"WMR040", "WMR041", "WMR042"},
    ),
    "LeKiwi, driver and CAD": (ring((0.125,) * 3), ring((0.0992, 0.1192, 0.11)), {"WMR043", "WMR044"}),
    "rover, distances of the rear corners": (rover(-0.310), rover(-0.274), {"WMR041", "WMR044"}),
    "rover, turning in place": (rover(-0.310), rover(-0.310, turning=True), {"WMR044"}),
    "F1TENTH, simulator and odometry": (bicycle(0.15875, -0.17145), bicycle(0.25, 0), {"WMR041", "WMR044"}),
}  # fmt: skip


@pytest.mark.parametrize("case", RECORDED)
def test_two_descriptions_of_one_robot(case: str) -> None:
    a, b, codes = RECORDED[case]
    assert {d.code for d in compare(a, b).differences} == codes
    assert {d.code for d in compare(b, a).differences} == codes
    assert not compare(a, a).differences and not compare(b, b).differences


def test_a_controller_for_other_wheels_and_joints_that_are_not_there(tmp_path: Path) -> None:
    """Pepper: parameters of a differential drive for omni wheels. Hunter: parameters name joints that do not exist."""
    path = tmp_path / "p.yaml"
    path.write_text(
        "drive:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: rear_left_joint\n",
        encoding="utf-8",
    )
    (layout,) = layouts(path)
    assert [d.code for d in compare(ring((0.1,) * 3), layout).differences] == ["WMR049"]
    wheels = stated_robot("differential", "track", 0.5).wheels
    for joints, codes in (
        (frozenset({"left", "right"}), ["WMR048"]),
        (frozenset({"robot_rear_left_joint"}), []),
        (None, []),
    ):
        robot = Layout("robot", "description", wheels, joints=joints)
        assert [d.code for d in compare(robot, layout).differences] == codes


def test_any_parameters_against_any_robot_of_the_gallery(tmp_path: Path) -> None:
    """Robots without a driven wheel, with trailers, with rollers: there is an answer, never a failure."""
    kinds = ("andino", "clearpath_do100", "rbcar", "neobotix_mpo_700", "jpl_osr", "axebot")
    given = [c for e in CORPUS["sets"] if e["robot"] in kinds for c in controllers(e, tmp_path)]
    robots = [of_robot(*wmrgen.read(path), path.stem) for path in GALLERY]
    results = [compare(robot, c) for robot in robots for c in given]
    assert all(math.isfinite(e.ratio) for c in results for e in c.effects)
    chair = [c for c in results if c.a.file == "office_chair"]
    assert all(c.notes and not c.effects for c in chair)
