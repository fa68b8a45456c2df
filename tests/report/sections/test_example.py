"""The example on top of a report, against `wmrgen eval` and against a pose integrated here."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import Outcome
from tests.report.sections.common import between, box, page_written, result
from tests.robots import ROBOTS, of_gallery

Cli = Callable[..., Outcome]
UNITS = re.compile(r"([\w.]+) += (-?[\d.e+-]+)")


def steps(text: str) -> list[tuple[dict[str, float], str]]:
    """What each row of the example says, and its command."""
    rows = re.findall(r"(?m)^\| (.*?) \| `wmrgen (.*?)` \|$", between(text, "An example", "Files"))
    return [({n: float(v) for n, v in UNITS.findall(said)}, command) for said, command in rows]


def check_example(text: str, file: Path, wmrgen_cli: Cli) -> None:
    """The example in a result with this text: joints to six digits, a twist to six decimals."""
    shown = steps(text)
    assert [command.split()[2] for _, command in shown] == ["inverse", "forward", "odometry"]
    twist = {}
    for said, command in shown:
        verb, name, *rest = command.split()
        assert name.endswith(".yaml")
        done = wmrgen_cli(verb, file, *rest)
        assert done.code == 0, done.err
        printed = {n: float(v) for n, v in UNITS.findall(done.out)}
        bound = {"rel": 0.0, "abs": 5.1e-7} if rest[0] == "forward" else {"rel": 5.1e-6, "abs": 1e-12}
        for port, value in said.items():
            assert value == pytest.approx(printed[port], **bound), (command, port)
        if rest[0] == "inverse":
            twist = {"vx": 0.0, "vy": 0.0, "omega": 0.0} | {
                n: float(v) for n, v in (w.split("=") for w in rest[1:])
            }
    assert any(twist.values())
    assert ("the same twist again" in text) == (shown[1][0] == twist)
    vx, vy, omega = twist.values()
    small = np.eye(3) + np.array([[0, -omega, vx], [omega, 0, vy], [0, 0, 0]]) / 2**26
    pose = np.linalg.matrix_power(small, 2**26)  # exp of the twist
    assert (shown[2][0]["x"], shown[2][0]["y"]) == pytest.approx((pose[0, 2], pose[1, 2]), abs=1e-5)
    assert shown[2][0]["theta"] == pytest.approx(omega)


EXAMPLES = ("pioneer3dx", "wpilib_swervebot", "kuka_youbot", "ackermann_car")


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_example_is_what_the_commands_print(name: str, wmrgen_cli: Cli) -> None:
    check_example(result(name), ROBOTS[name], wmrgen_cli)


TWO = (
    "{name: l, type: fixed, x: 0, y: A, heading: 0, r: B}",
    "{name: r, type: fixed, x: 0, y: -A, heading: 0, r: C}",
)
THREE = tuple(
    f"{{name: w{k}, type: steered, x: {x}, y: {y}, heading: 0, r: {r}}}"
    for k, (x, y, r) in enumerate((("A", "-B", "C"), ("-B", "A", "C"), ("-C", "-A", "B")))
)


@pytest.mark.parametrize("wheels", [TWO, THREE])
@pytest.mark.parametrize(
    "lengths", [("0.002", "0.19", "0.04"), ("3 mm", "150 mm", "4 mm"), ("1990", "200", "310")]
)
def test_an_example_of_small_and_large_robots(
    wheels: tuple[str, ...], lengths: tuple[str, ...], tmp_path: Path, wmrgen_cli: Cli
) -> None:
    """Six digits of a wheel speed say little about how fast they turn."""
    text = "wmrgen: 1\nname: sample\nwheels:\n" + "".join(f"  - {w}\n" for w in wheels)
    for letter, length in zip("ABC", lengths, strict=True):
        text = re.sub(rf"(?<=[ -]){letter}(?=[,}}])", length, text)
    file = tmp_path / "sample.yaml"
    file.write_text(text)
    page = box(page_written(text))
    check_example(page, file, wmrgen_cli)
    assert "the same twist again" in page


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in ROBOTS if n not in EXAMPLES])
def test_every_example_is_what_its_commands_print(name: str, wmrgen_cli: Cli) -> None:
    if "An example" in result(name):
        check_example(result(name), ROBOTS[name], wmrgen_cli)
    else:
        assert name in ("office_chair",)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_example_turns_where_the_robot_can(name: str) -> None:
    """It drives, too, however slow it is. A car whose P lies off its axle has a sideways velocity then."""
    m = of_gallery(name).mobility
    if name != "office_chair":
        (command,) = re.findall(r"`wmrgen eval \S+ inverse (.*?)`", result(name))
        assert ("omega=" in command) == (m.dof == 3) and re.search("v[xy]=", command), command
