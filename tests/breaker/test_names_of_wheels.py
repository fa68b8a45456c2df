"""Wheels whose names are words of a formula: no intermediate result may be defined twice."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import wmrgen
from wmrgen.errors import NotDerivableError
from wmrgen.exact.number import Exact
from wmrgen.functions.registry import names as functions
from wmrgen.robot import Derivation

ROBOT = """\
wmrgen: 1
name: three
wheels:
  - {{name: {0}, type: steered, x: 0.3, y: 0.2, heading: 0, r: 0.1, limits: {{steer: [-100 deg, 100 deg]}}}}
  - {{name: {1}, type: steered, x: -0.3, y: 0.1, heading: 0, r: 0.1}}
  - {{name: {2}, type: castor, x: 0, y: -0.3, heading: 0, d: 0.05, r: 0.1, actuated: [spin, steer]}}
limits: {{vx: 1, vy: 1, omega: 1, spin: 100, steer_rate: 5}}
cg: {{x: 0, y: 0, z: 0.3}}
"""
PLAIN = ("first_one", "second_one", "third_one")
# Words that begin the name of some intermediate result of which the rest may follow a wheel's name.
WORDS = ("half", "over", "point", "point_x", "point_y", "sum", "vector", "mean")


def derived(folder: Path, names: tuple[str, ...]) -> Derivation:
    path = folder / "robot.yaml"
    path.write_text(ROBOT.format(*names), encoding="utf-8")
    return wmrgen.derive(wmrgen.load(path))


@pytest.mark.parametrize("word", WORDS)
def test_a_wheel_with_the_name_of_a_word(word: str, tmp_path: Path) -> None:
    """Every function gives what it gives to wheels of other names."""
    plain, model = derived(tmp_path, PLAIN), derived(tmp_path, (word, PLAIN[1], f"{word}_x"))

    def renamed(name: str) -> str:
        return name.replace(PLAIN[0], word).replace(PLAIN[2], f"{word}_x")

    random = np.random.default_rng(3)
    tried = 0
    for name in functions():
        try:
            ports = plain.formula(name).inputs
        except NotDerivableError:
            continue
        symbols = [symbol.name for symbol, _ in model.formula(name).locals]
        assert len(symbols) == len(set(symbols)), name
        given = {p.name: Exact(Fraction(int(random.integers(-40, 40)), 32)) for p in ports}
        wanted = plain.evaluate(name, given)
        found = model.evaluate(name, {renamed(k): v for k, v in given.items()})
        assert found == {renamed(k): v for k, v in wanted.items()}, name
        tried += 1
    assert tried > 20
