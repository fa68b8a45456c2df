"""The core of the controller for ros2_control: C++17 without ROS around the compiled C.

Expected: the closed form of a figure of eight, and the core in Python, which has the same faults with the same names.
"""

from __future__ import annotations

import random
import subprocess
from collections.abc import Callable, Sequence
from functools import cache
from math import inf, isnan, nan, pi, remainder
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest

from tests.codegen.packages.eight import ROBOTS, figure_of_eight
from tests.codegen.packages.made import files_of, run
from tests.codegen.packages.test_ros2 import FAST, NOISY, PAIR, TUNABLE, core_of
from tests.conftest import ROOT, put
from tests.external_tools import need
from wmrgen import derive, load

DRIVER = Path(__file__).parent / "core_driver.cpp"
WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wno-float-conversion", "-Werror")
SECOND = 1_000_000_000  # ns


class Result(NamedTuple):
    """What the core returned in a step."""

    numbers: dict[str, list[float]]  # odometry, commands, alive, configured -> values
    events: list[str]


def driver_of(folder: Path, robot: Path) -> Path:
    """Return the compiled program that passes steps to the core of a robot file."""
    need("gcc", "g++")
    name = robot.stem
    put(folder, files_of(robot, "ros2", scalar="double"))
    sources = [str(path) for path in (folder / "src").glob("*.c")]
    run(folder, "gcc", "-std=c99", "-O1", "-ffp-contract=off", "-c", f"node/{name}_bridge.c", *sources)
    core, namespace = f'-DCORE="controller/{name}_core.hpp"', f"-DROBOT={name.lower()}_kinematics"
    objects = [path.name for path in folder.glob("*.o")]
    run(
        folder,
        "g++",
        "-std=c++17",
        "-O1",
        *WARNINGS,
        "-I.",
        core,
        namespace,
        DRIVER,
        *objects,
        "-o",
        "driver",
    )
    return folder / "driver"


