"""Sums that must not lose what cancels: the velocity of a pivot that the robot turns about.

With the centre of rotation 10 nm from a wheel, vx - y omega is 1e-8 of its terms: less than a float resolves. The
product is therefore formed in parts that are exact, and taken away one after the other.
"""

from __future__ import annotations

from fractions import Fraction

from wmrgen.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op
from wmrgen.ir.rounding import round_rational, to_float32
from wmrgen.ir.tape import Tape

_SPLIT = Exact(4097)  # 2**12 + 1: Veltkamp's constant for halves of 12 bits
_CLOSE = 8


def compensated_sums(function: Function, kernels: tuple[Function, ...] = ()) -> frozenset[int]:
    """The sums x + c y from whose ratio an arctangent is taken, by one of ``kernels`` too."""
    nodes = function.nodes
    found: set[int] = set()
    for node in nodes:
        if node.op is Op.ATAN:
            quotient = _reach(nodes, node.args[0], (Op.MIN, Op.MAX, Op.SELECT, Op.NEG), Op.DIV)
            for i in quotient:
                found |= _pair(nodes, *nodes[i].args)
    ratios = {kernel.name: _ratio(kernel) for kernel in kernels}
    for node in nodes:
        if node.op is Op.CALL:
            wanted = ratios.get(node.name or "", ())
            found |= _sums(nodes, set().union(*(_linear(nodes, node.args[k]) for k in wanted)))
    return frozenset(found)


def _ratio(kernel: Function) -> list[int]:
    """The inputs of a kernel from whose ratio it takes an arctangent."""
    nodes, reached = kernel.nodes, set[int]()
    for node in nodes:
        if node.op is Op.ATAN:
            for i in _reach(nodes, node.args[0], (Op.MIN, Op.MAX, Op.SELECT, Op.NEG), Op.DIV):
                reached |= set().union(*(_linear(nodes, a) for a in nodes[i].args))
    names = {nodes[i].name for i in reached}
    return [k for k, port in enumerate(kernel.inputs) if port.name in names]


def _reach(nodes: tuple[Node, ...], start: int, through: tuple[Op, ...], wanted: Op) -> set[int]:
    found, stack = set(), [start]
    while stack:
        i = stack.pop()
        node = nodes[i]
        if node.op is wanted:
            found.add(i)
        elif node.op in through:
            stack += node.args[2:] if node.op is Op.SELECT else node.args
    return found


def _pair(nodes: tuple[Node, ...], across: int, divisor: int) -> set[int]:
    """The sums among the two components of a velocity, unless the other one keeps it from mattering."""
    return _sums(nodes, _linear(nodes, across) | _linear(nodes, divisor))


def _sums(nodes: tuple[Node, ...], parts: set[int]) -> set[int]:
    sums = {i for i in parts if (t := _terms(nodes, i)) is not None and len(t) == 2}
    return {i for i in sums if not any(_held(nodes, i, j) for j in parts - {i})}


def _linear(nodes: tuple[Node, ...], start: int) -> set[int]:
    """The linear forms of which a value is made by adding and choosing."""
    found: set[int] = set()
    stack = [start]
    while stack:
        i = stack.pop()
        node = nodes[i]
        if _terms(nodes, i) is not None:
            found.add(i)
        elif node.op in (Op.ADD, Op.SUB, Op.NEG, Op.ABS, Op.MAX, Op.SELECT):
            stack += node.args[2:] if node.op is Op.SELECT else node.args
    return found


def _terms(nodes: tuple[Node, ...], i: int) -> dict[int, Exact | None] | None:
    """Input -> coefficient (None: tunable) of a linear form of one or two inputs."""
    node = nodes[i]
    if node.op is Op.INPUT:
        return {i: Exact(1)}
    if node.op is Op.MUL and all(nodes[a].op in (Op.INPUT, Op.CONST) for a in node.args):
        return {node.args[1]: nodes[node.args[0]].value}
    if node.op not in (Op.ADD, Op.SUB):
        return None
    terms: dict[int, Exact | None] = {}
    for arg in node.args:
        part = None if nodes[arg].op in (Op.ADD, Op.SUB) else _terms(nodes, arg)
        if part is None:
            return None
        terms.update(part)
    return terms if len(terms) == 2 else None


def _held(nodes: tuple[Node, ...], total: int, other: int) -> bool:
    """True where ``total`` is x + c z and ``other`` k z with k not much smaller: both cannot vanish together."""
    terms, single = _terms(nodes, total), _terms(nodes, other)
    if terms is None or single is None or len(single) != 1:
        return False
    ((z, k),) = single.items()
    c = terms.get(z)
    return c is not None and k is not None and abs(c) <= abs(k) * _CLOSE


def compensated_sum(tape: Tape, op: Op, a: int, b: int, fused: bool) -> int:
    """a + b or a - b, one of them a product."""
    first = tape.nodes[a].op is Op.MUL
    product, x = (a, b) if first else (b, a)
    if tape.nodes[product].op is not Op.MUL:
        return tape.put(op, a, b)
    factor, y = tape.nodes[product].args
    value = tape.nodes[factor].value
    if op is Op.SUB and first:
        x = tape.neg(x)
    sign = -1 if op is Op.SUB and not first else 1
    if value is not None:
        return (_fused if fused else _split)(tape, x, value * sign, y)
    if sign < 0:
        factor = tape.neg(factor)
    if fused:
        return tape.put(Op.FMA, factor, y, x)
    parts = _halves(tape, factor)
    return _less_parts(tape, x, parts, y, None)


def _fused(tape: Tape, x: int, c: Exact, y: int) -> int:
    high = Exact(Fraction(to_float32(c)))
    low = Exact(Fraction(to_float32(c - high)))
    total = tape.put(Op.FMA, tape.const(high), y, x)
    return tape.put(Op.FMA, tape.const(low), y, total) if low else total


def _split(tape: Tape, x: int, c: Exact, y: int) -> int:
    single = Exact(Fraction(to_float32(c)))
    first = Exact(Fraction(round_rational(c.rational(60), 12, -149, 128)))
    parts = [first, single - first]
    low = Exact(Fraction(to_float32(c - single)))
    if not parts[1] and abs(parts[0].num[0]) == 1:  # a power of two
        return tape.add(x, tape.mul(tape.const(parts[0]), y))
    ids = [tape.const(part) for part in parts if part]
    return _less_parts(tape, x, ids, y, tape.const(low) if low else None)


def _less_parts(tape: Tape, x: int, parts: list[int], y: int, low: int | None) -> int:
    """x + (parts + low) y; a product of two halves of 12 bits is exact, and so is the sum of the two middle ones."""
    high_y, low_y = _halves(tape, y)
    total = tape.add(x, tape.mul(parts[0], high_y))
    middle = tape.mul(parts[0], low_y)
    tail = None if low is None else tape.mul(low, y)
    for part in parts[1:]:
        middle = tape.add(middle, tape.mul(part, high_y))
        last = tape.mul(part, low_y)
        tail = last if tail is None else tape.add(last, tail)
    total = tape.add(total, middle)
    return total if tail is None else tape.add(total, tail)


def _halves(tape: Tape, y: int) -> list[int]:
    """y in two floats of 12 bits (Veltkamp)."""
    t = tape.mul(tape.const(_SPLIT), y)
    high = tape.sub(t, tape.sub(t, y))
    return [high, tape.sub(y, high)]
