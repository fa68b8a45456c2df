"""What is written has the form that its readers want, whatever a robot file says.

URDF and SDFormat by the rules of their specifications; Java and C++ by their compilers, against stubs of the few
classes of WPILib.
"""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from random import Random
from typing import get_args
from xml.etree.ElementTree import Element

import pytest
import yaml

import wmrgen
from tests.conftest import ROOT, Outcome, tree
from tests.tools.exporting.common import drives, gallery, load, root
from wmrgen.cli.export import Kind
from wmrgen.tools.exporting.ros2_control import ros2_control
from wmrgen.tools.exporting.sdf import sdf
from wmrgen.tools.exporting.urdf import urdf
from wmrgen.tools.exporting.wpilib import wpilib

Cli = Callable[..., Outcome]
EVERY_TYPE = [
    "ackermann_car",
    "clearpath_do100",
    "nomad_xr4000",
    "pr2",
    "textbook_differential",
    "textbook_tricycle",
]
HOSTILE = "ends */ --> ]]> -- } \\u002a\\u002f ??/ \\ // # \n- x: {y: 1}\n*/ </robot><!ENTITY a 'b'>&amp; \"'` é 😀 --"


def attribute(element: Element | None, name: str) -> str:
    assert element is not None and element.get(name) is not None, name
    return str(element.get(name))


@pytest.mark.parametrize("name", EVERY_TYPE)
def test_urdf_keeps_the_rules_of_its_specification(name: str) -> None:
    robot = root(urdf(gallery(name)))
    links = [attribute(link, "name") for link in robot.findall("link")]
    joints = robot.findall("joint")
    names = [attribute(joint, "name") for joint in joints]
    children = [attribute(joint.find("child"), "link") for joint in joints]
    parents = [attribute(joint.find("parent"), "link") for joint in joints]
    assert len({*links, *names}) == len(links) + len(names)
    assert len({*children}) == len(children) and {*children, *parents} == {*links}
    assert {*links} - {*children} == {"base_link"}
    for joint in joints:
        kind, limit, mimic = joint.get("type"), joint.find("limit"), joint.find("mimic")
        assert kind in ("fixed", "continuous", "revolute")
        for key in ("xyz", "rpy"):
            assert len([float(v) for v in attribute(joint.find("origin"), key).split()]) == 3
        if kind == "revolute":
            assert float(attribute(limit, "lower")) <= float(attribute(limit, "upper"))
        if limit is not None:
            assert float(attribute(limit, "effort")) > 0 and float(attribute(limit, "velocity")) >= 0
        if mimic is not None:
            assert mimic.get("joint") in names
    for link in robot.findall("link"):
        inertial = link.find("inertial")
        if link.get("name") == "base_link":
            assert inertial is None, "tools that build trees want none in the root"
            continue
        assert inertial is not None and float(attribute(inertial.find("mass"), "value")) > 0
        ixx, iyy, izz = (float(attribute(inertial.find("inertia"), key)) for key in ("ixx", "iyy", "izz"))
        assert min(ixx, iyy, izz) > 0 and 2 * max(ixx, iyy, izz) < ixx + iyy + izz, (
            "no body has these moments"
        )
        cylinder = link.find("collision/geometry/cylinder")
        if cylinder is not None:  # about y
            r, mass = float(attribute(cylinder, "radius")), float(attribute(inertial.find("mass"), "value"))
            assert ixx == izz and iyy == pytest.approx(mass * r**2 / 2)


