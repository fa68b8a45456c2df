"""The controller for ros2_control, with the message headers of ROS 2 and stand-ins for the headers of ros2_control.

The stand-ins in ``stubs/ros2`` state only what the controller uses, with the signatures of Kilted. A program
takes the place of the controller manager: it calls the functions of the lifecycle, and updates the controller.
Expected: the closed form of a figure of eight, and what the documentation says about each fault.
"""

from __future__ import annotations

import json
import re
import subprocess
import xml.etree.ElementTree
from collections.abc import Callable, Sequence
from functools import cache
from math import nan, pi, remainder
from pathlib import Path

import pytest
import yaml

from tests.codegen.packages.eight import ROBOTS, figure_of_eight, tunables
from tests.codegen.packages.made import files_of, of_gallery, run
from tests.codegen.packages.test_ros2 import PAIR, TUNABLE
from tests.codegen.packages.test_ros2_run import ros_python
from tests.conftest import ROOT, put
from tests.depth import GALLERY
from tests.external_tools import missing, need
from wmrgen import derive, load
from wmrgen.ir.interpret import FLOAT64, evaluate_module

HERE = Path(__file__).parent
WARNINGS = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
SECOND = 1_000_000_000  # ns
SUCCESS, ERROR = "result 97", "result 99"  # CallbackReturn of rclcpp_lifecycle
START = ["init", "configure", "activate"]


def includes() -> list[str]:
    """Return the options that name the folders of headers: stand-ins, and messages of ROS."""
    headers = Path(ros_python()).parent.parent / "include"
    if not (headers / "nav_msgs" / "nav_msgs").is_dir():
        missing("the message headers of ROS 2 are not installed")
    folders = sorted(folder for folder in headers.iterdir() if folder.is_dir())
    return [f"-I{HERE / 'stubs' / 'ros2'}", *(f"-isystem{folder}" for folder in folders)]


def manager_of(folder: Path, robot: Path) -> Path:
    """Return the program that is the controller manager of a robot file's controller."""
    need("gcc", "g++")
    name = robot.stem
    put(folder, files_of(robot, "ros2", scalar="double"))
    sources = [str(path) for path in (folder / "src").glob("*.c")]
    run(folder, "gcc", "-std=c99", "-O1", "-ffp-contract=off", "-c", f"node/{name}_bridge.c", *sources)
    words = [
        f'-DCONTROLLER="{folder}/controller/{name}_controller.hpp"',
        f"-DROBOT={name.lower()}_kinematics",
    ]
    files = [f"controller/{name}_controller.cpp", HERE / "controller_driver.cpp"]
    objects = [path.name for path in folder.glob("*.o")]
    run(folder, "g++", *WARNINGS, "-O0", *includes(), *words, *files, *objects, "-o", "manager")
    return folder / "manager"


def managed(manager: Path, steps: Sequence[str]) -> list[list[str]]:
    """Return the lines that a controller manager prints in each step."""
    done = subprocess.run([manager], input="\n".join(steps), capture_output=True, text=True, check=True)
    printed = [text.splitlines() for text in done.stdout.split("end\n")]
    assert len(printed) == len(steps) + 1
    return printed[:-1]


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A function that returns the controller manager of a differential drive from the text of its robot file."""

    @cache
    def made(text: str = PAIR) -> Path:
        folder = tmp_path_factory.mktemp("pair")
        (folder / "pair.yaml").write_text(text)
        return manager_of(folder, folder / "pair.yaml")

    return made


def update(time: float) -> str:
    """Return the step of an update at a time [s]."""
    return f"update {round(time * SECOND)}"


def states(left: object, right: object) -> list[str]:
    """Return the steps that set the speeds of both wheels [rad/s]."""
    return [f"state left_spin/velocity {left}", f"state right_spin/velocity {right}"]


def commanded(lines: Sequence[str]) -> list[float]:
    """Return the commands in the lines of an update."""
    return [float(line.split()[2]) for line in lines if line.startswith("command ")]


def logged(printed: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of the log."""
    lines = [line for lines in printed for line in lines]
    return [line for line in lines if line.startswith("log ")]


