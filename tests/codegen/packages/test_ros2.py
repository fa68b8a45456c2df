"""The core of the ROS 2 package, which is Python around the compiled C. `test_ros2_run` runs the node on ROS 2.

Expected: the closed form of a figure of eight, the interpreter, and what the core says about each fault."""

from __future__ import annotations

import importlib.util
import xml.etree.ElementTree
from collections.abc import Callable
from functools import cache
from math import inf, isnan, nan, pi, remainder
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tests.codegen.packages.eight import ROBOTS, figure_of_eight, named, tunables
from tests.codegen.packages.made import files_of, of_gallery, run
from tests.conftest import DIFFERENTIAL, ROOT, put
from tests.depth import GALLERY
from tests.external_tools import need
from wmrgen import derive, load
from wmrgen.geometry.ports import POSE, POSE_COVARIANCE, TWIST_COVARIANCE
from wmrgen.ir.interpret import FLOAT64, evaluate_module

STUBS = Path(__file__).parent / "stubs"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wno-float-conversion", "-Werror")
SECOND = 1_000_000_000  # ns


def core_of(folder: Path, robot: Path, scalar: str = "double") -> tuple[ModuleType, Any]:
    """Return the core's module of a robot file, and a core, with its C compiled."""
    need("gcc")
    name = robot.stem
    put(folder, files_of(robot, "ros2", scalar=scalar))
    sources = [str(path) for path in (folder / "src").glob("*.c")]
    library = folder / f"lib{name}_bridge.so"
    options = ("-std=c99", "-O1", "-fPIC", "-shared", "-ffp-contract=off", *WARNINGS)
    run(folder, "gcc", *options, f"node/{name}_bridge.c", *sources, "-lm", "-o", library)
    spec = importlib.util.spec_from_file_location(f"{name}_core", folder / "node" / f"{name}_core.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module, module.Core(library)


PAIR = DIFFERENTIAL + "limits: {vx: 1, omega: 2}\n"

FAST = PAIR.replace("vx: 1", "vx: 3")  # 3 / v * v is above 3 for some v


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    """A function that returns a new core of a differential drive from the text of its robot file."""

    @cache
    def compiled(text: str) -> tuple[ModuleType, Path]:
        folder = tmp_path_factory.mktemp("pair")
        robot = folder / "pair.yaml"
        robot.write_text(text)
        return core_of(folder, robot)[0], folder / "libpair_bridge.so"

    def made(text: str = PAIR) -> Any:
        module, library = compiled(text)
        return module.Core(library)

    return made


def spin(core: Any, time: float, left: float = 1.0, right: float = 1.0) -> Any:
    """Give the speeds of both wheels at a time [s] to a core."""
    return core.joint_states(["left_spin", "right_spin"], [], [left, right], round(time * SECOND), time)


def codes(core: Any) -> list[str]:
    """Return the codes of the events of a core, and remove them."""
    found = [code for code, _ in core.events]
    core.events.clear()
    return found


def test_the_package_file_names_what_the_node_imports() -> None:
    files = of_gallery("pioneer3dx", "ros2")
    package = xml.etree.ElementTree.fromstring(files["package.xml"])
    assert package.tag == "package" and package.get("format") == "3"
    tags = [child.tag for child in package]
    assert tags[:5] == ["name", "version", "description", "maintainer", "license"]
    assert package.find("maintainer").get("email")  # type: ignore[union-attr]
    assert package.findtext("name") == "pioneer3dx_kinematics"
    node = files["node/pioneer3dx_node.py"].decode()
    imported = {
        words[1].split(".")[0]
        for words in map(str.split, node.splitlines())
        if words[:1] in (["from"], ["import"]) and len(words) > 1
    }
    depends = {element.text for element in package if element.tag == "exec_depend"}
    assert depends == imported - {"math", "sys", "pathlib", "pioneer3dx_core"}
    assert package.findtext("export/build_type") == "ament_cmake"


@pytest.mark.slow
def test_the_package_builds_and_installs_the_library_beside_the_node(tmp_path: Path) -> None:
    need("cmake", "ctest", "gcc")
    put(tmp_path, of_gallery("pioneer3dx", "ros2"))
    flags = f"-DCMAKE_C_FLAGS={' '.join(WARNINGS)}"
    run(
        tmp_path,
        "cmake",
        "-B",
        "build",
        f"-DCMAKE_PREFIX_PATH={STUBS / 'cmake'}",
        flags,
        "-DCMAKE_INSTALL_PREFIX=out",
    )
    run(tmp_path, "cmake", "--build", "build")
    assert "100% tests passed" in run(tmp_path, "ctest", "--test-dir", "build")
    run(tmp_path, "cmake", "--install", "build")
    installed = {path.name for path in (tmp_path / "out" / "lib" / "pioneer3dx_kinematics").iterdir()}
    assert installed == {"libpioneer3dx_bridge.so", "pioneer3dx_node", "pioneer3dx_core.py"}


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_figure_of_eight_is_the_closed_form(robot: str, tmp_path: Path) -> None:
    path = ROOT / "robots" / f"{robot}.yaml"
    module, core = core_of(tmp_path, path)
    count = 0
    core.long_step = 10.0
    core.longest_step = 10.0
    for moment in figure_of_eight(derive(load(path)), *ROBOTS[robot]):
        state = named(moment.joints, module.JOINTS)
        got = core.joint_states(
            state["name"], state["position"], state["velocity"], moment.time, moment.time * 1e-9
        )
        assert not core.events
        if got is None:
            continue
        count += 1
        assert (got.x, got.y) == pytest.approx(moment.pose[:2], abs=1e-6)
        assert abs(remainder(got.theta - moment.pose[2], 2 * pi)) < 1e-6
        assert (got.vx, got.vy, got.omega) == pytest.approx(moment.twist, abs=1e-9)
    assert count == 120


@pytest.mark.slow
def test_commands_are_those_of_inverse_and_clamped_ones_keep_the_curvature(pair: Callable[[], Any]) -> None:
    core = pair()
    spin(core, 1.0, 0.0, 0.0)
    core.command(0.5, 0.0, 0.25, 1.0)
    velocities, positions = core.joint_commands(1.0)
    radius, half = 0.0975, 0.1655
    wanted = [(0.5 - half * 0.25) / radius, (0.5 + half * 0.25) / radius]
    assert velocities == pytest.approx(wanted, rel=1e-12) and all(map(isnan, positions))
    assert codes(core) == []
    core.command(1.01, 0.0, 0.505, 1.0)
    assert core.joint_commands(1.0)[0] == pytest.approx([2 * value for value in wanted], rel=1e-12)
    assert codes(core) == ["clamped"]
    core.command(1e30, 0.0, 5e29, 1.0)
    assert core.joint_commands(1.0)[0] == pytest.approx([2 * value for value in wanted], rel=1e-12)
    assert codes(core) == []  # the fault continues
    core.limits["vx"] = (-0.5, 0.5)
    core.command(1.0, 0.0, 0.5, 1.0)
    assert core.joint_commands(1.0)[0] == pytest.approx(wanted, rel=1e-12)


@pytest.mark.slow
def test_no_command_beyond_a_limit_stops_the_robot_by_its_rounding(pair: Callable[[str], Any]) -> None:
    core = pair(FAST)
    spin(core, 1.0, 0.0, 0.0)
    for k in range(1, 400):
        core.command(3.0 + k / 100, 0.0, 0.1, 1.0)
        assert sum(core.joint_commands(1.0)[0]) == pytest.approx(6.0 / 0.0975, rel=1e-12), k
    assert codes(core) == ["clamped"]


@pytest.mark.slow
def test_a_least_speed_does_not_move_a_robot_that_is_to_stop(pair: Callable[[str], Any]) -> None:
    core = pair(PAIR.replace("vx: 1", "vx: [0.1, 1]"))
    spin(core, 1.0, 0.0, 0.0)
    core.command(0.0, 0.0, 0.0, 1.0)
    assert core.joint_commands(1.0)[0] == [0.0, 0.0]


@pytest.mark.slow
def test_a_command_that_is_old_or_not_a_number_stops_the_robot(pair: Callable[[], Any]) -> None:
    core = pair()
    core.joint_timeout = 60.0
    spin(core, 1.0)
    core.command(0.5, 0.0, 0.0, 1.0)
    assert core.joint_commands(1.5)[0][0] > 0
    assert core.joint_commands(1.51)[0] == [0.0, 0.0] and codes(core) == ["no_command"]
    assert core.joint_commands(1.6)[0] == [0.0, 0.0] and codes(core) == []
    core.command(nan, 0.0, inf, 2.0)
    assert core.joint_commands(2.0)[0] == [0.0, 0.0] and codes(core) == ["not_a_number"]
    core.command(0.5, 0.0, 0.0, 2.0)
    assert core.joint_commands(2.1)[0][0] > 0
    assert core.joint_commands(20.0)[0] == [0.0, 0.0] and codes(core) == ["no_command"]
    core.command(0.5, 0.0, 0.0, 30.0)
    assert core.joint_commands(30.1)[0][0] > 0
    assert core.joint_commands(25.0)[0] == [0.0, 0.0]  # the clock went back


@pytest.mark.slow
def test_late_lost_and_old_joint_states(pair: Callable[[], Any]) -> None:
    core, speed = pair(), 0.0975  # 1 rad/s
    assert spin(core, 1.0) is None and codes(core) == []
    assert spin(core, 1.1).x == pytest.approx(0.1 * speed) and codes(core) == []
    assert spin(core, 1.6).x == pytest.approx(0.6 * speed) and codes(core) == ["late"]
    assert spin(core, 11.6) is None and codes(core) == ["gap"]
    assert spin(core, 11.7).x == pytest.approx(0.7 * speed) and codes(core) == []
    assert spin(core, 11.7) is None and codes(core) == ["backwards"]  # a second driver
    assert spin(core, 5.0) is None and codes(core) == [
        "backwards"
    ]  # the clock went back: it is reported again
    assert spin(core, 5.1) is None
    assert spin(core, 5.2).x == pytest.approx(0.8 * speed)


@pytest.mark.slow
def test_zero_stamps_take_the_clock_of_the_node(pair: Callable[[], Any]) -> None:
    core = pair()
    for now in (1.0, 1.1, 1.2):
        got = core.joint_states(["left_spin", "right_spin"], [], [1.0, 1.0], 0, now)
    assert got.x == pytest.approx(0.2 * 0.0975) and got.stamp == 1_200_000_000
    assert codes(core) == ["zero_stamp"]


@pytest.mark.slow
def test_joints_of_two_drivers_are_put_together_and_missing_ones_stop_the_robot(
    pair: Callable[[], Any],
) -> None:
    core = pair()
    core.command(0.5, 0.0, 0.0, 1.0)
    assert not core.alive(1.0) and not core.started
    for k in range(3):
        time = 1.0 + k / 10
        assert core.joint_states(["left_spin", "arm"], [], [1.0, 9.0], round(time * SECOND), time) is None
        got = core.joint_states(["right_spin"], [], [1.0], round(time * SECOND), time)
    assert got.x == pytest.approx(0.2 * 0.0975) and core.alive(1.2) and codes(core) == []
    for k in range(20):  # the driver of the right wheel is dead, and another name comes
        time = 1.3 + k / 10
        core.command(0.5, 0.0, 0.0, time)
        assert core.joint_states(["left_spin", "right"], [], [1.0, 1.0], round(time * SECOND), time) is None
        velocities = core.joint_commands(time)[0]
    assert velocities == [0.0, 0.0] and not core.alive(3.3)
    (event,) = core.events
    assert event[0] == "no_joint_states" and "right_spin" in event[1] and "left_spin" not in event[1]


@pytest.mark.slow
def test_a_joint_that_is_not_a_number_moves_nothing(pair: Callable[[], Any]) -> None:
    core = pair()
    spin(core, 1.0)
    assert spin(core, 1.1, nan) is None and codes(core) == ["not_a_number"]
    assert spin(core, 1.2).x == pytest.approx(0.2 * 0.0975)


TUNABLE = PAIR.replace("  half_track", "  radius: {value: 0.0975, tunable: true}\n  half_track")


@pytest.mark.slow
def test_tunables_scale_the_odometry_and_wrong_ones_are_refused(pair: Callable[[str], Any]) -> None:
    core = pair(TUNABLE.replace("r: 0.0975", "r: radius"))
    assert core.tune({"radius": 0.1}) and not core.tune({"radius": 1.0}) and core.tune({"radius": 0.1})
    spin(core, 1.0)
    assert spin(core, 1.1).x == pytest.approx(0.01)


@pytest.mark.slow
def test_joints_have_the_names_and_signs_of_the_robot_file(pair: Callable[[str], Any]) -> None:
    text = PAIR.replace("name: left, ", "name: left, joints: {spin: -wheel_left_joint}, ")
    assert text != PAIR
    core = pair(text)
    assert core.names == ["wheel_left_joint", "right_spin"]
    for time in (1.0, 1.1):
        got = core.joint_states(core.names, [], [-1.0, 1.0], round(time * SECOND), time)
    assert got.x == pytest.approx(0.1 * 0.0975) and got.omega == pytest.approx(0.0)
    core.command(0.0975, 0.0, 0.0, 1.1)
    assert core.joint_commands(1.1)[0] == pytest.approx([-1.0, 1.0])


@pytest.mark.slow
@pytest.mark.parametrize("robot", sorted(GALLERY - {"office_chair"}))
def test_the_bridge_of_every_robot_compiles(robot: str, tmp_path: Path) -> None:
    """The chair has neither motors nor sensors, so it has no node."""
    put(tmp_path, of_gallery(robot, "ros2"))
    run(tmp_path, "gcc", "-fsyntax-only", "-std=c99", *WARNINGS, f"node/{robot}_bridge.c")
    for part in ("core", "node"):
        source = (tmp_path / "node" / f"{robot}_{part}.py").read_text()
        compile(source, part, "exec")


NOISY = DIFFERENTIAL + (
    "noise: {spin: {proportional: 0.02, constant: 0.01 rad/s}}\nfunctions: [forward_covariance, odometry_covariance]\n"
)


@pytest.mark.slow
def test_covariance_is_propagated_where_the_robot_file_has_noise(
    tmp_path: Path, pair: Callable[[str], Any]
) -> None:
    """Every entry of both matrices after three steps, against the interpreter."""
    core = pair(NOISY)
    core.long_step = 1.0
    speeds = [(3.0, 5.0), (4.0, 2.0), (1.0, -1.0)]
    spin(core, 1.0, 0.0, 0.0)
    for k, (left, right) in enumerate(speeds, 1):
        got = spin(core, 1.0 + k / 4, left, right)

    (tmp_path / "pair.yaml").write_text(NOISY)
    module = derive(load(tmp_path / "pair.yaml")).module
    state = dict.fromkeys([p.name for p in (*POSE, *POSE_COVARIANCE)], 0.0) | {"dt": 0.25} | tunables(module)
    for left, right in speeds:
        state |= {"left.spin": left, "right.spin": right}
        for name in ("forward", "forward_covariance", "odometry_covariance"):
            state |= evaluate_module(module, name, state, FLOAT64)
    for matrix, ports in ((got.pose_covariance, POSE_COVARIANCE), (got.twist_covariance, TWIST_COVARIANCE)):
        for (i, j), port in zip([(0, 0), (0, 1), (0, 5), (1, 1), (1, 5), (5, 5)], ports, strict=True):
            wanted = pytest.approx(state[port.name], rel=1e-9, abs=1e-12)
            assert matrix[6 * i + j] == wanted and matrix[6 * j + i] == wanted
        assert [matrix[7 * axis] for axis in (2, 3, 4)] == [1e6] * 3
    assert got.pose_covariance[0] > 0 and got.twist_covariance[0] > 0
