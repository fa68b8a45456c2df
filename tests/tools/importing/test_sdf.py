"""SDF: wheels of a robot are the same by whatever frames a file gives them. What is expected of single features was
worked out by hand.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import Outcome
from tests.depth import DEEP
from tests.tools.importing.drawn_sdf import sdf, unsnapped
from wmrgen.tools.importing.read import MAX_BYTES

Cli = Callable[..., Outcome]
Import = Callable[..., dict[str, Any]]


@pytest.fixture
def read(wmrgen_cli: Cli, tmp_path: Path) -> Import:
    """What `wmrgen import --json` says of an SDF, wheels by their joints."""

    def call(text: str, *options: str) -> dict[str, Any]:
        place = tmp_path / "probe"
        place.mkdir(exist_ok=True)
        (place / "model.sdf").write_text(text, encoding="utf-8")
        done = wmrgen_cli("import", place / "model.sdf", "-o", tmp_path / "probe.yaml", "--json", *options)
        assert done.code == 0, done.err
        said = json.loads(done.out)
        return {**said, "wheels": {w["joint"]: w for w in said["wheels"]}, "notes": done.err}

    return call


def wheel(
    name: str, pose: str, shape: str = "", axis: str = "", more: str = "", kind: str = "revolute"
) -> str:
    """A link turned so that its z lies along y, a cylinder of radius 0.1 about it, and its joint."""
    shape = shape or "<cylinder><radius>0.1</radius><length>0.05</length></cylinder>"
    axis = axis or "<axis><xyz>0 0 1</xyz></axis>"
    return (
        f'<link name="{name}"><pose>{pose} -1.5707963 0 0</pose>'
        f'<collision name="c"><geometry>{shape}</geometry>{more}</collision></link>'
        f'<joint name="{name}_joint" type="{kind}"><parent>chassis</parent><child>{name}</child>{axis}</joint>'
    )


CHASSIS = '<link name="chassis"><pose>-0.15 0 0.2 0 0 0</pose></link>'
PAIR = CHASSIS + wheel("left", "0.05 0.25 0.1") + wheel("right", "0.05 -0.25 0.1")


@pytest.mark.parametrize("seed", range(100 if DEEP else 4))
def test_wheels_do_not_depend_on_the_frames_of_the_file(read: Import, seed: int) -> None:
    text, truth = unsnapped(seed)
    said = read(text)
    assert said["base"] == "__model__" and set(said["wheels"]) == set(truth)
    for name, (x, y, heading, d, offset) in truth.items():
        w = said["wheels"][name]
        assert (w["x"], w["y"], w["r"]) == pytest.approx((x, y, 0.1), abs=1e-9), name
        assert abs(math.remainder(w["heading"] - heading, 2 * math.pi)) < 1e-9, name
        assert (w["d"] or 0.0, w["offset_y"] or 0.0) == pytest.approx((d, offset), abs=1e-9), name
    assert [said["wheels"][n]["type"] for n in truth] == ["fixed", "fixed", "castor", "steered"]
    front = said["wheels"]["front_joint"]
    assert front["steer_joint"] == "front_joint" and said["wheels"]["tail_joint"]["steer_joint"] == "swivel"


def test_decimals_stay_decimals(read: Import, tmp_path: Path) -> None:
    said = read(sdf(PAIR))
    assert said["questions"] == [] and {w["heading"] for w in said["wheels"].values()} == {0.0}
    lines = (tmp_path / "probe.yaml").read_text(encoding="utf-8").splitlines()
    assert "    x: 0.05   # centre of the collision cylinder of joint 'left_joint'" in lines


@pytest.mark.parametrize(
    ("inside", "ratios"),
    [("", ""), ("<multiplier>2</multiplier><offset>0.3</offset>", ", ratios: [1, 2]")],
)
def test_a_joint_that_mimics_is_coupled(read: Import, tmp_path: Path, inside: str, ratios: str) -> None:
    mimic = f'<mimic joint="left_joint">{inside}</mimic></axis>'
    read(sdf(PAIR + wheel("back", "-0.3 0.25 0.1").replace("</axis>", mimic)))
    text = (tmp_path / "probe.yaml").read_text(encoding="utf-8")
    assert f"  - {{equal: [left.spin, back.spin]{ratios}}}   # mimic" in text


@pytest.mark.parametrize(
    ("version", "said", "heading"),
    [
        ("1.4", "", 0.0),
        ("1.5", "", -math.pi / 2),
        ("1.6", "<use_parent_model_frame>1</use_parent_model_frame>", 0.0),
    ],
)
def test_axes_are_in_the_joint_or_in_the_model(read: Import, version: str, said: str, heading: float) -> None:
    """0 1 0 along y; or in a link that is turned by -90 deg about x and 90 deg about its z before: along x."""
    parts = CHASSIS + "".join(
        wheel(
            n, f"0 {y} 0.1", "<sphere><radius>0.1</radius></sphere>", f"<axis><xyz>0 1 0</xyz>{said}</axis>"
        )
        for n, y in (("left", 0.2), ("right", -0.2))
    )
    parts = parts.replace("-1.5707963 0 0", "0 0 -1.5707963")
    assert {w["heading"] for w in read(sdf(parts, version=version))["wheels"].values()} == {heading}


@pytest.mark.parametrize(("kind", "order"), [("universal", 1), ("revolute2", 1), ("revolute2", -1)])
def test_two_axes_steer_and_spin(read: Import, kind: str, order: int, tmp_path: Path) -> None:
    """The upright one steers, whichever stands first, and its limits are the steering angle's."""
    steer = "<xyz>0 -1 0</xyz><limit><lower>-0.6</lower><upper>0.6</upper></limit>"
    keys = ("axis", "axis2")[::order]
    both = f"<{keys[0]}>{steer}</{keys[0]}><{keys[1]}><xyz>0 0 1</xyz></{keys[1]}>"
    said = read(sdf(PAIR, wheel("front", "0.5 0 0.1", axis=both, kind=kind)))["wheels"]
    front = said["front_joint"]
    assert (front["type"], front["steer_joint"], front["d"]) == ("steered", "front_joint", 0.0)
    assert {w["type"] for w in said.values()} == {"fixed", "steered"}
    assert "couplings:" not in (tmp_path / "probe.yaml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("limits", "count"),
    [("-1.79769e+308 1.79769e+308", 3), ("-inf inf", 3), ("-1e16 1e16", 3), ("-3 3", 2), ("0 0", 2)],
)
def test_limits(read: Import, limits: str, count: int) -> None:
    """Those as large as a float are none; one angle is a lock."""
    low, high = limits.split()
    axis = f"<axis><xyz>0 0 1</xyz><limit><lower>{low}</lower><upper>{high}</upper></limit></axis>"
    assert len(read(sdf(PAIR, wheel("third", "-0.3 0 0.1", axis=axis)))["wheels"]) == count


