"""What is asked of a robot: what a file leaves open, and what in it looks as if it were not meant so."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.tools.importing.urdf import cylinder, joint, link, pair, robot, wheel

Cli = Callable[..., Outcome]
Import = Callable[..., dict[str, Any]]
BALL = '<sphere radius="0.03"/>'
CORNERS = {"fl": (0.3, 0.25), "fr": (0.3, -0.25), "rl": (-0.3, 0.25), "rr": (-0.3, -0.25)}


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Import:
    """What `wmrgen import --json` says of a text, and its robot file; what is asked as wheel and key."""

    def call(text: str, *options: str) -> dict[str, Any]:
        (tmp_path / "probe.urdf").write_text(text, encoding="utf-8")
        out = tmp_path / "probe.yaml"
        done = wmrgen_cli("import", tmp_path / "probe.urdf", "-o", out, "--json", *options)
        assert done.code == 0, done.err
        said = json.loads(done.out)
        asked = [(q["wheel"], q["key"]) for q in said["questions"]]
        wheels = {w["name"]: w for w in said["wheels"]}
        return {
            **said,
            "wheels": wheels,
            "asked": asked,
            "notes": done.err,
            "text": out.read_text(encoding="utf-8"),
        }

    return call


def four(names: dict[str, str] | None = None, **of_wheel: str) -> str:
    names = names or {}
    return "".join(wheel(names.get(n, n), f"{x} {y} 0.1", **of_wheel) for n, (x, y) in CORNERS.items())


def control(*joints: str) -> str:
    commanded = "".join(f'<joint name="{j}"><command_interface name="velocity"/></joint>' for j in joints)
    return f"<ros2_control>{commanded}</ros2_control>"


def test_several_axles_without_a_controller(read: Import) -> None:
    assert read(robot(four()))["asked"] == [(n, "actuated") for n in CORNERS]
    assert read(robot(four(), control("fl_joint")))["asked"] == []
    assert read(robot(pair()))["asked"] == []


@pytest.mark.parametrize(
    ("moved", "asked"),
    [
        ({"rr": (-0.28, -0.266)}, [("rr", "x"), ("rr", "y")]),
        ({"fl": (0.31, 0.25)}, [("fl", "x")]),
        ({"fl": (0.304, 0.25)}, []),  # drawn by CAD
        ({"fl": (0.3, 0.2), "fr": (0.3, -0.2)}, []),  # a narrow front
        ({"fl": (0.5, 0.25)}, []),  # no slip of the pen
    ],
)  # fmt: skip
def test_a_wheel_beside_the_corner_that_three_others_leave_is_asked_about(
    read: Import, moved: dict[str, tuple[float, float]], asked: list[tuple[str, str]]
) -> None:
    places = {n: moved.get(n, place) for n, place in CORNERS.items()}
    wheels = "".join(wheel(n, f"{x} {y} 0.1") for n, (x, y) in places.items())
    skids = '<gazebo><plugin filename="libgazebo_ros_skid_steer_drive.so"/></gazebo>'
    said = read(robot(wheels, control(*(f"{n}_joint" for n in CORNERS)), skids))
    assert said["asked"] == asked and ("-0.3 at the corner" in said["text"]) is ("rr" in moved)


def modules(places: dict[str, str], **radii: str) -> str:
    """Steered wheels at the corners; ``places``: where a wheel stands in the frame of its swivel."""
    parts = ""
    for n, (x, y) in CORNERS.items():
        parts += link(f"{n}_s") + joint(f"{n}_s", "base_link", f"{n}_s", f"{x} {y} 0.1", axis="0 0 1")
        parts += wheel(n, places.get(n, "0 0 0"), cylinder(radii.get(n, "0.1")), f"{n}_s")
    return parts + control(*(f"{n}_{part}" for n in CORNERS for part in ("s", "joint")))


@pytest.mark.parametrize(
    ("places", "radii", "asked"),
    [
        ({"fl": "0.03 0.01 0"}, {}, [("fl", "type"), ("fl", "offset_y")]),
        ({"rr": "0 -0.02 0"}, {}, [("rr", "offset_y")]),
        ({"fl": "0 0.03 0", "rl": "0 0.03 0", "fr": "0 -0.03 0", "rr": "0 -0.03 0"}, {}, []),  # outward
        (dict.fromkeys(CORNERS, "-0.03 0 0"), {}, []),  # powered castors
        ({"fl": "-0.03 0 0", "fr": "-0.03 0 0"}, {}, []),
        ({}, {"fr": "0.105"}, [("fr", "r")]),
        ({}, {"fl": "0.12", "fr": "0.12"}, []),
        ({"fl": "0.03 0 0"}, {"fr": "0.105"}, [("fl", "type"), ("fr", "r")]),
    ],
)  # fmt: skip
def test_one_wheel_that_differs_from_all_others_of_its_kind_is_asked_about(
    read: Import, places: dict[str, str], radii: dict[str, str], asked: list[tuple[str, str]]
) -> None:
    assert read(robot(modules(places, **radii)))["asked"] == asked


def test_one_wheel_that_does_not_steer_as_all_others_do_is_asked_about(read: Import) -> None:
    """Its joint above turns about a level axis: a slip of the pen. A rocker above each of two wheels is none."""
    said = read(robot(modules({}).replace('<axis xyz="0 0 1"/>', '<axis xyz="1 0 0"/>', 1)))
    assert (
        said["asked"] == [("fl", "type")] and "joint 'fl_s' above it turns about a level axis" in said["text"]
    )
    assert read(robot(modules({}).replace('<axis xyz="0 0 1"/>', '<axis xyz="1 0 0"/>', 2)))["asked"] == []


@pytest.mark.parametrize(
    ("front", "rear", "names"),
    [
        ("joint_from_the_module_to_the_wheel_{}_front", "joint_from_the_module_to_the_wheel_{}_rear",
         ["left_front", "right_front", "left_rear", "right_rear"]),
        ("{}_rocker_of_the_chassis_to_front_{}", "{}_rocker_of_the_chassis_to_rear_{}",
         ["of_the_chassis_to_front_left", "the_chassis_to_front_right", "of_the_chassis_to_rear_left",
          "of_the_chassis_to_rear_right"]),
        ("{}_front", "{}_rear", ["left_front", "right_front", "left_rear", "right_rear"]),
    ],
)  # fmt: skip
def test_long_names_keep_what_tells_wheels_apart(
    read: Import, front: str, rear: str, names: list[str]
) -> None:
    corners = {"fl": (front, "left"), "fr": (front, "right"), "rl": (rear, "left"), "rr": (rear, "right")}
    said = read(robot(four({n: form.replace("{}", side) for n, (form, side) in corners.items()})))
    assert list(said["wheels"]) == names


def test_what_moves_the_body_names_no_motors(read: Import) -> None:
    moves = '<gazebo><plugin filename="libgazebo_ros_planar_move.so"/></gazebo>'
    said = read(robot(four(), moves))
    assert {w["actuated"] == [] for w in said["wheels"].values()} == {True}
    assert [k for _, k in said["asked"]].count("actuated") == 4


def test_a_simulator_that_moves_a_body_any_way_says_rollers_of_four_wheels_alone(read: Import) -> None:
    """Of a pair, of a car and of the wheels of tracks it is the simulator's way."""
    moves = '<gazebo><plugin filename="libgazebo_ros_planar_move.so"/></gazebo>'
    steered = link("s") + joint("s", "base_link", "s", "0.3 0 0.1", axis="0 0 1")
    car = (pair(), steered, wheel("front", "0 0 0", parent="s"))
    tracks = four() + pair()
    for parts, kinds in (
        (four(), {"swedish"}), (pair(), {"fixed"}), (tracks, {"fixed"}), ("".join(car), {"fixed", "steered"})
    ):  # fmt: skip
        said = read(robot(parts, moves))
        assert {w["type"] for w in said["wheels"].values()} == kinds


