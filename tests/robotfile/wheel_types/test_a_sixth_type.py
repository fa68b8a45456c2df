"""A sixth wheel type, registered from outside the package: it goes all the way from the robot file to C.

The twin castor swivels as a castor does. The runner (an ice skate, the knife edge of Chaplygin's sleigh) differs from
the five types: it has a sliding row and no spin. The expected values are written by hand from the velocity of a point.
"""

from __future__ import annotations

import contextlib
import json
import re
import shutil
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import atan2, cos, hypot, sin
from pathlib import Path

import pytest

from tests.conftest import Outcome
from wmrgen import derive, load
from wmrgen.errors import Code, NotDerivableError
from wmrgen.functions.registry import names
from wmrgen.report.sections.rows import general_rows
from wmrgen.robotfile.wheel_types import WHEEL_TYPES, Glyph, WheelType, Words, register

Cli = Callable[..., Outcome]

TWIN_CASTOR = WheelType(
    name="twin_castor",
    meaning="two wheels side by side that trail one steering axis",
    noun="twin castor",
    joints=("spin", "steer"),
    keys=("offset_y",),
    required=("r", "d"),
    oriented=False,
    aliases={"double": ""},
    words=Words("The two wheels of a twin castor roll as one between them:", free="a twin castor swivels"),
    glyph=Glyph("#123456", width=1.4, sign=5),
)
RUNNER = WheelType(
    name="runner",
    meaning="a blade that slides along itself and not across",
    noun="runner",
    joints=(),
    words=Words("A runner does not slide across its blade:"),
    glyph=Glyph("#654321", width=0.2, sign=1),
)
CART = """\
wmrgen: 1
name: cart
wheels:
  - {name: left, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05}
  - {name: right, type: fixed, x: 0, y: -0.2, heading: 0, r: 0.05}
  - {name: twin, type: twin_castor, x: 0.3, y: 0.1, r: 0.04, d: -0.03, actuated: [spin, steer]}
"""
SLEIGH = """\
wmrgen: 1
name: sleigh
wheels:
  - {name: blade, type: runner, x: 0, y: 0, heading: 0}
  - {name: front, type: steered, x: 0.5, y: 0, heading: 0, r: 0.1}
"""


@pytest.fixture(autouse=True)
def _registered() -> Iterator[None]:
    register(TWIN_CASTOR)
    register(RUNNER)
    yield
    del WHEEL_TYPES["twin_castor"], WHEEL_TYPES["runner"]


@pytest.fixture(params=["numpy", "casadi", "c"])
def backend(request: pytest.FixtureRequest) -> str:
    if request.param == "c" and not shutil.which("cc"):
        pytest.skip("no C compiler")
    return str(request.param)


def written(folder: Path, text: str) -> Path:
    path = folder / "robot.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def values(cli: Cli, *words: object) -> dict[str, float]:
    done = cli("eval", *words, "--json")
    assert done.code == 0, done.err
    return dict(json.loads(done.out))


def test_a_twin_castor_follows(wmrgen_cli: Cli, tmp_path: Path, backend: str) -> None:
    """Contact at A + d e: its velocity is r spin along e, and across e it follows from d steer_rate."""
    robot, steer, vx, omega = written(tmp_path, CART), 0.7, 0.4, 0.9
    inputs = ("vx=0.4", "vy=0", "omega=0.9", "twin.steer=0.7")
    found = values(wmrgen_cli, robot, "inverse", *inputs, "--backend", backend)
    ax, ay = vx - 0.1 * omega, 0.3 * omega
    along, across = ax * cos(steer) + ay * sin(steer), ay * cos(steer) - ax * sin(steer)
    assert found["twin.spin"] == pytest.approx(along / 0.04, rel=1e-5)
    assert found["twin.steer_rate"] == pytest.approx(across / 0.03 - omega, rel=1e-5)
    assert found["slip"] == pytest.approx(0, abs=1e-6)
    rates = [f"{k}={found[k]!r}" for k in ("left.spin", "right.spin", "twin.spin", "twin.steer_rate")]
    twist = values(wmrgen_cli, robot, "forward", *rates, "twin.steer=0.7", "--backend", backend)
    assert [twist[k] for k in ("vx", "vy", "omega")] == pytest.approx([vx, 0, omega], abs=1e-5)


