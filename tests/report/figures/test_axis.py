"""Numbers at the ends of an axis."""

from __future__ import annotations

import pytest

from wmrgen.report.figures.axis import ends
from wmrgen.report.figures.paper import width

ROOM = 56.0  # px
RANGES = [
    (0.0, 1.0), (-0.866, 0.866), (1.0, 1.0), (0.0, 0.0), (-2.47e7, 2.47e7), (0.0, 6.17e6), (1.23e-6, 2.46e-6),
    (-1e-9, 3.0), (0.09751, 0.09752), (1e300, 2e300), (-5e-300, 1e-300), (999999.0, 1000001.0),
    (0.00123456, 0.00123457), (-1e7, -9.999e6),
]  # fmt: skip


@pytest.mark.parametrize(("low", "high"), RANGES)
def test_numbers_fit_and_are_those_of_the_axis(low: float, high: float) -> None:
    found = ends(low, high, ROOM)
    assert max(width(found.low), width(found.high)) <= ROOM + 8
    for text, value in ((found.low, low), (found.high, high)):
        shown = float(text.replace("−", "-")) * 10.0**found.power
        assert shown == pytest.approx(value, rel=0.006, abs=1e-2 * max(abs(low), abs(high)))
    assert bool(found.unit("m").startswith(" [10")) == bool(found.power)


@pytest.mark.parametrize(("low", "high"), [(0.7112, 0.7114), (1000000.0, 1000100.0), (3.0001, 3.0002)])
def test_ends_that_differ_have_different_numbers(low: float, high: float) -> None:
    found = ends(low, high, 2 * ROOM)
    assert found.low != found.high


def test_the_power_of_ten_is_part_of_the_unit() -> None:
    assert ends(0.0, 6.17e6, ROOM) == ("0", "6.17", 6)
    assert ends(0.0, 6.17e6, ROOM).unit("m") == " [10⁶ m]"
    assert ends(0.0, 2e-7, 30.0).unit("") == " [10⁻⁷]"
    assert ends(0.0, 2.0, ROOM).unit("") == ""
