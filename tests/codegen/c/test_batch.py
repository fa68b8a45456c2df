"""C for arrays of states: it gives the numbers of the scalar C, and compilers vectorise its loops."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.codegen.backends.samples import samples
from tests.conftest import GALLERY
from tests.depth import everyday
from tests.external_tools import need
from tests.robots import of_gallery
from wmrgen.codegen.arrays import argument_names
from wmrgen.codegen.c.batch import batch
from wmrgen.codegen.c.driver import evaluate_c
from wmrgen.codegen.c.emit import printed, unit
from wmrgen.errors import EnvironmentFailure
from wmrgen.ir.calls import self_contained
from wmrgen.ir.kernels.choice import HOST, Choice, choice

DOUBLE = choice("double", target=HOST)
FEW = everyday([path.stem for path in GALLERY], ["pioneer3dx"])


@pytest.mark.parametrize("name", FEW)
def test_every_state_as_the_scalar_c(name: str) -> None:
    module = of_gallery(name).array_module
    many = of_gallery(name).compiled()
    cases = {f.name: samples(module, f, 9) for f in self_contained(module)}
    requests = [(function, case) for function, rows in cases.items() for case in rows]
    answers = iter(evaluate_c(module, requests, DOUBLE))
    for function in self_contained(module):
        names, rows = argument_names(function), cases[function.name]
        found = getattr(many, function.name)(**{a: np.array([r[n] for r in rows]) for n, a in names.items()})
        expectation = [next(answers) for _ in rows]
        for port, values in found.items():
            wanted = [answer[port] for answer in expectation]
            np.testing.assert_allclose(np.broadcast_to(values, len(rows)), wanted, rtol=1e-14, atol=1e-14)


def test_as_numpy() -> None:
    """Names, keywords, defaults and shapes are those of the NumPy functions; tunable parameters may be arrays."""
    derivation = of_gallery("pioneer3dx")
    fast, slow = derivation.compiled(), derivation.numpy()
    inputs: dict[str, Any] = {"left_spin": np.linspace(-3, 3, 12).reshape(3, 4), "right_spin": 2.0}
    for parameters in ({}, {"radius": np.array([0.09, 0.1, 0.11, 0.12])}):
        found, wanted = fast.forward(**inputs, **parameters), slow.forward(**inputs, **parameters)
        assert list(found) == list(wanted)
        for key, values in wanted.items():
            assert found[key].shape == values.shape
            np.testing.assert_allclose(found[key], values, rtol=1e-13, atol=1e-15)
    assert isinstance(fast.forward(1.0, 2.0)["vx"], float)
    assert fast.forward(np.zeros(0), 1.0)["vx"].shape == (0,)
    assert derivation.compiled("float").forward(**inputs)["vx"].dtype == np.float32
    with pytest.raises(TypeError, match="no argument q"):
        fast.forward(1.0, 2.0, q=1.0)


def test_without_a_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(EnvironmentFailure, match="no-such-compiler"):
        of_gallery("pioneer3dx").compiled()


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", ["pioneer3dx", "wpilib_swervebot"])
def test_compilers_vectorise(compiler: str, name: str, tmp_path: Path) -> None:
    """Compilers vectorise the loop of `forward` with its sines, and give no warning."""
    need(compiler)
    module = of_gallery(name).c_module
    functions = unit(module, Choice(target=HOST))
    header, source, pair = printed(functions)
    common = {"robot": name, "upper": name.upper(), "scalar": "float", "pair": pair}
    texts = batch(functions, common)
    for end, text in zip((".h", ".c", "_many.h", "_many.c"), (header, source, *texts), strict=True):
        (tmp_path / (name + end)).write_text(text)
    flags = [
        "-std=c99",
        "-O3",
        "-ffp-contract=off",
        "-fno-math-errno",
        "-fno-trapping-math",
        "-Wall",
        "-Werror",
    ]
    flags.append("-fopt-info-vec" if compiler == "gcc" else "-Rpass=loop-vectorize")
    done = subprocess.run(
        [compiler, *flags, "-c", f"{name}_many.c", "-o", "many.o"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert not done.returncode, done.stderr
    lines = texts[1].splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith(f"void {name}_forward_many("))
    loop = next(k for k in range(at, len(lines)) if "for (wmrgen_i" in lines[k]) + 1  # lines count from 1
    said = [line for line in done.stderr.splitlines() if "vectorized" in line]
    assert any(line.startswith(f"{name}_many.c:{loop}:") for line in said), said
