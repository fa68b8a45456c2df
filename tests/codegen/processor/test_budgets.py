"""Budgets: measured on the emulated Cortex-M4F, reproducible, and any growth is reported."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import pytest

from benchmarks import budgets
from benchmarks.budgets import Budget, check, growth, measure, update
from tests.robots import of_gallery
from wmrgen.derivation.artifacts import differences, write_tree
from wmrgen.derivation.manifest import BUDGET


@pytest.fixture(scope="module")
def measured() -> dict[str, Budget]:
    return measure([of_gallery(name).c_module for name in ("lekiwi", "kuka_youbot", "bicycle")])


def test_what_is_measured(measured: dict[str, Budget]) -> None:
    function = measured["lekiwi"]["functions"]["forward"]
    assert function["operations"] == {"additions": 4, "multiplications": 4}
    assert function["stack"] == 0 and function["calls"] == {}
    assert 12 <= function["instructions"] <= 18
    assert 4 * function["instructions"] <= function["text"] + 4 * 8
    assert measured["lekiwi"]["text"] >= sum(f["text"] for f in measured["lekiwi"]["functions"].values())


def test_the_same_every_time(measured: dict[str, Budget]) -> None:
    again = measure([of_gallery(name).c_module for name in measured])
    assert json.dumps(again) == json.dumps(measured)


def test_update_then_check(measured: dict[str, Budget], tmp_path: Path) -> None:
    assert [line.partition(": ")[2] for line in check(measured, tmp_path)] == ["no budget"] * 3
    assert update(measured, tmp_path) == 3
    assert update(measured, tmp_path) == 0
    assert check(measured, tmp_path) == []


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda b: b["functions"]["forward"].update(instructions=0), "forward: instructions 0 -> "),
        (lambda b: b["functions"]["forward"].update(text=1), "forward: text 1 -> "),
        (lambda b: b["functions"]["odometry"].update(stack=-1), "odometry: stack -1 -> "),
        (lambda b: b["functions"]["inverse"]["operations"].pop("additions"), "inverse: additions 0 -> "),
        (lambda b: b["functions"].pop("inverse"), "inverse has no budget"),
        (lambda b: b.update(text=7), "text 7 -> "),
        (lambda b: b.update(compiler="another"), "measured with another"),
        (lambda b: b.update(format=0), "measured with"),
    ],
)
def test_growth_is_reported(measured: dict[str, Budget], change: object, told: str) -> None:
    now = measured["lekiwi"]
    was = copy.deepcopy(now)
    assert growth(was, now) == []
    assert callable(change)
    change(was)
    assert any(line.startswith(told) for line in growth(was, now))


def test_a_decrease_is_not_reported(measured: dict[str, Budget]) -> None:
    was = copy.deepcopy(measured["lekiwi"])
    was["functions"]["forward"]["instructions"] += 1
    was["functions"]["gone"] = was["functions"]["forward"]
    assert growth(was, measured["lekiwi"]) == []


def test_the_check_fails_and_says_what_to_do(
    measured: dict[str, Budget], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(budgets, "gallery", list)
    monkeypatch.setattr(budgets, "measure", lambda modules: measured)
    monkeypatch.setattr(budgets, "check", lambda found: ["lekiwi: no budget"])
    lines: list[str] = []
    with pytest.raises(SystemExit) as caught:
        lines.extend(budgets.run(False))
    assert caught.value.code == 1


def test_derive_keeps_budget_files(tmp_path: Path) -> None:
    """`derive` does not measure. The file belongs to `benchmarks`, and `check` does not report it as unknown."""
    place = tmp_path / "robot"
    write_tree(place, {"a.c": b"1"})
    (place / BUDGET).write_bytes(b"{}")
    assert differences(place, {"a.c": b"1"}) == []
    assert write_tree(place, {"a.c": b"2"}).removed == ()
    assert (place / BUDGET).read_bytes() == b"{}"
    (place / "other.json").write_bytes(b"{}")
    assert [d.path.name for d in differences(place, {"a.c": b"2"})] == ["other.json"]


@pytest.mark.parametrize(
    ("robot", "fit", "most"), [("pioneer3dx", "forward", 400), ("wpilib_swervebot", "forward_slip", 1200)]
)
def test_the_loop_with_covariance(robot: str, fit: str, most: int) -> None:
    """The budget of a control step, from measured joints to commands, includes counters."""
    budget = budgets.read(budgets.GENERATED / robot / BUDGET)
    assert budget is not None
    loop = ("joints_from_counts", fit, "forward_covariance", "odometry_covariance", "limit_twist",
            "limit_acceleration", "inverse", "desaturate")  # fmt: skip
    assert 300 < sum(budget["functions"][name]["instructions"] for name in loop) <= most