def test_a_runner_forbids_sliding(wmrgen_cli: Cli, tmp_path: Path, backend: str) -> None:
    """The blade is at P and points forward: vy is forbidden, and the front wheel steers as on a bicycle."""
    robot = written(tmp_path, SLEIGH)
    inputs = ("vx=0.6", "vy=0.2", "omega=0.5", "front.steer=0")
    found = values(wmrgen_cli, robot, "inverse", *inputs, "--backend", backend)
    assert found["front.steer"] == pytest.approx(atan2(0.25, 0.6), rel=1e-5)
    assert found["front.spin"] == pytest.approx(hypot(0.6, 0.25) / 0.1, rel=1e-5)
    assert found["slip"] == pytest.approx(0.2, rel=1e-5)
    twist = values(
        wmrgen_cli, robot, "forward", f"front.spin={found['front.spin']!r}",
        f"front.steer={found['front.steer']!r}", "--backend", backend,
    )  # fmt: skip
    assert [twist[k] for k in ("vx", "vy", "omega")] == pytest.approx([0.6, 0, 0.5], abs=1e-5)


@pytest.mark.parametrize(("text", "mobility"), [(CART, [2, 0]), (SLEIGH, [1, 1])])
def test_everything_is_written(wmrgen_cli: Cli, tmp_path: Path, text: str, mobility: list[int]) -> None:
    done = wmrgen_cli("derive", written(tmp_path, text), "-o", tmp_path / "out")
    assert done.code == 0, done.err
    (folder,) = (tmp_path / "out").iterdir()
    model = json.loads((folder / "model.json").read_text())
    assert model["robot_type"] == mobility
    own = next(w for w in model["wheels"] if w["type"] in ("twin_castor", "runner"))
    kind = WHEEL_TYPES[own["type"]]
    report = (folder / "report.md").read_text(encoding="utf-8")
    assert kind.words.intro in report and f"one {kind.noun}" in report
    svg = (folder / "layout.svg").read_text()
    assert f".{kind.name} {{ fill: {kind.glyph.fill}; }}" in svg
    shapes = [e for e in ET.fromstring(svg).iter() if e.get("class") == f"wheel {kind.name}"]
    assert len(shapes) == 2  # the wheel, and its sign in the legend
    assert f"{own['name']}: {kind.name}, x" in (folder / f"{folder.name}.h").read_text()


def test_a_runner_beside_a_fixed_wheel(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """No textbook has this pair, so the report cites none. A wheel without r shows no r."""
    wheels = "  - {name: blade, type: runner, x: 0, y: -0.2, heading: 0}\n"
    wheels += "  - {name: drive, type: fixed, x: 0, y: 0.2, heading: 0, r: 0.05}\n"
    robot = written(tmp_path, "wmrgen: 1\nname: cart\nwheels:\n" + wheels)
    done = wmrgen_cli("derive", robot, "-o", tmp_path / "out")
    assert done.code == 0, done.err
    report = (tmp_path / "out" / "cart" / "report.md").read_text(encoding="utf-8")
    assert "The wheels `blade` and `drive` forbid motion along the axle" in report
    assert "In the textbooks" not in report
    assert "| `blade` | runner | — | 0 | −0.2 | 0.2 | −90° | 180° | 0° | — |" in report
    assert "blade: runner, x 0 m, y -0.2 m, heading 0 deg\n" in (tmp_path / "out/cart/cart.h").read_text()


def test_a_key_that_no_wheel_has(tmp_path: Path) -> None:
    robot = written(tmp_path, SLEIGH)
    for change in ({"keys": ("gama",)}, {"required": ("gama",)}):
        WHEEL_TYPES["runner"] = replace(RUNNER, **change)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match=r"runner .*gama"):
            load(robot)


