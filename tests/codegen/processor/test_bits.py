"""Every function of every gallery robot gives the interpreter's bits on emulated processors.

With kernels of its own the C calls nothing. With libm, sinf, cosf, atanf and atan2f are answered by the functions that
the interpreter calls, so equal bits prove the rest of the machine code. Nothing here is skipped: the compiler and the
processor come from PyPI.
"""

from __future__ import annotations

import pytest

from benchmarks.emulator.zig import M0, M4F, Target
from tests.codegen.processor.conftest import Built
from tests.codegen.processor.fleets import mismatches
from wmrgen.ir.kernels.choice import DEFAULT, MATHS


def test_cortex_m4f(built: Built) -> None:
    """Every function of every robot is called with a few inputs."""
    calls, wrong = mismatches(built(M4F, DEFAULT.math), DEFAULT.math, 2)
    assert wrong == []
    assert calls > 700


@pytest.mark.slow
@pytest.mark.parametrize("small", [False, True], ids=["inlined", "called"])
@pytest.mark.parametrize("target", [M4F, M0], ids=["m4f", "m0"])
@pytest.mark.parametrize("math", MATHS)
def test_on_many_inputs(target: Target, math: str, small: bool, built: Built) -> None:
    """Without an FPU, compiler-rt's arithmetic gives the same bits."""
    calls, wrong = mismatches(built(target, math, small), math, 12 if target is M4F else 3)
    assert wrong == []
    assert calls > 1000
