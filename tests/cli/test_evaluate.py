"""eval as contracted: results, notes, backends, and what it refuses."""

from __future__ import annotations

import json
import math
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import ROOT, Outcome

Cli = Callable[..., Outcome]
PIONEER = ROOT / "robots" / "pioneer3dx.yaml"


def test_eval_prints_aligned_lines(wmrgen_cli: Cli, robot_file: Path) -> None:
    done = wmrgen_cli("eval", robot_file, "inverse", "vx=0.0975")
    assert done.code == 0
    assert done.out == "left.spin  = 1.0 rad/s\nright.spin = 1.0 rad/s\nslip       = 0.0 m/s\n"
    assert done.err == "not given, taken as 0: vy omega\n"


@pytest.mark.parametrize(
    ("vx", "beyond"), [("1.2", False), ("-1.2", False), ("1.2000001", True), ("-6/5 - 1e-9", True)]
)
def test_eval_tells_inputs_beyond_the_limits(wmrgen_cli: Cli, vx: str, beyond: bool) -> None:
    """The Pioneer's are vx: 1.2, spin: 12.3; what it computes is the same."""
    words = ("eval", PIONEER, "inverse", f"vx={vx}", "vy=0", "omega=0", "tail.steer=0")
    done = wmrgen_cli(*words)
    assert beyond == (done.err != "") == bool(re.fullmatch(r"vx .*limits, -1\.2 to 1\.2 m/s\n", done.err))
    found = json.loads(wmrgen_cli(*words, "--json").out)
    assert found.pop("beyond_limits", None) == ({"vx": [-1.2, 1.2]} if beyond else None)
    assert [f"{name} = {value!r}" for name, value in found.items()] == [
        " ".join(line.split()[:3]) for line in done.out.splitlines()
    ]


def test_eval_knows_the_limits_of_joints_and_what_keeps_limits(wmrgen_cli: Cli) -> None:
    forward = wmrgen_cli("eval", PIONEER, "forward", "left.spin=12.3", "right.spin=12.4")
    assert re.fullmatch(r"right\.spin .*limits, -12\.3 to 12\.3 rad/s\n", forward.err)
    cases = (
        '[{"vx": 0, "vy": 0, "omega": 9, "tail.steer": 0}, {"vx": 2, "vy": 0, "omega": 0, "tail.steer": 0}]'
    )
    collector = wmrgen_cli("eval", PIONEER, "inverse", "--cases", "-", stdin=cases)
    assert [line.split()[0] for line in collector.err.splitlines()] == ["vx", "omega"]
    assert all("beyond_limits" not in result for result in json.loads(collector.out))
    assert wmrgen_cli("eval", PIONEER, "limit_twist", "vx=9", "vy=0", "omega=0").err == ""


@pytest.mark.parametrize("theta", ["pi/2", "90 deg", "pi/4 + 45*pi/180", "-3*pi/2"])
@pytest.mark.parametrize("words", [("--json",), ()])
def test_eval_is_exact_where_its_input_is(wmrgen_cli: Cli, theta: str, words: tuple[str, ...]) -> None:
    """Siegwart (3.11): theta = pi/2, r = 1, l = 1, wheel speeds 4 and 2 give (0, 3, 1); cos(pi/2) was 1e-67."""
    layout = ROOT / "robots" / "textbook_differential.yaml"
    words = ("theta=" + theta, "eta1=3", "eta2=1", *words)
    out = wmrgen_cli("eval", layout, "dynamics", *words).out
    if words[-1] == "--json":
        assert json.loads(out) == {"x_rate": 0.0, "y_rate": 3.0, "theta_rate": 1.0}
    else:
        assert [line.split()[2] for line in out.splitlines()] == ["0.0", "3.0", "1.0"] and "(" not in out


def test_eval_prints_short_exact_values(wmrgen_cli: Cli) -> None:
    def told(*words: str) -> dict[str, str]:
        lines = wmrgen_cli("eval", *words).out.splitlines()
        return {line.split()[0]: line.partition(" (")[2].removesuffix(")") for line in lines}

    heading = ("dynamics", "theta=pi/3", "eta1=1", "eta2=2/3")
    assert told(str(PIONEER), *heading) == {"x_rate": "", "y_rate": "sqrt(3)/2", "theta_rate": "2/3"}
    assert set(told(str(PIONEER), *heading, "--backend", "numpy").values()) == {""}
    steering = told(str(ROOT / "robots" / "textbook_two_steer.yaml"), "inverse", "vx=1", "vy=-1")
    assert steering["front.steer"] == "-pi/4" and steering["slip"] == ""
    long = told(str(PIONEER), "dynamics", "theta=1", "eta1=1")
    assert set(long.values()) == {""}


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