MECANUM = {"fl": (0.3, 0.25, "1 -1 0"), "fr": (0.3, -0.25, "1 1 0"), "bl": (-0.3, 0.25, "1 1 0"),
           "br": (-0.3, -0.25, "1 -1 0")}  # fmt: skip


def mecanum(where: str, turn: str = "") -> str:
    return CHASSIS + "".join(
        wheel(n, f"{x} {y} 0.1", more="<surface><friction><ode><mu>1</mu><mu2>0</mu2>"
              f"<fdir1 {where}>{turn or along}</fdir1></ode></friction></surface>")
        for n, (x, y, along) in MECANUM.items()
    )  # fmt: skip


@pytest.mark.parametrize(("space", "declared"), [("gz", True), ("ignition", True), ("gz", False)])
def test_gamma_by_the_direction_of_friction(read: Import, space: str, declared: bool) -> None:
    """Simulators do not ask for the declaration of a prefix."""
    declaration = f'xmlns:{space}="x" ' * declared
    said = read(sdf(mecanum(f'{declaration}{space}:expressed_in="chassis"')))
    gammas = [said["wheels"][f"{n}_joint"]["gamma"] * 4 / math.pi for n in MECANUM]
    assert gammas == pytest.approx([-1, 1, 1, -1]) and said["questions"] == []


