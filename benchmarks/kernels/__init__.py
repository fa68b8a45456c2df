"""The float kernels of generated C: their coefficients by Remez exchange, their worst errors by trying every float."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.kernels import remez, verify
from wmrgen.ir.kernels import trigonometry
from wmrgen.ir.kernels.choice import HOST, M0, M4F


def table(step: int = 1) -> Iterator[str]:
    """Coefficients with their approximation errors, then the worst errors over every ``step``-th float."""
    yield "| kernel | coefficients | error | with one less |"
    yield "|---|---|---:|---:|"
    for kernel in remez.KERNELS:
        texts, error = remez.coefficients(kernel)
        yield f"| {kernel.name} | {' '.join(texts)} | {error:.1e} | {remez.shorter(kernel):.1e} |"
    for kernel, bits in remez.INTEGER:
        whole = " ".join(map(str, remez.whole_coefficients(kernel, bits)))
        yield f"| integer {kernel.name} | {whole} in units of 2^-{bits}, signs alternating | | |"
    yield ""
    yield "| kernel | target | range | floats tried | worst | at | stated |"
    yield "|---|---|---|---:|---:|---:|---:|"
    with tempfile.TemporaryDirectory() as folder:
        for target, vector in ((M4F, False), (M4F, True), (HOST, False), (M0, False)):
            program = verify.build(Path(folder), target, vector)
            for r in verify.VECTOR if vector else verify.RANGES:
                found = verify.worst(program, r, step)
                unit = "2^-24" if r.absolute else "ulp"
                name = f"{r.function} of a vector" if vector else r.function
                yield (
                    f"| {name} | {target} | {r.start:g} to {r.end:g} | {found.count} "
                    f"| {found.worst:.3f} {unit} | {found.where:.9g} | {stated(r, target)} |"
                )


def stated(r: verify.Range, target: str) -> float:
    """What the header of generated C states for a range."""
    worst = trigonometry.worst(target)
    return float(worst.circle if r.absolute else getattr(worst, r.function))
