"""`wmrgen model`, and long trains."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import casadi
import pytest
import sympy

from tests.functions.motion.common import run_cli

ROBOTS = Path(__file__).parents[3] / "robots"
SINGULAR = "cos(front.steer) = 0: G is unbounded"


def wmrgen(*words: str | Path, code: int = 0) -> str:
    out, error = run_cli(*map(str, words), code=code)
    return error if code else out


def test_posture_in_plain_notation() -> None:
    lines = wmrgen("model", ROBOTS / "bicycle.yaml", "--form", "posture").splitlines()
    assert "  x'           = rear.spin*r*cos(theta)" in lines
    assert "  theta'       = rear.spin*r*tan(front.steer)/wheelbase" in lines
    assert "with:   wheelbase = 11/10, r = 17/50" in lines
    assert "  rear.spin: [r*cos(theta), r*sin(theta), r*tan(front.steer)/wheelbase, 0]" in lines
    assert any(SINGULAR in line for line in lines)


def test_trailers_name_their_jack_knife() -> None:
    shown = wmrgen("model", ROBOTS / "car_with_trailers.yaml", "--form", "trailer")
    assert "cos(theta - trailer1.theta) = 0: trailer1 is jack-knifed" in shown
    model = json.loads((ROBOTS.parent / "generated/car_with_trailers/model.json").read_text(encoding="utf-8"))
    assert "jack-knifed" in model["singular_models"]["trailer"][1]["meaning"]


@pytest.mark.slow
@pytest.mark.parametrize("form", ["posture", "configuration", "eta", "zeta", "trailer", "chained"])
def test_json_and_latex_of_every_form(form: str) -> None:
    sheets = json.loads(wmrgen("model", ROBOTS / "car_with_trailers.yaml", "--form", form, "--json"))
    for sheet in sheets if isinstance(sheets, list) else [sheets]:
        assert sheet["inputs"] and sheet["equations"]
        assert all(len(field) == len(sheet["state"]) for field in sheet["fields"].values())
    shown = wmrgen("model", ROBOTS / "car_with_trailers.yaml", "--form", form, "--latex")
    assert shown.startswith("\\begin{aligned}") and shown.rstrip().endswith("\\end{aligned}")


def test_what_there_is_not_is_said() -> None:
    assert "no trailers" in wmrgen("model", ROBOTS / "bicycle.yaml", "--form", "trailer", code=3)
    assert "zeta form" in wmrgen("model", ROBOTS / "pioneer3dx.yaml", "--form", "zeta", code=3)
    assert "Missing actuation" in wmrgen("model", ROBOTS / "unicycle.yaml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hitch", "functions"),
    [("0", "chained, chained_input, chained_rates"), ("0", "trailer"), ("0.15", "trailer")],
)
def test_eight_trailers_derive(hitch: str, functions: str, tmp_path: Path) -> None:
    """C and CasADi included; each case of fewer trailers is quicker."""
    text = (ROBOTS / "car_with_trailers.yaml").read_text(encoding="utf-8")
    head = text[: text.index("trailers:\n")]
    trailers = "".join(f"  - {{length: {0.5 + 0.1 * k:.1f}, hitch: {hitch}}}\n" for k in range(8))
    path = tmp_path / "train.yaml"
    path.write_text(f"{head}trailers:\n{trailers}functions: [{functions}]\n", encoding="utf-8")
    wmrgen("derive", path, "-o", tmp_path / "out")
    files = {f.name for f in (tmp_path / "out" / "car_with_trailers").iterdir()}
    assert {"car_with_trailers.c", *(f"car_with_trailers_{f}.casadi" for f in functions.split(", "))} <= files


def test_long_fractions_are_decimals_for_readers_only(tmp_path: Path) -> None:
    """A heading of 1 rad has sine and cosine of 40 digits: text shows 12, --json the exact fractions."""
    path = tmp_path / "leaning.yaml"
    path.write_text(
        "wmrgen: 1\nname: leaning\nwheels:\n  - {name: w, type: fixed, x: 0.3, y: 0.1, heading: 1, r: 0.1}\n",
        encoding="utf-8",
    )
    shown = wmrgen("model", path)
    assert "rounded for reading" in shown and not re.search(r"\d{13}", shown)
    exact = json.loads(wmrgen("model", path, "--json"))["fields"]
    c, s = math.cos(1), math.sin(1)
    for x, y, omega in exact.values():
        x, y, omega = (float(sympy.parse_expr(e).subs("theta", 0)) for e in (x, y, omega))
        across = c * (y + 0.3 * omega) - s * (x - 0.1 * omega)
        assert across == pytest.approx(0, abs=1e-15)
    proof = wmrgen("structure", path)
    assert "0.841470984808*cos(theta)" in proof and "c . curl c = -1 != 0" in proof
    assert "rounded" not in wmrgen("model", ROBOTS / "bicycle.yaml")


def test_a_step_is_printed_and_written(tmp_path: Path) -> None:
    """x + dt f of a robot that drives straight, in text, JSON and a file that CasADi loads."""
    words = ("model", ROBOTS / "bicycle.yaml", "--discrete", "rk4", "--dt", "0.5", "rear.spin=2", "x=3")
    step = json.loads(wmrgen(*words, "--json"))
    assert step["xnext"] == pytest.approx([3 + 0.5 * 2 * 0.34, 0, 0, 0])
    assert step["B"][0] == pytest.approx([0.5 * 0.34, 0]) and step["A"][0][0] == 1
    assert step["A"][1][2] == pytest.approx(0.34)  # dy per heading
    assert sum(map(float.__mul__, step["A"][0], [3.0, 0.0, 0.0, 0.0])) + 2 * step["B"][0][0] + step["c"][
        0
    ] == pytest.approx(step["xnext"][0])
    rows = wmrgen(*words).splitlines()
    assert rows[3].split()[:2] == ["x", "3.34"]
    wmrgen(*words[:-2], "-o", tmp_path / "step.casadi")
    f = casadi.Function.load(str(tmp_path / "step.casadi"))
    assert f([3, 0, 0, 0], [2, 0], [])[0].full().ravel() == pytest.approx(step["xnext"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--dt", "1"), "--discrete"),
        (("x=1",), "--discrete"),
        (("--discrete", "rk4"), "takes --dt"),
        (("--discrete", "rk4", "--dt", "0"), "takes time"),
        (("--discrete", "rk4", "--dt", "-0.1"), "takes time"),
        (("--discrete", "rk4", "--dt", "1", "--form", "chained"), "chained"),
        (("--discrete", "rk4", "--dt", "1", "speed=1"), "no input 'speed'"),
        (("--discrete", "exact", "--dt", "1"), "rk4"),
        (("--latex", "--json"), "Leave out --json"),
        (("--latex", "--discrete", "rk4", "--dt", "1"), "Leave out --json"),
        (
            (
                "--discrete",
                "collocation",
                "--dt",
                "1e3",
                "rear.spin=6",
                "front.steer=0.3",
                "front.steer_rate=1",
            ),
            "a smaller --dt",
        ),
        (("--discrete", "rk4", "--dt", "1", "-o", "my step.casadi"), "not a name"),
    ],
)
def test_a_step_that_cannot_be_is_refused(words: tuple[str, ...], message: str) -> None:
    assert message in wmrgen("model", ROBOTS / "bicycle.yaml", *words, code=2)


def test_a_step_where_the_model_is_singular_is_refused(tmp_path: Path) -> None:
    """A front wheel whose zero is across the robot: at 0 it gave NaN, which nobody explained."""
    path = tmp_path / "across.yaml"
    text = (ROBOTS / "bicycle.yaml").read_text(encoding="utf-8")
    path.write_text(
        text.replace("y: 0, heading: 0, r: r, act", "y: 0, heading: 90 deg, r: r, act"), encoding="utf-8"
    )
    words = ("model", path, "--discrete", "rk4", "--dt", "0.1", "rear.spin=1")
    assert "does not hold where sin(front.steer) = 0: G is unbounded" in wmrgen(*words, code=2)
    assert wmrgen(*words, "front.steer=1.5")
    quarter = ("model", ROBOTS / "bicycle.yaml", *words[2:])
    assert "does not hold where cos(front.steer) = 0: G is unbounded" in wmrgen(
        *quarter, "front.steer=pi/2", code=2
    )
    everywhere = (
        "model",
        ROBOTS / "pioneer3dx.yaml",
        "--discrete",
        "rk4",
        "--dt",
        "1e300",
        "left.spin=1e300",
    )
    assert "numbers overflow. Write other values" in wmrgen(*everywhere, code=2)


def test_it_is_said_which_form_holds_where() -> None:
    """Of a swerve drive, of a car and of a skid-steer, in words and as data."""
    lines = wmrgen("model", ROBOTS / "wpilib_swervebot.yaml").splitlines()
    told = {line.split()[0]: line for line in lines[lines.index("regular:") + 1 :]}
    assert told["twist"].split(maxsplit=1)[1] == "in every motion"
    assert "sin(back_right.steer) + cos(back_right.steer) = 0: G is unbounded" in told["posture"]
    assert "front_left" in told["eta"] and "back_right" in told["eta"] and "form twist" in told["eta"]
    sets = json.loads(wmrgen("model", ROBOTS / "ackermann_car.yaml", "--json"))["singular_sets"]
    assert [len(sets[form]) for form in ("posture", "twist", "eta")] == [1, 0, 0]
    lines = wmrgen("model", ROBOTS / "clearpath_a200.yaml").splitlines()
    told = {line.split()[0]: line for line in lines[lines.index("regular:") + 1 :]}
    assert "slide" in told["posture"] and "slide" not in told["twist"]
