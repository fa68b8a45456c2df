"""Words of the command line as exact numbers: units that robot files have no use for."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from wmrgen.cli.values import from_option, from_words
from wmrgen.errors import UsageError
from wmrgen.geometry.exact.number import Exact
from wmrgen.geometry.ports import Port, Role


def read(text: str, unit: str) -> Exact:
    """The value of an input q in ``unit``."""
    return from_words([f"q={text}"], [Port("q", Role.COMMAND, unit, "an input")])["q"]


@pytest.mark.parametrize("unit", ["s", "m/s^2", "m/s^3", "rad/s^2", "rad/s^3", "1/m", "1/s"])
@pytest.mark.parametrize(("text", "value"), [("2.3", Fraction(23, 10)), ("3", 3), ("-4.", -4), ("(2)", 2)])
def test_a_number_may_have_the_unit_of_its_input(text: str, value: Fraction | int, unit: str) -> None:
    assert read(text, unit) == value
    assert read(f"{text} {unit} ", unit) == value
    assert read(f"{text}  {unit}", unit) == value


@pytest.mark.parametrize("unit", ["s", "m/s^2", "rad/s^3"])
def test_a_unit_may_follow_at_once_where_no_digit_begins_it(unit: str) -> None:
    assert read(f"2.3{unit}", unit) == Fraction(23, 10)


def test_a_unit_that_begins_with_a_digit_needs_a_space() -> None:
    for text in ("2.31/m", "21/m"):
        with pytest.raises(UsageError):
            read(text, "1/m")


@pytest.mark.parametrize(("text", "unit"), [("2 m", "s"), ("2 rad", "1/m"), ("2.s", "m/s^2"), ("2 µs", "s")])
def test_another_unit_is_refused_by_name(text: str, unit: str) -> None:
    with pytest.raises(UsageError) as caught:
        read(text, unit)
    assert unit in caught.value.what and repr(text) in caught.value.what


def test_lengths_and_angles_have_the_units_of_robot_files() -> None:
    assert read("30 cm", "m") == Fraction(3, 10)
    assert read("2 mm/s", "m/s") == Fraction(2, 1000)
    assert float(read("180 deg", "rad")) == pytest.approx(3.141592653589793, rel=1e-15)


def test_numbers_that_another_program_prints_are_taken_as_far_as_floats_go() -> None:
    assert read("1e-200", "s") == Fraction(1, 10**200)
    assert float(read("-1.5e308", "s")) == -1.5e308
    with pytest.raises(UsageError) as caught:
        read("2e308", "s")
    assert "'2e308'" in caught.value.what


@pytest.mark.parametrize("unit", ["m/s", "s", "rad"])
def test_a_word_is_no_number_and_cannot_be_declared(unit: str) -> None:
    with pytest.raises(UsageError) as caught:
        read("fast", unit)
    assert "'fast'" in caught.value.what and f"q='0.5 {unit}'" in caught.value.what
    assert "parameters:" not in caught.value.what


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("500 ms", "s", Fraction(1, 2)),
        ("2 deg/s^2", "rad/s^2", None),
        ("3 m/s^2", "m/s^2", 3),
        ("7ms", "s", Fraction(7, 1000)),
    ],
)
def test_times_and_accelerations_have_the_units_of_robot_files(
    text: str, unit: str, value: Fraction | int | None
) -> None:
    found = read(text, unit)
    assert found == value if value is not None else float(found) == pytest.approx(math.radians(2), rel=1e-15)


TIME, LENGTH = Port("time", Role.COMMAND, "s"), Port("x", Role.COMMAND, "m")


def test_an_option_has_numbers_with_units() -> None:
    assert from_option("--time", "500 ms", [TIME]) == [Fraction(1, 2)]
    assert from_option("--move", "2 s, -3 cm", [TIME, LENGTH]) == [2, Fraction(-3, 100)]


@pytest.mark.parametrize("text", ["", " ", "1,2", "fast", "2 m", "2 min", "1e999", "nan"])
def test_messages_about_an_option_name_it_as_the_user_writes_it(text: str) -> None:
    with pytest.raises(UsageError) as caught:
        from_option("--time", text, [TIME])
    what = caught.value.what
    assert what.startswith("--time ") and "time=" not in what and ".." not in what


@pytest.mark.parametrize("text", ["1", "1,2,3", "1,", "1,fast"])
def test_an_option_takes_as_many_numbers_as_it_has_quantities(text: str) -> None:
    with pytest.raises(UsageError) as caught:
        from_option("--move", text, [TIME, LENGTH])
    assert caught.value.what.startswith("--move")
