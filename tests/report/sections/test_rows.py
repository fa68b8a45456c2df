"""The matrices of the report: equal entries once, long ones cut."""

from __future__ import annotations

import pytest

from tests.report.sections.common import keys_written, page_written

ONE = "{name: one, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}"
TWO = "{name: two, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.1}"
OTHER = "{name: two, type: fixed, x: 0, y: 0.4, heading: 0, r: 0.2}"
MANY = [
    f"{{name: w{k}, type: fixed, x: 0, y: {k / 10}, heading: 0, r: {0.1 + k / 100:.2f}}}" for k in range(14)
]


def robot(wheels: list[str]) -> str:
    return "wmrgen: 1\nname: sample\nwheels:\n" + "".join(f"  - {w}\n" for w in wheels)


def page(wheels: list[str]) -> str:
    return page_written(robot(wheels))


@pytest.mark.parametrize(
    ("wheels", "shown"),
    [
        ([ONE], r"J_2 = \mathrm{diag}\left(0.1\right)"),
        ([ONE, TWO], r"J_2 = 0.1\,I_{2}"),
        ([ONE, OTHER], r"J_2 = \mathrm{diag}\left(0.1, 0.2\right)"),
        (MANY[:12], r"0.2, 0.21\right)"),
        (MANY[:13], r"0.2, 0.21, \ldots\right)"),
    ],
)
def test_radii_of_j2(wheels: list[str], shown: str) -> None:
    assert shown in page(wheels)


def test_matrices_of_many_rows_are_cut() -> None:
    """After twelve."""
    for count in (12, 13):
        rows = page(MANY[:count]).partition("J_1 =")[2].partition("J_2 =")[0]
        assert (r"\vdots" in rows) == (count > 12)


def test_what_there_is_not_is_said() -> None:
    fixed = keys_written(robot([ONE]))
    assert "matrices.no_steered" in fixed and "matrices.no_fixed" not in fixed
    steered = keys_written(robot([ONE.replace("fixed", "steered")]))
    assert "matrices.no_fixed" in steered and "matrices.no_steered" not in steered
