"""What the header of generated C says about its arithmetic."""

from __future__ import annotations

from wmrgen.backends.c99.meta import Meta
from wmrgen.ir.kernels.choice import AVR, INLINE, M0
from wmrgen.ir.kernels.constants import worst
from wmrgen.ir.nodes import Function, Op

LARGEST_INPUT = {"float": "1e9", "double": "1e100"}
_WAVES = {Op.SIN, Op.COS, Op.ATAN, Op.ATAN2}


def arithmetic_notes(meta: Meta, functions: tuple[Function, ...], ops: frozenset[Op]) -> list[str]:
    """Paragraphs. ``functions`` before their kernels were put in, ``ops`` what is printed."""
    used = {node.op for function in functions for node in function.nodes}
    inline = meta.scalar == "float" and meta.math == INLINE and meta.target != AVR
    angles = " and angles (and omega dt) up to 12000 rad" if inline and used & _WAVES else ""
    notes = [
        f"Scalars are {meta.scalar}. No loops, recursion, heap or globals: every function may be called from "
        "anywhere. Results are bit for bit those of the printed operations where the compiler contracts "
        "nothing (-ffp-contract=off) and evaluates in the declared type (FLT_EVAL_METHOD 0). Inputs up to "
        f"{LARGEST_INPUT[meta.scalar]} in magnitude{angles} give finite results; beyond, squares may overflow. NaN is "
        "not caught: some outputs may come out as numbers all the same, a steering angle at its limit for one. Check "
        "inputs, or take the functions of the _checked files."
    ]
    if inline and used & _WAVES:
        notes.append(_kernels(meta.target, used))
    if Op.CALL in ops:
        notes.append(
            "The kernels at the top of the C file are inlined. Compiled with -DWMRGEN_SMALL they are called: the "
            "least flash, the same results to the bit; calls cost time and stack."
        )
    if Op.FMA in ops:
        notes.append(
            "Written for processors with a fused multiply-add (Cortex-M4F, M7, M33 and the like), where fmaf is one "
            "instruction; for others there are --target host, m0 and avr."
        )
    if not ops.isdisjoint({Op.IMUL, Op.IDIV, Op.ISQRT}):
        notes.append(
            "Written for processors without floating point: products, quotients and roots are formed in integers, to "
            "the last bit what IEEE 754 says, from fewer instructions than compilers' libraries take."
        )
    return notes


def _kernels(target: str, used: set[Op]) -> str:
    errors = worst(target)
    parts = []
    if used & {Op.SIN, Op.COS}:
        parts.append(
            f"a sine of up to pi/2 is within {errors.sine} ulp, sines and cosines of angles up to 100 rad within "
            f"{errors.circle} * 2**-24"
        )
    if used & {Op.ATAN, Op.ATAN2}:
        parts.append(f"an arctangent of up to 1 within {errors.arctangent} ulp")
    how = "without branches or tables"
    if target == M0:
        how = "in integers, without tables"
    tried = f"Every float of these ranges was tried: {'; '.join(parts)} of the true value."
    return f"Sines and arctangents are polynomials {how}. {tried}"