@pytest.mark.parametrize("words", [(PIONEER, "goto_pose", "x=-1"), ("textbook", "polar_gains", "k_rho=2")])
def test_eval_computes_with_numpy_too(words: tuple[str, ...], wmrgen_cli: Cli) -> None:
    found = [json.loads(wmrgen_cli("eval", *words, "--json", "--backend", b).out) for b in ("exact", "numpy")]
    assert found[1] == pytest.approx(found[0], abs=1e-12)


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


def test_eval_takes_the_options_of_the_c(wmrgen_cli: Cli) -> None:
    words = ("eval", "robots/kelly_4ws.yaml", "inverse", "vx=1", "omega=2", "--json", "--backend", "c")
    found = [json.loads(wmrgen_cli(*words, *w).out) for w in ((), ("--math", "libm"), ("--target", "host"))]
    for key, value in found[0].items():
        assert all(abs(other[key] - value) <= 2e-5 for other in found)


@pytest.mark.parametrize("zero", ["-0", "-0.0", "-0e3", "-.0 rad"])
def test_eval_hands_minus_zero_through(wmrgen_cli: Cli, robot_file: Path, zero: str) -> None:
    """The C of odometry adds dt omega = -0 to theta: -0 only where both zeros keep their sign on the way."""
    words = ("eval", robot_file, "odometry", "--backend", "c")
    single = json.loads(wmrgen_cli(*words, f"theta={zero}", "omega=-0.0", "--json").out)
    (case,) = json.loads(
        wmrgen_cli(*words, "--cases", "-", stdin=f'[{{"theta": "{zero}", "omega": -0.0}}]').out
    )
    assert [math.copysign(1.0, found["theta"]) for found in (single, case)] == [-1.0, -1.0]


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
        (("invers", "vx=1"), "inverse?"),
        (("inverse", "vx"), "NAME=VALUE"),
        (("inverse", "vx=1", "vx=2"), "vx"),
        (("inverse", "vx=nan"), "vx"),
        (("inverse", "vx=inf"), "vx"),
        (("inverse", "vx=1e999"), "vx"),
        (("inverse", "vx=9**9**9"), "vx"),
        (("inverse", "vx=1/0"), "vx"),
        (("inverse", "vx=__import__('os')"), "vx"),
        (("inverse", "vx="), "vx"),
        (("inverse", "vx=1", "--backend", "ada"), "exact c numpy casadi rust javascript"),
        (("inverse", "vx=1", "--backend", "zig"), "exact c numpy casadi rust javascript"),
    ],
)
def test_eval_refuses(wmrgen_cli: Cli, robot_file: Path, words: tuple[str, ...], says: str) -> None:
    done = wmrgen_cli("eval", robot_file, *words)
    assert (done.code, done.out) == (2, ""), done
    assert done.err.startswith("error[WMR112]") and says in done.err


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
    assert (done.code, done.out) == (2, "")
    assert done.err.startswith("error[WMR110]: nowhere.json: ")


def test_no_compiler(wmrgen_cli: Cli, robot_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    done = wmrgen_cli("eval", robot_file, "inverse", "vx=1", "--backend", "c")
    assert done.code == 4
    assert "no-such-compiler" in done.err


@pytest.mark.parametrize(
    ("backend", "vx", "note"),
    [
        ("numpy", "1e308", ""),
        ("c", "1e39", "--scalar double"),
    ],
)
def test_json_has_no_infinity(wmrgen_cli: Cli, robot_file: Path, backend: str, vx: str, note: str) -> None:
    words = ("eval", robot_file, "inverse", f"vx={vx}", "vy=0", "omega=0", "--backend", backend)
    done = wmrgen_cli(*words, "--json")
    assert len(done.err.splitlines()) == 1 and " left.spin right.spin" in done.err and note in done.err
    assert note or "--scalar" not in done.err
    found = json.loads(done.out, parse_constant=pytest.fail)
    assert found["left.spin"] is None and found["slip"] == 0.0
    assert "left.spin  = inf" in wmrgen_cli(*words).out