def test_a_direction_of_friction_that_turns_with_the_wheel_is_asked_about(read: Import) -> None:
    """1 0 1 of the collision, whose z is the wheel's axle, stands 45 deg off the wheel plane at joint angle 0."""
    said = read(sdf(mecanum("", "1 0 1")))
    assert {(w["type"], w["gamma"]) for w in said["wheels"].values()} == {("swedish", None)}
    assert [(q["answer"], len(q["also"])) for q in said["questions"]] == [("rollers", 3)]


PLUGINS = [
    ("libDiffDrivePlugin.so", "diff_drive", ["left_joint", "right_joint"]),
    ("gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive", ["left_joint", "right_joint"]),
    ("libSkidSteerDrivePlugin.so", "skid", ["right_front", "left_front"]),
    ("gz-sim-tricycle-drive", "x", ["traction_joint", "left_joint"]),
]


@pytest.mark.parametrize(("filename", "name", "tags"), PLUGINS)
def test_plugins_name_what_is_driven(read: Import, filename: str, name: str, tags: list[str]) -> None:
    joints = "".join(
        f"<{t}>{j}</{t}>" for t, j in zip(tags, ("left_joint", "probe::right_joint"), strict=True)
    )
    third = wheel("third", "-0.3 0 0.1")
    said = read(sdf(PAIR, third, f'<plugin filename="{filename}" name="{name}">{joints}</plugin>'))["wheels"]
    assert [said[f"{n}_joint"]["actuated"] for n in ("left", "right", "third")] == [["spin"], ["spin"], []]


def test_what_publishes_does_not_drive_and_what_moves_the_body_drives_no_wheel(read: Import) -> None:
    states = (
        '<plugin filename="gz-sim-joint-state-publisher-system"><joint_name>left_joint</joint_name></plugin>'
    )
    assert read(sdf(PAIR, states))["wheels"]["left_joint"]["actuated"] is None
    drives = '<plugin filename="libsimulation_drive.so" name="x"><joint>left_joint</joint></plugin>'
    assert read(sdf(PAIR, drives))["wheels"]["left_joint"]["actuated"] == ["spin"]
    moves = '<plugin filename="libgazebo_ros_planar_move.so" name="object_controller"/>'
    assert read(sdf(PAIR, moves))["wheels"]["left_joint"]["actuated"] == []


SIDE = ('<sdf version="1.9"><model name="side" canonical_link="hub"><link name="hub"><pose>1 0 0 0 0 0</pose></link>{}'
        "</model></sdf>").format(wheel("rim", "1 0.2 0.1").replace("<parent>chassis", "<parent>hub"))  # fmt: skip


@pytest.fixture
def side(tmp_path: Path) -> Path:
    """A model of a hub at x = 1 and a wheel 0.2 m to its left."""
    folder = tmp_path / "parts"
    folder.mkdir()
    (folder / "new.sdf").write_text(SIDE, encoding="utf-8")
    (folder / "model.config").write_text(
        '<model><sdf version="1.0">old.sdf</sdf><sdf version="1.9">new.sdf</sdf></model>', encoding="utf-8"
    )
    return folder


@pytest.mark.parametrize("scheme", ["model://", ""])
@pytest.mark.parametrize("merge", ["", ' merge="true"'])
def test_included_models_stand_at_their_place(read: Import, side: Path, merge: str, scheme: str) -> None:
    """Put down by its hub, which is the model's origin moved by 1, at x = -0.4 and turned round: the wheel is at
    y = -0.2, its axis backward."""
    include = (
        f"<include{merge}><uri>{scheme}side</uri><name>back</name><placement_frame>hub</placement_frame>"
        "<pose>-0.4 0 0 0 0 3.14159265</pose></include>"
    )
    inner = "" if merge else "back::"
    hold = f'<joint name="hold" type="fixed"><parent>chassis</parent><child>{inner}hub</child></joint>'
    said = read(sdf(PAIR, include, hold), "--package", f"side={side}")
    back = said["wheels"][f"{inner}rim_joint"]
    assert (back["x"], back["y"], back["heading"]) == (-0.4, -0.2, math.pi)


