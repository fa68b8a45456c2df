"""What random robots showed: tunable geometry of too small a rank, parameters called k0, coupled limits and castors."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.conftest import Outcome
from wmrgen.errors import NotDerivableError, RobotFileError
from wmrgen.exact.number import Exact
from wmrgen.ir.interpret import EXACT, evaluate_module
from wmrgen.robot import Derivation

RANKS = {
    "one fixed": "{name: a, type: fixed, x: 0, y: B, heading: 0, r: 0.05}",
    "one omni": "{name: a, type: swedish, x: 0, y: -B/2, heading: 0, gamma: 0, r: 0.1}",
    "two mecanum": (
        "{name: a, type: swedish, x: B, y: B, heading: 0, gamma: 45 deg, r: 0.1}\n"
        "  - {name: b, type: swedish, x: -B, y: -B, heading: 0, gamma: -45 deg, r: 0.1}"
    ),
    "no lever": (
        "{name: a, type: fixed, x: 0, y: 0.2 - B, heading: 0, r: 0.1}\n"
        "  - {name: b, type: fixed, x: 0, y: 0.2 - B, heading: 0, r: B}"
    ),
    "fixed and castor": (
        "{name: a, type: fixed, x: B, y: 0.1, heading: 0, r: 0.1}\n"
        "  - {name: c, type: castor, x: -B, y: 0, heading: 0, d: 0.05, r: 0.04, actuated: []}"
    ),
}


def derived(folder: Path, wheels: str, parameters: str = "", more: str = "") -> Derivation:
    path = folder / "robot.yaml"
    path.write_text(f"wmrgen: 1\nname: robot\n{parameters}wheels:\n  - {wheels}\n{more}", encoding="utf-8")
    return wmrgen.derive(wmrgen.load(path))


def numbers(values: Mapping[str, Exact]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items()}


@pytest.mark.parametrize("name", RANKS)
def test_tunable_geometry_of_any_rank(name: str, tmp_path: Path) -> None:
    """At its nominal value a tunable length gives what the number gives: the solution of least norm."""
    tunable = derived(
        tmp_path, RANKS[name].replace("B", "h"), "parameters: {h: {value: 0.2, tunable: true}}\n"
    )
    plain = derived(tmp_path, RANKS[name].replace("B", "0.2"))
    random = np.random.default_rng(5)
    ports = [p.name for p in plain.formula("forward").inputs]
    for _ in range(3):
        given = {p: Exact(Fraction(int(random.integers(-50, 50)), 16)) for p in ports}
        wanted = numbers(plain.evaluate("forward", given))
        found = numbers(tunable.evaluate("forward", given | {"h": Exact(Fraction(1, 5))}))
        assert found == pytest.approx(wanted, rel=1e-12, abs=1e-12)
        prepared = numbers(evaluate_module(tunable.c_module, "forward", given, EXACT))
        assert prepared == pytest.approx({k: wanted[k] for k in prepared}, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", ["k0", "k1"])
def test_a_parameter_may_have_the_name_of_a_prepared_value(name: str, tmp_path: Path) -> None:
    parameters = f"parameters: {{{name}: {{value: 0.05, tunable: true}}, a: {{value: 0.3, tunable: true}}}}\n"
    wheels = (
        f"{{name: l, type: fixed, x: 0, y: a, heading: 0, r: {name}}}\n"
        f"  - {{name: r, type: fixed, x: 0, y: -0.2, heading: 0, r: {name}}}"
    )
    prepare = derived(tmp_path, wheels, parameters).c_module.prepare
    assert prepare is not None
    assert name not in {port.name for port in prepare.outputs}


PAIR = (
    "{{name: a, type: steered, x: 0.3, y: 0.2, heading: 0, r: 0.05, limits: {{steer: {0}}}}}\n"
    "  - {{name: b, type: steered, x: -0.3, y: 0.2, heading: 0, r: 0.05, limits: {{steer: {1}}}}}"
)
COUPLED = "couplings:\n  - equal: [a.steer, b.steer]\n"


@pytest.mark.parametrize(
    "limits", [("[-90 deg, 45 deg]", "[-45 deg, 90 deg]"), ("[-45 deg, 90 deg]", "[-90 deg, 45 deg]")]
)
def test_coupled_wheels_keep_the_limits_of_all(limits: tuple[str, str], tmp_path: Path) -> None:
    robot = derived(tmp_path, PAIR.format(*limits), "", COUPLED)
    for vy in (1, -1):
        found = robot.evaluate("inverse", {"vx": Exact(Fraction(1, 10)), "vy": Exact(vy)})
        assert float(found["a.steer"]) == float(found["b.steer"]) == pytest.approx(vy * math.pi / 4)
        assert float(found["slip"]) > 0.5


def test_axles_of_coupled_castors_are_refused_in_words(tmp_path: Path) -> None:
    wheels = (
        "{name: f, type: fixed, x: 0.25, y: -0.8, heading: 90 deg, r: 0.1}\n"
        "  - {name: g, type: fixed, x: 0.3, y: 0.3, heading: 0, r: 0.1}\n"
        "  - {name: a, type: castor, x: 0.7, y: -0.4, heading: 0, r: 0.1, d: 0.04}\n"
        "  - {name: b, type: castor, x: 0.2, y: 0.4, heading: 0, r: 0.1, d: 0.02}"
    )
    with pytest.raises(NotDerivableError, match="coupled castors"):
        derived(tmp_path, wheels, "", COUPLED).formula("axles")


def test_coupled_wheels_without_a_common_angle_are_refused(
    tmp_path: Path, wmrgen_cli: Callable[..., Outcome]
) -> None:
    with pytest.raises(RobotFileError, match="steer limits of a and b have no value in common"):
        derived(tmp_path, PAIR.format("[-45 deg, 0 deg]", "[10 deg, 45 deg]"), "", COUPLED)
    done = wmrgen_cli("derive", tmp_path / "robot.yaml", "-o", tmp_path / "out")
    assert done.code == 2 and "equal: [a.steer, b.steer]" in done.err
