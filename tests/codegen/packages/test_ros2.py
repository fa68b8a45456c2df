"""The ROS 2 package, built by CMake against stubs of rclcpp, the messages and ament (`stubs/`), and its node, run: that
is no build with ROS 2. Expected: the closed form of a circle, and the interpreter on the functions in symbols."""

from __future__ import annotations

import subprocess
import xml.etree.ElementTree
from collections.abc import Sequence
from math import atan2, cos, hypot, isclose, isnan, nan, pi, sin
from pathlib import Path

import pytest

from tests.codegen.packages.made import files_of, in_folder, of_gallery, run
from tests.conftest import DIFFERENTIAL, put
from tests.depth import GALLERY
from tests.external_tools import need
from wmrgen import derive, load
from wmrgen.geometry.ports import POSE, POSE_COVARIANCE, TWIST_COVARIANCE
from wmrgen.ir.interpret import FLOAT64, evaluate_module

STUBS = Path(__file__).parent / "stubs"
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wno-float-conversion -Werror"


def node(folder: Path, robot: str) -> Path:
    """Build the node of a package with the package's CMakeLists.txt."""
    need("cmake", "ctest", "g++", "gcc")
    run(
        folder,
        "cmake",
        "-B",
        "build",
        f"-DCMAKE_PREFIX_PATH={STUBS / 'cmake'}",
        f"-DCMAKE_CXX_FLAGS={WARNINGS}",
    )
    run(folder, "cmake", "--build", "build")
    assert "100% tests passed" in run(folder, "ctest", "--test-dir", "build")
    return folder / "build" / f"{robot}_node"


