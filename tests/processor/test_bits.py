"""Every function of every gallery robot on emulated processors: the interpreter's bits.

sinf, cosf and atan2f are answered by the functions that the interpreter calls, so equal bits prove the rest of
the machine code. Nothing here is skipped: the compiler and the processor come from PyPI.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.emulator.zig import M0, M4F
from tests.processor.fleets import mismatches


def test_cortex_m4f(tmp_path: Path) -> None:
    calls, wrong = mismatches(M4F, tmp_path, 10)
    assert wrong == []
    assert calls > 3000


@pytest.mark.slow
def test_cortex_m0(tmp_path: Path) -> None:
    """The same bits without an FPU, from compiler-rt's arithmetic."""
    calls, wrong = mismatches(M0, tmp_path, 3)
    assert wrong == []
    assert calls > 1000
