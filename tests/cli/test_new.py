"""new, list and functions: a robot file of one's own from the gallery, and what a robot has."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

import wmrgen
from tests.conftest import ROOT, Outcome
from wmrgen.cli import console
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


@pytest.mark.parametrize("path", GALLERY, ids=lambda p: p.stem)
def test_what_begins_as_a_robot_is_that_robot(wmrgen_cli: Cli, here: Path, path: Path) -> None:
    """But for the names; and every key of the file is explained above it."""
    done = wmrgen_cli("new", "mine", "--from", path.stem)
    assert done.code == 0, done.err
    text = (here / "mine.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"{MODELINE}\n# mine, begun as {path.stem} of wmrgen's gallery.")
    ours, theirs = (yaml.load(t, yaml.BaseLoader) for t in (text, path.read_text(encoding="utf-8")))
    assert ours.pop("name") == "mine" and ours.pop("description") == f"after {theirs.pop('description')}"
    del theirs["name"]
    theirs.pop("source", None)
    assert ours == theirs
    lines = text.splitlines()
    for key in ours.keys() - {"wmrgen"}:
        above = lines.index(next(line for line in lines if line.startswith(f"{key}:")))
        comments = []
        while lines[above - 1].startswith("#"):
            above -= 1
            comments.insert(0, lines[above].lstrip("# "))
        assert any(ROBOT.field(key).meaning.startswith(comment) for comment in comments if comment)
    assert wmrgen.derive(wmrgen.load(here / "mine.yaml")).mobility.reasons


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
    ("words", "says"),
    [
        ("", "Write wmrgen new MY_ROBOT --from ROBOT"),
        ("mine", "Write wmrgen new MY_ROBOT --from ROBOT"),
        ("mine --from pionier3dx", "Did you mean pioneer3dx?"),
        ("mine --from pioneer3dx radios=1", "Did you mean radius?"),
        ("mine --from pioneer3dx radius", "'radius' is not PARAMETER=VALUE"),
        ("mine --from pioneer3dx radius=1:30", "1:30"),
        ("mine --from pioneer3dx radius=", "radius"),
        ("mine --from pioneer3dx radius=-1", "r"),
        ("mine --from unicycle radius=1", "It has none: edit the file."),
        ("int --from pioneer3dx", "int"),
        ("../x --from pioneer3dx", "../x"),
    ],
)
def test_what_new_refuses_writes_nothing(wmrgen_cli: Cli, here: Path, words: str, says: str) -> None:
    done = wmrgen_cli("new", *words.split())
    assert (done.code, done.out) == (2, "")
    assert says in done.err and not list(here.iterdir())


def test_new_never_writes_over_a_file(wmrgen_cli: Cli, here: Path) -> None:
    (here / "mine.yaml").write_text("mine\n")
    (here / "robot.schema.json").write_text("{}")
    assert wmrgen_cli("new", "mine", "--from", "pioneer3dx").code == 2
    assert wmrgen_cli("new", "other", "--from", "pioneer3dx").code == 0
    assert (here / "mine.yaml").read_text() + (here / "robot.schema.json").read_text() == "mine\n{}"


def test_questions(wmrgen_cli: Cli, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is given is not asked; an input that ends is no answer."""
    monkeypatch.setattr(console, "can_ask", lambda: True)
    done = wmrgen_cli("new", "--from", "bicycle", stdin="int\nmine\nlong\n1.25\n-2 m\n\n")
    assert done.code == 0 and "reserved" in done.err and done.err.count("wheelbase? [1.1]") == 2
    assert (
        "'long' is not a declared parameter" in done.err and "150 mm" in done.err and "r? [0.34]" in done.err
    )
    assert [float(p.nominal) for p in wmrgen.load(here / "mine.yaml").parameters] == [1.25, 0.34]
    assert wmrgen_cli("new", "other", "r=1", "--from", "bicycle").code == 0
    done = wmrgen_cli("new", stdin="bicycle\nlast\n")
    assert done.code == 2 and "the input has ended" in done.err and not (here / "last.yaml").exists()


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
    os.write(parent, b"tricycle\nbicycle\n\n1.25\n\n\x04")
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
    assert "kuka_youbot" in text and "the gallery has no robot 'tricycle'" in text
    assert "What is your robot called? [my_bicycle]" in text and "wheelbase? [1.1]" in text
    robot = wmrgen.load(here / "my_bicycle.yaml")
    assert [float(p.nominal) for p in robot.parameters] == [1.25, 0.34]


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