@pytest.mark.slow
@pytest.mark.parametrize("robot", sorted(GALLERY - {"office_chair"}))
def test_the_controller_of_every_robot_is_well_typed(robot: str, tmp_path: Path) -> None:
    """The chair has neither motors nor sensors, so it has no controller."""
    need("g++")
    put(tmp_path, of_gallery(robot, "ros2"))
    run(tmp_path, "g++", "-fsyntax-only", *WARNINGS, *includes(), f"controller/{robot}_controller.cpp")


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_figure_of_eight_under_a_controller_manager(robot: str, tmp_path: Path) -> None:
    path = ROOT / "robots" / f"{robot}.yaml"
    manager = manager_of(tmp_path, path)
    steps = ["parameter long_step number 100", "parameter longest_step number 100", *START]
    moments = {}
    derivation = derive(load(path))
    for moment in figure_of_eight(derivation, *ROBOTS[robot]):
        for name, value in moment.joints.items():
            field = {"spin": "velocity", "steer": "position", "steer_rate": "velocity"}[
                name.rpartition(".")[2]
            ]
            joint = name.replace(".", "_").removesuffix("_rate")
            steps.append(f"state {joint}/{field} {value!r}")
        moments[len(steps)] = moment
        steps.append(f"update {moment.time}")
    printed = managed(manager, steps)
    assert [SUCCESS in lines for lines in printed[2:5]] == [True] * 3 and not logged(printed)
    for k, moment in list(moments.items())[1:]:
        (odometry,) = [line.split()[1:] for line in printed[k] if line.startswith("odometry ")]
        (transform,) = [line.split()[1:] for line in printed[k] if line.startswith("transform ")]
        assert odometry[:2] == ["odom", derivation.robot.frame]
        assert int(odometry[2]) * SECOND + int(odometry[3]) == moment.time
        assert [float(value) for value in odometry[4:6]] == pytest.approx(moment.pose[:2], abs=1e-6)
        assert abs(remainder(float(odometry[6]) - moment.pose[2], 2 * pi)) < 1e-6
        assert [float(value) for value in odometry[7:10]] == pytest.approx(moment.twist, abs=1e-9)
        assert transform == odometry[:7]


@pytest.mark.slow
def test_interfaces_have_the_names_of_joints_and_references(pair: Callable[..., Path]) -> None:
    printed = managed(pair(), [*START])[-1]
    assert "commands left_spin/velocity right_spin/velocity" in printed
    assert "states left_spin/velocity right_spin/velocity" in printed
    references = [line.split()[1] for line in printed if line.startswith("reference ")]
    assert references == ["wheels/linear/x/velocity", "wheels/linear/y/velocity", "wheels/angular/z/velocity"]
    renamed = managed(pair(), ["parameter joints texts l r", *START])[-1]
    assert "commands l/velocity r/velocity" in renamed


@pytest.mark.slow
def test_joints_that_the_hardware_lacks_are_named(pair: Callable[..., Path]) -> None:
    printed = managed(pair(), ["hardware left_spin/velocity", *START])
    assert ERROR in printed[-1]
    (line,) = logged(printed)
    assert "right_spin/velocity" in line and "left_spin" not in line


@pytest.mark.slow
def test_commands_follow_cmd_vel_its_limits_and_its_timeout(pair: Callable[..., Path]) -> None:
    radius, half = 0.0975, 0.1655
    steps = [
        *START,
        "cmd_vel 0.9 0 0",
        update(1.0),
        *states(nan, nan),
        update(1.01),
        *states(0, 0),
        update(1.02),
    ]
    steps += [
        "cmd_vel 0.5 0 0.25",
        update(1.03),
        "cmd_vel 1.01 0 0.505",
        update(1.04),
        update(1.5),
        update(1.55),
    ]
    steps += ["cmd_vel nan 0 0", update(7.0), "cmd_vel 0.5 0 0.25", update(7.1), "deactivate"]
    printed = managed(pair(), steps)
    updates = [
        commanded(lines) for step, lines in zip(steps, printed, strict=True) if step.startswith("update")
    ]
    wanted = [(0.5 - half * 0.25) / radius, (0.5 + half * 0.25) / radius]
    # Nothing is written before the joints have come.
    assert all(value != value for value in updates[0] + updates[1])
    assert updates[2] == pytest.approx([0.9 / radius] * 2)
    assert updates[3] == pytest.approx(wanted)
    assert updates[4] == updates[5] == pytest.approx([2 * value for value in wanted])
    assert updates[6] == updates[7] == [0.0, 0.0]
    assert updates[8] == pytest.approx(wanted)
    assert commanded(printed[-1]) == [0.0, 0.0]
    words = ["left_spin is not a number", "beyond the limits", "no command", "command is not a number"]
    lines = logged(printed)
    assert [sum(word in line for line in lines) for word in words] == [1] * 4