@pytest.mark.parametrize("name", EVERY_TYPE)
def test_sdf_keeps_the_rules_of_its_specification(name: str) -> None:
    text = sdf(gallery(name))
    model = root(text).find("model")
    assert model is not None and root(text).get("version") == "1.8"
    names = [e.get("name") for e in model if e.tag in ("link", "joint")]
    assert len({*names}) == len(names), "links and joints share their names"
    for link in model.findall("link"):
        inner = [e.get("name") for e in link if e.tag in ("visual", "collision")]
        assert None not in inner and len({*inner}) == len(inner)
        assert all({e.tag for e in shape} <= {"pose", "geometry"} for shape in link.findall("visual"))
        pose = link.find("pose")
        assert (pose is None) == (link.get("name") == "base_link")
        assert pose is None or (len(str(pose.text).split()) == 6 and pose.get("relative_to") in names)
    for joint in model.findall("joint"):
        assert {joint.findtext("parent"), joint.findtext("child")} <= {*names}
        assert (joint.find("axis/xyz") is None) == (joint.get("type") == "fixed")
        assert joint.find("limit") is None and joint.find("origin") is None
        assert (joint.find("axis/limit/lower") is None) == (joint.get("type") != "revolute")


def test_names_of_wheels_that_are_those_of_links(tmp_path: Path) -> None:
    """Links and joints share their names in SDFormat; a case or an ending of ours in a wheel's name is no other's."""
    names = ["base", "chassis", "FL", "frontRight", "a", "a_spin", "a_steer", "a_spin_link", "model"]
    wheels = [f"name: {n}, type: fixed, x: {k}, y: 1, heading: 0, r: 0.1" for k, n in enumerate(names)]
    robot = load(
        tmp_path,
        *wheels,
        "name: ball, type: spherical, x: 0, y: 0",
        "name: a_ball, type: spherical, x: 1, y: 0",
    )
    model = root(sdf(robot)).find("model")
    assert model is not None
    for described in (root(urdf(robot)), model):
        found = [str(e.get("name")) for e in described if e.tag in ("link", "joint")]
        assert len({*found}) == len(found) == 2 * len(names) + 4 + (3 if described is not model else 1)
        assert {f"{n}_spin" for n in names} <= {*found}


def test_limits_and_frames_are_those_of_the_robot_file(tmp_path: Path) -> None:
    robot = load(
        tmp_path, "name: a, type: steered, x: 1, y: 0.5, heading: pi/2, r: 0.2, offset_y: 0.1, "
        "limits: {steer: [-0.5, 0.75], steer_rate: 3, spin: 12}",
        "name: b, type: fixed, x: 0, y: -0.5, heading: pi, r: 0.1",
    )  # fmt: skip
    joints = {j.get("name"): j for j in root(urdf(robot)).findall("joint")}
    steer, spin, back = joints["a_steer"], joints["a_spin"], joints["b_spin"]
    limit = steer.find("limit")
    assert limit is not None and {k: limit.get(k) for k in ("lower", "upper", "velocity")} == {
        "lower": "-0.5", "upper": "0.75", "velocity": "3",
    }  # fmt: skip
    assert attribute(spin.find("limit"), "velocity") == "12" and spin.get("type") == "continuous"
    assert back.find("limit") is None
    assert attribute(steer.find("origin"), "xyz") == "1 0.5 0.2"
    assert float(attribute(steer.find("origin"), "rpy").split()[2]) == pytest.approx(math.pi / 2, abs=1e-12)
    assert attribute(spin.find("origin"), "xyz") == "0 0.1 0"
    assert attribute(spin.find("parent"), "link") == "a_steer_link"
    assert (attribute(steer.find("axis"), "xyz"), attribute(spin.find("axis"), "xyz")) == ("0 0 1", "0 1 0")


def test_rollers_grip_along_their_axis_seen_from_the_base(tmp_path: Path) -> None:
    robot = load(tmp_path, "name: m, type: swedish, x: 1, y: 0, heading: pi/2, gamma: -pi/6, r: 0.1")
    (grip,) = root(urdf(robot)).iter("fdir1")
    assert grip.get("{http://gazebosim.org/schema}expressed_in") == "base_link"
    assert [float(v) for v in str(grip.text).split()] == pytest.approx([0.5, math.sqrt(3) / 2, 0], abs=1e-12)
    assert "m: gamma = -30 deg" in urdf(robot)
    assert [e.get("name") for e in root(urdf(robot)).findall("link/collision")] == [None], (
        "Gazebo would not join them"
    )


