"""What looks like a wheel and is none is left out in words: parts in the air, limbs, propellers, simulators' wheels."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import cylinder, joint, link, pair, robot, wheel

Cli = Callable[..., Outcome]
Import = Callable[..., dict[str, Any]]
LIMITS = '<limit lower="-1" upper="1"/>'
MESH = '<mesh filename="package://x/wheel.stl"/>'


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Import:
    def call(text: str) -> dict[str, Any]:
        (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
        done = wmrgen_cli("import", tmp_path / "probe.urdf", "-o", tmp_path / "probe.yaml", "--json")
        said = json.loads(done.out) if done.code == 0 else {"wheels": [], "questions": []}
        return {
            "code": done.code,
            "names": [w["name"] for w in said["wheels"]],
            "asked": {(q["wheel"], q["key"]): q["hints"] for q in said["questions"]},
            "notes": done.err,
            "text": (tmp_path / "probe.yaml").read_text(encoding="utf-8") if done.code == 0 else "",
        }

    return call


def body(name: str, *shapes: tuple[str, str, str]) -> str:
    """A link of several shapes: role, place and geometry."""
    parts = (
        f'<{role}><origin xyz="{xyz}" rpy="1.5707963 0 0"/><geometry>{geometry}</geometry></{role}>'
        for role, xyz, geometry in shapes
    )
    return f'<link name="{name}">{"".join(parts)}</link>'


def test_wheels_whose_joints_have_limits(read: Import) -> None:
    said = read(robot(pair(kind="revolute", more=LIMITS).replace("left", "left_wheel")))
    assert said["code"] == 2
    assert "'left_wheel_joint' is not taken for a wheel: it has limits, and turns no further" in said["notes"]


def test_wheels_in_the_air(read: Import) -> None:
    """The frame of the rear is written 0.4 m too high: two wheels are left, and what carries the rest is asked."""
    rear = [
        f'<joint name="{n}_spin" type="continuous"><origin xyz="-0.5 {y} 0.5"/><parent link="base_link"/>'
        f'<child link="{n}_wheel"/><axis xyz="0 1 0"/></joint>{link(f"{n}_wheel", cylinder("0.1"))}'
        for n, y in (("rl", 0.25), ("rr", -0.25))
    ]
    said = read(robot(pair(), *rear))
    assert said["names"] == ["left", "right"] and list(said["asked"]) == [("support", "type")]
    assert "'rl_spin' is not taken for a wheel: it stands 0.4 m above the ground" in said["notes"]
    assert any("'rr_spin', where it stands 0.4 m above" in hint for hint in said["asked"]["support", "type"])


@pytest.mark.parametrize(("height", "told"), [("0.8", True), ("0.12", False)])
def test_a_steering_wheel_is_told_and_a_wheel_on_uneven_ground_is_one(
    read: Import, height: str, told: bool
) -> None:
    """Within 0.35 r + 5 mm of the ground a wheel stands."""
    said = read(robot(pair(), wheel("rear_wheel", f"-0.3 0 {height}"), wheel("tail", "-0.4 0 0.1")))
    assert ("'rear_wheel_joint' is not taken" in said["notes"]) is told
    assert ("rear" in said["names"]) is not told


@pytest.mark.parametrize("geometry", [MESH, cylinder("0.1")])
def test_a_wheel_in_the_air_on_a_rocker_is_noted(read: Import, geometry: str) -> None:
    """The rocker of one side is drawn turned: its front wheel is 0.09 m above the others."""
    rocker = link("rocker") + joint("rocker", "base_link", "rocker", "0 -0.25 0.2", "revolute", more=LIMITS)
    sides = wheel("rear_wheel", "-0.2 0 -0.1", geometry, "rocker")
    sides += wheel("front_wheel", "0.2 0 -0.01", geometry, "rocker")
    said = read(robot(pair(geometry=geometry), rocker, sides))
    assert said["names"] == ["left", "right", "rear"] and "'front_wheel_joint'" in said["notes"]


def legs(body: str, above: int) -> str:
    """Four that turn without end, each behind ``above`` joints that turn."""
    parts = ""
    for n, (x, y) in {"fl": (0.2, 0.1), "fr": (0.2, -0.1), "rl": (-0.2, 0.1), "rr": (-0.2, -0.1)}.items():
        chain = ["base_link", *(f"{n}{k}" for k in range(above)), n]
        parts += "".join(link(name) for name in chain[1:-1]) + body.replace("BODY", n)
        parts += "".join(
            joint(f"{child}_joint", parent, child, f"{x} {y} 0.3" if parent == "base_link" else "0 0 0",
                  "continuous" if child == n else "revolute", more="" if child == n else LIMITS)
            for parent, child in itertools.pairwise(chain)
        )  # fmt: skip
    return parts


def stl(*points: str) -> str:
    return "solid s\n" + "".join(f"vertex {point}\n" for point in points)


_MESHED = '<link name="BODY"><visual><geometry><mesh filename="part.stl"/></geometry></visual></link>'
_HEAVY = '<link name="BODY"><inertial><origin xyz="{} 0 0"/><mass value="1"/></inertial></link>'
_BOX = link("BODY", '<box size=".01 .01 .2"/>', xyz="0 0 -0.1")


@pytest.mark.parametrize(
    ("mesh", "body", "above", "why"),
    [
        (("0 0 0.02", "0.02 0 0", "0 0 -0.2", "-0.02 0 0"), _MESHED, 2, "reaches 0.2 m from the axle, and 0.02 m to"),
        (("0 0 0.1", "0.01 0 0", "0 0 -0.1", "-0.01 0 0"), _MESHED, 0, "mesh is not round"),  # a blade
        (("0 0 0.1", "0.1 0 0", "0 0 -0.1", "-0.1 0 0"), _MESHED, 3, ""),
        ((), _HEAVY.format("0.01"), 2, ""),
        ((), _HEAVY.format("0,12"), 2, ""),  # a mistake in what wheels do not need
        ((), _BOX, 1, "body reaches 0.1 m to one side"),
        ((), _HEAVY.format("0"), 5, "5 joints turn between it and 'base_link'"),
        ((), _HEAVY.format("0"), 4, ""),
        ((), link("BODY", cylinder("0.02")), 4, "4 joints turn between it and 'base_link'"),  # motors of ankles
        ((), link("BODY", cylinder("0.02")), 3, ""),
    ],
)  # fmt: skip
def test_limbs_and_blades_are_no_wheels_and_wheels_on_legs_are(
    read: Import, tmp_path: Path, mesh: tuple[str, ...], body: str, above: int, why: str
) -> None:
    (tmp_path / "part.stl").write_text(stl(*mesh))
    said = read(robot(legs(body, above)))
    assert (said["code"], len(said["names"])) == ((2, 0) if why else (0, 4))
    assert ("is not taken for a wheel" in said["notes"]) is bool(why) and why in said["notes"]
    beside = read(robot(pair(), legs(body, above)))
    assert beside["names"][:2] == ["left", "right"] and (len(beside["names"]) == 2 or not why)


def test_a_wheel_that_is_drawn_and_called_one_stands_on_a_leg_of_any_length(read: Import) -> None:
    ankles = legs(link("BODY", cylinder("0.02")), 6)
    assert read(robot(ankles))["code"] == 2
    assert len(read(robot(ankles.replace("_joint", "_wheel_joint")))["names"]) == 4


@pytest.mark.parametrize("named", ["left_joint", "left_link"])
@pytest.mark.parametrize(
    ("plugin", "wheels"),
    [("gz-sim-thruster-system", 0), ("librotors_gazebo_motor_model.so", 0), ("gz-sim-joint-controller", 2)],
)
def test_propellers_are_told_by_what_plugins_have_them_push(
    read: Import, plugin: str, wheels: int, named: str
) -> None:
    tag = "joint_name" if named.endswith("joint") else "link_name"
    said = (
        f'<gazebo><plugin filename="{plugin}"><{tag}>{n}</{tag}></plugin></gazebo>'
        for n in (named, named.replace("left", "right"))
    )
    seen = read(robot(pair(axis="1 0 0"), *said))
    assert len(seen["names"]) == wheels and ("push air or water" in seen["notes"]) is (wheels == 0)


@pytest.mark.parametrize(
    ("shapes", "reaches"),
    [
        ([("0 0 0", "0.1"), ("0.3 0 0", "0.04")], True),  # belt around a large and a small wheel
        ([("0 0 0", "0.1"), ("0.09 0 0", "0.04")], False),  # within the rim
        ([("0 0 0", "0.1"), ("0.11 0 0", "0.04"), ("-0.11 0 0", "0.04")], False),  # rollers about a hub
    ],
)
def test_a_flipper_is_no_wheel(read: Import, shapes: list[tuple[str, str]], reaches: bool) -> None:
    arm = body("arm_link", *(("collision", at, cylinder(r)) for at, r in shapes))
    said = read(robot(pair(), arm, joint("arm", "base_link", "arm_link", "0.3 0.3 0.1")))
    assert ("arm" in said["names"]) is not reaches
    assert ("'arm' is not taken for a wheel: its body reaches 0.3 m to one side" in said["notes"]) is reaches


def test_a_shape_that_is_only_drawn_elsewhere_makes_no_flipper(read: Import) -> None:
    odd = body("odd_link", ("collision", "0 0 0", cylinder("0.1")), ("visual", "0.3 0 0", cylinder("0.1")))
    assert "odd" in read(robot(pair(), odd, joint("odd", "base_link", "odd_link", "0.3 0.3 0.1")))["names"]


def test_a_robot_of_flippers_alone_is_refused_with_the_reason(read: Import) -> None:
    arm = [("collision", "0 0 0", cylinder("0.1")), ("collision", "0.3 0 0", cylinder("0.04"))]
    parts = [
        body(f"{n}_link", *arm) + joint(n, "base_link", f"{n}_link", f"0.3 {y} 0.1")
        for n, y in (("l", 0.3), ("r", -0.3))
    ]
    said = read(robot(*parts))
    assert said["code"] == 2 and "0 joints are wheels" in said["notes"] and "a flipper" in said["notes"]


@pytest.mark.parametrize(
    ("geometry", "at", "wheels", "is_gear"),
    [
        ("", "0 0 0", "", True),
        (MESH, "0 0 0", "", True),
        (MESH, "0 0 0", MESH, True),
        (cylinder("0.03"), "0 0 0", "", True),
        (cylinder("0.09"), "0 0 0", "", False),  # it stands, too
        (MESH, "0 0.02 0", "", False),  # off the middle
        (MESH, "0.1 0 0", "", False),  # before the axle
    ],
)
def test_the_gear_of_a_differential(read: Import, geometry: str, at: str, wheels: str, is_gear: bool) -> None:
    """It turns in the middle of an axle and does not reach the ground; what drives it drives the wheels."""
    base = link("axle") + joint("axle", "base_link", "axle", "0 0 0.1", "fixed", "")
    rear = [wheel(n, f"0 {y} 0", wheels, "axle") for n, y in (("rl", 0.2), ("rr", -0.2))]
    gear = link("gear_link", geometry) + joint("gear", "axle", "gear_link", at)
    motor = '<transmission><joint name="gear"/></transmission>'
    said = read(robot(base, *rear, wheel("front", "0.4 0.1 0.1"), gear, motor))
    assert ("gear" not in said["names"]) is is_gear and {"rl", "rr", "front"} <= {*said["names"]}
    words = "'gear' is not taken for a wheel: it turns in the middle of the axle of 'rl_joint' and 'rr_joint'"
    assert (words in said["notes"]) is is_gear
    assert ("actuated: []" in said["text"].partition("name: rr")[2].partition("name: ")[0]) is not is_gear


def test_fingers_are_no_wheels(read: Import) -> None:
    """Upright under an upright joint, as a steered wheel is whose axis is written wrongly, but at the end of an arm."""
    parts = []
    for n, y in (("l", 0.2), ("r", -0.2)):
        parts += [link(f"{n}_{k}") for k in ("arm", "knuckle", "tip")]
        parts += [
            joint(f"{n}_arm", "base_link", f"{n}_arm", f"0.5 {y} 0.1", "revolute", "1 0 0", more=LIMITS),
            joint(f"{n}_knuckle", f"{n}_arm", f"{n}_knuckle", "0.1 0 0", axis="0 0 1"),
            joint(f"{n}_tip", f"{n}_knuckle", f"{n}_tip", "0.04 0 0", axis="0 0 1"),
        ]
    said = read(robot(*parts))
    assert said["code"] == 2 and "0 joints are wheels" in said["notes"]


@pytest.mark.parametrize("ahead", ["x", "y"])
@pytest.mark.parametrize(
    ("trail", "aside", "height", "drives"),
    [(-0.04, 0, 0.11, True), (-0.04, 0.05, 0.11, True), (0, 0, 0.11, False), (0, 0.05, 0.11, False),
     (-0.04, 0, 0.3, False)],
)  # fmt: skip
def test_wheels_larger_than_the_castors_beside_them(
    read: Import, trail: float, aside: float, height: float, drives: bool, ahead: str
) -> None:
    """Of meshes alone the ground is not known: castors do not drive, what drives beside them stands on it too. What
    stands beside its steering axis trails as little as what stands on it; and so along any axis of the base."""

    def at(x: float, y: float, z: float) -> str:
        return f"{x} {y} {z}" if ahead == "x" else f"{-y} {x} {z}"

    axle = at(0, 1, 0)
    wheels = (("left_wheel", 0.2), ("right_wheel", -0.2))
    parts = [wheel(n, at(0, y, height), MESH, axis=axle) for n, y in wheels]
    for n, y in (("a", 0.1), ("b", -0.1)):
        parts += [
            link(f"{n}_s"),
            joint(f"{n}_s", "base_link", f"{n}_s", at(-0.3, y, 0.1), axis="0 0 1"),
            wheel(n, at(trail, aside, -0.06), MESH, parent=f"{n}_s", axis=axle),
        ]
    said = read(robot(*parts))
    assert ({"left", "right"} <= {*said["names"]}) is drives and {"a", "b"} <= {*said["names"]}
    assert ("'left_wheel_joint' is not taken" in said["notes"]) is not drives


def test_a_limited_joint_is_noted_beside_wheels(read: Import) -> None:
    limited = wheel(
        "rear_wheel", "-0.3 0.25 0.1", kind="revolute", more='<limit lower="-3.14" upper="3.14"/>'
    )
    said = read(robot(pair(), limited))
    assert (
        said["names"] == ["left", "right"] and "'rear_wheel_joint' is not taken for a wheel" in said["notes"]
    )


@pytest.mark.parametrize("beside", ["hip", "base_link"])
def test_the_motors_of_legs_are_no_wheels(read: Import, beside: str) -> None:
    """A leg of two bars that a motor turns at each side of the hip, of which one bears its bar upwards: its other motor
    would stand on the ground."""
    hip = link("hip") + joint("hip", "base_link", "hip", "0 0.2 0", axis="1 0 0")
    motors = (
        link("one")
        + joint("one", "hip", "one", "0.2 0 0")
        + wheel("two", "0.2 0.2 0" if beside == "base_link" else "0.2 0 0", parent=beside)
    )
    knee = _BOX.replace("BODY", "shin") + joint("knee", "one", "shin", "0 0 0.3")
    said = read(robot(hip, motors, knee))
    assert (
        said["code"] == 2
        and "'two_joint' is not taken for a wheel: it is beside a limb that" in said["notes"]
    )
    assert read(robot(hip, motors, wheel("knee", "0 0 0", parent="one")))["code"] == 0


def test_what_is_fixed_in_an_arm_is_no_wheel(read: Import) -> None:
    """Where other joints turn on the body that one tilts; at the end of it a fixed wheel is one."""
    turns = joint("shoulder", "base_link", "upper", "0.2 0 0.5", "revolute", more=LIMITS) + link("upper")
    parts = [
        turns,
        wheel("end", "0.2 0 0", parent="upper", kind="fixed"),
        wheel("tail", "-0.2 0 0.5", kind="fixed"),
    ]
    assert len(read(robot(*parts))["names"]) == 2
    said = read(
        robot(*parts, link("fore"), joint("elbow", "upper", "fore", "0.1 0 0", "revolute", more=LIMITS))
    )
    assert said["code"] == 2 and "'tail_joint' alone is a wheel" in said["notes"]


def test_a_rigid_axle_is_not_taken_beside_its_wheels(read: Import) -> None:
    """One that steers, and one that does not; a wheel that turns is one with what is fixed to it."""
    steers = joint("steer", "base_link", "front_wheelbase", "0.5 0 0.1", "revolute", "0 0 1", more=LIMITS)
    rests = joint("rest", "base_link", "rear_wheelbase", "-0.5 0 0.1", "fixed", "")
    tires = [
        wheel(f"{end}_{side}_tire", f"0 {y} 0", parent=f"{end}_wheelbase", kind="fixed", axis="")
        for end in ("front", "rear")
        for side, y in (("left", 0.3), ("right", -0.3))
    ]
    axles = link("front_wheelbase") + steers + link("rear_wheelbase") + rests
    said = read(robot(axles, *tires))
    assert len(said["names"]) == 4 and all("tire" in name for name in said["names"])
    shaft = link("rear_wheelbase") + rests.replace("fixed", "continuous").replace(
        "</", '<axis xyz="0 1 0"/></'
    )
    nose = wheel("nose_wheel", "0.5 0 0.1", kind="fixed")
    assert read(robot(shaft, nose, *tires[2:]))["names"] == ["rest", "nose"]


def test_a_wheel_whose_axis_is_upright_is_told(read: Import) -> None:
    said = read(robot(pair(axis="0 0 1").replace("left", "left_wheel")))
    assert (
        said["code"] == 2
        and "'left_wheel_joint' is not taken for a wheel: its axis is upright" in said["notes"]
    )
