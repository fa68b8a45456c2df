"""Trailers, virtual wheels, centre of gravity, gains and functions in the robot file."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tests.robotfile.files import read, robot, show, wheel
from wmrgen.errors import RobotFileError
from wmrgen.geometry.layout import build

CAR = (
    wheel("rear", x="0", y="0"),
    wheel("left", "steered", x="1.4", y="0.3"),
    wheel("right", "steered", x="1.4", y="-0.3"),
)


def message(top: str) -> str:
    with pytest.raises(RobotFileError) as caught:
        build(read(robot(*CAR, top=top)))
    assert caught.value.mark is not None
    assert str(caught.value.mark).startswith("bot.yaml:")
    return str(caught.value)


def test_trailers() -> None:
    spec = read(
        robot(
            *CAR,
            top="parameters: {l1: 1.1}\ntrailers:\n  - {length: l1}\n  - {name: dolly, length: 90 cm, hitch: -20 cm}\n",
        )
    )
    assert [(t.name, show(t.length.expr)) for t in spec.trailers] == [("trailer1", "l1"), ("dolly", "9/10")]
    first, second = build(spec).trailers
    assert float(first.length.nominal) == 1.1 and first.hitch.nominal == 0
    assert second.hitch.nominal.rational() == Fraction(-1, 5)


def test_virtual_wheels_stand_in_the_middle() -> None:
    found = build(read(robot(*CAR, top="virtual:\n  - {name: front, steers: [left, right]}\n"))).virtual
    assert [(v.name, v.role, v.wheels) for v in found] == [("front", "steers", ("left", "right"))]
    assert (float(found[0].x.nominal), float(found[0].y.nominal)) == (1.4, 0.0)


def test_gains_may_be_tunable() -> None:
    top = "parameters: {k: {value: 3, tunable: true}}\ngains: {k_rho: k, k_beta: -k/2}\n"
    top += "cg: {x: 0, y: 1 cm, z: 0.3}\nslip: true\n"
    made = build(read(robot(*CAR, top=top)))
    assert made.slip
    assert made.gains["k_rho"].working.constant is None
    assert float(made.gains["k_beta"].nominal) == -1.5
    assert made.cg is not None and float(made.cg.y.nominal) == 0.01


@pytest.mark.parametrize(
    ("top", "words"),
    [
        ("trailers: [{length: 0}]\n", "not positive"),
        ("trailers: [{length: -1 m}]\n", "not positive"),
        ("trailers: [{hitch: 1}]\n", "has no length"),
        ("trailers: [{length: 1, hich: 1}]\n", "Did you mean hitch?"),
        ("trailers: [{length: 1, name: left}]\n", "name of a wheel already"),
        ("trailers: [{length: 1, name: a}, {length: 1, name: a}]\n", "name of a trailer already"),
        ("trailers: {length: 1}\n", "must be a list"),
        ("trailers: [" + "{length: 1}, " * 17 + "]\n", "At most 16"),
        ("virtual: [{name: front}]\n", "neither steers nor drives"),
        ("virtual: [{name: front, steers: [left], drives: [rear]}]\n", "steers and drives"),
        ("virtual: [{name: front, steers: [lft]}]\n", "Did you mean left?"),
        ("virtual: [{name: front, steers: [rear]}]\n", "rear is a fixed wheel"),
        ("virtual: [{name: front, steers: []}]\n", "names no wheel"),
        ("virtual: [{name: front, steers: [left, left]}]\n", "stands twice"),
        ("virtual: [{name: front, steers: [left], x: 1}]\n", "one of x and y"),
        ("virtual: [{name: left, steers: [left]}]\n", "name of a wheel already"),
        ("virtual: [{steers: [left]}]\n", "has no name"),
        ("cg: {x: 0, y: 0}\n", "has no z"),
        ("cg: {x: 0, y: 0, z: 3 rad}\n", "is a length"),
        ("gains: {k_rh: 3}\n", "Did you mean k_rho?"),
        ("gains: {k_rho: 1/0}\n", "division by zero"),
        ("gains: {k_rho: 3 m}\n", "has a unit"),
        ("functions: [dynamics, dynamics]\n", "stands twice"),
        ("functions: dynamics\n", "must be a list"),
        ("slip: yes\n", "not known"),
        ("parameters: {trailer1_theta: 1}\ntrailers: [{length: 1}]\n", "has the name of"),
        ("parameters: {front_steer: 1}\nvirtual: [{name: front, steers: [left]}]\n", "has the name of"),
    ],
)  # fmt: skip
def test_bad(top: str, words: str) -> None:
    assert words in message(top)
