"""Logs and their truths: what is read of each column, and what is refused, with the line and from where on."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest

from tests.tools.calibrating.simulated import Reals, csv
from wmrgen.errors import UsageError
from wmrgen.tools.calibrating.logs import Drive, pairs, read

T = np.arange(0, 40.05, 0.1)
LEFT = 2 * T + np.sin(T)
LOG = {"t": T, "left.angle": LEFT / 4, "right.angle": -T}
TRUTH = {"t": T[::5], "x": 0.1 * T[::5], "y": 0 * T[::5], "theta": np.sin(T[::5])}
JOINTS = ("left.spin", "right.spin")


def drive(
    folder: Path,
    log: Mapping[str, Reals],
    truth: Mapping[str, Reals] = TRUTH,
    joints: tuple[str, ...] = JOINTS,
    turns: Mapping[str, float] = MappingProxyType({}),
    change: Callable[[str], str] = str,
) -> Drive:
    (folder / "run.csv").write_text(change(csv(dict(log))), encoding="utf-8")
    (folder / "true.csv").write_text(csv(dict(truth)), encoding="utf-8")
    return read(folder / "run.csv", folder / "true.csv", joints, turns)


def test_each_column_gives_its_increments(tmp_path: Path) -> None:
    """Angles and counts by differences, rates by trapezoids, steering angles by means and differences without wraps."""
    steer = 0.3 * T  # beyond a whole turn
    wrapped = (steer + np.pi) % (2 * np.pi) - np.pi
    log = {"t": T, "a.angle": LEFT, "b.counts": LEFT * 400 / (2 * np.pi), "c.spin": 1 + T, "d.steer": wrapped}
    joints = ("a.spin", "b.spin", "c.spin", "d.steer", "d.steer_rate")
    columns = drive(tmp_path, log, joints=joints, turns={"b.spin": 400.0}).columns
    assert tuple(columns) == joints
    np.testing.assert_allclose(columns["a.spin"], np.diff(LEFT), atol=1e-6)
    np.testing.assert_allclose(columns["b.spin"], np.diff(LEFT), atol=1e-6)
    np.testing.assert_allclose(columns["c.spin"], np.diff(T + T**2 / 2), atol=1e-6)
    np.testing.assert_allclose(columns["d.steer"], (steer[1:] + steer[:-1]) / 2, atol=1e-6)
    np.testing.assert_allclose(columns["d.steer_rate"], np.diff(steer), atol=1e-6)


def at(row: int, column: str, value: float) -> dict[str, Reals]:
    changed = {name: values.copy() for name, values in LOG.items()}
    changed[column][row] = value
    return changed


def cut(first: int, last: int) -> dict[str, Reals]:
    """A log without the readings between two."""
    return {name: np.concatenate([values[: first + 1], values[last:]]) for name, values in LOG.items()}


def timed(log: Mapping[str, Reals], change: Callable[[Reals], Reals]) -> dict[str, Reals]:
    return {**log, "t": change(log["t"])}


def without(log: Mapping[str, Reals], *names: str) -> dict[str, Reals]:
    return {name: values for name, values in log.items() if name not in names}


def wrapping(radius: float) -> dict[str, Reals]:
    """Angles that begin again at 0 after each turn, of a wheel that turns by ``radius`` in a step."""
    return {**LOG, "left.angle": radius * np.arange(len(T)) * (1 + T / 1e4) % (2 * np.pi)}


HEADER = "run.csv:1: the header has no column t [s]; it reads "
NO_COLUMN = "run.csv:1: there is no column left.angle or left.counts or left.spin; the header has t, "
MEND = ": delete or mend that row"
SORT = "; sort the rows, and leave doubles out"
COMMAS = ": write commas between columns, and points in numbers"
CUT = ", or the other file cut short? t is in seconds"
CLOCK = ": they do not overlap; both need one clock, up to a second"
WHOLE = ": readings have to be cumulative, without wrapping or restarts"
UNREAD = " would be left unread: write the heading as theta [rad]"
TURN = ", as what wraps at 2 pi"
CHANGED: dict[str, tuple[Callable[[str], str], str]] = {
    "nan": (lambda s: s.replace(",-0.7\n", ",nan\n"), f"run.csv:9: right.angle is nan{MEND}"),
    "a word": (
        lambda s: s.replace("\n1,", "\nabc,", 1),
        f"run.csv:12: t is 'abc', which is no number{MEND}",
    ),
    "too few cells": (
        lambda s: s.replace("\n1,", "\n", 1),
        "run.csv:12: the row has 2 cells, the header 3",
    ),
    "one row": (
        lambda s: "\n".join(s.split("\n")[:2]),
        "run.csv: at least two rows are needed below the header; it has 1",
    ),
    "a header alone": (
        lambda s: s.split("\n")[0],
        "run.csv: at least two rows are needed below the header; it has 0",
    ),
    "an empty cell": (
        lambda s: s.replace("\n1,", "\n ,", 1),
        f"run.csv:12: t is ' ', which is no number{MEND}",
    ),
    "a name like t": (
        lambda s: s.replace("t,", "Time [s],", 1),
        HEADER + "Time [s],left.angle,right.angle: is Time [s] meant?",
    ),
    "no name like t": (lambda s: s.replace("t,", "tick,", 1), HEADER + "tick,left.angle,right.angle"),
    "no header": (
        lambda s: s.split("\n", 1)[1],
        HEADER + "0,0,-0: the first row has to name the columns",
    ),
    "a comment above the header": (
        lambda s: "# drive 3\n" + s,
        HEADER + "# drive 3: the header has to be the first line, without a comment above it",
    ),
    "decimal commas": (
        lambda s: s.split("\n")[0] + "\n" + s.split("\n", 1)[1].replace(".", ","),
        f"run.csv:3: the row has 6 cells, the header 3{COMMAS}",
    ),
    "quoted decimal commas": (
        lambda s: s.replace("\n0.1,", '\n"0,1",', 1),
        "run.csv:3: t is '0,1', which is no number: write points in numbers",
    ),
    "blanks": (lambda s: s.replace(",", " "), HEADER + f"t left.angle right.angle{COMMAS}"),
    "empty": (lambda s: "", HEADER + "nothing"),
    "semicolons": (
        lambda s: s.replace(",", ";").replace(".", ","),
        HEADER + f"t;left,angle;right,angle{COMMAS}",
    ),
    "a comma too many": (
        lambda s: s.replace("\n", ",\n"),
        "run.csv:1: the last column has no name in t,left.angle,right.angle,: is there a comma too many?",
    ),
    "twice": (
        lambda s: s.replace("right", "left", 1),
        "run.csv:1: a column stands twice in t,left.angle,left.angle",
    ),
}
REFUSED: dict[str, tuple[Mapping[str, Reals], Mapping[str, Reals], str]] = {
    "infinite": (LOG, {**TRUTH, "y": np.where(T[::5] > 20.4, np.inf, 0)}, f"true.csv:43: y is inf{MEND}"),
    "unsorted": (at(10, "t", 0.5), TRUTH, f"run.csv:12: t does not rise: 0.5 after 0.9{SORT}"),
    "a double": (at(10, "t", 0.9), TRUTH, f"run.csv:12: t does not rise: 0.9 after 0.9{SORT}"),
    "misspelt": (
        {"lft.angle" if name == "left.angle" else name: values for name, values in LOG.items()},
        TRUTH,
        NO_COLUMN + "lft.angle, right.angle; is lft.angle meant?",
    ),
    "missing": ({"t": T, "w": T}, TRUTH, NO_COLUMN + "w"),
    "counts": (
        {**without(LOG, "left.angle"), "left.counts": LEFT},
        TRUTH,
        "run.csv: left.counts needs counts per turn: write encoder: of left in the robot file",
    ),
    "no pose": (LOG, {"t": T, "z": T}, "true.csv: none of the columns x, y and theta is there, only t, z"),
    "a yaw": (
        LOG,
        {**without(TRUTH, "theta"), "yaw": T[::5]},
        f"true.csv:1: yaw{UNREAD}, or delete what is no heading",
    ),
    "a quaternion": (
        LOG,
        {**without(TRUTH, "theta"), **{f"orientation.{axis}": T[::5] for axis in "zw"}},
        f"true.csv:1: orientation.z, orientation.w{UNREAD}, which is atan2(2 (w z + x y), 1 - 2 (y^2 + z^2)) of a "
        "quaternion, or delete what is no heading",
    ),
    "a quaternion's letters": (
        LOG,
        {**without(TRUTH, "theta"), "qz": T[::5], "qw": T[::5]},
        f"true.csv:1: qw{UNREAD}, which is atan2(2 (w z + x y), 1 - 2 (y^2 + z^2)) of a quaternion, or delete what "
        "is no heading",
    ),
    "one pose": (
        LOG,
        {"t": T, "x": np.where(T < 0.05, 0.0, np.nan)},
        "true.csv: of x, y and theta one at least has to be measured twice",
    ),
    "milliseconds": (
        timed(LOG, lambda t: 1000 * t),
        TRUTH,
        f"run.csv lasts 40000 and true.csv 40: is t of run.csv in milliseconds{CUT}",
    ),
    "a truth in microseconds": (
        LOG,
        timed(TRUTH, lambda t: 1e6 * t),
        f"run.csv lasts 40 and true.csv 4e+07: is t of true.csv in microseconds{CUT}",
    ),
    "both in milliseconds": (
        timed(LOG, lambda t: 1000 * t),
        timed(TRUTH, lambda t: 1000 * t),
        "run.csv: readings are 100 s apart: is t in milliseconds? It is in seconds",
    ),
    "both in nanoseconds": (
        timed(LOG, lambda t: 1e9 * t),
        timed(TRUTH, lambda t: 1e9 * t),
        "run.csv: readings are 1e+08 s apart: is t in nanoseconds? It is in seconds",
    ),
    "a time that is missing": (
        LOG,
        {**TRUTH, "t": np.where(T[::5] == 5, np.nan, T[::5])},
        f"true.csv:12: t is nan{MEND}",
    ),
    "before": (
        timed(LOG, lambda t: t - 40.1),
        TRUTH,
        f"true.csv begins at t = 0 and ends at 40, run.csv at -40.1 and -0.1{CLOCK}",
    ),
    "after": (
        timed(LOG, lambda t: t + 40.1),
        TRUTH,
        f"true.csv begins at t = 0 and ends at 40, run.csv at 40.1 and 80.1{CLOCK}",
    ),
    "a gap": (
        cut(100, 121),
        TRUTH,
        "run.csv:103: 2.1 s without a reading, from t = 10 on, where 0.1 s are usual; make two logs of it, each with "
        "its truth",
    ),
    "a restart": (
        {**LOG, "left.angle": LEFT / 4 + 3.1 * (T > 9.95)},
        TRUTH,
        f"run.csv:102: left.angle jumps by 3.128 in one step, most move by 0.068 at most{WHOLE}",
    ),
    "a wrap": (
        wrapping(0.3),
        TRUTH,
        f"run.csv:23: left.angle jumps by -5.983 in one step, most move by 0.3 at most{TURN}{WHOLE}",
    ),
    "a wrap in degrees": (
        {**LOG, "left.angle": np.degrees(wrapping(0.3)["left.angle"])},
        TRUTH,
        "run.csv:23: left.angle jumps by -342.8 in one step, most move by 17 at most, as what wraps at 360: it seems "
        f"to be in degrees{WHOLE}",
    ),
    "counts of 16 bits": (
        {**without(LOG, "left.angle"), "left.counts": 1000 * np.arange(len(T)) % 65536},
        TRUTH,
        "run.csv:68: left.counts jumps by -6.454e+04 in one step, most move by 1e+03 at most, as what wraps at 2^16"
        f"{WHOLE}",
    ),
    "a fast wheel that wraps": (
        wrapping(1.1),
        TRUTH,
        f"run.csv:8: left.angle jumps by -5.183 in one step, most move by 1.1 at most{TURN}{WHOLE}",
    ),
}


@pytest.mark.parametrize("case", [*CHANGED, *REFUSED])
def test_what_is_refused(tmp_path: Path, case: str) -> None:
    change, told = CHANGED.get(case, (str, ""))
    log, truth, told = REFUSED.get(case, (LOG, TRUTH, told))
    with pytest.raises(UsageError) as refusal:
        drive(tmp_path, log, truth, change=change, turns={"left.spin": -4000.0} if "bits" in case else {})
    assert refusal.value.what.replace(f"{tmp_path}/", "") == told


@pytest.mark.parametrize(
    ("log", "truth"),
    [
        (cut(100, 119), TRUTH),
        (timed(LOG, lambda t: t - 39.9), TRUTH),
        (timed(LOG, lambda t: t + 39.9), TRUTH),
        (LOG, without(TRUTH, "x", "y")),
        (LOG, {"t": T, "theta": np.where(T < 0.15, T, np.nan)}),
        (timed(LOG, lambda t: 49 * t), timed(TRUTH, lambda t: 49 * t)),
        (LOG, {"t": T[:3], "x": T[:3]}),
        ({**LOG, "left.angle": LEFT + 2.6 * (T > 20)}, TRUTH),
    ],
    ids=[
        "almost a gap",
        "just before",
        "just after",
        "headings",
        "two of them",
        "slow",
        "short",
        "a small jump",
    ],
)
def test_what_is_not(tmp_path: Path, log: Mapping[str, Reals], truth: Mapping[str, Reals]) -> None:
    assert len(drive(tmp_path, log, truth).t) == len(log["t"])


def test_a_text_in_other_bytes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(csv(LOG), encoding="utf-16")
    with pytest.raises(UsageError, match=r"run\.csv: it is no text in UTF-8: save it as CSV in UTF-8"):
        read(tmp_path / "run.csv", tmp_path / "true.csv", JOINTS, {})


def test_lines_without_cells_and_empty_cells_of_a_truth(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(
        "\ufefft , left.angle,right.angle\n0,0,0\n1,1,1\n\n2,3,5\n", encoding="utf-8"
    )
    (tmp_path / "true.csv").write_text("t,x,theta\n0,,1\n\n1, ,\n2,7,3\n", encoding="utf-8")
    read_in = read(tmp_path / "run.csv", tmp_path / "true.csv", JOINTS, {})
    assert read_in.t.tolist() == [0, 1, 2] and read_in.columns["right.spin"].tolist() == [1, 4]
    assert np.isfinite(read_in.truth.x).tolist() == [False, False, True] and read_in.truth.measured == 2
    assert read_in.name == "run" and np.isnan(read_in.truth.y).all()


@pytest.mark.parametrize(("turned", "stands"), [(0.019, True), (0.021, False)])
@pytest.mark.parametrize("end", [0, -1])
def test_a_robot_stands_where_no_wheel_turns_for_a_second(
    tmp_path: Path, turned: float, stands: bool, end: int
) -> None:
    """At the end that is asked for; a second away it may move, and it may steer."""
    near = (T > 0.05) & (T < 1.05) if end == 0 else T > 39.15
    angle = np.cumsum(np.where(near, turned / near.sum(), 0.5))
    log = {"t": T, "left.angle": angle, "right.angle": 0 * T, "left.steer": T}
    read_in = drive(tmp_path, log, joints=("left.spin", "right.spin", "left.steer"))
    assert read_in.stands(end) == stands and not read_in.stands(-1 - end)


def test_each_log_has_the_truth_beside_it_or_the_next_that_is_named(tmp_path: Path) -> None:
    a, b, own, other, third = (tmp_path / f"{n}.csv" for n in ("a", "b", "a.truth", "c", "d"))
    for path in (a, b, own):
        path.write_text("")
    assert pairs([a], []) == [(a, own)]
    assert pairs([a, b], [other, third]) == [(a, other), (b, third)]
    for logs, truths, told in (
        ([a, b], [], f"{b}: no b.truth.csv is beside it, and no --truth is left for it"),
        ([a], [other, third], "there are 2 --truth for 1 logs"),
        ([third], [], f"{third}: there is no such file"),
    ):
        with pytest.raises(UsageError, match=re.escape(told)):
            pairs(logs, truths)
