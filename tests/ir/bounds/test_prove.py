"""`wmrgen prove`, and the bounds in header, report and model.json."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import wmrgen
from tests.conftest import command_line
from tests.robots import of_gallery, of_text
from wmrgen.cli.prove import eva
from wmrgen.derivation.emit import artifacts
from wmrgen.ir.bounds.robot import TIES
from wmrgen.ir.kernels.choice import choice

ROBOTS = Path(__file__).parents[3] / "robots"


@pytest.fixture
def no_eva(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wmrgen.codegen.compiler.find_tool", lambda name: None)


@pytest.mark.usefixtures("no_eva")
def test_prints_bounds_and_says_that_eva_is_missing() -> None:
    done = command_line("prove", ROBOTS / "pioneer3dx.yaml")
    assert done.code == 0
    assert "left.spin" in done.out and "error" in done.out
    assert "|vx| <= 1.2" in done.out
    assert "Eva was not run: frama-c is not on the PATH" in done.err
    assert TIES not in done.out


@pytest.mark.usefixtures("no_eva")
def test_says_of_steered_wheels_what_bounds_mean_at_ties() -> None:
    done = command_line("prove", ROBOTS / "f1tenth.yaml")
    assert TIES in done.out


@pytest.mark.usefixtures("no_eva")
def test_json_is_what_model_json_has() -> None:
    done = command_line("prove", "--json", ROBOTS / "pioneer3dx.yaml")
    printed = json.loads(done.out)
    model = of_gallery("pioneer3dx").model()
    assert printed["eva"]["run"] is False
    assert {key: printed[key] for key in model["bounds"]} == json.loads(json.dumps(model["bounds"]))
    spin = printed["functions"]["inverse"]["outputs"]["left.spin"]
    assert spin["range"][0] < 0 < spin["range"][1]
    assert 0 < spin["error"] < 1e-4


@pytest.mark.parametrize(
    ("printed", "alarms"),
    [
        ("[eva] done for function main\n", []),
        ("[eva:alarm] a.c:3: division by zero\n[eva] done for function main\n", ["a.c:3: division by zero"]),
        ("[eva] Failure\n", ["the analysis did not come to its end: [eva] Failure"]),
    ],
)
def test_what_eva_says_is_told(printed: str, alarms: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Here a tool that says the same of whatever it is given."""
    monkeypatch.setattr("wmrgen.codegen.compiler.find_tool", lambda name: name)
    monkeypatch.setattr("wmrgen.codegen.compiler.run_tool", lambda command, files: printed)
    wheel = "{name: disk, type: fixed, x: 0, y: 0, heading: 0, r: 0.3}"
    text = f"wmrgen: 1\nname: disk\nlimits: {{vx: 1, omega: 2}}\nwheels: [{wheel}]\n"
    derivation = of_text(text, ["inverse"])
    verdict = eva(derivation, derivation.bounds)
    assert verdict["run"] is True and set(verdict["alarms"]) == set(alarms)


def test_says_which_limits_are_needed(tmp_path: Path) -> None:
    text = (ROBOTS / "pioneer3dx.yaml").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith(("limits:", "functions:"))]
    path = tmp_path / "pioneer3dx.yaml"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    done = command_line("prove", path)
    assert done.code == 3
    assert "limits: {vx: 1.0, omega: 2.0}" in done.err
    files = artifacts(wmrgen.derive(wmrgen.load(path)))
    assert "bounds" not in json.loads(files["model.json"])
    assert b"Proved for" not in files["pioneer3dx.h"]
    assert b"no limits of `vx` and `omega`" in files["numerics.md"]


@pytest.mark.usefixtures("no_eva")
def test_says_which_limits_a_virtual_wheel_needs(tmp_path: Path) -> None:
    """Rates that nothing commands, and an angle at which the model of a car with trailers is singular."""
    text = (ROBOTS / "car_with_trailers.yaml").read_text(encoding="utf-8")
    path = tmp_path / "car_with_trailers.yaml"

    def proved(limits: str) -> str:
        lines = [f"limits: {limits}" if line.startswith("limits:") else line for line in text.splitlines()]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return command_line("prove", path).out

    assert "needs limits: {steer_rate: 2.0}" in proved("{vx: 2, omega: 1}")
    assert "perhaps it needs limits: {steer: 60 deg}" in proved("{vx: 2, omega: 1, steer_rate: 2}")
    complete = proved("{vx: 2, omega: 1, steer_rate: 2, steer: 60 deg}")
    assert "needs" not in complete and "not proved" not in complete and "no range" not in complete
    assert "trailer2.theta_rate" in complete


def test_bounds_stand_in_the_files() -> None:
    derivation = of_gallery("clearpath_do100")
    files = artifacts(derivation)
    bound = {f.name: f for f in derivation.bounds.functions}["inverse"].outputs[0]
    stored = json.loads(files["model.json"])["bounds"]["functions"]["inverse"]["outputs"][bound.name]
    assert stored == {"range": [bound.low, bound.high], "error": bound.error}
    for file in ("clearpath_do100.h", "numerics.md"):
        text = files[file].decode()
        assert "Proved for" in text
        assert f"{bound.high:.6g}" in text


def test_a_double_header_has_no_bounds_of_floats() -> None:
    files = artifacts(of_gallery("clearpath_do100"), choice("double"))
    assert b"Proved for" not in files["clearpath_do100.h"]
