"""Angles of two decimals, as URDFs have them: a differential drive stays one."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.oracle.harness import Model

TEXT = """wmrgen: 1
name: drive
wheels:
  - {{name: left, type: fixed, l: 0.2, alpha: 1.57, beta: 0, r: 0.1}}
  - {{name: right, type: fixed, l: 0.2, alpha: {alpha}, beta: {beta}, r: 0.1}}
"""


@pytest.mark.parametrize("alpha, beta", [("-1.57", "3.14"), ("-1.5708", "3.1416"), ("-1.571", "3.142")])
def test_the_heading_as_written_decides(tmp_path: Path, alpha: str, beta: str) -> None:
    """alpha + beta - pi/2 = -1.57 + 3.14 - pi/2 is 0.0008 from 0, although 3.14 is 0.0016 from pi.

    Rounding errors of alpha and beta cancel in the sum, so the sum of what the file says is what to snap, not
    the sum after alpha alone was moved.
    """
    m = Model.of(TEXT.format(alpha=alpha, beta=beta), tmp_path).derivation.mobility
    assert (m.degree_of_mobility, m.degree_of_steerability) == (2, 0)
