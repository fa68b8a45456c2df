"""Trailers, virtual wheels, centre of gravity, gains and functions in the robot file."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tests.robotfile.files import places, read, refused, robot, show, wheel
from wmrgen.geometry.layout import build

CAR = (
    wheel("rear", x="0", y="0"),
    wheel("left", "steered", x="1.4", y="0.3"),
    wheel("right", "steered", x="1.4", y="-0.3"),
)


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
    ("top", "where"),
    [
        ("trailers: [{length: 0}]\n", "WMR109 3:21"),
        ("trailers: [{length: -1 m}]\n", "WMR109 3:21"),
        ("trailers: [{hitch: 1}]\n", "WMR103 3:12"),
        ("trailers: [{length: 1, hich: 1}]\n", "WMR102 3:24"),
        ("trailers: [{length: 1, name: left}]\n", "WMR106 3:30"),
        ("trailers: [{length: 1, name: a}, {length: 1, name: a}]\n", "WMR106 3:52"),
        ("trailers: {length: 1}\n", "WMR104 3:11"),
        ("trailers: [" + "{length: 1}, " * 17 + "]\n", "WMR104 3:220"),
        ("virtual: [{name: front}]\n", "WMR103 3:11"),
        ("virtual: [{name: front, steers: [left], drives: [rear]}]\n", "WMR106 3:41"),
        ("virtual: [{name: front, steers: [lft]}]\n", "WMR107 3:34"),
        ("virtual: [{name: front, steers: [rear]}]\n", "WMR104 3:34"),
        ("virtual: [{name: front, steers: []}]\n", "WMR104 3:33"),
        ("virtual: [{name: front, steers: [left, left]}]\n", "WMR106 3:40"),
        ("virtual: [{name: front, steers: [left], x: 1}]\n", "WMR103 3:11"),
        ("virtual: [{name: left, steers: [left]}]\n", "WMR106 3:18"),
        ("virtual: [{steers: [left]}]\n", "WMR103 3:11"),
        ("cg: {x: 0, y: 0}\n", "WMR103 3:5"),
        ("cg: {x: 0, y: 0, z: 3 rad}\n", "WMR104 3:21"),
        ("gains: {k_rh: 3}\n", "WMR102 3:9"),
        ("gains: {k_rho: 1/0}\n", "WMR109 3:16"),
        ("gains: {k_rho: 3 m}\n", "WMR104 3:16"),
        ("functions: [dynamics, dynamics]\n", "WMR106 3:23"),
        ("functions: dynamics\n", "WMR104 3:12"),
        ("slip: yes\n", "WMR104 3:7"),
        ("parameters: {trailer1_theta: 1}\ntrailers: [{length: 1}]\n", "WMR109 3:30"),
        ("parameters: {front_steer: 1}\nvirtual: [{name: front, steers: [left]}]\n", "WMR109 3:27"),
    ],
)  # fmt: skip
def test_bad(top: str, where: str) -> None:
    assert places(refused(robot(*CAR, top=top), built=True)) == where