@pytest.mark.parametrize("more", [0, 1])
def test_the_largest_model_config_is_read(
    read: Import, wmrgen_cli: Cli, side: Path, tmp_path: Path, more: int
) -> None:
    """Of exactly so many bytes; one more is refused."""
    config = side / "model.config"
    text = config.read_bytes()
    config.write_bytes(text + b" " * (MAX_BYTES + more - len(text)))
    include = "<include><uri>model://side</uri></include>"
    if more:
        (tmp_path / "probe.sdf").write_text(sdf(PAIR, include), encoding="utf-8")
        refused = wmrgen_cli("import", tmp_path / "probe.sdf", "--package", f"side={side}")
        assert refused.code == 2 and "model.config: larger than 4 MiB" in refused.err
    else:
        assert "is not read" not in read(sdf(PAIR, include), "--package", f"side={side}")["notes"]


def test_a_world_includes_its_robot(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "bot").mkdir()
    (tmp_path / "bot" / "model.sdf").write_text(sdf(PAIR), encoding="utf-8")
    world = "<include><uri>model://bot</uri><pose>5 5 0 0 0 1</pose></include>"
    world = f'<sdf version="1.6"><world name="w">{world}</world></sdf>'
    assert list(read(world, "--package", f"bot={tmp_path / 'bot'}")["wheels"]) == [
        "left_joint",
        "right_joint",
    ]
    (tmp_path / "world.sdf").write_text(world, encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "world.sdf")
    assert done.code == 2 and "'model://bot' is not read" in done.err


def test_nested_models_and_frames_of_joints(read: Import) -> None:
    """A joint may name a frame, or a model, for the links that carry them; a pose may be relative to a joint."""
    inner = (
        '<model name="arm"><pose relative_to="left_joint">0 0 0 1.5707963 0 0</pose><link name="a"/>'
        '<frame name="tip" attached_to="a"><pose>-0.5 0 0 0 0 0</pose></frame></model>'
        '<joint name="hold" type="fixed"><parent>chassis</parent><child>arm</child></joint>'
    )
    rear = wheel("rear", "0 0 0").replace("<pose>", '<pose relative_to="arm::tip">')
    rear = rear.replace("<parent>chassis", "<parent>arm::tip")
    w = read(sdf(PAIR, inner, rear))["wheels"]["rear_joint"]
    assert (w["x"], w["y"], w["heading"]) == (-0.45, 0.25, 0.0)


@pytest.mark.parametrize(
    ("named", "inside", "driven"),
    [
        ("b::turn", "", {"b::turn"}),
        ("robot::b::turn", "", {"b::turn"}),
        ("", "turn", {"b::turn"}),
        ("other::turn", "", {"a::turn", "b::turn"}),
    ],
)
def test_of_joints_of_one_name_those_are_driven_that_a_plugin_means(
    read: Import, named: str, inside: str, driven: set[str]
) -> None:
    """One name in two models: a plugin says which, or stands in its model."""
    models = ""
    for name, x in (("a", 0.4), ("b", -0.4)):
        turn = wheel("w", "0 0 0").replace("w_joint", "turn").replace("chassis", "hub")
        plugin = f'<plugin name="p" filename="drive"><joint>{inside}</joint></plugin>' if name == "b" else ""
        models += (
            f'<model name="{name}"><pose>{x} 0 0.1 0 0 0</pose><link name="hub"/>{turn}{plugin}</model>'
            f'<joint name="hold_{name}" type="fixed"><parent>chassis</parent><child>{name}::hub</child></joint>'
        )
    models += f'<plugin name="p" filename="drive"><joint>{named}</joint></plugin>'
    said = read(sdf(PAIR, models))["wheels"]
    assert {joint for joint, w in said.items() if w["actuated"]} == driven


def test_a_model_that_nobody_gave_is_named(read: Import, wmrgen_cli: Cli, tmp_path: Path) -> None:
    include = "<include><uri>model://sonar</uri></include>"
    assert "--package NAME=DIR" in read(sdf(PAIR, include))["notes"]
    turn = '<joint name="turn" type="revolute"><parent>chassis</parent><child>sonar::link</child></joint>'
    (tmp_path / "bad.sdf").write_text(sdf(PAIR, include, turn), encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "bad.sdf")
    assert done.code == 2 and "--package sonar=DIR" in done.err
    assert "joint 'turn': there is no link or frame 'sonar::link'" in done.err


ENDS = "<limit><lower>-1</lower><upper>1</upper></limit>"


