"""Which measurements determine the yaw rate, and who has a heading from wheel angles."""

from __future__ import annotations

import pytest

from tests.functions.motion.common import derived
from wmrgen.errors import NotDerivableError
from wmrgen.functions.motion.paths import _sees_yaw
from wmrgen.geometry.exact.poly import Poly, Row

PAIR = """\
wmrgen: 1
name: pair
wheels:
  - {name: right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
  - {name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1%s}
"""
FAR = PAIR.replace("x: 0, y: ", "x: 7, y: 2 + ")


def rows(*values: tuple[float, float, float]) -> list[Row]:
    return [(Poly.of(a), Poly.of(b), Poly.of(k)) for a, b, k in values]


@pytest.mark.parametrize(
    ("seen", "measured"),
    [
        (False, ()),
        (True, ((0, 0, 1),)),
        (True, ((0, 0, -3),)),
        (False, ((1, 0, 0),)),
        (False, ((1, 0, 1),)),
        (False, ((0, 1, 1),)),
        (False, ((1, 1, 1),)),
        (True, ((1, 0, 1), (1, 0, 0))),
        (True, ((1, 0, 1), (1, 0, -1))),
        (True, ((0, 2, 1), (0, 1, 1))),
        (False, ((1, 0, 1), (0, 1, 0))),
        (False, ((1, 0, 1), (0, 1, 1))),
        (False, ((1, 0, 0), (0, 1, 0))),
        (False, ((1, 0, 1), (2, 0, 2))),
        (True, ((1, 0, 0), (0, 1, 0), (1, 1, 1))),
        (False, ((1, 0, 2), (0, 1, 3), (1, 1, 5))),
    ],
)
def test_the_yaw_rate_is_seen_where_rows_combine_to_it(
    seen: bool, measured: tuple[tuple[float, float, float], ...]
) -> None:
    assert _sees_yaw(derived(PAIR % "").robot, rows(*measured)) == seen
    there = [(a, b, k - a * 2 + b * 7) for a, b, k in measured]  # the same speeds, of wheels about (7, 2)
    assert _sees_yaw(derived(FAR % "").robot, rows(*there)) == seen


@pytest.mark.parametrize("text", [PAIR, FAR])
def test_one_sensed_wheel_of_two_tells_no_heading(text: str) -> None:
    assert derived(text % "").formula("heading").outputs
    with pytest.raises(NotDerivableError, match="do not determine its yaw rate"):
        derived(text % ", sensed: []").formula("heading")
