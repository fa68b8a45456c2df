"""new, list and functions: a robot file of one's own from the gallery, and what a robot has."""

from __future__ import annotations

import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

import wmrgen
from tests.conftest import ROOT, Outcome
from wmrgen.cli.commands import app
from wmrgen.cli.drives import DRIVES
from wmrgen.functions.registry import names
from wmrgen.robotfile.keys import ROBOT
from wmrgen.robotfile.schema import MODELINE

Cli = Callable[..., Outcome]
GALLERY = sorted((ROOT / "robots").glob("*.yaml"))
TERMINALS = pytest.mark.skipif(os.name != "posix", reason="terminals")


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_list_is_the_gallery(wmrgen_cli: Cli) -> None:
    lines = wmrgen_cli("list").out.splitlines()
    assert [line.split()[0] for line in lines] == [path.stem for path in GALLERY]
    assert "(2, 0)  Pioneer P3-DX" in next(line for line in lines if line.startswith("pioneer3dx"))
    rows = json.loads(wmrgen_cli("list", "--json").out)["robots"]
    assert {row["name"] for row in rows if row["degenerate"]} >= {"clearpath_a200", "locked_bicycle"}
    assert all(
        row["degree_of_maneuverability"] >= row["degree_of_mobility"] > 0 and row["description"]
        for row in rows
    )


OWN = {
    "limits",
    "deadband",
    "encoder",
    "noise",
    "lag",
    "cg",
    "gyro",
}  # sections that describe one robot alone


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_a_copy_moves_as_the_robot_does(wmrgen_cli: Cli, here: Path, path: Path) -> None:
    """The same constraints; every key of the file is explained above it, and what is left out is a comment."""
    done = wmrgen_cli("new", "mine", "--from", path.stem)
    assert done.code == 0, done.err
    text = (here / "mine.yaml").read_text(encoding="utf-8")
    first, second = text.splitlines()[:2]
    assert first == MODELINE and second.startswith("# mine") and path.stem in second
    ours, theirs = (yaml.load(t, yaml.BaseLoader) for t in (text, path.read_text(encoding="utf-8")))
    assert ours.pop("name") == "mine" and ours.pop("description") == f"after {theirs.pop('description')}"
    del theirs["name"]
    theirs.pop("source", None)
    wheels, original = ({w["name"]: w for w in robot.pop("wheels")} for robot in (ours, theirs))
    driven = any(
        w["type"] not in ("castor", "spherical") or w.keys() & {"actuated", "driven"}
        for w in original.values()
    )
    for name, wheel in original.items():
        passive = wheel["type"] in ("castor", "spherical") and not wheel.keys() & {"actuated", "driven"}
        if passive and driven:
            assert name not in wheels and re.search(rf"^ *# *- {{name: {name},", text, re.MULTILINE)
        else:
            assert wheels[name] == {key: value for key, value in wheel.items() if key not in OWN}
    for key in theirs.keys() & OWN:
        assert re.search(rf"^# {key}: ", text, re.MULTILINE)
    functions = [set(robot.pop("functions", ())) for robot in (ours, theirs)]
    assert functions[0] <= functions[1] and all(name in text for name in functions[1])
    assert ours == {key: value for key, value in theirs.items() if key not in OWN}
    lines = text.splitlines()
    for key in {*ours, "wheels"} - {"wmrgen"}:
        above = lines.index(next(line for line in lines if line.startswith(f"{key}:")))
        comments = []
        while lines[above - 1].startswith("#"):
            above -= 1
            comments.insert(0, lines[above].lstrip("# "))
        assert any(ROBOT.field(key).meaning.startswith(comment) for comment in comments if comment)
    copy, robot = (wmrgen.derive(wmrgen.load(file)).mobility for file in (here / "mine.yaml", path))
    assert copy.degree_of_mobility == robot.degree_of_mobility
    assert copy.degree_of_steerability == robot.degree_of_steerability
    assert wmrgen_cli("derive", "mine.yaml").code == 0


def test_a_robot_of_castors_keeps_them(wmrgen_cli: Cli, here: Path) -> None:
    assert wmrgen_cli("new", "mine", "--from", "office_chair").code == 0
    assert len(wmrgen.load(here / "mine.yaml").wheels) == 5


def test_values_and_a_description_of_one_s_own(wmrgen_cli: Cli, here: Path) -> None:
    said = 'a "robot": #1, {truly}'
    words = ("radius=50 mm", "half_track=0.2*cos(atan2(0, 1))")
    out = here / "deep" / "x.yaml"
    done = wmrgen_cli(
        "new", "rover", *words, "--from", "pioneer3dx", "--description", said, "-o", out, "--json"
    )
    told = json.loads(done.out)
    assert (told["name"], told["from"]) == ("rover", "pioneer3dx")
    assert told["files"] == [str(out), str(out.parent / "robot.schema.json")]
    robot = wmrgen.load(out)
    assert robot.description == said
    assert {p.name: float(p.nominal) for p in robot.parameters} == {"radius": 0.05, "half_track": 0.2}
    assert all(p.tunable for p in robot.parameters)


