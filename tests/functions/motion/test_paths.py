"""Which measurements determine the yaw rate, and who has a heading from wheel angles."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy

from tests.functions.motion.common import derived
from tests.functions.refusals import refused
from wmrgen.functions.registry import Reason

PAIR = """\
wmrgen: 1
name: pair
wheels:
  - {name: right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
  - {name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1%s}
"""
FAR = PAIR.replace("x: 0, y: ", "x: 7, y: 2 + ")


OMNI = "  - {{name: w{k}, type: swedish, x: {x}, y: {y}, heading: {heading}, r: 0.1, gamma: 0}}\n"


@pytest.mark.parametrize("text", [PAIR, FAR])
def test_one_sensed_wheel_of_two_tells_no_heading(text: str) -> None:
    assert derived(text % "").formula("heading").outputs
    with refused(Reason.UNOBSERVABLE, "heading"):
        derived(text % ", sensed: []").formula("heading")


@pytest.mark.parametrize("about", [(0, 0), (7, -2)])
@pytest.mark.parametrize(
    ("seen", "wheels"),
    [
        (True, ((0, -1, "0"), (0, 1, "0"), (1, 0, "pi/2"))),
        (False, ((0, 1, "0"), (1, 0, "pi/2"))),
        (False, ((0, -1, "0"), (1, 0, "pi/2"))),
        (False, ((0, -1, "0"), (0, -1, "0"), (1, 0, "pi/2"))),
        (True, ((0, -1, "0"), (0, 2, "0"))),
        (True, ((1, 0, "pi/2"), (-1, 0, "pi/2"))),
        (False, ((1, 0, "pi/2"), (1, 3, "pi/2"))),
        (True, ((1, 0, "pi/2"), (0, 1, "0"), (1, 2, "pi/4"))),
        (False, ((1, 0, "pi/2"), (0, 1, "0"), (1, 1, "pi/4"))),
        (False, ((1, 0, "pi/2"), (0, 1, "0"), (1, 1, "3*pi/4"))),
    ],
)
def test_the_yaw_rate_is_seen_where_sensed_wheels_combine_to_it(
    seen: bool, wheels: tuple[tuple[float, float, str], ...], about: tuple[float, float]
) -> None:
    """Omni wheels measure a vx + b vy + c omega; the yaw rate is seen if the rows span (0, 0, 1), wherever P is."""
    text = "wmrgen: 1\nname: omni\nwheels:\n" + "".join(
        OMNI.format(k=k, x=x + about[0], y=y + about[1], heading=heading)
        for k, (x, y, heading) in enumerate(wheels)
    )
    rows = []
    for x, y, heading in wheels:
        angle = float(sympy.sympify(heading))
        c, s = math.cos(angle), math.sin(angle)
        rows.append([c, s, x * s - y * c])
    spanned = np.linalg.matrix_rank(np.array(rows), 1e-9) == np.linalg.matrix_rank(
        np.array([*rows, [0.0, 0.0, 1.0]]), 1e-9
    )
    assert spanned == seen
    if seen:
        assert derived(text).formula("heading").outputs
    else:
        with refused(Reason.UNOBSERVABLE, "heading"):
            derived(text).formula("heading")
