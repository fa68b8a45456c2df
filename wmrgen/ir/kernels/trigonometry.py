"""The kernels, written on a tape: float operations without branches, tables or calls."""

from __future__ import annotations

from wmrgen.exact.number import ONE, ZERO, Exact
from wmrgen.ir.kernels import constants as c
from wmrgen.ir.kernels.tape import Tape
from wmrgen.ir.nodes import Op


def sine_cosine(tape: Tape, x: int, fused: bool) -> tuple[int, int, int]:
    """(raised, s, c): x = r + k pi, k = rint(x / pi); s = sin r, c = cos r; ``raised`` is k plus an even number.

    sin x = s and cos x = c where k is even, else -s and -c. ``fused``: products that are added are not rounded.
    """
    raised, k = _turns(tape, x, c.PER_PI, c.RINT32)
    if fused:
        r = _fused_rest(tape, x, k, c.HALF, c.LESS_HALF_LOW)
    else:
        r = tape.sub(x, tape.mul(k, tape.const(c.PI_HIGH)))
        r = tape.add(r, tape.mul(k, tape.const(c.LESS_PI_LOW)))
    return raised, _sine(tape, r), _cosine(tape, r)


def sine_cosine_of_rest(tape: Tape, x: int) -> tuple[int, int, int]:
    """As `sine_cosine`, fused, with cos r as sin(pi/2 - abs r): an operation more, seven constants less to keep.

    ``raised`` has the unit 2 in the last place: 2 k plus a multiple of 4. What pi/2 is rounded by, 0.73 * 2**-24,
    is not subtracted: the worst error stays where cosines are near 1.
    """
    raised, quarters = _turns(tape, x, c.PER_QUARTER, c.EVEN32)
    r = _fused_rest(tape, x, quarters, c.QUARTER, c.LESS_QUARTER_LOW)
    return raised, _sine(tape, r), _sine(tape, tape.sub(tape.const(c.QUARTER), tape.put(Op.ABS, r)))


def _turns(tape: Tape, x: int, per: Exact, large: Exact) -> tuple[int, int]:
    """``per`` x rounded to a multiple of the unit of ``large``, with and without that added."""
    raised = tape.add(tape.mul(x, tape.const(per)), tape.const(large))
    return raised, tape.sub(raised, tape.const(large))


def _fused_rest(tape: Tape, x: int, k: int, high: Exact, less: Exact) -> int:
    """x - k (high - less). Fused here, not by `fuse`, which may leave it: the products must not be rounded."""
    r = tape.put(Op.FMA, tape.put(Op.NEG, k), tape.const(high), x)
    return tape.put(Op.FMA, k, tape.const(less), r)


def _sine(tape: Tape, r: int) -> int:
    s = tape.mul(r, r)
    return tape.add(r, tape.mul(tape.mul(r, s), tape.horner(s, c.SIN)))


def _cosine(tape: Tape, r: int) -> int:
    s = tape.mul(r, r)
    return tape.horner(s, c.COS)


def signed_cosine(tape: Tape, sign: int, cosine: int) -> int:
    """``cosine`` of `sine_cosine` times ``sign``, 1 or -1, to the bit: 1 + s p becomes sign + (sign s) p.

    A fused multiply-add overwrites what it adds to. The sign is needed no more; the 1 would be copied for each cosine.
    """
    product, _ = tape.nodes[cosine].args
    s, rest = tape.nodes[product].args
    return tape.add(tape.mul(tape.mul(sign, s), rest), sign)


def arctangent(tape: Tape, q: int) -> int:
    """atan q for |q| <= 1."""
    t = tape.mul(q, q)
    return tape.add(q, tape.mul(tape.mul(q, t), tape.horner(t, c.ATAN)))


def arctangent2(tape: Tape, y: int, x: int, integer: bool = False) -> int:
    """atan2(y, x); 0 at (0, 0), and atan2(-0, x) is that of +0."""
    zero, one = tape.const(ZERO), tape.const(ONE)
    a, b = tape.put(Op.ABS, x), tape.put(Op.ABS, y)
    longer, shorter = tape.select(a, b, b, a), tape.select(a, b, a, b)
    divisor = tape.select(zero, longer, longer, one)
    slope = tape.div(shorter, divisor)
    angle = tape.put(Op.IATAN, slope) if integer else arctangent(tape, slope)
    angle = tape.select(a, b, tape.sub(tape.const(c.QUARTER), angle), angle)
    angle = tape.select(x, zero, tape.sub(tape.const(c.HALF), angle), angle)
    return tape.select(y, zero, tape.put(Op.NEG, angle), angle)
