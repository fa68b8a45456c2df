"""The names that other tools have for joints and for the robot frame."""

from __future__ import annotations

from typing import Any

import pytest

from tests.robotfile.files import read
from wmrgen import derive
from wmrgen.errors import Code, RobotFileError
from wmrgen.geometry.layout import build

FILE = """\
wmrgen: 1
name: probe
{frame}wheels:
  - {{name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05{left}}}
  - {{name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.05{right}}}
  - {{name: front, type: steered, x: 0.4, y: 0, heading: 0, r: 0.05{front}}}
"""


def text(frame: str = "", left: str = "", right: str = "", front: str = "") -> str:
    return FILE.format(frame=frame, left=left, right=right, front=front)


def test_names_of_joints_and_frame_are_read() -> None:
    robot = build(
        read(
            text(
                "frame: chassis_base\n",
                ", joints: {spin: left wheel/joint-1}",
                front=", joints: {spin: 'm::front', steer: -steering_joint}",
            )
        )
    )
    assert robot.frame == "chassis_base"
    left, right, front = robot.wheels
    assert left.joint_name("spin") == ("left wheel/joint-1", False)
    assert right.joint_name("spin") == ("right_spin", False) and not right.joints
    assert front.joint_name("spin") == ("m::front", False)
    assert front.joint_name("steer") == ("steering_joint", True) and front.joint_name("steer").sign == -1


def test_without_names_the_frame_is_that_of_ros() -> None:
    assert build(read(text())).frame == "base_link"


def test_model_json_has_the_names() -> None:
    robot = build(read(text("frame: chassis\n", front=", joints: {steer: -down}")))
    model: Any = derive(robot).model()
    assert model["frame"] == "chassis"
    assert model["wheels"][2]["joints"] == {"steer": {"name": "down", "reversed": True}}
    assert "joints" not in model["wheels"][0]
    assert "frame" not in derive(build(read(text()))).model()


@pytest.mark.parametrize(
    ("parts", "line", "code"),
    [
        ({"left": ", joints: {spin: 'a*b'}"}, 4, Code.NAME),
        ({"left": ", joints: {spin: ''}"}, 4, Code.FORM),
        ({"left": ", joints: {spin: '-'}"}, 4, Code.NAME),
        ({"left": ", joints: {spin: --a}"}, 4, Code.NAME),
        ({"left": ", joints: {spin: [a]}"}, 4, Code.FORM),
        ({"left": ", joints: {steer: a}"}, 4, Code.UNKNOWN_KEY),
        ({"left": ", joints: {spin: a}", "right": ", joints: {spin: a}"}, 5, Code.TWICE),
        ({"left": ", joints: {spin: a}", "right": ", joints: {spin: -a}"}, 5, Code.TWICE),
        ({"left": ", joints: {spin: a}", "front": ", joints: {steer: a}"}, 6, Code.TWICE),
        ({"frame": "frame: a(b)\n"}, 3, Code.NAME),
        ({"frame": "frame: -a\n"}, 3, Code.NAME),
    ],
)
def test_names_that_are_refused(parts: dict[str, str], line: int, code: Code) -> None:
    with pytest.raises(RobotFileError) as caught:
        build(read(text(**parts)))
    assert (caught.value.code, caught.value.mark and caught.value.mark.line) == (code, line)


@pytest.mark.parametrize(
    ("name", "ratios", "fits"), [("a", "", True), ("-a", "", False), ("-a", "[1, -1]", True)]
)
def test_one_joint_may_turn_coupled_wheels(name: str, ratios: str, fits: bool) -> None:
    coupling = "{equal: [left.spin, right.spin]" + (f", ratios: {ratios}" if ratios else "") + "}"
    file = (
        text(left=", joints: {spin: a}", right=f", joints: {{spin: {name}}}") + f"couplings: [{coupling}]\n"
    )
    if fits:
        assert build(read(file)).wheels[1].joint_name("spin").name == "a"
        return
    with pytest.raises(RobotFileError) as caught:
        build(read(file))
    assert caught.value.code is Code.TWICE


def test_a_joint_with_two_axes_steers_and_spins_one_wheel() -> None:
    front = build(read(text(front=", joints: {spin: universal, steer: universal}"))).wheels[2]
    assert front.joint_name("spin") == front.joint_name("steer") == ("universal", False)