@pytest.mark.parametrize(
    ("words", "code", "names"),
    [
        ("", "WMR112", "--drive"),
        ("mine", "WMR112", "--from"),
        ("mine --from pionier3dx", "WMR112", "pioneer3dx?"),
        ("mine --from pioneer3dx radios=1", "WMR112", "radius?"),
        ("mine --from pioneer3dx radius", "WMR112", "'radius'"),
        ("mine --from pioneer3dx radius=1:30", "WMR104", "'1:30'"),
        ("mine --from pioneer3dx radius=", "WMR104", "radius"),
        ("mine --from pioneer3dx radius=-1", "WMR109", "-1"),
        ("mine --from unicycle radius=1", "WMR112", "'radius'"),
        ("mine --drive tracks", "WMR112", "'tracks'"),
        ("mine --drive omni --from lekiwi", "WMR112", "--from"),
        ("mine --drive omni track=1", "WMR112", "'track'"),
        ("mine --drive omni radius=-1", "WMR109", "-1"),
        ("int --from pioneer3dx", "WMR105", "'int'"),
        ("../x --from pioneer3dx", "WMR105", "'../x'"),
    ],
)
def test_what_new_refuses_writes_nothing(
    wmrgen_cli: Cli, here: Path, words: str, code: str, names: str
) -> None:
    done = wmrgen_cli("new", *words.split())
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith(f"error[{code}]") and names in done.err and not list(here.iterdir())


def test_new_never_writes_over_a_file(wmrgen_cli: Cli, here: Path) -> None:
    (here / "mine.yaml").write_text("mine\n")
    (here / "robot.schema.json").write_text("{}")
    assert wmrgen_cli("new", "mine", "--from", "pioneer3dx").code == 2
    assert wmrgen_cli("new", "other", "--from", "pioneer3dx").code == 0
    assert (here / "mine.yaml").read_text() + (here / "robot.schema.json").read_text() == "mine\n{}"


class Terminal(io.StringIO):
    """A stream that somebody types at and reads."""

    def isatty(self) -> bool:
        return True


def asked(monkeypatch: pytest.MonkeyPatch, answers: str, *words: str) -> tuple[int, str]:
    """Exit code and questions of the command line on a terminal at which somebody types ``answers``."""
    shown = Terminal()
    with monkeypatch.context() as patch, pytest.raises(SystemExit) as end:
        patch.setattr("sys.stdin", Terminal(answers))
        patch.setattr("sys.stderr", shown)
        app(["new", *words])
    return int(str(end.value.code)), shown.getvalue()


