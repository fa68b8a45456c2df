"""Sine, cosine and arctangents as float kernels: functions without branches or tables, which only call each other.

``python -m benchmarks kernels`` computes their coefficients and their largest errors. Every number is a float32,
written as the shortest decimal that reads back as it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

from wmrgen.geometry.exact.number import ONE, ZERO, Exact
from wmrgen.geometry.ports import Port, Role
from wmrgen.ir.kernels.choice import M0, M4F
from wmrgen.ir.kernels.sums import fuse
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import to_float32
from wmrgen.ir.tape import Tape

RINT32 = Exact(12582912)  # 1.5 * 2**23: floats this large are whole numbers
EVEN32 = Exact(25165824)  # 1.5 * 2**24: floats this large are even
RINT64 = Exact(6755399441055744)  # 1.5 * 2**52


def _floats(*decimals: str) -> tuple[Exact, ...]:
    return tuple(Exact(Fraction(to_float32(Exact(Fraction(text))))) for text in decimals)


# sin(r) = r + r s (c3 + c5 s + c7 s**2 + c9 s**3), s = r**2, |r| <= pi/2
SIN = _floats("-0.16666657", "0.008333009", "-0.0001980605", "2.5989211e-06")
# cos(r) = 1 + s (c2 + c4 s + ... + c10 s**4)
COS = _floats("1", "-0.5", "0.041666657", "-0.0013888585", "2.477018e-05", "-2.620902e-07")
# atan(q) = q + q t (c3 + c5 t + ... + c17 t**7), t = q**2, |q| <= 1
ATAN = _floats(
    "-0.33333313", "0.1999624", "-0.14225537", "0.10709304", "-0.0762479", "0.04390253",
    "-0.016716665", "0.002993259",
)  # fmt: skip

PER_PI, QUARTER, HALF = _floats("0.31830987", "1.5707964", "3.1415927")  # 1/pi, pi/2, pi
# pi = PI_HIGH - LESS_PI_LOW within 3.4e-13. PI_HIGH has 12 bits, so k PI_HIGH is exact for |k| <= 4096.
PI_HIGH, LESS_PI_LOW = _floats("3.1416016", "8.90891e-06")
# pi = HALF - LESS_HALF_LOW within 1.5e-15, for a product that is not rounded.
LESS_HALF_LOW = _floats("8.742278e-08")[0]
# 2/pi, and pi/2 = QUARTER - LESS_QUARTER_LOW within 1e-15
PER_QUARTER, LESS_QUARTER_LOW = _floats("0.63661975", "4.371139e-08")


class Worst(NamedTuple):
    """The largest errors of kernels, found by trying every float."""

    sine: str  # of angles up to pi/2 [ulp]
    circle: str  # of sine and cosine of angles up to 100 rad [2**-24]
    arctangent: str  # of arguments up to 1 [ulp]


FUSED = Worst(sine="1.68", circle="2.52", arctangent="1.19")  # with fused multiply-add
WHOLE = Worst(sine="15.34", circle="0.73", arctangent="6.67")  # in integers
PLAIN = Worst(sine="1.90", circle="2.93", arctangent="1.23")  # in floats without fused multiply-add


def worst(target: str) -> Worst:
    """Return the largest errors of the kernels of a target."""
    return {M4F: FUSED, M0: WHOLE}.get(target, PLAIN)


_TWO = Exact(2)
VECTOR = ("x", "y")
SOFT = {Op.MUL: Op.IMUL, Op.DIV: Op.IDIV, Op.SQRT: Op.ISQRT}  # the same values from fewer instructions


class Processor(NamedTuple):
    """What a processor computes with."""

    inline: bool  # our own kernels; otherwise the functions of libm
    fused: bool  # fused multiply-add
    shared: bool  # fused multiply-add also for constants that other calls of a kernel need
    bits: bool  # signs are read from the bits of floats
    integer: bool  # no floating point
    single: bool  # float, not double

    @property
    def magic(self) -> Exact:
        """Return 1.5 * 2**23 for float, 1.5 * 2**52 for double: adding it rounds to a whole number."""
        return RINT32 if self.single else RINT64


def flipped(tape: Tape, a: int, raised: int, processor: Processor) -> int:
    """Write a if a whole number is even, else -a.

    Args:
        tape: the nodes.
        a: the number.
        raised: the whole number plus `Processor.magic`, whose last bit is that of the whole number.
        processor: what is computed with.

    Returns:
        The node of a or -a.
    """
    if processor.bits:
        return tape.put(Op.NEGATE_IF_ODD, a, raised)
    sign = _sign(tape, raised, processor)
    return sign if tape.nodes[a].value == ONE else tape.mul(a, sign)


def _sign(tape: Tape, raised: int, processor: Processor) -> int:
    """Write 1 if the whole number is even, else -1. Adding twice the magic number rounds to an even number."""
    if processor.bits:
        return tape.put(Op.NEGATE_IF_ODD, tape.const(ONE), raised)
    magic = tape.const(processor.magic)
    odd = tape.sub(raised, tape.sub(tape.add(raised, magic), magic))
    return tape.sub(tape.const(ONE), tape.mul(tape.const(_TWO), tape.mul(odd, odd)))


def _odd(tape: Tape, x: int, coefficients: tuple[Exact, ...]) -> list[int]:
    """x + x s p(s), s = x**2."""
    s = tape.mul(x, x)
    return [tape.add(x, tape.mul(tape.mul(x, s), tape.horner(s, coefficients)))]


def _sine(tape: Tape, _: Processor) -> list[int]:
    return _odd(tape, tape.input("r"), SIN)


def _arctangent(tape: Tape, _: Processor) -> list[int]:
    return _odd(tape, tape.input("q"), ATAN)


def _direction(tape: Tape, p: Processor) -> list[int]:
    raised, r = _rest(tape, tape.input("angle"), p)
    sign, s = _sign(tape, raised, p), tape.mul(r, r)
    # sign (1 + s p) as sign + (sign s) p: a fused multiply-add overwrites what it adds to, and the 1 would be copied
    cosine = tape.add(tape.mul(tape.mul(sign, s), tape.horner(s, COS[1:])), sign)
    return [cosine, tape.mul(sign, tape.call("sine", r))]


def _vector_at(tape: Tape, p: Processor) -> list[int]:
    size, angle = tape.input("size"), tape.input("angle")
    if p.inline and not p.integer:
        raised, sine, cosine = _quarters(tape, angle) if p.fused else _halves(tape, angle, p)
        size = flipped(tape, size, raised, p)
    else:
        names = (Op.ISIN, Op.ICOS) if p.inline else (Op.SIN, Op.COS)
        sine, cosine = (tape.put(op, angle) for op in names)
    return [tape.mul(size, cosine), tape.mul(size, sine)]


def _halves(tape: Tape, x: int, p: Processor) -> tuple[int, int, int]:
    """Write (raised, sin r, cos r) of `_rest`: sin x and cos x if k is even, otherwise their negatives."""
    raised, r = _rest(tape, x, p)
    return raised, tape.call("sine", r), tape.horner(tape.mul(r, r), COS)


def _quarters(tape: Tape, x: int) -> tuple[int, int, int]:
    """Write `_halves` with fused multiply-adds, and cos r as sin(pi/2 - abs r): only coefficients of sines.

    ``raised`` is 2 k plus a multiple of 4, and its last place is 2. The rounding of pi/2, 0.73 * 2**-24, is not
    subtracted, because the largest error remains where cosines are near 1.
    """
    raised, quarters = _turns(tape, x, PER_QUARTER, EVEN32)
    r = _fused_rest(tape, x, quarters, QUARTER, LESS_QUARTER_LOW)
    across = tape.sub(tape.const(QUARTER), tape.put(Op.ABS, r))
    return raised, tape.call("sine", r), tape.call("sine", across)


def _rest(tape: Tape, x: int, p: Processor) -> tuple[int, int]:
    """Write (raised, r) with x = r + k pi, k = rint(x / pi); the last bit of ``raised`` is that of k."""
    raised, k = _turns(tape, x, PER_PI, RINT32)
    if p.fused:
        return raised, _fused_rest(tape, x, k, HALF, LESS_HALF_LOW)
    r = tape.sub(x, tape.mul(k, tape.const(PI_HIGH)))
    return raised, tape.add(r, tape.mul(k, tape.const(LESS_PI_LOW)))


def _turns(tape: Tape, x: int, per: Exact, large: Exact) -> tuple[int, int]:
    """Write ``per`` x rounded to a multiple of the last place of ``large``, with and without ``large`` added."""
    raised = tape.add(tape.mul(x, tape.const(per)), tape.const(large))
    return raised, tape.sub(raised, tape.const(large))


def _fused_rest(tape: Tape, x: int, k: int, high: Exact, less: Exact) -> int:
    """Write x - k (high - less) with fused multiply-adds: these products must never be rounded."""
    r = tape.put(Op.FMA, tape.put(Op.NEG, k), tape.const(high), x)
    return tape.put(Op.FMA, k, tape.const(less), r)


def _arctangent2(tape: Tape, p: Processor) -> list[int]:
    y, x = tape.input("y"), tape.input("x")
    zero, one = tape.const(ZERO), tape.const(ONE)
    a, b = tape.put(Op.ABS, x), tape.put(Op.ABS, y)
    longer, shorter = tape.select(a, b, b, a), tape.select(a, b, a, b)
    divisor = tape.select(zero, longer, longer, one)
    slope = tape.div(shorter, divisor)
    angle = tape.put(Op.IATAN, slope) if p.integer else tape.call("arctangent", slope)
    angle = tape.select(a, b, tape.sub(tape.const(QUARTER), angle), angle)
    angle = tape.select(x, zero, tape.sub(tape.const(HALF), angle), angle)
    return [tape.select(y, zero, tape.put(Op.NEG, angle), angle)]


_Write = Callable[[Tape, Processor], list[int]]
# Kernels come after the kernels that they call. Name -> (text, outputs, how it is written).
_KERNELS: dict[str, tuple[str, tuple[str, ...], _Write]] = {
    "sine": ("sin r, |r| <= pi/2.", ("value",), _sine),
    "direction": ("(cos angle, sin angle).", VECTOR, _direction),
    "vector_at": ("The vector of this size at this angle: size (cos angle, sin angle).", VECTOR, _vector_at),
    "arctangent": ("atan q, |q| <= 1.", ("value",), _arctangent),
    "arctangent2": ("The angle of (x, y): atan2(y, x), and 0 at the origin.", ("value",), _arctangent2),
}


def library(processor: Processor) -> tuple[Function, ...]:
    """Return the float kernels as functions, each after those that it calls."""
    return tuple(_function(name, processor) for name in _KERNELS)


def _function(name: str, processor: Processor) -> Function:
    text, outputs, write = _KERNELS[name]
    tape = Tape()
    results = tuple(write(tape, processor))
    nodes = tuple(tape.nodes)
    inputs = tuple(port(node.name) for node in nodes if node.op is Op.INPUT and node.name)
    kernel = Function(name, inputs, nodes, tuple(port(n) for n in outputs), results, text)
    kernel = fuse(kernel, constants=processor.shared) if processor.fused else kernel
    return soft(kernel) if processor.integer else kernel


def port(name: str) -> Port:
    """Return an input or output of a kernel."""
    return Port(name, Role.STATE, "", "")


def soft(function: Function) -> Function:
    """Return ``function`` in the arithmetic of a processor without floating point."""
    nodes = (Node(SOFT[n.op], n.args) if n.op in SOFT else n for n in function.nodes)
    return replace(function, nodes=tuple(nodes))
