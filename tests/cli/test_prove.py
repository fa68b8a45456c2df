"""`wmrgen prove`: the limits that it asks for exist, are missing, and help; its exit codes are those of its help."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

import wmrgen
from tests.conftest import GALLERY, ROOT, Outcome
from tests.depth import everyday
from wmrgen.cli.prove import needed_limits
from wmrgen.errors import NotDerivableError
from wmrgen.functions.registry import has_function, names
from wmrgen.ir.bounds.assumptions import wanted

Cli = Callable[..., Outcome]
SOME = ["car_with_trailers", "pioneer3dx"]


@pytest.fixture
def without_eva(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")


def all_functions(robot: wmrgen.Robot) -> list[str]:
    """The functions that a robot has."""
    derivation, found = wmrgen.derive(robot), []
    for name in names():
        try:
            derivation.formula(name)
        except NotDerivableError:
            continue
        found.append(name)
    return found


def with_limits(content: dict[str, Any], suggestion: str) -> dict[str, Any]:
    """A robot file with the limits of a suggestion, none of which it has yet."""
    text, _, wheel = suggestion.partition(" of the wheel ")
    limits = yaml.load(text, yaml.BaseLoader)["limits"]

    def extended(part: dict[str, Any]) -> dict[str, Any]:
        assert not part.get("limits", {}).keys() & limits.keys()
        return {**part, "limits": {**part.get("limits", {}), **limits}}

    if not wheel:
        return extended(content)
    wheels = [extended(w) if w["name"] == wheel else w for w in content["wheels"]]
    assert wheels != content["wheels"]
    return {**content, "wheels": wheels}


@pytest.mark.parametrize("name", everyday([path.stem for path in GALLERY], SOME))
def test_the_limits_that_a_function_needs_let_it_be_analysed(name: str) -> None:
    """Of every function that a robot has: the format takes the limits, and with them each input has a range."""
    path = next(path for path in GALLERY if path.stem == name)
    content = yaml.load(path.read_text(encoding="utf-8"), yaml.BaseLoader)
    robot = wmrgen.load(content)
    missing = wmrgen.derive(robot).bounds.missing
    if missing:
        content = with_limits(content, wanted(missing))
        robot = wmrgen.load(content)
    derivation = wmrgen.derive(robot, all_functions(robot))
    bounds = derivation.bounds
    assert not bounds.missing
    needed = {
        f.name: needed_limits(derivation, bounds, f.name, f.unknown) for f in bounds.functions if f.unknown
    }
    helped = [function for function, limits in needed.items() if limits]
    for suggestion in dict.fromkeys(text for function in helped for text in needed[function]):
        content = with_limits(content, suggestion)
    after = wmrgen.derive(wmrgen.load(content), ["inverse", *filter(has_function, helped)]).bounds
    assert [f.name for f in after.functions if f.unknown and f.name in helped] == []


@pytest.mark.slow
@pytest.mark.usefixtures("without_eva")
@pytest.mark.parametrize("name", ["care_o_bot_4", "jpl_osr", "car_with_trailers"])
def test_a_limit_of_steering_angles_narrows_their_ranges(name: str) -> None:
    """Where a formula is singular at some steering angle, and no limit keeps the angle away from it."""
    path = ROOT / "robots" / f"{name}.yaml"
    content = yaml.load(path.read_text(encoding="utf-8"), yaml.BaseLoader)
    content["limits"] = {"vx": "1", "omega": "2"}
    derivation = wmrgen.derive(wmrgen.load(content), ["inverse", "circle"])
    before = next(f for f in derivation.bounds.functions if f.name == "circle")
    free = [n for n in before.inputs if n.endswith(".steer") and n not in derivation.bounds.declared]
    assert any(o.singular for o in before.outputs) or not free
    for suggestion in needed_limits(derivation, derivation.bounds, "circle", free):
        content = with_limits(content, suggestion)
    after = wmrgen.derive(wmrgen.load(content), ["inverse", "circle"]).bounds
    (circle,) = (f for f in after.functions if f.name == "circle")
    assert all(circle.inputs[n][1] < before.inputs[n][1] for n in free)


@pytest.mark.usefixtures("without_eva")
@pytest.mark.parametrize(
    ("name", "code"), [("bicycle", 0), ("pioneer3dx", 0), ("unicycle", 3), ("car_with_trailers", 3)]
)
def test_exit_codes(wmrgen_cli: Cli, name: str, code: int) -> None:
    """Encoder counts of the Pioneer have no limits; the car's virtual wheel needs one; the unicycle has none at all."""
    path = ROOT / "robots" / f"{name}.yaml"
    done = wmrgen_cli("prove", path)
    assert done.code == code and ("error[WMR113]" in done.err) == (code == 3)
    found = json.loads(wmrgen_cli("prove", path, "--json").out)
    assert found.get("exit_code", 0) == code
    assert name == "unicycle" or found["functions"]["inverse"]["proved"]


@pytest.mark.usefixtures("without_eva")
def test_a_limit_is_asked_for_only_if_it_helps(wmrgen_cli: Cli, tmp_path: Path) -> None:
    """The corners of a centre of rotation have no limit; the rates of a twist have one that the file gives."""
    path = tmp_path / "pioneer3dx.yaml"
    text = (ROOT / "robots" / "pioneer3dx.yaml").read_text(encoding="utf-8")
    assert "vx_rate" in text
    path.write_text(
        text.replace("functions: [", "functions: [dynamics, accelerations, pursuit, wheel_motion, ")
    )
    done = wmrgen_cli("prove", path)
    assert done.code == 0 and "limits: {" not in done.out + done.err
