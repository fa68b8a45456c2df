"""Integrals of the wheel angles: what the only motions of a robot reach."""

from __future__ import annotations

import pytest

from wmrgen.functions.models.integrals import _reachable
from wmrgen.geometry.exact.number import ZERO, Exact


def test_of_a_gradient_counts_what_lies_along_the_only_line() -> None:
    """(1, 2) along (3, 4): (3 + 8)/25 of it."""
    line = (Exact(3), Exact(4), ZERO)
    assert dict(_reachable((1.0, 2.0), [line])) == pytest.approx({"x_body": 33 / 25, "y_body": 44 / 25})


def test_where_every_direction_is_reached_the_gradient_stays() -> None:
    lines = [(Exact(3), Exact(4), ZERO), (Exact(1), ZERO, ZERO)]
    assert dict(_reachable((1.0, 2.0), lines)) == {"x_body": 1.0, "y_body": 2.0}
