"""The top view in a terminal."""

from __future__ import annotations

import pytest

from tests.report.figures.common import PAIR, THREE, robot
from tests.robots import ROBOTS, of_gallery
from wmrgen.report.figures.sketch import sketch


def test_a_differential_drive_in_characters() -> None:
    ball = "  - {name: ball, type: spherical, x: -0.4, y: 0, r: 0.02}\n"
    lines = sketch(robot(PAIR + ball).robot)
    assert lines == [
        "     |     ^     |",
        "left |     +     | right",
        "     |           |",
        "",
        "",
        "",
        "",
        "           o ball",
    ]


@pytest.mark.parametrize("name", ROBOTS)
def test_sketches_are_small_and_have_every_wheel(name: str) -> None:
    lines = sketch(of_gallery(name).robot)
    assert len(lines) <= 16 and max(map(len, lines)) <= 80 and "\n".join(lines).isascii()
    assert all(w.name in "\n".join(lines) for w in of_gallery(name).robot.wheels)


def test_a_wheel_is_a_stroke_along_its_rolling_direction() -> None:
    for heading, stroke in (
        (0, "|"),
        ("pi/4", "\\"),
        ("pi/2", "-"),
        ("-pi/4", "/"),
        ("pi", "|"),
        ("-pi/2", "-"),
    ):
        text = "\n".join(sketch(robot(THREE.replace("heading: 0", f"heading: {heading}")).robot))
        assert stroke in text.split("s0")[0].split("\n")[-1], text