@pytest.mark.parametrize(
    ("kind", "axis", "parent", "child", "hangs"),
    [
        ("fixed", "", "chassis", "sonar", False),
        ("revolute", ENDS, "chassis", "sonar", False),
        ("revolute", ENDS, "sonar", "mast", False),
        ("revolute", "", "chassis", "sonar", True),  # it may be a wheel's
        ("revolute", ENDS, "sonar", "knuckle", True),  # a wheel turns on it
        ("fixed", "", "sonar", "arm", True),  # and on what it carries
    ],
)
def test_a_joint_without_its_link_is_passed_over_where_no_wheel_hangs_on_it(
    wmrgen_cli: Cli, tmp_path: Path, kind: str, axis: str, parent: str, child: str, hangs: bool
) -> None:
    front = wheel("front", "0.5 0 0.1").replace("<parent>chassis", "<parent>knuckle")
    bodies = "".join(
        f'<link name="{name}"><pose>0.5 0 0.1 0 0 0</pose></link>' for name in ("knuckle", "mast", "arm")
    )
    arm = (
        "<joint name='arm' type='fixed'><parent>arm</parent><child>knuckle</child></joint>"
        if child == "arm"
        else ""
    )
    lost = (
        f'<joint name="lost" type="{kind}"><parent>{parent}</parent><child>{child}</child>'
        f"<axis><xyz>0 0 1</xyz>{axis}</axis></joint>"
    )
    (tmp_path / "probe.sdf").write_text(sdf(PAIR, bodies, front, arm, lost), encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "probe.sdf", "--json")
    words = "joint 'lost': there is no link or frame 'sonar'"
    assert done.code == (2 if hangs else 0) and words in done.err
    assert (f"{words}; it is not read" in done.err) is not hangs
    if not hangs:
        assert {"left_joint", "right_joint", "front_joint"} == {
            w["joint"] for w in json.loads(done.out)["wheels"]
        }


def test_includes_stay_inside(read: Import, side: Path, tmp_path: Path) -> None:
    """No way up, through a link of the file system, or to a model that includes itself."""
    (tmp_path / "outside.sdf").write_text(SIDE, encoding="utf-8")
    for uri in (
        "../outside.sdf",
        "model://side/../outside.sdf",
        f"file://{tmp_path}/outside.sdf",
        "https://a/b",
    ):
        said = read(sdf(PAIR, f"<include><uri>{uri}</uri></include>"), "--package", f"side={side}")
        assert len(said["wheels"]) == 2 and "is not read" in said["notes"], uri
    (side / "model.config").write_text("<model><sdf>../outside.sdf</sdf></model>", encoding="utf-8")
    said = read(sdf(PAIR, "<include><uri>model://side</uri></include>"), "--package", f"side={side}")
    assert len(said["wheels"]) == 2


@pytest.mark.parametrize(
    ("part", "note"),
    [
        ('<joint name="g" type="gearbox"><parent>left</parent><child>right</child></joint>', "'g' is a gearbox"),
        (wheel("tail", "-0.3 0 0.1").replace("tail_joint", "left_joint"), "several joints have this name"),
        (wheel("tail", "-0.3 0 0.1", more="<surface><friction><ode><fdir1>1 0</fdir1></ode></friction></surface>"),
         "link 'tail': fdir1: three numbers are needed, not '1 0'; this fdir1 is not read"),
        (wheel("tail", "-0.3 0 0.1", "<sphere><radius>-0.1</radius></sphere>"), "a radius of -0.1 is not read"),
    ],
)  # fmt: skip
def test_what_is_passed_over_is_noted(read: Import, part: str, note: str) -> None:
    said = read(sdf(PAIR, part))
    assert {"left_joint", "right_joint"} <= set(said["wheels"]) and note in said["notes"]