def test_every_function_is_that_of_a_castor(tmp_path: Path) -> None:
    """All functions of the twin castor are those of a castor."""
    twin = load(written(tmp_path, CART))
    castor = load(written(tmp_path, CART.replace("twin_castor", "castor")))
    derivable = []
    for name in names():
        try:
            expected = derive(castor, (name,)).raw_module
        except NotDerivableError as no:
            with pytest.raises(NotDerivableError, match=re.escape(str(no).splitlines()[0])):
                _ = derive(twin, (name,)).raw_module
            continue
        assert derive(twin, (name,)).raw_module == expected
        derivable.append(name)
    assert {"inverse", "forward", "odometry", "accelerations", "configuration", "slip_inverse"} <= {
        *derivable
    }


def test_every_function_of_a_sleigh_is_derived_or_refused_in_words(tmp_path: Path) -> None:
    sleigh = load(written(tmp_path, SLEIGH))
    derivable = []
    for name in names():
        with contextlib.suppress(NotDerivableError):
            assert derive(sleigh, (name,)).raw_module
            derivable.append(name)
    assert {"inverse", "forward", "odometry", "icr", "posture", "chained", "zeta"} <= {*derivable}


def test_what_a_runner_has_of_a_wheel(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """A runner slips across and not along, its contact moves along and across, and it is not a ball even with an r."""
    robot = written(tmp_path, SLEIGH.replace("heading: 0}", "heading: 90 deg, r: 0.1}", 1))
    twist = ("vx=0.6", "vy=0.2", "omega=0.5")
    slips = values(wmrgen_cli, robot, "slip_inverse", *twist, "front.steer=0", "front.slip_x=0")
    assert slips["blade.slip_y"] == pytest.approx(-0.6) and "blade.spin" not in slips
    moves = values(wmrgen_cli, robot, "projections", *twist, "front.steer=0", "theta=0")
    assert (moves["blade.along"], moves["blade.across"]) == pytest.approx((0.2, -0.6))
    assert wmrgen_cli("eval", robot, "contacts", *twist).code == 3


def test_the_reader_knows_it(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """Each error has its code, and names the wheel, the key or the type that is meant."""
    trouble = {
        CART.replace("d: -0.03, ", ""): (Code.MISSING, " twin ", " d\n"),
        CART.replace("d: -0.03, ", "d: 0, "): (Code.VALUE, "twin castor", "d = 0"),
        CART.replace("type: twin_castor", "type: double"): (Code.FORM, "twin_castor?"),
        SLEIGH.replace("heading: 0}\n  - {name: front", "heading: 0, gamma: 0}\n  - {name: front"):
            (Code.TWICE, " runner ", " gamma\n"),
        SLEIGH.replace("heading: 0}", "heading: 0, actuated: [spin]}", 1): (Code.FORM, " runner ", "'spin'"),
        SLEIGH.replace(" type: runner,", ""): (Code.MISSING, " ".join(WHEEL_TYPES)),
    }  # fmt: skip
    for text, (code, *words) in trouble.items():
        done = wmrgen_cli("derive", written(tmp_path, text), "-o", tmp_path / "out")
        assert done.code == 2 and f"error[{code}]" in done.err, done.err
        assert all(word in done.err for word in words), (words, done.err)


def test_the_schema_knows_it() -> None:
    from wmrgen.robotfile.schema import json_schema

    assert json_schema()["$defs"]["runner"]["description"] == RUNNER.meaning


def test_the_report_has_the_equations_of_a_wheel() -> None:
    """A crawler rolls and slides across its line, a runner slides along it: one equation each."""
    crawler = replace(WHEEL_TYPES["fixed"], sliding_row=False)
    for kind, right in ((crawler, r"\dot{\varphi}"), (RUNNER, "0")):
        (line,) = [line for line in "\n".join(general_rows(kind, False)).split("\n") if "&=" in line]
        assert line.partition("&=")[2].split("&&")[0].strip().endswith(right)