def spoken(program: Path, events: Sequence[str]) -> list[list[str]]:
    """Return what the node publishes for these events."""
    done = subprocess.run([program], input="\n".join(events), capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return [line.split() for line in done.stdout.splitlines()]


def test_the_package_file_names_what_the_build_finds() -> None:
    files = of_gallery("pioneer3dx", "ros2")
    package = xml.etree.ElementTree.fromstring(files["package.xml"])
    assert package.tag == "package" and package.get("format") == "3"
    tags = [child.tag for child in package]
    assert tags[:5] == ["name", "version", "description", "maintainer", "license"]
    assert package.find("maintainer").get("email")  # type: ignore[union-attr]
    assert package.findtext("name") == "pioneer3dx_kinematics"
    cmake = files["CMakeLists.txt"].decode()
    depends = {e.text for e in package if e.tag in ("depend", "buildtool_depend")}
    assert depends == {line[13:-10] for line in cmake.splitlines() if line.startswith("find_package(")}
    assert package.findtext("export/build_type") == "ament_cmake"


PAIR = DIFFERENTIAL + "limits: {vx: 1, omega: 2}\n"


def pair(folder: Path, text: str) -> Path:
    """Build the node of a differential drive with the robot file ``text``."""
    robot = folder / "pair.yaml"
    robot.write_text(text)
    put(folder / "pair", files_of(robot, "ros2"))
    return node(folder / "pair", "pair")


@pytest.mark.slow
def test_a_differential_drive_drives_a_circle(tmp_path: Path) -> None:
    """Wheels follow their commands for 2 s: the pose is then on the commanded circle."""
    program = pair(tmp_path, PAIR)
    vx, omega, radius, half = 0.4, 0.5, 0.0975, 0.1655
    left, right = (vx - half * omega) / radius, (vx + half * omega) / radius
    events = ["clock 10", f"cmd_vel {vx} 0 {omega}"]
    events += [
        f"joint_states {10 + k / 50} right_spin {right} 7 other 3 3 left_spin {left} 7" for k in range(101)
    ]
    published = spoken(program, events)
    odometry = [[float(w) for w in words[1:]] for words in published if words[0] == "odom"]
    assert len(odometry) == 100
    x, y, qz, qw, *twist = odometry[-1][:7]
    turn = omega * 2
    assert isclose(x, vx / omega * sin(turn), abs_tol=1e-5)
    assert isclose(y, vx / omega * (1 - cos(turn)), abs_tol=1e-5)
    assert isclose(2 * atan2(qz, qw), turn, abs_tol=1e-5) and isclose(hypot(qz, qw), 1)
    assert twist == pytest.approx([vx, 0, omega], abs=1e-6)
    pose = odometry[-1][7:43]
    assert [pose[i] for i in (0, 7, 35)] == [1e-3] * 3 and [pose[i] for i in (14, 21, 28)] == [1e6] * 3

    commands = [words[1:] for words in published if words[0] == "joint_commands"]
    assert len(commands) == 101 and commands[0][0::3] == ["left_spin", "right_spin"]
    assert [float(w) for w in commands[0][1::3]] == pytest.approx([left, right], rel=1e-6)
    assert all(isnan(float(w)) for w in commands[0][2::3])


@pytest.mark.slow
def test_old_invalid_or_foreign_messages_move_nothing(tmp_path: Path) -> None:
    program = pair(tmp_path, PAIR)
    turning = "left_spin 1 0 right_spin 1 0"
    published = spoken(
        program,
        [
            "clock 1", "cmd_vel 0.1 0 0",
            "joint_states 1 gripper 1 0",                    # joints of another node: ignored
            f"joint_states 1 {turning}",                     # the first message: commands only
            f"joint_states 1.1 left_spin {nan} 0 right_spin 1 0",  # a warning, no odometry
            "clock 2", f"joint_states 1.2 {turning}",        # the command is a second old
            "cmd_vel 99 0 0", f"joint_states 1.3 {turning}",  # faster than its limits: the robot stops
            f"joint_states 0.5 {turning}",                   # a log restarts
        ],
    )  # fmt: skip
    assert [words[0] for words in published] == [
        "joint_commands",
        "warning", "joint_commands",
        "odom", "joint_commands",
        "odom", "warning", "joint_commands",
        "warning", "joint_commands",
    ]  # fmt: skip
    speeds = [float(words[2]) for words in published if words[0] == "joint_commands"]
    assert speeds[0] > 0 and speeds[2:] == [0, 0, 0]
    travelled = [float(words[1]) for words in published if words[0] == "odom"]
    assert travelled == pytest.approx([0.00975, 0.0195], abs=1e-6)


@pytest.mark.slow
def test_a_swerve_drive_is_commanded_by_position_and_velocity(tmp_path: Path) -> None:
    robot = "wpilib_swervebot"
    program = node(in_folder(tmp_path, robot, "ros2"), robot)
    modules = ("front_left", "front_right", "back_left", "back_right")
    still = " ".join(f"{m}_spin 0 9 {m}_steer 9 0.1" for m in modules)
    events = ["clock 1", "cmd_vel 0 1 0", f"joint_states 1 {still}", f"joint_states 2 {still}"]
    commanded = [words for words in spoken(program, events) if words[0] == "joint_commands"]
    first = commanded[1]  # in the first step, no time has passed for the limits of acceleration
    commands = {
        name: (float(v), float(p)) for name, v, p in zip(first[1::3], first[2::3], first[3::3], strict=True)
    }
    for m in modules:
        assert commands[f"{m}_spin"][0] > 0 and isnan(commands[f"{m}_spin"][1])
        assert isnan(commands[f"{m}_steer"][0]) and commands[f"{m}_steer"][1] == pytest.approx(
            pi / 2, abs=1e-6
        )

    resting = [
        f"joint_states {k} " + " ".join(f"{m}_spin 0 9 {m}_steer 9 {k / 10}" for m in modules)
        for k in range(1, 5)
    ]
    published = [words for words in spoken(program, resting) if words[0] == "joint_commands"]
    angles = [float(words[6]) for words in published]
    assert angles == pytest.approx([0.1] * 4)  # the initial commands; later measurements have no effect


FLAGS = ("-std=c++17", *WARNINGS.split(), f"-I{STUBS / 'include'}")


def included(node: str) -> str:
    """The headers that a node includes from the standard library and from ROS."""
    return "".join(line for line in node.splitlines(keepends=True) if line.startswith("#include <"))


@pytest.fixture(scope="module")
def header(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Compile the headers that every node includes, once."""
    need("g++")
    folder = tmp_path_factory.mktemp("header")
    (folder / "node.hpp").write_text(
        included(of_gallery("pioneer3dx", "ros2")["node/pioneer3dx_node.cpp"].decode())
    )
    run(folder, "g++", *FLAGS, "-x", "c++-header", "node.hpp")
    return folder / "node.hpp"


@pytest.mark.slow
@pytest.mark.parametrize("robot", sorted(GALLERY - {"office_chair"}))
def test_the_node_of_every_robot_compiles(robot: str, header: Path, tmp_path: Path) -> None:
    """The chair has neither motors nor sensors, so it has no node."""
    put(tmp_path, of_gallery(robot, "ros2"))
    node = tmp_path / "node" / f"{robot}_node.cpp"
    assert included(node.read_text()) == header.read_text()
    run(tmp_path, "g++", "-fsyntax-only", *FLAGS, "-Isrc", "-include", header, node)


NOISY = DIFFERENTIAL + (
    "noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}}\nfunctions: [forward_covariance, odometry_covariance]\n"
)


@pytest.mark.slow
def test_covariance_is_propagated_where_the_robot_file_has_noise(tmp_path: Path) -> None:
    """Every entry of both matrices after three steps, against the interpreter."""
    speeds = [(3.0, 5.0), (4.0, 2.0), (1.0, -1.0)]
    events = ["joint_states 0 left_spin 0 0 right_spin 0 0"]
    events += [f"joint_states {k / 4} left_spin {a} 0 right_spin {b} 0" for k, (a, b) in enumerate(speeds, 1)]
    published = spoken(pair(tmp_path, NOISY), events)
    odometry = [[float(w) for w in words[1:]] for words in published if words[0] == "odom"]

    module = derive(load(tmp_path / "pair.yaml")).module
    state = dict.fromkeys([p.name for p in (*POSE, *POSE_COVARIANCE)], 0.0) | {"dt": 0.25}
    for left, right in speeds:
        state |= {"left.spin": left, "right.spin": right}
        for name in ("forward", "forward_covariance", "odometry_covariance"):
            state |= evaluate_module(module, name, state, FLOAT64)
    pose, twist = odometry[-1][7:43], odometry[-1][43:]
    for matrix, ports in ((pose, POSE_COVARIANCE), (twist, TWIST_COVARIANCE)):
        for (i, j), port in zip([(0, 0), (0, 1), (0, 5), (1, 1), (1, 5), (5, 5)], ports, strict=True):
            wanted = pytest.approx(state[port.name], rel=1e-4, abs=1e-9)
            assert matrix[6 * i + j] == wanted and matrix[6 * j + i] == wanted
    assert pose[0] > 0 and pose[35] > 0 and twist[0] > 0
