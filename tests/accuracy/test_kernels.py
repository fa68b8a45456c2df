"""The kernels: coefficients are those that the script computes, errors are at most those that headers state."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import pytest

from benchmarks.kernels import remez, stated, verify
from tests.depth import everyday
from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.interpret import FLOAT32, evaluate
from wmrgen.ir.kernels import expand, trigonometry
from wmrgen.ir.kernels.choice import HOST, M0, M4F
from wmrgen.ir.ops import integer
from wmrgen.ir.rounding import nearest_float32, to_float32

EVERYDAY = 499  # one float in so many


def floats(texts: tuple[str, ...]) -> tuple[Exact, ...]:
    return tuple(Exact(Fraction(to_float32(Exact(Fraction(text))))) for text in texts)


@pytest.mark.parametrize("kernel", remez.KERNELS, ids=lambda k: k.name)
def test_coefficients(kernel: remez.Kernel) -> None:
    """And the degree is the smallest that is good enough."""
    texts, error = remez.coefficients(kernel)
    own = getattr(trigonometry, kernel.name)
    assert floats(texts) == (own[1:] if kernel.name == "COS" else own)
    assert error <= remez.ENOUGH < remez.shorter(kernel)


@pytest.mark.parametrize(("kernel", "bits"), remez.INTEGER, ids=["SINE", "ATAN"])
def test_integer_coefficients(kernel: remez.Kernel, bits: int) -> None:
    assert remez.whole_coefficients(kernel, bits) == getattr(integer, kernel.name)
    assert round(2**34 / (2 * math.pi)) == integer.TURN


def test_parts_of_pi() -> None:
    import mpmath

    with mpmath.workdps(40):
        for high, less in (
            (trigonometry.HALF, trigonometry.LESS_HALF_LOW),
            (trigonometry.PI_HIGH, trigonometry.LESS_PI_LOW),
        ):
            low = float(mpmath.mpf(float(high)) - mpmath.pi)
            assert float(less) == nearest_float32(low)
    assert trigonometry.QUARTER * Exact(2) == trigonometry.HALF
    assert trigonometry.LESS_QUARTER_LOW * Exact(2) == trigonometry.LESS_HALF_LOW
    assert float(trigonometry.PER_QUARTER) == nearest_float32(2 / math.pi) == 2 * float(trigonometry.PER_PI)
    assert (trigonometry.PI_HIGH.num[0]).bit_length() <= 12


@pytest.mark.parametrize("target", everyday([M4F, HOST, M0], [M4F]))
def test_worst_of_a_sample(tmp_path: Path, target: str) -> None:
    program = verify.build(tmp_path, target)
    for r in verify.RANGES:
        assert verify.worst(program, r, EVERYDAY).worst <= stated(r, target), r


@pytest.mark.slow
def test_worst_of_a_sample_of_vectors(tmp_path: Path) -> None:
    """Their cosines are sines, not the usual polynomial, and the same on both sides of 0."""
    vector, usual = tmp_path / "vector", tmp_path / "usual"
    vector.mkdir()
    usual.mkdir()
    programs = verify.build(vector, M4F, vector=True), verify.build(usual, M4F)
    for r in verify.VECTOR:
        found, other = (verify.worst(program, r, EVERYDAY) for program in programs)
        assert found.worst <= stated(r, M4F), r
        assert found != other
    cosine = expand(verify.module(vector=True), "float", "inline").function("cosine")
    for x in (0.0, 1e-9, 0.3, 1.5, 1.6, 100.0):
        y, other = (evaluate(cosine, {"x": value}, FLOAT32)["y"] for value in (x, -x))
        assert y == other
        assert y == pytest.approx(math.cos(x), abs=1.5e-7)
    assert evaluate(cosine, {"x": 0.0}, FLOAT32)["y"] == 1.0


@pytest.mark.slow
@pytest.mark.parametrize("target", [M4F, HOST, M0])
def test_every_float(tmp_path: Path, target: str) -> None:
    """What is stated is the worst, rounded up."""
    program = verify.build(tmp_path, target)
    found = {r: verify.worst(program, r).worst for r in verify.RANGES}
    for r, worst in found.items():
        assert worst <= stated(r, target), r
        largest = max(w for other, w in found.items() if stated(other, target) == stated(r, target))
        assert largest > stated(r, target) - 0.011, r


@pytest.mark.slow
def test_every_float_of_vectors(tmp_path: Path) -> None:
    program = verify.build(tmp_path, M4F, vector=True)
    for r in verify.VECTOR:
        assert verify.worst(program, r).worst <= stated(r, M4F), r


def test_a_worse_coefficient_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: one coefficient off by 2e-6 of it."""
    first, *rest = trigonometry.SIN
    monkeypatch.setattr(trigonometry, "SIN", (first * Exact(Fraction(500_001, 500_000)), *rest))
    program = verify.build(tmp_path, M4F)
    assert verify.worst(program, verify.RANGES[0], EVERYDAY).worst > float(trigonometry.FUSED.sine)