@pytest.mark.slow
def test_a_state_that_is_locked_is_integrated_later(pair: Callable[..., Path]) -> None:
    steps = [*START, *states(1, 1), update(1.0), "state left_spin/velocity -", update(1.05)]
    steps += ["state left_spin/velocity 1", update(1.09)]
    printed = managed(pair(), steps)
    assert not any(line.startswith("odometry") for line in printed[-3])
    (odometry,) = [line.split() for line in printed[-1] if line.startswith("odometry")]
    assert float(odometry[5]) == pytest.approx(0.09 * 0.0975) and not logged(printed)


@pytest.mark.slow
def test_a_preceding_controller_gives_the_reference_instead_of_the_topic(pair: Callable[..., Path]) -> None:
    steps = ["init", "configure", "chain 1", "activate", *states(0, 0), update(1.0)]
    steps += ["cmd_vel 0.9 0 0", update(1.1), "reference 0.195 0 0", update(1.2), update(1.3), update(1.8)]
    steps += ["reference 0.195 nan 0", update(1.9), "chain 0", "activate", *states(0, 0), update(2.0)]
    printed = managed(pair(), steps)
    updates = [
        commanded(lines) for step, lines in zip(steps, printed, strict=True) if step.startswith("update")
    ]
    moving = pytest.approx([2.0, 2.0])
    assert updates == [[0.0, 0.0], [0.0, 0.0], moving, moving, [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]


@pytest.mark.slow
def test_a_gyro_is_a_state_of_the_imu(pair: Callable[..., Path]) -> None:
    """The wheels measure no turn and the gyro measures one; `forward` of the interpreter weighs them."""
    manager = pair(PAIR + "gyro: {constant: 0.0001 rad/s}\n")
    module = derive(load(manager.parent / "pair.yaml")).module
    measured = {"left.spin": 1.0, "right.spin": 1.0, "gyro": 0.5} | tunables(module)
    wanted = evaluate_module(module, "forward", measured, FLOAT64)["omega"]
    steps = ["parameter imu text base_imu", *START, *states(1, 1), "state base_imu/angular_velocity.z 0.5"]
    printed = managed(manager, [*steps, update(1.0), update(1.1)])
    assert "states left_spin/velocity right_spin/velocity base_imu/angular_velocity.z" in printed[3]
    (odometry,) = [line.split() for line in printed[-1] if line.startswith("odometry")]
    assert float(odometry[10]) == pytest.approx(wanted, rel=1e-9) and wanted > 0.1
    lacking = managed(manager, ["hardware left_spin/velocity right_spin/velocity", *START])
    assert ERROR in lacking[-1] and "imu/angular_velocity.z" in logged(lacking)[0]


@pytest.mark.slow
def test_parameters_change_while_the_controller_runs_and_wrong_ones_are_refused(
    pair: Callable[..., Path],
) -> None:
    steps = [
        *START,
        *states(1, 1),
        update(1.0),
        "set tunable.radius 0.1",
        "set tunable.radius 1",
        "set limit.vx nan",
    ]
    steps += ["set limit.vx 0.2", update(1.1), "cmd_vel 1 0 0", update(1.2)]
    printed = managed(pair(TUNABLE.replace("r: 0.0975", "r: radius")), steps)
    accepted = [lines[0] for step, lines in zip(steps, printed, strict=True) if step.startswith("set")]
    assert accepted == ["set 1", "set 0", "set 0", "set 1"]
    (odometry,) = [line.split() for line in printed[-3] if line.startswith("odometry")]
    assert float(odometry[5]) == pytest.approx(0.01)
    assert commanded(printed[-1]) == pytest.approx([2.0, 2.0])


@pytest.mark.slow
@pytest.mark.parametrize(
    "wrong",
    ["joints texts left_spin", "cmd_timeout number -1", "tunable.radius number 1", "cmd_timeout text now"],
)
def test_parameters_that_are_wrong_at_the_start_are_refused(wrong: str, pair: Callable[..., Path]) -> None:
    printed = managed(
        pair(TUNABLE.replace("r: 0.0975", "r: radius")), [f"parameter {wrong}", "init", "configure"]
    )
    assert ERROR in printed[-1] and logged(printed)


ROS_PACKAGES = (
    "controller_interface", "geometry_msgs", "hardware_interface", "nav_msgs", "pluginlib", "rcl_interfaces", "rclcpp",
    "rclcpp_lifecycle", "realtime_tools", "tf2_msgs", "nav2_mppi_controller",
)  # fmt: skip


def write_cmake_packages(folder: Path, nav2_version: str) -> None:
    """Write CMake packages of ROS: their targets have the headers of `includes`."""
    flags = ";".join(includes())
    for name in ROS_PACKAGES:
        target = f"{name}::{'mppi_controller' if name.startswith('nav2') else name}"
        lines = ["include_guard()", f"add_library({target} INTERFACE IMPORTED)"]
        lines += [f'set_target_properties({target} PROPERTIES INTERFACE_COMPILE_OPTIONS "{flags}")']
        lines += [f"set({name}_TARGETS {target})"]
        if name == "pluginlib":
            lines += ["function(pluginlib_export_plugin_description_file category file)"]
            lines += [
                "  install(FILES ${file} DESTINATION share/${PROJECT_NAME}/${category})",
                "endfunction()",
            ]
        version = [
            f'set(PACKAGE_VERSION "{nav2_version}")',
            "if(NOT PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)",
        ]
        version += ["  set(PACKAGE_VERSION_COMPATIBLE TRUE)", "endif()"]
        files = {f"{name}Config.cmake": lines, f"{name}Config-version.cmake": version}
        put(folder / name, {file: "\n".join(text).encode() for file, text in files.items()})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "nav2", "plugins"),
    [
        ("wpilib_swervebot", "1.5.1", ["controller"]),
        ("f1tenth", "1.5.1", ["controller", "motion_model"]),
        ("f1tenth", "1.4.2", ["controller"]),  # Kilted: motion models are no plugins
    ],
)
def test_cmake_builds_and_installs_the_plugins_whose_packages_are_found(
    robot: str, nav2: str, plugins: list[str], tmp_path: Path
) -> None:
    need("cmake", "gcc", "g++", "nm")
    put(tmp_path, of_gallery(robot, "ros2"))
    write_cmake_packages(tmp_path / "ros", nav2)
    prefix = f"-DCMAKE_PREFIX_PATH={HERE / 'stubs' / 'cmake'};{tmp_path / 'ros'}"
    run(tmp_path, "cmake", "-B", "build", prefix, "-DCMAKE_INSTALL_PREFIX=out", "-DBUILD_TESTING=OFF")
    run(tmp_path, "cmake", "--build", "build")
    run(tmp_path, "cmake", "--install", "build")
    libraries = sorted((tmp_path / "out" / "lib").glob("*.so"))
    assert [library.name for library in libraries] == [f"lib{robot}_{plugin}.so" for plugin in plugins]
    for library in libraries:
        unresolved = [line.split()[-1] for line in run(tmp_path, "nm", "-u", "-C", library).splitlines()]
        assert not [name for name in unresolved if robot in name]
    share = tmp_path / "out" / "share" / f"{robot}_kinematics"
    installed = {path.relative_to(share).as_posix() for path in share.rglob("*.*")}
    folders = {"controller": "controller_interface", "motion_model": "nav2_mppi_controller"}
    described = {f"{folders[plugin]}/{robot}_{plugin}.xml" for plugin in plugins}
    assert installed == described | {f"config/{robot}_controllers.yaml"}