def test_a_ball_slips_and_what_the_file_does_not_say_is_marked(tmp_path: Path) -> None:
    robot = load(
        tmp_path,
        "name: w, type: fixed, x: 0, y: 0, heading: 0, r: 0.1",
        "name: b, type: spherical, x: 1, y: 0",
    )
    text = urdf(robot)
    assert [e.text for e in root(text).iter("mu")] == ["0"] and "PLACEHOLDERS" in text
    assert text.count("<!-- placeholder -->") == text.count("<inertial>") == 3


def test_hostile_descriptions_stay_in_their_comments(tmp_path: Path) -> None:
    for kind, writers in {"differential": (ros2_control, wpilib), "mecanum": (ros2_control, wpilib)}.items():
        wheels, more = drives(Random(1))[kind]
        plain = load(tmp_path, *wheels, more=more)
        hostile = replace(plain, description=HOSTILE)
        for write in (lambda r: {"a.urdf": urdf(r), "a.sdf": sdf(r)}, *writers):
            for (name, text), expected in zip(write(hostile).items(), write(plain).values(), strict=True):
                assert "ends" in text
                if name.endswith("yaml"):
                    assert yaml.safe_load(text) == yaml.safe_load(expected)
                elif name.endswith(("urdf", "sdf")):
                    assert elements(root(text)) == elements(root(expected))
                else:
                    assert "\\" not in text and text.isascii()
                    assert uncommented(text) == uncommented(expected)


def elements(element: Element) -> object:
    return element.tag, element.attrib, (element.text or "").strip(), [elements(e) for e in element]


def uncommented(text: str) -> str:
    return re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)


# ---- the command


