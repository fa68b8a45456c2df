"""What logs determine: directions, the names in them, and how far apart clocks are."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from wmrgen.tools.calibration.observability import WEAK, clock_spread, groups, split

NAMES = ("a", "b", "c")
PROBLEM: Any = SimpleNamespace(origin=np.zeros(6))  # three parameters and the mount


def vector(**parts: float) -> np.ndarray:
    every = (*NAMES, "x", "y", "theta")
    result = np.array([parts.get(name, 0.0) for name in every])
    return result / np.linalg.norm(result)


def test_directions_are_split_by_their_deviation() -> None:
    sigmas = np.array([0.1, 0.9, 1.1, 0.01, 0.5, 2.0]) * WEAK
    rotation = np.linalg.qr(np.random.default_rng(2).standard_normal((6, 6)))[0]
    kept, weak = split(rotation @ np.diag(sigmas**2) @ rotation.T, np.eye(6))
    assert kept.shape == (6, 4) and weak.shape == (6, 2)
    assert kept.T @ kept == pytest.approx(np.eye(4), abs=1e-12)
    assert kept.T @ weak == pytest.approx(np.zeros((4, 2)), abs=1e-12)
    assert weak @ weak.T == pytest.approx(rotation[:, [2, 5]] @ rotation[:, [2, 5]].T, abs=1e-12)


def test_directions_that_were_not_estimated_are_in_neither() -> None:
    free = np.eye(6)[:, :3]
    kept, weak = split(np.diag([1e-6, 1.0, 1e-6, 1.0, 1.0, 1.0]), free)
    assert np.abs(kept) == pytest.approx(np.eye(6)[:, [0, 2]]) and np.abs(weak) == pytest.approx(
        np.eye(6)[:, [1]]
    )


@pytest.mark.parametrize(
    ("directions", "named"),
    [
        ([], []),
        ([vector(a=1)], [{"a"}]),
        ([vector(a=1, b=-1)], [{"a", "b"}]),
        ([vector(a=1, b=0.1)], [{"a"}]),  # small parts are not named
        ([vector(a=1), vector(b=1)], [{"a"}, {"b"}]),
        ([vector(a=1, b=1), vector(a=1, b=-1)], [{"a"}, {"b"}]),  # the same two directions, turned
        ([vector(a=1, b=1, c=1), vector(x=1)], [{"a", "b", "c"}, {"mount.x"}]),
        ([vector(theta=1, c=-1)], [{"mount.theta", "c"}]),
    ],
)
def test_groups_name_what_is_open(directions: list[np.ndarray], named: list[set[str]]) -> None:
    columns = np.array(directions).reshape(-1, 6).T
    found = [set(group) for group in groups(PROBLEM, NAMES, columns)]
    assert sorted(found, key=sorted) == sorted(named, key=sorted)


def test_groups_do_not_depend_on_the_basis() -> None:
    basis = np.array([vector(a=1, b=1), vector(c=1, x=1)]).T
    turned = basis @ np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    one, other = ({frozenset(group) for group in groups(PROBLEM, NAMES, b)} for b in (basis, turned))
    assert one == other == {frozenset({"a", "b"}), frozenset({"c", "mount.x"})}


@pytest.mark.parametrize(("apart", "error"), [(0.3, 0.02), (0.1, 0.02), (0.1, 0.1), (0.0, 0.05), (0.0, 0.3)])
def test_the_spread_of_clocks_is_found_back(apart: float, error: float) -> None:
    """Of 2000 logs, whose errors are unequal."""
    random = np.random.default_rng(7)
    errors = error * random.uniform(0.5, 2, 2000)
    offsets = apart * random.standard_normal(2000) + errors * random.standard_normal(2000)
    found = clock_spread(np.column_stack([offsets, errors]))
    assert found == pytest.approx(apart, rel=0.15, abs=0.25 * error)