def test_the_plugin_file_and_the_parameters_name_the_class() -> None:
    files = of_gallery("pioneer3dx", "ros2")
    library = xml.etree.ElementTree.fromstring(files["pioneer3dx_controller.xml"])
    (plugin,) = library
    base = "controller_interface::ChainableControllerInterface"
    assert library.get("path") == "pioneer3dx_controller" and plugin.get("base_class_type") == base
    assert (
        f"PLUGINLIB_EXPORT_CLASS({plugin.get('type')}, {base})"
        in files["controller/pioneer3dx_controller.cpp"].decode()
    )
    config = yaml.safe_load(files["config/pioneer3dx_controllers.yaml"])
    assert config["controller_manager"]["ros__parameters"]["pioneer3dx_controller"]["type"] == plugin.get(
        "name"
    )


@pytest.mark.parametrize("robot", ["pioneer3dx", "nomad_xr4000", "jpl_osr"])
def test_the_parameters_are_those_that_the_controller_declares(robot: str) -> None:
    files = of_gallery(robot, "ros2")
    parameters = yaml.safe_load(files[f"config/{robot}_controllers.yaml"])[f"{robot}_controller"][
        "ros__parameters"
    ]
    source = files[f"controller/{robot}_controller.cpp"].decode()
    declared = set(re.findall(r'auto_declare<[^(]*>\("([a-z_]+)"', source)) | set(
        re.findall(r'"(limit\.\w+)"', source)
    )
    del parameters["type"]  # the spawner reads it
    tunables = {name for name in parameters if name.startswith("tunable.")}
    assert set(parameters) - tunables <= declared
    core = files[f"controller/{robot}_core.hpp"].decode()
    assert all(f'{{ "{name.removeprefix("tunable.")}", ' in core for name in tunables)
    assert len(parameters["joints"]) == core.count(", Interface::")
    for name, value in parameters.items():
        assert isinstance(value, float) or name in {
            "joints", "odom_frame", "base_frame", "publish_tf", "pose_variance", "twist_variance"
        }  # fmt: skip


