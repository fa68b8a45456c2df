"""derive, eval and check as contracted: what is printed where, and the exit codes."""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome, process, tree

Cli = Callable[..., Outcome]
REAL = ROOT / "robots" / "pioneer3dx.yaml"


def test_derive_writes_and_summarises(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out")
    assert done.code == 0
    first = done.out.splitlines()[0]
    assert first == "pair: type (2, 0), mobility 2, steerability 0, maneuverability 2"
    assert {"model.json", "report.md", "pair.c", "pair.h"} <= tree(tmp_path / "out" / "pair").keys()
    assert "pair.c" in done.out


def test_derive_json_is_the_model(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--json")
    assert done.out.encode() == (tmp_path / "out" / "pair" / "model.json").read_bytes()
    model = json.loads(done.out)
    assert model["robot_type"] == [2, 0]
    assert {w["name"] for w in model["wheels"]} == {"left", "right"}


def test_derive_several(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    done = wmrgen_cli("derive", robot_file, REAL, "-o", tmp_path / "out", "--json")
    assert [model["name"] for model in json.loads(done.out)] == ["pair", "pioneer3dx"]


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


def test_eval_takes_the_options_of_the_c(wmrgen_cli: Cli) -> None:
    words = ("eval", "robots/kelly_4ws.yaml", "inverse", "vx=1", "omega=2", "--json", "--backend", "c")
    found = [json.loads(wmrgen_cli(*words, *w).out) for w in ((), ("--math", "libm"), ("--target", "host"))]
    for key, value in found[0].items():
        assert all(abs(other[key] - value) <= 2e-5 for other in found)


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
    assert done.code == 2
    assert "both describe a robot called pair" in done.err
    assert not (tmp_path / "out").exists()


def test_a_directory_that_cannot_be_written(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    (tmp_path / "out").write_text("in the way")
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out")
    assert done.code == 4
    assert done.err.startswith(f"cannot write {tmp_path / 'out' / 'pair'}")
    assert (tmp_path / "out").read_text() == "in the way"


def test_snap_notes_go_to_stderr(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    robot_file.write_text(robot_file.read_text().replace("alpha: pi/2", "alpha: 1.5707"))
    done = wmrgen_cli("derive", robot_file, "-o", tmp_path / "out", "--json")
    assert "left" in done.err
    assert "note" in done.err
    json.loads(done.out)


# ---- eval


MIRRORED = """wmrgen: 1
name: mirrored
parameters: {{a: {{value: 0.2, tunable: {0}}}, b: {1}}}
wheels:
  - {{name: fl, type: swedish, x: a, y: b, heading: 0, gamma: pi/4, r: 0.1}}
  - {{name: fr, type: swedish, x: a, y: -b, heading: 0, gamma: -pi/4, r: 0.1}}
  - {{name: rl, type: swedish, x: -a, y: b, heading: 0, gamma: -pi/4, r: 0.1}}
  - {{name: rr, type: swedish, x: -a, y: -b, heading: 0, gamma: pi/4, r: 0.1}}
"""


@pytest.mark.parametrize("tunable", ["false", "true"])
@pytest.mark.parametrize("b", ["0.2", "0.25"])
def test_mirrored_mecanum_on_a_square_is_warned_of(
    wmrgen_cli: Cli, tmp_path: Path, tunable: str, b: str
) -> None:
    """Tzafestas (2.81) as printed, d1 = d2: rank 2. On a rectangle the rank is 3 and nothing is said."""
    path = tmp_path / "mirrored.yaml"
    path.write_text(MIRRORED.format(tunable, b), encoding="utf-8")
    done = wmrgen_cli("derive", path, "-o", tmp_path / "out")
    assert done.code == 0 and ("rank 2" in done.err) == (b == "0.2")


def test_eval_prints_aligned_lines(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "vx=0.0975")
    assert done.code == 0
    assert done.out == "left.spin  = 1.0\nright.spin = 1.0\nslip       = 0.0\n"
    assert done.err == "not given, taken as 0: vy omega\n"


def test_eval_json_has_every_digit(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "vx=1/3", "vy=0", "omega=45 deg/s", "--json")
    found = json.loads(done.out)
    assert done.err == ""
    turn = 0.1655 * math.pi / 4
    assert found["right.spin"] == pytest.approx((1 / 3 + turn) / 0.0975, rel=1e-15)
    assert found["left.spin"] == pytest.approx((1 / 3 - turn) / 0.0975, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi/2", math.pi / 2),
        ("1e-3", 1e-3),
        ("-1/3", -1 / 3),
        ("90 deg", math.pi / 2),
        ("2*sqrt(2)", 8**0.5),
        (" 3 ", 3),
    ],
)
def test_eval_reads_expressions(wmrgen_cli: Cli, robot_file: Path, text: str, value: float) -> None:
    words = ("eval", robot_file, "odometry", f"theta={text}", "--json")
    assert json.loads(wmrgen_cli(*words).out)["theta"] == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("backend", ["casadi", "c"])
def test_backends_agree(wmrgen_cli: Cli, robot_file: Path, backend: str) -> None:
    if backend == "c" and not shutil.which("cc"):
        pytest.skip("no C compiler")
    for function, words in {
        "inverse": ("vx=0.3", "vy=0.2", "omega=0.7"),
        "forward": ("left.spin=1", "right.spin=2.5"),
        "odometry": ("x=1", "y=2", "theta=0.3", "vx=0.5", "omega=0.2", "dt=0.1"),
    }.items():
        exact = json.loads(wmrgen_cli("eval", robot_file, function, *words, "--json").out)
        other = json.loads(
            wmrgen_cli("eval", robot_file, function, *words, "--json", "--backend", backend).out
        )
        assert list(other) == list(exact)
        assert other == pytest.approx(exact, rel=1e-6, abs=1e-6)


def test_eval_cases(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path) -> None:
    cases = tmp_path / "cases.json"
    cases.write_text('[{"vx": 0.0975}, {"omega": "pi/2", "vx": 0, "vy": 0}, {}]')
    done = wmrgen_cli("eval", robot_file, "inverse", "--cases", cases)
    results = json.loads(done.out)
    assert results[0] == {"left.spin": 1.0, "right.spin": 1.0, "slip": 0.0}
    assert results[1]["right.spin"] == pytest.approx(0.1655 * math.pi / 2 / 0.0975, rel=1e-15)
    assert results[2]["left.spin"] == 0
    assert wmrgen_cli("eval", robot_file, "inverse", "--cases", "-", stdin=cases.read_text()).out == done.out


def test_tunable_parameters_are_inputs_with_a_nominal_value(wmrgen_cli: Cli, robot_file: Path) -> None:
    text = robot_file.read_text().replace("half_track: 0.1655", "half_track: {value: 0.1655, tunable: true}")
    robot_file.write_text(text)
    nominal = wmrgen_cli("eval", robot_file, "inverse", "vx=0", "vy=0", "omega=1", "--json")
    wider = wmrgen_cli("eval", robot_file, "inverse", "vx=0", "vy=0", "omega=1", "half_track=0.331", "--json")
    assert nominal.err == ""
    assert json.loads(wider.out)["right.spin"] == pytest.approx(2 * json.loads(nominal.out)["right.spin"])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("inverse", "vz=1"), "'vz'"),
        (("inverse", "omga=1"), "omega"),
        (("inverse", "left.spin=1"), "vx vy omega"),
        (("invers", "vx=1"), "inverse forward odometry"),
        (("inverse", "vx"), "NAME=VALUE"),
        (("inverse", "vx=1", "vx=2"), "twice"),
        (("inverse", "vx=nan"), "vx"),
        (("inverse", "vx=inf"), "vx"),
        (("inverse", "vx=1e999"), "vx"),
        (("inverse", "vx=9**9**9"), "vx"),
        (("inverse", "vx=1/0"), "vx"),
        (("inverse", "vx=__import__('os')"), "vx"),
        (("inverse", "vx="), "vx"),
        (("inverse", "vx=1", "--cases", "x.json"), "not both"),
    ],
)
def test_eval_refuses(wmrgen_cli: Cli, robot_file: Path, words: tuple[str, ...], says: str) -> None:
    done = wmrgen_cli("eval", robot_file, *words)
    assert (done.code, done.out) == (2, ""), done
    assert says in done.err


@pytest.mark.parametrize(
    "text", ["", "{}", "[1]", '[{"vx": NaN}]', '[{"vx": Infinity}]', '[{"vx": true}]', '[{"vz": 1}]',
             '[{"vx": 1, "vx": 2}]', '[{"vx": [1]}]', "[" * 100_000, '[{"vx": null}]', '[{"vx": "1e999999999"}]',
             "\udcff"],
)  # fmt: skip
def test_eval_refuses_cases(wmrgen_cli: Cli, robot_file: Path, tmp_path: Path, text: str) -> None:
    cases = tmp_path / "cases.json"
    cases.write_bytes(text.encode("utf-8", "surrogateescape"))
    done = wmrgen_cli("eval", robot_file, "inverse", "--cases", cases)
    assert (done.code, done.out) == (2, ""), done


def test_a_missing_cases_file(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "--cases", "nowhere.json")
    assert done.code == 4
    assert "nowhere.json" in done.err


def test_no_compiler(robot_file: Path) -> None:
    done = process("eval", robot_file, "inverse", "vx=1", "--backend", "c", env={"CC": "no-such-compiler"})
    assert done.code == 4
    assert "no-such-compiler" in done.err


# ---- check


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
    ("change", "says"),
    [
        (lambda g: (g / "pair" / "pair.c").write_text("changed"), "generated/pair/pair.c: not what"),
        (lambda g: (g / "pair" / "pair.h").unlink(), "generated/pair/pair.h: missing"),
        (lambda g: (g / "pair" / "pair.cpp").write_text(""), "generated/pair/pair.cpp: no robot file"),
        (lambda g: (g / "pair" / "manifest.json").write_text("{}"), "generated/pair/manifest.json: not what"),
        (lambda g: (g / "gone").mkdir(), "generated/gone: no robot file"),
        (lambda g: shutil.rmtree(g), "generated/pair/model.json: missing"),
    ],
)
def test_check_names_what_is_stale(
    wmrgen_cli: Cli, project: Path, change: Callable[[Path], object], says: str
) -> None:
    change(project / "generated")
    done = wmrgen_cli("check")
    assert done.code == 1
    assert says in done.out


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