def test_a_castor_with_a_transmission(read: Import) -> None:
    fork = link("fork") + joint("swivel", "base_link", "fork", "-0.3 0 0.2", axis="0 0 1")
    parts = (pair(), fork, wheel("tail", "-0.04 0 -0.1", parent="fork"))
    assert read(robot(*parts, control("left_joint", "tail_joint")))["asked"] == []
    assert read(robot(*parts, control("left_joint", "tail_joint", "swivel")))["asked"] == []
    transmission = '<transmission><joint name="swivel"/></transmission>'
    said = read(robot(*parts, control("left_joint", "tail_joint"), transmission))
    assert said["asked"] == [("tail", "actuated")] and "hint: [spin]" in said["text"]


def test_a_castor_that_stops_like_a_steered_wheel(read: Import) -> None:
    """A car whose steering nothing drives, its contacts 40 mm off their steering axes."""
    for stop, asked in ((0.6, [("tail", "type")]), (1.6, []), (0, [])):
        limits = f'<limit lower="-0.5" upper="{stop}"/>' if stop else ""
        kind = "revolute" if stop else "continuous"
        fork = link("fork") + joint("swivel", "base_link", "fork", "-0.3 0 0.2", kind, "0 0 1", more=limits)
        parts = (
            pair(),
            fork,
            wheel("tail", "-0.04 0 -0.1", parent="fork"),
            control("left_joint", "right_joint"),
        )
        assert read(robot(*parts))["asked"] == asked
    assert ("tail", "type") not in read(robot(*parts[:3], control("left_joint", "swivel")))["asked"]


def test_the_one_wheel_that_is_not_drawn(read: Import) -> None:
    """A fifth in the middle, as a simulator has it."""
    visual = f"</collision><visual><geometry>{cylinder('0.1')}</geometry></visual>"
    corners = enumerate(((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)))
    drawn = "".join(wheel(f"w{k}", f"{x} {y} 0.1") for k, (x, y) in corners).replace("</collision>", visual)
    for middle, asked in ((wheel("middle", "0 0 0.1"), [("middle", "type")]), (pair(), [])):
        assert [q for q in read(robot(drawn, middle))["asked"] if q[1] == "type"] == asked