def test_questions(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is given is not asked; an input that ends is no answer."""
    code, said = asked(monkeypatch, "int\nmine\nlong\n1.25\n-2 m\n\n", "--from", "bicycle")
    assert code == 0 and re.findall(r"error\[(WMR\d+)\]", said) == ["WMR105", "WMR107", "WMR109", "WMR109"]
    assert [said.count(f"{name}? [{value}]") for name, value in (("wheelbase", 1.1), ("r", 0.34))] == [2, 2]
    assert [float(p.nominal) for p in wmrgen.load(here / "mine.yaml").parameters] == [1.25, 0.34]
    code, said = asked(monkeypatch, "", "other", "r=1", "--from", "bicycle")
    assert code == 0 and "?" not in said
    code, said = asked(monkeypatch, "bicycle\nlast\n")
    assert code == 2 and "error[WMR112]" in said and not (here / "last.yaml").exists()


@TERMINALS
@pytest.mark.slow
def test_new_asks_on_a_terminal(here: Path) -> None:
    """An answer that cannot be is asked again, an empty line takes what is offered."""
    import pty

    parent, child = pty.openpty()
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    running = subprocess.Popen([sys.executable, "-m", "wmrgen", "new"], stdin=child, stdout=child, stderr=child,
                               env=environment)  # fmt: skip
    os.close(child)
    os.write(parent, b"tricycle\nackermann\n\n1.25\n\n0.1\n\x04")
    shown = b""
    while True:
        try:
            piece = os.read(parent, 4096)
        except OSError:
            break
        if not piece:
            break
        shown += piece
    os.close(parent)
    assert running.wait() == 0, shown
    text = shown.decode()
    assert "mecanum" in text and "error[WMR112]" in text and "'tricycle'" in text
    assert "[my_ackermann]" in text and "wheelbase? [TODO]" in text
    written = (here / "my_ackermann.yaml").read_text(encoding="utf-8")
    assert re.findall(r"^  (\w+): (.*)$", written, re.MULTILINE) == [
        ("wheelbase", "1.25"),
        ("track", "TODO"),
        ("radius", "0.1"),
    ]


@pytest.mark.parametrize("kind", DRIVES)
def test_a_drive_has_nothing_but_its_wheels(wmrgen_cli: Cli, here: Path, kind: str) -> None:
    """No castor, limits, encoders or noise. With its numbers it is derived without findings."""
    words = [f"{number.name}={number.example}" for number in DRIVES[kind].numbers]
    done = wmrgen_cli("new", "mine", *words, "--drive", kind)
    assert done.code == 0, done.err
    text = (here / "mine.yaml").read_text(encoding="utf-8")
    written = yaml.load(text, yaml.BaseLoader)
    assert set(written) == {"wmrgen", "name", "description", "parameters", "wheels"} and "TODO" not in text
    assert {wheel["type"] for wheel in written["wheels"]} <= {"fixed", "steered", "swedish"}
    linted = wmrgen_cli("lint", "mine.yaml")
    assert (linted.code, linted.out) == (0, "1 robot: no findings\n")
    freedom = {
        "differential": (2, 0),
        "ackermann": (1, 1),
        "swerve": (1, 2),
        "omni": (3, 0),
        "mecanum": (3, 0),
    }
    mobility = wmrgen.derive(wmrgen.load(here / "mine.yaml")).mobility
    assert (mobility.degree_of_mobility, mobility.degree_of_steerability) == freedom[kind]


@pytest.mark.parametrize("kind", DRIVES)
def test_a_number_that_is_not_given_is_open(wmrgen_cli: Cli, here: Path, kind: str) -> None:
    first, *rest = DRIVES[kind].numbers
    words = [f"{number.name}={number.example}" for number in rest]
    done = wmrgen_cli("new", "mine", *words, "--drive", kind)
    assert done.code == 0 and first.name in done.out
    lines = (here / "mine.yaml").read_text(encoding="utf-8").splitlines()
    row = lines.index(f"  {first.name}: TODO")
    assert lines[row - 1] == f"  # {first.meaning}"
    refused = wmrgen_cli("derive", "mine.yaml")
    assert refused.code == 2 and "error[WMR108]" in refused.err and f"mine.yaml:{row + 1}:" in refused.err


def test_what_a_copy_leaves_out_is_listed(wmrgen_cli: Cli, here: Path) -> None:
    done = wmrgen_cli("new", "mine", "--from", "pioneer3dx")
    for word in ("tail", "limits", "encoder", "noise", "joints_from_counts"):
        assert re.search(rf"\b{word}\b", done.err)
    assert "odometry_from_angles" not in done.err  # which needs none of them


def test_functions_are_those_that_can_be_derived(wmrgen_cli: Cli) -> None:
    robot = ROOT / "robots" / "pioneer3dx.yaml"
    told = json.loads(wmrgen_cli("functions", robot, "--json").out)
    has, lacks = ([entry["name"] for entry in told[key]] for key in ("functions", "absent"))
    assert sorted(has + lacks) == sorted(names()) and "pursuit" in has and "vaf" in lacks
    assert all(entry["text"] for entry in told["functions"]) and all(entry["why"] for entry in told["absent"])
    generated = {entry["name"] for entry in told["functions"] if entry["generated"]}
    assert {"inverse", "forward", "odometry", "limit_twist"} <= generated and "pursuit" not in generated
    inverse = told["functions"][0]
    assert inverse["name"] == "inverse" and "vx" in inverse["inputs"] and "left.spin" in inverse["outputs"]
    lines = wmrgen_cli("functions", robot).out.splitlines()
    assert (
        lines[0].startswith("* inverse ")
        and [name for name in names() if not any(f" {name} " in x for x in lines)] == []
    )


@pytest.mark.parametrize("value", ["0", "-3", "-30 cm", "30 deg", "0 mm"])
def test_a_number_of_a_drive_is_a_length_above_0(wmrgen_cli: Cli, here: Path, value: str) -> None:
    done = wmrgen_cli("new", "mine", "--drive", "differential", f"track={value}", "radius=0.1")
    assert done.code == 2 and "track" in done.err and not (here / "mine.yaml").exists()


def test_a_number_without_a_value_is_not_suggested_as_it_is(wmrgen_cli: Cli) -> None:
    done = wmrgen_cli("new", "mine", "--drive", "differential", "radius")
    assert done.code == 2 and "radius=" in done.err


@pytest.mark.parametrize("word", ["unicycle", "unicycle.yaml"])
def test_a_missing_file_with_the_name_of_a_robot_of_the_gallery(
    wmrgen_cli: Cli, here: Path, word: str
) -> None:
    """What the message says to write makes the file."""
    refused = wmrgen_cli("structure", word)
    (advice,) = re.findall(r"`wmrgen ([^`]+)`", refused.err)
    assert refused.code == 2 and wmrgen_cli(*advice.split()).code == 0
    assert wmrgen_cli("structure", "unicycle.yaml").code == 0
