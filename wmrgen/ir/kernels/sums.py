"""Sums of products as a processor computes them: fused where it has the instruction, and compensated.

A fused multiply-add does not round the product. A compensated sum must not lose digits when terms cancel: with the
centre of rotation 10 nm from a wheel, vx - y omega is 1e-8 of its terms, less than the resolution of a float. The
product is therefore formed in parts that are exact, which are subtracted one after the other.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from wmrgen.geometry.exact.number import Exact
from wmrgen.ir.nodes import Function, Node, Op, Shared, pruned, rebuilt, shared, uses_of
from wmrgen.ir.rounding import round_rational, to_float32
from wmrgen.ir.tape import Tape

_TWO = Exact(2)


def fuse(
    function: Function, kernel: bool = False, common: tuple[int, ...] = (), constants: bool = True
) -> Function:
    """Return ``function`` with fused multiply-adds: each sum with a product that has no other user becomes one.

    Args:
        function: a function in operations of C.
        kernel: whether squares of inputs remain products, because calls with equal inputs share them.
        common: numbers of results whose nodes are fused as if there were no other results.
        constants: whether products that are added to constants are fused as well.
    """
    function = pruned(function)
    nodes = function.nodes
    products = _products(function, kernel, shared(function, common))
    if not constants:
        products = {i: k for i, k in products.items() if nodes[nodes[i].args[1 - k]].value is None}
    fused: list[Node] = []
    place: list[int] = []
    opposites: dict[int, int] = {}

    def opposite(a: int) -> int:
        node = fused[a]
        if node.op is Op.NEG:
            return node.args[0]
        if a not in opposites:
            opposites[a] = len(fused)
            fused.append(Node(Op.NEG, (a,)) if node.value is None else Node(Op.CONST, value=-node.value))
        return opposites[a]

    for i, node in enumerate(nodes):
        args = tuple(map(place.__getitem__, node.args))
        k = products.get(i)
        if k is not None:
            x, y = (place[a] for a in nodes[node.args[k]].args)
            other = args[1 - k]
            if node.op is Op.SUB:
                x, other = (opposite(x), other) if k else (x, opposite(other))
            node = Node(Op.FMA, (x, y, other))
        else:
            node = node.over(args)
        place.append(len(fused))
        fused.append(node)
    return rebuilt(function, fused, dict(enumerate(place)))


def _products(function: Function, kernel: bool, part: Shared) -> dict[int, int]:
    """Return by sum which of its arguments is a product without other users; within ``part``, users there count."""
    sums = [i for i, node in enumerate(function.nodes) if node.op is Op.ADD or node.op is Op.SUB]
    products: dict[int, int] = {}
    uses = uses_of(function)
    for inside, counts in ((True, part.uses), (False, uses)):
        for i in sums:
            k = _product(function.nodes, i, counts, kernel) if (i in part.nodes) is inside else None
            if k is not None:
                products[i] = k
                uses[function.nodes[i].args[k]] -= inside
    return products


def _product(nodes: Sequence[Node], i: int, uses: Mapping[int, int], kernel: bool) -> int | None:
    """Return which argument of sum ``i`` is a product without other users, or None. 2 x stays: x + x is exact."""
    for k, arg in enumerate(nodes[i].args):
        product = nodes[arg]
        if (
            kernel
            and product.op is Op.MUL
            and nodes[product.args[0]].op is Op.INPUT
            and len(set(product.args)) == 1
        ):
            continue
        if product.op is Op.MUL and uses[arg] == 1 and nodes[product.args[0]].value != _TWO:
            return k
    return None


_SPLIT = Exact(4097)  # 2**12 + 1: Veltkamp's constant for halves of 12 bits


def compensated_sum(tape: Tape, x: int, product: int, fused: bool) -> int:
    """Write x + product with the product in parts that are exact.

    Args:
        tape: the nodes.
        x: the other addend.
        product: a product, or the negative of one; other nodes are added as they are.
        fused: whether the processor has a fused multiply-add.

    Returns:
        The node of the sum.
    """
    negative = tape.nodes[product].op is Op.NEG
    node = tape.nodes[tape.nodes[product].args[0]] if negative else tape.nodes[product]
    if node.op is not Op.MUL:
        return tape.add(x, product)
    factor, y = node.args
    value = tape.nodes[factor].value
    if value is not None:
        return (_fused if fused else _split)(tape, x, -value if negative else value, y)
    if negative:
        factor = tape.neg(factor)
    if fused:
        return tape.put(Op.FMA, factor, y, x)
    return _less_parts(tape, x, _halves(tape, factor), y, None)


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
    """Write x + (parts + low) y. Products of two halves of 12 bits are exact, and so is the sum of the middle ones."""
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


def rounding_error(tape: Tape, a: int, b: int) -> int:
    """Write the error of the rounding of a + b, which is a float (Knuth's TwoSum).

    Args:
        tape: the nodes.
        a: an addend.
        b: an addend.

    Returns:
        The node of the exact sum minus the rounded one.
    """
    total = tape.add(a, b)
    second = tape.sub(total, a)
    return tape.add(tape.sub(a, tape.sub(total, second)), tape.sub(b, second))


def _halves(tape: Tape, y: int) -> list[int]:
    """Write y as the sum of two floats of 12 bits (Veltkamp)."""
    t = tape.mul(tape.const(_SPLIT), y)
    high = tape.sub(t, tape.sub(t, y))
    return [high, tape.sub(y, high)]