@pytest.mark.parametrize(
    ("parts", "words", "place"),
    [
        (PAIR.replace("<child>left<", "<child>no<"), "'no'", '<joint name="left_joint"'),
        (PAIR.replace("<child>left</child>", ""), "'left_joint' has no <child>", '<joint name="left_joint"'),
        (PAIR.replace("<pose>0.05 0", '<pose relative_to="f">0.05 0'), "no frame 'f'", '<link name="left"'),
        (PAIR.replace("<pose>0.05 0", '<pose rotation_format="quat_xyzw">0.05 0'), "seven numbers", "<pose rotation"),
        (PAIR.replace("<pose>0.05 0.25", '<pose relative_to="right_joint">0.05 0.25')
         .replace("<pose>0.05 -0.25", '<pose relative_to="left_joint">0.05 -0.25'), "relative to itself", "<joint"),
        (PAIR.replace('"c">', '"c"><pose relative_to="f">0 0 0 0 0 0</pose>'), "there is no frame 'f'", "<collision"),
        (PAIR.replace("0.05 0.25 0.1 ", "0.25 0.1 "), "six numbers", "<pose>0.25 0.1"),
        (PAIR.replace("<xyz>0 0 1", "<xyz>0 O 1"), "'O' is not a number", "<xyz>0 O 1"),
        (f'<!-- <joint name="left_joint">O -->{PAIR.replace("<xyz>0 0 1", "<xyz>0 O 1")}', "'O' is not", "<xyz>0 O 1"),
        (PAIR.replace("<radius>0.1", "<radius>1e99"), "too large", "<cylinder"),
        (PAIR + '<frame name="a" attached_to="b"/><frame name="b" attached_to="a"/>'
         '<joint name="j" type="fixed"><parent>a</parent><child>chassis</child></joint>', "attached to itself",
         '<joint name="j"'),
        (PAIR + '<model name="m" placement_frame="f"><link name="l"/></model>', "no frame 'm::f'", '<model name="m"'),
        (PAIR + '<include><uri>model.sdf</uri></include>', "more than 64 models", "<model"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused_with_its_place(
    wmrgen_cli: Cli, tmp_path: Path, parts: str, words: str, place: str
) -> None:
    text = sdf(parts).replace("><", ">\n<")
    (tmp_path / "model.sdf").write_text(text, encoding="utf-8")
    done = wmrgen_cli("import", tmp_path / "model.sdf")
    assert (done.code, done.out) == (2, "") and words in done.err, done.err
    line, column = map(int, re.findall(r"/model\.sdf:(\d+):(\d+)", done.err)[0])
    assert text.splitlines()[line - 1][column - 1 :].startswith(place), done.err


def test_a_world_has_its_first_robot_read(read: Import, tmp_path: Path) -> None:
    """By the version of its own file, whatever the others have: in 1.4 their axes would be vertical."""
    (tmp_path / "bot").mkdir()
    (tmp_path / "bot" / "model.sdf").write_text(sdf(PAIR, version="1.4"), encoding="utf-8")
    ground = '<model name="ground"><static>true</static><link name="link"/></model>'
    robots = "".join(f'<model name="{n}"><pose>9 9 9 1 1 1</pose>{PAIR}</model>' for n in ("blue", "green"))
    robots += "<include><uri>model://bot</uri></include>"
    world = f'<sdf version="1.6"><world name="w">{ground}{robots}</world></sdf>'
    said = read(world, "--package", f"bot={tmp_path / 'bot'}")
    assert said["wheels"]["left_joint"]["x"] == 0.05 and "only the model 'blue'" in said["notes"]
    assert "Frame: that of the model, x forward." in (tmp_path / "probe.yaml").read_text(encoding="utf-8")


def test_of_a_world_that_model_is_read_in_which_something_turns(read: Import, tmp_path: Path) -> None:
    """A scene of models comes first."""
    post = '<model name="post"><link name="l"/></model>'
    held = '<joint name="j" type="fixed"><parent>world</parent><child>post::l</child></joint>'
    scene = f'<model name="scene">{post}{held}</model>'
    world = f'<sdf version="1.7"><world name="w">{scene}<model name="bot">{PAIR}</model></world></sdf>'
    said = read(world)
    assert list(said["wheels"]) == ["left_joint", "right_joint"] and "not 'scene'" in said["notes"]
    assert "the first in which a joint turns without end" in said["notes"]
    rigid = re.sub('type="(continuous|revolute)"', 'type="fixed"', PAIR)
    robots = "".join(f'<model name="{name}">{rigid}</model>' for name in ("bot", "other"))
    notes = read(f'<sdf version="1.7"><world name="w">{robots}</world></sdf>')["notes"]
    assert "only the model 'bot' is read, the first that has joints, of which none turns without end" in notes
