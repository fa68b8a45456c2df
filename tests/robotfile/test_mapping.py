"""Robots given as mappings and as texts: the same robot, the same checks, places that are paths of keys."""

from __future__ import annotations

import copy
import math
import subprocess
import sys
from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest
import yaml

import wmrgen
from tests.robots import ROBOTS
from wmrgen.errors import Code

PAIR: dict[str, object] = {
    "wmrgen": 1,
    "name": "pair",
    "parameters": {"half": 0.2, "r": {"value": "50 mm", "tunable": True}},
    "wheels": [
        {"name": "left", "type": "fixed", "x": 0, "y": "half", "heading": 0, "r": "r"},
        {"name": "right", "type": "fixed", "x": 0, "y": "-half", "heading": "0 deg", "r": "r"},
    ],
}


def with_value(path: str, value: object) -> dict[str, object]:
    """PAIR with another value at a path such as ``wheels.0.r``."""
    changed = copy.deepcopy(PAIR)
    *keys, last = path.split(".")
    place: object = changed
    for key in keys:
        place = place[int(key)] if isinstance(place, list) else place[key]  # type: ignore[index]
    place[int(last) if isinstance(place, list) else last] = value  # type: ignore[index]
    return changed


@pytest.mark.parametrize("name", ROBOTS)
def test_a_mapping_is_the_robot_of_the_file(name: str) -> None:
    """PyYAML reads the texts of the file, `load` the mapping of them."""
    text = ROBOTS[name].read_text(encoding="utf-8")
    mapping = yaml.load(text, Loader=yaml.BaseLoader)  # every value a text, as the file has it
    of_file, of_text, of_mapping = wmrgen.load(ROBOTS[name]), wmrgen.load(text), wmrgen.load(mapping)
    assert of_file.wheels == of_text.wheels == of_mapping.wheels
    assert of_file.parameters == of_text.parameters == of_mapping.parameters
    assert of_file.limits == of_mapping.limits and of_file.couplings == of_mapping.couplings


def test_numbers_are_the_decimals_that_are_written() -> None:
    half, r = wmrgen.load(with_value("parameters.r", Fraction(1, 30))).parameters
    assert (half.nominal, r.nominal) == (Fraction(1, 5), Fraction(1, 30))
    assert wmrgen.load(with_value("parameters.half", np.float64(0.165))).parameters[0].nominal == Fraction(
        33, 200
    )
    assert wmrgen.load(with_value("parameters.half", 1e-3)).parameters[0].nominal == Fraction(1, 1000)
    assert wmrgen.load(with_value("wheels.0.actuated", ())).wheel("left").actuated == ()


@pytest.mark.parametrize(
    ("path", "value", "place", "code"),
    [
        ("wheels.1.r", 0, "wheels[1].r", Code.VALUE),
        ("wheels.0.y", "hlf", "wheels[0].y", Code.UNDECLARED),
        ("wheelz", [], "wheelz", Code.UNKNOWN_KEY),
        ("parameters.half", math.nan, "parameters.half", Code.FORM),
        ("parameters.half", math.inf, "parameters.half", Code.FORM),
        ("parameters.half", None, "parameters.half", Code.FORM),
        ("parameters.half", object(), "parameters.half", Code.FORM),
        ("parameters.half", b"0.2", "parameters.half", Code.FORM),
        ("wheels.0.type", "fxed", "wheels[0].type", None),
        ("wheels.0", "left", "wheels[0]", None),
        ("name", "pa\u202eir", "name", Code.FORM),
        ("description", "x" * 300_000, "description", Code.FORM),
        ("limits", {"vx": {1: 2}}, "limits.vx", Code.FORM),
        ("wheels.0.α", 1, "wheels[0].α", None),
    ],
)
def test_errors_name_the_keys(path: str, value: object, place: str, code: Code | None) -> None:
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load(with_value(path, value))
    places = [str(error.mark) for error in caught.value.parts]
    assert place in places and f"--> {place}\n" in str(caught.value) + "\n"
    assert code is None or code in {error.code for error in caught.value.parts}


def test_a_mapping_that_holds_itself_ends_in_an_error() -> None:
    endless: dict[str, object] = dict(PAIR)
    endless["wheels"] = [endless]
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load(endless)
    assert caught.value.code == Code.FORM and caught.value.mark.path.startswith("wheels[0].wheels[0].")


def test_a_mapping_without_end_ends_in_an_error() -> None:
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load({**PAIR, "wheels": [{"name": "a"}] * 30_000})
    assert caught.value.code == Code.FORM and "20000" in caught.value.what


@pytest.mark.parametrize("value", [{}, {"wmrgen": 1}])
def test_what_is_missing_is_said(value: Mapping[str, object]) -> None:
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load(value)
    assert {error.code for error in caught.value.parts} == {Code.MISSING}


def test_errors_of_a_text_have_lines() -> None:
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load(f"wmrgen: 1\nname: {'x' * 40}\nwheels: []\n")
    mark = caught.value.parts[0].mark
    assert mark and (mark.line, mark.column) == (2, 7)


def test_a_text_without_a_line_break_is_a_path() -> None:
    with pytest.raises(wmrgen.RobotFileError) as caught:
        wmrgen.load("no_such_file.yaml")
    assert caught.value.code == Code.FILE


def test_the_public_names_are_listed_and_nothing_is_imported() -> None:
    program = (
        "import sys, wmrgen; names = dir(wmrgen); "
        "assert {'load', 'derive', 'Derivation', 'Robot', 'RobotFileError', 'NotDerivableError'} <= set(names); "
        "assert set(names) == set(wmrgen.__all__); "
        "loaded = {'sympy', 'casadi', 'numpy', 'yaml', 'mpmath'} & set(sys.modules); assert not loaded, loaded; "
        "assert all(hasattr(wmrgen, name) for name in names) and not hasattr(wmrgen, 'nothing')"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