def test_a_drum_on_an_arm_may_be_a_tool(read: Import) -> None:
    """Lowered to the ground it stands as wheels do. Two on one rocker are wheels, and so are they all on arms."""
    limits = '<limit lower="-1" upper="1"/>'

    def arm(name: str, x: float, *ends: float) -> str:
        turns = link(f"{name}_arm") + joint(
            f"{name}_arm", "base_link", f"{name}_arm", f"{x} 0 0.1", "revolute", more=limits
        )
        return turns + "".join(
            wheel(f"{name}{k}", f"{end} 0 0", parent=f"{name}_arm") for k, end in enumerate(ends)
        )

    def asked(*parts: str) -> list[tuple[str, str]]:
        return [
            q for q in read(robot(*parts, control("left_joint", "right_joint")))["asked"] if q[1] == "type"
        ]

    assert asked(pair(), arm("drum", -0.2, -0.3)) == [("drum0", "type")]
    assert asked(pair(), arm("rocker", -0.2, -0.3, 0.1)) == []
    assert asked(arm("a", 0.2, 0.3), arm("b", -0.2, -0.3)) == []


def test_swivels_that_take_velocities_beside_wheels_that_drive(read: Import) -> None:
    """On castors alone they are motors; castors of a robot that others drive follow, but where they take positions."""
    castors, said = "", ""
    for name, y in (("fl", 0.2), ("fr", -0.2)):
        castors += link(f"{name}_s") + joint(
            f"{name}_s", "base_link", f"{name}_s", f"0.3 {y} 0.2", axis="0 0 1"
        )
        castors += wheel(name, "-0.04 0 -0.1", parent=f"{name}_s")
        said += f'<transmission><joint name="{name}_s"><hardwareInterface>VelocityJointInterface</hardwareInterface></joint></transmission>'  # noqa: E501
    drives = control("fl_joint", "fr_joint", "left_joint", "right_joint")
    assert read(robot(castors, said, drives))["asked"] == []
    assert read(robot(castors))["asked"] == [("fl", "actuated"), ("fr", "actuated")]
    assert read(robot(castors, pair(), said, drives))["asked"] == [("fl", "actuated"), ("fr", "actuated")]
    assert read(robot(castors, pair(), said.replace("Velocity", "Position"), drives))["asked"] == []


def test_a_wheel_on_a_passive_steering_axis_is_asked_about(read: Import) -> None:
    """Its contact lies on the axis, so that it would not trail."""
    fork = link("s") + joint("s", "base_link", "s", "-0.3 0 0.1", axis="0 0 1")
    parts = (pair(), fork, wheel("tail", "0 0 0", parent="s"))
    assert read(robot(*parts, control("left_joint", "right_joint")))["asked"] == [("tail", "type")]
    assert read(robot(*parts, control("left_joint", "right_joint", "s")))["asked"] == []


@pytest.mark.parametrize(
    ("body", "kind", "asked"),
    [("", "continuous", True), (cylinder("0.02"), "continuous", False), ("", "revolute", False)],
)
def test_a_swivel_that_only_a_transmission_names(read: Import, body: str, kind: str, asked: bool) -> None:
    """Without a body and a limit, as descriptions of the youBot have it, whose wheels have rollers and do not steer."""
    fork = joint(
        "s", "base_link", "s", "-0.3 0 0.1", kind, axis="0 0 1", more='<limit lower="-1" upper="1"/>'
    )
    parts = (pair(), link("s", body), fork, wheel("tail", "0 0 0", parent="s"))
    said = '<transmission><joint name="s"/></transmission>' + control(
        "left_joint", "right_joint", "tail_joint"
    )
    assert read(robot(*parts, said))["asked"] == [("tail", "type")] * asked
    assert read(robot(*parts, said, control("s")))["asked"] == []


def test_a_steering_axis_that_leans(read: Import) -> None:
    """0.1 rad: at the height of the axle it stands 0.1 sin(0.1) further back than at the joint, 0.1 above."""
    fork = link("s") + joint("s", "base_link", "s", "0.3 0 0.2", axis="0 0 1", rpy="0 0.1 0")
    said = read(robot(pair(), fork, wheel("front", "0 0 -0.1", parent="s"), control("left_joint", "s")))
    assert said["asked"] == [("front", "x")]
    assert "leans by 5.73 deg" in said["text"] and "at the axle x = 0.290017, y = 0" in said["text"]


def test_a_mesh_beside_its_steering_axis(read: Import) -> None:
    """Without its file nothing tells whether the joint stands in its middle."""
    fork = link("s") + joint("s", "base_link", "s", "0.3 0 0.2", axis="0 0 1")
    front = wheel("front", "0 0.03 -0.1", '<mesh filename="a.stl"/>', parent="s")
    said = read(robot(pair(), fork, front, control("left_joint", "s")))
    hints = {q["key"]: q["hints"] for q in said["questions"]}
    assert hints == {
        "r": [],
        "offset_y": ["0.03 at the joint", "0.03 at the origin of the collision mesh 'a.stl'"],
    }
    for name, doubted in (("a", True), ("b", False)):  # nor in that of wheels with the same mesh
        rear = pair(geometry=f'<mesh filename="{name}.stl"/>')
        asked = read(robot(rear, fork, front, control("left_joint", "s")))["asked"]
        assert (("left", "y") in asked, ("right", "y") in asked) == (doubted, doubted)