def driven(driver: Path, steps: Sequence[str]) -> list[Result]:
    """Return what the core of a driver returns in each step."""
    done = subprocess.run([driver], input="\n".join(steps), capture_output=True, text=True, check=True)
    results = [Result({}, [])]
    for line in done.stdout.splitlines():
        word, _, rest = line.partition(" ")
        if word == "end":
            results.append(Result({}, []))
        elif word == "event":
            results[-1].events.append(rest)
        else:
            results[-1].numbers[word] = [float(value) for value in rest.split()]
    assert len(results) == len(steps) + 1
    return results[:-1]


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A function that returns the driver of a differential drive from the text of its robot file."""

    @cache
    def made(text: str = PAIR) -> Path:
        folder = tmp_path_factory.mktemp("pair")
        (folder / "pair.yaml").write_text(text)
        return driver_of(folder, folder / "pair.yaml")

    return made


def joints(time: float, *values: float | None) -> str:
    """Return the step of joint states at a time [s]."""
    words = ["-" if value is None else repr(value) for value in values]
    return f"joints {round(time * SECOND)} {' '.join(words)}"


def command(time: float, vx: float, vy: float, omega: float) -> str:
    """Return the step of a twist at a time [s]."""
    return f"command {round(time * SECOND)} {vx!r} {vy!r} {omega!r}"


def act(time: float) -> str:
    """Return the step that computes commands at a time [s]."""
    return f"act {round(time * SECOND)}"


def signs(driver: Path) -> list[int]:
    """Return the signs of the rotations of the joints in ROS."""
    text = next((driver.parent / "controller").glob("*_core.hpp")).read_text()
    lines = [line for line in text.splitlines() if "Interface::" in line and line.startswith("    {")]
    return [-1 if "-1.0" in line else 1 for line in lines]


@pytest.mark.slow
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_figure_of_eight_is_the_closed_form_in_spite_of_faults(robot: str, tmp_path: Path) -> None:
    """Some states are dropped, are not numbers, or come twice; the pose after each complete state is exact."""
    path = ROOT / "robots" / f"{robot}.yaml"
    driver = driver_of(tmp_path, path)
    steps, wanted = ["set long_step 100", "set longest_step 100"], {}
    for k, moment in enumerate(figure_of_eight(derive(load(path)), *ROBOTS[robot])):
        values = [sign * value for sign, value in zip(signs(driver), moment.joints.values(), strict=True)]
        states: list[float | None] = list(values)
        turning = 58 <= k <= 63  # the twist changes here, so each state counts
        if k % 7 == 3 and not turning:
            states[0] = None
        elif k % 11 == 5 and not turning:
            states[0] = nan
        elif k:
            wanted[len(steps)] = moment
        steps.append(joints(moment.time / SECOND, *states))
        if k % 13 == 6:
            steps.append(joints(moment.time / SECOND, *values))
            if states != values:  # the state that was missing
                wanted[len(steps) - 1] = moment
    results = driven(driver, steps)
    got = {k: result.numbers["odometry"] for k, result in enumerate(results) if "odometry" in result.numbers}
    assert got.keys() == wanted.keys() and len(got) > 90
    for k, moment in wanted.items():
        assert got[k][0] == moment.time and got[k][1:3] == pytest.approx(moment.pose[:2], abs=1e-6)
        assert abs(remainder(got[k][3] - moment.pose[2], 2 * pi)) < 1e-6
        assert got[k][4:7] == pytest.approx(moment.twist, abs=1e-9)
    events = [event for result in results for event in result.events]
    assert events and all("not a number" in event for event in events)


@pytest.mark.slow
def test_a_twist_beyond_a_limit_is_scaled_as_a_whole(pair: Callable[[], Path]) -> None:
    radius, half = 0.0975, 0.1655
    at_limit = [(1.0 - half * 0.5) / radius, (1.0 + half * 0.5) / radius]
    steps = [joints(1.0, 0.0, 0.0)]
    for factor in (1.0, 1.01, 1e30, 0.5):
        steps += [command(1.0, factor, 0.0, 0.5 * factor), act(1.0)]
    steps += ["set limit.vx -0.5 0.5", command(1.0, 2.0, 0.0, 1.0), act(1.0)]
    results = driven(pair(), steps)
    got = [result.numbers["commands"] for result in results if "commands" in result.numbers]
    for speeds, factor in zip(got, (1.0, 1.0, 1.0, 0.5, 0.5), strict=True):
        assert speeds == pytest.approx([factor * speed for speed in at_limit], rel=1e-12)
    (event,) = [event for result in results for event in result.events]
    assert "0.99" in event


@pytest.mark.slow
def test_no_twist_beyond_a_limit_stops_the_robot_by_its_rounding(pair: Callable[[str], Path]) -> None:
    steps = [joints(1.0, 0.0, 0.0)]
    for k in range(1, 400):
        steps += [command(1.0, 3.0 + k / 100, 0.0, 0.1), act(1.0)]
    results = driven(pair(FAST), steps)
    sums = [sum(result.numbers["commands"]) for result in results if "commands" in result.numbers]
    assert sums == pytest.approx([6.0 / 0.0975] * 399, rel=1e-12)
    assert sum(len(result.events) for result in results) == 1


@pytest.mark.slow
def test_a_least_speed_does_not_move_a_robot_that_is_to_stop(pair: Callable[[str], Path]) -> None:
    steps = [joints(1.0, 0.0, 0.0), command(1.0, 0.0, 0.0, 0.0), act(1.0)]
    results = driven(pair(PAIR.replace("vx: 1", "vx: [0.1, 1]")), steps)
    assert results[-1].numbers["commands"] == [0.0, 0.0]


@pytest.mark.slow
def test_a_command_that_is_old_from_the_future_or_not_a_number_stops_the_robot(
    pair: Callable[[], Path],
) -> None:
    steps = ["set joint_timeout 60", joints(1.0, 1.0, 1.0), command(1.0, 0.5, 0.0, 0.0)]
    steps += [act(1.5), act(1.51), act(1.6), command(2.0, nan, 0.0, inf), act(2.0)]
    steps += [command(3.0, 0.5, 0.0, 0.0), act(3.1), act(2.0)]
    results = driven(pair(), steps)
    moving = [result.numbers["commands"][0] > 0 for result in results if "commands" in result.numbers]
    assert moving == [True, False, False, False, True, False]
    assert sum("no command" in event for result in results for event in result.events) == 1
    assert sum("not a number" in event for result in results for event in result.events) == 1


@pytest.mark.slow
def test_a_joint_that_does_not_come_is_named_and_stops_the_robot(pair: Callable[[], Path]) -> None:
    steps = ["alive 1000000000", "alive 1400000000", joints(1.4, None, 1.0), "alive 1600000000"]
    steps += [joints(1.7, 1.0, None), "alive 1700000000", command(1.7, 0.5, 0.0, 0.0), act(1.7)]
    for k in range(10):
        steps += [joints(1.8 + k / 10, None, 1.0), command(1.8 + k / 10, 0.5, 0.0, 0.0), act(1.8 + k / 10)]
    results = driven(pair(), steps)
    alive = [tuple(result.numbers["alive"]) for result in results if "alive" in result.numbers]
    assert alive == [(0, 0), (0, 0), (0, 0), (1, 1)]
    speeds = [result.numbers["commands"][0] for result in results if "commands" in result.numbers]
    assert speeds[0] > 0 and speeds[4] > 0 and speeds[-1] == 0
    events = [event for result in results for event in result.events]
    assert len(events) == 1 and "left_spin" in events[0] and "right_spin" not in events[0]


@pytest.mark.slow
def test_a_restart_keeps_the_pose_and_forgets_the_command(pair: Callable[[], Path]) -> None:
    steps = [joints(1.0, 1.0, 1.0), joints(1.1, 1.0, 1.0), command(1.1, 0.5, 0.0, 0.0), "restart"]
    steps += [joints(9.0, 1.0, 1.0), act(9.0), joints(9.1, 1.0, 1.0)]
    results = driven(pair(), steps)
    assert results[1].numbers["odometry"][1] == pytest.approx(0.1 * 0.0975)
    assert results[4].numbers == {} and results[5].numbers["commands"] == [0.0, 0.0]
    assert results[6].numbers["odometry"][1] == pytest.approx(0.2 * 0.0975)
    assert all(not result.events for result in results)


@pytest.mark.slow
def test_settings_out_of_range_change_nothing(pair: Callable[[str], Path]) -> None:
    driver = pair(TUNABLE.replace("r: 0.0975", "r: radius"))
    steps = ["set radius 0.1", "set radius 1.0", "set radius nan", "set radius 0.1", "set cmd_timeout -1"]
    steps += ["set cmd_timeout nan", joints(1.0, 1.0, 1.0), joints(1.1, 1.0, 1.0)]
    results = driven(driver, steps)
    accepted = [result.numbers["configured"] == [1] for result in results[:6]]
    assert accepted == [True, False, False, True, False, False]
    assert results[-1].numbers["odometry"][1] == pytest.approx(0.01)


def test_only_joints_with_a_motor_are_commanded() -> None:
    """The rear wheels of the tricycle are measured, and have no motor."""
    text = files_of(ROOT / "robots" / "textbook_tricycle.yaml", "ros2")[
        "controller/textbook_tricycle_core.hpp"
    ]
    lines = [
        line.split(",") for line in text.decode().splitlines() if "Interface::" in line and '{ "' in line
    ]
    commanded = {words[0].split('"')[1]: words[3].strip() for words in lines}
    assert commanded == {
        "rear_left_spin": "false", "rear_right_spin": "false", "front_spin": "true", "front_steer": "true"
    }  # fmt: skip


# The line of a fault in C++ -> its code in Python.
CODES = {
    "beyond the limits": "clamped",
    "not a number": "not_a_number",
    "no command": "no_command",
    "integrated": "late",
    "did not change": "gap",
    "older": "backwards",
    "no state of": "no_joint_states",
    "out of the range": "out_of_range",
    "rejected": "unreachable",
}


def random_steps(seed: int) -> list[tuple[str, float, list[float | None]]]:
    """Return steps with random faults: verb, time [s], and values."""
    rng = random.Random(seed)
    time, steps = 100.0, []
    for _ in range(300):
        time += rng.choice([0.02, 0.02, 0.02, 0.02, 0.2, 0.6, 1.5, -0.013, -2.0])
        time = round(time, 6)
        speeds: list[float | None] = [rng.uniform(-9.0, 9.0), rng.uniform(-9.0, 9.0)]
        if rng.random() < 0.1:
            speeds[rng.randrange(2)] = rng.choice([None, nan, inf])
        steps.append(("joints", time, speeds))
        if rng.random() < 0.7:
            twist = [rng.uniform(-1.5, 1.5), 0.0, rng.uniform(-3.0, 3.0)]
            if rng.random() < 0.05:
                twist[rng.randrange(3)] = nan
            steps.append(("command", time, [*twist]))
        steps.append(("act", time, []))
    return steps


def by_python(
    module: ModuleType, core: Any, step: tuple[str, float, list[float | None]]
) -> tuple[list[float], list[str]]:
    """Return the numbers and the codes of the events of a step in the Python core."""
    verb, time, values = step
    numbers: list[float] = []
    if verb == "joints":
        seen = [(name, value) for name, value in zip(core.names, values, strict=True) if value is not None]
        names, speeds = [name for name, _ in seen], [value for _, value in seen]
        got = core.joint_states(names, [], speeds, round(time * SECOND), time)
        if got:
            numbers = [got.stamp, got.x, got.y, got.theta, got.vx, got.vy, got.omega]
            numbers += [*got.pose_covariance, *got.twist_covariance]
    elif verb == "command":
        core.command(*values, time)
    else:
        numbers = [*core.joint_commands(time)[0]]
    codes = [code for code, _ in core.events]
    core.events.clear()
    return numbers, codes


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("text", [PAIR, NOISY], ids=["plain", "noisy"])
def test_random_drives_with_faults_are_those_of_the_python_core(
    text: str, seed: int, pair: Callable[[str], Path], tmp_path: Path
) -> None:
    (tmp_path / "pair.yaml").write_text(text)
    module, core = core_of(tmp_path, tmp_path / "pair.yaml")
    steps = random_steps(seed)
    words = [
        {"joints": joints, "command": command}.get(verb, act)(time, *values) for verb, time, values in steps
    ]
    results = driven(pair(text), words)
    found = set()
    for step, result in zip(steps, results, strict=True):
        numbers, codes = by_python(module, core, step)
        got = [value for values in result.numbers.values() for value in values]
        assert len(got) == len(numbers)
        assert all(a == b or (isnan(a) and isnan(b)) for a, b in zip(got, numbers, strict=True)), step
        own = [next(code for part, code in CODES.items() if part in event) for event in result.events]
        assert own == codes, step
        found |= set(own)
    assert len(found) >= 5
