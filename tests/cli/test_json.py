"""``--json``: every command has it, and prints one JSON value on stdout, on failure an object that says what failed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import Outcome
from wmrgen.cli import console
from wmrgen.cli.commands import VERBS
from wmrgen.errors import NotDerivableError

Cli = Callable[..., Outcome]
TAKES_A_ROBOT = [  # and what else it must be given
    "derive", "check", "lint", "eval inverse", "motion left=1 --time 1", "icr vx=1", "model", "structure",
    "stability", "prove", "gains",
]  # fmt: skip


@pytest.mark.parametrize("name", VERBS)
def test_every_command_has_it(wmrgen_cli: Cli, name: str) -> None:
    assert "--json " in wmrgen_cli(name, "--help").out


@pytest.mark.parametrize("name", [*VERBS, "fly"])
def test_words_that_a_command_does_not_take(wmrgen_cli: Cli, name: str) -> None:
    done = wmrgen_cli(name, "--jsonn", "--json")
    told = json.loads(done.out)
    assert (done.code, told["exit_code"]) == (2, 2)
    wrong, nearest = ("'fly'", "") if name == "fly" else ("'--jsonn'", "Did you mean --json?")
    assert wrong in told["error"] and nearest in told["error"] and told["error"] in done.err
    assert [entry["line"] for entry in told["errors"]] == [None]


@pytest.mark.parametrize("words", TAKES_A_ROBOT)
def test_a_bad_robot_file_has_its_place(wmrgen_cli: Cli, tmp_path: Path, words: str) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("wmrgen: 1\nname: bad\nwheels:\n  - {name: a, type: fixd, x: 0, y: 0, heading: 0, r: 1}\n")
    name, *more = words.split()
    out = ["-o", tmp_path / "out"] if name in ("derive", "check") else []
    done = wmrgen_cli(name, bad, *more, *out, "--json")
    told = json.loads(done.out)
    assert (done.code, told["exit_code"]) == (2, 2) and "fixd" in told["error"]
    (entry,) = told["errors"]
    assert (entry["file"], entry["line"], entry["column"]) == (str(bad), 4, 21)
    assert "fixed" in entry["instead"]


def test_an_internal_error_and_a_signal_are_objects_too(capsys: pytest.CaptureFixture[str]) -> None:
    def broken() -> int:
        raise console.Stopped("SIGTERM", 15)

    assert console.outcome(broken, as_json=True) == 143
    assert json.loads(capsys.readouterr().out)["error"] == "terminated"

    def degenerate() -> int:
        raise NotDerivableError("it cannot\nmove")

    assert console.outcome(degenerate, as_json=True) == 3
    told = json.loads(capsys.readouterr().out)
    assert (told["error"], told["exit_code"]) == ("error[WMR113]: it cannot\n = move", 3)


def test_check_says_what_is_stale(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = (robot_file, "-o", "out")
    assert wmrgen_cli("derive", *words).code == 0
    fresh = wmrgen_cli("check", *words, "--json")
    assert (fresh.code, json.loads(fresh.out)) == (0, {"robots": 1, "stale": [], "errors": []})
    (tmp_path / "out" / "pair" / "pair.c").unlink()
    done = wmrgen_cli("check", *words, "--json")
    assert (done.code, json.loads(done.out)["stale"]) == (1, [{"file": "out/pair/pair.c", "why": "missing"}])


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ("evla", "Did you mean eval?"),
        ("prov", "Did you mean prove?"),
        ("qqq", "Valid here: "),
        ("", "Valid here: "),
    ],
)
def test_an_unknown_command_gets_the_nearest(wmrgen_cli: Cli, wrong: str, says: str) -> None:
    done = wmrgen_cli(wrong)
    assert (done.code, done.out) == (2, "")
    assert f"there is no command '{wrong}'. {says}" in done.err


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ("--pakage", " Did you mean --package?"),
        ("--traget", " Did you mean --target?"),
        ("-p", "\n"),
    ],
)
def test_an_unknown_option_gets_the_nearest(wmrgen_cli: Cli, wrong: str, says: str) -> None:
    done = wmrgen_cli("derive", "x.yaml", wrong)
    assert (done.code, done.out) == (2, "")
    assert f"there is no option '{wrong}'.{says}" in done.err