def test_export_prints_or_writes(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    for kind, names in {
        "urdf": ["pair.urdf"], "sdf": ["pair.sdf"], "ros2_control": ["pair.urdf", "pair_controllers.yaml"],
        "wpilib": ["PairConstants.java", "PairConstants.h"],
    }.items():  # fmt: skip
        printed = wmrgen_cli("export", robot_file, "--to", kind)
        data = json.loads(wmrgen_cli("export", robot_file, "--to", kind, "--json").out)
        assert (data["robot"], data["to"], list(data["files"])) == ("pair", kind, names)
        heads = [f"==> {name} <==\n" for name in names] if len(names) > 1 else [""]
        assert printed.out == "".join(h + t for h, t in zip(heads, data["files"].values(), strict=True))
        out = tmp_path / kind
        done = wmrgen_cli("export", robot_file, "--to", kind, "-o", out)
        assert (done.code, done.out.splitlines()) == (0, [str(out / name) for name in names])
        assert tree(out) == {name: data["files"][name].encode() for name in names}


def test_export_to_a_file(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    assert wmrgen_cli("export", robot_file, "--to", "urdf", "-o", tmp_path / "my.urdf").code == 0
    assert (tmp_path / "my.urdf").read_text() == urdf(wmrgen.load(robot_file))
    refused = wmrgen_cli("export", robot_file, "--to", "wpilib", "-o", tmp_path / "my.java")
    assert refused.code == 2 and "wpilib is 2 files" in refused.err and not (tmp_path / "my.java").exists()


def test_what_does_not_fit_is_refused_and_nothing_written(wmrgen_cli: Cli, tmp_path: Path) -> None:
    done = wmrgen_cli("export", ROOT / "robots/pr2.yaml", "--to", "wpilib", "-o", tmp_path / "out")
    assert done.code == 3 and "no kinematics of WPILib fits" in done.err and not (tmp_path / "out").exists()
    assert wmrgen_cli("export", ROOT / "robots/pr2.yaml", "--to", "mjcf").code == 2
    assert set(get_args(Kind)) == {"urdf", "sdf", "ros2_control", "wpilib", "nav2", "robot_localization"}


# ---- compilers

JAVA = {
    "geometry/Translation2d": "public record Translation2d(double x, double y) {}",
    "kinematics/DifferentialDriveKinematics": "public record DifferentialDriveKinematics(double track) {}",
    "kinematics/MecanumDriveKinematics": "import edu.wpi.first.math.geometry.Translation2d; public record "
    "MecanumDriveKinematics(Translation2d a, Translation2d b, Translation2d c, Translation2d d) {}",
    "kinematics/SwerveDriveKinematics": "import edu.wpi.first.math.geometry.Translation2d; public class "
    "SwerveDriveKinematics { public SwerveDriveKinematics(Translation2d... modules) {} }",
}
UNIT = "namespace units {{ struct {0} {{ double v; constexpr explicit {0}(double x) : v(x) {{}} }}; }}"
CPP = {
    "units/length.h": UNIT.format("meter_t"),
    "units/angle.h": UNIT.format("radian_t"),
    "frc/geometry/Translation2d.h": "namespace frc { struct Translation2d { constexpr Translation2d(units::meter_t, "
    "units::meter_t) {} }; }",
    "frc/kinematics/DifferentialDriveKinematics.h": "namespace frc { struct DifferentialDriveKinematics { constexpr "
    "explicit DifferentialDriveKinematics(units::meter_t) {} }; }",
    "frc/kinematics/MecanumDriveKinematics.h": "namespace frc { struct MecanumDriveKinematics { explicit "
    "MecanumDriveKinematics(Translation2d, Translation2d, Translation2d, Translation2d) {} }; }",
    "frc/kinematics/SwerveDriveKinematics.h": "namespace frc { template <int N> struct SwerveDriveKinematics { "
    "template <class... T> explicit SwerveDriveKinematics(T &&...) { static_assert(sizeof...(T) == N); } }; }",
}  # fmt: skip
DRIVES = ["pioneer3dx", "nexus_4wd", "wpilib_swervebot"]


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("javac"), reason="no Java compiler")
def test_java_compiles(tmp_path: Path) -> None:
    for path, text in JAVA.items():
        file = tmp_path / f"edu/wpi/first/math/{path}.java"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"package edu.wpi.first.math.{path.split('/')[0]};\n{text}\n")
    robots = [replace(gallery(name), description=HOSTILE) for name in DRIVES]
    files = {n: t for robot in robots for n, t in wpilib(robot).items() if n.endswith(".java")}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    done = subprocess.run(
        ["javac", "-Xlint:all", "-Werror", "-sourcepath", ".", "-d", "out", *files],
        cwd=tmp_path, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len(files) == 3 and len(list((tmp_path / "out/frc/robot").iterdir())) == 3


@pytest.mark.skipif(not shutil.which("g++"), reason="no C++ compiler")
def test_cpp_compiles(tmp_path: Path) -> None:
    for path, text in CPP.items():
        file = tmp_path / path
        file.parent.mkdir(parents=True, exist_ok=True)
        uses = "" if path.startswith("units") else "#include <units/length.h>\n"
        uses += "#include <frc/geometry/Translation2d.h>\n" if "kinematics" in path else ""
        file.write_text(f"#pragma once\n{uses}{text}\n")
    includes = ""
    for name in DRIVES:
        for file_name, text in wpilib(replace(gallery(name), description=HOSTILE)).items():
            if file_name.endswith(".h"):
                (tmp_path / file_name).write_text(text)
                includes += f'#include "{file_name}"\n'
    (tmp_path / "all.cpp").write_text(
        f"{includes}int main() {{ return nexus_4wd::UPPER_RIGHT_INVERTED ? 0 : 1; }}\n"
    )
    command = ["g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-I.", "-fsyntax-only", "all.cpp"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