def test_eval_in_c_takes_either_scalar(wmrgen_cli: Callable[..., Outcome]) -> None:
    """Double agrees with exact to a double's rounding, float does not."""
    words = (
        "eval",
        ROOT / "robots" / "kuka_youbot.yaml",
        "inverse",
        "vx=0.3",
        "vy=0.1",
        "omega=0.7",
        "--json",
    )
    exact = json.loads(wmrgen_cli(*words).out)
    worst = {}
    for scalar in ("float", "double"):
        found = json.loads(wmrgen_cli(*words, "--backend", "c", "--scalar", scalar).out)
        worst[scalar] = max(abs(found[k] - exact[k]) for k in exact)
    assert worst["double"] < 1e-13 < worst["float"] < 1e-4


@pytest.mark.parametrize("zero", ["-0", "-0.0", "-0e3", "-.0 rad"])
def test_eval_hands_minus_zero_through(wmrgen_cli: Cli, robot_file: Path, zero: str) -> None:
    """The C of odometry adds dt omega = -0 to theta: -0 only where both zeros keep their sign on the way."""
    words = ("eval", robot_file, "odometry", "--backend", "c")
    single = json.loads(wmrgen_cli(*words, f"theta={zero}", "omega=-0.0", "--json").out)
    (case,) = json.loads(
        wmrgen_cli(*words, "--cases", "-", stdin=f'[{{"theta": "{zero}", "omega": -0.0}}]').out
    )
    assert [math.copysign(1.0, found["theta"]) for found in (single, case)] == [-1.0, -1.0]
