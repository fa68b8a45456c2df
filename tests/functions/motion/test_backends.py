"""Every function of motion on the exact, CasADi and C backends: the same numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wmrgen
from tests.functions.motion.common import CAR, DIFFERENTIAL, FOUR_WS, MECANUM_T, OMNI_K, SKEWED, compute
from tests.functions.motion.test_laws import FUNCTIONS
from wmrgen.errors import NotDerivableError

TEXTS = {
    "car": CAR,
    "differential": DIFFERENTIAL,
    "four_ws": FOUR_WS,
    "mecanum": MECANUM_T,
    "omni": OMNI_K,
    "skewed": SKEWED,
}
TINY = 1e-9


@pytest.mark.parametrize("function", FUNCTIONS)
@pytest.mark.parametrize("name", TEXTS)
def test_backends_agree(name: str, function: str, tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(TEXTS[name], encoding="utf-8")
    derivation = wmrgen.derive(wmrgen.load(path), [])
    try:
        ports = [p for p in derivation.formula(function).inputs if p.default is None]
    except NotDerivableError as error:
        assert derivation.robot.name in str(error) and len(str(error)) > 40
        return
    random = np.random.default_rng(3)
    cases = [
        {p.name: round(float(v), 6) for p, v in zip(ports, random.uniform(-1, 1, len(ports)), strict=True)}
        for _ in range(3)
    ]
    exact, *others = (compute(path, function, cases, backend) for backend in ("exact", "casadi", "c"))
    for found in others:
        for a, b in zip(exact, found, strict=True):
            assert a.keys() == b.keys()
            np.testing.assert_allclose([b[k] for k in a], list(a.values()), rtol=TINY, atol=TINY)
