"""derive and check as contracted: what is written, what is printed where, and the exit codes."""

from __future__ import annotations

import json
import py_compile
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import DIFFERENTIAL, ROOT, Outcome, tree

Cli = Callable[..., Outcome]


REAL = ROOT / "robots" / "pioneer3dx.yaml"


MIRRORED = """wmrgen: 1
name: mirrored
parameters: {{a: {{value: 0.2, tunable: {0}}}, b: {1}}}
wheels:
  - {{name: fl, type: swedish, x: a, y: b, heading: 0, gamma: pi/4, r: 0.1}}
  - {{name: fr, type: swedish, x: a, y: -b, heading: 0, gamma: -pi/4, r: 0.1}}
  - {{name: rl, type: swedish, x: -a, y: b, heading: 0, gamma: -pi/4, r: 0.1}}
  - {{name: rr, type: swedish, x: -a, y: -b, heading: 0, gamma: pi/4, r: 0.1}}
"""


def test_derive_writes_and_summarises(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out")
    assert done.code == 0
    first = done.out.splitlines()[0]
    assert first == "pair: type (2, 0), mobility 2, steerability 0, maneuverability 2"
    assert {"model.json", "report.md", "pair.c", "pair.h"} <= tree(tmp_path / "out" / "pair").keys()
    assert "pair.c" in done.out


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        ("clearpath_a200", "it turns only by skidding"),
        ("locked_bicycle", "its fixed axles are not one line"),
        ("unicycle", "The fixed wheel wheel forbids motion along the axle"),
    ],
)
def test_derive_says_what_decides(wmrgen_cli: Cli, tmp_path: Path, robot: str, why: str) -> None:
    lines = wmrgen_cli("derive", ROOT / "robots" / f"{robot}.yaml", "-o", tmp_path).out.splitlines()
    assert why in lines[1] and ("degenerate" in lines[0]) == lines[1].startswith("  Degenerate: ")