def test_two_wheels_on_one_shaft(read: Import) -> None:
    """One joint turns both: rigid parts of it, 0.4 m apart; two sides of one wheel stand nearer."""
    for half, asked in ((0.2, [("axle", "type")]), (0.04, [])):
        shaft = link("axle") + joint("axle", "base_link", "axle", "-0.3 0 0.1")
        for n, y in (("a", half), ("b", -half)):
            shaft += link(n, cylinder("0.1")) + joint(n, "axle", n, f"0 {y} 0", "fixed", "")
        said = read(robot(pair(), shaft, control("axle", "left_joint", "right_joint")))
        assert said["asked"] == asked and said["wheels"]["axle"]["y"] == 0


def test_a_sphere_that_nothing_drives(read: Import) -> None:
    """On a joint about one axle, where simulators have it; what carries the robot is a ball."""
    parts = (pair(), wheel("tail", "-0.3 0 0.03", BALL))
    drives = ("left_joint", "right_joint")
    assert read(robot(*parts, control(*drives)))["asked"] == [("tail", "type")]
    for text in (
        robot(*parts, control(*drives, "tail_joint")),
        robot(*parts).replace(BALL, cylinder("0.03")),
    ):
        assert ("tail", "type") not in read(text)["asked"]


def test_rollers_that_reach_further_than_the_wheel_is_drawn(read: Import) -> None:
    """A hub of 0.1 with rollers of 0.01 on a circle of 0.1."""
    rollers = ""
    for k in range(6):
        c, s = math.cos(math.pi * k / 3), math.sin(math.pi * k / 3)
        rollers += link(f"r{k}", '<cylinder radius="0.01" length="0.02"/>', rpy=f"0 {-math.pi * k / 3} 0")
        rollers += joint(f"r{k}", "left_link", f"r{k}", f"{0.1 * c} 0 {0.1 * s}", axis=f"{-s} 0 {c}")
    said = read(robot(pair(), rollers))
    assert ("left", "r") in said["asked"] and "0.11 to the rollers' surface" in said["text"]


def test_a_scale_that_is_none_is_noted(read: Import) -> None:
    said = read(robot(pair(), link("hull", '<mesh filename="a.stl" scale="1 1 1 1"/>')))
    assert said["asked"] == [] and "taken as 1 1 1" in said["notes"]


def test_what_is_drawn_in_the_place_of_a_wheel_is_no_castor(read: Import) -> None:
    shown = wheel("shown_wheel", "0.05 0.25 0.1", kind="fixed")
    assert read(robot(pair(), shown))["asked"] == []


LABELS = {"fl": "front_left", "fr": "front_right", "rl": "rear_left", "rr": "rear_right"}
TURNED = {"fl": "rear_left", "fr": "front_left", "rl": "rear_right", "rr": "front_right"}  # forward is -y
ALIKE = {"fl": "p_l", "fr": "q_l", "rl": "s_l", "rr": "u_l"}  # l of link
MIRRORED = {"fl": "front_right", "fr": "front_left", "rl": "rear_right", "rr": "rear_left"}


@pytest.mark.parametrize(
    ("names", "forward"),
    [(LABELS, None), (ALIKE, None), (TURNED, "--forward -y"), (MIRRORED, "x is forward")],
)
def test_names_that_contradict_the_places(read: Import, names: dict[str, str], forward: str | None) -> None:
    skids = '<gazebo><plugin filename="libgazebo_ros_skid_steer_drive.so"/></gazebo>'
    said = read(robot(four(names), control("x_joint", *(f"{n}_joint" for n in names.values())), skids))
    assert said["asked"] == ([] if forward is None else [(names["fl"], "heading")])
    assert forward is None or forward in " ".join(said["text"].split())


@pytest.mark.parametrize(("axis", "forward"), [("1 0 0", "-y"), ("-1 0 0", "y")])
def test_wheels_that_roll_along_y(read: Import, axis: str, forward: str) -> None:
    """Whoever says what is forward has the frame turned, and is not asked again."""
    sideways = "".join(
        wheel(n, f"{x} 0 0.1", geometry='<sphere radius="0.1"/>', axis=axis)
        for n, x in (("a", 0.2), ("b", -0.2))
    )
    said = read(robot(sideways))
    assert ("a", "heading") in said["asked"] and f"--forward {forward}" in " ".join(said["text"].split())
    turned = read(robot(sideways), f"--forward={forward}")
    assert turned["asked"] == [] and {w["heading"] for w in turned["wheels"].values()} == {0.0}
    sign = 1 if forward == "y" else -1
    assert [(w["x"], w["y"]) for w in turned["wheels"].values()] == [(0.0, -sign * 0.2), (0.0, sign * 0.2)]
    assert read(robot(sideways), "--forward=x")["wheels"]["a"]["heading"] == pytest.approx(sign * math.pi / 2)


