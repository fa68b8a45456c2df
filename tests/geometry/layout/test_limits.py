"""Limits of a robot file: the lower end must not be above the upper end, also for expressions."""

from __future__ import annotations

import pytest

from tests.robotfile.files import read, robot, wheel
from wmrgen.errors import RobotFileError
from wmrgen.geometry.layout import build


@pytest.mark.parametrize("limit", ["[2, 1]", "-1", "[30 deg, 0.5]", "[p*2, p]"])
def test_the_lower_end_above_the_upper_is_refused(limit: str) -> None:
    spec = read(
        robot(wheel("a", limits=f"{{spin: {limit}}}"), top="parameters: {p: 0.1}\n").replace("deg", "rpm")
    )
    with pytest.raises(RobotFileError) as caught:
        build(spec)
    assert caught.value.code == "WMR109" and "spin" in caught.value.what
    mark = caught.value.mark
    assert mark is not None and mark.text[mark.column - 1 :].startswith(limit[:2])


@pytest.mark.parametrize("share", ["1", "1.5", "-0.01", "p"])
def test_a_deadband_is_a_share(share: str) -> None:
    """From 0 to below 1, and no calibration moves it."""
    spec = read(robot(top=f"parameters: {{p: {{value: 0.1, tunable: true}}}}\ndeadband: {share}\n"))
    with pytest.raises(RobotFileError) as caught:
        build(spec)
    assert caught.value.code == "WMR109" and "deadband" in caught.value.what
    assert caught.value.mark is not None and caught.value.mark.line == 4
    assert float(build(read(robot(top="parameters: {q: 0.1}\ndeadband: q/4\n"))).deadband) == 0.025
    assert not build(read(robot())).deadband and not build(read(robot(top="deadband: 0\n"))).deadband


@pytest.mark.parametrize("limit", ["[2, 2]", "0", "[p*2, p + p]"])
def test_equal_ends_are_limits_of_one_value(limit: str) -> None:
    built = build(read(robot(wheel("a", limits=f"{{spin: {limit}}}"), top="parameters: {p: 0.1}\n")))
    interval = built.limit(built.wheel("a"), "spin")
    assert interval is not None and interval.low == interval.high
