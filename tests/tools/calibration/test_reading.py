"""Logs and their reference poses: what is read of each column, and what is refused, with file, line and numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from tests.tools.calibration.simulated import Reals, csv
from wmrgen.errors import UsageError
from wmrgen.tools.calibration.logs import Log, check
from wmrgen.tools.calibration.reading import Recording, read, recordings

T = np.arange(0, 40.05, 0.1)
LEFT = 2 * T + np.sin(T)
LOG = {"t": T, "left.angle": LEFT / 4, "right.angle": -T}
POSES = {"t": T[::5], "x": 0.1 * T[::5], "y": 0 * T[::5], "theta": np.sin(T[::5])}
JOINTS = ("left.spin", "right.spin")


def log_of(
    folder: Path,
    log: Mapping[str, Reals],
    poses: Mapping[str, Reals] = POSES,
    joints: tuple[str, ...] = JOINTS,
    turns: Mapping[str, float] = MappingProxyType({}),
    change: Callable[[str], str] = str,
) -> Log:
    """Write a log and its reference poses, and read both."""
    (folder / "run.csv").write_text(change(csv(dict(log))), encoding="utf-8")
    (folder / "true.csv").write_text(csv(dict(poses)), encoding="utf-8")
    return check(read(Recording("run", folder / "run.csv", folder / "true.csv"), joints, turns))


def test_each_column_gives_its_increments(tmp_path: Path) -> None:
    """Angles and counts by differences, rates by trapezoids, steering angles by means and differences without wraps."""
    steer = 0.3 * T  # beyond a whole turn
    wrapped = (steer + np.pi) % (2 * np.pi) - np.pi
    log = {"t": T, "a.angle": LEFT, "b.counts": LEFT * 400 / (2 * np.pi), "c.spin": 1 + T, "d.steer": wrapped}
    joints = ("a.spin", "b.spin", "c.spin", "d.steer", "d.steer_rate")
    columns = log_of(tmp_path, log, joints=joints, turns={"b.spin": 400.0}).columns
    assert tuple(columns) == joints
    np.testing.assert_allclose(columns["a.spin"], np.diff(LEFT), atol=1e-6)
    np.testing.assert_allclose(columns["b.spin"], np.diff(LEFT), atol=1e-6)
    np.testing.assert_allclose(columns["c.spin"], np.diff(T + T**2 / 2), atol=1e-6)
    np.testing.assert_allclose(columns["d.steer"], (steer[1:] + steer[:-1]) / 2, atol=1e-6)
    np.testing.assert_allclose(columns["d.steer_rate"], np.diff(steer), atol=1e-6)


def at(row: int, column: str, value: float) -> dict[str, Reals]:
    """Return the log with another number in a row."""
    changed = {name: values.copy() for name, values in LOG.items()}
    changed[column][row] = value
    return changed


def cut(first: int, last: int) -> dict[str, Reals]:
    """Return the log without the readings between two rows."""
    return {name: np.concatenate([values[: first + 1], values[last:]]) for name, values in LOG.items()}


def timed(log: Mapping[str, Reals], change: Callable[[Reals], Reals]) -> dict[str, Reals]:
    return {**log, "t": change(log["t"])}


def without(log: Mapping[str, Reals], *names: str) -> dict[str, Reals]:
    return {name: values for name, values in log.items() if name not in names}


def wrapping(step: float) -> dict[str, Reals]:
    """Return angles that restart at 0 after each turn, of a wheel that turns by ``step`` in a step."""
    return {**LOG, "left.angle": step * np.arange(len(T)) * (1 + T / 1e4) % (2 * np.pi)}


def cell(text: str, new: str) -> Callable[[str], str]:
    return lambda s: s.replace(text, new, 1)


# The change of the text, the place of the error, and what the message names.
TEXTS: dict[str, tuple[Callable[[str], str], str, tuple[str, ...]]] = {
    "nan": (cell(",-0.7\n", ",nan\n"), "run.csv:9", ("right.angle",)),
    "a word": (cell("\n1,", "\nabc,"), "run.csv:12", ("'abc'", "t")),
    "too few cells": (cell("\n1,", "\n"), "run.csv:12", ("2", "3")),
    "one row": (lambda s: "\n".join(s.split("\n")[:2]), "run.csv", ("1",)),
    "a header alone": (lambda s: s.split("\n")[0], "run.csv", ("0",)),
    "an empty cell": (cell("\n1,", "\n ,"), "run.csv:12", ("t", "' '")),
    "a name like t": (cell("t,", "Time [s],"), "run.csv:1", ("t", "Time [s] meant")),
    "no name like t": (cell("t,", "tick,"), "run.csv:1", ("t", "tick,left.angle,right.angle")),
    "no header": (lambda s: s.split("\n", 1)[1], "run.csv:1", ("0,0,-0", "the first row")),
    "a comment above the header": (lambda s: "# drive 3\n" + s, "run.csv:1", ("# drive 3", "comment")),
    "decimal commas": (
        lambda s: s.split("\n")[0] + "\n" + s.split("\n", 1)[1].replace(".", ","), "run.csv:3", ("6", "3", "points"),
    ),
    "quoted decimal commas": (cell("\n0.1,", '\n"0,1",'), "run.csv:3", ("t", "'0,1'", "points")),
    "blanks": (lambda s: s.replace(",", " "), "run.csv:1", ("t left.angle right.angle", "commas")),
    "empty": (lambda s: "", "run.csv:1", ("t",)),
    "semicolons": (
        lambda s: s.replace(",", ";").replace(".", ","), "run.csv:1", ("t;left,angle;right,angle", "commas"),
    ),
    "a comma too many": (lambda s: s.replace("\n", ",\n"), "run.csv:1", ("t,left.angle,right.angle,",)),
    "twice": (cell("right", "left"), "run.csv:1", ("t,left.angle,left.angle",)),
}  # fmt: skip
# The log, its reference poses, the place of the error, and what the message names.
TABLES: dict[str, tuple[Mapping[str, Reals], Mapping[str, Reals], str, tuple[str, ...]]] = {
    "infinite": (LOG, {**POSES, "y": np.where(T[::5] > 20.4, np.inf, 0)}, "true.csv:43", ("y", "inf")),
    "unsorted": (at(10, "t", 0.5), POSES, "run.csv:12", ("t", "0.5", "0.9")),
    "a double": (at(10, "t", 0.9), POSES, "run.csv:12", ("t", "0.9")),
    "misspelt": (
        {"lft.angle" if name == "left.angle" else name: values for name, values in LOG.items()}, POSES,
        "run.csv", ("left.angle", "left.counts", "left.spin", "lft.angle meant"),
    ),
    "missing": ({"t": T, "w": T}, POSES, "run.csv", ("left.angle", "left.counts", "left.spin", "t, w")),
    "counts": (
        {**without(LOG, "left.angle"), "left.counts": LEFT}, POSES, "run.csv", ("left.counts", "encoder:"),
    ),
    "no pose": (LOG, {"t": T, "z": T}, "true.csv", ("x", "y", "theta", "t, z")),
    "a yaw": (LOG, {**without(POSES, "theta"), "yaw": T[::5]}, "true.csv", ("yaw", "theta")),
    "a quaternion": (
        LOG, {**without(POSES, "theta"), **{f"orientation.{axis}": T[::5] for axis in "zw"}},
        "true.csv", ("orientation.z, orientation.w", "atan2"),
    ),
    "a quaternion's letters": (
        LOG, {**without(POSES, "theta"), "qz": T[::5], "qw": T[::5]}, "true.csv", ("qw", "atan2"),
    ),
    "one pose": (LOG, {"t": T, "x": np.where(T < 0.05, 0.0, np.nan)}, "run", ("x", "y", "theta", "twice")),
    "milliseconds": (timed(LOG, lambda t: 1000 * t), POSES, "run.csv", ("100 s", "milliseconds")),
    "both in milliseconds": (
        timed(LOG, lambda t: 1000 * t), timed(POSES, lambda t: 1000 * t), "run.csv", ("100 s", "milliseconds"),
    ),
    "both in nanoseconds": (
        timed(LOG, lambda t: 1e9 * t), timed(POSES, lambda t: 1e9 * t), "run.csv", ("1e+08 s", "seconds"),
    ),
    "a time that is missing": (LOG, {**POSES, "t": np.where(T[::5] == 5, np.nan, T[::5])}, "true.csv:12", ("t", "nan")),
    "before": (timed(LOG, lambda t: t - 40.1), POSES, "true.csv", ("0 to 40", "-40.1 to -0.1", "run.csv")),
    "after": (timed(LOG, lambda t: t + 40.1), POSES, "true.csv", ("0 to 40", "40.1 to 80.1", "run.csv")),
    "a gap": (cut(100, 121), POSES, "run.csv:103", ("2.1 s", "t = 10,", "0.1 s")),
    "a restart": (
        {**LOG, "left.angle": LEFT / 4 + 3.1 * (T > 9.95)}, POSES, "run.csv:102", ("left.angle", "3.128", "0.068"),
    ),
    "a wrap": (wrapping(0.3), POSES, "run.csv:23", ("left.angle", "-5.983", "0.3")),
    "a wrap in degrees": (
        {**LOG, "left.angle": np.degrees(wrapping(0.3)["left.angle"])}, POSES, "run.csv:23", ("-342.8", "17"),
    ),
    "counts of 16 bits": (
        {**without(LOG, "left.angle"), "left.counts": 1000 * np.arange(len(T)) % 65536}, POSES,
        "run.csv:68", ("left.counts", "-6.454e+04", "1e+03"),
    ),
    "a fast wheel that wraps": (wrapping(1.1), POSES, "run.csv:8", ("left.angle", "-5.183", "1.1")),
}  # fmt: skip


@pytest.mark.parametrize("case", [*TEXTS, *TABLES])
def test_refused(tmp_path: Path, case: str) -> None:
    if case in TEXTS:
        change, place, named = TEXTS[case]
        log, poses = LOG, POSES
    else:
        log, poses, place, named = TABLES[case]
        change = str
    with pytest.raises(UsageError) as refusal:
        log_of(tmp_path, log, poses, change=change, turns={"left.spin": -4000.0} if "bits" in case else {})
    what = refusal.value.what.replace(f"{tmp_path}/", "")
    assert re.match(rf"{re.escape(place)}(?![:\d])|{re.escape(place)}: ", what), what
    for part in named:
        assert part in what.removeprefix(place)


@pytest.mark.parametrize(
    ("log", "poses"),
    [
        pytest.param(cut(100, 119), POSES, id="almost a gap"),
        pytest.param(timed(LOG, lambda t: t - 39.9), POSES, id="just before"),
        pytest.param(timed(LOG, lambda t: t + 39.9), POSES, id="just after"),
        pytest.param(LOG, without(POSES, "x", "y"), id="headings"),
        pytest.param(LOG, {"t": T, "theta": np.where(T < 0.15, T, np.nan)}, id="two of them"),
        pytest.param(timed(LOG, lambda t: 49 * t), timed(POSES, lambda t: 49 * t), id="slow"),
        pytest.param(LOG, {"t": T[:3], "x": T[:3]}, id="short"),
        pytest.param({**LOG, "left.angle": LEFT + 2.6 * (T > 20)}, POSES, id="a small jump"),
    ],
)
def test_accepted(tmp_path: Path, log: Mapping[str, Reals], poses: Mapping[str, Reals]) -> None:
    assert len(log_of(tmp_path, log, poses).t) == len(log["t"])


def test_a_text_in_other_bytes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(csv(LOG), encoding="utf-16")
    with pytest.raises(UsageError, match=r"run\.csv: .*UTF-8"):
        read(Recording("run", tmp_path / "run.csv", tmp_path / "true.csv"), JOINTS, {})


def test_empty_lines_of_a_log_and_empty_cells_of_a_reference(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(
        "\ufefft , left.angle,right.angle\n0,0,0\n1,1,1\n\n2,3,5\n", encoding="utf-8"
    )
    (tmp_path / "true.csv").write_text("t,x,theta\n0,,1\n1, ,\n2,7,3\n", encoding="utf-8")
    log = read(Recording("run", tmp_path / "run.csv", tmp_path / "true.csv"), JOINTS, {})
    assert log.t.tolist() == [0, 1, 2] and log.columns["right.spin"].tolist() == [1, 4]
    assert np.isfinite(log.poses.x).tolist() == [False, False, True] and log.poses.measured == 2
    assert log.name == "run" and np.isnan(log.poses.y).all()


def test_each_log_has_the_reference_beside_it_or_the_next_that_is_given(tmp_path: Path) -> None:
    """A pattern of the shell gives the references, too: they are no logs."""
    a, b, own, other, third = (tmp_path / f"{n}.csv" for n in ("a", "b", "a.truth", "c", "d"))
    for path in (a, b, own):
        path.write_text("")
    assert recordings([a], []) == recordings([a, own], []) == [Recording("a", a, own)]
    assert recordings([a, b], [other, third]) == [Recording("a", a, other), Recording("b", b, third)]
    for logs, references, place in (
        ([a, b], [], f"{b}: "),
        ([a], [other, third], ""),
        ([third], [], f"{third}: "),
    ):
        with pytest.raises(UsageError) as refusal:
            recordings(logs, references)
        assert refusal.value.what.startswith(place)


def test_logs_of_one_name_are_numbered(tmp_path: Path) -> None:
    logs = [tmp_path / day / f"{name}.csv" for day in "abc" for name in ("run", "turn")]
    for log in logs:
        log.parent.mkdir(exist_ok=True)
        log.write_text("")
    names = [one.name for one in recordings(logs, logs)]
    assert names == ["run", "turn", "run (2)", "turn (2)", "run (3)", "turn (3)"]
