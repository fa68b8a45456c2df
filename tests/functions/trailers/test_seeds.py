"""Cases of structure: Frobenius, chained form, Brockett, the locked bicycle; each through the command line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import wmrgen
from tests.depth import BACKENDS
from tests.functions.motion.common import compute, run_cli
from tests.oracle.harness import robot_text
from tests.robots import of_text
from tests.seeds import layouts

CASES: dict[str, Any] = {
    c["id"]: c
    for c in json.loads((Path(__file__).parents[3] / "textbook" / "cases.json").read_text(encoding="utf-8"))[
        "cases"
    ]
}
WHEEL = "wmrgen: 1\nname: sample\nwheels:\n  - {name: wheel, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}\n"
DIFFERENTIAL = """wmrgen: 1
name: sample
wheels:
  - {name: right, type: fixed, x: 0, y: -0.3, heading: 0, r: 0.1}
  - {name: left, type: fixed, x: 0, y: 0.3, heading: 0, r: 0.1}
"""
CAR = """wmrgen: 1
name: sample
wheels:
  - {{name: rear, type: fixed, x: 0, y: 0, heading: 0, r: 0.1}}
  - {{name: front, type: steered, x: {D}, y: 0, heading: 0, r: 0.1, actuated: [steer]}}
"""


class Robot:
    """A robot file, asked through ``wmrgen eval``."""

    def __init__(self, folder: Path, text: str, backend: str) -> None:
        self.path, self.backend = folder / "sample.yaml", backend
        self.path.write_text(text, encoding="utf-8")

    def call(self, function: str, values: dict[str, float]) -> list[float]:
        return list(compute(self.path, function, [values], self.backend)[0].values())


def close(case: dict[str, Any], actual: Any, wanted: Any) -> None:
    np.testing.assert_allclose(
        np.asarray(actual, float), np.asarray(wanted, float), rtol=case["tol"], atol=case["tol"]
    )


def test_t_2_25_frobenius() -> None:
    case = CASES["T-2.25-frobenius"]
    row = of_text(WHEEL).integrability.row("wheel")
    close(case, float(row.value), case["expect"]["c_dot_curl_c"])
    assert row.integrable is case["expect"]["integrable"]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("text", [WHEEL, DIFFERENTIAL], ids=["unicycle", "differential"])
def test_t_2_62(text: str, backend: str, tmp_path: Path) -> None:
    case = CASES["T-2.62"]
    robot = Robot(tmp_path, text, backend)
    state = dict(zip(("x", "y", "theta"), case["given"]["state"], strict=True))
    given, expect = case["given"]["input"], case["expect"]
    close(case, robot.call("chained", state), expect["z"])
    rates = robot.call("chained_rates", state | given)
    close(case, rates, expect["z_rate"])
    close(case, rates[:2], expect["u"])
    back = robot.call("chained_input", state | dict(zip(("u1", "u2"), expect["u"], strict=True)))
    close(case, [back[0], back[3]], [given["v"], given["omega"]])


@pytest.mark.parametrize("backend", BACKENDS)
def test_t_2_64(backend: str, tmp_path: Path) -> None:
    case = CASES["T-2.64"]
    robot = Robot(tmp_path, DIFFERENTIAL, backend)
    state = dict(zip(("x", "y", "theta"), case["given"]["state"], strict=True))
    close(case, robot.call("brockett", state), case["expect"]["x"])
    rates = robot.call("brockett_rates", state | case["given"]["input"])
    close(case, rates, case["expect"]["x_rate"])
    back = robot.call("brockett_input", state | {"u1": rates[0], "u2": rates[1]})
    close(case, [back[0], back[3]], [case["given"]["input"][k] for k in ("v", "omega")])


@pytest.mark.parametrize("backend", BACKENDS)
def test_t_2_67(backend: str, tmp_path: Path) -> None:
    case = CASES["T-2.67"]
    given, expect = case["given"], case["expect"]
    robot = Robot(tmp_path, CAR.format(D=given["D"]), backend)
    state = dict(zip(("x", "y", "theta", "front.steer"), given["state"], strict=True))
    close(case, robot.call("chained", state), expect["x"])
    own = robot.call("chained_input", state | dict(zip(("u1", "u2"), given["u"], strict=True)))
    close(case, [own[0], own[-1]], expect["v"])
    rates = robot.call("chained_rates", state | {"v": own[0], "front.steer_rate": own[-1]})
    close(case, rates, expect["x_rate"])


@pytest.mark.parametrize("backend", BACKENDS)
def test_s_lockbike_phi(backend: str, tmp_path: Path) -> None:
    """phi = x/r + phi0 and, for the second wheel, -x/r + phi0; nothing but x moves."""
    case = CASES["S-lockbike-phi"]
    layout, _ = layouts.of(case, "cartesian")
    robot = Robot(tmp_path, robot_text(layout), backend)
    g = case["given"]
    angles = robot.call("wheel_angles", {"x": g["x"], "w1.angle": g["phi0"], "w2.angle": g["phi0"]})
    close(case, angles, [case["expect"][k] for k in ("phi_wheel1", "phi_wheel2")])


def test_a_holo(tmp_path: Path) -> None:
    """AA274, definitions 1 and 2: holonomic robots are those whose constraints integrate together."""
    for name in ("A-three-fixed-concurrent", "S-lockbike", "S-lockbike-bent"):
        case = CASES[name]
        layout, _ = layouts.of(case, "cartesian")
        path = tmp_path / "sample.yaml"
        path.write_text(robot_text(layout), encoding="utf-8")
        whole = wmrgen.derive(wmrgen.load(path)).integrability
        assert whole.ddof == case["expect"]["delta_m"]
        assert whole.holonomic == case["expect"].get("holonomic", whole.ddof == whole.dof)


@pytest.mark.parametrize("backend", ["text", "json", "latex"])
def test_the_chained_form_is_printed(backend: str, tmp_path: Path) -> None:
    """`wmrgen model --form chained`: transformation, inputs, domain and the verification."""
    path = tmp_path / "sample.yaml"
    path.write_text(CAR.format(D=1.4), encoding="utf-8")
    out, _ = run_cli(
        "model", str(path), "--form", "chained", *([] if backend == "text" else [f"--{backend}"])
    )
    if backend == "json":
        sheet = json.loads(out)
        assert sheet["equations"]["z3"] == "tan(theta)" and sheet["equations"]["v"] == "u1/cos(theta)"
        assert sheet["domain"][0]["condition"] == "cos(theta) = 0"
        assert "hold exactly at 3 rational points" in sheet["text"]
    elif backend == "text":
        assert "(2,4) chain" in out and "z2               = kappa/cos(theta)**3" in out
        assert "front.steer_rate = " in out and "cos(front.steer)/5 = 0" in out
    else:
        assert r"\frac{\kappa" in out or r"\kappa" in out or "kappa" in out


@pytest.mark.parametrize("name", ["bicycle", "locked_bicycle", "festo_robotino", "synchro_drive"])
def test_structure_is_printed(name: str) -> None:
    """`wmrgen structure`: the proofs, the integrals, the brackets, and why something is not there."""
    path = Path(__file__).parents[3] / "robots" / f"{name}.yaml"
    printed, _ = run_cli("structure", str(path))
    facts = json.loads(run_cli("structure", str(path), "--json")[0])
    d = wmrgen.derive(wmrgen.load(path))
    assert facts["holonomic"] == d.mobility.holonomic and facts["text"] in printed
    assert all(row["proof"] in printed and not row["integrable"] for row in facts["constraints"])
    assert len(facts["fields"]) == d.mobility.growth_vector[-1]
    assert facts["chained"].startswith("none: " if name != "bicycle" else "(2,4) chain")
    assert facts["flat"].startswith("none: ") == (name == "locked_bicycle")
    assert tuple(facts["growth_vector"]) == d.mobility.growth_vector
    assert all(row["value"] == "-1" for row in facts["constraints"])  # Tzafestas (2.25): c . curl c
