"""What a calibration writes: the robot file with every other character kept, counts, and values for C."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import wmrgen
from tests.tools.calibration.drives import derived
from tests.tools.calibration.simulated import LAYOUTS
from wmrgen.tools.calibration.observability import Estimate
from wmrgen.tools.calibration.written import beyond, c_values, equivalent_counts, new_values, with_values


@pytest.mark.parametrize(
    "text",
    ["r_right: {value: 0.05, tunable: true}   # mm\r\n", 'r_right:\n    value: "50 mm"\n    tunable: true\n'],
)
def test_the_robot_file_keeps_every_other_character(tmp_path: Path, text: str) -> None:
    path = tmp_path / "r.yaml"
    wheel = "{name: w, type: fixed, x: a, y: 0.05, heading: 0, r: r_right}"
    whole = f"wmrgen: 1\nname: r\nparameters:\n  {text}  a: 0.05\nwheels:\n  - {wheel}\n"
    path.write_bytes(whole.encode())
    new = with_values(path, {"r_right": 0.0512345})
    assert new == whole.replace("50 mm", "0.0512345").replace("value: 0.05,", "value: 0.0512345,")


RANGES = (
    "wmrgen: 1\nname: r\nparameters:\n  r: {value: 0.05, tunable: [49 mm, 0.051]}\n"
    "  half: {tunable: [0.04, 0.06], value: 0.05}\nwheels:\n"
    "  - {name: w, type: fixed, x: 0, y: half, heading: 0, r: r}\n"
)


def test_a_range_that_the_value_leaves_is_widened(tmp_path: Path) -> None:
    path = tmp_path / "r.yaml"
    path.write_text(RANGES)
    new = with_values(path, {"r": 0.0512345, "half": 0.055})
    before = ("value: 0.05, tunable: [49 mm, 0.051]", "value: 0.05}")
    after = ("value: 0.0512345, tunable: [49 mm, 0.0512345]", "value: 0.055}")
    assert new == RANGES.replace(before[0], after[0]).replace(before[1], after[1])
    lower = with_values(path, {"r": 0.04, "half": 0.02})
    assert lower == RANGES.replace("value: 0.05, tunable: [49 mm", "value: 0.04, tunable: [0.04").replace(
        "[0.04, 0.06], value: 0.05", "[0.02, 0.06], value: 0.02"
    )
    path.write_text(lower)
    assert [float(p.low) for p in wmrgen.load(path).tunable] == [0.04, 0.02]


@pytest.mark.parametrize(("value", "side"), [(0.0489, -1), (0.049, 0), (0.051, 0), (0.0511, 1)])
def test_sides_of_a_range(tmp_path: Path, value: float, side: int) -> None:
    path = tmp_path / "r.yaml"
    path.write_text(RANGES)
    (parameter,) = (p for p in wmrgen.load(path).tunable if p.name == "r")
    assert beyond(parameter, value) == side


def test_values_that_stay_nominal_are_not_written() -> None:
    """Values that belong together are, although no deviation is given for them."""
    result: Any = SimpleNamespace(
        parameters={
            "a": Estimate(1.1, 0.1, 1.0, True),
            "b": Estimate(1.2, None, 1.0, False),
            "c": Estimate(1.0, None, 1.0, False),
        }
    )
    assert new_values(result) == {"a": 1.1, "b": 1.2}


def test_counts_make_up_for_radii() -> None:
    """A radius that is 2 % larger is an encoder with 2 % fewer counts; one that counts down keeps its sign."""
    encoder = "encoder: {spin: {counts: 1000, gear: 2, bits: 32, reversed: true}}\n"
    robot = derived(LAYOUTS["differential_with_castor"].text + encoder).robot
    counts = equivalent_counts(robot, {"radius": 0.033 * 1.02, "track": 0.2})
    assert counts == pytest.approx({"left.spin": -2000 / 1.02, "right.spin": -2000 / 1.02})
    assert equivalent_counts(derived(LAYOUTS["differential_with_castor"].text).robot, {"radius": 0.03}) == {}


def test_values_for_c() -> None:
    derivation = derived(LAYOUTS["differential_with_castor"].text)
    header = c_values(derivation.c_module, {"radius": 0.0337, "track": 1.0})
    assert "#define DIFFERENTIAL_WITH_CASTOR_CALIBRATED {.radius = 0.0337, .track = 1.0}" in header
