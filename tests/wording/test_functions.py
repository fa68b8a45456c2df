"""Messages of functions: each names the robot or the part, is one paragraph with a cure, and has no loose ends."""

from __future__ import annotations

import re

import pytest

from tests.robots import ROBOTS, of_gallery
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import UnderivableError, names

SOME = ("pioneer3dx", "wpilib_swervebot", "ackermann_car", "synchro_drive")


@pytest.mark.parametrize("name", [n for n in ROBOTS if n in SOME])
def test_a_refusal_names_the_robot_and_the_reason(name: str) -> None:
    """Every function that a robot of the gallery cannot have: its message renders and says of what and why."""
    d, refusals = of_gallery(name), 0
    for function in names():
        try:
            d.formula(function)
        except NotDerivableError as error:
            refusals += 1
            first, *cures = error.what.split("\n")
            assert name in first and len(error.what.split()) > 6, function
            assert not re.search(r"\{[A-Za-z_.]+\}", error.what), "a text that was to be an f-string"
            assert "None" not in error.what and "  " not in first
            assert all(cure.startswith("  ") and cure.strip() for cure in cures)
            assert str(error).startswith(f"error[{error.code}]: ")
            if isinstance(error, UnderivableError):
                assert error.reason.value
    assert refusals > 3


@pytest.mark.parametrize("name", [n for n in ROBOTS if n in SOME])
def test_a_description_is_one_line_without_a_full_stop(name: str) -> None:
    d = of_gallery(name)
    for formula in d.program.formulas:
        assert "\n" not in formula.text and formula.text and not formula.text.endswith("."), formula.name
        for port in (*formula.inputs, *(port for port, _ in formula.outputs)):
            assert "\n" not in port.text and not port.text.endswith("."), (formula.name, port.name)