@pytest.mark.parametrize(
    "name", ["cmd_timeout", "joint_timeout", "long_step", "longest_step", "unmeasured_variance"]
)
def test_the_node_the_controller_and_the_parameters_have_the_same_defaults(name: str) -> None:
    files = of_gallery("pioneer3dx", "ros2")
    config = yaml.safe_load(files["config/pioneer3dx_controllers.yaml"])["pioneer3dx_controller"][
        "ros__parameters"
    ]
    sources = {
        "node/pioneer3dx_core.py": rf"self\.{name} = (\S+)",
        "controller/pioneer3dx_core.hpp": rf" {name} = (\S+);",
    }
    for file, pattern in sources.items():
        found = re.search(pattern, files[file].decode())
        assert found and float(found[1]) == config[name]


READ = """
import json, sys, rclpy
from rclpy.node import Node
rclpy.init(args=["--ros-args", "--params-file", sys.argv[1]])
node = Node(sys.argv[2], automatically_declare_parameters_from_overrides=True)
print(json.dumps({name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}))
"""


@pytest.mark.slow
@pytest.mark.parametrize("robot", ["pioneer3dx", "nomad_xr4000", "jpl_osr"])
def test_ros_reads_the_parameters(robot: str, tmp_path: Path) -> None:
    python = ros_python()
    file = f"config/{robot}_controllers.yaml"
    text = of_gallery(robot, "ros2")[file]
    put(tmp_path, {file: text})
    done = run(tmp_path, python, "-c", READ, file, f"{robot}_controller")
    read = json.loads(done.splitlines()[-1])
    wanted = yaml.safe_load(text)[f"{robot}_controller"]["ros__parameters"]
    assert {name: read[name] for name in wanted} == wanted