def test_a_castor_of_fixed_joints(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Pivot at x = -0.3, wheel 0.04 behind; as a castor it can be derived."""
    hub = link("hub") + joint("swivel", "base_link", "hub", "-0.3 0 0.2", "fixed", axis="0 0 1")
    tail = link("tail", cylinder("0.05")) + joint(
        "roll", "hub", "tail", "-0.04 0 -0.15", "fixed", axis="0 1 0"
    )
    said = read(robot(pair(), hub, tail))
    assert said["asked"] == [("support", "type")]
    hint = said["questions"][0]["hints"][0]
    assert hint == "castor, with x: -0.3, y: 0, d: -0.04, r: 0.05"
    assert wmrgen_cli("derive", tmp_path / "probe.yaml", "-o", tmp_path / "out").code == 2
    lines = said["text"].split("  - name: support")
    values = "\n    type: castor\n    x: -0.3\n    y: 0\n    d: -0.04\n    r: 0.05\n"
    (tmp_path / "probe.yaml").write_text(f"{lines[0]}  - name: support{values}", encoding="utf-8")
    assert wmrgen_cli("derive", tmp_path / "probe.yaml", "-o", tmp_path / "out").code == 0
    plain = tail.replace('<axis xyz="0 1 0"/>', "")
    assert read(robot(pair(), hub, plain))["asked"] == []


def test_what_carries_a_pair_of_wheels(read: Import) -> None:
    """A ball of its own body does; one of the base is asked about; that nothing does is told."""
    own = link("third", BALL, xyz="0 0 0.03") + joint("third", "base_link", "third", "-0.2 0 0", "fixed")
    said = read(robot(pair(), own))
    assert said["asked"] == [] and "what carries the rest" not in said["notes"]
    box = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    ball = f'<collision><origin xyz="-0.2 0 0.03"/><geometry>{BALL}</geometry></collision>'
    said = read(robot(pair()).replace('<link name="base_link">', f'<link name="base_link">{box}{ball}'))
    assert said["asked"] == [("support", "type")]
    assert said["questions"][0]["hints"] == ["a ball of 'base_link' at x = -0.2, y = 0: spherical"]
    alone = read(robot(pair()))
    assert alone["asked"] == [] and "what carries the rest" in alone["notes"]
    steered = "".join(
        link(n)
        + joint(n, "base_link", n, "-0.4 0 0.1", "revolute", "0 0 1", more='<limit lower="-1" upper="1"/>')
        + wheel(f"{n}_tail", f"0 {y} 0", parent=n)
        for n, y in (("a", 0.2), ("b", -0.2))
    )  # about one axis, to either side of it
    said = read(robot(steered, pair()))
    assert ("support", "type") not in said["asked"] and "what carries the rest" not in said["notes"]


def test_wheels_of_a_controller_are_none_of_the_robot(read: Import) -> None:
    """Drawn, touching nothing, and mimicked: one joint drives both wheels."""
    shown = wheel("shown", "0.05 0 0.1").replace("collision>", "visual>")
    both = pair(more='<mimic joint="shown_joint"/>')
    said = read(robot(shown, both, control("shown_joint")))
    assert list(said["wheels"]) == ["left", "right"]
    assert [w["actuated"] for w in said["wheels"].values()] == [["spin"], ["spin"]]
    assert ("right", "equal") in said["asked"]
    assert "hint: [left.spin, right.spin]" in said["text"] and "  - {equal: TODO}" in said["text"]
    touching = read(robot(wheel("shown", "0.05 0 0.1"), both))
    assert list(touching["wheels"]) == ["shown", "left", "right"]
    drawn = both.replace("collision>", "visual>")  # as all wheels
    assert list(read(robot(shown, drawn, wheel("mast", "0 0 1")))["wheels"]) == ["shown", "left", "right"]


def arm(name: str, y: float, mimic: str = "", limits: str = "-0.6 0.5", axis: str = "0 0 1") -> str:
    low, high = limits.split()
    more = f'<limit lower="{low}" upper="{high}"/>' + mimic
    turn = joint(f"{name}_turn", "base_link", f"{name}_arm", f"1 {y} 0.1", "revolute", axis, more=more)
    return link(f"{name}_arm") + turn + wheel(name, "0 0 0", parent=f"{name}_arm")


def test_wheels_that_one_joint_steers_are_coupled(read: Import) -> None:
    """Left and right hub of one pivot left of the robot's middle, which lint takes by their own middle."""
    pivot = link("fork") + joint("swivel", "base_link", "fork", "-0.3 0.3 0.1", axis="0 0 1")
    twins = "".join(
        wheel(n, f"-0.05 {y} -0.05", cylinder("0.05"), "fork") for n, y in (("hub_l", 0.06), ("hub_r", -0.06))
    )
    said = read(robot(pair(), pivot, twins))
    assert [said["wheels"][n]["offset_y"] for n in ("hub_l", "hub_r")] == [0.06, -0.06]
    assert "  - {equal: [hub_l.steer, hub_r.steer]}   # joint 'swivel' steers both" in said["text"]


def test_steering_that_mimics(read: Import) -> None:
    """One to one it is a coupling; what turns half as far cannot be said."""
    mimic = '<mimic joint="a_turn"/>'
    arms = arm("a", 0.2) + arm("b", -0.2, mimic)
    driven = control("a_joint", "a_turn", "left_joint")
    said = read(robot(arms, driven))
    assert said["asked"] == [] and "  - {equal: [a.steer, b.steer]}   # mimic" in said["text"]
    third = arm("c", 0.4, '<mimic joint="b_turn"/>')
    assert read(robot(arms, third, driven))["wheels"]["c"]["actuated"] == ["steer"]
    half = read(robot(arm("a", 0.2) + arm("b", -0.2, '<mimic joint="a_turn" multiplier="0.5"/>'), driven))
    assert "0.5 times 'a_turn'" in half["notes"] and "leave steer out of actuated of b" in half["notes"]
    assert "couplings:" not in half["text"]


@pytest.mark.parametrize(
    ("multiplier", "ratios"),
    [
        ("2", ", ratios: [1, 2]"),
        ("-0.4", ", ratios: [1, -0.4]"),
        ("1", ""),
        ("0", None),
        ("1e29", None),
        ("-1e-9", None),
    ],
)
def test_spins_that_mimic_in_a_ratio(read: Import, multiplier: str, ratios: str | None) -> None:
    """A chain from the left wheel to one behind it; where a spin begins does not matter."""
    mimic = f'<mimic joint="left_joint" multiplier="{multiplier}" offset="0.3"/>'
    said = read(robot(pair(), wheel("back", "-0.3 0.25 0.1", more=mimic)))
    if ratios is None:
        assert (
            "couplings:" not in said["text"] and f"{float(multiplier):g} times 'left_joint'" in said["notes"]
        )
    else:
        assert f"  - {{equal: [left.spin, back.spin]{ratios}}}   # mimic" in said["text"]


def test_what_follows_through_another_joint_follows_its_leader(read: Import) -> None:
    chain = [
        wheel(name, f"{x} 0.25 0.1", more=f'<mimic joint="{leader}_joint" multiplier="{k}"/>')
        for name, x, leader, k in (("last", -0.6, "mid", 3), ("mid", -0.3, "left", -0.5))
    ]
    said = read(robot(pair(), *chain))
    assert "  - {equal: [left.spin, last.spin], ratios: [1, -1.5]}   # mimic" in said["text"]
    assert "  - {equal: [left.spin, mid.spin], ratios: [1, -0.5]}   # mimic" in said["text"]


def test_an_axle_that_turns_in_a_ratio_is_asked_about(read: Import) -> None:
    both = pair(more='<mimic joint="left_joint" multiplier="1.2"/>').replace(
        '<mimic joint="left_joint" multiplier="1.2"/>', "", 1
    )
    said = read(robot(both))
    assert "turn in one ratio in the file" in said["text"]
    assert "[left.spin, right.spin], ratios: [1, 1.2] where it does" in said["text"]


@pytest.mark.parametrize(
    ("axis", "factor", "ratios"),
    [
        ("0 0 1", "-1", ", ratios: [1, -1]"),
        ("0 0 -1", "-1", ""),
        ("0 0 -1", "1", ", ratios: [1, -1]"),
        ("0 0 1", "-0.5", None),
    ],
)
def test_steering_that_mimics_the_other_way_round(
    read: Import, axis: str, factor: str, ratios: str | None
) -> None:
    """About an axis that points down the angle of a robot file is that of the file negated; other ratios are noted."""
    mimic = f'<mimic joint="a_turn" multiplier="{factor}"/>'
    said = read(
        robot(arm("a", 0.2), arm("b", -0.2, mimic, axis=axis), control("a_joint", "a_turn", "left_joint"))
    )
    assert (f"  - {{equal: [a.steer, b.steer]{ratios}}}   # mimic" in said["text"]) == (ratios is not None)
    assert ("times 'a_turn'" in said["notes"]) == (ratios is None)


def test_noise_of_floating_point_is_no_length(read: Import) -> None:
    """A steering axis is turned by 0.3, and a wheel 0.05 m beside it is turned back, in digits of floating point."""
    turned, wheels = arm("a", 0.2).replace('rpy="0 0 0"', 'rpy="0 0 0.3"', 1).split('<link name="a_link">')
    beside = f'xyz="{0.05 * math.sin(0.3)!r} {0.05 * math.cos(0.3)!r} 0" rpy="0 0 -0.3"'
    back = wheels.replace('<origin xyz="0 0 0" rpy="0 0 0"/>', f"<origin {beside}/>")
    said = read(robot(turned, f'<link name="a_link">{back}', pair()))
    assert (said["wheels"]["a"]["d"], said["wheels"]["a"]["offset_y"]) == (0, 0.05)
    assert "off the steering axis" not in said["text"]


def test_what_follows_one_leader_in_one_ratio_turns_alike(read: Import) -> None:
    """Both follow a steering column, which is no wheel's."""
    column = link("column") + joint("column", "base_link", "column", "0 0 0.5", "revolute", "0 0 1",
                                    more='<limit lower="-6" upper="6"/>')  # fmt: skip
    mimic = '<mimic joint="column" multiplier="0.1"/>'
    said = read(
        robot(column, arm("a", 0.2, mimic), arm("b", -0.2, mimic), control("a_joint", "column", "b_joint"))
    )
    assert "  - {equal: [a.steer, b.steer]}   # mimic" in said["text"] and "times" not in said["notes"]
    odd = arm("b", -0.2, mimic.replace("0.1", "0.2"))
    said = read(robot(column, arm("a", 0.2, mimic), odd, control("a_joint", "column", "b_joint")))
    assert "couplings:" not in said["text"] and "0.2 times 'column'" in said["notes"]


@pytest.mark.parametrize(
    ("limits", "axis", "shown"),
    [
        ("-0.6 0.5", "0 0 1", "    limits: {steer: [-0.6, 0.5]}"),
        ("-0.6 0.5", "0 0 -1", "    limits: {steer: [-0.5, 0.6]}"),
        ("-1e16 1e16", "0 0 1", None),
        ("-3.5 3.5", "0 0 1", None),
        ("0 0", "0 0 1", None),
        ("0.2 0.5", "0 0 1", None),
    ],
)
def test_steering_limits_are_kept_where_they_are_some(
    read: Import, wmrgen_cli: Cli, tmp_path: Path, limits: str, axis: str, shown: str | None
) -> None:
    driven = control("left_joint", "a_turn", "b_turn")
    arms = "".join(arm(n, y, limits=limits, axis=axis) for n, y in (("a", 0.2), ("b", -0.2)))
    said = read(robot(pair(), arms, driven))
    lines = [line for line in said["text"].splitlines() if line.startswith("    limits")]
    assert lines == ([shown, shown] if shown else [])
    if (limits, axis) == ("-0.6 0.5", "0 0 -1"):
        done = wmrgen_cli("derive", tmp_path / "probe.yaml", "-o", tmp_path / "out", "--json")
        assert done.code == 0 and json.loads(done.out)["robot_type"] == [1, 1]


@pytest.mark.parametrize(("first", "second"), [("left", "right"), ("right", "left")])
def test_two_wheels_joined_by_a_joint(read: Import, first: str, second: str) -> None:
    between = joint("differential", f"{first}_link", f"{second}_link", "0 -0.5 0")
    assert (second, "equal") in read(robot(pair(), between))["asked"]


def test_an_articulated_body_looks_like_steering(read: Import) -> None:
    front = link("front") + joint("waist", "base_link", "front", "0.5 0 0.1", "revolute", "0 0 1",
                                  more='<limit lower="-0.7" upper="0.7"/>')  # fmt: skip
    wheels = "".join(wheel(n, f"0 {y} 0", parent="front") for n, y in (("a", 0.4), ("b", -0.4)))
    said = read(robot(pair(), front, wheels, control("left_joint", "a_joint")))
    assert said["asked"] == [("a", "type"), ("b", "type")]
    twin = wheels.replace("0 0.4 0", "0 0.05 0").replace("0 -0.4 0", "0 -0.05 0")
    assert read(robot(pair(), front, twin, control("left_joint", "a_joint")))["asked"] == []


def test_a_body_that_turns_above_the_steering_is_asked_about(read: Import) -> None:
    """Two wheels that steer on a part of the robot that turns, too."""
    waist = link("front") + joint("waist", "base_link", "front", "0.5 0 0.1", axis="0 0 1")
    steered = ""
    for n, y in (("a", 0.4), ("b", -0.4)):
        steered += link(f"{n}_s") + joint(f"{n}_s", "front", f"{n}_s", f"0 {y} 0", axis="0 0 1")
        steered += wheel(n, "0 0 0", parent=f"{n}_s")
    driven = control("left_joint", "right_joint", "a_s", "b_s")
    said = read(robot(pair(), waist, steered, driven))
    assert said["asked"] == [("a", "type"), ("b", "type")] and "'waist'" in said["text"]
    rocker = waist.replace("0 0 1", "1 0 0")
    assert read(robot(pair(), rocker, steered, driven))["asked"] == []


def test_wheels_on_upright_axes_are_no_robot_and_nothing_else_is_taken_for_them(
    wmrgen_cli: Cli, tmp_path: Path
) -> None:
    """A body as CAD exports it, its z across: what else turns is a gripper's, or stands still."""
    lying = "".join(wheel(f"{n}_wheel", f"{x} 0 {y}", axis="0 0 1") for n, (x, y) in CORNERS.items())
    pads = wheel("pad_a_wheel", "0.4 0.1 0") + wheel("pad_b_wheel", "0.4 -0.1 0")
    (tmp_path / "probe.urdf").write_text(
        robot(lying, pads, control(*(f"{n}_wheel_joint" for n in CORNERS))), "utf-8"
    )
    done = wmrgen_cli("import", tmp_path / "probe.urdf")
    assert done.code == 2 and "0 joints are wheels" in done.err
    assert "joint 'fl_wheel_joint' is not taken for a wheel: its axis is upright" in done.err


def test_a_driven_wheel_on_an_upright_axis_is_noted(read: Import) -> None:
    lying = wheel("wheel5", "0 0 0.1", axis="0 0 1")
    said = read(robot(four(), lying, control("fl_joint", "wheel5_joint")))
    assert "joint 'wheel5_joint' is not taken for a wheel: its axis is upright" in said["notes"]
    assert list(said["wheels"]) == list(CORNERS)


def test_wheels_that_steer_and_stand_across_at_zero_keep_the_front_that_their_names_say(
    read: Import,
) -> None:
    across = modules({}).replace('<axis xyz="0 1 0"/>', '<axis xyz="1 0 0"/>').replace("1.57 0 0", "0 1.57 0")
    said = read(robot(across))
    assert said["asked"] == [("fl", "heading")] and "--forward" in said["text"]
    assert "as it seems to be" not in said["text"]


@pytest.mark.parametrize(("mirrored", "type_"), [(("fl", "rr"), "swedish"), (("fl", "rl"), "fixed")])
def test_a_mesh_mirrored_on_the_diagonals_has_rollers(
    read: Import, mirrored: tuple[str, str], type_: str
) -> None:
    shapes = {
        n: f'<mesh filename="package://p/wheel.dae" scale="{-1 if n in mirrored else 1} 1 1"/>'
        for n in CORNERS
    }
    wheels = "".join(wheel(n, f"{x} {y} 0.1", shapes[n]) for n, (x, y) in CORNERS.items())
    said = read(robot(wheels))
    assert {w["type"] for w in said["wheels"].values()} == {type_}
    assert (("fl", "gamma") in said["asked"]) == (type_ == "swedish")


def test_a_joint_about_the_wheels_own_axle_may_be_meant_to_steer(read: Import) -> None:
    """A rocker turns about another axle, and is suspension."""
    more = '<limit lower="0" upper="0"/>'
    both = "".join(
        link(f"{n}_arm") + joint(f"{n}_turn", "base_link", f"{n}_arm", f"1 {y} 0.1", "revolute", more=more)
        + wheel(n, "0.02 0 0", parent=f"{n}_arm") for n, y in (("a", 0.25), ("b", -0.25))
    )  # fmt: skip
    driven = control("left_joint", "right_joint")
    assert read(robot(pair(), both, driven))["asked"] == []
    centred = both.replace('xyz="0.02 0 0"', 'xyz="0 0 0"')
    assert read(robot(pair(), centred, driven))["asked"] == [("a", "type"), ("b", "type")]


def test_only_what_concerns_wheels_says_rollers(read: Import) -> None:
    """Not the name of a sensor, or of another link."""
    others = '<gazebo><plugin filename="libgazebo_ros_ir_sensor.so" name="ir_omni"/></gazebo>' + link(
        "omni_sensor"
    )
    assert {w["type"] for w in read(robot(pair(), others))["wheels"].values()} == {"fixed"}
    named = pair().replace("left", "left_omni").replace("right", "right_omni")
    assert {w["type"] for w in read(robot(named))["wheels"].values()} == {"swedish"}


def test_a_large_wheel_beside_a_small_castor_is_no_mesh_in_the_air(read: Import) -> None:
    """Its centre is 0.08 m above the castor's: known by the radius that the controller has."""
    mesh = '<mesh filename="package://x/wheel.stl"/>'
    fork = link("fork") + joint("swivel", "base_link", "fork", "-0.3 0 0.2", axis="0 0 1")
    tail = wheel("tail", "-0.04 0 -0.18", mesh, parent="fork")
    plugin = '<gazebo><plugin filename="libdiff.so"><wheel_radius>0.1</wheel_radius></plugin></gazebo>'
    wheels = read(robot(pair(geometry=mesh), fork, tail, plugin))["wheels"]
    assert list(wheels) == ["left", "right", "tail"]


def test_swivels_of_a_robot_that_says_mecanum(read: Import) -> None:
    arms = "".join(arm(n, y) for n, y in (("a", 0.2), ("b", -0.2)))
    words = '<gazebo><plugin filename="libmecanum_drive.so" name="x"/></gazebo>'
    said = read(robot(arms, words))
    assert [w["type"] for w in said["wheels"].values()] == ["steered", "steered"]
    assert said["asked"][:2] == [("a", "type"), ("b", "type")]


def test_a_wheel_beside_its_steering_axis_without_a_mesh(read: Import) -> None:
    """Nothing is drawn that could stand elsewhere than its joint: the radius alone is asked."""
    arm = link("arm") + joint("turn", "base_link", "arm", "0.5 0 0.3", axis="0 0 1")
    bare = link("front_link") + joint("front_joint", "arm", "front_link", "0 0.03 -0.2")
    said = read(robot(pair(), arm, bare))
    assert ("front", "r") in said["asked"] and ("front", "offset_y") not in said["asked"]
    assert said["wheels"]["front"]["offset_y"] == 0.03
