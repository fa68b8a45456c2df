"""Messages of the command line: what is wrong, as a clause that starts with a small letter, then what to do."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome

Cli = Callable[..., Outcome]


@pytest.mark.parametrize(
    ("words", "names"),
    [
        ("check", "robots/*.yaml"),
        ("schema --json --markdown", "--json --markdown"),
        ("eval PAIR inverse vx=1 --cases x.json", "--cases"),
        ("motion PAIR", "--time --segments"),
        ("motion PAIR --time 1 --segments x.json", "--time --segments"),
        ("icr PAIR", "vx= vy= omega= <wheel>.steer= icr.x= icr.y="),
        ("gains k_rho=1e60", "1e+50"),
        ("new", "wmrgen new"),
        ("model PAIR --dt 1", "--discrete"),
        ("eval PAIR inverse --backend nothing", "exact c"),
    ],
)
def test_a_message_says_what_is_wrong_and_then_what_to_do(
    wmrgen_cli: Cli, robot_file: Path, monkeypatch: pytest.MonkeyPatch, words: str, names: str
) -> None:
    monkeypatch.chdir(robot_file.parent)
    done = wmrgen_cli(*words.replace("PAIR", robot_file.name).split())
    assert done.code == 2 and bool(done.out) == ("--json" in words)
    message = re.fullmatch(r"error\[WMR112\]: ([a-z-].*?)\. ([A-Z`].*)\.?\n", done.err)
    assert message, done.err
    assert [name for name in names.split() if name not in done.err] == []


@pytest.mark.parametrize("heading", ["0", "pi"])
@pytest.mark.parametrize(("x", "side"), [("0.05", "in front of"), ("-0.05", "behind")])
def test_the_side_of_an_axle_is_that_of_the_robot(
    wmrgen_cli: Cli, tmp_path: Path, heading: str, x: str, side: str
) -> None:
    path = tmp_path / "a.yaml"
    lines = [
        f"  - {{name: {n}, type: fixed, x: {x}, y: {y}, heading: {heading}, r: 0.1}}\n"
        for n, y in (("left", 0.2), ("right", -0.2))
    ]
    path.write_text("wmrgen: 1\nname: a\nwheels:\n" + "".join(lines))
    assert f"0.05 m {side} the origin P" in wmrgen_cli("lint", path).out


@pytest.mark.parametrize(
    ("words", "start"),
    [
        ("gains", "Stable"),
        ("gains k_rho=-3", "Unstable"),
        ("gains k_alpha=4", "Stable near the goal"),
        ("icr PAIR vx=1 omega=1", "The robot turns"),
        ("icr PAIR vx=1", "The robot does not turn"),
        ("icr PAIR vx=0", "The robot stands still"),
    ],
)
def test_a_result_starts_with_a_sentence(wmrgen_cli: Cli, robot_file: Path, words: str, start: str) -> None:
    first = wmrgen_cli(*words.replace("PAIR", str(robot_file)).split()).out.splitlines()[0]
    assert first.startswith(start) and first.endswith(".") and "=" not in first.partition("because")[0]
