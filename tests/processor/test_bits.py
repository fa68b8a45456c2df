"""Every function of every gallery robot on emulated processors: the interpreter's bits.

With kernels of its own the C calls nothing. With libm, sinf, cosf, atanf and atan2f are answered by the functions that
the interpreter calls, so equal bits prove the rest of the machine code. Nothing here is skipped: the compiler and the
processor come from PyPI.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.emulator.zig import M0, M4F, Target
from benchmarks.flavours import DEFAULT, MATHS
from tests.processor.fleets import every, mismatches

TARGETS = pytest.mark.parametrize("target", [M4F, M0], ids=["m4f", "m0"])
FEW = ("lekiwi", "wpilib_swervebot", "nomad_xr4000", "bicycle", "andino")


def test_cortex_m4f(tmp_path: Path) -> None:
    """Every function of every robot, on a few inputs."""
    calls, wrong = mismatches(M4F, tmp_path, every(), DEFAULT, 2)
    assert wrong == []
    assert calls > 700


@pytest.mark.slow
def test_cortex_m0(tmp_path: Path) -> None:
    """The same bits without an FPU, from compiler-rt's arithmetic."""
    calls, wrong = mismatches(M0, tmp_path, [m for m in every() if m.name in FEW], DEFAULT, 2)
    assert wrong == []
    assert calls > 80


@pytest.mark.slow
@TARGETS
@pytest.mark.parametrize("math", MATHS)
def test_on_many_inputs(target: Target, math: str, tmp_path: Path) -> None:
    calls, wrong = mismatches(target, tmp_path, every(), math, 12 if target is M4F else 3)
    assert wrong == []
    assert calls > 1000
