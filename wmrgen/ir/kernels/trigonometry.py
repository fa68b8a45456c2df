"""Sine, cosine and arctangents as float kernels: functions without branches, tables or calls but of each other.

``python -m benchmarks kernels`` computes their coefficients and their worst errors. Every value is a float32, given as
the decimal that reads back as it.
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
    """Worst errors over every float. ``sine``, ``arctangent``: of angles up to pi/2 and of arguments up to 1, in ulp;
    ``circle``: of the sine and cosine of angles up to 100 rad, in units of 2**-24."""

    sine: str
    circle: str
    arctangent: str


FUSED = Worst(sine="1.68", circle="2.52", arctangent="1.19")  # where a product that is added is not rounded
WHOLE = Worst(sine="15.34", circle="0.73", arctangent="6.67")  # in integers
PLAIN = Worst(sine="1.90", circle="2.93", arctangent="1.23")


def worst(target: str) -> Worst:
    """Of the kernels of a target that has its own."""
    return {M4F: FUSED, M0: WHOLE}.get(target, PLAIN)


_TWO = Exact(2)
VECTOR = ("x", "y")
SOFT = {Op.MUL: Op.IMUL, Op.DIV: Op.IDIV, Op.SQRT: Op.ISQRT}  # the same values from fewer instructions


class Processor(NamedTuple):
    """What floats are computed with. ``inline``: own kernels, else libm's functions. ``fused``: products that are
    added are not rounded; ``shared``: also where they are added to a constant that other calls of a kernel need.
    ``bits``: signs are taken from bits. ``integer``: no floating point at all."""

    inline: bool
    fused: bool
    shared: bool
    bits: bool
    integer: bool
    single: bool  # float, not double

    @property
    def magic(self) -> Exact:
        """Numbers this large are whole."""
        return RINT32 if self.single else RINT64


def flipped(tape: Tape, a: int, raised: int, processor: Processor) -> int:
    """a or -a: ``raised`` has the unit 1 in the last place, so its last bit tells odd from even."""
    if processor.bits:
        return tape.put(Op.NEGATE_IF_ODD, a, raised)
    sign = _sign(tape, raised, processor)
    return sign if tape.nodes[a].value == ONE else tape.mul(a, sign)


def _sign(tape: Tape, raised: int, processor: Processor) -> int:
    """1 or -1. Twice the magic number has the unit 2: rounding to it tells odd from even."""
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
    """(raised, sin r, cos r) of `_rest`: sin x and cos x where k is even, else these are -sin r and -cos r."""
    raised, r = _rest(tape, x, p)
    return raised, tape.call("sine", r), tape.horner(tape.mul(r, r), COS)


def _quarters(tape: Tape, x: int) -> tuple[int, int, int]:
    """As `_halves`, fused, with cos r as sin(pi/2 - abs r): no coefficients but those of sines.

    ``raised`` has the unit 2 in the last place: 2 k plus a multiple of 4. What pi/2 is rounded by, 0.73 * 2**-24,
    is not subtracted: the worst error stays where cosines are near 1.
    """
    raised, quarters = _turns(tape, x, PER_QUARTER, EVEN32)
    r = _fused_rest(tape, x, quarters, QUARTER, LESS_QUARTER_LOW)
    across = tape.sub(tape.const(QUARTER), tape.put(Op.ABS, r))
    return raised, tape.call("sine", r), tape.call("sine", across)


def _rest(tape: Tape, x: int, p: Processor) -> tuple[int, int]:
    """(raised, r): x = r + k pi, k = rint(x / pi); the last bit of ``raised`` is that of k."""
    raised, k = _turns(tape, x, PER_PI, RINT32)
    if p.fused:
        return raised, _fused_rest(tape, x, k, HALF, LESS_HALF_LOW)
    r = tape.sub(x, tape.mul(k, tape.const(PI_HIGH)))
    return raised, tape.add(r, tape.mul(k, tape.const(LESS_PI_LOW)))


def _turns(tape: Tape, x: int, per: Exact, large: Exact) -> tuple[int, int]:
    """``per`` x rounded to a multiple of the unit of ``large``, with and without that added."""
    raised = tape.add(tape.mul(x, tape.const(per)), tape.const(large))
    return raised, tape.sub(raised, tape.const(large))


def _fused_rest(tape: Tape, x: int, k: int, high: Exact, less: Exact) -> int:
    """x - k (high - less). Fused here, not by `fuse`, which may leave it: the products must not be rounded."""
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
# Those that are called stand before those that call.
_KERNELS: dict[str, tuple[str, tuple[str, ...], _Write]] = {
    "sine": ("sin r, |r| <= pi/2.", ("value",), _sine),
    "direction": ("(cos angle, sin angle).", VECTOR, _direction),
    "vector_at": ("The vector of this size at this angle: size (cos angle, sin angle).", VECTOR, _vector_at),
    "arctangent": ("atan q, |q| <= 1.", ("value",), _arctangent),
    "arctangent2": ("The angle of (x, y): atan2(y, x), and 0 at the origin.", ("value",), _arctangent2),
}


def library(processor: Processor) -> tuple[Function, ...]:
    """The float kernels as functions of their own, those that are called before those that call."""
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
    """An input or output of a kernel."""
    return Port(name, Role.STATE, "", "")


def soft(function: Function) -> Function:
    """``function`` in the arithmetic of a processor without floating point."""
    nodes = (Node(SOFT[n.op], n.args) if n.op in SOFT else n for n in function.nodes)
    return replace(function, nodes=tuple(nodes))