def test_no_top_view_where_nobody_looks(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    for more in ([], ["--json"]):
        assert " | " not in wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", *more).out


def test_derive_json_is_the_model(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--json")
    assert done.out.encode() == (tmp_path / "out" / "pair" / "model.json").read_bytes()
    model = json.loads(done.out)
    assert model["robot_type"] == [2, 0]
    assert {w["name"] for w in model["wheels"]} == {"left", "right"}


def test_derive_several(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, REAL, "-o", tmp_path / "out", "--json")
    assert [model["name"] for model in json.loads(done.out)["robots"]] == ["pair", "pioneer3dx"]


def test_a_module_that_was_imported_stays_fresh(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert wmrgen_cli("derive", robot_file, "-o", out).code == 0
    py_compile.compile(str(out / "pair" / "pair.py"))
    assert (out / "pair" / "__pycache__").is_dir()
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0


def test_check_regenerates_with_the_options_of_the_manifest(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path
) -> None:
    out, texts = tmp_path / "out", set()
    for words in (
        ("--math", "libm"),
        ("--target", "host"),
        ("--target", "m0"),
        ("--scalar", "double"),
        (),
    ):
        assert wmrgen_cli("derive", robot_file, "-o", out, *words).code == 0
        texts.add(next(out.glob("*/*.c")).read_text())
        assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    assert len(texts) == 5
    assert wmrgen_cli("derive", robot_file, "-o", out, "--scalar", "double", "--math", "inline").code == 2


def test_the_scalar_option_changes_the_c_only(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    for scalar in ("float", "double"):
        assert wmrgen_cli("derive", robot_file, "-o", tmp_path / scalar, "--scalar", scalar).code == 0
    single, double = tree(tmp_path / "float" / "pair"), tree(tmp_path / "double" / "pair")
    assert b"double vx" in double["pair.h"]
    assert b"float vx" in single["pair.h"]
    assert single["model.json"] == double["model.json"]


def test_one_bad_file_of_two_writes_nothing(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("wmrgen: 1\nname: bad\nwheels: []\nwheelz: 3\n")
    done = wmrgen_cli("derive", robot_file, bad, "-o", tmp_path / "out")
    assert (done.code, done.out) == (2, "")
    assert f"{bad}:4:1" in done.err
    assert not (tmp_path / "out").exists()


def test_two_robots_of_one_name(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    shutil.copy(robot_file, tmp_path / "again.yaml")
    done = wmrgen_cli("derive", robot_file, tmp_path / "again.yaml", "-o", tmp_path / "out")
    assert done.code == 2 and done.err.startswith("error[WMR112]")
    assert str(robot_file) in done.err and str(tmp_path / "again.yaml") in done.err
    assert not (tmp_path / "out").exists()


def test_a_directory_that_cannot_be_written(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("in the way")
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out")
    assert done.code == 4
    assert done.err.startswith("error[WMR114]") and str(tmp_path / "out" / "pair") in done.err
    assert (tmp_path / "out").read_text() == "in the way"


def test_snap_notes_go_to_stderr(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    robot_file.write_text(robot_file.read_text().replace("alpha: pi/2", "alpha: 1.5707"))
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--json")
    assert "left" in done.err
    assert "note" in done.err
    json.loads(done.out)


@pytest.mark.parametrize("tunable", ["false", "true"])
@pytest.mark.parametrize("b", ["0.2", "0.25"])
def test_mirrored_mecanum_on_a_square_is_warned_of(
    wmrgen_cli: Cli, tmp_path: Path, tunable: str, b: str
) -> None:
    """Tzafestas (2.81) as printed, d1 = d2: rank 2. On a rectangle the rank is 3, by little."""
    path = tmp_path / "mirrored.yaml"
    path.write_text(MIRRORED.format(tunable, b), encoding="utf-8")
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 0 and ("rank 2" in done.err) == (b == "0.2")
    assert ("WMR032" in done.err) == (b != "0.2")


def test_a_missing_robot_file(wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = wmrgen_cli("derive", "nowhere.yaml")
    assert done.code == 2
    assert "nowhere.yaml" in done.err
    assert "Traceback" not in done.err
    assert list(tmp_path.iterdir()) == []


@pytest.fixture
def project(robot_file: Path, tmp_path: Path, wmrgen_cli: Cli, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with robots/pair.yaml and its generated/."""
    home = tmp_path / "project"
    (home / "robots").mkdir(parents=True)
    robot_file.rename(home / "robots" / "pair.yaml")
    monkeypatch.chdir(home)
    assert wmrgen_cli("derive", "robots/pair.yaml").code == 0
    return home


def test_check_passes_when_fresh(wmrgen_cli: Cli, project: Path) -> None:
    done = wmrgen_cli("check")
    assert done.code == 0
    assert "up to date" in done.out


@pytest.mark.parametrize(
    ("change", "file"),
    [
        (lambda g: (g / "pair" / "pair.c").write_text("changed"), "generated/pair/pair.c"),
        (lambda g: (g / "pair" / "pair.h").unlink(), "generated/pair/pair.h"),
        (lambda g: (g / "pair" / "pair.cpp").write_text(""), "generated/pair/pair.cpp"),
        (lambda g: (g / "pair" / "manifest.json").write_text("{}"), "generated/pair/manifest.json"),
        (lambda g: (g / "gone").mkdir(), "generated/gone"),
        (lambda g: shutil.rmtree(g), "generated/pair/model.json"),
    ],
)
def test_check_names_what_is_stale(
    wmrgen_cli: Cli, project: Path, change: Callable[[Path], object], file: str
) -> None:
    change(project / "generated")
    done = wmrgen_cli("check")
    assert done.code == 1
    assert f"\n{file}: " in f"\n{done.out}"
    assert file in [entry["file"] for entry in json.loads(wmrgen_cli("check", "--json").out)["stale"]]


def test_check_sees_a_changed_robot(wmrgen_cli: Cli, project: Path) -> None:
    path = project / "robots" / "pair.yaml"
    path.write_text(path.read_text().replace("0.0975", "0.098"))
    done = wmrgen_cli("check", path)
    assert done.code == 1
    assert "generated/pair/pair.c" in done.out


def test_check_reports_a_bad_robot_and_goes_on(wmrgen_cli: Cli, project: Path) -> None:
    (project / "robots" / "bad.yaml").write_text("wmrgen: 2\n")
    (project / "generated" / "pair" / "pair.c").write_text("changed")
    done = wmrgen_cli("check")
    assert done.code == 2
    assert "bad.yaml" in done.err
    assert "pair.c" in done.out


def test_check_with_nothing_to_check(
    wmrgen_cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert wmrgen_cli("check").code == 2


def test_every_function_that_a_robot_cannot_have_is_told_where_it_is_asked_for(
    wmrgen_cli: Cli, robot_file: Path, tmp_path: Path
) -> None:
    text = robot_file.read_text() + "functions: [icr, desaturate,\n  joints_from_counts]\n"
    robot_file.write_text(text)
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out")
    assert done.code == 3 and not (tmp_path / "out").exists()
    places = [line.rpartition(".yaml:")[2] for line in done.err.splitlines() if "-->" in line]
    line = text.count("\n") - 1
    assert places[-2:] == [f"{line}:18", f"{line + 1}:3"], done.err
    assert done.err.count("error[WMR113]") == 2 and " desaturate" in done.err


def test_batch_is_noted(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    """`--batch` writes the functions over arrays; `check` expects them."""
    out = tmp_path / "out"
    assert wmrgen_cli("derive", robot_file, "-o", out, "--batch").code == 0
    assert {"pair_many.h", "pair_many.c"} <= tree(out / "pair").keys()
    assert wmrgen_cli("check", robot_file, "-o", out).code == 0
    (out / "pair" / "pair_many.c").unlink()
    assert wmrgen_cli("check", robot_file, "-o", out).code == 1
    assert wmrgen_cli("derive", robot_file, "-o", out).code == 0
    assert "pair_many.h" not in tree(out / "pair")


def test_sections_that_no_function_uses_are_reported(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Each by its name, until a function of the file uses it; per-wheel sections too."""
    path = tmp_path / "pair.yaml"
    trailers, cg = "trailers: [{name: cart, length: 1, hitch: 0}]\n", "cg: {x: 0, y: 0, z: 0.3}\n"
    encoder = "r: 0.0975, encoder: {spin: {counts: 2000}}}"
    wheels = DIFFERENTIAL.replace("r: 0.0975}", encoder)
    text = f"{wheels}{trailers}{cg}noise: {{spin: {{proportional: 0.02}}}}\n"
    assert encoder in text

    def noted(functions: str) -> list[str]:
        path.write_text(text + functions, encoding="utf-8")
        done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
        assert done.code == 0, done.err
        lines = [line for line in done.err.splitlines() if "generated C" in line]
        return re.findall(r"trailers|cg\b|encoder|noise", " ".join(lines).partition(". List")[0])

    assert noted("") == ["trailers", "cg", "encoder", "noise"]
    assert noted("functions: [trailer, joints_from_counts]\n") == ["cg", "noise"]
    assert noted("functions: [trailer, joints_from_counts, cg_force, forward_covariance]\n") == []
